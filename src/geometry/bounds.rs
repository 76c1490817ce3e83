//! Axis-aligned boxes.

use crate::linalg::{Real, Vector, lit};

/// The box `lo <= x <= hi`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds<const N: usize, T: Real = f64> {
    /// Least coordinates.
    pub lo: Vector<N, T>,
    /// Largest coordinates.
    pub hi: Vector<N, T>,
}

impl<const N: usize, T: Real> Bounds<N, T> {
    /// The smallest box around `points`; `None` without points.
    pub fn around(points: &[Vector<N, T>]) -> Option<Self> {
        let first = *points.first()?;
        Some(points.iter().fold(Self { lo: first, hi: first }, |b, p| b.union(&Self { lo: *p, hi: *p })))
    }

    /// The smallest box around both.
    pub fn union(&self, other: &Self) -> Self {
        Self { lo: self.lo.zip_map(&other.lo, |a, b| a.min(b)), hi: self.hi.zip_map(&other.hi, |a, b| a.max(b)) }
    }

    /// The box grown by `margin` \[length\] on every side.
    pub fn inflated(&self, margin: T) -> Self {
        Self { lo: self.lo.add_scalar(-margin), hi: self.hi.add_scalar(margin) }
    }

    /// The middle of the box.
    pub fn center(&self) -> Vector<N, T> {
        (self.lo + self.hi) * lit::<T>(0.5)
    }

    /// Length of the diagonal.
    pub fn diagonal(&self) -> T {
        (self.hi - self.lo).norm()
    }

    /// Whether `other` lies within this box.
    pub fn holds(&self, other: &Self) -> bool {
        (0..N).all(|k| self.lo[k] <= other.lo[k] && other.hi[k] <= self.hi[k])
    }

    /// Whether the boxes share a point.
    pub fn meets(&self, other: &Self) -> bool {
        (0..N).all(|k| self.lo[k] <= other.hi[k] && other.lo[k] <= self.hi[k])
    }

    /// Distance of `x` to the box, zero inside.
    pub fn distance(&self, x: &Vector<N, T>) -> T {
        let outside = Vector::<N, T>::from_fn(|k, _| (self.lo[k] - x[k]).max(x[k] - self.hi[k]).max(T::zero()));
        outside.norm()
    }
}
