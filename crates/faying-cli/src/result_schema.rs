//! JSON Schema of `result.json` and of the document of `--json`.

use serde_json::Value;

/// The schema: what every field means, which are always there. Fields may be added within `faying.result/1`, so others are allowed.
pub fn result_schema() -> Value {
    serde_json::from_str(include_str!("result.schema.json")).expect("a test reads the schema")
}
