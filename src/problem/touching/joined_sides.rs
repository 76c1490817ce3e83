//! Facets that are joined already: sides may overlap, so that names of sides do not identify them.

use super::paired_sides::PairedSides;
use super::partly_joined::Candidate;
use crate::problem::facet_owners::{FacetKey, facet_keys};
use crate::problem::model::BodySide;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// Shares that differ by less than this are equal.
const SAME: f64 = 1e-9;

/// Two sides (body, name), the lesser first.
pub(super) type SidePair = [(usize, String); 2];

/// The pair of two sides.
pub(super) fn side_pair(a: (usize, &str), b: (usize, &str)) -> SidePair {
    let [a, b] = if a <= b { [a, b] } else { [b, a] };
    [a, b].map(|(body, name)| (body, name.to_owned()))
}

/// The body and the name of a side.
pub(super) fn key<const S: usize, const N: usize>(side: &BodySide<S, N>) -> (usize, &str) {
    (side.patch, &side.side)
}

/// (couple, whether as slave) for every couple that a side is part of.
pub(super) type Marks = BTreeSet<(usize, bool)>;

/// Bodies that hang together.
#[derive(Clone, Debug, Default)]
struct Groups(BTreeMap<usize, usize>);

impl Groups {
    /// The body that stands for all that a body hangs together with.
    fn of(&self, body: usize) -> usize {
        self.0.get(&body).copied().unwrap_or(body)
    }

    fn join(&mut self, a: usize, b: usize) {
        let [from, to] = [a, b].map(|k| *self.0.entry(k).or_insert(k));
        self.0.values_mut().filter(|group| **group == from).for_each(|group| *group = to);
    }
}

/// Pairs of sides that are excluded from the search: named elsewhere, or joined already.
#[derive(Clone, Debug, Default)]
pub(super) struct JoinedSides {
    named: BTreeSet<SidePair>,
    /// Of the named ones those that are excluded where both sides are joined, to whatever it may be.
    rest: BTreeSet<SidePair>,
    /// (couple, whether as slave) for every couple that a facet is part of.
    of_facet: BTreeMap<FacetKey, Vec<(usize, bool)>>,
    couples: usize,
    /// Bodies that couples join.
    tied: Groups,
    /// Bodies that couples or contacts bring together.
    met: Groups,
}

impl JoinedSides {
    /// Excludes a pair of sides.
    pub fn exclude(&mut self, pair: SidePair) {
        self.named.insert(pair);
    }

    /// Restricts the exclusion of a pair of sides by its names to parts that are joined, to whatever it may be.
    pub fn include_rest(&mut self, pair: SidePair) {
        self.rest.insert(pair);
    }

    /// Joins the sides of a couple.
    pub fn join<const S: usize, const N: usize>(&mut self, couple: &PairedSides<S, N>) {
        self.contact(std::slice::from_ref(&couple.slave), &couple.masters);
        couple.masters.iter().for_each(|master| self.tied.join(couple.slave.patch, master.patch));
    }

    /// Marks the facets of sides that meet, every slave with all masters.
    pub fn contact<const S: usize, const N: usize>(&mut self, slaves: &[Arc<BodySide<S, N>>], masters: &[Arc<BodySide<S, N>>]) {
        for (side, slave) in masters.iter().map(|m| (m, false)).chain(slaves.iter().map(|s| (s, true))) {
            facet_keys(side).for_each(|f| self.of_facet.entry(f).or_default().push((self.couples, slave)));
        }
        self.couples += 1;
        slaves.iter().flat_map(|s| masters.iter().map(move |m| (s.patch, m.patch))).for_each(|(a, b)| self.met.join(a, b));
    }

    /// The body that stands for all that couples join with a body.
    pub fn group(&self, body: usize) -> usize {
        self.tied.of(body)
    }

    /// Whether couples and contacts bring two bodies together.
    pub fn are_met(&self, a: usize, b: usize) -> bool {
        self.met.of(a) == self.met.of(b)
    }

