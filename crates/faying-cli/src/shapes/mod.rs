//! Shapes of a case: control nets, outlines of obstacles, and points of meshes, scaled, rotated and translated as their geometry says.

mod faults;
mod given;
mod outline;
mod plane;
mod points;
mod solid;
mod solid_outline;

use crate::case::Geometry;
use crate::registry::Fault;
use faying::geometry::ControlNet;

pub(crate) use faults::mesh_fault;
pub(crate) use outline::{PLANE as PLANE_OBSTACLES, is_boundary, is_closed};
pub use plane::plane_net;
pub(crate) use points::{named_point, placed_points, point_of};
pub use solid::solid_net;
pub(crate) use solid_outline::SPACE as SPACE_OBSTACLES;

/// Builds the net of a shape with its transformations in N dimensions.
pub type MakeControlNet<const N: usize> = fn(&Geometry) -> Result<ControlNet<N, N>, Fault>;
