//! Curved sides that slide and contradict the values that are prescribed where they end.
//!
//! In a common point u is known in the directions of conditions, pins, inclined sides and curved sides before it. Where a direction of the
//! side is within their span, what they give along it must vanish.

use super::curved_slides::SampledSlide;
use super::data::Point;
use super::error::{ErrorKind, ProblemError};
use super::handles::Statement;
use super::model::{Model, Value};
use super::side_points::SidePoint;
use crate::linalg::Vector;
use std::collections::HashSet;

/// Sines below this are those of parallel directions.
const PARALLEL: f64 = 1e-9;
/// Values below this share of the largest one are rounding.
const NO_DEFECT: f64 = 1e-9;

/// A direction that a statement prescribes in all functions of a side, an edge or a corner.
struct StatedDirection<'a, const N: usize> {
    of: Statement,
    label: &'a str,
    functions: HashSet<usize>,
    direction: Vector<N>,
    value: &'a Value,
    patch: usize,
}

impl<const S: usize, const N: usize> Model<S, N> {
    /// Reports the curved sides that contradict what is prescribed at one of `times`, each once.
    pub(super) fn contradicted_slides(&self, slides: &[SampledSlide<'_, S, N>], times: &[f64]) -> Vec<ProblemError> {
        let known = self.known_directions();
        if slides.is_empty() || known.iter().all(|k| matches!(k.value, Value::Zero)) {
            return Vec::new();
        }
        let (changes, times) = self.times_of_values(times);
        let report = |k: usize| {
            times.iter().find_map(|&t| {
                let (defect, others) = self.contradicted(&slides[k], &slides[..k], &known, t)?;
                let slide = slides[k].slide;
                let of = others.iter().map(|o| o.0).chain([slide.of]).collect();
                let names = std::iter::once(&*slide.side.label).chain(others.iter().map(|o| o.1)).map(str::to_owned).collect();
                Some(ProblemError::new(ErrorKind::Contradiction { defect, t, changes }, of, names))
            })
        };
        (0..slides.len()).filter_map(report).collect()
    }

    /// Directions that supports prescribe, but for curved sides.
    fn known_directions(&self) -> Vec<StatedDirection<'_, N>> {
        let axis = |c: usize| Vector::from_fn(|k, _| f64::from(u8::from(k == c)));
        let of_model = |patch: usize, functions: &[usize]| functions.iter().map(|&f| self.function(patch, f)).collect();
        let mut all: Vec<StatedDirection<'_, N>> = Vec::new();
        for c in &self.conditions {
            let (functions, direction) = (of_model(c.side.patch, &c.side.trace.dofs), axis(c.component));
            all.push(StatedDirection { of: c.of, label: &c.side.label, functions, direction, value: &c.value, patch: c.side.patch });
        }
        for p in &self.pins {
            let (functions, direction) = (of_model(p.rim.patch, &p.rim.rim.functions()), axis(p.component));
            all.push(StatedDirection { of: p.of, label: &p.rim.label, functions, direction, value: &p.value, patch: p.rim.patch });
        }
        for h in &self.held {
            let functions = of_model(h.side.patch, &h.side.trace.dofs);
            all.push(StatedDirection {
                of: h.of,
                label: &h.side.label,
                functions,
                direction: h.direction,
                value: &Value::Zero,
                patch: h.side.patch,
            });
        }
        all
    }

    /// The largest displacement of a slide in a direction that it holds, by what others prescribe there at time `t`, and these.
    fn contradicted<'a>(
        &self,
        slide: &SampledSlide<'_, S, N>,
        before: &[SampledSlide<'a, S, N>],
        known: &'a [StatedDirection<'a, N>],
        t: f64,
    ) -> Option<(f64, Vec<(Statement, &'a str)>)> {
        let value = |k: &StatedDirection<'_, N>, x: &Vector<N>| match k.value {
            Value::Zero => 0.0,
            Value::Data(f) => f.value(&Point::new(x.as_slice()).at_time(t)),
            Value::Exact => {
                let exact = self.patches[k.patch].exact.as_ref().expect("exact data were refused without an exact solution");
                let component = k.direction.imax();
                exact.value(component, &Point::new(x.as_slice()).at_time(t))
            }
        };
        let mut worst: Option<(f64, Vec<(Statement, &str)>)> = None;
        for point in &slide.points {
            let holds = |k: &&StatedDirection<'_, N>| point.functions.iter().all(|f| k.functions.contains(&f.0));
            let mut there: Vec<(Vector<N>, f64, (Statement, &str))> =
                known.iter().filter(holds).map(|k| (k.direction, value(k, &point.x), (k.of, k.label))).collect();
            // data without a value in the point itself, such as those of a corner, are projected there
            if there.is_empty() || there.iter().any(|k| !k.1.is_finite()) {
                continue;
            }
            for other in before {
                let meets = |p: &&SidePoint<N>| self.is_near(&p.x, &point.x);
                let Some(normal) = point.functions.first().and_then(|f| other.points_of(f.0).find(meets)).map(|p| p.normal) else {
                    continue;
                };
                let of = (other.slide.of, &*other.slide.side.label);
                there.extend(other.directions(&normal).into_iter().map(|d| (d, 0.0, of)));
            }
            for d in slide.directions(&point.normal) {
                let Some(defect) = given_along(&there, &d).map(f64::abs).filter(|v| worst.as_ref().is_none_or(|w| *v > w.0)) else {
                    continue;
                };
                let mut others: Vec<(Statement, &str)> = Vec::new();
                for (_, _, of) in there.iter().filter(|k| k.0.dot(&d).abs() > PARALLEL) {
                    if of.0 != slide.slide.of && !others.iter().any(|o| o.0 == of.0) {
                        others.push(*of);
                    }
                }
                worst = Some((defect, others));
            }
        }
        let (defect, others) = worst?;
        let scale = self.prescribed(t).ok()?.iter().fold(0.0_f64, |m, v| m.max(v.1.abs()));
        (defect > NO_DEFECT * scale).then_some((defect, others))
    }
}

/// u along `d`, if the directions with their values give it.
fn given_along<const N: usize, X>(there: &[(Vector<N>, f64, X)], d: &Vector<N>) -> Option<f64> {
    let mut basis: Vec<(Vector<N>, f64)> = Vec::new();
    let rest = |basis: &[(Vector<N>, f64)], d: &Vector<N>| {
        basis.iter().fold((*d, 0.0), |(v, given), (b, value)| (v - b * b.dot(d), given + value * b.dot(d)))
    };
    for (direction, value, _) in there {
        let (across, given) = rest(&basis, direction);
        let size = across.norm();
        if size > PARALLEL {
            basis.push((across / size, (value - given) / size));
        }
    }
    let (across, given) = rest(&basis, d);
    (across.norm() <= PARALLEL).then_some(given)
}
