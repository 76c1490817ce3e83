//! Piecewise constants on the elements of another basis.

use crate::basis::{Basis, Cell, Elements, Order, ShapeTable};
use crate::linalg::{Real, Vector};

/// The functions that are one on one element and zero elsewhere.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PiecewiseConstant {
    cells: Vec<Cell>,
    corners: Vec<Vec<usize>>,
}

impl PiecewiseConstant {
    /// Creates the constants on the elements of `other`.
    pub fn of<E: Elements + ?Sized>(other: &E) -> Self {
        let corners = |element| {
            let mut ids = Vec::new();
            other.corners(element, &mut ids);
            ids
        };
        Self {
            cells: (0..other.num_elements()).map(|e| other.cell(e)).collect(),
            corners: (0..other.num_elements()).map(corners).collect(),
        }
    }
}

impl Elements for PiecewiseConstant {
    fn num_elements(&self) -> usize {
        self.cells.len()
    }
    fn cell(&self, element: usize) -> Cell {
        self.cells[element]
    }
    fn corners(&self, element: usize, ids: &mut Vec<usize>) {
        ids.clear();
        ids.extend_from_slice(&self.corners[element]);
    }
}

impl<const D: usize, T: Real> Basis<D, T> for PiecewiseConstant {
    fn num_functions(&self) -> usize {
        self.cells.len()
    }
    fn degree(&self, _element: usize) -> [usize; D] {
        [0; D]
    }
    fn active(&self, element: usize, ids: &mut Vec<usize>) {
        ids.clear();
        ids.push(element);
    }
    fn tabulate(&self, _element: usize, xi: &[Vector<D, T>], order: Order, table: &mut ShapeTable<D, T>) {
        table.reset(xi.len(), 1, order);
        for q in 0..xi.len() {
            table.values_mut(q)[0] = T::one();
        }
    }
}
