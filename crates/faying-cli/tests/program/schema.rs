//! `faying schema` against the reader, the samples and the documents of real commands; `faying explain` against the codes.

use crate::common::json_schema;
use faying_cli::Case;
use faying_cli::case::{Names, ReadOptions, schema};
use faying_cli::codes::CODES;
use json_schema::faults;
use serde_json::{Value, json};
use std::path::Path;
use std::process::{Command, Output, Stdio};

fn faying(at: &Path, words: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_faying")).current_dir(at).args(words).stdin(Stdio::null()).output().unwrap()
}

fn document(at: &Path, words: &[&str]) -> Value {
    let out = faying(at, words);
    serde_json::from_slice(&out.stdout).unwrap_or_else(|e| panic!("{words:?}: {e}: {}", String::from_utf8_lossy(&out.stderr)))
}

fn samples() -> Vec<(String, String)> {
    let folder = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")).join("examples/cases");
    let files = std::fs::read_dir(folder).unwrap().map(|f| f.unwrap().path());
    let mut all: Vec<(String, String)> = files
        .filter(|f| f.extension().is_some_and(|e| e == "toml"))
        .map(|f| (f.display().to_string(), std::fs::read_to_string(&f).unwrap()))
        .collect();
    all.sort();
    assert!(all.len() >= 4);
    all
}

fn as_json(toml: &str) -> Value {
    serde_json::to_value(toml.parse::<toml::Table>().unwrap()).unwrap()
}

#[test]
fn samples_and_their_effective_cases_are_valid() {
    let here = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."));
    let schema = document(here, &["schema"]);
    assert_eq!(schema["$schema"], "https://json-schema.org/draft/2020-12/schema");
    for (name, text) in samples() {
        assert_eq!(faults(&schema, &as_json(&text)), Vec::<String>::new(), "{name}");
        let case = Case::read(&name).unwrap();
        assert_eq!(faults(&schema, &as_json(case.effective_toml())), Vec::<String>::new(), "{name}, effective");
    }
}

/// Keys that are not built stand in the schema with the values that mean what is built.
#[test]
fn plain_values_of_keys_that_are_not_built_are_valid() {
    let schema = schema(&Names::default());
    let (_, good) = samples().into_iter().find(|(name, _)| name.ends_with("contact-patch.toml")).unwrap();
    for (old, new) in [
        ("dimension = 2", "dimension = 2\nkinematics = \"small\""),
        ("slave =", "friction = 0.0\nslave ="),
        ("young =", "law = \"hooke\"\nyoung ="),
    ] {
        let plain = good.replacen(old, new, 1);
        assert_ne!(plain, good);
        assert_eq!(faults(&schema, &as_json(&plain)), Vec::<String>::new(), "{new}");
        Case::parse("plain.toml", &plain, &ReadOptions::default()).unwrap();
    }
    let study = "[study.sweep]\nquantity = [\"energy\"]\n";
    assert_eq!(faults(&schema, &as_json(&format!("{good}\n{study}"))), Vec::<String>::new());
}

/// Mistakes that the reader refuses; the schema refuses them, too.
#[test]
fn what_the_reader_refuses_for_its_keys_words_and_types_the_schema_refuses() {
    let schema = schema(&Names::default());
    let (_, good) = samples().into_iter().find(|(name, _)| name.ends_with("contact-patch.toml")).unwrap();
    for (old, new) in [
        ("young = \"E\"", "yougn = \"E\""),
        ("physics = \"elasticity\"", "physics = \"elastic\""),
        ("dimension = 2", "dimension = 4"),
        ("degree = 2", "degree = \"2\""),
        ("degree = 2", "degree = 13"),
        ("backend = \"iga\"", "backend = \"igaa\""),
        ("kind = \"box\"", "kind = \"bax\""),
        ("min = [0.0, 0.0], ", ""),
        ("slave = \"upper.bottom\"", ""),
        ("name = \"lower\"", "name = \"lower block\""),
        ("over = \"all\"", "over = \"some\""),
        ("below = 6", ""),
        ("fix = [\"y\"]", "fix = [\"q\"]"),
        ("[[contact]]", "[[contacts]]"),
        ("dimension = 2", "dimension = 2\nkinematics = \"finite\""),
        ("slave = \"upper.bottom\"", "friction = 0.3\nslave = \"upper.bottom\""),
        ("[model]", "[output]\nfields = [1]\n[model]"),
    ] {
        assert!(good.contains(old), "{old}");
        let bad = good.replacen(old, new, 1);
        assert!(Case::parse("bad.toml", &bad, &ReadOptions::default()).is_err(), "the reader takes {new}");
        assert!(!faults(&schema, &as_json(&bad)).is_empty(), "the schema takes {new}");
    }
}

