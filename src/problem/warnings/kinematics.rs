//! Bodies that deform or turn too far for small kinematics, whose error is about the square of strains and rotations.
//!
//! Strains grow without bound in corners and under loads at points, whatever is small elsewhere: a hundredth of a body must be beyond the
//! bound. A manufactured solution solves the equations of small kinematics whatever its size is.

use super::warning::{Subject, Warning};
use crate::problem::Beyond;
use crate::problem::model::Model;
use crate::problem::state::StepState;

/// Largest strain, and largest rotation in radians, of small kinematics.
const SMALL: f64 = 0.1;
/// Rounding of strains and rotations, relative.
const ROUNDING: f64 = 1e-9;
/// Share of a body's volume that may be beyond it.
const LOCAL: f64 = 1e-2;

/// Finds the patches that deform too far.
pub(super) fn kinematics<const S: usize, const N: usize>(model: &Model<S, N>, state: &StepState<S, N>) -> Vec<Warning> {
    if model.components != N || model.has_exact() {
        return Vec::new();
    }
    let of = |k: usize| {
        let found = model.patches[k].deformation(&state.u, SMALL * (1.0 + ROUNDING));
        let [strain, rotation] = [found.strain, found.rotation].map(|b: Beyond| (b.share > LOCAL).then_some(b));
        let is_large = strain.is_some() || rotation.is_some();
        is_large.then(|| Warning::Kinematics { of: Subject::body(model, k), strain, rotation, allowed: SMALL })
    };
    (0..model.patches.len()).filter_map(of).collect()
}
