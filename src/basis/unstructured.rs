//! Lagrange and Bernstein polynomials of one degree on cells that are joined at will, shapes mixed.

use super::numbering::lattice;
use super::topology::corner_count;
use super::{
    BSpline, Basis, BasisStructure, BernsteinSimplex, Cell, Elements, LagrangeLine, LagrangeSimplex, Listed, Order, Polynomials, ShapeTable,
};
use super::{TensorProduct, Topology};
use crate::linalg::{Real, Vector, num};
use std::sync::Arc;

/// Polynomials of one degree on cells of dimension D: tensor cells have the products of the interval's functions, simplices those of
/// [`LagrangeSimplex`], and neighbours share the functions of common vertices, edges and faces.
///
/// Local functions are in the order of the cell's lattice, first axis fastest. Lagrange nodes are the interval's Gauss-Lobatto nodes on
/// every edge, and on faces those of the square or of the triangle; all have the symmetries of their cell.
#[derive(Clone, Debug)]
pub struct Unstructured<const D: usize, T: Real = f64> {
    topology: Arc<Topology<D>>,
    degree: usize,
    kind: Kind,
    functions: usize,
    first: Vec<usize>,
    ids: Vec<usize>,
    /// The functions of one tensor cell and of one simplex, where there are such cells.
    kernels: [Option<Arc<dyn Basis<D, T>>>; 2],
    /// Places of the corners in the lattices of a tensor cell and of a simplex.
    corners: [Vec<usize>; 2],
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Lagrange,
    Bernstein { continuous: bool },
}

impl<const D: usize, T: Real> Unstructured<D, T> {
    /// Continuous Lagrange polynomials.
    ///
    /// # Panics
    /// If the degree is zero.
    pub fn lagrange(degree: usize, topology: Arc<Topology<D>>) -> Self {
        Self::new(degree, Kind::Lagrange, topology)
    }

    /// Continuous Lagrange polynomials, numbered by the first cell of their support, cells in the order `along`.
    ///
    /// Where cells that follow each other are near each other, so are numbers: matrices are read and written in pieces.
    ///
    /// # Panics
    /// If the degree is zero, or `along` does not list every cell once.
    pub fn lagrange_along(degree: usize, topology: Arc<Topology<D>>, along: &[u32]) -> Self {
        let mut basis = Self::lagrange(degree, topology);
        assert_eq!(along.len(), basis.topology.num_cells(), "every cell once");
        let (mut number, mut next) = (vec![usize::MAX; basis.functions], 0);
        for &e in along {
            for &id in basis.functions(e as usize) {
                if number[id] == usize::MAX {
                    number[id] = next;
                    next += 1;
                }
            }
        }
        assert_eq!(next, basis.functions, "every cell once");
        basis.ids.iter_mut().for_each(|id| *id = number[*id]);
        basis
    }

    /// Bernstein polynomials, continuous or not.
    ///
    /// # Panics
    /// If a continuous basis has degree zero.
    pub fn bernstein(degree: usize, continuous: bool, topology: Arc<Topology<D>>) -> Self {
        Self::new(degree, Kind::Bernstein { continuous }, topology)
    }

    fn new(degree: usize, kind: Kind, topology: Arc<Topology<D>>) -> Self {
        let continuous = kind != Kind::Bernstein { continuous: false };
        assert!(degree > 0 || !continuous, "continuous polynomials have degree 1 or more");
        let has = |c: Cell| (0..topology.num_cells()).any(|e| topology.cell(e) == c);
        let kernels = [Cell::Tensor, Cell::Simplex].map(|c| has(c).then(|| kernel::<D, T>(degree, kind, c)));
        let (functions, first, ids) = if continuous {
            topology.number(degree)
        } else {
            let local = kernels.each_ref().map(|k| k.as_ref().map_or(0, |k| k.num_functions()));
            let mut first = vec![0];
            let mut n = 0;
            for e in 0..topology.num_cells() {
                n += local[usize::from(topology.cell(e) == Cell::Simplex)];
                first.push(n);
            }
            (n, first, (0..n).collect())
        };
        let corners = [Cell::Tensor, Cell::Simplex].map(|c| corner_places::<D>(c, degree));
        Self { topology, degree, kind, functions, first, ids, kernels, corners }
    }

    /// The cells.
    pub fn topology(&self) -> &Arc<Topology<D>> {
        &self.topology
    }

    /// The functions of an element in the order of its lattice.
    pub fn functions(&self, element: usize) -> &[usize] {
        &self.ids[self.first[element]..self.first[element + 1]]
    }

