//! Statement of a problem: bodies, supports, loads, ties, contacts.

use super::assembled::System;
use super::contact_part::ContactSetup;
use super::data::{Data, Exact};
use super::fixed::Fixed;
use super::glued::Glued;
use super::handles::{BodyId, Components, SideOf, Sides};
use super::interfaces::{ContactOf, Faced, Opposite, Tie};
use super::model::{Action, Condition, ContactModel, Model, PatchModel, SideLoad, SideModel, SideSpring, TieModel, Value};
use super::obstacle::{ObstacleModel, Pressed};
use super::physics::Physics;
use super::problem_error::ProblemError;
use super::rigid_bodies::RigidBodies;
use super::rigid_rows::closed_forms;
use super::supports::{Ties, free_by, held_by, sentences};
use super::tie_part::{Memberships, TieSetup};
use crate::assembly::measure;
use crate::contact::Obstacle;
use crate::coupling::multiplier::MultiplierKind;
use crate::physics::Material;
use crate::space::{Body, Near};
use std::collections::HashMap;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// A problem of bodies with materials, supports, loads, ties and contacts.
///
/// Bodies and sides are named by handles, which are copied. Everything is checked where it is said, sides and materials first; what needs
/// the whole problem is checked by [`assemble`](Self::assemble). Data are numbers or functions of position and time, see [`Data`].
/// Components are those of the unknown: one for conduction (Poisson), one per coordinate for elasticity.
#[derive(Debug)]
pub struct Problem<const S: usize, const N: usize> {
    id: u64,
    bodies: Vec<PatchModel<S, N>>,
    sides: HashMap<(usize, String), Arc<SideModel<S, N>>>,
    glued: Vec<(Arc<SideModel<S, N>>, Arc<SideModel<S, N>>)>,
    conditions: Vec<Condition<S, N>>,
    loads: Vec<SideLoad<S, N>>,
    springs: Vec<SideSpring<S, N>>,
    exact: Option<Arc<dyn Exact>>,
    interfaces: Interfaces,
    times: Vec<f64>,
}

/// Ties and contacts; empty in space.
#[derive(Debug, Default)]
struct Interfaces {
    ties: Vec<Tie>,
    contacts: Vec<ContactOf>,
}

/// Number of problems made so far.
static MADE: AtomicU64 = AtomicU64::new(0);

impl<const S: usize, const N: usize> Default for Problem<S, N> {
    fn default() -> Self {
        Self::new()
    }
}

impl<const S: usize, const N: usize> Problem<S, N> {
    /// A problem without bodies.
    pub fn new() -> Self {
        Self {
            id: MADE.fetch_add(1, Ordering::Relaxed),
            bodies: Vec::new(),
            sides: HashMap::new(),
            glued: Vec::new(),
            conditions: Vec::new(),
            loads: Vec::new(),
            springs: Vec::new(),
            exact: None,
            interfaces: Interfaces::default(),
            times: vec![1.0],
        }
    }

    /// Adds a body of a linear material of C components: 1, or one per coordinate.
    ///
    /// # Errors
    /// [`ProblemError`] for a name that is taken, and for a material that is not linear or has another number of components.
    pub fn body<const C: usize>(
        &mut self,
        name: &str,
        body: impl Body<S, N> + 'static,
        material: impl Material<C, N> + 'static,
    ) -> Result<BodyId, ProblemError> {
        let physics = Physics::new::<C>(material).map_err(|error| ProblemError::Material { body: name.into(), error })?;
        if self.bodies.iter().any(|b| b.name == name) {
            return Err(ProblemError::Name { name: name.into() });
        }
        let expected = self.bodies.first().map_or(physics.components(), |b| b.field.components);
        if physics.components() != expected {
            return Err(ProblemError::Mixed { body: name.into(), found: physics.components(), expected });
        }
        let first = self.bodies.last().map_or(0, |b| b.range().end);
        self.bodies.push(PatchModel::new(name.into(), Arc::new(body), physics, first, 0));
        Ok(BodyId { problem: self.id, number: self.bodies.len() - 1 })
    }

