//! Rounding that spoils the solution: its error is at most the condition number of the system times the rounding of a double.
//!
//! A hard body on a soft one moves with it as a whole, and its own stresses are small differences: the condition number grows with the
//! contrast of their moduli.

use super::warning::{Subject, Warning};
use crate::basis::Order;
use crate::geometry::{MapTable, cell};
use crate::problem::model::{BodyModel, Model};
use crate::problem::state::StepState;
use std::cmp::Ordering;

/// Bound of the relative error above which the warning is given.
const POOR: f64 = 1e-6;

/// Finds whether rounding is not small.
pub(super) fn rounding<const S: usize, const N: usize>(model: &Model<S, N>, state: &StepState<S, N>) -> Option<Warning> {
    let condition = state.condition?;
    let error = condition * f64::EPSILON / 2.0;
    if !condition.is_finite() || error <= POOR {
        return None;
    }
    let moduli: Vec<f64> = model.patches.iter().map(modulus).collect();
    let by = |order: Ordering| (0..moduli.len()).reduce(|a, b| if moduli[b].total_cmp(&moduli[a]) == order { b } else { a });
    let (hard, soft) = (by(Ordering::Greater)?, by(Ordering::Less)?);
    let contrast = moduli[hard] / moduli[soft];
    Some(Warning::Rounding { of: Subject::body(model, hard), soft: Subject::body(model, soft), contrast, condition, error })
}

/// The modulus in the middle of the first element.
fn modulus<const S: usize, const N: usize>(patch: &BodyModel<S, N>) -> f64 {
    let (space, mut table) = (&**patch.body.space(), MapTable::new());
    if space.num_elements() == 0 {
        return 0.0;
    }
    space.map(0, &[cell::center::<N, f64>(space.cell(0))], Order::Values, &mut table);
    patch.physics.modulus(&table.x[0])
}
