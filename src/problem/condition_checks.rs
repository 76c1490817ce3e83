//! Checks of what is prescribed and loaded together: components prescribed twice, loads on what is held, exact data without exact solution.

use super::builder::Problem;
use super::data::Data;
use super::error::{ErrorKind, ProblemError};
use super::handles::Statement;
use super::model::{Action, Condition, SideModel, Value};
use crate::geometry::cell;
use std::collections::{HashMap, HashSet};
use std::sync::Arc;

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
            let side = &*load.side;
            // a formula may vanish where the component is held
            let is_load = |f: &Data| f.as_constant().is_some_and(|value| value != 0.0);
            let component = match &load.action {
                Action::Traction(c, f) | Action::Force(c, f, _) if is_load(f) => *c,
                // along rollers a pressure on a list of sides acts on the supports alone
                Action::Pressure(f) if is_load(f) && (0..components).all(|c| holds(side, c).is_some()) => components - 1,
                _ => continue,
            };
            if let Some(held) = holds(side, component) {
                loaded(held, load.of, component, &side.label);
            }
        }
        for spring in self.said.springs.iter().filter(|s| s.stiffness.as_constant().is_some_and(|k| k != 0.0)) {
            if let Some(held) = holds(&spring.side, spring.component) {
                loaded(held, spring.of, spring.component, &spring.side.label);
            }
        }
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
