//! A checker for the part of JSON Schema 2020-12 that the program's schemas use; an unknown word of a schema is a failure.

use serde_json::Value;

/// Words that demand nothing.
const REMARKS: [&str; 5] = ["$schema", "title", "description", "default", "$defs"];

/// What is wrong with `value`: a path and a sentence each.
pub fn faults(schema: &Value, value: &Value) -> Vec<String> {
    let mut found = Vec::new();
    check(schema, schema, value, "", &mut found);
    found
}

fn holds(root: &Value, schema: &Value, value: &Value) -> bool {
    let mut found = Vec::new();
    check(root, schema, value, "", &mut found);
    found.is_empty()
}

fn check(root: &Value, schema: &Value, value: &Value, path: &str, found: &mut Vec<String>) {
    let words = schema.as_object().unwrap_or_else(|| panic!("no schema: {schema}"));
    let mut here: Vec<String> = Vec::new();
    let mut wrong = |text: String| here.push(format!("{path}: {text}"));
    let list = |v: &Value| v.as_array().cloned().unwrap();
    for (word, demand) in words {
        match word.as_str() {
            "type" => {
                let types = demand.as_array().cloned().unwrap_or_else(|| vec![demand.clone()]);
                if !types.iter().any(|t| is(value, t.as_str().unwrap())) {
                    wrong(format!("{value} is no {demand}"));
                }
            }
            "enum" => {
                if !list(demand).contains(value) {
                    wrong(format!("{value} is none of {demand}"));
                }
            }
            "const" => {
                if value != demand {
                    wrong(format!("{value} is not {demand}"));
                }
            }
            "minimum" | "maximum" | "exclusiveMinimum" => {
                let (v, limit) = (value.as_f64(), demand.as_f64().unwrap());
                let good = v.is_none_or(|v| match word.as_str() {
                    "minimum" => v >= limit,
                    "maximum" => v <= limit,
                    _ => v > limit,
                });
                if !good {
                    wrong(format!("{value} breaks {word} {demand}"));
                }
            }
            "minItems" | "maxItems" => {
                let n = value.as_array().map(Vec::len);
                let limit = demand.as_u64().unwrap() as usize;
                if n.is_some_and(|n| if word == "minItems" { n < limit } else { n > limit }) {
                    wrong(format!("{value} breaks {word} {demand}"));
                }
            }
            "maxLength" => {
                if value.as_str().is_some_and(|text| text.chars().count() as u64 > demand.as_u64().unwrap()) {
                    wrong(format!("{value} is longer than {demand}"));
                }
            }
            "pattern" => {
                if value.as_str().is_some_and(|text| !matches(text, demand.as_str().unwrap())) {
                    wrong(format!("{value} does not match {demand}"));
                }
            }
            "required" => {
                for key in list(demand) {
                    if value.as_object().is_some_and(|map| !map.contains_key(key.as_str().unwrap())) {
                        wrong(format!("{key} is missing"));
                    }
                }
            }
            "anyOf" => {
                if !list(demand).iter().any(|s| holds(root, s, value)) {
                    wrong(format!("{value} is nothing that may stand here"));
                }
            }
            "oneOf" => {
                let n = list(demand).iter().filter(|s| holds(root, s, value)).count();
                if n != 1 {
                    wrong(format!("{value} fits {n} schemas of one"));
                }
            }
            "allOf" => list(demand).iter().for_each(|s| check(root, s, value, path, found)),
            "$ref" => check(root, referred(root, demand), value, path, found),
            "items" => {
                for (k, item) in value.as_array().into_iter().flatten().enumerate() {
                    check(root, demand, item, &format!("{path}/{k}"), found);
                }
            }
            "properties" => {
                for (key, inner) in value.as_object().into_iter().flatten() {
                    if let Some(s) = demand.get(key) {
                        check(root, s, inner, &format!("{path}/{key}"), found);
                    }
                }
            }
            "additionalProperties" => {
                for (key, inner) in value.as_object().into_iter().flatten() {
                    if words.get("properties").is_some_and(|p| p.get(key).is_some()) {
                        continue;
                    }
                    match demand {
                        Value::Bool(true) => {}
                        Value::Bool(false) => found.push(format!("{path}: `{key}` is not known")),
                        s => check(root, s, inner, &format!("{path}/{key}"), found),
                    }
                }
            }
            other => assert!(REMARKS.contains(&other), "the checker does not know `{other}`"),
        }
    }
    found.append(&mut here);
}

fn referred<'a>(root: &'a Value, reference: &Value) -> &'a Value {
    let path = reference.as_str().unwrap().strip_prefix('#').unwrap();
    root.pointer(path).unwrap_or_else(|| panic!("{reference} leads nowhere"))
}

fn is(value: &Value, kind: &str) -> bool {
    match kind {
        "null" => value.is_null(),
        "boolean" => value.is_boolean(),
        "string" => value.is_string(),
        "array" => value.is_array(),
        "object" => value.is_object(),
        "number" => value.is_number(),
        "integer" => value.as_f64().is_some_and(|v| v.fract() == 0.0),
        other => panic!("no type {other}"),
    }
}

/// The two patterns of the schema.
fn matches(text: &str, pattern: &str) -> bool {
    match pattern {
        "^[A-Za-z0-9_-]+$" => !text.is_empty() && text.chars().all(|c| c.is_ascii_alphanumeric() || c == '_' || c == '-'),
        "^p/p-([1-9]|1[0-2])$" => {
            text.strip_prefix("p/p-").is_some_and(|k| !k.starts_with('0') && k.parse::<u8>().is_ok_and(|k| (1..=12).contains(&k)))
        }
        other => panic!("the checker does not know the pattern {other}"),
    }
}
