//! Axes of studies know what the case can name: rules of the registry, and what contacts and penalties take.

use faying::coupling::interface::{InterfaceQuadrature, SlaveRule};
use faying::problem::Rule;
use faying_cli::case::ReadOptions;
use faying_cli::studies::{Axes, Base, Runs, StudyPlan};
use faying_cli::{Case, Registry, RunControl};
use serde_json::Value;
use std::process::{Command, Stdio};

const PAIR: &str = "[model]\nphysics = \"poisson\"\ndimension = 2\nexact = { u = \"sin(pi*x)*y\" }\n\
    [[patch]]\nname = \"left\"\ngeometry = { kind = \"box\", min = [0, 0], max = [1, 1] }\nelements = [4, 4]\n\
    [[patch]]\nname = \"right\"\ngeometry = { kind = \"box\", min = [1, 0], max = [2, 1] }\nelements = [3, 3]\n\
    [[boundary]]\non = \"all-outer\"\ndirichlet = \"exact\"\n[[interface]]\nname = \"seam\"\nslave = \"left.right\"\nmaster = \"right.left\"\n";

/// A row of a study has the numbers of the run with its value, whoever brought the rule.
#[test]
fn a_rule_of_the_registry_is_an_axis() {
    let mut registry = Registry::default();
    let rule = |points, partners| -> Box<dyn InterfaceQuadrature<1, 2>> { Box::new(SlaveRule { points: points + 3, partners }) };
    registry.plane.integrations.add("slave-finer", Rule::of(rule));
    let options = ReadOptions { names: registry.case_names(), ..ReadOptions::default() };
    let written = Case::parse("case.toml", PAIR, &options).unwrap();
    let base = Base { name: "case.toml", text: PAIR, options: options.clone() };
    let axes = Axes { levels: 1, integrations: ["merged", "slave-finer"].map(String::from).to_vec(), ..Axes::default() };
    let (command, quantities) = ("quadrature", &["energy".to_owned()][..]);
    let plan =
        StudyPlan { command, written: &written, base, registry: &registry, axes, quantities, compares: false, tol: None, kept: None };
    let specs = plan.rows().unwrap();
    let study = plan.solve(&specs, &Runs { registry: &registry }, &RunControl::default(), |_, _, _| {});
    let run = |rule: &str| {
        let options = ReadOptions { sets: vec![format!("interface.seam.{rule}")], ..options.clone() };
        Case::parse("case.toml", PAIR, &options).unwrap().run(&registry).unwrap().energy
    };
    let energies: Vec<f64> = study.rows.iter().map(|row| row.result.energy).collect();
    assert_eq!(energies, [run("integration=merged"), run("integration=slave-finer")]);
    assert_ne!(energies[0], energies[1]);
    assert_eq!(study.rows[1].integration, "slave-finer");
}

fn told(case: &str, words: &[&str]) -> (i32, Value) {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("a.toml"), case).unwrap();
    let words = [words, &["--json"]].concat();
    let out = Command::new(env!("CARGO_BIN_EXE_faying")).current_dir(folder.path()).args(words).stdin(Stdio::null()).output().unwrap();
    (out.status.code().unwrap(), serde_json::from_slice(&out.stdout).unwrap())
}

/// The default rules of the study are those that the method of the contact takes: it has no mixed rule.
#[test]
fn the_integration_of_a_contact_by_nitsche_is_studied() {
    let text = "[model]\nphysics = \"elasticity\"\ndimension = 2\n[[material]]\nname = \"m\"\nyoung = 1\npoisson = 0.3\n\
        [[patch]]\nname = \"a\"\ngeometry = { kind = \"box\", min = [0, 0], max = [1, 0.5] }\nelements = [4, 2]\n\
        [[patch]]\nname = \"b\"\ngeometry = { kind = \"box\", min = [0, 0.5], max = [1, 1] }\nelements = [3, 2]\n\
        [[boundary]]\non = \"a.bottom\"\nfix = [\"x\", \"y\"]\n[[boundary]]\non = \"b.top\"\ndirichlet = { x = 0, y = -0.01 }\n\
        [[contact]]\nname = \"c\"\nslave = \"b.bottom\"\nmaster = \"a.top\"\nmethod = \"nitsche\"\n";
    let (exit, study) = told(text, &["quadrature", "a.toml", "--levels", "1", "--extra-points", "0,2"]);
    assert_eq!(exit, 0, "{study}");
    let rules: Vec<&str> = study["rows"].as_array().unwrap().iter().map(|row| row["integration"].as_str().unwrap()).collect();
    assert_eq!(rules, ["merged", "merged", "slave", "slave"]);
}

/// A penalty has the multipliers of its rows.
#[test]
fn inf_sup_constants_of_a_penalty_differ_by_multiplier() {
    let words = ["infsup", "a.toml", "--levels", "1", "--pairings", "p/p,p/p-2,constant"];
    let [mortar, penalty] =
        ["", "coupling = \"penalty\"\n"].map(|coupling| told(&format!("{PAIR}{coupling}[discretization]\ndegree = 3\n"), &words));
    for (exit, study) in [&mortar, &penalty] {
        assert_eq!((*exit, study["rows"].as_array().unwrap().len()), (0, 3), "{study}");
    }
    let beta = |study: &Value| -> Vec<f64> { study["rows"].as_array().unwrap().iter().map(|row| row["beta"].as_f64().unwrap()).collect() };
    let found = beta(&penalty.1);
    assert_eq!(found, beta(&mortar.1));
    assert!(found[0] != found[1] && found[1] != found[2], "{found:?}");
}
