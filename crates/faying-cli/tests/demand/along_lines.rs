//! `[[line]]`: fields along straight lines, in files of runs and studies.

use std::path::PathBuf;
use std::process::{Command, Output};

/// u = x in the boxes [0, 1] and [2, 3] x [0, 1].
const BOXES: &str = "[model]\nphysics = \"poisson\"\ndimension = 2\n[[patch]]\nname = \"a\"\ngeometry = { kind = \"box\", min = [0, 0], max = [1, 1] }\n\
    elements = [2, 2]\n[[patch]]\nname = \"b\"\ngeometry = { kind = \"box\", min = [2, 0], max = [3, 1] }\nelements = [2, 2]\n\
    [[boundary]]\non = \"all-outer\"\ndirichlet = \"x\"\n";

const LINE: &str = "[[line]]\nname = \"across\"\nquantity = [\"u\", \"flux.x in b\"]\nfrom = [-0.5, 0.5]\nto = [3.5, 0.5]\nn = 9\n";

fn folder(name: &str, text: &str) -> PathBuf {
    let folder = std::env::temp_dir().join(format!("faying-along-{name}-{}", std::process::id()));
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).unwrap();
    std::fs::write(folder.join("case.toml"), text).unwrap();
    folder
}

fn faying(folder: &PathBuf, words: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_faying")).args(words).current_dir(folder).output().unwrap()
}

/// Names of the columns, and numbers row by row; NaN where a cell is empty.
fn table(text: &str) -> (Vec<String>, Vec<Vec<f64>>) {
    let mut lines = text.lines();
    let head = lines.next().unwrap().split(',').map(str::to_owned).collect();
    let number = |cell: &str| if cell.is_empty() { f64::NAN } else { cell.parse().unwrap() };
    (head, lines.map(|line| line.split(',').map(number).collect()).collect())
}

