//! Interfaces whose integration is inexact, by [`crate::coupling::consistency`].

use super::warning::{Subject, Warning};
use crate::problem::model::Model;
use crate::problem::state::StepState;

/// Consistency error above which the warning is given.
const INEXACT: f64 = 1e-2;

/// Finds the ties and contacts whose integration is inexact.
pub(super) fn integration<const S: usize, const N: usize>(model: &Model<S, N>, state: &StepState<S, N>) -> Vec<Warning> {
    let ties = model.ties.iter().enumerate().map(|(k, tie)| (Subject::tie(model, k), tie.consistency(model, state)));
    let contacts = model.contacts.iter().zip(&state.contacts).enumerate();
    let contacts = contacts.map(|(k, (contact, built))| (Subject::contact(model, k), contact.consistency(model, built, state)));
    let poor = |(of, error)| (error > INEXACT).then_some(Warning::Integration { of, error });
    ties.chain(contacts).filter_map(poor).collect()
}