/// Defaults that the schema states are those that the reader writes into the effective case.
#[test]
fn defaults_are_those_of_the_reader() {
    let names = Names::default();
    let schema = schema(&names);
    // keys of other methods and couplings than those of this case have no value in it
    let entries = names.coupling_keys.iter().chain(names.methods.iter().map(|m| &m.entry));
    let of_entries: Vec<&str> = entries.flat_map(|e| &e.keys).map(|key| key.name).collect();
    let text = "[model]\nphysics = \"elasticity\"\ndimension = 2\n[[material]]\nname = \"m\"\nyoung = 1\npoisson = 0.3\n\
        [[patch]]\nname = \"a\"\ngeometry = { kind = \"box\", min = [0, 0], max = [1, 1] }\nelements = [2, 2]\n\
        [[patch]]\nname = \"b\"\ngeometry = { kind = \"box\", min = [1, 0], max = [2, 1] }\nelements = [2, 2]\n\
        [[patch]]\nname = \"c\"\ngeometry = { kind = \"box\", min = [0, 2], max = [1, 3] }\nelements = [2, 2]\n\
        [[boundary]]\non = \"a.left\"\nfix = [\"x\", \"y\"]\n\
        [[interface]]\nslave = \"a.right\"\nmaster = \"b.left\"\n\
        [[contact]]\nslave = \"c.bottom\"\nrigid = { kind = \"sphere\", center = [0, 0], radius = 1 }\n";
    let effective = as_json(Case::parse("a.toml", text, &ReadOptions::default()).unwrap().effective_toml());
    let at = |path: &str| schema.pointer(path).unwrap_or_else(|| panic!("{path}"));
    let mut compared = 0;
    for (properties, found) in [
        (at("/properties"), &effective),
        (at("/properties/model/properties"), &effective["model"]),
        (at("/properties/discretization/properties"), &effective["discretization"]),
        (at("/properties/solver/properties"), &effective["solver"]),
        (at("/properties/patch/items/properties"), &effective["patch"][0]),
        (at("/properties/interface/items/properties"), &effective["interface"][0]),
        (at("/properties/contact/items/properties"), &effective["contact"][0]),
        (at("/properties/contact/items/properties/active_set/properties"), &effective["contact"][0]["active_set"]),
    ] {
        for (key, property) in properties.as_object().unwrap() {
            let Some(default) = property.get("default") else { continue };
            if found[key].is_null() && of_entries.contains(&key.as_str()) {
                continue;
            }
            assert_eq!(default, &found[key], "{key}");
            compared += 1;
        }
    }
    assert!(compared >= 20, "{compared}");
}

#[test]
fn names_from_outside_appear() {
    let mut names = Names::default();
    Names::add(&mut names.backends, ["modal"]);
    let (_, good) = samples().into_iter().find(|(name, _)| name.ends_with("contact-patch.toml")).unwrap();
    let modal = as_json(&good.replacen("backend = \"iga\"", "backend = \"modal\"", 1));
    assert_eq!(faults(&schema(&names), &modal), Vec::<String>::new());
    assert!(!faults(&schema(&Names::default()), &modal).is_empty());
}

/// The schema with nothing added to what it names.
fn closed(mut schema: Value) -> Value {
    fn close(value: &mut Value) {
        match value {
            Value::Object(map) => {
                map.values_mut().for_each(close);
                if map.get("properties").is_some_and(Value::is_object) && !map.contains_key("additionalProperties") {
                    map.insert("additionalProperties".into(), json!(false));
                }
            }
            Value::Array(items) => items.iter_mut().for_each(close),
            _ => {}
        }
    }
    close(&mut schema);
    schema
}

#[test]
fn documents_of_runs_checks_studies_and_failures_are_valid() {
    let at = tempfile::tempdir().unwrap();
    let schema = document(at.path(), &["schema", "result"]);
    let strict = closed(schema.clone());
    for sample in ["contact-patch", "iga-fe-arc"] {
        assert_eq!(faying(at.path(), &["new", sample]).status.code(), Some(0));
        let case = format!("{sample}.toml");
        for words in [
            &["run", &case, "--json", "--vtu", "none"][..],
            &["check", &case, "--json"],
            &["compare", &case, "--json", "--tol", "1e-3"],
            &["compare", &case, "--json", "--force", "--levels", "2", "--backends", "fe", "--degrees", "2,9"],
        ] {
            let found = document(at.path(), words);
            assert_eq!(faults(&strict, &found), Vec::<String>::new(), "{words:?}");
        }
    }
    std::fs::write(at.path().join("bad.toml"), "[model]\nphysics = \"elastic\"\ndimension = 2\n").unwrap();
    for words in [&["run", "bad.toml", "--json"][..], &["run", "none.toml", "--json"], &["run", "--json"]] {
        let found = document(at.path(), words);
        assert_eq!(faults(&strict, &found), Vec::<String>::new(), "{words:?}");
    }
    // and the checker is no rubber stamp
    let mut wrong = document(at.path(), &["run", "bad.toml", "--json"]);
    wrong["status"] = json!("fine");
    assert!(!faults(&schema, &wrong).is_empty());
}

#[test]
fn every_code_is_explained_with_an_example_and_a_remedy() {
    let at = tempfile::tempdir().unwrap();
    // those of the contract, and 65
    let codes = [
        1, 3, 5, 12, 13, 14, 15, 16, 17, 18, 19, 21, 22, 23, 24, 25, 26, 31, 32, 33, 34, 41, 42, 43, 44, 51, 52, 53, 54, 61, 62, 63, 64,
        65, 71, 72, 73, 74, 81, 90, 91,
    ];
    let known: Vec<String> = CODES.iter().map(|c| c.code.to_owned()).collect();
    assert_eq!(known, codes.map(|n| format!("E{n:03}")));
    for c in CODES {
        assert!(c.text.len() > 30 && c.example.len() > 5 && c.remedy.ends_with('.'), "{}", c.code);
    }
    let out = faying(at.path(), &["explain"]);
    let list = String::from_utf8(out.stdout).unwrap();
    assert!(out.status.code() == Some(0) && known.iter().all(|code| list.contains(code.as_str())), "{list}");
    let out = faying(at.path(), &["explain", "E013"]);
    let shown = String::from_utf8(out.stdout).unwrap();
    assert!(shown.contains("For example") && shown.contains("What to do: add the key"), "{shown}");
    let out = faying(at.path(), &["explain", "E201"]);
    let said = String::from_utf8(out.stderr).unwrap();
    assert!(out.status.code() == Some(2) && said.contains("there is no code `E201`") && said.contains("did you mean E"), "{said}");
}
