//! What an element adds to the file: points, weights and fields of its cell.

use super::cells::{Interpolant, Shape, bernstein, cell_type, linear_pieces};
use super::plan::{Plan, denominator, plan};
use super::{CellStyle, Part, PointField, VtuError, padded};
use crate::basis::{Cell, Order};
use crate::geometry::MapTable;
use crate::linalg::Vector;
use nalgebra::DMatrix;
use rayon::prelude::*;
use std::collections::BTreeMap;

/// What an element adds to the file.
#[derive(Clone, Debug, Default)]
pub(super) struct Piece {
    pub points: Vec<[f64; 3]>,
    pub weights: Option<Vec<f64>>,
    /// Per field, padded components per point.
    pub fields: Vec<Vec<f64>>,
    pub kind: u8,
    pub degrees: [f64; 3],
    /// Local nodes of every cell.
    pub cells: Vec<Vec<usize>>,
}

/// Elements whose pieces are held at once.
const AT_ONCE: usize = 4096;

/// Hands the pieces of all elements of a part to `take`, in their order.
pub(super) fn each_piece<const D: usize, const N: usize>(
    part: &Part<'_, D, N>,
    mut take: impl FnMut(usize, &Piece),
) -> Result<(), VtuError> {
    let plans: Vec<Plan<D>> = (0..part.space.num_elements()).into_par_iter().map(|e| plan(part, e)).collect();
    let mut known: BTreeMap<(bool, [usize; D]), Interpolant<D>> = BTreeMap::new();
    for p in &plans {
        for degree in [p.degree, p.lagrange] {
            known.entry((p.cell == Cell::Simplex, degree)).or_insert_with(|| Interpolant::new(p.cell, degree));
        }
    }
    let of = |cell: Cell, degree: [usize; D]| &known[&(cell == Cell::Simplex, degree)];
    let piece = |e: usize, plan: &Plan<D>| {
        if plan.shape == Shape::Bezier
            && let Some(piece) = bezier_piece(part, e, plan, of(plan.cell, plan.degree))?
        {
            return Ok(piece);
        }
        lagrange_piece(part, e, plan, of(plan.cell, plan.lagrange))
    };
    for first in (0..plans.len()).step_by(AT_ONCE) {
        let some = &plans[first..plans.len().min(first + AT_ONCE)];
        let pieces: Vec<Piece> = some.par_iter().enumerate().map(|(k, plan)| piece(first + k, plan)).collect::<Result<_, _>>()?;
        pieces.iter().enumerate().for_each(|(k, piece)| take(first + k, piece));
    }
    Ok(())
}

/// Values of all fields, padded to three where they are two.
fn sampled<const D: usize, const N: usize>(part: &Part<'_, D, N>, element: usize, xi: &[Vector<D>]) -> Result<Vec<DMatrix<f64>>, VtuError> {
    let checked = |values: &[f64], name: &str, components: usize| {
        let (found, expected) = (values.len(), xi.len() * components);
        let fault = || VtuError::Values { field: name.to_owned(), part: part.name.clone(), element, found, expected };
        if found == expected { Ok(()) } else { Err(fault()) }
    };
    // `width` numbers per point, those of the field from `first` on
    let matrix = |values: &[f64], width: usize, first: usize, c: usize| {
        DMatrix::from_fn(xi.len(), padded(c), |q, i| if i < c { values[q * width + first + i] } else { 0.0 })
    };
    if let Some(together) = &part.together {
        let (values, width) = (together(element, xi), part.fields.iter().map(|f| f.components).sum());
        checked(&values, "all", width)?;
        let mut first = 0;
        let of = |field: &PointField<'_, D>| {
            first += field.components;
            matrix(&values, width, first - field.components, field.components)
        };
        return Ok(part.fields.iter().map(of).collect());
    }
    let own = |field: &PointField<'_, D>| {
        let values = (field.sample)(element, xi);
        checked(&values, &field.name, field.components)?;
        Ok(matrix(&values, field.components, 0, field.components))
    };
    part.fields.iter().map(own).collect()
}

fn positions<const D: usize, const N: usize>(part: &Part<'_, D, N>, element: usize, xi: &[Vector<D>]) -> DMatrix<f64> {
    let mut table = MapTable::new();
    part.space.map(element, xi, Order::Values, &mut table);
    DMatrix::from_fn(xi.len(), 3, |q, i| if i < N { table.x[q][i] } else { 0.0 })
}

fn rows(m: &DMatrix<f64>) -> Vec<f64> {
    m.row_iter().flat_map(|row| row.iter().copied().collect::<Vec<_>>()).collect()
}

fn triples(m: &DMatrix<f64>) -> Vec<[f64; 3]> {
    m.row_iter().map(|row| [row[0], row[1], row[2]]).collect()
}

