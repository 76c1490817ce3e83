//! Half the width of a contact zone, the least gap at points, and checks that no run can decide.

use crate::common::pressed;
use faying_cli::Registry;
use faying_cli::result::{RunResult, Status};
use pressed::{contact, read, run, solve};
use rayon::prelude::*;

const HERTZ: &str = include_str!("../../../../examples/cases/hertz.toml");

fn close(found: f64, wanted: f64, share: f64, what: &str) {
    assert!((found - wanted).abs() <= share * wanted.abs(), "{what}: {found} instead of {wanted}");
}

/// Sizes of a/R; with `FAYING_HERTZ=all` thirteen of them.
fn sizes() -> Vec<f64> {
    match std::env::var("FAYING_HERTZ").is_ok_and(|v| v == "all") {
        true => (0..13).map(|k| 0.008 + 0.001 * f64::from(k)).collect(),
        false => vec![0.008, 0.0137, 0.02],
    }
}

#[test]
fn the_zone_of_hertz_ends_within_a_hundredth_of_its_half_width() {
    let mut cases = Vec::new();
    for degree in [2, 3] {
        for multiplier in ["p/p", "p/p-2"] {
            cases.extend(sizes().into_iter().map(|a| (degree, multiplier, a)));
        }
    }
    let errors: Vec<(f64, String)> = cases
        .par_iter()
        .map(|&(degree, multiplier, a)| {
            let sets = [
                format!("let.a_R={a}"),
                format!("discretization.degree={degree}"),
                format!("contact.plane.multiplier={multiplier}"),
                "contact.plane.active_set.max_iterations=60".into(),
            ];
            let sets: Vec<&str> = sets.iter().map(String::as_str).collect();
            let result = solve(HERTZ, &sets);
            let error = contact(&result, "plane").half_width.unwrap() / a - 1.0;
            println!("degree {degree} {multiplier} a/R {a}: {:.2} %", 100.0 * error);
            (error.abs(), format!("degree {degree} {multiplier} a/R {a}"))
        })
        .collect();
    let worst = errors.iter().max_by(|a, b| a.0.total_cmp(&b.0)).unwrap();
    assert!(worst.0 < 0.01, "{} of {}: {worst:?}", errors.iter().filter(|e| e.0 >= 0.01).count(), errors.len());
}

#[test]
fn only_half_models_go_on_beyond_the_end_of_their_side() {
    let coarse = ["patch.cylinder.elements=[40, 24]", "check.half-width.rtol=0.03"];
    let of = |more: &[&str]| {
        // the check asks for all of it
        let result = read(HERTZ, &[more, coarse.as_slice()].concat()).run(&Registry::default()).unwrap();
        let found = contact(&result, "plane");
        (found.half_width.unwrap(), found.reason.clone().unwrap_or_default())
    };
    let all = of(&["contact.plane.symmetry=true"]).0;
    assert!(all > 0.0);
    // the end of the side does not move along it: half of a whole, or all of one that ends there
    let (none, reason) = of(&["contact.plane.symmetry=false"]);
    assert!(none.is_nan() && reason.contains("does not move along it") && reason.contains("symmetry"), "{none} {reason}");
    // a zone inside its side has half its extent either way
    for backend in ["iga", "fe"] {
        let [one, other] = [true, false].map(|symmetry| contact(&ball(backend, 0.1, 1.0, symmetry), "c").half_width.unwrap());
        assert_eq!(one, other, "{backend}");
    }
}

