//! Contribution of an element to the file: the nodes of its cell with their positions, weights and fields.

use super::cells::{Interpolant, Shape, bernstein, cell_type};
use super::plan::{Plan, denominator, plan};
use super::{CellStyle, MAX_DEGREE, Part, VtuError, padded};
use faying::basis::{Cell, Order};
use faying::geometry::MapTable;
use faying::linalg::Vector;
use nalgebra::DMatrix;
use rayon::prelude::*;
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::sync::OnceLock;

/// Values of a node before its fields: the position and the weight.
pub(super) const AHEAD: usize = 4;

/// Position of the weight among the values of a node.
pub(super) const WEIGHT: usize = 3;

/// Contribution of an element to the file.
#[derive(Clone, Debug)]
pub(super) struct Piece<'a> {
    /// Node after node: position, weight, and the fields, those of two components padded to three.
    pub values: Vec<f64>,
    /// Values in the middle of the element, where fields are averaged; else empty.
    pub middle: Vec<f64>,
    /// Whether the weights are those of a rational cell.
    pub rational: bool,
    pub kind: u8,
    pub degrees: [f64; 3],
    /// Local nodes of every cell.
    pub cells: Cow<'a, [Vec<usize>]>,
    /// Ids of the element's corners; none where unknown.
    pub corners: Vec<usize>,
    /// Local corners around every node with its weights at them; `None` inside.
    pub around: &'a [Option<Vec<(usize, u64)>>],
}

/// Elements whose pieces are held at once.
const AT_ONCE: usize = 4096;

/// Most doublings of the lattice of linear cells.
const DOUBLED: usize = 2;

/// Most doublings of the lattice of a degree, so that it stays of a size that one element can have.
fn most_doubled<const D: usize>(degree: [usize; D]) -> usize {
    (0..DOUBLED).take_while(|n| degree.iter().all(|p| p << (n + 1) <= 2 * MAX_DEGREE)).count()
}

/// Numbers per node.
pub(super) fn width<const D: usize, const N: usize>(part: &Part<'_, D, N>) -> usize {
    AHEAD + part.fields.iter().map(|f| padded(f.components)).sum::<usize>()
}

