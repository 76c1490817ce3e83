//! `faying schema`: the JSON Schema (2020-12) of the case file, made of the reader's own key tables and the known names.

use super::keys;
use super::names::{EntryKeys, Names, built_in_couplings, built_in_methods};
use super::not_yet::{LATER_KEYS, Plain, later_of};
use super::schema_keys::{ENTRIES, Entry};
use serde_json::{Map, Value, json};

/// The schema of a case file, as the JSON that its TOML stands for; `names` are those of a registry.
///
/// Every block has the keys of the reader and no others. What depends on other keys (numbers per dimension, conditions that
/// exclude each other) is checked by the reader alone.
pub fn schema(names: &Names) -> Value {
    let mut root = block("", "", keys::ROOT, &["model", "patch"]);
    let all = properties(&mut root);
    all.insert("model".into(), described("", "model", block("model", "model", keys::MODEL, &["physics", "dimension"])));
    all.insert(
        "discretization".into(),
        described("", "discretization", block("discretization", "discretization", keys::DISCRETIZATION, &[])),
    );
    all.insert("steps".into(), described("", "steps", block("steps", "steps", keys::STEPS, &[])));
    all.insert("solver".into(), described("", "solver", block("solver", "solver", keys::SOLVER, &[])));
    let lists: [(&str, &[&'static str], &[&str]); 7] = [
        ("material", keys::MATERIAL, &["name"]),
        ("patch", keys::PATCH, &["name", "geometry"]),
        ("boundary", keys::BOUNDARY, &["on"]),
        ("interface", keys::INTERFACE, &[]),
        ("contact", keys::CONTACT, &[]),
        ("probe", keys::PROBE, &["quantity"]),
        ("check", keys::CHECK, &["quantity"]),
    ];
    for (name, known, required) in lists {
        let mut item = block(name, name, known, required);
        also(&mut item, name);
        if name == "material" && !names.laws.is_empty() {
            let laws: Vec<&str> = std::iter::once("hooke").chain(names.laws.iter().map(|law| law.name.as_str())).collect();
            let all = properties(&mut item);
            all.insert("law".into(), json!({"enum": laws, "description": "law of the material", "default": "hooke"}));
            for key in names.laws.iter().flat_map(|law| &law.keys) {
                all.entry(key.name).or_insert_with(|| key.schema());
            }
        }
        let own = match name {
            "interface" => names.coupling_keys.clone(),
            "contact" => names.method_keys(),
            _ => Vec::new(),
        };
        entry_keys(&mut item, &own);
        all.insert(name.into(), described("", name, json!({"type": "array", "items": item})));
    }
    let studies: Map<String, Value> = keys::STUDIES.iter().map(|s| ((*s).to_owned(), block("study", "study", keys::STUDY, &[]))).collect();
    let study = json!({"type": "object", "properties": studies, "additionalProperties": false});
    all.insert("study".into(), described("", "study", study));

    let map = root.as_object_mut().expect("a block is an object");
    map.insert("$defs".into(), definitions(names));
    let mut document = json!({
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "faying case file, schema 1",
    });
    document.as_object_mut().expect("a document is an object").append(map);
    document
}

/// Adds the keys of entries of the registry to a block; each says whose it is.
fn entry_keys(item: &mut Value, entries: &[EntryKeys]) {
    let all = properties(item);
    for key in entries.iter().flat_map(|e| &e.keys) {
        let owners: Vec<&str> = entries.iter().filter(|e| e.keys.iter().any(|k| k.name == key.name)).map(|e| e.name.as_str()).collect();
        let mut value = key.schema();
        value["description"] = json!(format!("{}: {}", owners.join(", "), key.text));
        all.entry(key.name).or_insert(value);
    }
}

/// Whether `word` is a key of some block, built or not.
pub(crate) fn is_key(word: &str) -> bool {
    let own = built_in_couplings().into_iter().chain(built_in_methods().into_iter().map(|m| m.entry)).flat_map(|e| e.keys);
    ENTRIES.iter().any(|e| e.key == word)
        || own.into_iter().any(|key| key.name == word)
        || keys::ALIASES.iter().any(|(alias, _)| *alias == word)
        || LATER_KEYS.iter().any(|(_, key, ..)| *key == word)
}

/// The entry of a key.
fn entry(of: &str, key: &str) -> &'static Entry {
    ENTRIES.iter().find(|e| e.block == of && e.key == key).expect("a test holds the entries against the keys of the reader")
}

fn described(of: &str, key: &str, mut value: Value) -> Value {
    value["description"] = json!(entry(of, key).text);
    value
}

/// A table with the keys `known`, which `of` describes.
fn block(of: &str, title: &str, known: &[&'static str], required: &[&str]) -> Value {
    let mut properties = Map::new();
    for key in known {
        let e = entry(of, key);
        let mut value: Value = serde_json::from_str(e.kind).expect("a test reads every entry");
        value["description"] = json!(e.text);
        properties.insert((*key).to_owned(), value);
        // other names of a key
        for (alias, _) in keys::ALIASES.iter().filter(|(_, meant)| meant == key) {
            let mut same: Value = serde_json::from_str(e.kind).expect("a test reads every entry");
            same["description"] = json!(format!("another name of `{key}`"));
            properties.insert((*alias).to_owned(), same);
        }
    }
    for (_, key, plain, _) in later_of(of) {
        let mut value = match plain {
            Plain::Never => continue,
            Plain::Zero => json!({"type": "number", "minimum": 0, "maximum": 0}),
            Plain::Words(plain, _) => json!({"enum": plain}),
        };
        value["description"] = json!("other values are not in this version");
        properties.insert((*key).to_owned(), value);
    }
    let mut value = json!({"type": "object", "properties": properties, "additionalProperties": false});
    if !title.is_empty() {
        value["title"] = json!(title);
    }
    if !required.is_empty() {
        value["required"] = json!(required);
    }
    value
}

fn properties(block: &mut Value) -> &mut Map<String, Value> {
    block["properties"].as_object_mut().expect("a block has properties")
}

/// Adds the conditions of a block on combinations of keys.
fn also(item: &mut Value, name: &str) {
    let one_of_names = |key: &str| {
        let names = std::iter::once(key).chain(keys::ALIASES.iter().filter(|(_, k)| *k == key).map(|(a, _)| *a));
        json!({"anyOf": names.map(|n| json!({"required": [n]})).collect::<Vec<_>>()})
    };
    let any = |names: &[&str]| json!(names.iter().map(|n| json!({"required": [n]})).collect::<Vec<_>>());
    match name {
        "interface" => {
            item["anyOf"] = json!([{"required": ["between"]}, {"allOf": [one_of_names("slave"), one_of_names("master")]}]);
        }
        "contact" => {
            item["allOf"] = json!([one_of_names("slave"), {"anyOf": [one_of_names("master"), {"required": ["rigid"]}]}]);
        }
        "check" => item["oneOf"] = any(&["below", "above", "equals"]),
        "boundary" => {
            let conditions: Vec<&str> = keys::BOUNDARY.iter().copied().filter(|k| !["name", "on", "where"].contains(k)).collect();
            item["anyOf"] = any(&conditions);
        }
        _ => {}
    }
}

/// Tables with a `kind`, one of `kinds`.
fn kinded(kinds: &[(&'static str, &'static [&'static str])], common: &[(&str, &[&'static str])]) -> Value {
    let one = |kind: &str, own: &[&'static str]| {
        let mut value = block(kind, kind, own, required(kind));
        for (of, known) in common {
            let more = block(of, "", known, &[]);
            properties(&mut value).extend(more["properties"].as_object().expect("a block has properties").clone());
        }
        properties(&mut value).insert("kind".into(), json!({"const": kind}));
        let mut needed = vec![json!("kind")];
        needed.extend(value["required"].as_array().cloned().unwrap_or_default());
        value["required"] = json!(needed);
        value
    };
    json!({"type": "object", "oneOf": kinds.iter().map(|(kind, own)| one(kind, own)).collect::<Vec<_>>()})
}

/// An obstacle of the registry.
fn added_obstacle(entry: &EntryKeys) -> Value {
    let mut value = block("obstacle", &entry.name, keys::OBSTACLE, &[]);
    let all = properties(&mut value);
    all.insert("kind".into(), json!({"const": entry.name}));
    all.extend(entry.keys.iter().map(|key| (key.name.to_owned(), key.schema())));
    let needed = std::iter::once("kind").chain(entry.keys.iter().filter(|k| k.is_required()).map(|k| k.name));
    value["required"] = json!(needed.collect::<Vec<_>>());
    value
}

/// Required keys of a kind.
fn required(kind: &str) -> &'static [&'static str] {
    match kind {
        "box" => &["min", "max"],
        "annulus-sector" | "disc-sector" => &["radius", "angle_deg"],
        "plate-with-hole" => &["radius", "half_width"],
        "sphere-octant" => &["radius"],
        "nurbs" | "nurbs-curve" => &["degree", "knots", "points"],
        "file" => &["file"],
        "half-plane" => &["point", "normal"],
        "sphere" => &["center", "radius"],
        "cylinder" | "torus" => &["center", "axis", "radius"],
        "level-set" => &["f"],
        _ => &[],
    }
}

fn definitions(names: &Names) -> Value {
    let mut obstacle = kinded(keys::OBSTACLES, &[("obstacle", keys::OBSTACLE)]);
    let mut shapes = kinded(keys::GEOMETRIES, &[("motion", keys::PLACING), ("obstacle", keys::OBSTACLE)]);
    let mut curve = kinded(&[("nurbs-curve", keys::NURBS_CURVE)], &[("motion", keys::PLACING), ("obstacle", keys::OBSTACLE)]);
    curve["oneOf"][0]["properties"]["kind"] = json!({"const": "nurbs"});
    let kinds = obstacle["oneOf"].as_array_mut().expect("a list of kinds");
    kinds.extend(names.obstacles.iter().map(added_obstacle));
    for more in [&mut shapes, &mut curve] {
        kinds.append(more["oneOf"].as_array_mut().expect("a list of kinds"));
    }
    json!({
        "name": {"type": "string", "pattern": "^[A-Za-z0-9_-]+$"},
        "number": {"type": ["number", "string"], "description": "a number, or a quoted formula of constants"},
        "positive": {"anyOf": [{"type": "number", "exclusiveMinimum": 0}, {"type": "string"}]},
        "formula": {"type": ["number", "string"], "description": "a number, or a quoted formula of x, y, z, t, r, theta and the names of [let]"},
        "vector": {"type": "array", "items": {"$ref": "#/$defs/number"}, "minItems": 2, "maxItems": 3},
        "field": {"anyOf": [{"$ref": "#/$defs/formula"}, {"type": "array", "items": {"$ref": "#/$defs/formula"}, "minItems": 1, "maxItems": 3}]},
        "components": {"anyOf": [{"$ref": "#/$defs/field"}, {"type": "object", "properties":
            {"x": {"$ref": "#/$defs/formula"}, "y": {"$ref": "#/$defs/formula"}, "z": {"$ref": "#/$defs/formula"}, "u": {"$ref": "#/$defs/formula"}},
            "additionalProperties": false}]},
        "sides": {"anyOf": [{"type": "string"}, {"type": "array", "items": {"type": "string"}, "minItems": 1}]},
        "words": {"anyOf": [{"type": "string"}, {"type": "array", "items": {"type": "string"}}]},
        "degree": {"type": "integer", "minimum": 1, "maximum": 12},
        "auto": {"anyOf": [{"const": "auto"}, {"$ref": "#/$defs/positive"}]},
        "extra_points": {"type": "integer", "minimum": 0, "maximum": 60},
        "backend": {"enum": names.backends},
        "coupling": {"enum": names.couplings},
        "method": {"enum": names.methods.iter().map(|m| &m.entry.name).collect::<Vec<_>>()},
        "constraint": {"enum": names.constraints},
        "integration": {"enum": names.integrations},
        "multiplier": {"anyOf": [{"enum": names.multipliers}, {"type": "string", "pattern": "^p/p-([1-9]|1[0-2])$"},
            block("multiplier", "multiplier", keys::MULTIPLIER, &["degree"])]},
        "active_set": block("active_set", "active_set", keys::ACTIVE_SET, &[]),
        "grade": block("grade", "grade", keys::GRADE, &["toward", "ratio"]),
        "geometry": kinded(keys::GEOMETRIES, &[("motion", keys::MOTIONS)]),
        "obstacle": obstacle,
    })
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    /// Every block of the reader with its keys.
    fn tables() -> Vec<(&'static str, Vec<&'static str>)> {
        let mut all: Vec<(&str, &[&str])> = vec![
            ("", keys::ROOT),
            ("model", keys::MODEL),
            ("discretization", keys::DISCRETIZATION),
            ("material", keys::MATERIAL),
            ("patch", keys::PATCH),
            ("motion", keys::MOTIONS),
            ("grade", keys::GRADE),
            ("boundary", keys::BOUNDARY),
            ("interface", keys::INTERFACE),
            ("contact", keys::CONTACT),
            ("obstacle", keys::OBSTACLE),
            ("nurbs-curve", keys::NURBS_CURVE),
            ("multiplier", keys::MULTIPLIER),
            ("active_set", keys::ACTIVE_SET),
            ("steps", keys::STEPS),
            ("solver", keys::SOLVER),
            ("probe", keys::PROBE),
            ("check", keys::CHECK),
            ("study", keys::STUDY),
        ];
        all.extend(keys::GEOMETRIES.iter().chain(keys::OBSTACLES).copied());
        all.into_iter().map(|(b, k)| (b, k.to_vec())).collect()
    }

    #[test]
    fn every_key_of_the_reader_has_one_entry_and_every_entry_is_a_key() {
        let tables = tables();
        for (of, known) in &tables {
            for key in known {
                let found = ENTRIES.iter().filter(|e| e.block == *of && e.key == *key).count();
                assert_eq!(found, 1, "`{key}` of `{of}` has {found} entries in schema_keys.rs");
            }
        }
        for e in ENTRIES {
            assert!(tables.iter().any(|(of, known)| *of == e.block && known.contains(&e.key)), "no key `{}` of `{}`", e.key, e.block);
        }
    }

    #[test]
    fn every_geometry_is_an_obstacle_with_the_keys_that_place_it() {
        assert_eq!(keys::GEOMETRIES.len(), keys::OBSTACLE_GEOMETRIES.len());
        for ((kind, own), (same, all)) in keys::GEOMETRIES.iter().zip(keys::OBSTACLE_GEOMETRIES) {
            let placed: Vec<&str> = own.iter().chain(keys::PLACING).copied().collect();
            assert_eq!((kind, placed.as_slice()), (same, *all));
        }
    }

    #[test]
    fn every_entry_is_json_and_says_what_the_key_means() {
        for e in ENTRIES {
            let kind: Value = serde_json::from_str(e.kind).unwrap_or_else(|x| panic!("{} {}: {x}", e.block, e.key));
            assert!(kind.is_object() && e.text.len() > 5, "{} {}", e.block, e.key);
        }
    }
}
