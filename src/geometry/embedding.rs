//! Affine cells inside elements of a parent.

use crate::linalg::{Matrix, Real, Vector};

/// A cell inside a parent element: parent xi = origin + axes xi.
///
/// A refined cell, a simplex cut from a cell, and a facet are all one of these.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Embedding<const S: usize, const D: usize, T: Real = f64> {
    /// The parent element.
    pub element: usize,
    /// Image of the cell's origin.
    pub origin: Vector<D, T>,
    /// Images of the cell's axes.
    pub axes: Matrix<D, S, T>,
}

impl<const S: usize, const D: usize, T: Real> Embedding<S, D, T> {
    /// The parent's local coordinates of the local point `xi`.
    #[inline]
    pub fn lift(&self, xi: &Vector<S, T>) -> Vector<D, T> {
        self.origin + self.axes * xi
    }
}
