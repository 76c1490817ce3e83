//! Solution of a step.

use super::at_rest::at_rest;
use super::matrices::Matrices;
use super::model::Model;
use super::observer::Observer;
use super::solver::ProblemSolver;
use super::state::{StepError, StepState, Unsolved};
use crate::constraint::SolveError;

/// Solves the model at time `t` with the matrices of its bodies at that time.
///
/// The active set starts as it ended in `before`. Where that leads nowhere it starts again as [`ContactModel`](super::ContactModel) says: a
/// set that holds a body in one step may leave it free in the next.
///
/// # Errors
/// [`Unsolved`], with the best state of an active set that did not settle or that was cancelled.
pub fn step<const S: usize, const N: usize>(
    model: &Model<S, N>,
    matrices: &Matrices,
    solver: &mut ProblemSolver,
    t: f64,
    before: Option<&StepState<S, N>>,
    observer: Observer<'_>,
) -> Result<StepState<S, N>, Unsolved<Box<StepState<S, N>>>> {
    let before = before.filter(|_| !model.contacts.is_empty());
    let solved = at_rest(model, matrices, solver, t, before, observer);
    match &solved {
        Err(Unsolved { error: StepError::Solve(e), .. }) if before.is_some() && !matches!(e, SolveError::Stopped { .. }) => {
            at_rest(model, matrices, solver, t, None, observer)
        }
        _ => solved,
    }
}
