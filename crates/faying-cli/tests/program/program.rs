//! The program as its users meet it: streams, exit codes, the folder of results, documents of failures.

use serde_json::Value;
use sha2::{Digest, Sha256};
use std::collections::BTreeSet;
use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Command, Output, Stdio};
use tempfile::TempDir;

/// A unit square with a known temperature: fast, one patch, one probe, one check.
const SQUARE: &str = r#"
title = "A square"
[model]
physics = "poisson"
dimension = 2
exact = { u = "sin(pi*x)*y" }
[discretization]
degree = 2
[[patch]]
name = "square"
geometry = { kind = "box", min = [0, 0], max = [1, 1] }
elements = [4, 4]
[[boundary]]
on = "all-outer"
dirichlet = "exact"
[[probe]]
name = "middle"
quantity = "u at [0.5, 0.5]"
[[check]]
name = "error"
quantity = "error.u.L2"
below = 1e-2
"#;

fn folder() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("square.toml"), SQUARE).unwrap();
    folder
}

fn program(at: &Path) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_faying"));
    command.current_dir(at).env_remove("NO_COLOR").stdin(Stdio::null());
    command
}

fn faying(at: &Path, words: &[&str]) -> Output {
    program(at).args(words).output().unwrap()
}

fn code(out: &Output) -> i32 {
    out.status.code().unwrap_or(-1)
}

fn stdout(out: &Output) -> String {
    String::from_utf8(out.stdout.clone()).unwrap()
}

fn stderr(out: &Output) -> String {
    String::from_utf8(out.stderr.clone()).unwrap()
}

fn json(text: &str) -> Value {
    serde_json::from_str(text).unwrap_or_else(|e| panic!("{e} in {text}"))
}

fn names(at: &Path) -> BTreeSet<String> {
    std::fs::read_dir(at).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect()
}

fn listed(value: &Value) -> BTreeSet<String> {
    value.as_array().unwrap().iter().map(|v| v.as_str().unwrap().to_owned()).collect()
}

/// Exit code and text agree, and the document says the same.
#[track_caller]
fn fails(at: &Path, words: &[&str], exit: i32, error: &str) -> Value {
    let plain = faying(at, words);
    assert_eq!(code(&plain), exit, "{}", stderr(&plain));
    assert!(stderr(&plain).contains(error), "`{error}` is not in\n{}", stderr(&plain));
    assert_eq!(stdout(&plain), "");
    let told = faying(at, &[words, &["--json"]].concat());
    assert_eq!(code(&told), exit);
    let document = json(&stdout(&told));
    assert_eq!(document["schema"], "faying.result/1");
    assert_eq!(document["exit"], exit);
    let first = &document["diagnostics"][0];
    for key in ["code", "severity", "message", "file", "line", "column", "help"] {
        assert!(first.get(key).is_some(), "{key} is missing in {first}");
    }
    document
}

#[test]
fn help_and_version_go_to_stdout() {
    let at = folder();
    let help = faying(at.path(), &["--help"]);
    assert_eq!(code(&help), 0);
    for word in ["run", "check", "new", "compare", "--out", "--force", "--json", "--threads", "--set", "--max-memory", "--time-limit"] {
        assert!(stdout(&help).contains(word), "{word}");
    }
    let version = faying(at.path(), &["--version"]);
    assert_eq!((code(&version), stdout(&version)), (0, format!("faying {}\n", env!("CARGO_PKG_VERSION"))));
    assert_eq!(code(&faying(at.path(), &["run", "--help"])), 0);
    let word = faying(at.path(), &["help"]);
    assert_eq!((code(&word), stdout(&word)), (0, stdout(&help)));
}

#[test]
fn wrong_words_are_exit_2() {
    let at = folder();
    assert_eq!(code(&faying(at.path(), &[])), 2);
    let document = json(&stdout(&faying(at.path(), &["run", "--json"])));
    assert!(document["diagnostics"][0]["message"].as_str().unwrap().contains("<CASE>"), "{document}");
    fails(at.path(), &["run", "square.toml", "--frobnicate"], 2, "--frobnicate");
    fails(at.path(), &["run", "square.toml", "--backend", "fem"], 2, "unknown backend `fem`; known: iga, fe");
    fails(at.path(), &["run", "square.toml", "--threads", "0"], 2, "--threads");
    fails(at.path(), &["run", "square.toml", "--max-memory", "lots"], 2, "4GB");
    fails(at.path(), &["run", "square.toml", "--set", "degree"], 2, "KEY=VALUE");
    assert_eq!(names(at.path()), BTreeSet::from(["square.toml".to_owned()]));
}

