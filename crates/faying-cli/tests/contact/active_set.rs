//! The active set of contact: one solution from any start, an end within thirty systems, and outcomes that say what is wrong.
//!
//! `FAYING_ACTIVE_SET=500` takes that many random cases (`.ci/long`), 25 otherwise.

use faying_cli::Case;
use faying_cli::case::ReadOptions;
use faying_cli::run::run;
use faying_cli::table::InterfaceRow;
use faying_cli::{Finished, Registry, RunControl, RunOptions, RunResult, Status};
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::path::Path;

fn solved(text: &str, sets: &[String]) -> Finished {
    let options = ReadOptions { sets: sets.to_vec(), ..ReadOptions::default() };
    let case = Case::parse("case.toml", text, &options).unwrap_or_else(|e| panic!("{e}\n{text}"));
    run(&case, &Registry::default(), &RunOptions::default(), &RunControl::default())
}

fn set(result: &RunResult) -> faying_cli::result::ActiveSetSummary {
    result.solve.as_ref().unwrap().active_set.clone().unwrap()
}

fn said(result: &RunResult) -> String {
    result.diagnostics.iter().map(|d| d.render()).collect()
}

const MODEL: &str = "[model]\nphysics = \"elasticity\"\ndimension = 2\n[[material]]\nname = \"m\"\nyoung = 1.0\npoisson = 0.3\n";

/// A box pressed on another by a load that leans; one corner lifts.
const LEANING: &str = "[[patch]]\nname = \"a\"\ngeometry = { kind = \"box\", min = [0, 0], max = [1, 0.5] }\nelements = [7, 3]\n\
    [[patch]]\nname = \"b\"\ngeometry = { kind = \"box\", min = [0, 0.5], max = [1, 1] }\nelements = [9, 4]\n\
    [[boundary]]\non = \"a.bottom\"\nfix = [\"x\", \"y\"]\n[[boundary]]\non = \"b.left\"\nfix = [\"x\"]\n\
    [[boundary]]\non = \"b.top\"\ntraction = { y = \"-1e-3*(1 - 1.3*x)\" }\n\
    [[contact]]\nname = \"c\"\nslave = \"b.bottom\"\nmaster = \"a.top\"\n";

/// Hertz: a quarter of a ring pressed on a plane, the zone a small part of the side.
const ROUND: &str = "[[patch]]\nname = \"b\"\ngeometry = { kind = \"annulus-sector\", center = [0, 1], radius = [0.2, 1], angle_deg = [-90, 0] }\n\
    elements = [24, 10]\ngrade = { toward = { u = 0.0, v = 1.0 }, ratio = 0.1 }\n\
    [[boundary]]\non = \"b.u0\"\nfix = [\"x\"]\n[[boundary]]\non = \"b.u1\"\ntraction = { y = \"-2e-3\" }\n\
    [[contact]]\nname = \"c\"\nslave = \"b.v1\"\nrigid = { kind = \"half-plane\", point = [0, 0], normal = [0, 1] }\n";

fn rows(finished: &Finished) -> &[InterfaceRow] {
    &finished.output.as_ref().unwrap().sides[0].rows
}

/// What differs between two answers; rows with neither pressure nor gap may be either.
fn difference(a: &Finished, b: &Finished) -> Option<String> {
    let (x, y) = (&a.result, &b.result);
    if (x.status, y.status) != (Status::Ok, Status::Ok) {
        return Some(format!("{:?} and {:?}: {}{}", x.status, y.status, said(x), said(y)));
    }
    if (x.energy - y.energy).abs() > 1e-9 * x.energy.abs() {
        return Some(format!("energies {} and {}", x.energy, y.energy));
    }
    let press = rows(a).iter().fold(0.0, |m: f64, r| m.max(r.lambda[0].abs()));
    for (k, (p, q)) in rows(a).iter().zip(rows(b)).enumerate() {
        let (l, m) = (p.lambda[0], q.lambda[0]);
        let (g, h) = (p.gap.unwrap_or(0.0), q.gap.unwrap_or(0.0));
        if (l - m).abs() > 1e-9 * press || (g - h).abs() > 1e-9 {
            return Some(format!("row {k}: lambda {l} and {m}, gap {g} and {h}"));
        }
        if p.active != q.active && (l.abs() > 1e-11 * press || g.abs() > 1e-11) {
            return Some(format!("row {k} is active in one only: lambda {l} and {m}, gap {g} and {h}"));
        }
    }
    None
}

