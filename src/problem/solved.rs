//! The work of solutions.
//!
//! Behind a trait object, as that of systems.

use super::body_locators::BodyLocators;
use super::contact_zone::HalfWidth;
use super::data::Exact;
use super::error::{ErrorKind, ProblemError};
use super::extremes::Extreme;
use super::handles::{BodyId, ContactId, InterfaceId, Region, RegionId, SideOf, TieId};
use super::identity::Identity;
use super::interface_results::{ContactResult, TieResult};
use super::lambda_error::SquaredError;
use super::lambda_field::LambdaField;
use super::matrices::Matrices;
use super::model::{BodyModel, BodySide, ContactModel, ContactPart, Model, Opposing, TieModel};
use super::physics::{OtherField, Physics, PointState};
use super::reactions::{Reaction, reactions};
use super::regions::{RegionPart, Regions};
use super::resultant::Resultant;
use super::state::StepState;
use super::warnings::Warning;
use crate::assembly::{Errors, revolved};
use crate::linalg::{Csr, Operator, Vector};
use crate::parallel;
use crate::quadrature::Quadrature;
use std::fmt::Debug;
use std::sync::{Arc, OnceLock};

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
    fn force(&self, on: Region<'_>) -> Result<Resultant, ProblemError>;
    fn reactions(&self) -> &[Reaction<S, N>];
    fn balance(&self) -> Resultant;
    fn energy(&self) -> f64;
    fn errors(&self, exact: Option<&dyn Exact>) -> Vec<Errors>;
    fn difference(&self, body: BodyId, rules: &dyn Quadrature<N>, other: &dyn OtherField<N>) -> Result<Errors, ProblemError>;
    fn extremes(&self, body: BodyId, derived: Option<bool>, field: Scalar<'_, N>) -> Result<Option<[Extreme<N>; 2]>, ProblemError>;
    fn lambda_field(self: Arc<Self>, of: InterfaceId, side: usize) -> Result<Option<LambdaField<S>>, ProblemError>;
    fn lambda_error(&self, of: InterfaceId) -> Result<SquaredError, ProblemError>;
    fn warnings(&self) -> Vec<Warning>;
}

/// A number of the state at a point.
type Scalar<'a, const N: usize> = &'a (dyn Fn(&PointState<N>) -> f64 + Sync);

/// Parts that a system and all its solutions have in common.
#[derive(Debug)]
pub(super) struct Common<const S: usize, const N: usize> {
    pub identity: Identity,
    pub regions: Regions<S, N>,
    pub places: BodyLocators<N>,
    pub model: Arc<Model<S, N>>,
    pub half_width: HalfWidth<S, N>,
}

/// A state of a model.
#[derive(Debug)]
pub(super) struct Solved<const S: usize, const N: usize> {
    pub(super) common: Arc<Common<S, N>>,
    pub(super) state: StepState<S, N>,
    /// 1/2 uᵀ K u of all bodies.
    energy: f64,
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
        &self.common.model
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
        self.common.places.of(patch);
        parallel::map(x.len(), |k| self.place(patch, &physics, &x[k]))
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
        Ok(self.of_tie(tie)?.result(&self.common.model, &self.state))
    }

    fn contact(&self, contact: ContactId) -> Result<ContactResult<N>, ProblemError> {
        Ok(self.of_contact(contact)?.result(&self.common.model, &self.state.contacts[contact.number], &self.state, self.common.half_width))
    }

    fn reaction(&self, on: Region<'_>) -> Result<Vec<f64>, ProblemError> {
        let number = match on {
            Region::Side(side) => {
                self.made(side)?;
                self.common.regions.known(side.body.number, side.name)
            }
            Region::Made(region) => Some(self.known(region)?),
        };
        let mut sum = vec![0.0; self.common.model.components];
        let Some(number) = number else { return Ok(sum) };
        let pieces = self.common.regions.pieces(number);
        for reaction in self.reactions() {
            if pieces.iter().any(|piece| piece.is(&reaction.on)) {
                sum.iter_mut().zip(&reaction.force).for_each(|(s, f)| *s += f);
            }
        }
        Ok(sum)
    }

    fn force(&self, on: Region<'_>) -> Result<Resultant, ProblemError> {
        let (model, state) = (&self.common.model, &self.state);
        let pieces = match on {
            Region::Side(side) => return Ok(model.force_through([&self.made(side)?], state)),
            Region::Made(region) => self.common.regions.pieces(self.known(region)?),
        };
        let mut sides = Vec::with_capacity(pieces.len());
        for piece in pieces {
            match piece {
                RegionPart::Side(side) => sides.push(&**side),
                RegionPart::Rim(rim) => return Err(ProblemError::named(ErrorKind::NotASide, &[&rim.label])),
            }
        }
        Ok(model.force_through(sides, state))
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

    fn errors(&self, exact: Option<&dyn Exact>) -> Vec<Errors> {
        let (t, u) = (self.state.t, &self.state.u);
        let of = |(k, p): (usize, &BodyModel<S, N>)| {
            let exact = exact.or(p.exact.as_deref())?;
            let foundation = self.common.model.foundation(k, t);
            Some(p.physics_at(t).errors(&**p.body.space(), &p.rules, foundation.as_deref(), (&u[p.range()], exact, t)))
        };
        self.common.model.patches.iter().enumerate().filter_map(of).collect()
    }

    fn difference(&self, body: BodyId, rules: &dyn Quadrature<N>, other: &dyn OtherField<N>) -> Result<Errors, ProblemError> {
        let patch = self.patch(body)?;
        let foundation = self.common.model.foundation(body.number, self.state.t);
        let (physics, own, space) = (patch.physics_at(self.state.t), &self.state.u[patch.range()], &**patch.body.space());
        let around = patch.is_revolved().then(|| revolved(space, rules));
        let rules = around.as_ref().map_or(rules, |rules| rules);
        Ok(physics.difference(space, rules, foundation.as_deref(), (own, other)))
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
            InterfaceId::Tie(tie) => self.of_tie(tie)?.lambda_error(&self.common.model, &self.state),
            InterfaceId::Contact(contact) => {
                self.of_contact(contact)?.lambda_error(&self.common.model, &self.state.contacts[contact.number], &self.state)
            }
        })
    }

    fn warnings(&self) -> Vec<Warning> {
        self.common.model.state_warnings(&self.state)
    }
}

