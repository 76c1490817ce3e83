//! Penalties that let bodies sink into each other, or come apart, by more than a hundredth of their size.

use super::warning::{Subject, Warning};
use crate::problem::model::{Model, TieModel};
use crate::problem::state::StepState;

/// Share of the smaller body's size that bodies may sink.
const DEEP: f64 = 1e-2;

/// Finds the contacts and ties whose penalty is too soft.
pub(super) fn soft_penalties<const S: usize, const N: usize>(model: &Model<S, N>, state: &StepState<S, N>) -> Vec<Warning> {
    let mut found = Vec::new();
    let size = |patches: &mut dyn Iterator<Item = usize>| {
        patches.filter_map(|k| model.patches[k].extent).map(|b| b.diagonal()).fold(f64::INFINITY, f64::min)
    };
    for (k, contact) in model.contacts.iter().enumerate().filter(|(_, c)| c.is_soft()) {
        let size = size(&mut contact.parts.iter().flat_map(|p| p.masters.iter().chain([&p.slave])).map(|s| s.patch));
        let depth = -contact.least_gap(model, &state.contacts[k], &state.u);
        if depth > DEEP * size {
            found.push(Warning::SoftPenalty { of: Subject::contact(model, k), apart: depth, size });
        }
    }
    let soft = |tie: &TieModel<S, N>| model.components == N && tie.parts.iter().any(|p| p.penalty.is_some());
    for (k, tie) in model.ties.iter().enumerate().filter(|(_, tie)| soft(tie)) {
        let size = size(&mut tie.parts.iter().flat_map(|p| p.pairings.iter().map(|m| m.master.patch).chain([p.slave.patch])));
        let measure: f64 = tie.parts.iter().flat_map(|p| &p.pairings).map(|p| p.segments.measure()).sum();
        let jump = tie.jumps(model, &state.u).0 / measure.sqrt();
        if jump > DEEP * size {
            found.push(Warning::SoftPenalty { of: Subject::tie(model, k), apart: jump, size });
        }
    }
    found
}