fn families() -> Vec<(String, String, Vec<String>)> {
    let mut all = Vec::new();
    for (name, text) in [("leaning", LEANING), ("round", ROUND)] {
        for (backend, degree, multiplier) in
            [("iga", 2, "p/p-2"), ("iga", 3, "p/p"), ("iga", 2, "dual"), ("fe", 2, "p/p-2"), ("fe", 3, "p/p"), ("fe", 2, "constant")]
        {
            let sets = vec![
                format!("discretization.backend={backend}"),
                format!("discretization.degree={degree}"),
                format!("contact.c.multiplier={multiplier}"),
            ];
            all.push((format!("{name} {backend} {degree} {multiplier}"), format!("{MODEL}{text}"), sets));
        }
    }
    let sets = ["patch.a.backend=iga", "patch.b.backend=fe"].map(String::from).to_vec();
    all.push(("leaning, mixed".into(), format!("{MODEL}{LEANING}"), sets));
    all
}

#[test]
fn one_solution_is_found_from_every_start_and_with_every_c() {
    let failures: Vec<String> = families()
        .par_iter()
        .flat_map_iter(|(name, text, sets)| {
            let with = |more: String| solved(text, &[&sets[..], &[more]].concat());
            let reference = with("contact.c.active_set.start=all".into());
            assert_eq!(reference.result.status, Status::Ok, "{name}: {}", said(&reference.result));
            let mut starts: Vec<String> =
                ["auto", "all", "none", "gap"].iter().map(|s| format!("contact.c.active_set.start={s}")).collect();
            starts.extend((1..=20).map(|seed| format!("contact.c.active_set.start={{ seed = {seed} }}")));
            let mut failures: Vec<String> = starts
                .iter()
                .filter_map(|start| difference(&reference, &with(start.clone())).map(|d| format!("{name}, {start}: {d}")))
                .collect();
            for c in ["1e-3", "1e3", "1e6"] {
                let other = with(format!("contact.c.active_set={{ start = \"all\", c = {c} }}"));
                failures.extend(difference(&reference, &other).map(|d| format!("{name}, c = {c}: {d}")));
                assert_eq!(set(&reference.result), set(&other.result), "{name}, c = {c}: the same iteration to the last row");
            }
            failures
        })
        .collect();
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

/// SplitMix64.
struct Dice(u64);

impl Dice {
    fn below(&mut self, n: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) % n as u64) as usize
    }
    fn one<'a>(&mut self, of: &[&'a str]) -> &'a str {
        of[self.below(of.len())]
    }
}

