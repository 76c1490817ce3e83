//! Contacts that pull at points.
//!
//! The cones of weights and of values hold means and points of the multiplier alone: between these it may change its sign. A tenth of the
//! largest pressure is what a polynomial has beside the end of a zone; beside an edge, where pressures are unbounded, it may be a half, and
//! does not fall with the elements. With -p the least and P the largest pressure at the points of the contact, the warning is given if
//!
//! ```text
//! p > 0.2 P
//! ```

use super::warning::{Subject, Warning};
use crate::contact::Cone;
use crate::problem::model::Model;
use crate::problem::state::StepState;

/// Least p / P.
const PULLS: f64 = 0.2;

/// Finds the contacts that pull.
pub(super) fn tensions<const S: usize, const N: usize>(model: &Model<S, N>, state: &StepState<S, N>) -> Vec<Warning> {
    let mut found = Vec::new();
    for (k, (contact, built)) in model.contacts.iter().zip(&state.contacts).enumerate() {
        let parts = contact.parts.iter().zip(built).filter(|(part, _)| part.multiplier.is_some() && part.cone != Cone::Coefficients);
        let [mut least, mut largest] = [0.0_f64; 2];
        for (part, rows) in parts {
            let carried = part.transmitted(rows, &state.lambda[part.rows()]);
            least = least.min(carried.least_pressure);
            largest = largest.max(carried.largest_pressure);
        }
        if largest > 0.0 && -least > PULLS * largest {
            found.push(Warning::Tension { of: Subject::contact(model, k), least, largest });
        }
    }
    found
}
