//! Bodies of patches that are read from meshes: the cells are transformed, refined, and made a Lagrange mesh.

use super::lower_context::LowerContext;
use crate::case::{Patch, SideRef};
use crate::errors::Diagnostic;
use crate::place::Located;
use crate::shapes::{mesh_fault, placed_points};
use crate::text_format::place;
use faying::linalg::Vector;
use faying::space::{Body, Dimension, Mapping, Mesh, Trace, Unshared, refine_cells, unshared_points};

/// Builds the body of a patch that is read from a mesh (backend `fe`).
pub(crate) fn body<const S: usize, const N: usize>(
    context: &LowerContext<'_, S, N>,
    patch: &Patch,
) -> Result<Box<dyn Body<S, N>>, Box<Diagnostic>>
where
    Trace<S, N>: Dimension<S, N>,
{
    let geometry = &patch.geometry;
    let name = &patch.name.value;
    let part = geometry.shape.part();
    let Some(mut cells) = part.and_then(|p| p.cells::<N>()) else {
        let text = format!("geometry of patch \"{name}\": the cells are not of dimension {N}");
        return Err(Box::new(context.error("E044", text, geometry.at)));
    };
    cells.points = placed_points(&cells.points, geometry)
        .map_err(|text| context.error("E015", format!("geometry of patch \"{name}\": {text}"), geometry.at))?;
    for _ in 0..patch.refine.value {
        cells = refine_cells(&cells);
    }
    let d = &patch.discretization;
    let degree = d.degree.value.first().copied().unwrap_or(1);
    let mesh = Mesh::<S, N>::from_cells(&cells, degree, d.mapping.value).map_err(|error| {
        let fault = mesh_fault(error, part, N * patch.refine.value);
        let at = if fault.key == "degree" { d.degree.at } else { geometry.at };
        context.error(fault.code, format!("patch \"{name}\": {fault}"), at)
    })?;
    Ok(Box::new(mesh))
}

/// Warns of meshes with nodes that coincide and are not shared; none where a tie or a contact joins sides of one mesh to each other.
pub(super) fn unshared<const S: usize, const N: usize>(context: &mut LowerContext<'_, S, N>) {
    let case = context.case;
    for (k, patch) in case.patches.iter().enumerate() {
        let of = |list: &[Located<SideRef>]| list.iter().any(|side| side.value.patch == k);
        let tied = case.interfaces.iter().any(|t| of(&t.slave) && of(&t.master));
        let pressed = case.contacts.iter().any(|c| of(&c.slave) && of(c.masters()));
        let cells = patch.geometry.shape.mesh_part().and_then(|p| p.cells::<N>());
        let Some(found) = cells.filter(|_| !tied && !pressed).and_then(|cells| unshared_points(&cells)) else { continue };
        let at = placed_points(&[found.at], &patch.geometry).unwrap_or_default();
        let text = unshared_text(&format!("patch \"{}\"", patch.name.value), &found, at.first().unwrap_or(&found.at));
        let warning = context.warning("E023", text, patch.geometry.at).with_help(UNSHARED);
        context.faults.push(warning);
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
pub(super) fn unrefined<const S: usize, const N: usize>(patch: &Patch) -> Option<Box<dyn Body<S, N>>>
where
    Trace<S, N>: Dimension<S, N>,
{
    let part = patch.geometry.shape.mesh_part().filter(|_| patch.refine.value > 0)?;
    let mut cells = part.cells::<N>()?;
    cells.points = placed_points(&cells.points, &patch.geometry).ok()?;
    Some(Box::new(Mesh::<S, N>::from_cells(&cells, 1, Mapping::Exact).ok()?))
}

/// Numbers of product cells and simplices of a mesh after refinement; `None` for other geometries.
pub(crate) fn counts<const N: usize>(patch: &Patch) -> Option<[f64; 2]> {
    let part = patch.geometry.shape.mesh_part()?;
    let factor = f64::exp2((N * patch.refine.value) as f64);
    Some(part.counts().map(|n| n as f64 * factor))
}