/// Options of the contract that are not built.
#[test]
fn known_words_of_the_command_line_that_are_not_built_are_exit_2() {
    let at = folder();
    for words in [&["run", "square.toml", "--resume"][..], &["--quiet", "run", "--resume", "square.toml"]] {
        let document = fails(at.path(), words, 2, "`--resume` is not in this version");
        assert_eq!((&document["status"], &document["exit"]), (&"invalid".into(), &2.into()));
    }
    // words of no contract and options of other commands are not understood
    fails(at.path(), &["run", "square.toml", "--dryer"], 2, "unexpected argument '--dryer' found");
    fails(at.path(), &["check", "square.toml", "--watch"], 2, "unexpected argument '--watch' found");
    fails(at.path(), &["mann"], 2, "unrecognized subcommand 'mann'");
    assert_eq!(names(at.path()).len(), 1);
}

#[test]
fn codes_are_explained() {
    let at = folder();
    let out = faying(at.path(), &["explain", "e021"]);
    assert_eq!(code(&out), 0);
    assert!(stdout(&out).starts_with("E021: unknown patch or side (exit 3)\n"));
    fails(at.path(), &["explain", "E999"], 2, "there is no code `E999`");
}

#[test]
fn samples_are_listed_printed_and_written_but_never_over_a_file() {
    let at = folder();
    let list = stdout(&faying(at.path(), &["new", "--list"]));
    for name in ["poisson-arc", "contact-patch", "hertz", "iga-fe-arc"] {
        assert!(list.contains(name));
        let printed = faying(at.path(), &["new", name, "-"]);
        assert_eq!(code(&printed), 0);
        let file = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")).join("examples/cases").join(format!("{name}.toml"));
        assert_eq!(stdout(&printed), std::fs::read_to_string(file).unwrap());
        assert!(!at.path().join(format!("{name}.toml")).exists());
    }
    assert_eq!(code(&faying(at.path(), &["new", "contact-patch"])), 0);
    std::fs::write(at.path().join("contact-patch.toml"), "mine").unwrap();
    fails(at.path(), &["new", "contact-patch"], 4, "never writes over a file");
    assert_eq!(std::fs::read_to_string(at.path().join("contact-patch.toml")).unwrap(), "mine");
    fails(at.path(), &["new", "contact-path"], 2, "did you mean `contact-patch`?");
}

#[test]
fn a_run_writes_the_folder_its_manifest_lists() {
    let at = folder();
    let out = faying(at.path(), &["run", "square.toml"]);
    assert_eq!(code(&out), 0, "{}", stderr(&out));
    assert_eq!(stderr(&out), "");
    assert!(stdout(&out).starts_with("square.toml: ok\n") && stdout(&out).contains("middle"), "{}", stdout(&out));
    let results = at.path().join("square.out");
    let manifest = json(&std::fs::read_to_string(results.join("manifest.json")).unwrap());
    assert_eq!(listed(&manifest["files"]), names(&results));
    for file in ["result.json", "manifest.json", "fields.vtu", "fields.svg", "case.effective.toml", "log.txt"] {
        assert!(names(&results).contains(file), "{file}");
    }
    let hash: String = Sha256::digest(SQUARE.as_bytes()).iter().map(|b| format!("{b:02x}")).collect();
    assert_eq!(manifest["inputs"][0]["sha256"], hash);
    assert!(manifest["seconds"].as_array().unwrap().iter().any(|p| p["phase"] == "read"));
    let result = json(&std::fs::read_to_string(results.join("result.json")).unwrap());
    assert_eq!(result["status"], "ok");
    let mut beside = names(&results);
    beside.remove("result.json");
    assert_eq!(listed(&result["files"]), beside);
    assert!((result["probes"][0]["value"].as_f64().unwrap() - 0.5).abs() < 1e-2);
}

