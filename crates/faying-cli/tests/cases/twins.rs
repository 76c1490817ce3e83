//! Twins: C^0 B-splines of degree p on the exact map span the same space as Lagrange functions of degree p on it.
//!
//! So every problem has the same discrete solution on both backends: displacement to 1e-10, tied to 1e-9, in contact to
//! 1e-8 with equal active sets, all relative. The multipliers are the same splines on both sides: equal coefficients.

use faying::linalg::Vector;
use faying_cli::Case;
use faying_cli::case::ReadOptions;
use faying_cli::run::run;
use faying_cli::{Finished, Parts, Registry, RunOptions, Status, Watch};
use faying_files::vtu::Part;

/// The two discretisations of one space.
const TWINS: [&str; 2] =
    ["backend = \"iga\"\ncontinuity = 0\nbasis = \"b-spline\"\n", "backend = \"fe\"\ncells = \"tensor\"\nmapping = \"exact\"\n"];

fn solve(text: &str) -> Finished {
    let case = Case::parse("twin.toml", text, &ReadOptions::default()).unwrap_or_else(|e| panic!("{e}\n{text}"));
    let finished = run(&case, &Registry::default(), &RunOptions::default(), &Watch::default());
    assert_eq!(finished.result.status, Status::Ok, "{:?}\n{text}", finished.result.diagnostics);
    finished
}

