//! `faying infsup`: rows hold the tables, verdicts follow, ends and norms are obeyed, checks decide, names from outside are known.

use crate::common::json_schema;
use faying::coupling::multiplier::PiecewiseConstant;
use faying::problem::Multiplier;
use faying_cli::Case;
use faying_cli::case::ReadOptions;
use faying_cli::infsup::{InfSupOptions, constants};
use faying_cli::{Registry, RunControl, result_schema};
use serde_json::Value;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use tempfile::TempDir;

/// Two boxes tied along y = 1, the lower one slave; both ends of the interface are prescribed.
const BOXES: &str = r#"
title = "Two boxes"
[model]
physics = "poisson"
dimension = 2
[[patch]]
name = "lower"
geometry = { kind = "box", min = [0, 0], max = [1, 1] }
elements = [8, 1]
[[patch]]
name = "upper"
geometry = { kind = "box", min = [0, 1], max = [1, 2] }
elements = [5, 1]
[[boundary]]
on = "all-outer"
dirichlet = "x"
[[interface]]
name = "seam"
slave = "lower.top"
master = "upper.bottom"
"#;

/// [`BOXES`] with free ends.
fn open() -> String {
    BOXES.replace("\"all-outer\"", "[\"lower.bottom\", \"upper.top\"]")
}

fn folder(case: &str) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("a.toml"), case).unwrap();
    folder
}

fn faying(at: &Path, words: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_faying")).current_dir(at).args(words).stdin(Stdio::null()).output().unwrap()
}

/// The document of `infsup a.toml WORDS`, its exit and its schema checked.
fn infsup(at: &Path, words: &[&str], exit: i32) -> Value {
    let all: Vec<&str> = ["infsup", "a.toml", "--json", "--force"].iter().chain(words).copied().collect();
    let out = faying(at, &all);
    let said = String::from_utf8_lossy(&out.stderr).into_owned();
    assert_eq!(out.status.code(), Some(exit), "{words:?}\n{said}\n{}", String::from_utf8_lossy(&out.stdout));
    let document: Value = serde_json::from_slice(&out.stdout).unwrap();
    let schema: Value = serde_json::from_str(&result_schema().to_string()).unwrap();
    assert_eq!(json_schema::faults(&schema, &document), Vec::<String>::new());
    document
}

fn rows(document: &Value) -> &Vec<Value> {
    document["rows"].as_array().unwrap()
}

fn beta(row: &Value) -> f64 {
    row["beta"].as_f64().unwrap()
}

#[test]
fn rows_hold_the_tables_of_straight_sides() {
    let at = folder(BOXES);
    let document = infsup(at.path(), &["--levels", "3", "--degrees", "2,3", "--pairings", "p/p,p/p-2", "--backends", "iga,fe"], 0);
    assert_eq!((document["command"].as_str(), rows(&document).len()), (Some("infsup"), 24));
    let find = |backend: &str, degree: u64, pairing: &str, level: u64| {
        rows(&document)
            .iter()
            .find(|r| r["backend"] == backend && r["degree"] == degree && r["pairing"] == pairing && r["level"] == level)
            .unwrap()
    };
    for (degree, pairing, level, printed) in [
        (2, "p/p-2", 0, 0.873201),
        (2, "p/p-2", 2, 0.873060),
        (3, "p/p-2", 0, 0.807025),
        (3, "p/p-2", 2, 0.808955),
        (2, "p/p", 0, 0.784391),
        (2, "p/p", 2, 0.784777),
        (3, "p/p", 0, 0.723276),
        (3, "p/p", 2, 0.724711),
    ] {
        let row = find("iga", degree, pairing, level);
        assert!((beta(row) - printed).abs() < 1e-6, "{degree} {pairing} {level}: {}", beta(row));
        assert!((row["parametric"].as_f64().unwrap() - printed).abs() < 1e-6);
        assert_eq!((row["verdict"].as_str(), row["side"].as_str(), row["status"].as_str()), (Some("stable"), Some("seam"), Some("ok")));
        let n = 8 << level;
        assert_eq!(row["elements"].as_u64(), Some(n));
        assert!((row["h"].as_f64().unwrap() * n as f64 - 1.0).abs() < 1e-12);
        // both ends leave the trace space
        assert_eq!(row["unknowns"]["primal"].as_u64(), Some(n + degree - 2));
        assert_eq!(row["unknowns"]["multipliers"].as_u64(), Some(n + degree - 2));
    }
    assert!((beta(find("fe", 2, "p/p-2", 1)) - 0.912871).abs() < 1e-6);
    assert!((beta(find("fe", 3, "p/p-2", 1)) - 0.836660).abs() < 1e-6);
    // ln(0.836660 / 0.912871) / ln(3 / 2) = -0.2151
    let notes: Vec<&str> = document["notes"].as_array().unwrap().iter().filter_map(Value::as_str).collect();
    assert!(notes.iter().any(|n| n.starts_with("fe, p/p-2, seam: beta ~ p^-0.22")), "{notes:?}");
    assert_eq!(notes.iter().filter(|n| n.ends_with(": stable")).count(), 8, "{notes:?}");
    let read = |name: &str| std::fs::read_to_string(at.path().join("a.infsup").join(name)).unwrap();
    assert!(read("study.csv").lines().next().unwrap().contains("side,beta,parametric,slope,verdict"));
    assert!(read("study.svg").contains("h of the slave side"));
    assert!(read("report.html").contains("stable") && read("report.html").contains("<svg"));
}

