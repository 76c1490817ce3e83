//! The documents of reference/data/, and runs of the cases that they name.

use faying_cli::Case;
use faying_cli::case::ReadOptions;
use faying_cli::{Registry, RunResult};
use serde_json::Value;
use std::path::{Path, PathBuf};

fn reference() -> PathBuf {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")).join("reference")
}

/// reference/data/NAME.json.
pub fn document(name: &str) -> Value {
    let path = reference().join("data").join(format!("{name}.json"));
    let text = std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    serde_json::from_str(&text).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

/// reference/dolfinx/cases/CASE.toml with `--set` texts, asked for `quantities` beside its own.
pub fn case(case: &str, sets: &[String], quantities: &[String]) -> Case {
    let folder = reference().join("dolfinx/cases");
    let file = format!("{case}.toml");
    let mut text = std::fs::read_to_string(folder.join(&file)).unwrap_or_else(|e| panic!("{file}: {e}"));
    for (k, quantity) in quantities.iter().enumerate() {
        text += &format!("\n[[probe]]\nname = \"asked-{k}\"\nquantity = '{quantity}'\n");
    }
    let options = ReadOptions { sets: sets.to_vec(), folder: Some(folder), ..ReadOptions::default() };
    Case::parse(&file, &text, &options).unwrap_or_else(|e| panic!("{file} {sets:?}: {e}"))
}

/// The numbers of [`case`].
pub fn run(name: &str, sets: &[String], quantities: &[String]) -> RunResult {
    case(name, sets, quantities).run(&Registry::default()).unwrap_or_else(|e| panic!("{name} {sets:?}: {e}"))
}

/// The values of the quantities that [`run`] was asked for, in their order.
pub fn asked(result: &RunResult) -> Vec<f64> {
    result.probes.iter().filter(|p| p.name.starts_with("asked-")).map(|p| p.value).collect()
}

/// The texts of a list.
pub fn texts(list: &Value) -> Vec<String> {
    list.as_array().map(|l| l.iter().map(|t| t.as_str().unwrap().to_owned()).collect()).unwrap_or_default()
}
