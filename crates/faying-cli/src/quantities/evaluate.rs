//! Values of quantities on a solved model.

use super::grammar::{FieldName, Reduce};
use super::path::look_up;
use super::prepare::Prepared;
use faying::basis::{Cell, Order};
use faying::geometry::MapTable;
use faying::linalg::{Vector, measure};
use faying::physics::von_mises;
use faying::problem::{ContactField, Model, PointState, StepState, TieField};
use faying::quadrature::Quadrature;
use faying::space::Space;
use rayon::prelude::*;
use serde_json::Value;

/// Volume change of a map, relative to that in the middle of the element, below which the map has collapsed.
const COLLAPSED: f64 = 1e-12;
/// Share of the element by which points are moved off a collapsed edge.
const NUDGE: f64 = 1e-7;

/// The value of a quantity.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Answer {
    /// One number.
    One(f64),
    /// Least and largest value of a field.
    Range(f64, f64),
    /// No number, with the reason.
    None(String),
    /// Known to studies only.
    Study,
}

/// Component of a field from the solution at a point.
fn component<const N: usize>(field: FieldName, p: &PointState<N>) -> f64 {
    match field {
        FieldName::U(c) => p.u[c.unwrap_or(0)],
        FieldName::Flux(c) => p.stress[c],
        FieldName::Stress(i, j) => p.stress[voigt(i, j)],
        FieldName::VonMises => von_mises(&p.stress),
    }
}

/// Index of a component among xx yy zz xy yz xz.
fn voigt(i: usize, j: usize) -> usize {
    match (i.min(j), i.max(j)) {
        (a, b) if a == b => a,
        (0, 1) => 3,
        (1, 2) => 4,
        _ => 5,
    }
}

fn finite(value: f64) -> Answer {
    if value.is_finite() { Answer::One(value) } else { Answer::None("the value is not finite".into()) }
}

/// Returns the point; if the map of the element collapses there, as at the centre of a disc, a point nearer to the middle by 1e-7 of the
/// element: gradients have a limit there and no value at the point itself. Nearer points lose more to round-off than this distance changes
/// the field.
fn off_collapsed<const N: usize>(space: &dyn Space<N, N>, element: usize, xi: &Vector<N>) -> Vector<N> {
    let middle = match space.cell(element) {
        Cell::Simplex => 1.0 / (N + 1) as f64,
        _ => 0.5,
    };
    let middle = Vector::<N>::repeat(middle);
    let mut map = MapTable::new();
    space.map(element, &[*xi, middle], Order::Gradients, &mut map);
    let collapsed = measure(&map.jacobian[0]) <= COLLAPSED * measure(&map.jacobian[1]);
    if collapsed { xi + (middle - xi) * NUDGE } else { *xi }
}

/// Evaluates a quantity on `state`; numbers of the result are read from `result`.
pub fn evaluate<const S: usize, const N: usize>(
    prepared: &Prepared<S, N>,
    model: &Model<S, N>,
    state: &StepState<S, N>,
    result: &Value,
) -> Answer {
    match prepared {
        Prepared::Study => Answer::Study,
        Prepared::Number(value) => finite(*value),
        Prepared::Path(path) => match look_up(result, path) {
            Some(Ok(value)) => finite(value),
            Some(Err(reason)) => Answer::None(reason),
            None => Answer::None("the result has no such number".into()),
        },
        Prepared::At(field, spot) => {
            let patch = &model.patches[spot.patch];
            let mut mean = PointState::<N> { x: faying::linalg::Vector::zeros(), u: [0.0; 3], stress: [0.0; 6] };
            let share = 1.0 / spot.elements.len() as f64;
            let physics = patch.physics_at(state.t);
            for (e, xi) in &spot.elements {
                let space = &**patch.body.space();
                // displacements need no derivative
                let xi = if matches!(field, FieldName::U(_)) { *xi } else { off_collapsed(space, *e, xi) };
                let p = physics.at(space, &patch.field, &state.u, *e, &[xi])[0];
                mean.u.iter_mut().zip(p.u).for_each(|(m, v)| *m += share * v);
                mean.stress.iter_mut().zip(p.stress).for_each(|(m, v)| *m += share * v);
            }
            finite(component(*field, &mean))
        }
        Prepared::Over(field, bodies, reduce) => {
            let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
            let mut whole = true;
            for p in bodies.iter().map(|k| &model.patches[*k]) {
                let (space, physics) = (&**p.body.space(), p.physics_at(state.t));
                let parts: Vec<(f64, f64, bool)> = (0..space.num_elements())
                    .into_par_iter()
                    .map(|e| {
                        let points = physics.at(space, &p.field, &state.u, e, &p.rules.rule(e).points);
                        points
                            .iter()
                            .map(|s| component(*field, s))
                            .fold((f64::INFINITY, f64::NEG_INFINITY, true), |(l, h, ok), v| (l.min(v), h.max(v), ok && v.is_finite()))
                    })
                    .collect();
                for (l, h, ok) in parts {
                    (low, high, whole) = (low.min(l), high.max(h), whole && ok);
                }
            }
            if !whole {
                return Answer::None("the field is not finite everywhere".into());
            }
            match reduce {
                Reduce::Min => finite(low),
                Reduce::Max => finite(high),
                Reduce::None => Answer::Range(low, high),
            }
        }
        Prepared::Lambda(spot, component) => {
            let part = &model.ties[spot.number].parts[spot.part];
            finite(TieField::of(model, part, state.t).at(model, part, state, spot.element, &[spot.xi])[*component][0])
        }
        Prepared::Pressure(spot, pressure) => {
            let contact = &model.contacts[spot.number];
            let part = &contact.parts[spot.part];
            let field = ContactField::of(model, part, state.t);
            let [lambda, _] = field.at(model, contact, part, state, spot.element, &[spot.xi])[0];
            finite(if *pressure { -lambda } else { lambda })
        }
    }
}
