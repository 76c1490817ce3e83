//! Ties across a gap that lose moments: equal and opposite forces on sides that are apart make a couple that nothing carries.

use super::warning::{Subject, Warning};
use crate::geometry::Geometry;
use crate::problem::model::Model;
use crate::problem::state::StepState;

/// Lost moment over the force through the tie times half its size, above which the warning is given.
const LOST: f64 = 1e-3;
/// Forces below this share of the modulus times displacement and size are rounding.
const ROUNDING: f64 = 1e-12;

/// Finds the ties that lose moments.
pub(super) fn lost_moments<const S: usize, const N: usize>(model: &Model<S, N>, state: &StepState<S, N>) -> Vec<Warning> {
    if model.is_revolved() {
        return Vec::new();
    }
    let mut found = Vec::new();
    if model.components != N {
        return found;
    }
    for (k, tie) in model.ties.iter().enumerate() {
        let (mut moment, mut force) = ([0.0; 3], 0.0);
        for part in &tie.parts {
            let lost = part.lost_moment(model, state);
            moment.iter_mut().zip(lost.moment).for_each(|(sum, m)| *sum += m);
            force += lost.force;
        }
        let sides = tie.parts.iter().filter_map(|part| part.slave.trace.space.extent());
        let size = 0.5 * sides.reduce(|a, b| a.union(&b)).map_or(0.0, |b| b.diagonal());
        let lost = moment.iter().map(|m| m * m).sum::<f64>().sqrt();
        let stiff = tie.parts.iter().map(|part| {
            let patch = &model.patches[part.slave.patch];
            patch.physics_at(state.t).modulus(&patch.extent.map_or(model.center, |b| b.center()))
        });
        let moved = state.u.iter().fold(0.0_f64, |most, u| most.max(u.abs()));
        let rounding = ROUNDING * stiff.fold(0.0, f64::max) * moved * size.powi(N as i32 - 2);
        if force <= rounding || lost <= LOST * force * size {
            continue;
        }
        let apart = tie.parts.iter().flat_map(|part| &part.pairings).map(|p| p.segments.report.distance).fold(0.0, f64::max);
        found.push(Warning::LostMoment { of: Subject::tie(model, k), apart, moment: lost, share: lost / (force * size) });
    }
    found
}
