//! Choice of the cell type and degree of an element, and the denominator of map and basis on it.

use super::cells::{Shape, inner_points, nodes};
use super::{CellStyle, MAX_DEGREE, Part};
use faying::basis::{Block, Cell, Order, ShapeTable};
use faying::geometry::MapTable;
use faying::linalg::{Matrix, Vector, determinant};
use faying::space::Space;

/// Cell type, degrees and orientation of the cell of an element.
#[derive(Clone, Copy, Debug)]
pub(super) struct Plan<const D: usize> {
    pub cell: Cell,
    pub shape: Shape,
    pub degree: [usize; D],
    /// Degree of the Lagrange cell used if the Bezier cell is not exact.
    pub lagrange: [usize; D],
    pub map_weights: bool,
    pub basis_weights: bool,
    /// Whether the map has a negative Jacobian determinant; its cell is then mirrored.
    pub left: bool,
}

/// Plan of an element: a Bezier cell if map and basis are polynomial or rational of a degree that VTK evaluates.
pub(super) fn plan<const D: usize, const N: usize>(part: &Part<'_, D, N>, element: usize, table: &mut MapTable<D, N>) -> Plan<D> {
    let space = &*part.space;
    let cell = space.cell(element);
    let p = space.degree(element);
    let map = space.map_structure().map_block(element);
    let map_degree = map.as_ref().map_or(p, |m| block_degree(&m.basis, element));
    let highest: [usize; D] = std::array::from_fn(|k| p[k].max(map_degree[k]));
    // linear cells of a degree-p element are cut between the same nodes
    let mut lagrange = highest.map(|d| d.max(part.least_degree).clamp(1, MAX_DEGREE));
    let quadratic = lagrange.iter().any(|d| *d > 1);
    if part.style == CellStyle::Quadratic {
        lagrange = [if quadratic { 2 } else { 1 }; D];
    }
    let mut plan = Plan {
        cell,
        shape: match part.style {
            CellStyle::Quadratic if quadratic => Shape::Quadratic,
            CellStyle::Linear | CellStyle::Quadratic => Shape::Linear,
            CellStyle::Bezier | CellStyle::Lagrange => Shape::Lagrange,
        },
        degree: lagrange,
        lagrange,
        map_weights: false,
        basis_weights: false,
        left: is_left(space, element, table),
    };
    if part.style != CellStyle::Bezier {
        return plan;
    }
    let at = inner_points(cell, &nodes(cell, highest), highest);
    let w = map.and_then(|m| denominators(&m.basis, element, &at)).filter(|w| varies(w));
    let v = space.structure().block(element).and_then(|b| denominators(&b, element, &at)).filter(|v| varies(v));
    let same = |w: &[f64], v: &[f64]| !varies(&w.iter().zip(v).map(|(w, v)| w / v).collect::<Vec<_>>());
    (plan.map_weights, plan.basis_weights) = match (&w, &v) {
        (Some(w), Some(v)) => (true, !same(w, v)),
        (w, v) => (w.is_some(), v.is_some()),
    };
    let one_function = match (&w, &v) {
        (None, None) => true,
        (Some(w), Some(v)) => same(w, v),
        _ => false,
    };
    plan.degree = if one_function { highest } else { std::array::from_fn(|k| p[k] + map_degree[k]) }.map(|d| d.max(1));
    if plan.degree.iter().all(|&d| d <= MAX_DEGREE) {
        plan.shape = Shape::Bezier;
    } else {
        plan.degree = lagrange;
    }
    plan
}

/// Whether the Jacobian determinant is negative in the middle of an element; a surface in space has no sign.
fn is_left<const D: usize, const N: usize>(space: &dyn Space<D, N>, element: usize, table: &mut MapTable<D, N>) -> bool {
    if D != N || D == 1 {
        return false;
    }
    let middle = if space.cell(element) == Cell::Simplex { 1.0 / (D as f64 + 1.0) } else { 0.5 };
    space.map(element, &[Vector::<D>::repeat(middle)], Order::Gradients, table);
    determinant(&Matrix::<D, D>::from_fn(|i, k| table.jacobian[0][(i, k)])) < 0.0
}

/// Whether positive numbers differ by more than rounding.
fn varies(w: &[f64]) -> bool {
    let (lo, hi) = w.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), &w| (lo.min(w), hi.max(w)));
    hi - lo > 1e-13 * hi.abs()
}

/// Element along every axis that corresponds to `element` of a block.
fn axis_elements<const D: usize>(block: &Block<'_, D>, element: usize) -> [usize; D] {
    let mut rest = element - block.first;
    std::array::from_fn(|k| {
        let n = block.axes[k].num_elements();
        let e = rest % n;
        rest /= n;
        e
    })
}

fn block_degree<const D: usize>(block: &Block<'_, D>, element: usize) -> [usize; D] {
    let e = axis_elements(block, element);
    std::array::from_fn(|k| block.axes[k].degree(e[k])[0])
}

/// sum_i N_i w_i at local points; `None` without weights.
fn denominators<const D: usize>(block: &Block<'_, D>, element: usize, xi: &[Vector<D>]) -> Option<Vec<f64>> {
    let weights = block.weights?;
    let e = axis_elements(block, element);
    let mut ids: [Vec<usize>; D] = std::array::from_fn(|_| Vec::new());
    let mut tables: [ShapeTable<1>; D] = std::array::from_fn(|_| ShapeTable::new());
    let mut strides = [1; D];
    for k in 0..D {
        let line: Vec<Vector<1>> = xi.iter().map(|xi| Vector::<1>::new(xi[k])).collect();
        block.axes[k].active(e[k], &mut ids[k]);
        block.axes[k].tabulate(e[k], &line, Order::Values, &mut tables[k]);
        if k > 0 {
            strides[k] = strides[k - 1] * block.axes[k - 1].num_functions();
        }
    }
    let total: usize = ids.iter().map(Vec::len).product();
    let sum = |q: usize| {
        (0..total)
            .map(|mut a| {
                let (mut place, mut value) = (0, 1.0);
                for k in 0..D {
                    let i = a % ids[k].len();
                    a /= ids[k].len();
                    place += strides[k] * ids[k][i];
                    value *= tables[k].values(q)[i];
                }
                value * weights[place]
            })
            .sum()
    };
    Some((0..xi.len()).map(sum).collect())
}

/// D at local points.
pub(super) fn denominator<const D: usize, const N: usize>(
    part: &Part<'_, D, N>,
    element: usize,
    plan: &Plan<D>,
    xi: &[Vector<D>],
) -> Vec<f64> {
    let mut values = vec![1.0; xi.len()];
    let mut times = |w: Option<Vec<f64>>| values.iter_mut().zip(w.unwrap_or_default()).for_each(|(d, w)| *d *= w);
    if plan.map_weights {
        times(part.space.map_structure().map_block(element).and_then(|m| denominators(&m.basis, element, xi)));
    }
    if plan.basis_weights {
        times(part.space.structure().block(element).and_then(|b| denominators(&b, element, xi)));
    }
    values
}
