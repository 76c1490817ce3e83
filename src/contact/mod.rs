//! Floor 10: contact kinematics (gaps, normals, rigid obstacles, half-width) and multiplier cones. Names no basis type.

mod cone;
mod curves;
mod frames;
mod gap;
mod greville;
pub mod nitsche;
mod obstacles;
mod pressed;
mod pressure;
mod surface;
mod tail;
mod width;

use crate::linalg::{Real, Vector};
use std::fmt::Debug;

pub use cone::{Cone, MOST_FUNCTIONS};
pub use frames::Frames;
pub use gap::{Contact, ContactError, Opponent};
pub use greville::greville_points;
pub use nitsche::{AtPoints, PointValues, point_values};
pub use obstacles::{HalfPlane, LevelSet, Moved, Sphere};
pub use pressure::Transmitted;
pub use surface::{OutlinePiece, Surface, pieces};
pub use width::{ClosedSide, NoHalfWidth, half_width};

/// Position of a point on a surface: element and local coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Location<const D: usize, T: Real = f64> {
    /// The element.
    pub element: usize,
    /// Local coordinates in it.
    pub xi: Vector<D, T>,
}

/// The closest point of an obstacle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit<const D: usize, const N: usize, T: Real = f64> {
    /// The closest point.
    pub x: Vector<N, T>,
    /// Unit normal there, out of the obstacle.
    pub normal: Vector<N, T>,
    /// (point - x) . normal \[length\], positive when open.
    pub gap: T,
    /// Position on a meshed obstacle; `None` on an analytic one.
    pub at: Option<Location<D, T>>,
}

/// An obstacle. (D, N) stands for (N - 1, N).
pub trait Obstacle<const D: usize, const N: usize, T: Real = f64>: Debug + Send + Sync {
    /// Closest point to `x`; `None` if the target does not face it.
    fn project(&self, x: &Vector<N, T>) -> Option<Hit<D, N, T>>;
}

impl<const D: usize, const N: usize, T: Real, X: Obstacle<D, N, T> + ?Sized> Obstacle<D, N, T> for Box<X> {
    fn project(&self, x: &Vector<N, T>) -> Option<Hit<D, N, T>> {
        (**self).project(x)
    }
}

impl<const D: usize, const N: usize, T: Real, X: Obstacle<D, N, T> + ?Sized> Obstacle<D, N, T> for std::sync::Arc<X> {
    fn project(&self, x: &Vector<N, T>) -> Option<Hit<D, N, T>> {
        (**self).project(x)
    }
}
