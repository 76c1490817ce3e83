//! Contact sides that a support holds along the normal in part, sides that touch without load, and loads near the end of a side.

use faying_cli::Case;
use faying_cli::case::ReadOptions;
use faying_cli::{Registry, RunResult, Status};

fn run(text: &str) -> RunResult {
    let case = Case::parse("case.toml", text, &ReadOptions::default()).unwrap_or_else(|e| panic!("{e}\n{text}"));
    case.run(&Registry::default()).unwrap_or_else(|e| panic!("{e}\n{text}"))
}

fn said(result: &RunResult) -> String {
    result.diagnostics.iter().map(|d| d.render()).collect()
}

fn model(backend: &str, degree: usize) -> String {
    format!(
        "[model]\nphysics = \"elasticity\"\ndimension = 2\n[discretization]\nbackend = \"{backend}\"\ndegree = {degree}\n\
         [[material]]\nname = \"m\"\nyoung = 1.0\npoisson = 0.3\n"
    )
}

/// A block whose lower side is held along y where `held`, pressed on a plane or on a block.
fn block(backend: &str, degree: usize, held: &str, rule: &str, rigid: bool, elements: usize) -> String {
    let opponent = if rigid {
        "rigid = { kind = \"half-plane\", point = [0, 0.5], normal = [0, 1] }".to_owned()
    } else {
        "master = \"a.top\"".to_owned()
    };
    let below = if rigid {
        String::new()
    } else {
        format!(
            "[[patch]]\nname = \"a\"\ngeometry = {{ kind = \"box\", min = [0, 0], max = [1, 0.5] }}\nelements = [{}, 3]\n\
             [[boundary]]\non = \"a.bottom\"\nfix = [\"x\", \"y\"]\n",
            elements * 7 / 5
        )
    };
    format!(
        "{}[[patch]]\nname = \"b\"\ngeometry = {{ kind = \"box\", min = [0, 0.5], max = [1, 1] }}\nelements = [{elements}, 3]\n{below}\
         [[boundary]]\non = \"b.bottom\"\nwhere = \"{held}\"\nfix = [\"y\"]\n[[boundary]]\non = \"b.left\"\nfix = [\"x\"]\n\
         [[boundary]]\non = \"b.top\"\ntraction = {{ y = \"-1e-3\" }}\n[[contact]]\nname = \"c\"\nslave = \"b.bottom\"\n{opponent}\n{rule}\n",
        model(backend, degree)
    )
}

const HELD: [&str; 3] = ["x < 0.3", "x > 0.8", "abs(x - 0.5) < 0.2"];

fn solved(text: &str) -> RunResult {
    let result = run(text);
    assert_eq!(result.status, Status::Ok, "{}\n{text}", said(&result));
    assert!(result.balance.force.iter().all(|f| f.abs() < 1e-12), "{:?}", result.balance);
    result
}

// A uniform state: the plane presses what is free, the support what is held, and u is in every space.
#[test]
fn a_side_held_along_its_normal_in_part_passes_the_patch_test_on_a_plane() {
    // what is held, what is free, and the number of places where they meet
    for (held, (free, edges)) in HELD.into_iter().zip([(0.7, 1.0), (0.8, 1.0), (0.6, 2.0)]) {
        for backend in ["iga", "fe"] {
            for degree in [1, 2, 3] {
                for multiplier in ["auto", "p/p", "constant"] {
                    let text = block(backend, degree, held, &format!("multiplier = \"{multiplier}\""), true, 20)
                        + "[[probe]]\nname = \"top\"\nquantity = \"u.y at [0.4, 1] in b\"\n";
                    let result = solved(&text);
                    let (what, contact) = (format!("{held} {backend} {degree} {multiplier}"), result.contact.get("c").unwrap());
                    assert!((result.probes[0].value / (-1e-3 * 0.91 * 0.5) - 1.0).abs() < 1e-9, "{what}: {}", result.probes[0].value);
                    // functions that reach into what is held take their share of it
                    let share = contact.force[1] / 1e-3;
                    assert!((share - free).abs() < edges * 0.5 * 0.05 * degree as f64 + 1e-9, "{what}: {share} of {free}");
                }
            }
        }
    }
}

