//! The work of systems and solutions.
//!
//! Behind trait objects: everything is compiled with this crate, for the plane and for space, and no program compiles it again.

use super::closed_points::left_free;
use super::data::Exact;
use super::error::{ErrorKind, ProblemError, ProblemErrors};
use super::extremes::Extreme;
use super::forecast::Forecast;
use super::handles::{BodyId, ContactId, InterfaceId, Region, TieId};
use super::identity::Identity;
use super::interface_results::{ContactResult, TieResult};
use super::interface_side::HalfWidth;
use super::lambda_error::SquaredError;
use super::lambda_field::LambdaField;
use super::linearised::{Linearised, StepSystem};
use super::loads::LoadSum;
use super::matrices::{Matrices, Stiffness};
use super::model::{Against, ContactModel, ContactPart, Model, PatchModel, TieModel};
use super::observer::Observer;
use super::physics::{OtherField, Physics, PointState};
use super::places::Places;
use super::reactions::{Reaction, reactions};
use super::regions::Regions;
use super::resultant::Resultant;
use super::rigid_motions::RigidMotion;
use super::row_names::RowsOfSide;
use super::solver::Solver;
use super::state::{StepError, StepState, Unsolved};
use super::step::step;
use super::warnings::Warning;
use crate::assembly::Errors;
use crate::constraint::{ConstrainedSolution, ConstraintSolver, Direct, verified};
use crate::linalg::residual::RESIDUAL_LIMIT;
use crate::linalg::{Csr, Operator, Vector};
use crate::quadrature::Quadrature;
use rayon::prelude::*;
use std::fmt::Debug;
use std::sync::{Arc, OnceLock};

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

