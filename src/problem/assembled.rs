//! A problem that is ready to be solved.

use super::contents::Contents;
use super::error::ProblemErrors;
use super::forecast::Forecast;
use super::handles::InterfaceId;
use super::linearised::Linearised;
use super::loads::LoadSum;
use super::observer::Observer;
use super::rigid_motions::RigidMotion;
use super::row_names::RowsOfSide;
use super::solution::Solution;
use super::solved::Common;
use super::solving::{Assembled, Solve};
use super::state::{StepError, Unsolved};
use super::warnings::Warning;
use crate::constraint::{ConstrainedSolution, ConstraintSolver};
use std::ops::ControlFlow;

/// A problem that is ready to be solved: its model, and the matrices of its bodies. It owns all that it needs, and may go to another thread.
#[derive(Debug)]
pub struct System<const S: usize, const N: usize> {
    inner: Box<dyn Solve<S, N>>,
}

impl<const S: usize, const N: usize> System<S, N> {
    /// A system of these parts, whose data are of `times`.
    pub(super) fn new(common: Common<S, N>, times: Vec<f64>) -> Self {
        Self { inner: Box::new(Assembled::new(common, times)) }
    }

    /// Solves with another constraint solver; by default by factors of the whole system.
    #[must_use]
    pub fn with_solver(mut self, solver: impl ConstraintSolver + 'static) -> Self {
        self.set_solver(solver);
        self
    }

    /// Replaces the constraint solver, as [`with_solver`](Self::with_solver) does.
    pub fn set_solver(&mut self, solver: impl ConstraintSolver + 'static) {
        self.inner.replace_solver(Box::new(solver));
    }

    /// Bodies, ties, contacts and supports, and their sizes.
    pub fn contents(&self) -> Contents<'_, S, N> {
        Contents { model: self.inner.model() }
    }

    /// Doubts about the problem at the times of its data: those of [`statement_warnings`](Self::statement_warnings) and of
    /// [`accuracy_warnings`](Self::accuracy_warnings).
    pub fn warnings(&self) -> Vec<Warning> {
        let mut found = self.statement_warnings();
        found.extend(self.accuracy_warnings());
        found
    }

    /// Doubts about what is stated: facets that do not explain a distance, values that jump in a corner, overlaps, multipliers with too few
    /// functions.
    pub fn statement_warnings(&self) -> Vec<Warning> {
        self.inner.statement_warnings()
    }

    /// Doubts about the accuracy of solutions: thin cells, inexact integrals, soft supports, fluxes that jump.
    pub fn accuracy_warnings(&self) -> Vec<Warning> {
        self.inner.accuracy_warnings()
    }

    /// The memory that a run of a number of `steps` takes, whose solutions are kept; `factor`: whether a factor of the system is computed.
    pub fn forecast(&self, factor: bool, steps: usize) -> Forecast {
        self.inner.forecast(factor, steps)
    }

    /// Bodies, and obstacles that forces press, that can still move as rigid bodies with all points of ties held and all contacts closed;
    /// none of a system from [`Problem::assemble`](super::Problem::assemble).
    pub fn rigid_motions(&self) -> Vec<RigidMotion> {
        self.inner.rigid_motions()
    }

    /// Rigid motions that are left at time `t` with the contact rows `open`, numbered as those of the system, and all others closed.
    pub fn motions_with_open(&self, t: f64, open: &[usize]) -> Vec<RigidMotion> {
        self.inner.motions_with_open(t, open)
    }

    /// Returns, side by side, those of `rows` of the system that belong to contacts.
    pub fn contact_rows(&self, rows: &[usize]) -> Vec<RowsOfSide<N>> {
        self.inner.contact_rows(rows)
    }

    /// The tie or contact that a row of the system belongs to, its name, and the number of the row among those of its slave side; `None`
    /// beyond the last row.
    pub fn row_owner(&self, row: usize) -> Option<(InterfaceId, &str, usize)> {
        self.inner.row_owner(row)
    }

    /// Force and moment of every load at time `t`, as the rules of the problem integrate it.
    pub fn loads(&self, t: f64) -> Vec<LoadSum> {
        self.inner.loads(t)
    }

    /// All loads as [`loads`](Self::loads) lists them, with the resultant zero.
    pub fn no_loads(&self) -> Vec<LoadSum> {
        self.inner.model().no_loads()
    }

    /// Assembles the matrices of the bodies at time `t`; [`solve`](Self::solve) does the same where it has not been done.
    pub fn assemble_at(&mut self, t: f64) {
        self.inner.assemble_at(t);
    }

    /// Checks that nothing can move as a rigid body with every contact closed.
    pub(super) fn held(&self) -> Result<(), ProblemErrors> {
        self.inner.held()
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

    /// Linearises the problem at time `t` about `before`, a solution of this system, or about rest: matrices, load and rows for a solver of
    /// one's own. Obstacles that forces press stand where `before` has them; their rows are those of that place.
    ///
    /// # Errors
    /// [`StepError`] where data, ties or contacts have no value at this time.
    pub fn linearise(&mut self, t: f64, before: Option<&Solution<S, N>>) -> Result<Linearised<S, N>, StepError> {
        self.inner.linearise(t, before.map(|b| &*b.inner))
    }

    /// Takes an answer to a linearised system. Its residual and its rows are checked, whoever solved it; all results are as of
    /// [`solve`](Self::solve).
    ///
    /// # Errors
    /// [`StepError::OtherSystem`] for a linearised system of another system, [`StepError::Solve`] for an answer that does not solve it, and
    /// [`StepError::Free`] where the closed contacts leave a body free.
    pub fn accept(&mut self, system: &Linearised<S, N>, answer: ConstrainedSolution) -> Result<Solution<S, N>, Unsolved<Solution<S, N>>> {
        let solution = |inner| Solution { inner };
        self.inner.accept(system, answer).map(solution).map_err(|unsolved| unsolved.map(solution))
    }
}
