//! Restart with weak springs to the ground, for bodies held by contact alone if even partial steps leave them free.
//!
//! ```text
//! (K + δ diag K) u + Bᵀ lambda = f
//! ```
//!
//! is regular for every set of closed rows. If δ is small against the stiffness of the bodies, its active set is that of K. It is the
//! start of the iteration without springs, so that the solution contains none.

use super::super::{ActiveSetEvent, ActiveSetReport, ConstrainedSolution, ConstrainedSystem, ConstraintSolver, SolveError};
use super::{ActiveSet, SetIteration};
use crate::linalg::{Csr, Operator, Triplets, sum};

/// δ: far below the stiffness of a body, far above rounding.
const WEAK: f64 = 1e-7;

impl<C: ConstraintSolver<f64>> ActiveSet<C> {
    /// Restarts with springs, then without from the set found; `lost`: the error to return if this fails.
    pub(super) fn on_springs(
        &mut self,
        system: &ConstrainedSystem<'_, f64>,
        lost: SolveError,
        goes_on: &mut dyn FnMut(SetIteration) -> bool,
    ) -> Result<ConstrainedSolution<f64>, SolveError> {
        let (SolveError::RigidMotion { iteration, best, .. }, Some(stiffness)) = (&lost, held(system.stiffness)) else { return Err(lost) };
        let first = best.as_ref().and_then(|b| b.active_set.clone()).unwrap_or_default();
        let (start, near, most) = (std::mem::take(&mut self.start), std::mem::take(&mut self.near), self.max_iterations);
        let mut report = first;
        report.events.push(ActiveSetEvent::Springs { iteration: *iteration });
        let mut phase = |set: &mut Self, stiffness: &dyn Operator<f64>, report: &mut ActiveSetReport| {
            set.max_iterations = most.saturating_sub(report.iterations);
            let before = report.iterations;
            let news = &mut |news: SetIteration| goes_on(SetIteration { iteration: before + news.iteration, ..news });
            let mut solution = set.iterate(&ConstrainedSystem { stiffness, ..*system }, news)?;
            *report = solution.active_set.take().unwrap_or_default().after(report);
            Ok(solution)
        };
        let ended = phase(self, &stiffness, &mut report).and_then(|soft| {
            (self.start, self.near) = (soft.active, true);
            phase(self, system.stiffness, &mut report)
        });
        (self.start, self.near, self.max_iterations) = (start, near, most);
        match ended {
            Ok(solution) => Ok(ConstrainedSolution { active_set: Some(report), ..solution }),
            Err(SolveError::Stopped { iterations, best }) => Err(SolveError::Stopped { iterations: report.iterations + iterations, best }),
            Err(_) => Err(lost),
        }
    }
}

/// K + δ diag K; unknowns without stiffness get the largest spring. `None` if the operator has no matrix.
fn held(stiffness: &dyn Operator<f64>) -> Option<Csr<f64>> {
    let matrix = stiffness.csr()?;
    let diagonal = stiffness.diagonal();
    let largest = diagonal.iter().fold(0.0, |m: f64, d| m.max(d.abs()));
    let mut springs = Triplets::new(matrix.num_rows(), matrix.num_cols());
    for (i, &d) in diagonal.iter().enumerate() {
        springs.push(i, i, if d > 0.0 { d } else { largest });
    }
    Some(sum(1.0, matrix, WEAK, &springs.to_csr()).with_dof_coordinates(stiffness.dof_coordinates().to_vec()))
}