#[test]
fn the_document_is_the_result_file() {
    let at = folder();
    let out = faying(at.path(), &["run", "--json", "square.toml"]);
    assert_eq!(code(&out), 0);
    assert_eq!(stdout(&out), std::fs::read_to_string(at.path().join("square.out/result.json")).unwrap());
    let out = faying(at.path(), &["run", "square.toml", "--json=r.json"]);
    assert!(stdout(&out).starts_with("square.toml: ok\n"));
    assert_eq!(std::fs::read(at.path().join("r.json")).unwrap(), std::fs::read(at.path().join("square.out/result.json")).unwrap());
    let out = faying(at.path(), &["run", "square.toml", "--json=nowhere/r.json"]);
    assert_eq!(code(&out), 4);
    assert_eq!(stderr(&out).matches("error[E091]").count(), 1, "{}", stderr(&out));
}

#[test]
fn the_document_never_replaces_what_is_read_or_written() {
    let at = folder();
    std::fs::create_dir(at.path().join("sub")).unwrap();
    for words in [
        &["run", "square.toml", "--json=square.toml"][..],
        &["check", "square.toml", "--json=sub/../square.toml"],
        &["run", "square.toml", "--json=square.toml", "--frobnicate"],
        &["run", "square.toml", "--json=square.out/result.json"],
        &["run", "square.toml", "--out", "new", "--json=./new/r.json"],
        &["new", "hertz", "--json=hertz.toml"],
    ] {
        let out = faying(at.path(), words);
        assert_eq!(code(&out), 2, "{words:?} {}", stderr(&out));
        assert_eq!(std::fs::read_to_string(at.path().join("square.toml")).unwrap(), SQUARE);
        assert_eq!(names(at.path()).len(), 2, "nothing is made by {words:?}");
    }
    assert!(stderr(&faying(at.path(), &["run", "square.toml", "--json=square.toml"])).contains("--json would write over `square.toml`"));
}

#[test]
fn the_folder_of_the_same_case_is_replaced_and_nothing_else() {
    let at = folder();
    let results = at.path().join("square.out");
    assert_eq!(code(&faying(at.path(), &["run", "square.toml"])), 0);
    std::fs::write(results.join("notes.txt"), "mine").unwrap();
    assert_eq!(code(&faying(at.path(), &["run", "square.toml", "--vtu", "none"])), 0);
    assert!(!names(&results).contains("fields.vtu"), "a listed file of the run before is gone");
    assert_eq!(std::fs::read_to_string(results.join("notes.txt")).unwrap(), "mine");

    std::fs::copy(at.path().join("square.toml"), at.path().join("other.toml")).unwrap();
    fails(at.path(), &["run", "other.toml", "--out", "square.out"], 4, "E090");
    assert_eq!(code(&faying(at.path(), &["run", "other.toml", "--out", "square.out", "--force"])), 0);
    assert_eq!(std::fs::read_to_string(results.join("notes.txt")).unwrap(), "mine");

    std::fs::create_dir(at.path().join("full")).unwrap();
    std::fs::write(at.path().join("full/a.txt"), "mine").unwrap();
    fails(at.path(), &["run", "square.toml", "--out", "full"], 4, "holds files that faying did not write");
    assert_eq!(names(&at.path().join("full")).len(), 1);
    fails(at.path(), &["run", "square.toml", "--out", "square.toml"], 4, "E090");
    std::fs::create_dir(at.path().join("empty")).unwrap();
    assert_eq!(code(&faying(at.path(), &["run", "square.toml", "--out", "empty"])), 0);
}

#[test]
fn a_manifest_reaches_no_file_outside_its_folder() {
    let at = folder();
    assert_eq!(code(&faying(at.path(), &["run", "square.toml"])), 0);
    let file = at.path().join("square.out/manifest.json");
    let mut manifest = json(&std::fs::read_to_string(&file).unwrap());
    manifest["files"] = serde_json::json!(["../square.toml", "..", "fields.svg"]);
    std::fs::write(&file, manifest.to_string()).unwrap();
    assert_eq!(code(&faying(at.path(), &["run", "square.toml"])), 0);
    assert!(at.path().join("square.toml").exists());
}

