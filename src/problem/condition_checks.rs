//! Checks of what is prescribed and loaded together: components prescribed twice, loads on what is held, exact data without exact solution.

use super::builder::Problem;
use super::coupled::StatedOpponent;
use super::error::{ErrorKind, ProblemError};
use super::handles::Statement;
use super::model::{Action, BodySide, Condition, Value};
use super::rigid_bodies::unit;
use crate::basis::Order;
use crate::geometry::{MapTable, cell};
use crate::linalg::Vector;
use crate::quadrature::Quadrature;
use std::collections::{HashMap, HashSet};
use std::sync::Arc;

/// Local coordinates of a facet's centre are compared in steps of this size.
const SAME_FACET: f64 = 1e-6;

/// Sines below this are those of parallel directions, loads below this share of those beside them none.
const ALONG: f64 = 1e-9;

/// A facet of a body: the body, the element, and its centre in the element.
type Facet<const N: usize> = (usize, usize, [i64; N]);

/// The facets of a side.
fn facets<const S: usize, const N: usize>(side: &BodySide<S, N>) -> impl Iterator<Item = Facet<N>> + '_ {
    side.trace.facets.iter().enumerate().map(|(e, facet)| {
        let center = facet.lift(&cell::center(side.trace.space.cell(e)));
        (side.patch, facet.element, std::array::from_fn(|k| (center[k] / SAME_FACET).round() as i64))
    })
}

impl<const S: usize, const N: usize> Problem<S, N> {
    /// Components that are prescribed twice, loads that act on what is held, values of an exact solution that is not there, sources and
    /// foundations beside one.
    pub(super) fn check_conditions(&self, errors: &mut Vec<ProblemError>) {
        let exact = |patch: usize| self.exact_of(&self.bodies[patch]);
        let of_sides = self.said.conditions.iter().map(|c| (c.of, &c.side.label, &c.value, c.side.patch));
        for (of, label, value, patch) in of_sides.chain(self.said.pins.iter().map(|p| (p.of, &p.rim.label, &p.value, p.rim.patch))) {
            if let (Value::Exact, None) = (value, exact(patch)) {
                errors.push(ProblemError::new(ErrorKind::NoExact, vec![of], vec![label.clone()]));
            }
        }
        let prescribed = self.check_twice(errors);
        self.check_curved_slides(errors);
        self.check_loads_on_supports(&prescribed, errors);
        self.check_sides_as_one(errors);
        self.check_loads_on_points(errors);
        for load in self.said.loads.iter().filter(|l| exact(l.side.patch).is_none() && matches!(l.action, Action::Exact(_))) {
            errors.push(ProblemError::new(ErrorKind::NoExact, vec![load.of], vec![load.side.label.clone()]));
        }
        let (known, unknown): (Vec<_>, Vec<_>) = self.bodies.iter().partition(|b| self.exact_of(b).is_some());
        if let (Some(known), Some(unknown)) = (known.first(), unknown.first()) {
            let names = vec![known.name.clone(), unknown.name.clone()];
            errors.push(ProblemError::new(ErrorKind::ExactInPart, vec![known.id.into(), unknown.id.into()], names));
        }
        for foundation in self.said.foundations.iter().filter(|f| exact(f.body).is_some()) {
            let name = self.bodies[foundation.body].name.clone();
            errors.push(ProblemError::new(ErrorKind::FoundationBesideExact, vec![foundation.of], vec![name]));
        }
        for body in self.bodies.iter().filter(|b| self.exact_of(b).is_some() && !(b.source.is_empty() && b.weights.is_empty())) {
            errors.push(ProblemError::new(ErrorKind::SourceTwice, vec![body.id.into()], vec![body.name.clone()]));
        }
    }

