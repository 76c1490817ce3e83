//! Gluing of the couples of a case.

use super::lower_context::LowerContext;
use super::meetings;
use super::places::{Places, Said};
use super::refused::too_far;
use super::side_pairs::SidePairs;
use crate::errors::Diagnostic;
use crate::place::SourceSpan;
use crate::text_format::place;
use faying::problem::Problem;
use faying::space::GlueError;

/// Says the couples of the case that are glued, and the points in which patches of one mesh meet.
pub(super) fn say<const S: usize, const N: usize>(
    context: &mut LowerContext<'_, S, N>,
    problem: &mut Problem<S, N>,
    places: &mut Places,
    couples: &SidePairs<S, N>,
) {
    for couple in couples.glued(context.case) {
        let said = problem.glue_couple(couple.couple.clone());
        places.keep(said, Said { at: couple.at, ..Said::default() });
    }
    for (functions, x) in meetings::found(context.case, problem) {
        let functions: Vec<_> = functions.into_iter().map(|(patch, function)| (places.bodies[patch], function)).collect();
        if let Err(error) = problem.share(&functions, x.into()) {
            context.faults.push(context.error("E015", error.to_string(), SourceSpan::default()));
        }
    }
}

/// The diagnostic of sides that cannot be glued: `names` of the slave and its masters.
pub(super) fn fault<const S: usize, const N: usize>(
    context: &LowerContext<'_, S, N>,
    at: SourceSpan,
    names: &[String],
    error: &GlueError,
) -> Diagnostic {
    let (slave, masters) = (&names[0], names[1..].iter().map(|m| format!("`{m}`")).collect::<Vec<_>>().join(", "));
    let mortar = "use coupling = \"mortar\", which ties any two sides (patches of one file: with glue = false in the patch)";
    match error {
        GlueError::Apart { distance, at: x, allowed } => too_far(context, (slave, &masters), (*distance, &x[..N], *allowed), at),
        GlueError::Grids { element, at: x } => {
            let text = format!(
                "`{slave}` and {masters} cannot be glued: their grids do not match at element {element} of `{slave}` (around {})",
                place(&x[..N])
            );
            context.error("E015", text, at).with_help(format!("give both the same breakpoints along the seam, or {mortar}"))
        }
        GlueError::Functions { element, at: x, difference } => {
            let text = format!(
                "`{slave}` and {masters} cannot be glued: their functions differ on element {element} of `{slave}` (around {}): {difference}",
                place(&x[..N])
            );
            context.error("E015", text, at).with_help(format!("give both the same degree, continuity and weights, or {mortar}"))
        }
        _ => context.error("E015", format!("`{slave}` and {masters} cannot be glued: {error}"), at).with_help(mortar),
    }
}
