//! Balance of the forces between bodies: action and reaction.

use super::model::{ContactModel, ContactPart, Model, Opposing, TieModel};
use super::state::StepState;
use crate::contact::ContactRows;
use crate::coupling::Rows;

/// Sum of coupling forces on both bodies, which vanishes. Of bodies of revolution it is that along the axis: a radial translation strains them,
/// so that the fluxes in Nitsche's method do work on it.
#[derive(Debug, Default)]
pub(super) struct CouplingBalance {
    sum: [f64; 3],
    size: f64,
}

impl CouplingBalance {
    /// Adds a force on an unknown of the model.
    pub fn push<const S: usize, const N: usize>(&mut self, model: &Model<S, N>, unknown: usize, force: f64) {
        let of = model.patches.iter().find(|p| p.range().contains(&unknown));
        let component = of.map_or(0, |p| (unknown - p.field.first) % p.field.components);
        if component > 0 || !model.is_revolved() || model.components == 1 {
            self.sum[component] += force;
        }
        self.size += force.abs();
    }

    /// Adds the forces Cᵀ lambda of rows.
    pub fn add<const S: usize, const N: usize>(&mut self, model: &Model<S, N>, rows: &Rows, lambda: &[f64]) {
        for &(i, j, value) in rows.slave.entries.iter().chain(&rows.master.entries) {
            self.push(model, j, value * lambda[i]);
        }
    }

    /// The sum of the forces on both bodies [force].
    pub fn sum(&self) -> [f64; 3] {
        self.sum
    }

    /// The largest component of the sum, as a share of all forces.
    pub fn defect(&self) -> f64 {
        if self.size > 0.0 { self.sum.iter().fold(0.0, |m: f64, d| m.max(d.abs())) / self.size } else { 0.0 }
    }
}

impl<const S: usize, const N: usize> TieModel<S, N> {
    /// The forces of its rows on both bodies.
    pub(super) fn row_balance(&self, model: &Model<S, N>, state: &StepState<S, N>) -> CouplingBalance {
        let mut balance = CouplingBalance::default();
        for part in &self.parts {
            let lambda = &state.lambda[part.first_row..part.first_row + part.num_rows];
            balance.add(model, part.reaction.as_ref().unwrap_or(&part.rows), lambda);
        }
        balance
    }
}

impl<const S: usize, const N: usize> ContactModel<S, N> {
    /// The forces of the rows `built` for its parts on both bodies; those against obstacles have no counterpart and are left out.
    pub(super) fn row_balance(&self, model: &Model<S, N>, built: &[ContactRows<S, N>], state: &StepState<S, N>) -> CouplingBalance {
        let mut balance = CouplingBalance::default();
        let between = |part: &ContactPart<S, N>| matches!(part.against, Opposing::Side(..));
        for (part, rows) in self.parts.iter().zip(built).filter(|(part, _)| between(part)) {
            balance.add(model, rows.reaction.as_ref().unwrap_or(&rows.rows), &state.lambda[part.rows()]);
        }
        balance
    }
}
