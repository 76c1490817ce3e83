//! Quantities that a study evaluates in every row: its columns.

use super::rows::{Row, contact_names};
use crate::case::Case;
use crate::quantities::Quantity;

/// A quantity of a study: a probe of the case, or one that the study adds to it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Asked {
    /// Name of the probe that evaluates it.
    pub probe: String,
    /// Name in the table: the probe's name, or the text of the quantity.
    pub name: String,
    /// Its text.
    pub quantity: String,
    /// Whether it is compared between rows.
    pub compared: bool,
}

impl Asked {
    /// Whether the study adds it to the probes of the case.
    pub fn is_added(&self) -> bool {
        self.probe != self.name
    }

    /// Its value in a row; not finite if there is none.
    pub fn value(&self, row: &Row) -> f64 {
        let answer = row.result.probes.iter().find(|p| p.name == self.probe);
        answer.filter(|_| row.solved()).map_or(f64::NAN, |p| p.value)
    }

    /// Whether it is an error, which tends to zero under refinement.
    pub fn is_error(&self) -> bool {
        self.quantity.trim().starts_with("error.")
    }
}

/// The quantities of a study: `wanted`, each the name of a probe or a quantity; else all probes; else the energy and the
/// greatest pressure of every contact. Then, not compared, the quantities in checks of `case` on rates.
pub fn asked(case: &Case, wanted: &[String], levels: usize) -> Vec<Asked> {
    let mut list: Vec<Asked> = Vec::new();
    let mut add = |text: &str, compared: bool| {
        let text = text.trim();
        let known = case.probes.iter().find(|p| p.name.value == text || p.quantity.value.trim() == text);
        if list.iter().any(|a| a.quantity == text || a.name == text) {
            return;
        }
        let (probe, name, quantity) = match known {
            Some(p) => (p.name.value.clone(), p.name.value.clone(), p.quantity.value.trim().to_owned()),
            None => (format!("--quantity-{}", list.len()), text.to_owned(), text.to_owned()),
        };
        list.push(Asked { probe, name, quantity, compared });
    };
    if !wanted.is_empty() {
        wanted.iter().for_each(|text| add(text, true));
    } else if !case.probes.is_empty() {
        case.probes.iter().for_each(|p| add(&p.name.value, true));
    } else {
        add("energy", true);
        contact_names(case).iter().for_each(|name| add(&format!("contact.{name}.pressure.max"), true));
    }
    if levels > 1 {
        for check in &case.checks {
            if let Some(inner) = rate_of(&check.quantity.value) {
                add(&inner, false);
            }
        }
    }
    list
}

/// Returns Q of `rate.Q`.
pub(super) fn rate_of(text: &str) -> Option<String> {
    let inner = text.trim().strip_prefix("rate.")?.trim();
    Quantity::parse(inner).ok().filter(|q| !q.is_study()).map(|_| inner.to_owned())
}