    /// Reports components that two statements prescribe on one facet, one edge or one corner; returns the first statement of every
    /// prescribed component of a facet.
    fn check_twice(&self, errors: &mut Vec<ProblemError>) -> HashMap<(Facet<N>, usize), Statement> {
        let mut first: HashMap<(Facet<N>, usize), &Condition<S, N>> = HashMap::new();
        let mut told: HashSet<(Statement, Statement, usize)> = HashSet::new();
        let mut twice = |before: Statement, of: Statement, component: usize, label: &str| {
            if before != of && told.insert((before, of, component)) {
                errors.push(ProblemError::new(ErrorKind::Twice { component }, vec![before, of], vec![label.to_owned()]));
            }
        };
        for condition in &self.said.conditions {
            for facet in facets(&condition.side) {
                let before = *first.entry((facet, condition.component)).or_insert(condition);
                // sides and parts may overlap where they prescribe the same
                if Arc::ptr_eq(&before.side, &condition.side) || differ(&before.value, &condition.value) {
                    twice(before.of, condition.of, condition.component, &condition.side.label);
                }
            }
        }
        let mut of_rims = HashMap::new();
        for pin in &self.said.pins {
            let before = *of_rims.entry((Arc::as_ptr(&pin.rim), pin.component)).or_insert(pin.of);
            twice(before, pin.of, pin.component, &pin.rim.label);
        }
        first.into_iter().map(|(at, condition)| (at, condition.of)).collect()
    }

    /// Reports curved sides that slide where something else holds a facet of them: rows and values would hold the same displacement.
    fn check_curved_slides(&self, errors: &mut Vec<ProblemError>) {
        let mut beside: Vec<(Statement, &Arc<BodySide<S, N>>)> = Vec::new();
        beside.extend(self.said.conditions.iter().map(|c| (c.of, &c.side)));
        beside.extend(self.said.held.iter().map(|h| (h.of, &h.side)));
        for tie in &self.ties {
            let sides = tie.own.pairs.iter().flat_map(|pair| pair.masters.iter().chain([&pair.slave]));
            beside.extend(sides.map(|side| (tie.id().into(), side)));
        }
        for contact in &self.contacts {
            let masters = if let StatedOpponent::Sides(masters) = &contact.own.faced { masters.as_slice() } else { &[] };
            beside.extend(contact.own.slaves.iter().chain(masters).map(|side| (contact.id().into(), side)));
        }
        for (k, slide) in self.said.slides.iter().enumerate() {
            let own: HashSet<Facet<N>> = facets(&slide.side).collect();
            let before = self.said.slides[..k].iter().map(|other| (other.of, &other.side));
            let mut all = beside.iter().copied().chain(before);
            if let Some((other, side)) = all.find(|(_, side)| facets(side).any(|facet| own.contains(&facet))) {
                let names = vec![slide.side.label.clone(), side.label.clone()];
                errors.push(ProblemError::new(ErrorKind::SlideBeside, vec![other, slide.of], names));
            }
        }
    }

