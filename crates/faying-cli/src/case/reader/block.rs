//! Tables: opening, unknown keys, missing ones, keys without effect, keys of later versions.

use super::Reader;
use crate::case::key::{Absent, Key, Plain, Scene, Special};
use crate::case::rows;
use crate::case::tree::{Node, Table, Value, parse_value};
use crate::errors::{Diagnostic, nearest};
use crate::formula::{Formula, Scope};
use crate::place::{Located, Origin, SourceSpan};

/// A table that is being read.
#[derive(Debug)]
pub(in crate::case) struct Block {
    pub table: Table,
    /// Its head, or the value itself for an inline table.
    pub at: SourceSpan,
    /// Description for messages: `material "steel"`.
    pub what: String,
    /// Its rows of the grammar.
    pub keys: Vec<Key>,
    /// Given keys that are also the nearest ones to unknown keys.
    pub meant: Vec<&'static str>,
    /// Given keys that were reported and taken out.
    pub refused: Vec<&'static str>,
}

impl Block {
    pub fn node(&self, key: &str) -> Option<&Node> {
        self.table.get(key).map(|e| &e.node)
    }

    pub fn has(&self, key: &str) -> bool {
        self.table.get(key).is_some()
    }

    /// The place of a key, or of the head where the key is absent.
    pub fn key_at(&self, key: &str) -> SourceSpan {
        self.table.get(key).map_or(self.at, |e| e.key_at)
    }

    /// The row of a key.
    pub fn key(&self, key: &str) -> &Key {
        self.keys.iter().find(|k| k.name == key).unwrap_or_else(|| panic!("{} has no key `{key}`", self.what))
    }

    /// The default of a number.
    pub fn default_number(&self, key: &str) -> f64 {
        match default_node(self.key(key), self.at).value {
            Value::Integer(n) => n as f64,
            Value::Float(v) => v,
            other => panic!("the default of `{key}` is no number: {other:?}"),
        }
    }

    /// Writes a value that is not in the file into the tree, from which the effective case is written.
    pub fn default(&mut self, key: &str, value: Value) -> SourceSpan {
        let at = SourceSpan { origin: Origin::Default, ..self.at };
        self.table.set(key, at, Node::new(value, at));
        at
    }

    /// Writes the default of a key into the tree.
    pub fn fill(&mut self, key: &Key) {
        if let Absent::Is(_) = key.absent {
            let at = SourceSpan { origin: Origin::Default, ..self.at };
            self.default(key.name, default_node(key, at).value);
        }
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

/// The default of a key as a value of the file at `at`.
fn default_node(key: &Key, at: SourceSpan) -> Node {
    let Absent::Is(text) = key.absent else { panic!("`{}` has no default", key.name) };
    parse_value(text, at).unwrap_or_else(|e| panic!("the default {text} of `{}`: {e}", key.name))
}

impl Reader {
    pub fn scene(&self) -> Scene<'_> {
        Scene {
            names: &self.known,
            poisson: self.components == 1,
            dimension: self.dimension,
            backend: self.backend.as_ref(),
            any_backend: self.any_backend,
        }
    }

    /// Opens a table. Unknown keys are reported with the nearest known one, and read as that one if it is absent, so that a misspelt key is
    /// one error. Keys of later versions (E019) and keys without effect (E015) are reported and taken out.
    pub fn block(&mut self, node: &Node, what: &str, keys: &[Key]) -> Option<Block> {
        let Value::Table(table) = &node.value else {
            self.wrong_type(node, what, "a table", "");
            return None;
        };
        let mut table = table.clone();
        for key in keys {
            for alias in key.aliases {
                let Some(at) = table.get(alias).map(|e| e.key_at) else { continue };
                if table.get(key.name).is_some() {
                    let key = key.name;
                    self.fault("E016", at, format!("`{alias}` is another name of `{key}`, which is given too"), format!("keep `{key}`"));
                    table.entries.retain(|e| e.key != *alias);
                } else if let Some(e) = table.get_mut(alias) {
                    e.key = key.name.to_owned();
                }
            }
        }
        let named = match table.get("name").map(|e| &e.node.value) {
            Some(Value::Text(name)) if keys.iter().any(|k| k.name == "name") => format!("{what} {name:?}"),
            _ => what.to_owned(),
        };
        let mut refused = Vec::new();
        for key in keys.iter().filter(|k| k.is_later()) {
            if !self.is_plain(&table, key) {
                table.entries.retain(|e| e.key != key.name);
                refused.push(key.name);
            }
        }
        let known = |key: &str| keys.iter().any(|k| k.name == key);
        let unknown: Vec<(String, SourceSpan)> =
            table.entries.iter().filter(|e| !known(&e.key)).map(|e| (e.key.clone(), e.key_at)).collect();
        let mut meant = Vec::new();
        for (key, at) in unknown {
            let scene = self.scene();
            let here: Vec<&str> =
                keys.iter().filter(|k| !k.is_later() && k.only.is_none_or(|only| (only.holds)(&table, &scene))).map(|k| k.name).collect();
            let Some(near) = self.unknown_key(&key, at, &named, keys, &here.join(", ")) else { continue };
            if table.get(near).is_some() {
                meant.push(near);
            } else if let Some(e) = table.get_mut(&key) {
                e.key = near.to_owned();
            }
        }
        table.entries.retain(|e| known(&e.key));
        refused.extend(self.effects(&mut table, keys));
        Some(Block { table, at: node.at, what: named, keys: keys.to_vec(), meant, refused })
    }

    /// Reports keys without effect in a table, but for those with their defaults, and takes them out; returns them.
    fn effects(&mut self, table: &mut Table, keys: &[Key]) -> Vec<&'static str> {
        let scene = self.scene();
        // keys of the entries that the table names count as these entries say
        let entries = keys.iter().filter_map(|key| match key.special() {
            Some(Special::Entry(family)) => Some((rows::word(table, key.name)?, scene.names.entries(*family))),
            _ => None,
        });
        let own: Vec<&str> = entries
            .flat_map(|(word, list)| list.into_iter().filter(move |e| e.name == word))
            .flat_map(|e| &e.keys)
            .map(|k| k.name)
            .collect();
        let mut idle = Vec::new();
        for key in keys.iter().filter(|key| !own.contains(&key.name)) {
            let (Some(only), Some(entry)) = (key.only, table.get(key.name)) else { continue };
            let default = matches!(key.absent, Absent::Is(_)).then(|| default_node(key, entry.node.at));
            if !(only.holds)(table, &scene) && default.is_none_or(|default| default.value != entry.node.value) {
                let out = match key.absent {
                    Absent::Is(default) => format!("leave it out, or write {default}"),
                    _ => "leave it out".to_owned(),
                };
                let help = if only.instead.is_empty() { out } else { only.instead.to_owned() };
                idle.push((key.name, entry.key_at, format!("`{}` is a key of {}", key.name, only.of), help));
            }
        }
        idle.into_iter()
            .map(|(key, at, message, help)| {
                self.fault("E015", at, message, help);
                table.entries.retain(|e| e.key != key);
                key
            })
            .collect()
    }