    /// Loads a body by a force per volume, or a source; one function per component.
    ///
    /// # Errors
    /// [`ProblemError`] for another number of components, and for a body of another problem.
    pub fn source(&mut self, body: BodyId, force: Vec<Data>) -> Result<(), ProblemError> {
        let components = self.bodies[self.number(body)?].field.components;
        if force.len() != components {
            return Err(ProblemError::Component { component: force.len(), components });
        }
        self.bodies[body.number].source = force;
        Ok(())
    }

    /// Prescribes components of a side to be zero.
    ///
    /// # Errors
    /// [`ProblemError`] for a side or a component that does not exist.
    pub fn fix(&mut self, side: SideOf<'_>, components: Components) -> Result<(), ProblemError> {
        self.condition(side, components, &Value::Zero)
    }

    /// Prescribes a component of a side.
    ///
    /// # Errors
    /// [`ProblemError`] for a side or a component that does not exist.
    pub fn prescribe(&mut self, side: SideOf<'_>, component: usize, value: impl Into<Data>) -> Result<(), ProblemError> {
        self.condition(side, Components::One(component), &Value::Data(value.into()))
    }

    /// Prescribes the [`exact`](Self::exact) solution on a side.
    ///
    /// # Errors
    /// [`ProblemError`] for a side or a component that does not exist. A problem without an exact solution is not assembled.
    pub fn prescribe_exact(&mut self, side: SideOf<'_>, components: Components) -> Result<(), ProblemError> {
        self.condition(side, components, &Value::Exact)
    }

    /// Applies a component of a traction [force/area], or of a flux k du/dn.
    ///
    /// # Errors
    /// [`ProblemError`] for a side or a component that does not exist.
    pub fn traction(&mut self, side: SideOf<'_>, component: usize, traction: impl Into<Data>) -> Result<(), ProblemError> {
        let (side, component) = (self.side(side)?, self.component(component)?);
        self.load(side, Action::Traction(component, traction.into()));
        Ok(())
    }

    /// Applies a component of the traction of the [`exact`](Self::exact) solution.
    ///
    /// # Errors
    /// [`ProblemError`] for a side or a component that does not exist. A problem without an exact solution is not assembled.
    pub fn traction_exact(&mut self, side: SideOf<'_>, component: usize) -> Result<(), ProblemError> {
        let (side, component) = (self.side(side)?, self.component(component)?);
        self.load(side, Action::Exact(component));
        Ok(())
    }

    /// Applies a pressure [force/area] along minus the outward normal.
    ///
    /// # Errors
    /// [`ProblemError`] for a side that does not exist, and in problems of one component.
    pub fn pressure(&mut self, side: SideOf<'_>, pressure: impl Into<Data>) -> Result<(), ProblemError> {
        let side = self.side(side)?;
        if side.field.components == 1 {
            return Err(ProblemError::Scalar { name: side.label.clone() });
        }
        self.load(side, Action::Pressure(pressure.into()));
        Ok(())
    }

    /// Applies a component of a force, spread evenly over a side.
    ///
    /// # Errors
    /// [`ProblemError`] for a side or a component that does not exist.
    pub fn force(&mut self, side: SideOf<'_>, component: usize, force: impl Into<Data>) -> Result<(), ProblemError> {
        let (side, component) = (self.side(side)?, self.component(component)?);
        let area = measure(&*side.trace.space, &side.rules);
        self.load(side, Action::Force(component, force.into(), area));
        Ok(())
    }

    fn load(&mut self, side: Arc<SideModel<S, N>>, action: Action) {
        self.loads.push(SideLoad { name: side.label.clone(), side, action });
    }