/// Passes the pieces of all elements of a part to `take`, in their order.
pub(super) fn each_piece<const D: usize, const N: usize>(
    part: &Part<'_, D, N>,
    averaged: bool,
    mut take: impl FnMut(usize, &Piece<'_>),
) -> Result<(), VtuError> {
    let plans: Vec<Plan<D>> =
        (0..part.space.num_elements()).into_par_iter().map_init(MapTable::new, |table, e| plan(part, e, table)).collect();
    let mut known: BTreeMap<(bool, [usize; D]), [OnceLock<Interpolant<D>>; DOUBLED + 1]> = BTreeMap::new();
    for p in &plans {
        for degree in [p.degree, p.lagrange] {
            known.entry((p.cell == Cell::Simplex, degree)).or_default();
        }
    }
    let known = &known;
    let of = |cell: Cell, degree: [usize; D], doubled: usize| {
        known[&(cell == Cell::Simplex, degree)][doubled].get_or_init(|| Interpolant::new(cell, degree, 1 << doubled))
    };
    // one number for the part: neighbours keep their points in common
    let doubled = if part.style == CellStyle::Linear {
        let enough = |table: &mut MapTable<D, N>, (e, plan): (usize, &Plan<D>)| {
            let positive = |doubled: &usize| {
                let of = of(plan.cell, plan.lagrange, *doubled);
                part.space.map(e, &of.lattice, Order::Values, table);
                of.cut(&table.x, plan.left).1
            };
            // where the map itself folds over, no lattice is fine enough
            (0..=most_doubled(plan.lagrange)).find(positive).unwrap_or(0)
        };
        plans.par_iter().enumerate().map_init(MapTable::new, enough).max().unwrap_or(0)
    } else {
        0
    };
    let piece = |table: &mut MapTable<D, N>, e: usize, plan: &Plan<D>| {
        let found = match plan.shape {
            Shape::Bezier => bezier_piece(part, e, plan, of(plan.cell, plan.degree, 0), table)?,
            _ => None,
        };
        let mut piece = match found {
            Some(piece) => piece,
            None => lagrange_piece(part, e, plan, of(plan.cell, plan.lagrange, doubled.min(most_doubled(plan.lagrange))), table)?,
        };
        if averaged {
            piece.middle = sampled(part, e, &[middle(plan.cell)], table)?;
        }
        part.space.corners(e, &mut piece.corners);
        Ok::<_, VtuError>(piece)
    };
    for first in (0..plans.len()).step_by(AT_ONCE) {
        let some = &plans[first..plans.len().min(first + AT_ONCE)];
        let each = |table: &mut MapTable<D, N>, (k, plan): (usize, &Plan<D>)| piece(table, first + k, plan);
        // the error of the first element that has one, whichever thread comes first
        let pieces: Vec<Result<Piece<'_>, VtuError>> = some.par_iter().enumerate().map_init(MapTable::new, each).collect();
        for (k, piece) in pieces.into_iter().enumerate() {
            take(first + k, &piece?);
        }
    }
    Ok(())
}

/// The numbers of nodes at local points, point after point as in [`Piece::values`], with the weight one.
fn sampled<const D: usize, const N: usize>(
    part: &Part<'_, D, N>,
    element: usize,
    xi: &[Vector<D>],
    table: &mut MapTable<D, N>,
) -> Result<Vec<f64>, VtuError> {
    let width = width(part);
    let mut rows = vec![0.0; xi.len() * width];
    part.space.map(element, xi, Order::Values, table);
    for (row, x) in rows.chunks_exact_mut(width).zip(&table.x) {
        row[..N].copy_from_slice(x.as_slice());
        row[WEIGHT] = 1.0;
    }
    let checked = |values: &[f64], name: &str, components: usize| {
        let (found, expected) = (values.len(), xi.len() * components);
        let fault = || VtuError::Values { field: name.to_owned(), part: part.name.clone(), element, found, expected };
        if found == expected { Ok(()) } else { Err(fault()) }
    };
    let together = match &part.together {
        Some(together) => {
            let (values, all) = (together(element, xi), part.fields.iter().map(|f| f.components).sum());
            checked(&values, "all", all)?;
            Some((values, all))
        }
        None => None,
    };
    let (mut to, mut from) = (AHEAD, 0);
    for field in &part.fields {
        let c = field.components;
        let own;
        let (values, stride, first) = match &together {
            Some((values, all)) => (values, *all, from),
            None => {
                own = (field.sample)(element, xi);
                checked(&own, &field.name, c)?;
                (&own, c, 0)
            }
        };
        for (row, point) in rows.chunks_exact_mut(width).zip(values.chunks_exact(stride.max(1))) {
            row[to..to + c].copy_from_slice(&point[first..first + c]);
        }
        (to, from) = (to + padded(c), from + c);
    }
    Ok(rows)
}

/// The middle of a cell.
fn middle<const D: usize>(cell: Cell) -> Vector<D> {
    Vector::repeat(if cell == Cell::Simplex && D > 1 { 1.0 / (D as f64 + 1.0) } else { 0.5 })
}

/// Points between those of the interpolation.
fn check_points<const D: usize>(cell: Cell) -> [Vector<D>; 2] {
    let share = if cell == Cell::Simplex && D > 1 { 1.0 / D as f64 } else { 1.0 };
    [Vector::from_fn(|k, _| share * [0.31, 0.73, 0.58][k]), Vector::from_fn(|k, _| share * [0.87, 0.12, 0.44][k])]
}

/// Bezier cell of an element; `None` if it cannot represent map and exact fields.
fn bezier_piece<'a, const D: usize, const N: usize>(
    part: &Part<'_, D, N>,
    element: usize,
    plan: &Plan<D>,
    of: &'a Interpolant<D>,
    table: &mut MapTable<D, N>,
) -> Result<Option<Piece<'a>>, VtuError> {
    let n = of.points.len();
    let d = denominator(part, element, plan, &of.points);
    let w = &of.to_bezier * DMatrix::from_column_slice(d.len(), 1, &d);
    if w.iter().any(|w| !(w.is_finite() && *w > 0.0)) {
        return Ok(None);
    }
    let at = check_points::<D>(plan.cell);
    let shapes: Vec<Vec<f64>> = at
        .iter()
        .map(|xi| {
            let b: Vec<f64> = bernstein(plan.cell, &of.nodes, plan.degree, xi).iter().zip(w.iter()).map(|(b, w)| b * w).collect();
            let sum: f64 = b.iter().sum();
            b.iter().map(|b| b / sum).collect()
        })
        .collect();
    // the points between follow those of the interpolation
    let all: Vec<Vector<D>> = of.points.iter().chain(&at).copied().collect();
    let values = DMatrix::from_row_slice(all.len(), width(part), &sampled(part, element, &all, table)?);
    let mut c = &of.to_bezier * DMatrix::from_fn(n, values.ncols(), |q, i| d[q] * values[(q, i)]);
    (0..n).for_each(|a| c.row_mut(a).unscale_mut(w[a]));
    let holds = |columns: std::ops::Range<usize>, tolerance: f64| {
        (0..at.len()).all(|q| {
            columns.clone().all(|i| {
                let value: f64 = shapes[q].iter().enumerate().map(|(a, b)| b * c[(a, i)]).sum();
                (value - values[(n + q, i)]).abs() <= tolerance
            })
        })
    };
    let size = (0..3).map(|i| c.column(i).max() - c.column(i).min()).fold(0.0, f64::max);
    if !holds(0..3, 1e-10 * size + 1e-13 * c.columns(0, 3).amax()) {
        return Ok(None);
    }
    let mut first = AHEAD;
    for field in &part.fields {
        let count = padded(field.components);
        if field.exact && !holds(first..first + count, 1e-9 * values.view((0, first), (n, count)).amax()) {
            return Ok(None);
        }
        first += count;
    }
    c.column_mut(WEIGHT).copy_from(&w);
    Ok(Some(Piece {
        values: c.transpose().as_slice().to_vec(),
        middle: Vec::new(),
        rational: plan.map_weights || plan.basis_weights,
        kind: cell_type(D, plan.cell, Shape::Bezier),
        degrees: degrees(plan.degree, plan.left),
        cells: Cow::Borrowed(&of.whole[usize::from(plan.left)]),
        corners: Vec::new(),
        around: &of.around,
    }))
}

