//! Ties whose multipliers are too coarse to hold their sides together.
//!
//! The functions of a multiplier make the jump of u vanish in their means, or leave what a [soft penalty](super::soft_penalty) leaves there.
//! Between them it stays: a multiplier that is constant on elements leaves the bend of the finer side free.

use super::soft_penalty::{bodies_of, held_apart, moved_by};
use super::warning::{Subject, Warning};
use crate::problem::model::Model;
use crate::problem::state::StepState;

/// Share of the largest displacement of the bodies that their sides may come apart on average.
const SHARE: f64 = 0.02;

/// Finds the ties of vectors whose sides come apart between the functions of their multipliers.
pub(super) fn coarse_ties<const S: usize, const N: usize>(model: &Model<S, N>, state: &StepState<S, N>) -> Vec<Warning> {
    let mut found = Vec::new();
    for (k, tie) in model.ties.iter().enumerate().filter(|(_, tie)| model.components == N && tie.parts.iter().any(|p| p.num_rows > 0)) {
        let (apart, moved) = (tie.mean_jump(model, &state.u), moved_by(model, state, &bodies_of(tie)));
        let between = (apart.powi(2) - held_apart(tie, &state.u).powi(2)).max(0.0).sqrt();
        if between > SHARE * moved && moved > 0.0 {
            found.push(Warning::CoarseTie { of: Subject::tie(model, k), apart: between, moved });
        }
    }
    found
}
