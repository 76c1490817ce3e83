//! Keys of obstacles and materials from outside, and the values that a case gives them.

use super::reader::{Block, Reader, Sign, Uses};
use super::tree::Value;
use crate::formula::{Formula, Point};
use faying::linalg::Vector;
use serde_json::json;

/// A key of an entry of the registry: its name, its type with its default, its meaning.
#[derive(Clone, Debug, PartialEq)]
pub struct Key {
    /// Name in case files.
    pub name: &'static str,
    /// Type and default.
    pub kind: KeyKind,
    /// Meaning, with its unit, for `faying schema`.
    pub text: &'static str,
}

/// Type of a key, with its default; required without one.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum KeyKind {
    /// A number.
    Number(Option<f64>),
    /// A number above zero.
    Positive(Option<f64>),
    /// A formula of x, y, z, t.
    Formula(Option<f64>),
    /// A number per coordinate.
    Vector,
    /// true or false.
    Flag(bool),
    /// One of these words, by default the first.
    Word(&'static [&'static str]),
}

impl Key {
    /// A key.
    pub fn new(name: &'static str, kind: KeyKind, text: &'static str) -> Self {
        Self { name, kind, text }
    }

    /// Whether a case must give it.
    pub(super) fn is_required(&self) -> bool {
        matches!(self.kind, KeyKind::Number(None) | KeyKind::Positive(None) | KeyKind::Formula(None) | KeyKind::Vector)
    }

    /// Its type as JSON Schema.
    pub(super) fn schema(&self) -> serde_json::Value {
        let (mut value, default) = match &self.kind {
            KeyKind::Number(default) => (json!({"$ref": "#/$defs/number"}), default.map(|v| json!(v))),
            KeyKind::Positive(default) => (json!({"$ref": "#/$defs/positive"}), default.map(|v| json!(v))),
            KeyKind::Formula(default) => (json!({"$ref": "#/$defs/formula"}), default.map(|v| json!(v))),
            KeyKind::Vector => (json!({"$ref": "#/$defs/vector"}), None),
            KeyKind::Flag(default) => (json!({"type": "boolean"}), Some(json!(default))),
            KeyKind::Word(words) => (json!({"enum": words}), words.first().map(|w| json!(w))),
        };
        value["description"] = json!(self.text);
        if let Some(default) = default {
            value["default"] = default;
        }
        value
    }
}

#[derive(Clone, Debug, PartialEq)]
enum GivenValue {
    Number(f64),
    Formula(Formula),
    Vector(Vec<f64>),
    Flag(bool),
    Word(String),
}

/// Values of the keys of an entry, defaults included.
///
/// Every getter panics if the entry has no key of this name and type.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Given {
    values: Vec<(&'static str, GivenValue)>,
}

impl Given {
    fn value(&self, key: &str) -> &GivenValue {
        let found = self.values.iter().find(|(name, _)| *name == key);
        &found.unwrap_or_else(|| panic!("the entry has no key `{key}`")).1
    }

    /// A number.
    pub fn number(&self, key: &str) -> f64 {
        match self.value(key) {
            GivenValue::Number(v) => *v,
            other => panic!("`{key}` is no number: {other:?}"),
        }
    }

    /// A formula.
    pub fn formula(&self, key: &str) -> &Formula {
        match self.value(key) {
            GivenValue::Formula(f) => f,
            other => panic!("`{key}` is no formula: {other:?}"),
        }
    }

    /// A formula as a function of position at time `t`.
    pub fn function<const N: usize>(&self, key: &str, t: f64) -> impl Fn(&Vector<N>) -> f64 + Send + Sync + 'static {
        let formula = self.formula(key).clone();
        move |x| formula.value(&Point::new(x.as_slice()).at_time(t))
    }

    /// A number per coordinate.
    pub fn vector<const N: usize>(&self, key: &str) -> Vector<N> {
        match self.value(key) {
            GivenValue::Vector(v) => Vector::from_fn(|k, _| v.get(k).copied().unwrap_or(0.0)),
            other => panic!("`{key}` is no vector: {other:?}"),
        }
    }

    /// A flag.
    pub fn flag(&self, key: &str) -> bool {
        match self.value(key) {
            GivenValue::Flag(b) => *b,
            other => panic!("`{key}` is no flag: {other:?}"),
        }
    }

    /// A word.
    pub fn word(&self, key: &str) -> &str {
        match self.value(key) {
            GivenValue::Word(w) => w,
            other => panic!("`{key}` is no word: {other:?}"),
        }
    }

    /// Whether a formula depends on the time.
    pub fn depends_on_time(&self) -> bool {
        self.values.iter().any(|(_, v)| matches!(v, GivenValue::Formula(f) if f.depends_on_time()))
    }
}

impl Reader {
    /// The values of `keys` in a block; `None` where one cannot be read.
    pub(super) fn given(&mut self, b: &mut Block, keys: &[Key]) -> Option<Given> {
        let mut values = Vec::with_capacity(keys.len());
        let mut complete = true;
        for key in keys {
            match self.given_value(b, key) {
                Some(value) => values.push((key.name, value)),
                None => complete = false,
            }
        }
        complete.then_some(Given { values })
    }

    fn given_value(&mut self, b: &mut Block, key: &Key) -> Option<GivenValue> {
        let name = key.name;
        let numbers = if self.dimension == 2 { "[0.0, 1.0]" } else { "[0.0, 0.0, 1.0]" };
        let example = if key.kind == KeyKind::Vector { format!("{name} = {numbers}") } else { format!("{name} = 1.0") };
        match &key.kind {
            KeyKind::Flag(default) => return Some(GivenValue::Flag(self.flag(b, name, *default).value)),
            KeyKind::Word(words) => {
                let all: Vec<(&str, usize)> = words.iter().enumerate().map(|(k, w)| (*w, k)).collect();
                let chosen = self.word(b, name, &all).value;
                return Some(GivenValue::Word(words[chosen].to_owned()));
            }
            KeyKind::Number(Some(v)) | KeyKind::Positive(Some(v)) | KeyKind::Formula(Some(v)) if !b.has(name) => {
                b.default(name, Value::Float(*v));
            }
            _ => {}
        }
        let node = self.required(b, name, &example)?;
        Some(match &key.kind {
            KeyKind::Number(_) => GivenValue::Number(self.number_of(&node, name, Sign::Any)?),
            KeyKind::Positive(_) => GivenValue::Number(self.number_of(&node, name, Sign::Positive)?),
            KeyKind::Formula(_) => GivenValue::Formula(self.formula_of(&node, name, Uses::Space)?.value),
            _ => GivenValue::Vector(self.vector_of(&node, name, false)?.value),
        })
    }
}
