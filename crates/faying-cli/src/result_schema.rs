//! JSON Schema of `result.json` and of the document of `--json`.

use serde_json::Value;

/// Returns the schema: the meaning of every field and the required ones. Other fields are allowed: `faying.result/1` may be extended.
pub fn result_schema() -> Value {
    serde_json::from_str(include_str!("result.schema.json")).expect("a test reads the schema")
}
