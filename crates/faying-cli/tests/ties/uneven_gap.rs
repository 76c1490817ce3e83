//! Bodies that meet on an arc in chords of their own, in a linear field: what the gaps between the chords do to lambda.

use faying_cli::case::ReadOptions;
use faying_cli::{Case, Registry, RunResult};
use std::fmt::Write;

/// A mesh in Abaqus' format of the part of [-1, 1] x [-2, 2] below or above an arc of the radius 2, in `chords`.
fn body(chords: usize, is_below: bool) -> String {
    const ROWS: usize = 4;
    let mut text = String::from("*NODE\n");
    for (row, i) in (0..=ROWS).flat_map(|row| (0..=chords).map(move |i| (row, i))) {
        let angle = (30.0 * (2.0 * i as f64 / chords as f64 - 1.0)).to_radians();
        let (x, y, share) = (2.0 * angle.sin(), 2.0 * angle.cos() - 2.0, row as f64 / ROWS as f64);
        let height = if is_below { -2.0 + (y + 2.0) * share } else { y + (2.0 - y) * share };
        writeln!(text, "{}, {x}, {height}", row * (chords + 1) + i + 1).unwrap();
    }
    text += "*ELEMENT, TYPE=CPE4, ELSET=all\n";
    for e in 0..ROWS * chords {
        let first = e / chords * (chords + 1) + e % chords + 1;
        writeln!(text, "{}, {first}, {}, {}, {}", e + 1, first + 1, first + chords + 2, first + chords + 1).unwrap();
    }
    let mut side = |name: &str, face: &str, elements: &mut dyn Iterator<Item = usize>| {
        writeln!(text, "*SURFACE, NAME={name}").unwrap();
        elements.for_each(|e| writeln!(text, "{}, {face}", e + 1).unwrap());
    };
    side("bottom", "S1", &mut (0..chords));
    side("top", "S3", &mut ((ROWS - 1) * chords..ROWS * chords));
    side("left", "S4", &mut (0..ROWS).map(|row| row * chords));
    side("right", "S2", &mut (0..ROWS).map(|row| row * chords + chords - 1));
    text
}

fn tied(chords: [usize; 2], refine: usize, degree: usize, multiplier: &str) -> RunResult {
    let folder = tempfile::tempdir().unwrap();
    let mut text = format!(
        "[model]\nphysics = \"elasticity\"\ndimension = 2\nexact = {{ u = [\"x + 0.3*y\", \"0.2*x - 0.5*y\"] }}\n[discretization]\nbackend = \"fe\"\n\
         degree = {degree}\n[[material]]\nname = \"m\"\nyoung = 1\npoisson = 0.3\n"
    );
    for (name, chords, is_below) in [("a", chords[0], true), ("b", chords[1], false)] {
        std::fs::write(folder.path().join(format!("{name}.inp")), body(chords, is_below)).unwrap();
        text += &format!("[[patch]]\nname = \"{name}\"\nrefine = {refine}\ngeometry = {{ kind = \"file\", file = \"{name}.inp\" }}\n");
    }
    text += "[[boundary]]\non = [\"a.bottom\", \"a.left\", \"a.right\", \"b.left\", \"b.right\", \"b.top\"]\ndirichlet = \"exact\"\n";
    text += &format!("[[interface]]\nname = \"t\"\nslave = \"b.bottom\"\nmaster = \"a.top\"\nmultiplier = \"{multiplier}\"\n");
    let options = ReadOptions { folder: Some(folder.path().to_path_buf()), ..ReadOptions::default() };
    let case = Case::parse("case.toml", &text, &options).unwrap_or_else(|e| panic!("{e}"));
    case.run(&Registry::default()).unwrap_or_else(|e| panic!("{e}\n{text}"))
}

/// Chords of their own are no matter for functions of their size; those of halves of chords see where the other side's chords leave theirs.
#[test]
fn gaps_that_alternate_are_told_with_the_error_of_lambda() {
    for (chords, refine, degree, multiplier, is_told) in [
        ([12, 16], 0, 1, "auto", false),
        ([12, 16], 0, 2, "auto", false),
        ([12, 12], 1, 1, "auto", false),
        ([12, 16], 1, 1, "auto", true),
        ([24, 32], 1, 1, "auto", true),
        ([12, 16], 1, 1, "dual", true),
        ([5, 16], 0, 1, "auto", true),
    ] {
        let result = tied(chords, refine, degree, multiplier);
        let off = result.errors.get("error.t.lambda.L2.rel").copied().unwrap();
        let what = format!("{chords:?} {refine} {degree} {multiplier}: {off}, {:?}", result.warnings);
        let told = result.warnings.iter().find(|w| w.code == "E065" && w.message.contains("apart by unlike distances"));
        assert_eq!(told.is_some(), is_told, "{what}");
        assert!(is_told == (off > 0.1), "{what}");
        if let Some(told) = told {
            let percent: f64 = told.message.split("about ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap();
            assert!((0.6..1.6).contains(&(percent / 100.0 / off)), "{what}");
        }
    }
}