#[test]
fn ends_are_those_of_the_case_or_of_the_option() {
    let at = folder(&open());
    let full = "{ degree = 2, ends = \"full\" }";
    for (ends, pairing, verdict) in [
        ("zero", full, "unstable"),
        ("free", full, "stable"),
        ("case", full, "stable"),
        ("zero", "p/p", "stable"),
        ("zero", "p/p-1", "unstable"),
        ("free", "p/p-1", "unstable"),
        ("zero", "p/p-2", "stable"),
    ] {
        let document = infsup(at.path(), &["--levels", "4", "--ends", ends, "--pairings", pairing], 0);
        let rows = rows(&document);
        assert!(rows.iter().all(|r| r["verdict"] == verdict), "{ends} {pairing}: {rows:?}");
        match (ends, pairing) {
            ("zero", p) if p == full => assert!(rows.iter().all(|r| beta(r) == 0.0)),
            // the same space twice
            (_, p) if p == full => assert!(rows.iter().all(|r| (beta(r) - 1.0).abs() < 1e-12)),
            ("zero", "p/p") => assert!((beta(&rows[0]) - 0.784391).abs() < 1e-6),
            ("zero", "p/p-1") => assert!(rows.iter().all(|r| beta(r) < 1e-12)),
            ("free", _) => {
                assert!((beta(&rows[0]) - 0.546663).abs() < 1e-6 && (beta(&rows[2]) - 0.153938).abs() < 1e-6);
                assert!((rows[3]["rates"]["beta"].as_f64().unwrap() - 1.0).abs() < 0.02);
                assert!((rows[3]["slope"].as_f64().unwrap() - 1.0).abs() < 0.05);
            }
            _ => assert!((beta(&rows[0]) - 0.873201).abs() < 1e-6),
        }
    }
}

#[test]
fn ends_of_the_case_are_those_of_each_component() {
    let elastic = BOXES.replace("\"poisson\"", "\"elasticity\"").replace(
        "on = \"all-outer\"\ndirichlet = \"x\"",
        "on = [\"lower.left\", \"upper.left\"]\nfix = [\"x\"]\n[[boundary]]\non = \"lower.bottom\"\nfix = [\"x\", \"y\"]",
    ) + "[[material]]\nname = \"m\"\nyoung = 1\npoisson = 0.3\n";
    // one end of x is held, none of y: p/p with full ends has one function too many in x and none in y
    let case = Case::parse(
        "a.toml",
        &elastic.replace("name = \"seam\"", "name = \"seam\"\nmultiplier = { degree = 2, ends = \"full\" }"),
        &ReadOptions::default(),
    )
    .unwrap();
    let found = constants(&case, &Registry::default(), &InfSupOptions::default(), &RunControl::default()).unwrap();
    let all: Vec<(&str, usize, usize)> = found.iter().map(|c| (c.component, c.found.functions, c.found.multipliers)).collect();
    assert_eq!(all, [("x", 9, 10), ("y", 10, 10)]);
    assert!(found[0].found.beta == 0.0 && (found[1].found.beta - 1.0).abs() < 1e-12);
}

