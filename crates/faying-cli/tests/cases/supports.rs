//! Supports that hold nothing, contradict each other or carry loads alone: `check` and `run` say the same, at any size and angle.

use faying_cli::case::ReadOptions;
use faying_cli::errors::Diagnostic;
use faying_cli::run::{check, run};
use faying_cli::{Case, Registry, RunControl, RunOptions, RunResult, Status};

fn both(text: &str) -> [RunResult; 2] {
    let case = Case::parse("case.toml", text, &ReadOptions::default()).unwrap_or_else(|e| panic!("{e}\n{text}"));
    [check, run].map(|f| f(&case, &Registry::default(), &RunOptions::default(), &RunControl::default()).result)
}

/// The errors of a case that is refused.
pub fn refused(text: &str) -> Vec<Diagnostic> {
    let [checked, run] = both(text);
    assert_eq!((checked.exit, run.exit), (3, 3), "{:?} {:?}\n{text}", checked.diagnostics, run.diagnostics);
    assert_eq!(checked.diagnostics, run.diagnostics);
    run.diagnostics
}

pub fn solved(text: &str) {
    let [checked, run] = both(text);
    assert_eq!((checked.exit, run.status), (0, Status::Ok), "{:?} {:?}\n{text}", checked.diagnostics, run.diagnostics);
}

/// A square of `size`, turned by `angle` degrees about the origin, with blocks of (side, lines).
fn square(backend: &str, size: f64, angle: f64, blocks: &[(&str, &str)]) -> String {
    let mut text = format!(
        "[model]\nphysics = \"elasticity\"\ndimension = 2\n[discretization]\nbackend = \"{backend}\"\n[[material]]\nname = \"m\"\nyoung = 1e3\n\
         poisson = 0.3\n[[patch]]\nname = \"b\"\ngeometry = {{ kind = \"box\", min = [0, 0], max = [{size:e}, {size:e}], rotate_deg = {angle:?} }}\n\
         elements = [3, 2]\n"
    );
    for (side, lines) in blocks {
        text += &format!("[[boundary]]\non = \"b.{side}\"\n{lines}\n");
    }
    text
}

/// Line of the last text that begins with `word`.
pub fn line_of(text: &str, word: &str) -> Option<usize> {
    Some(text.lines().count() - text.lines().rev().position(|line| line.starts_with(word))?)
}

#[test]
fn springs_that_vanish_on_their_side_hold_nothing() {
    for backend in ["iga", "fe"] {
        for size in [1.0, 1e-3, 1e4] {
            let case = |spring: &str, more: &str| {
                let spring = format!("spring = {{ x = {spring} }}");
                square(backend, size, 0.0, &[("bottom", "fix = [\"y\"]"), ("top", &spring), ("right", "traction = { x = 1e-3 }")]) + more
            };
            let steps = "[steps]\nt = [0.5, 1]\n";
            let beyond = format!("\"max(0, x - {:e})\"", 2.0 * size);
            for (spring, more) in [
                ("\"x*0\"", ""),
                (&*beyond, ""),
                ("\"if(t > 0.7, 0, 1)\"", ""),
                ("\"max(0, t - 0.7)\"", steps),
                ("\"max(0, 0.7 - t)\"", steps),
            ] {
                let found = refused(&case(spring, more));
                assert_eq!(found.len(), 1, "{found:?}");
                assert_eq!((found[0].code, &*found[0].message), ("E051", "body \"b\" can still move: translation x"), "{spring}");
            }
            // on one element of the side, at one time of the case
            solved(&case(&format!("\"if(x > {:e}, 10, 0)\"", 0.7 * size), ""));
            solved(&case("\"if(t > 0.7, 10, 0)\"", ""));
        }
    }
}

