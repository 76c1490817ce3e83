//! The best point of a search for the closest one.

use super::closest::Sample;
use crate::linalg::{Real, Vector};

/// The best point so far.
pub(super) struct Best<const D: usize, const N: usize, T: Real> {
    pub element: usize,
    pub xi: Vector<D, T>,
    pub x: Vector<N, T>,
    pub distance: T,
    pub found: bool,
    /// The sample that it is, of a curve.
    pub sample: Option<Sample<N, T>>,
}

impl<const D: usize, const N: usize, T: Real> Best<D, N, T> {
    pub fn offer(&mut self, element: usize, xi: Vector<D, T>, x: Vector<N, T>, distance: T) {
        if distance < self.distance {
            *self = Self { element, xi, x, distance, found: true, sample: None };
        }
    }

    pub fn offer_sample(&mut self, element: usize, sample: &Sample<N, T>, p: &Vector<N, T>) {
        let distance = (sample.x - p).norm();
        if distance < self.distance {
            *self = Self { element, xi: Vector::repeat(sample.t), x: sample.x, distance, found: true, sample: Some(*sample) };
        }
    }
}
