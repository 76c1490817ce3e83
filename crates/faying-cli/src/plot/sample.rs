//! Sampling of elements for a picture: coloured pieces and curved edges.

use super::{FieldPlot, PlotError, lacks, number};
use faying::basis::{Cell, Elements, Order};
use faying::geometry::{Bounds, Geometry, MapTable, Sampler, cell};
use faying::linalg::Vector;
use faying::space::Space;
use faying_files::vtu::Part;
use rayon::prelude::*;
use std::collections::BTreeMap;

/// Coloured pieces and edges of one element.
pub(super) struct Drawn {
    /// Corners and value of every piece, row by row.
    pub pieces: Vec<(Vec<[f64; 2]>, f64)>,
    /// Pieces of a row of quadrilaterals; 1 elsewhere.
    pub row: usize,
    /// Points along every edge, with whether it is an outer one.
    pub edges: Vec<(Vec<[f64; 2]>, bool)>,
}

/// Most pieces of a picture; small elements are coloured whole.
const PIECES: f64 = 5000.0;
/// Size of a piece in pixels, where that makes not too many.
const PIECE: f64 = 8.0;
/// Most pieces per direction of an element.
const FINEST: f64 = 24.0;

/// Pieces per direction of an element of this size in a picture `pixels` wide that shows the length `shown`.
pub(super) fn division(bounds: &Bounds<2>, shown: f64, pixels: f64) -> f64 {
    (bounds.diagonal() / shown * pixels / PIECE).clamp(1.0, FINEST)
}

/// Points per direction between which an element is assumed straight.
const LOOKS: usize = 5;

/// Approximate bounding boxes of all elements: around some of their points. Bulges between these are small in a picture, and
/// guaranteed bounds would take second derivatives.
pub(super) fn boxes(part: &Part<'_, 2, 2>, factor: f64) -> Vec<Bounds<2>> {
    let space = &*part.space;
    let grids = [Cell::Tensor, Cell::Simplex].map(|kind| [2, LOOKS].map(|n| cell::grid::<2, f64>(kind, n)));
    let maps = || (Sampler::new(space, Order::Values), MapTable::<2, 2>::new());
    (0..space.num_elements())
        .into_par_iter()
        .map_init(maps, |(map, table), e| {
            let (kind, bent) = (usize::from(space.cell(e) == Cell::Simplex), usize::from(!space.map_structure().is_affine(e)));
            map.map(e, 2 * bent + kind, &grids[kind][bent], table);
            moved(part, factor, e, &grids[kind][bent], &mut table.x);
            Bounds::around(&table.x).unwrap_or(Bounds { lo: Vector::zeros(), hi: Vector::zeros() })
        })
        .collect()
}

/// Moves the points of an element by their displacements times a factor, where the part has any.
pub(super) fn moved<const N: usize>(part: &Part<'_, N, N>, factor: f64, element: usize, xi: &[Vector<N>], points: &mut [Vector<N>]) {
    let Some(field) = part.fields.iter().find(|f| f.name == "displacement" && f.components == N).filter(|_| factor != 0.0) else { return };
    let by = (field.sample)(element, xi);
    for (point, u) in points.iter_mut().zip(by.chunks(N)) {
        *point += Vector::<N>::from_column_slice(u) * factor;
    }
}

/// Pieces per direction of every element of every part, whose boxes are `boxes`: by size, within [`PIECES`] in total.
pub(super) fn divisions(boxes: &[Vec<Bounds<2>>]) -> Vec<Vec<Option<usize>>> {
    let size = boxes.iter().flatten().copied().reduce(|a, b| a.union(&b)).map_or(1.0, |b| b.diagonal());
    let total: f64 = boxes.iter().flatten().map(|b| division(b, size, 900.0).powi(2)).sum();
    let scale = (PIECES / total).sqrt().min(1.0);
    boxes.iter().map(|part| part.iter().map(|b| Some(division(b, size, 900.0 * scale).round() as usize)).collect()).collect()
}

