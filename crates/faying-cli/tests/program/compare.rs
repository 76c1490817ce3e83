//! `faying compare`: rows are runs, differences and rates are right, failing rows stay, files agree with each other.

use serde_json::Value;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use tempfile::TempDir;

/// A square with a known temperature.
const SQUARE: &str = r#"
title = "A square"
[model]
physics = "poisson"
dimension = 2
exact = { u = "sin(pi*x)*y" }
[[patch]]
name = "square"
geometry = { kind = "box", min = [0, 0], max = [1, 1] }
elements = [4, 4]
[[boundary]]
on = "all-outer"
dirichlet = "exact"
[[probe]]
name = "middle"
quantity = "u at [0.5, 0.4]"
"#;

/// Two squares tied along x = 1, the left one slave.
const PAIR: &str = r#"
[model]
physics = "poisson"
dimension = 2
exact = { u = "sin(pi*x)*y" }
[[patch]]
name = "left"
geometry = { kind = "box", min = [0, 0], max = [1, 1] }
elements = [4, 4]
[[patch]]
name = "right"
geometry = { kind = "box", min = [1, 0], max = [2, 1] }
elements = [3, 3]
[[boundary]]
on = ["left.bottom", "left.top", "left.left", "right.bottom", "right.top", "right.right"]
dirichlet = "exact"
[[interface]]
name = "seam"
slave = "left.right"
master = "right.left"
"#;

fn folder(case: &str) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("a.toml"), case).unwrap();
    folder
}

