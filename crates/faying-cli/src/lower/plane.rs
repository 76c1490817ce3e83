//! Nets of the shapes of plane cases.

use crate::case::{FilePart, Geometry, Shape};
use crate::place::Located;
use faying::geometry::{ControlNet, NetError, shapes, turn};
use faying::linalg::Vector;

/// The first numbers of a list as coordinates; missing ones are zero.
pub(super) fn coordinates<const N: usize>(list: &[f64]) -> [f64; N] {
    std::array::from_fn(|k| list.get(k).copied().unwrap_or(0.0))
}

/// The net of D parameters in N dimensions that a case gives by its numbers.
pub(super) fn nurbs<const D: usize, const N: usize>(
    degree: &[usize],
    knots: &[Located<Vec<f64>>],
    points: &[Vec<f64>],
    weights: Option<&Located<Vec<f64>>>,
) -> Result<ControlNet<D, N>, (&'static str, String)> {
    let degree = std::array::from_fn(|k| degree.get(k).copied().unwrap_or(1));
    let knots = std::array::from_fn(|k| knots.get(k).map(|list| list.value.clone()).unwrap_or_default());
    let points = points.iter().map(|x| Vector::from(coordinates(x))).collect();
    ControlNet::from_knots(degree, knots, points, weights.map(|w| w.value.clone())).map_err(net_fault)
}

/// Error code of an unusable net.
fn code(error: &NetError) -> &'static str {
    match error {
        NetError::Weights(_) => "E034",
        NetError::Counts { .. } => "E033",
        _ => "E031",
    }
}

/// Error code and message of an invalid shape.
pub(super) fn shape_fault(error: shapes::ShapeError) -> (&'static str, String) {
    match &error {
        shapes::ShapeError::Net(inner) => (code(inner), error.to_string()),
        _ => ("E015", error.to_string()),
    }
}

/// Error code and message of an invalid net.
fn net_fault(error: NetError) -> (&'static str, String) {
    (code(&error), error.to_string())
}

/// The net of a plane shape, without transformations.
pub(super) fn plane_shape(shape: &Shape) -> Result<ControlNet<2, 2>, (&'static str, String)> {
    match shape {
        Shape::Box { min, max } => shapes::rectangle(coordinates(&min.value), coordinates(&max.value)).map_err(shape_fault),
        Shape::AnnulusSector { center, radius, angle_deg } => {
            shapes::annulus_sector(coordinates(&center.value), radius.value, angle_deg.value).map_err(shape_fault)
        }
        Shape::DiscSector { center, radius, angle_deg } => {
            shapes::disc_sector(coordinates(&center.value), radius.value, angle_deg.value).map_err(shape_fault)
        }
        Shape::PlateWithHole { radius, half_width } => shapes::plate_with_hole(radius.value, half_width.value).map_err(shape_fault),
        Shape::Nurbs { degree, knots, points, weights } => nurbs(&degree.value, knots, &points.value, weights.as_ref()),
        Shape::SphereOctant { .. } => Err(("E044", "a sphere-octant is a body of three dimensions, the model has two".into())),
        Shape::File { .. } => match shape.part().and_then(FilePart::spline) {
            Some(patch) => patch.net::<2, 2>().map_err(|e| (crate::codes::of_file(&e), e.to_string())),
            None => Err(("E043", "the file gave no spline patch".into())),
        },
        #[allow(unreachable_patterns)] // the enum may grow
        other => Err(("E019", format!("the kind \"{}\" in the plane is not in this version", other.kind()))),
    }
}

/// Builds the net of a plane shape with its transformations; an error is a code and a message.
///
/// # Errors
/// E015 for numbers out of range, E019 for shapes that are not in this version, E031 to E034 for nets, E044 for shapes of
/// three dimensions.
pub fn plane_net(geometry: &Geometry) -> Result<ControlNet<2, 2>, (&'static str, String)> {
    let net = plane_shape(&geometry.shape.value)?;
    if geometry.extrude.is_some() {
        return Err(("E044", "`extrude` makes a body of three dimensions, the model has two".into()));
    }
    Ok(placed(net, geometry))
}

/// Scales, rotates and translates a net as `geometry` says.
pub(super) fn placed<const D: usize>(mut net: ControlNet<D, 2>, geometry: &Geometry) -> ControlNet<D, 2> {
    if let Some(factor) = &geometry.scale {
        net = net.scale(factor.value);
    }
    if let Some(degrees) = &geometry.rotate_deg {
        net = net.rotate(&turn(degrees.value));
    }
    if let Some(by) = &geometry.translate {
        net = net.translate(&Vector::from(coordinates(&by.value)));
    }
    net
}
