//! Segments on surfaces of revolution.

use super::Segments;
use crate::basis::{Cell, Order};
use crate::geometry::{Geometry, MapTable, circumference};
use crate::linalg::{Real, Vector, measure};
use crate::quadrature::{Quadrature, TensorRule, simplex_rule};

/// Gauss points per direction that measure an element.
const POINTS: usize = 12;

impl<const D: usize, T: Real> Segments<D, T> {
    /// The segments of the surface that the `slave` makes on its way around the axis: weights times 2 pi r, r the first coordinate of the
    /// slave's points. The measures of the report are areas then, the shares of the elements stay those of the curve.
    #[must_use]
    pub fn revolved<const N: usize>(self, slave: &dyn Geometry<D, N, T>) -> Self {
        let mut out = self.scaled(slave, &circumference);
        let rules = [TensorRule::<D, T>::gauss([POINTS; D]).rule(0).clone(), simplex_rule::<D, T>(2 * POINTS - 1)];
        let mut map = MapTable::new();
        let mut of_element = |e: usize| {
            let rule = &rules[usize::from(slave.cell(e) == Cell::Simplex)];
            slave.map(e, &rule.points, Order::Gradients, &mut map);
            let points = rule.weights.iter().zip(&map.jacobian).zip(&map.x);
            points.fold(T::zero(), |s, ((&w, j), x)| s + w * measure(j) * circumference(x))
        };
        out.report.covered = out.measure();
        out.report.slave_measure = (0..slave.num_elements()).fold(T::zero(), |s, e| s + of_element(e));
        out
    }

    /// The segments with their weights times a function of the slave's points; the report stays as it is.
    #[must_use]
    pub fn scaled<const N: usize>(mut self, slave: &dyn Geometry<D, N, T>, factor: &dyn Fn(&Vector<N, T>) -> T) -> Self {
        let mut map = MapTable::new();
        for piece in 0..self.num_pieces() {
            let points = self.points(piece);
            slave.map(self.slave[piece], &self.slave_xi[points.clone()], Order::Values, &mut map);
            for (ds, x) in self.ds[points].iter_mut().zip(&map.x) {
                *ds *= factor(x);
            }
        }
        self
    }
}
