//! Lengths of sides: the sag of their facets, the size of these, the thickness of the body behind them.

use super::partly_joined::Candidate;
use crate::geometry::{Bounds, Kinks, Sag};
use crate::problem::model::{BodyModel, BodySide, Whole};
use crate::space::{Trace, measure};
use std::sync::Arc;

/// Distances below this fraction of the size of all sides count as zero.
pub(super) const SAME_PLACE: f64 = 1e-8;

/// Returns the sag of a side's facets: zero if they are the surface itself; for refined meshes that of the unrefined facets. A piece has that of
/// its facets on the whole side, since those of an arc in two chords are pieces, too.
pub fn sag<const S: usize, const N: usize>(patches: &[BodyModel<S, N>], side: &BodySide<S, N>) -> Sag<S, N> {
    match &side.whole {
        None => sag_between(patches, side, Kinks::OfPlanes),
        Some(Whole { side, elements }) => {
            if let Some(known) = side.sag_of_pieces.get() {
                return known.of_elements(elements);
            }
            // made outside of the cell: no thread waits for another one there
            let made = sag_between(patches, side, Kinks::OfSureWalls);
            side.sag_of_pieces.get_or_init(|| made).of_elements(elements)
        }
    }
}

fn sag_between<const S: usize, const N: usize>(patches: &[BodyModel<S, N>], side: &BodySide<S, N>, kinks: Kinks) -> Sag<S, N> {
    let patch = &patches[side.patch];
    if patch.exact_map {
        return Sag::none(side.trace.facets.len());
    }
    let of = |trace: &Trace<S, N>| Sag::between(&*trace.space, &trace.outward, kinks);
    let of_parts = || {
        let whole = patch.unrefined.as_ref()?.trace(&side.side).ok()?;
        of(&whole).of_parts(&*whole.space, &*side.trace.space)
    };
    of_parts().unwrap_or_else(|| of(&side.trace))
}

/// Largest admissible distance of points of faceted sides \[length\]: four times the largest of the `sags`, at least twice `floor`.
pub(super) fn widest<const S: usize, const N: usize>(sags: &[Sag<S, N>], floor: f64) -> f64 {
    (4.0 * sags.iter().map(Sag::greatest).fold(0.0, f64::max)).max(2.0 * floor)
}

/// Largest gap or overlap of two sides, or of a side and an obstacle, that their facets explain \[length\]: twice the sum of the greatest
/// sags of both, and no less than what counts as zero.
pub fn explained<const S: usize, const N: usize>(
    patches: &[BodyModel<S, N>],
    slave: &Arc<BodySide<S, N>>,
    masters: &[Arc<BodySide<S, N>>],
) -> f64 {
    let of = |side: &Arc<BodySide<S, N>>| sag(patches, side).greatest();
    let all: Vec<_> = std::iter::once(slave).chain(masters).cloned().collect();
    (2.0 * (of(slave) + masters.iter().map(of).fold(0.0, f64::max))).max(floor(&all))
}

/// Diagonal of the box around all `boxes` \[length\].
pub(super) fn size<const N: usize>(boxes: impl Iterator<Item = Bounds<N>>) -> f64 {
    boxes.reduce(|a, b| a.union(&b)).map_or(0.0, |b| b.diagonal())
}

/// Distance that counts as zero \[length\].
pub fn floor<const S: usize, const N: usize>(sides: &[Arc<BodySide<S, N>>]) -> f64 {
    size(sides.iter().flat_map(|s| s.trace.space.all_bounds())) * SAME_PLACE
}

/// Mean thickness of the body behind a side: its volume over the area of the side \[length\].
pub(super) fn thickness<const S: usize, const N: usize>(patches: &[BodyModel<S, N>], side: &BodySide<S, N>) -> f64 {
    measure::<N, N, f64, _>(&**patches[side.patch].body.space()) / measure::<S, N, f64, _>(&*side.trace.space)
}

/// A side with its boxes.
#[derive(Debug)]
pub(super) struct Extent<const S: usize, const N: usize> {
    pub candidate: Candidate<S, N>,
    /// Box of every facet.
    pub facets: Vec<Bounds<N>>,
    /// Box of all facets.
    pub whole: Bounds<N>,
    /// Mean size of a facet \[length\].
    pub facet: f64,
}

impl<const S: usize, const N: usize> Extent<S, N> {
    /// Returns the boxes of a side; `None` for one without facets.
    pub fn of(candidate: Candidate<S, N>) -> Option<Self> {
        let facets = candidate.side.trace.space.all_bounds();
        let whole = facets.iter().copied().reduce(|a, b| a.union(&b))?;
        let facet = facets.iter().map(Bounds::diagonal).sum::<f64>() / facets.len() as f64;
        Some(Self { candidate, facets, whole, facet })
    }

    /// The side.
    pub fn side(&self) -> &Arc<BodySide<S, N>> {
        &self.candidate.side
    }
}