/// The methods of a solution.
pub(super) trait State<const S: usize, const N: usize>: Debug + Send + Sync {
    fn state(&self) -> &StepState<S, N>;
    fn model(&self) -> &Model<S, N>;
    fn at(&self, body: BodyId, x: &[f64; N]) -> Result<PointState<N>, ProblemError>;
    fn at_many(&self, body: BodyId, x: &[[f64; N]]) -> Vec<Result<PointState<N>, ProblemError>>;
    fn in_element(&self, body: BodyId, element: usize, xi: &[[f64; N]]) -> Result<Vec<PointState<N>>, ProblemError>;
    fn coefficients(&self, body: BodyId) -> Result<&[f64], ProblemError>;
    fn multiplier(&self, of: InterfaceId) -> Result<Vec<f64>, ProblemError>;
    fn tie(&self, tie: TieId) -> Result<TieResult, ProblemError>;
    fn contact(&self, contact: ContactId) -> Result<ContactResult<N>, ProblemError>;
    fn reaction(&self, on: Region<'_>) -> Result<Vec<f64>, ProblemError>;
    fn reactions(&self) -> &[Reaction<S, N>];
    fn balance(&self) -> Resultant;
    fn energy(&self) -> f64;
    fn errors(&self, exact: &dyn Exact) -> Vec<Errors>;
    fn difference(&self, body: BodyId, rules: &dyn Quadrature<N>, other: &dyn OtherField<N>) -> Result<Errors, ProblemError>;
    fn extremes(&self, body: BodyId, derived: Option<bool>, field: Scalar<'_, N>) -> Result<Option<[Extreme<N>; 2]>, ProblemError>;
    fn lambda_field(self: Arc<Self>, of: InterfaceId, side: usize) -> Result<Option<LambdaField<S>>, ProblemError>;
    fn lambda_error(&self, of: InterfaceId) -> Result<SquaredError, ProblemError>;
    fn warnings(&self) -> Vec<Warning>;
}

/// A number of the state at a point.
type Scalar<'a, const N: usize> = &'a (dyn Fn(&PointState<N>) -> f64 + Sync);

/// A model with its matrices and its solver.
#[derive(Debug)]
pub(super) struct Assembled<const S: usize, const N: usize> {
    identity: Arc<Identity>,
    regions: Arc<Regions<S, N>>,
    places: Arc<Places<N>>,
    model: Arc<Model<S, N>>,
    times: Vec<f64>,
    stiffness: Option<Stiffness>,
    solver: Solver,
    half_width: HalfWidth<S, N>,
}

impl<const S: usize, const N: usize> Assembled<S, N> {
    pub fn new(model: Model<S, N>, identity: Identity, regions: Regions<S, N>, times: Vec<f64>, half_width: HalfWidth<S, N>) -> Self {
        Self {
            identity: Arc::new(identity),
            regions: Arc::new(regions),
            places: Arc::new(Places::new(model.patches.len())),
            model: Arc::new(model),
            times,
            stiffness: None,
            solver: Solver::new(Box::new(Direct::new())),
            half_width,
        }
    }
}

impl<const S: usize, const N: usize> Solve<S, N> for Assembled<S, N> {
    fn model(&self) -> &Model<S, N> {
        &self.model
    }

    fn statement_warnings(&self) -> Vec<Warning> {
        self.model.statement_warnings(&self.times)
    }

    fn accuracy_warnings(&self) -> Vec<Warning> {
        self.model.accuracy_warnings(&self.times)
    }

    fn forecast(&self, factor: bool, steps: usize) -> Forecast {
        self.model.forecast(factor, steps)
    }

    fn rigid_motions(&self) -> Vec<RigidMotion> {
        self.model.rigid_motions()
    }

    fn motions_with_open(&self, t: f64, open: &[usize]) -> Vec<RigidMotion> {
        self.model.motions_with_open(t, open)
    }

    fn held(&self) -> Result<(), ProblemErrors> {
        self.model.held()
    }

    fn contact_rows(&self, rows: &[usize]) -> Vec<RowsOfSide<N>> {
        self.model.contact_rows(rows)
    }

    fn row_owner(&self, row: usize) -> Option<(InterfaceId, &str, usize)> {
        self.model.row_owner(row)
    }

    fn loads(&self, t: f64) -> Vec<LoadSum> {
        self.model.load_sums(t)
    }

    fn replace_solver(&mut self, solver: Box<dyn ConstraintSolver>) {
        self.solver = Solver::new(solver);
    }

    fn assemble_at(&mut self, t: f64) {
        self.stiffness.get_or_insert_with(|| Stiffness::new(&self.model, t)).at(&self.model, t);
    }

    fn solve(&mut self, t: f64, before: Option<&dyn State<S, N>>, observer: Observer<'_>) -> Solves<S, N> {
        let model = &*self.model;
        let stiffness = self.stiffness.get_or_insert_with(|| Stiffness::new(model, t));
        let before = before.filter(|b| std::ptr::eq(b.model(), model)).map(|b| b.state());
        let matrices = stiffness.at(model, t);
        let stepped = step(model, matrices, &mut self.solver, t, before, observer);
        let shared = Shared {
            identity: &self.identity,
            regions: &self.regions,
            places: &self.places,
            model: &self.model,
            half_width: self.half_width,
            matrices,
        };
        let state = stepped.map_err(|unsolved| unsolved.map(|state| shared.solution(*state)))?;
        shared.held(state)
    }

    fn linearise(&mut self, t: f64, before: Option<&dyn State<S, N>>) -> Result<Linearised<S, N>, StepError> {
        let model = &*self.model;
        let stiffness = self.stiffness.get_or_insert_with(|| Stiffness::new(model, t));
        let before = before.filter(|b| std::ptr::eq(b.model(), model) && !model.contacts.is_empty()).map(|b| b.state());
        let place = before.map(|b| b.u.as_slice());
        let inner = stiffness.at(model, t).with_blocks(model, |blocks| StepSystem::of(model, blocks, t, before, place))??;
        Ok(Linearised { model: Arc::clone(&self.model), inner })
    }

    fn accept(&mut self, system: &Linearised<S, N>, solution: ConstrainedSolution) -> Solves<S, N> {
        if !Arc::ptr_eq(&self.model, &system.model) {
            return Err(StepError::OtherSystem.into());
        }
        let (model, inner) = (&*self.model, &system.inner);
        let iterated = inner.enforced.iterations.iter().map(|(_, iteration)| iteration.tolerance());
        let checked = verified(&inner.constrained(), solution, iterated.fold(RESIDUAL_LIMIT, f64::max)).map_err(StepError::Solve)?;
        let matrices = self.stiffness.get_or_insert_with(|| Stiffness::new(model, inner.t)).at(model, inner.t);
        let state = matrices.with_blocks(model, |blocks| inner.finished(model, blocks, checked))?;
        let shared = Shared {
            identity: &self.identity,
            regions: &self.regions,
            places: &self.places,
            model: &self.model,
            half_width: self.half_width,
            matrices,
        };
        shared.held(state)
    }
}

/// Parts that all solutions of a system have in common, and the matrices of a time.
struct Shared<'a, const S: usize, const N: usize> {
    identity: &'a Arc<Identity>,
    regions: &'a Arc<Regions<S, N>>,
    places: &'a Arc<Places<N>>,
    model: &'a Arc<Model<S, N>>,
    half_width: HalfWidth<S, N>,
    matrices: &'a Matrices,
}

impl<const S: usize, const N: usize> Shared<'_, S, N> {
    /// A state with its answers.
    fn solution(&self, state: StepState<S, N>) -> Arc<dyn State<S, N>> {
        let bodies = self.model.patches.iter().zip(&self.matrices.bodies);
        let energy = bodies.map(|(p, k)| energy(k, &state.u[p.range()])).sum();
        let (identity, regions) = (Arc::clone(self.identity), Arc::clone(self.regions));
        let (places, model) = (Arc::clone(self.places), Arc::clone(self.model));
        Arc::new(Solved { identity, regions, places, model, state, energy, half_width: self.half_width, outside: OnceLock::new() })
    }

