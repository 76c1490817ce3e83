//! Multipliers that run round an edge of their slave side.
//!
//! Tractions of a constant stress jump with the normal. A multiplier that is continuous across an edge does not hold them: beside the edge it is off
//! by a share of the jump, whatever the size of the elements. Slave sides are taken as their pieces between edges where each piece has room for
//! a multiplier of its own, so this is left of walls of single elements. Ties are told of chains of facets, too, that turn by more than 20 degrees from one
//! to the next; the pressure of a contact has no direction that jumps with them.

use super::warning::{Subject, Warning};
use crate::basis::Basis;
use crate::geometry::Kinks;
use crate::problem::model::{BodySide, ContactPart, Model, TiePart};
use crate::problem::smooth_pieces::walls;
use std::collections::HashMap;

/// Finds the ties and contacts with such multipliers.
pub(super) fn round_kinks<const S: usize, const N: usize>(model: &Model<S, N>) -> Vec<Warning> {
    let mut found = Vec::new();
    for (k, tie) in model.ties.iter().enumerate() {
        let round = |part: &&TiePart<S, N>| runs_round(model, &part.slave, part.multipliers.iter().map(|psi| &**psi), Kinks::Steep);
        let part = tie.parts.iter().find(round);
        found.extend(part.map(|part| Warning::RoundKink { of: Subject::tie(model, k), slave: part.slave.label.clone() }));
    }
    for (k, contact) in model.contacts.iter().enumerate() {
        let round = |part: &&ContactPart<S, N>| runs_round(model, &part.slave, part.multiplier.as_deref(), Kinks::OfWalls);
        let part = contact.parts.iter().find(round);
        found.extend(part.map(|part| Warning::RoundKink { of: Subject::contact(model, k), slave: part.slave.label.clone() }));
    }
    found
}

/// Whether a function of a multiplier lies in several pieces of the side between `kinks`.
fn runs_round<'a, const S: usize, const N: usize>(
    model: &Model<S, N>,
    side: &BodySide<S, N>,
    multipliers: impl IntoIterator<Item = &'a dyn Basis<S>>,
    kinks: Kinks,
) -> bool {
    let pieces = walls(&model.patches, side, kinks);
    let is_in_several = |psi: &dyn Basis<S>| {
        let (mut first, mut ids) = (HashMap::new(), Vec::new());
        pieces.iter().enumerate().any(|(k, piece)| {
            piece.iter().any(|&e| {
                psi.active(e, &mut ids);
                ids.iter().any(|&j| *first.entry(j).or_insert(k) != k)
            })
        })
    };
    pieces.len() > 1 && multipliers.into_iter().any(is_in_several)
}
