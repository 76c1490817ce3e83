//! `faying convergence`, `quadrature`, `sweep`: every axis, tables of the case, rates, failing rows, exit codes, pictures, `--resume`.

use faying_cli::Case;
use faying_cli::case::ReadOptions;
use faying_cli::studies::{Axes, Base, Runs, StoredRows, Study, StudyPlan, html, picture};
use faying_cli::{Registry, RunControl};
use quick_xml::Reader;
use quick_xml::events::Event;
use serde_json::Value;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::sync::atomic::Ordering;
use tempfile::TempDir;

/// A square with a known temperature.
const SQUARE: &str = r#"
title = "A <square> & its \"temperature\""
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

fn rows(document: &Value) -> &[Value] {
    document["rows"].as_array().unwrap_or_else(|| panic!("{document}"))
}

fn file(at: &Path, name: &str) -> String {
    std::fs::read_to_string(at.join(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
}

/// Parses a document as XML: tags match and every attribute is quoted. Returns the names of its elements.
fn elements(document: &str) -> Vec<String> {
    let (mut reader, mut open, mut names) = (Reader::from_str(document), 0_i32, Vec::new());
    loop {
        let event = reader.read_event().unwrap_or_else(|e| panic!("byte {}: {e}", reader.buffer_position()));
        match &event {
            Event::Start(tag) | Event::Empty(tag) => {
                tag.attributes().for_each(|a| assert!(!a.unwrap().value.contains(&b'<')));
                names.push(String::from_utf8(tag.name().as_ref().to_vec()).unwrap());
                open += i32::from(matches!(event, Event::Start(_)));
            }
            Event::End(_) => open -= 1,
            Event::Eof => break,
            _ => {}
        }
    }
    assert_eq!(open, 0);
    names
}

#[test]
fn the_poisson_sample_converges_at_the_rates_of_theory_on_both_backends() {
    let at = tempfile::tempdir().unwrap();
    assert_eq!(faying(at.path(), &["new", "poisson-arc"]).status.code(), Some(0));
    let words = ["convergence", "poisson-arc.toml", "--levels", "4", "--backends", "iga,fe", "--degrees", "2,3"];
    let coarser = ["--set", "patch.0.elements=[6, 4]", "--set", "check.error.below=1", "--set", "check.gradient-error.below=10"];
    let (exit, study) = told(at.path(), &[&words[..], &coarser].concat());
    assert_eq!((exit, study["command"].as_str(), rows(&study).len()), (0, Some("convergence"), 2 * 2 * 4), "{study}");
    for line in rows(&study).chunks(4) {
        let p = line[0]["degree"].as_f64().unwrap();
        for (k, row) in line.iter().enumerate() {
            assert_eq!((row["level"].as_u64(), row["status"].as_str()), (Some(k as u64), Some("ok")));
        }
        for (name, order) in [("error.u.L2", p + 1.0), ("error.u.H1", p)] {
            let rate = line[3]["rates"][name].as_f64().unwrap();
            assert!(rate > order - 0.1, "{} degree {p}, {name}: {rate}", line[0]["name"]);
        }
    }
    let out = at.path().join("poisson-arc.convergence");
    let svg = file(&out, "study.svg");
    // a triangle for every order that occurs: its number stands beside it, a 1 below
    let words: Vec<&str> = svg.split("<text").filter_map(|t| Some(t.split_once('>')?.1.split('<').next()?.trim())).collect();
    assert!(words.iter().filter(|w| **w == "1").count() >= 4, "{words:?}");
    assert!(words.contains(&"3") && words.contains(&"4") && words.contains(&"2"), "{words:?}");
    for panel in ["error.u.L2", "error.u.H1", "unknowns", "h, largest diameter of an element"] {
        assert!(words.contains(&panel), "{panel}: {words:?}");
    }
    assert!(elements(&svg).contains(&"svg".to_owned()));
    let page = file(&out, "report.html");
    assert!(page.contains("the L2 error of u falls like h^3.0 (last rates "), "{page}");
}

#[test]
fn the_page_is_well_formed_and_whole_in_itself() {
    let at = folder(&format!("{SQUARE}[[check]]\nname = \"order\"\nquantity = \"rate.error.u.L2\"\nabove = 2.9\n"));
    let (exit, study) = told(at.path(), &["convergence", "a.toml", "--levels", "3", "--backends", "iga,fe", "--degrees", "1,2"]);
    assert_eq!(exit, 1, "{study}");
    let page = file(&at.path().join("a.convergence"), "report.html");
    let names = elements(&page);
    for name in ["html", "h1", "svg", "table", "caption", "figure", "ul", "main"] {
        assert!(names.iter().any(|n| n == name), "{name}");
    }
    assert_eq!(names.iter().filter(|n| *n == "tr").count(), 1 + 12 + 1 + 4);
    for outside in ["http:", "https:", "src=", "href=", "url(", "@import", "<script", "<link"] {
        assert!(!page.contains(outside), "{outside}");
    }
    for inside in [
        "A &lt;square&gt; &amp; its &quot;temperature&quot;",
        "prefers-color-scheme:dark",
        "@media print",
        "aria-label=",
        "scope=\"col\"",
        "class=\"bad\"",
        "rate.error.u.L2",
        "faying convergence a.toml --levels 3 --backends iga,fe --degrees 1,2<",
        "Varied: backends iga, fe; degrees 1, 2; levels 0 to 2",
    ] {
        assert!(page.contains(inside), "{inside}");
    }
}

#[test]
fn checks_on_rates_are_decided_in_the_last_level_of_every_line() {
    let check = |above: f64| format!("{SQUARE}[[check]]\nname = \"order\"\nquantity = \"rate.error.u.L2\"\nabove = {above}\n");
    // degree 1 has order 2, degree 2 order 3
    for (above, exit, found) in [(1.8, 0, [true, true]), (2.8, 1, [false, true]), (3.8, 1, [false, false])] {
        let at = folder(&check(above));
        let (code, study) = told(at.path(), &["convergence", "a.toml", "--levels", "3", "--degrees", "1,2"]);
        assert_eq!(code, exit, "{study}");
        for (k, row) in rows(&study).iter().enumerate() {
            let report = &row["checks"][0];
            assert_eq!(report["skipped"].as_bool().unwrap_or(false), k % 3 != 2);
            if k % 3 == 2 {
                assert_eq!((report["ok"].as_bool(), report["value"].as_f64()), (Some(found[k / 3]), row["rates"]["error.u.L2"].as_f64()));
            }
        }
    }
}

#[test]
fn other_checks_are_decided_on_the_case_as_written() {
    let at = folder(&format!("{SQUARE}[[check]]\nname = \"small\"\nquantity = \"unknowns\"\nbelow = 40\n"));
    // 36 unknowns as written, more on finer levels
    let (exit, study) = told(at.path(), &["convergence", "a.toml", "--levels", "3", "--backends", "iga,fe", "--degrees", "2"]);
    let skipped: Vec<bool> = rows(&study).iter().map(|r| r["checks"][0]["skipped"].as_bool().unwrap_or(false)).collect();
    assert_eq!((exit, skipped), (0, vec![false, true, true, true, true, true]), "{study}");
    assert_eq!(rows(&study)[0]["checks"][0]["value"].as_f64(), Some(36.0));
    let (exit, study) =
        told(at.path(), &["sweep", "a.toml", "--vary", "patch.square.elements=[3, 3],[4, 4],[5, 5]", "--set", "check.small.below=30"]);
    let skipped: Vec<bool> = rows(&study).iter().map(|r| r["checks"][0]["skipped"].as_bool().unwrap_or(false)).collect();
    assert_eq!((exit, skipped), (1, vec![true, false, true]), "{study}");
    assert_eq!(rows(&study)[2]["status"], "ok");
}

#[test]
fn without_an_exact_solution_changes_have_rates() {
    let case = SQUARE
        .replace("exact = { u = \"sin(pi*x)*y\" }", "source = \"2*pi^2*sin(pi*x)*sin(pi*y)\"")
        .replace("dirichlet = \"exact\"", "dirichlet = \"0\"");
    let at = folder(&case);
    let (exit, study) = told(at.path(), &["convergence", "a.toml", "--quantity", "energy"]);
    assert_eq!((exit, rows(&study).len()), (0, 5), "{study}");
    // energies converge at twice the order of the energy norm
    let rate = rows(&study)[4]["rates"]["energy"].as_f64().unwrap();
    assert!((rate - 4.0).abs() < 0.2, "{rate}");
    let out = at.path().join("a.convergence");
    assert!(file(&out, "study.svg").contains("change of energy from the level before"));
    assert!(file(&out, "report.html").contains("the differences of energy between levels fall like h^4.0"));
}

#[test]
fn every_axis_of_a_side_changes_the_case_of_its_rows() {
    let at = folder(PAIR);
    let words = ["convergence", "a.toml", "--levels", "2", "--pairings", "p/p,p/p-2,{ degree = 1 }", "--extra-points", "0,3"];
    let (exit, study) = told(at.path(), &[&words[..], &["--integration", "merged", "--degrees", "3"]].concat());
    assert_eq!((exit, rows(&study).len()), (0, 3 * 2 * 2), "{study}");
    let place = |r: &Value| {
        (
            r["pairing"].as_str().unwrap().to_owned(),
            r["extra_points"].as_u64().unwrap(),
            r["level"].as_u64().unwrap(),
            r["integration"] == "merged",
        )
    };
    let found: Vec<_> = rows(&study).iter().map(place).collect();
    let names = ["p/p", "p/p-2", "degree 1"];
    let expected: Vec<_> =
        names.iter().flat_map(|n| [0, 3].into_iter().flat_map(move |e| [0, 1].map(|l| ((*n).to_owned(), e, l, true)))).collect();
    assert_eq!(found, expected);
    // cubic splines on four elements: 7 functions, both ends lowered; linear ones on the same breakpoints: 5
    let multipliers: Vec<u64> = [0, 4, 8].map(|k| rows(&study)[k]["unknowns"]["multipliers"].as_u64().unwrap()).to_vec();
    assert_eq!(multipliers, [5, 5, 5]);
    // a row is the run with the same keys
    let (_, run) = told(
        at.path(),
        &[
            "run",
            "a.toml",
            "--set",
            "interface.seam.multiplier=p/p-2",
            "--set",
            "interface.seam.extra_points=3",
            "--set",
            "discretization.degree=3",
        ],
    );
    for key in ["energy", "errors", "unknowns", "interface"] {
        assert_eq!(rows(&study)[6][key], run[key], "{key}");
    }
    assert_ne!(rows(&study)[0]["energy"], rows(&study)[4]["energy"]);
    let shown = text(&faying(at.path(), &[&words[..], &["--force"]].concat()).stdout);
    assert!(shown.lines().any(|l| l.starts_with("row ") && l.contains("multiplier") && l.contains("points")), "{shown}");
}

#[test]
fn pairings_of_a_penalty_are_its_multipliers() {
    let at = folder(&format!("{PAIR}coupling = \"penalty\"\n"));
    let pairings = ["p/p", "p/p-2", "dual"];
    let (exit, study) = told(at.path(), &["convergence", "a.toml", "--levels", "1", "--pairings", &pairings.join(",")]);
    assert_eq!((exit, rows(&study).len()), (0, pairings.len()), "{study}");
    // a row is the run with that multiplier, and no two rows are the same
    for (pairing, row) in pairings.iter().zip(rows(&study)) {
        let (_, run) = told(at.path(), &["run", "a.toml", "--force", "--set", &format!("interface.seam.multiplier={pairing}")]);
        for key in ["energy", "errors", "unknowns", "interface"] {
            assert_eq!(row[key], run[key], "{pairing}: {key}");
        }
        assert_eq!(row["pairing"].as_str(), Some(*pairing));
    }
    for (k, row) in rows(&study).iter().enumerate() {
        rows(&study)[..k].iter().for_each(|before| assert_ne!(before["energy"], row["energy"], "{}", row["pairing"]));
    }
}

#[test]
fn pairings_need_a_coupling_with_a_multiplier() {
    let words = ["convergence", "a.toml", "--levels", "1", "--pairings", "p/p,p/p-2"];
    for coupling in ["nitsche", "glue"] {
        // glued sides must match
        let at = folder(&format!("{}coupling = \"{coupling}\"\n", PAIR.replace("[3, 3]", "[4, 4]")));
        let (exit, document) = told(at.path(), &words);
        assert_eq!((exit, document["diagnostics"][0]["code"].as_str()), (3, Some("E063")), "{document}");
        // as written, and by the key that gives it one
        let (exit, _) = told(at.path(), &["convergence", "a.toml", "--levels", "1"]);
        assert_eq!(exit, 0);
        let varied = [&words[..], &["--force", "--vary", "interface.seam.coupling=mortar,penalty"]].concat();
        let (exit, study) = told(at.path(), &varied);
        assert_eq!((exit, rows(&study).len()), (0, 4), "{study}");
    }
    // only the sides that have a multiplier get it
    let third = "[[patch]]\nname = \"third\"\ngeometry = { kind = \"box\", min = [0, 1], max = [1, 2] }\nelements = [3, 3]\n\
                 [[interface]]\nslave = \"left.top\"\nmaster = \"third.bottom\"\ncoupling = \"nitsche\"\n";
    let case = format!("{}{third}", PAIR.replace("\"left.top\", ", "\"third.left\", \"third.right\", \"third.top\", "));
    let at = folder(&case);
    let (exit, study) = told(at.path(), &words);
    assert_eq!(exit, 0, "{study}");
    assert_eq!(rows(&study)[0]["pairing"], "p/p+auto");
    assert_ne!(rows(&study)[0]["energy"], rows(&study)[1]["energy"]);
}

#[test]
fn the_integration_study_has_its_defaults_and_needs_an_interface() {
    let at = folder(PAIR);
    let (_, study) = told(at.path(), &["quadrature", "a.toml", "--levels", "2"]);
    let place =
        |r: &Value| (r["integration"].as_str().unwrap().to_owned(), r["extra_points"].as_u64().unwrap(), r["level"].as_u64().unwrap());
    let found: Vec<_> = rows(&study).iter().map(place).collect();
    let rules = ["merged", "slave", "mixed"];
    let expected: Vec<_> =
        rules.iter().flat_map(|r| [0, 1, 2, 4, 8].into_iter().flat_map(move |e| [0, 1].map(|l| ((*r).to_owned(), e, l)))).collect();
    assert_eq!(found, expected);
    for row in rows(&study).iter().filter(|r| r["integration"] == "merged") {
        assert_eq!(row["status"], "ok");
        // exact on every segment: more points change nothing but round-off
        let (a, b) = (
            row["errors"]["error.u.L2"].as_f64().unwrap(),
            rows(&study)[row["level"].as_u64().unwrap() as usize]["errors"]["error.u.L2"].as_f64().unwrap(),
        );
        assert!((a - b).abs() < 1e-9 * b, "{a:e} and {b:e}");
    }
    let out = at.path().join("a.quadrature");
    let svg = file(&out, "study.svg");
    assert!(
        svg.contains("points beyond the default") && svg.contains("error.u.L2 on level 1") && svg.contains("as written, degree 2, merged")
    );
    assert!(file(&out, "report.html").contains("merged: the L2 error of u is"));
    assert_eq!(elements(&file(&out, "report.html")).iter().filter(|n| *n == "svg").count(), 1);
    let at = folder(SQUARE);
    for command in ["quadrature", "convergence"] {
        let words: &[&str] = if command == "quadrature" { &[] } else { &["--pairings", "p/p,p/p-2"] };
        let (exit, document) = told(at.path(), &[&[command, "a.toml"], words].concat());
        assert_eq!((exit, document["diagnostics"][0]["code"].as_str()), (3, Some("E063")), "{document}");
        assert!(!at.path().join(format!("a.{command}")).exists());
    }
    // glued sides share their functions: there is nothing to integrate, and no multiplier
    let glued = PAIR.replace("[3, 3]", "[4, 4]") + "coupling = \"glue\"\n";
    let at = folder(&glued);
    let (exit, document) = told(at.path(), &["quadrature", "a.toml", "--levels", "1"]);
    assert_eq!((exit, document["diagnostics"][0]["code"].as_str()), (3, Some("E063")), "{document}");
    let at = folder(&(glued + "[[check]]\nquantity = \"error.seam.lambda.L2\"\nbelow = 1\n"));
    let (exit, document) = told(at.path(), &["run", "a.toml"]);
    assert_eq!((exit, document["diagnostics"][0]["code"].as_str()), (3, Some("E018")), "{document}");
    assert!(document["diagnostics"][0]["message"].as_str().unwrap().contains("is glued and has no multiplier"), "{document}");
}

#[test]
fn tables_of_the_case_are_the_defaults_of_their_command() {
    let tables = "[study.convergence]\nlevels = 2\nbackends = [\"iga\", \"fe\"]\ndegrees = { iga = [2, 3], fe = [1] }\n\
                  [study.quadrature]\nlevels = 1\nintegration = \"merged\"\nextra_points = [0, 3]\npairings = [\"p/p\", \"p/p-2\"]\n\
                  [study.sweep]\nvary = \"patch.right.elements=[3, 3],[5, 5]\"\ndegrees = [1, 2]\n";
    let at = folder(&format!("{PAIR}{tables}"));
    let place = |r: &Value| (r["name"].as_str().unwrap().to_owned(), r["degree"].as_u64().unwrap(), r["level"].as_u64().unwrap());
    let (exit, study) = told(at.path(), &["convergence", "a.toml"]);
    let of = |name: &str, p: u64| [(name.to_owned(), p, 0), (name.to_owned(), p, 1)];
    assert_eq!(exit, 0, "{study}");
    assert_eq!(rows(&study).iter().map(place).collect::<Vec<_>>(), [of("iga", 2), of("iga", 3), of("fe", 1)].concat());
    let (exit, study) = told(at.path(), &["quadrature", "a.toml"]);
    let found: Vec<_> = rows(&study).iter().map(|r| (r["pairing"].as_str().unwrap(), r["extra_points"].as_u64().unwrap())).collect();
    assert_eq!((exit, found), (0, vec![("p/p", 0), ("p/p", 3), ("p/p-2", 0), ("p/p-2", 3)]));
    let (exit, study) = told(at.path(), &["sweep", "a.toml"]);
    let found: Vec<_> = rows(&study).iter().map(|r| (r["elements"].as_u64().unwrap(), r["degree"].as_u64().unwrap())).collect();
    assert_eq!((exit, found), (0, vec![(25, 1), (25, 2), (41, 1), (41, 2)]));
    // the command line goes first
    let (_, study) = told(at.path(), &["convergence", "a.toml", "--levels", "1", "--degrees", "1", "--backends", "fe"]);
    assert_eq!(rows(&study).iter().map(place).collect::<Vec<_>>(), [("fe".to_owned(), 1, 0)]);
}

#[test]
fn wrong_values_say_what_to_write() {
    let at = folder(PAIR);
    for (words, message) in [
        (&["convergence", "a.toml", "--pairings", "p/q"][..], "--pairings: unknown multiplier `p/q`"),
        (&["convergence", "a.toml", "--pairings", "p/p,p/p"], "`p/p` is named twice"),
        (&["quadrature", "a.toml", "--integration", "merged,sleeve"], "unknown integration `sleeve`; did you mean `slave`?"),
        (&["quadrature", "a.toml", "--extra-points", "0,-1"], "`-1` is no number of points"),
        (&["quadrature", "a.toml", "--extra-points", "2,4,2"], "`2` is named twice"),
        (&["convergence", "a.toml", "--degrees", "1,1"], "degree 1 is named twice"),
        (&["convergence", "a.toml", "--degrees", "fem:2"], "unknown backend `fem`"),
        (&["convergence", "a.toml", "--backends", ","], "no value is named"),
        (&["convergence", "a.toml", "--levels", "21"], "--levels"),
        (&["sweep", "a.toml"], "no key is named"),
        (&["sweep", "a.toml", "--vary", "let.a=1", "--vary", "let.a=2"], "`let.a` varies twice"),
        (&["sweep", "a.toml", "--vary", "let.a=1,2,2"], "`2` is named twice"),
    ] {
        let out = faying(at.path(), words);
        let said = text(&out.stderr);
        assert_eq!(out.status.code(), Some(2), "{words:?} {said}");
        assert!(said.contains(message) && (said.contains("help:") || said.contains("--help")), "{words:?} {said}");
    }
    assert_eq!(std::fs::read_dir(at.path()).unwrap().count(), 1);
    // of the case: located, exit 3
    for (table, message) in [
        ("backends = [\"fem\"]", "`backends` of [study.convergence]: unknown backend `fem`"),
        ("extra_points = [1, 1]", "`extra_points` of [study.convergence]: `1` is named twice"),
        ("degrees = { iga = [2, 2] }", "degree 2 is named twice"),
        ("extra_points = [-1]", "from 0 to 60"),
    ] {
        let at = folder(&format!("{PAIR}[study.convergence]\n{table}\n"));
        let (exit, document) = told(at.path(), &["convergence", "a.toml"]);
        let d = &document["diagnostics"][0];
        assert_eq!((exit, d["line"].is_u64()), (3, true), "{document}");
        assert!(d["message"].as_str().unwrap().contains(message), "{document}");
    }
}

/// The row of the case as written decides its checks, however its numbers are spelt.
#[test]
fn a_number_of_a_sweep_may_be_spelt_as_it_likes() {
    let at = folder(
        &SQUARE
            .replace("[model]", "[let]\nF = 1.0\n[model]")
            .replace("[[probe]]", "[[check]]\nquantity = \"u at [0.5, 0.4]\"\nbelow = 0\n[[probe]]"),
    );
    for spelt in ["1", "1.0", "1e0"] {
        let out = faying(at.path(), &["sweep", "a.toml", "--vary", &format!("let.F={spelt}"), "--force"]);
        assert_eq!(out.status.code(), Some(1), "{spelt}: {}", String::from_utf8_lossy(&out.stderr));
    }
    let out = faying(at.path(), &["sweep", "a.toml", "--vary", "let.F=2", "--force"]);
    assert_eq!(out.status.code(), Some(0), "{}", String::from_utf8_lossy(&out.stderr));
}

#[test]
fn a_sweep_draws_numbers_on_an_axis_and_words_side_by_side() {
    let at = folder(SQUARE);
    let (exit, study) = told(at.path(), &["sweep", "a.toml", "--vary", "discretization.degree=1,2,3", "--backends", "iga,fe"]);
    assert_eq!((exit, rows(&study).len()), (0, 6), "{study}");
    let values: Vec<&str> = rows(&study).iter().map(|r| r["vary"]["discretization.degree"].as_str().unwrap()).collect();
    assert_eq!(values, ["1", "1", "2", "2", "3", "3"]);
    let svg = file(&at.path().join("a.sweep"), "study.svg");
    assert!(svg.contains("discretization.degree") && svg.contains("error.u.L2") && svg.contains("middle"));
    let page = file(&at.path().join("a.sweep"), "report.html");
    assert!(page.contains("iga, over discretization.degree: the L2 error of u goes from "), "{page}");
    let words =
        ["sweep", "a.toml", "--vary", "discretization.mapping=exact,isoparametric", "--vary", "patch.square.elements=[2, 2],[4, 4]"];
    let (exit, study) = told(at.path(), &words);
    assert_eq!((exit, rows(&study).len()), (0, 4));
    let svg = file(&at.path().join("a.sweep"), "study.svg");
    assert!(svg.contains("isoparametric") && svg.contains("patch.square.elements = [4, 4]"));
}

#[test]
fn failing_rows_stay_and_decide_the_exit_code() {
    // fe goes up to degree 8
    let at = folder(SQUARE);
    let (exit, study) = told(at.path(), &["convergence", "a.toml", "--backends", "fe", "--degrees", "2,9", "--levels", "2"]);
    assert_eq!((exit, study["status"].as_str()), (3, Some("invalid")));
    let found: Vec<_> = rows(&study).iter().map(|r| (r["status"].as_str().unwrap(), r["code"].is_string())).collect();
    assert_eq!(found, [("ok", false), ("ok", false), ("invalid", true), ("invalid", true)]);
    let page = file(&at.path().join("a.convergence"), "report.html");
    assert!(page.contains("<tr class=\"bad") && page.contains("2 of 4 rows could not be finished"), "{page}");
    elements(&page);
    // a limit on memory ends the rows that are too large, and comes before an invalid row
    let words = ["convergence", "a.toml", "--backends", "fe", "--degrees", "1,9", "--levels", "6", "--max-memory", "25MB"];
    let (exit, study) = told(at.path(), &words);
    let status: Vec<&str> = rows(&study).iter().map(|r| r["status"].as_str().unwrap()).collect();
    assert_eq!((exit, status[0], status[5], status[6]), (6, "ok", "limit", "invalid"), "{status:?}");
    // nothing at all can be solved: no folder
    let (exit, _) = told(at.path(), &["convergence", "a.toml", "--backends", "fe", "--degrees", "9", "--out", "none"]);
    assert_eq!((exit, at.path().join("none").exists()), (3, false));
}

#[test]
fn results_are_the_same_at_any_number_of_threads_and_rows_have_seconds() {
    let at = folder(PAIR);
    let words = |n: &'static str| ["convergence", "a.toml", "--levels", "3", "--backends", "iga+fe", "--threads", n, "--out", n];
    for n in ["1", "2"] {
        assert_eq!(faying(at.path(), &words(n)).status.code(), Some(0));
    }
    for name in ["result.json", "study.csv", "study.svg", "report.html"] {
        assert!(file(&at.path().join("1"), name) == file(&at.path().join("2"), name), "{name}");
    }
    let manifest: Value = serde_json::from_str(&file(&at.path().join("1"), "manifest.json")).unwrap();
    let timed: Vec<&str> = manifest["seconds"].as_array().unwrap().iter().map(|s| s["phase"].as_str().unwrap()).collect();
    assert_eq!(timed.iter().filter(|p| p.starts_with("row ") && p.contains(" of 3: iga+fe, level ")).count(), 3, "{timed:?}");
}

#[test]
fn resuming_keeps_what_is_finished_and_ends_with_the_same_bytes() {
    let at = folder(PAIR);
    let words = |levels: &'static str, more: &[&'static str]| -> Vec<&'static str> {
        [&["convergence", "a.toml", "--backends", "iga,fe", "--levels", levels][..], more].concat()
    };
    assert_eq!(faying(at.path(), &words("3", &["--out", "whole"])).status.code(), Some(0));
    assert_eq!(faying(at.path(), &words("2", &[])).status.code(), Some(0));
    let out = faying(at.path(), &words("3", &["--resume"]));
    assert_eq!(out.status.code(), Some(0), "{}", text(&out.stderr));
    assert!(text(&out.stdout).contains("4 rows kept of the 4 of the earlier study, 2 solved now\n"), "{}", text(&out.stdout));
    let same = || {
        for name in ["result.json", "study.csv", "study.svg", "report.html"] {
            assert!(file(&at.path().join("a.convergence"), name) == file(&at.path().join("whole"), name), "{name}");
        }
    };
    same();
    let manifest: Value = serde_json::from_str(&file(&at.path().join("a.convergence"), "manifest.json")).unwrap();
    let rows = manifest["seconds"].as_array().unwrap().iter().filter(|s| s["phase"].as_str().unwrap().starts_with("row "));
    assert!(rows.clone().count() == 6 && rows.clone().all(|s| s["seconds"].as_f64().unwrap() > 0.0), "{manifest}");
    // once more: nothing is left to solve
    let out = faying(at.path(), &words("3", &["--resume"]));
    assert!(text(&out.stdout).contains("6 rows kept of the 6 of the earlier study, 0 solved now\n"), "{}", text(&out.stdout));
    same();
    // another case in the same file: all rows are solved again, and it says so
    std::fs::write(at.path().join("a.toml"), PAIR.replace("sin(pi*x)*y", "sin(3*x)*y")).unwrap();
    let out = faying(at.path(), &words("3", &["--resume"]));
    let said = text(&out.stdout);
    assert!(said.contains("0 rows kept of the 6 of the earlier study, 6 solved now; 6 of them are of another case"), "{said}");
    assert!(file(&at.path().join("a.convergence"), "result.json") != file(&at.path().join("whole"), "result.json"));
    // other options are another study, too
    let out = faying(at.path(), &words("3", &["--resume", "--set", "discretization.degree=3"]));
    assert!(text(&out.stdout).contains("0 rows kept of the 6"), "{}", text(&out.stdout));
}

