//! Errors of bodies, boundary blocks and interfaces come together, each once and in its line; data are checked at all times and points.

use faying_cli::Case;
use faying_cli::case::ReadOptions;
use faying_cli::errors::Diagnostic;
use faying_cli::{Registry, RunResult};

const MODEL: &str = "[model]\nphysics = \"elasticity\"\ndimension = 2\n";
const STEEL: &str = "[[material]]\nname = \"m\"\nyoung = 1.0\npoisson = 0.3\n";

fn block(name: &str, min: [f64; 2], max: [f64; 2]) -> String {
    format!("[[patch]]\nname = \"{name}\"\ngeometry = {{ kind = \"box\", min = {min:?}, max = {max:?} }}\nelements = [4, 2]\n")
}

/// Two blocks on each other, the lower one held.
fn blocks() -> String {
    let (lo, up) = (block("lo", [0.0, 0.0], [1.0, 0.5]), block("up", [0.0, 0.5], [1.0, 1.0]));
    format!("{MODEL}{STEEL}{lo}{up}[[boundary]]\non = \"lo.bottom\"\nfix = [\"x\", \"y\"]\n")
}

const TIE: &str = "[[interface]]\nname = \"g\"\nslave = \"up.bottom\"\nmaster = \"lo.top\"\n";

fn run(text: &str) -> Result<RunResult, Vec<Diagnostic>> {
    let case = Case::parse("case.toml", text, &ReadOptions::default()).map_err(|e| e.items)?;
    case.run(&Registry::default()).map_err(|e| e.items)
}

/// Code, and the text of the line, of every error.
#[track_caller]
fn refused(text: &str) -> Vec<(&'static str, String)> {
    let found = run(text).expect_err("the case is wrong");
    found.iter().filter(|d| d.exit() != 0).map(|d| (d.code, d.snippet.clone().unwrap_or_default())).collect()
}

#[test]
fn errors_of_all_blocks_come_together() {
    let soft = "[[material]]\nname = \"soft\"\nyoung = 1.0\npoisson = \"0.3 + 0.3*x\"\n";
    let weak = block("weak", [5.0, 0.0], [6.0, 1.0]) + "material = \"soft\"\n";
    let far = block("far", [5.0, 3.0], [6.0, 4.0]);
    let text = blocks().replace("elements = [4, 2]\n", "elements = [4, 2]\nmaterial = \"m\"\n")
        + soft
        + &weak
        + &far.replace("elements = [4, 2]\n", "elements = [4, 2]\nmaterial = \"m\"\n")
        + TIE
        + "[[interface]]\nname = \"none\"\nbetween = [\"weak\", \"far\"]\n\
           [[boundary]]\non = \"up.top\"\nspring = { x = \"1/(x - 1/8)^0.5\" }\n\
           [[boundary]]\non = \"up.right\"\ntraction = { y = \"log(y - 2)\" }\n";
    let mut found = refused(&text);
    found.sort();
    let lines: Vec<(&str, &str)> = found.iter().map(|(code, line)| (*code, line.as_str())).collect();
    assert_eq!(
        lines,
        [
            ("E017", "spring = { x = \"1/(x - 1/8)^0.5\" }"),
            ("E017", "traction = { y = \"log(y - 2)\" }"),
            ("E023", "between = [\"weak\", \"far\"]"),
            ("E053", "poisson = \"0.3 + 0.3*x\""),
        ]
    );
}

#[test]
fn data_are_checked_at_all_times_and_points() {
    let steps = "[steps]\nt = [0.5, 1, 2]\n";
    let floor = "kind = \"half-plane\", point = [0, 2], normal = [0, -1]";
    let ball = |drive: &str| format!("[[contact]]\nname = \"k\"\nslave = \"up.top\"\nrigid = {{ {floor}, {drive} }}\n");
    let spring = |k: &str| format!("[[boundary]]\non = \"up.top\"\nspring = {{ y = \"{k}\" }}\n");
    let filter = |rule: &str| format!("[[boundary]]\non = \"up.top\"\nwhere = \"{rule}\"\npressure = 0.01\n");
    let corner = "[[boundary]]\non = \"up.u0v1\"\ndirichlet = { x = \"0.1*(t - 0.5)\" }\n[[boundary]]\non = \"up.left\"\nfix = [\"x\"]\n";
    for (tail, code) in [
        (ball("move = [0, \"1/(t - 2)\"]"), "E017"),
        (ball("force = [0, \"-1/(2 - t)\"]"), "E017"),
        (spring("x - 0.5"), "E015"),
        (spring("1.5 - t"), "E015"),
        (filter("sqrt(x - 0.5)"), "E017"),
        (filter("x < t"), "E017"),
        (corner.to_owned(), "E052"),
    ] {
        let found = refused(&format!("{}{TIE}{tail}{steps}", blocks()));
        assert_eq!(found.iter().map(|d| d.0).collect::<Vec<_>>(), [code], "{tail}: {found:?}");
        assert!(!found[0].1.is_empty(), "{tail}");
    }
}

