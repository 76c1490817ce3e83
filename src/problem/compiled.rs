//! The longest functions of problems, compiled with the library once per dimension: programs call them and do not compile them again.

use super::builder::Problem;
use super::error::ProblemErrors;
use super::handles::BodyId;
use super::model::{BodyModel, BodySide};
use super::physics::Physics;
use super::touching::{NearPair, PairedSides, Search, TouchError};
use crate::assembly::Rim;
use crate::basis::Cell;
use crate::geometry::Sag;
use crate::space::{Body, Trace};
use std::collections::BTreeMap;
use std::fmt::Debug;
use std::sync::Arc;

/// The functions of [`Problem`] and of [`Search`] that take the most code; [`InterfaceSide::compiled`](super::InterfaceSide::compiled)
/// returns them.
pub trait Compiled<const S: usize, const N: usize>: Debug + Sync {
    /// [`Problem::check`].
    ///
    /// # Errors
    /// All that is wrong.
    fn check(&self, problem: &Problem<S, N>) -> Result<(), ProblemErrors>;

    /// [`Problem::meant_sides`].
    fn meant_sides(&self, problem: &Problem<S, N>, slave: &BodySide<S, N>, masters: &[Arc<BodySide<S, N>>])
    -> Option<[(usize, String); 2]>;

    /// A body with its handle and name, whose unknowns begin at `first`.
    fn body(
        &self,
        named: (BodyId, String),
        body: Arc<dyn Body<S, N>>,
        physics: Physics<N>,
        first: usize,
        extra_points: usize,
    ) -> BodyModel<S, N>;

    /// [`Trace::part`].
    fn part(&self, side: &Trace<S, N>, elements: &[usize], kind: Cell) -> Trace<S, N>;

    /// The points that a side shares with others.
    fn rim(&self, side: &Trace<S, N>, others: &[&Trace<S, N>], extra_points: usize) -> Rim<N>;

    /// [`Search::sag`].
    fn sag(&self, search: &Search<'_, S, N>, side: &BodySide<S, N>) -> Sag<S, N>;

    /// [`Search::tie`].
    fn tie(
        &self,
        search: &mut Search<'_, S, N>,
        slave: Arc<BodySide<S, N>>,
        masters: Vec<Arc<BodySide<S, N>>>,
        tolerance: Option<f64>,
    ) -> PairedSides<S, N>;

    /// Sides of bodies that touch, but for those of bodies that are `apart`.
    ///
    /// # Errors
    /// [`TouchError`] of the sides.
    fn touching(
        &self,
        search: &mut Search<'_, S, N>,
        bodies: &[usize],
        tolerance: Option<f64>,
        apart: &dyn Fn(usize, usize) -> bool,
    ) -> Result<Vec<PairedSides<S, N>>, TouchError<S, N>>;

    /// The nearest sides of every two bodies, with `near` only those that are near for the size of their facets.
    fn nearest_of(&self, search: &mut Search<'_, S, N>, bodies: &[usize], near: bool) -> BTreeMap<[usize; 2], NearPair<S, N>>;

    /// [`Search::unjoined`].
    fn unjoined(
        &self,
        search: &mut Search<'_, S, N>,
        contacts: &[[usize; 2]],
        outer: &[Arc<BodySide<S, N>>],
        closable: &dyn Fn(usize) -> bool,
    );
}

/// The functions of the library.
#[derive(Debug)]
pub(super) struct Library;

impl<const S: usize, const N: usize> Compiled<S, N> for Library {
    fn check(&self, problem: &Problem<S, N>) -> Result<(), ProblemErrors> {
        problem.model(0).map(|_| ())
    }
    fn meant_sides(
        &self,
        problem: &Problem<S, N>,
        slave: &BodySide<S, N>,
        masters: &[Arc<BodySide<S, N>>],
    ) -> Option<[(usize, String); 2]> {
        problem.model(0).ok()?.meant_sides(slave, masters)
    }
    fn body(
        &self,
        (id, name): (BodyId, String),
        body: Arc<dyn Body<S, N>>,
        physics: Physics<N>,
        first: usize,
        extra_points: usize,
    ) -> BodyModel<S, N> {
        BodyModel::new(id, name, body, physics, first, extra_points)
    }
    fn part(&self, side: &Trace<S, N>, elements: &[usize], kind: Cell) -> Trace<S, N> {
        side.part(elements, kind)
    }
    fn rim(&self, side: &Trace<S, N>, others: &[&Trace<S, N>], extra_points: usize) -> Rim<N> {
        Rim::shared(side, others, extra_points)
    }
    fn sag(&self, search: &Search<'_, S, N>, side: &BodySide<S, N>) -> Sag<S, N> {
        search.own_sag(side)
    }
    fn tie(
        &self,
        search: &mut Search<'_, S, N>,
        slave: Arc<BodySide<S, N>>,
        masters: Vec<Arc<BodySide<S, N>>>,
        tolerance: Option<f64>,
    ) -> PairedSides<S, N> {
        search.tie_named(slave, masters, tolerance)
    }
    fn touching(
        &self,
        search: &mut Search<'_, S, N>,
        bodies: &[usize],
        tolerance: Option<f64>,
        apart: &dyn Fn(usize, usize) -> bool,
    ) -> Result<Vec<PairedSides<S, N>>, TouchError<S, N>> {
        search.touching(bodies, tolerance, apart)
    }
    fn nearest_of(&self, search: &mut Search<'_, S, N>, bodies: &[usize], near: bool) -> BTreeMap<[usize; 2], NearPair<S, N>> {
        search.nearest_of(bodies, near)
    }
    fn unjoined(
        &self,
        search: &mut Search<'_, S, N>,
        contacts: &[[usize; 2]],
        outer: &[Arc<BodySide<S, N>>],
        closable: &dyn Fn(usize) -> bool,
    ) {
        search.find_unjoined(contacts, outer, closable);
    }
}