/// A ball of revolution on a plane, after Hertz: a zone that ends on the axis goes on beyond it, whatever the case says.
#[test]
fn a_zone_goes_on_beyond_the_axis_of_revolution() {
    let text = "[let]\nF = 1000.0\nEs = \"210e3/(1 - 0.3^2)\"\na = \"(3*F*10/(4*Es))^(1/3)\"\n[model]\nphysics = \"elasticity\"\ndimension = 2\n\
        assumption = \"axisymmetric\"\n[discretization]\ndegree = 2\n[[material]]\nname = \"m\"\nyoung = 210e3\npoisson = 0.3\n[[patch]]\nname = \"k\"\n\
        geometry = { kind = \"annulus-sector\", center = [0, 10], radius = [1, 10], angle_deg = [-90, 0] }\nelements = [32, 24]\n\
        grade = { toward = { u = 0.0, v = 1.0 }, ratio = 0.03 }\n[[boundary]]\non = \"k.u0\"\nfix = [\"x\"]\n[[boundary]]\non = \"k.u1\"\n\
        rigid_force = { y = \"-F\" }\n[[contact]]\nname = \"c\"\nslave = \"k.v1\"\nrigid = { kind = \"half-plane\", point = [0, 0], normal = [0, 1] }\n\
        [[check]]\nquantity = \"contact.c.half_width\"\nequals = \"a\"\nrtol = 0.02\n";
    for set in ["contact.c.symmetry=false", "contact.c.symmetry=true"] {
        let result = read(text, &[set]).run(&Registry::default()).unwrap();
        assert_eq!(result.exit, 0, "{set}: {:?}", result.checks);
    }
}

/// A block under a rigid circle around x = `middle` that is pressed in; what is symmetric stays so.
fn ball(backend: &str, middle: f64, length: f64, symmetry: bool) -> RunResult {
    let l = |x: f64| format!("{:.17e}", x * length);
    run(
        &format!(
            "[model]\nphysics = \"elasticity\"\ndimension = 2\n[discretization]\nbackend = \"{backend}\"\ndegree = 2\n\
             [[material]]\nname = \"m\"\nyoung = 1.0\npoisson = 0.3\n\
             [[patch]]\nname = \"b\"\ngeometry = {{ kind = \"box\", min = [{}, {}], max = [{}, 0] }}\nelements = [401, 24]\n\
             [[boundary]]\non = \"b.bottom\"\nfix = [\"x\", \"y\"]\n\
             [[contact]]\nname = \"c\"\nslave = \"b.top\"\nsymmetry = {symmetry}\n\
             rigid = {{ kind = \"sphere\", center = [{}, {}], radius = {} }}\n",
            l(-1.0),
            l(-1.0),
            l(1.0),
            l(middle),
            l(0.985),
            l(1.0)
        ),
        &[],
        length,
    )
}

#[test]
fn a_zone_moves_with_what_presses_it_and_scales_with_its_length() {
    // far from the ends of the side: where the zone lies between two elements does not count
    for backend in ["iga", "fe"] {
        let widths: Vec<f64> = (0..6).map(|k| contact(&ball(backend, 0.01 * f64::from(k), 1.0, false), "c").half_width.unwrap()).collect();
        let (least, most) = widths.iter().fold((f64::INFINITY, 0.0f64), |(l, m), w| (l.min(*w), m.max(*w)));
        println!("{backend}: {widths:?}");
        assert!(most / least < 1.02, "{backend}: {widths:?}");
        let large = contact(&ball(backend, 0.02, 1e6, false), "c").half_width.unwrap();
        close(large, 1e6 * widths[2], 1e-8, backend);
    }
}

