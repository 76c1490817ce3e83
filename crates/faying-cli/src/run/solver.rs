//! The constraint solver of a run, and what it is asked once to learn what it can do.

use super::system::empty;
use crate::case;
use crate::registry::{Fault, Registry, SolverOptions, solver_name};
use crate::watch::Watch;
use faying::constraint::{ActiveSet, ConstrainedSystem, ConstraintSolver, RowKind, SolveError};
use faying::linalg::{Csr, Limits};

/// The constraint solver of a run: what it learnt from a step serves the next ones.
#[derive(Debug)]
pub struct Solver {
    pub(super) set: ActiveSet<Box<dyn ConstraintSolver>>,
    /// Whether the solver inside decides contact rows itself: then it is no part of an active set.
    pub(super) decides: bool,
}

impl Solver {
    /// The solver that `wanted` names, stopped by `watch`. One that refuses contact rows gets an active set around it.
    ///
    /// # Errors
    /// [`Fault`] where the registry has none of this name, or the name and the other keys do not go together.
    pub fn new(registry: &Registry, wanted: &case::Solver, watch: &Watch) -> Result<Self, Fault> {
        let make = registry.solvers.get(solver_name(&wanted.constraint.value)).map_err(|e| Fault::new("E015", e.to_string()))?;
        let limits = Limits {
            tolerance: wanted.tolerance.value,
            max_iterations: wanted.max_iterations.map_or(0, |m| m.value),
            stop: watch.stop_sign(),
        };
        let mut inner = make(&SolverOptions { linear: wanted.linear.value, limits })?;
        let decides = decides_contact(&mut *inner);
        Ok(Self { set: ActiveSet::new(inner), decides })
    }

    /// Whether the solver refuses systems whose reaction differs from the constraint: asked of a system with one row.
    pub fn needs_symmetry(&mut self) -> bool {
        let (mut rows, stiffness) = (empty(1, 2), Csr::from_parts(2, vec![0, 1, 2], vec![0, 1], vec![1.0; 2]));
        rows.slave.push(0, 0, 1.0);
        let mut reaction = rows.clone();
        reaction.slave.push(0, 1, 0.5);
        let system = ConstrainedSystem {
            stiffness: &stiffness,
            load: &[0.0; 2],
            constraint: &rows,
            reaction: Some(&reaction),
            offset: &[-1.0],
            kind: &[RowKind::Equal],
            compliance: &[],
        };
        matches!(self.set.inner.solve(&system), Err(SolveError::NotSymmetric))
    }

    /// Whether the solver refuses soft rows of which there are more than unknowns: asked of two rows on one unknown.
    pub fn needs_independent_rows(&mut self) -> bool {
        let (mut rows, stiffness) = (empty(2, 1), Csr::from_parts(1, vec![0, 1], vec![0], vec![1.0]));
        rows.slave.push(0, 0, 1.0);
        rows.slave.push(1, 0, 1.0);
        let system = ConstrainedSystem {
            stiffness: &stiffness,
            load: &[1.0],
            constraint: &rows,
            reaction: None,
            offset: &[0.0; 2],
            kind: &[RowKind::Equal; 2],
            compliance: &[1.0; 2],
        };
        matches!(self.set.inner.solve(&system), Err(SolveError::OverConstrained { .. }))
    }
}

/// Whether a solver answers contact rows: asked of two springs pushed by 2 and 0, the first towards a wall at distance 1.
fn decides_contact(solver: &mut dyn ConstraintSolver) -> bool {
    let (mut rows, stiffness) = (empty(1, 2), Csr::from_parts(2, vec![0, 1, 2], vec![0, 1], vec![1.0; 2]));
    rows.slave.push(0, 0, -1.0);
    let system = ConstrainedSystem {
        stiffness: &stiffness,
        load: &[2.0, 0.0],
        constraint: &rows,
        reaction: None,
        offset: &[1.0],
        kind: &[RowKind::Contact],
        compliance: &[],
    };
    solver.solve(&system).is_ok()
}