/// A grazing or symmetric case: gaps exactly closed, rows with neither gap nor pressure, loads that vanish or pull, bodies that contact
/// alone holds.
fn random_case(number: usize) -> String {
    let mut dice = Dice(number as u64);
    let d = &mut dice;
    let degree = 1 + d.below(3);
    let backend = d.one(&["iga", "fe"]);
    let multiplier = if degree == 1 { d.one(&["auto", "p/p", "constant"]) } else { d.one(&["auto", "p/p", "p/p-2", "dual", "constant"]) };
    let start = match d.below(5) {
        0 => "\"all\"".to_owned(),
        1 => "\"none\"".to_owned(),
        2 => "\"gap\"".to_owned(),
        3 => "\"auto\"".to_owned(),
        _ => format!("{{ seed = {} }}", d.below(1000)),
    };
    let rule =
        format!("multiplier = \"{multiplier}\"\nactive_set = {{ start = {start}, c = {} }}\n", d.one(&["1e-3", "1.0", "1e3", "1e6"]));
    // symmetric, leaning, concentrated, none, a pull at one end, a pull everywhere
    let load = d.one(&[
        "-1e-3",
        "-1e-3*(x-0.5)^2",
        "1e-3*(x - 0.7)",
        "if(abs(x-0.5)<0.26, -1e-3, 0)",
        "0",
        "-1e-3*cos(2*pi*x)",
        "2e-4*x - 1e-4",
        "1e-3",
    ]);
    let elements = |d: &mut Dice| format!("elements = [{}, {}]\n", 2 + d.below(7), 1 + d.below(3));
    let hold = d.one(&["[[boundary]]\non = \"b.left\"\nfix = [\"x\"]\n", "[[boundary]]\non = \"b.left\"\nspring = { x = 1.0 }\n"]);
    let above = |d: &mut Dice| {
        format!("[[patch]]\nname = \"b\"\ngeometry = {{ kind = \"box\", min = [0, 0.5], max = [1, 1] }}\n{}{hold}", elements(d))
            + &format!("[[boundary]]\non = \"b.top\"\ntraction = {{ y = \"{load}\" }}\n")
    };
    let below = |d: &mut Dice| {
        format!("[[patch]]\nname = \"a\"\ngeometry = {{ kind = \"box\", min = [0, 0], max = [1, 0.5] }}\n{}", elements(d))
            + "[[boundary]]\non = \"a.bottom\"\nfix = [\"x\", \"y\"]\n"
    };
    let gap = d.one(&["g", "0", "g + 1e-3*(x-0.5)^2", "if(x < 0.5, g, g + 1e-4)", "g - 1e-4", "g + 2e-4*abs(x-0.5)", "g + 1e-4*x"]);
    let body = match d.below(6) {
        0 => {
            above(d)
                + &format!(
                    "[[contact]]\nname = \"c\"\nslave = \"b.bottom\"\nrigid = {{ kind = \"half-plane\", point = [0, 0.5], normal = [0, 1] }}\ngap = \"{gap}\"\n{rule}"
                )
        }
        1 | 2 => {
            above(d) + &below(d) + &format!("[[contact]]\nname = \"c\"\nslave = \"b.bottom\"\nmaster = \"a.top\"\ngap = \"{gap}\"\n{rule}")
        }
        // a third body between, held by two contacts alone
        3 => {
            let low = below(d).replace("min = [0, 0], max = [1, 0.5]", "min = [0, 0], max = [1, 0.25]");
            let middle = format!(
                "[[patch]]\nname = \"m\"\ngeometry = {{ kind = \"box\", min = [0, 0.25], max = [1, 0.5] }}\n{}[[boundary]]\non = \"m.left\"\nfix = [\"x\"]\n",
                elements(d)
            );
            above(d)
                + &low
                + &middle
                + &format!("[[contact]]\nname = \"c\"\nslave = \"b.bottom\"\nmaster = \"m.top\"\ngap = \"{gap}\"\n{rule}")
                + &format!("[[contact]]\nname = \"d\"\nslave = \"m.bottom\"\nmaster = \"a.top\"\n{rule}")
        }
        // an arc that touches in one point
        4 => format!(
            "[[patch]]\nname = \"b\"\ngeometry = {{ kind = \"annulus-sector\", center = [0, 1], radius = [0.4, 1], angle_deg = [-90, 0] }}\n{}\
             [[boundary]]\non = \"b.u0\"\nfix = [\"x\"]\n[[boundary]]\non = \"b.u1\"\ntraction = {{ y = \"{load}\" }}\n\
             [[contact]]\nname = \"c\"\nslave = \"b.v1\"\nrigid = {{ kind = \"half-plane\", point = [0, 0], normal = [0, 1] }}\n{rule}",
            elements(d)
        ),
        // between two plates
        _ => {
            above(d)
                + &format!(
                    "[[contact]]\nname = \"c\"\nslave = \"b.bottom\"\nrigid = {{ kind = \"half-plane\", point = [0, 0.5], normal = [0, 1] }}\n{rule}"
                )
                + &format!(
                    "[[contact]]\nname = \"d\"\nslave = \"b.right\"\nrigid = {{ kind = \"half-plane\", point = [1, 0], normal = [-1, 0] }}\n{rule}"
                )
        }
    };
    let probes: String = ["u.x.min", "u.x.max", "u.y.min", "u.y.max"].map(|q| format!("[[probe]]\nquantity = \"{q}\"\n")).concat();
    format!("{MODEL}[discretization]\nbackend = \"{backend}\"\ndegree = {degree}\n{body}{probes}")
}

/// Pressure that the rounding of positions makes: nodes are 1/24 of a length apart at least and lie at 1 at most, the modulus is 1, so a gap
/// that is off by the rounding of its places has the pressure eps E / h. Case 203 has nothing else: a body that a gap moves as a whole.
const ROUNDING: f64 = 24.0 * f64::EPSILON;

