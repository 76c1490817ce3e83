//! Penalties that let bodies sink into each other, or come apart, by more than a hundredth of their size or a tenth of their displacement.

use super::warning::{Subject, Warning};
use crate::problem::model::{Model, TieModel};
use crate::problem::state::StepState;

/// Share of the smaller body's size that bodies may sink.
const DEEP: f64 = 1e-2;
/// Share of the bodies' largest displacement that they may sink.
const SHARE: f64 = 0.1;

/// Finds the contacts and ties whose penalty is too soft.
pub(super) fn soft_penalties<const S: usize, const N: usize>(model: &Model<S, N>, state: &StepState<S, N>) -> Vec<Warning> {
    let mut found = Vec::new();
    let warning = |of: Subject, apart: f64, patches: &[usize]| {
        let size = patches.iter().filter_map(|k| model.patches[*k].extent).map(|b| b.diagonal()).fold(f64::INFINITY, f64::min);
        let moved = patches.iter().flat_map(|k| &state.u[model.patches[*k].range()]).fold(0.0_f64, |m, u| m.max(u.abs()));
        (apart > DEEP * size || apart > SHARE * moved && moved > 0.0).then_some(Warning::SoftPenalty { of, apart, size, moved })
    };
    for (k, contact) in model.contacts.iter().enumerate().filter(|(_, c)| c.is_soft()) {
        let patches: Vec<usize> = contact.parts.iter().flat_map(|p| p.masters.iter().chain([&p.slave])).map(|s| s.patch).collect();
        let depth = -contact.least_gap(model, &state.contacts[k], &state.u);
        found.extend(warning(Subject::contact(model, k), depth, &patches));
    }
    let soft = |tie: &TieModel<S, N>| model.components == N && tie.parts.iter().any(|p| p.penalty.is_some());
    for (k, tie) in model.ties.iter().enumerate().filter(|(_, tie)| soft(tie)) {
        let patches: Vec<usize> = tie.parts.iter().flat_map(|p| p.pairings.iter().map(|m| m.master.patch).chain([p.slave.patch])).collect();
        let measure: f64 = tie.parts.iter().flat_map(|p| &p.pairings).map(|p| p.segments.measure()).sum();
        found.extend(warning(Subject::tie(model, k), tie.jumps(model, &state.u).0 / measure.sqrt(), &patches));
    }
    found
}
