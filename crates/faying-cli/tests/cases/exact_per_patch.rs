//! Exact solutions said per patch: they may jump across ties and contacts.

use faying_cli::case::ReadOptions;
use faying_cli::{Case, Registry, RunResult, Status};

fn run(text: &str) -> RunResult {
    let case = Case::parse("case.toml", text, &ReadOptions::default()).unwrap_or_else(|e| panic!("{e}\n{text}"));
    let result = case.run(&Registry::default()).unwrap_or_else(|e| panic!("{e}\n{text}"));
    assert!(matches!(result.status, Status::Ok), "{:?}\n{text}", result.diagnostics);
    result
}

fn refused(text: &str, code: &str, part: &str) {
    let faults = match Case::parse("case.toml", text, &ReadOptions::default()) {
        Err(faults) => faults,
        Ok(case) => case.run(&Registry::default()).map(|_| ()).expect_err(text),
    };
    let found = &faults.items[0];
    assert!(found.code == code && found.message.contains(part) && found.line.is_some() && found.help.is_some(), "{faults:?}");
}

fn error(result: &RunResult, name: &str) -> f64 {
    *result.errors.get(name).unwrap_or_else(|| panic!("{name}: {:?}", result.errors))
}

fn patch(name: &str, [from, to]: [f64; 2], n: usize, material: &str, rest: &str) -> String {
    format!(
        "[[patch]]\nname = \"{name}\"\nmaterial = \"{material}\"\ngeometry = {{ kind = \"box\", min = [{from:?}, 0], max = [{to:?}, 1] }}\n\
         elements = [{n}, {n}]\n{rest}\n"
    )
}

/// Conductivities 1 and 4; u = sin(pi y) (x + x²) left of x = 1, with the same flux and value there on the right.
fn bars(backend: &str, degree: usize, n: usize) -> String {
    let left = "exact = { u = \"sin(pi*y)*(x + x^2)\" }";
    // value 2 and slope 3/4 at x = 1
    let right = "exact = { u = \"sin(pi*y)*(2 + 0.75*(x - 1))\" }";
    format!("[model]\nphysics = \"poisson\"\ndimension = 2\n[discretization]\nbackend = \"{backend}\"\ndegree = {degree}\n")
        + "[[material]]\nname = \"a\"\nconductivity = 1\n[[material]]\nname = \"b\"\nconductivity = 4\n"
        + &patch("l", [0.0, 1.0], 2 * n, "a", left)
        + &patch("r", [1.0, 2.0], 3 * n, "b", right)
        + "[[boundary]]\non = [\"l.left\", \"r.right\"]\ndirichlet = \"exact\"\n\
           [[boundary]]\non = [\"l.bottom\", \"l.top\", \"r.bottom\", \"r.top\"]\nneumann = \"exact\"\n\
           [[interface]]\nname = \"i\"\nslave = \"r.left\"\nmaster = \"l.right\"\n"
}

#[test]
fn errors_against_solutions_of_each_patch_fall_by_their_orders() {
    for backend in ["iga", "fe"] {
        for degree in [1, 2, 3] {
            let [coarse, fine] = [2, 4].map(|n| run(&bars(backend, degree, n)));
            assert!(coarse.warnings.is_empty() && fine.warnings.is_empty(), "{:?}", fine.warnings);
            let rate = |name: &str| (error(&coarse, name) / error(&fine, name)).log2();
            let p = degree as f64;
            assert!(rate("error.u.L2") > p + 0.8 && rate("error.u.H1") > p - 0.2, "{backend} {degree}: {}", rate("error.u.L2"));
            assert!(rate("error.i.lambda.L2") > (p - 1.1).max(0.8), "{backend} {degree}: {}", rate("error.i.lambda.L2"));
        }
    }
}