// Displacements: the pressure is singular where the support ends, and who takes the force of that place is a matter of the functions there.
#[test]
fn a_side_held_along_its_normal_in_part_moves_as_on_a_finer_mesh() {
    for held in HELD {
        let moved = |backend: &str, degree: usize, multiplier: &str, elements: usize| {
            let text = block(backend, degree, held, &format!("multiplier = \"{multiplier}\""), false, elements)
                + "[[probe]]\nname = \"top\"\nquantity = \"u.y at [0.7, 1] in b\"\n";
            solved(&text).probes[0].value
        };
        let fine = moved("iga", 2, "auto", 160);
        for backend in ["iga", "fe"] {
            for degree in [1, 2, 3] {
                for multiplier in ["auto", "p/p", "constant"] {
                    let apart = moved(backend, degree, multiplier, 40) / fine - 1.0;
                    assert!(apart.abs() < 0.02, "{held} {backend} {degree} {multiplier}: {apart:+.1e}");
                }
            }
        }
    }
}

#[test]
fn curved_sides_that_touch_without_load_are_at_rest() {
    for (backend, center, size) in
        [("iga", [0.0, 0.0], 1.0), ("fe", [0.1, 0.3], 1.0), ("fe", [0.0, 0.0], 1e-3), ("iga", [10.0, 0.33], 0.37)]
    {
        for (inner, outer) in [(8, 8), (21, 10), (64, 64), (120, 77), (200, 301)] {
            let ring = |name: &str, radii: [f64; 2], n: usize| {
                format!(
                    "[[patch]]\nname = \"{name}\"\ngeometry = {{ kind = \"annulus-sector\", center = {center:?}, \
                     radius = [{}, {}], angle_deg = [0, 90] }}\nelements = [{n}, 2]\n",
                    radii[0] * size,
                    radii[1] * size
                )
            };
            let text = model(backend, 2)
                + &ring("i", [0.5, 1.0], inner)
                + &ring("o", [1.0, 1.3], outer)
                + "[[boundary]]\non = \"i.v0\"\nfix = [\"x\", \"y\"]\n[[boundary]]\non = \"o.u0\"\nfix = [\"y\"]\n\
                   [[boundary]]\non = \"o.u1\"\nfix = [\"x\"]\n[[contact]]\nname = \"c\"\nslave = \"i.v1\"\nmaster = \"o.v0\"\n";
            let result = run(&text);
            assert_eq!(result.status, Status::Ok, "{backend} {center:?} {inner} {outer}: {}", said(&result));
            let contact = result.contact.get("c").unwrap();
            if inner == outer || backend == "iga" {
                assert!(contact.force.iter().all(|f| f.abs() < 1e-13 * size), "{backend} {center:?} {inner} {outer}: {contact:?}");
                assert_eq!(contact.iterations, 1, "{backend} {center:?} {inner} {outer}");
            }
        }
    }
}

#[test]
fn a_load_beyond_the_middle_of_the_last_element_asks_for_a_finer_side() {
    // a block on a plane, pushed down at `at` of its width: nothing else holds it upright
    let case = |at: f64, elements: usize, size: f64| {
        let (one, half) = (size, 0.5 * size);
        let tilt = 12.0 * (at - 0.5);
        model("iga", 2)
            + &format!(
                "[[patch]]\nname = \"b\"\ngeometry = {{ kind = \"box\", min = [0, 0], max = [{one}, {half}] }}\nelements = [{elements}, 2]\n\
                 [[boundary]]\non = \"b.bottom\"\nspring = {{ x = {} }}\n\
                 [[boundary]]\non = \"b.top\"\ntraction = {{ y = \"-1e-3*(1 + {tilt}*(x/{size} - 0.5))\" }}\n\
                 [[contact]]\nname = \"c\"\nslave = \"b.bottom\"\nrigid = {{ kind = \"half-plane\", point = [0, 0], normal = [0, 1] }}\n",
                1e-3 / size
            )
    };
    for size in [1.0, 1e-3] {
        // centres of the last of 4 elements at 0.875, of 16 at 0.969
        assert_eq!(run(&case(0.85, 4, size)).status, Status::Ok);
        let coarse = run(&case(0.94, 4, size));
        assert_eq!((coarse.status, coarse.exit), (Status::Singular, 5), "{}", said(&coarse));
        assert_eq!(coarse.solve.as_ref().unwrap().reason, "side too coarse");
        let text = said(&coarse);
        assert!(text.contains("error[E072]: the contact side is too coarse for its load") && text.contains("more elements"), "{text}");
        assert!(!text.contains("infeasible"), "{text}");
        assert_eq!(run(&case(0.94, 16, size)).status, Status::Ok, "{}", said(&run(&case(0.94, 16, size))));
        let beyond = run(&case(1.05, 16, size));
        assert_eq!(beyond.solve.as_ref().unwrap().reason, "infeasible load", "{}", said(&beyond));
    }
}

