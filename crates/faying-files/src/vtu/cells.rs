//! Cell types, node orders and interpolation operators of high-order VTK cells.
//!
//! Lagrange and Bezier cells share one node order. A node is a multi-index a with xi_k = a_k / p_k on equispaced
//! Lagrange cells, and the index of a Bernstein polynomial on Bezier cells. On simplices the indices sum to at most p.
//! Source: VTK 9.7 (vtkHigherOrderQuadrilateral, vtkHigherOrderTetra and relatives), each order tested against VTK.

use faying::basis::Cell;
use faying::linalg::{Matrix, Vector, determinant};
use nalgebra::DMatrix;
use std::collections::BTreeMap;

/// Largest degree VTK evaluates (vtkHigherOrderInterpolation::MaxDegree).
pub const MAX_DEGREE: usize = 10;

/// Shape functions of a cell in the file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Shape {
    Linear,
    Quadratic,
    Lagrange,
    Bezier,
}

/// VTK's number of the cell type.
pub(crate) fn cell_type(dimension: usize, cell: Cell, shape: Shape) -> u8 {
    let simplex = cell == Cell::Simplex;
    let (linear, quadratic, lagrange) = match (dimension, simplex) {
        (1, _) => (3, 21, 68),
        (2, true) => (5, 22, 69),
        (2, false) => (9, 28, 70),
        (_, true) => (10, 24, 71),
        (_, false) => (12, 29, 72),
    };
    match shape {
        Shape::Linear => linear,
        Shape::Quadratic => quadratic,
        Shape::Lagrange => lagrange,
        Shape::Bezier => lagrange + 7,
    }
}

/// Multi-indices of the nodes in VTK's order.
pub(crate) fn nodes<const D: usize>(cell: Cell, degree: [usize; D]) -> Vec<[usize; D]> {
    let list: Vec<[usize; 3]> = match (D, cell) {
        (1, _) => curve(degree[0]),
        (2, Cell::Simplex) => triangle(degree[0]).iter().map(|&[i, j]| [i, j, 0]).collect(),
        (_, Cell::Simplex) => tetrahedron(degree[0]),
        (2, _) => quadrilateral(degree[0], degree[1]).iter().map(|&[i, j]| [i, j, 0]).collect(),
        (_, _) => hexahedron(degree[0], degree[1], degree[2]),
    };
    list.iter().map(|a| std::array::from_fn(|k| a[k])).collect()
}

fn curve(p: usize) -> Vec<[usize; 3]> {
    [0, p].into_iter().chain(1..p).map(|i| [i, 0, 0]).collect()
}

/// Edges (i,0), (p,j), (i,q), (0,j), each with rising index.
fn quadrilateral_edges(p: usize, q: usize) -> impl Iterator<Item = [usize; 2]> {
    let along_u = move |j: usize| (1..p).map(move |i| [i, j]);
    let along_v = move |i: usize| (1..q).map(move |j| [i, j]);
    along_u(0).chain(along_v(p)).chain(along_u(q)).chain(along_v(0))
}

fn quadrilateral(p: usize, q: usize) -> Vec<[usize; 2]> {
    let mut list = vec![[0, 0], [p, 0], [p, q], [0, q]];
    list.extend(quadrilateral_edges(p, q));
    list.extend((1..q).flat_map(|j| (1..p).map(move |i| [i, j])));
    list
}

fn hexahedron(p: usize, q: usize, r: usize) -> Vec<[usize; 3]> {
    let corners = [[0, 0], [p, 0], [p, q], [0, q]];
    let mut list: Vec<[usize; 3]> = Vec::new();
    for k in [0, r] {
        list.extend(corners.iter().map(|c| [c[0], c[1], k]));
    }
    for k in [0, r] {
        list.extend(quadrilateral_edges(p, q).map(|c| [c[0], c[1], k]));
    }
    for c in corners {
        list.extend((1..r).map(|k| [c[0], c[1], k]));
    }
    for i in [0, p] {
        list.extend((1..r).flat_map(|k| (1..q).map(move |j| [i, j, k])));
    }
    for j in [0, q] {
        list.extend((1..r).flat_map(|k| (1..p).map(move |i| [i, j, k])));
    }
    for k in [0, r] {
        list.extend((1..q).flat_map(|j| (1..p).map(move |i| [i, j, k])));
    }
    list.extend((1..r).flat_map(|k| (1..q).flat_map(move |j| (1..p).map(move |i| [i, j, k]))));
    list
}