    /// The solution, if its closed contacts hold all bodies.
    fn held(&self, state: StepState<S, N>) -> Solves<S, N> {
        match left_free(self.model, &state) {
            Some(motions) => Err(Unsolved { error: StepError::Free { motions }, best: Some(self.solution(state)) }),
            None => Ok(self.solution(state)),
        }
    }
}

/// A state of a model.
#[derive(Debug)]
pub(super) struct Solved<const S: usize, const N: usize> {
    identity: Arc<Identity>,
    regions: Arc<Regions<S, N>>,
    places: Arc<Places<N>>,
    pub(super) model: Arc<Model<S, N>>,
    pub(super) state: StepState<S, N>,
    /// 1/2 uᵀ K u of all bodies.
    energy: f64,
    half_width: HalfWidth<S, N>,
    /// Reactions, and the sum of all external forces.
    outside: OnceLock<(Vec<Reaction<S, N>>, Resultant)>,
}

/// 1/2 uᵀ K u.
fn energy(matrix: &Csr, u: &[f64]) -> f64 {
    let mut y = vec![0.0; u.len()];
    matrix.apply(u, &mut y);
    0.5 * u.iter().zip(&y).map(|(a, b)| a * b).sum::<f64>()
}

impl<const S: usize, const N: usize> State<S, N> for Solved<S, N> {
    fn state(&self) -> &StepState<S, N> {
        &self.state
    }

    fn model(&self) -> &Model<S, N> {
        &self.model
    }

    fn at(&self, body: BodyId, x: &[f64; N]) -> Result<PointState<N>, ProblemError> {
        let patch = self.patch(body)?;
        self.place(patch, &patch.physics_at(self.state.t), x)
    }

