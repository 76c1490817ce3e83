//! Times at which data are checked, and places of the constants of materials.

use crate::case::{self, Elastic as Constants};
use crate::formula::Formula;
use crate::place::Place;
use crate::words::short;
use faying::physics::MaterialError;

/// Times at which a formula is checked: all of the case if it changes, else the first.
pub(crate) fn times(case: &case::Case, changes: bool) -> &[f64] {
    match case.steps.value.as_slice() {
        [] => &[1.0],
        all if changes => all,
        all => &all[..1],
    }
}

/// Text ", t = 0.5" if something changes with the time, else empty.
pub(super) fn time_text(changes: bool, t: f64) -> String {
    if changes { format!(", t = {}", short(t)) } else { String::new() }
}

/// Source location of the key that an error of a material refers to.
pub(super) fn key(material: &case::Material, error: &MaterialError) -> Place {
    match (&material.elastic, error) {
        (Some(Constants::YoungPoisson(_, nu)), MaterialError::Singular { .. } | MaterialError::Ratio { .. }) => nu.at,
        (Some(Constants::YoungPoisson(e, _)), _) => e.at,
        (Some(Constants::Lame(l, _)), MaterialError::Lambda { .. }) => l.at,
        (Some(Constants::Lame(_, m)), _) => m.at,
        (None, _) => material.conductivity.at,
    }
}

/// The formulas of the constants of a material.
pub(super) fn constants(material: &case::Material) -> Vec<&Formula> {
    match &material.elastic {
        Some(Constants::YoungPoisson(a, b) | Constants::Lame(a, b)) => vec![&a.value, &b.value],
        None => vec![&material.conductivity.value],
    }
}
