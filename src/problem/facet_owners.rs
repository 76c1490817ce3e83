//! The facets that several sides have in common: whole sides, parts of sides, tags of meshes.

use super::model::BodySide;
use crate::geometry::{MapTable, cell};
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
        (side.patch_of(f), facet.element, part)
    })
}

/// The numbers of sides by their facets: sides of one body may overlap.
#[derive(Clone, Debug, Default)]
pub struct FacetOwners(HashMap<FacetKey, Vec<usize>>);

impl FacetOwners {
    /// Adds a side with a number.
    pub fn add<const S: usize, const N: usize>(&mut self, side: &BodySide<S, N>, number: usize) {
        facet_keys(side).for_each(|facet| self.0.entry(facet).or_default().push(number));
    }

    /// The numbers of sides with a facet of `side`, one for every facet in common.
    pub fn of<const S: usize, const N: usize>(&self, side: &BodySide<S, N>) -> impl Iterator<Item = usize> {
        facet_keys(side).filter_map(|facet| self.0.get(&facet)).flatten().copied()
    }

    /// Measure of the facets of `side` that no side has \[length^S\], of a body of revolution with the factor 2 pi r.
    pub fn free_measure<const S: usize, const N: usize>(&self, side: &BodySide<S, N>) -> f64 {
        let mut map = MapTable::new();
        let free = facet_keys(side).enumerate().filter(|(_, facet)| !self.0.contains_key(facet));
        free.map(|(f, _)| side.measure_of(f, &mut map)).sum()
    }
}
