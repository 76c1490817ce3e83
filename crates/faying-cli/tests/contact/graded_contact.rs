//! How many systems the active set takes on graded meshes, and that every start ends in the same set.
//!
//! `FAYING_ACTIVE_SET=500` takes that many random problems (`.ci/long`), 25 otherwise.

use faying_cli::Case;
use faying_cli::case::ReadOptions;
use faying_cli::run::run;
use faying_cli::table::InterfaceRow;
use faying_cli::{Finished, Registry, RunControl, RunOptions, Status};
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::fmt::Write;

const HERTZ: &str = include_str!("../../../../examples/cases/hertz.toml");

fn solved(text: &str, sets: &[String]) -> Finished {
    let options = ReadOptions { sets: sets.to_vec(), ..ReadOptions::default() };
    let case = Case::parse("case.toml", text, &options).unwrap_or_else(|e| panic!("{e}\n{text}"));
    run(&case, &Registry::default(), &RunOptions::default(), &RunControl::default())
}

/// Rows closed in every system.
fn history(finished: &Finished) -> Vec<usize> {
    finished.result.solve.as_ref().unwrap().active_set.as_ref().unwrap().history.clone()
}

fn rows(finished: &Finished) -> &[InterfaceRow] {
    &finished.output.as_ref().unwrap().sides[0].rows
}

/// SplitMix64.
struct Dice(u64);

