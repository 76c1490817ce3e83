//! Facets of sides that nearly fit, if they leave the surface that they stand for by as much as their gap.
//!
//! Facets of polygons that approximate one curve are apart, or overlap, by up to their [sag](crate::geometry::Sag), whatever the clearance
//! or the interference of the curve is. With h the sum of the greatest sags of both sides and g the gap by the gap formula, the warning is
//! given if
//!
//! ```text
//! h > 0.1 mean |g|   and   max |g| < 10 h,
//! ```
//!
//! so that sides that touch only in part, as in Hertz' problem, are excluded: there the gap grows beyond any sag. Nor is it given where
//! the contact closes all that facets leave.

use super::warning::{Subject, Warning};
use crate::problem::model::{ContactModel, ContactPart, Model};
use crate::problem::touching::sag;

/// Ratio h / mean |g| above which the warning is given.
const POOR: f64 = 0.1;
/// Ratio max |g| / h from which on sides do not fit.
const FIT: f64 = 10.0;
/// Sags and gaps below this fraction of the size of the model, and of its distance from the origin, are round-off.
const ROUNDING: f64 = 1e-12;

/// Finds the contacts with such sides, gaps at time `t`.
pub(super) fn facets<const S: usize, const N: usize>(model: &Model<S, N>, t: f64) -> Vec<Warning> {
    let of = |k: usize| {
        let contact = &model.contacts[k];
        let poor = contact.parts.iter().filter_map(|part| of_part(model, contact, part, t));
        let (sag, gap) = poor.max_by(|a, b| (a.0 / a.1).total_cmp(&(b.0 / b.1)))?;
        Some(Warning::Facets { of: Subject::contact(model, k), sag, gap })
    };
    (0..model.contacts.len()).filter_map(of).collect()
}

/// Returns h and mean |g| of a part if the warning applies.
fn of_part<const S: usize, const N: usize>(
    model: &Model<S, N>,
    contact: &ContactModel<S, N>,
    part: &ContactPart<S, N>,
    t: f64,
) -> Option<(f64, f64)> {
    let sides = part.masters.iter().chain([&part.slave]);
    let sag: f64 = sides.map(|side| sag(&model.patches, side).greatest()).sum();
    let rounding = ROUNDING * (model.size + model.center.norm());
    if sag <= rounding {
        return None;
    }
    let (segments, frames) = (&part.first.segments, &part.first.frames);
    if frames.gap.iter().all(|gap| gap.abs() <= part.closes) || !contact.follows_sides(part, t, model.size) {
        return None;
    }
    let (mut sum, mut size, mut largest) = (0.0, 0.0, 0.0f64);
    for ((x, &gap), &ds) in frames.x.iter().zip(&frames.gap).zip(&segments.ds) {
        let gap = contact.wanted(x, t, gap, part.closes).abs();
        sum += ds * gap;
        size += ds;
        largest = largest.max(gap);
    }
    let mean = sum / size;
    (mean > rounding && sag > POOR * mean && largest < FIT * sag).then_some((sag, mean))
}
