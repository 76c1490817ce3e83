//! A discrete field at points of an element.

use super::scratch::inverse_or_nan;
use crate::basis::{Order, ShapeTable};
use crate::geometry::MapTable;
use crate::linalg::{Matrix, Real, Vector};
use crate::space::Space;

/// A field at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample<const C: usize, const N: usize, T: Real = f64> {
    /// Where.
    pub x: Vector<N, T>,
    /// u.
    pub value: Vector<C, T>,
    /// `gradient[(i, j)]` = du_i/dx_j; not finite where the map is singular.
    pub gradient: Matrix<C, N, T>,
}

/// The field `u` (unknown = C * function + component) at the local points `xi` of `element`.
///
/// # Panics
/// If `u` is shorter than C times the number of functions.
pub fn sample<const C: usize, const N: usize, T: Real, S: Space<N, N, T> + ?Sized>(
    space: &S,
    u: &[T],
    element: usize,
    xi: &[Vector<N, T>],
) -> Vec<Sample<C, N, T>> {
    let (mut ids, mut shapes, mut map) = (Vec::new(), ShapeTable::new(), MapTable::new());
    space.active(element, &mut ids);
    space.evaluate(element, xi, Order::Gradients, &mut shapes, &mut map);
    (0..xi.len())
        .map(|q| {
            let (mut value, mut local) = (Vector::<C, T>::zeros(), Matrix::<C, N, T>::zeros());
            for ((&i, &n), g) in ids.iter().zip(shapes.values(q)).zip(shapes.grads(q)) {
                for c in 0..C {
                    let coefficient = u[C * i + c];
                    value[c] += coefficient * n;
                    for k in 0..N {
                        local[(c, k)] += coefficient * g[k];
                    }
                }
            }
            Sample { x: map.x[q], value, gradient: local * inverse_or_nan(&map.jacobian[q]) }
        })
        .collect()
}