impl Dice {
    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }
    fn below(&mut self, n: usize) -> usize {
        (self.bits() % n as u64) as usize
    }
    /// Uniform in `from..to`.
    fn within(&mut self, from: f64, to: f64) -> f64 {
        from + (to - from) * (self.bits() >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// A block pressed on a plane through a gap that is not straight, or on another block.
struct Problem {
    /// The case but for the slave's breakpoints, its cone and its start.
    text: String,
    elements: usize,
    /// Elements across the block.
    layers: usize,
    /// Size of the least element over the largest.
    ratio: f64,
    /// Where the elements are least.
    toward: f64,
    cone: &'static str,
}

/// `elements + 1` numbers from 0 to 1: sizes grow geometrically away from `toward`, from `ratio` to 1.
fn breakpoints(elements: usize, ratio: f64, toward: f64) -> Vec<f64> {
    let here = toward * (elements - 1) as f64;
    let far = here.max((elements - 1) as f64 - here);
    let mut at = vec![0.0];
    (0..elements).for_each(|k| at.push(at[k] + ratio.powf(1.0 - (k as f64 - here).abs() / far)));
    let end = at[elements];
    at.iter_mut().for_each(|x| *x /= end);
    at[elements] = 1.0;
    at
}

impl Problem {
    fn random(number: usize) -> Self {
        let d = &mut Dice(number as u64 + 1);
        let (p, q) = (1 + d.below(4), 1 + d.below(4));
        let pair = if p == 1 || d.below(2) == 0 { "p/p" } else { "p/p-2" };
        let cone = ["coefficients", "weights", "values"][d.below(3)];
        let elements = 8 + d.below(57);
        let (ratio, toward) = (10f64.powf(d.within(-3.0, 0.0)), d.within(0.0, 1.0));
        let middle = d.within(0.35, 0.65);
        // one zone, a wedge, two zones, a shallow bottom
        let shape = match d.below(4) {
            0 => format!("(x - {middle})^2"),
            1 => format!("0.3*abs(x - {middle})"),
            2 => format!("0.04*(1 - cos(4*pi*(x - {middle} + 0.25)))"),
            _ => format!("4*(x - {middle})^4"),
        };
        let load = 10f64.powf(d.within(-3.5, -1.5));
        let (held, rigid) = (d.below(2) == 0, d.below(2) == 0);
        let mut text = format!(
            "[model]\nphysics = \"elasticity\"\ndimension = 2\n[[material]]\nname = \"m\"\nyoung = 1.0\npoisson = 0.3\n\
             [[patch]]\nname = \"b\"\ndegree = {p}\ngeometry = {{ kind = \"box\", min = [0, 0], max = [1, 0.5] }}\n\
             elements = [BREAKPOINTS, LAYERS]\n"
        );
        if held {
            writeln!(text, "[[boundary]]\non = \"b.top\"\nfix = [\"x\"]\ndirichlet = {{ y = \"-{load:e}\" }}").unwrap();
        } else {
            // the middle of the load lies above the zone
            let push = format!("-{load:e}*(1 + 12*({middle} - 0.5)*(x - 0.5))");
            writeln!(text, "[[boundary]]\non = \"b.left\"\nfix = [\"x\"]\n[[boundary]]\non = \"b.top\"\ntraction = {{ y = \"{push}\" }}")
                .unwrap();
        }
        let opponent = if rigid {
            "rigid = { kind = \"half-plane\", point = [0, 0], normal = [0, 1] }".to_owned()
        } else {
            let (n, middle) = (3 + d.below(20), d.within(0.0, 1.0));
            writeln!(
                text,
                "[[patch]]\nname = \"a\"\ndegree = {q}\ngeometry = {{ kind = \"box\", min = [0, -0.5], max = [1, 0] }}\n\
                 elements = [{:?}, 2]\n[[boundary]]\non = \"a.bottom\"\nfix = [\"x\", \"y\"]",
                breakpoints(n, 0.2, middle)
            )
            .unwrap();
            "master = \"a.top\"".to_owned()
        };
        writeln!(
            text,
            "[[contact]]\nname = \"c\"\nslave = \"b.bottom\"\n{opponent}\ngap = \"{shape}\"\nmultiplier = \"{pair}\"\n\
             cone = \"CONE\"\nactive_set = {{ start = START }}"
        )
        .unwrap();
        Self { text, elements, layers: 2, ratio, toward, cone }
    }

    /// Solved from a start.
    fn from(&self, start: &str) -> Finished {
        let points = format!("{:?}", breakpoints(self.elements, self.ratio, self.toward));
        let layers = self.layers.to_string();
        let text = self.text.replace("BREAKPOINTS", &points).replace("LAYERS", &layers);
        solved(&text.replace("CONE", self.cone).replace("START", start), &[])
    }

    /// The problem of a number that its cone admits: interpolation in the Greville points of strongly graded splines has weights that are
    /// not positive, and the cone E is refused there. Every fourth is graded to where its zone ends.
    fn admitted(number: usize) -> Self {
        let mut problem = Self::random(number);
        if problem.from("\"auto\"").result.diagnostics.iter().any(|d| d.code == "E064") {
            assert_eq!(problem.cone, "values", "{}", problem.text);
            problem.cone = "weights";
        }
        if number.is_multiple_of(4) {
            let found = problem.from("\"auto\"");
            let last = rows(&found).iter().filter(|r| r.active).fold(0.0, |m: f64, r| m.max(r.x[0]));
            (problem.toward, problem.ratio) = (last, problem.ratio.min(0.03));
            if problem.from("\"auto\"").result.diagnostics.iter().any(|d| d.code == "E064") {
                assert_eq!(problem.cone, "values", "{}", problem.text);
                problem.cone = "weights";
            }
        }
        problem
    }
}

/// What differs between two answers; rows with neither pressure nor gap may be either.
fn difference(a: &Finished, b: &Finished) -> Option<String> {
    for found in [a, b] {
        if found.result.status != Status::Ok {
            return Some(format!("{:?}: {}", found.result.status, found.result.diagnostics.iter().map(|d| d.render()).collect::<String>()));
        }
    }
    let press = rows(a).iter().fold(0.0, |m: f64, r| m.max(r.lambda[0].abs()));
    let negligible = |r: &InterfaceRow| r.lambda[0].abs() <= 1e-9 * press && r.gap.is_none_or(|g| g.abs() <= 1e-11);
    rows(a)
        .iter()
        .zip(rows(b))
        .enumerate()
        .find_map(|(k, (r, s))| (r.active != s.active && !(negligible(r) && negligible(s))).then(|| format!("row {k}: {r:?} and {s:?}")))
}

/// Median, 95 % and greatest.
fn distribution(mut counts: Vec<usize>) -> [usize; 3] {
    counts.sort_unstable();
    let n = counts.len();
    [counts[(n - 1) / 2], counts[(95 * n).div_ceil(100) - 1], counts[n - 1]]
}

#[test]
fn graded_problems_take_few_systems_from_every_start() {
    let count = std::env::var("FAYING_ACTIVE_SET").ok().and_then(|n| n.parse().ok()).unwrap_or(25);
    let found: Vec<(usize, Vec<usize>, Vec<String>, &str)> = (0..count)
        .into_par_iter()
        .map(|number| {
            let problem = Problem::admitted(number);
            let starts = ["\"auto\"", "\"all\"", "{ seed = 1 }", "{ seed = 2 }", "{ seed = 3 }"];
            let ends: Vec<Finished> = starts.iter().map(|s| problem.from(s)).collect();
            let faults: Vec<String> = ends
                .iter()
                .zip(starts)
                .filter_map(|(end, start)| difference(&ends[0], end).map(|d| format!("problem {number}, {start}: {d}")))
                .collect();
            (number, ends.iter().map(|e| history(e).len()).collect(), faults, problem.cone)
        })
        .collect();
    let of = |starts: std::ops::Range<usize>| distribution(found.iter().flat_map(|f| f.1[starts.clone()].to_vec()).collect());
    let (auto, all, random) = (of(0..1), of(1..2), of(2..5));
    let cones = ["coefficients", "weights", "values"].map(|c| found.iter().filter(|f| f.3 == c).count());
    let ends = BTreeMap::from([("auto", auto), ("all", all), ("random", random)]);
    println!("graded_contact ends {ends:?} (systems: median, 95 %, greatest) of {count} problems, cones {cones:?}");
    let mut worst: Vec<_> = found.iter().map(|f| (f.1[0], f.0)).collect();
    worst.sort_unstable();
    println!("most from auto, and their problems: {:?}", worst.iter().rev().take(8).collect::<Vec<_>>());
    let mut worst: Vec<_> = found.iter().map(|f| (f.1[2..].iter().copied().max(), f.0)).collect();
    worst.sort_unstable();
    println!("most from random starts, and their problems: {:?}", worst.iter().rev().take(8).collect::<Vec<_>>());
    let faults: Vec<&String> = found.iter().flat_map(|f| &f.2).collect();
    assert!(faults.is_empty(), "{} faults\n{faults:#?}", faults.len());
    assert!(auto[0] <= 6 && auto[1] <= 12 && auto[2] <= 40, "{auto:?}");
    assert!(random[1] <= 18 && random[2] <= 60, "{random:?}");
}

/// With mixed integration the reaction differs from the constraint, and every set takes an LU of the whole system.
#[test]
fn where_every_set_is_a_factor_the_symmetric_system_gives_the_first_guess() {
    let wanted: Option<usize> = std::env::var("FAYING_ACTIVE_SET").ok().and_then(|n| n.parse().ok());
    let (count, sizes) = wanted.map_or((18, 3), |n| (n / 5, 6));
    let pairs: Vec<Problem> = (1000..).map(Problem::random).filter(|p| p.text.contains("master")).take(count).collect();
    let found: Vec<(bool, usize, usize)> = pairs
        .into_par_iter()
        .enumerate()
        .map(|(number, mut problem)| {
            problem.text += "integration = \"mixed\"\n";
            problem.elements = 32 << (number % sizes);
            problem.layers = if problem.elements > 128 { problem.elements / 16 } else { problem.elements / 4 };
            if number.is_multiple_of(2) {
                problem.ratio = 1.0;
            }
            if problem.cone == "values" {
                problem.cone = "weights";
            }
            let (short, long) = (problem.from("\"auto\""), problem.from("\"all\""));
            assert_eq!(difference(&short, &long), None, "problem {number}\n{}", problem.text);
            let report = short.result.solve.as_ref().unwrap().active_set.as_ref().unwrap();
            assert!(report.notes.iter().any(|n| n.contains("symmetric system")), "problem {number}: {:?}", report.notes);
            (problem.ratio == 1.0, problem.elements, report.iterations)
        })
        .collect();
    let of = |wanted: &dyn Fn(bool) -> bool| distribution(found.iter().filter(|f| wanted(f.0)).map(|f| f.2).collect());
    let ends = BTreeMap::from([("all", of(&|_| true)), ("uniform", of(&|uniform| uniform))]);
    println!("graded_contact ends {ends:?} (LU of the whole system: median, 95 %, greatest) of {count} problems, rows {:?}", {
        let mut rows: Vec<usize> = found.iter().map(|f| f.1).collect();
        rows.sort_unstable();
        rows.dedup();
        rows
    });
    let (all, uniform) = (ends["all"], ends["uniform"]);
    assert!(all[0] <= 3 && all[1] <= 8 && all[2] <= 25 && uniform[2] <= 6, "{ends:?}");
}

#[test]
fn a_zone_that_ends_among_smooth_multipliers_opens_in_one_stroke() {
    // degree 3 with p/p on a Hertz mesh refined twice: 83 rows, of which 76 face the plane and less than half stay closed
    let case = |start: &str| {
        let sets = [
            "let.a_R=0.1",
            "discretization.degree=3",
            "contact.plane.multiplier=p/p",
            "patch.cylinder.elements=[20, 12]",
            "patch.cylinder.refine=2",
            "patch.cylinder.grade={ toward = { u = 0.0, v = 1.0 }, ratio = 0.05 }",
        ];
        let start = format!("contact.plane.active_set.start={start}");
        solved(HERTZ.split("[[check]]").next().unwrap(), &[&sets.map(String::from)[..], &[start]].concat())
    };
    let (auto, all) = (case("auto"), case("all"));
    let decided = |f: &Finished| [f.result.solve.as_ref().unwrap().active_set.as_ref().unwrap().sets.clone(), history(f)].concat();
    let (short, long) = (decided(&auto), decided(&all));
    println!("auto {short:?}, all {long:?}");
    assert_eq!((long[0], *long.last().unwrap()), (76, 37));
    assert_eq!(difference(&auto, &all), None);
    // sets of the rows alone cost little; the whole system is solved once
    assert!(short.len() <= 6 && long.len() <= 12 && history(&auto).len() == 1 && history(&all).len() == 1, "{short:?} {long:?}");
}