    /// Reports loads and springs along components and directions that are held on all facets on which they act: they would act on supports
    /// alone.
    fn check_loads_on_supports(&self, prescribed: &HashMap<(Facet<N>, usize), Statement>, errors: &mut Vec<ProblemError>) {
        let (slides, curved) = (self.slides(), self.tangents_held());
        if prescribed.is_empty() && slides.is_empty() && curved.is_empty() {
            return;
        }
        let components = self.components();
        // what is held on all facets: components, and the directions of sliding
        let held_on = |side: &BodySide<S, N>| {
            let of_all = |at: &dyn Fn(Facet<N>) -> Option<Statement>| {
                let mut all = facets(side).map(at);
                let first = all.next().flatten()?;
                all.all(|of| of.is_some()).then_some(first)
            };
            let axes = (0..components).filter_map(|c| Some((unit::<N>(c), of_all(&|f| prescribed.get(&(f, c)).copied())?)));
            let mut all: Vec<(Vector<N>, Statement)> = axes.collect();
            let first = facets(side).next().and_then(|f| slides.get(&f));
            all.extend(first.into_iter().flatten().filter_map(|(d, _)| {
                let along = |f: Facet<N>| slides.get(&f)?.iter().find(|(other, _)| (other - d).norm() <= ALONG).map(|s| s.1);
                Some((*d, of_all(&along)?))
            }));
            all
        };
        let mut told: HashSet<(Statement, usize)> = HashSet::new();
        let mut refuse = |of: Statement, group: Statement, found: Option<(ErrorKind, Statement)>, label: &str| {
            let Some((kind, held)) = found else { return };
            // all components of a load along held directions are one
            let told_of = if let ErrorKind::Held { component } = kind { (of, component) } else { (group, components) };
            if told.insert(told_of) {
                errors.push(ProblemError::new(kind, vec![held, of], vec![label.to_owned()]));
            }
        };
        let along = |side: &BodySide<S, N>, held: &[(Vector<N>, Statement)], force: &Vector<N>| {
            Some((ErrorKind::HeldAlong, within(held, force).or_else(|| along_tangents(&curved, side, force))?))
        };
        let component = |held: &[(Vector<N>, Statement)], c: usize| {
            let of = held.iter().find(|(d, _)| *d == unit::<N>(c))?.1;
            Some((ErrorKind::Held { component: c }, of))
        };
        for load in &self.said.loads {
            let (side, held) = (&load.side, held_on(&load.side));
            match &load.action {
                Action::Traction(c, _) | Action::Force(c, ..) => {
                    let beside = || self.said.loads.iter().filter(|l| Arc::ptr_eq(&l.side, side));
                    let largest = beside().map(|l| constant::<N>(&l.action).norm()).fold(0.0, f64::max);
                    // a formula may vanish where the component is held, and what is left of zero by rounding is no load
                    if constant::<N>(&load.action).norm() <= ALONG * largest {
                        continue;
                    }
                    let group: Vector<N> = beside().filter(|l| l.group == load.group).map(|l| constant(&l.action)).sum();
                    let whole: Vector<N> = beside().map(|l| constant(&l.action)).sum();
                    refuse(
                        load.of,
                        load.group,
                        component(&held, *c).or_else(|| along(side, &held, &group)).or_else(|| along(side, &held, &whole)),
                        &side.label,
                    );
                }
                // along rollers a pressure on a list of sides acts on the supports alone
                Action::Pressure(f) if f.as_constant().is_some_and(|p| p != 0.0) => {
                    let all = (0..components).all(|c| within(&held, &unit(c)).is_some());
                    let last = components - 1;
                    refuse(
                        load.of,
                        load.group,
                        component(&held, last).or_else(|| along(side, &held, &unit(last))).filter(|_| all),
                        &side.label,
                    );
                }
                _ => {}
            }
        }
        for spring in self.said.springs.iter().filter(|s| s.stiffness.as_constant().is_some_and(|k| k != 0.0)) {
            let (held, c) = (held_on(&spring.side), spring.component);
            refuse(spring.of, spring.of, component(&held, c).or_else(|| along(&spring.side, &held, &unit(c))), &spring.side.label);
        }
    }

    /// Reports forces on sides that move as one where a value is prescribed in a part of them, such as a corner that they share with a support.
    fn check_sides_as_one(&self, errors: &mut Vec<ProblemError>) {
        for group in &self.said.rigid_sides {
            let acts = |action: &Action| matches!(action, Action::Force(_, f, _) if f.as_constant() != Some(0.0));
            if !self.said.loads.iter().any(|l| l.of == group.of && acts(&l.action)) {
                continue;
            }
            let own: Vec<HashSet<usize>> = group.sides.iter().map(|s| s.trace.dofs.iter().copied().collect()).collect();
            let moves = |patch: usize, functions: &[usize]| {
                let shares = |k: &usize| group.sides[*k].patch == patch && functions.iter().any(|f| own[*k].contains(f));
                (0..own.len()).find(shares).map(|k| &group.sides[k])
            };
            let of_sides = self.said.conditions.iter().filter(|c| c.component == group.component);
            let of_sides = of_sides.filter_map(|c| Some((moves(c.side.patch, &c.side.trace.dofs)?, c.of, &c.side.label)));
            let of_rims = self.said.pins.iter().filter(|p| p.component == group.component);
            let of_rims = of_rims.filter_map(|p| Some((moves(p.rim.patch, &p.rim.rim.functions())?, p.of, &p.rim.label)));
            if let Some((side, by, label)) = of_sides.chain(of_rims).find(|found| found.1 != group.of) {
                let names = vec![side.label.clone(), label.clone()];
                errors.push(ProblemError::new(ErrorKind::HeldAsOne { component: group.component }, vec![by, group.of], names));
            }
        }
    }

