//! The four formulations of contact against each other and against exact states: lagrange, penalty, augmented, nitsche.

use faying_cli::Case;
use faying_cli::case::ReadOptions;
use faying_cli::errors::Diagnostics;
use faying_cli::{Registry, RunResult, Status};
use rayon::prelude::*;

const PAIRS: [[&str; 2]; 4] = [["iga", "iga"], ["iga", "fe"], ["fe", "iga"], ["fe", "fe"]];
const VARIANTS: [&str; 3] = ["symmetric", "unsymmetric", "incomplete"];

fn read(text: &str, sets: &[String]) -> Result<Case, Diagnostics> {
    Case::parse("case.toml", text, &ReadOptions { sets: sets.to_vec(), ..ReadOptions::default() })
}

fn result(text: &str, sets: &[String]) -> RunResult {
    let case = read(text, sets).unwrap_or_else(|e| panic!("{e}\n{sets:?}"));
    case.run(&Registry::default()).unwrap_or_else(|e| panic!("{e}\n{sets:?}"))
}

/// A run that has converged; what its checks say is left to the test.
fn run(text: &str, sets: &[String]) -> RunResult {
    let result = result(text, sets);
    assert!(matches!(result.status, Status::Ok | Status::CheckFailed), "{sets:?}: {:?}", result.diagnostics);
    result
}

fn sample(name: &str) -> String {
    std::fs::read_to_string(format!("{}/examples/cases/{name}.toml", concat!(env!("CARGO_MANIFEST_DIR"), "/../.."))).unwrap()
}

/// `--set` texts: the method of a contact, with its own keys.
fn method(contact: &str, words: &[&str]) -> Vec<String> {
    let mut sets = vec![format!("contact.{contact}.method={}", words[0])];
    sets.extend(words[1..].iter().map(|key| format!("contact.{contact}.{key}")));
    sets
}

/// The formulations without an error of their own.
fn exact_methods(contact: &str) -> Vec<Vec<String>> {
    let mut all = vec![method(contact, &["lagrange"]), method(contact, &["augmented"])];
    all.extend(VARIANTS.map(|v| method(contact, &["nitsche", &format!("variant={v}")])));
    all
}

fn contact<'a>(result: &'a RunResult, name: &str) -> &'a faying_cli::result::ContactReport {
    result.contact.get(name).unwrap()
}

/// Errors of the patch test relative to the pressure: settlement, stress, force, pressure, moment, area.
fn defects(r: &RunResult) -> [f64; 7] {
    let p = 1.25e-3;
    let check = |name: &str| {
        let c = r.checks.iter().find(|c| c.name == name).unwrap();
        (c.value / c.expected - 1.0).abs()
    };
    let k = contact(r, "pad");
    let faying_cli::result::Moment::Plane(moment) = k.moment else { panic!("a plane case") };
    [
        check("settlement"),
        check("stress"),
        (k.force[1] / p - 1.0).abs(),
        (k.pressure.max / p - 1.0).abs(),
        (k.pressure.min / p - 1.0).abs(),
        (moment / (0.5 * p) - 1.0).abs(),
        (k.area - 1.0).abs(),
    ]
}

fn largest(list: &[f64]) -> f64 {
    list.iter().fold(0.0, |m: f64, &v| if v.is_nan() { f64::INFINITY } else { m.max(v) })
}

fn pair_sets(pair: [&str; 2], degree: usize) -> Vec<String> {
    vec![format!("patch.lower.backend={}", pair[0]), format!("patch.upper.backend={}", pair[1]), format!("discretization.degree={degree}")]
}