/// Sign, lumped gap and complementarity of every row; sizes: modulus 1, lengths 1, so that displacements are stresses, too.
fn kkt(result: &RunResult) -> Option<String> {
    let loads = result
        .probes
        .iter()
        .filter(|p| p.quantity.starts_with("u.") && !p.quantity.contains("at"))
        .fold(1e-3, |m: f64, p| m.max(p.value.abs()));
    result.contact.iter().find_map(|(name, c)| {
        let press = c.pressure.max.abs().max(c.pressure.min.abs()).max(loads);
        let allowed = (1e-12 * press).max(ROUNDING);
        let bad = c.kkt.lambda > allowed || c.kkt.gap > 1e-12 || c.kkt.product > 1e-12 * press;
        bad.then(|| format!("{name}: {:?}, pressure {press:e}", c.kkt))
    })
}

#[test]
fn random_grazing_and_symmetric_cases_end_within_thirty_systems() {
    let count = std::env::var("FAYING_ACTIVE_SET").ok().and_then(|n| n.parse().ok()).unwrap_or(25);
    let ends: Vec<(usize, String, usize, Option<String>)> = (0..count)
        .into_par_iter()
        .map(|number| {
            let text = random_case(number);
            let options = ReadOptions::default();
            let case = Case::parse("case.toml", &text, &options).unwrap_or_else(|e| panic!("{number}: {e}\n{text}"));
            let result = match case.run(&Registry::default()) {
                Ok(result) => result,
                // more multipliers than the side has free unknowns
                Err(e) if e.items.iter().all(|d| d.code == "E024") => return (number, "refused".into(), 0, None),
                Err(e) => return (number, "refused".into(), 0, Some(format!("{e}\n{text}"))),
            };
            let solve = result.solve.as_ref().unwrap();
            let iterations = solve.active_set.as_ref().map_or(0, |s| s.iterations);
            let known = ["converged", "cycling", "rigid motion left", "infeasible load"];
            let mut fault = None;
            if iterations > 30 || !known.contains(&solve.reason.as_str()) {
                fault = Some(format!("{} after {iterations}: {}\n{text}", solve.reason, said(&result)));
            } else if solve.reason == "converged" {
                fault = kkt(&result).map(|f| format!("{f}\n{text}"));
            } else if result.exit != 5 || result.diagnostics.is_empty() {
                fault = Some(format!("{}, exit {}", solve.reason, result.exit));
            }
            (number, solve.reason.clone(), iterations, fault)
        })
        .collect();
    let (mut outcomes, mut counts) = (BTreeMap::new(), BTreeMap::new());
    for (_, reason, iterations, _) in &ends {
        *outcomes.entry(reason.as_str()).or_insert(0) += 1;
        *counts.entry(*iterations).or_insert(0) += 1;
    }
    println!("active_set ends {outcomes:?}, iterations {counts:?}");
    let faults: Vec<String> = ends.iter().filter_map(|(n, _, _, f)| f.as_ref().map(|f| format!("case {n}: {f}"))).collect();
    assert!(faults.is_empty(), "{} of {count}:\n{}", faults.len(), faults.iter().take(5).cloned().collect::<Vec<_>>().join("\n\n"));
    assert!(outcomes.get("converged").is_some_and(|&n| 2 * n > count), "{outcomes:?}");
}

#[test]
fn the_contact_conditions_hold_at_the_end_of_every_sample_case() {
    let folder = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")).join("examples/cases");
    let mut seen = 0;
    let mut files: Vec<_> = std::fs::read_dir(folder).unwrap().map(|e| e.unwrap().path()).collect();
    files.sort();
    for path in files.iter().filter(|p| p.extension().is_some_and(|e| e == "toml")) {
        if !std::fs::read_to_string(path).unwrap().contains("[[contact]]") {
            continue;
        }
        let result = Case::read(path).unwrap().run(&Registry::default()).unwrap();
        assert_eq!(result.status, Status::Ok, "{}: {}", path.display(), said(&result));
        let iterations = set(&result).iterations;
        assert!(iterations <= 8, "{}: {iterations}", path.display());
        assert_eq!(kkt(&result), None, "{}", path.display());
        seen += 1;
    }
    assert!(seen >= 2);
}

const BLOCK: &str = "[[patch]]\nname = \"upper\"\ngeometry = { kind = \"box\", min = [0, 0], max = [1, 1] }\nelements = [4, 3]\n\
    [[boundary]]\non = \"upper.left\"\nfix = [\"x\"]\n\
    [[contact]]\nname = \"c\"\nslave = \"upper.bottom\"\nrigid = { kind = \"half-plane\", point = [0, 0], normal = [0, 1] }\n";

