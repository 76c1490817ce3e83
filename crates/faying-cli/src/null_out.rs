//! Numbers of a result that were not computed: left out, or `null` with a reason; never zero.

use serde_json::{Map, Value};

/// Members of a result that only a solved step fills.
const SOLVED: [&str; 6] = ["contact", "interface", "reactions", "balance", "energy", "errors"];
/// Members that are known without a solution, too.
const CHECKED: [&str; 1] = ["loads"];
/// Members that are known once the bodies are built.
const BUILT: [&str; 4] = ["backend", "backends", "unknowns", "geometry"];

/// Removes (`looked_at`: there was nothing to solve) or sets to `null` the numbers that were not computed, in the document of a result
/// without a solution.
pub fn forget(document: &mut Value, looked_at: bool, built: bool) {
    let Value::Object(map) = document else { return };
    if looked_at {
        SOLVED.iter().for_each(|key| drop(map.remove(*key)));
    } else {
        let reason = "nothing was solved";
        for key in SOLVED.iter().chain(&CHECKED).chain(&["solve"]) {
            map.get_mut(*key).into_iter().for_each(|inner| blank(inner, reason));
        }
        map.insert("reason".into(), reason.into());
    }
    if !built {
        for key in BUILT {
            if looked_at {
                map.remove(key);
            } else {
                map.insert(key.into(), Value::Null);
            }
        }
    }
}

/// Replaces every number by `null` and adds `reason` to the objects that hold one.
fn blank(value: &mut Value, reason: &str) {
    match value {
        Value::Number(_) => *value = Value::Null,
        Value::Array(items) => items.iter_mut().for_each(|item| blank(item, reason)),
        Value::Object(map) => {
            map.values_mut().for_each(|inner| blank(inner, reason));
            say(map, reason);
        }
        _ => {}
    }
}

fn say(map: &mut Map<String, Value>, reason: &str) {
    let blank = |v: &Value| v.is_null() || v.as_array().is_some_and(|list| list.contains(&Value::Null));
    if map.values().any(blank) && !map.contains_key("reason") {
        map.insert("reason".into(), reason.into());
    }
}
