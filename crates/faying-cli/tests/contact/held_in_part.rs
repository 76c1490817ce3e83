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
            elements * 7 / 10
        )
    };
    format!(
        "{}[[patch]]\nname = \"b\"\ngeometry = {{ kind = \"box\", min = [0, 0.5], max = [1, 1] }}\nelements = [{elements}, 3]\n{below}\
         [[boundary]]\non = \"b.bottom\"\nwhere = \"{held}\"\nfix = [\"y\"]\n[[boundary]]\non = \"b.left\"\nfix = [\"x\"]\n\
         [[boundary]]\non = \"b.top\"\ntraction = {{ y = \"-1e-3\" }}\n[[contact]]\nname = \"c\"\nslave = \"b.bottom\"\n{opponent}\n{rule}\n",
        model(backend, degree)
    )
}

#[test]
fn a_contact_side_held_along_its_normal_in_part_presses_as_by_nitsche() {
    for held in ["x < 0.3", "x > 0.8", "abs(x - 0.5) < 0.2"] {
        for rigid in [true, false] {
            for backend in ["iga", "fe"] {
                for degree in [1, 2, 3] {
                    let force = |rule: &str| {
                        let result = run(&block(backend, degree, held, rule, rigid, 20));
                        assert_eq!(result.status, Status::Ok, "{held} {rigid} {backend} {degree} {rule}: {}", said(&result));
                        assert!(result.balance.force.iter().all(|f| f.abs() < 1e-12), "{:?}", result.balance);
                        result.contact.get("c").unwrap().force[1]
                    };
                    let wanted = force("method = \"nitsche\"");
                    for multiplier in ["auto", "p/p", "constant", "dual"] {
                        let found = force(&format!("multiplier = \"{multiplier}\""));
                        println!("{held} {rigid} {backend} {degree} {multiplier}: {found:.3e} {:+.1e}", found / wanted - 1.0);
                        assert!((found / wanted - 1.0).abs() < 0.05, "{held} {rigid} {backend} {degree} {multiplier}: {found} {wanted}");
                    }
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