#[test]
fn a_load_that_no_pressure_balances_is_infeasible_and_says_what_is_missing() {
    let finished = solved(&format!("{MODEL}{BLOCK}[[boundary]]\non = \"upper.top\"\ntraction = {{ y = 0.25 }}\n"), &[]);
    let result = &finished.result;
    assert_eq!((result.status, result.exit), (Status::Singular, 5));
    assert_eq!(result.solve.as_ref().unwrap().reason, "infeasible load");
    let text = said(result);
    assert!(text.contains("error[E072]: infeasible load: nothing holds body \"upper\" against its load in translation y"), "{text}");
    assert!(text.contains("a force (0, -0.25) is missing"), "{text}");
    // the best iterate is written: all rows closed, in tension
    assert!(finished.output.is_some());
    assert_eq!((set(result).best, set(result).iterations), (1, 1));
    // with its moment: a block that only rests on a plane, pushed down beside it
    let free = BLOCK.replace("fix = [\"x\"]", "spring = { x = 1e-3 }").replace("on = \"upper.left\"", "on = \"upper.bottom\"");
    let tilted = solved(&format!("{MODEL}{free}[[boundary]]\non = \"upper.top\"\ntraction = {{ y = \"2 - 6*x\" }}\n"), &[]);
    assert_eq!(tilted.result.solve.as_ref().unwrap().reason, "infeasible load", "{}", said(&tilted.result));
    assert!(said(&tilted.result).contains("a moment"), "{}", said(&tilted.result));
}

#[test]
fn a_balanced_load_leaves_a_body_that_touches_without_force() {
    // pulled and pushed in equal parts along its lower side: contact can hold it, and has nothing to hold
    let text = format!("{MODEL}{BLOCK}[[boundary]]\non = \"upper.bottom\"\ntraction = {{ y = \"1e-3*cos(2*pi*x)\" }}\n");
    let finished = solved(&text, &[]);
    let result = &finished.result;
    assert_eq!((result.status, result.exit), (Status::Ok, 0), "{}", said(result));
    let contact = result.contact.get("c").unwrap();
    assert!(contact.force[1].abs() < 1e-12 * 1e-3 && contact.gap.min.abs() < 1e-12, "{contact:?}");
    assert_eq!(kkt(result), None);
}

#[test]
fn a_body_that_contact_alone_holds_converges_from_starts_that_leave_it_free() {
    for start in ["none", "gap", "{ seed = 3 }", "{ seed = 4 }"] {
        let text = format!("{MODEL}{BLOCK}[[boundary]]\non = \"upper.top\"\ntraction = {{ y = \"-1e-3*(1 - 1.3*x)\" }}\n");
        let sets = [format!("contact.c.active_set.start={start}"), "contact.c.gap=\"g + 1e-4\"".to_owned()];
        let result = solved(&text, &sets).result;
        assert_eq!(result.status, Status::Ok, "{start}: {}", said(&result));
        let set = set(&result);
        if start == "none" || start == "gap" {
            assert_eq!(set.notes[0], "rows alone: set 1: the start left a body free; all rows were closed");
        }
        assert_eq!((set.best, set.history.len(), set.sign_cases.len()), (set.iterations, set.iterations, set.iterations));
        assert_eq!(set.wrong.last(), Some(&0));
        assert_eq!(kkt(&result), None);
    }
}

/// A clamped block over a wedge: with all rows closed two of forty pull, and only they open.
const WEDGE: &str = "[[patch]]\nname = \"up\"\ngeometry = { kind = \"box\", min = [0, 0], max = [1, 0.5] }\nelements = [40, 4]\n\
    [[boundary]]\non = \"up.top\"\nfix = [\"x\"]\ndirichlet = { y = \"-0.03\" }\n\
    [[contact]]\nname = \"pad\"\nslave = \"up.bottom\"\nrigid = { kind = \"half-plane\", point = [0, 0], normal = [0, 1] }\n\
    gap = \"0.05*abs(x - 0.5)\"\n";

// 38 of 40 rows and the force: an independent quadratic program (nonnegative least squares on the dual, numpy)
#[test]
fn a_start_of_all_rows_needs_few_systems_where_nearly_all_are_right() {
    let text = format!("{MODEL}{WEDGE}");
    for start in ["\"auto\"", "\"all\"", "\"none\"", "\"gap\"", "{ seed = 3 }"] {
        let found = solved(&text, &[format!("contact.pad.active_set={{ start = {start} }}")]);
        assert_eq!(found.result.status, Status::Ok, "{start}: {}", said(&found.result));
        let pad = found.result.contact.get("pad").unwrap();
        assert!((pad.force[1] - 0.04152652866816576).abs() < 1e-12 && pad.active == 38, "{start}: {pad:?}");
        assert!(set(&found.result).iterations <= 6, "{start}: {:?}", set(&found.result));
    }
}

