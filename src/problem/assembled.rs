//! A problem that is ready to be solved, and its solution.

use super::data::Exact;
use super::error::ProblemError;
use super::handles::{BodyId, ContactId, InterfaceId, Region, TieId};
use super::identity::Identity;
use super::interface_results::{ContactResult, TieResult};
use super::model::Model;
use super::observer::Observer;
use super::physics::PointState;
use super::regions::Regions;
use super::solved::{Assembled, Solve, State};
use super::state::{StepState, Unsolved};
use super::warnings::Warning;
use crate::assembly::Errors;
use crate::constraint::ConstraintSolver;
use std::ops::ControlFlow;
use std::sync::Arc;

/// A problem that is ready to be solved: its model, and the matrices of its bodies. It owns all that it needs, and may go to another thread.
#[derive(Debug)]
pub struct System<const S: usize, const N: usize> {
    inner: Box<dyn Solve<S, N>>,
}

impl<const S: usize, const N: usize> System<S, N> {
    /// The problem of this identity with this model, whose data are of `times`.
    pub(super) fn new(model: Model<S, N>, identity: Identity, regions: Regions<S, N>, times: Vec<f64>) -> Self {
        Self { inner: Box::new(Assembled::new(model, identity, regions, times)) }
    }

    /// Solves with another constraint solver; by default by factors of the whole system.
    #[must_use]
    pub fn with_solver(mut self, solver: impl ConstraintSolver + 'static) -> Self {
        self.inner.replace_solver(Box::new(solver));
        self
    }

    /// The model: all that the problem consists of.
    pub fn model(&self) -> &Model<S, N> {
        self.inner.model()
    }

    /// Doubts about the problem at the times of its data: overlaps, thin cells, inexact integrals, soft supports.
    pub fn warnings(&self) -> Vec<Warning> {
        self.inner.warnings()
    }

    /// Solves the problem at time `t`, beginning with the contacts that are closed in `before`, a solution of this system; one of another
    /// system is not looked at.
    ///
    /// # Errors
    /// [`Unsolved`], with the best solution that was reached, if there is one.
    pub fn solve(&mut self, t: f64, before: Option<&Solution<S, N>>) -> Result<Solution<S, N>, Unsolved<Solution<S, N>>> {
        self.solve_observed(t, before, &|_| ControlFlow::Continue(()))
    }

    /// Solves as [`solve`](Self::solve) does; `observer` is told of the progress and may cancel.
    ///
    /// # Errors
    /// [`Unsolved`], with the best solution that was reached, if there is one.
    pub fn solve_observed(
        &mut self,
        t: f64,
        before: Option<&Solution<S, N>>,
        observer: Observer<'_>,
    ) -> Result<Solution<S, N>, Unsolved<Solution<S, N>>> {
        let solution = |inner| Solution { inner };
        self.inner.solve(t, before.map(|b| &*b.inner), observer).map(solution).map_err(|unsolved| unsolved.map(solution))
    }
}

/// The solution of a problem at a time.
#[derive(Clone, Debug)]
pub struct Solution<const S: usize, const N: usize> {
    inner: Arc<dyn State<S, N>>,
}

impl<const S: usize, const N: usize> Solution<S, N> {
    /// The state: unknowns, multipliers, reactions.
    pub fn state(&self) -> &StepState<S, N> {
        self.inner.state()
    }

    /// The model that it solves.
    pub fn model(&self) -> &Model<S, N> {
        self.inner.model()
    }

    /// Displacement (or u) and stress (or flux) at a point of a body; a point outside by less than a quarter of an element moves to the
    /// nearest one of the body. The first point that is asked for in a body builds a tree over its elements, which all solutions of the
    /// system share.
    ///
    /// # Errors
    /// [`ErrorKind::OtherProblem`](super::ErrorKind::OtherProblem) for a body of another problem,
    /// [`ErrorKind::Outside`](super::ErrorKind::Outside) for a point that is not in the body.
    pub fn at(&self, body: BodyId, x: &[f64; N]) -> Result<PointState<N>, ProblemError> {
        self.inner.at(body, x)
    }

    /// The answers of [`at`](Self::at) for many points of a body, found on all threads.
    pub fn at_many(&self, body: BodyId, x: &[[f64; N]]) -> Vec<Result<PointState<N>, ProblemError>> {
        self.inner.at_many(body, x)
    }

    /// Displacement (or u) and stress (or flux) at points of an element of a body, given by their coordinates in the reference cell.
    ///
    /// # Errors
    /// [`ErrorKind::OtherProblem`](super::ErrorKind::OtherProblem) for a body of another problem,
    /// [`ErrorKind::NoElement`](super::ErrorKind::NoElement) for an element that the body does not have.
    pub fn in_element(&self, body: BodyId, element: usize, xi: &[[f64; N]]) -> Result<Vec<PointState<N>>, ProblemError> {
        self.inner.in_element(body, element, xi)
    }

    /// Unknowns of a body: coefficients of its functions, component by component within each.
    ///
    /// # Errors
    /// [`ProblemError`] for a body of another problem.
    pub fn coefficients(&self, body: BodyId) -> Result<&[f64], ProblemError> {
        self.inner.coefficients(body)
    }

    /// Multipliers of a tie or a contact: coefficients of lambda [force/area], row by row.
    ///
    /// # Errors
    /// [`ErrorKind::OtherProblem`](super::ErrorKind::OtherProblem) for one of another problem, and for one that was said after the system
    /// was made.
    pub fn multiplier(&self, of: impl Into<InterfaceId>) -> Result<Vec<f64>, ProblemError> {
        self.inner.multiplier(of.into())
    }

    /// Jump and resultant of a tie.
    ///
    /// # Errors
    /// [`ErrorKind::OtherProblem`](super::ErrorKind::OtherProblem) as for [`multiplier`](Self::multiplier).
    pub fn tie(&self, tie: TieId) -> Result<TieResult, ProblemError> {
        self.inner.tie(tie)
    }

    /// Pressure, gap and resultant of a contact.
    ///
    /// # Errors
    /// [`ErrorKind::OtherProblem`](super::ErrorKind::OtherProblem) as for [`multiplier`](Self::multiplier).
    pub fn contact(&self, contact: ContactId) -> Result<ContactResult<N>, ProblemError> {
        self.inner.contact(contact)
    }

    /// Force of the supports of a region on its body, per component; zero for a region without any.
    ///
    /// # Errors
    /// [`ProblemError`] for a side that does not exist, and for a region that was made after the system.
    pub fn reaction<'a>(&self, on: impl Into<Region<'a>>) -> Result<Vec<f64>, ProblemError> {
        self.inner.reaction(on.into())
    }

    /// Doubts about the solution: large strains, moments that are lost, coarse zones, inexact interfaces, rounding.
    pub fn warnings(&self) -> Vec<Warning> {
        self.inner.warnings()
    }

    /// Norms of the error against an exact solution, per body.
    pub fn errors(&self, exact: &dyn Exact) -> Vec<Errors> {
        self.inner.errors(exact)
    }
}