/// A study of PAIR over three levels of two backends; ended as soon as row `end` begins.
fn interrupted(case: &Case, kept: Option<&StoredRows>, end: usize) -> Study {
    let registry = Registry::default();
    let axes = Axes { backends: ["iga", "fe"].map(String::from).to_vec(), levels: 3, ..Axes::default() };
    let base = Base { name: "a.toml", text: PAIR, options: ReadOptions::default() };
    let plan = StudyPlan {
        command: "convergence",
        written: case,
        base,
        registry: &registry,
        axes,
        quantities: &[],
        compares: false,
        tol: None,
        kept,
    };
    let specs = plan.rows().unwrap();
    let watch = RunControl::default();
    plan.solve(&specs, &Runs { registry: &registry }, &watch, |k, _, _| {
        if k == end {
            watch.interrupted.store(true, Ordering::Relaxed);
        }
    })
}

#[test]
fn a_study_that_is_interrupted_goes_on_where_it_was() {
    let case = Case::parse("a.toml", PAIR, &ReadOptions::default()).unwrap();
    let whole = interrupted(&case, None, 99);
    let part = interrupted(&case, None, 3);
    assert_eq!((whole.exit(), part.exit(), part.rows.len()), (0, 130, 4));
    assert_eq!(part.rows[3].result.exit, 130);
    assert!(part.to_json(&[]).contains("rows that were not begun: 2 of 6") && part.summary(None).contains("2 of 6"));
    let kept = StoredRows::read(&part.stored).unwrap();
    let rest = interrupted(&case, Some(&kept), 99);
    // the row that was interrupted is solved again
    assert_eq!(rest.rows.iter().map(|r| r.kept).collect::<Vec<_>>(), [true, true, true, false, false, false]);
    assert_eq!(rest.to_json(&[]), whole.to_json(&[]));
    assert_eq!((rest.csv(), picture(&rest).unwrap()), (whole.csv(), picture(&whole).unwrap()));
    assert_eq!(html(&rest, None, &[]), html(&whole, None, &[]));
}
