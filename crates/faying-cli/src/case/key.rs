//! Keys of entries of the registry, and the values that a case gives them.

use super::names::EntryKeys;
use super::reader::{Block, Reader, Sign, Uses};
use super::tree::Value;
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

#[derive(Clone, Debug, PartialEq)]
enum GivenValue {
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
    values: Vec<(&'static str, GivenValue, Place)>,
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

impl Reader {
    /// The values of `keys` in a block; `None` where one cannot be read.
    pub(super) fn given(&mut self, b: &mut Block, keys: &[Key]) -> Option<Given> {
        let mut values = Vec::with_capacity(keys.len());
        let mut complete = true;
        for key in keys {
            match self.given_value(b, key) {
                Some((value, at)) => values.push((key.name, value, at)),
                None => complete = false,
            }
        }
        complete.then_some(Given { values })
    }

    /// The values of the keys of the entry `chosen` of a family; `what` is the key that chooses it, "method". Keys of other entries are
    /// accepted with their defaults alone (E015).
    pub(super) fn entry(&mut self, b: &mut Block, what: &str, chosen: &str, entries: &[EntryKeys]) -> Option<Given> {
        let own = entries.iter().find(|e| e.name == chosen).map_or(&[][..], |e| &e.keys);
        let given = self.given(b, own);
        let mut seen: Vec<&str> = own.iter().map(|key| key.name).collect();
        for key in entries.iter().flat_map(|e| &e.keys) {
            if seen.contains(&key.name) || !b.has(key.name) {
                continue;
            }
            seen.push(key.name);
            let Some((value, at)) = self.given_value(b, key) else { continue };
            if Given::of_defaults(std::slice::from_ref(key)).values.first().is_some_and(|(_, default, _)| *default == value) {
                continue;
            }
            let owners = entries.iter().filter(|e| e.keys.iter().any(|k| k.name == key.name)).map(|e| format!("{:?}", e.name));
            let owners: Vec<String> = owners.collect();
            let owners = match owners.split_last() {
                Some((last, rest)) if !rest.is_empty() => format!("{} or {last}", rest.join(", ")),
                _ => owners.concat(),
            };
            let (key, text) = (key.name, key.text);
            let message = format!("`{key}` is not a key of {what} = {chosen:?}");
            self.fault("E015", at, message, format!("it belongs to {what} = {owners}: {text}"));
        }
        given
    }

    fn given_value(&mut self, b: &mut Block, key: &Key) -> Option<(GivenValue, Place)> {
        let name = key.name;
        let numbers = if self.dimension == 2 { "[0.0, 1.0]" } else { "[0.0, 0.0, 1.0]" };
        let example = if key.kind == KeyKind::Vector { format!("{name} = {numbers}") } else { format!("{name} = 1.0") };
        match &key.kind {
            KeyKind::Flag(default) => {
                let flag = self.flag(b, name, *default);
                return Some((GivenValue::Flag(flag.value), flag.at));
            }
            KeyKind::Auto => {
                let number = self.auto(b, name);
                return Some((GivenValue::Auto(number.value), number.at));
            }
            KeyKind::Word(words) => {
                let all: Vec<(&str, usize)> = words.iter().enumerate().map(|(k, w)| (*w, k)).collect();
                let chosen = self.word(b, name, &all);
                return Some((GivenValue::Word(words[chosen.value].to_owned()), chosen.at));
            }
            KeyKind::Number(Some(v)) | KeyKind::Positive(Some(v)) | KeyKind::Formula(Some(v)) if !b.has(name) => {
                b.default(name, Value::Float(*v));
            }
            _ => {}
        }
        let node = self.required(b, name, &example)?;
        let value = match &key.kind {
            KeyKind::Number(_) => GivenValue::Number(self.number_of(&node, name, Sign::Any)?),
            KeyKind::Positive(_) => GivenValue::Number(self.number_of(&node, name, Sign::Positive)?),
            KeyKind::Formula(_) => GivenValue::Formula(self.formula_of(&node, name, Uses::Space)?.value),
            _ => GivenValue::Vector(self.vector_of(&node, name, false)?.value),
        };
        Some((value, node.at))
    }
}
