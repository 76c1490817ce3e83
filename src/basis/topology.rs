//! Cells by their corners: the vertices, edges and faces that neighbours share.

use super::Cell;
use crate::parallel;
use rayon::prelude::*;

/// Cells handed to one task at a time.
const CELLS_PER_TASK: usize = 1 << 12;

/// Cells of dimension D with corner ids; vertices, edges and faces are shared by cells that name the same corners.
///
/// Shapes may be mixed: a triangle and a quadrilateral share an edge, a tetrahedron and a hexahedron no face.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Topology<const D: usize> {
    pub(super) cells: Vec<Cell>,
    /// Place of each cell's first corner, one more at the end.
    first: Vec<usize>,
    corners: Vec<usize>,
    pub(super) vertices: Shared,
    pub(super) edges: Shared,
    pub(super) faces: Shared,
}

/// Parts of cells that neighbours share.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Shared {
    pub(super) count: usize,
    /// Place of each cell's first part in `of`, one more at the end.
    first: Vec<usize>,
    /// The number of every part, cell after cell.
    of: Vec<usize>,
}

impl Shared {
    pub(super) fn of(&self, cell: usize) -> &[usize] {
        &self.of[self.first[cell]..self.first[cell + 1]]
    }
}

/// Number of corners of a cell of dimension `d`.
pub(super) fn corner_count(cell: Cell, d: usize) -> usize {
    match cell {
        Cell::Tensor => 1 << d,
        Cell::Simplex => d + 1,
    }
}

/// Local corners of the edges of a cell; in the plane in the order of the cell's faces.
pub(crate) fn local_edges(cell: Cell, d: usize) -> Vec<[usize; 2]> {
    match (cell, d) {
        (_, 0 | 1) => Vec::new(),
        (Cell::Simplex, 2) => vec![[0, 2], [0, 1], [1, 2]],
        (Cell::Simplex, _) => (0..=d).flat_map(|b| (0..b).map(move |a| [a, b])).collect(),
        (Cell::Tensor, 2) => vec![[0, 2], [1, 3], [0, 1], [2, 3]],
        (Cell::Tensor, _) => (0..d).flat_map(|k| (0..1usize << d).filter(move |c| c >> k & 1 == 0).map(move |c| [c, c | 1 << k])).collect(),
    }
}

/// Local corners of the faces of a solid cell: xi_k = 0 and 1 in turn; on a tetrahedron xi_k = 0, then sum xi = 1.
pub(super) fn local_faces(cell: Cell, d: usize) -> Vec<Vec<usize>> {
    match (cell, d) {
        (Cell::Tensor, 3) => (0..6).map(|f| (0..8).filter(|c| c >> (f / 2) & 1 == f % 2).collect()).collect(),
        (Cell::Simplex, 3) => (0..4).map(|f| (0..4).filter(|&c| c != (f + 1) % 4).collect()).collect(),
        _ => Vec::new(),
    }
}

/// Equal keys get one number; numbers rise in the order of first appearance. n log n.
fn numbered<K: Ord + Copy + Send + Sync>(keys: &[K]) -> (usize, Vec<usize>) {
    let mut order: Vec<(K, usize)> = keys.iter().copied().zip(0..).collect();
    order.par_sort_unstable();
    let mut first = vec![0; keys.len()];
    let mut start = 0;
    for k in 0..order.len() {
        if order[k].0 != order[start].0 {
            start = k;
        }
        first[order[k].1] = order[start].1;
    }
    let mut count = 0;
    for k in 0..first.len() {
        // the first of its kind comes before all others
        first[k] = if first[k] == k {
            count += 1;
            count - 1
        } else {
            first[first[k]]
        };
    }
    (count, first)
}

/// A key of up to four ids in any order.
pub(crate) fn key_of(ids: impl Iterator<Item = usize>) -> [usize; 4] {
    let mut key = [usize::MAX; 4];
    key.iter_mut().zip(ids).for_each(|(k, id)| *k = id);
    key.sort_unstable();
    key
}

impl<const D: usize> Topology<D> {
    /// Cells with the ids of their corners, cell after cell, first axis fastest. n log n.
    ///
    /// # Panics
    /// If the number of ids does not match the shapes, or D is not 1 to 3.
    pub fn new(cells: Vec<Cell>, corners: Vec<usize>) -> Self {
        const { assert!(D >= 1 && D <= 3, "cells of dimension 1 to 3") }
        let first = running(cells.iter().map(|&c| corner_count(c, D)));
        assert_eq!(first.last(), Some(&corners.len()), "one id per corner of every cell");
        let (count, of) = numbered(&corners);
        let vertices = Shared { count, first: first.clone(), of };
        let edge_lists = [Cell::Tensor, Cell::Simplex].map(|c| local_edges(c, D));
        let edges = shared(&cells, &vertices, |c| edge_lists[usize::from(c == Cell::Simplex)].iter().map(|e| e.to_vec()).collect());
        let faces = shared(&cells, &vertices, |c| local_faces(c, D));
        Self { cells, first, corners, vertices, edges, faces }
    }

    /// Number of cells.
    pub fn num_cells(&self) -> usize {
        self.cells.len()
    }

    /// Shape of a cell.
    pub fn cell(&self, cell: usize) -> Cell {
        self.cells[cell]
    }

    /// Corner ids of a cell, as given.
    pub fn corners(&self, cell: usize) -> &[usize] {
        &self.corners[self.first[cell]..self.first[cell + 1]]
    }

    /// Number of vertices.
    pub fn num_vertices(&self) -> usize {
        self.vertices.count
    }

    /// The corners of a cell, numbered from zero in the order of first appearance.
    pub fn vertices(&self, cell: usize) -> &[usize] {
        self.vertices.of(cell)
    }

    /// Number of facets: faces in space, edges in the plane, vertices of a curve.
    pub fn num_facets(&self) -> usize {
        self.facets_shared().count
    }

    /// The facets of a cell: those of its faces xi_k = 0, xi_k = 1 in turn; on a simplex xi_k = 0, then sum xi = 1. On a curve the ends.
    pub fn facets(&self, cell: usize) -> &[usize] {
        self.facets_shared().of(cell)
    }

    fn facets_shared(&self) -> &Shared {
        match D {
            1 => &self.vertices,
            2 => &self.edges,
            _ => &self.faces,
        }
    }
}

/// Sums of `counts` up to each entry, one more at the end.
pub(super) fn running(counts: impl Iterator<Item = usize>) -> Vec<usize> {
    let mut sums = vec![0];
    let mut sum = 0;
    sums.extend(counts.map(|n| {
        sum += n;
        sum
    }));
    sums
}

/// Parts of cells with equal sets of vertices are one.
fn shared(cells: &[Cell], vertices: &Shared, parts: impl Fn(Cell) -> Vec<Vec<usize>>) -> Shared {
    let lists = [Cell::Tensor, Cell::Simplex].map(parts);
    let list = |c: Cell| &lists[usize::from(c == Cell::Simplex)];
    let first = running(cells.iter().map(|&c| list(c).len()));
    let keys: Vec<[usize; 4]> = parallel::map_ranges(cells.len(), CELLS_PER_TASK, |cells_of_task| {
        let keys = cells_of_task.flat_map(|e| list(cells[e]).iter().map(move |part| key_of(part.iter().map(|&c| vertices.of(e)[c]))));
        keys.collect::<Vec<_>>()
    })
    .concat();
    let (count, of) = numbered(&keys);
    Shared { count, first, of }
}
