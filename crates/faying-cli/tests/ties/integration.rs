//! Slave, mixed and merged integration in cases: where each is exact, masters that are longer or in a row, what a result says.

use faying_cli::Case;
use faying_cli::case::ReadOptions;
use faying_cli::{Registry, RunResult, Status};

fn run(text: &str) -> RunResult {
    let case = Case::parse("case.toml", text, &ReadOptions::default()).unwrap_or_else(|e| panic!("{e}\n{text}"));
    case.run(&Registry::default()).unwrap_or_else(|e| panic!("{e}\n{text}"))
}

/// A patch: name, corners, elements along x.
type Box2 = (&'static str, [f64; 4], usize);

/// Boxes of elasticity under a linear displacement that all sides outside of interfaces prescribe.
fn boxes(patches: &[Box2], backends: [&str; 2], degree: usize, interfaces: &str) -> String {
    let mut text = "[model]\nphysics = \"elasticity\"\ndimension = 2\nexact = { u = [\"0.1 + 0.3*x - 0.2*y\", \"0.2 + 0.5*x + 0.4*y\"] }\n\
        [[material]]\nname = \"m\"\nyoung = 1.0\npoisson = 0.3\n"
        .to_owned();
    for &(name, [x0, y0, x1, y1], n) in patches {
        let backend = backends[usize::from(y0 > 0.0)];
        let cells = if backend == "simplex" { "cells = \"simplex\"\n" } else { "" };
        let backend = if backend == "simplex" { "fe" } else { backend };
        text += &format!(
            "[[patch]]\nname = \"{name}\"\ngeometry = {{ kind = \"box\", min = [{x0}, {y0}], max = [{x1}, {y1}] }}\nelements = [{n}, 2]\n\
             degree = {degree}\nbackend = \"{backend}\"\n{cells}"
        );
    }
    text + "[[boundary]]\non = \"all-outer\"\ndirichlet = \"exact\"\n"
        + interfaces
        + "[[check]]\nname = \"u\"\nquantity = \"error.u.L2\"\nbelow = 1e-12\n[[check]]\nname = \"lambda\"\nquantity = \"error.lambda.L2\"\nbelow = 1e-10\n"
}

fn passes(text: &str, what: &str) -> RunResult {
    let result = run(text);
    assert_eq!(result.status, Status::Ok, "{what}: {:?} {:?}\n{text}", result.checks, result.diagnostics);
    for (name, i) in result.interface.iter() {
        assert!(i.balance < 1e-12, "{what}: forces on {name} differ by {:e}", i.balance);
        assert!(i.consistency < 1e-11, "{what}: consistency of {name} {:e}", i.consistency);
    }
    result
}

const BACKENDS: [[&str; 2]; 5] = [["iga", "iga"], ["iga", "fe"], ["fe", "iga"], ["fe", "fe"], ["simplex", "iga"]];

fn interface(name: &str, slave: &str, master: &str, multiplier: &str, integration: &str) -> String {
    format!(
        "[[interface]]\nname = \"{name}\"\nslave = {slave}\nmaster = {master}\nmultiplier = \"{multiplier}\"\nintegration = \"{integration}\"\n"
    )
}

fn multipliers(degree: usize) -> &'static [&'static str] {
    if degree == 1 { &["p/p"] } else { &["p/p", "p/p-2"] }
}

// Three slaves share a master that is longer than each; their ends lie inside master elements.
#[test]
fn masters_longer_than_their_slaves_keep_the_patch_test_in_mixed_and_merged_integration() {
    let patches: [Box2; 4] =
        [("a", [0.0, 0.0, 3.0, 1.0], 7), ("b", [0.0, 1.0, 0.9, 2.0], 3), ("c", [0.9, 1.0, 2.2, 2.0], 5), ("d", [2.2, 1.0, 3.0, 2.0], 2)];
    for backends in BACKENDS {
        for degree in [1, 2, 3] {
            for multiplier in multipliers(degree) {
                for integration in ["merged", "mixed"] {
                    let ties: String = ["b", "c", "d"]
                        .iter()
                        .map(|s| interface(&format!("i{s}"), &format!("\"{s}.bottom\""), "\"a.top\"", multiplier, integration))
                        .collect();
                    passes(&boxes(&patches, backends, degree, &ties), &format!("{backends:?} {degree} {multiplier} {integration}"));
                }
            }
        }
    }
}

