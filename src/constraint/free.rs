//! Systems whose rows are all soft: their multipliers are eliminated, and an unconstrained system is left.
//!
//! ```text
//! lambda = s⁻¹ (C u + g),   (K + Cᵀ s⁻¹ C) u = f - Cᵀ s⁻¹ g
//! ```

use super::penalised::{inverse_diagonal, penalised, refuse_motions};
use super::scale::{Scaled, gaps};
use super::{Abilities, ConstrainedSolution, ConstrainedSystem, ConstraintSolver, SolveError};
use crate::linalg::residual::RESIDUAL_LIMIT;
use crate::linalg::{Cg, Csr, Ldlt, Limits, LinearError, LinearSolver};

/// Limit of corrections, needed if springs much stiffer than the bodies cost digits.
const MAX_CORRECTIONS: usize = 5;
/// Residual at rounding level.
const ENOUGH: f64 = 1e-14;

/// Solver of systems without exact rows by any solver of symmetric positive definite matrices; needs B = C.
///
/// Wrap it in [`Augmented`](super::Augmented) for exact rows.
#[derive(Debug)]
pub struct PenaltyElimination<L> {
    /// Solves with K + Cᵀ s⁻¹ C.
    pub linear: L,
    krylov: bool,
    /// Largest relative residual of its answers.
    tolerance: f64,
    /// The matrix that `linear` is prepared for.
    matrix: Option<Csr<f64>>,
    /// Number of factors so far.
    factors: usize,
}

impl PenaltyElimination<Ldlt> {
    /// Creates a solver that uses a factor.
    pub fn new() -> Self {
        Self { linear: Ldlt::new(), krylov: false, tolerance: RESIDUAL_LIMIT, matrix: None, factors: 0 }
    }
}

impl Default for PenaltyElimination<Ldlt> {
    fn default() -> Self {
        Self::new()
    }
}

impl PenaltyElimination<Cg> {
    /// Creates a solver that uses conjugate gradients with symmetric Gauss-Seidel sweeps.
    pub fn iterative(limits: &Limits) -> Self {
        let mut linear = Cg::new(limits.tolerance).with_gauss_seidel();
        linear.max_iterations = limits.max_iterations;
        linear.stop = limits.stop.clone();
        Self { linear, krylov: true, tolerance: limits.tolerance, matrix: None, factors: 0 }
    }
}

impl<L: LinearSolver<f64>> ConstraintSolver<f64> for PenaltyElimination<L> {
    fn abilities(&self) -> Abilities {
        Abilities { more_rows_than_unknowns: true, ..Abilities::default() }
    }

    fn tolerance(&self) -> f64 {
        self.tolerance
    }

    fn factors(&self) -> usize {
        self.factors
    }

    fn solve(&mut self, system: &ConstrainedSystem<'_, f64>) -> Result<ConstrainedSolution<f64>, SolveError> {
        let s = Scaled::of(system)?;
        s.need_symmetry()?;
        let (n, m) = (s.num_unknowns(), s.num_rows());
        if let Some(row) = (0..m).find(|&a| s.enforced[a] && s.compliance[a] <= 0.0) {
            return Err(SolveError::ExactRow { row });
        }
        let w: Vec<f64> = (0..m).map(|a| if s.enforced[a] { 1.0 / s.compliance[a] } else { 0.0 }).collect();
        let matrix = penalised(&s, &s.columns, &w, system.stiffness.dof_coordinates());
        if self.matrix.as_ref() != Some(&matrix) {
            self.matrix = None;
            self.linear.prepare(&matrix)?;
            self.factors += usize::from(!self.krylov);
            if self.krylov {
                refuse_motions(&matrix, &inverse_diagonal(&matrix)?, &Limits::default())?;
            }
            self.matrix = Some(matrix);
        }
        let matrix = self.matrix.as_ref().expect("prepared above");
        let scale: Vec<f64> = s.diagonal.iter().map(|d| if *d != 0.0 { 1.0 / d.abs() } else { 1.0 }).collect();
        let (mut u, mut l, mut done) = (vec![0.0; n], vec![0.0; m], 0);
        let (mut r1, mut r2) = (u.clone(), l.clone());
        let mut residual = s.residual(&scale, &u, &l, &mut r1, &mut r2);
        for _ in 0..MAX_CORRECTIONS {
            if residual <= ENOUGH {
                break;
            }
            let pushed: Vec<f64> = (0..m).map(|a| w[a] * r2[a]).collect();
            let mut b = r1.clone();
            s.rows.add_transposed_mul(&pushed, &mut b);
            let mut du = vec![0.0; n];
            done += self.linear.solve(matrix, &b, &mut du)?;
            let mut moved = vec![0.0; m];
            s.rows.mul(&du, &mut moved);
            for i in 0..n {
                u[i] += du[i];
            }
            for a in 0..m {
                l[a] += w[a] * (moved[a] - r2[a]);
            }
            residual = s.residual(&scale, &u, &l, &mut r1, &mut r2);
            if self.krylov {
                // its accuracy was asked for
                break;
            }
        }
        if !self.krylov && (residual.is_nan() || residual > RESIDUAL_LIMIT) {
            return Err(LinearError::Singular { residual: if residual.is_finite() { residual } else { 1.0 } }.into());
        }
        Ok(ConstrainedSolution {
            gap: gaps(system, &u),
            unknowns: u,
            multipliers: (0..m).map(|a| s.factor[a] * l[a]).collect(),
            active: s.enforced,
            residual,
            condition: None,
            method: if self.krylov { "conjugate gradients" } else { "direct" }.into(),
            iterations: if self.krylov { done } else { 0 },
            active_set: None,
        })
    }
}
