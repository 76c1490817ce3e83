//! Resultants of the stresses over a straight cut of the plane: `force.x cut [1, 0] to [1, 2]`, `moment cut [1, 0] to [1, 2] in beam`.
//!
//! With n the unit normal to the right of the way from the first point to the second, force = ∫ sigma n ds is what the part to the right does to
//! the part to the left, moment = ∫ x × sigma n ds about the origin; in Poisson's equation flux = ∫ k grad u . n ds. Gauss points lie in pieces that
//! end where the cut enters another element: no kink or jump is inside. What lies in no body is left out. Along edges of elements, where stresses
//! jump, the sum is the mean of those of both sides, so that the way back has the opposite sign.

use super::grammar::{At, GrammarError, axis, coordinates, keyword};
use super::prepare::{Prepared, Preparer};
use crate::errors::Diagnostic;
use crate::place::SourceSpan;
use faying::geometry::Bounds;
use faying::linalg::Vector;
use faying::problem::Solution;
use faying::quadrature::gauss_legendre;

/// Points of a piece.
const POINTS: usize = 8;
/// Pieces are looked for this many times per element along a row of elements.
const SAMPLES: f64 = 8.0;
/// Share of the cut below which a piece is a point.
const POINT: f64 = 1e-12;
/// Distance from the cut relative to the size of the model at which the elements to its right and left are looked for.
const BESIDE: f64 = 1e-9;
/// Distance from a body relative to the size of the model within which a point is in it.
const IN: f64 = 1e-12;

/// Sums over a cut.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum CutSum {
    /// A component of the force.
    Force(usize),
    /// The moment about the origin.
    Moment,
    /// The flux of Poisson's equation.
    Flux,
}

/// A cut with the points of its sums.
#[derive(Clone, Debug, PartialEq)]
pub struct PreparedCut<const N: usize> {
    sum: CutSum,
    normal: Vector<N>,
    /// Patch, element, local coordinates and weight \[length\].
    points: Vec<(usize, usize, Vector<N>, f64)>,
}

/// The words around `cut`: what is summed, and both ends.
pub(super) fn parse(head: &str, place: &str) -> Result<(CutSum, [Vec<String>; 2]), GrammarError> {
    let wrong = |message: String| Err(GrammarError { message });
    if let Some(word) = ["at", "about"].into_iter().find(|word| keyword(head, word).or_else(|| keyword(place, word)).is_some()) {
        return wrong(format!("a sum over a cut takes no `{word}`: moments are about the origin; `in PATCH` may stand at its end"));
    }
    let sum = match head.split_once('.') {
        None if head == "moment" => CutSum::Moment,
        None if head == "flux" => CutSum::Flux,
        Some(("force", c)) if axis(c).is_some() => CutSum::Force(axis(c).unwrap_or(0)),
        _ => return wrong(format!("`{head}` is no sum over a cut; force.x, force.y, moment are, and flux in Poisson's equation")),
    };
    let Some(k) = keyword(place, "to") else {
        return wrong(format!("a cut has two ends; write {head} cut [0, 0] to [0, 1]"));
    };
    Ok((sum, [coordinates(place[..k].trim())?, coordinates(place[k + 3..].trim())?]))
}

/// The part of the way from `from` to `to` within a box, however far away both points are; `None` where it passes by.
fn within<const N: usize>(from: Vector<N>, to: Vector<N>, around: &Bounds<N>) -> Option<(Vector<N>, Vector<N>)> {
    let (mut from, mut to) = (from, to);
    for k in 0..N {
        for (bound, sign) in [(around.lo[k], 1.0), (around.hi[k], -1.0)] {
            let outside = |x: &Vector<N>| sign * (bound - x[k]) > 0.0;
            // weights of both ends without their difference, which may exceed all numbers
            let cut = |out: &Vector<N>, inside: &Vector<N>| {
                let scale = (0.5 * inside[k] - 0.5 * out[k]).abs();
                let [w, v] = [(0.5 * inside[k] - 0.5 * bound).abs() / scale, (0.5 * bound - 0.5 * out[k]).abs() / scale];
                Vector::from_fn(|j, _| if j == k { bound } else { w * out[j] + v * inside[j] })
            };
            match (outside(&from), outside(&to)) {
                (true, true) => return None,
                (true, false) => from = cut(&from, &to),
                (false, true) => to = cut(&to, &from),
                (false, false) => {}
            }
        }
    }
    Some((from, to))
}