#[test]
fn an_invalid_case_is_exit_3_without_a_folder() {
    let at = folder();
    std::fs::write(at.path().join("bad.toml"), SQUARE.replace("degree = 2", "degre = 2")).unwrap();
    let document = fails(at.path(), &["run", "bad.toml"], 3, "error[E012]: unknown key `degre`");
    assert_eq!(document["status"], "invalid");
    assert_eq!(document["diagnostics"][0]["line"], 8);
    fails(at.path(), &["run", "square.toml", "--set", "discretization.degree=\"two\""], 3, "E014");
    fails(at.path(), &["check", "bad.toml"], 3, "E012");
    let document = fails(at.path(), &["run", "squar.toml"], 4, "square.toml");
    assert_eq!(document["diagnostics"][0]["code"], "E003");
    assert_eq!(names(at.path()).len(), 2);
}

#[test]
fn a_failed_check_is_exit_1_with_everything_written() {
    let at = folder();
    let out = faying(at.path(), &["run", "square.toml", "--set", "check.error.below=1e-12"]);
    assert_eq!(code(&out), 1, "{}", stderr(&out));
    assert!(stdout(&out).contains("FAILED"));
    let result = json(&std::fs::read_to_string(at.path().join("square.out/result.json")).unwrap());
    assert_eq!((&result["status"], &result["exit"]), (&"check-failed".into(), &1.into()));
    assert!(at.path().join("square.out/fields.vtu").exists());
}

#[test]
fn limits_are_exit_6() {
    let at = folder();
    let document = fails(at.path(), &["run", "square.toml", "--max-memory", "10kB"], 6, "E081");
    assert_eq!(document["status"], "limit");
    assert_eq!(names(at.path()).len(), 1, "a foreseen limit makes no folder");
    let out = faying(at.path(), &["run", "square.toml", "--time-limit", "1e-9"]);
    assert_eq!(code(&out), 6, "{}", stderr(&out));
    assert!(stderr(&out).contains("E081"));
}

#[test]
fn a_case_may_come_from_stdin() {
    let at = folder();
    let mut child = program(at.path()).args(["run", "-"]).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().unwrap();
    child.stdin.take().unwrap().write_all(SQUARE.as_bytes()).unwrap();
    assert_eq!(child.wait_with_output().unwrap().status.code(), Some(0));
    assert!(at.path().join("stdin.out/result.json").exists());
}

#[test]
fn another_text_on_stdin_is_another_case() {
    let at = folder();
    let run = |text: &str| {
        let mut child =
            program(at.path()).args(["run", "-"]).stdin(Stdio::piped()).stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
        child.stdin.take().unwrap().write_all(text.as_bytes()).unwrap();
        child.wait_with_output().unwrap()
    };
    assert_eq!(code(&run(SQUARE)), 0);
    let first = std::fs::read(at.path().join("stdin.out/result.json")).unwrap();
    let other = run(&SQUARE.replace("[4, 4]", "[2, 2]"));
    assert_eq!(code(&other), 4);
    assert!(stderr(&other).contains("error[E090]"), "{}", stderr(&other));
    assert_eq!(std::fs::read(at.path().join("stdin.out/result.json")).unwrap(), first);
    assert_eq!(code(&run(SQUARE)), 0, "the same text is the same case");
}

#[test]
fn a_case_that_moved_keeps_its_folder() {
    let at = folder();
    assert_eq!(code(&faying(at.path(), &["run", "square.toml"])), 0);
    std::fs::rename(at.path().join("square.toml"), at.path().join("box.toml")).unwrap();
    assert_eq!(code(&faying(at.path(), &["run", "box.toml", "--out", "square.out"])), 0);
}

#[cfg(unix)]
#[test]
fn an_endless_case_is_a_limit() {
    let at = folder();
    fails(at.path(), &["run", "/dev/zero"], 6, "error[E081]: /dev/zero is longer than 16 MiB");
    let out = program(at.path()).args(["run", "-"]).stdin(std::fs::File::open("/dev/zero").unwrap()).output().unwrap();
    assert_eq!(code(&out), 6);
    assert!(stderr(&out).contains("error[E081]: stdin is longer"), "{}", stderr(&out));
}

#[test]
fn a_reason_stands_beside_numbers_only() {
    let at = folder();
    assert_eq!(code(&faying(at.path(), &["new", "hertz"])), 0);
    let words = [
        "run",
        "hertz.toml",
        "--json",
        "--vtu",
        "none",
        "--set",
        "contact.0.active_set.max_iterations=1",
        "--set",
        "contact.0.active_set.start=all",
        "--set",
        "solver.constraint=condensed",
    ];
    let out = faying(at.path(), &words);
    assert_eq!(code(&out), 5);
    let document = json(&stdout(&out));
    assert_eq!(document["diagnostics"][0]["code"], "E071");
    assert_eq!(document["diagnostics"][0].as_object().unwrap().len(), 7, "{document}");
}

