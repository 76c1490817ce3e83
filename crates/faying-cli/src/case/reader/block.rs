//! Tables: opening, unknown keys, missing ones.

use super::Reader;
use crate::case::keys;
use crate::case::tree::{Node, Table, Value};
use crate::errors::{Diagnostic, nearest};
use crate::place::{Located, Origin, Place};

/// A table that is being read.
#[derive(Debug)]
pub(in crate::case) struct Block {
    pub table: Table,
    /// Its head, or the value itself for an inline table.
    pub at: Place,
    /// Description for messages: `material "steel"`.
    pub what: String,
    pub keys: Vec<&'static str>,
    /// Given keys that are also the nearest ones to unknown keys.
    pub meant: Vec<&'static str>,
}

impl Block {
    pub fn node(&self, key: &str) -> Option<&Node> {
        self.table.get(key).map(|e| &e.node)
    }

    pub fn has(&self, key: &str) -> bool {
        self.table.get(key).is_some()
    }

    /// The place of a key, or of the head where the key is absent.
    pub fn key_at(&self, key: &str) -> Place {
        self.table.get(key).map_or(self.at, |e| e.key_at)
    }

    /// Writes a default into the tree, from which the effective case is written.
    pub fn default(&mut self, key: &str, value: Value) -> Place {
        let at = Place { origin: Origin::Default, ..self.at };
        self.table.set(key, at, Node::new(value, at));
        at
    }

    /// Replaces an inline table of the file by its read form with all defaults.
    pub fn replace(&mut self, key: &str, table: Table) {
        if let Some(e) = self.table.get_mut(key) {
            e.node.value = Value::Table(table);
        }
    }

    /// The table in the order of its keys.
    pub fn finish(mut self) -> Table {
        self.table.order(&self.keys);
        self.table
    }

    pub fn head(&self) -> Located<()> {
        Located::new((), self.at)
    }
}

impl Reader {
    /// Opens a table; unknown keys are reported with the nearest known one, and read as that one if it is absent, so that a
    /// misspelt key is one error.
    pub fn block(&mut self, node: &Node, what: &str, known: &[&'static str]) -> Option<Block> {
        let Value::Table(table) = &node.value else {
            self.wrong_type(node, what, "a table", "");
            return None;
        };
        let mut table = table.clone();
        for (alias, key) in keys::ALIASES {
            if !known.contains(key) {
                continue;
            }
            if let Some(at) = table.get(alias).map(|e| e.key_at) {
                if table.get(key).is_some() {
                    self.fault("E016", at, format!("`{alias}` is another name of `{key}`, which is given too"), format!("keep `{key}`"));
                    table.entries.retain(|e| e.key != *alias);
                } else if let Some(e) = table.get_mut(alias) {
                    e.key = (*key).to_owned();
                }
            }
        }
        let named = match table.get("name").map(|e| &e.node.value) {
            Some(Value::Text(name)) if known.contains(&"name") => format!("{what} {name:?}"),
            _ => what.to_owned(),
        };
        let (plain, refused) = self.later_keys(&table, what);
        let understood = |key: &str| known.contains(&key) || plain.contains(&key);
        let unknown: Vec<(String, Place)> = table
            .entries
            .iter()
            .filter(|e| !understood(&e.key) && !refused.contains(&e.key.as_str()))
            .map(|e| (e.key.clone(), e.key_at))
            .collect();
        let mut meant = Vec::new();
        for (key, at) in unknown {
            let Some(near) = self.unknown_key(&key, at, &named, known) else { continue };
            if table.get(near).is_some() {
                meant.push(near);
            } else if let Some(e) = table.get_mut(&key) {
                e.key = near.to_owned();
            }
        }
        table.entries.retain(|e| understood(&e.key));
        Some(Block { table, at: node.at, what: named, keys: known.to_vec(), meant })
    }

    /// Reports an unknown key; returns the nearest known one, if there is one.
    pub fn unknown_key(&mut self, key: &str, at: Place, what: &str, known: &[&'static str]) -> Option<&'static str> {
        if keys::LATER.contains(&key) {
            self.fault("E019", at, format!("`{key}` is not in this version"), format!("keys here: {}", known.join(", ")));
            return None;
        }
        let place = if what.is_empty() { "at the top level".to_owned() } else { format!("in {what}") };
        let mut d = Diagnostic::error("E012", format!("unknown key `{key}` {place}"));
        let symbol = keys::SYMBOLS.iter().find(|(s, k)| *s == key && known.contains(k)).map(|(_, k)| *k);
        let near = symbol.or_else(|| nearest(key, known.iter().copied())).and_then(|n| known.iter().find(|k| **k == n).copied());
        if let Some(near) = near {
            d = d.with_label(format!("did you mean `{near}`?"));
        }
        self.push(at, d.with_help(format!("keys here: {}", known.join(", "))));
        near
    }

    pub fn missing(&mut self, block: &Block, key: &str, example: &str) {
        let what = block.what.clone();
        self.fault("E013", block.at, format!("`{key}` is missing in {what}"), format!("write {example}"));
    }

    /// The node of a required key.
    pub fn required(&mut self, block: &Block, key: &str, example: &str) -> Option<Node> {
        let node = block.node(key).cloned();
        if node.is_none() {
            self.missing(block, key, example);
        }
        node
    }
}
