//! `faying schema`: the JSON Schema (2020-12) of the case file, made of the rows of the grammar and the known names.

use super::key::{Absent, Inside, Key, KeyKind, Plain, Special};
use super::names::Names;
use super::reader::LONGEST_NAME;
use super::rows::{ROOT, inside};
use super::tree::parse_value;
use crate::place::SourceSpan;
use serde_json::{Map, Value, json};

/// The schema of a case file, as the JSON that its TOML stands for; `names` are those of a registry.
///
/// Every block has the keys of the reader and no others. What depends on other keys (numbers per dimension, conditions that
/// exclude each other) is checked by the reader alone.
pub fn schema(names: &Names) -> Value {
    let mut document = json!({
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "faying case file, schema 1",
    });
    let mut root = block(ROOT, "", names);
    root["$defs"] = definitions(names);
    document.as_object_mut().expect("a document is an object").append(root.as_object_mut().expect("a block is an object"));
    document
}

/// A table with these keys, which `title` names.
fn block(keys: &[Key], title: &str, names: &Names) -> Value {
    let keys = names.extended(keys);
    let mut properties = Map::new();
    let mut required: Vec<&str> = Vec::new();
    for key in &keys {
        let owners = names.owners(&keys, key);
        if matches!(key.special(), Some(Special::Later(Plain::Never, _))) {
            continue;
        }
        properties.insert(key.name.to_owned(), described(key, &owners, names));
        for alias in key.aliases {
            let mut same = of_kind(key, names);
            same["description"] = json!(format!("another name of `{}`", key.name));
            properties.insert((*alias).to_owned(), same);
        }
        // other names of a required key stand among the conditions of its block; keys of entries are required with these alone
        if key.is_required() && key.aliases.is_empty() && owners.is_empty() {
            required.push(key.name);
        }
    }
    let mut value = json!({"type": "object", "properties": properties, "additionalProperties": false});
    if !title.is_empty() {
        value["title"] = json!(title);
    }
    if !required.is_empty() {
        value["required"] = json!(required);
    }
    conditions(&mut value, title, &keys);
    value
}

/// The type of a key with its meaning and its default.
fn described(key: &Key, owners: &[String], names: &Names) -> Value {
    let mut value = of_kind(key, names);
    let text = match key.special() {
        Some(Special::Later(..)) => "other values are not in this version".to_owned(),
        _ => {
            let unit = if key.unit.is_empty() { String::new() } else { format!(" [{}]", key.unit) };
            let of = if owners.is_empty() { String::new() } else { format!("{}: ", owners.join(", ")) };
            format!("{of}{}{unit}", key.text)
        }
    };
    value["description"] = json!(text);
    if let Absent::Is(default) = key.absent
        && !matches!(key.special(), Some(Special::Block(_)))
    {
        let node = parse_value(default, SourceSpan::NONE).unwrap_or_else(|e| panic!("the default {default} of `{}`: {e}", key.name));
        value["default"] = node.to_json();
    }
    value
}

/// The type of a key.
fn of_kind(key: &Key, names: &Names) -> Value {
    let defined = |name: &str| json!({"$ref": format!("#/$defs/{name}")});
    let special = match &key.kind {
        KeyKind::Number => return defined("number"),
        KeyKind::Positive => return defined("positive"),
        KeyKind::Whole(0, i64::MAX) => return json!({"type": "integer", "minimum": 0}),
        KeyKind::Whole(least, most) => return json!({"type": "integer", "minimum": least, "maximum": most}),
        KeyKind::Auto => return defined("auto"),
        KeyKind::Formula => return defined("formula"),
        KeyKind::Vector => return defined("vector"),
        KeyKind::Flag => return json!({"type": "boolean"}),
        KeyKind::Word(words) => return json!({"enum": words}),
        KeyKind::Text => return json!({"type": "string"}),
        KeyKind::Language(kind) => &kind.0,
    };
    match special {
        Special::Name => defined("name"),
        Special::FormulaOf(_) => defined("formula"),
        Special::Numbers => json!({"type": "array", "items": {"$ref": "#/$defs/number"}}),
        Special::Pair => json!({"type": "array", "items": {"$ref": "#/$defs/number"}, "minItems": 2, "maxItems": 2}),
        Special::Field => defined("field"),
        Special::Components { .. } => defined("components"),
        Special::SomeCoordinates => defined("some_coordinates"),
        Special::Sides => defined("sides"),
        Special::Words => defined("words"),
        Special::Entry(family) => json!({"enum": names.words(*family)}),
        Special::Multiplier => defined("multiplier"),
        Special::Block(keys) => block(keys, key.name, names),
        Special::Blocks(keys) => json!({"type": "array", "items": block(keys, key.name, names)}),
        Special::BlockPer(words, keys) => {
            let all: Map<String, Value> = words.iter().map(|word| ((*word).to_owned(), block(keys, key.name, names))).collect();
            json!({"type": "object", "properties": all, "additionalProperties": false})
        }
        Special::Let => json!({"type": "object", "additionalProperties": {"type": ["number", "string"]}}),
        Special::Geometry => defined("geometry"),
        Special::Obstacle => defined("obstacle"),
        Special::Only(_, schema) => serde_json::from_str(schema).unwrap_or_else(|e| panic!("the schema of `{}`: {e}", key.name)),
        Special::Later(Plain::Zero, _) => json!({"type": "number", "minimum": 0, "maximum": 0}),
        Special::Later(Plain::Words(words, _), _) => json!({"enum": words}),
        Special::Later(Plain::Never, _) => json!(false),
    }
}

