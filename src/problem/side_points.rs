//! Points of a side with its normals, and the functions of the model that have a value there.

use super::model::{BodySide, Model};
use crate::basis::{Order, ShapeTable};
use crate::geometry::{MapTable, cell};
use crate::linalg::{Vector, measure};

/// Function values below this count as zero.
const NO_VALUE: f64 = 1e-10;
/// Share of the measure at the centre of an element below which its map is singular.
const SINGULAR: f64 = 1e-9;
/// Points closer than this share of the size of the model are one.
const SAME_PLACE: f64 = 1e-9;

/// A point of a side.
#[derive(Debug)]
pub(super) struct SidePoint<const N: usize> {
    pub x: Vector<N>,
    /// The unit normal out of the body.
    pub normal: Vector<N>,
    /// Functions of the model with their values.
    pub functions: Vec<(usize, f64)>,
}

impl<const N: usize> SidePoint<N> {
    /// The value of a function, without its sign.
    pub fn value(&self, function: usize) -> f64 {
        self.functions.iter().filter(|f| f.0 == function).map(|f| f.1.abs()).sum()
    }
}

/// Points of all elements of a side, corners and edges included, degree + 2 per direction; without those at which the map is singular.
pub(super) fn side_points<const S: usize, const N: usize>(model: &Model<S, N>, side: &BodySide<S, N>) -> Vec<SidePoint<N>> {
    let (space, trace) = (&*side.trace.space, &side.trace);
    let (mut shapes, mut map, mut ids) = (ShapeTable::new(), MapTable::new(), Vec::new());
    let mut all = Vec::new();
    for e in 0..space.num_elements() {
        space.map(e, &[cell::center(space.cell(e))], Order::Gradients, &mut map);
        let least = SINGULAR * measure(&map.jacobian[0]);
        let points = cell::grid::<S, f64>(space.cell(e), side.degree() + 2);
        space.active(e, &mut ids);
        space.evaluate(e, &points, Order::Gradients, &mut shapes, &mut map);
        for q in 0..points.len() {
            let normal = trace.normal(e, &map.jacobian[q]);
            if measure(&map.jacobian[q]) <= least || !normal.iter().all(|v| v.is_finite()) {
                continue;
            }
            let values = ids.iter().zip(shapes.values(q)).filter(|(_, value)| value.abs() > NO_VALUE);
            let functions = values.map(|(&i, &value)| (model.function(side.patch, trace.dofs[i]), value)).collect();
            all.push(SidePoint { x: map.x[q], normal, functions });
        }
    }
    all
}

impl<const S: usize, const N: usize> Model<S, N> {
    /// Whether two points are one.
    pub(super) fn is_near(&self, a: &Vector<N>, b: &Vector<N>) -> bool {
        (a - b).norm() <= SAME_PLACE * self.size
    }
}
