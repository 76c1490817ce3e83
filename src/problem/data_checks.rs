//! Checks of data at quadrature points: limits of materials, values that are not finite, negative or too large.

use super::builder::Problem;
use super::data::{Data, Point};
use super::error::{ErrorKind, ProblemError};
use super::handles::Statement;
use super::model::{Action, BodySide, Value};
use crate::basis::Order;
use crate::geometry::{Geometry, MapTable};
use crate::linalg::Vector;
use crate::parallel;
use crate::quadrature::Quadrature;
use std::collections::HashSet;

/// Largest size of data: squares of larger numbers overflow.
const LARGEST: f64 = 1e150;

/// Values that data may take.
#[derive(Clone, Copy)]
struct Limits {
    least: f64,
    most: f64,
}

impl Limits {
    const ANY: Self = Self { least: -LARGEST, most: LARGEST };
    const DENSITY: Self = Self { least: 0.0, ..Self::ANY };
    /// Springs may be as stiff as supports.
    const STIFFNESS: Self = Self { least: 0.0, most: LARGEST * LARGEST };

    fn hold(self, value: f64) -> bool {
        (self.least..=self.most).contains(&value)
    }

    /// The error of a value beyond the limits, at a point and a time.
    fn error(self, value: f64, (x, t): ([f64; 3], f64), component: usize) -> ErrorKind {
        if !value.is_finite() {
            ErrorKind::NotFinite { x, t, value, component }
        } else if value < 0.0 && self.least == 0.0 {
            ErrorKind::Negative { x, t, value, component }
        } else {
            ErrorKind::TooLarge { x, t, value, component }
        }
    }
}

/// The first quadrature point, elements ascending, at which `wrong` returns something.
fn first_wrong<const D: usize, const N: usize, E: Send>(
    space: &dyn Geometry<D, N>,
    rules: &dyn Quadrature<D>,
    wrong: &(dyn Fn(&Vector<N>) -> Option<E> + Sync),
) -> Option<([f64; 3], E)> {
    let found = parallel::map(space.num_elements(), |e| {
        let mut map = MapTable::new();
        space.map(e, &rules.rule(e).points, Order::Values, &mut map);
        map.x.iter().find_map(|x| wrong(x).map(|found| (Point::new(x.as_slice()).x, found)))
    });
    found.into_iter().flatten().next()
}

impl<const S: usize, const N: usize> Problem<S, N> {
    /// All times if data change with them, else the first.
    fn times_of(&self, changes: bool) -> &[f64] {
        if changes { &self.times } else { &self.times[..1] }
    }

    /// A point and a time at which data are beyond their limits.
    fn wrong_value<const D: usize>(
        &self,
        space: &dyn Geometry<D, N>,
        rules: &dyn Quadrature<D>,
        (data, component, limits): (&Data, usize, Limits),
    ) -> Option<ErrorKind> {
        if data.as_constant().is_some_and(|value| limits.hold(value)) {
            return None;
        }
        self.beyond(space, rules, data.depends_on_time(), &|at| data.value(at), (component, limits))
    }

    /// The first time and quadrature point at which a value is beyond its limits.
    fn beyond<const D: usize>(
        &self,
        space: &dyn Geometry<D, N>,
        rules: &dyn Quadrature<D>,
        changes: bool,
        value: &(dyn Fn(&Point) -> f64 + Sync),
        (component, limits): (usize, Limits),
    ) -> Option<ErrorKind> {
        self.times_of(changes).iter().find_map(|&t| {
            let wrong = |x: &Vector<N>| Some(value(&Point::new(x.as_slice()).at_time(t))).filter(|v| !limits.hold(*v));
            first_wrong(space, rules, &wrong).map(|(x, value)| limits.error(value, (x, t), component))
        })
    }

    /// A point and a time at which a component of the exact solution is beyond the limits on a side.
    fn wrong_exact(&self, side: &BodySide<S, N>, component: usize) -> Option<ErrorKind> {
        let exact = self.exact_of(&self.bodies[side.patch])?;
        let value = |at: &Point| exact.value(component, at);
        self.beyond(&*side.trace.space, &side.rules, exact.depends_on_time(), &value, (component, Limits::ANY))
    }

    /// Materials beyond their limits.
    pub(super) fn check_materials(&self, errors: &mut Vec<ProblemError>) {
        for body in &self.bodies {
            let wrong = self.times_of(body.changing.is_some()).iter().find_map(|&t| {
                let physics = body.physics_at(t);
                if physics.is_homogeneous() {
                    return None;
                }
                let found = first_wrong(&**body.body.space(), &body.rules, &|x: &Vector<N>| physics.check(x).err());
                found.map(|(x, error)| ErrorKind::OutOfLimits { error, x, t })
            });
            errors.extend(wrong.map(|kind| ProblemError::new(kind, vec![body.id.into()], vec![body.name.clone()])));
        }
    }

