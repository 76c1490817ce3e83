//! The facets that several sides have in common: whole sides, parts of sides, tags of meshes.

use super::model::BodySide;
use crate::geometry::cell;
use std::collections::HashMap;

/// Key of a facet: patch, element, and midpoint in units of the element over [`UNITS`].
pub(super) type FacetKey = (usize, usize, [i64; 3]);

/// Resolution of facet midpoints: those of one element differ by more than 1 / `UNITS` of it.
const UNITS: f64 = 1048576.0;

/// The keys of the facets of a side.
pub(super) fn facet_keys<const S: usize, const N: usize>(side: &BodySide<S, N>) -> impl Iterator<Item = FacetKey> + '_ {
    side.trace.facets.iter().enumerate().map(|(f, facet)| {
        let middle = facet.lift(&cell::center(side.trace.space.cell(f)));
        let part = std::array::from_fn(|k| if k < N { (middle[k] * UNITS).round() as i64 } else { 0 });
        (side.patch, facet.element, part)
    })
}

/// The numbers of sides by their facets.
#[derive(Debug, Default)]
pub(super) struct FacetOwners(HashMap<FacetKey, Vec<usize>>);

impl FacetOwners {
    /// Adds a side with a number.
    pub fn add<const S: usize, const N: usize>(&mut self, side: &BodySide<S, N>, number: usize) {
        facet_keys(side).for_each(|facet| self.0.entry(facet).or_default().push(number));
    }

    /// The numbers of sides with a facet of `side`, one for every facet in common.
    pub fn of<const S: usize, const N: usize>(&self, side: &BodySide<S, N>) -> impl Iterator<Item = usize> {
        facet_keys(side).filter_map(|facet| self.0.get(&facet)).flatten().copied()
    }
}
