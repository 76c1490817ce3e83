//! Keys of entries of the registry.

use super::{Block, Reader, Sign, Uses};
use crate::case::key::{Given, GivenValue, Key, KeyKind};
use crate::case::names::EntryKeys;
use crate::case::tree::Value;
use crate::place::Place;

impl Reader {
    /// The values of `keys` in a block; `None` where one cannot be read.
    pub fn given(&mut self, b: &mut Block, keys: &[Key]) -> Option<Given> {
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
    pub fn entry(&mut self, b: &mut Block, what: &str, chosen: &str, entries: &[EntryKeys]) -> Option<Given> {
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
