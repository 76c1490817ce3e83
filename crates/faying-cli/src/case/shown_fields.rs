//! `fields` of `[output]`: what `fields.svg` shows.

use super::reader::{Block, Reader};
use super::tree::Value;
use super::types::{Case, PointNumber, ShownField};
use crate::errors::nearest;
use crate::formula::{Formula, Scope};
use crate::place::Located;
use crate::quantities::{At, FieldName, Quantity, QuantityKind, Reduce};

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

/// Another field of quantities in elasticity, `principal.1` or `stress.rr about [0, 0]`; the text may say what is wrong with its centre.
fn derived(word: &str, case: &Case) -> Option<Result<PointNumber, String>> {
    let QuantityKind::Field { field, about, at: At::Everywhere, patch: None, reduce: Reduce::None } = Quantity::parse(word).ok()?.kind
    else {
        return None;
    };
    let dimension = case.model.dimension.value;
    let there = match field {
        FieldName::Strain(i, j) => i == j || i.max(j) < dimension,
        other => other.is_polar() || matches!(other, FieldName::Principal(_) | FieldName::Norm),
    };
    if !there || case.model.components() == 1 {
        return None;
    }
    let mut centre = [0.0; 2];
    if !about.is_empty() && about.len() != 2 {
        return Some(Err(format!("the centre of `{word}` has {} coordinates; write about [x, y]", about.len())));
    }
    for (x, text) in centre.iter_mut().zip(&about) {
        let value = Formula::parse(text, &Scope::number(&case.constants)).ok().and_then(|f| f.as_constant()).filter(|v| v.is_finite());
        match value {
            Some(value) => *x = value,
            None => return Some(Err(format!("the coordinate `{text}` of `{word}` is no number"))),
        }
    }
    Some(Ok(PointNumber::Derived(field, centre)))
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
        let more = if case.model.components() == 1 { "" } else { ", principal.1, strain.xx, stress.rr about [x, y], ..." };
        let list: Vec<&str> = known.iter().map(|(word, _)| word.as_str()).collect();
        let mut found: Vec<ShownField> = Vec::new();
        for word in words {
            if let Some((_, field)) = known.iter().find(|(name, _)| *name == word.value) {
                found.push(field.clone());
                continue;
            }
            match derived(&word.value, case) {
                Some(Ok(number)) => {
                    if found.iter().any(|f| matches!(f, ShownField::Bodies { number: known, .. } if *known == number)) {
                        continue;
                    }
                    found.push(ShownField::Bodies { word: word.value.trim().to_owned(), number });
                    continue;
                }
                Some(Err(text)) => {
                    self.fault("E018", word.at, text, "coordinates are numbers, or formulas of [let]");
                    continue;
                }
                None => {}
            }
            let near = nearest(&word.value, list.iter().copied()).map_or(String::new(), |near| format!("did you mean `{near}`? "));
            self.fault(
                "E018",
                word.at,
                format!("there is no field `{}` to show", word.value),
                format!("{near}fields here: {}{more}", list.join(", ")),
            );
        }
        found
    }
}
