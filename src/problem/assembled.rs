//! A problem that is ready to be solved, and its solution.

use super::closed_points::left_free;
use super::data::Exact;
use super::handles::{BodyId, SideOf};
use super::matrices::Stiffness;
use super::model::Model;
use super::observer::Observer;
use super::physics::PointState;
use super::problem_error::ProblemError;
use super::reactions::reactions;
use super::resultant::Resultant;
use super::solver::Solver;
use super::state::{StepError, StepState, Unsolved};
use super::step::step;
use crate::assembly::Errors;
use crate::constraint::{ConstraintSolver, Direct};
use crate::contact::Transmitted;
use crate::linalg::Vector;
use crate::space::Locator;
use std::ops::ControlFlow;
use std::sync::Arc;

/// A problem that is ready to be solved: its model, and the matrices of its bodies.
#[derive(Debug)]
pub struct System<const S: usize, const N: usize> {
    problem: u64,
    model: Arc<Model<S, N>>,
    stiffness: Option<Stiffness>,
    solver: Solver,
}

impl<const S: usize, const N: usize> System<S, N> {
    pub(super) fn new(model: Model<S, N>, problem: u64) -> Self {
        Self { problem, model: Arc::new(model), stiffness: None, solver: Solver::new(Box::new(Direct::new())) }
    }

    /// Solves with another constraint solver; by default by factors of the whole system.
    pub fn with_solver(mut self, solver: impl ConstraintSolver + 'static) -> Self {
        self.solver = Solver::new(Box::new(solver));
        self
    }

    /// The model: all that the problem consists of.
    pub fn model(&self) -> &Model<S, N> {
        &self.model
    }

    /// Solves the problem at time `t`, beginning with the contacts that are closed in `before`, a solution of this system; one of another
    /// system is not looked at.
    ///
    /// # Errors
    /// [`Unsolved`], with the last state if there is one.
    pub fn solve(&mut self, t: f64, before: Option<&Solution<S, N>>) -> Result<Solution<S, N>, Unsolved<S, N>> {
        self.solve_observed(t, before, &|_| ControlFlow::Continue(()))
    }

    /// Solves as [`solve`](Self::solve) does; `observer` is told of the progress and may cancel.
    ///
    /// # Errors
    /// [`Unsolved`], with the last state if there is one.
    pub fn solve_observed(
        &mut self,
        t: f64,
        before: Option<&Solution<S, N>>,
        observer: Observer<'_>,
    ) -> Result<Solution<S, N>, Unsolved<S, N>> {
        let model = &*self.model;
        let stiffness = self.stiffness.get_or_insert_with(|| Stiffness::new(model, t));
        let before = before.filter(|b| Arc::ptr_eq(&b.model, &self.model)).map(|b| &*b.state);
        let state = step(model, stiffness.at(model, t), &mut self.solver, t, before, observer)?;
        if let Some(motions) = left_free(model, &state) {
            return Err(Unsolved { error: StepError::Free { motions }, last: Some(Box::new(state)) });
        }
        Ok(Solution { problem: self.problem, model: Arc::clone(&self.model), state: Arc::new(state) })
    }
}

/// The solution of a problem at a time.
#[derive(Clone, Debug)]
pub struct Solution<const S: usize, const N: usize> {
    problem: u64,
    model: Arc<Model<S, N>>,
    state: Arc<StepState<S, N>>,
}

/// Pressure and gap of a contact, and what it transmits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactResult<const N: usize> {
    /// Force on the slave body \[force\].
    pub force: Vector<N>,
    /// Moment of it about the origin, about x, y, z.
    pub moment: [f64; 3],
    /// Area of the slave side under pressure.
    pub area: f64,
    /// Largest pressure [force/area]; -inf where nothing is faced.
    pub largest_pressure: f64,
    /// Least gap of a row \[length\]; inf where nothing is faced.
    pub least_gap: f64,
    /// Number of closed rows.
    pub active: usize,
}

impl<const S: usize, const N: usize> Solution<S, N> {
    /// The state: unknowns, multipliers, reactions.
    pub fn state(&self) -> &StepState<S, N> {
        &self.state
    }

    /// The model that it solves.
    pub fn model(&self) -> &Model<S, N> {
        &self.model
    }

