//! Lagrange polynomials on triangles and tetrahedra: lattice, nodes, numbering, basis.

use super::bernstein::Cells;
use super::{Basis, BasisStructure, BernsteinSimplex, Cell, Elements, Order, Polynomials, ShapeTable, lagrange_nodes};
use crate::linalg::{Real, Vector, num};
use std::collections::BTreeMap;

/// The multi-indices (i_1, .., i_D) with sum at most `degree`, first entry fastest: the order of local functions.
pub fn simplex_lattice<const D: usize>(degree: usize) -> Vec<[usize; D]> {
    let mut lattice = Vec::new();
    for a in 0..(degree + 1).pow(D as u32) {
        let mut rest = a;
        let index: [usize; D] = std::array::from_fn(|_| {
            let i = rest % (degree + 1);
            rest /= degree + 1;
            i
        });
        if index.iter().sum::<usize>() <= degree {
            lattice.push(index);
        }
    }
    lattice
}

/// The Lagrange nodes on the unit simplex, in the order of [`simplex_lattice`]: those on an edge are the Gauss-Lobatto
/// nodes of the interval, those on a face the nodes of the triangle.
///
/// Source: T. Isaac, Recursive, parameter-free, explicitly defined interpolation nodes for simplices, SIAM J. Sci.
/// Comput. 42 (2020) A4046.
pub fn simplex_nodes<const D: usize, T: Real>(degree: usize) -> Vec<Vector<D, T>> {
    let lines: Vec<Vec<T>> = (0..=degree).map(lagrange_nodes).collect();
    simplex_lattice::<D>(degree)
        .iter()
        .map(|index| {
            let mut full = vec![degree - index.iter().sum::<usize>()];
            full.extend(index);
            let place = if degree == 0 { vec![T::one() / num(D + 1); D + 1] } else { recursive_node(&full, &lines) };
            Vector::from_fn(|k, _| place[k + 1])
        })
        .collect()
}

/// Barycentric coordinates of the node of a full multi-index: the mean of the nodes of its faces, each weighted by the
/// interval's node at the face's share of the degree.
fn recursive_node<T: Real>(index: &[usize], lines: &[Vec<T>]) -> Vec<T> {
    if index.len() == 1 {
        return vec![T::one()];
    }
    let n: usize = index.iter().sum();
    let (mut place, mut total) = (vec![T::zero(); index.len()], T::zero());
    for skip in (0..index.len()).filter(|&s| index[s] < n) {
        let weight = lines[n][n - index[skip]];
        let face: Vec<usize> = (0..index.len()).filter(|&k| k != skip).map(|k| index[k]).collect();
        for (j, x) in recursive_node(&face, lines).into_iter().enumerate() {
            place[j + usize::from(j >= skip)] += weight * x;
        }
        total += weight;
    }
    place.iter().map(|&x| x / total).collect()
}

/// Numbers the lattice points of simplices so that cells share those on common vertices, edges and faces.
///
/// `corners`: D + 1 vertex ids per cell. Returns the number of functions and their ids, cell by cell in the order of
/// [`simplex_lattice`], rising in the order of the cells.
pub fn simplex_numbering<const D: usize>(degree: usize, corners: &[usize]) -> (usize, Vec<usize>) {
    let lattice = simplex_lattice::<D>(degree);
    let mut known: BTreeMap<Vec<(usize, usize)>, usize> = BTreeMap::new();
    let mut ids = Vec::with_capacity(corners.len() / (D + 1) * lattice.len());
    for cell in corners.chunks_exact(D + 1) {
        for index in &lattice {
            // a point is the vertices it depends on, each with its share
            let first = (cell[0], degree - index.iter().sum::<usize>());
            let mut key: Vec<(usize, usize)> = std::iter::once(first).chain((0..D).map(|k| (cell[k + 1], index[k]))).collect();
            key.retain(|v| v.1 > 0);
            key.sort_unstable();
            let next = known.len();
            ids.push(*known.entry(key).or_insert(next));
        }
    }
    (known.len(), ids)
}

/// Lagrange polynomials of one degree on triangles (D = 2) or tetrahedra (D = 3), continuous where cells share ids.
///
/// Local functions are ordered by [`simplex_lattice`], their nodes are [`simplex_nodes`]; on an edge they are the
/// Lagrange basis of the interval. Values are combinations of Bernstein polynomials.
#[derive(Clone, Debug, PartialEq)]
pub struct LagrangeSimplex<const D: usize, T: Real = f64> {
    bernstein: BernsteinSimplex<D, T>,
    nodes: Vec<Vector<D, T>>,
    /// N_a = sum_b c_ba B_b with c_ba at b n + a.
    coefficients: Vec<T>,
}