/// The elements of a part that have a number of pieces.
pub(super) fn sampled(plot: &FieldPlot<'_>, part: &Part<'_, 2, 2>, divisions: &[Option<usize>]) -> Result<Vec<Drawn>, PlotError> {
    let field = part.fields.iter().find(|f| f.name == plot.field && plot.component.unwrap_or(0) < f.components);
    let field = field.ok_or_else(|| lacks(plot, &part.name))?;
    let outer = edge_kinds(&*part.space);
    let element = |table: &mut MapTable<2, 2>, e: usize, m: usize| {
        let curved = if m == 1 { 2 } else { m.max(8) };
        let simplex = part.space.cell(e) == Cell::Simplex;
        let (cells, middles) = pieces(simplex, m);
        let values = (field.sample)(e, &middles);
        let value = |k: usize| number(plot, field.components, &values, k);
        let mut at = |xi: &[Vector<2>]| -> Vec<[f64; 2]> {
            part.space.map(e, xi, Order::Values, table);
            moved(part, plot.moved, e, xi, &mut table.x);
            table.x.iter().map(|x| [x[0], x[1]]).collect()
        };
        let corners = at(&cells.concat());
        let mut from = 0;
        let pieces = cells
            .iter()
            .enumerate()
            .map(|(k, c)| {
                from += c.len();
                (corners[from - c.len()..from].to_vec(), value(k))
            })
            .collect();
        let edges = element_edges(simplex)
            .iter()
            .enumerate()
            .filter_map(|(k, [a, b])| {
                let kind = outer.get(&(e, k)).copied().unwrap_or(Edge::Inner);
                if kind == Edge::Repeated {
                    return None;
                }
                let along = |i: usize| Vector::<2>::from(*a).lerp(&Vector::<2>::from(*b), i as f64 / curved as f64);
                Some((at(&(0..=curved).map(along).collect::<Vec<_>>()), kind == Edge::Outer))
            })
            .collect();
        Drawn { pieces, row: if simplex { 1 } else { m }, edges }
    };
    let each = |table: &mut MapTable<2, 2>, (e, m): (usize, &Option<usize>)| m.map(|m| element(table, e, m));
    let drawn: Vec<Option<Drawn>> = divisions.par_iter().enumerate().map_init(MapTable::new, each).collect();
    Ok(drawn.into_iter().flatten().collect())
}

/// Edges of the cell as local end points.
fn element_edges(simplex: bool) -> &'static [[[f64; 2]; 2]] {
    if simplex {
        &[[[0.0, 0.0], [1.0, 0.0]], [[1.0, 0.0], [0.0, 1.0]], [[0.0, 1.0], [0.0, 0.0]]]
    } else {
        &[[[0.0, 0.0], [1.0, 0.0]], [[1.0, 0.0], [1.0, 1.0]], [[1.0, 1.0], [0.0, 1.0]], [[0.0, 1.0], [0.0, 0.0]]]
    }
}

/// Role of an element edge in the picture.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Edge {
    /// Edge of one element only.
    Outer,
    /// Drawn for this element.
    Inner,
    /// Drawn for an element before.
    Repeated,
}

/// Role of edge k of element e by (e, k); edges of elements without corner ids are left out.
fn edge_kinds(space: &dyn Space<2, 2>) -> BTreeMap<(usize, usize), Edge> {
    let mut owners: BTreeMap<[usize; 2], Vec<(usize, usize)>> = BTreeMap::new();
    let mut ids = Vec::new();
    for e in 0..space.num_elements() {
        space.corners(e, &mut ids);
        let ends: &[[usize; 2]] = match (space.cell(e), ids.len()) {
            (Cell::Simplex, 3) => &[[0, 1], [1, 2], [2, 0]],
            (Cell::Tensor, 4) => &[[0, 1], [1, 3], [3, 2], [2, 0]],
            _ => &[],
        };
        for (k, [a, b]) in ends.iter().enumerate() {
            let key = [ids[*a].min(ids[*b]), ids[*a].max(ids[*b])];
            owners.entry(key).or_default().push((e, k));
        }
    }
    let kind = |k: usize, of: usize| match (k, of) {
        (_, 1) => Edge::Outer,
        (0, _) => Edge::Inner,
        _ => Edge::Repeated,
    };
    owners.values().flat_map(|who| who.iter().enumerate().map(move |(k, at)| (*at, kind(k, who.len())))).collect()
}

/// Local corners of the pieces of a cell and a point inside each.
///
/// Each piece reaches a little over its neighbours: later ones paint over it, and no seam shows between them.
fn pieces(simplex: bool, m: usize) -> (Vec<Vec<Vector<2>>>, Vec<Vector<2>>) {
    let at = |i: usize, j: usize| Vector::<2>::new(i as f64 / m as f64, j as f64 / m as f64);
    let mut cells: Vec<Vec<Vector<2>>> = Vec::new();
    for j in 0..m {
        for i in 0..m {
            if !simplex {
                cells.push(vec![at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]);
            } else if i + j < m {
                cells.push(vec![at(i, j), at(i + 1, j), at(i, j + 1)]);
                if i + j + 1 < m {
                    cells.push(vec![at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]);
                }
            }
        }
    }
    let middles: Vec<Vector<2>> = cells.iter().map(|c| c.iter().sum::<Vector<2>>() / c.len() as f64).collect();
    let grown = |p: &Vector<2>, middle: &Vector<2>| {
        let mut p = (middle + (p - middle) * 1.3).map(|t| t.clamp(0.0, 1.0));
        if simplex && p.sum() > 1.0 {
            p /= p.sum();
        }
        p
    };
    let cells = cells.iter().zip(&middles).map(|(c, middle)| c.iter().map(|p| grown(p, middle)).collect()).collect();
    (cells, middles)
}
