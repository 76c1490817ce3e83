//! `fields` of `[output]`: what `fields.svg` shows.

use super::reader::{Block, Reader};
use super::tree::Value;
use super::types::{Case, PointNumber, ShownField};
use crate::errors::nearest;
use crate::place::Located;

/// Numbers of the bodies, by what they are of: components of u, and dimension.
fn numbers(components: usize, dimension: usize) -> Vec<(String, PointNumber)> {
    if components == 1 {
        return vec![("u".to_owned(), PointNumber::Unknown(0))];
    }
    let stresses = ["xx", "yy", "zz", "xy", "yz", "xz"].into_iter().enumerate().filter(|(k, _)| dimension == 3 || *k < 4);
    let own = [("von_mises".to_owned(), PointNumber::VonMises), ("displacement".to_owned(), PointNumber::Displacement)];
    let stresses = stresses.map(|(k, name)| (format!("stress.{name}"), PointNumber::Stress(k)));
    let of_axes = ["x", "y", "z"].into_iter().take(dimension).enumerate().map(|(k, axis)| (format!("u.{axis}"), PointNumber::Unknown(k)));
    own.into_iter().chain(of_axes).chain(stresses).collect()
}

impl Reader {
    /// The words of `fields`: a text, or a list of texts.
    pub(super) fn words_of_fields(&mut self, b: &mut Block) -> Vec<Located<String>> {
        let Some(node) = b.node("fields").cloned() else { return Vec::new() };
        match &node.value {
            Value::List(items) => items.iter().filter_map(|item| self.text_of(item, "fields")).collect(),
            _ => self.text_of(&node, "fields").into_iter().collect(),
        }
    }

    /// The fields that these words name.
    pub(super) fn shown_fields(&mut self, words: &[Located<String>], case: &Case) -> Vec<ShownField> {
        if words.is_empty() {
            return Vec::new();
        }
        let of_bodies = numbers(case.model.components(), case.model.dimension.value);
        let mut known: Vec<(String, ShownField)> =
            of_bodies.into_iter().map(|(word, number)| (word.clone(), ShownField::Bodies { word, number })).collect();
        let contacts = case.contacts.iter().map(|c| (&c.name.value, "contact", "pressure"));
        let ties = case.interfaces.iter().map(|t| (&t.name.value, "interface", "lambda"));
        known.extend(contacts.chain(ties).map(|(name, of, what)| (format!("{of}.{name}.{what}"), ShownField::Sides(name.clone()))));
        let list: Vec<&str> = known.iter().map(|(word, _)| word.as_str()).collect();
        let mut found = Vec::new();
        for word in words {
            if let Some((_, field)) = known.iter().find(|(name, _)| *name == word.value) {
                found.push(field.clone());
                continue;
            }
            let near = nearest(&word.value, list.iter().copied()).map_or(String::new(), |near| format!("did you mean `{near}`? "));
            self.fault(
                "E018",
                word.at,
                format!("there is no field `{}` to show", word.value),
                format!("{near}fields here: {}", list.join(", ")),
            );
        }
        found
    }
}
