//! Keys of entries of the registry, and the values that a case gives them.

use crate::formula::{Formula, Point};
use crate::place::Place;
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
    /// "auto", its default, or a number above zero.
    Auto,
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
    pub(crate) fn is_required(&self) -> bool {
        matches!(self.kind, KeyKind::Number(None) | KeyKind::Positive(None) | KeyKind::Formula(None) | KeyKind::Vector)
    }

    /// Its type as JSON Schema.
    pub(super) fn schema(&self) -> serde_json::Value {
        let (mut value, default) = match &self.kind {
            KeyKind::Number(default) => (json!({"$ref": "#/$defs/number"}), default.map(|v| json!(v))),
            KeyKind::Positive(default) => (json!({"$ref": "#/$defs/positive"}), default.map(|v| json!(v))),
            KeyKind::Auto => (json!({"$ref": "#/$defs/auto"}), None),
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

/// Value of a key.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum GivenValue {
    Number(f64),
    Auto(Option<f64>),
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
    /// Name, value and place of every key.
    pub(super) values: Vec<(&'static str, GivenValue, Place)>,
}

impl Given {
    /// The defaults of `keys`; those without default are left out.
    pub(crate) fn of_defaults(keys: &[Key]) -> Self {
        let default = |key: &Key| match &key.kind {
            KeyKind::Number(v) | KeyKind::Positive(v) => v.map(GivenValue::Number),
            KeyKind::Auto => Some(GivenValue::Auto(None)),
            KeyKind::Formula(v) => v.map(|v| GivenValue::Formula(Formula::constant(v))),
            KeyKind::Vector => None,
            KeyKind::Flag(b) => Some(GivenValue::Flag(*b)),
            KeyKind::Word(words) => words.first().map(|w| GivenValue::Word((*w).to_owned())),
        };
        Self { values: keys.iter().filter_map(|key| Some((key.name, default(key)?, Place::default()))).collect() }
    }

    /// Place of a key's value in the case; `None` if the entry has no such key.
    pub fn at(&self, key: &str) -> Option<Place> {
        self.values.iter().find(|(name, ..)| *name == key).map(|(_, _, at)| *at)
    }

    fn value(&self, key: &str) -> &GivenValue {
        let found = self.values.iter().find(|(name, ..)| *name == key);
        &found.unwrap_or_else(|| panic!("the entry has no key `{key}`")).1
    }

    /// A number, or `None` for "auto".
    pub fn auto(&self, key: &str) -> Option<f64> {
        match self.value(key) {
            GivenValue::Auto(v) => *v,
            other => panic!("`{key}` may not be \"auto\": {other:?}"),
        }
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
        self.values.iter().any(|(_, v, _)| matches!(v, GivenValue::Formula(f) if f.depends_on_time()))
    }
}
