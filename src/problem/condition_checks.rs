//! Checks of what is prescribed and loaded together: components prescribed twice, loads on what is held, exact data without exact solution.

use super::builder::Problem;
use super::error::{ErrorKind, ProblemError};
use super::handles::Statement;
use super::model::{Action, SideModel, Value};
use crate::assembly::planar_normal;
use crate::geometry::cell;
use crate::linalg::Vector;
use std::collections::{HashMap, HashSet};
use std::sync::Arc;

/// Components of a unit normal below this count as zero.
const PERPENDICULAR: f64 = 1e-9;
/// Local coordinates of a facet's centre are compared in steps of this size.
const SAME_FACET: f64 = 1e-6;

/// A facet of a body: the body, the element, and its centre in the element.
type Facet<const N: usize> = (usize, usize, [i64; N]);

/// The facets of a side.
fn facets<const S: usize, const N: usize>(side: &SideModel<S, N>) -> impl Iterator<Item = Facet<N>> + '_ {
    side.trace.facets.iter().enumerate().map(|(e, facet)| {
        let center = facet.lift(&cell::center(side.trace.space.cell(e)));
        (side.patch, facet.element, std::array::from_fn(|k| (center[k] / SAME_FACET).round() as i64))
    })
}

impl<const S: usize, const N: usize> Problem<S, N> {
    /// Components that are prescribed twice, loads that act on what is held, values of an exact solution that is not there, and sources
    /// beside one.
    pub(super) fn check_conditions(&self, errors: &mut Vec<ProblemError>) {
        let of_sides = self.said.conditions.iter().map(|c| (c.of, &c.side.label, &c.value));
        for (of, label, value) in of_sides.chain(self.said.pins.iter().map(|p| (p.of, &p.rim.label, &p.value))) {
            if let (Value::Exact, None) = (value, &self.exact) {
                errors.push(ProblemError::new(ErrorKind::NoExact, vec![of], vec![label.clone()]));
            }
        }
        let prescribed = self.check_twice(errors);
        self.check_loads_on_supports(&prescribed, errors);
        for load in self.said.loads.iter().filter(|l| self.exact.is_none() && matches!(l.action, Action::Exact(_))) {
            errors.push(ProblemError::new(ErrorKind::NoExact, vec![load.of], vec![load.side.label.clone()]));
        }
        for body in self.bodies.iter().filter(|b| self.exact.is_some() && !(b.source.is_empty() && b.weights.is_empty())) {
            errors.push(ProblemError::new(ErrorKind::SourceTwice, vec![body.id.into()], vec![body.name.clone()]));
        }
    }

    /// Reports components that two statements prescribe on one facet, one edge or one corner; returns the first statement of every
    /// prescribed component of a facet.
    fn check_twice(&self, errors: &mut Vec<ProblemError>) -> HashMap<(Facet<N>, usize), Statement> {
        let mut first = HashMap::new();
        let mut told: HashSet<(Statement, Statement, usize)> = HashSet::new();
        let mut twice = |before: Statement, of: Statement, component: usize, label: &str| {
            if before != of && told.insert((before, of, component)) {
                errors.push(ProblemError::new(ErrorKind::Twice { component }, vec![before, of], vec![label.to_owned()]));
            }
        };
        for condition in &self.said.conditions {
            for facet in facets(&condition.side) {
                let before = *first.entry((facet, condition.component)).or_insert(condition.of);
                twice(before, condition.of, condition.component, &condition.side.label);
            }
        }
        let mut of_rims = HashMap::new();
        for pin in &self.said.pins {
            let before = *of_rims.entry((Arc::as_ptr(&pin.rim), pin.component)).or_insert(pin.of);
            twice(before, pin.of, pin.component, &pin.rim.label);
        }
        first
    }

    /// Reports loads and springs in a component that is prescribed on all facets on which they act: they would act on supports alone.
    fn check_loads_on_supports(&self, prescribed: &HashMap<(Facet<N>, usize), Statement>, errors: &mut Vec<ProblemError>) {
        if prescribed.is_empty() && self.said.held.is_empty() {
            return;
        }
        // the statement that holds a component on all facets
        let holds = |side: &SideModel<S, N>, component: usize| {
            let mut all = facets(side).map(|facet| prescribed.get(&(facet, component)));
            let first = all.next().flatten()?;
            all.all(|of| of.is_some()).then_some(*first)
        };
        let components = self.components();
        let mut told: HashSet<(Statement, usize)> = HashSet::new();
        let mut loaded = |held: Statement, of: Statement, component: usize, label: &str| {
            if told.insert((of, component)) {
                errors.push(ProblemError::new(ErrorKind::Held { component }, vec![held, of], vec![label.to_owned()]));
            }
        };
        for load in &self.said.loads {
            let (side, is_zero) = (&*load.side, |f: &super::data::Data| f.as_constant() == Some(0.0));
            let component = match &load.action {
                Action::Traction(c, f) | Action::Force(c, f, _) if !is_zero(f) => *c,
                Action::Pressure(f) if !is_zero(f) => match along_axis(side) {
                    Some(axis) => axis,
                    // an inclined or curved side has no component of its own: all of them are held, or the load acts
                    None if (0..components).all(|c| holds(side, c).is_some()) => components - 1,
                    None => continue,
                },
                _ => continue,
            };
            if let Some(held) = holds(side, component) {
                loaded(held, load.of, component, &side.label);
            }
        }
        for spring in self.said.springs.iter().filter(|s| s.stiffness.as_constant() != Some(0.0)) {
            if let Some(held) = holds(&spring.side, spring.component) {
                loaded(held, spring.of, spring.component, &spring.side.label);
            }
        }
    }
}

/// The axis along which a planar side has its normal.
fn along_axis<const S: usize, const N: usize>(side: &SideModel<S, N>) -> Option<usize> {
    let normal: Vector<N> = planar_normal(&side.trace)?;
    (0..N).find(|&k| (normal[k].abs() - 1.0).abs() < PERPENDICULAR)
}