/// Blocks of two moduli under a uniform pressure, with a gap of 0.01 between them that the displacement of the upper one closes: u jumps by it.
#[test]
fn a_displacement_that_jumps_across_a_contact_is_exact() {
    for backend in ["iga", "fe"] {
        let text = format!(
            "[model]\nphysics = \"elasticity\"\ndimension = 2\nassumption = \"plane-stress\"\n[discretization]\nbackend = \"{backend}\"\n"
        ) + "[[material]]\nname = \"a\"\nyoung = 10\npoisson = 0.0\n[[material]]\nname = \"b\"\nyoung = 40\npoisson = 0.0\n\
               [[patch]]\nname = \"a\"\nmaterial = \"a\"\ngeometry = { kind = \"box\", min = [0, 0], max = [1, 1] }\nelements = [3, 3]\n\
               exact = { u = [\"0\", \"-0.1*y\"] }\n\
               [[patch]]\nname = \"b\"\nmaterial = \"b\"\ngeometry = { kind = \"box\", min = [0, 1.01], max = [1, 2.01] }\nelements = [4, 4]\n\
               exact = { u = [\"0\", \"-0.11 - 0.025*(y - 1.01)\"] }\n\
               [[boundary]]\non = [\"a.bottom\", \"b.top\"]\ndirichlet = \"exact\"\n\
               [[contact]]\nname = \"c\"\nslave = \"b.bottom\"\nmaster = \"a.top\"\n";
        let result = run(&text);
        assert!(result.warnings.is_empty(), "{:?}", result.warnings);
        for name in ["error.u.L2", "error.u.energy", "error.c.lambda.L2"] {
            assert!(error(&result, name) < 1e-10, "{name}: {:e}", error(&result, name));
        }
        // the model's solution holds in patches without one of their own
        let both = text
            .replacen("exact = { u = [\"0\", \"-0.1*y\"] }\n", "", 1)
            .replace("dimension = 2\n", "dimension = 2\nexact = { u = [\"0\", \"-0.1*y\"] }\n");
        assert_eq!(run(&both).errors.get("error.u.L2"), result.errors.get("error.u.L2"));
    }
}

#[test]
fn a_flux_that_jumps_between_patches_is_told_and_missing_solutions_are_named() {
    let text = bars("iga", 2, 2);
    let jumping = run(&text.replace("0.75*(x - 1)", "0.5*(x - 1)"));
    assert!(
        jumping.warnings.iter().any(|w| w.code == "E017" && w.message.contains("jumps across interface \"i\"")),
        "{:?}",
        jumping.warnings
    );
    let alone =
        text.replace("exact = { u = \"sin(pi*y)*(x + x^2)\" }", "").replace("\"l.left\", ", "").replace("\"l.bottom\", \"l.top\", ", "");
    refused(&alone, "E062", "patch \"l\" has no `exact`, and patch \"r\" has one");
    refused(&text.replace("exact = { u = \"sin(pi*y)*(x + x^2)\" }", ""), "E062", "data marked \"exact\"");
    refused(
        &text.replace("exact = { u = \"sin(pi*y)*(x + x^2)\" }", "exact = { u = \"x\" }\nsource = 1"),
        "E015",
        "does not stand beside `exact`",
    );
}

/// Two layers in tension along their interface: no flux crosses it but for rounding, of which one layer has thrice as much as the other.
#[test]
fn a_flux_along_an_interface_does_not_jump_across_it() {
    let layer = |name: &str, material: &str, y: [f64; 2], n: usize| {
        format!(
            "[[patch]]\nname = \"{name}\"\nmaterial = \"{material}\"\ngeometry = {{ kind = \"box\", min = [0, {}], max = [2, {}] }}\nelements = [{n}, 2]\n",
            y[0], y[1]
        )
    };
    let text =
        "[model]\nphysics = \"elasticity\"\ndimension = 2\nassumption = \"plane-stress\"\nexact = { u = [\"0.1*x\", \"-0.033*y\"] }\n\
                [[material]]\nname = \"soft\"\nyoung = 1\npoisson = 0.33\n[[material]]\nname = \"stiff\"\nyoung = 3\npoisson = 0.33\n"
            .to_owned()
            + &layer("l", "soft", [0.0, 1.0], 3)
            + &layer("u", "stiff", [1.0, 2.0], 4)
            + "[[boundary]]\non = [\"l.left\", \"u.left\"]\ndirichlet = \"exact\"\n[[boundary]]\non = [\"l.right\", \"u.right\", \"l.bottom\", \"u.top\"]\n\
           neumann = \"exact\"\n[[interface]]\nname = \"i\"\nslave = \"u.bottom\"\nmaster = \"l.top\"\n";
    let result = run(&text);
    assert!(result.warnings.iter().all(|w| w.code != "E017"), "{:?}", result.warnings);
    assert!(error(&result, "error.u.L2") < 1e-12, "{:?}", result.errors);
}
