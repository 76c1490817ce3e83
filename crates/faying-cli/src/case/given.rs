//! Values that a case gives the keys of an entry of the registry.

use super::key::{Absent, Key, KeyKind};
use super::tree::{Node, Value, parse_value};
use crate::formula::{Formula, Point};
use crate::place::{Located, Origin, SourceSpan};
use faying::linalg::Vector;

#[derive(Clone, Debug, PartialEq)]
pub(super) enum GivenValue {
    Number(f64),
    Whole(usize),
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
    pub(super) values: Vec<(&'static str, GivenValue, SourceSpan)>,
}

impl Given {
    /// The defaults of `keys`; those without default are left out.
    pub(crate) fn of_defaults(keys: &[Key]) -> Self {
        Self { values: keys.iter().filter_map(|key| Some((key.name, default_of(key)?, SourceSpan::default()))).collect() }
    }

    /// Place of a key's value in the case; `None` if the entry has no such key.
    pub fn at(&self, key: &str) -> Option<SourceSpan> {
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

    /// A number that stands in the case, with its place; `None` without such a key, and where it is "auto".
    pub(crate) fn written(&self, key: &str) -> Option<Located<f64>> {
        let (_, value, at) = self.values.iter().find(|(name, ..)| *name == key)?;
        match value {
            GivenValue::Auto(Some(v)) | GivenValue::Number(v) if at.origin != Origin::Default => Some(Located::new(*v, *at)),
            _ => None,
        }
    }

    /// A whole number.
    pub fn whole(&self, key: &str) -> usize {
        match self.value(key) {
            GivenValue::Whole(n) => *n,
            other => panic!("`{key}` is no whole number: {other:?}"),
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

    /// A word, or a text.
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

/// The default of a key of an entry; `None` for a required one.
///
/// # Panics
/// If the text of the default is no value of the key's type.
pub(super) fn default_of(key: &Key) -> Option<GivenValue> {
    let Absent::Is(text) = key.absent else { return None };
    let node = parse_value(text, SourceSpan::default()).ok();
    let value = node.and_then(|node| typed(&key.kind, &node));
    Some(value.unwrap_or_else(|| panic!("the default {text} of `{}` is no value of its type", key.name)))
}

/// A plain value of a type; `None` for values of other types.
fn typed(kind: &KeyKind, node: &Node) -> Option<GivenValue> {
    let number = |node: &Node| match node.value {
        Value::Integer(n) => Some(n as f64),
        Value::Float(v) => Some(v),
        _ => None,
    };
    Some(match (kind, &node.value) {
        (KeyKind::Number | KeyKind::Positive, _) => GivenValue::Number(number(node)?),
        (KeyKind::Whole(..), Value::Integer(n)) => GivenValue::Whole(usize::try_from(*n).ok()?),
        (KeyKind::Auto, Value::Text(word)) if word == "auto" => GivenValue::Auto(None),
        (KeyKind::Auto, _) => GivenValue::Auto(Some(number(node)?)),
        (KeyKind::Formula, Value::Integer(_) | Value::Float(_)) => GivenValue::Formula(Formula::constant(number(node)?)),
        (KeyKind::Vector, Value::List(list)) => GivenValue::Vector(list.iter().map(number).collect::<Option<_>>()?),
        (KeyKind::Flag, Value::Bool(b)) => GivenValue::Flag(*b),
        (KeyKind::Word(_) | KeyKind::Text, Value::Text(word)) => GivenValue::Word(word.clone()),
        _ => return None,
    })
}
