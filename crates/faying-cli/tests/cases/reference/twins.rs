//! The same discrete problems solved by FEniCSx on our meshes: what both find differs by rounding.

use super::document::{self, texts};
use faying_cli::run::run;
use faying_cli::{Registry, RunOptions, Watch};
use faying_files::vtu::CellStyle;
use faying_files::{Limits, vtu_read};
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};

/// Places nearer than this share of the mesh are one node: places only tell nodes apart, and are stored to eight digits.
const SAME_PLACE: f64 = 1e-6;

/// What our program finds: values at the points of its cells, and numbers by name.
struct Found {
    points: Vec<[f64; 3]>,
    components: usize,
    values: Vec<f64>,
    unknowns: usize,
    energy: f64,
    reactions: BTreeMap<String, f64>,
    errors: BTreeMap<String, f64>,
}

fn found(case: &str, sets: &[String]) -> Found {
    let read = document::case(case, sets, &[]);
    let options = RunOptions { cells: Some(CellStyle::Lagrange), ..RunOptions::default() };
    let finished = run(&read, &Registry::default(), &options, &Watch::default());
    let result = serde_json::to_value(&finished.result).unwrap();
    assert_eq!(result["status"], "ok", "{case} {sets:?}: {result}");
    let file = vtu_read::parse(&finished.output.unwrap().parts.vtu().unwrap(), &Limits::default()).unwrap();
    let field = file.point_fields.into_iter().find(|f| ["u", "displacement"].contains(&&*f.name)).unwrap();
    let number = |v: &Value| v.as_f64().unwrap();
    let mut reactions = BTreeMap::new();
    for (side, force) in result["reactions"].as_object().unwrap() {
        let force = force.as_array().unwrap();
        for (k, f) in force.iter().enumerate() {
            let name = if force.len() == 1 { side.clone() } else { format!("{side}.{}", ["x", "y", "z"][k]) };
            reactions.insert(name, number(f));
        }
    }
    let errors = result["errors"].as_object().map(|all| all.iter().map(|(name, v)| (name.clone(), number(v))).collect());
    Found {
        points: file.points,
        components: field.components,
        values: field.values,
        unknowns: result["unknowns"]["primal"].as_u64().unwrap() as usize,
        energy: number(&result["energy"]),
        reactions,
        errors: errors.unwrap_or_default(),
    }
}

fn numbers(list: &Value) -> Vec<f64> {
    list.as_array().unwrap().iter().map(|v| v.as_f64().unwrap()).collect()
}

fn lists(list: &Value) -> Vec<Vec<f64>> {
    list.as_array().unwrap().iter().map(numbers).collect()
}

fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |m, v| v.abs().max(m))
}

/// What both may differ by, per kind of quantity.
type Kinds = BTreeMap<&'static str, f64>;

/// The largest difference of each kind of quantity, as a share of its scale; a number that one side lacks is a fault.
fn differences(stored: &Value, places: &[Vec<f64>], found: &Found) -> Result<Kinds, String> {
    let mut all = Kinds::from([("u", nodal(stored, places, found)?)]);
    let energy = stored["energy"].as_f64().unwrap();
    all.insert("energy", (found.energy - energy).abs() / energy.abs());

    let scale = stored["reaction_scale"].as_f64().unwrap();
    let wanted = stored["reactions"].as_object().unwrap();
    let worst = all.entry("reactions").or_default();
    for (name, force) in wanted {
        let own = found.reactions.get(name).ok_or_else(|| format!("no reaction {name}"))?;
        *worst = worst.max((own - force.as_f64().unwrap()).abs() / scale);
    }
    // supports carry nothing in directions they do not hold
    if let Some((name, force)) = found.reactions.iter().find(|(name, force)| !wanted.contains_key(*name) && **force != 0.0) {
        return Err(format!("reaction {name} = {force:e} has no twin"));
    }

    if found.errors.is_empty() != stored["errors"].is_null() {
        return Err("norms of errors on one side only".into());
    }
    for (name, error) in stored["errors"].as_object().into_iter().flatten() {
        let own = found.errors.get(name).ok_or_else(|| format!("no {name}"))?;
        let share = found.errors.get(&format!("{name}.rel")).ok_or_else(|| format!("no {name}.rel"))?;
        let (wanted, scale) = (error["value"].as_f64().unwrap(), error["scale"].as_f64().unwrap());
        let worst = all.entry("errors").or_default();
        *worst = worst.max((own / wanted - 1.0).abs()).max((own / share / scale - 1.0).abs());
    }
    Ok(all)
}

/// The largest difference at a node. Every point of our cells is a stored node, and every stored node is such a point.
fn nodal(stored: &Value, places: &[Vec<f64>], found: &Found) -> Result<f64, String> {
    let wanted = lists(&stored["u"]);
    let size = places.iter().map(|x| largest(x)).fold(0.0, f64::max);
    let scale = wanted.iter().map(|v| largest(v)).fold(0.0, f64::max);
    let near = SAME_PLACE * size;
    let mut order: Vec<usize> = (0..places.len()).collect();
    order.sort_by(|&a, &b| places[a][0].total_cmp(&places[b][0]));
    let (mut met, mut worst) = (BTreeSet::new(), 0.0f64);
    for (point, own) in found.points.iter().zip(found.values.chunks_exact(found.components)) {
        let first = order.partition_point(|&k| places[k][0] < point[0] - near);
        let column = order[first..].iter().copied().take_while(|&k| places[k][0] <= point[0] + near);
        let mut at = column.filter(|&k| places[k].iter().zip(point).all(|(a, b)| (a - b).abs() <= near));
        let k = at.next().ok_or_else(|| format!("no stored node at {point:?}"))?;
        if at.next().is_some() {
            return Err(format!("two stored nodes at {point:?}"));
        }
        met.insert(k);
        worst = wanted[k].iter().zip(own).fold(worst, |worst, (a, b)| worst.max((a - b).abs() / scale));
    }
    let unknowns: usize = wanted.iter().map(Vec::len).sum();
    if met.len() != places.len() || wanted.len() != places.len() || unknowns != found.unknowns {
        return Err(format!("{} of {} nodes met, {unknowns} stored unknowns for {}", met.len(), places.len(), found.unknowns));
    }
    Ok(worst)
}

/// Names of a document's quantities that differ by more than it allows.
fn too_large(agreement: &Value, all: &Kinds) -> Vec<String> {
    let allowed = |kind: &str| agreement[kind].as_f64().unwrap_or_else(|| panic!("no tolerance of {kind}"));
    // a difference that is no number is too large
    all.iter().filter(|(kind, d)| d.is_nan() || **d > allowed(kind)).map(|(kind, d)| format!("{kind} differs by {d:.1e}")).collect()
}

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
