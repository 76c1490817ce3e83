//! The solution of a problem at a time.

use super::contents::Contents;
use super::data::Exact;
use super::error::ProblemError;
use super::extremes::Extreme;
use super::handles::{BodyId, ContactId, InterfaceId, Region, TieId};
use super::interface_results::{ContactResult, TieResult};
use super::lambda_error::SquaredError;
use super::lambda_field::LambdaField;
use super::loads::LoadSum;
use super::physics::{OtherField, PointState};
use super::reactions::Reaction;
use super::resultant::Resultant;
use super::solved::State;
use super::warnings::Warning;
use crate::assembly::Errors;
use crate::constraint::ActiveSetReport;
use crate::quadrature::Quadrature;
use std::sync::Arc;

/// The solution of a problem at a time.
#[derive(Clone, Debug)]
pub struct Solution<const S: usize, const N: usize> {
    pub(super) inner: Arc<dyn State<S, N>>,
}

impl<const S: usize, const N: usize> Solution<S, N> {
    /// Bodies, ties, contacts and supports of the system, and their sizes.
    pub fn contents(&self) -> Contents<'_, S, N> {
        Contents { model: self.inner.model() }
    }

    /// Its time.
    pub fn t(&self) -> f64 {
        self.inner.state().t
    }

    /// All unknowns, body by body: coefficients of their functions, component by component within each; then the places of obstacles that
    /// forces press.
    pub fn unknowns(&self) -> &[f64] {
        &self.inner.state().u
    }

    /// The multipliers of all rows: coefficients of lambda [force/area].
    pub fn multipliers(&self) -> &[f64] {
        &self.inner.state().lambda
    }

    /// The linear algebra that found it.
    pub fn linear(&self) -> Linear<'_> {
        let state = self.inner.state();
        let (residual, condition) = (state.residual, state.condition);
        Linear { method: &state.method, residual, condition, iterations: state.iterations, factors: state.factors, free: state.free }
    }

    /// The iteration that found the closed rows of contacts; `None` without contacts.
    pub fn active_set(&self) -> Option<&ActiveSetReport> {
        self.inner.state().active_set.as_ref()
    }

    /// Force and moment of every load, as the rules of the problem integrate it.
    pub fn loads(&self) -> &[LoadSum] {
        &self.inner.state().loads
    }

    /// Forces of all supports on their bodies: sides first, then edges and corners.
    pub fn reactions(&self) -> &[Reaction<S, N>] {
        self.inner.reactions()
    }

    /// Sum of all external forces and of their moments about the origin: loads, springs, foundations, reactions, and forces of obstacles. It vanishes
    /// up to rounding where both sides of ties and contacts are integrated on the same pieces and the functions of their bodies hold rotations; mixed
    /// integration, and moments of Lagrange functions on exact maps, leave what falls with the mesh.
    pub fn balance(&self) -> Resultant {
        self.inner.balance()
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

    /// Force of the stresses on the sides of a region and its moment about the origin, ∫ sigma n ds with n out of the body: what lies beyond
    /// the sides does to it. It converges with the mesh; loads, reactions, ties and contacts know their forces exactly. Of conduction the
    /// flux ∫ k du/dn ds.
    ///
    /// # Errors
    /// [`ProblemError`] for a side that does not exist, for a region that was made after the system, and
    /// [`ErrorKind::NotASide`](super::ErrorKind::NotASide) for one of edges or corners.
    pub fn force<'a>(&self, on: impl Into<Region<'a>>) -> Result<Resultant, ProblemError> {
        self.inner.force(on.into())
    }

    /// Doubts about the solution: large strains, moments that are lost, coarse zones, inexact interfaces, rounding.
    pub fn warnings(&self) -> Vec<Warning> {
        self.inner.warnings()
    }

    /// 1/2 uᵀ K u of all bodies, their springs and foundations included \[force length\].
    pub fn energy(&self) -> f64 {
        self.inner.energy()
    }

    /// lambda on the slave side with a number, from 0, of a tie or a contact; `None` if there is no such side. The first points that are
    /// asked for where there is no multiplier build a tree over the elements of the masters.
    ///
    /// # Errors
    /// [`ErrorKind::OtherProblem`](super::ErrorKind::OtherProblem) as for [`multiplier`](Self::multiplier).
    pub fn lambda(&self, of: impl Into<InterfaceId>, side: usize) -> Result<Option<LambdaField<S>>, ProblemError> {
        Arc::clone(&self.inner).lambda_field(of.into(), side)
    }

    /// Squares of the L2 norms of the error of lambda over the slave sides, and of the exact lambda: the own one of the tie or the contact,
    /// else that of the problem's exact solution, zero without any; NaN if it is open which piece of it a slave side has.
    ///
    /// # Errors
    /// [`ErrorKind::OtherProblem`](super::ErrorKind::OtherProblem) as for [`multiplier`](Self::multiplier).
    pub fn lambda_error(&self, of: impl Into<InterfaceId>) -> Result<SquaredError, ProblemError> {
        self.inner.lambda_error(of.into())
    }

    /// The least and the greatest value of `field` over the closed elements of a body, with their places; `None` if it is not finite
    /// everywhere, or there are no elements. `derived`: whether the field takes derivatives of u, which have no value where a map
    /// collapses.
    ///
    /// # Errors
    /// [`ErrorKind::OtherProblem`](super::ErrorKind::OtherProblem) for a body of another problem.
    pub fn extremes(
        &self,
        body: BodyId,
        derived: bool,
        field: &(dyn Fn(&PointState<N>) -> f64 + Sync),
    ) -> Result<Option<[Extreme<N>; 2]>, ProblemError> {
        self.inner.extremes(body, Some(derived), field)
    }

    /// As [`extremes`](Self::extremes), over the points of integration alone.
    ///
    /// # Errors
    /// [`ErrorKind::OtherProblem`](super::ErrorKind::OtherProblem) for a body of another problem.
    pub fn extremes_at_points(
        &self,
        body: BodyId,
        field: &(dyn Fn(&PointState<N>) -> f64 + Sync),
    ) -> Result<Option<[Extreme<N>; 2]>, ProblemError> {
        self.inner.extremes(body, None, field)
    }

    /// Norms of the difference from another field on a body, by `rules` on its elements.
    ///
    /// # Errors
    /// [`ErrorKind::OtherProblem`](super::ErrorKind::OtherProblem) for a body of another problem.
    pub fn difference(&self, body: BodyId, rules: &dyn Quadrature<N>, other: &dyn OtherField<N>) -> Result<Errors, ProblemError> {
        self.inner.difference(body, rules, other)
    }

    /// Norms of the error against an exact solution, per body.
    pub fn errors(&self, exact: &dyn Exact) -> Vec<Errors> {
        self.inner.errors(Some(exact))
    }

    /// Norms of the error against the exact solution of the problem, per body that has one.
    pub fn own_errors(&self) -> Vec<Errors> {
        self.inner.errors(None)
    }
}

/// The linear algebra of a solution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Linear<'a> {
    /// Description of the method.
    pub method: &'a str,
    /// Relative residual of the system.
    pub residual: f64,
    /// Condition number of the scaled system, if a factor provides it.
    pub condition: Option<f64>,
    /// Iterations of the linear algebra, 0 if everything was done by factors.
    pub iterations: usize,
    /// Number of factorisations of whole systems.
    pub factors: usize,
    /// Number of unknowns that are free.
    pub free: usize,
}
