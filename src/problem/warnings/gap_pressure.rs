//! Pressures of methods with fluxes that come from gaps and not from the stress of the bodies.
//!
//! P = sigma + γ g: where a contact is closed, g is zero in the limit, and P the stress. γ g is what the size of the elements, facets that
//! leave the surface they stand for, and rounding of the gap times γ put into P. The force, a mean, hardly knows of it; values at points do.

use super::warning::{Subject, Warning};
use crate::problem::model::Model;
use crate::problem::state::StepState;

/// Largest |γ g|, as a share of the largest pressure, without a warning.
const LARGEST: f64 = 0.15;

/// Finds the contacts whose pressures at points are so far from the stress.
pub(super) fn gap_pressures<const S: usize, const N: usize>(model: &Model<S, N>, state: &StepState<S, N>) -> Vec<Warning> {
    let mut found = Vec::new();
    for (k, (contact, built)) in model.contacts.iter().zip(&state.contacts).enumerate().filter(|(_, (c, _))| c.method.needs().fluxes) {
        let largest = contact.parts.iter().flat_map(|part| &state.lambda[part.rows()]).fold(0.0_f64, |m, l| m.max(-l));
        let mut worst: Option<(f64, f64, f64, Vec<f64>)> = None;
        for (part, rows) in contact.parts.iter().zip(built) {
            let Some(row) = rows.row_of_points() else { continue };
            let gaps = part.point_gaps(model, rows, &state.u);
            for (q, &j) in row.iter().enumerate().filter(|(_, j)| state.active[part.first_row + **j]) {
                let from_gap = gaps[q] * rows.weights[j] / rows.compliance.get(j).copied().unwrap_or(f64::INFINITY);
                if from_gap.abs() > worst.as_ref().map_or(LARGEST * largest, |w| w.0.abs()) {
                    worst = Some((from_gap, gaps[q], -state.lambda[part.first_row + j], rows.frames.x[q].as_slice().to_vec()));
                }
            }
        }
        if let Some((from_gap, gap, pressure, x)) = worst {
            found.push(Warning::GapPressure { of: Subject::contact(model, k), pressure, from_gap: -from_gap, gap, x });
        }
    }
    found
}