#[test]
fn sides_that_slide_or_move_as_one_agree_with_what_is_prescribed_beside_them() {
    for backend in ["iga", "fe"] {
        for (size, angle) in [(1.0, 30.0), (1e-3, -75.0), (1e4, 200.0)] {
            let u = 0.01 * size;
            // along the lower side, and along its normal
            let (s, c) = f64::to_radians(angle).sin_cos();
            let moved = |along: f64, normal: f64| {
                format!("dirichlet = {{ x = {:e}, y = {:e} }}", u * (along * c - normal * s), u * (along * s + normal * c))
            };
            for (fix, good, bad) in [
                ("fix = [\"normal\"]", [moved(1.0, 0.0), moved(0.0, 0.0)], [moved(1.0, 1.0), moved(0.0, 1e-3)]),
                ("fix = [\"tangential\"]", [moved(0.0, 1.0), moved(0.0, 0.0)], [moved(1.0, 1.0), moved(1e-3, 1.0)]),
            ] {
                good.iter().for_each(|beside| solved(&square(backend, size, angle, &[("bottom", fix), ("right", beside)])));
                for beside in &bad {
                    for blocks in [[("bottom", fix), ("right", &**beside)], [("right", &**beside), ("bottom", fix)]] {
                        let text = square(backend, size, angle, &blocks);
                        let found = refused(&text);
                        assert_eq!((found.len(), found[0].code, found[0].line), (1, "E052", line_of(&text, "fix")), "{found:?}\n{text}");
                        let other = format!("`b.right` (line {})", line_of(&text, "dirichlet").unwrap());
                        assert!(found[0].message.starts_with("the condition on `b.bottom` contradicts"), "{found:?}");
                        assert!(found[0].message.contains(&other), "{found:?}");
                    }
                }
            }
            // a side that moves as one between two others
            let held = |left: f64, right: f64, force: f64| {
                let [left, right] = [left, right].map(|v| format!("dirichlet = {{ y = {:e} }}", v * u));
                let top = format!("rigid_force = {{ y = {force} }}");
                let sides = [("bottom", "fix = [\"x\"]"), ("left", &left), ("right", &right), ("top", &top)];
                square(backend, size, 0.0, &sides)
            };
            solved(&held(1.0, 1.0, 0.0));
            // a force would act on these supports alone
            let text = held(1.0, 1.0, 1e-3);
            let found = refused(&text);
            assert_eq!((found.len(), found[0].code, found[0].line), (1, "E052", line_of(&text, "rigid_force")), "{found:?}");
            assert!(found[0].message.contains("`b.left` (line 19) prescribes in a part of it"), "{found:?}");
            let text = held(1.0, 0.9, 0.0);
            let found = refused(&text);
            assert_eq!((found.len(), found[0].code, found[0].line), (1, "E052", line_of(&text, "rigid_force")), "{found:?}");
            assert!(found[0].message.contains("`b.left` (line 19) and `b.right` (line 22)"), "{found:?}");
        }
    }
}

#[test]
fn a_contradiction_at_a_later_time_tells_the_time() {
    let blocks = [("bottom", "fix = [\"normal\"]"), ("right", "dirichlet = { x = \"max(0, t - 1)\", y = 0 }")];
    let found = refused(&(square("iga", 1.0, 30.0, &blocks) + "[steps]\nt = [0.5, 1, 1.5]\n"));
    assert!(found[0].code == "E052" && found[0].message.ends_with("by 0.25, t = 1.5"), "{found:?}");
}

#[test]
fn loads_that_supports_carry_alone_are_refused_at_any_angle() {
    for angle in [0.0, 90.0, 30.0, -110.0] {
        let (s, c) = f64::to_radians(angle).sin_cos();
        // outward from the lower side, and along it
        let (normal, along) = ([s, -c], [c, s]);
        let by = |what: &str, d: [f64; 2]| format!("{what} = {{ x = {:e}, y = {:e} }}", d[0], d[1]);
        let all = "fix = [\"normal\", \"tangential\"]";
        for (fix, load, carried) in [
            ("fix = [\"normal\"]", by("traction", normal), true),
            ("fix = [\"normal\"]", by("force", normal), true),
            ("fix = [\"normal\"]", by("traction", along), false),
            ("fix = [\"normal\"]", "pressure = 1".to_owned(), false),
            ("fix = [\"tangential\"]", by("traction", along), true),
            ("fix = [\"tangential\"]", by("force", normal), false),
            ("fix = [\"tangential\"]", "pressure = 1".to_owned(), false),
            (all, by("traction", along), true),
            (all, "traction = { x = 1 }".to_owned(), true),
            (all, "pressure = 1".to_owned(), true),
            (all, "spring = { x = 1 }".to_owned(), true),
        ] {
            let text = square("iga", 1.0, angle, &[("top", "fix = [\"x\", \"y\"]"), ("bottom", fix), ("bottom", &load)]);
            if !carried {
                solved(&text);
                continue;
            }
            let found = refused(&text);
            let at = |d: &Diagnostic| d.code == "E052" && d.line == Some(text.lines().count()) && d.message.contains("in line 19");
            assert!(found.iter().all(at), "{angle}: {found:?}\n{text}");
        }
        // part of the load is free
        let both = [normal[0] + along[0], normal[1] + along[1]];
        if s * c != 0.0 && angle != 90.0 {
            let text = [("top", "fix = [\"x\", \"y\"]"), ("bottom", "fix = [\"normal\"]"), ("bottom", &by("traction", both))];
            solved(&square("iga", 1.0, angle, &text));
        }
    }
}

/// The angles of a full ring.
const WHOLE: &str = "[0, 360]";

