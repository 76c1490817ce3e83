//! Constraint solver of a problem, and probes of what it can solve.

use super::system::empty;
use crate::constraint::{ActiveSet, ConstrainedSystem, ConstraintSolver, RowKind, SolveError};
use crate::linalg::Csr;

/// Constraint solver of a problem, kept from step to step.
#[derive(Debug)]
pub struct Solver {
    /// The solver, with an active set around it.
    pub(super) set: ActiveSet<Box<dyn ConstraintSolver>>,
    /// Whether the solver inside decides contact rows itself: then it is no part of an active set.
    pub(super) decides: bool,
}

impl Solver {
    /// Wraps a constraint solver; one that refuses contact rows gets an active set around it.
    pub fn new(mut inner: Box<dyn ConstraintSolver>) -> Self {
        let decides = decides_contact(&mut *inner);
        Self { set: ActiveSet::new(inner), decides }
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
