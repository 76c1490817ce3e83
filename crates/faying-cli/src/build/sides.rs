//! Sides of bodies by their references in the case, each built once.

use super::builder::Builder;
use crate::case::{Case, SideRef, quoted};
use crate::errors::Diagnostic;
use crate::formula::{Formula, Point};
use crate::place::Located;
use faying::basis::{Cell, Order};
use faying::geometry::{Embedding, MapTable};
use faying::linalg::{Vector, lit, num};
use faying::problem::{PatchModel, SideModel};
use faying::space::{SideError, Trace};
use std::collections::HashMap;
use std::sync::Arc;

/// Sides built so far, by patch and canonical name.
#[derive(Debug)]
pub(super) struct Sides<const S: usize, const N: usize> {
    known: HashMap<(usize, String), Arc<SideModel<S, N>>>,
}

impl<const S: usize, const N: usize> Default for Sides<S, N> {
    fn default() -> Self {
        Self { known: HashMap::new() }
    }
}

/// The short name of a side of a box: left, right, bottom, top, front, back.
pub(crate) fn alias(side: &str, dimension: usize) -> &str {
    match (side, dimension) {
        ("u0", _) => "left",
        ("u1", _) => "right",
        ("v0", 2) | ("w0", 3) => "bottom",
        ("v1", 2) | ("w1", 3) => "top",
        ("v0", 3) => "front",
        ("v1", 3) => "back",
        _ => side,
    }
}

/// Canonical name of an alias.
pub(crate) fn canonical(side: &str, dimension: usize) -> &str {
    ["u0", "u1", "v0", "v1", "w0", "w1"].into_iter().find(|s| alias(s, dimension) == side).unwrap_or(side)
}

impl<const S: usize, const N: usize> Sides<S, N> {
    /// Returns the side of a reference.
    pub fn get(
        &mut self,
        builder: &Builder<'_, S, N>,
        patches: &[PatchModel<S, N>],
        wanted: &Located<SideRef>,
    ) -> Result<Arc<SideModel<S, N>>, Box<Diagnostic>> {
        let (patch, side) = (wanted.value.patch, &wanted.value.side);
        let found = self.find(builder.case, patches, patch, side);
        found.map_err(|e| Box::new(side_fault(builder, &patches[patch], &e, wanted)))
    }

    /// Returns the side of a patch by its canonical name.
    pub fn find(&mut self, case: &Case, patches: &[PatchModel<S, N>], patch: usize, side: &str) -> Result<Arc<SideModel<S, N>>, SideError> {
        let wanted = SideRef { patch, side: side.to_owned() };
        let key = (patch, wanted.side.clone());
        if let Some(side) = self.known.get(&key) {
            return Ok(side.clone());
        }
        let side = Arc::new(SideModel::new(&patches[patch], patch, side, label(case, &patches[patch], &wanted))?);
        self.known.insert(key, side.clone());
        Ok(side)
    }

    /// Returns the part of a side whose facets have their centre where `filter` holds, `None` if there are none; not cached.
    pub fn filtered(
        &mut self,
        builder: &Builder<'_, S, N>,
        patches: &[PatchModel<S, N>],
        wanted: &Located<SideRef>,
        filter: &Located<Formula>,
    ) -> Result<Option<Arc<SideModel<S, N>>>, Box<Diagnostic>> {
        let whole = self.get(builder, patches, wanted)?;
        let patch = &patches[wanted.value.patch];
        let space = &*whole.trace.space;
        let mut table = MapTable::new();
        // facets by shape of cell: meshes may have both
        let mut facets: [Vec<Embedding<S, N>>; 2] = [Vec::new(), Vec::new()];
        for e in 0..space.num_elements() {
            let simplex = space.cell(e) == Cell::Simplex;
            let middle = if simplex { lit::<f64>(1.0) / num::<f64>(S + 1) } else { 0.5 };
            space.map(e, &[Vector::repeat(middle)], Order::Values, &mut table);
            if filter.value.value(&Point::new(table.x[0].as_slice())) != 0.0 {
                facets[usize::from(simplex)].push(whole.trace.facets[e]);
            }
        }
        let label = format!("{} where {}", whole.label, filter.value.text());
        let (kind, facets) = match facets {
            [a, b] if a.is_empty() && b.is_empty() => return Ok(None),
            [a, b] if b.is_empty() => (Cell::Tensor, a),
            [a, b] if a.is_empty() => (Cell::Simplex, b),
            _ => {
                let text = format!("`where` on `{}`, a side of triangles and quadrilaterals, is not in this version", whole.label);
                return Err(Box::new(builder.error("E019", text, filter.at).with_help("give the part a tag of its own in the mesh")));
            }
        };
        let trace = Trace::from_facets(patch.body.space(), facets, kind).map_err(|e| side_fault(builder, patch, &e, wanted))?;
        Ok(Some(Arc::new(SideModel::of_trace(patch, wanted.patch, &wanted.side, label, trace))))
    }
}

/// Name of a side in the body's own words: by alias on boxes and by direction or tag elsewhere.
fn label<const S: usize, const N: usize>(case: &Case, patch: &PatchModel<S, N>, wanted: &SideRef) -> String {
    let is_box = case.patches[wanted.patch].geometry.value.shape.value.kind() == "box";
    if is_box { format!("{}.{}", patch.name, alias(&wanted.side, N)) } else { case.side_name(wanted) }
}

/// Builds the diagnostic of a side that cannot be made.
pub(super) fn side_fault<const S: usize, const N: usize>(
    builder: &Builder<'_, S, N>,
    patch: &PatchModel<S, N>,
    error: &SideError,
    wanted: &Located<SideRef>,
) -> Diagnostic {
    let part = builder.case.patches[wanted.value.patch].geometry.shape.part().filter(|p| p.is_mesh());
    let sides = part.map_or_else(|| patch.body.sides(), |p| p.outer_tags().into_iter().map(quoted).collect());
    let patch = &patch.name;
    let known = match (part.is_some(), sides.is_empty()) {
        (true, true) => format!("no tag of \"{patch}\" is a side; \"all-outer\" is its whole boundary"),
        (true, false) => {
            format!("sides of \"{patch}\" are {}; \"all-outer\" is every side that stands in no other block", sides.join(", "))
        }
        _ => format!("sides of \"{patch}\" are {}", sides.join(", ")),
    };
    match error {
        SideError::Unknown { .. } => builder.error("E021", format!("there is no side `{patch}.{}`; {known}", wanted.value.side), wanted.at),
        other => builder.error("E021", format!("`{patch}.{}`: {other}", wanted.value.side), wanted.at).with_help(known),
    }
}
