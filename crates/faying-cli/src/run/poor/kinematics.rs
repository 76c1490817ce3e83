//! Warning E065 if bodies deform or turn too far for small kinematics, whose error is about the square of strains and rotations.
//!
//! Strains grow without bound in corners and under loads at points, whatever is small elsewhere: a hundredth of a body must be beyond the
//! bound. A manufactured solution solves the equations of small kinematics whatever its size is.

use crate::case::Case;
use crate::errors::Diagnostic;
use crate::words::{percent, short};
use faying::problem::{Model, StepState};

/// Largest strain, and largest rotation in radians, of small kinematics.
const SMALL: f64 = 0.1;
/// Share of a body's volume that may be beyond it.
const LOCAL: f64 = 1e-2;

/// Returns at most one warning per patch.
pub fn warnings<const S: usize, const N: usize>(case: &Case, model: &Model<S, N>, state: &StepState<S, N>) -> Vec<Diagnostic> {
    if model.components != N || model.exact.is_some() {
        return Vec::new();
    }
    let of = |k: usize| {
        let (patch, block) = (&model.patches[k], &case.patches[k]);
        let found = patch.deformation(&state.u, SMALL);
        let what = [(&found.strain, "strains", ""), (&found.rotation, "rotations", " rad")].into_iter().filter(|(b, ..)| b.share > LOCAL);
        let list: Vec<String> = what
            .map(|(b, word, unit)| format!("{word} up to {}{unit}, beyond {SMALL} in {} % of it", short(b.largest), percent(b.share)))
            .collect();
        let text = format!("patch \"{}\" deforms too far for small kinematics: {}", patch.name, list.join("; "));
        let help = "load it less; lengths, moduli and forces may be in units that do not fit";
        (!list.is_empty()).then(|| Diagnostic::warning("E065", text).at(&case.source, block.head.at).with_help(help))
    };
    (0..model.patches.len()).filter_map(of).collect()
}
