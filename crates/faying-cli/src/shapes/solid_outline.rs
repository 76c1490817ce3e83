//! Obstacles with the shape of a geometry in space: surfaces, or the boundary of solids.

use super::given::nurbs;
use super::outline::{is_boundary, of_cells, of_net};
use super::solid::{placed_in_space, solid_net};
use crate::case::{FilePart, Geometry, Shape};
use crate::registry::{Fault, MakeShaped};
use faying::contact::{FacingSurface, OutlinePiece, surface_outline, without_seams};
use faying::geometry::ControlNet;
use std::sync::Arc;

/// Returns the outline of a geometry of a case in space.
///
/// A geometry of two parameters is a surface with its normal t_u x t_v out of the obstacle; where surfaces close on themselves the obstacle
/// is their inside. For solids (three parameters, cells of a mesh) it is the boundary; pieces that touch another solid are interior and left
/// out.
///
/// # Errors
/// [`Fault`] with the codes of patches: E015, E031 to E034, E041, E043, E044.
fn solid_outline(geometry: &Geometry) -> Result<Vec<OutlinePiece<2, 3>>, Fault> {
    match &geometry.shape.value {
        Shape::Nurbs { degree, knots, points, weights } if knots.len() == 2 => {
            surfaces(vec![nurbs(&degree.value, knots, &points.value, weights.as_ref())?], geometry)
        }
        Shape::File { parts, .. } if is_boundary(geometry, 3) => {
            let net = |part: &Arc<FilePart>| match part.spline() {
                Some(patch) if patch.dimension() == 2 => Ok(patch.net::<2, 3>()?),
                _ => Err(Fault::new("E044", "the file holds surfaces and solids; select one by `id`")),
            };
            surfaces(parts.iter().map(net).collect::<Result<_, _>>()?, geometry)
        }
        Shape::File { parts, .. } => {
            let mut all = Vec::new();
            for part in parts {
                all.extend(match &**part {
                    FilePart::Spline(patch) => of_net(placed_in_space(patch.net::<3, 3>()?, geometry)?)?,
                    mesh => of_cells(mesh, geometry)?,
                });
            }
            Ok(without_seams(all))
        }
        shape @ (Shape::AnnulusSector { .. } | Shape::DiscSector { .. } | Shape::PlateWithHole { .. }) => {
            let text = format!("this {} is plane, the model has dimension 3", shape.kind());
            Err(Fault::new("E044", text + "; obstacles in space are a cylinder, a box, a nurbs surface or solid, a file"))
        }
        _ => Ok(without_seams(of_net(solid_net(geometry)?)?)),
    }
}

/// Outline of the obstacle behind surfaces.
fn surfaces(nets: Vec<ControlNet<2, 3>>, geometry: &Geometry) -> Result<Vec<OutlinePiece<2, 3>>, Fault> {
    let placed: Result<Vec<_>, Fault> = nets.into_iter().map(|net| placed_in_space(net, geometry)).collect();
    Ok(surface_outline(placed?)?)
}

/// Builds obstacles from geometries in space.
pub(crate) const SPACE: MakeShaped<2, 3> = |geometry| Ok(Arc::new(FacingSurface::of_pieces(solid_outline(geometry)?)));
