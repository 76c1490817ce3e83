//! Segments: the same physical points seen from one slave and one master element, with weights.

use super::CouplingError;
use crate::geometry::Geometry;
use crate::linalg::{Real, Vector};
use std::fmt::Debug;

/// How well a list of segments covers the slave side.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Coverage<T: Real = f64> {
    /// Measure of the slave side [length^D].
    pub slave_measure: T,
    /// Measure of its part that faces the master.
    pub covered: T,
    /// Largest distance between partner points \[length\].
    pub distance: T,
    /// Where that distance was found.
    pub at: [f64; 3],
    /// Covered share per slave element, 0 to 1.
    pub share: Vec<T>,
}

/// Pairs of local points of the same physical points, with weights.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Segments<const D: usize, T: Real = f64> {
    /// Slave element of each piece.
    pub slave: Vec<usize>,
    /// Master element of each piece.
    pub master: Vec<usize>,
    /// Piece k owns the points `start[k]..start[k + 1]`.
    pub start: Vec<usize>,
    /// Local coordinates on the slave element, per point.
    pub slave_xi: Vec<Vector<D, T>>,
    /// Local coordinates on the master element, per point; never clamped to the cell.
    pub master_xi: Vec<Vector<D, T>>,
    /// Physical weight of the point [length^D].
    pub ds: Vec<T>,
    /// How well the slave side is covered.
    pub report: Coverage<T>,
}

/// Makes the list of segments of two sides. Slave, mixed and merged integration differ only here.
pub trait InterfaceQuadrature<const D: usize, const N: usize, T: Real = f64>: Debug + Send + Sync {
    /// The segments of `slave` against `master`, in order of slave elements.
    ///
    /// # Errors
    /// [`CouplingError`] where no segments can be made.
    fn segments(&self, slave: &dyn Geometry<D, N, T>, master: &dyn Geometry<D, N, T>) -> Result<Segments<D, T>, CouplingError>;
}
