//! Small cases with values exchanged for others run to an end that the contract knows: no panic, no unknown exit, no
//! number that is not finite in a run that says it went well. `FAYING_MUTATIONS=10000` in the environment makes that many.

use faying_cli::Case;
use faying_cli::case::ReadOptions;
use faying_cli::run::{check, run};
use faying_cli::{Registry, RunControl, RunOptions};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::{Duration, Instant};

const SAMPLES: [&str; 4] = [
    include_str!("../../../../examples/cases/poisson-arc.toml"),
    include_str!("../../../../examples/cases/contact-patch.toml"),
    include_str!("../../../../examples/cases/hertz.toml"),
    include_str!("../../../../examples/cases/iga-fe-arc.toml"),
];

/// A NURBS patch in full, tied to a disc; sides that need care: collapsed centre, corner of a plate.
const ODD: &str = r#"
[let]
k = 2.0
[model]
physics = "poisson"
dimension = 2
source = "k*x - y"
[[material]]
name = "stuff"
conductivity = 1.5
[[patch]]
name = "core"
geometry = { kind = "disc-sector", center = [0, 0], radius = 1.0, angle_deg = [0, 90] }
elements = [4, 3]
[[patch]]
name = "shell"
geometry = { kind = "nurbs", degree = [2, 1], knots = [[0, 0, 0, 1, 1, 1], [0, 0, 1, 1]], points = [[1, 0], [1, 1], [0, 1], [2, 0], [2, 2], [0, 2]], weights = [1, 0.7071067811865476, 1, 1, 0.7071067811865476, 1] }
elements = [5, 2]
basis = "nurbs"
[[boundary]]
on = "shell.v1"
dirichlet = "x^2"
[[boundary]]
on = "core.u0"
neumann = "sin(x)"
[[interface]]
name = "arc"
slave = "shell.v0"
master = "core.v1"
multiplier = "p/p"
[[probe]]
name = "middle"
quantity = "u at [0.5, 0.5] in core"
[[check]]
quantity = "interface.arc.jump.L2"
below = 1.0
"#;

/// A block that its load presses down a little more than another lifts it: most other loads take it off its support.
const LIFTED: &str = r#"
[model]
physics = "elasticity"
dimension = 2
[[material]]
name = "soft"
young = 1
poisson = 0.3
[[patch]]
name = "lower"
geometry = { kind = "box", min = [0, 0], max = [1, 0.5] }
elements = [4, 2]
[[patch]]
name = "upper"
geometry = { kind = "box", min = [0, 0.5], max = [1, 1] }
elements = [3, 2]
[[boundary]]
on = "lower.bottom"
fix = ["y"]
[[boundary]]
on = ["lower.left", "upper.left"]
fix = ["x"]
[[boundary]]
on = "upper.top"
pressure = 0.001
[[boundary]]
on = "upper.bottom"
pressure = 0.0009
[[contact]]
name = "pad"
slave = "upper.bottom"
master = "lower.top"
"#;

/// Xorshift: the same mutations on every machine.
struct Random(u64);

impl Random {
    fn below(&mut self, n: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as usize % n.max(1)
    }
    fn pick<'a>(&mut self, from: &[&'a str]) -> &'a str {
        from[self.below(from.len())]
    }
}

/// Numbers and words that stand in the place of others.
const NUMBERS: [&str; 16] =
    ["0", "1", "-1", "2", "3", "7", "0.5", "1e-9", "1e9", "-0.25", "90", "360", "\"x\"", "\"1/k\"", "1e-300", "1e300"];
const WORDS: [&[&str]; 9] = [
    &["iga", "fe"],
    &["auto", "p/p", "p/p-2", "p/p-1", "constant", "p/p-4"],
    &["u0", "u1", "v0", "v1", "left", "top"],
    &["auto", "nurbs", "b-spline"],
    &["tensor", "simplex"],
    &["isoparametric", "exact"],
    &["plane-strain", "plane-stress"],
    &["auto", "saddle-point", "condensed"],
    &["all", "none", "gap"],
];