// The state is in every space: a formulation without an error of its own has it to round-off, whatever the meshes are.
#[test]
fn a_constant_pressure_passes_a_grid_that_does_not_match_by_every_method() {
    let text = sample("contact-patch");
    let cases: Vec<_> = PAIRS.iter().flat_map(|&pair| (1..=3).map(move |p| (pair, p))).collect();
    let failures: Vec<String> = cases
        .par_iter()
        .flat_map_iter(|&(pair, p)| {
            let mut failures = Vec::new();
            for sets in exact_methods("pad") {
                let sets = [pair_sets(pair, p), sets].concat();
                let r = run(&text, &sets);
                let found = defects(&r);
                if largest(&found) > 1e-10 {
                    failures.push(format!("{sets:?}: {found:?}"));
                }
                let at_points = sets.iter().any(|s| s.contains("nitsche"));
                assert_eq!(r.unknowns.multipliers == 0, at_points, "{sets:?}");
                assert_eq!(contact(&r, "pad").multiplier.is_none(), at_points, "{sets:?}");
            }
            failures
        })
        .collect();
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

#[test]
fn a_penalty_has_an_error_that_falls_with_its_factor() {
    let text = sample("contact-patch");
    let cases: Vec<_> = PAIRS.iter().flat_map(|&pair| (1..=3).map(move |p| (pair, p))).collect();
    cases.par_iter().for_each(|&(pair, p)| {
        let error = |factor: &str| {
            let r = run(&text, &[pair_sets(pair, p), method("pad", &["penalty", &format!("factor={factor}")])].concat());
            let k = contact(&r, "pad");
            // what gives way is pressed: gap = compliance lambda in the whole zone
            assert!(k.kkt.gap > 0.0 && k.kkt.lambda == 0.0 && k.gap.min == -k.kkt.gap, "{:?}", k.kkt);
            assert!((k.force[1] / 1.25e-3 - 1.0).abs() < 1e-10);
            defects(&r)[0]
        };
        let errors = [error("1e2"), error("1e4"), error("1e6")];
        for pair in errors.windows(2) {
            assert!((pair[0] / pair[1] / 100.0 - 1.0).abs() < 0.1, "{errors:?}");
        }
        assert!(error("auto") < 1e-8);
    });
}

/// The sample of a half cylinder on a rigid plane with fewer elements. A set of points that is far too large is peeled a few per iteration.
fn coarse_hertz() -> String {
    sample("hertz").replace("elements = [64, 40]", "elements = [24, 10]").replace("max_iterations = 60", "max_iterations = 200")
}

/// A small cylinder on a block that gives way, both with a curved gap: the zone ends between elements.
fn cylinder_on_block(backends: [&str; 2], degree: usize) -> String {
    format!(
        r#"
[model]
physics = "elasticity"
dimension = 2
[discretization]
degree = {degree}
[[material]]
name = "hard"
young = 3.0
poisson = 0.3
[[material]]
name = "soft"
young = 1.0
poisson = 0.3
[[patch]]
name = "cylinder"
backend = "{}"
material = "hard"
geometry = {{ kind = "annulus-sector", center = [0, 1], radius = [0.3, 1], angle_deg = [-90, 0] }}
elements = [16, 6]
grade = {{ toward = {{ u = 0.0, v = 1.0 }}, ratio = 0.2 }}
[[patch]]
name = "block"
backend = "{}"
material = "soft"
geometry = {{ kind = "box", min = [0, -1], max = [1.5, 0] }}
elements = [17, 5]
grade = {{ toward = {{ u = 0.0, v = 1.0 }}, ratio = 0.2 }}
[[boundary]]
on = ["cylinder.u0", "block.left"]
fix = ["x"]
[[boundary]]
on = "block.bottom"
fix = ["y"]
[[boundary]]
on = "cylinder.u1"
traction = {{ y = "-0.02" }}
[[contact]]
name = "line"
slave = "cylinder.v1"
master = "block.top"
reach = 0.3
active_set = {{ max_iterations = 200 }}
[[probe]]
name = "top"
quantity = "u.y at [1, 1] in cylinder"
[[probe]]
name = "side"
quantity = "u.x at [0.9, -0.5] in block"
[[probe]]
name = "middle"
quantity = "contact.line.pressure at [0.01, 0]"
[[probe]]
name = "beside"
quantity = "contact.line.pressure at [0.1, 0.005]"
"#,
        backends[0], backends[1]
    )
}

/// Probes, force, moment, greatest pressure, area and half width, -1 where the zone is too coarse for one.
fn numbers(r: &RunResult, name: &str) -> Vec<f64> {
    let k = contact(r, name);
    let faying_cli::result::Moment::Plane(moment) = k.moment else { panic!("a plane case") };
    let mut all: Vec<f64> = r.probes.iter().map(|p| p.value).collect();
    let width = if k.half_width.unwrap().is_nan() { -1.0 } else { k.half_width.unwrap() };
    all.extend([k.force[1], moment, k.pressure.max, k.area, width]);
    all
}

fn difference(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    largest(&a.iter().zip(b).map(|(a, b)| if a == b { 0.0 } else { (a - b).abs() / a.abs().max(b.abs()) }).collect::<Vec<_>>())
}

// Augmented ends at the multiplier method's state, penalty at it in its limit; iterations are printed for docs/comparisons.md.
#[test]
fn penalty_and_augmented_end_at_the_state_of_the_multiplier_method() {
    let hertz = coarse_hertz();
    let mut cases: Vec<(String, &str, Vec<String>)> = Vec::new();
    for backend in ["iga", "fe"] {
        let sets = |p: usize| vec![format!("discretization.backend={backend}"), format!("discretization.degree={p}")];
        cases.extend((1..=3).map(|p| (hertz.clone(), "plane", sets(p))));
    }
    cases.extend(PAIRS.iter().map(|&pair| (cylinder_on_block(pair, 2), "line", Vec::new())));
    let rows: Vec<String> = cases
        .par_iter()
        .map(|(text, name, sets)| {
            let solve = |words: &[&str]| run(text, &[sets.clone(), method(name, words)].concat());
            let exact = solve(&["lagrange"]);
            let wanted = numbers(&exact, name);
            assert!(wanted.iter().all(|v| v.is_finite()));
            let augmented = solve(&["augmented"]);
            let d = difference(&numbers(&augmented, name), &wanted);
            assert!(d < 1e-9, "{sets:?}: augmented differs by {d:e}");
            let set = |r: &RunResult| r.solve.as_ref().unwrap().active_set.clone().unwrap();
            assert!(set(&augmented).updates.unwrap() > 1 && set(&exact).updates.is_none());
            assert_eq!(contact(&augmented, name).iterations, set(&augmented).history.len());
            assert_eq!(contact(&augmented, name).sign_cases, contact(&exact, name).sign_cases, "{sets:?}");
            let apart = ["1e4", "1e6", "1e8"].map(|f| difference(&numbers(&solve(&["penalty", &format!("factor={f}")]), name), &wanted));
            assert!(apart[0] > 10.0 * apart[1] && apart[1] > 10.0 * apart[2] && apart[2] < 1e-6, "{sets:?}: {apart:?}");
            let penalty = solve(&["penalty"]);
            let d = difference(&numbers(&penalty, name), &wanted);
            assert!(d < 1e-6, "{sets:?}: penalty differs by {d:e}");
            format!(
                "{name} {sets:?}: linear systems {} lagrange, {} penalty, {} augmented ({} updates)",
                set(&exact).iterations,
                set(&penalty).iterations,
                set(&augmented).iterations,
                set(&augmented).updates.unwrap()
            )
        })
        .collect();
    println!("{}", rows.join("\n"));
}

/// Manufactured contact (benchmarks, section 4): a gap that closes completely, with the exact tangential traction.
fn manufactured(backend: &str, degree: usize, n: usize) -> String {
    format!(
        r#"
[let]
mu = "1/2.6"
lam = "0.3/(1.3*0.4)"
[model]
physics = "elasticity"
dimension = 2
exact = {{ u = ["-0.2*y^3*(x - 0.5)", "-0.05*(x - 0.5)^2*(1 + y) - 0.01*y"] }}
[discretization]
backend = "{backend}"
degree = {degree}
[[material]]
name = "m"
young = 1.0
poisson = 0.3
[[patch]]
name = "a"
geometry = {{ kind = "box", min = [0, 0], max = [1, 1] }}
elements = [{n}, {n}]
[[boundary]]
on = ["a.left", "a.right", "a.top"]
dirichlet = "exact"
[[boundary]]
on = "a.bottom"
traction = {{ x = "0.1*mu*(x - 0.5)" }}
[[contact]]
name = "c"
slave = "a.bottom"
rigid = {{ kind = "level-set", f = "y + 0.05*(x - 0.5)^2", along = [0, 1] }}
exact = "-(lam + 2*mu)*(0.01 + 0.05*(x - 0.5)^2)"
"#
    )
}

fn error(r: &RunResult, name: &str) -> f64 {
    *r.errors.get(name).unwrap()
}

// Consistent: what lies in the space is the answer. Below it both fields fall at the order of the space.
#[test]
fn nitsche_contact_is_exact_where_the_space_is_and_falls_at_its_order_elsewhere() {
    let jobs: Vec<(&str, &str)> = ["iga", "fe"].iter().flat_map(|&b| VARIANTS.map(|v| (b, v))).collect();
    let rows: Vec<String> = jobs
        .par_iter()
        .map(|&(backend, variant)| {
            let solve = |p: usize, n: usize| run(&manufactured(backend, p, n), &method("c", &["nitsche", &format!("variant={variant}")]));
            let r = solve(3, 4);
            let found = [error(&r, "error.u.L2.rel"), error(&r, "error.u.H1.rel"), error(&r, "error.c.lambda.L2.rel")];
            assert!(largest(&found) < 1e-11, "{backend} {variant}: {found:?}");
            let mut text = format!("{backend} {variant}:");
            for p in [1, 2] {
                let levels = [solve(p, 8), solve(p, 16), solve(p, 32)];
                for name in ["error.u.L2.rel", "error.u.H1.rel", "error.c.lambda.L2.rel"] {
                    let e: Vec<f64> = levels.iter().map(|r| error(r, name)).collect();
                    let rate = (e[1] / e[2]).log2();
                    text += &format!(" p={p} {name} {:.1e} rate {rate:.2};", e[2]);
                    // without symmetry L2 keeps the rate of H1 for even p
                    let wanted = match name {
                        "error.u.L2.rel" if variant == "symmetric" || p == 1 => p as f64 + 0.9,
                        "error.u.L2.rel" => p as f64 - 0.1,
                        "error.u.H1.rel" => p as f64 - 0.1,
                        _ => p as f64 - 0.1,
                    };
                    assert!(rate > wanted, "{backend} {variant} p = {p} {name}: {e:?}");
                }
            }
            text
        })
        .collect();
    println!("{}", rows.join("\n"));
}

// Balance holds whatever the discretisation error is; pressure, zone and displacement come closer to the multiplier method's.
#[test]
fn nitsche_contact_approaches_the_multiplier_method_on_finer_meshes() {
    let jobs: Vec<(Option<[&str; 2]>, &str)> = vec![
        (None, "symmetric"),
        (None, "unsymmetric"),
        (Some(["iga", "fe"]), "symmetric"),
        (Some(["fe", "iga"]), "incomplete"),
        (Some(["iga", "iga"]), "unsymmetric"),
    ];
    let rows: Vec<String> = jobs
        .par_iter()
        .map(|&(pair, variant)| {
            let (text, name) = match pair {
                None => (coarse_hertz(), "plane"),
                Some(pair) => (cylinder_on_block(pair, 2), "line"),
            };
            let words = ["nitsche", &format!("variant={variant}")];
            let patches: &[&str] = if name == "line" { &["cylinder", "block"] } else { &["cylinder"] };
            let level = |refine: usize, words: &[&str]| {
                let sets: Vec<String> = patches.iter().map(|p| format!("patch.{p}.refine={refine}")).collect();
                run(&text, &[sets, method(name, words)].concat())
            };
            let mut apart = Vec::new();
            let mut iterations = Vec::new();
            for refine in 0..2 {
                let (a, b) = (level(refine, &words), level(refine, &["lagrange"]));
                let (k, l) = (contact(&a, name), contact(&b, name));
                assert!((k.force[1] / l.force[1] - 1.0).abs() < 1e-9, "{variant} {pair:?}: {:?} {:?}", k.force, l.force);
                assert!(a.balance.force.iter().all(|f| f.abs() < 1e-10 * l.force[1].abs()), "{:?}", a.balance);
                assert!(k.kkt.lambda == 0.0 && k.pressure.min == 0.0 && k.active > 0);
                apart.push((k.pressure.max / l.pressure.max - 1.0).abs());
                // zones too coarse for a half width have none
                let ratio = k.half_width.unwrap() / l.half_width.unwrap();
                assert!(ratio.is_nan() || (ratio - 1.0).abs() < 0.35, "{} {}", k.half_width.unwrap(), l.half_width.unwrap());
                iterations.push([k.iterations, l.iterations]);
                // a first state of all points does not have to be peeled
                assert!(k.iterations <= 60, "{variant} {pair:?}: {} iterations", k.iterations);
            }
            assert!(apart[0] < 0.05 && apart[1] < 0.02, "{variant} {pair:?}: {apart:?}");
            format!("{name} {pair:?} {variant}: greatest pressures differ by {apart:?}, iterations (nitsche, lagrange) {iterations:?}")
        })
        .collect();
    println!("{}", rows.join("\n"));
}

/// A stack of five blocks of one width; `joints`: a contact or an interface between each two of them.
fn stack(joints: &[&str], backends: &[&str]) -> String {
    let mut text = String::from(
        "[model]\nphysics = \"elasticity\"\ndimension = 2\n[[material]]\nname = \"m\"\nyoung = 1.0\npoisson = 0.3\n[discretization]\ndegree = 2\n",
    );
    for (k, n) in (0..=joints.len()).map(|k| (k, 3 + (k * 2) % 3)) {
        text += &format!(
            "[[patch]]\nname = \"b{k}\"\nbackend = \"{}\"\ngeometry = {{ kind = \"box\", min = [0, {k}], max = [2, {}] }}\nelements = [{n}, 2]\n",
            backends[k % backends.len()],
            k + 1
        );
        text += &format!("[[boundary]]\non = \"b{k}.left\"\nfix = [\"x\"]\n");
    }
    for (k, joint) in joints.iter().enumerate() {
        text += &format!("{joint}\nname = \"j{k}\"\nslave = \"b{}.bottom\"\nmaster = \"b{k}.top\"\n", k + 1);
    }
    text += "[[boundary]]\non = \"b0.bottom\"\nfix = [\"y\"]\n";
    text
}

#[test]
fn contacts_of_every_method_stand_beside_each_other_and_a_tie() {
    let joints = [
        "[[contact]]\nmethod = \"lagrange\"",
        "[[contact]]\nmethod = \"nitsche\"\nvariant = \"incomplete\"",
        "[[interface]]",
        "[[contact]]\nmethod = \"penalty\"",
        "[[contact]]\nmethod = \"augmented\"",
        "[[contact]]\nmethod = \"nitsche\"",
    ];
    for backends in [&["iga", "fe"][..], &["fe"], &["iga"]] {
        let text = stack(&joints, backends)
            + "[[boundary]]\non = \"b6.top\"\npressure = 0.01\n[[probe]]\nname = \"top\"\nquantity = \"u.y at [1, 7] in b6\"\n";
        let r = run(&text, &[]);
        // seven units of height, plane strain, free to grow sideways
        assert!((r.probes[0].value / (-0.01 * 0.91 * 7.0) - 1.0).abs() < 1e-8, "{backends:?}: {}", r.probes[0].value);
        for k in [0, 1, 3, 4, 5] {
            let c = contact(&r, &format!("j{k}"));
            assert!((c.force[1] / 0.02 - 1.0).abs() < 1e-10 && (c.pressure.max / 0.01 - 1.0).abs() < 1e-8, "{backends:?} j{k}: {c:?}");
        }
        assert!(r.balance.force.iter().all(|f| f.abs() < 1e-12));
    }
}

#[test]
fn contacts_open_and_close_over_steps_by_every_method() {
    for (k, words) in
        [&["lagrange"][..], &["penalty"], &["augmented"], &["nitsche"], &["nitsche", "variant=unsymmetric"]].iter().enumerate()
    {
        let backends = PAIRS[k % 4];
        // the gap closes by 1e-3 in the course of a step, on top of the motion of the upper side
        let text = stack(&["[[contact]]\ngap = \"g - 1e-3*t\""], &backends)
            + "[[boundary]]\non = \"b1.top\"\ndirichlet = { y = \"if(t < 1.5, -0.001, if(t < 2.5, 0.01, -0.002))\" }\n[steps]\nt = [1, 2, 3]\n";
        let r = run(&text, &method("j0", words));
        for (step, push) in r.steps.iter().zip([0.002, 0.0, 0.005]) {
            // two blocks of height 1: p = E / (1 - nu^2) push / 2
            let expected = 2.0 * push / 2.0 / 0.91;
            let found = step.contact.get("j0").unwrap().force[1];
            assert!((found - expected).abs() < 1e-9 * 0.005, "{words:?} at t = {}: {found} of {expected}", step.t);
        }
        let active: Vec<bool> = r.steps.iter().map(|s| s.contact.get("j0").unwrap().active > 0).collect();
        assert_eq!(active, [true, false, true], "{words:?}");
    }
}

#[test]
fn an_obstacle_that_moves_presses_by_every_method() {
    for words in [&["lagrange"][..], &["penalty"], &["augmented"], &["nitsche"], &["nitsche", "variant=incomplete"]] {
        for backend in ["iga", "fe"] {
            let text = stack(&[], &[backend])
                + "[[contact]]\nname = \"c\"\nslave = \"b0.top\"\nrigid = { kind = \"half-plane\", point = [0, 1], normal = [0, -1], move = { y = \"0.01 - 0.02*t\" } }\n\
                   [steps]\nt = [0.25, 0.75, 1]\n";
            let r = run(&text, &method("c", words));
            // a penalty has its own error
            let tolerance = if words[0] == "penalty" { 1e-8 } else { 1e-11 };
            for (step, push) in r.steps.iter().zip([0.0, 0.005, 0.01]) {
                let found = step.contact.get("c").unwrap().force[1];
                assert!((found + 2.0 * push / 0.91).abs() <= tolerance * push, "{words:?} {backend} at t = {}: {found}", step.t);
            }
            assert!(r.balance.force.iter().all(|f| f.abs() < 1e-13));
        }
    }
}

#[test]
fn an_obstacle_pressed_by_a_force_gives_way_to_soft_rows_too() {
    let case = |method: &str| {
        stack(&[], &["iga"])
            + &format!(
                "[[contact]]\nname = \"c\"\nslave = \"b0.top\"\nmethod = \"{method}\"\n\
                 rigid = {{ kind = \"half-plane\", point = [0, 1], normal = [0, -1], force = {{ y = -0.02 }} }}\n"
            )
    };
    for method in ["lagrange", "penalty", "augmented"] {
        let r = run(&case(method), &[]);
        let k = contact(&r, "c");
        assert!((k.force[1] / -0.02 - 1.0).abs() < 1e-9 && (k.pressure.max / 0.01 - 1.0).abs() < 1e-7, "{method}: {k:?}");
    }
    let found = faults(&case("nitsche"), &[]);
    assert!(found.items[0].code == "E019" && found.items[0].line.is_some(), "{:?}", found.items[0]);
}

#[test]
fn sides_may_be_lists_for_nitsche_contact() {
    // two blocks side by side on two others, glued in pairs; the joints of slaves and masters do not match
    let text = r#"
[model]
physics = "elasticity"
dimension = 2
[[material]]
name = "m"
young = 1.0
poisson = 0.3
[[patch]]
name = "a"
geometry = { kind = "box", min = [0, 0], max = [0.6, 1] }
elements = [3, 2]
[[patch]]
name = "b"
backend = "fe"
geometry = { kind = "box", min = [0.6, 0], max = [2, 1] }
elements = [4, 2]
[[patch]]
name = "c"
backend = "fe"
geometry = { kind = "box", min = [0, 1], max = [1.1, 2] }
elements = [4, 2]
[[patch]]
name = "d"
geometry = { kind = "box", min = [1.1, 1], max = [2, 2] }
elements = [3, 2]
[[interface]]
name = "low"
slave = "a.right"
master = "b.left"
[[interface]]
name = "high"
slave = "c.right"
master = "d.left"
[[boundary]]
on = ["a.left", "c.left"]
fix = ["x"]
[[boundary]]
on = ["a.bottom", "b.bottom"]
fix = ["y"]
[[boundary]]
on = ["c.top", "d.top"]
pressure = 0.01
[[contact]]
name = "pad"
slave = ["c.bottom", "d.bottom"]
master = ["a.top", "b.top"]
method = "nitsche"
"#;
    for variant in VARIANTS {
        let r = run(text, &[format!("contact.pad.variant={variant}")]);
        let k = contact(&r, "pad");
        assert!((k.force[1] / 0.02 - 1.0).abs() < 1e-10, "{variant}: {k:?}");
        assert!((k.pressure.max / 0.01 - 1.0).abs() < 1e-9 && (k.pressure.min / 0.01 - 1.0).abs() < 1e-9, "{variant}: {k:?}");
        assert!((k.area - 2.0).abs() < 1e-12 && k.kkt.gap < 1e-12);
    }
}

fn faults(text: &str, sets: &[&str]) -> Diagnostics {
    let sets: Vec<String> = sets.iter().map(|s| s.to_string()).collect();
    match read(text, &sets) {
        Err(found) => found,
        Ok(case) => case.run(&Registry::default()).expect_err("the case is wrong"),
    }
}

#[test]
fn keys_that_do_not_go_with_a_method_are_named_where_they_stand() {
    let text = sample("contact-patch").replace("name = \"pad\"", "name = \"pad\"\nmethod = \"METHOD\"\nKEY");
    let case = |method: &str, key: &str| text.replace("METHOD", method).replace("KEY", key);
    for (method, key, part) in [
        ("nitsche", "multiplier = \"p/p\"", "`multiplier` is a key of methods with a multiplier"),
        ("nitsche", "cone = \"weights\"", "`cone` is a key of methods with a multiplier"),
        ("nitsche", "integration = \"mixed\"", "mixed integration has no meaning for method = \"nitsche\""),
        ("nitsche", "factor = 0.5", "stable for factors from 1 on, found 0.5"),
        ("nitsche", "factor = 0.5\nvariant = \"incomplete\"", "stable for factors from 1 on, found 0.5"),
        ("nitsche", "tolerance = 1e-9", "`tolerance` is not a key of method = \"nitsche\""),
        ("penalty", "tolerance = 1e-9", "`tolerance` is not a key of method = \"penalty\""),
        ("penalty", "variant = \"incomplete\"", "`variant` is not a key of method = \"penalty\""),
        ("penalty", "factor = -1", "must be"),
        ("augmented", "tolerance = 1.0", "must be between 0 and 1, found 1"),
        ("augmented", "tolerance = 1e30", "must be between 0 and 1"),
        ("lagrange", "factor = 10", "`factor` is not a key of method = \"lagrange\""),
    ] {
        let found = faults(&case(method, key), &[]);
        let d = &found.items[0];
        assert_eq!(d.code, "E015", "{method} {key}: {d:?}");
        assert!(d.message.contains(part) && d.line > Some(1), "{method} {key}: {d:?}");
    }
    // what says nothing may stand
    run(&case("nitsche", "multiplier = \"auto\"\ncone = \"coefficients\"\nintegration = \"slave\""), &[]);
    // unsymmetric systems and solvers that need symmetry
    for variant in ["unsymmetric", "incomplete"] {
        let found = faults(&case("nitsche", &format!("variant = \"{variant}\"")), &["solver.constraint=condensed"]);
        assert!(found.items[0].code == "E015" && found.items[0].message.contains(variant), "{:?}", found.items[0]);
    }
}

#[test]
fn constraint_solvers_agree_for_every_method() {
    let text = cylinder_on_block(["iga", "fe"], 2);
    for (words, solver) in [(&["penalty"][..], "condensed"), (&["augmented"], "condensed"), (&["nitsche"], "uzawa")] {
        let wanted = numbers(&run(&text, &method("line", words)), "line");
        let found = run(&text, &[method("line", words), vec![format!("solver.constraint={solver}")]].concat());
        let d = difference(&numbers(&found, "line"), &wanted);
        assert!(d < 1e-8, "{words:?}: {d:e}");
    }
    // points are more than unknowns
    let found = faults(&text, &["contact.line.method=nitsche", "solver.constraint=condensed"]);
    assert!(found.items[0].code == "E015" && found.items[0].message.contains("one per point"), "{:?}", found.items[0]);
}

#[test]
fn a_body_that_contact_alone_holds_stands_or_falls_by_every_method() {
    for words in [&["penalty"][..], &["augmented"], &["nitsche"], &["nitsche", "variant=unsymmetric"]] {
        let text = stack(&["[[contact]]"], &["iga", "fe"]);
        let pressed = text.clone() + "[[boundary]]\non = \"b1.top\"\npressure = 0.01\n";
        assert!((contact(&run(&pressed, &method("j0", words)), "j0").force[1] / 0.02 - 1.0).abs() < 1e-10);
        let pulled = text + "[[boundary]]\non = \"b1.top\"\npressure = -0.01\n";
        let r = result(&pulled, &method("j0", words));
        assert_eq!((r.status, r.exit), (Status::Singular, 5), "{words:?}: {:?}", r.diagnostics);
        assert!(
            r.diagnostics[0].code == "E072" && r.diagnostics[0].message.contains("infeasible load: nothing holds body"),
            "{:?}",
            r.diagnostics
        );
    }
}

/// Half a disc on a block: where the slave is steep to the master, a length of the master faces a longer one of the slave.
fn half_disc(disc: [usize; 2], block: [usize; 2], backends: [&str; 2], size: f64) -> String {
    format!(
        "[model]\nphysics = \"elasticity\"\ndimension = 2\n[[material]]\nname = \"m\"\nyoung = 1.0\npoisson = 0.3\n\
         [[patch]]\nname = \"disc\"\nbackend = \"{}\"\n\
         geometry = {{ kind = \"annulus-sector\", center = [0, {size}], radius = [{}, {size}], angle_deg = [180, 360] }}\nelements = {disc:?}\n\
         [[patch]]\nname = \"block\"\nbackend = \"{}\"\n\
         geometry = {{ kind = \"box\", min = [{}, {}], max = [{}, 0] }}\nelements = {block:?}\n\
         [[boundary]]\non = \"block.bottom\"\nfix = [\"x\", \"y\"]\n[[boundary]]\non = \"disc.v0\"\ndirichlet = {{ x = 0, y = {} }}\n\
         [[contact]]\nname = \"c\"\nslave = \"disc.v1\"\nmaster = \"block.top\"\n",
        backends[0],
        0.3 * size,
        backends[1],
        -1.5 * size,
        -size,
        1.5 * size,
        -0.005 * size,
    )
}

// 1.1855e-3: both methods on meshes of four times as many elements, 1.1839e-3 and 1.1871e-3. Few functions lie in the zone: on the coarse
// meshes multipliers are off by 2 % themselves.
#[test]
fn a_half_disc_as_slave_is_definite_with_the_default_factor_and_presses_as_with_multipliers() {
    let mut cases = Vec::new();
    for (disc, block) in [([32, 16], [96, 24]), ([40, 12], [64, 16]), ([64, 16], [48, 16]), ([64, 24], [160, 32]), ([48, 12], [60, 12])] {
        cases.extend([["iga", "fe"], ["iga", "iga"], ["fe", "iga"]].map(|backends| (half_disc(disc, block, backends, 1.0), 1.0)));
    }
    cases.extend([1e-3, 1e3].map(|size| (half_disc([32, 16], [96, 24], ["iga", "fe"], size), size)));
    let rows: Vec<String> = cases
        .par_iter()
        .map(|(text, size)| {
            let force = contact(&run(text, &method("c", &["nitsche"])), "c").force.clone();
            let apart = force[1] / (1.1855e-3 * size) - 1.0;
            assert!(apart.abs() < 0.03 && force[0].abs() < 0.01 * force[1], "{force:?}\n{text}");
            format!("{apart:+.1e}")
        })
        .collect();
    println!("forces of half discs are off by {rows:?}");
}

#[test]
fn an_augmented_iteration_that_stops_tells_what_it_did_not_reach() {
    for size in [1.0, 1e-3, 1e4] {
        for load in ["pressure = 1.0", "dirichlet = { y = \"-0.01*L\" }"] {
            for factor in ["1e-12", "1e-9", "1e-6", "1e-3"] {
                let text = format!(
                    "[let]\nL = {size:e}\n[model]\nphysics = \"elasticity\"\ndimension = 2\n[[material]]\nname = \"m\"\nyoung = 100.0\npoisson = 0.3\n\
                     [[patch]]\nname = \"b\"\ngeometry = {{ kind = \"box\", min = [0, 0], max = [{size:e}, {size:e}] }}\nelements = [4, 4]\n\
                     [[boundary]]\non = \"b.top\"\n{load}\n[[boundary]]\non = \"b.left\"\nfix = [\"x\"]\n\
                     [[contact]]\nname = \"c\"\nslave = \"b.bottom\"\nrigid = {{ kind = \"half-plane\", point = [0, 0], normal = [0, 1] }}\n\
                     method = \"augmented\"\nfactor = {factor}\n"
                );
                let found = result(&text, &[]);
                let [fault] = &found.diagnostics[..] else { panic!("{:?}", found.diagnostics) };
                assert_eq!((found.exit, fault.code), (5, "E074"), "{fault:?}");
                let number = |before: &str| -> f64 {
                    let rest = fault.message.split_once(before).unwrap_or_else(|| panic!("{fault:?}")).1;
                    rest.split(';').next().unwrap().trim().parse().unwrap()
                };
                let (reached, wanted) = (number("relative error of "), number("; wanted "));
                assert!(reached > wanted && wanted == 1e-12, "{load} {factor}: {fault:?}");
            }
        }
    }
}
