//! Penalties that let bodies sink into each other, or come apart, by more than a hundredth of their size or a tenth of their displacement.
//!
//! What counts is the mean over every function of the multiplier: of a tie g_j = ∫ ψ_j [u] / ∫ ψ_j, which a stiffer penalty makes smaller. What
//! the sides come apart between these functions, no penalty changes ([`coarse_tie`](super::coarse_tie)).

use super::warning::{Subject, Warning};
use crate::problem::model::{Model, TieModel};
use crate::problem::state::StepState;

/// Share of the smaller body's size that bodies may sink.
const DEEP: f64 = 1e-2;
/// Share of the bodies' largest displacement that they may sink, or that a tie may come apart.
const SHARE: f64 = 0.1;

/// Finds the contacts and ties whose penalty is too soft.
pub(super) fn soft_penalties<const S: usize, const N: usize>(model: &Model<S, N>, state: &StepState<S, N>) -> Vec<Warning> {
    let mut found = Vec::new();
    let warning = |of: Subject, apart: f64, patches: &[usize]| {
        let size = patches.iter().filter_map(|k| model.patches[*k].extent).map(|b| b.diagonal()).fold(f64::INFINITY, f64::min);
        let moved = moved_by(model, state, patches);
        (apart > DEEP * size || apart > SHARE * moved && moved > 0.0).then_some(Warning::SoftPenalty { of, apart, size, moved })
    };
    for (k, contact) in model.contacts.iter().enumerate().filter(|(_, c)| c.is_soft()) {
        let patches: Vec<usize> = contact.parts.iter().flat_map(|p| p.masters.iter().chain([&p.slave])).map(|s| s.patch).collect();
        let depth = -contact.least_gap(model, &state.contacts[k], &state.u);
        found.extend(warning(Subject::contact(model, k), depth, &patches));
    }
    let soft = |tie: &TieModel<S, N>| model.components == N && tie.parts.iter().any(|p| p.penalty.is_some());
    for (k, tie) in model.ties.iter().enumerate().filter(|(_, tie)| soft(tie)) {
        found.extend(warning(Subject::tie(model, k), held_apart(tie, &state.u), &bodies_of(tie)));
    }
    found
}

/// The bodies of a tie.
pub(super) fn bodies_of<const S: usize, const N: usize>(tie: &TieModel<S, N>) -> Vec<usize> {
    tie.parts.iter().flat_map(|p| p.pairings.iter().map(|m| m.master.patch).chain([p.slave.patch])).collect()
}

/// The largest component of the displacement of `patches`.
pub(super) fn moved_by<const S: usize, const N: usize>(model: &Model<S, N>, state: &StepState<S, N>, patches: &[usize]) -> f64 {
    patches.iter().flat_map(|k| &state.u[model.patches[*k].range()]).fold(0.0, |m, u| m.max(u.abs()))
}

/// The mean distance of the sides of a tie that its rows leave: the root of Σ w_j |g_j|² / |Γ|, w_j = ∫ ψ_j; zero without mortar rows.
pub(super) fn held_apart<const S: usize, const N: usize>(tie: &TieModel<S, N>, u: &[f64]) -> f64 {
    let mut sum = 0.0;
    for part in &tie.parts {
        let rows = part.num_rows;
        let mut jumps = vec![0.0; rows];
        for &(row, unknown, value) in part.rows.slave.entries.iter().chain(&part.rows.master.entries) {
            jumps[row] += value * u[unknown];
        }
        let mut weights = vec![0.0; rows];
        for of_master in &part.function_sums {
            of_master.iter().zip(&mut weights).for_each(|(own, weight)| *weight += own.sum);
        }
        sum += jumps.iter().zip(&weights).filter(|(_, w)| **w > 0.0).map(|(jump, w)| jump * jump / w).sum::<f64>();
    }
    (sum / tie.measure()).sqrt()
}
