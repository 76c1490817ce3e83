//! However a case names a side, its results have the same names.

use faying_cli::case::ReadOptions;
use faying_cli::{Case, Registry};

const SQUARE: &str = "[model]\nphysics = \"elasticity\"\ndimension = 2\n[[material]]\nname = \"m\"\nyoung = 1\npoisson = 0.3\n\
    [[patch]]\nname = \"a\"\ngeometry = { kind = \"box\", min = [0, 0], max = [1, 1] }\nelements = [2, 2]\n\
    [[boundary]]\nname = \"held\"\non = ON\nfix = [\"x\", \"y\"]\n[[boundary]]\non = \"a.right\"\nforce = { x = 1 }\n";

fn labels(text: &str, sets: &[&str]) -> (Vec<(String, Vec<f64>)>, String) {
    let options = ReadOptions { sets: sets.iter().map(|set| (*set).to_owned()).collect(), ..ReadOptions::default() };
    let case = Case::parse("case.toml", text, &options).unwrap_or_else(|e| panic!("{e}"));
    let result = case.run(&Registry::default()).unwrap();
    (result.reactions.iter().map(|(name, force)| (name.to_string(), force.to_vec())).collect(), case.effective_toml().to_owned())
}

#[test]
fn reactions_have_the_bodys_own_words() {
    let said = |on: &str, sets: &[&str]| labels(&SQUARE.replace("ON", on), sets);
    let (first, effective) = said("\"a.left\"", &[]);
    assert_eq!(first[0].0, "a.left");
    let all = [
        said("\"a.u0\"", &[]),
        said("[\"a.u0\"]", &[]),
        said("\"a.u\\u0030\"", &[]),
        said("'a.u0'", &[]),
        said("\"a.bottom\"", &["boundary.held.on=a.u0"]),
        said("\"a.bottom\"", &["boundary.held.on=a.left"]),
        labels(&effective, &[]),
    ];
    for (found, _) in &all {
        assert_eq!(found, &first);
    }
    // all others of a square
    let (all, effective) = said("\"all-outer\"", &[]);
    let (again, _) = labels(&effective, &[]);
    assert_eq!(all.iter().map(|r| r.0.as_str()).collect::<Vec<_>>(), ["a.left", "a.bottom", "a.top"]);
    assert_eq!(all, again);
}
