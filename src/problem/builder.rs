//! Statement of a problem: bodies, supports, loads, ties, contacts.

use super::compiled::Compiled;
use super::contents::BodyView;
use super::coupled::{Contact, Tie};
use super::data::Exact;
use super::error::{ErrorKind, ProblemError, ProblemErrors};
use super::facets_apart::FacetsApart;
use super::fixed::Eliminated;
use super::handles::{BodyId, Sides, Statement};
use super::identity::Identity;
use super::interface_side::InterfaceSide;
use super::model::{BodyModel, BodySide, Model, RigidSides};
use super::regions::Regions;
use super::said::{Gluing, Said, Shared};
use crate::space::Trace;
use std::collections::HashMap;
use std::sync::Arc;

/// A problem of bodies with materials, supports, loads, ties and contacts.
///
/// Every call returns a handle, which is copied; errors and results refer to handles. A call checks what it is given alone, sides and
/// materials first; what needs the whole problem is checked by [`assemble`](Self::assemble), which returns all errors. Data are numbers or
/// functions of position and time, see [`Data`](super::Data). Components are those of the unknown: one for conduction (Poisson), one per coordinate for
/// elasticity.
///
/// A clone goes its own way and knows the handles of the problem that it was cloned from; handles that either of both makes later belong
/// to it alone.
#[derive(Debug)]
pub struct Problem<const S: usize, const N: usize> {
    pub(super) compiled: &'static dyn Compiled<S, N>,
    pub(super) identity: Identity,
    pub(super) bodies: Vec<BodyModel<S, N>>,
    pub(super) regions: Regions<S, N>,
    pub(super) said: Said<S, N>,
    /// (statement, body) of sources, and of weights.
    pub(super) volume_loads: Vec<(Statement, usize)>,
    pub(super) weight_loads: Vec<(Statement, usize)>,
    pub(super) gluings: Vec<Gluing<S, N>>,
    pub(super) shared: Vec<Shared<N>>,
    /// Number of supports, loads and joints.
    pub(super) statements: usize,
    /// The first statement of every name that loads were given.
    pub(super) groups: HashMap<String, Statement>,
    pub(super) exact: Option<Arc<dyn Exact>>,
    /// Warnings of searches for touching sides.
    pub(super) findings: Vec<FacetsApart>,
    pub(super) ties: Vec<Tie<S, N>>,
    pub(super) contacts: Vec<Contact<S, N>>,
    pub(super) times: Vec<f64>,
    /// Whether bodies are those of revolution.
    pub(super) is_revolved: bool,
    active_set: (f64, usize),
}

impl<const S: usize, const N: usize> Clone for Problem<S, N> {
    fn clone(&self) -> Self {
        let counts = [self.bodies.len(), self.regions.len(), self.ties.len(), self.contacts.len(), self.statements];
        Self {
            compiled: self.compiled,
            identity: self.identity.heir(counts),
            bodies: self.bodies.clone(),
            regions: self.regions.clone(),
            said: self.said.clone(),
            volume_loads: self.volume_loads.clone(),
            weight_loads: self.weight_loads.clone(),
            gluings: self.gluings.clone(),
            shared: self.shared.clone(),
            statements: self.statements,
            groups: self.groups.clone(),
            exact: self.exact.clone(),
            findings: self.findings.clone(),
            ties: self.ties.clone(),
            contacts: self.contacts.clone(),
            times: self.times.clone(),
            is_revolved: self.is_revolved,
            active_set: self.active_set,
        }
    }
}

impl<const S: usize, const N: usize> Default for Problem<S, N>
where
    Trace<S, N>: InterfaceSide<S, N>,
{
    fn default() -> Self {
        Self::new()
    }
}

