//! Bodies of patches that are read from meshes: the cells are transformed, refined, and made a Lagrange mesh.

use super::builder::Builder;
use crate::case::{FilePart, Geometry, Master, Patch, SideRef};
use crate::errors::Diagnostic;
use crate::place::Located;
use crate::words::place;
use faying::geometry::{turn, turn_about};
use faying::linalg::Vector;
use faying::space::{Body, Mapping, Mesh, MeshError, Unshared, refine_cells, unshared_points};

/// Builds the body of a patch that is read from a mesh (backend `fe`).
pub(crate) fn body<const S: usize, const N: usize>(
    builder: &Builder<'_, S, N>,
    patch: &Patch,
) -> Result<Box<dyn Body<S, N>>, Box<Diagnostic>> {
    let geometry = &patch.geometry;
    let name = &patch.name.value;
    let part = geometry.shape.part();
    let Some(mut cells) = part.and_then(|p| p.cells::<N>()) else {
        let text = format!("geometry of patch \"{name}\": the cells are not of dimension {N}");
        return Err(Box::new(builder.error("E044", text, geometry.at)));
    };
    cells.points = placed_points(&cells.points, geometry)
        .map_err(|text| builder.error("E015", format!("geometry of patch \"{name}\": {text}"), geometry.at))?;
    for _ in 0..patch.refine.value {
        cells = refine_cells(&cells);
    }
    let d = &patch.discretization;
    let degree = d.degree.value.first().copied().unwrap_or(1);
    let mesh = Mesh::<S, N>::from_cells(&cells, degree, d.mapping.value).map_err(|error| {
        let at = if matches!(error, MeshError::Degree { .. }) { d.degree.at } else { geometry.at };
        let error = match part {
            Some(part) => in_numbers_of(part, error, N * patch.refine.value),
            None => error,
        };
        builder.error(mesh_code(&error), format!("patch \"{name}\": {error}"), at)
    })?;
    Ok(Box::new(mesh))
}

/// Warns of meshes with nodes that coincide and are not shared; none where a tie or a contact joins sides of one mesh to each other.
pub(super) fn unshared<const S: usize, const N: usize>(builder: &mut Builder<'_, S, N>) {
    let case = builder.case;
    for (k, patch) in case.patches.iter().enumerate() {
        let of = |list: &[Located<SideRef>]| list.iter().any(|side| side.value.patch == k);
        let tied = case.interfaces.iter().any(|t| of(&t.slave) && of(&t.master));
        let pressed = case.contacts.iter().any(|c| of(&c.slave) && matches!(&c.master, Master::Sides(list) if of(list)));
        let cells = patch.geometry.shape.part().filter(|p| p.is_mesh()).and_then(|p| p.cells::<N>());
        let Some(found) = cells.filter(|_| !tied && !pressed).and_then(|cells| unshared_points(&cells)) else { continue };
        let at = placed_points(&[found.at], &patch.geometry).unwrap_or_default();
        let text = unshared_text(&format!("patch \"{}\"", patch.name.value), &found, at.first().unwrap_or(&found.at));
        let warning = builder.warning("E023", text, patch.geometry.at).with_help(UNSHARED);
        builder.faults.push(warning);
    }
}

/// Advice for nodes that are not shared.
const UNSHARED: &str = "merge the nodes where the mesh is made (in Gmsh: fragment the shapes, or remove duplicate nodes); \
    or give both sides tags and join them by [[interface]], or by [[contact]] if they may part";

/// "nodes of patch "a" coincide and are not shared: 9 pairs, the first at x = 5, y = 0; what is on both sides does not hang together there".
pub(crate) fn unshared_text<const N: usize>(whose: &str, found: &Unshared<N>, at: &Vector<N>) -> String {
    let parts = if found.parts > 1 { format!(" The mesh has {} parts that share no node", found.parts) } else { String::new() };
    let pairs = if found.pairs == 1 { "1 pair".to_owned() } else { format!("{} pairs", found.pairs) };
    format!(
        "nodes of {whose} coincide and are not shared: {pairs}, the first at {}. The cells on both sides are not joined there.{parts}",
        place(at.as_slice())
    )
}