/// One side carries a tied block on its left half, as master, and presses another one on its right half, as slave: its functions are free.
#[test]
fn a_tied_master_is_a_slave_of_contact_on_another_part() {
    for dimension in [2, 3] {
        let (axis, y) = if dimension == 2 { ("y", "") } else { ("z", ", 0") };
        let corner = |x: f64, z: f64, far: bool| {
            let y = if far { y.replace('0', "1") } else { y.to_owned() };
            format!("[{x}{y}, {z}]")
        };
        let patch = |name: &str, [x0, x1]: [f64; 2], [z0, z1]: [f64; 2], n: usize| {
            let elements = &[n, 2, 2][..dimension];
            format!(
                "[[patch]]\nname = \"{name}\"\ngeometry = {{ kind = \"box\", min = {}, max = {} }}\nelements = {elements:?}\n",
                corner(x0, z0, false),
                corner(x1, z1, true)
            )
        };
        for (backend, rest) in [("iga", ""), ("fe", ""), ("fe", "cells = \"simplex\""), ("iga", "degree = 3")] {
            for master in
                ["master = \"r.bottom\"", "master = \"r.bottom\"\nmultiplier = \"p/p\"", "master = \"r.bottom\"\nmethod = \"penalty\""]
            {
                let front = if dimension == 3 { "[[boundary]]\non = [\"b.front\", \"p.front\", \"r.front\"]\nfix = [\"y\"]\n" } else { "" };
                let text = format!(
                    "[model]\nphysics = \"elasticity\"\ndimension = {dimension}\n[discretization]\nbackend = \"{backend}\"\n{rest}\n\
                     [[material]]\nname = \"m\"\nyoung = 1.0\npoisson = 0.0\n"
                ) + &patch("b", [0.0, 1.0], [0.0, 1.0], 4)
                    + &patch("p", [0.0, 0.5], [1.0, 1.5], 2)
                    + &patch("r", [0.5, 1.0], [1.0, 1.5], 3)
                    + &format!(
                        "[[boundary]]\non = \"b.bottom\"\nfix = [\"{axis}\"]\n[[boundary]]\non = [\"b.left\", \"p.left\", \"r.right\"]\nfix = [\"x\"]\n"
                    )
                    + front
                    + "[[boundary]]\non = [\"p.top\", \"r.top\"]\npressure = 0.01\n[[interface]]\nname = \"t\"\nslave = \"p.bottom\"\nmaster = \"b.top\"\n"
                    + &format!("[[contact]]\nname = \"c\"\nslave = \"b.top\"\nwhere = \"x > 0.5\"\n{master}\n")
                    + &format!(
                        "[[probe]]\nname = \"least\"\nquantity = \"stress.{axis}{axis}.min\"\n[[probe]]\nname = \"largest\"\nquantity = \"stress.{axis}{axis}.max\"\n"
                    );
                let result = run(&text);
                assert_eq!(result.status, Status::Ok, "{}\n{text}", said(&result));
                for probe in &result.probes {
                    assert!((probe.value + 0.01).abs() < 1e-10, "{dimension}D {backend} {rest} {master}: {} {}", probe.name, probe.value);
                }
            }
        }
    }
}
