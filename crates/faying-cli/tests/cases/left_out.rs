//! Sides that are tied in part: what "all-outer" leaves out of them is told, and is as free as the note says.

use faying_cli::case::ReadOptions;
use faying_cli::errors::Diagnostic;
use faying_cli::{Case, Registry, RunResult, Status};

fn run(text: &str) -> RunResult {
    let case = Case::parse("case.toml", text, &ReadOptions::default()).unwrap_or_else(|e| panic!("{e}\n{text}"));
    let result = case.run(&Registry::default()).unwrap_or_else(|e| panic!("{e}\n{text}"));
    assert_eq!(result.status, Status::Ok, "{:?}\n{text}", result.diagnostics);
    result
}

/// u = y on boxes [0, 1] x [0, 1] and [0, `length`] x [1, 2] that are tied along their common part, all outer sides given.
fn tied(length: f64, tie: &str, rest: &str) -> RunResult {
    let block = |name: &str, max: [f64; 2], min: f64, elements: [usize; 2]| {
        format!(
            "[[patch]]\nname = \"{name}\"\ngeometry = {{ kind = \"box\", min = [0, {min}], max = [{}, {}] }}\nelements = {elements:?}\n",
            max[0], max[1]
        )
    };
    run(&("[model]\nphysics = \"poisson\"\ndimension = 2\nexact = { u = \"y\" }\n".to_owned()
        + &block("a", [1.0, 1.0], 0.0, [3, 3])
        + &block("b", [length, 2.0], 1.0, [4, 2])
        + "[[boundary]]\non = \"all-outer\"\ndirichlet = \"exact\"\n"
        + &format!("[[interface]]\nname = \"i\"\n{tie}\n")
        + rest))
}

fn note(result: &RunResult) -> Option<&Diagnostic> {
    result.warnings.iter().find(|w| w.code == "E021" && w.message.contains("all-outer"))
}

const NAMED: &str = "slave = \"a.top\"\nmaster = \"b.bottom\"";

#[test]
fn the_free_part_of_a_longer_master_is_told_with_its_share() {
    for tie in [NAMED, "between = \"all\""] {
        let longer = tied(2.5, tie, "");
        let note = note(&longer).unwrap_or_else(|| panic!("{:?}", longer.warnings));
        assert!(note.message.contains("`b.bottom` is tied in part") && note.message.contains("60 % of it"), "{note:?}");
        assert!(note.help.as_ref().is_some_and(|help| help.contains("on = \"b.bottom\" with `where`")), "{note:?}");
        assert!(note.line.is_some(), "{note:?}");
        // the part is free: du/dn = 0 in place of -1, which the solution feels
        assert!(*longer.errors.get("error.u.L2").unwrap() > 1e-2, "{:?}", longer.errors);
    }
}

#[test]
fn sides_that_are_tied_as_a_whole_or_named_elsewhere_are_not_told() {
    for tie in [NAMED, "between = \"all\""] {
        let whole = tied(1.0, tie, "");
        assert!(note(&whole).is_none() && *whole.errors.get("error.u.L2").unwrap() < 1e-12, "{:?}", whole.warnings);
    }
    // of what the tie leaves a half is named
    let half = tied(3.0, NAMED, "[[boundary]]\non = \"b.bottom\"\nwhere = \"x > 2\"\ndirichlet = \"exact\"\n");
    assert!(
        note(&half).is_some_and(|told| told.message.contains("is tied in part") && told.message.contains("leaves out the rest")),
        "{:?}",
        half.warnings
    );
    // the remedy of the help; elements of b end where the tie does
    let named = tied(2.0, NAMED, "[[boundary]]\non = \"b.bottom\"\nwhere = \"x > 1\"\ndirichlet = \"exact\"\n");
    assert!(note(&named).is_none(), "{:?}", named.warnings);
    assert!(*named.errors.get("error.u.L2").unwrap() < 1e-12, "{:?}", named.errors);
    // and without "all-outer" there is nothing that could leave it out
    let text = "[model]\nphysics = \"poisson\"\ndimension = 2\n[[patch]]\nname = \"a\"\ngeometry = { kind = \"box\", min = [0, 0], max = [1, 1] }\nelements = [2, 2]\n\
        [[patch]]\nname = \"b\"\ngeometry = { kind = \"box\", min = [0, 1], max = [2, 2] }\nelements = [2, 2]\n\
        [[boundary]]\non = \"a.bottom\"\ndirichlet = \"x\"\n[[interface]]\nname = \"i\"\nslave = \"a.top\"\nmaster = \"b.bottom\"\n";
    assert!(note(&run(text)).is_none());
}

/// Sides of which a block of loads or supports names no more than a part.
#[test]
fn the_rest_of_a_side_that_where_cuts_is_told() {
    let given = |where_: &str, given: &str| format!("[[boundary]]\non = \"b.top\"\nwhere = \"{where_}\"\n{given} = \"exact\"\n");
    let part = tied(1.0, NAMED, &given("x < 0.5", "neumann"));
    let told = note(&part).unwrap_or_else(|| panic!("{:?}", part.warnings));
    assert!(told.message.contains("`b.top` stands in another block with a part of it") && told.message.contains("50 % of it"), "{told:?}");
    assert!(told.help.as_ref().is_some_and(|help| help.contains("on = \"b.top\" with `where`")), "{told:?}");
    assert!(*part.errors.get("error.u.L2").unwrap() > 1e-2, "{:?}", part.errors);
    // both parts, by the same condition and by two, and a side that is tied where `where` does not hold
    for rest in [given("x > 0.5", "neumann"), given("x > 0.5", "dirichlet")] {
        let both = tied(1.0, NAMED, &(given("x < 0.5", "neumann") + &rest));
        assert!(note(&both).is_none() && *both.errors.get("error.u.L2").unwrap() < 1e-12, "{:?}", both.warnings);
    }
    for tie in [NAMED, "between = \"all\""] {
        let beside = tied(2.0, tie, "[[boundary]]\non = \"b.bottom\"\nwhere = \"x > 1\"\ndirichlet = \"exact\"\n");
        assert!(note(&beside).is_none_or(|told| !told.message.contains("stands")), "{:?}", beside.warnings);
    }
}