#[test]
fn checks_on_constants_decide_and_others_are_left_to_runs() {
    let check = |below: &str| {
        format!(
            "{BOXES}[[check]]\nname = \"stable\"\nquantity = \"infsup.p/p-2.beta\"\n{below}\n[[check]]\nname = \"energy\"\nquantity = \"energy\"\nabove = 1e9\n"
        )
    };
    for (bound, exit) in [("above = 0.8", 0), ("above = 0.9", 1), ("equals = 0.8732\natol = 1e-3", 0), ("below = 0.8", 1)] {
        let at = folder(&check(bound));
        let document = infsup(at.path(), &["--levels", "2"], exit);
        for row in rows(&document) {
            assert_eq!((row["checks_performed"].as_u64(), row["checks_skipped"].as_u64()), (Some(1), Some(1)));
            assert_eq!(row["status"], if exit == 0 { "ok" } else { "check-failed" });
        }
        // the pair of another check is not this one
        let document = infsup(at.path(), &["--levels", "1", "--pairings", "p/p"], 0);
        assert_eq!(rows(&document)[0]["checks_performed"].as_u64(), Some(0));
    }
}

#[test]
fn too_many_multipliers_are_an_error_of_run_and_zero_here() {
    for (degree, pairing) in [(1, "\"p/p\""), (2, "{ degree = 2, ends = \"full\" }")] {
        let text = BOXES.replace("elements = [8, 1]", &format!("elements = [1, 1]\ndegree = {degree}"));
        let at = folder(&text.replace("name = \"seam\"", &format!("name = \"seam\"\nmultiplier = {pairing}")));
        let out = faying(at.path(), &["run", "a.toml"]);
        assert_eq!(out.status.code(), Some(3));
        assert!(String::from_utf8_lossy(&out.stderr).contains("E024"));
        let document = infsup(at.path(), &["--levels", "1"], 0);
        assert_eq!((beta(&rows(&document)[0]), rows(&document)[0]["verdict"].as_str()), (0.0, Some("unstable")));
    }
}

#[test]
fn a_multiplier_from_outside_is_tested_by_its_name() {
    let mut registry = Registry::default();
    registry.plane.multipliers.add("mine", Multiplier::of(|side, _| Ok(Box::new(PiecewiseConstant::of(&*side.space)))));
    let options = ReadOptions { names: registry.case_names(), ..ReadOptions::default() };
    let case = Case::parse("a.toml", &BOXES.replace("name = \"seam\"", "name = \"seam\"\nmultiplier = \"mine\""), &options).unwrap();
    let found = constants(&case, &registry, &InfSupOptions::default(), &RunControl::default()).unwrap();
    assert_eq!((found.len(), found[0].pairing.as_deref()), (1, Some("mine")));
    // constants against quadratic splines are p/p-2
    assert!((found[0].found.beta - 0.873201).abs() < 1e-6);
}

