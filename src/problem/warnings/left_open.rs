//! Slave sides of which the exact solution leaves open which of its pieces they have: errors of lambda have no value there.

use super::warning::{Subject, Warning};
use crate::problem::model::Model;
use crate::problem::state::StepState;

/// Finds the ties and contacts with such sides.
pub(super) fn left_open<const S: usize, const N: usize>(model: &Model<S, N>, state: &StepState<S, N>) -> Vec<Warning> {
    if !model.has_exact() || !model.patches.iter().any(|p| p.exact.as_ref().is_some_and(|exact| exact.is_piecewise())) {
        return Vec::new();
    }
    let ties = model.ties.iter().enumerate().filter(|(_, tie)| tie.exact.is_none());
    let ties = ties.map(|(k, tie)| (Subject::tie(model, k), tie.lambda_error(model, state)));
    let contacts = model.contacts.iter().zip(&state.contacts).enumerate().filter(|(_, (contact, _))| contact.exact.is_none());
    let contacts = contacts.map(|(k, (contact, built))| (Subject::contact(model, k), contact.lambda_error(model, built, state)));
    ties.chain(contacts).filter(|(_, error)| error.error.is_nan()).map(|(of, _)| Warning::LeftOpen { of }).collect()
}
