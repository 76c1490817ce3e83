//! Parts of a contact's slave side that are held inside of what it faces: no pressure can move them out.
//!
//! A point counts as held if more than half of its displacement is that of functions that cannot move along the normal. The warning is given
//! where such a point lies deeper than a tenth of the largest displacement of the bodies:
//!
//! ```text
//! Σ_(i held) N_i > 1/2,   -g > 0.1 max |u|
//! ```

use super::soft_penalty::moved_by;
use super::warning::{Subject, Warning};
use crate::basis::{Basis, Order, ShapeTable};
use crate::problem::model::Model;
use crate::problem::state::StepState;
use std::collections::HashSet;

/// Share of the displacement at a point from which on it is held.
const HELD: f64 = 0.5;
/// Depth over the largest displacement.
const DEEP: f64 = 0.1;

/// Finds the contacts with such parts.
pub(super) fn held_within<const S: usize, const N: usize>(model: &Model<S, N>, state: &StepState<S, N>) -> Vec<Warning> {
    let mut found = Vec::new();
    for (k, (contact, built)) in model.contacts.iter().zip(&state.contacts).enumerate() {
        let mut worst: Option<(f64, Vec<f64>)> = None;
        for (part, rows) in contact.parts.iter().zip(built).filter(|(part, _)| !part.held.is_empty()) {
            let patches: Vec<usize> = part.masters.iter().map(|m| m.patch).chain([part.slave.patch]).collect();
            let deep = DEEP * moved_by(model, state, &patches);
            let (held, gaps) = (part.held.iter().collect::<HashSet<_>>(), part.point_gaps(model, rows, &state.u));
            let (trace, segments) = (&part.slave.trace, &rows.segments);
            let (mut ids, mut table) = (Vec::new(), ShapeTable::new());
            for piece in 0..segments.num_pieces() {
                let points = segments.points(piece);
                if points.clone().all(|q| -gaps[q] <= deep) {
                    continue;
                }
                trace.space.active(segments.slave[piece], &mut ids);
                trace.space.tabulate(segments.slave[piece], &segments.slave_xi[points.clone()], Order::Values, &mut table);
                for (at, q) in points.enumerate() {
                    let share: f64 =
                        ids.iter().zip(table.values(at)).filter(|(i, _)| held.contains(&trace.dofs[**i])).map(|(_, n)| n).sum();
                    if share > HELD && -gaps[q] > worst.as_ref().map_or(deep, |w| w.0) {
                        worst = Some((-gaps[q], rows.frames.x[q].as_slice().to_vec()));
                    }
                }
            }
        }
        found.extend(worst.map(|(depth, x)| Warning::HeldWithin { of: Subject::contact(model, k), depth, x }));
    }
    found
}
