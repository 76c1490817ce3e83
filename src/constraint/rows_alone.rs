//! Contact rows alone: multipliers and gaps of any set from the Schur complement, without the unknowns.
//!
//! ```text
//! (S + diag d) nu = h - b      d, b, lambda of closed and open rows as in super::interface
//! gap of open rows: g - nu / W
//! ```
//!
//! Rows may be groups: sums of neighbouring rows of the system, which share one multiplier. A set costs a dense factor of the rows. Its
//! answers are not refined: they choose sets, whose systems are solved and checked as a whole.

use super::{Abilities, ConstrainedSolution, ConstrainedSystem, ConstraintSolver, RowKind, SolveError};
use crate::linalg::{Buffer, DenseLdlt, LinearError};
use std::sync::Arc;

/// A pivot below this part of its entry belongs to a rigid motion that the set leaves.
const LOST: f64 = 1e-12;

/// Contact rows of a system, or groups of them, without the unknowns.
#[derive(Debug)]
pub struct RowsAlone {
    /// S, column after column; the lower triangle is set.
    pub(super) complement: Arc<Buffer<f64>>,
    /// The rows.
    pub(super) rows: Vec<ScaledRow>,
    pub(super) dense: DenseLdlt,
}

/// A row in scaled units.
#[derive(Clone, Copy, Debug)]
pub(super) struct ScaledRow {
    /// h: C u without multipliers.
    pub load: f64,
    /// W.
    pub spring: f64,
    /// t: compliance and regularisation.
    pub soft: f64,
    /// g.
    pub offset: f64,
    /// Factor of the row: lambda is that of the scaled row times it, the gap is divided by it.
    pub factor: f64,
}

impl RowsAlone {
    /// Multipliers and gaps of a set, in the units of the system.
    fn of_set(&mut self, closed: &[bool]) -> Result<(Vec<f64>, Vec<f64>), LinearError> {
        let (m, rows, complement) = (self.rows.len(), &self.rows, &self.complement);
        let share = |row: &ScaledRow| 1.0 - row.soft * row.spring;
        let diagonal = |i: usize| if closed[i] { rows[i].soft / share(&rows[i]) } else { -1.0 / rows[i].spring };
        self.dense.eliminate(m, m, |i, j| complement[j * m + i] + if i == j { diagonal(i) } else { 0.0 })?;
        for (i, pivot) in self.dense.pivots().enumerate() {
            let lost = LOST * (complement[i * (m + 1)].abs() + diagonal(i).abs());
            if !(if closed[i] { pivot > lost } else { pivot < -lost }) {
                return Err(LinearError::Singular { residual: 1.0 });
            }
        }
        let mut nu: Vec<f64> =
            rows.iter().zip(closed).map(|(row, &closed)| row.load + if closed { row.offset / share(row) } else { 0.0 }).collect();
        self.dense.solve(&mut nu);
        let of = |((row, nu), &closed): ((&ScaledRow, &f64), &bool)| {
            if closed {
                let lambda = (nu - row.spring * row.offset) / share(row);
                (row.factor * lambda, row.soft * lambda / row.factor)
            } else {
                (0.0, (row.offset - nu / row.spring) / row.factor)
            }
        };
        Ok(rows.iter().zip(&nu).zip(closed).map(of).unzip())
    }
}

impl ConstraintSolver<f64> for RowsAlone {
    fn abilities(&self) -> Abilities {
        Abilities { more_rows_than_unknowns: true, ..Abilities::default() }
    }

    fn solve(&mut self, system: &ConstrainedSystem<'_, f64>) -> Result<ConstrainedSolution<f64>, SolveError> {
        let active: Vec<bool> = system.kind.iter().map(|kind| *kind == RowKind::Equal).collect();
        let (multipliers, gap) = self.of_set(&active)?;
        // no unknowns are solved for
        let unknowns = vec![0.0; system.stiffness.size()];
        Ok(ConstrainedSolution { unknowns, multipliers, gap, active, ..ConstrainedSolution::default() })
    }
}
