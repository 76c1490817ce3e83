//! Constraint solver of a run, and small systems that test its capabilities.

use super::system::empty;
use crate::case;
use crate::registry::{Fault, Registry, SolverOptions, solver_name};
use crate::watch::Watch;
use faying::constraint::{ActiveSet, ConstrainedSystem, ConstraintSolver, RowKind, SolveError};
use faying::linalg::{Csr, Limits};

/// Constraint solver of a run, reused from step to step.
#[derive(Debug)]
pub struct Solver {
    pub(super) set: ActiveSet<Box<dyn ConstraintSolver>>,
    /// Whether the inner solver handles contact rows itself, without the active set.
    pub(super) decides: bool,
}

impl Solver {
    /// Creates the solver that `wanted` names, cancelled by `watch`, inside of an active set for contact rows it does not handle.
    ///
    /// # Errors
    /// [`Fault`] if the registry has none of this name, or the name and the other keys do not go together.
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

    /// Whether the solver refuses systems whose reaction differs from the constraint, tested by a system with one row.
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

    /// Whether the solver refuses more compliant rows than unknowns, tested by two rows on one unknown.
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

/// Whether a solver handles contact rows, tested by two springs pushed by 2 and 0, the first towards a wall at distance 1.
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
