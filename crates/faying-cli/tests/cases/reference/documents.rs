//! The case files of reference/dolfinx/cases: they run as they stand, take the choices of the documents, and write what FEniCSx reads.
//!
//! Whether the numbers are right is `cross_validation` of the library.

use faying_cli::case::ReadOptions;
use faying_cli::run::run;
use faying_cli::{Case, Registry, RunControl, RunOptions, Status};
use faying_files::vtu::CellStyle;
use faying_files::{Limits, vtu_read};
use serde_json::Value;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

fn reference() -> PathBuf {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")).join("reference")
}

fn files(folder: &str, extension: &str) -> Vec<PathBuf> {
    let all = std::fs::read_dir(reference().join(folder)).unwrap().map(|f| f.unwrap().path());
    let mut files: Vec<PathBuf> = all.filter(|p| p.extension().is_some_and(|e| e == extension)).collect();
    files.sort();
    assert!(!files.is_empty(), "{folder}");
    files
}

fn case(file: &Path, sets: Vec<String>) -> Case {
    Case::read_with(file, &ReadOptions { sets, ..ReadOptions::default() }).unwrap_or_else(|e| panic!("{e}"))
}

#[test]
fn cases_of_documents_run_as_they_stand_and_meet_their_own_checks() {
    for file in files("dolfinx/cases", "toml") {
        let result = case(&file, Vec::new()).run(&Registry::default()).unwrap_or_else(|e| panic!("{e}"));
        assert_eq!((result.status, result.exit), (Status::Ok, 0), "{}: {:?} {:?}", file.display(), result.checks, result.diagnostics);
    }
}

fn texts(list: &Value) -> Vec<String> {
    list.as_array().map(|l| l.iter().map(|t| t.as_str().unwrap().to_owned()).collect()).unwrap_or_default()
}

/// Calls `see` for every case that a document names, with its choices.
fn each_case(entry: &Value, see: &mut dyn FnMut(&str, Vec<String>)) {
    match entry {
        Value::Object(map) => {
            if let Some(case) = map.get("case") {
                let own: Vec<String> = ["set", "sets"].iter().flat_map(|key| texts(&entry[*key])).collect();
                let more = |key: &str| entry[key].as_array().cloned().unwrap_or_default();
                let levels = more("levels").iter().map(texts).chain(more("loads").iter().map(|l| texts(&l["sets"]))).collect::<Vec<_>>();
                for level in levels.iter().chain(levels.is_empty().then_some(&Vec::new())) {
                    see(case.as_str().unwrap(), own.iter().chain(level).cloned().collect());
                }
            }
            map.values().for_each(|value| each_case(value, see));
        }
        Value::Array(list) => list.iter().for_each(|value| each_case(value, see)),
        _ => {}
    }
}

#[test]
fn cases_take_the_choices_of_the_documents() {
    let mut seen = BTreeSet::new();
    for file in files("data", "json") {
        let document: Value = serde_json::from_str(&std::fs::read_to_string(&file).unwrap()).unwrap();
        each_case(&document, &mut |name, sets| {
            case(&reference().join("dolfinx/cases").join(format!("{name}.toml")), sets);
            seen.insert(name.to_owned());
        });
    }
    assert!(seen.len() >= 22, "{seen:?}");
}

/// Names of sides of a result and of a document are the same, and so are the nodes of the Lagrange cells that the program writes.
#[test]
fn what_fenicsx_reads_of_a_run_has_the_nodes_and_numbers_that_it_stores() {
    for name in ["twins_poisson", "twins_elasticity", "twins_solid"] {
        let document: Value =
            serde_json::from_str(&std::fs::read_to_string(reference().join(format!("data/{name}.json"))).unwrap()).unwrap();
        let mut kinds = BTreeSet::new();
        for twin in document["twins"].as_array().unwrap() {
            // one of every kind of cell, of degree 2
            if twin["degree"] != 2 || !kinds.insert(twin["kind"].as_str().unwrap()) {
                continue;
            }
            let file = reference().join("dolfinx/cases").join(format!("{}.toml", twin["case"].as_str().unwrap()));
            let options = RunOptions { cells: Some(CellStyle::Lagrange), ..RunOptions::default() };
            let finished = run(&case(&file, texts(&twin["set"])), &Registry::default(), &options, &RunControl::default());
            let (result, title) = (serde_json::to_value(&finished.result).unwrap(), format!("{name} {}", twin["case"]));
            let near = |a: f64, b: f64, scale: f64| assert!((a - b).abs() <= 1e-11 * scale, "{title}: {a} for {b}");
            let number = |v: &Value| v.as_f64().unwrap();
            near(number(&result["energy"]), number(&twin["energy"]), number(&twin["energy"]).abs());
            for (side, force) in twin["reactions"].as_object().unwrap() {
                let (place, k) = ["x", "y", "z"]
                    .iter()
                    .position(|c| side.ends_with(&format!(".{c}")))
                    .map_or((&side[..], 0), |k| (&side[..side.len() - 2], k));
                near(number(&result["reactions"][place][k]), number(force), number(&twin["reaction_scale"]));
            }
            let vtu = vtu_read::parse(&finished.output.unwrap().parts.vtu().unwrap(), &Limits::default()).unwrap();
            let field = vtu.point_fields.iter().find(|f| ["u", "displacement"].contains(&&*f.name)).unwrap();
            let places: Vec<Vec<f64>> =
                serde_json::from_value(document["places"][twin["places"].as_u64().unwrap() as usize].clone()).unwrap();
            let stored: Vec<Vec<f64>> = serde_json::from_value(twin["u"].clone()).unwrap();
            let scale = stored.iter().flatten().fold(0.0_f64, |m, v| m.max(v.abs()));
            let mut met = BTreeSet::new();
            for (point, own) in vtu.points.iter().zip(field.values.chunks_exact(field.components)) {
                let found = places.iter().position(|x| x.iter().zip(point).all(|(a, b)| (a - b).abs() <= 2e-6));
                let k = found.unwrap_or_else(|| panic!("{title}: no stored node at {point:?}"));
                stored[k].iter().zip(own).for_each(|(a, b)| near(*b, *a, scale));
                met.insert(k);
            }
            assert_eq!(met.len(), places.len(), "{title}: nodes");
        }
        assert_eq!(kinds.len(), 2 + 2 * usize::from(name == "twins_poisson"), "{name}: {kinds:?}");
    }
}
