//! Published cases under reference/: every folder's case meets its own checks, with each backend.

use faying_cli::Case;
use faying_cli::case::ReadOptions;
use faying_cli::{Registry, Status};
use std::path::Path;

#[test]
fn published_cases_meet_their_numbers_with_each_backend() {
    let root = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")).join("reference");
    let mut folders: Vec<_> =
        std::fs::read_dir(root).unwrap().map(|f| f.unwrap().path()).filter(|p| p.join("case.toml").is_file()).collect();
    folders.sort();
    assert!(!folders.is_empty());
    for folder in folders {
        let expected: serde_json::Value = serde_json::from_str(&std::fs::read_to_string(folder.join("expected.json")).unwrap()).unwrap();
        // cases whose expected.json holds one number have a test of their own
        let Some(quantities) = expected["quantities"].as_array() else { continue };
        for backend in ["iga", "fe"] {
            let options = ReadOptions { backend: Some(backend.into()), ..ReadOptions::default() };
            let case = Case::read_with(folder.join("case.toml"), &options).unwrap_or_else(|e| panic!("{e}"));
            let result = case.run(&Registry::default()).unwrap_or_else(|e| panic!("{e}"));
            assert_eq!(result.status, Status::Ok, "{} {backend}: {:?} {:?}", folder.display(), result.checks, result.diagnostics);
            assert!(folder.join("source.md").is_file(), "{} has no source.md", folder.display());
            for c in &result.checks {
                println!("{} {backend}: {} = {:.7}", folder.display(), c.quantity, c.value);
            }
            // the numbers of expected.json are those that the case as written checks
            if backend != "iga" {
                continue;
            }
            for entry in quantities {
                let quantity = entry["quantity"].as_str().unwrap();
                let value = entry["value"].as_f64().unwrap();
                assert!(
                    result.checks.iter().any(|c| c.quantity == quantity && c.expected == value),
                    "{}: {quantity} = {value} is not checked",
                    folder.display()
                );
            }
        }
    }
}
