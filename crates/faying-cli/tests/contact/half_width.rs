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
            let error = contact(&result, "plane").half_width / a - 1.0;
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
    let [all, half] = [true, false].map(|symmetry| {
        let word = format!("contact.plane.symmetry={symmetry}");
        // the check asks for all of it
        let result = read(HERTZ, &[&[word.as_str()], coarse.as_slice()].concat()).run(&Registry::default()).unwrap();
        contact(&result, "plane").half_width
    });
    assert_eq!(all, 2.0 * half);
    // a zone inside its side has half its extent either way
    for backend in ["iga", "fe"] {
        let [one, other] = [true, false].map(|symmetry| contact(&ball(backend, 0.1, 1.0, symmetry), "c").half_width);
        assert_eq!(one, other, "{backend}");
    }
}

/// A block under a rigid circle around x = `middle` that is pressed in; what is symmetric stays so.
fn ball(backend: &str, middle: f64, length: f64, symmetry: bool) -> RunResult {
    let l = |x: f64| format!("{:.17e}", x * length);
    run(
        &format!(
            "[model]\nphysics = \"elasticity\"\ndimension = 2\n[discretization]\nbackend = \"{backend}\"\ndegree = 2\n\
             [[material]]\nname = \"m\"\nyoung = 1.0\npoisson = 0.3\n\
             [[patch]]\nname = \"b\"\ngeometry = {{ kind = \"box\", min = [{}, {}], max = [{}, 0] }}\nelements = [101, 24]\n\
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
        let widths: Vec<f64> = (0..6).map(|k| contact(&ball(backend, 0.01 * f64::from(k), 1.0, false), "c").half_width).collect();
        let (least, most) = widths.iter().fold((f64::INFINITY, 0.0f64), |(l, m), w| (l.min(*w), m.max(*w)));
        println!("{backend}: {widths:?}");
        assert!(most / least < 1.03, "{backend}: {widths:?}");
        let large = contact(&ball(backend, 0.02, 1e6, false), "c").half_width;
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
                close(contact(&result, "c").half_width, wanted, 1e-12, &format!("{backend} {multiplier} {wanted}"));
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