// A T-junction whose foot lies inside a slave element.
#[test]
fn masters_in_a_row_keep_the_patch_test_in_mixed_and_merged_integration() {
    let patches: [Box2; 3] = [("a", [0.0, 0.0, 1.3, 1.0], 3), ("b", [1.3, 0.0, 3.0, 1.0], 4), ("c", [0.0, 1.0, 3.0, 2.0], 5)];
    for backends in BACKENDS {
        for degree in [1, 2, 3] {
            for multiplier in multipliers(degree) {
                for integration in ["merged", "mixed"] {
                    let tie = interface("h", "\"c.bottom\"", "[\"a.top\", \"b.top\"]", multiplier, integration);
                    let what = format!("{backends:?} {degree} {multiplier} {integration}");
                    let result = passes(&boxes(&patches, backends, degree, &tie), &what);
                    assert!((result.interface.get("h").unwrap().segments.measure - 3.0).abs() < 1e-12, "{what}");
                }
            }
        }
    }
}

// The slave's rule is exact where the slave's knots contain the master's; elsewhere only mixed and merged are.
#[test]
fn slave_integration_keeps_the_patch_test_where_the_slaves_knots_contain_the_masters() {
    for backends in BACKENDS {
        for degree in [1, 2, 3] {
            for multiplier in multipliers(degree) {
                let of = |upper: usize, integration: &str| {
                    let patches: [Box2; 2] = [("a", [0.0, 0.0, 1.0, 0.5], 3), ("c", [0.0, 0.5, 1.0, 1.0], upper)];
                    boxes(&patches, backends, degree, &interface("h", "\"c.v0\"", "\"a.v1\"", multiplier, integration))
                };
                let what = format!("{backends:?} {degree} {multiplier}");
                passes(&of(6, "slave"), &what);
                passes(&of(6, "mixed"), &what);
                passes(&of(5, "mixed"), &what);
                passes(&of(5, "merged"), &what);
                let missed = run(&of(5, "slave"));
                assert_eq!(missed.status, Status::CheckFailed, "{what}: knots that differ are not integrated exactly");
                assert!(missed.interface.get("h").unwrap().consistency > 1e-8, "{what}");
            }
        }
    }
}

/// Poisson on two squares above each other with a smooth solution; 3 elements face 2.
fn smooth(backend: &str, integration: &str, extra: usize) -> String {
    format!(
        "[model]\nphysics = \"poisson\"\ndimension = 2\nexact = {{ u = \"cos(3*x + 0.3)*exp(y) + sin(2*pi*x*y)\" }}\n[[material]]\nname = \"m\"\n\
         [discretization]\nbackend = \"{backend}\"\ndegree = 3\n\
         [[patch]]\nname = \"a\"\ngeometry = {{ kind = \"box\", min = [0, 0], max = [1, 0.5] }}\nelements = [12, 6]\n\
         [[patch]]\nname = \"b\"\ngeometry = {{ kind = \"box\", min = [0, 0.5], max = [1, 1] }}\nelements = [8, 4]\n\
         [[boundary]]\non = \"all-outer\"\ndirichlet = \"exact\"\n\
         [[interface]]\nname = \"i\"\nslave = \"a.top\"\nmaster = \"b.bottom\"\nmultiplier = \"p/p\"\nintegration = \"{integration}\"\nextra_points = {extra}\n\
         [[check]]\nname = \"u\"\nquantity = \"error.u.L2\"\nbelow = 1\n[[check]]\nname = \"c\"\nquantity = \"interface.i.consistency\"\nbelow = 1\n"
    )
}

#[test]
fn the_consistency_error_is_zero_where_integration_is_exact_and_falls_with_points_elsewhere() {
    for backend in ["iga", "fe"] {
        let estimate = |integration: &str, extra: usize| {
            let result = run(&smooth(backend, integration, extra));
            assert_eq!(result.status, Status::Ok, "{:?}", result.checks);
            // the quantity is the number by its path
            assert_eq!(result.checks[1].value, result.interface.get("i").unwrap().consistency);
            result.checks[1].value
        };
        let merged = estimate("merged", 0);
        assert!(merged < 1e-13, "{backend}: merged integration of piecewise polynomials is exact: {merged:e}");
        let slave: Vec<f64> = [0, 2, 10, 40].map(|extra| estimate("slave", extra)).to_vec();
        eprintln!("{backend}: merged {merged:.1e}, slave with 0, 2, 10, 40 points more {slave:?}, mixed {:.2e}", estimate("mixed", 0));
        assert!(slave[0] > 1e-5 && slave.windows(2).all(|w| w[1] < w[0]) && slave[3] < 0.05 * slave[0], "{backend}: {slave:?}");
        // mixed sums are the slave's in the constraint and the master's in the equilibrium: neither is exact
        let mixed = estimate("mixed", 0);
        assert!(mixed > 1e-7, "{backend}: {mixed:e}");
    }
}