impl<const D: usize, T: Real> LagrangeSimplex<D, T> {
    /// `connectivity`: the function ids of one cell after the other, in the order of [`simplex_lattice`]; those at the
    /// vertices serve as corner ids.
    ///
    /// # Panics
    /// If the degree is zero, the number of ids is no multiple of the functions per cell, or an id is not below `functions`.
    pub fn new(degree: usize, functions: usize, connectivity: Vec<usize>) -> Self {
        let lattice = simplex_lattice::<D>(degree);
        assert_eq!(connectivity.len() % lattice.len(), 0, "as many ids per cell as it has functions");
        assert!(connectivity.iter().all(|&i| i < functions), "ids below the number of functions");
        let place = |v: usize| {
            let vertex: [usize; D] = std::array::from_fn(|k| if k + 1 == v { degree } else { 0 });
            lattice.iter().position(|i| *i == vertex).expect("the lattice has its vertices")
        };
        let vertices: Vec<usize> = (0..=D).map(place).collect();
        let corners = connectivity.chunks_exact(lattice.len()).flat_map(|cell| vertices.iter().map(|&v| cell[v])).collect();
        Self::on_cells(degree, Cells { functions, local: lattice.len(), connectivity, corners })
    }

    /// The continuous basis on the cells of `corners` (D + 1 vertex ids each), numbered by [`simplex_numbering`].
    ///
    /// # Panics
    /// If the degree is zero or the number of ids is no multiple of D + 1.
    pub fn on_corners(degree: usize, corners: Vec<usize>) -> Self {
        assert_eq!(corners.len() % (D + 1), 0, "D + 1 corners per cell");
        let (functions, connectivity) = simplex_numbering::<D>(degree, &corners);
        Self::on_cells(degree, Cells { functions, local: simplex_lattice::<D>(degree).len(), connectivity, corners })
    }

    fn on_cells(degree: usize, cells: Cells) -> Self {
        assert!(degree > 0, "a continuous Lagrange basis has degree 1 or more");
        let bernstein = BernsteinSimplex::<D, T>::on_cells(degree, true, cells);
        let nodes = simplex_nodes::<D, T>(degree);
        let n = nodes.len();
        let mut table = ShapeTable::new();
        bernstein.tabulate(0, &nodes, Order::Values, &mut table);
        let values = nalgebra::DMatrix::from_fn(n, n, |a, b| table.values(a)[b]);
        let inverse = values.try_inverse().expect("the nodes determine polynomials");
        let coefficients = (0..n * n).map(|i| inverse[(i / n, i % n)]).collect();
        Self { bernstein, nodes, coefficients }
    }

    /// The nodes on the unit simplex, in the order of the local functions.
    pub fn nodes(&self) -> &[Vector<D, T>] {
        &self.nodes
    }

    /// The function ids of all cells.
    pub fn connectivity(&self) -> &[usize] {
        &self.bernstein.cells.connectivity
    }
}

impl<const D: usize, T: Real> Elements for LagrangeSimplex<D, T> {
    fn num_elements(&self) -> usize {
        self.bernstein.num_elements()
    }
    fn cell(&self, _element: usize) -> Cell {
        Cell::Simplex
    }
    fn corners(&self, element: usize, ids: &mut Vec<usize>) {
        self.bernstein.corners(element, ids);
    }
}

impl<const D: usize, T: Real> Basis<D, T> for LagrangeSimplex<D, T> {
    fn num_functions(&self) -> usize {
        self.bernstein.num_functions()
    }
    fn degree(&self, element: usize) -> [usize; D] {
        self.bernstein.degree(element)
    }
    fn active(&self, element: usize, ids: &mut Vec<usize>) {
        self.bernstein.active(element, ids);
    }
    fn tabulate(&self, element: usize, xi: &[Vector<D, T>], order: Order, table: &mut ShapeTable<D, T>) {
        let n = self.nodes.len();
        let mut inner = table.inner.take().unwrap_or_default();
        self.bernstein.tabulate(element, xi, order, &mut inner);
        table.reset(xi.len(), n, order);
        for q in 0..xi.len() {
            for b in 0..n {
                let row = &self.coefficients[b * n..(b + 1) * n];
                let value = inner.values(q)[b];
                table.values_mut(q).iter_mut().zip(row).for_each(|(v, &c)| *v += value * c);
                if order >= Order::Gradients {
                    let grad = inner.grads(q)[b];
                    table.grads_mut(q).iter_mut().zip(row).for_each(|(g, &c)| *g += grad * c);
                }
                if order >= Order::Hessians {
                    let hessian = inner.hessians(q)[b];
                    table.hessians_mut(q).iter_mut().zip(row).for_each(|(h, &c)| *h += hessian * c);
                }
            }
        }
        table.inner = Some(inner);
    }
    fn structure(&self) -> &dyn BasisStructure<D, T> {
        self
    }
    /// Bernstein polynomials on the same cells.
    fn polynomials(&self, wanted: Polynomials) -> Option<Box<dyn Basis<D, T>>> {
        self.bernstein.polynomials(wanted)
    }
}

impl<const D: usize, T: Real> BasisStructure<D, T> for LagrangeSimplex<D, T> {
    /// One for all.
    fn reference(&self, _element: usize) -> Option<usize> {
        Some(0)
    }
}
