//! Obstacles with the shape of a geometry in the plane: a curve, or the outline of areas.

use super::faults::mesh_fault;
use super::given::nurbs;
use super::plane::{placed_in_plane, plane_shape};
use super::points::placed_points;
use crate::case::{FilePart, Geometry, Shape};
use crate::registry::{Fault, MakeShaped};
use faying::contact::{OutlinePiece, Surface, body_outline, curve_outline, without_seams};
use faying::geometry::ControlNet;
use faying::space::{BasisKind, Body, Dimension, Mapping, Mesh, MeshCells, Patch, PatchSpec, Trace};
use std::sync::Arc;

/// Ends of a curve nearer than this share of its size are one.
const TOUCHING: f64 = 1e-8;

/// Returns the outline of a geometry of a plane case.
///
/// A geometry of one parameter is a curve with the obstacle to its right: normals are the direction of travel turned by +90 degrees. For
/// areas (two parameters, cells of a mesh) it is the boundary with outward normals; pieces that touch another area are interior and left
/// out.
///
/// # Errors
/// [`Fault`] with the codes of patches: E015, E031 to E034, E041, E043, E044.
fn plane_outline(geometry: &Geometry) -> Result<Vec<OutlinePiece>, Fault> {
    let shape = &geometry.shape.value;
    let parts: Vec<&FilePart> = match shape {
        Shape::File { parts, .. } => parts.iter().map(|p| &**p).collect(),
        _ => Vec::new(),
    };
    let curves = parts.iter().filter(|p| of_one_parameter(p)).count();
    if curves > 0 && curves < parts.len() {
        return Err(Fault::new("E044", "the file holds curves and areas; select one by `id`"));
    }
    match shape {
        Shape::Nurbs { degree, knots, points, weights } if knots.len() == 1 => {
            curve(placed_in_plane(nurbs(&degree.value, knots, &points.value, weights.as_ref())?, geometry))
        }
        _ if parts.is_empty() => Ok(without_seams(of_net(placed_in_plane(plane_shape(shape)?, geometry))?)),
        _ => {
            let mut all = Vec::new();
            for part in parts {
                all.extend(match part {
                    FilePart::Spline(patch) if curves > 0 => curve(placed_in_plane(patch.net::<1, 2>()?, geometry))?,
                    FilePart::Spline(patch) => of_net(placed_in_plane(patch.net::<2, 2>()?, geometry))?,
                    mesh => of_cells(mesh, geometry)?,
                });
            }
            Ok(if curves > 0 { all } else { without_seams(all) })
        }
    }
}

fn of_one_parameter(part: &FilePart) -> bool {
    part.spline().is_some_and(|p| p.dimension() == 1)
}

/// Whether a geometry has one parameter less than the space of `n` dimensions: a curve with the obstacle to its right, a surface with the
/// obstacle behind it.
pub(crate) fn is_boundary(geometry: &Geometry, n: usize) -> bool {
    match &geometry.shape.value {
        Shape::Nurbs { knots, .. } => knots.len() + 1 == n,
        Shape::File { parts, .. } => parts.iter().any(|p| p.spline().is_some_and(|p| p.dimension() + 1 == n)),
        _ => false,
    }
}

/// Whether a geometry is a curve that ends where it begins.
pub(crate) fn is_closed(geometry: &Geometry) -> bool {
    match &geometry.shape.value {
        Shape::Nurbs { knots, points, .. } if knots.len() == 1 => {
            let distance = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt();
            let Some((first, rest)) = points.value.split_first() else { return false };
            let size = rest.iter().map(|p| distance(first, p)).fold(0.0, f64::max);
            rest.last().is_some_and(|last| distance(first, last) <= TOUCHING * size)
        }
        _ => false,
    }
}

/// Outline of an area or a solid: its boundary.
pub(super) fn of_net<const S: usize, const N: usize>(net: ControlNet<N, N>) -> Result<Vec<OutlinePiece<S, N>>, Fault>
where
    Trace<S, N>: Dimension<S, N>,
{
    // only the map is needed, which is the same for all degrees
    let mut spec = PatchSpec::new(net).with_degree([1; N]);
    spec.basis = BasisKind::BSpline;
    let patch = Patch::<S, N>::try_new(&spec)?;
    body_outline(&patch, patch.sides()).map_err(|e| Fault::new("E041", e.to_string()))
}

/// Outline of the cells of a mesh: their boundary.
pub(super) fn of_cells<const S: usize, const N: usize>(part: &FilePart, geometry: &Geometry) -> Result<Vec<OutlinePiece<S, N>>, Fault>
where
    Trace<S, N>: Dimension<S, N>,
{
    let Some(found) = part.cells::<N>() else {
        return Err(Fault::new("E044", format!("the cells of the mesh are not of dimension {N}")));
    };
    let points = placed_points(&found.points, geometry).map_err(|text| Fault::new("E015", text))?;
    // one side: all facets that no two cells share
    let cells = MeshCells { points, tags: Vec::new(), ..found };
    let mesh = Mesh::<S, N>::from_cells(&cells, 1, Mapping::Exact).map_err(|error| mesh_fault(error, Some(part), 0))?;
    body_outline(&mesh, mesh.untagged().map(str::to_owned)).map_err(|e| Fault::new("E041", e.to_string()))
}

/// Outline of the obstacle to the right of a curve.
fn curve(net: ControlNet<1, 2>) -> Result<Vec<OutlinePiece>, Fault> {
    Ok(curve_outline(net)?)
}

/// Builds obstacles from geometries in the plane.
pub(crate) const PLANE: MakeShaped<1, 2> = |geometry| Ok(Arc::new(Surface::of_pieces(plane_outline(geometry)?, None)));