impl<const S: usize, const N: usize> Solved<S, N> {
    /// A state with its answers, by the matrices of its time.
    pub(super) fn new(common: &Arc<Common<S, N>>, matrices: &Matrices, state: StepState<S, N>) -> Self {
        let bodies = common.model.patches.iter().zip(&matrices.bodies);
        let energy = bodies.map(|(p, k)| energy(k, &state.u[p.range()])).sum();
        Self { common: Arc::clone(common), state, energy, outside: OnceLock::new() }
    }

    fn patch(&self, body: BodyId) -> Result<&BodyModel<S, N>, ProblemError> {
        // a body may have been added after the system was made
        self.common.model.patches.get(body.number).filter(|_| self.common.identity.knows(body)).ok_or_else(other_problem)
    }

    /// A side of a body.
    fn made(&self, side: SideOf<'_>) -> Result<BodySide<S, N>, ProblemError> {
        let patch = self.patch(side.body)?;
        let refused = |error| ProblemError::new(ErrorKind::Side(error), vec![side.body.into()], vec![patch.name.clone()]);
        BodySide::new(patch, side.body.number, side.name, side.name.to_owned()).map_err(refused)
    }

    /// Number of a region that was made before the system.
    fn known(&self, region: RegionId) -> Result<usize, ProblemError> {
        let there = self.common.identity.knows(region) && region.number < self.common.regions.len();
        if there { Ok(region.number) } else { Err(other_problem()) }
    }

    /// Reactions, and the sum of all external forces: of loads, obstacles and supports.
    fn outside(&self) -> &(Vec<Reaction<S, N>>, Resultant) {
        self.outside.get_or_init(|| {
            let mut outside = self.state.load;
            for (contact, built) in self.common.model.contacts.iter().zip(&self.state.contacts) {
                for (part, rows) in contact.parts.iter().zip(built).filter(|(part, _)| matches!(part.against, Opposing::Rigid(..))) {
                    let sent = part.transmitted(rows, &self.state.lambda[part.rows()]);
                    let mut force = [0.0; 3];
                    force[..N].copy_from_slice(sent.force.as_slice());
                    // the force that drives the obstacle is among the loads
                    contact.obstacle.iter().flat_map(|o| &o.pressed).for_each(|p| force[p.component] = 0.0);
                    outside.sum(&Resultant { force, moment: sent.moment });
                }
            }
            let reactions = reactions(&self.common.model, &self.state, &mut outside);
            (reactions, self.common.model.balanced(outside))
        })
    }

    pub(super) fn of_tie(&self, tie: TieId) -> Result<&TieModel<S, N>, ProblemError> {
        self.common.model.ties.get(tie.number).filter(|_| self.common.identity.knows(tie)).ok_or_else(other_problem)
    }

    pub(super) fn of_contact(&self, contact: ContactId) -> Result<&ContactModel<S, N>, ProblemError> {
        self.common.model.contacts.get(contact.number).filter(|_| self.common.identity.knows(contact)).ok_or_else(other_problem)
    }

    /// The state at a point of a body with its material at the time of the state.
    fn place(&self, patch: &BodyModel<S, N>, physics: &Physics<N>, x: &[f64; N]) -> Result<PointState<N>, ProblemError> {
        let outside = || {
            let at = std::array::from_fn(|k| x.get(k).copied().unwrap_or(0.0));
            ProblemError::new(ErrorKind::Outside { x: at }, vec![patch.id.into()], vec![patch.name.clone()])
        };
        let found = self.common.places.of(patch).locate(&Vector::from(*x)).map_err(|_| outside())?;
        let states = physics.at(&**patch.body.space(), &patch.field, &self.state.u, found.element, &[found.xi]);
        states.first().copied().ok_or_else(outside)
    }
}

/// The error of a handle that the solved problem does not have.
fn other_problem() -> ProblemError {
    ProblemError::named(ErrorKind::OtherProblem, &[])
}
