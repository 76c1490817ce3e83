//! Values of quantities on a solved model.

use super::fields::FieldAbout;
use super::grammar::Reduce;
use super::path::look_up;
use super::prepare::{Prepared, SideSpot};
use faying::linalg::Vector;
use faying::problem::{Extreme, PointState, Solution};
use faying::space::off_collapsed;
use serde_json::Value;

/// The value of a quantity.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Answer {
    /// One number.
    One(f64),
    /// A value and its place: an extreme of a field, or that of the nearest point of a body.
    Placed(f64, Vec<f64>),
    /// Least and largest value of a field, each with its place.
    Range([(f64, Vec<f64>); 2]),
    /// No number, with the reason.
    None(String),
    /// Known to studies only.
    Study,
}

fn finite(value: f64) -> Answer {
    if value.is_finite() { Answer::One(value) } else { Answer::None("the value is not finite".into()) }
}

/// A field over bodies: an extreme with its place, or both.
fn over<const S: usize, const N: usize>(solution: &Solution<S, N>, field: &FieldAbout<N>, bodies: &[usize], reduce: Reduce) -> Answer {
    let value = |s: &PointState<N>| field.value(s);
    let derived = field.name.is_derived();
    let of_body = |k: &usize| {
        let body = solution.contents().body(*k).id();
        let found = match reduce {
            Reduce::MinGauss | Reduce::MaxGauss => solution.extremes_at_points(body, &value),
            _ => solution.extremes(body, derived, &value),
        };
        found.ok().flatten()
    };
    let Some(parts) = bodies.iter().map(of_body).collect::<Option<Vec<[Extreme<N>; 2]>>>() else {
        return Answer::None("the field is not finite everywhere".into());
    };
    let low = parts.iter().map(|p| p[0]).reduce(|a, b| if b.value < a.value { b } else { a });
    let high = parts.iter().map(|p| p[1]).reduce(|a, b| if b.value > a.value { b } else { a });
    let (Some(low), Some(high)) = (low, high) else { return Answer::None("there is no body".into()) };
    let placed = |x: Extreme<N>| (x.value, x.at.as_slice().to_vec());
    match reduce {
        Reduce::Min | Reduce::MinGauss => Answer::Placed(low.value, placed(low).1),
        Reduce::Max | Reduce::MaxGauss => Answer::Placed(high.value, placed(high).1),
        Reduce::None => Answer::Range([placed(low), placed(high)]),
    }
}

/// Evaluates a quantity on a solution; numbers of the result are read from `result`.
pub fn evaluate<const S: usize, const N: usize>(prepared: &Prepared<S, N>, solution: &Solution<S, N>, result: &Value) -> Answer {
    match prepared {
        Prepared::Study => Answer::Study,
        Prepared::Number(value) => finite(*value),
        Prepared::Path(path) => match look_up(result, path) {
            Some(Ok(value)) => finite(value),
            Some(Err(reason)) => Answer::None(reason),
            None => Answer::None("the result has no such number".into()),
        },
        Prepared::At(field, spot) => {
            let body = solution.contents().body(spot.patch);
            let none = Vector::zeros();
            let mut mean = PointState::<N> { x: none, u: [0.0; 3], stress: [0.0; 6], strain: [0.0; 6] };
            let share = 1.0 / spot.elements.len() as f64;
            for (e, xi) in &spot.elements {
                let xi = if field.name.is_derived() { off_collapsed(&**body.space(), *e, [*xi])[0] } else { *xi };
                let p = solution.in_element(body.id(), *e, &[xi.into()]).expect("an element of the body")[0];
                mean.x += p.x * share;
                mean.u.iter_mut().zip(p.u).for_each(|(m, v)| *m += share * v);
                mean.stress.iter_mut().zip(p.stress).for_each(|(m, v)| *m += share * v);
                mean.strain.iter_mut().zip(p.strain).for_each(|(m, v)| *m += share * v);
            }
            match finite(field.value(&mean)) {
                Answer::One(value) if spot.moved => Answer::Placed(value, mean.x.as_slice().to_vec()),
                answer => answer,
            }
        }
        Prepared::FunctionSpace(field, bodies, reduce) => over(solution, field, bodies, *reduce),
        Prepared::SideForce(sides, component) => finite(sides.iter().map(|side| side_force(solution, side, *component)).sum()),
        Prepared::Cut(cut) => finite(cut.value(solution)),
        Prepared::Lambda(spot, component) => finite(lambda(solution, spot, *component)),
        Prepared::Pressure(spot, pressure) => {
            let lambda = lambda(solution, spot, 0);
            finite(if *pressure { -lambda } else { lambda })
        }
    }
}

/// A component of the force of the stresses on a side, given by its patch and its name.
fn side_force<const S: usize, const N: usize>(solution: &Solution<S, N>, (patch, side): &(usize, String), component: usize) -> f64 {
    let body = solution.contents().body(*patch).id();
    solution.force(body.side(side)).map_or(f64::NAN, |found| found.force[component])
}

/// A component of lambda at a place of a slave side.
fn lambda<const S: usize, const N: usize>(solution: &Solution<S, N>, spot: &SideSpot<S>, component: usize) -> f64 {
    let field = solution.lambda(spot.of, spot.side).ok().flatten();
    field.map_or(f64::NAN, |field| field.at(spot.element, &[spot.xi])[component][0])
}
