//! `faying schema`: JSON Schemas of the case file and of `result.json`, for editors and other programs.

use super::arguments::{SchemaArguments, SchemaOf};
use super::ended::Exit;
use crate::case;
use crate::{Registry, result_schema};

/// Prints a schema; with `--json` it is the document.
pub fn schema(registry: &Registry, arguments: &SchemaArguments) -> Exit {
    let schema = match arguments.of {
        SchemaOf::Case => case::schema(&registry.case_names()),
        SchemaOf::Result => result_schema(),
    };
    let mut text = serde_json::to_string_pretty(&schema).expect("a schema has string keys and plain values only");
    text.push('\n');
    Exit { summary: text.clone(), document: text, ..Exit::default() }
}
