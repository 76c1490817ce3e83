//! Prescribed values where tied bodies meet: one value in the corner, and what that does for the multiplier.

use faying_cli::Case;
use faying_cli::case::ReadOptions;
use faying_cli::run::run;
use faying_cli::{Finished, Registry, RunControl, RunOptions, Status};

const BACKENDS: [&str; 2] = ["iga", "fe"];

fn solved(text: &str) -> Finished {
    let case = Case::parse("corners.toml", text, &ReadOptions::default()).unwrap_or_else(|e| panic!("{e}\n{text}"));
    let finished = run(&case, &Registry::default(), &RunOptions::default(), &RunControl::default());
    assert_eq!(finished.result.status, Status::Ok, "{:?}\n{text}", finished.result.diagnostics);
    finished
}

fn probe(finished: &Finished, name: &str) -> f64 {
    finished.result.probes.iter().find(|p| p.name == name).unwrap().value
}

/// Four unit squares around the cross point (1, 1) with n, 3n/2, 5n/4 and 7n/4 elements along their sides.
fn squares(backend: &str, degree: usize, n: usize, head: &str, rest: &str) -> String {
    let mut text =
        format!("[model]\nphysics = \"poisson\"\ndimension = 2\n{head}[discretization]\nbackend = \"{backend}\"\ndegree = {degree}\n");
    for (name, x, y, n) in [("a", 0, 0, n), ("b", 1, 0, 3 * n / 2), ("c", 0, 1, 5 * n / 4), ("d", 1, 1, 7 * n / 4)] {
        text += &format!(
            "[[patch]]\nname = \"{name}\"\ngeometry = {{ kind = \"box\", min = [{x}, {y}], max = [{}, {}] }}\nelements = [{n}, {n}]\n",
            x + 1,
            y + 1
        );
    }
    text + "[[interface]]\nname = \"t\"\nbetween = \"all\"\nmultiplier = \"p/p\"\n" + rest
}

const EXACT: &str = "exact = { u = \"SOLUTION\" }\n";
const PRESCRIBED: &str = "[[boundary]]\non = \"all-outer\"\ndirichlet = \"exact\"\n";

#[test]
fn bodies_take_the_same_value_where_they_meet() {
    let exact = EXACT.replace("SOLUTION", "sin(5*x)*exp(3*y)");
    let points = [([1.0, 0.0], ["a", "b"]), ([0.0, 1.0], ["a", "c"]), ([2.0, 1.0], ["b", "d"]), ([1.0, 2.0], ["c", "d"])];
    for backend in BACKENDS {
        for degree in 1..=4 {
            let probes: String = points
                .iter()
                .enumerate()
                .flat_map(|(k, (x, bodies))| bodies.map(|b| format!("[[probe]]\nname = \"{b}{k}\"\nquantity = \"u at {x:?} in {b}\"\n")))
                .collect();
            let finished = solved(&squares(backend, degree, 4, &exact, &(PRESCRIBED.to_owned() + &probes)));
            for (k, (x, bodies)) in points.iter().enumerate() {
                let [a, b]: [f64; 2] = *x;
                let expected = (5.0 * a).sin() * (3.0 * b).exp();
                for body in bodies {
                    let found = probe(&finished, &format!("{body}{k}"));
                    assert!((found - expected).abs() <= 1e-13 * 400.0, "{backend} p = {degree}, {body} at {x:?}: {found} for {expected}");
                }
            }
        }
    }
}

/// |lambda - exact| in L2 over the interfaces of four squares around (1/2, 1/2), grids n : 2n/3 on each, p/p, values `prescribed`.
fn multiplier_error(backend: &str, degree: usize, n: usize, prescribed: &str) -> f64 {
    let mut text = format!(
        "[model]\nphysics = \"poisson\"\ndimension = 2\nexact = {{ u = \"{SMOOTH}\" }}\n\
         [discretization]\nbackend = \"{backend}\"\ndegree = {degree}\n[[boundary]]\non = \"all-outer\"\ndirichlet = \"{prescribed}\"\n"
    );
    for (name, x, y, n) in [("sw", 0.0, 0.0, n), ("se", 0.5, 0.0, 2 * n / 3), ("nw", 0.0, 0.5, 2 * n / 3), ("ne", 0.5, 0.5, n)] {
        text += &format!(
            "[[patch]]\nname = \"{name}\"\ngeometry = {{ kind = \"box\", min = [{x}, {y}], max = [{}, {}] }}\nelements = [{n}, {n}]\n",
            x + 0.5,
            y + 0.5
        );
    }
    for (slave, master) in [("sw.right", "se.left"), ("ne.left", "nw.right"), ("sw.top", "nw.bottom"), ("ne.bottom", "se.top")] {
        let name = slave.replace('.', "-");
        text += &format!("[[interface]]\nname = \"{name}\"\nslave = \"{slave}\"\nmaster = \"{master}\"\nmultiplier = \"p/p\"\n");
    }
    *solved(&text).result.errors.get("error.lambda.L2").unwrap()
}