#[test]
fn a_zone_ends_where_its_side_does_and_at_the_rim_of_what_it_faces() {
    // a block on a plane; and on a block that ends at x = 0.63, within an element
    for backend in ["iga", "fe"] {
        for multiplier in ["p/p", "p/p-2"] {
            let case = |more: &str, opponent: &str| {
                format!(
                    "[model]\nphysics = \"elasticity\"\ndimension = 2\n[discretization]\nbackend = \"{backend}\"\ndegree = 2\n\
                     [[material]]\nname = \"m\"\nyoung = 1.0\npoisson = 0.3\n\
                     [[patch]]\nname = \"b\"\ngeometry = {{ kind = \"box\", min = [0, 0], max = [1, 1] }}\nelements = [10, 10]\n{more}\
                     [[boundary]]\non = \"b.top\"\ndirichlet = [\"0\", \"-0.01\"]\n\
                     [[contact]]\nname = \"c\"\nslave = \"b.bottom\"\nmultiplier = \"{multiplier}\"\n{opponent}\n"
                )
            };
            let plane = case("", "rigid = { kind = \"half-plane\", point = [0, 0], normal = [0, 1] }");
            let below = "[[patch]]\nname = \"a\"\ngeometry = { kind = \"box\", min = [0, -1], max = [0.63, 0] }\nelements = [6, 8]\n\
                         [[boundary]]\non = \"a.bottom\"\nfix = [\"x\", \"y\"]\n";
            for (text, wanted) in [(plane, 0.5), (case(below, "master = \"a.top\""), 0.315)] {
                let result = solve(&text, &[]);
                close(contact(&result, "c").half_width.unwrap(), wanted, 1e-12, &format!("{backend} {multiplier} {wanted}"));
            }
        }
    }
}

#[test]
fn the_least_gap_is_that_of_a_point() {
    // nothing touches: the gap is its formula, less what the top moves down
    let h = 0.25;
    let first = h * 0.5 * (1.0 - 0.6f64.sqrt());
    for backend in ["iga", "fe"] {
        for (method, lumped) in [("lagrange", h * h / 3.0), ("nitsche", first * first)] {
            let text = format!(
                "[model]\nphysics = \"elasticity\"\ndimension = 2\n[discretization]\nbackend = \"{backend}\"\ndegree = 2\n\
                 [[material]]\nname = \"m\"\nyoung = 1.0\npoisson = 0.3\n\
                 [[patch]]\nname = \"b\"\ngeometry = {{ kind = \"box\", min = [0, 0], max = [1, 1] }}\nelements = [4, 2]\n\
                 [[boundary]]\non = \"b.top\"\ndirichlet = [\"0\", \"-0.0004\"]\n[[boundary]]\non = [\"b.left\", \"b.right\"]\nfix = [\"x\"]\n\
                 [[contact]]\nname = \"c\"\nslave = \"b.bottom\"\nmethod = \"{method}\"\ngap = \"g + 0.001 + x^2\"\n\
                 rigid = {{ kind = \"half-plane\", point = [0, 0], normal = [0, 1] }}\n"
            );
            let result = solve(&text, &[]);
            let gap = contact(&result, "c").gap;
            close(gap.least, 0.0006 + first * first, 1e-11, &format!("{backend} {method}"));
            close(gap.min, 0.0006 + lumped, 1e-11, &format!("{backend} {method}"));
        }
        // an obstacle that a force presses has come to the side
        let text = format!(
            "[model]\nphysics = \"elasticity\"\ndimension = 2\n[discretization]\nbackend = \"{backend}\"\ndegree = 2\n\
             [[material]]\nname = \"m\"\nyoung = 1.0\npoisson = 0.3\n\
             [[patch]]\nname = \"b\"\ngeometry = {{ kind = \"box\", min = [0, 0], max = [1, 1] }}\nelements = [4, 2]\n\
             [[boundary]]\non = \"b.bottom\"\nfix = [\"y\"]\n[[boundary]]\non = [\"b.left\", \"b.right\"]\nfix = [\"x\"]\n\
             [[contact]]\nname = \"c\"\nslave = \"b.top\"\n\
             rigid = {{ kind = \"half-plane\", point = [0, 1.5], normal = [0, -1], force = {{ y = -0.01 }} }}\n"
        );
        let gap = contact(&run(&text, &[], 1.0), "c").gap;
        assert!(gap.least.abs() < 1e-12 && gap.min.abs() < 1e-12, "{backend}: {gap:?}");
    }
}

