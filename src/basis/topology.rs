//! Cells by their corners: the vertices, edges and faces that neighbours share, and the numbers of functions on them.

use super::{Cell, simplex_lattice};
use rayon::prelude::*;

/// Cells of dimension D with corner ids; vertices, edges and faces are shared by cells that name the same corners.
///
/// Shapes may be mixed: a triangle and a quadrilateral share an edge, a tetrahedron and a hexahedron no face.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Topology<const D: usize> {
    cells: Vec<Cell>,
    /// Place of each cell's first corner, one more at the end.
    first: Vec<usize>,
    corners: Vec<usize>,
    vertices: Shared,
    edges: Shared,
    faces: Shared,
}

/// Parts of cells that neighbours share.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
struct Shared {
    count: usize,
    /// Place of each cell's first part in `of`, one more at the end.
    first: Vec<usize>,
    /// The number of every part, cell after cell.
    of: Vec<usize>,
}

impl Shared {
    fn of(&self, cell: usize) -> &[usize] {
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
fn local_edges(cell: Cell, d: usize) -> Vec<[usize; 2]> {
    match (cell, d) {
        (_, 0 | 1) => Vec::new(),
        (Cell::Simplex, 2) => vec![[0, 2], [0, 1], [1, 2]],
        (Cell::Simplex, _) => (0..=d).flat_map(|b| (0..b).map(move |a| [a, b])).collect(),
        (Cell::Tensor, 2) => vec![[0, 2], [1, 3], [0, 1], [2, 3]],
        (Cell::Tensor, _) => (0..d).flat_map(|k| (0..1usize << d).filter(move |c| c >> k & 1 == 0).map(move |c| [c, c | 1 << k])).collect(),
    }
}

/// Local corners of the faces of a solid cell: xi_k = 0 and 1 in turn; on a tetrahedron xi_k = 0, then sum xi = 1.
fn local_faces(cell: Cell, d: usize) -> Vec<Vec<usize>> {
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
    /// If the number of ids is not what the shapes ask for, or D is not 1 to 3.
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

    /// Numbers the nodes of Lagrange cells of `degree`: on vertices, edges, faces, then inside the cells; on curves along
    /// the cells. Returns their number, the place of each cell's first node (one more at the end), and the numbers in the
    /// order of the cells' lattices.
    ///
    /// Neighbours may see a common edge reversed and a common face turned or mirrored; the nodes must have the symmetries
    /// of the cells.
    pub fn number(&self, degree: usize) -> (usize, Vec<usize>, Vec<usize>) {
        let templates = [Cell::Tensor, Cell::Simplex].map(|c| places::<D>(c, degree));
        let template = |c: Cell| &templates[usize::from(c == Cell::Simplex)];
        let first = running(self.cells.iter().map(|&c| template(c).len()));
        let mut ids = Vec::with_capacity(*first.last().expect("one more at the end"));
        if D == 1 {
            let mut end = vec![usize::MAX; self.vertices.count];
            let mut next = 0;
            for cell in 0..self.cells.len() {
                for place in template(self.cells[cell]) {
                    let fresh = next;
                    let id = match place {
                        Place::Vertex(v) => {
                            let known = &mut end[self.vertices(cell)[*v]];
                            if *known == usize::MAX {
                                *known = fresh;
                            }
                            *known
                        }
                        _ => fresh,
                    };
                    next += usize::from(id == fresh);
                    ids.push(id);
                }
            }
            return (next, first, ids);
        }
        let inner = degree.saturating_sub(1);
        let (triangle, quadrilateral) = (inner * inner.saturating_sub(1) / 2, inner * inner);
        // nodes on a face depend on its shape
        let mut on_face = vec![0; self.faces.count];
        for cell in 0..self.cells.len() {
            let nodes = if self.cells[cell] == Cell::Simplex { triangle } else { quadrilateral };
            self.faces.of(cell).iter().for_each(|&f| on_face[f] = nodes);
        }
        let edge_base = self.vertices.count;
        let face_base = edge_base + self.edges.count * inner;
        let face_first = running(on_face.into_iter());
        let mut next = face_base + *face_first.last().expect("one more at the end");
        let lists = [Cell::Tensor, Cell::Simplex].map(|c| (local_edges(c, D), local_faces(c, D)));
        for cell in 0..self.cells.len() {
            let (edges, faces) = &lists[usize::from(self.cells[cell] == Cell::Simplex)];
            let v = self.vertices(cell);
            for place in template(self.cells[cell]) {
                ids.push(match *place {
                    Place::Vertex(corner) => v[corner],
                    Place::Edge { edge, step } => {
                        let [a, b] = edges[edge];
                        edge_base + self.edges.of(cell)[edge] * inner + if v[a] < v[b] { step } else { degree - step } - 1
                    }
                    Place::Triangle { face, shares } => {
                        let corner = [0, 1, 2].map(|k| v[faces[face][k]]);
                        face_base + face_first[self.faces.of(cell)[face]] + on_triangle(degree, corner, shares)
                    }
                    Place::Quadrilateral { face, at } => {
                        let corner = [0, 1, 2, 3].map(|k| v[faces[face][k]]);
                        face_base + face_first[self.faces.of(cell)[face]] + on_quadrilateral(degree, corner, at)
                    }
                    Place::Inside => {
                        next += 1;
                        next - 1
                    }
                });
            }
        }
        (next, first, ids)
    }
}

/// Sums of `counts` up to each entry, one more at the end.
fn running(counts: impl Iterator<Item = usize>) -> Vec<usize> {
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
    let keys: Vec<[usize; 4]> = (0..cells.len())
        .into_par_iter()
        .flat_map_iter(|e| list(cells[e]).iter().map(move |part| key_of(part.iter().map(|&c| vertices.of(e)[c]))))
        .collect();
    let (count, of) = numbered(&keys);
    Shared { count, first, of }
}

/// Where a node lies in its cell.
#[derive(Clone, Copy, Debug)]
enum Place {
    Vertex(usize),
    /// `step` nodes from the edge's first corner.
    Edge {
        edge: usize,
        step: usize,
    },
    /// Shares of the face's corners.
    Triangle {
        face: usize,
        shares: [usize; 3],
    },
    /// Index along the face's axes.
    Quadrilateral {
        face: usize,
        at: [usize; 2],
    },
    Inside,
}

/// The multi-indices of a cell's nodes, first axis fastest.
pub(crate) fn lattice<const D: usize>(cell: Cell, degree: usize) -> Vec<[usize; D]> {
    match cell {
        Cell::Simplex => simplex_lattice::<D>(degree),
        Cell::Tensor => (0..(degree + 1).pow(D as u32))
            .map(|mut a| {
                std::array::from_fn(|_| {
                    let i = a % (degree + 1);
                    a /= degree + 1;
                    i
                })
            })
            .collect(),
    }
}

/// Where the nodes of a cell of degree 1 or more lie.
fn places<const D: usize>(cell: Cell, degree: usize) -> Vec<Place> {
    let (edges, faces) = (local_edges(cell, D), local_faces(cell, D));
    let edge_of = |a: usize, b: usize| edges.iter().position(|e| *e == [a.min(b), a.max(b)]).expect("two corners of an edge");
    let place = |index: [usize; D]| match cell {
        Cell::Simplex => {
            let share = |c: usize| if c == 0 { degree - index.iter().sum::<usize>() } else { index[c - 1] };
            let on: Vec<usize> = (0..=D).filter(|&c| share(c) > 0).collect();
            match on[..] {
                [corner] => Place::Vertex(corner),
                [a, b] if D > 1 => Place::Edge { edge: edge_of(a, b), step: share(b) },
                [a, b, c] if D > 2 => {
                    let face = faces.iter().position(|f| *f == on).expect("three corners of a face");
                    Place::Triangle { face, shares: [share(a), share(b), share(c)] }
                }
                _ => Place::Inside,
            }
        }
        Cell::Tensor => {
            let corner = (0..D).filter(|&k| index[k] == degree).map(|k| 1 << k).sum::<usize>();
            let free: Vec<usize> = (0..D).filter(|&k| index[k] > 0 && index[k] < degree).collect();
            match free[..] {
                [] => Place::Vertex(corner),
                [k] if D > 1 => Place::Edge { edge: edge_of(corner, corner | 1 << k), step: index[k] },
                [k, l] if D > 2 => {
                    let fixed = (0..D).find(|m| *m != k && *m != l).expect("three axes");
                    Place::Quadrilateral { face: 2 * fixed + (corner >> fixed & 1), at: [index[k], index[l]] }
                }
                _ => Place::Inside,
            }
        }
    };
    lattice::<D>(cell, degree).into_iter().map(place).collect()
}

/// The number of an inner node of a triangle from the shares of its corners, the same for every order of the corners.
fn on_triangle(degree: usize, corners: [usize; 3], shares: [usize; 3]) -> usize {
    let mut sorted = [0, 1, 2].map(|k| (corners[k], shares[k]));
    sorted.sort_unstable();
    let (a, b, most) = (sorted[1].1 - 1, sorted[2].1 - 1, degree - 3);
    // rows of most + 1, most, .. nodes
    b * (2 * most + 3 - b) / 2 + a
}

/// The number of an inner node of a quadrilateral, counted from its least corner towards the lesser of the next two.
fn on_quadrilateral(degree: usize, corners: [usize; 4], at: [usize; 2]) -> usize {
    let origin = (0..4).min_by_key(|&c| corners[c]).expect("four corners");
    let from = |k: usize| if origin >> k & 1 == 1 { degree - at[k] } else { at[k] };
    let (mut i, mut j) = (from(0), from(1));
    if corners[origin ^ 1] > corners[origin ^ 2] {
        std::mem::swap(&mut i, &mut j);
    }
    (i - 1) + (j - 1) * (degree - 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nodes_of_a_triangle_and_a_quadrilateral_are_numbered_once_from_any_side() {
        for degree in 3..7 {
            for corners in [[5, 7, 9], [9, 5, 7], [7, 5, 9]] {
                let inner = (1..degree).flat_map(|a| (1..degree).map(move |b| (a, b))).filter(|(a, b)| a + b < degree);
                let mut seen: Vec<usize> = inner.map(|(a, b)| on_triangle(degree, corners, [a, b, degree - a - b])).collect();
                seen.sort_unstable();
                assert_eq!(seen, (0..(degree - 1) * (degree - 2) / 2).collect::<Vec<_>>());
            }
            let inner = (1..degree).flat_map(|a| (1..degree).map(move |b| [a, b]));
            let mut seen: Vec<usize> = inner.map(|at| on_quadrilateral(degree, [4, 1, 3, 2], at)).collect();
            seen.sort_unstable();
            assert_eq!(seen, (0..(degree - 1) * (degree - 1)).collect::<Vec<_>>());
        }
    }

    #[test]
    fn a_triangle_and_a_quadrilateral_share_the_nodes_of_their_edge() {
        // corners 0 1 / 2 3 and the triangle 3 1 4
        let topology = Topology::<2>::new(vec![Cell::Tensor, Cell::Simplex], vec![0, 1, 2, 3, 3, 1, 4]);
        assert_eq!((topology.num_vertices(), topology.num_facets()), (5, 6));
        let (functions, first, ids) = topology.number(3);
        assert_eq!(functions, 5 + 6 * 2 + 4 + 1);
        let (quadrilateral, triangle) = ids.split_at(first[1]);
        // the edge xi_0 = 1 upwards, the edge of the triangle's first axis backwards
        let right: Vec<usize> = (0..4).map(|j| quadrilateral[4 * j + 3]).collect();
        let left: Vec<usize> = (0..4).map(|i| triangle[3 - i]).collect();
        assert_eq!(right, left);
    }
}