    fn at_many(&self, body: BodyId, x: &[[f64; N]]) -> Vec<Result<PointState<N>, ProblemError>> {
        let patch = match self.patch(body) {
            Ok(patch) => patch,
            Err(error) => return vec![Err(error); x.len()],
        };
        let physics = patch.physics_at(self.state.t);
        self.places.of(patch);
        x.par_iter().map(|x| self.place(patch, &physics, x)).collect()
    }

    fn in_element(&self, body: BodyId, element: usize, xi: &[[f64; N]]) -> Result<Vec<PointState<N>>, ProblemError> {
        let patch = self.patch(body)?;
        let (space, elements) = (patch.body.space(), patch.body.space().num_elements());
        if element >= elements {
            return Err(ProblemError::new(ErrorKind::NoElement { element, elements }, vec![body.into()], vec![patch.name.clone()]));
        }
        let xi: Vec<Vector<N>> = xi.iter().map(|xi| Vector::from(*xi)).collect();
        Ok(patch.physics_at(self.state.t).at(&**space, &patch.field, &self.state.u, element, &xi))
    }

    fn coefficients(&self, body: BodyId) -> Result<&[f64], ProblemError> {
        Ok(&self.state.u[self.patch(body)?.range()])
    }

    fn multiplier(&self, of: InterfaceId) -> Result<Vec<f64>, ProblemError> {
        let rows: Vec<_> = match of {
            InterfaceId::Tie(tie) => self.of_tie(tie)?.parts.iter().map(|p| p.first_row..p.first_row + p.num_rows).collect(),
            InterfaceId::Contact(contact) => self.of_contact(contact)?.parts.iter().map(ContactPart::rows).collect(),
        };
        Ok(rows.into_iter().flat_map(|rows| &self.state.lambda[rows]).copied().collect())
    }

    fn tie(&self, tie: TieId) -> Result<TieResult, ProblemError> {
        Ok(self.of_tie(tie)?.result(&self.model, &self.state))
    }

    fn contact(&self, contact: ContactId) -> Result<ContactResult<N>, ProblemError> {
        Ok(self.of_contact(contact)?.result(&self.model, &self.state.contacts[contact.number], &self.state, self.half_width))
    }

    fn reaction(&self, on: Region<'_>) -> Result<Vec<f64>, ProblemError> {
        let number = match on {
            Region::Side(side) => {
                let patch = self.patch(side.body)?;
                let refused = |error| ProblemError::new(ErrorKind::Side(error), vec![side.body.into()], vec![patch.name.clone()]);
                patch.body.trace(side.name).map_err(refused)?;
                self.regions.known(side.body.number, side.name)
            }
            Region::Made(region) if self.identity.knows(region) && region.number < self.regions.len() => Some(region.number),
            Region::Made(_) => return Err(other_problem()),
        };
        let mut sum = vec![0.0; self.model.components];
        let Some(number) = number else { return Ok(sum) };
        let pieces = self.regions.pieces(number);
        for reaction in self.reactions() {
            if pieces.iter().any(|piece| piece.is(&reaction.on)) {
                sum.iter_mut().zip(&reaction.force).for_each(|(s, f)| *s += f);
            }
        }
        Ok(sum)
    }

    fn reactions(&self) -> &[Reaction<S, N>] {
        &self.outside().0
    }

    fn balance(&self) -> Resultant {
        self.outside().1
    }

    fn energy(&self) -> f64 {
        self.energy
    }

    fn errors(&self, exact: &dyn Exact) -> Vec<Errors> {
        let t = self.state.t;
        let patches = self.model.patches.iter();
        patches.map(|p| p.physics_at(t).errors(&**p.body.space(), &p.rules, &self.state.u[p.range()], exact, t)).collect()
    }

    fn difference(&self, body: BodyId, rules: &dyn Quadrature<N>, other: &dyn OtherField<N>) -> Result<Errors, ProblemError> {
        let patch = self.patch(body)?;
        Ok(patch.physics_at(self.state.t).difference(&**patch.body.space(), rules, &self.state.u[patch.range()], other))
    }

