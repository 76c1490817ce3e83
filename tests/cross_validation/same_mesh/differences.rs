//! Differences between what a document stores of a problem and what the library finds.

use super::found::Found;
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};

/// Places nearer than this share of the mesh are one node: places only tell nodes apart, and are stored to eight digits.
const SAME_PLACE: f64 = 1e-6;

fn numbers(list: &Value) -> Vec<f64> {
    list.as_array().unwrap().iter().map(|v| v.as_f64().unwrap()).collect()
}

pub fn lists(list: &Value) -> Vec<Vec<f64>> {
    list.as_array().unwrap().iter().map(numbers).collect()
}

pub fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |m, v| v.abs().max(m))
}

/// A reaction of a document by the name that its side has in the library: "body.left.x" is "body.u0.x"; quotes are left out.
fn own_name(name: &str, side: fn(&str) -> &str) -> String {
    let name = name.replace('"', "");
    let parts: Vec<&str> = name.split('.').collect();
    parts.iter().enumerate().map(|(k, part)| if k == 1 { side(part) } else { part }).collect::<Vec<_>>().join(".")
}

/// What both may differ by, per kind of quantity.
pub type Kinds = BTreeMap<&'static str, f64>;

/// The largest difference of each kind of quantity, as a share of its scale; a number that one side lacks is a fault.
pub fn differences(stored: &Value, places: &[Vec<f64>], found: &Found) -> Result<Kinds, String> {
    let mut all = Kinds::from([("u", nodal(stored, places, found)?)]);
    let energy = stored["energy"].as_f64().unwrap();
    all.insert("energy", (found.energy - energy).abs() / energy.abs());

    let scale = stored["reaction_scale"].as_f64().unwrap();
    let wanted = stored["reactions"].as_object().unwrap();
    let worst = all.entry("reactions").or_default();
    for (name, force) in wanted {
        let own = found.reactions.get(&own_name(name, found.side)).ok_or_else(|| format!("no reaction {name}"))?;
        *worst = worst.max((own - force.as_f64().unwrap()).abs() / scale);
    }
    // supports carry nothing in directions they do not hold
    let held: BTreeSet<String> = wanted.keys().map(|name| own_name(name, found.side)).collect();
    if let Some((name, force)) = found.reactions.iter().find(|(name, force)| !held.contains(*name) && **force != 0.0) {
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
pub fn too_large(agreement: &Value, all: &Kinds) -> Vec<String> {
    let allowed = |kind: &str| agreement[kind].as_f64().unwrap_or_else(|| panic!("no tolerance of {kind}"));
    // a difference that is no number is too large
    all.iter().filter(|(kind, d)| d.is_nan() || **d > allowed(kind)).map(|(kind, d)| format!("{kind} differs by {d:.1e}")).collect()
}