#[test]
fn curved_sides_have_both_measures() {
    let ring = BOXES
        .replace(
            "{ kind = \"box\", min = [0, 0], max = [1, 1] }",
            "{ kind = \"annulus-sector\", center = [0, 0], radius = [1, 2], angle_deg = [0, 90] }",
        )
        .replace(
            "{ kind = \"box\", min = [0, 1], max = [1, 2] }",
            "{ kind = \"annulus-sector\", center = [0, 0], radius = [2, 3], angle_deg = [0, 90] }",
        )
        .replace("lower.top", "lower.v1")
        .replace("upper.bottom", "upper.v0")
        .replace("[[interface]]", "[discretization]\nbasis = \"b-spline\"\n[[interface]]");
    let at = folder(&ring);
    let document = infsup(at.path(), &["--levels", "4", "--backends", "iga,fe", "--pairings", "p/p,p/p-2"], 0);
    let rows = rows(&document);
    assert!(rows.iter().all(|r| r["verdict"] == "stable"), "{rows:?}");
    for row in rows.iter().filter(|r| r["backend"] == "iga") {
        assert!((beta(row) - row["parametric"].as_f64().unwrap()).abs() > 1e-9);
    }
    let straight = rows.iter().find(|r| r["backend"] == "iga" && r["pairing"] == "p/p-2" && r["level"] == 2).unwrap();
    assert!((straight["parametric"].as_f64().unwrap() - 0.873060).abs() < 1e-6);
}

#[test]
fn norms_agree_on_equal_elements_and_differ_on_graded_ones() {
    let graded = BOXES.replace("elements = [8, 1]", "elements = [[0, 0.01, 0.03, 0.1, 0.3, 1.0], 1]");
    for (text, same) in [(BOXES, true), (graded.as_str(), false)] {
        let at = folder(text);
        let find = |norm: &str| {
            let document = infsup(at.path(), &["--levels", "1", "--norm", norm, "--pairings", "p/p"], 0);
            let row = &rows(&document)[0];
            // a straight side with an affine map: its parameter is its length
            assert!((beta(row) - row["parametric"].as_f64().unwrap()).abs() < 1e-12);
            beta(row)
        };
        let (l2, half) = (find("l2"), find("h-half"));
        assert_eq!((l2 - half).abs() < 1e-12, same, "{l2} {half}");
    }
}

#[test]
fn several_interfaces_have_a_row_each_and_rows_of_other_ends_are_not_kept() {
    let third = "[[patch]]\nname = \"third\"\ngeometry = { kind = \"box\", min = [0, 2], max = [1, 3] }\nelements = [4, 1]\n";
    let text = BOXES.replace("[[boundary]]", &format!("{third}[[boundary]]"))
        + "[[interface]]\nname = \"top\"\nslave = \"third.bottom\"\nmaster = \"upper.top\"\n";
    let at = folder(&text);
    let words = ["--levels", "2", "--pairings", "p/p-1"];
    let document = infsup(at.path(), &words, 0);
    let sides: Vec<&str> = rows(&document).iter().filter_map(|r| r["side"].as_str()).collect();
    assert_eq!(sides, ["seam", "top", "seam", "top"]);
    assert!(rows(&document).iter().all(|r| beta(r) < 1e-12));
    let again = infsup(at.path(), &["--levels", "2", "--pairings", "p/p-1", "--resume"], 0);
    assert_eq!(rows(&again), rows(&document));
    let free = infsup(at.path(), &["--levels", "2", "--pairings", "p/p-1", "--resume", "--ends", "free"], 0);
    assert!(rows(&free).iter().all(|r| beta(r) > 1e-3));
}

#[test]
fn a_case_without_multipliers_is_refused() {
    let at = folder(&BOXES.replace("master =", "coupling = \"glue\"\nmaster =").replace("[5, 1]", "[8, 1]"));
    let document = infsup(at.path(), &["--levels", "1"], 3);
    assert_eq!(document["diagnostics"][0]["code"], "E063");
    assert_eq!(faying(at.path(), &["infsup", "a.toml", "--ends", "wrong"]).status.code(), Some(2));
}

#[test]
fn thousands_of_elements_need_no_bulk_problem() {
    let text = BOXES.replace("elements = [8, 1]", "elements = [4000, 1]\ndegree = 3");
    let case = Case::parse("a.toml", &text, &ReadOptions::default()).unwrap();
    let found = constants(&case, &Registry::default(), &InfSupOptions::default(), &RunControl::default()).unwrap();
    assert!(found[0].found.iterations > 0);
    assert!((found[0].found.beta - 0.808955).abs() < 1e-6, "{}", found[0].found.beta);
}
