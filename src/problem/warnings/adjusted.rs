//! Contacts that close more than facets explain.
//!
//! A contact that adjusts takes gaps and overlaps at rest for none, up to twice the deviation of facets from the surfaces for which they
//! stand. Where these surfaces themselves are apart or overlap in the mean by more than facets explain ([`clearance`]), a clearance or a
//! press fit was drawn, and is lost.

use super::warning::{Subject, Warning};
use crate::problem::model::{ContactPart, Model};
use crate::problem::touching::{floor, sag};
use crate::space::clearance;

/// Reach of a facet in multiples of its size, in which its partners are looked for.
const REACH: f64 = 1.0;

/// Finds such contacts between bodies.
pub(super) fn adjusted<const S: usize, const N: usize>(model: &Model<S, N>) -> Vec<Warning> {
    let of = |k: usize| {
        let worst = |a: &(f64, f64), b: &(f64, f64)| a.0.total_cmp(&b.0);
        let parts = model.contacts[k].parts.iter().filter_map(|part| beyond(model, part));
        parts.max_by(worst).map(|(mean, explained)| Warning::Adjusted { of: Subject::contact(model, k), mean, explained })
    };
    (0..model.contacts.len()).filter_map(of).collect()
}

/// The mean distance of the surfaces of a part that is closed, and how much of it facets explain, if that is less.
fn beyond<const S: usize, const N: usize>(model: &Model<S, N>, part: &ContactPart<S, N>) -> Option<(f64, f64)> {
    if part.closes <= 0.0 || part.masters.is_empty() {
        return None;
    }
    let sags: Vec<_> = part.masters.iter().map(|master| sag(&model.patches, master)).collect();
    let own = sag(&model.patches, &part.slave);
    // sides without facets are where they are drawn
    if sags.iter().chain([&own]).all(|sag| sag.greatest() <= 0.0) {
        return None;
    }
    let masters: Vec<_> = part.masters.iter().zip(&sags).map(|(master, sag)| (&master.trace, sag)).collect();
    let sides: Vec<_> = part.masters.iter().chain([&part.slave]).cloned().collect();
    let zero = floor(&sides);
    // what is closed is rounding
    if part.closes <= zero || part.first.frames.gap.iter().all(|gap| gap.abs() <= zero) {
        return None;
    }
    let found = clearance((&part.slave.trace, &own), &masters, REACH, zero);
    let (mean, explained) = (found.mean(), found.allowed().max(zero));
    (mean > explained).then_some((mean.min(part.closes), explained))
}