    /// Displacement (or u) and stress (or flux) at a point of a body; a point outside by less than a quarter of an element moves to the
    /// nearest one of the body.
    ///
    /// # Errors
    /// [`ProblemError`] for a body of another problem, and for a point that is not in it.
    pub fn at(&self, body: BodyId, x: &[f64; N]) -> Result<PointState<N>, ProblemError> {
        let patch = self.patch(body)?;
        let space = patch.body.space();
        let outside = || {
            let at = std::array::from_fn(|k| x.get(k).copied().unwrap_or(0.0));
            ProblemError::Outside { body: patch.name.clone(), at }
        };
        let found = Locator::new(&**space).locate(&Vector::from(*x)).map_err(|_| outside())?;
        let states = patch.physics_at(self.state.t).at(&**space, &patch.field, &self.state.u, found.element, &[found.xi]);
        states.first().copied().ok_or_else(outside)
    }

    /// Unknowns of a body: coefficients of its functions, component by component within each.
    ///
    /// # Errors
    /// [`ProblemError`] for a body of another problem.
    pub fn coefficients(&self, body: BodyId) -> Result<&[f64], ProblemError> {
        Ok(&self.state.u[self.patch(body)?.range()])
    }

    /// Multipliers of a tie or a contact: coefficients of lambda, row by row.
    ///
    /// # Errors
    /// [`ProblemError`] if there is none of this name.
    pub fn multiplier(&self, name: &str) -> Result<Vec<f64>, ProblemError> {
        let tie = self.model.ties.iter().find(|t| t.name == name);
        let ranges = tie.map(|t| t.parts.iter().map(|p| p.first_row..p.first_row + p.num_rows).collect::<Vec<_>>());
        let contact = || Some(self.model.contacts.iter().find(|c| c.name == name)?.parts.iter().map(|p| p.rows()).collect());
        let ranges = ranges.or_else(contact).ok_or_else(|| ProblemError::Unknown { name: name.into() })?;
        Ok(ranges.into_iter().flat_map(|rows| self.state.lambda[rows].to_vec()).collect())
    }

    /// Pressure, gap and resultants of a contact.
    ///
    /// # Errors
    /// [`ProblemError`] if there is none of this name.
    pub fn contact(&self, name: &str) -> Result<ContactResult<N>, ProblemError> {
        let k = self.model.contacts.iter().position(|c| c.name == name);
        let k = k.ok_or_else(|| ProblemError::Unknown { name: name.into() })?;
        let mut sum = ContactResult {
            force: Vector::zeros(),
            moment: [0.0; 3],
            area: 0.0,
            largest_pressure: f64::NEG_INFINITY,
            least_gap: f64::INFINITY,
            active: 0,
        };
        for (part, rows) in self.model.contacts[k].parts.iter().zip(&self.state.contacts[k]) {
            let sent: Transmitted<N> = part.transmitted(rows, &self.state.lambda[part.rows()]);
            sum.force += sent.force;
            (0..3).for_each(|k| sum.moment[k] += sent.moment[k]);
            sum.area += sent.area;
            sum.largest_pressure = sum.largest_pressure.max(sent.largest_pressure);
            sum.least_gap = part.gaps(&self.model, rows, &self.state.u).into_iter().flatten().fold(sum.least_gap, f64::min);
            sum.active += part.rows().filter(|&j| self.state.active[j]).count();
        }
        Ok(sum)
    }

    /// Force of a support on its body, per component; zero for a side that is none.
    ///
    /// # Errors
    /// [`ProblemError`] for a side that does not exist.
    pub fn reaction(&self, side: SideOf<'_>) -> Result<Vec<f64>, ProblemError> {
        let patch = self.patch(side.body)?;
        patch.body.trace(side.name).map_err(|error| ProblemError::Side { body: patch.name.clone(), error })?;
        let label = format!("{}.{}", patch.name, side.name);
        let all = reactions(&self.model, &self.state, &mut Resultant::default());
        Ok(all.into_iter().find(|(name, _)| *name == label).map_or_else(|| vec![0.0; self.model.components], |(_, force)| force))
    }

    /// Norms of the error against an exact solution, per body.
    pub fn errors(&self, exact: &dyn Exact) -> Vec<Errors> {
        let t = self.state.t;
        let patches = self.model.patches.iter();
        patches.map(|p| p.physics_at(t).errors(&**p.body.space(), &p.rules, &self.state.u[p.range()], exact, t)).collect()
    }

    fn patch(&self, body: BodyId) -> Result<&super::model::PatchModel<S, N>, ProblemError> {
        // a body may have been added after the system was made
        let known = self.model.patches.get(body.number).filter(|_| body.problem == self.problem);
        known.ok_or(ProblemError::OtherProblem)
    }
}
