//! Gluing of the couples of a case.

use super::builder::Builder;
use super::couples::{CoupleAt, Couples};
use super::meetings;
use crate::errors::Diagnostic;
use crate::words::{labels, short};
use faying::problem::{Glued, Hinge, PatchModel};
use faying::space::{GlueError, Near};

/// Glues the couples of the case, and the points in which patches of one mesh meet; returns these beside it.
pub(super) fn of<const S: usize, const N: usize>(
    builder: &mut Builder<'_, S, N>,
    patches: &[PatchModel<S, N>],
    couples: &Couples<S, N>,
) -> (Glued, Vec<Hinge<N>>) {
    let unknowns = patches.last().map_or(0, |p| p.range().end);
    let components = builder.case.model.components();
    let mut glued = Glued::new(components, unknowns / components.max(1), patches.len());
    let mut faults = Vec::new();
    for couple in couples.glued(builder.case) {
        if let Err(error) = glued.add(patches, &couple.slave, &couple.masters, near(patches, couple)) {
            faults.push(fault(builder, couple, &error));
        }
    }
    for found in faults {
        builder.faults.push(found);
    }
    let hinges = meetings::join(builder.case, patches, components, &mut glued);
    glued.finish();
    (glued, hinges)
}

/// Distance of points that are the same.
fn near<const S: usize, const N: usize>(patches: &[PatchModel<S, N>], couple: &CoupleAt<S, N>) -> Near {
    let exact = patches[couple.slave.patch].exact_map && couple.masters.iter().all(|m| patches[m.patch].exact_map);
    match couple.tolerance {
        Some(distance) => Near::Given(distance),
        None if exact => Near::Exact,
        None if couple.is_named => Near::Corners,
        None => Near::Facets,
    }
}

fn fault<const S: usize, const N: usize>(builder: &Builder<'_, S, N>, couple: &CoupleAt<S, N>, error: &GlueError) -> Diagnostic {
    let (slave, masters) = (&couple.slave.label, labels(&couple.masters));
    let spot = |at: &[f64; 3]| {
        let list: Vec<String> = ["x", "y", "z"][..N].iter().zip(at).map(|(l, v)| format!("{l} = {}", short(*v))).collect();
        list.join(", ")
    };
    let mortar = "use coupling = \"mortar\", which ties any two sides";
    match error {
        GlueError::Apart { distance, at, allowed } => {
            let text =
                format!("`{slave}` and {masters} are up to {} apart (at {}); allowed {}", short(*distance), spot(at), short(*allowed));
            builder
                .error("E023", text, couple.at)
                .with_help("move the bodies together or raise `tolerance`; use [[contact]] if a gap is meant")
        }
        GlueError::Grids { element, at } => {
            let text = format!(
                "`{slave}` and {masters} cannot be glued: their grids do not match at element {element} of `{slave}` (around {})",
                spot(at)
            );
            builder.error("E015", text, couple.at).with_help(format!("give both the same breakpoints along the seam, or {mortar}"))
        }
        GlueError::Functions { element, at, difference } => {
            let text = format!(
                "`{slave}` and {masters} cannot be glued: their functions differ on element {element} of `{slave}` (around {}): {difference}",
                spot(at)
            );
            builder.error("E015", text, couple.at).with_help(format!("give both the same degree, continuity and weights, or {mortar}"))
        }
        _ => builder.error("E015", format!("`{slave}` and {masters} cannot be glued: {error}"), couple.at).with_help(mortar),
    }
}
