//! Obstacles with the shape of a geometry in the plane: a curve, or the outline of areas.

use super::meshes::{in_numbers_of, mesh_code};
use super::patches::patch_fault;
use super::plane::{nurbs, placed, plane_shape};
use crate::case::{self, FilePart, Shape};
use crate::registry::Fault;
use faying::contact::{OutlineError, OutlinePiece, Surface, area_outline, curve_outline, without_seams};
use faying::geometry::ControlNet;
use faying::space::{BasisKind, Body, Mapping, Mesh, MeshCells, Patch, PatchSpec};

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
pub fn plane_outline(geometry: &case::Geometry) -> Result<Vec<OutlinePiece>, Fault> {
    let shape = &geometry.shape.value;
    let parts: Vec<&FilePart> = match shape {
        Shape::File { parts, .. } => parts.iter().map(|p| &**p).collect(),
        _ => Vec::new(),
    };
    let curves = parts.iter().filter(|p| of_one_parameter(p)).count();
    if curves > 0 && curves < parts.len() {
        return Err(Fault::new("E044", "the file holds curves and areas; select one by `id`"));
    }
    let file_fault = |e: faying_files::FileError| Fault::new(crate::codes::of_file(&e), e.to_string());
    let fault = |(code, text): (&'static str, String)| Fault::new(code, text);
    match shape {
        Shape::Nurbs { degree, knots, points, weights } if knots.len() == 1 => {
            curve(placed(nurbs(&degree.value, knots, &points.value, weights.as_ref()).map_err(fault)?, geometry))
        }
        _ if parts.is_empty() => Ok(without_seams(area(placed(plane_shape(shape).map_err(fault)?, geometry))?)),
        _ => {
            let mut all = Vec::new();
            for part in parts {
                all.extend(match part {
                    FilePart::Spline(patch) if curves > 0 => curve(placed(patch.net::<1, 2>().map_err(file_fault)?, geometry))?,
                    FilePart::Spline(patch) => area(placed(patch.net::<2, 2>().map_err(file_fault)?, geometry))?,
                    mesh => cells(mesh, geometry)?,
                });
            }
            Ok(if curves > 0 { all } else { without_seams(all) })
        }
    }
}

fn of_one_parameter(part: &FilePart) -> bool {
    part.spline().is_some_and(|p| p.dimension() == 1)
}

/// Whether a geometry is a curve, with the obstacle to its right.
pub(super) fn is_curve(geometry: &case::Geometry) -> bool {
    match &geometry.shape.value {
        Shape::Nurbs { knots, .. } => knots.len() == 1,
        Shape::File { parts, .. } => parts.iter().any(|p| of_one_parameter(p)),
        _ => false,
    }
}

/// Whether a geometry is a curve that ends where it begins.
pub(super) fn is_closed(geometry: &case::Geometry) -> bool {
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

/// Outline of an area: its boundary.
fn area(net: ControlNet<2, 2>) -> Result<Vec<OutlinePiece>, Fault> {
    // only the map is needed, which is the same for all degrees
    let mut spec = PatchSpec::new(net).with_degree([1, 1]);
    spec.basis = BasisKind::BSpline;
    let patch = Patch::<1, 2>::try_new(&spec).map_err(|e| patch_fault(&e))?;
    area_outline(&patch, patch.sides()).map_err(|e| Fault::new("E041", e.to_string()))
}

/// Outline of the cells of a mesh: their boundary.
fn cells(part: &FilePart, geometry: &case::Geometry) -> Result<Vec<OutlinePiece>, Fault> {
    let Some(found) = part.cells::<2>() else {
        return Err(Fault::new("E044", "the cells of the mesh are not of dimension 2"));
    };
    let points = super::meshes::placed_points(&found.points, geometry).map_err(|text| Fault::new("E015", text))?;
    // one side: all facets that no two cells share
    let cells = MeshCells { points, tags: Vec::new(), ..found };
    let mesh = Mesh::<1, 2>::from_cells(&cells, 1, Mapping::Exact)
        .map_err(|error| Fault::new(mesh_code(&error), in_numbers_of(part, error, 0).to_string()))?;
    area_outline(&mesh, mesh.untagged().map(str::to_owned)).map_err(|e| Fault::new("E041", e.to_string()))
}

/// Outline of the obstacle to the right of a curve.
fn curve(net: ControlNet<1, 2>) -> Result<Vec<OutlinePiece>, Fault> {
    let code = |error: &OutlineError| if matches!(error, OutlineError::Weights(_)) { "E034" } else { "E041" };
    curve_outline(net).map_err(|error| Fault::new(code(&error), error.to_string()))
}

/// Builds the obstacle with this outline.
pub(crate) fn surface(outline: &[OutlinePiece]) -> Surface {
    Surface::of_pieces(outline.to_vec(), None)
}