    /// Prescribed values, loads, springs, sources, densities and foundations beyond their limits; each statement once.
    pub(super) fn check_values(&self, errors: &mut Vec<ProblemError>) {
        let mut told: HashSet<Statement> = HashSet::new();
        let loads = self.said.loads.iter().filter_map(|l| match &l.action {
            Action::Traction(c, f) | Action::Force(c, f, _) => Some((l.of, &l.name, &l.side, (f, *c, Limits::ANY))),
            Action::Pressure(f) => Some((l.of, &l.name, &l.side, (f, 0, Limits::ANY))),
            Action::Exact(_) => None,
        });
        let springs = self.said.springs.iter().map(|s| (s.of, &s.name, &s.side, (&s.stiffness, s.component, Limits::STIFFNESS)));
        let values = self.said.conditions.iter().filter_map(|c| match &c.value {
            Value::Data(f) => Some((c.of, &c.side.label, &c.side, (f, c.component, Limits::ANY))),
            Value::Zero | Value::Exact => None,
        });
        let mut all: Vec<_> = values.chain(loads).chain(springs).collect();
        // as they were said
        all.sort_by_key(|(of, ..)| *of);
        for (of, name, side, data) in all {
            if told.contains(&of) {
                continue;
            }
            if let Some(kind) = self.wrong_value(&*side.trace.space, &side.rules, data) {
                told.insert(of);
                errors.push(ProblemError::new(kind, vec![of], vec![name.clone(), side.label.clone()]));
            }
        }
        for c in self.said.conditions.iter().filter(|c| matches!(c.value, Value::Exact) && !told.contains(&c.of)) {
            if let Some(kind) = self.wrong_exact(&c.side, c.component) {
                errors.push(ProblemError::new(kind, vec![c.of], vec![c.side.label.clone(); 2]));
            }
        }
        for load in &self.said.point_loads {
            let at = |t: f64| {
                load.rim.rim.x.iter().find_map(|x| {
                    let value = load.force.value(&Point::new(x.as_slice()).at_time(t));
                    (!Limits::ANY.hold(value)).then(|| (Point::new(x.as_slice()).x, t, value))
                })
            };
            let wrong = self.times_of(load.force.depends_on_time()).iter().find_map(|&t| at(t));
            let Some((x, t, value)) = wrong.filter(|_| told.insert(load.of)) else { continue };
            let kind = Limits::ANY.error(value, (x, t), load.component);
            errors.push(ProblemError::new(kind, vec![load.of], vec![load.name.clone(), load.rim.label.clone()]));
        }
        for pin in &self.said.pins {
            let (value, changes): (&dyn Fn(&Point) -> f64, bool) = match (&pin.value, self.exact_of(&self.bodies[pin.rim.patch])) {
                (Value::Data(f), _) => (&|at| f.value(at), f.depends_on_time()),
                (Value::Exact, Some(exact)) => (&|at| exact.value(pin.component, at), exact.depends_on_time()),
                _ => continue,
            };
            let at = |t: f64| {
                pin.rim.rim.x.iter().find_map(|x| {
                    let value = value(&Point::new(x.as_slice()).at_time(t));
                    (!Limits::ANY.hold(value)).then(|| (Point::new(x.as_slice()).x, value))
                })
            };
            let wrong = self.times_of(changes).iter().find_map(|&t| at(t).map(|(x, value)| (x, t, value)));
            let Some((x, t, value)) = wrong.filter(|_| told.insert(pin.of)) else { continue };
            let kind = Limits::ANY.error(value, (x, t), pin.component);
            errors.push(ProblemError::new(kind, vec![pin.of], vec![pin.rim.label.clone(); 2]));
        }
        let components = self.components();
        let mut number = vec![0; self.bodies.len()];
        let sources = self.volume_loads.iter().flat_map(|&(of, body)| {
            let first = number[body];
            number[body] += components;
            (0..components).map(move |c| (of, body, first + c, c)).collect::<Vec<_>>()
        });
        let sources: Vec<_> = sources.map(|(of, body, k, c)| (of, body, (&self.bodies[body].source[k], c, Limits::ANY))).collect();
        let mut number = vec![0; self.bodies.len()];
        let weights = self.weight_loads.iter().map(|&(of, body)| {
            number[body] += 1;
            (of, body, (&self.bodies[body].weights[number[body] - 1].0, 0, Limits::DENSITY))
        });
        let foundations = self.said.foundations.iter().map(|f| (f.of, f.body, (&f.stiffness, f.component, Limits::STIFFNESS)));
        for (of, body, data) in sources.into_iter().chain(weights).chain(foundations) {
            let body = &self.bodies[body];
            if let Some(kind) = self.wrong_value(&**body.body.space(), &body.rules, data) {
                errors.push(ProblemError::new(kind, vec![of, body.id.into()], vec![body.name.clone(), body.name.clone()]));
            }
        }
    }

    /// Motions and forces of obstacles that are not finite or too large.
    pub(super) fn check_obstacles(&self, errors: &mut Vec<ProblemError>) {
        for contact in &self.contacts {
            for (component, f) in contact.own.motion.iter().chain(&contact.own.forces) {
                let value = |t: f64| f.value(&Point::default().at_time(t));
                if let Some(&t) = self.times_of(f.depends_on_time()).iter().find(|t| !Limits::ANY.hold(value(**t))) {
                    let kind = Limits::ANY.error(value(t), ([0.0; 3], t), *component);
                    errors.push(ProblemError::new(kind, vec![contact.id().into()], vec![contact.name.clone(), contact.name.clone()]));
                }
            }
        }
    }
}