#[test]
fn a_rate_that_no_study_finds_fails_in_a_run() {
    let text = "[model]\nphysics = \"poisson\"\ndimension = 2\nexact = { u = \"x^3\" }\n\
                [[patch]]\nname = \"a\"\ngeometry = { kind = \"box\", min = [0, 0], max = [1, 1] }\nelements = [2, 2]\n\
                [[boundary]]\non = \"all-outer\"\ndirichlet = \"exact\"\n\
                [[check]]\nname = \"order\"\nquantity = \"rate.error.u.L2\"\nabove = 1\n";
    let result = read(text, &[]).run(&Registry::default()).unwrap();
    let check = &result.checks[0];
    assert_eq!((result.status, result.exit, check.ok, check.skipped), (Status::CheckFailed, 1, false, false));
    let reason = check.reason.as_deref().unwrap();
    assert!(reason.contains("studies") && reason.contains("faying convergence"), "{reason}");
    assert!(check.value.is_nan());
}

const PLANE: &str = "[model]\nphysics = \"elasticity\"\ndimension = 2\n[[material]]\nname = \"m\"\nyoung = 1000\npoisson = 0.3\n";

/// Half of a half-plane under half an obstacle that a force presses.
fn pressed_half_plane(obstacle: &str, [nx, ny]: [usize; 2], force: f64) -> String {
    format!(
        "{PLANE}[[patch]]\nname = \"half\"\ngeometry = {{ kind = \"box\", min = [0, -60], max = [60, 0] }}\nelements = [{nx}, {ny}]\n\
         grade = {{ toward = {{ u = 0, v = 1 }}, ratio = 0.05 }}\n[[boundary]]\non = \"half.left\"\nfix = [\"x\"]\n\
         [[boundary]]\non = \"half.bottom\"\nfix = [\"y\"]\n[[contact]]\nname = \"c\"\nslave = \"half.top\"\nsymmetry = true\n\
         rigid = {{ kind = \"level-set\", f = \"{obstacle} - y\", along = [0, -1], force = {{ y = {:?} }} }}\n",
        -0.5 * force
    )
}

/// A layer on a rigid plane, pressed around x = 0: it leaves the plane farther out.
fn receding_layer([nx, ny]: [usize; 2]) -> String {
    format!(
        "{PLANE}[[patch]]\nname = \"a\"\ngeometry = {{ kind = \"box\", min = [0, 0], max = [6, 1] }}\nelements = [{nx}, {ny}]\n\
         [[boundary]]\non = \"a.left\"\nfix = [\"x\"]\n[[boundary]]\non = \"a.top\"\ntraction = {{ y = \"-exp(-(x/0.3)^2)\" }}\n\
         [[contact]]\nname = \"c\"\nslave = \"a.bottom\"\nrigid = {{ kind = \"half-plane\", point = [0, 0], normal = [0, 1] }}\nsymmetry = true\n"
    )
}

/// Half the width of the zone of a flat punch of half width 1 with corners of radius 20 (Ciavarella, Int. J. Solids Struct. 35, 1998).
fn rounded_punch(force: f64, modulus: f64) -> f64 {
    let load = |b: f64| {
        let (from, n) = ((1.0 / b).asin(), 20_000);
        let step = (0.5 * std::f64::consts::PI - from) / f64::from(n);
        let part = |k: i32| {
            let t = from + (f64::from(k) + 0.5) * step;
            (b * t.sin() - 1.0) * b * t.sin() * step
        };
        modulus / 20.0 * (0..n).map(part).sum::<f64>()
    };
    let (mut low, mut high) = (1.0, 100.0);
    for _ in 0..60 {
        let b = 0.5 * (low + high);
        if load(b) < force { low = b } else { high = b }
    }
    low
}

