//! Changes of a case by a row of a study, after `--set`: backends, degrees, levels, multipliers, integration, quantities.

use super::names::Names;
use super::tree::{Node, Table, Value, parse_value};
use crate::place::{Origin, Place};

/// Changes of a case between its `--set` options and its reading; the default changes nothing.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Changes {
    /// One backend for every patch.
    pub backend: Option<String>,
    /// Backend of single patches by name, after `backend`.
    pub backends: Vec<(String, String)>,
    /// One degree for every patch.
    pub degree: Option<usize>,
    /// Degree of single patches by name, after `degree`.
    pub degrees: Vec<(String, usize)>,
    /// Halvings of every element beyond those of the file.
    pub level: usize,
    /// Multiplier of every interface and contact: a name, or data such as `{ degree = 1 }`.
    pub pairing: Option<String>,
    /// Integration of every interface and contact.
    pub integration: Option<String>,
    /// Points of every interface and contact beyond the default.
    pub extra_points: Option<usize>,
    /// Quantities to evaluate beside the probes of the file, as probes with these names.
    pub quantities: Vec<(String, String)>,
}

const AT: Place = Place { origin: Origin::Option, ..Place::NONE };

/// Applies the changes; `names` tells the couplings with a multiplier.
pub(super) fn apply(root: &mut Table, changes: &Changes, names: &Names) {
    if let Some(backend) = &changes.backend {
        everywhere(root, "backend", Value::Text(backend.clone()));
    }
    if let Some(degree) = changes.degree {
        everywhere(root, "degree", whole(degree));
    }
    // a word that is missing is the default, and the reader rejects one that is not known: both have a multiplier
    let method = |word: &str| names.needs(word).multiplier;
    let coupling = |word: &str| names.has_rows(word);
    for (list, kind, has_multiplier) in [("interface", "coupling", &coupling as &dyn Fn(&str) -> bool), ("contact", "method", &method)] {
        for couple in tables(root, list) {
            let word = match couple.get(kind).map(|e| &e.node.value) {
                Some(Value::Text(word)) => word.clone(),
                _ => String::new(),
            };
            // glued sides have neither a multiplier nor an integration; couplings without a multiplier are still integrated
            if word == "glue" {
                continue;
            }
            if let Some(pairing) = changes.pairing.as_ref().filter(|_| has_multiplier(&word)) {
                let value = if pairing.starts_with('{') { parse_value(pairing, AT).ok() } else { None };
                couple.set("multiplier", AT, value.unwrap_or_else(|| Node::new(Value::Text(pairing.clone()), AT)));
            }
            if let Some(integration) = &changes.integration {
                couple.set("integration", AT, Node::new(Value::Text(integration.clone()), AT));
            }
            if let Some(points) = changes.extra_points {
                couple.set("extra_points", AT, Node::new(whole(points), AT));
            }
        }
    }
    for patch in tables(root, "patch") {
        let name = match patch.get("name").map(|e| &e.node.value) {
            Some(Value::Text(name)) => name.clone(),
            _ => String::new(),
        };
        if let Some((_, backend)) = changes.backends.iter().find(|(n, _)| *n == name) {
            patch.set("backend", AT, Node::new(Value::Text(backend.clone()), AT));
        }
        if let Some((_, degree)) = changes.degrees.iter().find(|(n, _)| *n == name) {
            patch.set("degree", AT, Node::new(whole(*degree), AT));
        }
        if changes.level > 0 {
            refine(patch, changes.level);
        }
    }
    for (name, quantity) in &changes.quantities {
        ask(root, name, quantity);
    }
}

fn whole(n: usize) -> Value {
    Value::Integer(i64::try_from(n).unwrap_or(i64::MAX))
}

/// The tables of a list of the case.
fn tables<'a>(root: &'a mut Table, list: &str) -> impl Iterator<Item = &'a mut Table> + use<'a> {
    let list = match root.get_mut(list).map(|e| &mut e.node.value) {
        Some(Value::List(list)) => list.as_mut_slice(),
        _ => &mut [],
    };
    list.iter_mut().filter_map(|node| match &mut node.value {
        Value::Table(t) => Some(t),
        _ => None,
    })
}

// sets `key` in [discretization] and removes it from every patch
fn everywhere(root: &mut Table, key: &str, value: Value) {
    if root.get("discretization").is_none() {
        root.set("discretization", AT, Node::new(Value::Table(Table::default()), AT));
    }
    if let Some(Value::Table(t)) = root.get_mut("discretization").map(|e| &mut e.node.value) {
        t.set(key, AT, Node::new(value, AT));
    }
    tables(root, "patch").for_each(|patch| patch.entries.retain(|e| e.key != key));
}

// a value that is not a whole number stays and is rejected by the reader
fn refine(patch: &mut Table, level: usize) {
    let more = i64::try_from(level).unwrap_or(i64::MAX);
    match patch.get_mut("refine").map(|e| &mut e.node) {
        None => patch.set("refine", AT, Node::new(Value::Integer(more), AT)),
        Some(Node { value: Value::Integer(n), .. }) if *n >= 0 => *n = n.saturating_add(more),
        Some(_) => {}
    }
}

fn ask(root: &mut Table, name: &str, quantity: &str) {
    if root.get("probe").is_none() {
        root.set("probe", AT, Node::new(Value::List(Vec::new()), AT));
    }
    if let Some(Value::List(list)) = root.get_mut("probe").map(|e| &mut e.node.value) {
        let mut table = Table::default();
        table.set("name", AT, Node::new(Value::Text(name.to_owned()), AT));
        table.set("quantity", AT, Node::new(Value::Text(quantity.to_owned()), AT));
        list.push(Node::new(Value::Table(table), AT));
    }
}
