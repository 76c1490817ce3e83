//! Balance of the forces between bodies: action and reaction.

use super::model::Model;
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
