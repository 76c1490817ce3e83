//! The documents of reference/data/: what FEniCSx finds for the same problems.

use serde_json::Value;
use std::path::{Path, PathBuf};

/// The root of the crate.
pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).to_owned()
}

/// reference/data/NAME.json.
pub fn document(name: &str) -> Value {
    let path = root().join("reference/data").join(format!("{name}.json"));
    let text = std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    serde_json::from_str(&text).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

/// The texts of a list.
pub fn texts(list: &Value) -> Vec<String> {
    list.as_array().map(|l| l.iter().map(|t| t.as_str().unwrap().to_owned()).collect()).unwrap_or_default()
}

/// A value of the reference with its estimated error.
#[derive(Clone, Debug)]
pub struct Known {
    /// The quantity as the document writes it.
    pub quantity: String,
    pub value: f64,
    pub error: f64,
}

/// The entry of a list of quantities; an error that is not stored is zero.
pub fn known(entry: &Value) -> Known {
    let quantity = entry["quantity"].as_str().unwrap().to_owned();
    Known { quantity, value: entry["value"].as_f64().unwrap(), error: entry["error"].as_f64().unwrap_or(0.0) }
}

/// The entries of a list of quantities.
pub fn all_known(list: &Value) -> Vec<Known> {
    list.as_array().unwrap().iter().map(known).collect()
}
