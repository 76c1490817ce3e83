//! Reaction terms, foundations and bodies of revolution from case files.

use faying_cli::case::ReadOptions;
use faying_cli::errors::Diagnostics;
use faying_cli::{Case, Registry, RunResult, Status};

fn read(text: &str, backend: &str) -> Result<Case, Diagnostics> {
    Case::parse("case.toml", text, &ReadOptions { backend: Some(backend.into()), ..ReadOptions::default() })
}

fn run(text: &str, backend: &str) -> RunResult {
    let case = read(text, backend).unwrap_or_else(|e| panic!("{e}\n{text}"));
    let result = case.run(&Registry::default()).unwrap_or_else(|e| panic!("{e}\n{text}"));
    assert!(matches!(result.status, Status::Ok), "{:?} {:?}\n{text}", result.diagnostics, result.checks);
    result
}

/// (code, message, line) of the first error.
fn refused(text: &str) -> (&'static str, String, Option<usize>) {
    let found = match read(text, "iga") {
        Err(found) => found,
        Ok(case) => case.run(&Registry::default()).expect_err(text),
    };
    (found.items[0].code, found.items[0].message.clone(), found.items[0].line)
}

/// -div(grad u) + c u = 0, u(1) = 1: 1 / cosh(m) at x = 0.
const FLOW: &str = "[let]\nm = 3\n[model]\nphysics = \"poisson\"\ndimension = 2\nreaction = \"m^2 - 4\"\n[discretization]\ndegree = 4\n\
    [[patch]]\nname = \"a\"\ngeometry = { kind = \"box\", min = [0, 0], max = [1, 0.25] }\nelements = [12, 1]\nreaction = 4\n\
    [[boundary]]\non = \"a.right\"\ndirichlet = 1\n\
    [[check]]\nquantity = \"u at [0, 0.1]\"\nequals = \"1/cosh(m)\"\nrtol = 1e-8\n\
    [[check]]\nquantity = \"energy\"\nequals = \"0.125*m*tanh(m)\"\nrtol = 1e-9\n\
    [[check]]\nquantity = \"reaction.a.right\"\nequals = \"0.25*m*tanh(m)\"\nrtol = 1e-9\n";

/// A block that a uniform force moves by f / k.
fn block(model: &str, patch: &str, more: &str) -> String {
    format!(
        "[model]\nphysics = \"elasticity\"\ndimension = 2\n{model}\n[[material]]\nname = \"m\"\nyoung = 1e5\npoisson = 0.3\n\
         [[patch]]\nname = \"b\"\ngeometry = {{ kind = \"box\", min = [0, 0], max = [2, 1] }}\nelements = [3, 2]\n{patch}\n{more}"
    )
}

#[test]
fn reactions_of_model_and_patch_add_up() {
    for backend in ["iga", "fe"] {
        assert_eq!(run(FLOW, backend).checks_performed, 3);
    }
}

#[test]
fn a_block_moves_by_force_over_foundation_and_its_forces_balance() {
    let text = block(
        "body_force = [\"0\", \"-2\"]\nfoundation = { x = 1, y = 1e3 }",
        "foundation = { y = \"1e3*t\" }",
        "[steps]\nt = [0, 1, 3]\n[[probe]]\nname = \"down\"\nquantity = \"u.y at [1, 0.5]\"\n",
    );
    for backend in ["iga", "fe"] {
        let result = run(&text, backend);
        for (step, expected) in result.steps.iter().zip([-2e-3, -1e-3, -5e-4]) {
            assert!((step.probes[0].value - expected).abs() <= 1e-12, "{expected}: {}", step.probes[0].value);
        }
        assert!(result.balance.force.iter().all(|f| f.abs() <= 1e-11), "{:?}", result.balance);
        assert!(result.warnings.is_empty(), "{:?}", result.warnings);
    }
    let space = text
        .replace("dimension = 2", "dimension = 3")
        .replace("[\"0\", \"-2\"]", "[\"0\", \"-2\", \"1\"]")
        .replace("x = 1, y = 1e3", "x = 1, y = 1e3, z = 10")
        .replace("[0, 0], max = [2, 1]", "[0, 0, 0], max = [2, 1, 1]")
        .replace("[3, 2]", "[2, 2, 1]")
        .replace("[1, 0.5]", "[1, 0.5, 0.5]")
        + "[[check]]\nquantity = \"u.z at [0.3, 0.1, 0.7]\"\nequals = 0.1\nrtol = 1e-10\n";
    run(&space, "iga");
    run(&space, "fe");
    run(&space.replace("[[material]]", "[discretization]\ncells = \"simplex\"\n[[material]]"), "fe");
}

#[test]
fn foundations_that_make_no_sense_are_refused_in_their_place() {
    let of = |model: &str, patch: &str| refused(&block(model, patch, ""));
    let same = |(code, message, line): (&str, String, Option<usize>), expected: (&str, &str, usize)| {
        assert_eq!((code, message.as_str(), line), (expected.0, expected.1, Some(expected.2)));
    };
    same(of("foundation = { y = 1e3 }", ""), ("E051", "body \"b\" can still move: translation x", 9));
    same(of("foundation = { y = -1 }", ""), ("E015", "`foundation` must not be negative, found -1.0", 4));
    let found = of("foundation = { x = 1, y = 1 }", "foundation = { y = \"x - 1\" }");
    assert!(
        found.0 == "E015" && found.2 == Some(13) && found.1.starts_with("foundation of `b` must not be negative, found -0.92"),
        "{found:?}"
    );
    assert_eq!(of("foundation = {}", "").0, "E014");
    assert_eq!(of("foundation = 1e3", "").0, "E014");
    assert_eq!(of("foundation = { z = 1 }", "").0, "E012");
    assert_eq!(of("reaction = 1", "").0, "E015");
    let exact = "exact = { u = [\"x\", \"y\"] }";
    same(of(&format!("{exact}\nfoundation = {{ y = 1 }}"), ""), ("E015", "`foundation` does not stand beside `exact`", 5));
    same(of(exact, "foundation = { y = 1 }"), ("E015", "`foundation` does not stand beside `exact`", 13));
    let flow = FLOW.replace("reaction = 4", "foundation = { y = 1 }");
    assert_eq!(refused(&flow).0, "E015");
}

