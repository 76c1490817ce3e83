//! Arc length along a side that is a chain of curves.

use super::model::BodySide;
use crate::basis::Order;
use crate::coupling::interface::Chain;
use crate::geometry::{Geometry, MapTable};
use crate::linalg::Vector;
use crate::quadrature::{Rule, gauss_legendre};
use std::collections::HashMap;

/// Gauss points per stretch.
const POINTS: usize = 8;
/// Bisections of a point's local coordinate.
const STEPS: usize = 50;
/// Newton steps towards it.
const GUESSES: usize = 4;
/// Uncertainty of an arc length, in units of round-off.
const ROUNDINGS: f64 = 256.0;

/// Arc length along a chain of curves: start, length and direction of every element.
#[derive(Debug)]
pub struct ArcLength<'a, const N: usize> {
    curve: &'a dyn Geometry<1, N>,
    start: Vec<f64>,
    length: Vec<f64>,
    reversed: Vec<bool>,
    walk: Vec<usize>,
    rule: Rule<1>,
}

impl<'a, const N: usize> ArcLength<'a, N> {
    /// Creates the chain of `curve`, from its first end.
    pub fn new(curve: &'a dyn Geometry<1, N>) -> Self {
        let n = curve.num_elements();
        let mut out = Self {
            curve,
            start: vec![0.0; n],
            length: vec![0.0; n],
            reversed: vec![false; n],
            walk: Vec::new(),
            rule: gauss_legendre(POINTS),
        };
        let mut s = 0.0;
        for (e, reversed) in Chain::of(curve).walk() {
            out.length[e] = out.stretch(e, 1.0);
            (out.start[e], out.reversed[e]) = (s, reversed);
            s += out.length[e];
            out.walk.push(e);
        }
        out
    }

    /// Arc length along a side; along the whole one for a piece of it between kinks.
    pub fn of_side(side: &'a BodySide<1, N>) -> Self {
        let mut own = Self::new(&*side.trace.space);
        let Some(whole) = &side.whole else { return own };
        let all = Self::new(&*whole.side.trace.space);
        let mut place = HashMap::new();
        for (e, &w) in whole.elements.iter().enumerate() {
            (own.start[e], own.reversed[e]) = (all.start[w], all.reversed[w]);
            place.insert(w, e);
        }
        own.walk = all.walk.iter().filter_map(|w| place.get(w).copied()).collect();
        own
    }

    /// Length of element `e` from its local start to `xi`.
    fn stretch(&self, e: usize, xi: f64) -> f64 {
        self.stretch_and_speed(e, xi, &mut MapTable::new())[0]
    }

    /// Length of element `e` from its local start to `xi`, and |dx/dxi| there.
    fn stretch_and_speed(&self, e: usize, xi: f64, map: &mut MapTable<1, N>) -> [f64; 2] {
        let points: [Vector<1>; POINTS + 1] = std::array::from_fn(|q| Vector::<1>::new(self.rule.points.get(q).map_or(xi, |p| p[0] * xi)));
        self.curve.map(e, &points, Order::Gradients, map);
        let length = map.jacobian.iter().zip(&self.rule.weights).map(|(j, w)| xi * w * j.norm()).sum();
        [length, map.jacobian[POINTS].norm()]
    }

    /// Arc length of a local point.
    pub fn of(&self, e: usize, xi: f64) -> f64 {
        self.along(e, self.stretch(e, xi))
    }

    /// Arc length of the point of element `e` at the distance `within` from its local start.
    fn along(&self, e: usize, within: f64) -> f64 {
        self.start[e] + if self.reversed[e] { self.length[e] - within } else { within }
    }

    /// The point at an arc length.
    pub fn point(&self, s: f64) -> Vector<N> {
        let Some(&e) = self.walk.iter().rev().find(|&&e| self.start[e] <= s).or(self.walk.first()) else { return Vector::zeros() };
        let mut map = MapTable::new();
        let mut before = |xi: f64| (self.along(e, self.stretch_and_speed(e, xi, &mut map)[0]) < s) != self.reversed[e];
        // bisection is needed between these bounds only
        let [mut least, mut most] = self.near(e, s);
        least = if before(least) { least } else { 0.0 };
        most = if before(most) { 1.0 } else { most };
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..STEPS {
            let middle = 0.5 * (low + high);
            if middle <= least || (middle < most && before(middle)) { low = middle } else { high = middle }
        }
        self.curve.map(e, &[Vector::<1>::new(0.5 * (low + high))], Order::Values, &mut map);
        map.x[0]
    }

    /// Local coordinates of element `e` on both sides of the point at the arc length `s`, further apart than round-off.
    fn near(&self, e: usize, s: f64) -> [f64; 2] {
        let wanted = if self.reversed[e] { self.length[e] - (s - self.start[e]) } else { s - self.start[e] };
        let (mut xi, mut slowest, mut map) = ((wanted / self.length[e]).clamp(0.0, 1.0), f64::INFINITY, MapTable::new());
        for _ in 0..GUESSES {
            let [within, speed] = self.stretch_and_speed(e, xi, &mut map);
            slowest = speed.min(slowest);
            xi = (xi - (within - wanted) / speed).clamp(0.0, 1.0);
        }
        let apart = ROUNDINGS * f64::EPSILON * (1.0 + (self.start[e] + self.length[e]) / slowest);
        if apart < 0.5 && xi.is_finite() { [xi - apart, xi + apart].map(|xi| xi.clamp(0.0, 1.0)) } else { [0.0, 1.0] }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::basis::{BSpline, Rational};
    use crate::geometry::ControlPoints;

    #[test]
    fn points_have_their_arc_length_to_rounding_and_the_bits_of_plain_bisection() {
        let axis = BSpline::uniform(2, 5, 1);
        let count = crate::basis::Basis::<1>::num_functions(&axis);
        let points: Vec<Vector<2>> =
            (0..count).map(|i| Vector::<2>::new((0.6 * i as f64).cos() + 7.0, 3.0 * (0.6 * i as f64).sin())).collect();
        let curve = ControlPoints { basis: Rational::new::<1>(axis, (0..count).map(|i| 1.0 + 0.3 * (i % 2) as f64).collect()), points };
        let arc = ArcLength::new(&curve);
        let total: f64 = arc.length.iter().sum();
        let mut map = MapTable::new();
        for k in 0..=200 {
            let s = total * k as f64 / 200.0;
            let e = *arc.walk.iter().rev().find(|&&e| arc.start[e] <= s).unwrap();
            let (mut low, mut high) = (0.0, 1.0);
            for _ in 0..STEPS {
                let middle = 0.5 * (low + high);
                if (arc.of(e, middle) < s) != arc.reversed[e] { low = middle } else { high = middle }
            }
            let xi = 0.5 * (low + high);
            curve.map(e, &[Vector::<1>::new(xi)], Order::Values, &mut map);
            assert_eq!(arc.point(s), map.x[0], "s = {s}");
            assert!((arc.of(e, xi) - s).abs() < 1e-14 * total, "s = {s}");
        }
    }
}
