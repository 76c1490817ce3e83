//! Keys of entries of the registry.

use super::{Block, Reader, Sign, Uses};
use crate::case::given::{Given, GivenValue, default_of};
use crate::case::key::{Absent, Key, KeyKind};
use crate::case::names::EntryKeys;
use crate::place::{Origin, SourceSpan};

impl Reader {
    /// The values of `keys` in a block; `None` where one cannot be read.
    pub fn given(&mut self, b: &mut Block, keys: &[Key]) -> Option<Given> {
        let mut values = Vec::with_capacity(keys.len());
        let mut complete = true;
        for key in keys {
            match self.given_value(b, key) {
                Some((value, at)) => values.push((key.name, value, at)),
                None => complete &= matches!(key.absent, Absent::None(_)) && !b.has(key.name),
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
            if default_of(key).is_some_and(|default| default == value) {
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

    fn given_value(&mut self, b: &mut Block, key: &Key) -> Option<(GivenValue, SourceSpan)> {
        let name = key.name;
        if !b.has(name)
            && let Absent::Is(_) = key.absent
        {
            b.fill(key);
            let at = SourceSpan { origin: Origin::Default, ..b.at };
            return Some((default_of(key)?, at));
        }
        let node = match key.absent {
            Absent::None(_) => b.node(name).cloned()?,
            _ => self.required(b, name)?,
        };
        let value = match &key.kind {
            KeyKind::Number => GivenValue::Number(self.number_of(&node, name, Sign::Any)?),
            KeyKind::Positive => GivenValue::Number(self.number_of(&node, name, Sign::Positive)?),
            KeyKind::Whole(least, most) => GivenValue::Whole(self.whole_of(&node, name, *least, *most)?),
            KeyKind::Auto => GivenValue::Auto(self.auto_of(&node, name)?),
            KeyKind::Formula => GivenValue::Formula(self.formula_of(&node, name, Uses::Space)?.value),
            KeyKind::Vector => GivenValue::Vector(self.vector_of(&node, name, false)?.value),
            KeyKind::Flag => GivenValue::Flag(self.flag_of(&node, name)?),
            KeyKind::Word(words) => {
                let all: Vec<(&str, usize)> = words.iter().enumerate().map(|(k, w)| (*w, k)).collect();
                GivenValue::Word(words[self.word_of(&node, name, &all)?].to_owned())
            }
            KeyKind::Text => GivenValue::Word(self.text_of(&node, name)?.value),
            KeyKind::Language(kind) => unreachable!("entries have no keys of type {kind:?}"),
        };
        Some((value, node.at))
    }
}
