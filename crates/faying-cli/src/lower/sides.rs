//! Sides of bodies by their references in the case, each built once.

use super::lower_context::LowerContext;
use super::places::Places;
use crate::case::{Case, SideRef, alias, quoted};
use crate::errors::Diagnostic;
use crate::place::Located;
use faying::problem::{BodyView, ErrorKind, Problem, ProblemError, SideNames, SideView};
use faying::space::SideError;
use std::sync::Arc;

/// Looks up a side of a reference.
pub(super) fn side<const S: usize, const N: usize>(
    context: &LowerContext<'_, S, N>,
    problem: &mut Problem<S, N>,
    places: &Places,
    wanted: &Located<SideRef>,
) -> Result<Arc<SideView<S, N>>, Box<Diagnostic>> {
    let body = places.bodies[wanted.value.patch];
    problem.side(body.side(&wanted.value.side)).map_err(|error| Box::new(refused(context, problem, &error, wanted)))
}

/// The diagnostic of a side that a problem refuses.
pub(super) fn refused<const S: usize, const N: usize>(
    context: &LowerContext<'_, S, N>,
    problem: &Problem<S, N>,
    error: &ProblemError,
    wanted: &Located<SideRef>,
) -> Diagnostic {
    match (&error.kind, problem.bodies().nth(wanted.value.patch)) {
        (ErrorKind::Side(of_side), Some(body)) => side_fault(context, &body, of_side, wanted),
        _ => context.error("E015", error.to_string(), wanted.at),
    }
}

/// Whether the case can name a side: what is left of the boundary of a mesh has no name in its file.
pub(super) fn has_name(case: &Case, patch: usize, side: &str) -> bool {
    case.patches[patch].geometry.shape.mesh_part().is_none_or(|part| part.tags().contains(&side))
}

/// Names of the sides of a patch in the body's own words: aliases on boxes, directions or tags elsewhere.
pub(crate) fn names(case: &Case, patch: usize) -> SideNames {
    let dimension = case.model.dimension.value;
    if case.patches[patch].geometry.value.shape.value.kind() == "box" {
        return Arc::new(move |side| alias(side, dimension).to_owned());
    }
    Arc::new(quoted)
}

pub(super) fn side_fault<const S: usize, const N: usize>(
    context: &LowerContext<'_, S, N>,
    body: &BodyView<'_, S, N>,
    error: &SideError,
    wanted: &Located<SideRef>,
) -> Diagnostic {
    let part = context.case.patches[wanted.value.patch].geometry.shape.mesh_part();
    let sides = part.map_or_else(|| body.body().sides(), |p| p.outer_tags().into_iter().map(quoted).collect());
    let patch = body.name();
    let known = match (part.is_some(), sides.is_empty()) {
        (true, true) => format!("no tag of \"{patch}\" is a side; \"all-outer\" is its whole boundary"),
        (true, false) => {
            format!("sides of \"{patch}\" are {}; \"all-outer\" is every side that stands in no other block", sides.join(", "))
        }
        _ => format!("sides of \"{patch}\" are {}", sides.join(", ")),
    };
    match error {
        SideError::Unknown { .. } => context.error("E021", format!("there is no side `{patch}.{}`; {known}", wanted.value.side), wanted.at),
        SideError::Lower { dimension, .. } => {
            let what = if *dimension == 0 { "points" } else { "edges" };
            let text = format!("`{patch}.{}` is a set of {what} of the file, no side", wanted.value.side);
            context.error("E021", text, wanted.at).with_help(format!("[[boundary]] takes it, for fix, dirichlet and force; {known}"))
        }
        other => context.error("E021", format!("`{patch}.{}`: {other}", wanted.value.side), wanted.at).with_help(known),
    }
}