impl<const S: usize, const N: usize> Preparer<'_, S, N> {
    /// Prepares a sum over a cut of `bodies`.
    pub(super) fn cut(
        &self,
        text: &str,
        (sum, ends): (CutSum, [Vec<String>; 2]),
        bodies: &[usize],
        at: SourceSpan,
    ) -> Result<Prepared<S, N>, Box<Diagnostic>> {
        let scalar = self.contents.components() == 1;
        if N != 2 || self.contents.is_revolved() {
            let help = "force.PATCH.SIDE.x is the force on a side, interface.NAME.force that of a tie";
            let fault = self.fault("E019", format!("`{text}`: cuts are those of plane models in this version"), at);
            return Err(Box::new(fault.with_help(help)));
        }
        let wrong = match sum {
            CutSum::Flux if !scalar => Some("the flux belongs to Poisson problems; write force.x, force.y or moment"),
            CutSum::Force(_) | CutSum::Moment if scalar => Some("forces and moments belong to elasticity; write flux"),
            CutSum::Force(c) if c >= N => Some("this component is not there in the plane"),
            _ => None,
        };
        if let Some(why) = wrong {
            return Err(self.fault("E018", format!("`{text}` is no quantity here: {why}"), at));
        }
        let [from, to] = ends.map(|end| self.point(text, &At::Point(end), at));
        let (from, to) = (from?, to?);
        if (to - from).amax() <= IN * self.contents.size().diagonal {
            return Err(self.fault("E015", format!("`{text}`: the cut has no length"), at));
        }
        let points_between = |(from, to): (Vector<N>, Vector<N>)| {
            let along = to - from;
            let normal = Vector::<N>::from_fn(|k, _| if k == 0 { along[1] } else { -along[0] }) / along.norm();
            (normal, self.points_of_cut(from, along, normal, bodies))
        };
        let boxes = bodies.iter().filter_map(|&k| self.contents.body(k).space().extent());
        let around = boxes.reduce(|a, b| a.union(&b)).map(|b| b.inflated(BESIDE * self.contents.size().diagonal));
        let (normal, points) = around.and_then(|b| within(from, to, &b)).map_or((Vector::zeros(), Vec::new()), points_between);
        if points.is_empty() {
            let fault = self.fault("E022", format!("`{text}`: no point of the cut is inside of a body"), at);
            return Err(Box::new(fault.with_help("move its ends so that it crosses a body")));
        }
        Ok(Prepared::Cut(PreparedCut { sum, normal, points }))
    }

    /// The Gauss points of all pieces, each in the elements to its right and left.
    fn points_of_cut(&self, from: Vector<N>, along: Vector<N>, normal: Vector<N>, bodies: &[usize]) -> Vec<(usize, usize, Vector<N>, f64)> {
        let size = self.contents.size().diagonal;
        let (near, beside) = (IN * size, normal * (BESIDE * size));
        let at = |x: Vector<N>| {
            let found =
                bodies.iter().filter_map(|&k| Some((k, self.locators.of(k).locate(&x).ok().filter(|found| found.distance <= near)?)));
            found.map(|(k, found)| (k, found.element, found.xi)).next()
        };
        let inside = |s: f64| {
            let x = from + along * s;
            at(x).map(|own| [at(x + beside).unwrap_or(own), at(x - beside).unwrap_or(own)])
        };
        let owner = |s: f64| inside(s).map(|both| both.map(|(patch, element, _)| (patch, element)));
        let elements: usize = bodies.iter().map(|k| self.contents.body(*k).space().num_elements()).sum();
        let samples = (SAMPLES * (elements as f64).sqrt()).ceil().max(2.0 * SAMPLES) as usize;
        let mut ends = vec![0.0];
        let mut before = owner(0.0);
        for k in 1..=samples {
            let (mut low, high) = ((k - 1) as f64 / samples as f64, k as f64 / samples as f64);
            let last = owner(high);
            // every change on the way, the first one first
            while before != last {
                let (mut a, mut b) = (low, high);
                while b - a > POINT {
                    let middle = 0.5 * (a + b);
                    if owner(middle) == before { a = middle } else { b = middle }
                }
                ends.push(b);
                (low, before) = (b, if high - b > POINT { owner(b) } else { last });
            }
        }
        ends.push(1.0);
        let rule = gauss_legendre::<f64>(POINTS);
        let mut points = Vec::new();
        for piece in ends.windows(2) {
            for (xi, weight) in rule.points.iter().zip(&rule.weights) {
                let s = piece[0] + (piece[1] - piece[0]) * xi[0];
                for (patch, element, xi) in inside(s).into_iter().flatten() {
                    points.push((patch, element, xi, 0.5 * weight * (piece[1] - piece[0]) * along.norm()));
                }
            }
        }
        points
    }
}

impl<const N: usize> PreparedCut<N> {
    /// The sum on a solution; NaN where an element has no stress.
    pub(super) fn value<const S: usize>(&self, solution: &Solution<S, N>) -> f64 {
        let of = |(patch, element, xi, ds): &(usize, usize, Vector<N>, f64)| {
            let body = solution.contents().body(*patch).id();
            let Some(state) = solution.in_element(body, *element, &[(*xi).into()]).ok().and_then(|states| states.first().copied()) else {
                return f64::NAN;
            };
            let (s, n) = (state.stress, [self.normal[0], self.normal[1]]);
            let traction = [s[0] * n[0] + s[3] * n[1], s[3] * n[0] + s[1] * n[1]];
            ds * match self.sum {
                CutSum::Force(c) => traction[c],
                CutSum::Moment => state.x[0] * traction[1] - state.x[1] * traction[0],
                CutSum::Flux => s[0] * n[0] + s[1] * n[1],
            }
        };
        self.points.iter().map(of).sum()
    }
}
