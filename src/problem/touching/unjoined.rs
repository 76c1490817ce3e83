//! Sides that touch, nearly touch or overlap and that nothing joins, and bodies that overlap.
//!
//! Looked at are sides of different bodies, and opposite sides of one body, which would close it to a ring. Left out are pairs that are
//! joined or excluded, bodies that a contact lets touch, whatever its sides are, and outer sides that somebody has thought of.

use super::facing::facing_either;
use super::finding::{Finding, Position};
use super::joined_sides::JoinedSides;
use super::lengths::{Extent, SAME_PLACE, sag, size, thickness};
use super::nearest::{NEAR, THIN};
use super::overlapping::overlapping;
use super::search::Search;
use super::touching_sides::{Touching, touching_sides};
use crate::geometry::{Sag, Tree};
use crate::problem::model::BodySide;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

impl<const S: usize, const N: usize> Search<'_, S, N> {
    /// Finds sides and bodies that nothing joins: [`Finding::Unjoined`], without pairs that a finding or an error has named, then
    /// [`Finding::Overlap`] of bodies without such sides.
    ///
    /// `contacts`: pairs of bodies that a contact lets touch. `outer`: sides that are meant to be open. `closable`: whether opposite sides
    /// of a body may be joined to a ring.
    pub fn unjoined(&mut self, contacts: &[[usize; 2]], outer: &[Arc<BodySide<S, N>>], closable: &dyn Fn(usize) -> bool) {
        self.compiled.unjoined(self, contacts, outer, closable);
    }

    pub(crate) fn find_unjoined(&mut self, contacts: &[[usize; 2]], outer: &[Arc<BodySide<S, N>>], closable: &dyn Fn(usize) -> bool) {
        let patches = self.patches;
        let names = (0..patches.len()).flat_map(|patch| patches[patch].body.sides().into_iter().map(move |side| (patch, side)));
        let sides: Vec<_> = names.filter_map(|(patch, side)| self.side(patch, &side).ok()).collect();
        let all: Vec<_> = sides.iter().flat_map(|side| self.candidates(side)).filter_map(Extent::of).collect();
        let known = &self.joined;
        let groups = |a: usize, b: usize| {
            let (a, b) = (known.group(a), known.group(b));
            [a.min(b), a.max(b)]
        };
        let apart: BTreeSet<[usize; 2]> = contacts.iter().map(|&[a, b]| groups(a, b)).collect();
        let mut open = JoinedSides::default();
        open.contact(outer, &[]);
        let outside: Vec<bool> = all.iter().map(|c| open.meets(c.side())).collect();
        let allowed = |a: usize, b: usize| {
            let (p, q) = (all[a].side().patch, all[b].side().patch);
            (p != q || opposite(&all[a].side().side, &all[b].side().side) && closable(p))
                && !(outside[a] || outside[b])
                && !apart.contains(&groups(p, q))
                && !known.hold(&all[a].candidate, &all[b].candidate)
        };
        let tree = Tree::new(all.iter().map(|c| c.whole.inflated(NEAR * c.facet)).collect());
        let mut pairs: BTreeSet<[usize; 2]> = BTreeSet::new();
        for a in 0..all.len() {
            let met = tree.meeting(tree.item(a)).into_iter().filter(|&b| a < b);
            pairs.extend(met.filter(|&b| allowed(a, b)).map(|b| [a, b]));
        }
        let is_free = |k: usize| all[k].candidate.marks.is_empty();
        // sides that both press on a body, which lies between them
        let is_layered = |a: usize, b: usize| {
            let [p, q] = [a, b].map(|k| all[k].side().patch);
            let press = |r: usize| apart.contains(&groups(p, r)) && apart.contains(&groups(r, q));
            !is_free(a) && !is_free(b) && (0..patches.len()).any(press)
        };
        let found = if pairs.is_empty() { BTreeMap::new() } else { self.positions(&all, &pairs, &is_free, &is_layered) };
        let seen: BTreeSet<[usize; 2]> = found.keys().map(|pair| pair.map(|k| all[k].side().patch)).collect();
        let overlaps = overlapping(patches, &|a, b| {
            let [p, q] = groups(a, b);
            p != q && !apart.contains(&[p, q]) && !seen.contains(&[a, b])
        });
        for (pair, position) in found {
            let sides = pair.map(|k| all[k].side().clone());
            if self.tell(&sides) {
                self.findings.push(Finding::Unjoined { sides, position });
            }
        }
        self.findings.extend(overlaps.into_iter().map(|(patches, x)| Finding::Overlap { patches, x }));
    }

    /// Positions of the sides of `pairs` to each other, if they touch or nearly do; `is_free`: whether nothing joins a side; `is_layered`: whether
    /// a body lies between two sides, which are apart by its thickness.
    fn positions(
        &self,
        all: &[Extent<S, N>],
        pairs: &BTreeSet<[usize; 2]>,
        is_free: &dyn Fn(usize) -> bool,
        is_layered: &dyn Fn(usize, usize) -> bool,
    ) -> BTreeMap<[usize; 2], Position> {
        let used: Vec<usize> = pairs.iter().flatten().copied().collect::<BTreeSet<_>>().into_iter().collect();
        let place: BTreeMap<usize, usize> = used.iter().enumerate().map(|(k, &i)| (i, k)).collect();
        let sides: Vec<_> = used.iter().map(|&i| all[i].side().clone()).collect();
        let sags: Vec<Sag<S, N>> = sides.iter().map(|s| sag(self.patches, s)).collect();
        let floor = size(used.iter().map(|&i| all[i].whole)) * SAME_PLACE;
        let left_out = |a: usize, b: usize| !pairs.contains(&[used[a].min(used[b]), used[a].max(used[b])]);
        let Touching { shares, .. } = touching_sides(&sides, None, &sags, floor, &left_out);
        let mut found = BTreeMap::new();
        for &[a, b] in pairs {
            let (k, l) = (place[&a], place[&b]);
            if shares.contains_key(&(k, l)) || shares.contains_key(&(l, k)) {
                found.insert([a, b], Position::Touch);
                continue;
            }
            // the far faces of thin bodies that are joined lie in each other, those of the layers beside a thin body are joined to it, and
            // those of one body are apart
            let [p, q] = [a, b].map(|k| all[k].side().patch);
            let are_joined = self.joined.group(p) == self.joined.group(q);
            if are_joined && (p == q || !is_free(a) && !is_free(b)) {
                continue;
            }
            let reach = NEAR * all[a].facet.min(all[b].facet);
            let slit = |gap: f64| {
                let thin = [a, b].map(|k| thickness(self.patches, all[k].side()));
                0.0 < gap && gap <= THIN * thin[0].min(thin[1])
            };
            let best = facing_either(&all[a].side().trace, &all[b].side().trace, reach).filter(|f| !are_joined || slit(f.gap));
            let Some(best) = best.filter(|f| f.gap <= 0.0 || !is_layered(a, b)) else { continue };
            found.insert([a, b], if best.gap < 0.0 { Position::Overlap(best.distance) } else { Position::Apart(best.distance) });
        }
        found
    }
}

/// Whether two sides are the ends of one direction: u0 and u1.
fn opposite(a: &str, b: &str) -> bool {
    a != b && a.len() == 2 && b.len() == 2 && a.as_bytes()[0] == b.as_bytes()[0]
}
