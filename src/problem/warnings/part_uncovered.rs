//! Parts of tied slave sides that meet no master, because facets end beside each other.

use super::warning::{Subject, Warning};
use crate::problem::model::Model;

/// Finds the ties with such sides.
pub(super) fn parts_uncovered<const S: usize, const N: usize>(model: &Model<S, N>) -> Vec<Warning> {
    let parts = model.ties.iter().enumerate().flat_map(|(k, tie)| tie.parts.iter().map(move |part| (k, part)));
    let warning = |k, slave: &str, share| Warning::PartUncovered { of: Subject::tie(model, k), slave: slave.to_owned(), share };
    parts.filter_map(|(k, part)| Some(warning(k, &part.slave.label, part.uncovered()?))).collect()
}
