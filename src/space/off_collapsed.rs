//! Points moved off the edges where the map of an element collapses.

use super::Space;
use crate::basis::Order;
use crate::geometry::{MapTable, cell};
use crate::linalg::{Vector, measure};

/// Volume change of a map, relative to that in the middle of the element, below which the map has collapsed.
const COLLAPSED: f64 = 1e-12;
/// Share of the element by which points are moved off a collapsed edge.
const NUDGE: f64 = 1e-7;

/// Returns the local points `xi` of an element, those moved nearer to its middle by 1e-7 of the element at which its map collapses, as at
/// the centre of a disc: gradients have a limit there and no value at the point itself. Nearer points lose more to round-off than this
/// distance changes the field.
pub fn off_collapsed<const N: usize, X: Space<N, N> + ?Sized>(
    space: &X,
    element: usize,
    xi: impl IntoIterator<Item = Vector<N>>,
) -> Vec<Vector<N>> {
    let middle = cell::center::<N, f64>(space.cell(element));
    // a map that collapses does so in a corner
    let mut looks = cell::corners::<N, f64>(space.cell(element));
    looks.push(middle);
    let mut map = MapTable::new();
    space.map(element, &looks, Order::Gradients, &mut map);
    let volume = |map: &MapTable<N, N>, q: usize| measure(&map.jacobian[q]);
    let least = COLLAPSED * volume(&map, looks.len() - 1);
    let mut xi: Vec<Vector<N>> = xi.into_iter().collect();
    if (0..looks.len() - 1).all(|q| volume(&map, q) > least) {
        return xi;
    }
    space.map(element, &xi, Order::Gradients, &mut map);
    for (q, xi) in xi.iter_mut().enumerate() {
        if volume(&map, q) <= least {
            *xi += (middle - *xi) * NUDGE;
        }
    }
    xi
}
