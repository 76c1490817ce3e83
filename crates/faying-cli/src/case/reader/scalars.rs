//! Texts, flags, numbers, words and names.

use super::{Block, Reader};
use crate::case::keys;
use crate::case::tree::{Node, Value};
use crate::errors::{Diagnostic, nearest};
use crate::formula::{Formula, Scope};
use crate::place::{Located, Place};

/// Signs that a number may have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::case) enum Sign {
    Any,
    Positive,
}

impl Reader {
    pub fn text_of(&mut self, node: &Node, what: &str) -> Option<Located<String>> {
        match &node.value {
            Value::Text(s) => Some(Located::new(s.clone(), node.at)),
            _ => {
                self.wrong_type(node, what, "a text in quotes", "");
                None
            }
        }
    }

    pub fn flag(&mut self, block: &mut Block, key: &str, default: bool) -> Located<bool> {
        match block.node(key).cloned() {
            None => Located::new(default, block.default(key, Value::Bool(default))),
            Some(Node { value: Value::Bool(b), at, .. }) => Located::new(b, at),
            Some(node) => {
                self.wrong_type(&node, key, "true or false", format!("write {key} = {default}"));
                Located::new(default, node.at)
            }
        }
    }

    pub fn whole_of(&mut self, node: &Node, what: &str, least: i64, most: i64) -> Option<usize> {
        let range = if most >= i64::from(i32::MAX) {
            format!("a whole number of at least {least}")
        } else {
            format!("a whole number from {least} to {most}")
        };
        let (wrong_type, near) = match &node.value {
            Value::Integer(n) if (least..=most).contains(n) => return usize::try_from(*n).ok(),
            Value::Integer(n) => (false, (*n).clamp(least, most)),
            Value::Float(v) if v.is_finite() && v.abs() < 1e15 => (true, (v.round() as i64).clamp(least, most)),
            Value::Text(s) => (true, s.trim().parse::<i64>().unwrap_or(least).clamp(least, most)),
            _ => (true, least),
        };
        let message = format!("`{what}` must be {range}, found {}", node.describe());
        let help = if what.contains(' ') { String::new() } else { format!("write {what} = {near}") };
        self.fault(if wrong_type { "E014" } else { "E015" }, node.at, message, help);
        None
    }

    pub fn whole(&mut self, block: &mut Block, key: &str, least: i64, most: i64, default: usize) -> Located<usize> {
        match block.node(key).cloned() {
            None => Located::new(default, block.default(key, Value::Integer(default as i64))),
            Some(node) => Located::new(self.whole_of(&node, key, least, most).unwrap_or(default), node.at),
        }
    }

    /// A number, or a formula of constants.
    pub fn number_of(&mut self, node: &Node, what: &str, sign: Sign) -> Option<f64> {
        let value = match &node.value {
            Value::Integer(n) => *n as f64,
            Value::Float(v) => *v,
            Value::Text(text) => {
                let parsed = Formula::parse(text, &Scope::number(&self.constants));
                match parsed {
                    Ok(f) => f.value(&Default::default()),
                    Err(e) => {
                        self.push_formula_error(node, what, &e);
                        return None;
                    }
                }
            }
            _ => {
                self.wrong_type(node, what, "a number", "");
                return None;
            }
        };
        let allowed = match sign {
            Sign::Any => "finite",
            Sign::Positive => "positive",
        };
        let good = value.is_finite()
            && match sign {
                Sign::Any => true,
                Sign::Positive => value > 0.0,
            };
        if !good {
            self.fault("E015", node.at, format!("`{what}` must be {allowed}, found {value:?}"), "");
            return None;
        }
        Some(value)
    }

    /// "auto" or a positive number.
    pub fn auto(&mut self, block: &mut Block, key: &str) -> Located<Option<f64>> {
        match block.node(key).cloned() {
            None => Located::new(None, block.default(key, Value::Text("auto".to_owned()))),
            Some(Node { value: Value::Text(s), at, .. }) if s == "auto" => Located::new(None, at),
            Some(node) => Located::new(self.number_of(&node, key, Sign::Positive), node.at),
        }
    }

