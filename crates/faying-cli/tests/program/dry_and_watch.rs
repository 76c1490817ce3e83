//! `run --dry`, which solves nothing, and `run --watch`, which solves again; completions and manual.

use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Command, Output, Stdio};
use tempfile::TempDir;

fn program(at: &Path, words: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_faying"));
    command.current_dir(at).args(words).stdin(Stdio::null());
    command
}

fn faying(at: &Path, words: &[&str]) -> Output {
    program(at, words).output().unwrap()
}

fn stdout(out: &Output) -> String {
    String::from_utf8(out.stdout.clone()).unwrap()
}

fn sample(name: &str) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    assert!(faying(folder.path(), &["new", name]).status.success());
    folder
}

/// The resultants are those of the closed forms: the contact patch test presses p = 1.25e-3 on a length of 1.
#[test]
fn a_dry_run_tells_the_model_and_writes_nothing() {
    let at = sample("contact-patch");
    let out = faying(at.path(), &["run", "contact-patch.toml", "--dry"]);
    let text = stdout(&out);
    assert_eq!(out.status.code(), Some(0), "{}", String::from_utf8_lossy(&out.stderr));
    for part in [
        "Elasticity in plane strain",
        "lower: box; 8 elements of iga of degree 2",
        "area 0.5; material soft",
        "soft: young E, poisson nu; of lower, upper",
        "boundary-0 on lower.bottom (length 1): prescribed y = 0.0",
        "boundary-2 on upper.top (length 1): pressure p; resultant (0, -0.00125), moment -0.000625",
        "3 sides, edges or corners are held",
        "contact pad (as the case names them): method lagrange, multiplier auto, integration merged, gap g",
        "slave upper.bottom (4 elements, 0.25 each on average), 4 rows",
        "master lower.top (4 elements, 0.25 each on average): faces 100 % of the slave, at most 0 apart",
        "Forecast: 96 unknowns, 4 multipliers",
        "Nothing was solved, nothing written.",
    ] {
        assert!(text.contains(part), "`{part}` is not in\n{text}");
    }
    let names: Vec<_> = std::fs::read_dir(at.path()).unwrap().map(|e| e.unwrap().file_name()).collect();
    assert_eq!(names, ["contact-patch.toml"]);
    let out = faying(at.path(), &["run", "contact-patch.toml", "--dry", "--json"]);
    let document: serde_json::Value = serde_json::from_slice(&out.stdout).unwrap();
    assert_eq!(document["command"], "run");
    assert!(document["predicted"]["memory"].as_f64().unwrap() > 0.0 && document.get("contact").is_none());
    assert_eq!(document["model"].as_array().unwrap().len(), text.lines().count());
    // what is wrong is an error, as in a run
    let out = faying(at.path(), &["run", "contact-patch.toml", "--dry", "--set", "boundary.2.on=upper.tip"]);
    assert_eq!((out.status.code(), stdout(&out).as_str()), (Some(3), ""));
    assert_eq!(faying(at.path(), &["run", "contact-patch.toml", "--dry", "--watch"]).status.code(), Some(2));
}

#[test]
fn a_dry_run_says_which_side_is_slave_and_why() {
    let at = sample("seam");
    let tie = "interface=[{ name = \"found\", between = \"all\" }]";
    let text = stdout(&faying(at.path(), &["run", "seam.toml", "--dry", "--set", tie]));
    let of = |start: &str| text.lines().find(|line| line.trim_start().starts_with(start)).unwrap_or_else(|| panic!("{start}: {text}"));
    assert!(of("interface found").contains("found by `between`: they touch, the finer one is slave"), "{text}");
    assert!(of("slave lower.top").contains("6 elements") && of("master upper.bottom").contains("4 elements"), "{text}");
    let text = stdout(&faying(at.path(), &["run", "seam.toml", "--dry"]));
    assert!(text.contains("Poisson's equation in the plane") && text.contains("an exact solution is given"), "{text}");
    assert!(text.contains("flux u = exact"), "{text}");
    // solids, obstacles and sides found by "all-outer" are told, too
    let at = sample("hertz-solid");
    let text = stdout(&faying(at.path(), &["run", "hertz-solid.toml", "--dry"]));
    assert!(text.contains("against a rigid sphere") && text.contains("(area ") && text.contains("volume "), "{text}");
}

