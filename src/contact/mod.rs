//! Floor 10: contact kinematics (gaps, normals, rigid obstacles, half-width) and multiplier cones. Names no basis type.

mod cone;
mod cylinder;
mod depth;
mod edges;
mod facing_surface;
mod frames;
mod gap;
mod greville;
mod half_width;
mod level_set;
mod line_zero;
mod method;
mod normal_cone;
mod obstacles;
mod outline;
mod pressed;
mod pressure;
mod rims;
mod several;
mod surface;
mod surface_feet;
mod surface_outline;
mod tail;
mod torus;

use crate::geometry::Bounds;
use crate::linalg::{Real, Vector};
use std::fmt::Debug;

pub use crate::geometry::opposes;
pub use cone::{Cone, MOST_FUNCTIONS};
pub use cylinder::Cylinder;
pub use facing_surface::FacingSurface;
pub use frames::ContactKinematics;
pub use gap::{ContactError, ContactRows, Opponent, RowsAt};
pub use greville::greville_points;
pub use half_width::{ClosedSide, NoHalfWidth, SideEnd, half_width};
pub use level_set::LevelSet;
pub use method::{Augmented, Begun, ContactAt, ContactMethod, Lagrange, MethodError, Needs, PointValues, Translation};
pub use obstacles::{HalfPlane, Moved, Sphere};
pub use outline::{OutlineError, OutlinePiece, body_outline, curve_outline, pieces, without_seams};
pub use pressure::ContactResultants;
pub use rims::points_at_rims;
pub use surface::Surface;
pub use surface_outline::surface_outline;
pub use torus::Torus;

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
    /// Closest point to `x` among what opposes `outward`, the unit normal of the slave at `x` out of its body: normals of the obstacle
    /// deviate from its reverse by at most 60 degrees ([`opposes`]). `None` where nothing opposes it.
    ///
    /// Obstacles with one closest point may ignore `outward`: hits that do not oppose it are dropped ([`opposed`]).
    fn project(&self, x: &Vector<N, T>, outward: &Vector<N, T>) -> Option<Hit<D, N, T>>;

    /// A box that holds the whole obstacle: small ones are searched for within elements. `None` if it has no end, or the box is not known.
    fn extent(&self) -> Option<Bounds<N, T>> {
        None
    }
}

/// The hit of `obstacle` for a slave point with the normal `outward`, if it opposes that; a gap that is no number is kept, to be reported.
pub fn opposed<const D: usize, const N: usize, T: Real>(
    obstacle: &dyn Obstacle<D, N, T>,
    x: &Vector<N, T>,
    outward: &Vector<N, T>,
) -> Option<Hit<D, N, T>> {
    obstacle.project(x, outward).filter(|hit| opposes(outward, &hit.normal) || !hit.gap.is_finite())
}

impl<const D: usize, const N: usize, T: Real, X: Obstacle<D, N, T> + ?Sized> Obstacle<D, N, T> for Box<X> {
    fn project(&self, x: &Vector<N, T>, outward: &Vector<N, T>) -> Option<Hit<D, N, T>> {
        (**self).project(x, outward)
    }
    fn extent(&self) -> Option<Bounds<N, T>> {
        (**self).extent()
    }
}

impl<const D: usize, const N: usize, T: Real, X: Obstacle<D, N, T> + ?Sized> Obstacle<D, N, T> for std::sync::Arc<X> {
    fn project(&self, x: &Vector<N, T>, outward: &Vector<N, T>) -> Option<Hit<D, N, T>> {
        (**self).project(x, outward)
    }
    fn extent(&self) -> Option<Bounds<N, T>> {
        (**self).extent()
    }
}
