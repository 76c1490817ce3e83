//! Warning E065 if a tie across a gap loses moments: equal and opposite forces on sides that are apart make a couple that nothing carries.

use crate::case::Case;
use crate::errors::Diagnostic;
use crate::words::{percent, short};
use faying::geometry::Geometry;
use faying::problem::{Model, StepState};

/// Lost moment over the force through the tie times half its size, above which the warning is given.
const LOST: f64 = 1e-3;

/// Returns at most one warning per interface.
pub fn warnings<const S: usize, const N: usize>(case: &Case, model: &Model<S, N>, state: &StepState<S, N>) -> Vec<Diagnostic> {
    let mut found = Vec::new();
    if model.components != N {
        return found;
    }
    for tie in &model.ties {
        let Some(block) = case.interfaces.iter().find(|i| i.name.value == tie.name) else { continue };
        let (mut moment, mut force) = ([0.0; 3], 0.0);
        for part in &tie.parts {
            let lost = part.lost_moment(model, state);
            moment.iter_mut().zip(lost.moment).for_each(|(sum, m)| *sum += m);
            force += lost.force;
        }
        let sides = tie.parts.iter().filter_map(|part| part.slave.trace.space.extent());
        let size = 0.5 * sides.reduce(|a, b| a.union(&b)).map_or(0.0, |b| b.diagonal());
        let lost = moment.iter().map(|m| m * m).sum::<f64>().sqrt();
        if lost <= LOST * force * size {
            continue;
        }
        let apart = tie.parts.iter().flat_map(|part| &part.pairings).map(|p| p.segments.report.distance).fold(0.0, f64::max);
        let text = format!(
            "interface \"{}\" loses a moment: its sides are up to {} apart, and its forces on both have the moment {} about that gap, \
             {} % of what they have about the middle of the side; `balance.moment` lacks it",
            tie.name,
            short(apart),
            short(lost),
            percent(lost / (force * size))
        );
        let help = "move the bodies together, or fill the gap with a body";
        found.push(Diagnostic::warning("E065", text).at(&case.source, block.head.at).with_help(help));
    }
    found
}