impl<const S: usize, const N: usize> Problem<S, N>
where
    Trace<S, N>: InterfaceSide<S, N>,
{
    /// A problem without bodies.
    pub fn new() -> Self {
        Self {
            compiled: Trace::<S, N>::compiled(),
            identity: Identity::new(),
            bodies: Vec::new(),
            regions: Regions::default(),
            said: Said::default(),
            volume_loads: Vec::new(),
            weight_loads: Vec::new(),
            gluings: Vec::new(),
            shared: Vec::new(),
            statements: 0,
            groups: HashMap::new(),
            exact: None,
            findings: Vec::new(),
            ties: Vec::new(),
            contacts: Vec::new(),
            times: vec![1.0],
            is_revolved: false,
            active_set: (1.0, 100),
        }
    }

    /// A problem of bodies of revolution without bodies: x = r >= 0, y = z, nothing moves around the axis x = 0.
    ///
    /// Forces, areas, volumes and energies are those of the full circle: all integrals have the factor 2 pi r, and a force is spread evenly
    /// over the surface that its sides make on their way around. Tractions, pressures, stiffnesses and multipliers are per area or volume as
    /// ever. Component x of a force is the integral of the radial one; it has no resultant in space, and no equation of balance: like the
    /// moments, it is zero in [`Solution::balance`](super::Solution::balance). Sides on the axis hold u_r = 0 by themselves. The third normal
    /// stress, zz in the plane, is the hoop stress.
    ///
    /// Elastic materials are those with a hoop strain, [`Hooke::axisymmetric`](crate::physics::Hooke::axisymmetric); conductors serve as
    /// they are.
    ///
    /// # Panics
    /// If N is not 2.
    pub fn axisymmetric() -> Self {
        assert_eq!(N, 2, "bodies of revolution are given by their half section in the plane");
        Self { is_revolved: true, ..Self::new() }
    }
}

impl<const S: usize, const N: usize> Problem<S, N> {
    /// Number of components of the unknown, 0 before the first body.
    pub fn components(&self) -> usize {
        self.bodies.first().map_or(0, |b| b.field.components)
    }

    /// Sets the exact solution in all bodies that have none of their own: its source loads them, and they have none of their own then.
    pub fn exact(&mut self, exact: impl Exact + 'static) {
        self.exact = Some(Arc::new(exact));
    }

    /// Sets the exact solution in a body. Where one body has one, all must have one; solutions may jump between bodies.
    ///
    /// # Errors
    /// [`ErrorKind::OtherProblem`].
    pub fn exact_in(&mut self, body: BodyId, exact: impl Exact + 'static) -> Result<(), ProblemError> {
        let number = self.number(body)?;
        self.bodies[number].exact = Some(Arc::new(exact));
        Ok(())
    }

    /// The exact solution in a body.
    pub(super) fn exact_of<'a>(&'a self, body: &'a BodyModel<S, N>) -> Option<&'a Arc<dyn Exact>> {
        body.exact.as_ref().or(self.exact.as_ref())
    }

    /// Sets the times at which the problem will be solved; by default t = 1 alone. Prescribed values, materials and loads, and what moving
    /// obstacles face, are checked at all of them.
    pub fn times(&mut self, times: &[f64]) {
        if !times.is_empty() {
            self.times = times.to_vec();
        }
    }

    /// Sets the weight c of the gap beside the pressure in the active set, by default 1, and the largest number of its iterations, by
    /// default 100.
    pub fn active_set(&mut self, c: f64, max_iterations: usize) {
        self.active_set = (c, max_iterations);
    }

    /// Sides of a list.
    pub(super) fn sides(&mut self, sides: Sides<'_>) -> Result<Vec<Arc<BodySide<S, N>>>, ProblemError> {
        if sides.0.is_empty() {
            return Err(ProblemError::named(ErrorKind::NoMaster, &[]));
        }
        let all: Result<Vec<_>, _> = sides.0.into_iter().map(|side| self.sides_of(side)).collect();
        Ok(all?.concat())
    }