/// Points between those of the interpolation.
fn check_points<const D: usize>(cell: Cell) -> [Vector<D>; 2] {
    let share = if cell == Cell::Simplex && D > 1 { 1.0 / D as f64 } else { 1.0 };
    [Vector::from_fn(|k, _| share * [0.31, 0.73, 0.58][k]), Vector::from_fn(|k, _| share * [0.87, 0.12, 0.44][k])]
}

/// The Bezier cell of an element; none where it does not hold map and exact fields.
fn bezier_piece<const D: usize, const N: usize>(
    part: &Part<'_, D, N>,
    element: usize,
    plan: &Plan<D>,
    of: &Interpolant<D>,
) -> Result<Option<Piece>, VtuError> {
    let n = of.points.len();
    let d = denominator(part, element, plan, &of.points);
    let w = &of.to_bezier * DMatrix::from_column_slice(d.len(), 1, &d);
    if w.iter().any(|w| !(w.is_finite() && *w > 0.0)) {
        return Ok(None);
    }
    let coefficients = |values: &DMatrix<f64>| {
        let numerators = DMatrix::from_fn(n, values.ncols(), |q, i| d[q] * values[(q, i)]);
        let mut c = &of.to_bezier * numerators;
        (0..c.nrows()).for_each(|a| c.row_mut(a).unscale_mut(w[a]));
        c
    };
    let at = check_points::<D>(plan.cell);
    let shapes: Vec<Vec<f64>> = at
        .iter()
        .map(|xi| {
            let b: Vec<f64> = bernstein(plan.cell, &of.nodes, plan.degree, xi).iter().zip(w.iter()).map(|(b, w)| b * w).collect();
            let sum: f64 = b.iter().sum();
            b.iter().map(|b| b / sum).collect()
        })
        .collect();
    // the points between stand behind those of the interpolation
    let all: Vec<Vector<D>> = of.points.iter().chain(&at).copied().collect();
    let holds = |c: &DMatrix<f64>, values: &DMatrix<f64>, tolerance: f64| {
        (0..at.len()).all(|q| {
            (0..c.ncols())
                .all(|i| (shapes[q].iter().enumerate().map(|(a, b)| b * c[(a, i)]).sum::<f64>() - values[(n + q, i)]).abs() <= tolerance)
        })
    };
    let positions = positions(part, element, &all);
    let x = coefficients(&positions);
    let size = (0..3).map(|i| x.column(i).max() - x.column(i).min()).fold(0.0, f64::max);
    if !holds(&x, &positions, 1e-10 * size + 1e-13 * x.amax()) {
        return Ok(None);
    }
    let mut fields = Vec::new();
    for (field, values) in part.fields.iter().zip(sampled(part, element, &all)?) {
        let c = coefficients(&values);
        if field.exact && !holds(&c, &values, 1e-9 * values.rows(0, n).amax()) {
            return Ok(None);
        }
        fields.push(rows(&c));
    }
    Ok(Some(Piece {
        points: triples(&x),
        weights: (plan.map_weights || plan.basis_weights).then(|| w.iter().copied().collect()),
        fields,
        kind: cell_type(D, plan.cell, Shape::Bezier),
        degrees: degrees(plan.degree),
        cells: vec![(0..of.nodes.len()).collect()],
    }))
}

fn degrees<const D: usize>(degree: [usize; D]) -> [f64; 3] {
    std::array::from_fn(|k| if k < D { degree[k] as f64 } else { 0.0 })
}

fn lagrange_piece<const D: usize, const N: usize>(
    part: &Part<'_, D, N>,
    element: usize,
    plan: &Plan<D>,
    of: &Interpolant<D>,
) -> Result<Piece, VtuError> {
    let mut fields = sampled(part, element, &of.lattice)?;
    if fields.iter().any(|values| values.iter().any(|v| !v.is_finite())) {
        // a gradient has no value where the map collapses; continue it from inside
        for (values, inside) in fields.iter_mut().zip(sampled(part, element, &of.points)?) {
            if values.iter().any(|v| !v.is_finite()) {
                *values = &of.to_lattice * inside;
            }
        }
    }
    let linear = part.style == CellStyle::Linear;
    Ok(Piece {
        points: triples(&positions(part, element, &of.lattice)),
        weights: None,
        fields: fields.iter().map(rows).collect(),
        kind: cell_type(D, plan.cell, if linear { Shape::Linear } else { Shape::Lagrange }),
        degrees: degrees(if linear { [1; D] } else { plan.lagrange }),
        cells: if linear { linear_pieces(plan.cell, plan.lagrange, &of.nodes) } else { vec![(0..of.nodes.len()).collect()] },
    })
}
