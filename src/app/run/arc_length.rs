//! Arc length along a side that is a chain of curves.

use crate::basis::Order;
use crate::coupling::interface::Chain;
use crate::geometry::{Geometry, MapTable};
use crate::linalg::Vector;
use crate::quadrature::gauss_legendre;

/// Gauss points per stretch.
const POINTS: usize = 8;
/// Bisections of a point's local coordinate.
const STEPS: usize = 50;

/// Where every element begins, and which way it runs.
#[derive(Debug)]
pub struct ArcLength<'a, const N: usize> {
    curve: &'a dyn Geometry<1, N>,
    start: Vec<f64>,
    length: Vec<f64>,
    reversed: Vec<bool>,
    walk: Vec<usize>,
}

impl<'a, const N: usize> ArcLength<'a, N> {
    /// The chain of `curve`, from its first end.
    pub fn new(curve: &'a dyn Geometry<1, N>) -> Self {
        let n = curve.num_elements();
        let mut out = Self { curve, start: vec![0.0; n], length: vec![0.0; n], reversed: vec![false; n], walk: Vec::new() };
        let mut s = 0.0;
        for (e, reversed) in Chain::of(curve).walk() {
            out.length[e] = out.stretch(e, 1.0);
            (out.start[e], out.reversed[e]) = (s, reversed);
            s += out.length[e];
            out.walk.push(e);
        }
        out
    }

    /// Length of element `e` from its local start to `xi`.
    fn stretch(&self, e: usize, xi: f64) -> f64 {
        let rule = gauss_legendre::<f64>(POINTS);
        let points: Vec<Vector<1>> = rule.points.iter().map(|p| p * xi).collect();
        let mut map = MapTable::new();
        self.curve.map(e, &points, Order::Gradients, &mut map);
        map.jacobian.iter().zip(&rule.weights).map(|(j, w)| xi * w * j.norm()).sum()
    }

    /// Arc length of a local point.
    pub fn of(&self, e: usize, xi: f64) -> f64 {
        let within = self.stretch(e, xi);
        self.start[e] + if self.reversed[e] { self.length[e] - within } else { within }
    }

    /// The point at an arc length.
    pub fn point(&self, s: f64) -> Vector<N> {
        let Some(&e) = self.walk.iter().rev().find(|&&e| self.start[e] <= s).or(self.walk.first()) else { return Vector::zeros() };
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..STEPS {
            let middle = 0.5 * (low + high);
            if (self.of(e, middle) < s) != self.reversed[e] { low = middle } else { high = middle }
        }
        let mut map = MapTable::new();
        self.curve.map(e, &[Vector::<1>::new(0.5 * (low + high))], Order::Values, &mut map);
        map.x[0]
    }
}
