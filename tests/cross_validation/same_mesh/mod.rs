//! The same discrete problems solved by FEniCSx on our meshes: what both find differs by rounding.

mod differences;
mod found;

use crate::document::{self, texts};
use differences::{differences, largest, lists, too_large};
use found::{Found, found};
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};

/// Kinds of twins: (law, kind of cell, degree, feature).
type Held = BTreeSet<(String, String, u64, String)>;

/// Runs all twins of a document, prints the largest differences, and says which kinds it holds.
fn agree(name: &str) -> Held {
    let document = document::document(name);
    let agreement = &document["agreement"];
    let meshes: Vec<Vec<Vec<f64>>> = document["places"].as_array().unwrap().iter().map(lists).collect();
    let (mut worst, mut held, mut faults) = (BTreeMap::<&str, (f64, String)>::new(), Held::new(), Vec::new());
    let twins = document["twins"].as_array().unwrap();
    for twin in twins {
        let word = |key: &str| twin[key].as_str().unwrap().to_owned();
        let (case, degree) = (word("case"), twin["degree"].as_u64().unwrap());
        let title = format!("{case}, {} of degree {degree}", word("kind"));
        let places = &meshes[twin["places"].as_u64().unwrap() as usize];
        let all = differences(twin, places, &found(&case, &texts(&twin["set"]))).unwrap_or_else(|e| panic!("{title}: {e}"));
        faults.extend(too_large(agreement, &all).into_iter().map(|f| format!("{title}: {f}")));
        for (kind, difference) in all {
            let entry = worst.entry(kind).or_default();
            if difference >= entry.0 {
                *entry = (difference, title.clone());
            }
        }
        held.extend(texts(&twin["features"]).into_iter().map(|feature| (word("law"), word("kind"), degree, feature)));
    }
    println!("{name}: {} twins, {} meshes", twins.len(), meshes.len());
    for (kind, (difference, title)) in &worst {
        println!("  {kind}: at most {difference:.1e} of {:.0e} ({title})", agreement[kind].as_f64().unwrap());
    }
    assert!(faults.is_empty(), "{faults:#?}");
    held
}

/// Every law on every kind of cell, straight and curved, in every degree, and every feature on every kind of cell.
fn covers(held: &Held, laws: &[&str], cells: &[&str], degrees: std::ops::RangeInclusive<u64>, features: &[&str]) {
    for cell in cells {
        for law in laws {
            for degree in degrees.clone() {
                let has = |feature: &str| held.contains(&((*law).into(), (*cell).into(), degree, feature.into()));
                assert!(has("straight") || has("curved"), "no {law} on a {cell} of degree {degree}");
            }
        }
        for feature in features {
            for degree in degrees.clone() {
                let any = held.iter().any(|(_, c, p, f)| c == cell && *p == degree && f == feature);
                assert!(any, "no {feature} on a {cell} of degree {degree}");
            }
        }
    }
}

#[test]
fn poisson_agrees_on_all_cells() {
    let held = agree("twins_poisson");
    let features = ["straight", "curved", "coefficient", "source", "dirichlet", "shared corners", "neumann", "spring", "exact"];
    covers(&held, &["poisson"], &["triangle", "quadrilateral"], 1..=4, &features);
    covers(&held, &["poisson"], &["tetrahedron", "hexahedron"], 1..=3, &features);
}

#[test]
fn plane_elasticity_agrees_on_all_cells() {
    let held = agree("twins_elasticity");
    let features = [
        "straight",
        "curved",
        "coefficient",
        "body_force",
        "dirichlet",
        "dirichlet on an arc",
        "sliding",
        "traction",
        "pressure",
        "spring",
        "exact",
    ];
    covers(&held, &["plane-strain", "plane-stress"], &["triangle", "quadrilateral"], 1..=4, &features);
    assert!(held.iter().any(|(_, cell, _, feature)| cell == "triangle" && feature == "gmsh"), "no mesh from Gmsh");
}

#[test]
fn elasticity_in_space_agrees_on_all_cells() {
    let held = agree("twins_solid");
    let features = [
        "straight",
        "curved",
        "coefficient",
        "body_force",
        "dirichlet",
        "shared corners",
        "sliding",
        "traction",
        "pressure",
        "spring",
        "exact",
    ];
    covers(&held, &["solid"], &["tetrahedron", "hexahedron"], 1..=3, &features);
}

/// One stored twin, and what our program finds for it.
fn one() -> (Value, Value, Vec<Vec<f64>>, Found) {
    let document = document::document("twins_poisson");
    let twin = document["twins"].as_array().unwrap().iter().find(|t| !t["errors"].is_null()).unwrap().clone();
    let places = lists(&document["places"][twin["places"].as_u64().unwrap() as usize]);
    let found = found(twin["case"].as_str().unwrap(), &texts(&twin["set"]));
    (document["agreement"].clone(), twin, places, found)
}

#[test]
fn a_number_that_is_changed_or_missing_is_reported() {
    let (agreement, twin, places, found) = one();
    let faults = |twin: &Value| too_large(&agreement, &differences(twin, &places, &found).unwrap());
    assert!(faults(&twin).is_empty());
    let changed = |path: &str, factor: f64| {
        let mut twin = twin.clone();
        let at = twin.pointer_mut(path).unwrap_or_else(|| panic!("{path}"));
        *at = (at.as_f64().unwrap() * factor).into();
        faults(&twin)
    };
    let largest_node = lists(&twin["u"]).iter().map(|v| largest(v)).enumerate().max_by(|a, b| a.1.total_cmp(&b.1)).unwrap().0;
    let side =
        twin["reactions"].as_object().unwrap().iter().max_by(|a, b| a.1.as_f64().unwrap().abs().total_cmp(&b.1.as_f64().unwrap().abs()));
    let side = format!("/reactions/{}", side.unwrap().0);
    for (kind, path) in [("u", format!("/u/{largest_node}/0")), ("energy", "/energy".into()), ("reactions", side)] {
        // ten times what is allowed
        let found = changed(&path, 1.0 + 10.0 * agreement[kind].as_f64().unwrap());
        assert!(found.len() == 1 && found[0].starts_with(kind), "{path}: {found:?}");
    }
    for path in ["/errors/error.u.H1/value", "/errors/error.u.L2/scale"] {
        let found = changed(path, 1.0 + 10.0 * agreement["errors"].as_f64().unwrap());
        assert!(found.len() == 1 && found[0].starts_with("errors"), "{path}: {found:?}");
    }
    let mut without = twin.clone();
    without.as_object_mut().unwrap().remove("errors");
    assert!(differences(&without, &places, &found).is_err());
    let mut more = twin.clone();
    more["reactions"]["body.nowhere"] = 1.0.into();
    assert!(differences(&more, &places, &found).is_err());
    assert!(differences(&twin, &places[1..], &found).is_err());
    let mut moved = places.clone();
    moved[0][0] += 0.01;
    assert!(differences(&twin, &moved, &found).is_err());
}