    /// Puts springs [force/area per length] between a side and the ground.
    ///
    /// # Errors
    /// [`ProblemError`] for a side or a component that does not exist.
    pub fn spring(&mut self, side: SideOf<'_>, component: usize, stiffness: impl Into<Data>) -> Result<(), ProblemError> {
        let (side, component) = (self.side(side)?, self.component(component)?);
        self.springs.push(SideSpring { name: side.label.clone(), side, component, stiffness: stiffness.into() });
        Ok(())
    }

    /// Sets the exact solution: its source loads all bodies, which have none of their own then.
    pub fn exact(&mut self, exact: impl Exact + 'static) {
        self.exact = Some(Arc::new(exact));
    }

    /// Glues a side to another of the same grid and functions: they share their unknowns.
    ///
    /// # Errors
    /// [`ProblemError`] for a side that does not exist.
    pub fn glue(&mut self, slave: SideOf<'_>, master: SideOf<'_>) -> Result<(), ProblemError> {
        let pair = (self.side(slave)?, self.side(master)?);
        self.glued.push(pair);
        Ok(())
    }

    /// Sets the times at which the problem will be solved; by default t = 1 alone. Prescribed values, and what moving obstacles face, are
    /// checked at all of them.
    pub fn times(&mut self, times: &[f64]) {
        if !times.is_empty() {
            self.times = times.to_vec();
        }
    }

    /// Number of a body.
    fn number(&self, body: BodyId) -> Result<usize, ProblemError> {
        if body.problem == self.id { Ok(body.number) } else { Err(ProblemError::OtherProblem) }
    }

    fn component(&self, component: usize) -> Result<usize, ProblemError> {
        let components = self.bodies.first().map_or(0, |b| b.field.components);
        if component < components { Ok(component) } else { Err(ProblemError::Component { component, components }) }
    }

    /// A side, made once.
    fn side(&mut self, side: SideOf<'_>) -> Result<Arc<SideModel<S, N>>, ProblemError> {
        let number = self.number(side.body)?;
        if let Some(known) = self.sides.get(&(number, side.name.to_owned())) {
            return Ok(known.clone());
        }
        let body = &self.bodies[number];
        let label = format!("{}.{}", body.name, side.name);
        let made = SideModel::new(body, number, side.name, label);
        let made = Arc::new(made.map_err(|error| ProblemError::Side { body: body.name.clone(), error })?);
        self.sides.insert((number, side.name.to_owned()), made.clone());
        Ok(made)
    }

    fn sides(&mut self, sides: Sides<'_>) -> Result<Vec<Arc<SideModel<S, N>>>, ProblemError> {
        if sides.0.is_empty() {
            return Err(ProblemError::NoMaster);
        }
        sides.0.into_iter().map(|side| self.side(side)).collect()
    }

    fn condition(&mut self, side: SideOf<'_>, components: Components, value: &Value) -> Result<(), ProblemError> {
        let side = self.side(side)?;
        let all = match components {
            Components::All => 0..side.field.components,
            Components::One(c) => {
                let c = self.component(c)?;
                c..c + 1
            }
        };
        self.conditions.extend(all.map(|component| Condition { side: side.clone(), component, value: value.clone() }));
        Ok(())
    }