    /// Reports forces on edges and in corners in components that are prescribed there: they would act on supports alone.
    fn check_loads_on_points(&self, errors: &mut Vec<ProblemError>) {
        for load in self.said.point_loads.iter().filter(|l| l.force.as_constant() != Some(0.0)) {
            let functions = load.rim.rim.functions();
            let holds = |patch: usize, component: usize, held: &[usize]| {
                let held: HashSet<&usize> = held.iter().collect();
                (patch, component) == (load.rim.patch, load.component) && functions.iter().all(|f| held.contains(f))
            };
            let of_sides = self.said.conditions.iter().filter(|c| holds(c.side.patch, c.component, &c.side.trace.dofs)).map(|c| c.of);
            let of_rims = self.said.pins.iter().filter(|p| holds(p.rim.patch, p.component, &p.rim.rim.functions())).map(|p| p.of);
            if let Some(held) = of_sides.chain(of_rims).next() {
                let kind = ErrorKind::Held { component: load.component };
                errors.push(ProblemError::new(kind, vec![held, load.of], vec![load.rim.label.clone()]));
            }
        }
    }

    /// The facets of curved sides that are held along their tangents, with normals at their points.
    fn tangents_held(&self) -> HashMap<Facet<N>, (Vec<Vector<N>>, Statement)> {
        let (mut all, mut map) = (HashMap::new(), MapTable::new());
        for slide in self.said.slides.iter().filter(|s| !s.along_normal) {
            let side = &slide.side;
            for (e, facet) in facets(side).enumerate() {
                side.trace.space.map(e, &side.rules.rule(e).points, Order::Gradients, &mut map);
                let normals = map.jacobian.iter().map(|jacobian| side.trace.normal(e, jacobian));
                all.insert(facet, (normals.filter(|n| n.iter().all(|v| v.is_finite())).collect(), slide.of));
            }
        }
        all
    }

    /// The directions along which sliding holds facets.
    fn slides(&self) -> HashMap<Facet<N>, Vec<(Vector<N>, Statement)>> {
        let mut all: HashMap<Facet<N>, Vec<(Vector<N>, Statement)>> = HashMap::new();
        // a side that moves as one is loaded itself
        let is_rigid = |of: Statement| self.said.rigid_sides.iter().any(|r| r.of == of);
        for held in self.said.held.iter().filter(|h| !is_rigid(h.of)) {
            facets(&held.side).for_each(|facet| all.entry(facet).or_default().push((held.direction, held.of)));
        }
        all
    }
}

/// The statement that holds the tangents of all facets of a side, if a force is along them everywhere.
fn along_tangents<const S: usize, const N: usize>(
    held: &HashMap<Facet<N>, (Vec<Vector<N>>, Statement)>,
    side: &BodySide<S, N>,
    force: &Vector<N>,
) -> Option<Statement> {
    let across = |normal: &Vector<N>| normal.dot(force).abs() <= ALONG * force.norm();
    let mut all = facets(side).map(|f| held.get(&f).filter(|(normals, _)| force.norm() > 0.0 && normals.iter().all(across)));
    let first = all.next().flatten()?.1;
    all.all(|of| of.is_some()).then_some(first)
}

/// The first statement that takes part in a force within the span of what is held; `None` of a force that is not, and of none.
fn within<const N: usize>(held: &[(Vector<N>, Statement)], force: &Vector<N>) -> Option<Statement> {
    let (mut rest, mut basis) = (*force, Vec::<Vector<N>>::new());
    for (d, _) in held {
        let across = basis.iter().fold(*d, |v, b| v - b * b.dot(d));
        if across.norm() > ALONG {
            basis.push(across / across.norm());
        }
    }
    basis.iter().for_each(|b| rest -= b * b.dot(&rest));
    let takes_part = || held.iter().find(|(d, _)| d.dot(force).abs() > ALONG * force.norm()).map(|h| h.1);
    (rest.norm() <= ALONG * force.norm()).then(takes_part).flatten()
}

/// The force per area of a load that is the same everywhere and at any time, else zero.
fn constant<const N: usize>(action: &Action) -> Vector<N> {
    match action {
        Action::Traction(c, f) => unit(*c) * f.as_constant().unwrap_or(0.0),
        Action::Force(c, f, area) => unit(*c) * (f.as_constant().unwrap_or(0.0) / area),
        Action::Exact(_) | Action::Pressure(_) => Vector::zeros(),
    }
}

/// Whether two values are known to differ; those of functions are compared where the sides meet.
fn differ(a: &Value, b: &Value) -> bool {
    let constant = |value: &Value| match value {
        Value::Zero => Some(0.0),
        Value::Data(f) => f.as_constant(),
        Value::Exact => None,
    };
    constant(a).zip(constant(b)).is_some_and(|(a, b)| a != b)
}