    /// The function whose node is at a corner of an element.
    pub fn at_corner(&self, element: usize, corner: usize) -> usize {
        self.functions(element)[self.corners[usize::from(self.topology.cell(element) == Cell::Simplex)][corner]]
    }

    /// The function whose node is at each vertex.
    pub fn at_vertices(&self) -> Vec<usize> {
        let mut functions = vec![usize::MAX; self.topology.num_vertices()];
        for e in 0..self.topology.num_cells() {
            self.topology.vertices(e).iter().enumerate().for_each(|(c, &v)| functions[v] = self.at_corner(e, c));
        }
        functions
    }

    fn kernel(&self, element: usize) -> &Arc<dyn Basis<D, T>> {
        self.kernels[usize::from(self.topology.cell(element) == Cell::Simplex)].as_ref().expect("every shape has its functions")
    }
}

/// Places of the corners in the lattice of a cell.
pub(crate) fn corner_places<const D: usize>(cell: Cell, degree: usize) -> Vec<usize> {
    let list = lattice::<D>(cell, degree);
    let corner = |c: usize| -> [usize; D] {
        std::array::from_fn(|k| {
            let far = if cell == Cell::Simplex { c == k + 1 } else { c >> k & 1 == 1 };
            if far { degree } else { 0 }
        })
    };
    (0..corner_count(cell, D)).map(|c| list.iter().position(|i| *i == corner(c)).expect("the lattice has its corners")).collect()
}

/// The functions of one cell.
fn kernel<const D: usize, T: Real>(degree: usize, kind: Kind, cell: Cell) -> Arc<dyn Basis<D, T>> {
    let corners = || (0..=D).collect();
    match (kind, cell) {
        (Kind::Lagrange, Cell::Tensor) => Arc::new(TensorProduct::new(std::array::from_fn(|_| LagrangeLine::<T>::new(degree, 1)))),
        (Kind::Lagrange, Cell::Simplex) => Arc::new(LagrangeSimplex::<D, T>::on_corners(degree, corners())),
        (Kind::Bernstein { .. }, Cell::Tensor) => {
            Arc::new(TensorProduct::new(std::array::from_fn(|_| BSpline::<T>::bernstein(degree, &[num(0), num(1)]))))
        }
        (Kind::Bernstein { .. }, Cell::Simplex) => Arc::new(BernsteinSimplex::<D, T>::new(degree, corners(), false)),
    }
}

impl<const D: usize, T: Real> Elements for Unstructured<D, T> {
    fn num_elements(&self) -> usize {
        self.topology.num_cells()
    }
    fn cell(&self, element: usize) -> Cell {
        self.topology.cell(element)
    }
    fn corners(&self, element: usize, ids: &mut Vec<usize>) {
        ids.clear();
        ids.extend_from_slice(self.topology.corners(element));
    }
}

impl<const D: usize, T: Real> Basis<D, T> for Unstructured<D, T> {
    fn num_functions(&self) -> usize {
        self.functions
    }
    fn degree(&self, _element: usize) -> [usize; D] {
        [self.degree; D]
    }
    fn active(&self, element: usize, ids: &mut Vec<usize>) {
        ids.clear();
        ids.extend_from_slice(self.functions(element));
    }
    fn tabulate(&self, element: usize, xi: &[Vector<D, T>], order: Order, table: &mut ShapeTable<D, T>) {
        self.kernel(element).tabulate(0, xi, order, table);
    }
    fn structure(&self) -> &dyn BasisStructure<D, T> {
        self
    }
    /// Bernstein polynomials on the same cells: continuous at no reduction of the degree, discontinuous at any.
    fn polynomials(&self, wanted: Polynomials) -> Option<Box<dyn Basis<D, T>>> {
        let (degree, continuous) = match wanted {
            Polynomials::Lowered(k) => (self.degree.checked_sub(k)?, k == 0 && self.kind != Kind::Bernstein { continuous: false }),
            Polynomials::Uniform { degree, continuity: -1 } => (degree, false),
            Polynomials::Uniform { degree, continuity: 0 } if degree > 0 => (degree, true),
            Polynomials::Uniform { .. } => return None,
        };
        Some(Box::new(Self::bernstein(degree, continuous, self.topology.clone())))
    }
}

impl<const D: usize, T: Real> BasisStructure<D, T> for Unstructured<D, T> {
    fn is_linear(&self, element: usize) -> bool {
        self.degree == 1 && self.cell(element) == Cell::Simplex
    }
    /// One for the tensor cells, one for the simplices.
    fn reference(&self, element: usize) -> Option<usize> {
        Some(usize::from(self.cell(element) == Cell::Simplex))
    }
    fn listed(&self) -> Option<Listed<'_>> {
        Some(Listed { first: &self.first, ids: &self.ids })
    }
}
