//! Linear solvers behind one trait: prepare on an operator, solve, check the residual.

use super::{Operator, Real};
use std::fmt::Debug;

/// Error of a linear solver.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LinearError {
    /// The factorisation met a zero pivot, or the residual of the true system stayed large.
    #[error("the matrix is singular to working precision (relative residual {residual:.1e})")]
    Singular {
        /// Relative residual |b - A x| / (|A| |x| + |b|) that was reached.
        residual: f64,
    },
    /// A number in the matrix, the right-hand side or the solution is infinite or not a number.
    #[error("a value in the linear system is not finite")]
    NotFinite,
    /// An iterative method stopped before its tolerance.
    #[error("the iterative solver stopped after {iterations} iterations at relative residual {residual:.1e}, wanted {tolerance:.1e}")]
    NotConverged {
        /// Iterations done.
        iterations: usize,
        /// Relative residual reached.
        residual: f64,
        /// Relative residual wanted.
        tolerance: f64,
    },
    /// A direct solver was given an operator without a matrix.
    #[error("this solver needs a matrix, the operator has none; take an iterative solver")]
    NoMatrix,
    /// There is not enough memory for the factor, or an index overflows.
    #[error("the factorisation does not fit into memory; take a coarser mesh or an iterative solver")]
    Memory,
    /// A method for symmetric matrices was given a non-symmetric one.
    #[error("the matrix is not symmetric and this solver needs one that is; take a solver for non-symmetric systems")]
    NotSymmetric,
    /// A method for positive definite matrices was given an indefinite one.
    #[error("the matrix is not positive definite: {negative} directions have negative energy")]
    Indefinite {
        /// Number of negative eigenvalues.
        negative: usize,
    },
    /// Cancelled by the callback.
    #[error("the iterative solver was stopped after {iterations} iterations")]
    Stopped {
        /// Iterations done.
        iterations: usize,
    },
    /// Sizes disagree.
    #[error("the right-hand side has {found} entries, the operator {expected}")]
    Shape {
        /// Size of the operator.
        expected: usize,
        /// Size that was given.
        found: usize,
    },
}

/// Relative asymmetry, against the largest entries of the rows, that counts as rounding.
pub const NO_SYMMETRY: f64 = 1e-9;

/// A method for A x = b.
pub trait LinearSolver<T: Real = f64>: Debug + Send {
    /// Prepares for solves with `a`: a direct solver factorises; a pattern seen before keeps its symbolic analysis.
    ///
    /// # Errors
    /// [`LinearError`] if `a` cannot be prepared.
    fn prepare(&mut self, a: &dyn Operator<T>) -> Result<(), LinearError>;
    /// Solves for `x` (its content is the start value of iterative methods) and checks the residual on `a` itself.
    /// Returns the number of iterations or refinements.
    ///
    /// # Errors
    /// [`LinearError`] if no accurate solution was found.
    fn solve(&self, a: &dyn Operator<T>, b: &[T], x: &mut [T]) -> Result<usize, LinearError>;
}

impl<T: Real, X: LinearSolver<T> + ?Sized> LinearSolver<T> for Box<X> {
    fn prepare(&mut self, a: &dyn Operator<T>) -> Result<(), LinearError> {
        (**self).prepare(a)
    }
    fn solve(&self, a: &dyn Operator<T>, b: &[T], x: &mut [T]) -> Result<usize, LinearError> {
        (**self).solve(a, b, x)
    }
}
