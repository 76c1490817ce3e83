//! Sums over points of bodies and sides, and fields on sides.

use super::model::BodySide;
use crate::basis::{Order, ShapeTable};
use crate::geometry::MapTable;
use crate::linalg::{Vector, measure};
use crate::quadrature::Quadrature;
use crate::space::{Field, Trace};

/// Calls `visit(element, xi, x, outward normal, ds)` at every point of a side, elements ascending.
pub(super) fn over_side<const S: usize, const N: usize>(
    side: &BodySide<S, N>,
    mut visit: impl FnMut(usize, &Vector<S>, &Vector<N>, &Vector<N>, f64),
) {
    let (space, mut map) = (&*side.trace.space, MapTable::new());
    for e in 0..space.num_elements() {
        let rule = side.rules.rule(e);
        space.map(e, &rule.points, Order::Gradients, &mut map);
        for (q, &w) in rule.weights.iter().enumerate() {
            let normal = side.trace.normal(e, &map.jacobian[q]);
            visit(e, &rule.points[q], &map.x[q], &normal, w * measure(&map.jacobian[q]));
        }
    }
}

/// Evaluates the field `u` on a trace at local points of an element; components beyond the field's are zero.
pub fn on_trace<const S: usize, const N: usize>(
    trace: &Trace<S, N>,
    field: Field,
    u: &[f64],
    element: usize,
    xi: &[Vector<S>],
) -> Vec<[f64; 3]> {
    let (mut ids, mut table) = (Vec::new(), ShapeTable::new());
    trace.space.active(element, &mut ids);
    trace.space.tabulate(element, xi, Order::Values, &mut table);
    (0..xi.len())
        .map(|q| {
            let mut value = [0.0; 3];
            for (&i, n) in ids.iter().zip(table.values(q)) {
                for (c, v) in value.iter_mut().enumerate().take(field.components) {
                    *v += n * u[field.unknown(trace.dofs[i], c)];
                }
            }
            value
        })
        .collect()
}
