//! Nets of the shapes of cases in space: solids, and plane shapes that are extruded.

use super::given::{coordinates, nurbs, placed};
use super::plane::plane_shape;
use crate::case::{FilePart, Geometry, Shape};
use crate::registry::Fault;
use faying::geometry::{ControlNet, shapes, turn_about};
use faying::linalg::Vector;

/// Builds the net of a solid, without transformations; `None` for plane shapes.
fn solid(shape: &Shape) -> Result<Option<ControlNet<3, 3>>, Fault> {
    Ok(Some(match shape {
        Shape::Box { min, max } if min.value.len() == 3 => shapes::brick(coordinates(&min.value), coordinates(&max.value))?,
        Shape::SphereOctant { center, radius } => shapes::sphere_octant(coordinates(&center.value), radius.value)?,
        Shape::Nurbs { degree, knots, points, weights } if knots.len() == 3 => {
            nurbs(&degree.value, knots, &points.value, weights.as_ref())?
        }
        Shape::File { .. } => match shape.part().and_then(FilePart::spline) {
            Some(patch) if patch.dimension() == 3 => patch.net::<3, 3>()?,
            _ => return Ok(None),
        },
        _ => return Ok(None),
    }))
}

/// Builds the net of a shape in space with its transformations: extrude, scale, rotate, translate in this order.
///
/// # Errors
/// E015 for numbers out of range, E031 to E034 for nets, E043 for files without a patch, E044 for a plane shape that is not extruded and a
/// solid that is.
pub fn solid_net(geometry: &Geometry) -> Result<ControlNet<3, 3>, Fault> {
    let shape = &geometry.shape.value;
    let kind = shape.kind();
    let net = match (solid(shape), &geometry.extrude) {
        (Ok(None), Some(height)) => plane_shape(shape)?.extrude(height.value),
        (Ok(None), None) => {
            let text = format!("this {kind} is plane, the model has dimension 3; add extrude = h for a solid of height h along z");
            return Err(Fault::new("E044", text));
        }
        (_, Some(_)) => return Err(Fault::new("E044", format!("`extrude` makes solids of plane shapes, this {kind} is a solid already"))),
        (Ok(Some(net)), None) => net,
        (Err(fault), None) => return Err(fault),
    };
    placed_in_space(net, geometry)
}

/// Scales, rotates and translates a net in space as `geometry` says.
///
/// # Errors
/// E015 for a rotation without an axis.
pub(super) fn placed_in_space<const D: usize>(net: ControlNet<D, 3>, geometry: &Geometry) -> Result<ControlNet<D, 3>, Fault> {
    let turn = match &geometry.rotate_deg {
        None => None,
        Some(degrees) => {
            let axis = geometry.axis.as_ref().map_or([0.0, 0.0, 1.0], |a| coordinates(&a.value));
            let turn = turn_about(&Vector::from(axis), degrees.value);
            Some(turn.ok_or_else(|| Fault::new("E015", "`axis` of a rotation must not be zero"))?)
        }
    };
    Ok(placed(net, geometry, turn))
}
