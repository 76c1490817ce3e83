//! Warning E065 if the facets of sides that nearly fit deviate from the surface they approximate by as much as their gap.
//!
//! Facets of polygons that approximate one curve are apart, or overlap, by up to their [sag](faying::geometry::Sag), whatever the clearance
//! or the interference of the curve is. With h the sum of the greatest sags of both sides and g the gap by the gap formula, the warning is
//! given if
//!
//!   h > 0.1 mean |g|   and   max |g| < 10 h,
//!
//! so that sides that touch only in part, as in Hertz' problem, are excluded: there the gap grows beyond any sag.

use crate::case::Case;
use crate::errors::Diagnostic;
use crate::formula::Point;
use crate::words::percent;
use crate::words::short;
use faying::problem::touching::sag;
use faying::problem::{ContactModel, ContactPart, Model};

/// Ratio h / mean |g| above which the warning is given.
const POOR: f64 = 0.1;
/// Ratio max |g| / h from which on sides do not fit.
const FIT: f64 = 10.0;
/// Sags and gaps below this fraction of the size of the model, and of its distance from the origin, are round-off.
const ROUNDING: f64 = 1e-12;

/// Returns at most one warning per contact.
pub fn warnings<const S: usize, const N: usize>(case: &Case, model: &Model<S, N>) -> Vec<Diagnostic> {
    let mut found = Vec::new();
    for (contact, block) in model.contacts.iter().zip(&case.contacts) {
        let worst =
            contact.parts.iter().filter_map(|part| of_part(case, model, contact, part)).max_by(|a, b| (a.0 / a.1).total_cmp(&(b.0 / b.1)));
        let Some((sag, mean)) = worst else { continue };
        let text = format!(
            "the facets of contact \"{}\" leave the surface that they stand for by up to {}, {} % of the mean gap {}: facets decide what touches",
            contact.name,
            short(sag),
            percent(sag / mean),
            short(mean)
        );
        let help = "take more elements along the sides, degree 2 or more, mapping = \"exact\", or backend = \"iga\"";
        found.push(Diagnostic::warning("E065", text).at(&case.source, block.head.at).with_help(help));
    }
    found
}

/// Returns h and mean |g| of a part if the warning applies.
fn of_part<const S: usize, const N: usize>(
    case: &Case,
    model: &Model<S, N>,
    contact: &ContactModel<S, N>,
    part: &ContactPart<S, N>,
) -> Option<(f64, f64)> {
    let sides = part.masters.iter().chain([&part.slave]);
    let sag: f64 = sides.map(|side| sag(&model.patches, side).greatest()).sum();
    let rounding = ROUNDING * (model.size + model.center.norm());
    if sag <= rounding {
        return None;
    }
    let t = case.steps.value.first().copied().unwrap_or(1.0);
    let (segments, frames) = (&part.first.segments, &part.first.frames);
    let (mut sum, mut size, mut largest) = (0.0, 0.0, 0.0f64);
    for ((x, &gap), &ds) in frames.x.iter().zip(&frames.gap).zip(&segments.ds) {
        let gap = contact.gap.value(&Point::new(x.as_slice()).at_time(t).with_gap(gap)).abs();
        sum += ds * gap;
        size += ds;
        largest = largest.max(gap);
    }
    let mean = sum / size;
    (mean > rounding && sag > POOR * mean && largest < FIT * sag).then_some((sag, mean))
}