/// Values of the first field (u or displacement) at points inside every element, patch after patch.
fn values(finished: &Finished) -> Vec<f64> {
    fn of<const N: usize>(parts: &[Part<'_, N, N>]) -> Vec<f64> {
        const INSIDE: [[f64; 3]; 4] = [[0.1, 0.2, 0.6], [0.5, 0.5, 0.5], [0.9, 0.3, 0.2], [0.35, 0.85, 0.9]];
        let xi: Vec<Vector<N>> = INSIDE.map(|x| Vector::from_fn(|k, _| x[k])).to_vec();
        parts.iter().flat_map(|part| (0..part.space.num_elements()).flat_map(|e| (part.fields[0].sample)(e, &xi))).collect()
    }
    match &finished.output.as_ref().expect("a solved case has fields").parts {
        Parts::Plane(parts) => of(parts),
        Parts::Volume(parts) => of(parts),
        other => panic!("no values of {other:?}"),
    }
}

/// Largest difference relative to the largest value.
fn difference(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    let scale = a.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
    a.iter().zip(b).fold(0.0_f64, |m, (x, y)| m.max((x - y).abs())) / scale
}

/// Multiplier coefficients and active flags of all sides.
fn multipliers(finished: &Finished) -> (Vec<f64>, Vec<bool>) {
    let sides = &finished.output.as_ref().expect("a solved case has fields").sides;
    let rows = || sides.iter().flat_map(|s| &s.rows);
    (rows().flat_map(|r| r.lambda.clone()).collect(), rows().map(|r| r.active).collect())
}

/// Solves both twins of `text`, in which DISC stands for the discretisation, and compares them.
fn compare(what: &str, text: &str, tolerance: f64) {
    let [a, b] = TWINS.map(|twin| solve(&text.replace("DISC", twin)));
    let d = difference(&values(&a), &values(&b));
    assert!(d <= tolerance, "{what}: displacements differ by {d:e}");
    let ((la, aa), (lb, ab)) = (multipliers(&a), multipliers(&b));
    assert_eq!(aa, ab, "{what}: active sets differ");
    if !la.is_empty() {
        let d = difference(&la, &lb);
        assert!(d <= tolerance, "{what}: multipliers differ by {d:e}");
    }
}

const SHAPES: [(&str, &str, &str); 3] = [
    ("box", "{ kind = \"box\", min = [0, 0], max = [1, 0.6] }", "[3, 2]"),
    ("ring", "{ kind = \"annulus-sector\", radius = [1, 2], angle_deg = [10, 100] }", "[4, 3]"),
    ("plate", "{ kind = \"plate-with-hole\", radius = 0.5, half_width = 2 }", "[4, 3]"),
];

#[test]
fn one_body_has_the_same_solution_on_both_backends() {
    let mut pairs = 0;
    for p in 1..=4 {
        for (name, geometry, elements) in SHAPES {
            for (physics, material, exact) in [
                ("poisson", "conductivity = \"1 + 0.2*x\"", "\"sin(x + 2*y)\""),
                ("elasticity", "young = 3.0\npoisson = 0.3", "[\"sin(x + 2*y)\", \"x*cos(y)\"]"),
            ] {
                let text = format!(
                    "[model]\nphysics = \"{physics}\"\ndimension = 2\nexact = {{ u = {exact} }}\n[discretization]\ndegree = {p}\nDISC\n\
                     [[material]]\nname = \"m\"\n{material}\n[[patch]]\nname = \"b\"\ngeometry = {geometry}\nelements = {elements}\n\
                     [[boundary]]\non = [\"b.u0\", \"b.u1\", \"b.v1\"]\ndirichlet = \"exact\"\n\
                     [[boundary]]\non = \"b.v0\"\nneumann = \"exact\"\n"
                );
                compare(&format!("{name} p={p} {physics}"), &text, 1e-10);
                pairs += 1;
            }
        }
    }
    assert_eq!(pairs, 24);
}

#[test]
fn one_solid_has_the_same_solution_on_both_backends() {
    let mut pairs = 0;
    for p in 1..=3 {
        for (name, geometry, elements) in [
            ("box", "{ kind = \"box\", min = [0, 0, 0], max = [1, 0.6, 0.8] }", "[3, 2, 2]"),
            ("ring", "{ kind = \"annulus-sector\", radius = [1, 2], angle_deg = [10, 100], extrude = 0.7 }", "[4, 2, 2]"),
            ("shell", "{ kind = \"sphere-octant\", radius = [1, 2] }", "[2, 2, 2]"),
        ] {
            for (physics, material, exact) in [
                ("poisson", "conductivity = \"1 + 0.2*x*z\"", "\"sin(x + 2*y - z)\""),
                ("elasticity", "young = 3.0\npoisson = 0.3", "[\"sin(x + 2*y)\", \"x*cos(z)\", \"y*z\"]"),
            ] {
                let text = format!(
                    "[model]\nphysics = \"{physics}\"\ndimension = 3\nexact = {{ u = {exact} }}\n[discretization]\ndegree = {p}\nDISC\n\
                     [[material]]\nname = \"m\"\n{material}\n[[patch]]\nname = \"b\"\ngeometry = {geometry}\nelements = {elements}\n\
                     [[boundary]]\non = [\"b.u0\", \"b.u1\", \"b.w1\"]\ndirichlet = \"exact\"\n\
                     [[boundary]]\non = [\"b.v0\", \"b.w0\"]\nneumann = \"exact\"\n"
                );
                compare(&format!("{name} p={p} {physics}"), &text, 1e-10);
                pairs += 1;
            }
        }
    }
    assert_eq!(pairs, 18);
}

#[test]
fn tied_bodies_have_the_same_solution_and_multipliers_on_both_backends() {
    let mut pairs = 0;
    for p in 1..=4 {
        for multiplier in ["p/p", "p/p-2"] {
            if p == 1 && multiplier == "p/p-2" {
                continue;
            }
            for (name, lower, upper) in [
                ("boxes", "{ kind = \"box\", min = [0, 0], max = [1, 0.5] }", "{ kind = \"box\", min = [0, 0.5], max = [1, 1] }"),
                (
                    "rings",
                    "{ kind = \"annulus-sector\", radius = [1, 1.5], angle_deg = [0, 90] }",
                    "{ kind = \"annulus-sector\", radius = [1.5, 2], angle_deg = [0, 90] }",
                ),
            ] {
                let text = format!(
                    "[model]\nphysics = \"elasticity\"\ndimension = 2\n[discretization]\ndegree = {p}\nDISC\n\
                     [[material]]\nname = \"m\"\nyoung = 1.0\npoisson = 0.3\n\
                     [[patch]]\nname = \"a\"\ngeometry = {lower}\nelements = [5, 3]\n\
                     [[patch]]\nname = \"b\"\ngeometry = {upper}\nelements = [4, 2]\n\
                     [[boundary]]\non = [\"a.u0\", \"b.u0\"]\nfix = [\"y\"]\n\
                     [[boundary]]\non = [\"a.u1\", \"b.u1\"]\nfix = [\"x\"]\n\
                     [[boundary]]\non = \"a.v0\"\npressure = \"1 + 0.3*x\"\n\
                     [[interface]]\nname = \"i\"\nslave = \"a.v1\"\nmaster = \"b.v0\"\nmultiplier = \"{multiplier}\"\n"
                );
                compare(&format!("{name} p={p} {multiplier}"), &text, 1e-9);
                pairs += 1;
            }
        }
    }
    assert_eq!(pairs, 14);
}

#[test]
fn bodies_in_contact_have_the_same_solution_and_active_set_on_both_backends() {
    let mut pairs = 0;
    for p in 1..=4 {
        // a quarter disc pressed on a plane, and a circle pressed into a box: partly open
        for (name, geometry, elements, slave, rigid, boundary) in [
            (
                "plane",
                "{ kind = \"annulus-sector\", center = [0, 1], radius = [0.3, 1], angle_deg = [-90, 0] }",
                "[10, 4]",
                "b.v1",
                "{ kind = \"half-plane\", point = [0, 0], normal = [0, 1] }",
                "[[boundary]]\non = \"b.u0\"\nfix = [\"x\"]\n[[boundary]]\non = \"b.u1\"\ndirichlet = { y = -0.02 }\n",
            ),
            (
                "circle",
                "{ kind = \"box\", min = [-1, -1], max = [1, 0] }",
                "[11, 4]",
                "b.v1",
                "{ kind = \"sphere\", center = [0.1, 0.97], radius = 1 }",
                "[[boundary]]\non = \"b.v0\"\nfix = [\"x\", \"y\"]\n",
            ),
        ] {
            let text = format!(
                "[model]\nphysics = \"elasticity\"\ndimension = 2\n[discretization]\ndegree = {p}\nDISC\n\
                 [[material]]\nname = \"m\"\nyoung = 1.0\npoisson = 0.3\n\
                 [[patch]]\nname = \"b\"\ngeometry = {geometry}\nelements = {elements}\n{boundary}\
                 [[contact]]\nname = \"c\"\nslave = \"{slave}\"\nrigid = {rigid}\n"
            );
            let finished = solve(&text.replace("DISC", TWINS[0]));
            let (_, active) = multipliers(&finished);
            assert!(active.contains(&true) && active.contains(&false), "{name} p={p}: a part of the side is open, a part closed");
            compare(&format!("{name} p={p}"), &text, 1e-8);
            pairs += 1;
        }
    }
    assert_eq!(pairs, 8);
}
