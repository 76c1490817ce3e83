//! Points in volumes: their elements and local coordinates.

use super::feasible_step::into_cell;
use super::{Bounds, ClosestPoint, Geometry, MapTable, Projection, cell};
use crate::basis::Order;
use crate::linalg::{Matrix, Real, Vector, inverse, lit};

/// Most steps of Newton's method; it converges in three to six.
const STEPS: usize = 12;

impl<const D: usize, const N: usize, T: Real, G: Geometry<D, N, T>> ClosestPoint<D, N, G, T> {
    /// The place of `p` in an element of a volume (D = N) that holds it, by Newton's method from the centre of the cell; `None` where that
    /// fails, which does not say that `p` is outside.
    pub(super) fn inside(&self, p: &Vector<N, T>, table: &mut MapTable<D, N, T>) -> Option<Projection<D, N, T>> {
        if D != N || D > 3 {
            return None;
        }
        let done = (self.size() + p.amax()) * T::default_epsilon() * lit(4.0);
        self.tree().meeting(&Bounds { lo: *p, hi: *p }).into_iter().find_map(|element| {
            let kind = self.geometry().cell(element);
            let mut xi = cell::center::<D, T>(kind);
            for _ in 0..STEPS {
                self.geometry().map(element, &[xi], Order::Gradients, table);
                let (x, j) = (table.x[0], table.jacobian[0]);
                let away = p - x;
                let distance = away.norm();
                if distance <= done {
                    return Some(Projection { element, xi, x, distance, rim: false });
                }
                // D = N
                let square = Matrix::<D, D, T>::from_fn(|i, k| j[(i, k)]);
                let next = into_cell(kind, xi + inverse(&square)? * Vector::<D, T>::from_fn(|i, _| away[i]));
                if (next - xi).amax() <= T::default_epsilon() {
                    return None;
                }
                xi = next;
            }
            None
        })
    }
}
