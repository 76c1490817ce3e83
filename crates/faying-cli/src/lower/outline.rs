//! Obstacles with the shape of a geometry in the plane: a curve, or the outline of areas.

use super::meshes::{in_numbers_of, mesh_code};
use super::patches::patch_fault;
use super::plane::{net_fault, placed, plane_shape};
use crate::case::{self, FilePart, Shape};
use crate::registry::Fault;
use faying::basis::{Elements, Order, Rational};
use faying::contact::{OutlinePiece, Surface, pieces};
use faying::geometry::{Bounds, ClosestPoint, ControlNet, ControlPoints, Geometry, MapTable, Tree, unit_normal};
use faying::linalg::Vector;
use faying::space::{BasisKind, Body, Mapping, Mesh, MeshCells, Patch, PatchSpec};
use std::sync::Arc;

/// Pieces nearer than this share of the outline's size touch.
const TOUCHING: f64 = 1e-8;
/// Touching pieces of two areas have opposite normals: their product is below this.
const OPPOSITE: f64 = -0.5;
/// Tangents shorter than this fraction of the curve's size count as zero.
const STANDS_STILL: f64 = 1e-12;
/// Points of an element at which its tangent is checked.
const LOOKS: usize = 5;

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
            let points = points.value.iter().map(|x| Vector::<2>::from_fn(|k, _| x.get(k).copied().unwrap_or(0.0))).collect();
            let degree = [degree.value.first().copied().unwrap_or(1)];
            let net = ControlNet::from_knots(degree, [knots[0].value.clone()], points, weights.as_ref().map(|w| w.value.clone()));
            curve(placed(net.map_err(|e| fault(net_fault(e)))?, geometry))
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

/// Outline of the obstacle to the right of a curve.
fn curve(net: ControlNet<1, 2>) -> Result<Vec<OutlinePiece>, Fault> {
    let ControlNet { axes: [axis], points, weights } = net;
    let map: Arc<dyn Geometry<1, 2>> = match weights {
        Some(weights) => {
            let basis = Rational::try_new::<1>(axis, weights).map_err(|e| Fault::new("E034", e.to_string()))?;
            Arc::new(ControlPoints { basis, points })
        }
        None => Arc::new(ControlPoints { basis: axis, points }),
    };
    let size = map.extent().map_or(0.0, |b| b.diagonal());
    let looks: Vec<Vector<1>> = (0..LOOKS).map(|k| Vector::<1>::new(k as f64 / (LOOKS - 1) as f64)).collect();
    let mut table = MapTable::new();
    for e in 0..map.num_elements() {
        map.map(e, &looks, Order::Gradients, &mut table);
        if let Some(q) = table.jacobian.iter().position(|j| j.norm().is_nan() || j.norm() <= STANDS_STILL * size) {
            let x = table.x[q];
            let text = format!("element {e} of the curve stands still at ({}, {}): it has no normal there", x[0], x[1]);
            return Err(Fault::new("E041", text));
        }
    }
    Ok((0..map.num_elements()).map(|element| OutlinePiece { curve: Arc::clone(&map), element, outward: -1.0 }).collect())
}

/// Outline of an area: its boundary.
fn area(net: ControlNet<2, 2>) -> Result<Vec<OutlinePiece>, Fault> {
    // only the map is needed, which is the same for all degrees
    let mut spec = PatchSpec::new(net).with_degree([1, 1]);
    spec.basis = BasisKind::BSpline;
    let patch = Patch::<1, 2>::try_new(&spec).map_err(|e| patch_fault(&e))?;
    outline_of(&patch, patch.sides())
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
    outline_of(&mesh, mesh.untagged().map(str::to_owned))
}

fn outline_of(body: &dyn Body<1, 2>, sides: impl IntoIterator<Item = String>) -> Result<Vec<OutlinePiece>, Fault> {
    let mut all = Vec::new();
    for side in sides {
        all.extend(pieces(&body.trace(&side).map_err(|e| Fault::new("E041", e.to_string()))?));
    }
    Ok(all)
}

/// Returns the pieces that touch no other; seams between areas, or of an area with itself, are interior.
fn without_seams(all: Vec<OutlinePiece>) -> Vec<OutlinePiece> {
    let bounds: Vec<Bounds<2>> = all.iter().map(|p| p.curve.bounds(p.element)).collect();
    let tree = Tree::new(bounds);
    let tolerance = TOUCHING * tree.bounds().map_or(0.0, |b| b.diagonal());
    let (middle, mut table) = ([Vector::<1>::new(0.5)], MapTable::new());
    let mut at = |p: &OutlinePiece, xi: &[Vector<1>; 1]| {
        p.curve.map(p.element, xi, Order::Gradients, &mut table);
        (table.x[0], unit_normal(&table.jacobian[0], p.outward))
    };
    let inside: Vec<bool> = (0..all.len())
        .map(|k| {
            let (x, normal) = at(&all[k], &middle);
            let near = tree.meeting(&Bounds { lo: x, hi: x }.inflated(tolerance));
            near.into_iter().filter(|&j| j != k).any(|j| {
                let one = OneElement { piece: &all[j] };
                let foot = ClosestPoint::<1, 2, _>::new(one).project_within(&x, 2.0 * tolerance);
                foot.is_some_and(|f| f.distance <= tolerance && normal.dot(&at(&all[j], &[f.xi]).1) < OPPOSITE)
            })
        })
        .collect();
    all.into_iter().zip(inside).filter(|(_, inside)| !inside).map(|(p, _)| p).collect()
}

/// One element of a curve as a curve.
struct OneElement<'a> {
    piece: &'a OutlinePiece,
}

impl std::fmt::Debug for OneElement<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_tuple("OneElement").field(&self.piece.element).finish()
    }
}

impl Elements for OneElement<'_> {
    fn num_elements(&self) -> usize {
        1
    }
}

impl Geometry<1, 2> for OneElement<'_> {
    fn map(&self, _: usize, xi: &[Vector<1>], order: Order, table: &mut MapTable<1, 2>) {
        self.piece.curve.map(self.piece.element, xi, order, table);
    }
    fn bounds(&self, _: usize) -> Bounds<2> {
        self.piece.curve.bounds(self.piece.element)
    }
}

/// Builds the obstacle with this outline.
pub(crate) fn surface(outline: &[OutlinePiece]) -> Surface {
    Surface::of_pieces(outline.to_vec(), None)
}