/// Corners, edges 01, 12, 20, then the same rule at degree p - 3.
fn triangle(p: usize) -> Vec<[usize; 2]> {
    if p == 0 {
        return vec![[0, 0]];
    }
    let mut list = vec![[0, 0], [p, 0], [0, p]];
    list.extend((1..p).map(|i| [i, 0]));
    list.extend((1..p).map(|i| [p - i, i]));
    list.extend((1..p).map(|i| [0, p - i]));
    if p >= 3 {
        list.extend(triangle(p - 3).iter().map(|&[i, j]| [i + 1, j + 1]));
    }
    list
}

fn tetrahedron(p: usize) -> Vec<[usize; 3]> {
    if p == 0 {
        return vec![[0, 0, 0]];
    }
    // barycentric multiplicities of vertices 0..4; the multi-index drops vertex 0
    let place = |on: &[(usize, usize)]| {
        let mut b = [0; 4];
        on.iter().for_each(|&(vertex, n)| b[vertex] += n);
        [b[1], b[2], b[3]]
    };
    let mut list: Vec<[usize; 3]> = (0..4).map(|v| place(&[(v, p)])).collect();
    for (a, b) in [(0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)] {
        list.extend((1..p).map(|i| place(&[(a, p - i), (b, i)])));
    }
    if p >= 3 {
        for (a, b, c) in [(0, 1, 3), (2, 3, 1), (0, 3, 2), (0, 2, 1)] {
            list.extend(triangle(p - 3).iter().map(|&[i, j]| place(&[(a, p - 2 - i - j), (b, i + 1), (c, j + 1)])));
        }
    }
    if p >= 4 {
        list.extend(tetrahedron(p - 4).iter().map(|&[i, j, k]| [i + 1, j + 1, k + 1]));
    }
    list
}

/// Corner nodes of linear cells, as places in the list of [`nodes`].
pub(crate) type Pieces = Vec<Vec<usize>>;

/// Bodies that fill one cell of the given degree between its nodes, each with the ways to cut it into linear cells.
///
/// Simplices: every edge is parallel to an edge of the cell, so that neighbours cut a common side alike. What this leaves between
/// the tetrahedra are octahedra; any of their three diagonals cuts them.
pub(crate) fn linear_pieces<const D: usize>(cell: Cell, degree: [usize; D], nodes: &[[usize; D]]) -> Vec<Vec<Pieces>> {
    const OCTAHEDRON: [([usize; 3], [usize; 3], [[usize; 3]; 4]); 3] = [
        ([0, 1, 0], [1, 0, 1], [[1, 1, 0], [0, 1, 1], [0, 0, 1], [1, 0, 0]]),
        ([1, 0, 0], [0, 1, 1], [[0, 0, 1], [1, 0, 1], [1, 1, 0], [0, 1, 0]]),
        ([0, 0, 1], [1, 1, 0], [[0, 1, 0], [0, 1, 1], [1, 0, 1], [1, 0, 0]]),
    ];
    let place: BTreeMap<[usize; D], usize> = nodes.iter().copied().zip(0..).collect();
    let mut bodies = Vec::new();
    for a in boxes(degree) {
        let moved = |by: &[usize]| place[&std::array::from_fn(|k| a[k] + by[k])];
        let mut one = |corners: &[&[usize]]| bodies.push(vec![vec![corners.iter().map(|by| moved(by)).collect()]]);
        let room = degree[0].saturating_sub(a.iter().sum::<usize>());
        match (D, cell == Cell::Simplex && D > 1) {
            (1, _) => one(&[&[0], &[1]]),
            (2, false) => one(&[&[0, 0], &[1, 0], &[1, 1], &[0, 1]]),
            (_, false) => one(&[&[0, 0, 0], &[1, 0, 0], &[1, 1, 0], &[0, 1, 0], &[0, 0, 1], &[1, 0, 1], &[1, 1, 1], &[0, 1, 1]]),
            (2, true) => {
                if room >= 1 {
                    one(&[&[0, 0], &[1, 0], &[0, 1]]);
                }
                if room >= 2 {
                    one(&[&[1, 0], &[1, 1], &[0, 1]]);
                }
            }
            (_, true) => {
                if room >= 1 {
                    one(&[&[0, 0, 0], &[1, 0, 0], &[0, 1, 0], &[0, 0, 1]]);
                }
                if room >= 3 {
                    one(&[&[1, 1, 1], &[1, 0, 1], &[0, 1, 1], &[1, 1, 0]]);
                }
                if room >= 2 {
                    let around = |(from, to, ring): &([usize; 3], [usize; 3], [[usize; 3]; 4])| {
                        (0..4).map(|k| [from, to, &ring[k], &ring[(k + 1) % 4]].map(|by| moved(by)).to_vec()).collect()
                    };
                    bodies.push(OCTAHEDRON.iter().map(around).collect());
                }
            }
        }
    }
    bodies
}

