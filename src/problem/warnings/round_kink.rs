//! Multipliers that run round an edge of their slave side.
//!
//! Tractions of a constant stress jump with the normal. A multiplier that is continuous across an edge does not hold them: beside the edge it is off
//! by a share of the jump, whatever the size of the elements. Slave sides are taken as their pieces between edges where each piece has room for
//! a multiplier of its own, so this is left of walls of single elements.

use super::warning::{Subject, Warning};
use crate::basis::Basis;
use crate::problem::model::{BodySide, Model};
use crate::problem::smooth_pieces::walls;
use std::collections::HashMap;

/// Finds the ties and contacts with such multipliers.
pub(super) fn round_kinks<const S: usize, const N: usize>(model: &Model<S, N>) -> Vec<Warning> {
    let mut found: Vec<Warning> = Vec::new();
    for (k, tie) in model.ties.iter().enumerate() {
        let parts = tie.parts.iter().filter(|part| part.multipliers.iter().any(|psi| runs_round(model, &part.slave, &**psi)));
        found.extend(parts.take(1).map(|part| Warning::RoundKink { of: Subject::tie(model, k), slave: part.slave.label.clone() }));
    }
    for (k, contact) in model.contacts.iter().enumerate() {
        let parts = contact.parts.iter().filter(|part| part.multiplier.as_deref().is_some_and(|psi| runs_round(model, &part.slave, psi)));
        found.extend(parts.take(1).map(|part| Warning::RoundKink { of: Subject::contact(model, k), slave: part.slave.label.clone() }));
    }
    found
}

/// Whether a function of `psi` lies on both sides of an edge.
fn runs_round<const S: usize, const N: usize>(model: &Model<S, N>, slave: &BodySide<S, N>, psi: &dyn Basis<S>) -> bool {
    let pieces = walls(&model.patches, slave);
    if pieces.len() == 1 {
        return false;
    }
    let (mut first, mut ids) = (HashMap::new(), Vec::new());
    pieces.iter().enumerate().any(|(k, piece)| {
        piece.iter().any(|&e| {
            psi.active(e, &mut ids);
            ids.iter().any(|&j| *first.entry(j).or_insert(k) != k)
        })
    })
}
