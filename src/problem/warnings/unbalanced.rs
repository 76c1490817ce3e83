//! Mixed integration whose lack of balance springs have to take.
//!
//! The forces of mixed integration on slave and master differ by the error of its two rules. Where supports hold the bodies, they take the difference
//! F. Where springs of the stiffness K alone do, it moves all bodies that hang together by F / K, however small it is beside the forces.

use super::hardly_held::{HeldBySprings, held_by_springs};
use super::soft_penalty::moved_by;
use super::warning::{Subject, Warning};
use crate::linalg::Union;
use crate::problem::model::{ContactModel, Model, TieModel};
use crate::problem::state::StepState;
use nalgebra::DVector;

/// Share of the largest displacement that a motion by lack of balance may have.
const SHARE: f64 = 0.02;
/// Motions that differ from those that springs hold by more than this are held by supports.
const HELD: f64 = 1e-6;

/// Finds the ties and contacts by mixed integration whose forces move the bodies.
pub(super) fn unbalanced<const S: usize, const N: usize>(model: &Model<S, N>, state: &StepState<S, N>) -> Vec<Warning> {
    let sums = sums(model, state);
    if sums.is_empty() || model.is_revolved() {
        return Vec::new();
    }
    let Some(held) = held_by_springs(model, state.t) else { return Vec::new() };
    let joined = joined(model, &held);
    let mut found = Vec::new();
    for (of, slave, sum) in sums {
        let own: Vec<usize> = (0..model.patches.len()).filter(|&k| joined[k] == joined[slave]).collect();
        let mut moved = 0.0_f64;
        for (component, force) in sum.iter().enumerate().take(model.components) {
            let mut motion = DVector::<f64>::zeros(held.left.nrows());
            own.iter().for_each(|&k| motion[held.bodies.of_patch(k) * held.modes.modes() + component] = 1.0);
            let rest = &motion - &held.left * (held.left.transpose() * &motion);
            if rest.norm() <= HELD * motion.norm() {
                moved = moved.max(force.abs() / (motion.transpose() * &held.stiffness * &motion)[0]);
            }
        }
        if moved > SHARE * moved_by(model, state, &own) {
            found.push(Warning::Unbalanced { of, moved });
        }
    }
    found
}

/// Ties and contacts with mixed integration, the patch of their first slave side, and the sum of the forces on both bodies.
fn sums<const S: usize, const N: usize>(model: &Model<S, N>, state: &StepState<S, N>) -> Vec<(Subject, usize, [f64; 3])> {
    let is_mixed = |tie: &TieModel<S, N>| tie.parts.iter().any(|part| part.pairings.iter().any(|p| p.second.is_some()));
    let ties = model.ties.iter().enumerate().filter(|(_, tie)| is_mixed(tie));
    let ties = ties.map(|(k, tie)| (Subject::tie(model, k), tie.parts[0].slave.patch, tie.row_balance(model, state).sum()));
    let contacts = model.contacts.iter().zip(&state.contacts).enumerate();
    let contacts = contacts.filter(|(_, (contact, _))| contact.parts.iter().any(|part| part.second.is_some()));
    let sum = |contact: &ContactModel<S, N>, built| contact.row_balance(model, built, state).sum();
    let contacts = contacts.map(|(k, (contact, built))| (Subject::contact(model, k), contact.parts[0].slave.patch, sum(contact, built)));
    ties.chain(contacts).collect()
}

/// For each patch the number of the bodies that ties and contacts join with its own.
fn joined<const S: usize, const N: usize>(model: &Model<S, N>, held: &HeldBySprings<N>) -> Vec<usize> {
    let mut joined = Union::new(held.modes.num_bodies());
    let body = |patch: usize| held.bodies.of_patch(patch);
    for part in model.ties.iter().flat_map(|tie| &tie.parts) {
        part.pairings.iter().flat_map(|p| &p.master.runs).for_each(|run| joined.unite(body(part.slave.patch), body(run.1)));
    }
    for part in model.contacts.iter().flat_map(|contact| &contact.parts) {
        part.masters.iter().for_each(|master| joined.unite(body(part.slave.patch), body(master.patch)));
    }
    (0..model.patches.len()).map(|k| joined.root(body(k))).collect()
}
