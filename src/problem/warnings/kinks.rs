//! Whether the functions of a multiplier kink between the elements of the slave side.
//!
//! Gradients along the surface are compared on both sides of the middle of every edge that two elements have in common (of curves: of every
//! end). A function kinks there if they differ by more than half of what they are together; those of Lagrange do, by all of it, smooth splines
//! do not, on curved facets up to what these turn.

use crate::basis::{Basis, Cell, Order, ShapeTable};
use crate::geometry::MapTable;
use crate::linalg::{Matrix, Vector};
use crate::space::Space;
use std::collections::{BTreeMap, HashMap};

/// |g - g'| over |g| + |g'| from which on a function kinks.
const KINK: f64 = 0.5;
/// Places that agree to this part of the side's size are one.
const SAME: f64 = 1e-7;

/// Middles of the edges of a cell, or ends of an interval.
fn middles<const S: usize>(cell: Cell) -> Vec<Vector<S>> {
    if S > 1 && cell == Cell::Simplex {
        let vertex = |k: usize| Vector::<S>::from_fn(|i, _| if i + 1 == k { 1.0 } else { 0.0 });
        return (0..=S).flat_map(|a| (0..a).map(move |b| (vertex(a) + vertex(b)) * 0.5)).collect();
    }
    let end = |k: usize, at: f64| Vector::<S>::from_fn(|i, _| if i == k { at } else { 0.5 });
    (0..S).flat_map(|k| [end(k, 0.0), end(k, 1.0)]).collect()
}

/// Share of the edges between two elements of `space` at which a function of `psi` kinks; zero of a single element.
pub(super) fn kinked_share<const S: usize, const N: usize>(space: &dyn Space<S, N>, psi: &dyn Basis<S>) -> f64 {
    let size = space.extent().map_or(1.0, |b| b.diagonal()) * SAME;
    let mut seen: HashMap<[i64; N], BTreeMap<usize, Vector<N>>> = HashMap::new();
    let (mut ids, mut table, mut map) = (Vec::new(), ShapeTable::new(), MapTable::new());
    let (mut common, mut kinked) = (0, 0);
    for e in 0..psi.num_elements() {
        let at = middles::<S>(space.cell(e));
        space.map(e, &at, Order::Gradients, &mut map);
        psi.active(e, &mut ids);
        psi.tabulate(e, &at, Order::Gradients, &mut table);
        for (q, x) in map.x.iter().enumerate() {
            // J (Jᵀ J)^-1 takes a gradient to that along the surface
            let jacobian = &map.jacobian[q];
            let metric = Matrix::<S, S>::from_fn(|i, j| jacobian.column(i).dot(&jacobian.column(j)));
            let Some(inverse) = nalgebra::DMatrix::from_fn(S, S, |i, j| metric[(i, j)]).try_inverse() else { continue };
            let inverse = Matrix::<S, S>::from_fn(|i, j| inverse[(i, j)]);
            let own: BTreeMap<usize, Vector<N>> = ids.iter().zip(table.grads(q)).map(|(&j, g)| (j, jacobian * (inverse * g))).collect();
            let key = std::array::from_fn(|k| (x[k] / size).round() as i64);
            let Some(other) = seen.remove(&key) else {
                seen.insert(key, own);
                continue;
            };
            common += 1;
            let zero = Vector::<N>::zeros();
            let mut functions = own.keys().chain(other.keys());
            let scale = own.values().chain(other.values()).map(|g| g.norm()).fold(0.0, f64::max);
            kinked += usize::from(functions.any(|j| {
                let [a, b] = [&own, &other].map(|list| list.get(j).unwrap_or(&zero));
                let sum = a.norm() + b.norm();
                sum > KINK * scale && (a - b).norm() > KINK * sum
            }));
        }
    }
    if common == 0 { 0.0 } else { kinked as f64 / common as f64 }
}
