//! A univariate basis seen on smaller elements.

use super::{Basis, BasisStructure, Block, Cell, Elements, Order, Polynomials, ShapeTable};
use crate::linalg::{Real, Vector, lit};

/// The functions of `inner` on cells cut from its elements: a coarse basis on a fine grid.
///
/// Cell e is the part origin + length xi of one inner element. Functions and their numbers stay those of `inner`.
#[derive(Clone, Debug, PartialEq)]
pub struct Refined<B, T: Real = f64> {
    inner: B,
    cells: Vec<(usize, T, T)>,
    /// Cells follow each other without a hole, so that they share corners.
    connected: bool,
    /// The inner elements never fall.
    ordered: bool,
}

/// Cells whose ends differ by less than this (in the inner element's coordinate) touch.
const TOUCH: f64 = 1e-6;

impl<B: Basis<1, T>, T: Real> Refined<B, T> {
    /// Cells (inner element, origin, length) of `inner`.
    ///
    /// # Panics
    /// If a cell names an element that `inner` does not have.
    pub fn new(inner: B, cells: Vec<(usize, T, T)>) -> Self {
        assert!(cells.iter().all(|c| c.0 < inner.num_elements()), "cells lie in elements of the inner basis");
        let near = |a: T, b: T| (a - b).abs() < lit(TOUCH);
        let (mut last, mut next) = (Vec::new(), Vec::new());
        let connected = cells.windows(2).all(|w| {
            let ((e0, o0, l0), (e1, o1, _)) = (w[0], w[1]);
            if e0 == e1 {
                return near(o0 + l0, o1);
            }
            inner.corners(e0, &mut last);
            inner.corners(e1, &mut next);
            near(o0 + l0, T::one()) && near(o1, T::zero()) && last.last().is_some() && last.last() == next.first()
        });
        let ordered = cells.windows(2).all(|w| w[0].0 <= w[1].0);
        Self { inner, cells, connected, ordered }
    }

    /// The underlying basis.
    pub fn inner(&self) -> &B {
        &self.inner
    }

    /// The cells (inner element, origin, length).
    pub fn cells(&self) -> &[(usize, T, T)] {
        &self.cells
    }
}

impl<B: Elements, T: Real> Elements for Refined<B, T> {
    fn num_elements(&self) -> usize {
        self.cells.len()
    }
    fn cell(&self, element: usize) -> Cell {
        self.inner.cell(self.cells[element].0)
    }
    fn corners(&self, element: usize, ids: &mut Vec<usize>) {
        ids.clear();
        if self.connected {
            ids.extend([element, element + 1]);
        }
    }
}

impl<B: Basis<1, T>, T: Real> Basis<1, T> for Refined<B, T> {
    fn num_functions(&self) -> usize {
        self.inner.num_functions()
    }
    fn degree(&self, element: usize) -> [usize; 1] {
        self.inner.degree(self.cells[element].0)
    }
    fn active(&self, element: usize, ids: &mut Vec<usize>) {
        self.inner.active(self.cells[element].0, ids);
    }
    fn tabulate(&self, element: usize, xi: &[Vector<1, T>], order: Order, table: &mut ShapeTable<1, T>) {
        let (e, origin, length) = self.cells[element];
        let mut points = std::mem::take(&mut table.inner_points);
        let mut inner = table.inner.take().unwrap_or_default();
        points.clear();
        points.extend(xi.iter().map(|x| Vector::<1, T>::new(origin + length * x[0])));
        self.inner.tabulate(e, &points, order, &mut inner);
        table.reset(xi.len(), inner.num_functions(), order);
        for q in 0..xi.len() {
            table.values_mut(q).copy_from_slice(inner.values(q));
            if order >= Order::Gradients {
                for (to, from) in table.grads_mut(q).iter_mut().zip(inner.grads(q)) {
                    *to = from * length;
                }
            }
            if order >= Order::Hessians {
                for (to, from) in table.hessians_mut(q).iter_mut().zip(inner.hessians(q)) {
                    *to = from * (length * length);
                }
            }
        }
        table.inner_points = points;
        table.inner = Some(inner);
    }
    fn structure(&self) -> &dyn BasisStructure<1, T> {
        self
    }
    /// The polynomials of the inner basis on the smaller elements.
    fn polynomials(&self, wanted: Polynomials) -> Option<Box<dyn Basis<1, T>>> {
        Some(Box::new(Refined::new(self.inner.polynomials(wanted)?, self.cells.clone())))
    }
}

impl<B: Basis<1, T>, T: Real> BasisStructure<1, T> for Refined<B, T> {
    fn block(&self, _element: usize) -> Option<Block<'_, 1, T>> {
        let whole = super::tensor::is_one_block(&self.inner);
        (whole && self.ordered).then_some(Block { first: 0, axes: [self], weights: None })
    }
}