// Multipliers by enumerating all sets of closed rows (numpy); whatever opens first leaves the block free.
/// A box that covers three elements and a half of a side: every set from the first guess on leads back to one that was there.
#[test]
fn exchanges_from_the_best_set_may_come_through_the_one_that_closed_a_circle() {
    for size in [1e-8, 1.0, 2.3e8] {
        let point = |[x, y]: [f64; 2]| format!("[{:?}, {:?}]", x * size, y * size);
        let corners = [[0.1976, 1.12], [0.1976, -0.0362], [-0.4471, -0.0362], [-0.4471, 1.12], [0.1976, 1.12]].map(point).join(", ");
        let text = format!(
            "[model]\nphysics = \"elasticity\"\ndimension = 2\n[[material]]\nname = \"m\"\nyoung = 1.0\npoisson = 0.3\n\
             [[patch]]\nname = \"b\"\ngeometry = {{ kind = \"box\", min = {}, max = {} }}\nelements = [11, 3]\ndegree = 2\n\
             [[boundary]]\non = [\"b.bottom\", \"b.right\"]\nfix = [\"x\", \"y\"]\n\
             [[contact]]\nname = \"c\"\nslave = \"b.top\"\nmultiplier = \"p/p\"\n\
             rigid = {{ kind = \"nurbs\", degree = 1, knots = [0, 0, 1, 2, 3, 4, 4], points = [{corners}] }}\n",
            point([-1.0, -0.9555]),
            point([1.0, 0.0])
        );
        for start in ["auto", "all", "none", "gap", "{ seed = 1 }"] {
            let set = [format!("contact.c.active_set.start={start}")];
            let finished = solved(&text, &set);
            assert_eq!(finished.result.status, Status::Ok, "{size} {start}: {:?}", finished.result.diagnostics);
            let kkt = &finished.result.contact.get("c").unwrap().kkt;
            assert!(kkt.lambda < 1e-11 && kkt.gap < 1e-11 * size && kkt.product < 1e-11 * size, "{size} {start}: {kkt:?}");
        }
    }
}

#[test]
fn a_block_between_leaning_planes_is_held_by_the_rows_that_are_needed() {
    let plane = |name: &str, side: &str, point: &str, normal: [f64; 2]| {
        format!(
            "[[contact]]\nname = \"{name}\"\nslave = \"b.{side}\"\nreach = 50\nrigid = {{ kind = \"half-plane\", point = {point}, normal = [{}, {}] }}\n",
            normal[0], normal[1]
        )
    };
    let text = format!(
        "{MODEL}[[patch]]\nname = \"b\"\ngeometry = {{ kind = \"box\", min = [0, 0], max = [1, 0.5] }}\nelements = [2, 1]\n{}{}{}",
        plane("right", "right", "[1, 0.25]", [-0.9950041652780258, -0.09983341664682815]),
        plane("left", "left", "[0, 0.25]", [0.9800665778412416, 0.19866933079506122]),
        plane("top", "top", "[0.5, 0.5]", [-0.19866933079506122, -0.9800665778412416])
    )
    .replace("dimension = 2\n", "dimension = 2\nbody_force = [\"-0.1\", \"1.0\"]\n")
    .replace("young = 1.0", "young = 1000.0");
    for start in ["all", "none", "gap"] {
        let sets: Vec<String> = ["right", "left", "top"].map(|c| format!("contact.{c}.active_set={{ start = \"{start}\" }}")).to_vec();
        let found = solved(&text, &sets);
        assert_eq!(found.result.status, Status::Ok, "{start}: {}", said(&found.result));
        let sides = &found.output.as_ref().unwrap().sides;
        let lambda: Vec<f64> = sides.iter().flat_map(|s| s.rows.iter().map(|r| r.lambda[0])).collect();
        for (l, expected) in lambda.iter().zip([0.0, -0.32210, -0.49808, -0.58756]) {
            assert!((l - expected).abs() < 1e-5, "{start}: {lambda:?}");
        }
    }
}