/// Adds the conditions of a block on combinations of keys.
fn conditions(item: &mut Value, name: &str, keys: &[Key]) {
    let one_of_names = |name: &str| {
        let aliases = keys.iter().filter(|k| k.name == name).flat_map(|k| k.aliases).copied();
        json!({"anyOf": std::iter::once(name).chain(aliases).map(|n| json!({"required": [n]})).collect::<Vec<_>>()})
    };
    let any = |names: &[&str]| json!(names.iter().map(|n| json!({"required": [n]})).collect::<Vec<_>>());
    match name {
        "interface" => item["anyOf"] = json!([{"required": ["between"]}, {"allOf": [one_of_names("slave"), one_of_names("master")]}]),
        "contact" => item["allOf"] = json!([one_of_names("slave"), {"anyOf": [one_of_names("master"), {"required": ["rigid"]}]}]),
        "check" => item["oneOf"] = any(&["below", "above", "equals"]),
        "boundary" => {
            item["anyOf"] = any(&keys.iter().map(|k| k.name).filter(|k| !["name", "on", "where"].contains(k)).collect::<Vec<_>>())
        }
        _ => {}
    }
}

/// Tables with a `kind`, one of these.
fn kinded(inside: Inside, names: &Names) -> Value {
    let Inside::Kinds(kinds) = inside else { panic!("a table with kinds") };
    let one = |(kind, keys): &(String, Vec<Key>)| {
        let mut value = block(keys, kind, names);
        value["properties"]["kind"] = json!({"const": kind});
        let needed = value["required"].as_array().cloned().unwrap_or_default();
        value["required"] = json!(std::iter::once(json!("kind")).chain(needed).collect::<Vec<_>>());
        value
    };
    json!({"type": "object", "oneOf": kinds.iter().map(one).collect::<Vec<_>>()})
}

fn definitions(names: &Names) -> Value {
    let inside = |kind: Special| inside(&Key::of("", kind, ""), names);
    json!({
        "name": {"type": "string", "pattern": "^[A-Za-z0-9_-]+$", "maxLength": LONGEST_NAME},
        "number": {"type": ["number", "string"], "description": "a number, or a quoted formula of constants"},
        "positive": {"anyOf": [{"type": "number", "exclusiveMinimum": 0}, {"type": "string"}]},
        "formula": {"type": ["number", "string"], "description": "a number, or a quoted formula of x, y, z, t, r, theta and the names of [let]"},
        "vector": {"type": "array", "items": {"$ref": "#/$defs/number"}, "minItems": 2, "maxItems": 3},
        "some_coordinates": {"anyOf": [{"$ref": "#/$defs/vector"}, {"type": "object", "properties":
            {"x": {"$ref": "#/$defs/number"}, "y": {"$ref": "#/$defs/number"}, "z": {"$ref": "#/$defs/number"}}, "additionalProperties": false}]},
        "field": {"anyOf": [{"$ref": "#/$defs/formula"}, {"type": "array", "items": {"$ref": "#/$defs/formula"}, "minItems": 1, "maxItems": 3}]},
        "components": {"anyOf": [{"$ref": "#/$defs/field"}, {"type": "object", "properties":
            {"x": {"$ref": "#/$defs/formula"}, "y": {"$ref": "#/$defs/formula"}, "z": {"$ref": "#/$defs/formula"}, "u": {"$ref": "#/$defs/formula"}},
            "additionalProperties": false}]},
        "sides": {"anyOf": [{"type": "string"}, {"type": "array", "items": {"type": "string"}, "minItems": 1}]},
        "words": {"anyOf": [{"type": "string"}, {"type": "array", "items": {"type": "string"}}]},
        "degree": {"type": "integer", "minimum": 1, "maximum": 12},
        "auto": {"anyOf": [{"const": "auto"}, {"$ref": "#/$defs/positive"}]},
        "extra_points": {"type": "integer", "minimum": 0, "maximum": 60},
        "multiplier": {"anyOf": [{"enum": names.multipliers}, {"type": "string", "pattern": "^p/p-([1-9]|1[0-2])$"},
            block(super::rows::MULTIPLIER, "multiplier", names)]},
        "geometry": kinded(inside(Special::Geometry), names),
        "obstacle": kinded(inside(Special::Obstacle), names),
    })
}