#[test]
fn the_effective_case_runs_where_it_lies() {
    let at = folder();
    assert_eq!(code(&faying(at.path(), &["run", "square.toml", "--backend", "fe"])), 0);
    let results = at.path().join("square.out");
    let out = faying(&results, &["run", "case.effective.toml", "--json", "--out", "again"]);
    assert_eq!(code(&out), 0, "{}", stderr(&out));
    let (first, again) = (json(&std::fs::read_to_string(results.join("result.json")).unwrap()), json(&stdout(&out)));
    for key in ["probes", "errors", "energy", "unknowns", "backends"] {
        assert_eq!(first[key], again[key], "{key}");
    }
}

#[test]
fn results_are_the_same_bytes_for_one_and_two_threads() {
    let at = folder();
    for sample in ["contact-patch", "poisson-arc"] {
        assert_eq!(code(&faying(at.path(), &["new", sample])), 0);
        let case = format!("{sample}.toml");
        let made = ["1", "2"].map(|threads| {
            let out = format!("{sample}-{threads}");
            let run = faying(at.path(), &["run", &case, "--threads", threads, "--out", &out]);
            assert_eq!(code(&run), 0, "{}{}", stdout(&run), stderr(&run));
            at.path().join(out)
        });
        assert_eq!(names(&made[0]), names(&made[1]));
        for name in names(&made[0]) {
            if name.ends_with(".vtu") || name.ends_with(".csv") || name.ends_with(".svg") || name == "result.json" {
                assert!(std::fs::read(made[0].join(&name)).unwrap() == std::fs::read(made[1].join(&name)).unwrap(), "{name} of {sample}");
            }
        }
    }
}

#[test]
fn contact_writes_its_side() {
    let at = folder();
    assert_eq!(code(&faying(at.path(), &["new", "contact-patch"])), 0);
    let out = faying(at.path(), &["run", "contact-patch.toml"]);
    assert_eq!(code(&out), 0, "{}", stderr(&out));
    assert!(stdout(&out).contains("active set: "), "the history of the active set is printed");
    let results = at.path().join("contact-patch.out");
    let csv = std::fs::read_to_string(results.join("interface_pad.csv")).unwrap();
    assert!(csv.starts_with("s,x,y,z,lambda,gap,active\n"));
    for line in csv.lines().skip(1) {
        let lambda: f64 = line.split(',').nth(4).unwrap().parse().unwrap();
        assert!((lambda + 1.25e-3).abs() < 1e-9, "the multiplier is the exact pressure: {line}");
    }
    for name in ["interface_pad.vtu", "interface_pad.svg"] {
        assert!(results.join(name).exists(), "{name}");
    }
}

#[test]
fn a_tie_writes_what_is_left_of_it() {
    let at = folder();
    assert_eq!(code(&faying(at.path(), &["new", "iga-fe-arc"])), 0);
    let out = faying(at.path(), &["run", "iga-fe-arc.toml", "--vtu", "linear"]);
    assert_eq!(code(&out), 0, "{}", stderr(&out));
    let results = at.path().join("iga-fe-arc.out");
    let side = names(&results).into_iter().find(|n| n.starts_with("interface_") && n.ends_with(".vtu")).unwrap();
    let bytes = std::fs::read(results.join(&side)).unwrap();
    let text = String::from_utf8_lossy(&bytes);
    for name in ["lambda", "gap", "active", "traction", "normal"] {
        assert!(text.contains(&format!("Name=\"{name}\"")), "{name} is not in {side}");
    }
    assert!(!text.contains("HigherOrderDegrees"), "linear cells have no degrees");
    let csv = std::fs::read_to_string(results.join(side.replace(".vtu", ".csv"))).unwrap();
    for line in csv.lines().skip(1) {
        let words: Vec<&str> = line.split(',').rev().collect();
        let gap: f64 = words[1].parse().unwrap();
        assert!(gap.abs() < 1e-2, "the jump is an error of the discretisation: {line}");
        assert_eq!(words[0], "1");
    }
}

