//! Caller-owned tables of function values and derivatives at a batch of points.

use super::ScratchSlot;
use crate::linalg::{Matrix, Real, Vector};

/// Highest order of derivatives to tabulate; each includes those before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Order {
    /// Values alone.
    Values,
    /// Values and first derivatives.
    Gradients,
    /// Values, first and second derivatives.
    Hessians,
}

/// Values and derivatives (with respect to the local coordinates xi) of the active functions at a batch of points.
///
/// Shape: `values(q)[a]`, `grads(q)[a]`, `hessians(q)[a]` for point q and local function a, in the order of
/// [`Basis::active`](crate::basis::Basis::active). The table keeps its memory between calls, scratch for products and
/// quotients of bases included, so a warm table is filled without allocating.
#[derive(Clone, Debug)]
pub struct ShapeTable<const D: usize, T: Real = f64> {
    functions: usize,
    order: Order,
    values: Vec<T>,
    grads: Vec<Vector<D, T>>,
    hessians: Vec<Matrix<D, D, T>>,
    /// Scratch of implementors: univariate tables of a product.
    pub lines: Vec<ShapeTable<1, T>>,
    /// Scratch of implementors: the table of an inner basis of the same dimension.
    pub inner: Option<Box<ShapeTable<D, T>>>,
    /// Scratch of implementors: points per axis.
    pub line_points: Vec<Vector<1, T>>,
    /// Scratch of implementors: points of an inner basis of the same dimension.
    pub inner_points: Vec<Vector<D, T>>,
    /// Scratch of implementors: numbers.
    pub numbers: Vec<T>,
    /// Scratch of implementors: ids.
    pub ids: Vec<usize>,
    /// Scratch of implementors: the table of an inner basis of another dimension, with its points.
    pub embedded: ScratchSlot,
}

impl<const D: usize, T: Real> Default for ShapeTable<D, T> {
    fn default() -> Self {
        Self {
            functions: 0,
            order: Order::Values,
            values: Vec::new(),
            grads: Vec::new(),
            hessians: Vec::new(),
            lines: Vec::new(),
            inner: None,
            line_points: Vec::new(),
            inner_points: Vec::new(),
            numbers: Vec::new(),
            ids: Vec::new(),
            embedded: ScratchSlot::default(),
        }
    }
}

impl<const D: usize, T: Real> ShapeTable<D, T> {
    /// An empty table.
    pub fn new() -> Self {
        Self::default()
    }

    /// Makes room for `points` x `functions` entries up to `order`, all zero; implementors call it first.
    pub fn reset(&mut self, points: usize, functions: usize, order: Order) {
        let n = points * functions;
        self.functions = functions;
        self.order = order;
        self.values.clear();
        self.values.resize(n, T::zero());
        self.grads.clear();
        self.hessians.clear();
        if order >= Order::Gradients {
            self.grads.resize(n, Vector::zeros());
        }
        if order >= Order::Hessians {
            self.hessians.resize(n, Matrix::zeros());
        }
    }

    /// [`reset`](Self::reset) that leaves old numbers, for implementors that write every entry.
    pub(super) fn resize(&mut self, points: usize, functions: usize, order: Order) {
        let n = points * functions;
        self.functions = functions;
        self.order = order;
        let of = |least: Order| if order >= least { n } else { 0 };
        self.values.resize(n, T::zero());
        self.grads.resize(of(Order::Gradients), Vector::zeros());
        self.hessians.resize(of(Order::Hessians), Matrix::zeros());
    }

    /// Number of functions per point.
    pub fn num_functions(&self) -> usize {
        self.functions
    }

    /// Number of points.
    pub fn num_points(&self) -> usize {
        self.values.len().checked_div(self.functions).unwrap_or(0)
    }

    /// Order of the table.
    pub fn order(&self) -> Order {
        self.order
    }

    /// Values of all functions at point `q`.
    #[inline]
    pub fn values(&self, q: usize) -> &[T] {
        &self.values[q * self.functions..(q + 1) * self.functions]
    }

    /// First derivatives of all functions at point `q`.
    #[inline]
    pub fn grads(&self, q: usize) -> &[Vector<D, T>] {
        &self.grads[q * self.functions..(q + 1) * self.functions]
    }

    /// Second derivatives of all functions at point `q`.
    #[inline]
    pub fn hessians(&self, q: usize) -> &[Matrix<D, D, T>] {
        &self.hessians[q * self.functions..(q + 1) * self.functions]
    }

    /// Values at point `q`, to fill.
    #[inline]
    pub fn values_mut(&mut self, q: usize) -> &mut [T] {
        &mut self.values[q * self.functions..(q + 1) * self.functions]
    }

    /// First derivatives at point `q`, to fill.
    #[inline]
    pub fn grads_mut(&mut self, q: usize) -> &mut [Vector<D, T>] {
        &mut self.grads[q * self.functions..(q + 1) * self.functions]
    }

    /// Second derivatives at point `q`, to fill.
    #[inline]
    pub fn hessians_mut(&mut self, q: usize) -> &mut [Matrix<D, D, T>] {
        &mut self.hessians[q * self.functions..(q + 1) * self.functions]
    }

    /// Values, first and second derivatives at point `q`, to fill; empty beyond the order of the table.
    #[inline]
    pub(super) fn point_mut(&mut self, q: usize) -> (&mut [T], &mut [Vector<D, T>], &mut [Matrix<D, D, T>]) {
        let own = q * self.functions..(q + 1) * self.functions;
        let of = |order: Order| if self.order >= order { own.clone() } else { 0..0 };
        let (grads, hessians) = (of(Order::Gradients), of(Order::Hessians));
        (&mut self.values[own], &mut self.grads[grads], &mut self.hessians[hessians])
    }
}
