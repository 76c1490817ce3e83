//! Segments: quadrature points of an interface in local coordinates of one slave and one master element, with weights.

mod chain;
mod cuts;
mod master_sums;
mod merged_curve;
mod pairing;
mod revolution;
mod slave;
mod slave_pieces;
mod surface;
mod verified;

use super::CouplingError;
use crate::basis::Elements;
use crate::geometry::{Geometry, cell};
use crate::linalg::{Real, Vector};
use std::fmt::Debug;
use std::ops::Range;

pub use chain::{Chain, Vertex};
pub use master_sums::MasterSums;
pub use merged_curve::MergedCurve;
pub use pairing::{MasterCurve, Partner, Partners, Tolerance, crossing};
pub use slave::{SlaveRule, slave_segments};
pub use surface::{MasterSurfaceSums, MergedSurface, SlaveSurface};

/// Coverage of the slave side by a list of segments.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Coverage<T: Real = f64> {
    /// Measure of the slave side \[length^D\].
    pub slave_measure: T,
    /// Measure of its part that faces the master.
    pub covered: T,
    /// Largest distance between partner points \[length\].
    pub distance: T,
    /// Position of that pair; coordinates beyond the dimension are zero.
    pub at: [f64; 3],
    /// Covered share per slave element, 0 to 1.
    pub share: Vec<T>,
    /// Largest distance of a point from the cell of its master element, in local coordinates.
    pub outside: T,
    /// Slave elements whose pieces leave a part uncovered, or cover it twice, where the master does not end.
    pub lost: Vec<usize>,
    /// Number of pieces.
    pub pieces: usize,
}

impl<T: Real> Default for Coverage<T> {
    fn default() -> Self {
        Self {
            slave_measure: T::zero(),
            covered: T::zero(),
            distance: T::zero(),
            at: [0.0; 3],
            share: Vec::new(),
            outside: T::zero(),
            lost: Vec::new(),
            pieces: 0,
        }
    }
}

/// Pairs of slave and master local points (partners) with weights.
#[derive(Clone, Debug, PartialEq)]
pub struct Segments<const D: usize, T: Real = f64> {
    /// Slave element of each piece.
    pub slave: Vec<usize>,
    /// Master element of each piece.
    pub master: Vec<usize>,
    /// Piece k has the points `start[k]..start[k + 1]`.
    pub start: Vec<usize>,
    /// Local coordinates on the slave element, per point.
    pub slave_xi: Vec<Vector<D, T>>,
    /// Local coordinates on the master element, per point; never clamped to the cell.
    pub master_xi: Vec<Vector<D, T>>,
    /// Physical weight of the point \[length^D\].
    pub ds: Vec<T>,
    /// Coverage of the slave side.
    pub report: Coverage<T>,
}

impl<const D: usize, T: Real> Default for Segments<D, T> {
    fn default() -> Self {
        Self {
            slave: Vec::new(),
            master: Vec::new(),
            start: vec![0],
            slave_xi: Vec::new(),
            master_xi: Vec::new(),
            ds: Vec::new(),
            report: Coverage::default(),
        }
    }
}

impl<const D: usize, T: Real> Segments<D, T> {
    /// Creates an empty list with an empty report.
    pub fn new() -> Self {
        Self::default()
    }

    /// An empty list with room for pieces and points.
    fn with_capacity(pieces: usize, points: usize) -> Self {
        let mut out = Self::new();
        out.slave.reserve(pieces);
        out.master.reserve(pieces);
        out.start.reserve(pieces);
        out.slave_xi.reserve(points);
        out.master_xi.reserve(points);
        out.ds.reserve(points);
        out
    }

    /// Number of pieces.
    pub fn num_pieces(&self) -> usize {
        self.slave.len()
    }

    /// Points of `piece`.
    pub fn points(&self, piece: usize) -> Range<usize> {
        self.start[piece]..self.start[piece + 1]
    }

    /// Appends a piece with points (slave xi, master xi, ds).
    pub fn push_piece(&mut self, slave: usize, master: usize, points: impl IntoIterator<Item = (Vector<D, T>, Vector<D, T>, T)>) {
        self.slave.push(slave);
        self.master.push(master);
        for (a, b, ds) in points {
            self.slave_xi.push(a);
            self.master_xi.push(b);
            self.ds.push(ds);
        }
        self.start.push(self.ds.len());
    }

    /// Runs of consecutive pieces that share their slave element.
    pub fn runs(&self) -> Vec<Range<usize>> {
        let mut runs: Vec<Range<usize>> = Vec::new();
        for piece in 0..self.num_pieces() {
            match runs.last_mut() {
                Some(run) if self.slave[run.start] == self.slave[piece] => run.end = piece + 1,
                _ => runs.push(piece..piece + 1),
            }
        }
        runs
    }

    /// Exchanges slave and master: for mixed integration, with segments made by the master's rule.
    #[must_use]
    pub fn swapped(self) -> Self {
        Self { slave: self.master, master: self.slave, slave_xi: self.master_xi, master_xi: self.slave_xi, ..self }
    }

    /// Reports the number of pieces and how far points lie outside of the cells of `master`.
    pub(super) fn count(&mut self, master: &dyn Elements) {
        self.report.pieces = self.num_pieces();
        self.report.outside = T::zero();
        for piece in 0..self.num_pieces() {
            let kind = master.cell(self.master[piece]);
            for q in self.points(piece) {
                self.report.outside = self.report.outside.max(cell::outside(kind, &self.master_xi[q]));
            }
        }
    }

    /// Measure of all pieces \[length^D\].
    pub fn measure(&self) -> T {
        self.ds.iter().fold(T::zero(), |s, &ds| s + ds)
    }
}

/// Builds the list of segments of two sides. Slave, mixed and merged integration differ only here.
pub trait InterfaceQuadrature<const D: usize, const N: usize, T: Real = f64>: Debug + Send + Sync {
    /// Builds the segments of `slave` against `master`, in order of slave elements.
    ///
    /// # Errors
    /// [`CouplingError`] where no segments can be built.
    fn segments(&self, slave: &dyn Geometry<D, N, T>, master: &dyn Geometry<D, N, T>) -> Result<Segments<D, T>, CouplingError>;
}

impl<const D: usize, const N: usize, T: Real, X: InterfaceQuadrature<D, N, T> + ?Sized> InterfaceQuadrature<D, N, T> for Box<X> {
    fn segments(&self, slave: &dyn Geometry<D, N, T>, master: &dyn Geometry<D, N, T>) -> Result<Segments<D, T>, CouplingError> {
        (**self).segments(slave, master)
    }
}
