//! What cannot be tied is refused with its place.

use super::{KINDS, stacked};
use faying_cli::case::ReadOptions;
use faying_cli::run::check;
use faying_cli::{Case, Diagnostic, Registry, RunControl, RunOptions, Severity};

/// The first error of a case, found while it is read or built, with its line of text.
fn refused(text: &str) -> (Diagnostic, String) {
    let found = match Case::parse("case.toml", text, &ReadOptions::default()) {
        Err(found) => found,
        Ok(case) => case.run(&Registry::default()).expect_err("refused"),
    };
    let first = found.items.iter().find(|d| d.severity == Severity::Error).expect("an error").clone();
    let line = first.line.unwrap_or_else(|| panic!("no place: {first:?}"));
    let text = text.lines().nth(line - 1).unwrap_or_default().to_owned();
    (first, text)
}

/// Stacked boxes of splines with changes of the text.
fn with(changes: &[(&str, &str)]) -> String {
    changes.iter().fold(stacked(false, [KINDS[0]; 2], 2, "integration = \"merged\""), |text, (from, to)| {
        assert!(text.contains(from), "{from}");
        text.replace(from, to)
    })
}

#[test]
fn sides_that_do_not_meet_or_only_in_part() {
    let apart = with(&[("min = [0, 0, 0], max = [1, 0.8, 0.6]", "min = [0, 0, 0.1], max = [1, 0.8, 0.6]")]);
    let (fault, line) = refused(&apart);
    assert!(fault.code == "E023" && fault.message.contains("are up to 0.1 apart"), "{fault:?}");
    assert!(line.starts_with("slave"), "{line}");
    let (fault, _) = refused(&with(&[("slave = \"upper.bottom\"", "slave = \"upper.top\"")]));
    assert!(fault.code == "E023" && fault.message.contains("`upper.top` and `lower.top`"), "{fault:?}");
    let shifted = with(&[("min = [0, 0, 0], max = [1, 0.8, 0.6]", "min = [0.25, 0, 0], max = [1.25, 0.8, 0.6]")]);
    let (fault, line) = refused(&shifted);
    assert!(fault.code == "E025" && fault.message.contains("only 75 % of the slave side `upper.bottom`"), "{fault:?}");
    assert!(line.starts_with("slave"), "{line}");
}

#[test]
fn names_and_roles() {
    let (fault, line) = refused(&with(&[("master = \"lower.top\"", "master = \"lower.tops\"")]));
    assert!(fault.code == "E021" && line.starts_with("master"), "{fault:?}");
    let (fault, line) = refused(&with(&[("master = \"lower.top\"", "master = \"upper.bottom\"")]));
    assert!(fault.code == "E026" && fault.message.contains("its own master") && line.starts_with("slave"), "{fault:?}");
    let twice = with(&[]) + "[[interface]]\nname = \"again\"\nslave = \"upper.bottom\"\nmaster = \"lower.top\"\n";
    assert_eq!(refused(&twice).0.code, "E026");
    let (fault, _) = refused(&(with(&[]) + "[[boundary]]\non = \"upper.bottom\"\ndirichlet = { x = \"exact\" }\n"));
    assert!(fault.code == "E024" && fault.message.contains("component x has 0 free unknowns"), "{fault:?}");
}

#[test]
fn multipliers_that_surfaces_do_not_have() {
    let (fault, line) = refused(&stacked(false, [KINDS[0], KINDS[3]], 2, "multiplier = \"dual\""));
    assert!(fault.code == "E064" && fault.message.contains("lumped weight") && line.starts_with("multiplier"), "{fault:?}");
    let simplex = stacked(false, [KINDS[0], KINDS[3]], 2, "multiplier = \"p/p-2\"");
    let (fault, line) = refused(&simplex);
    assert!(fault.code == "E064" && fault.message.contains("p/p-1") && line.starts_with("multiplier"), "{fault:?}");
    // one element loses two degrees of each direction
    let (fault, _) = refused(&stacked(false, [KINDS[0]; 2], 1, "multiplier = \"p/p\"").replace("[2, 3, 1]", "[1, 1, 1]"));
    assert!(fault.code == "E024" && fault.message.contains("edge") && fault.message.contains("(component x)"), "{fault:?}");
}

#[test]
fn quantities() {
    let asked = |quantity: &str| refused(&(with(&[]) + &format!("[[probe]]\nname = \"q\"\nquantity = \"{quantity}\"\n")));
    assert_eq!(asked("interface.seam.lambda at [0, 0, 0]").0.code, "E018");
    assert_eq!(asked("interface.seam.lambda.x at [5, 5, 5]").0.code, "E022");
    assert_eq!(asked("interface.seam.lambda.x at [0, 0]").0.code, "E018");
}

#[test]
fn a_check_builds_the_tie_without_a_solution() {
    let case = Case::parse("case.toml", &with(&[]), &ReadOptions::default()).unwrap();
    let checked = check(&case, &Registry::default(), &RunOptions::default(), &RunControl::default()).result;
    let seam = checked.interface.get("seam").unwrap();
    assert!(checked.exit == 0 && checked.predicted.is_some() && (seam.share - 1.0).abs() < 1e-12, "{:?}", checked.diagnostics);
}

/// One layer of tetrahedra with held ends: the multiplier `auto` has more functions than there are free unknowns, and what the help names works.
#[test]
fn more_functions_than_free_unknowns_and_the_ways_out() {
    let text = |choice: &str| {
        format!(
            "schema = 1\n[model]\nphysics = \"elasticity\"\ndimension = 3\n\
             [[material]]\nname = \"m\"\nyoung = 1\npoisson = 0.3\n\
             [[patch]]\nname = \"a\"\nbackend = \"fe\"\ncells = \"simplex\"\ndegree = 2\nelements = [3, 1, 1]\n\
             geometry = {{ kind = \"box\", min = [0, 0, 0], max = [1, 1, 1] }}\n\
             [[patch]]\nname = \"b\"\ndegree = 2\nelements = [3, 3, 3]\n\
             geometry = {{ kind = \"box\", min = [0, 0, 1], max = [1, 1, 2] }}\n\
             [[boundary]]\non = [\"a.v0\", \"a.v1\"]\ndirichlet = [0, 0, 0]\n\
             [[boundary]]\nname = \"top\"\non = \"b.w1\"\ntraction = [0, 0, -0.1]\n\
             [[interface]]\nname = \"seam\"\nslave = \"a.w1\"\nmaster = \"b.w0\"\n{choice}\n"
        )
    };
    for choice in ["", "multiplier = \"p/p-1\""] {
        let (fault, _) = refused(&text(choice));
        assert!(fault.code == "E024" && fault.message.contains("8 functions for 7 free unknowns"), "{fault:?}");
        let help = fault.help.unwrap();
        assert!(help.contains("take p/p") && help.contains("\"nitsche\""), "{help}");
    }
    for way in ["multiplier = \"p/p\"", "coupling = \"nitsche\""] {
        let case = Case::parse("case.toml", &text(way), &ReadOptions::default()).unwrap();
        let result = case.run(&Registry::default()).unwrap();
        assert_eq!(result.exit, 0, "{way}: {:?}", result.diagnostics);
        // the seam carries the load
        let force = result.interface.get("seam").unwrap().force[2].abs();
        assert!((force - 0.1).abs() < 1e-10, "{way}: {force}");
    }
}
