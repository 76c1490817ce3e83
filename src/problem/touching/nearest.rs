//! Sides that are near each other and that nothing joins.

use super::facing::{COVERED, facing_either};
use super::finding::{Finding, NearPair};
use super::lengths::{Extent, size, thickness};
use super::search::Search;
use crate::geometry::Bounds;
use std::collections::BTreeMap;

/// Sides nearer than this share of their facets may have been meant to be tied, if they are also nearer than [`THIN`] of the bodies behind
/// them: coarse facets alone say nothing about what was meant.
pub const NEAR: f64 = 0.1;
/// Share of the thickness of the thinner body.
pub const THIN: f64 = 0.02;

impl<const S: usize, const N: usize> Search<'_, S, N> {
    /// Finds sides of `bodies` that nothing joins though they are near for the size of their facets: [`Finding::Near`], of every two bodies
    /// the nearest sides, without pairs that a finding or an error has named.
    pub fn nearly_touching(&mut self, bodies: &[usize]) {
        for pair in self.compiled.nearest_of(self, bodies, true).into_values() {
            if self.tell(&pair.sides) {
                self.findings.push(Finding::Near(pair));
            }
        }
    }

    /// Returns the nearest of the sides of `bodies` that nothing joins; `None` if no two face each other.
    pub(super) fn nearest(&mut self, bodies: &[usize]) -> Option<NearPair<S, N>> {
        let pairs = self.compiled.nearest_of(self, bodies, false).into_values();
        pairs.reduce(|a, b| if b.facing.distance < a.facing.distance { b } else { a })
    }

    /// The nearest sides of every two of `bodies`, of those that are part of no couple; with `near` only those that are so for the size of
    /// their facets, else at least those that are nearest of all.
    ///
    /// Sides that overlap through bodies that are joined are the far faces of thin ones.
    pub(crate) fn nearest_of(&mut self, bodies: &[usize], near: bool) -> BTreeMap<[usize; 2], NearPair<S, N>> {
        let patches = self.patches;
        let names = bodies.iter().flat_map(|&patch| patches[patch].body.sides().into_iter().map(move |side| (patch, side)));
        let all: Vec<_> = names.filter_map(|(patch, side)| self.side(patch, &side).ok()).collect();
        let known = &self.joined;
        let free = all.iter().flat_map(|side| self.candidates(side)).filter(|c| c.marks.is_empty());
        let free: Vec<_> = free.filter_map(Extent::of).collect();
        let size = size(free.iter().map(|f| f.whole));
        let (mut best, mut least): (BTreeMap<[usize; 2], NearPair<S, N>>, f64) = (BTreeMap::new(), size);
        for (k, a) in free.iter().enumerate() {
            for b in free[k + 1..].iter().filter(|b| b.side().patch != a.side().patch) {
                let reach = if near { NEAR * a.facet.min(b.facet) } else { size };
                if !a.whole.inflated(reach.min(least)).meets(&b.whole) || known.hold(&a.candidate, &b.candidate) {
                    continue;
                }
                // neighbours in one plane meet in a rim
                if !mostly(&a.facets, &b.whole.inflated(reach)) && !mostly(&b.facets, &a.whole.inflated(reach)) {
                    continue;
                }
                let Some(facing) = facing_either(&a.side().trace, &b.side().trace, reach) else { continue };
                if facing.gap < 0.0 && known.are_met(a.side().patch, b.side().patch) {
                    continue;
                }
                if near && facing.distance > THIN * thickness(patches, a.side()).min(thickness(patches, b.side())) {
                    continue;
                }
                if !near {
                    least = least.min(facing.distance);
                }
                let key = [a.side().patch.min(b.side().patch), a.side().patch.max(b.side().patch)];
                if best.get(&key).is_none_or(|other| facing.distance < other.facing.distance) {
                    best.insert(key, NearPair { sides: [a.side().clone(), b.side().clone()], facing });
                }
            }
        }
        best
    }
}

/// Whether more than the share of facets, by their size, that must face another side meets its box.
fn mostly<const N: usize>(facets: &[Bounds<N>], near: &Bounds<N>) -> bool {
    let size = |b: &Bounds<N>| b.diagonal().powi(N as i32 - 1);
    facets.iter().filter(|b| near.meets(b)).map(size).sum::<f64>() > COVERED * facets.iter().map(size).sum::<f64>()
}
