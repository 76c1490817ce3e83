//! Searches for sides that touch, with what is joined and what was found.

use super::finding::Finding;
use super::joined_sides::{JoinedSides, SidePair, key, side_pair};
use super::lengths::sag;
use super::paired_sides::PairedSides;
use crate::geometry::Sag;
use crate::problem::compiled::Compiled;
use crate::problem::contents::BodyView;
use crate::problem::model::{BodyModel, BodySide};
use crate::space::SideError;
use std::collections::BTreeSet;
use std::sync::Arc;

/// Source of sides: returns the side of a body (its number) by its name.
pub(crate) type SideSource<'a, const S: usize, const N: usize> = dyn FnMut(usize, &str) -> Result<Arc<BodySide<S, N>>, SideError> + 'a;

/// A search for sides that touch, among bodies of which some sides are joined already.
pub struct Search<'a, const S: usize, const N: usize> {
    pub(super) compiled: &'static dyn Compiled<S, N>,
    pub(super) patches: &'a [BodyModel<S, N>],
    sides: &'a mut SideSource<'a, S, N>,
    pub(super) joined: JoinedSides,
    told: BTreeSet<SidePair>,
    /// The findings so far, in their order; whoever takes them out may leave it empty.
    pub findings: Vec<Finding<S, N>>,
}

impl<const S: usize, const N: usize> std::fmt::Debug for Search<'_, S, N> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Search").field("joined", &self.joined).field("findings", &self.findings).finish_non_exhaustive()
    }
}

impl<'a, const S: usize, const N: usize> Search<'a, S, N> {
    /// A search among `patches`, of which no sides are joined.
    pub(crate) fn new(compiled: &'static dyn Compiled<S, N>, patches: &'a [BodyModel<S, N>], sides: &'a mut SideSource<'a, S, N>) -> Self {
        Self { compiled, patches, sides, joined: JoinedSides::default(), told: BTreeSet::new(), findings: Vec::new() }
    }

    /// The body with a number.
    ///
    /// # Panics
    /// If there are fewer bodies.
    pub fn body(&self, number: usize) -> BodyView<'a, S, N> {
        BodyView { patch: &self.patches[number] }
    }

    /// Returns a side of a body.
    ///
    /// # Errors
    /// [`SideError`] of the source.
    pub fn side(&mut self, patch: usize, side: &str) -> Result<Arc<BodySide<S, N>>, SideError> {
        (self.sides)(patch, side)
    }

    /// The sag of the facets of a side: zero if they are the surface itself; for refined meshes that of the unrefined facets.
    pub fn sag(&self, side: &BodySide<S, N>) -> Sag<S, N> {
        self.compiled.sag(self, side)
    }

    pub(crate) fn own_sag(&self, side: &BodySide<S, N>) -> Sag<S, N> {
        sag(self.patches, side)
    }

    /// Excludes a pair of sides (body, name) from the search.
    pub fn exclude(&mut self, a: (usize, &str), b: (usize, &str)) {
        self.joined.exclude(side_pair(a, b));
    }

    /// Restricts the exclusion of a pair of sides (body, name) to parts that are joined: a statement joins no more of them than a part.
    pub fn include_rest(&mut self, a: (usize, &str), b: (usize, &str)) {
        self.joined.include_rest(side_pair(a, b));
    }

    /// Joins two sides whose functions are shared.
    pub fn glue(&mut self, slave: Arc<BodySide<S, N>>, master: Arc<BodySide<S, N>>) -> PairedSides<S, N> {
        let couple = PairedSides { slave, masters: vec![master], tolerance: None, is_named: false, explained: None };
        self.joined.join(&couple);
        couple
    }

    /// Joins the sides of a couple that was found or named before.
    pub fn join(&mut self, couple: &PairedSides<S, N>) {
        self.joined.join(couple);
    }

    /// Marks the sides of a contact: they are no candidates for a tie.
    pub fn contact(&mut self, slaves: &[Arc<BodySide<S, N>>], masters: &[Arc<BodySide<S, N>>]) {
        self.joined.contact(slaves, masters);
    }

    /// Notes that a finding or an error names these sides together; returns whether there is a pair that none has named before.
    pub(super) fn tell(&mut self, sides: &[Arc<BodySide<S, N>>]) -> bool {
        let pairs = sides.iter().enumerate().flat_map(|(k, a)| sides[k + 1..].iter().map(move |b| side_pair(key(a), key(b))));
        let before = self.told.len();
        self.told.extend(pairs);
        self.told.len() > before
    }
}