    /// The bodies, in the order in which they were said.
    pub fn bodies(&self) -> impl ExactSizeIterator<Item = BodyView<'_, S, N>> {
        self.bodies.iter().map(|patch| BodyView { patch })
    }

    /// Checks what is said of bodies, supports, loads and what is glued, without ties and contacts.
    ///
    /// # Errors
    /// All that is wrong.
    pub fn check(&self) -> Result<(), ProblemErrors> {
        self.compiled.check(self)
    }

    /// Supports that prescribe components of a side, with the component.
    pub fn supports_of(&self, side: &BodySide<S, N>) -> Vec<(Statement, usize)> {
        let of_side = self.said.conditions.iter().filter(|c| c.side.patch == side.patch && c.side.side == side.side);
        of_side.map(|c| (c.of, c.component)).collect()
    }

    /// Statements that make a side move as one in a component, with the component.
    pub fn moved_as_one(&self, side: &BodySide<S, N>) -> Vec<(Statement, usize)> {
        let has = |group: &&RigidSides<S, N>| group.sides.iter().any(|s| s.patch == side.patch && s.side == side.side);
        self.said.rigid_sides.iter().filter(has).map(|group| (group.of, group.component)).collect()
    }

    /// Whether supports hold a side, in components or along its normal or tangents.
    pub fn is_supported(&self, side: &BodySide<S, N>) -> bool {
        self.said.supports.iter().any(|s| s.patch == side.patch && s.side == side.side)
    }

    /// Sides of the bodies of `slave` and of `masters`, by body and name, that face each other best; `None` if they are no closer than half
    /// the distance of the named ones, which may be right but too far apart, and while bodies, supports or loads are wrong.
    pub fn meant_sides(&self, slave: &BodySide<S, N>, masters: &[Arc<BodySide<S, N>>]) -> Option<[(usize, String); 2]> {
        self.compiled.meant_sides(self, slave, masters)
    }

    /// The model without ties and contacts, with room for `pressed` unknowns of obstacles.
    ///
    /// # Errors
    /// All that is wrong with bodies, supports, loads and what is glued.
    pub(super) fn model(&self, pressed: usize) -> Result<Model<S, N>, ProblemErrors> {
        if self.bodies.is_empty() {
            return Err(ProblemError::named(ErrorKind::Empty, &[]).into());
        }
        let mut errors = Vec::new();
        self.check_materials(&mut errors);
        let (glued, hinges) = self.joined(&mut errors);
        self.check_conditions(&mut errors);
        self.check_values(&mut errors);
        self.check_obstacles(&mut errors);
        self.check_axis(&mut errors);
        if !errors.is_empty() {
            return Err(ProblemErrors(errors));
        }
        let mut bodies = self.bodies.clone();
        for body in &mut bodies {
            if body.changing.is_some() {
                body.physics = body.physics_at(self.times[0]);
            }
            body.exact = self.exact_of(body).cloned();
        }
        let mut model = Model::new(bodies, glued, hinges);
        model.unknowns += pressed;
        model.findings.clone_from(&self.findings);
        let Said { conditions, pins, supports, equations, held, slides: _, rigid_sides, loads, point_loads, springs, foundations } =
            self.said.clone();
        (model.conditions, model.pins, model.supports) = (conditions, pins, supports);
        (model.equations, model.held, model.rigid_sides) = (equations, held, rigid_sides);
        (model.loads, model.point_loads, model.springs, model.foundations) = (loads, point_loads, springs, foundations);
        (model.c, model.max_iterations) = self.active_set;
        model.hold_axis();
        model.find_corners();
        Ok(model)
    }

    /// The unknowns of a model of this problem that supports eliminate.
    ///
    /// # Errors
    /// [`ErrorKind::Prescribed`], [`ErrorKind::Contradiction`].
    pub(super) fn fixed(&self, model: &Model<S, N>) -> Result<Eliminated, ProblemError> {
        Eliminated::of(model, &self.times)
    }
}
