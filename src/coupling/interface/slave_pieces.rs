//! The pieces of one slave element, and their list in the order of slave elements.

use super::pairing::{Worst, place_of};
use super::{Coverage, Segments};
use crate::basis::Elements;
use crate::coupling::CouplingError;
use crate::linalg::{Real, Vector};

/// A point of a piece: slave xi, master xi, ds.
pub(super) type Point<const D: usize, T> = (Vector<D, T>, Vector<D, T>, T);

/// The pieces of one slave element.
#[derive(Debug)]
pub(super) struct SlavePieces<const D: usize, T: Real> {
    pub element: usize,
    /// Master element and points of each piece.
    pub pieces: Vec<(usize, Vec<Point<D, T>>)>,
    pub measure: T,
    pub covered: T,
    /// Whether the pieces tile the element in its local coordinates; else its share is that of measures.
    pub whole: bool,
    /// Share of the element that the pieces cover, in local coordinates, where they should tile it and do not.
    pub lost: Option<f64>,
    pub worst: Worst<T>,
    pub farthest: (T, [f64; 3]),
}

impl<const D: usize, T: Real> SlavePieces<D, T> {
    pub fn new(element: usize) -> Self {
        let farthest = (T::zero(), [0.0; 3]);
        let (measure, covered) = (T::zero(), T::zero());
        Self { element, pieces: Vec::new(), measure, covered, whole: false, lost: None, worst: Worst::none(), farthest }
    }

    /// Records the distance of a pair of partners.
    pub fn see<const N: usize>(&mut self, x: &Vector<N, T>, distance: T, allowed: T) {
        let ratio = distance / allowed.max(T::default_epsilon());
        if distance > self.farthest.0 {
            self.farthest = (distance, place_of(x));
        }
        if ratio > self.worst.ratio {
            self.worst = Worst { distance, at: place_of(x), allowed, ratio };
        }
    }

    fn share(&self) -> T {
        if self.whole {
            T::one()
        } else if self.measure > T::zero() {
            (self.covered / self.measure).min(T::one())
        } else {
            T::zero()
        }
    }
}

/// Joins the parts into one list in the order of slave elements, with its coverage; checks distances and tiling of touching sides.
pub(super) fn join<const D: usize, T: Real>(
    parts: Vec<SlavePieces<D, T>>,
    master: &dyn Elements,
    touching: bool,
) -> Result<Segments<D, T>, CouplingError> {
    let (pieces, points) = parts.iter().flat_map(|part| &part.pieces).fold((0, 0), |(n, q), piece| (n + 1, q + piece.1.len()));
    let mut out = Segments::with_capacity(pieces, points);
    let (mut report, mut worst, mut lost) = (Coverage::default(), Worst::none(), None);
    for part in parts {
        report.slave_measure += part.measure;
        report.covered += part.covered;
        report.share.push(part.share());
        if let Some(share) = part.lost {
            report.lost.push(part.element);
            lost = lost.or(Some(CouplingError::Lost { element: part.element, share }));
        }
        for (master, points) in part.pieces {
            out.push_piece(part.element, master, points);
        }
        if part.farthest.0 > report.distance {
            (report.distance, report.at) = part.farthest;
        }
        if part.worst.ratio > worst.ratio {
            worst = part.worst;
        }
    }
    if touching {
        if let Some(error) = worst.error().or(lost) {
            return Err(error);
        }
        if out.num_pieces() == 0 {
            return Err(CouplingError::NothingFaces);
        }
    }
    out.report = report;
    out.count(master);
    Ok(out)
}
