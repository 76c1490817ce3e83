//! Polynomials of one variable, given element by element.

use super::{Basis, Cell, Elements, Order, ShapeTable};
use crate::linalg::{Real, Vector, lit, num};

/// The polynomials of one element.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ElementPolynomials<T: Real = f64> {
    /// The functions active on the element, each once.
    pub ids: Vec<usize>,
    /// Highest degree.
    pub degree: usize,
    /// c_ak, `degree + 1` numbers per function: N_a = sum_k c_ak P_k(2 xi - 1) with Legendre's polynomials P_k.
    pub coefficients: Vec<T>,
}

/// Functions that are a polynomial of their own on every element: dual bases.
///
/// There are no blocks and no polynomials; nothing says that functions join continuously.
#[derive(Clone, Debug, PartialEq)]
pub struct Piecewise<T: Real = f64> {
    cells: Vec<Cell>,
    corners: Vec<Vec<usize>>,
    functions: usize,
    pieces: Vec<ElementPolynomials<T>>,
}

impl<T: Real> Piecewise<T> {
    /// `functions` functions on the elements of `elements`, with one piece each.
    ///
    /// # Panics
    /// If there is not one piece per element, a piece has not degree + 1 coefficients per function, or an id is not
    /// below `functions`.
    pub fn new<E: Elements + ?Sized>(elements: &E, functions: usize, pieces: Vec<ElementPolynomials<T>>) -> Self {
        assert_eq!(pieces.len(), elements.num_elements(), "one piece per element");
        for piece in &pieces {
            assert_eq!(piece.coefficients.len(), piece.ids.len() * (piece.degree + 1), "degree + 1 coefficients per function");
            assert!(piece.ids.iter().all(|&i| i < functions), "pieces name functions below {functions}");
        }
        let corners = |element| {
            let mut ids = Vec::new();
            elements.corners(element, &mut ids);
            ids
        };
        Self {
            cells: (0..pieces.len()).map(|e| elements.cell(e)).collect(),
            corners: (0..pieces.len()).map(corners).collect(),
            functions,
            pieces,
        }
    }
}

impl<T: Real> Elements for Piecewise<T> {
    fn num_elements(&self) -> usize {
        self.pieces.len()
    }
    fn cell(&self, element: usize) -> Cell {
        self.cells[element]
    }
    fn corners(&self, element: usize, ids: &mut Vec<usize>) {
        ids.clear();
        ids.extend_from_slice(&self.corners[element]);
    }
}

impl<T: Real> Basis<1, T> for Piecewise<T> {
    fn num_functions(&self) -> usize {
        self.functions
    }
    fn degree(&self, element: usize) -> [usize; 1] {
        [self.pieces[element].degree]
    }
    fn active(&self, element: usize, ids: &mut Vec<usize>) {
        ids.clear();
        ids.extend_from_slice(&self.pieces[element].ids);
    }
    fn tabulate(&self, element: usize, xi: &[Vector<1, T>], order: Order, table: &mut ShapeTable<1, T>) {
        let piece = &self.pieces[element];
        let n = piece.degree + 1;
        table.reset(xi.len(), piece.ids.len(), order);
        let mut legendre = std::mem::take(&mut table.numbers);
        for (q, xi) in xi.iter().enumerate() {
            legendre_polynomials(piece.degree, xi[0], &mut legendre);
            let sum = |a: usize, derivative: usize| {
                let line = &piece.coefficients[a * n..(a + 1) * n];
                line.iter().zip(&legendre[derivative * n..]).fold(T::zero(), |s, (&c, &p)| s + c * p)
            };
            for a in 0..piece.ids.len() {
                table.values_mut(q)[a] = sum(a, 0);
                if order >= Order::Gradients {
                    table.grads_mut(q)[a][0] = sum(a, 1);
                }
                if order >= Order::Hessians {
                    table.hessians_mut(q)[a][(0, 0)] = sum(a, 2);
                }
            }
        }
        table.numbers = legendre;
    }
}

/// P_k(2 xi - 1), k = 0..=degree, then their first, then their second derivatives by xi:
/// (k + 1) P_(k+1) = (2k + 1) x P_k - k P_(k-1), differentiated term by term.
pub fn legendre_polynomials<T: Real>(degree: usize, xi: T, out: &mut Vec<T>) {
    let n = degree + 1;
    let two = lit::<T>(2.0);
    let x = two * xi - T::one();
    out.clear();
    out.resize(3 * n, T::zero());
    out[0] = T::one();
    if degree == 0 {
        return;
    }
    out[1] = x;
    out[n + 1] = two;
    for k in 1..degree {
        let (a, b, c) = (num::<T>(2 * k + 1), num::<T>(k), num::<T>(k + 1));
        out[k + 1] = (a * x * out[k] - b * out[k - 1]) / c;
        out[n + k + 1] = (a * (two * out[k] + x * out[n + k]) - b * out[n + k - 1]) / c;
        out[2 * n + k + 1] = (a * (two * two * out[n + k] + x * out[2 * n + k]) - b * out[2 * n + k - 1]) / c;
    }
}