    /// The model without ties and contacts, with room for `pressed` unknowns of obstacles.
    fn model(&self, pressed: usize) -> Result<Model<S, N>, ProblemError> {
        let components = self.bodies.first().ok_or(ProblemError::Empty)?.field.components;
        if let Some(body) = self.bodies.iter().find(|b| self.exact.is_some() && !b.source.is_empty()) {
            return Err(ProblemError::SourceTwice { body: body.name.clone() });
        }
        let prescribed = self.conditions.iter().filter(|c| matches!(c.value, Value::Exact)).map(|c| &c.side);
        let loaded = self.loads.iter().filter(|l| matches!(l.action, Action::Exact(_))).map(|l| &l.side);
        if let Some(side) = prescribed.chain(loaded).find(|_| self.exact.is_none()) {
            return Err(ProblemError::NoExact { side: side.label.clone() });
        }
        let functions = self.bodies.last().map_or(0, |b| b.range().end) / components;
        let mut glued = Glued::new(components, functions, self.bodies.len());
        for (slave, master) in &self.glued {
            let exact = [slave, master].iter().all(|s| self.bodies[s.patch].exact_map);
            let near = if exact { Near::Exact } else { Near::Corners };
            let faults = |error| ProblemError::Glue { slave: slave.label.clone(), master: master.label.clone(), error };
            glued.add(&self.bodies, slave, std::slice::from_ref(master), near).map_err(faults)?;
        }
        glued.finish();
        let mut model = Model::new(self.bodies.clone(), glued, Vec::new());
        model.unknowns += pressed;
        model.exact.clone_from(&self.exact);
        model.conditions.clone_from(&self.conditions);
        for condition in &self.conditions {
            if !model.supports.iter().any(|s| Arc::ptr_eq(s, &condition.side)) {
                model.supports.push(condition.side.clone());
            }
        }
        model.loads.clone_from(&self.loads);
        model.springs.clone_from(&self.springs);
        model.find_corners();
        Ok(model)
    }

    /// Checks that nothing can move as a rigid body with every contact closed: neither where points of ties hold nor where only the
    /// functions of multipliers do.
    fn held(model: &Model<S, N>) -> Result<(), ProblemError> {
        let first: Vec<Vec<_>> = model.contacts.iter().map(|c| c.parts.iter().map(|p| &p.first).collect()).collect();
        let mut free = free_by(model, &first, &|_, _, _| true, Ties::Points);
        if free.is_empty() {
            let bodies = RigidBodies::of(model);
            let (modes, mut forms) = held_by(model, &bodies, &model.springs, Ties::Functions);
            forms.extend(closed_forms(model, &modes, &bodies));
            let left = modes.names(&modes.null(&forms)).into_iter();
            free = left.map(|f| bodies.numbered(model, &modes, f)).collect();
        }
        if free.is_empty() { Ok(()) } else { Err(ProblemError::Motions { motions: sentences(model, &free) }) }
    }
}

