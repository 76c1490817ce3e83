//! Parts of a contact's slave side that are held inside of what it faces: no pressure can move them out.
//!
//! A point of a side counts as held if more than half of its displacement is that of functions that cannot move along the normal. The warning
//! is given where such a point of the slave, with one of the master if it faces a body, lies deeper than a tenth of the largest displacement
//! of the bodies, and than what facets leave of the surfaces that they stand for:
//!
//! ```text
//! Σ_(i held) N_i > 1/2,   -g > 0.1 max |u| + sag
//! ```
//!
//! The force on such a part is what the method makes of the depth, or of the functions that reach into the free rest: both depend on the elements.
//! A master that gives way is pressed aside by the neighbours of the point; what is left of the depth falls with the elements.

use super::soft_penalty::moved_by;
use super::warning::{Subject, Warning};
use crate::basis::{Basis, Order, ShapeTable};
use crate::linalg::Vector;
use crate::problem::model::{BodySide, ContactPart, Model, Opposing};
use crate::problem::state::StepState;
use crate::problem::touching::sag;

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
            let (gaps, segments) = (part.point_gaps(model, rows, &state.u), &rows.segments);
            let candidates: Vec<usize> =
                (0..segments.num_pieces()).filter(|&piece| segments.points(piece).any(|q| -gaps[q] > deep)).collect();
            if candidates.is_empty() {
                continue;
            }
            let sags: Vec<_> = part.masters.iter().map(|m| sag(&model.patches, m).greatest()).collect();
            let (own, master) = (sag(&model.patches, &part.slave), sags.into_iter().sum::<f64>());
            for piece in candidates {
                let (points, element) = (segments.points(piece), segments.slave[piece]);
                let deep = deep + own.of_facet(element) + master;
                let slave = held_shares(model, part, &part.slave, element, &segments.slave_xi[points.clone()]);
                let opposite = match &part.against {
                    Opposing::Side(master, _) => {
                        held_shares(model, part, master, segments.master[piece], &segments.master_xi[points.clone()])
                    }
                    Opposing::Rigid(..) => vec![1.0; points.len()],
                };
                for (q, (own, opposite)) in points.zip(slave.into_iter().zip(opposite)) {
                    if own.min(opposite) > HELD && -gaps[q] > worst.as_ref().map_or(0.0, |w| w.0).max(deep) {
                        worst = Some((-gaps[q], rows.frames.x[q].as_slice().to_vec()));
                    }
                }
            }
        }
        found.extend(worst.map(|(depth, x)| Warning::HeldWithin { of: Subject::contact(model, k), depth, x }));
    }
    found
}

/// Sum of the values of the functions that cannot move along the normal, at points `xi` of an element of one of the contact's sides.
fn held_shares<const S: usize, const N: usize>(
    model: &Model<S, N>,
    part: &ContactPart<S, N>,
    side: &BodySide<S, N>,
    element: usize,
    xi: &[Vector<S>],
) -> Vec<f64> {
    let (mut ids, mut table) = (Vec::new(), ShapeTable::new());
    side.trace.space.active(element, &mut ids);
    side.trace.space.tabulate(element, xi, Order::Values, &mut table);
    // several sides joined into one have functions of the model
    let function = |dof: usize| if side.runs.len() > 1 { dof } else { model.function(side.patch, dof) };
    let held: Vec<bool> = ids.iter().map(|&i| part.held.contains(&function(side.trace.dofs[i]))).collect();
    (0..xi.len()).map(|q| held.iter().zip(table.values(q)).filter(|(held, _)| **held).map(|(_, n)| n).sum()).collect()
}