/// Exchanges a number or a word; `small` keeps the elements few.
fn mutate(text: &str, r: &mut Random) -> String {
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    let k = r.below(lines.len());
    let line = lines[k].split('#').next().unwrap_or("").to_owned();
    match r.below(6) {
        0 => drop(lines.remove(k)),
        1 | 2 => {
            // one of the line's numbers
            let mut places = Vec::new();
            let bytes = line.as_bytes();
            let mut i = 0;
            while i < bytes.len() {
                let starts = bytes[i].is_ascii_digit() && (i == 0 || !(bytes[i - 1].is_ascii_alphanumeric() || bytes[i - 1] == b'_'));
                let mut end = i + 1;
                while starts && end < bytes.len() && (bytes[end].is_ascii_alphanumeric() || bytes[end] == b'.') {
                    end += 1;
                }
                if starts {
                    places.push(i..end);
                }
                i = end;
            }
            if let Some(place) = places.get(r.below(places.len())).cloned() {
                lines[k] = format!("{}{}{}", &line[..place.start], r.pick(&NUMBERS), &line[place.end..]);
            }
        }
        3 => {
            let family = WORDS[r.below(WORDS.len())];
            for (number, line) in lines.clone().iter().enumerate() {
                if let Some(word) = family.iter().find(|w| line.contains(&format!("\"{w}\"")) || line.contains(&format!(".{w}\""))) {
                    let (from, to) = (word.to_string(), r.pick(family));
                    lines[number] = line.replace(&format!("{from}\""), &format!("{to}\""));
                }
            }
        }
        4 => {
            // a key that the block does not have yet
            let extra = r.pick(&[
                "degree = 1",
                "degree = 3",
                "degree = [3, 1]",
                "continuity = 0",
                "basis = \"b-spline\"",
                "basis = \"nurbs\"",
                "backend = \"fe\"",
                "cells = \"simplex\"",
                "mapping = \"exact\"",
                "multiplier = \"p/p\"",
                "extra_points = 2",
                "gap = \"g - 0.01\"",
                "pressure = \"x\"",
                "fix = [\"x\"]",
                "refine = 1",
            ]);
            lines.insert(k, extra.to_owned());
        }
        _ => {
            let j = r.below(lines.len());
            lines.swap(k, j);
        }
    }
    lines.join("\n")
}

/// The sample with few elements, so that hundreds of them run in seconds.
fn small(text: &str) -> String {
    text.lines()
        .map(|l| {
            if l.trim_start().starts_with("elements = [") {
                "elements = [5, 3]".to_owned()
            } else {
                l.replace("ratio = 0.02", "ratio = 0.2")
            }
        })
        .collect::<Vec<_>>()
        .join("\n")
}

#[test]
fn mutated_cases_end_as_the_contract_says() {
    let registry = Registry::default();
    let mut r = Random(0x9e37_79b9_7f4a_7c15);
    let sources: Vec<String> = SAMPLES.iter().map(|s| small(s)).chain([ODD.to_owned(), LIFTED.to_owned()]).collect();
    let mut ends = std::collections::BTreeMap::<i32, usize>::new();
    let count = std::env::var("FAYING_MUTATIONS").ok().and_then(|n| n.parse().ok()).unwrap_or(2000);
    for number in 0..count {
        let mut text = sources[number % sources.len()].clone();
        for _ in 0..1 + r.below(2) {
            text = mutate(&text, &mut r);
        }
        let outcome = catch_unwind(AssertUnwindSafe(|| {
            let case = match Case::parse("case.toml", &text, &ReadOptions::default()) {
                Ok(case) => case,
                Err(_) => return 3,
            };
            let limit = Duration::from_secs(10);
            let watch = || RunControl {
                max_memory: Some(200_000_000),
                deadline: Some((Instant::now() + limit, limit.as_secs_f64())),
                ..RunControl::default()
            };
            let checked = check(&case, &registry, &RunOptions::default(), &watch()).result;
            let finished = run(&case, &registry, &RunOptions::default(), &watch());
            if checked.exit == 3 {
                assert_eq!(finished.result.exit, 3, "`check` refuses what `run` accepts");
            }
            // every file can be made of what came out
            let json = finished.result.to_json();
            assert!(serde_json::from_str::<serde_json::Value>(&json).is_ok(), "{json}");
            if let Some(output) = &finished.output {
                let _ = format!("{:?}", output.parts);
            }
            finished.result.exit
        }));
        let exit = outcome.unwrap_or_else(|_| panic!("case {number} panics:\n{text}"));
        assert!([0, 1, 3, 5, 6].contains(&exit), "case {number} ends with {exit}:\n{text}");
        *ends.entry(exit).or_default() += 1;
    }
    // the mutations do not only break the syntax; few leave a body that no contact holds
    for (exit, least) in [(0, 10), (1, 10), (3, 10), (5, 2)] {
        assert!(ends.get(&exit).is_some_and(|n| *n >= least), "{ends:?}");
    }
}