    fn extremes(&self, body: BodyId, derived: Option<bool>, field: Scalar<'_, N>) -> Result<Option<[Extreme<N>; 2]>, ProblemError> {
        let (patch, state) = (self.patch(body)?, &self.state);
        Ok(match derived {
            Some(derived) => patch.extremes(&state.u, state.t, derived, field),
            None => patch.extremes_at_points(&state.u, state.t, field),
        })
    }

    fn lambda_field(self: Arc<Self>, of: InterfaceId, side: usize) -> Result<Option<LambdaField<S>>, ProblemError> {
        LambdaField::of(self, of, side)
    }

    fn lambda_error(&self, of: InterfaceId) -> Result<SquaredError, ProblemError> {
        Ok(match of {
            InterfaceId::Tie(tie) => self.of_tie(tie)?.lambda_error(&self.model, &self.state),
            InterfaceId::Contact(contact) => {
                self.of_contact(contact)?.lambda_error(&self.model, &self.state.contacts[contact.number], &self.state)
            }
        })
    }

    fn warnings(&self) -> Vec<Warning> {
        self.model.state_warnings(&self.state)
    }
}

impl<const S: usize, const N: usize> Solved<S, N> {
    fn patch(&self, body: BodyId) -> Result<&PatchModel<S, N>, ProblemError> {
        // a body may have been added after the system was made
        self.model.patches.get(body.number).filter(|_| self.identity.knows(body)).ok_or_else(other_problem)
    }

    /// Reactions, and the sum of all external forces: of loads, obstacles and supports.
    fn outside(&self) -> &(Vec<Reaction<S, N>>, Resultant) {
        self.outside.get_or_init(|| {
            let mut outside = self.state.load;
            for (contact, built) in self.model.contacts.iter().zip(&self.state.contacts) {
                for (part, rows) in contact.parts.iter().zip(built).filter(|(part, _)| matches!(part.against, Against::Rigid(..))) {
                    let sent = part.transmitted(rows, &self.state.lambda[part.rows()]);
                    let mut force = [0.0; 3];
                    force[..N].copy_from_slice(sent.force.as_slice());
                    // the force that drives the obstacle is among the loads
                    contact.obstacle.iter().flat_map(|o| &o.pressed).for_each(|p| force[p.component] = 0.0);
                    outside.sum(&Resultant { force, moment: sent.moment });
                }
            }
            (reactions(&self.model, &self.state, &mut outside), outside)
        })
    }

    pub(super) fn of_tie(&self, tie: TieId) -> Result<&TieModel<S, N>, ProblemError> {
        self.model.ties.get(tie.number).filter(|_| self.identity.knows(tie)).ok_or_else(other_problem)
    }

    pub(super) fn of_contact(&self, contact: ContactId) -> Result<&ContactModel<S, N>, ProblemError> {
        self.model.contacts.get(contact.number).filter(|_| self.identity.knows(contact)).ok_or_else(other_problem)
    }

    /// The state at a point of a body with its material at the time of the state.
    fn place(&self, patch: &PatchModel<S, N>, physics: &Physics<N>, x: &[f64; N]) -> Result<PointState<N>, ProblemError> {
        let outside = || {
            let at = std::array::from_fn(|k| x.get(k).copied().unwrap_or(0.0));
            ProblemError::new(ErrorKind::Outside { x: at }, vec![patch.id.into()], vec![patch.name.clone()])
        };
        let found = self.places.of(patch).locate(&Vector::from(*x)).map_err(|_| outside())?;
        let states = physics.at(&**patch.body.space(), &patch.field, &self.state.u, found.element, &[found.xi]);
        states.first().copied().ok_or_else(outside)
    }
}

/// The error of a handle that the solved problem does not have.
fn other_problem() -> ProblemError {
    ProblemError::named(ErrorKind::OtherProblem, &[])
}
