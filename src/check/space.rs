//! Contract of [`Space`]: a sound map, and [`Space::evaluate`] equal to its separate tables.

use super::geometry::{chosen, sample_points};
use crate::basis::{Order, ShapeTable};
use crate::geometry::MapTable;
use crate::linalg::{Real, num};
use crate::space::Space;

/// Checks the map of `space` as [`geometry`](super::geometry()) does, and [`Space::evaluate`].
///
/// Rules: `evaluate` gives what `tabulate` and `map` give, to rounding; as many functions are tabulated as are active,
/// each listed once and with an id below their number.
///
/// # Errors
/// A sentence that names the broken rule and the place.
pub fn space<const D: usize, const N: usize, T: Real, X: Space<D, N, T> + ?Sized>(space: &X) -> Result<(), String> {
    super::geometry::geometry(space)?;
    let near = T::default_epsilon() * num(1000);
    let (mut shapes, mut both) = (ShapeTable::new(), ShapeTable::new());
    let (mut map, mut both_map) = (MapTable::new(), MapTable::new());
    let mut ids = Vec::new();
    for e in chosen(space.num_elements()) {
        let points = sample_points::<D, T>(space.cell(e));
        space.active(e, &mut ids);
        let listed = ids.len();
        ids.sort_unstable();
        ids.dedup();
        if ids.len() != listed || ids.last().is_some_and(|&i| i >= space.num_functions()) {
            return Err(format!("element {e}: a function is listed twice, or has an id that is too large"));
        }
        for order in [Order::Values, Order::Gradients, Order::Hessians] {
            space.tabulate(e, &points, order, &mut shapes);
            space.map(e, &points, order, &mut map);
            space.evaluate(e, &points, order, &mut both, &mut both_map);
            if shapes.num_functions() != listed || both.num_functions() != listed {
                return Err(format!("element {e}: {} functions are tabulated, {listed} are active", shapes.num_functions()));
            }
            let size = space.bounds(e).diagonal() + map.x.iter().fold(T::zero(), |m, x| m.max(x.amax()));
            for q in 0..points.len() {
                let mut off = shapes.values(q).iter().zip(both.values(q)).fold(T::zero(), |m, (a, b)| m.max((*a - *b).abs()));
                let mut off_map = (map.x[q] - both_map.x[q]).amax();
                if order >= Order::Gradients {
                    let scale = shapes.grads(q).iter().fold(T::one(), |m, g| m.max(g.amax()));
                    off = shapes.grads(q).iter().zip(both.grads(q)).fold(off, |m, (a, b)| m.max((a - b).amax() / scale));
                    off_map = off_map.max((map.jacobian[q] - both_map.jacobian[q]).amax());
                }
                if order >= Order::Hessians {
                    let scale = shapes.hessians(q).iter().fold(T::one(), |m, h| m.max(h.amax()));
                    off = shapes.hessians(q).iter().zip(both.hessians(q)).fold(off, |m, (a, b)| m.max((a - b).amax() / scale));
                    let bend = map.hessian[q].iter().fold(T::one(), |m, h| m.max(h.amax() / size));
                    off_map = (0..N).fold(off_map, |m, c| m.max((map.hessian[q][c] - both_map.hessian[q][c]).amax() / bend));
                }
                if off > near || off_map > near * size {
                    return Err(format!("element {e}, xi = {:?}: evaluate differs from tabulate and map at order {order:?}", points[q]));
                }
            }
        }
    }
    Ok(())
}
