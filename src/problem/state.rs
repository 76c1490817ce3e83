//! States of a problem, and errors of steps without one.

use super::handles::{ContactId, Statement};
use super::loads::LoadSum;
use super::resultant::Resultant;
use crate::assembly::{DirichletError, ReductionError};
use crate::constraint::SolveError;
use crate::contact::{ContactError, ContactRows};
use crate::coupling::CouplingError;
use std::error::Error;
use std::fmt::{Debug, Display, Formatter};

/// Sign case of rows without one: of ties, and of contact rows that face nothing.
pub(super) const NO_CONTACT: u8 = 9;

/// The solution of a step.
#[derive(Debug)]
pub struct StepState<const S: usize, const N: usize> {
    /// Its time.
    pub t: f64,
    /// All unknowns.
    pub u: Vec<f64>,
    /// One multiplier per row: coefficients of lambda.
    pub lambda: Vec<f64>,
    /// Multipliers in the variables of the solver, one per row: of contacts those of their cone, lambda = T mu; of ties lambda.
    pub mu: Vec<f64>,
    /// Whether each row is enforced.
    pub active: Vec<bool>,
    /// Rows, weights and points of every contact part at this time.
    pub contacts: Vec<Vec<ContactRows<S, N>>>,
    /// Reactions of supports on the bodies, per unknown.
    pub support: Vec<f64>,
    /// Sum of all loads, springs included.
    pub load: Resultant,
    /// Resultant of every load, as integrated.
    pub loads: Vec<LoadSum>,
    /// Number of unknowns that are free.
    pub free: usize,
    /// Relative residual.
    pub residual: f64,
    /// Condition number of the scaled system, if a factor provides it.
    pub condition: Option<f64>,
    /// Description of the linear algebra.
    pub method: String,
    /// Iterations of the linear algebra, 0 if everything was done by factors.
    pub iterations: usize,
    /// Number of factorisations of whole systems.
    pub factors: usize,
    /// The active set, where there is contact.
    pub active_set: Option<crate::constraint::ActiveSetReport>,
    /// Sign case 0 to 8 of every row; 9 for rows of ties.
    pub sign_case: Vec<u8>,
}

/// Error of a step without solution.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum StepError {
    /// Prescribed values could not be projected.
    #[error(transparent)]
    Dirichlet(#[from] DirichletError),
    /// Conditions contradict each other.
    #[error(transparent)]
    Reduction(#[from] ReductionError),
    /// A tie has no stiffness at this time.
    #[error(transparent)]
    Coupling(#[from] CouplingError),
    /// A contact could not be set up at this time.
    #[error(transparent)]
    Contact(#[from] ContactError),
    /// No contact pressure balances the loads.
    #[error("infeasible load: {what}")]
    Infeasible {
        /// Sentence with the body, its motion, and the missing force.
        what: String,
    },
    /// Prescribed values hold a slave side within what it faces, where no pressure moves it.
    #[error("infeasible contact: {what}")]
    Blocked {
        /// The contact.
        contact: ContactId,
        /// The slave side, by its place in the statement.
        slave: usize,
        /// The statements that prescribe the values.
        of: Vec<Statement>,
        /// Sentence with the side, the depth, what it faces, and where.
        what: String,
    },
    /// No contact pressure of these multipliers balances the loads, though forces at the ends of the sides would.
    #[error("the contact side is too coarse for its load: {what}")]
    Coarse {
        /// Sentence with the body, its motion, and the missing force.
        what: String,
    },
    /// An answer to a linearised system of another problem.
    #[error("the linearised system is one of another system")]
    OtherSystem,
    /// The system was not solved.
    #[error(transparent)]
    Solve(#[from] SolveError),
    /// A body that contact held can move: every contact that held it has opened.
    #[error("{}", .motions.join("; "))]
    Free {
        /// A sentence per body.
        motions: Vec<String>,
    },
    /// Obstacles that forces press did not come to rest.
    #[error("an obstacle that a force presses does not come to rest: contact was built at {places} places")]
    Obstacle {
        /// Number of places.
        places: usize,
    },
}

/// An error of a step, with the best state that was reached: a [`Solution`](super::Solution).
///
/// Its texts, `{}` and `{:?}`, are the sentence of the error alone.
pub struct Unsolved<L> {
    /// The error.
    pub error: StepError,
    /// The best state of the iteration, the last one where none is better; `None` if there is no state.
    pub best: Option<L>,
}

impl<L> Unsolved<L> {
    /// Keeps the error with another form of the state.
    pub(super) fn map<M>(self, form: impl FnOnce(L) -> M) -> Unsolved<M> {
        Unsolved { error: self.error, best: self.best.map(form) }
    }
}

impl<L> Display for Unsolved<L> {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        Display::fmt(&self.error, f)
    }
}

impl<L> Debug for Unsolved<L> {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        Display::fmt(&self.error, f)
    }
}

impl<L> Error for Unsolved<L> {
    fn source(&self) -> Option<&(dyn Error + 'static)> {
        Some(&self.error)
    }
}

impl<L, E: Into<StepError>> From<E> for Unsolved<L> {
    fn from(error: E) -> Self {
        Self { error: error.into(), best: None }
    }
}