#[test]
fn a_patch_may_be_called_all() {
    let text = |between: &str| {
        let right = block("r", [1.0, 0.5], [2.0, 1.0]);
        let text = blocks().replace("\"lo\"", "\"all\"").replace("lo.bottom", "all.bottom") + &right;
        let held = "[[boundary]]\non = \"r.right\"\nfix = [\"x\", \"y\"]\n";
        text + held + &format!("[[interface]]\nname = \"n\"\nbetween = {between}\n")
    };
    let sides = |between: &str| run(&text(between)).unwrap().interface.get("n").unwrap().sides.len();
    assert_eq!((sides("[\"all\", \"up\"]"), sides("\"all\"")), (1, 2));
}

#[test]
fn a_zone_between_the_functions_of_a_coarse_side_is_told() {
    let text = |f: &str| {
        let one = block("a", [0.0, 0.0], [1.0, 0.5]);
        let contact = format!("[[contact]]\nname = \"k\"\nslave = \"a.top\"\nrigid = {{ kind = \"level-set\", f = \"{f}\" }}\n");
        format!("{MODEL}{STEEL}{one}[[boundary]]\non = \"a.bottom\"\nfix = [\"x\", \"y\"]\n{contact}")
    };
    let told = |f: &str| {
        let result = run(&text(f)).unwrap();
        let force = result.contact.get("k").unwrap().force[1];
        (force, result.warnings.iter().filter(|d| d.code == "E065" && d.message.contains("too coarse")).count())
    };
    // 0.001 deep over 0.2 of the side; 0.001 above it
    assert_eq!(told("0.499 - y + 0.1*(x - 0.5)^2"), (0.0, 1));
    assert_eq!(told("0.501 - y + 0.1*(x - 0.5)^2"), (0.0, 0));
}

#[test]
fn what_is_held_is_not_loaded_and_parts_are_prescribed_once() {
    let side = |on: &str, rest: &str| format!("[[boundary]]\non = \"up.{on}\"\n{rest}\n");
    for (tail, wrong) in [
        (side("left", "fix = [\"normal\"]") + &side("left", "traction = { x = 1.0 }"), "traction = { x = 1.0 }"),
        (side("left", "fix = [\"normal\", \"tangential\"]") + &side("left", "pressure = 1.0"), "pressure = 1.0"),
        (side("left", "fix = [\"tangential\"]") + &side("left", "force = { y = 1.0 }"), "force = { y = 1.0 }"),
        (
            side("top", "where = \"x < 0.5\"\nfix = [\"y\"]") + &side("top", "where = \"x < 0.3\"\ndirichlet = { y = 0.1 }"),
            "dirichlet = { y = 0.1 }",
        ),
        (side("top", "fix = [\"y\"]") + &side("top", "where = \"x < 0.3\"\nforce = { y = 0.1 }"), "force = { y = 0.1 }"),
    ] {
        assert_eq!(refused(&format!("{}{TIE}{tail}", blocks())), [("E052", wrong.to_owned())]);
    }
    let overlapping = side("top", "where = \"x < 0.7\"\nfix = [\"y\"]") + &side("top", "where = \"x > 0.3\"\nfix = [\"y\"]");
    let roller = side("left", "fix = [\"normal\"]") + "[[boundary]]\non = [\"up.left\", \"up.right\"]\npressure = 0.01\n";
    for tail in [overlapping, roller, side("left", "fix = [\"normal\"]") + &side("left", "traction = [\"x\", \"1\"]")] {
        assert_eq!(run(&format!("{}{TIE}{tail}", blocks())).unwrap().exit, 0, "{tail}");
    }
    let sound =
        side("left", "fix = [\"normal\"]") + &side("left", "traction = { y = 1.0 }") + &side("top", "where = \"x < 0.5\"\nfix = [\"y\"]");
    assert_eq!(run(&format!("{}{TIE}{sound}", blocks())).unwrap().exit, 0);
}

#[test]
fn every_prescribed_value_without_a_value_is_told_in_its_line() {
    let tail = "[[boundary]]\non = \"up.left\"\nfix = [\"x\"]\n[[boundary]]\non = \"up.top\"\ndirichlet = { y = \"log(x - 0.5)\" }\n\
        [[boundary]]\non = \"up.right\"\ndirichlet = { x = \"1/(y - y)\" }\n";
    let found = refused(&format!("{}{TIE}{tail}", blocks()));
    let lines: Vec<&str> = found.iter().map(|(_, line)| line.as_str()).collect();
    assert_eq!(lines, ["dirichlet = { y = \"log(x - 0.5)\" }", "dirichlet = { x = \"1/(y - y)\" }"]);
    assert!(found.iter().all(|d| d.0 == "E017"), "{found:?}");
}

#[test]
fn gaps_and_level_sets_are_asked_at_all_times() {
    let steps = "[steps]\nt = [0.5, 1, 2]\n";
    for contact in [
        "rigid = { kind = \"half-plane\", point = [0, 1], normal = [0, -1] }\ngap = \"g + sqrt(1.5 - t)\"",
        "rigid = { kind = \"level-set\", f = \"1.01 - y + 0*sqrt(1.5 - t)\" }",
    ] {
        let text = format!("{}{TIE}{steps}[[contact]]\nname = \"k\"\nslave = \"up.top\"\n{contact}\n", blocks());
        assert!(Case::parse("case.toml", &text, &ReadOptions::default()).is_ok());
        let found = refused(&text);
        assert_eq!(found.iter().map(|d| d.0).collect::<Vec<_>>(), ["E017"], "{contact}");
    }
}