/// Degrees along the axes of the cell, the first two of which are exchanged if the element is left-handed.
fn degrees<const D: usize>(degree: [usize; D], left: bool) -> [f64; 3] {
    let mut all = std::array::from_fn(|k| if k < D { degree[k] as f64 } else { 0.0 });
    if left {
        all.swap(0, 1);
    }
    all
}

fn lagrange_piece<'a, const D: usize, const N: usize>(
    part: &Part<'_, D, N>,
    element: usize,
    plan: &Plan<D>,
    of: &'a Interpolant<D>,
    table: &mut MapTable<D, N>,
) -> Result<Piece<'a>, VtuError> {
    let mut values = sampled(part, element, &of.lattice, table)?;
    if values.iter().any(|v| !v.is_finite()) {
        continue_inwards(part, element, of, &mut values)?;
    }
    let linear = part.style == CellStyle::Linear;
    let cells = if linear {
        let x: Vec<Vector<N>> = values.chunks_exact(width(part)).map(|row| Vector::from_fn(|k, _| row[k])).collect();
        Cow::Owned(of.cut(&x, plan.left).0)
    } else {
        Cow::Borrowed(&of.whole[usize::from(plan.left)][..])
    };
    Ok(Piece {
        values,
        middle: Vec::new(),
        rational: false,
        kind: cell_type(D, plan.cell, if plan.shape == Shape::Bezier { Shape::Lagrange } else { plan.shape }),
        degrees: degrees(if linear { [1; D] } else { plan.lagrange }, plan.left),
        cells,
        corners: Vec::new(),
        around: &of.around,
    })
}

/// Extrapolates fields from inside that are not finite at some node (a gradient has no value where the map collapses).
fn continue_inwards<const D: usize, const N: usize>(
    part: &Part<'_, D, N>,
    element: usize,
    of: &Interpolant<D>,
    values: &mut [f64],
) -> Result<(), VtuError> {
    let width = width(part);
    let inside =
        &of.to_lattice * DMatrix::from_row_slice(of.points.len(), width, &sampled(part, element, &of.points, &mut MapTable::new())?);
    let mut first = AHEAD;
    for field in &part.fields {
        let own = first..first + padded(field.components);
        if values.chunks_exact(width).any(|row| row[own.clone()].iter().any(|v| !v.is_finite())) {
            for (q, row) in values.chunks_exact_mut(width).enumerate() {
                own.clone().for_each(|i| row[i] = inside[(q, i)]);
            }
        }
        first = own.end;
    }
    Ok(())
}
