//! Nets of the shapes of cases in space: solids, and plane shapes that are extruded.

use super::plane::{coordinates, nurbs, plane_shape, shape_fault};
use crate::case::{FilePart, Geometry, Shape};
use faying::geometry::{ControlNet, shapes, turn_about};
use faying::linalg::Vector;

/// Builds the net of a solid, without transformations; `None` for plane shapes.
fn solid(shape: &Shape) -> Option<Result<ControlNet<3, 3>, (&'static str, String)>> {
    Some(match shape {
        Shape::Box { min, max } if min.value.len() == 3 => {
            shapes::brick(coordinates(&min.value), coordinates(&max.value)).map_err(shape_fault)
        }
        Shape::SphereOctant { center, radius } => shapes::sphere_octant(coordinates(&center.value), radius.value).map_err(shape_fault),
        Shape::Nurbs { degree, knots, points, weights } if knots.len() == 3 => nurbs(&degree.value, knots, &points.value, weights.as_ref()),
        Shape::File { .. } => match shape.part().and_then(FilePart::spline) {
            Some(patch) if patch.dimension() == 3 => patch.net::<3, 3>().map_err(|e| (crate::codes::of_file(&e), e.to_string())),
            _ => return None,
        },
        _ => return None,
    })
}

/// Builds the net of a shape in space with its transformations: extrude, scale, rotate, translate in this order; an error is a code and a
/// message.
///
/// # Errors
/// E015 for numbers out of range, E019 for shapes that are not in this version, E031 to E034 for nets, E044 for a plane
/// shape that is not extruded and a solid that is.
pub fn volume_net(geometry: &Geometry) -> Result<ControlNet<3, 3>, (&'static str, String)> {
    let shape = &geometry.shape.value;
    let kind = shape.kind();
    let mut net = match (solid(shape), &geometry.extrude) {
        (Some(net), None) => net?,
        (Some(_), Some(_)) => return Err(("E044", format!("`extrude` makes solids of plane shapes, this {kind} is a solid already"))),
        (None, Some(height)) => plane_shape(shape)?.extrude(height.value),
        (None, None) => {
            return Err((
                "E044",
                format!("this {kind} is plane, the model has dimension 3; add extrude = h for a solid of height h along z"),
            ));
        }
    };
    if let Some(factor) = &geometry.scale {
        net = net.scale(factor.value);
    }
    if let Some(degrees) = &geometry.rotate_deg {
        let axis = geometry.axis.as_ref().map_or([0.0, 0.0, 1.0], |a| coordinates(&a.value));
        let turn = turn_about(&Vector::from(axis), degrees.value);
        net = net.rotate(&turn.ok_or_else(|| ("E015", "`axis` of a rotation must not be zero".to_string()))?);
    }
    if let Some(by) = &geometry.translate {
        net = net.translate(&Vector::from(coordinates(&by.value)));
    }
    Ok(net)
}