/// A ring of radii 1 and 2 between two angles, closed if it is whole, with blocks of (side, lines).
pub fn ring(backend: &str, angles: &str, blocks: &[(&str, &str)]) -> String {
    let closed = if angles == WHOLE { "closed = \"u\"\n" } else { "" };
    let mut text = format!(
        "[model]\nphysics = \"elasticity\"\ndimension = 2\n[discretization]\nbackend = \"{backend}\"\nmapping = \"exact\"\ndegree = 3\n[[material]]\nname = \"m\"\n\
         young = 1\npoisson = 0.3\n[[patch]]\nname = \"b\"\ngeometry = {{ kind = \"annulus-sector\", radius = [1, 2], angle_deg = {angles} }}\n\
         {closed}elements = [32, 8]\n"
    );
    for (side, lines) in blocks {
        text += &format!("[[boundary]]\non = \"b.{side}\"\n{lines}\n");
    }
    text
}

/// A full ring under pressure: u_r = 1.3 / 3 (0.4 r + 4 / r) p in plane strain.
#[test]
fn tangents_of_a_circle_hold_a_full_ring() {
    for backend in ["iga", "fe"] {
        for held in ["v0", "v1"] {
            let probes = "[[check]]\nquantity = \"u.r about [0, 0] at [1, 0]\"\nequals = \"1.3/3*4.4\"\nrtol = 1e-5\n\
                          [[check]]\nquantity = \"u.r about [0, 0] at [0, -2]\"\nequals = \"1.3/3*2.8\"\nrtol = 1e-5\n\
                          [[check]]\nquantity = \"stress.tt about [0, 0] at [-1.5, 0]\"\nequals = \"(1 + 4/2.25)/3\"\nrtol = 1e-3\n\
                          [[check]]\nquantity = \"balance.moment\"\nequals = 0\natol = 1e-9\n";
            solved(&(ring(backend, WHOLE, &[(held, "fix = [\"tangential\"]"), ("v0", "pressure = 1")]) + probes));
            // the normals leave the rotation
            let found = refused(&ring(backend, WHOLE, &[("v1", "fix = [\"normal\"]"), ("v0", "pressure = 1")]));
            assert!(found.len() == 1 && found[0].code == "E051" && found[0].message.contains("rotation"), "{found:?}");
            // both are all components
            solved(&ring(backend, WHOLE, &[("v1", "fix = [\"normal\", \"tangential\"]"), ("v0", "pressure = 1")]));
            let text = ring(backend, WHOLE, &[("v1", "fix = [\"x\"]"), ("v0", "pressure = 1"), ("v1", "fix = [\"normal\"]")]);
            let found = refused(&text);
            assert_eq!((found.len(), found[0].code, found[0].line), (1, "E052", Some(text.lines().count())), "{found:?}");
            assert!(found[0].message.contains("`b.v1` (line 19) holds facets of it"), "{found:?}");
        }
    }
}

#[test]
fn facets_of_a_curved_side_do_not_slide() {
    for word in ["normal", "tangential"] {
        let text = ring("fe", "[0, 90]", &[("v1", &format!("fix = [\"{word}\"]")), ("u0", "fix = [\"normal\"]")]);
        let found = refused(&text.replace("mapping = \"exact\"\n", ""));
        assert_eq!((found[0].code, found[0].line), ("E015", Some(17)), "{found:?}");
        assert!(found[0].message.contains("`b.v1` stands for a curved side by facets"), "{found:?}");
    }
}

/// A quarter of a ring in a rigid hole, its outer arc held in two parts: sigma_r(2) b is the reaction per axis.
#[test]
fn a_ring_in_a_rigid_hole_presses_on_it() {
    // u_r = B (1 / r - r / 4): sigma_r = 1 / 1.3 (-B / (4 * 0.4) - B / r^2), -1 at r = 1
    for backend in ["iga", "fe"] {
        let blocks = [("u0", "fix = [\"y\"]"), ("u1", "fix = [\"x\"]"), ("v0", "pressure = 1"), ("v1", "fix = [\"normal\"]")];
        let checks = "[let]\nB = \"1.3/(1/1.6 + 1)\"\nq = \"-B/1.3*(1/1.6 + 0.25)\"\n\
                      [[check]]\nquantity = \"reaction.b.v1.x\"\nequals = \"2*q\"\nrtol = 1e-4\n\
                      [[check]]\nquantity = \"reaction.b.v1.y\"\nequals = \"2*q\"\nrtol = 1e-4\n\
                      [[check]]\nquantity = \"u.r about [0, 0] at [1, 0]\"\nequals = \"B*0.75\"\nrtol = 1e-5\n";
        solved(&(ring(backend, "[0, 90]", &blocks) + checks));
    }
}
