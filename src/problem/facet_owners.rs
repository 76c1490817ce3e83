//! The facets that several sides have in common: whole sides, parts of sides, tags of meshes.

use super::model::BodySide;
use crate::geometry::Embedding;
use std::collections::HashMap;

/// Sides by their facets.
#[derive(Debug)]
pub(super) struct FacetOwners<'a, const S: usize, const N: usize> {
    /// Facets with the number of their side, by body and element.
    known: HashMap<(usize, usize), Vec<(&'a Embedding<S, N>, usize)>>,
}

impl<'a, const S: usize, const N: usize> FacetOwners<'a, S, N> {
    /// No sides.
    pub fn new() -> Self {
        Self { known: HashMap::new() }
    }

    /// Adds a side with a number.
    pub fn add(&mut self, side: &'a BodySide<S, N>, number: usize) {
        for facet in &side.trace.facets {
            self.known.entry((side.patch, facet.element)).or_default().push((facet, number));
        }
    }

    /// The numbers of sides with a facet of `side`, one for every facet in common.
    pub fn of<'s>(&'s self, side: &'s BodySide<S, N>) -> impl Iterator<Item = usize> + 's {
        let near =
            |facet: &'s Embedding<S, N>| self.known.get(&(side.patch, facet.element)).into_iter().flatten().map(move |of| (facet, of));
        side.trace.facets.iter().flat_map(near).filter(|(facet, (other, _))| facet == other).map(|(_, (_, number))| *number)
    }
}