impl Problem<1, 2> {
    /// Ties a slave side to a master side, or to several that cover it together.
    ///
    /// # Errors
    /// [`ProblemError`] for a side that does not exist. Sides that do not meet are found when the problem is assembled.
    pub fn tie<'a>(&mut self, slave: SideOf<'_>, masters: impl Into<Sides<'a>>) -> Result<&mut Tie, ProblemError> {
        let (slave, masters) = (self.side(slave)?, self.sides(masters.into())?);
        let name = format!("{} - {}", slave.label, labels(&masters));
        self.interfaces.ties.push(Tie::new(name, slave, masters));
        Ok(self.interfaces.ties.last_mut().expect("just pushed"))
    }

    /// Presses a slave side against another side, several sides or a rigid obstacle.
    ///
    /// # Errors
    /// [`ProblemError`] for a side that does not exist, and in problems of one component.
    pub fn contact<'a>(&mut self, slave: SideOf<'_>, opposite: impl Into<Opposite<'a>>) -> Result<&mut ContactOf, ProblemError> {
        let slave = self.side(slave)?;
        let (opponent, faced) = match opposite.into() {
            Opposite::Sides(masters) => {
                let masters = self.sides(masters)?;
                (labels(&masters), Faced::Sides(masters))
            }
            Opposite::Obstacle(obstacle) => ("obstacle".to_owned(), Faced::Obstacle(obstacle)),
        };
        let name = format!("{} - {opponent}", slave.label);
        if slave.field.components == 1 {
            return Err(ProblemError::Scalar { name });
        }
        self.interfaces.contacts.push(ContactOf::new(name, slave, faced));
        Ok(self.interfaces.contacts.last_mut().expect("just pushed"))
    }

    /// Builds ties and contacts and checks the whole problem: prescribed values, sides that meet, multipliers, rigid motions.
    ///
    /// # Errors
    /// [`ProblemError`] with what is wrong.
    pub fn assemble(&self) -> Result<System<1, 2>, ProblemError> {
        self.check_interfaces()?;
        let Interfaces { ties, contacts } = &self.interfaces;
        let pressed: usize = contacts.iter().map(|c| c.forces.len()).sum();
        let mut model = self.model(pressed)?;
        let fixed = Fixed::of(&model, &self.times)?;
        let mut members = Memberships::default();
        for tie in ties.iter().filter(|t| (t.coupling)().has_rows()) {
            tie.masters.iter().chain([&tie.slave]).for_each(|side| members.add(&model, side));
        }
        for tie in ties {
            let refused = |error| ProblemError::Interface { name: tie.name.clone(), slave: tie.slave.label.clone(), error };
            let setup = TieSetup {
                slave: &tie.slave,
                masters: &tie.masters,
                coupling: (tie.coupling)(),
                mortar_rows: tie.mortar_rows,
                multiplier: &|trace, constrained| tie.multiplier.make(trace, constrained),
                rules: tie.integration.rules(tie.extra_points, false),
                tolerance: tie.tolerance,
                explained: None,
                t: self.times[0],
            };
            let part = model.tie_part(setup, &fixed, &members).map_err(refused)?;
            model.rows += part.num_rows;
            model.ties.push(TieModel { name: tie.name.clone(), parts: vec![part], exact: None });
        }
        let mut next = model.unknowns - pressed;
        for contact in contacts {
            let built = self.contact_model(&model, contact, next, &fixed, &members)?;
            next += contact.forces.len();
            model.rows += built.parts[0].num_rows;
            model.contacts.push(built);
        }
        Self::held(&model)?;
        Ok(System::new(model, self.id, self.times.clone()))
    }

    /// Names that are taken, slave sides that are so twice, and motions and forces of contacts.
    fn check_interfaces(&self) -> Result<(), ProblemError> {
        let Interfaces { ties, contacts } = &self.interfaces;
        let names: Vec<&String> = ties.iter().map(|t| &t.name).chain(contacts.iter().map(|c| &c.name)).collect();
        if let Some(twice) = names.iter().enumerate().find(|(k, name)| names[..*k].contains(name)) {
            return Err(ProblemError::Name { name: (*twice.1).clone() });
        }
        let slaves: Vec<_> = ties.iter().map(|t| &t.slave).collect();
        if let Some(twice) = slaves.iter().enumerate().find(|(k, side)| slaves[..*k].iter().any(|s| Arc::ptr_eq(s, side))) {
            return Err(ProblemError::SlaveTwice { side: twice.1.label.clone() });
        }
        let pairs = ties.iter().flat_map(|t| t.masters.iter().map(|m| (&t.slave, m)));
        let pairs: Vec<_> = pairs
            .chain(contacts.iter().flat_map(|c| match &c.faced {
                Faced::Sides(masters) => masters.iter().map(|m| (&c.slave, m)).collect(),
                Faced::Obstacle(_) => Vec::new(),
            }))
            .collect();
        let meets = |a: &(&Arc<_>, &Arc<_>), b: &(&Arc<_>, &Arc<_>)| Arc::ptr_eq(a.0, b.1) && Arc::ptr_eq(a.1, b.0);
        if let Some(twice) = pairs.iter().find(|a| pairs.iter().any(|b| meets(a, b))) {
            return Err(ProblemError::BothWays { slave: twice.0.label.clone(), master: twice.1.label.clone() });
        }
        for contact in contacts {
            let driven = || contact.motion.iter().chain(&contact.forces).map(|(component, _)| *component);
            if matches!(contact.faced, Faced::Sides(_)) && driven().next().is_some() {
                return Err(ProblemError::NoObstacle { name: contact.name.clone() });
            }
            if let Some(component) = driven().find(|c| *c >= 2 || driven().filter(|other| other == c).count() > 1) {
                return Err(ProblemError::Driven { name: contact.name.clone(), component });
            }
        }
        Ok(())
    }

    /// A contact with its part; the unknowns of its obstacle begin at `unknown`.
    fn contact_model(
        &self,
        model: &Model<1, 2>,
        contact: &ContactOf,
        unknown: usize,
        fixed: &Fixed,
        tied: &Memberships,
    ) -> Result<ContactModel<1, 2>, ProblemError> {
        let (slave, multiplier) = (&contact.slave, &contact.multiplier);
        let refused = |error| ProblemError::Interface { name: contact.name.clone(), slave: slave.label.clone(), error };
        let (obstacle, masters) = match &contact.faced {
            Faced::Sides(masters) => (None, masters.as_slice()),
            Faced::Obstacle(shape) => (Some(Arc::new(obstacle(contact, shape, unknown))), &[][..]),
        };
        let mut built = ContactModel {
            name: contact.name.clone(),
            parts: Vec::new(),
            obstacle,
            gap: contact.gap.clone(),
            reach: contact.reach,
            exact: None,
            symmetry: contact.symmetry,
            start: contact.start,
            formulation: contact.formulation,
        };
        let field = model.patches[slave.patch].field;
        let is_dual = matches!(multiplier, super::interfaces::Multiplier::Kind(MultiplierKind::Dual));
        let is_made = matches!(multiplier, super::interfaces::Multiplier::Made(_));
        // a function on the slave sides of two contacts would get two multipliers
        let others: Vec<_> = self.interfaces.contacts.iter().map(|c| &c.slave).filter(|s| s.patch != slave.patch).collect();
        let on = |side: &SideModel<1, 2>, function| side.trace.dofs.iter().any(|&dof| model.function(side.patch, dof) == function);
        let setup = ContactSetup {
            slave,
            masters,
            multiplier: &|trace, constrained| multiplier.make(trace, constrained),
            covered: is_dual.then_some(super::multipliers::covered_dual),
            cut: (!is_dual && !is_made)
                .then_some(|psi, trace, segments| crate::coupling::multiplier::without_slivers(psi, &*trace.space, segments)),
            cone: contact.cone,
            rules: contact.integration.rules(contact.extra_points, true),
            times: &self.times,
            taken: &|function, c| fixed.is(field.unknown(function, c)) || tied.count(model, slave.patch, function) > 0,
            on_seam: &|function| {
                let function = model.function(slave.patch, function);
                !model.glued.is_empty() && others.iter().any(|side| on(side, function))
            },
        };
        let part = model.contact_part(&built, &setup).map_err(refused)?;
        built.parts.push(part);
        Ok(built)
    }
}

