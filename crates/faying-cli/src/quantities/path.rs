//! Numbers of a result by their path, and the short names some of them have.

use serde_json::Value;

/// Resolves the path of a quantity to the path in `result.json`.
///
/// Short names: `error.*` in `errors`, `reaction.SIDE.y` in `reactions`, `area.PATCH` and `volume.PATCH` in
/// `geometry.measure`, `interface.NAME.segments` and `.measure` in `interface.NAME.segments`.
pub fn resolve(path: &[String]) -> Vec<String> {
    let list = |parts: &[&str], rest: &[String]| parts.iter().map(|s| (*s).to_string()).chain(rest.iter().cloned()).collect::<Vec<_>>();
    let words: Vec<&str> = path.iter().map(String::as_str).collect();
    match words.as_slice() {
        ["error", ..] => vec!["errors".into(), path.join(".")],
        ["reaction", ..] => list(&["reactions"], &path[1..]),
        ["area" | "volume", _] => list(&["geometry", "measure"], &path[1..]),
        ["interface" | "contact", name, "segments"] => list(&[words[0], name, "segments", "count"], &[]),
        ["interface", name, "measure"] => list(&["interface", name, "segments", "measure"], &[]),
        ["interface", name, "lambda"] => list(&["interface", name, "lambda", "norm"], &[]),
        _ => path.to_vec(),
    }
}

/// Returns the number at the end of `path`; keys may hold dots, entries of lists are numbered or called x, y, z.
///
/// `None`: no such path. `Some(Err(reason))`: the number is not finite.
pub fn look_up(value: &Value, path: &[String]) -> Option<Result<f64, String>> {
    if path.len() == 1 && path[0] == "unknowns" {
        let part = |key: &str| value["unknowns"][key].as_f64().unwrap_or(0.0);
        return Some(Ok(part("primal") + part("multipliers")));
    }
    let path = resolve(path);
    let found = find(value, &path, "the number is not finite");
    match path.as_slice() {
        // of the plane it is a number
        [whole @ .., axis] if axis == "z" && whole.last().is_some_and(|key| key == "moment") => {
            found.or_else(|| find(value, whole, "the number is not finite"))
        }
        _ => found,
    }
}

/// `reason`: that for a number without value, of the innermost object that holds it and gives one.
fn find(value: &Value, path: &[String], reason: &str) -> Option<Result<f64, String>> {
    let Some(first) = path.first() else {
        return match value {
            Value::Number(n) => n.as_f64().map(Ok),
            Value::Bool(b) => Some(Ok(f64::from(u8::from(*b)))),
            Value::Null => Some(Err(reason.into())),
            _ => None,
        };
    };
    match value {
        Value::Object(map) => {
            let reason = map.get("reason").and_then(Value::as_str).unwrap_or(reason);
            (1..=path.len()).find_map(|n| map.get(&path[..n].join(".")).and_then(|inner| find(inner, &path[n..], reason)))
        }
        Value::Array(items) => {
            let by_name = items.iter().find(|item| item.get("name").and_then(Value::as_str) == Some(first));
            let index = first.parse::<usize>().ok().or_else(|| super::grammar::axis(first));
            by_name.or_else(|| index.and_then(|k| items.get(k))).and_then(|inner| find(inner, &path[1..], reason))
        }
        _ => None,
    }
}

/// Returns every path to a number in `value`, for suggestions.
pub fn known(value: &Value) -> Vec<String> {
    fn walk(value: &Value, prefix: &str, list: &mut Vec<String>) {
        match value {
            Value::Object(map) => map.iter().for_each(|(key, inner)| {
                let path = if prefix.is_empty() || prefix == "errors" { key.clone() } else { format!("{prefix}.{key}") };
                walk(inner, &path, list);
            }),
            Value::Array(items) if prefix == "probes" => {
                for name in items.iter().filter_map(|item| item.get("name").and_then(Value::as_str)) {
                    list.push(format!("probes.{name}.value"));
                }
            }
            Value::Array(items) if items.len() <= 3 => {
                for (inner, letter) in items.iter().zip(["x", "y", "z"]) {
                    walk(inner, &format!("{prefix}.{letter}"), list);
                }
            }
            Value::Number(_) | Value::Null => list.push(prefix.replacen("reactions.", "reaction.", 1)),
            _ => {}
        }
    }
    let mut list = Vec::new();
    walk(value, "", &mut list);
    list
}

/// The numbers of `value` beside a path that leads to none: the longest part of the path that is the beginning of some, and these.
pub fn beside(value: &Value, path: &[String]) -> Option<(String, Vec<String>)> {
    let all = known(value);
    (1..=path.len()).rev().find_map(|n| {
        let stem = path[..n].join(".").replacen("reactions.", "reaction.", 1);
        let own: Vec<String> = all.iter().filter(|k| k.strip_prefix(&*stem).is_some_and(|rest| rest.starts_with('.'))).cloned().collect();
        (!own.is_empty()).then_some((stem, own))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn at(value: &Value, path: &str) -> Option<f64> {
        let parts = super::super::grammar::parts(path).unwrap();
        look_up(value, &parts).and_then(Result::ok)
    }

    #[test]
    fn any_number_of_a_result_is_found_by_its_path() {
        let value = json!({
            "unknowns": {"primal": 300, "multipliers": 15},
            "geometry": {"measure": {"lower": 0.5}},
            "contact": {"pad": {"force": [0.0, 1.25e-3], "moment": 6.25e-4, "segments": {"count": 10, "measure": 1.0}}},
            "reactions": {"lower.bottom": [0.0, -1.25e-3]},
            "errors": {"error.u.L2": 1e-4},
            "probes": [{"name": "tip", "value": 7.0}]
        });
        assert_eq!(at(&value, "unknowns"), Some(315.0));
        assert_eq!(at(&value, "unknowns.primal"), Some(300.0));
        assert_eq!(at(&value, "area.lower"), Some(0.5));
        assert_eq!(at(&value, "contact.pad.force.y"), Some(1.25e-3));
        assert_eq!(at(&value, "contact.pad.force.1"), Some(1.25e-3));
        assert_eq!(at(&value, "contact.pad.moment.z"), Some(6.25e-4));
        assert_eq!(at(&value, "contact.pad.moment.x"), None);
        let solid = json!({"contact": {"pad": {"moment": [1.0, 2.0, 3.0]}}});
        assert_eq!(at(&solid, "contact.pad.moment.z"), Some(3.0));
        assert_eq!(at(&value, "contact.pad.segments"), Some(10.0));
        assert_eq!(at(&value, "reaction.lower.bottom.y"), Some(-1.25e-3));
        assert_eq!(at(&value, "error.u.L2"), Some(1e-4));
        assert_eq!(at(&value, "probes.tip.value"), Some(7.0));
        assert_eq!(at(&value, "contact.pod.force.y"), None);
        assert!(known(&value).contains(&"reaction.lower.bottom.y".to_string()));
        assert!(known(&value).contains(&"error.u.L2".to_string()));
    }
}