const SMOOTH: &str = "cos(3*x + 0.3)*exp(y) + sin(2*pi*x*y)";

#[test]
fn one_value_in_the_corner_is_worth_a_factor_in_the_multiplier() {
    // data without a value in the corners are projected there body by body: 0/0 where x or y is 1/2, which no Gauss point meets
    let body_by_body = format!("({SMOOTH})*(x - 0.5)/(x - 0.5)*(y - 0.5)/(y - 0.5)");
    for (backend, degree, least) in [("iga", 2, 2.0), ("iga", 3, 1.3), ("iga", 4, 8.0), ("fe", 2, 2.5), ("fe", 3, 1.05), ("fe", 4, 14.0)] {
        let errors = [12, 24].map(|n| multiplier_error(backend, degree, n, "exact"));
        for (n, shared) in [12, 24].into_iter().zip(errors) {
            let apart = multiplier_error(backend, degree, n, &body_by_body);
            assert!(apart > least * shared, "{backend} p = {degree}, n = {n}: {apart:e} body by body, {shared:e} with shared corners");
        }
        let order = (errors[0] / errors[1]).log2();
        assert!(order > degree as f64, "{backend} p = {degree}: order {order} of {errors:?}");
    }
}

#[test]
fn data_that_jump_between_tied_bodies_are_warned() {
    let on = |side: &str, value: &str| format!("[[boundary]]\non = \"{side}\"\ndirichlet = \"{value}\"\n");
    let warnings = |text: &str| -> Vec<String> {
        let finished = solved(text);
        finished.result.warnings.iter().filter(|w| w.code == "E052").map(|w| w.message.clone()).collect()
    };
    for backend in BACKENDS {
        let text = squares(backend, 2, 4, "", &(on("a.bottom", "1 + x") + &on("b.bottom", "3 - x")));
        assert!(warnings(&text).is_empty(), "2 on both sides of (1, 0)");
        let text = squares(backend, 2, 4, "", &(on("a.bottom", "1 + x") + &on("b.bottom", "x - 1.5")));
        let [found] = &warnings(&text)[..] else { panic!("{:?}", warnings(&text)) };
        for part in ["component u is prescribed as 2 on `a.bottom` (line", "and as -0.5 on `b.bottom`", "(1, 0)", "tied"] {
            assert!(found.contains(part), "{found}");
        }
        // "a" and "d" meet nowhere but in the cross point, which nothing prescribes
        let text = squares(backend, 2, 4, "", &(on("a.bottom", "1") + &on("d.top", "2")));
        assert!(warnings(&text).is_empty());
    }
}