/// Zones on several meshes, each with its half width: within 1 % where there is one; how many there are at least.
fn within_a_hundredth(what: &str, cases: Vec<(String, f64)>, least: usize) {
    let found: Vec<(f64, Option<String>)> = cases
        .par_iter()
        .map(|(text, wanted)| {
            let result = solve(text, &[]);
            let c = contact(&result, "c");
            (c.half_width.unwrap() / wanted - 1.0, c.reason.clone())
        })
        .collect();
    let shown: Vec<String> = found.iter().map(|(e, why)| why.clone().map_or(format!("{:.2} %", 100.0 * e), |_| "-".into())).collect();
    println!("{what}: {shown:?}");
    for (error, reason) in &found {
        assert!(error.is_nan() == reason.is_some(), "{what}: {error} {reason:?}");
        assert!(error.is_nan() || error.abs() < 0.01, "{what}: {shown:?}");
        assert!(reason.as_ref().is_none_or(|why| why.contains("half_width") && why.contains("refine")), "{reason:?}");
    }
    assert!(found.iter().filter(|f| !f.0.is_nan()).count() >= least, "{what}: {shown:?}");
}

/// With `FAYING_HERTZ=all` every problem on every space.
#[test]
fn zones_of_wedges_rounded_punches_and_receding_layers_end_within_a_hundredth() {
    let modulus = 1000.0 / (1.0 - 0.09);
    let meshes = [[50, 24], [60, 30], [70, 30], [80, 40], [90, 40], [100, 50], [120, 50]];
    let degrees = ["", "[discretization]\ndegree = 3\n", "[discretization]\nbackend = \"fe\"\ndegree = 2\n"];
    for (k, more) in degrees.into_iter().enumerate() {
        let takes = |problem: usize| problem == k || std::env::var("FAYING_HERTZ").is_ok_and(|v| v == "all");
        let wedges = meshes.iter().flat_map(|n| [14.0, 20.0, 27.0].map(|p| (p, *n)));
        let wedge = |(p, n): (f64, [usize; 2])| (pressed_half_plane("0.02*abs(x)", n, p) + more, p / (modulus * 0.02));
        if takes(0) {
            within_a_hundredth(&format!("wedge {more}"), wedges.map(wedge).collect(), 8);
        }
        let punches = [[80, 40], [120, 50], [140, 50], [180, 50], [220, 60]].into_iter().flat_map(|n| [20.0, 40.0, 80.0].map(|p| (p, n)));
        let punch = |(p, n): (f64, [usize; 2])| (pressed_half_plane("max(0, x - 1)^2/40", n, p) + more, rounded_punch(p, modulus));
        if takes(1) {
            within_a_hundredth(&format!("punch {more}"), punches.map(punch).collect(), 7);
        }
        if !takes(2) {
            continue;
        }
        let fine = contact(&solve(&(receding_layer([600, 30]) + more), &[]), "c").half_width.unwrap();
        let layers = [[50, 8], [60, 12], [70, 10], [80, 12], [100, 12], [120, 16], [160, 16], [200, 20]];
        within_a_hundredth(&format!("layer {more}"), layers.map(|n| (receding_layer(n) + more, fine)).to_vec(), 4);
    }
}

#[test]
fn a_half_width_that_the_pressure_does_not_tell_is_null_with_a_reason() {
    // three elements between the corner of the punch and the end of its zone
    let text = pressed_half_plane("max(0, x - 1)^2/40", [80, 40], 10.0)
        + "[[probe]]\nname = \"b\"\nquantity = \"contact.c.half_width\"\n[[check]]\nquantity = \"contact.c.half_width\"\nabove = 0\n";
    let result = read(&text, &[]).run(&Registry::default()).unwrap();
    let document: serde_json::Value = serde_json::from_str(&result.to_json()).unwrap();
    let c = &document["contact"]["c"];
    assert!(c["half_width"].is_null() && c["area"].as_f64().unwrap() > 0.0 && c["active"].as_u64().unwrap() > 0, "{c}");
    for reason in [&c["reason"], &document["probes"][0]["reason"], &document["checks"][0]["reason"]] {
        assert!(reason.as_str().unwrap().contains("elements that are pressed"), "{reason}");
    }
    assert_eq!((result.status, result.checks[0].ok), (Status::CheckFailed, false));
}
