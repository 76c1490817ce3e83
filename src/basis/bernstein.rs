//! Bernstein polynomials on triangles and tetrahedra; those of intervals are [`BSpline::bernstein`](super::BSpline::bernstein).

use super::{Basis, Cell, Elements, Order, Polynomials, ShapeTable, simplex_lattice, simplex_numbering};
use crate::linalg::{Matrix, Real, Vector, num};

/// Cells of a basis on simplices: function and vertex ids.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Cells {
    pub(super) functions: usize,
    /// Functions per cell.
    pub(super) local: usize,
    pub(super) connectivity: Vec<usize>,
    pub(super) corners: Vec<usize>,
}

impl Cells {
    fn ids(&self, element: usize) -> &[usize] {
        &self.connectivity[element * self.local..(element + 1) * self.local]
    }
    fn count(&self) -> usize {
        self.connectivity.len() / self.local
    }
}

/// Bernstein polynomials p! / (a_0! .. a_D!) l_0^(a_0) .. l_D^(a_D) of the barycentric coordinates of simplices,
/// continuous across them or not.
#[derive(Clone, Debug, PartialEq)]
pub struct BernsteinSimplex<const D: usize, T: Real = f64> {
    degree: usize,
    continuous: bool,
    pub(super) cells: Cells,
    lattice: Vec<[usize; D]>,
    factors: Vec<T>,
}

/// Maximum number of barycentric coordinates, that of a tetrahedron.
const MOST: usize = 4;

impl<const D: usize, T: Real> BernsteinSimplex<D, T> {
    /// Polynomials on the cells of `corners` (D + 1 vertex ids each).
    ///
    /// # Panics
    /// If the number of ids is no multiple of D + 1, or a continuous basis has degree 0.
    pub fn new(degree: usize, corners: Vec<usize>, continuous: bool) -> Self {
        assert_eq!(corners.len() % (D + 1), 0, "D + 1 corners per cell");
        assert!(degree > 0 || !continuous, "continuous polynomials have degree 1 or more");
        let local = simplex_lattice::<D>(degree).len();
        let (functions, connectivity) = if continuous {
            simplex_numbering::<D>(degree, &corners)
        } else {
            let n = corners.len() / (D + 1) * local;
            (n, (0..n).collect())
        };
        Self::on_cells(degree, continuous, Cells { functions, local, connectivity, corners })
    }

    pub(super) fn on_cells(degree: usize, continuous: bool, cells: Cells) -> Self {
        const { assert!(D >= 1 && D < MOST, "simplices of dimension 1 to 3") }
        let lattice = simplex_lattice::<D>(degree);
        let factorial = |n: usize| (1..=n).fold(T::one(), |f, k| f * num(k));
        let factors = lattice
            .iter()
            .map(|a| a.iter().fold(factorial(degree) / factorial(degree - a.iter().sum::<usize>()), |f, &k| f / factorial(k)))
            .collect();
        Self { degree, continuous, cells, lattice, factors }
    }
}

impl<const D: usize, T: Real> Elements for BernsteinSimplex<D, T> {
    fn num_elements(&self) -> usize {
        self.cells.count()
    }
    fn cell(&self, _element: usize) -> Cell {
        Cell::Simplex
    }
    fn corners(&self, element: usize, ids: &mut Vec<usize>) {
        ids.clear();
        ids.extend_from_slice(&self.cells.corners[element * (D + 1)..(element + 1) * (D + 1)]);
    }
}

impl<const D: usize, T: Real> Basis<D, T> for BernsteinSimplex<D, T> {
    fn num_functions(&self) -> usize {
        self.cells.functions
    }
    fn degree(&self, _element: usize) -> [usize; D] {
        [self.degree; D]
    }
    fn active(&self, element: usize, ids: &mut Vec<usize>) {
        ids.clear();
        ids.extend_from_slice(self.cells.ids(element));
    }
    fn tabulate(&self, _element: usize, xi: &[Vector<D, T>], order: Order, table: &mut ShapeTable<D, T>) {
        let p = self.degree;
        table.reset(xi.len(), self.lattice.len(), order);
        let mut powers = std::mem::take(&mut table.numbers);
        powers.clear();
        powers.resize((D + 1) * (p + 1), T::one());
        for (q, x) in xi.iter().enumerate() {
            for v in 0..=D {
                let l = if v == 0 { T::one() - x.sum() } else { x[v - 1] };
                for j in 1..=p {
                    powers[v * (p + 1) + j] = powers[v * (p + 1) + j - 1] * l;
                }
            }
            // derivative of l^a of the given order
            let power = |v: usize, a: usize, times: usize| match times {
                0 => powers[v * (p + 1) + a],
                1 if a >= 1 => num::<T>(a) * powers[v * (p + 1) + a - 1],
                2 if a >= 2 => num::<T>(a * (a - 1)) * powers[v * (p + 1) + a - 2],
                _ => T::zero(),
            };
            for (a, (index, &factor)) in self.lattice.iter().zip(&self.factors).enumerate() {
                let rest = p - index.iter().sum::<usize>();
                let exponent = |v: usize| if v == 0 { rest } else { index[v - 1] };
                // derivatives by the barycentric coordinates s and t, taken as independent
                let partial =
                    |along: &[usize]| (0..=D).fold(factor, |f, v| f * power(v, exponent(v), along.iter().filter(|&&s| s == v).count()));
                table.values_mut(q)[a] = partial(&[]);
                if order >= Order::Gradients {
                    let base = partial(&[0]);
                    table.grads_mut(q)[a] = Vector::from_fn(|k, _| partial(&[k + 1]) - base);
                }
                if order >= Order::Hessians {
                    let base = partial(&[0, 0]);
                    table.hessians_mut(q)[a] =
                        Matrix::from_fn(|k, l| partial(&[k + 1, l + 1]) - partial(&[k + 1, 0]) - partial(&[0, l + 1]) + base);
                }
            }
        }
        table.numbers = powers;
    }
    fn polynomials(&self, wanted: Polynomials) -> Option<Box<dyn Basis<D, T>>> {
        let (degree, continuous) = match wanted {
            Polynomials::Lowered(k) => (self.degree.checked_sub(k)?, self.continuous && k == 0),
            Polynomials::Uniform { degree, continuity: -1 } => (degree, false),
            Polynomials::Uniform { degree, continuity: 0 } if degree > 0 => (degree, true),
            Polynomials::Uniform { .. } => return None,
        };
        Some(Box::new(Self::new(degree, self.cells.corners.clone(), continuous)))
    }
}
