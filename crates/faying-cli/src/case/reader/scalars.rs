//! Texts, flags, numbers, words and names.

use super::{Block, Reader};
use crate::case::key::{KeyKind, Special};
use crate::case::rows;
use crate::case::tree::{Node, Value};
use crate::errors::{Diagnostic, nearest};
use crate::formula::{Formula, Scope};
use crate::place::{Located, SourceSpan};

/// Longest name, in letters: files have it in their names.
pub(in crate::case) const LONGEST_NAME: usize = 100;

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

    pub fn flag_of(&mut self, node: &Node, what: &str) -> Option<bool> {
        if let Value::Bool(b) = node.value {
            return Some(b);
        }
        self.wrong_type(node, what, "true or false", format!("write {what} = true"));
        None
    }

    /// true or false, with a default.
    pub fn flag(&mut self, block: &mut Block, key: &str) -> Located<bool> {
        let node = self.value_of(block, key);
        Located::new(self.flag_of(&node, key).unwrap_or_default(), node.at)
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

    /// A whole number within the range of its key.
    fn whole_in(&mut self, block: &Block, node: &Node, key: &str) -> Option<usize> {
        let KeyKind::Whole(least, most) = block.key(key).kind else { panic!("`{key}` is no whole number") };
        self.whole_of(node, key, least, most)
    }

    /// A whole number, with a default.
    pub fn whole(&mut self, block: &mut Block, key: &str) -> Located<usize> {
        let node = self.value_of(block, key);
        Located::new(self.whole_in(block, &node, key).unwrap_or(1), node.at)
    }

    /// A whole number, if it is given.
    pub fn optional_whole(&mut self, block: &Block, key: &str) -> Option<Located<usize>> {
        let node = block.node(key).cloned()?;
        self.whole_in(block, &node, key).map(|n| Located::new(n, node.at))
    }

    /// A required whole number.
    pub fn required_whole(&mut self, block: &Block, key: &str) -> Option<Located<usize>> {
        let node = self.required(block, key)?;
        self.whole_in(block, &node, key).map(|n| Located::new(n, node.at))
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

    /// "auto" or a number above zero.
    pub fn auto_of(&mut self, node: &Node, what: &str) -> Option<Option<f64>> {
        match &node.value {
            Value::Text(s) if s == "auto" => Some(None),
            _ => self.number_of(node, what, Sign::Positive).map(Some),
        }
    }

    /// "auto" or a number above zero, with a default.
    pub fn auto(&mut self, block: &mut Block, key: &str) -> Located<Option<f64>> {
        let node = self.value_of(block, key);
        Located::new(self.auto_of(&node, key).flatten(), node.at)
    }

    /// A number, of the sign of its key.
    fn signed(&mut self, block: &Block, node: &Node, key: &str) -> Option<f64> {
        let sign = if block.key(key).kind == KeyKind::Positive { Sign::Positive } else { Sign::Any };
        self.number_of(node, key, sign)
    }

    /// A number, if it is given.
    pub fn number(&mut self, block: &Block, key: &str) -> Option<Located<f64>> {
        let node = block.node(key).cloned()?;
        self.signed(block, &node, key).map(|v| Located::new(v, node.at))
    }

    /// A number, with a default.
    pub fn number_or_default(&mut self, block: &mut Block, key: &str) -> Located<f64> {
        let node = self.value_of(block, key);
        let value = self.signed(block, &node, key);
        // what could not be read is reported, and gives no further error
        Located::new(value.unwrap_or_else(|| block.default_number(key)), node.at)
    }

    pub fn required_number(&mut self, block: &Block, key: &str) -> Located<f64> {
        let Some(node) = self.required(block, key) else { return Located::new(1.0, block.at) };
        Located::new(self.signed(block, &node, key).unwrap_or(1.0), node.at)
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
        if rows::LATER.contains(&text.as_str()) {
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

    /// The value of one of the words of a key, which are those of `values` in their order.
    pub fn word_in<T: Copy>(&mut self, block: &Block, node: &Node, key: &str, values: &[T]) -> Option<T> {
        let KeyKind::Word(words) = block.key(key).kind else { panic!("`{key}` is no word") };
        assert_eq!(words.len(), values.len(), "`{key}` has a value per word");
        let words: Vec<(&str, T)> = words.iter().copied().zip(values.iter().copied()).collect();
        self.word_of(node, key, &words)
    }

    /// One of some words, with a default.
    pub fn word<T: Copy>(&mut self, block: &mut Block, key: &str, values: &[T]) -> Located<T> {
        let node = self.value_of(block, key);
        Located::new(self.word_in(block, &node, key, values).unwrap_or(values[0]), node.at)
    }

    /// A required word.
    pub fn required_word<T: Copy>(&mut self, block: &Block, key: &str, values: &[T]) -> Option<Located<T>> {
        let node = self.required(block, key)?;
        self.word_in(block, &node, key, values).map(|v| Located::new(v, node.at))
    }

    /// One of some words, if it is given.
    pub fn optional_word<T: Copy>(&mut self, block: &Block, key: &str, values: &[T]) -> Option<Located<T>> {
        let node = block.node(key).cloned()?;
        self.word_in(block, &node, key, values).map(|v| Located::new(v, node.at))
    }

    /// The name of an entry of the registry, with a default.
    pub fn entry_name(&mut self, block: &mut Block, key: &str) -> Located<String> {
        let node = self.value_of(block, key);
        let name = self.entry_name_of(block, &node, key);
        Located::new(name.unwrap_or_else(|| self.entry_names(block, key)[0].clone()), node.at)
    }

    pub fn entry_name_of(&mut self, block: &Block, node: &Node, key: &str) -> Option<String> {
        let known = self.entry_names(block, key);
        let words: Vec<(&str, usize)> = known.iter().enumerate().map(|(k, n)| (n.as_str(), k)).collect();
        self.word_of(node, key, &words).map(|k| known[k].clone())
    }

    fn entry_names(&self, block: &Block, key: &str) -> Vec<String> {
        let Some(Special::Entry(family)) = block.key(key).special() else { panic!("`{key}` names no entry") };
        self.known.words(*family).into_iter().map(str::to_owned).collect()
    }

    /// `name`, by default made of the kind and the position where the key is not required.
    pub fn name(&mut self, block: &mut Block, kind: &str, index: usize) -> Located<String> {
        let fallback = format!("{kind}-{index}");
        match block.node("name").cloned() {
            None if block.key("name").is_required() => {
                self.missing(block, "name");
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
                } else if name.len() > LONGEST_NAME {
                    let (message, help) = (
                        format!("a name of {} letters is too long", name.len()),
                        format!("files have it in their names: take at most {LONGEST_NAME}"),
                    );
                    self.fault("E016", node.at, message, help);
                    self.broken.insert(kind.to_owned());
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
                let place: SourceSpan = at;
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