#[test]
fn a_line_is_empty_outside_of_bodies_and_has_a_table_and_a_picture() {
    let folder = folder("run", &(BOXES.to_owned() + LINE));
    let done = faying(&folder, &["run", "case.toml"]);
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    let read = |name: &str| std::fs::read_to_string(folder.join("case.out").join(name)).unwrap();
    let (head, rows) = table(&read("line_across.csv"));
    assert_eq!(head, ["s", "x", "y", "u", "flux.x in b"]);
    assert_eq!(rows.len(), 9);
    for (k, row) in rows.iter().enumerate() {
        let x = -0.5 + 0.5 * k as f64;
        assert!((row[0] - 0.5 * k as f64).abs() < 1e-15 && (row[1] - x).abs() < 1e-15 && row[2] == 0.5, "{row:?}");
        let (in_a, in_b) = ((0.0..=1.0).contains(&x), (2.0..=3.0).contains(&x));
        assert!(if in_a || in_b { (row[3] - x).abs() < 1e-13 } else { row[3].is_nan() }, "{row:?}");
        assert!(if in_b { (row[4] - 1.0).abs() < 1e-12 } else { row[4].is_nan() }, "{row:?}");
    }
    // the line of u is cut between the boxes: a stroke in each
    let svg = read("line_across.svg");
    assert!(svg.contains("flux.x in b") && svg.contains("distance from (-0.5, 0.5)"), "{svg}");
    let result: serde_json::Value = serde_json::from_str(&read("result.json")).unwrap();
    assert!((result["lines"][0]["values"][0][2].as_f64().unwrap() - 0.5).abs() < 1e-13);
    assert!(result["lines"][0]["values"][0][0].is_null());
    let listed = result["files"].as_array().unwrap().iter().filter(|f| f.as_str().unwrap().starts_with("line_")).count();
    assert_eq!(listed, 2);
    std::fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn backends_stand_beside_each_other_and_a_study_that_goes_on_keeps_them() {
    let folder = folder("compare", &(BOXES.to_owned() + LINE));
    for resume in [false, true] {
        let words = ["compare", "case.toml", "--backends", "iga,fe"];
        let done = if resume { faying(&folder, &[&words[..], &["--resume"]].concat()) } else { faying(&folder, &words) };
        assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
        let text = std::fs::read_to_string(folder.join("case.compare/line_across.csv")).unwrap();
        let (head, rows) = table(&text.replace("iga, ", "iga ").replace("fe, ", "fe ").replace('"', ""));
        assert_eq!(head.len(), 3 + 2 * 2, "{head:?}");
        assert!(head[3].starts_with("iga") && head[5].starts_with("fe"), "{head:?}");
        for row in rows.iter().filter(|row| (0.0..=1.0).contains(&row[1])) {
            assert!((row[3] - row[1]).abs() < 1e-13 && (row[5] - row[1]).abs() < 1e-13, "{row:?}");
        }
        assert!(folder.join("case.compare/line_across.svg").exists());
    }
    std::fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn a_line_outside_of_all_bodies_and_what_is_no_field_are_errors() {
    for (from, to, code, part) in [
        ("to = [3.5, 0.5]", "to = [-0.5, 9]", "E022", "no point of the line is in a body"),
        ("\"u\", \"flux.x in b\"", "\"energy\"", "E018", "no field that a line can follow"),
        ("\"u\", \"flux.x in b\"", "\"u at [0.5, 0.5]\"", "E018", "no field that a line can follow"),
        ("to = [3.5, 0.5]", "to = [-0.5, 0.5]", "E015", "the line has no length"),
    ] {
        let folder = folder("wrong", &(BOXES.to_owned() + &LINE.replace(from, to)));
        let done = faying(&folder, &["check", "case.toml"]);
        let errors = String::from_utf8_lossy(&done.stderr).into_owned();
        assert!(done.status.code() == Some(3) && errors.contains(code) && errors.contains(part), "{to}: {errors}");
        std::fs::remove_dir_all(&folder).unwrap();
    }
}

/// A bar of modulus 1000 that the traction t stretches: stress.xx = t, u.x = t x / 1000.
const BAR: &str = "units = { length = \"mm\", force = \"N\" }\n[model]\nphysics = \"elasticity\"\ndimension = 2\nassumption = \"plane-stress\"\n\
    [[material]]\nname = \"m\"\nyoung = 1000\npoisson = 0\n[[patch]]\nname = \"a\"\ngeometry = { kind = \"box\", min = [0, 0], max = [1, 1] }\nelements = [2, 2]\n\
    [[boundary]]\non = \"a.left\"\nfix = [\"x\", \"y\"]\n[[boundary]]\non = \"a.right\"\ntraction = { x = \"t\" }\n[steps]\nt = [0.25, 0.5, 1.0]\n";

fn along(name: &str, t: &str) -> String {
    format!("[[line]]\nname = \"{name}\"\nquantity = [\"u.x\", \"stress.xx\", \"strain.xx\"]\nfrom = [0, 0.5]\nto = [1, 0.5]\nn = 3\n{t}")
}

#[test]
fn lines_of_a_step_and_of_all_steps_have_its_values_and_units() {
    let text = BAR.to_owned() + &along("last", "") + &along("half", "t = 0.5\n") + &along("all", "t = \"all\"\n");
    let folder = folder("steps", &text);
    let done = faying(&folder, &["run", "case.toml"]);
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    let read = |name: &str| std::fs::read_to_string(folder.join("case.out").join(name)).unwrap();
    for (name, times) in [("last", &[1.0][..]), ("half", &[0.5]), ("all", &[0.25, 0.5, 1.0])] {
        let (head, rows) = table(&read(&format!("line_{name}.csv")));
        let label = |t: f64| if name == "last" { String::new() } else { format!("t = {t}: ") };
        let columns = times.iter().flat_map(|t| ["u.x", "stress.xx", "strain.xx"].map(|q| label(*t) + q));
        let expected: Vec<String> = ["s", "x", "y"].map(str::to_owned).into_iter().chain(columns).collect();
        assert_eq!(head, expected, "{name}");
        for (k, t) in times.iter().enumerate() {
            for row in &rows {
                let values = [1e-3 * t * row[1], *t, 1e-3 * t];
                assert!((0..3).all(|c| (row[3 + 3 * k + c] - values[c]).abs() < 1e-12), "{name}: {row:?}");
            }
        }
        let svg = read(&format!("line_{name}.svg"));
        assert!(svg.contains("u.x [mm]") && svg.contains("stress.xx [N/mm²]"), "{svg}");
        assert!(svg.contains("distance from (0, 0.5) [mm]") && !svg.contains("strain.xx ["), "{svg}");
    }
    // one report per step, each with its time; the page shows a line once
    let result: serde_json::Value = serde_json::from_str(&read("result.json")).unwrap();
    let all: Vec<(&str, Option<f64>)> =
        result["lines"].as_array().unwrap().iter().map(|l| (l["name"].as_str().unwrap(), l["t"].as_f64())).collect();
    assert_eq!(all, [("last", None), ("half", Some(0.5)), ("all", Some(0.25)), ("all", Some(0.5)), ("all", Some(1.0))]);
    assert_eq!(read("report.html").matches("Line all").count(), 1);
    // a study has the steps of its rows beside each other
    let done = faying(&folder, &["compare", "case.toml", "--backends", "iga,fe", "--out", "both"]);
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    let both = std::fs::read_to_string(folder.join("both/line_all.csv")).unwrap();
    let head = both.lines().next().unwrap();
    for t in ["0.25", "0.5", "1"] {
        assert_eq!(head.matches(&format!(", t = {t}: u.x\"")).count(), 2, "{head}");
    }
    assert!(head.contains("\"iga, degree 2, t = 0.5: u.x\"") && head.contains("\"fe, degree 2, t = 0.5: u.x\""), "{head}");
    // a time that is no step
    std::fs::write(folder.join("case.toml"), BAR.to_owned() + &along("never", "t = 0.3\n")).unwrap();
    let done = faying(&folder, &["check", "case.toml"]);
    assert!(String::from_utf8_lossy(&done.stderr).contains("error[E015]: there is no step at t = 0.3"), "{done:?}");
    std::fs::remove_dir_all(&folder).unwrap();
}