#[test]
fn a_picture_of_many_elements_is_small() {
    let at = folder();
    let words = ["run", "square.toml", "--vtu", "none", "--set", "discretization.degree=1", "--set", "patch.square.elements=[200, 200]"];
    let out = faying(at.path(), &words);
    assert_eq!(code(&out), 0, "{}", stderr(&out));
    let length = std::fs::metadata(at.path().join("square.out/fields.svg")).unwrap().len();
    assert!(length < 2_000_000, "{length} bytes");
}

#[test]
fn quiet_verbose_and_colour_change_words_only() {
    let at = folder();
    let quiet = faying(at.path(), &["run", "square.toml", "-q"]);
    assert_eq!((code(&quiet), stdout(&quiet), stderr(&quiet)), (0, String::new(), String::new()));
    let verbose = faying(at.path(), &["run", "square.toml", "-v"]);
    assert!(stderr(&verbose).contains("read") && stderr(&verbose).contains("write"));
    assert_eq!(code(&faying(at.path(), &["run", "square.toml", "-q", "-v"])), 2);
    let colour = |when: &str| stderr(&faying(at.path(), &["run", "no.toml", "--color", when])).contains('\u{1b}');
    assert!(colour("always") && !colour("never") && !colour("auto"));
}

#[test]
fn check_solves_nothing_and_writes_nothing() {
    let at = folder();
    let out = faying(at.path(), &["check", "square.toml"]);
    assert_eq!(code(&out), 0, "{}", stderr(&out));
    assert!(stdout(&out).contains("valid") && stdout(&out).contains("unknowns"), "{}", stdout(&out));
    let document = json(&stdout(&faying(at.path(), &["check", "square.toml", "--json"])));
    assert_eq!((&document["command"], &document["status"]), (&"check".into(), &"ok".into()));
    assert_eq!(names(at.path()).len(), 1);
}

/// A run that is sent `signals` in its first phase, started with the signals `ignored`; how it ended, and its result.
#[cfg(unix)]
fn signalled(ignored: &str, signals: &[&str]) -> (Option<i32>, serde_json::Value) {
    let at = folder();
    let words = "run square.toml -v --set patch.square.elements=[160,160] --set discretization.degree=3";
    let ignore = if ignored.is_empty() { String::new() } else { format!("trap '' {ignored}\n") };
    let script = format!("{ignore}exec {} {words}", env!("CARGO_BIN_EXE_faying"));
    // a runner may have been started with signals ignored, which its children inherit
    let defaults = ["--default-signal=HUP,INT,TERM", "sh"];
    let mut shell = if cfg!(target_os = "linux") { Command::new("env") } else { Command::new("sh") };
    shell.args(defaults.iter().filter(|_| cfg!(target_os = "linux"))).args(["-c", &script]).current_dir(at.path());
    let mut child = shell.stderr(Stdio::piped()).stdout(Stdio::null()).spawn().unwrap();
    let mut lines = BufReader::new(child.stderr.take().unwrap()).lines();
    // "build" begins after signals are listened to
    lines.find(|line| line.as_ref().is_ok_and(|l| l.contains("build"))).expect("a phase called build").unwrap();
    for signal in signals {
        assert!(Command::new("kill").args([signal, child.id().to_string().as_str()]).status().unwrap().success());
    }
    lines.for_each(drop);
    let code = child.wait().unwrap().code();
    (code, json(&std::fs::read_to_string(at.path().join("square.out/result.json")).unwrap()))
}

#[cfg(unix)]
#[test]
fn a_run_that_is_asked_to_end_writes_what_there_is() {
    // a scheduler sends SIGTERM, a terminal that closes SIGHUP, and its shell another one
    for signals in [&["-INT"][..], &["-TERM"], &["-HUP"], &["-HUP", "-TERM", "-HUP"]] {
        let (code, result) = signalled("", signals);
        assert_eq!(code, Some(130), "{signals:?}");
        assert_eq!((&result["status"], &result["exit"]), (&"interrupted".into(), &130.into()), "{signals:?}");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_run_under_nohup_outlives_its_terminal() {
    // nohup ignores SIGHUP, and nothing else
    let (code, result) = signalled("HUP", &["-HUP"]);
    assert_eq!((code, &result["status"]), (Some(0), &"ok".into()));
    assert_eq!(signalled("HUP", &["-HUP", "-TERM"]).0, Some(130));
}