/// The middle of a square whose sides have the value v is v.
const SQUARE: &str = "[let]\nv = 2.0\n[model]\nphysics = \"poisson\"\ndimension = 2\n[[patch]]\nname = \"a\"\n\
    geometry = { kind = \"box\", min = [0, 0], max = [1, 1] }\nelements = [2, 2]\n[[boundary]]\non = \"all-outer\"\ndirichlet = \"v\"\n\
    [[probe]]\nname = \"middle\"\nquantity = \"u at [0.5, 0.5]\"\n";

#[cfg(unix)]
#[test]
fn a_watched_case_is_solved_again_when_it_changes() {
    let at = tempfile::tempdir().unwrap();
    let case = at.path().join("square.toml");
    std::fs::write(&case, SQUARE).unwrap();
    let mut child = program(at.path(), &["run", "square.toml", "--watch"]).stdout(Stdio::piped()).stderr(Stdio::null()).spawn().unwrap();
    let mut lines = BufReader::new(child.stdout.take().unwrap()).lines();
    let mut until = |word: &str| -> String {
        let mut all = String::new();
        for line in lines.by_ref() {
            all += &(line.unwrap() + "\n");
            if all.contains(word) {
                return all;
            }
        }
        panic!("`{word}` never came:\n{all}");
    };
    let first = until("results in square.out");
    assert!(first.contains("middle      2") && !first.contains("changed"), "{first}");
    // an editor puts a new file in the place of the old one
    std::fs::write(at.path().join("new"), SQUARE.replace("v = 2.0", "v = 3.00")).unwrap();
    std::fs::rename(at.path().join("new"), &case).unwrap();
    until("changed since the run before");
    let change = until("middle");
    assert!(change.contains("2") && change.contains("3") && change.contains("50 %"), "{change}");
    // a mistake ends nothing
    std::fs::write(&case, SQUARE.replace("elements = [2, 2]", "elements = [2, 2")).unwrap();
    std::thread::sleep(std::time::Duration::from_millis(700));
    std::fs::write(&case, SQUARE).unwrap();
    let back = until("middle       3    2  -33.3 %");
    assert!(back.contains("square.toml: ok"), "{back}");
    assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
    assert_eq!(child.wait().unwrap().code(), Some(130));
}

#[test]
fn a_watched_case_is_a_file() {
    let at = tempfile::tempdir().unwrap();
    for words in [&["run", "-", "--watch"][..], &["run", "a.toml", "--watch", "--json"]] {
        let out = faying(at.path(), words);
        assert_eq!(out.status.code(), Some(2), "{words:?}");
        assert!(String::from_utf8_lossy(&out.stderr).contains("--watch needs a case in a file"), "{words:?}");
    }
    // one that is not there ends the program; later on it may be away for a moment
    let out = faying(at.path(), &["run", "away.toml", "--watch"]);
    assert_eq!(out.status.code(), Some(4));
    assert!(String::from_utf8_lossy(&out.stderr).contains("E003"), "{}", String::from_utf8_lossy(&out.stderr));
}

#[test]
fn shells_complete_every_command_and_the_manual_has_every_option() {
    let at = tempfile::tempdir().unwrap();
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let out = faying(at.path(), &["completions", shell]);
        let text = stdout(&out);
        assert!(out.status.success() && ["convergence", "infsup", "pairings", "watch"].iter().all(|word| text.contains(word)), "{shell}");
    }
    assert_eq!(faying(at.path(), &["completions", "basic"]).status.code(), Some(2));
    let manual = stdout(&faying(at.path(), &["man"]));
    for word in [".TH faying 1", ".TH faying-run 1", ".TH faying-infsup 1", "\\-\\-save\\-reference", "\\-\\-max\\-memory"] {
        assert!(manual.contains(word), "{word}");
    }
}
