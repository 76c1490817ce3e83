//! A key is one row: what the reader, defaults, the schema, `explain`, the reference, `--set` and the axes of studies make of it.

use faying::physics::Hooke;
use faying::problem::Physics;
use faying_cli::case::reference::{explained, find, keys, reference};
use faying_cli::case::{Given, Key, KeyKind, ReadOptions, schema};
use faying_cli::studies::{Axes, Base, Runs, StudyPlan, Vary};
use faying_cli::{Case, Fault, Registry, RunControl};
use std::sync::Arc;

/// The keys of the law "spring-steel": a modulus, and the rows of `more`. Its modulus is multiplied by the key `share`, where it has one.
fn with_rows(more: Vec<Key>) -> Registry {
    let mut registry = Registry::default();
    let own = vec![Key::new("stiffness", KeyKind::Positive, "Young's modulus").unit("force/area")];
    let make = |given: &Given, _: f64| -> Result<Physics<2>, Fault> {
        let share = given.at("share").map_or(1.0, |_| given.number("share"));
        let law = Hooke::<2>::plane_strain(given.number("stiffness") * share, 0.0).expect("a modulus above zero");
        Ok(Physics::new::<2>(law).expect("a law of the plane"))
    };
    registry.plane.materials.add_keyed("spring-steel", [own, more].concat(), Arc::new(make));
    registry
}

/// A strip pulled at its end: u_x = F x / (E h).
const STRIP: &str = "[model]\nphysics = \"elasticity\"\ndimension = 2\n[[material]]\nname = \"m\"\nlaw = \"spring-steel\"\nstiffness = 50.0\n\
    [[patch]]\nname = \"a\"\ngeometry = { kind = \"box\", min = [0, 0], max = [4, 0.5] }\nelements = [2, 1]\n\
    [[boundary]]\non = \"a.left\"\nfix = [\"x\"]\n[[boundary]]\non = \"a.bottom\"\nfix = [\"y\"]\n[[boundary]]\non = \"a.right\"\nforce = { x = 3.0 }\n\
    [[probe]]\nname = \"end\"\nquantity = \"u.x at [4, 0.5]\"\n";

fn read(registry: &Registry, text: &str, sets: &[&str]) -> Result<Case, String> {
    let sets = sets.iter().map(|set| (*set).to_owned()).collect();
    let options = ReadOptions { names: registry.case_names(), sets, ..ReadOptions::default() };
    Case::parse("case.toml", text, &options).map_err(|e| e.to_string())
}

#[test]
fn a_row_more_is_known_to_everything_that_reads_the_table() {
    let row = Key::new("share", KeyKind::Positive, "multiplies the modulus of the strip").unit("strips").default("1.0");
    let [bare, full] = [with_rows(Vec::new()), with_rows(vec![row])];
    let [without, with] = [&bare, &full].map(Registry::case_names);

    // the table has it, and nothing else changed
    let paths = |names| keys(names).into_iter().map(|found| found.path).collect::<Vec<_>>();
    let (before, mut after) = (paths(&without), paths(&with));
    let place = after.iter().position(|path| path == "material.share").expect("the row");
    after.remove(place);
    assert_eq!(before, after);

    // schema: type, meaning, unit, default, and nothing else changed
    let pointer = "/properties/material/items/properties";
    let [old, mut new] = [&without, &with].map(schema);
    let own = new.pointer_mut(pointer).and_then(|all| all.as_object_mut()).unwrap().remove("share").expect("the key");
    assert_eq!(old, new);
    assert_eq!(own["default"], 1.0);
    assert_eq!(own["$ref"], "#/$defs/positive");
    let text = own["description"].as_str().unwrap();
    assert!(text.contains("multiplies the modulus of the strip [strips]") && text.contains("spring-steel"), "{text}");

    // explain
    assert!(find("share", &without).is_empty());
    let [found] = &find("material.m.share", &with)[..] else { panic!("one key") };
    let told = explained(found, &with);
    for part in ["material.share: multiplies the modulus of the strip [strips]", "a number above zero", "default  1.0", "spring-steel"] {
        assert!(told.contains(part), "{part} is not in\n{told}");
    }

    // reference: one line more
    let [old, new] = [&without, &with].map(reference);
    let more: Vec<&str> = new.lines().filter(|line| !old.contains(line)).collect();
    assert!(more.len() == 1 && more[0].starts_with("| `share` |") && more[0].contains("`1.0`"), "{more:?}");

    // reader: default in the effective case, values, mistakes; unknown without the row
    assert!(read(&full, STRIP, &[]).unwrap().effective_toml().contains("share = 1.0"));
    let given = STRIP.replace("stiffness = 50.0\n", "stiffness = 50.0\nshare = 2\n");
    let end = |case: Case| case.run(&full).unwrap().probes.iter().find(|p| p.name == "end").unwrap().value;
    let exact = |share: f64| 3.0 * 4.0 / (50.0 * share * 0.5);
    let near = |a: f64, b: f64| assert!((a / b - 1.0).abs() < 1e-11, "{a} for {b}");
    near(end(read(&full, STRIP, &[]).unwrap()), exact(1.0));
    near(end(read(&full, &given, &[]).unwrap()), exact(2.0));
    for (text, parts) in [
        (given.replace("share = 2", "share = -2"), ["E015", "`share` must be positive"]),
        (given.replace("share = 2", "share = \"auto\""), ["E017", "auto"]),
        (given.replace("share", "shar"), ["E012", "did you mean `share`?"]),
    ] {
        let error = read(&full, &text, &[]).unwrap_err();
        assert!(parts.iter().all(|part| error.contains(part)), "{error}");
    }
    assert!(read(&bare, &given, &[]).unwrap_err().contains("E012"));

    // --set
    near(end(read(&full, STRIP, &["material.m.share=4"]).unwrap()), exact(4.0));
    assert!(read(&full, STRIP, &["material.m.shar=4"]).unwrap_err().contains("did you mean `share`?"));

    // an axis of a study
    let written = read(&full, STRIP, &[]).unwrap();
    let base = Base { name: "case.toml", text: STRIP, options: ReadOptions { names: with, ..ReadOptions::default() } };
    let axes = Axes { levels: 1, vary: vec![Vary::parse("material.m.share=1,2,5").unwrap()], ..Axes::default() };
    let (command, quantities) = ("sweep", &["end".to_owned()][..]);
    let plan = StudyPlan { command, written: &written, base, registry: &full, axes, quantities, compares: false, tol: None, kept: None };
    let specs = plan.rows().unwrap();
    let study = plan.solve(&specs, &Runs { registry: &full }, &RunControl::default(), |_, _, _| {});
    assert_eq!(study.rows.len(), 3);
    for (row, share) in study.rows.iter().zip([1.0, 2.0, 5.0]) {
        near(row.result.probes.iter().find(|p| p.name == "end").unwrap().value, exact(share));
    }
}