    /// The couples that the facets of a side are part of, per facet.
    pub fn marks_of_facets<const S: usize, const N: usize>(&self, side: &BodySide<S, N>) -> Vec<Marks> {
        facet_keys(side).map(|f| self.of_facet.get(&f).into_iter().flatten().copied().collect()).collect()
    }

    /// Whether a couple has a facet of a side.
    pub fn meets<const S: usize, const N: usize>(&self, side: &BodySide<S, N>) -> bool {
        facet_keys(side).any(|f| self.of_facet.contains_key(&f))
    }

    /// Whether a pair of sides is excluded.
    pub fn hold<const S: usize, const N: usize>(&self, a: &Candidate<S, N>, b: &Candidate<S, N>) -> bool {
        let pair = side_pair(key(&a.side), key(&b.side));
        let is_rest = self.rest.contains(&pair) && (a.marks.is_empty() || b.marks.is_empty());
        self.named.contains(&pair) && !is_rest || a.marks.iter().any(|&(couple, slave)| b.marks.contains(&(couple, !slave)))
    }
}

/// Restricts `shares` to sides without common facets: of overlapping sides the largest of the fully covered ones is kept, else the smallest
/// (`touched`: share of a side's facets on any other); where that leaves out a facet, the largest of all.
///
/// # Errors
/// Indices of a dropped side and of one it touches with facets that lie on no kept side.
pub(super) fn disjoint<const S: usize, const N: usize>(
    all: &[Arc<BodySide<S, N>>],
    shares: &mut BTreeMap<(usize, usize), f64>,
    touched: &[f64],
) -> Result<(), [usize; 2]> {
    let mut order: Vec<usize> = shares.keys().flat_map(|&(a, b)| [a, b]).collect::<BTreeSet<_>>().into_iter().collect();
    order.sort_by_key(|&k| {
        let (covered, facets) = (touched[k] >= 1.0 - SAME, all[k].trace.facets.len());
        (!covered, if covered { usize::MAX - facets } else { facets })
    });
    let kept = kept_in(all, shares, &order).or_else(|beyond| {
        order.sort_by_key(|&k| usize::MAX - all[k].trace.facets.len());
        kept_in(all, shares, &order).map_err(|_| beyond)
    })?;
    shares.retain(|(a, b), _| kept[*a] && kept[*b]);
    Ok(())
}

/// Whether a side is kept, by which those with common facets that come later in `order` are dropped.
///
/// # Errors
/// Those of [`disjoint`].
fn kept_in<const S: usize, const N: usize>(
    all: &[Arc<BodySide<S, N>>],
    shares: &BTreeMap<(usize, usize), f64>,
    order: &[usize],
) -> Result<Vec<bool>, [usize; 2]> {
    let mut taken: BTreeSet<FacetKey> = BTreeSet::new();
    let mut kept = vec![false; all.len()];
    for &k in order {
        kept[k] = facet_keys(&all[k]).all(|f| !taken.contains(&f));
        if kept[k] {
            taken.extend(facet_keys(&all[k]));
        }
    }
    // facets of a patch on a kept side, and on all kept sides of a patch: they must include those of a dropped side
    let facets = |a: usize, share: f64| share * all[a].trace.facets.len() as f64;
    let mut on_side: BTreeMap<(usize, usize), f64> = BTreeMap::new();
    let mut on_patch: BTreeMap<(usize, usize), f64> = BTreeMap::new();
    for (&(a, b), &share) in shares.iter().filter(|((a, b), _)| kept[*a] && kept[*b]) {
        *on_side.entry((all[a].patch, b)).or_default() += facets(a, share);
        *on_patch.entry((all[a].patch, all[b].patch)).or_default() += facets(a, share);
    }
    for (&(a, b), &share) in shares.iter().filter(|((a, b), _)| !kept[*a] || !kept[*b]) {
        let found = if kept[b] { on_side.get(&(all[a].patch, b)) } else { on_patch.get(&(all[a].patch, all[b].patch)) };
        if facets(a, share) > found.copied().unwrap_or(0.0) + 0.5 {
            return Err([a, b]);
        }
    }
    Ok(kept)
}
