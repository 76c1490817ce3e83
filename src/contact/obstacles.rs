//! Rigid obstacles: half-plane, sphere, level set, and translations of them.

use super::{Hit, Obstacle};
use crate::linalg::{Real, Vector, lit};
use std::fmt::{self, Debug};

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
    fn project(&self, x: &Vector<N, T>) -> Option<Hit<D, N, T>> {
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
    fn project(&self, x: &Vector<N, T>) -> Option<Hit<D, N, T>> {
        // the centre has no closest point
        let out = unit(x - self.center)?;
        let normal = if self.inside { -out } else { out };
        let closest = self.center + out * self.radius;
        Some(Hit { x: closest, normal, gap: (x - closest).dot(&normal), at: None })
    }
}

/// The obstacle f <= 0, for f and its gradient as a function of place.
///
/// The gap is f / |grad f| along grad f, exact to second order in the distance; with `along` it is f itself along a
/// fixed direction. Where f or its gradient is no number, neither is the gap.
pub struct LevelSet<const N: usize, T: Real, F> {
    /// Value and gradient of f.
    pub function: F,
    /// A fixed unit direction of the gap.
    along: Option<Vector<N, T>>,
}

impl<const N: usize, T: Real, F: Fn(&Vector<N, T>) -> (T, Vector<N, T>) + Send + Sync> LevelSet<N, T, F> {
    /// The gap f / |grad f|.
    pub fn new(function: F) -> Self {
        Self { function, along: None }
    }

    /// The gap f along `direction` (any length); `None` if it is zero.
    pub fn try_along(function: F, direction: Vector<N, T>) -> Option<Self> {
        Some(Self { function, along: Some(unit(direction)?) })
    }
}

impl<const N: usize, T: Real, F> Debug for LevelSet<N, T, F> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("LevelSet").field("along", &self.along).finish_non_exhaustive()
    }
}

impl<const D: usize, const N: usize, T: Real, F: Fn(&Vector<N, T>) -> (T, Vector<N, T>) + Send + Sync> Obstacle<D, N, T>
    for LevelSet<N, T, F>
{
    fn project(&self, x: &Vector<N, T>) -> Option<Hit<D, N, T>> {
        let (value, gradient) = (self.function)(x);
        if !(value.is_finite() && gradient.iter().all(|g| g.is_finite())) {
            // the gap is NaN, so that the caller can report it
            let none = lit::<T>(f64::NAN);
            return Some(Hit { x: Vector::repeat(none), normal: Vector::repeat(none), gap: none, at: None });
        }
        let (gap, normal) = match self.along {
            Some(along) => (value, along),
            None => (value / gradient.norm(), unit(gradient)?),
        };
        gap.is_finite().then(|| Hit { x: x - normal * gap, normal, gap, at: None })
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
    fn project(&self, x: &Vector<N, T>) -> Option<Hit<D, N, T>> {
        let hit = self.target.project(&(x - self.by))?;
        Some(Hit { x: hit.x + self.by, ..hit })
    }
}

/// `v` normalised; `None` if it is zero or not finite.
pub(super) fn unit<const N: usize, T: Real>(v: Vector<N, T>) -> Option<Vector<N, T>> {
    let norm = v.norm();
    (norm > T::zero() && norm.is_finite()).then(|| v / norm)
}