impl Problem<2, 3> {
    /// Checks the whole problem: prescribed values, rigid motions.
    ///
    /// # Errors
    /// [`ProblemError`] with what is wrong.
    pub fn assemble(&self) -> Result<System<2, 3>, ProblemError> {
        let model = self.model(0)?;
        Fixed::of(&model, &self.times)?;
        Self::held(&model)?;
        Ok(System::new(model, self.id, self.times.clone()))
    }
}

/// Names of sides in a sentence.
fn labels<const S: usize, const N: usize>(sides: &[Arc<SideModel<S, N>>]) -> String {
    sides.iter().map(|s| s.label.as_str()).collect::<Vec<_>>().join(", ")
}

/// The obstacle of a contact, whose motions and forces have components of the plane.
fn obstacle(contact: &ContactOf, shape: &Arc<dyn Obstacle<1, 2>>, unknown: usize) -> ObstacleModel<1, 2> {
    let pressed = contact.forces.iter().enumerate();
    let pressed = pressed.map(|(k, (component, force))| Pressed { component: *component, unknown: unknown + k, force: force.clone() });
    let mut motion = vec![None; 2];
    for (component, by) in &contact.motion {
        motion[*component] = Some(by.clone());
    }
    let changes = motion.iter().flatten().any(Data::depends_on_time);
    let shape = shape.clone();
    ObstacleModel { at_rest: Box::new(move |_| Box::new(shape.clone())), motion, pressed: pressed.collect(), changes }
}