/// The least determinant of the edges at a corner of a linear cell, and the sum of those of all its corners.
///
/// The sum has the sign of the volume; the least is its own multiple on simplices.
fn determinants<const D: usize, const N: usize>(x: &[Vector<N>], piece: &[usize]) -> [f64; 2] {
    // a corner and the ends of its edges, right-handed
    let corners: &[&[usize]] = match (D, piece.len()) {
        (2, 3) => &[&[0, 1, 2]],
        (2, _) => &[&[0, 1, 3], &[1, 2, 0], &[2, 3, 1], &[3, 0, 2]],
        (_, 4) => &[&[0, 1, 2, 3]],
        _ => &[&[0, 1, 3, 4], &[1, 2, 0, 5], &[2, 3, 1, 6], &[3, 0, 2, 7], &[4, 7, 5, 0], &[5, 4, 6, 1], &[6, 5, 7, 2], &[7, 6, 4, 3]],
    };
    let at = |c: &&[usize]| determinant(&Matrix::<D, D>::from_fn(|i, k| x[piece[c[k + 1]]][i] - x[piece[c[0]]][i]));
    corners.iter().map(at).fold([f64::INFINITY, 0.0], |[least, sum], d| [least.min(d), sum + d])
}

/// Returns the linear cell with the opposite handedness.
fn mirrored<const D: usize>(piece: &[usize]) -> Vec<usize> {
    let order: &[usize] = match (D, piece.len()) {
        (2, 3) => &[0, 2, 1],
        (2, _) => &[0, 3, 2, 1],
        (3, 4) => &[0, 2, 1, 3],
        (3, _) => &[0, 3, 2, 1, 4, 7, 6, 5],
        _ => &[0, 1],
    };
    order.iter().map(|&k| piece[k]).collect()
}

/// Indices into `nodes` of the cell with its first two axes exchanged, in VTK's order: the cell of opposite handedness.
fn exchanged<const D: usize>(cell: Cell, degree: [usize; D], nodes: &[[usize; D]]) -> Vec<usize> {
    let swapped = |mut a: [usize; D]| {
        if D > 1 {
            a.swap(0, 1);
        }
        a
    };
    let place: BTreeMap<[usize; D], usize> = nodes.iter().copied().zip(0..).collect();
    self::nodes(cell, swapped(degree)).into_iter().map(|a| place[&swapped(a)]).collect()
}

