//! Nets of the shapes of plane cases.

use super::given::{coordinates, nurbs, placed};
use crate::case::{FilePart, Geometry, Shape};
use crate::registry::Fault;
use faying::geometry::{ControlNet, shapes, turn};

/// The net of a plane shape, without transformations.
pub(super) fn plane_shape(shape: &Shape) -> Result<ControlNet<2, 2>, Fault> {
    Ok(match shape {
        Shape::Box { min, max } => shapes::rectangle(coordinates(&min.value), coordinates(&max.value))?,
        Shape::AnnulusSector { center, radius, angle_deg } => {
            shapes::annulus_sector(coordinates(&center.value), radius.value, angle_deg.value)?
        }
        Shape::DiscSector { center, radius, angle_deg } => shapes::disc_sector(coordinates(&center.value), radius.value, angle_deg.value)?,
        Shape::PlateWithHole { radius, half_width } => shapes::plate_with_hole(radius.value, half_width.value)?,
        Shape::Nurbs { degree, knots, points, weights } => nurbs(&degree.value, knots, &points.value, weights.as_ref())?,
        Shape::SphereOctant { .. } => {
            return Err(Fault::new("E044", "a sphere-octant is a body of three dimensions, the model has two"));
        }
        Shape::File { .. } => match shape.part().and_then(FilePart::spline) {
            Some(patch) => patch.net::<2, 2>()?,
            None => return Err(Fault::new("E043", "the file gave no spline patch")),
        },
    })
}

/// Builds the net of a plane shape with its transformations.
///
/// # Errors
/// E015 for numbers out of range, E031 to E034 for nets, E043 for files without a patch, E044 for shapes of three dimensions.
pub fn plane_net(geometry: &Geometry) -> Result<ControlNet<2, 2>, Fault> {
    let net = plane_shape(&geometry.shape.value)?;
    if geometry.extrude.is_some() {
        return Err(Fault::new("E044", "`extrude` makes a body of three dimensions, the model has two"));
    }
    Ok(placed_in_plane(net, geometry))
}

/// Scales, rotates and translates a net in the plane as `geometry` says.
pub(super) fn placed_in_plane<const D: usize>(net: ControlNet<D, 2>, geometry: &Geometry) -> ControlNet<D, 2> {
    placed(net, geometry, geometry.rotate_deg.as_ref().map(|degrees| turn(degrees.value)))
}
