//! Axes of studies: changes of a case by a row, after `--set`. Each sets its key in every block where the grammar says that it has an
//! effect.

use super::key::{Axis, Key, Scene, Special};
use super::names::Names;
use super::rows::ROOT;
use super::tree::{Node, Table, Value, parse_value};
use crate::place::{Origin, SourceSpan};

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

const AT: SourceSpan = SourceSpan { origin: Origin::Option, ..SourceSpan::NONE };

impl Changes {
    /// Axes with their values, for all blocks or for the patch of a name.
    fn values(&self) -> Vec<(Axis, Option<&str>, Node)> {
        let text = |word: &str| Node::new(Value::Text(word.to_owned()), AT);
        let whole = |n: usize| Node::new(Value::Integer(i64::try_from(n).unwrap_or(i64::MAX)), AT);
        let data = |pairing: &str| {
            if pairing.starts_with('{') { parse_value(pairing, AT).unwrap_or_else(|_| text(pairing)) } else { text(pairing) }
        };
        let mut all = Vec::new();
        all.extend(self.backend.iter().map(|word| (Axis::Backend, None, text(word))));
        all.extend(self.degree.iter().map(|p| (Axis::Degree, None, whole(*p))));
        all.extend(self.pairing.iter().map(|word| (Axis::Pairing, None, data(word))));
        all.extend(self.integration.iter().map(|word| (Axis::Integration, None, text(word))));
        all.extend(self.extra_points.iter().map(|n| (Axis::ExtraPoints, None, whole(*n))));
        all.extend(self.backends.iter().map(|(patch, word)| (Axis::Backend, Some(patch.as_str()), text(word))));
        all.extend(self.degrees.iter().map(|(patch, p)| (Axis::Degree, Some(patch.as_str()), whole(*p))));
        all.extend((self.level > 0).then(|| (Axis::Level, None, whole(self.level))));
        all
    }
}

/// Applies the changes.
pub(super) fn apply(root: &mut Table, changes: &Changes, names: &Names) {
    for (axis, patch, node) in changes.values() {
        for block in ROOT {
            match block.special() {
                Some(Special::Block(keys)) => section(root, block.name, keys, axis, &node, patch.is_none()),
                Some(Special::Blocks(keys)) => list(root, block.name, keys, axis, &node, patch, names),
                _ => {}
            }
        }
    }
    for (name, quantity) in &changes.quantities {
        ask(root, name, quantity);
    }
}

fn of_axis(keys: &[Key], axis: Axis) -> Option<&Key> {
    keys.iter().find(|key| key.axis == Some(axis))
}

/// Sets the key of an axis in a section, which holds defaults of blocks.
fn section(root: &mut Table, name: &str, keys: &[Key], axis: Axis, node: &Node, everywhere: bool) {
    let Some(key) = of_axis(keys, axis).filter(|_| everywhere) else { return };
    if root.get(name).is_none() {
        root.set(name, AT, Node::new(Value::Table(Table::default()), AT));
    }
    if let Some(Value::Table(t)) = root.get_mut(name).map(|e| &mut e.node.value) {
        t.set(key.name, AT, node.clone());
    }
}

/// Sets the key of an axis in the blocks of a list. One that only overrides the default of a section is taken out instead, but for a patch
/// by name; levels add up.
fn list(root: &mut Table, name: &str, keys: &[Key], axis: Axis, node: &Node, patch: Option<&str>, names: &Names) {
    let Some(key) = of_axis(keys, axis) else { return };
    let overrides = ROOT.iter().any(|block| matches!(block.special(), Some(Special::Block(keys)) if of_axis(keys, axis).is_some()));
    let scene = Scene { names, poisson: false, dimension: 2, backend: None, any_backend: true };
    let Some(Value::List(blocks)) = root.get_mut(name).map(|e| &mut e.node.value) else { return };
    let tables = blocks.iter_mut().filter_map(|block| match &mut block.value {
        Value::Table(t) => Some(t),
        _ => None,
    });
    for table in tables.filter(|t| patch.is_none() || super::rows::word(t, "name") == patch) {
        if key.only.is_some_and(|only| !(only.holds)(table, &scene)) {
            continue;
        }
        match (&node.value, table.get_mut(key.name).map(|e| &mut e.node.value)) {
            _ if overrides && patch.is_none() => table.entries.retain(|e| e.key != key.name),
            // a level that is no whole number stays and is rejected by the reader
            (Value::Integer(more), Some(Value::Integer(n))) if axis == Axis::Level && *n >= 0 => *n = n.saturating_add(*more),
            (_, Some(_)) if axis == Axis::Level => {}
            _ => table.set(key.name, AT, node.clone()),
        }
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
