//! Numbers of absurd size: told at their place where they overflow, taken where the results are sound.

use faying_cli::case::ReadOptions;
use faying_cli::run::{check, run};
use faying_cli::{Case, Registry, RunControl, RunOptions, RunResult, Status};

fn both(text: &str) -> [RunResult; 2] {
    let case = Case::parse("case.toml", text, &ReadOptions::default()).unwrap_or_else(|e| panic!("{e}\n{text}"));
    [check, run].map(|f| f(&case, &Registry::default(), &RunOptions::default(), &RunControl::default()).result)
}

/// A block on its lower side and what acts above, whose line is the last.
fn block(above: &str) -> String {
    format!(
        "[model]\nphysics = \"elasticity\"\ndimension = 2\n[[material]]\nname = \"m\"\nyoung = 1e3\npoisson = 0.3\n[[patch]]\nname = \"b\"\n\
         geometry = {{ kind = \"box\", min = [0, 0], max = [1, 1] }}\nelements = [3, 2]\n[[boundary]]\non = \"b.bottom\"\nfix = [\"x\", \"y\"]\n\
         [[boundary]]\non = \"b.top\"\n{above}"
    )
}

#[test]
fn data_whose_squares_overflow_are_refused_at_their_place() {
    for above in [
        "pressure = 1e308",
        "pressure = -1e160",
        "traction = { y = -1e308 }",
        "force = { y = \"1e300*x\" }",
        "rigid_force = { y = 1e308 }",
        "dirichlet = { y = -1e308 }",
        "dirichlet = { y = \"-1e308*x\" }",
        "spring = { y = 1e308 }",
    ] {
        let text = block(above);
        for result in both(&text) {
            let [found] = &result.diagnostics[..] else { panic!("{above}: {:?}", result.diagnostics) };
            assert_eq!((result.exit, found.code, found.line), (3, "E015", Some(17)), "{above}: {found:?}");
            assert!(found.message.contains("is too large at"), "{found:?}");
        }
    }
    for above in ["pressure = 1e140", "dirichlet = { y = 1e-200 }", "pressure = 1\nspring = { x = 1e200, y = 1e200 }"] {
        let [checked, run] = both(&block(above));
        assert_eq!((checked.exit, run.status), (0, Status::Ok), "{above}: {:?}", run.diagnostics);
        assert!(run.energy.is_finite(), "{above}: {:?}", run.energy);
    }
}

/// A block that its contact alone holds along y.
fn pressed(method: &str) -> String {
    block("pressure = 1").replace("bottom\"\nfix = [\"x\", \"y\"]", "left\"\nfix = [\"x\"]")
        + &format!(
            "\n[[contact]]\nname = \"pad\"\nslave = \"b.bottom\"\nrigid = {{ kind = \"half-plane\", point = [0, 0], normal = [0, 1] }}\n{method}"
        )
}

#[test]
fn a_factor_that_spoils_the_system_is_told_at_its_place() {
    let tied = |coupling: &str| {
        block("[[patch]]").replace("on = \"b.top\"\n[[patch]]", "on = \"b.left\"\nfix = [\"x\"]")
            + &format!(
                "\n[[patch]]\nname = \"a\"\ngeometry = {{ kind = \"box\", min = [0, 1], max = [1, 2] }}\nelements = [2, 2]\n\
                 [[boundary]]\non = \"a.top\"\npressure = 1\n[[interface]]\nname = \"t\"\nslave = \"b.top\"\nmaster = \"a.bottom\"\n{coupling}"
            )
    };
    for (text, code) in [
        (pressed("method = \"penalty\"\nfactor = 1e-30"), "E072"),
        (pressed("method = \"augmented\"\nfactor = 1e-30"), "E072"),
        (pressed("method = \"augmented\"\nfactor = 1e-8"), "E074"),
        (tied("coupling = \"penalty\"\nfactor = 1e-30"), "E072"),
        (tied("coupling = \"nitsche\"\nfactor = 1e30"), "E072"),
        (tied("coupling = \"nitsche\"\nfactor = 1e308"), "E073"),
    ] {
        let [checked, run] = both(&text);
        assert_eq!((checked.exit, run.exit), (0, 5), "{:?}\n{text}", checked.diagnostics);
        let [found] = &run.diagnostics[..] else { panic!("{:?}\n{text}", run.diagnostics) };
        assert_eq!((found.code, found.line), (code, Some(text.lines().count())), "{found:?}\n{text}");
        assert!(found.message.starts_with("`factor` of ") && found.message.contains("too "), "{found:?}");
    }
    for method in ["penalty", "augmented", "nitsche"] {
        for factor in ["1e30", "1e300"] {
            let [_, run] = both(&pressed(&format!("method = \"{method}\"\nfactor = {factor}")));
            assert_eq!(run.status, Status::Ok, "{method}, {factor}: {:?}", run.diagnostics);
            // rounding of the gap times such a factor is a pressure
            let told = if method == "nitsche" { 1 } else { 0 };
            assert_eq!(run.warnings.len(), told, "{method}, {factor}: {:?}", run.warnings);
            assert!(
                run.warnings.iter().all(|w| w.code == "E065" && w.message.contains("is the factor times a gap of")),
                "{:?}",
                run.warnings
            );
        }
    }
}