/// Lamé's tube of radii 1 and 2, pressure 1 inside, plane strain: u_r(1) = 1.906667 / E, u_r(2) = 1.213333 / E, the stresses c -+ d / r², c = 1/3, d = 4/3.
const TUBE: &str = "[model]\nphysics = \"elasticity\"\ndimension = 2\nassumption = \"axisymmetric\"\n[discretization]\ndegree = 3\n\
    [[material]]\nname = \"m\"\nyoung = 1e4\npoisson = 0.3\n\
    [[patch]]\nname = \"t\"\ngeometry = { kind = \"box\", min = [1, 0], max = [2, 0.5] }\nelements = [16, 1]\n\
    [[boundary]]\non = [\"t.bottom\", \"t.top\"]\nfix = [\"y\"]\n\
    [[boundary]]\nname = \"in\"\non = \"t.left\"\npressure = 1\n";

fn check(quantity: &str, equals: &str, tolerance: &str) -> String {
    format!("[[check]]\nquantity = \"{quantity}\"\nequals = {equals}\nrtol = {tolerance}\n")
}

#[test]
fn a_tube_of_a_case_has_the_numbers_of_lame_and_of_the_full_circle() {
    let checks = [
        check("u.x at [1, 0.2]", "1.9066666666666667e-4", "1e-6"),
        check("u.x at [2, 0.2]", "1.2133333333333334e-4", "1e-6"),
        check("stress.xx at [1.25, 0.2]", "\"1/3 - 4/3/1.25^2\"", "1e-4"),
        check("stress.zz at [1.25, 0.2]", "\"1/3 + 4/3/1.25^2\"", "1e-4"),
        check("stress.yy at [1.25, 0.2]", "0.2", "1e-3"),
        check("energy", "\"0.5*2*pi*0.5*1.9066666666666667e-4\"", "1e-6"),
        check("loads.in.force.x", "\"2*pi*0.5\"", "1e-12"),
        check("reaction.t.top.y", "\"0.2*pi*(4 - 1)\"", "1e-4"),
        check("area.t", "\"0.5*pi*(4 - 1)\"", "1e-12"),
        check("length.t.left", "\"2*pi*0.5\"", "1e-12"),
    ];
    let triangles = TUBE.replace("degree = 3", "degree = 3\ncells = \"simplex\"");
    for (tube, backend) in [(TUBE, "iga"), (TUBE, "fe"), (&triangles, "fe")] {
        let result = run(&(tube.to_owned() + &checks.concat()), backend);
        assert_eq!(result.checks_performed, checks.len());
        assert!(result.warnings.is_empty(), "{:?}", result.warnings);
        assert!(result.balance.force.iter().all(|f| f.abs() <= 1e-11), "{:?}", result.balance);
    }
    // heat: u = log r / log 2
    let pipe = "[model]\nphysics = \"poisson\"\ndimension = 2\nassumption = \"axisymmetric\"\n[discretization]\ndegree = 3\n\
        [[patch]]\nname = \"t\"\ngeometry = { kind = \"box\", min = [1, 0], max = [2, 0.5] }\nelements = [16, 1]\n\
        [[boundary]]\non = \"t.left\"\nfix = [\"u\"]\n[[boundary]]\non = \"t.right\"\ndirichlet = 1\n"
        .to_owned()
        + &check("u at [1.3, 0.1]", "\"log(1.3)/log(2)\"", "1e-7")
        + &check("reaction.t.right", "\"pi/log(2)\"", "1e-7");
    for backend in ["iga", "fe"] {
        assert_eq!(run(&pipe, backend).checks_performed, 2);
    }
}

#[test]
fn what_a_body_of_revolution_cannot_have_is_refused_in_its_place() {
    let beyond = TUBE.replace("min = [1, 0]", "min = [-1, 0]");
    let found = refused(&beyond);
    assert_eq!((found.0, found.2), ("E041", Some(13)));
    assert!(found.1.starts_with("patch \"t\" has points beyond the axis x = 0, such as x = -1, y = 0"), "{}", found.1);
    let axis = TUBE.replace("min = [1, 0]", "min = [0, 0]");
    let found = refused(&axis);
    assert_eq!(
        (found.0, found.1.as_str(), found.2),
        ("E015", "`t.left` lies on the axis x = 0, where u.x is zero and areas are", Some(21))
    );
    // held without a word, or said again
    let rod = axis.replace("name = \"in\"\non = \"t.left\"\npressure = 1", "on = \"t.right\"\npressure = 1");
    let expected = check("u.x at [2, 0.3]", "\"-2*(1 + 0.3)*(1 - 2*0.3)*1e-4\"", "1e-10");
    run(&(rod.clone() + &expected), "iga");
    run(&(rod + &expected + "[[boundary]]\non = \"t.left\"\nfix = [\"x\"]\n"), "fe");
    let space = TUBE.replace("dimension = 2", "dimension = 3");
    assert_eq!(refused(&space).0, "E015");
    let free = TUBE.replace("fix = [\"y\"]", "spring = { y = \"0*x\" }");
    assert_eq!(refused(&free).1, "body \"t\" can still move: translation y");
}