#[test]
fn values_that_contradict_each_other_in_a_corner_of_two_tied_bodies_are_warned_with_both_lines() {
    let text = |backend: &str, coupling: &str, [slave, master]: [&str; 2], size: f64, on: [(&str, &str); 2]| {
        let mut text = format!(
            "[model]\nphysics = \"poisson\"\ndimension = 2\n[discretization]\nbackend = \"{backend}\"\ndegree = 2\n\
             [[boundary]]\non = \"{}\"\ndirichlet = \"{}\"\n[[boundary]]\non = \"{}\"\ndirichlet = \"{}\"\n\
             [[interface]]\nname = \"t\"\nslave = \"{slave}\"\nmaster = \"{master}\"\ncoupling = \"{coupling}\"\n",
            on[0].0, on[0].1, on[1].0, on[1].1
        );
        for (name, k, n) in [("a", 0.0, 4), ("b", 1.0, 6)] {
            text += &format!(
                "[[patch]]\nname = \"{name}\"\ngeometry = {{ kind = \"box\", min = [{:e}, 0], max = [{:e}, {size:e}] }}\nelements = [{n}, {n}]\n",
                k * size,
                (k + 1.0) * size
            );
        }
        text
    };
    let found = |text: &str| -> Vec<(Option<usize>, String)> {
        let finished = solved(text);
        finished.result.warnings.iter().filter(|w| w.code == "E052").map(|w| (w.line, w.message.clone())).collect()
    };
    for backend in BACKENDS {
        for coupling in ["mortar", "nitsche", "penalty"] {
            for sides in [["a.right", "b.left"], ["b.left", "a.right"]] {
                for size in [1.0, 1e-4, 1e5] {
                    for on in [["a.bottom", "b.bottom"], ["a.bottom", "b.u0v0"], ["b.bottom", "a.u1v0"], ["a.u1v0", "b.u0v0"]] {
                        let with = |v: &str| text(backend, coupling, sides, size, [(on[0], "0"), (on[1], v)]);
                        let [(line, message)] = &found(&with("1"))[..] else { panic!("{coupling} {on:?} {size}") };
                        let lines = [line.unwrap(), message.split_once("(line ").unwrap().1.split_once(')').unwrap().0.parse().unwrap()];
                        assert!(lines == [9, 12] || lines == [12, 9], "{message}, line {line:?}");
                        assert!(on.iter().all(|side| message.contains(&format!("`{side}`"))) && message.contains("tied"), "{message}");
                        assert_eq!(found(&with(&format!("x - {size:e}"))), [], "{coupling} {on:?} {size}");
                    }
                    // a corner at the other end of the body is none of the interface
                    assert_eq!(found(&text(backend, coupling, sides, size, [("a.bottom", "0"), ("b.u1v0", "1")])), []);
                }
            }
        }
    }
}

/// A block in a corner, tied below and beside by one statement with two slaves and two masters: each slave has the master that it meets, and
/// the linear field is exact.
#[test]
fn lists_of_sides_around_a_corner_find_their_partners() {
    for dimension in [2, 3] {
        for (integration, multiplier) in
            ["merged", "slave", "mixed"].into_iter().flat_map(|rule| ["p/p", "auto"].map(|multiplier| (rule, multiplier)))
        {
            let up = ["v", "w"][dimension - 2];
            let point = |x: f64, z: f64, y: f64| if dimension == 2 { format!("[{x}, {z}]") } else { format!("[{x}, {y}, {z}]") };
            let patch = |name: &str, [x0, z0]: [f64; 2], [x1, z1]: [f64; 2], n: usize| {
                let (elements, min, max) = (vec![n; dimension], point(x0, z0, 0.0), point(x1, z1, 1.0));
                format!(
                    "[[patch]]\nname = \"{name}\"\ngeometry = {{ kind = \"box\", min = {min}, max = {max} }}\nelements = {elements:?}\n"
                )
            };
            let exact = ["[\"1e-3*x+2e-3*y\", \"-1e-3*y\"]", "[\"1e-3*x+2e-3*z\", \"-1e-3*y\", \"5e-4*x+1e-3*z\"]"][dimension - 2];
            let text = format!(
                "[model]\nphysics = \"elasticity\"\ndimension = {dimension}\nexact = {{ u = {exact} }}\n\
                 [[material]]\nname = \"m\"\nyoung = 1.0\npoisson = 0.3\n"
            ) + &patch("a", [0.0, 0.0], [1.0, 1.0], 2)
                + &patch("b", [0.0, -1.0], [2.0, 0.0], 3)
                + &patch("c", [1.0, 0.0], [2.0, 1.0], 3)
                + &format!(
                    "[[boundary]]\non = \"b.{up}0\"\ndirichlet = \"exact\"\n[[boundary]]\non = \"all-outer\"\nneumann = \"exact\"\n"
                )
                + &format!(
                    "[[interface]]\nname = \"i\"\nslave = [\"a.{up}0\", \"a.u1\"]\nmaster = [\"b.{up}1\", \"c.u0\"]\n\
                     integration = \"{integration}\"\nmultiplier = \"{multiplier}\"\n\
                     [[interface]]\nname = \"j\"\nslave = \"c.{up}0\"\nmaster = \"b.{up}1\"\nmultiplier = \"p/p\"\n"
                );
            let finished = solved(&text);
            let result = &finished.result;
            assert_eq!(result.status, Status::Ok, "{integration} {multiplier}: {:?}\n{text}", result.diagnostics);
            let error = result.errors["error.u.L2.rel"];
            // the slave's own points do not see where the master's elements end
            let allowed = if integration == "slave" { 0.02 } else { 1e-10 };
            assert!(error < allowed, "{dimension}D {integration} {multiplier}: {error:e}");
        }
    }
}
