//! Rigid obstacles: half-plane, sphere, and translations of obstacles.

use super::{Hit, Obstacle};
use crate::geometry::Bounds;
use crate::linalg::{Real, Vector};

/// The points behind a line (2D) or plane (3D).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HalfPlane<const N: usize, T: Real = f64> {
    point: Vector<N, T>,
    normal: Vector<N, T>,
}

impl<const N: usize, T: Real> HalfPlane<N, T> {
    /// Half-plane through `point`, with `normal` out of the obstacle (any length); `None` if the normal is zero.
    pub fn try_new(point: Vector<N, T>, normal: Vector<N, T>) -> Option<Self> {
        Some(Self { point, normal: unit(normal)? })
    }
}

impl<const D: usize, const N: usize, T: Real> Obstacle<D, N, T> for HalfPlane<N, T> {
    fn project(&self, x: &Vector<N, T>, _outward: &Vector<N, T>) -> Option<Hit<D, N, T>> {
        let gap = (x - self.point).dot(&self.normal);
        Some(Hit { x: x - self.normal * gap, normal: self.normal, gap, at: None })
    }
}

/// A ball (a disc in 2D), or the space around it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere<const N: usize, T: Real = f64> {
    /// Its centre.
    pub center: Vector<N, T>,
    /// Its radius \[length\].
    pub radius: T,
    /// Whether the bodies are inside and the obstacle is the space around.
    pub inside: bool,
}

impl<const D: usize, const N: usize, T: Real> Obstacle<D, N, T> for Sphere<N, T> {
    fn project(&self, x: &Vector<N, T>, _outward: &Vector<N, T>) -> Option<Hit<D, N, T>> {
        // the centre has no closest point
        let out = unit(x - self.center)?;
        let normal = if self.inside { -out } else { out };
        let closest = self.center + out * self.radius;
        Some(Hit { x: closest, normal, gap: (x - closest).dot(&normal), at: None })
    }
    fn extent(&self) -> Option<Bounds<N, T>> {
        Some(Bounds { lo: self.center, hi: self.center }.inflated(self.radius))
    }
}

/// A translated target.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moved<X, const N: usize, T: Real = f64> {
    /// The target at rest.
    pub target: X,
    /// Its translation \[length\].
    pub by: Vector<N, T>,
}

impl<X: Obstacle<D, N, T>, const D: usize, const N: usize, T: Real> Obstacle<D, N, T> for Moved<X, N, T> {
    fn project(&self, x: &Vector<N, T>, outward: &Vector<N, T>) -> Option<Hit<D, N, T>> {
        let hit = self.target.project(&(x - self.by), outward)?;
        Some(Hit { x: hit.x + self.by, ..hit })
    }
    fn extent(&self) -> Option<Bounds<N, T>> {
        self.target.extent().map(|b| Bounds { lo: b.lo + self.by, hi: b.hi + self.by })
    }
}

/// `v` normalised; `None` if it is zero or not finite.
pub(super) fn unit<const N: usize, T: Real>(v: Vector<N, T>) -> Option<Vector<N, T>> {
    let norm = v.norm();
    (norm > T::zero() && norm.is_finite()).then(|| v / norm)
}
