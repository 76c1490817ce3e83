//! Depths at which a side is asked for its own piece of the exact solution.

use super::model::{BodySide, Model};
use super::own_piece::Depths;
use super::touching::sag;
use crate::geometry::{Geometry, Sag};

/// Depth at which a point lies in the body and no longer on its side, as a share of the size of the model and of its distance from the
/// origin.
const INSIDE: f64 = 1e-9;
/// Facets leave the surface that they stand for by up to this many sags.
const DEVIATION: f64 = 2.0;
/// The own piece must hold down to this many times that.
const CERTAIN: f64 = 2.0;
/// Depth down to which the own piece must hold where facets are too coarse for a sag, as a share of their size: a chord of a quarter of
/// a circle is 0.21 of its length below it.
const COARSE: f64 = 0.25;

/// A side with the deviation of its facets.
#[derive(Debug)]
pub(super) struct OwnSide<'a, const S: usize, const N: usize> {
    side: &'a BodySide<S, N>,
    sag: Sag<S, N>,
    inside: f64,
    /// Whether the surface is known that the facets stand for.
    shaped: bool,
}

impl<'a, const S: usize, const N: usize> OwnSide<'a, S, N> {
    /// Measures a side of a model; where the exact solution has no pieces there is nothing to measure.
    pub fn new(model: &'a Model<S, N>, side: &'a BodySide<S, N>) -> Self {
        let by_pieces = model.patches[side.patch].exact.as_ref().is_some_and(|exact| exact.is_piecewise());
        let shaped = by_pieces && model.patches[side.patch].is_shaped;
        let sag = if by_pieces { sag(&model.patches, side) } else { Sag::none(side.trace.facets.len()) };
        Self { side, sag, inside: INSIDE * (model.size + model.center.norm()), shaped }
    }

    /// Largest distance of an element of the side from the surface that it stands for \[length\].
    pub fn deviation(&self, element: usize) -> f64 {
        DEVIATION * self.sag.of_facet(element)
    }

    /// The depths of an element; its points may be off the side by `more`.
    pub fn depths(&self, element: usize, more: f64) -> Depths {
        let deviation = self.deviation(element) + more;
        let coarse = if deviation == 0.0 && self.shaped { COARSE * self.side.trace.space.bounds(element).diagonal() } else { 0.0 };
        Depths { own: deviation.max(self.inside), certain: (CERTAIN * deviation).max(coarse) }
    }
}
