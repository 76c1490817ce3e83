//! Sides that are joined in part: tags of a mesh may overlap, and `where` keeps a part of a side.

use super::joined_sides::Marks;
use super::search::Search;
use crate::basis::Cell;
use crate::problem::model::BodySide;
use std::collections::BTreeMap;
use std::sync::Arc;

/// A side, or a part of one, whose facets are part of the same couples.
#[derive(Clone, Debug)]
pub(super) struct Candidate<const S: usize, const N: usize> {
    pub side: Arc<BodySide<S, N>>,
    /// The couples that every facet of it is part of.
    pub marks: Marks,
}

impl<const S: usize, const N: usize> Search<'_, S, N> {
    /// The parts of a side whose facets are part of the same couples, those in none first; the side itself if this holds for all of it.
    /// Cells of several shapes are several parts.
    pub(super) fn candidates(&self, side: &Arc<BodySide<S, N>>) -> Vec<Candidate<S, N>> {
        let of_facets = self.joined.marks_of_facets(side);
        let first = of_facets.first().cloned().unwrap_or_default();
        if of_facets.iter().all(|marks| *marks == first) {
            return vec![Candidate { side: side.clone(), marks: first }];
        }
        let mut parts: BTreeMap<(Marks, bool), Vec<usize>> = BTreeMap::new();
        for (e, marks) in of_facets.into_iter().enumerate() {
            parts.entry((marks, side.trace.space.cell(e) == Cell::Simplex)).or_default().push(e);
        }
        let part = |((marks, _), elements): ((Marks, bool), Vec<usize>)| {
            let label = format!("{} where {}", side.label, if marks.is_empty() { "nothing joins it" } else { "it is joined" });
            Candidate { side: Arc::new(side.part(self.patches, self.compiled, &elements, label)), marks }
        };
        parts.into_iter().map(part).collect()
    }

    /// The parts of a side that nothing joins; the side itself if nothing joins any of it, and none if all of it is joined.
    pub fn free_parts(&self, side: &Arc<BodySide<S, N>>) -> Vec<Arc<BodySide<S, N>>> {
        self.candidates(side).into_iter().filter(|c| c.marks.is_empty()).map(|c| c.side).collect()
    }
}
