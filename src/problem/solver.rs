//! Constraint solver of a problem.

use crate::constraint::{Abilities, ActiveSet, ConstraintSolver};

/// Constraint solver of a problem, kept from step to step.
#[derive(Debug)]
pub struct ProblemSolver {
    /// The solver, with an active set around it.
    pub(super) set: ActiveSet<Box<dyn ConstraintSolver>>,
}

impl ProblemSolver {
    /// Wraps a constraint solver; one that refuses contact rows gets an active set around it.
    pub fn new(inner: Box<dyn ConstraintSolver>) -> Self {
        Self { set: ActiveSet::new(inner) }
    }

    /// Returns the abilities of the solver, without the active set.
    pub fn abilities(&self) -> Abilities {
        self.set.inner.abilities()
    }
}