    pub fn number(&mut self, block: &Block, key: &str, sign: Sign) -> Option<Located<f64>> {
        let node = block.node(key).cloned()?;
        self.number_of(&node, key, sign).map(|v| Located::new(v, node.at))
    }

    pub fn required_number(&mut self, block: &Block, key: &str, sign: Sign, example: &str) -> Located<f64> {
        let Some(node) = self.required(block, key, example) else { return Located::new(1.0, block.at) };
        Located::new(self.number_of(&node, key, sign).unwrap_or(1.0), node.at)
    }

    /// One of some words.
    pub fn word_of<T: Copy>(&mut self, node: &Node, what: &str, words: &[(&str, T)]) -> Option<T> {
        let list = words.iter().map(|(w, _)| format!("{w:?}")).collect::<Vec<_>>().join(", ");
        let Value::Text(text) = &node.value else {
            self.wrong_type(node, what, &format!("one of {list}"), "");
            return None;
        };
        if let Some((_, value)) = words.iter().find(|(w, _)| w == text) {
            return Some(*value);
        }
        if keys::LATER.contains(&text.as_str()) {
            self.fault("E019", node.at, format!("{text:?} is not in this version"), format!("`{what}` is one of {list}"));
            return None;
        }
        let text: String = text.chars().take(60).collect();
        let mut d = Diagnostic::error("E015", format!("`{what}` must be one of {list}, found {text:?}"));
        if let Some(near) = nearest(&text, words.iter().map(|(w, _)| *w)) {
            d = d.with_label(format!("did you mean {near:?}?"));
        }
        self.push(node.at, d);
        None
    }

    /// One of some words; the first is the default.
    pub fn word<T: Copy>(&mut self, block: &mut Block, key: &str, words: &[(&str, T)]) -> Located<T> {
        let (name, default) = words[0];
        match block.node(key).cloned() {
            None => Located::new(default, block.default(key, Value::Text(name.to_owned()))),
            Some(node) => Located::new(self.word_of(&node, key, words).unwrap_or(default), node.at),
        }
    }

    /// `name`: required with an example, or else made of the kind and the position.
    pub fn name(&mut self, block: &mut Block, kind: &str, index: usize, required: bool) -> Located<String> {
        let fallback = format!("{kind}-{index}");
        match block.node("name").cloned() {
            None if required => {
                self.missing(block, "name", if kind == "material" { "name = \"steel\"" } else { "name = \"lower\"" });
                self.broken.insert(kind.to_owned());
                Located::new(fallback, block.at)
            }
            None => {
                let at = block.default("name", Value::Text(fallback.clone()));
                Located::new(fallback, at)
            }
            Some(node) => {
                let Some(name) = self.text_of(&node, "name") else {
                    self.broken.insert(kind.to_owned());
                    return Located::new(fallback, node.at);
                };
                // a bad name stays, so that references to it are found
                if name.is_empty() || !name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_' || c == '-') {
                    self.fault("E016", node.at, format!("{:?} is no name", name.value), "names are made of letters, digits, `_` and `-`");
                }
                name
            }
        }
    }

    /// Checks that names of one kind are unique (E016).
    pub fn unique(&mut self, kind: &str, names: &[Located<String>]) {
        let mut first = std::collections::BTreeMap::new();
        for n in names {
            if let Some(at) = first.get(&n.value).copied() {
                let place: Place = at;
                let line = place.in_file().map_or(String::new(), |(l, _)| format!(" on line {l}"));
                self.fault(
                    "E016",
                    n.at,
                    format!("the {kind} name {:?} is already used{line}", n.value),
                    "names are unique within their kind",
                );
                self.broken.insert(kind.to_owned());
            } else {
                first.insert(n.value.clone(), n.at);
            }
        }
    }
}