/// Returns the mesh of a patch, transformed but not refined: its facets determine the sag. `None` if the patch is no refined mesh.
pub(super) fn unrefined<const S: usize, const N: usize>(patch: &Patch) -> Option<Box<dyn Body<S, N>>> {
    let part = patch.geometry.shape.part().filter(|p| p.is_mesh() && patch.refine.value > 0)?;
    let mut cells = part.cells::<N>()?;
    cells.points = placed_points(&cells.points, &patch.geometry).ok()?;
    Some(Box::new(Mesh::<S, N>::from_cells(&cells, 1, Mapping::Exact).ok()?))
}

/// Scales, rotates and translates the points of a mesh as `geometry` says.
pub(super) fn placed_points<const N: usize>(points: &[Vector<N>], geometry: &Geometry) -> Result<Vec<Vector<N>>, String> {
    let turn = turn_of(geometry)?;
    Ok(points.iter().map(|x| moved(x, geometry, &turn)).collect())
}

/// Error code of an unusable mesh.
pub(super) fn mesh_code(error: &MeshError) -> &'static str {
    match error {
        MeshError::Inverted(_) | MeshError::Folded { .. } | MeshError::Collapsed { .. } => "E041",
        MeshError::Degree { .. } => "E015",
        _ => "E043",
    }
}

/// Converts cells and points of `error` to the numbers in the file of `part`; cell k is a child of cell k >> `shift`.
pub(super) fn in_numbers_of(part: &FilePart, error: MeshError, shift: usize) -> MeshError {
    let cell = |k: usize| part.cell_ids().get(k >> shift).map_or(k, |id| *id as usize);
    let point = |k: usize| part.point_ids().get(k).map_or(k, |id| *id as usize);
    error.renumbered(cell, point)
}

/// Rows of the rotation matrix of a geometry, `None` without rotation; in the plane the axis is z.
fn turn_of(geometry: &Geometry) -> Result<Option<[[f64; 3]; 3]>, String> {
    let Some(degrees) = geometry.rotate_deg.as_ref().map(|d| d.value) else { return Ok(None) };
    let rows = match &geometry.axis {
        None => {
            let q = turn(degrees);
            [[q[(0, 0)], q[(0, 1)], 0.0], [q[(1, 0)], q[(1, 1)], 0.0], [0.0, 0.0, 1.0]]
        }
        Some(axis) => {
            let axis = Vector::<3>::from_fn(|k, _| axis.get(k).copied().unwrap_or(0.0));
            let q = turn_about(&axis, degrees).ok_or("`axis` of a rotation must not be zero")?;
            std::array::from_fn(|i| std::array::from_fn(|k| q[(i, k)]))
        }
    };
    Ok(Some(rows))
}

/// Scales, rotates and translates a point.
fn moved<const N: usize>(x: &Vector<N>, geometry: &Geometry, turn: &Option<[[f64; 3]; 3]>) -> Vector<N> {
    let mut x = *x;
    if let Some(factor) = &geometry.scale {
        x *= factor.value;
    }
    if let Some(rows) = turn {
        x = Vector::from_fn(|i, _| (0..N).map(|k| rows[i][k] * x[k]).sum());
    }
    if let Some(by) = &geometry.translate {
        x += Vector::from_fn(|k, _| by.get(k).copied().unwrap_or(0.0));
    }
    x
}

/// Position of a named point of the mesh that a patch is read from.
pub(crate) fn named_point<const N: usize>(patch: &Patch, name: &str) -> Option<Vector<N>> {
    let geometry = &patch.geometry;
    let x = geometry.shape.part()?.point(name)?;
    Some(moved(&Vector::<N>::from_fn(|k, _| x[k]), geometry, &turn_of(geometry).ok()?))
}

/// Position of a point of the mesh that a patch is read from, by its index in the file.
pub(crate) fn point_of<const N: usize>(patch: &Patch, point: usize) -> Option<Vector<N>> {
    let geometry = &patch.geometry;
    let x = geometry.shape.part()?.place_of::<N>(point)?;
    Some(moved(&x, geometry, &turn_of(geometry).ok()?))
}

/// Numbers of product cells and simplices of a mesh after refinement; `None` for other geometries.
pub(crate) fn counts<const N: usize>(patch: &Patch) -> Option<[f64; 2]> {
    let part = patch.geometry.shape.part().filter(|p| p.is_mesh())?;
    let factor = f64::exp2((N * patch.refine.value) as f64);
    Some(part.counts().map(|n| n as f64 * factor))
}
