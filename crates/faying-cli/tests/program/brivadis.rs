//! The studies under reference/brivadis: every number of their expected.json is found again.
//!
//! FAYING_BRIVADIS=FOLDER runs them whole and leaves their reports in FOLDER; without it fewer levels are run, and what they do
//! not reach is not looked at.

use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::Command;

/// A study of a case, and what it must find.
struct Study {
    folder: PathBuf,
    spec: Value,
}

fn studies() -> Vec<Study> {
    let root = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")).join("reference/brivadis");
    let mut folders: Vec<PathBuf> = std::fs::read_dir(root).unwrap().map(|f| f.unwrap().path()).filter(|p| p.is_dir()).collect();
    folders.sort();
    let read = |folder: &PathBuf| {
        assert!(folder.join("source.md").is_file(), "{} has no source.md", folder.display());
        let expected: Value = serde_json::from_str(&std::fs::read_to_string(folder.join("expected.json")).unwrap()).unwrap();
        expected["studies"].as_array().unwrap().iter().map(|spec| Study { folder: folder.clone(), spec: spec.clone() }).collect::<Vec<_>>()
    };
    folders.iter().flat_map(read).collect()
}

fn words(list: &Value) -> Vec<String> {
    list.as_array().map(|list| list.iter().map(|w| w.as_str().unwrap().to_owned()).collect()).unwrap_or_default()
}

impl Study {
    fn name(&self) -> String {
        format!("{}-{}", self.folder.file_name().unwrap().to_string_lossy(), self.spec["name"].as_str().unwrap())
    }

    /// The rows of `result.json`; of a run, which has none, the whole of it as one.
    fn run(&self, out: &Path, whole: bool) -> Vec<Value> {
        let quick = words(&self.spec["quick"]);
        let options = if whole || quick.is_empty() { words(&self.spec["options"]) } else { quick };
        let out = out.join(self.name());
        let done = Command::new(env!("CARGO_BIN_EXE_faying"))
            .arg(self.spec["command"].as_str().unwrap())
            .arg(self.folder.join(self.spec["case"].as_str().unwrap()))
            .args(&options)
            .args(["--force", "-q", "--out"])
            .arg(&out)
            .output()
            .unwrap();
        // rows that cannot be stay in the table: their place in it is part of what is expected
        let known = [0, 1, 3].contains(&done.status.code().unwrap_or(-1));
        assert!(known, "{}: {:?} {}", self.name(), done.status, String::from_utf8_lossy(&done.stderr));
        let text = std::fs::read_to_string(out.join("result.json")).unwrap_or_else(|e| panic!("{}: {e}", self.name()));
        let result: Value = serde_json::from_str(&text).unwrap();
        result["rows"].as_array().cloned().unwrap_or_else(|| vec![result])
    }
}

/// What an entry says of a number: nothing where it holds.
fn departure(entry: &Value, found: Option<f64>) -> Option<String> {
    let bound = |key: &str| entry[key].as_f64();
    let Some(found) = found else { return Some("there is no such number".into()) };
    if let Some(value) = bound("value") {
        let allowed = bound("atol").unwrap_or(0.0) + bound("rtol").unwrap_or(0.0) * value.abs();
        return ((found - value).abs() > allowed).then(|| format!("{value} expected within {allowed:.1e}"));
    }
    let (above, below) = (bound("above"), bound("below"));
    assert!(above.is_some() || below.is_some(), "{entry} expects nothing");
    let holds = above.is_none_or(|b| found > b) && below.is_none_or(|b| found < b);
    (!holds).then(|| format!("expected above {above:?}, below {below:?}"))
}

#[test]
fn studies_of_the_thesis_find_its_numbers_again() {
    let folder = std::env::var_os("FAYING_BRIVADIS").map(PathBuf::from);
    let whole = folder.is_some();
    let temporary = tempfile::tempdir().unwrap();
    let out = folder.unwrap_or_else(|| temporary.path().to_owned());
    std::fs::create_dir_all(&out).unwrap();
    let mut departs = Vec::new();
    for study in studies() {
        let rows = study.run(&out, whole);
        let mut looked_at = 0;
        for entry in study.spec["expected"].as_array().unwrap() {
            let wanted = entry["row"].as_object().unwrap();
            let Some(row) = rows.iter().find(|row| wanted.iter().all(|(key, value)| row[key] == *value)) else {
                assert!(!whole, "{}: no row {}", study.name(), entry["row"]);
                continue;
            };
            looked_at += 1;
            let path = entry["quantity"].as_str().unwrap();
            let found = row.pointer(path);
            let says = match entry["is"].as_str() {
                Some(word) => (found.and_then(Value::as_str) != Some(word)).then(|| format!("expected {word}")),
                None => departure(entry, found.and_then(Value::as_f64)),
            };
            println!("{:28} {} {path} = {} {}", study.name(), entry["row"], found.unwrap_or(&Value::Null), says.as_deref().unwrap_or(""));
            departs.extend(says.map(|says| format!("{} {} {path}: {}, {says}", study.name(), entry["row"], found.unwrap_or(&Value::Null))));
        }
        assert!(looked_at > 0, "{}: nothing was looked at", study.name());
    }
    assert!(departs.is_empty(), "{} departures:\n{}", departs.len(), departs.join("\n"));
}