    /// Whether a key of a later version has a value that means what this version does anyway; else reports it.
    fn is_plain(&mut self, table: &Table, key: &Key) -> bool {
        let (Some(Special::Later(plain, help)), Some(entry)) = (key.special(), table.get(key.name)) else { return true };
        let (name, node) = (key.name, &entry.node);
        let fault = match plain {
            Plain::Never => Some((entry.key_at, format!("`{name}`"))),
            Plain::Zero => (!self.is_zero(node)).then(|| (entry.key_at, format!("`{name}`"))),
            Plain::Words(plain, others) => {
                let words: Vec<(&str, Option<&str>)> =
                    plain.iter().map(|w| (*w, None)).chain(others.iter().map(|w| (*w, Some(*w)))).collect();
                self.word_of(node, name, &words).flatten().map(|word| (node.at, format!("{name} = {word:?}")))
            }
        };
        if let Some((at, what)) = &fault {
            self.fault("E019", *at, format!("{what} is not in this version"), *help);
        }
        fault.is_none()
    }

    fn is_zero(&self, node: &Node) -> bool {
        match &node.value {
            Value::Integer(n) => *n == 0,
            Value::Float(v) => *v == 0.0,
            Value::Text(text) => Formula::parse(text, &Scope::number(&self.constants)).is_ok_and(|f| f.as_constant() == Some(0.0)),
            Value::List(items) => items.iter().all(|item| self.is_zero(item)),
            Value::Table(table) => table.entries.iter().all(|e| self.is_zero(&e.node)),
            _ => false,
        }
    }

    /// Reports an unknown key among those with an effect, `here`; returns the nearest known one, if there is one.
    pub fn unknown_key(&mut self, key: &str, at: SourceSpan, what: &str, keys: &[Key], here: &str) -> Option<&'static str> {
        let known: Vec<&'static str> = keys.iter().filter(|k| !k.is_later()).map(|k| k.name).collect();
        let help = format!("keys here: {here}");
        if rows::LATER.contains(&key) {
            self.fault("E019", at, format!("`{key}` is not in this version"), help);
            return None;
        }
        let place = if what.is_empty() { "at the top level".to_owned() } else { format!("in {what}") };
        let mut d = Diagnostic::error("E012", format!("unknown key `{key}` {place}"));
        let symbol = keys.iter().find(|k| k.symbol == Some(key)).map(|k| k.name);
        let near = symbol.or_else(|| nearest(key, keys.iter().map(|k| k.name)));
        if let Some(near) = near {
            d = d.with_label(format!("did you mean `{near}`?"));
        }
        self.push(at, d.with_help(help));
        known.into_iter().find(|k| Some(*k) == near)
    }

    pub fn missing(&mut self, block: &Block, key: &str) {
        let example = block.key(key).example(self.dimension);
        self.fault("E013", block.at, format!("`{key}` is missing in {}", block.what), format!("write {example}"));
    }

    /// The node of a required key.
    pub fn required(&mut self, block: &Block, key: &str) -> Option<Node> {
        let node = block.node(key).cloned();
        if node.is_none() {
            self.missing(block, key);
        }
        node
    }

    /// The node of a key, or of its default, which enters the effective case where the key has an effect.
    pub fn value_of(&mut self, block: &mut Block, key: &str) -> Node {
        if let Some(node) = block.node(key) {
            return node.clone();
        }
        let row = block.key(key).clone();
        let node = default_node(&row, SourceSpan { origin: Origin::Default, ..block.at });
        if row.only.is_none_or(|only| (only.holds)(&block.table, &self.scene())) {
            block.default(key, node.value.clone());
        }
        node
    }
}