/// Local corners (first axis fastest) around a node with its integer weights at them, without common factors: equal for all
/// cells that share the vertex, edge or face. `None` inside the cell.
fn around<const D: usize>(cell: Cell, degree: [usize; D], node: [usize; D]) -> Option<Vec<(usize, u64)>> {
    let weights: Vec<usize> = if cell == Cell::Simplex && D > 1 {
        std::iter::once(degree[0] - node.iter().sum::<usize>()).chain(node).collect()
    } else {
        (0..1usize << D).map(|c| (0..D).map(|k| if c >> k & 1 == 1 { node[k] } else { degree[k] - node[k] }).product()).collect()
    };
    let common = weights.iter().fold(0, |a, &b| gcd(a, b));
    let list: Vec<(usize, u64)> = weights.iter().enumerate().filter(|(_, w)| **w > 0).map(|(c, w)| (c, (w / common) as u64)).collect();
    (list.len() < weights.len()).then_some(list)
}

fn gcd(a: usize, b: usize) -> usize {
    if b == 0 { a } else { gcd(b, a % b) }
}

/// Multi-indices below `size`, first index fastest.
fn boxes<const D: usize>(size: [usize; D]) -> Vec<[usize; D]> {
    let total: usize = size.iter().product();
    (0..total)
        .map(|mut n| {
            std::array::from_fn(|k| {
                let i = n % size[k];
                n /= size[k];
                i
            })
        })
        .collect()
}

/// Local points of equispaced Lagrange nodes.
pub(crate) fn equispaced<const D: usize>(nodes: &[[usize; D]], degree: [usize; D]) -> Vec<Vector<D>> {
    nodes.iter().map(|a| Vector::<D>::from_fn(|k, _| a[k] as f64 / degree[k] as f64)).collect()
}

/// Points inside the cell, one per node, that determine a polynomial of the given degree.
///
/// Chebyshev points on cubes, a shrunk lattice on simplices: none lies on an edge, where a map may collapse.
pub(crate) fn inner_points<const D: usize>(cell: Cell, nodes: &[[usize; D]], degree: [usize; D]) -> Vec<Vector<D>> {
    let chebyshev = |i: usize, p: usize| 0.5 - 0.5 * (std::f64::consts::PI * (i as f64 + 0.5) / (p as f64 + 1.0)).cos();
    let shrunk = |i: usize, p: usize| (i as f64 + 1.0 / (D as f64 + 1.0)) / (p as f64 + 1.0);
    let simplex = cell == Cell::Simplex && D > 1;
    nodes.iter().map(|a| Vector::<D>::from_fn(|k, _| if simplex { shrunk(a[k], degree[k]) } else { chebyshev(a[k], degree[k]) })).collect()
}

/// Values of the Bernstein polynomials at `xi`, one per node.
pub(crate) fn bernstein<const D: usize>(cell: Cell, nodes: &[[usize; D]], degree: [usize; D], xi: &Vector<D>) -> Vec<f64> {
    if cell == Cell::Simplex && D > 1 {
        let p = degree[0];
        let rest = 1.0 - xi.iter().sum::<f64>();
        return nodes
            .iter()
            .map(|a| {
                let (mut value, mut left) = (1.0, p);
                for k in 0..D {
                    value *= binomial(left, a[k]) * power(xi[k], a[k]);
                    left -= a[k];
                }
                value * power(rest, left)
            })
            .collect();
    }
    let line = |k: usize| -> Vec<f64> {
        (0..=degree[k]).map(|i| binomial(degree[k], i) * power(xi[k], i) * power(1.0 - xi[k], degree[k] - i)).collect()
    };
    let lines: [Vec<f64>; D] = std::array::from_fn(line);
    nodes.iter().map(|a| (0..D).map(|k| lines[k][a[k]]).product()).collect()
}

fn binomial(n: usize, k: usize) -> f64 {
    (0..k).fold(1.0, |b, i| b * (n - i) as f64 / (i + 1) as f64)
}

fn power(x: f64, n: usize) -> f64 {
    (0..n).fold(1.0, |y, _| y * x)
}