// On curved sides no rule is exact; the estimate falls fast with the points of merged integration.
#[test]
fn the_consistency_error_of_merged_integration_falls_on_a_curved_interface() {
    let of = |extra: usize| {
        run(&format!(
            "[model]\nphysics = \"poisson\"\ndimension = 2\nexact = {{ u = \"x^2 - y^2 + x\" }}\n[[material]]\nname = \"m\"\n\
             [discretization]\ndegree = 2\n\
             [[patch]]\nname = \"a\"\ngeometry = {{ kind = \"annulus-sector\", center = [0, 0], radius = [1, 1.5], angle_deg = [0, 90] }}\nelements = [3, 2]\n\
             [[patch]]\nname = \"b\"\ngeometry = {{ kind = \"annulus-sector\", center = [0, 0], radius = [1.5, 2], angle_deg = [0, 90] }}\nelements = [4, 2]\n\
             [[boundary]]\non = \"all-outer\"\ndirichlet = \"exact\"\n\
             [[interface]]\nname = \"i\"\nslave = \"a.v1\"\nmaster = \"b.v0\"\nextra_points = {extra}\n"
        ))
        .interface
        .get("i")
        .unwrap()
        .consistency
    };
    let found = [0, 1, 2, 4].map(of);
    assert!(found[0] > 1e-10 && found[1] < 0.1 * found[0] && found[2] < 0.1 * found[1] && found[3] < 1e-10, "{found:?}");
}

// A slave side that is covered in part is refused by every integration, wherever its points lie.
#[test]
fn partly_covered_slaves_are_refused_by_every_integration() {
    for integration in ["merged", "slave", "mixed"] {
        let patches: [Box2; 2] = [("a", [0.0, 0.0, 0.995, 1.0], 3), ("c", [0.0, 1.0, 1.0, 2.0], 2)];
        let text = boxes(&patches, ["iga", "fe"], 2, &interface("h", "\"c.bottom\"", "\"a.top\"", "p/p", integration));
        let error = Case::parse("case.toml", &text, &ReadOptions::default()).unwrap().run(&Registry::default()).unwrap_err();
        let first = error.to_string();
        assert!(first.contains("E025") && first.contains("99.5 %") || first.contains("99.4999"), "{integration}: {first}");
    }
}

// Contact takes the slave's points; a pressed stack of boxes stays a patch test where knots nest.
#[test]
fn contact_between_sides_takes_slave_integration() {
    let text = |integration: &str, upper: usize| {
        format!(
            "[model]\nphysics = \"elasticity\"\ndimension = 2\n[[material]]\nname = \"m\"\nyoung = 1.0\npoisson = 0.3\n[discretization]\ndegree = 2\n\
             [[patch]]\nname = \"a\"\ngeometry = {{ kind = \"box\", min = [0, 0], max = [1, 0.5] }}\nelements = [3, 2]\n\
             [[patch]]\nname = \"b\"\ngeometry = {{ kind = \"box\", min = [0, 0.5], max = [1, 1] }}\nelements = [{upper}, 2]\nbackend = \"fe\"\n\
             [[boundary]]\non = [\"a.left\", \"b.left\"]\nfix = [\"x\"]\n[[boundary]]\non = \"a.bottom\"\nfix = [\"y\"]\n\
             [[boundary]]\non = \"b.top\"\npressure = 0.01\n\
             [[contact]]\nname = \"c\"\nslave = \"b.bottom\"\nmaster = \"a.top\"\nintegration = \"{integration}\"\n"
        )
    };
    for upper in [3, 6] {
        let result = run(&text("slave", upper));
        let pressure = &result.contact.get("c").unwrap().pressure;
        assert!((pressure.min - 0.01).abs() < 1e-12 && (pressure.max - 0.01).abs() < 1e-12, "{upper}: {pressure:?}");
    }
    let (slave, merged) = (run(&text("slave", 5)), run(&text("merged", 5)));
    let spread = |r: &RunResult| r.contact.get("c").unwrap().pressure.max - r.contact.get("c").unwrap().pressure.min;
    assert!(spread(&merged) < 1e-12 && spread(&slave) > 1e-6, "{:e} {:e}", spread(&merged), spread(&slave));
}
