//! Numbering of the nodes of cells, shared on vertices, edges and faces for any orientation of the cells.

use super::topology::{local_edges, local_faces, running};
use super::{Cell, Topology, simplex_lattice};

impl<const D: usize> Topology<D> {
    /// Numbers the nodes of Lagrange cells of `degree`: on vertices, edges, faces, then inside the cells; on curves along
    /// the cells. Returns their number, the place of each cell's first node (one more at the end), and the numbers in the
    /// order of the cells' lattices.
    ///
    /// A common edge may be reversed in a neighbour, a common face rotated or mirrored; the nodes must have the symmetries
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

/// Position of a node in its cell.
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

/// Positions of the nodes of a cell of degree 1 or more, in the order of [`lattice`].
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