/// Nodes of one cell kind and degree, with the operators from values at inner points to coefficients and nodal values.
#[derive(Clone, Debug)]
pub(crate) struct Interpolant<const D: usize> {
    /// Multi-indices in VTK's order.
    pub nodes: Vec<[usize; D]>,
    /// Points at which values are sampled.
    pub points: Vec<Vector<D>>,
    /// Equispaced nodes, of a multiple of the degree.
    pub lattice: Vec<Vector<D>>,
    /// Bernstein coefficients = `to_bezier` * values at `points`.
    pub to_bezier: DMatrix<f64>,
    /// Values at `lattice` = `to_lattice` * values at `points`.
    pub to_lattice: DMatrix<f64>,
    /// Nodes of the cell in the file: for a right-handed element, and for a left-handed one, whose first two axes are exchanged.
    pub whole: [Vec<Vec<usize>>; 2],
    /// The linear cells that fill it, as [`linear_pieces`] says, between the nodes at `lattice`.
    linear: Vec<Vec<Pieces>>,
    /// Per node at `lattice` the corners around it, as [`around`] says.
    pub around: Vec<Option<Vec<(usize, u64)>>>,
}

impl<const D: usize> Interpolant<D> {
    /// Interpolation of a degree whose lattice has `times` as many steps.
    pub fn new(cell: Cell, degree: [usize; D], times: usize) -> Self {
        let (fine, nodes) = (degree.map(|p| times * p), nodes(cell, degree));
        let between = self::nodes(cell, fine);
        let points = inner_points(cell, &nodes, degree);
        let lattice = equispaced(&between, fine);
        let n = nodes.len();
        let values = |at: &[Vector<D>]| {
            let rows: Vec<Vec<f64>> = at.iter().map(|xi| bernstein(cell, &nodes, degree, xi)).collect();
            DMatrix::from_fn(at.len(), n, |i, j| rows[i][j])
        };
        let to_bezier = values(&points).try_inverse().expect("inner points determine the polynomial");
        let to_lattice = values(&lattice) * &to_bezier;
        let whole = [vec![(0..n).collect()], vec![exchanged(cell, degree, &nodes)]];
        let linear = linear_pieces(cell, fine, &between);
        let around = between.iter().map(|&node| around(cell, fine, node)).collect();
        Self { nodes, points, lattice, to_bezier, to_lattice, whole, linear, around }
    }

    /// Cuts the cell between the places `x` of the lattice into linear cells, none of them negative; says whether none had to be turned:
    /// one that is negative where the map is not shows that the lattice is too coarse.
    ///
    /// Of the ways to cut a body the one whose least cell is the greatest. A surface in space has no sign.
    pub fn cut<const N: usize>(&self, x: &[Vector<N>], left: bool) -> (Pieces, bool) {
        if D != N || D == 1 {
            return (self.linear.iter().flat_map(|ways| ways[0].iter().cloned()).collect(), true);
        }
        let turned = |piece: &Vec<usize>, turn: bool| if turn { mirrored::<D>(piece) } else { piece.clone() };
        let least_of = |way: &Pieces| way.iter().map(|p| determinants::<D, N>(x, &turned(p, left))[0]).fold(f64::INFINITY, f64::min);
        let (mut pieces, mut least) = (Vec::new(), f64::INFINITY);
        for ways in &self.linear {
            let mut best = (&ways[0], least_of(&ways[0]));
            for way in &ways[1..] {
                let own = least_of(way);
                // of equals the first, whatever the rounding
                if own > best.1 + 1e-9 * best.1.abs() {
                    best = (way, own);
                }
            }
            least = least.min(best.1);
            pieces.extend(best.0.iter().map(|piece| turned(piece, determinants::<D, N>(x, piece)[1] < 0.0)));
        }
        let size = x.iter().map(|p| (p - x[0]).amax()).fold(0.0, f64::max);
        (pieces, least >= -1e-12 * size.powi(D as i32))
    }
}

#[cfg(test)]
mod tests;
