//! The work of systems.
//!
//! Behind a trait object: everything is compiled with this crate, for the plane and for space, and no program compiles it again.

use super::closed_points::remaining_motions;
use super::error::ProblemErrors;
use super::forecast::Forecast;
use super::handles::InterfaceId;
use super::linearised::{Linearised, StepSystem};
use super::loads::LoadSum;
use super::matrices::{Matrices, Stiffness};
use super::model::Model;
use super::observer::Observer;
use super::rigid_motions::RigidMotion;
use super::row_names::RowsOfSide;
use super::solved::{Common, Solved, State};
use super::solver::ProblemSolver;
use super::state::{StepError, StepState, Unsolved};
use super::step::step;
use super::warnings::Warning;
use crate::constraint::{ConstrainedSolution, ConstraintSolver, Direct, verified};
use crate::linalg::residual::RESIDUAL_LIMIT;
use std::fmt::Debug;
use std::sync::Arc;

/// A state, or an error with the best one.
type Solves<const S: usize, const N: usize> = Result<Arc<dyn State<S, N>>, Unsolved<Arc<dyn State<S, N>>>>;

/// The methods of a system.
pub(super) trait Solve<const S: usize, const N: usize>: Debug + Send {
    fn model(&self) -> &Model<S, N>;
    fn statement_warnings(&self) -> Vec<Warning>;
    fn accuracy_warnings(&self) -> Vec<Warning>;
    fn forecast(&self, factor: bool, steps: usize) -> Forecast;
    fn rigid_motions(&self) -> Vec<RigidMotion>;
    fn motions_with_open(&self, t: f64, open: &[usize]) -> Vec<RigidMotion>;
    fn held(&self) -> Result<(), ProblemErrors>;
    fn contact_rows(&self, rows: &[usize]) -> Vec<RowsOfSide<N>>;
    fn row_owner(&self, row: usize) -> Option<(InterfaceId, &str, usize)>;
    fn loads(&self, t: f64) -> Vec<LoadSum>;
    fn replace_solver(&mut self, solver: Box<dyn ConstraintSolver>);
    fn assemble_at(&mut self, t: f64);
    fn solve(&mut self, t: f64, before: Option<&dyn State<S, N>>, observer: Observer<'_>) -> Solves<S, N>;
    fn linearise(&mut self, t: f64, before: Option<&dyn State<S, N>>) -> Result<Linearised<S, N>, StepError>;
    fn accept(&mut self, system: &Linearised<S, N>, solution: ConstrainedSolution) -> Solves<S, N>;
}

/// A model with its matrices and its solver.
#[derive(Debug)]
pub(super) struct Assembled<const S: usize, const N: usize> {
    common: Arc<Common<S, N>>,
    times: Vec<f64>,
    stiffness: Option<Stiffness>,
    solver: ProblemSolver,
}

impl<const S: usize, const N: usize> Assembled<S, N> {
    pub fn new(common: Common<S, N>, times: Vec<f64>) -> Self {
        Self { common: Arc::new(common), times, stiffness: None, solver: ProblemSolver::new(Box::new(Direct::new())) }
    }
}

impl<const S: usize, const N: usize> Solve<S, N> for Assembled<S, N> {
    fn model(&self) -> &Model<S, N> {
        &self.common.model
    }

    fn statement_warnings(&self) -> Vec<Warning> {
        self.common.model.statement_warnings(&self.times)
    }

    fn accuracy_warnings(&self) -> Vec<Warning> {
        self.common.model.accuracy_warnings(&self.times)
    }

    fn forecast(&self, factor: bool, steps: usize) -> Forecast {
        self.common.model.forecast(factor, steps)
    }

    fn rigid_motions(&self) -> Vec<RigidMotion> {
        self.common.model.rigid_motions(&self.times)
    }

    fn motions_with_open(&self, t: f64, open: &[usize]) -> Vec<RigidMotion> {
        self.common.model.motions_with_open(t, open)
    }

    fn held(&self) -> Result<(), ProblemErrors> {
        self.common.model.held(&self.times)
    }

    fn contact_rows(&self, rows: &[usize]) -> Vec<RowsOfSide<N>> {
        self.common.model.contact_rows(rows)
    }

    fn row_owner(&self, row: usize) -> Option<(InterfaceId, &str, usize)> {
        self.common.model.row_owner(row)
    }

    fn loads(&self, t: f64) -> Vec<LoadSum> {
        self.common.model.load_sums(t)
    }

    fn replace_solver(&mut self, solver: Box<dyn ConstraintSolver>) {
        self.solver = ProblemSolver::new(solver);
    }

    fn assemble_at(&mut self, t: f64) {
        self.stiffness.get_or_insert_with(|| Stiffness::new(&self.common.model, t)).at(&self.common.model, t);
    }

    fn solve(&mut self, t: f64, before: Option<&dyn State<S, N>>, observer: Observer<'_>) -> Solves<S, N> {
        let model = &*self.common.model;
        let stiffness = self.stiffness.get_or_insert_with(|| Stiffness::new(model, t));
        let before = before.filter(|b| std::ptr::eq(b.model(), model)).map(|b| b.state());
        let matrices = stiffness.at(model, t);
        let best = |state: Box<_>| Arc::new(Solved::new(&self.common, matrices, *state)) as Arc<dyn State<S, N>>;
        let state = step(model, matrices, &mut self.solver, t, before, observer).map_err(|unsolved| unsolved.map(best))?;
        held(&self.common, matrices, state)
    }

    fn linearise(&mut self, t: f64, before: Option<&dyn State<S, N>>) -> Result<Linearised<S, N>, StepError> {
        let model = &*self.common.model;
        let stiffness = self.stiffness.get_or_insert_with(|| Stiffness::new(model, t));
        let before = before.filter(|b| std::ptr::eq(b.model(), model) && !model.contacts.is_empty()).map(|b| b.state());
        let place = before.map(|b| b.u.as_slice());
        let inner = stiffness.at(model, t).with_blocks(model, |blocks| StepSystem::of(model, blocks, t, before, place))??;
        Ok(Linearised { model: Arc::clone(&self.common.model), inner })
    }

    fn accept(&mut self, system: &Linearised<S, N>, solution: ConstrainedSolution) -> Solves<S, N> {
        if !Arc::ptr_eq(&self.common.model, &system.model) {
            return Err(StepError::OtherSystem.into());
        }
        let (model, inner) = (&*self.common.model, &system.inner);
        let iterated = inner.enforced.iterations.iter().map(|(_, iteration)| iteration.tolerance());
        let checked = verified(&inner.constrained(), solution, iterated.fold(RESIDUAL_LIMIT, f64::max)).map_err(StepError::Solve)?;
        let matrices = self.stiffness.get_or_insert_with(|| Stiffness::new(model, inner.t)).at(model, inner.t);
        let state = matrices.with_blocks(model, |blocks| inner.finished(model, blocks, checked))?;
        held(&self.common, matrices, state)
    }
}

/// The solution, if its closed contacts hold all bodies.
fn held<const S: usize, const N: usize>(common: &Arc<Common<S, N>>, matrices: &Matrices, state: StepState<S, N>) -> Solves<S, N> {
    let free = remaining_motions(&common.model, &state);
    let solved: Arc<dyn State<S, N>> = Arc::new(Solved::new(common, matrices, state));
    match free {
        Some(motions) => Err(Unsolved { error: StepError::Free { motions }, best: Some(solved) }),
        None => Ok(solved),
    }
}