fn faying(at: &Path, words: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_faying")).current_dir(at).args(words).stdin(Stdio::null()).output().unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

/// Exit code and document of a command with `--json`.
fn told(at: &Path, words: &[&str]) -> (i32, Value) {
    let out = faying(at, &[words, &["--json"]].concat());
    let document = serde_json::from_slice(&out.stdout).unwrap_or_else(|e| panic!("{e}: {} {}", text(&out.stdout), text(&out.stderr)));
    (out.status.code().unwrap(), document)
}

fn names(document: &Value) -> Vec<&str> {
    document["rows"].as_array().unwrap().iter().map(|r| r["name"].as_str().unwrap()).collect()
}

#[test]
fn a_row_says_what_a_run_with_its_backend_says() {
    let at = folder(SQUARE);
    let (exit, study) = told(at.path(), &["compare", "a.toml"]);
    assert_eq!((exit, names(&study)), (0, vec!["iga", "fe"]));
    assert_eq!((study["command"].as_str(), study["schema"].as_str()), (Some("compare"), Some("faying.result/1")));
    for (k, backend) in ["iga", "fe"].into_iter().enumerate() {
        let (_, run) = told(at.path(), &["run", "a.toml", "--backend", backend, "--out", backend]);
        let row = &study["rows"][k];
        for key in ["backend", "backends", "unknowns", "energy", "errors", "probes", "checks", "status"] {
            assert_eq!(row[key], run[key], "{backend}: {key}");
        }
        assert_eq!(row["elements"], 16);
        // the diagonal of a quarter
        assert!((row["h"].as_f64().unwrap() - 0.125f64.sqrt()).abs() < 1e-14);
        assert_eq!((row["degree"].as_i64(), row["level"].as_i64()), (Some(2), Some(0)));
    }
    // 1D splines of degree 2 on 4 elements have 6 functions, quadratic elements 9
    assert_eq!(study["rows"][0]["unknowns"]["primal"], 36);
    assert_eq!(study["rows"][1]["unknowns"]["primal"], 81);
    let out = faying(at.path(), &["compare", "a.toml", "--force"]);
    let shown = text(&out.stdout);
    assert!(shown.contains("middle") && shown.lines().any(|l| l.starts_with("iga ") && l.contains(" 36 ")), "{shown}");
}

#[test]
fn differences_are_relative_to_the_first_row_and_decide_with_a_tolerance() {
    let at = folder(SQUARE);
    let (exit, study) = told(at.path(), &["compare", "a.toml", "--quantity", "middle,energy"]);
    assert_eq!(exit, 0);
    let value = |k: usize, n: usize| study["rows"][k]["probes"][n]["value"].as_f64().unwrap();
    for (n, name) in ["middle", "energy"].into_iter().enumerate() {
        let (a, b) = (value(0, n), value(1, n));
        let found = study["rows"][1]["differences"][name].as_f64().unwrap();
        assert!(found > 0.0 && (found - (a - b).abs() / a.abs().max(b.abs())).abs() < 1e-15, "{name}: {found}");
    }
    assert_eq!(study["rows"][1]["probes"][1]["value"], study["rows"][1]["energy"]);
    let found = study["rows"][1]["differences"]["energy"].as_f64().unwrap();
    let below = format!("{:e}", 0.999 * found);
    let above = format!("{:e}", 1.001 * found);
    let (exit, study) = told(at.path(), &["compare", "a.toml", "--quantity", "energy", "--tol", &below]);
    assert_eq!((exit, study["status"].as_str(), study["differences"][0]["ok"].as_bool()), (1, Some("check-failed"), Some(false)));
    let (exit, study) = told(at.path(), &["compare", "a.toml", "--quantity", "energy", "--tol", &above]);
    assert_eq!((exit, study["status"].as_str(), study["differences"][0]["ok"].as_bool()), (0, Some("ok"), Some(true)));
}

#[test]
fn a_case_that_mixes_backends_comes_first_as_it_is_written() {
    let at = folder(PAIR);
    assert_eq!(names(&told(at.path(), &["compare", "a.toml"]).1), ["iga", "fe"]);
    let mixed = ["--set", "patch.right.backend=fe"];
    let (exit, study) = told(at.path(), &[&["compare", "a.toml", "--backends", "iga,fe,iga+fe,fe+iga"], &mixed[..]].concat());
    assert_eq!((exit, names(&study)), (0, vec!["as written", "iga", "fe", "iga+fe", "fe+iga"]));
    let rows = &study["rows"];
    // the left patch is slave
    let backends = |k: usize| (rows[k]["backends"]["left"].as_str().unwrap(), rows[k]["backends"]["right"].as_str().unwrap());
    assert_eq!([0, 1, 2, 3, 4].map(backends), [("iga", "fe"), ("iga", "iga"), ("fe", "fe"), ("iga", "fe"), ("fe", "iga")]);
    assert_eq!(rows[0]["energy"], rows[3]["energy"]);
    assert_eq!((rows[0]["backend"].as_str(), rows[4]["backend"].as_str()), (Some("iga+fe"), Some("fe+iga")));
    assert_eq!(rows[0]["unknowns"], rows[3]["unknowns"]);
    assert_ne!(rows[3]["unknowns"], rows[4]["unknowns"]);
}

#[test]
fn a_row_for_two_backends_of_a_case_without_slaves_is_the_second_backend() {
    let at = folder(SQUARE);
    let (exit, study) = told(at.path(), &["compare", "a.toml", "--backends", "fe,iga+fe"]);
    assert_eq!(exit, 0);
    assert_eq!(study["rows"][0]["energy"], study["rows"][1]["energy"]);
}

#[test]
fn levels_halve_elements_and_rates_are_those_of_theory() {
    let at = folder(SQUARE);
    let (exit, study) = told(at.path(), &["compare", "a.toml", "--levels", "4", "--degrees", "1,2", "--degrees", "iga:3"]);
    assert_eq!(exit, 0);
    let rows = study["rows"].as_array().unwrap();
    let place: Vec<(i64, i64)> = rows.iter().map(|r| (r["degree"].as_i64().unwrap(), r["level"].as_i64().unwrap())).collect();
    let expected: Vec<(i64, i64)> = [3, 1, 2].into_iter().flat_map(|p| (0..4).map(move |l| (p, l))).collect();
    assert_eq!(place, expected);
    for k in 0..rows.len() {
        let (row, level) = (&rows[k], place[k].1);
        assert_eq!(row["elements"], 16 << (2 * level));
        if level == 0 {
            assert_eq!(row["rates"].as_object().unwrap().len(), 0);
            continue;
        }
        for (name, order) in [("error.u.L2", place[k].0 + 1), ("error.u.H1", place[k].0), ("error.u.energy", place[k].0)] {
            let e = |r: &Value| r["errors"][name].as_f64().unwrap();
            let rate = row["rates"][name].as_f64().unwrap();
            assert!((rate - (e(&rows[k - 1]) / e(row)).log2()).abs() < 1e-12);
            if level == 3 {
                assert!((rate - order as f64).abs() < 0.1, "{name}, degree {}: {rate}", place[k].0);
            }
        }
    }
    // values converge, too: their changes fall with a rate
    assert!(rows[3]["rates"]["middle"].as_f64().unwrap() > 2.5);
}

/// A field that every level holds: its errors are rounding, and grow.
#[test]
fn errors_that_are_rounding_have_no_rates() {
    let at = folder(&PAIR.replace("sin(pi*x)*y", "x + 2*y"));
    let (exit, study) = told(at.path(), &["compare", "a.toml", "--levels", "3"]);
    assert_eq!(exit, 0);
    for row in study["rows"].as_array().unwrap() {
        assert!(row["errors"]["error.u.L2.rel"].as_f64().unwrap() < 1e-13, "{row}");
        assert!(row["rates"].get("error.u.L2").is_none(), "{row}");
    }
}

#[test]
fn checks_on_rates_are_decided_on_the_last_level() {
    let check = |bound: f64| format!("{SQUARE}[[check]]\nname = \"order\"\nquantity = \"rate.error.u.L2\"\nabove = {bound}\n");
    for (bound, exit) in [(2.9, 0), (3.5, 1)] {
        let at = folder(&check(bound));
        let (found, study) = told(at.path(), &["compare", "a.toml", "--levels", "3", "--backends", "fe"]);
        assert_eq!(found, exit);
        let report = |k: usize| &study["rows"][k]["checks"][0];
        assert_eq!((report(0)["skipped"].as_bool(), report(1)["skipped"].as_bool()), (Some(true), Some(true)));
        assert_eq!(
            (report(2)["ok"].as_bool(), report(2)["value"].as_f64()),
            (Some(exit == 0), study["rows"][2]["rates"]["error.u.L2"].as_f64())
        );
        // one level has no rate
        assert_eq!(told(at.path(), &["compare", "a.toml", "--backends", "fe", "--force"]).0, 0);
    }
}

#[test]
fn keys_vary_and_the_study_of_the_case_is_the_default() {
    let at = folder(&format!("{SQUARE}[study.compare]\nbackends = [\"fe\"]\nlevels = 2\nvary = \"patch.square.elements=[2, 3],[4, 4]\"\n"));
    let (exit, study) = told(at.path(), &["compare", "a.toml"]);
    assert_eq!(exit, 0);
    let elements: Vec<i64> = study["rows"].as_array().unwrap().iter().map(|r| r["elements"].as_i64().unwrap()).collect();
    assert_eq!(elements, [6, 24, 16, 64]);
    assert_eq!(study["rows"][0]["vary"]["patch.square.elements"], "[2, 3]");
    let (_, study) =
        told(at.path(), &["compare", "a.toml", "--levels", "1", "--vary", "discretization.mapping=exact,isoparametric", "--force"]);
    assert_eq!(study["rows"].as_array().unwrap().len(), 2);
}

#[test]
fn a_failing_row_stays_in_the_table_and_the_next_rows_are_solved() {
    // fe goes up to degree 8
    let at = folder(SQUARE);
    let (exit, study) = told(at.path(), &["compare", "a.toml", "--backends", "fe,iga", "--degrees", "9"]);
    assert_eq!((exit, study["status"].as_str()), (3, Some("invalid")));
    let row = |k: usize| (study["rows"][k]["status"].as_str().unwrap(), study["rows"][k]["exit"].as_i64().unwrap());
    assert_eq!([row(0), row(1)], [("invalid", 3), ("ok", 0)]);
    assert!(study["rows"][0]["energy"].is_null() && study["rows"][0]["reason"].is_string());
    assert!(study["diagnostics"][0]["message"].as_str().unwrap().contains("row fe"));
    assert!(at.path().join("a.compare/result.json").is_file());
    // nothing compares with a row that has no value
    let (_, study) = told(at.path(), &["compare", "a.toml", "--backends", "fe,iga", "--degrees", "9", "--tol", "1", "--force"]);
    assert_eq!((study["differences"][0]["ok"].as_bool(), study["differences"][0]["largest"].as_f64()), (Some(false), None));
    let csv = std::fs::read_to_string(at.path().join("a.compare/study.csv")).unwrap();
    let code = study["rows"][0]["code"].as_str().unwrap();
    assert!(csv.lines().nth(1).unwrap().ends_with(&format!(",invalid,3,{code}")), "{csv}");
    assert!(csv.lines().nth(1).unwrap().starts_with("fe,fe,9,0,"), "{csv}");
    assert_eq!((study["rows"][0]["degree"].as_i64(), study["rows"][1]["code"].is_null()), (Some(9), true));
}

#[test]
fn checks_hold_in_every_row_but_those_of_one_backend_there_alone() {
    let at = folder(&format!("{SQUARE}[[check]]\nname = \"many\"\nquantity = \"unknowns\"\nabove = 50\n"));
    let (exit, study) = told(at.path(), &["compare", "a.toml"]);
    assert_eq!((exit, study["rows"][0]["status"].as_str(), study["rows"][1]["status"].as_str()), (1, Some("check-failed"), Some("ok")));
    let at = folder(&format!("{SQUARE}[[check]]\nname = \"many\"\nquantity = \"unknowns\"\nabove = 50\nbackend = \"fe\"\n"));
    let (exit, study) = told(at.path(), &["compare", "a.toml"]);
    assert_eq!((exit, study["rows"][0]["checks_skipped"].as_i64(), study["rows"][1]["checks_performed"].as_i64()), (0, Some(1), Some(1)));
}

/// Fields of a line of comma-separated values.
fn fields(line: &str) -> Vec<String> {
    let (mut out, mut quoted) = (vec![String::new()], false);
    for c in line.chars() {
        match c {
            '"' => quoted = !quoted,
            ',' if !quoted => out.push(String::new()),
            c => out.last_mut().unwrap().push(c),
        }
    }
    out
}

#[test]
fn the_csv_has_the_numbers_of_the_json_and_the_folder_is_whole() {
    let at = folder(PAIR);
    let words = ["compare", "a.toml", "--levels", "2", "--quantity", "u at [0.5, 0.5],interface.seam.lambda at [1, 0.5]"];
    let (exit, study) = told(at.path(), &words);
    assert_eq!(exit, 0);
    let out = at.path().join("a.compare");
    let csv = std::fs::read_to_string(out.join("study.csv")).unwrap();
    let head = fields(csv.lines().next().unwrap());
    let rows = study["rows"].as_array().unwrap();
    assert_eq!(csv.lines().count(), rows.len() + 1);
    for (line, row) in csv.lines().skip(1).zip(rows) {
        let cells = fields(line);
        assert_eq!(cells.len(), head.len());
        for (name, cell) in head.iter().zip(&cells) {
            let json = if let Some(n) = name.strip_prefix("rate.") {
                &row["rates"][n]
            } else if name.starts_with("error.") {
                &row["errors"][name]
            } else if let Some(n) = name.strip_prefix("probes.") {
                row["probes"].as_array().unwrap().iter().find(|p| p["name"] == n).map(|p| &p["value"]).unwrap()
            } else if let Some(n) = name.strip_prefix("differences.") {
                &row["differences"][n]
            } else {
                name.split('.').fold(row, |v, key| &v[key])
            };
            match json {
                Value::Null => assert_eq!(cell, "", "{name}"),
                Value::String(s) => assert_eq!(cell, s, "{name}"),
                number => {
                    // the JSON parser of this test rounds to within one unit of the last place
                    let (a, b) = (cell.parse::<f64>().unwrap(), number.as_f64().unwrap());
                    assert!((a - b).abs() <= f64::EPSILON * b.abs(), "{name}: {a:e} and {b:e}");
                }
            }
        }
    }
    assert!(head.contains(&"probes.u at [0.5, 0.5]".to_owned()) && head.contains(&"rate.error.u.L2".to_owned()), "{head:?}");
    let manifest: Value = serde_json::from_slice(&std::fs::read(out.join("manifest.json")).unwrap()).unwrap();
    let mut listed: Vec<&str> = manifest["files"].as_array().unwrap().iter().map(|f| f.as_str().unwrap()).collect();
    listed.sort_unstable();
    let mut there: Vec<String> = std::fs::read_dir(&out).unwrap().map(|f| f.unwrap().file_name().into_string().unwrap()).collect();
    there.sort_unstable();
    assert_eq!(listed, there);
    assert_eq!(manifest["command"], "compare");
    let timed = manifest["seconds"].as_array().unwrap().iter().filter(|s| s["phase"].as_str().unwrap().starts_with("row ")).count();
    assert_eq!(timed, rows.len());
    let svg = std::fs::read_to_string(out.join("study.svg")).unwrap();
    assert!(svg.contains("iga, degree 2: rate ") && svg.contains("fe, degree 2: rate ") && svg.contains("error.u.L2"));
    let page = std::fs::read_to_string(out.join("report.html")).unwrap();
    assert!(page.contains("<svg") && page.contains("</table>") && !page.contains("src=") && !page.contains("href="));
}

#[test]
fn files_are_the_same_at_any_number_of_threads() {
    let at = folder(PAIR);
    let words = |n: &'static str| ["compare", "a.toml", "--backends", "iga,fe,iga+fe", "--levels", "2", "--threads", n, "--out", n];
    assert_eq!(faying(at.path(), &words("1")).status.code(), Some(0));
    assert_eq!(faying(at.path(), &words("2")).status.code(), Some(0));
    for file in ["result.json", "study.csv", "study.svg", "report.html"] {
        let read = |n: &str| std::fs::read(at.path().join(n).join(file)).unwrap();
        assert!(read("1") == read("2"), "{file}");
    }
}

#[test]
fn pairs_of_backends_follow_the_slave_that_between_chooses() {
    // the left patch is the finer one and slave
    let named = folder(PAIR);
    let found = folder(&PAIR.replace("slave = \"left.right\"\nmaster = \"right.left\"", "between = \"all\""));
    let study = |at: &TempDir| told(at.path(), &["compare", "a.toml", "--backends", "iga+fe,fe+iga"]);
    let ((exit, a), (_, b)) = (study(&found), study(&named));
    assert_eq!(exit, 0, "{a}");
    for k in 0..2 {
        assert_eq!(a["rows"][k]["backends"], b["rows"][k]["backends"]);
        assert_eq!(a["rows"][k]["energy"], b["rows"][k]["energy"]);
    }
    assert_eq!((a["rows"][0]["backends"]["left"].as_str(), a["rows"][1]["backends"]["left"].as_str()), (Some("iga"), Some("fe")));
}

#[test]
fn wrong_words_are_refused_before_anything_is_solved() {
    let at = folder(SQUARE);
    for (words, exit, error) in [
        (&["--backends", "iga,fem"][..], 2, "unknown backend `fem`"),
        (&["--backends", "iga+fem"], 2, "unknown backend `fem`"),
        (&["--backends", "fe,iga,fe"], 2, "`fe` is named twice"),
        (&["--degrees", "two"], 2, "is no list of degrees"),
        (&["--vary", "degree"], 2, "KEY=v1,v2"),
        (&["--levels", "0"], 2, "--levels"),
        (&["--tol=-1"], 2, "--tol"),
        (&["--tol", "1e-3", "--backends", "fe"], 2, "there is one row"),
        (&["--pairings", "p/p"], 3, "E063"),
        (&["--pairings", "p/q"], 2, "unknown multiplier `p/q`"),
        (&["--integration", "gauss"], 2, "unknown integration `gauss`"),
        (&["--extra-points", "0,61"], 2, "`61` is no number of points"),
        (&["--extra-points", "1,1"], 2, "`1` is named twice"),
        (&["--degrees", "2,2"], 2, "degree 2 is named twice"),
        (&["--vary", "let.a=1,1"], 2, "`1` is named twice"),
        (&["--quantity", "enrgy"], 3, "enrgy"),
        (&["--set", "patch.square.degree=\"x\""], 3, "E014"),
    ] {
        let out = faying(at.path(), &[&["compare", "a.toml"], words].concat());
        assert_eq!(out.status.code(), Some(exit), "{words:?} {}", text(&out.stderr));
        assert!(text(&out.stderr).contains(error), "{words:?} {}", text(&out.stderr));
        assert!(!at.path().join("a.compare").exists(), "{words:?}");
    }
    std::fs::create_dir(at.path().join("a.compare")).unwrap();
    std::fs::write(at.path().join("a.compare/mine.txt"), "mine").unwrap();
    let out = faying(at.path(), &["compare", "a.toml"]);
    assert_eq!((out.status.code(), text(&out.stderr).contains("E090")), (Some(4), true));
}

#[test]
fn a_row_that_cannot_be_read_says_what_it_would_have_been() {
    let at = folder(SQUARE);
    // degree 9 is too high for fe
    let words =
        ["compare", "a.toml", "--backends", "fe", "--degrees", "2,9", "--levels", "2", "--vary", "patch.square.elements=[2, 2],[3, 2]"];
    let (exit, study) = told(at.path(), &words);
    assert_eq!(exit, 3);
    let rows = study["rows"].as_array().unwrap();
    let found: Vec<(i64, i64, &str, bool)> = rows
        .iter()
        .map(|r| {
            let vary = r["vary"]["patch.square.elements"].as_str().unwrap();
            (r["degree"].as_i64().unwrap(), r["level"].as_i64().unwrap(), vary, r["code"].is_string())
        })
        .collect();
    let of = |keys: &'static str| [(2, 0, keys, false), (2, 1, keys, false), (9, 0, keys, true), (9, 1, keys, true)];
    assert_eq!(found, [of("[2, 2]"), of("[3, 2]")].concat());
    let shown = text(&faying(at.path(), &[&words[..], &["--force"]].concat()).stdout);
    assert_eq!(shown.matches(&format!("invalid ({})", rows[2]["code"].as_str().unwrap())).count(), 4, "{shown}");
}

/// Two triangles of a unit square.
const MESH: &str = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n2\n1 1 \"rim\"\n2 2 \"body\"\n$EndPhysicalNames\n\
$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n$EndNodes\n\
$Elements\n6\n1 1 2 1 1 1 2\n2 1 2 1 1 2 3\n3 1 2 1 1 3 4\n4 1 2 1 1 4 1\n5 2 2 2 1 1 2 3\n6 2 2 2 1 1 3 4\n$EndElements\n";

#[test]
fn a_patch_that_is_read_from_a_mesh_stays_with_fe_and_a_warning_says_so() {
    let at = folder(
        "[model]\nphysics = \"poisson\"\ndimension = 2\nexact = { u = \"sin(pi*x)*y\" }\n[[patch]]\nname = \"a\"\n\
         geometry = { kind = \"file\", file = \"a.msh\" }\nrefine = 2\n[[boundary]]\non = \"a.rim\"\ndirichlet = \"exact\"\n",
    );
    std::fs::write(at.path().join("a.msh"), MESH).unwrap();
    let (exit, study) = told(at.path(), &["compare", "a.toml", "--backends", "iga,fe,iga+fe", "--degrees", "iga:5", "--degrees", "fe:2"]);
    assert_eq!((exit, names(&study)), (0, vec!["iga", "fe", "iga+fe"]), "{study}");
    for row in study["rows"].as_array().unwrap() {
        assert_eq!((row["backends"]["a"].as_str(), row["degree"].as_i64(), row["elements"].as_i64()), (Some("fe"), Some(2), Some(32)));
        assert_eq!(row["errors"], study["rows"][1]["errors"]);
    }
    let warning = study["warnings"][0]["message"].as_str().unwrap();
    assert!(warning.contains("stays with backend \"fe\"") && warning.contains("row iga"), "{warning}");
    let manifest: Value = serde_json::from_slice(&std::fs::read(at.path().join("a.compare/manifest.json")).unwrap()).unwrap();
    assert_eq!(manifest["inputs"].as_array().unwrap().len(), 2);
}
