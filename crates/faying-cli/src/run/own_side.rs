//! Depths at which a side is asked for its own piece of the exact solution.

use crate::build::sag;
use crate::case::Case;
use faying::basis::Order;
use faying::geometry::{MapTable, Sag, cell};
use faying::linalg::Vector;
use faying::problem::{Depths, Model, SideModel};

/// Depth at which a point lies in the body and no longer on its side, as a share of the size of the model and of its distance from the
/// origin.
const INSIDE: f64 = 1e-9;
/// Facets leave the surface that they stand for by up to this many sags.
const DEVIATION: f64 = 2.0;
/// The own piece must hold down to this many times that.
const CERTAIN: f64 = 2.0;
/// Depth down to which the own piece must hold where facets are too coarse for a sag, as a share of the element behind them.
const COARSE: f64 = 0.5;

/// A side with the deviation of its facets.
#[derive(Debug)]
pub struct OwnSide<'a, const S: usize, const N: usize> {
    model: &'a Model<S, N>,
    side: &'a SideModel<S, N>,
    sag: Sag<S, N>,
    inside: f64,
    /// Whether the surface is known that the facets stand for.
    shaped: bool,
}

impl<'a, const S: usize, const N: usize> OwnSide<'a, S, N> {
    /// Measures a side of the model of `case`; where the exact solution has no pieces there is nothing to measure.
    pub fn new(case: &Case, model: &'a Model<S, N>, side: &'a SideModel<S, N>) -> Self {
        let by_pieces = model.exact.as_ref().is_some_and(|exact| exact.is_piecewise());
        let mesh = case.patches[side.patch].geometry.shape.part().is_some_and(|part| part.is_mesh());
        let shaped = by_pieces && !mesh && !model.patches[side.patch].exact_map;
        let sag = if by_pieces { sag(case, &model.patches, side) } else { Sag::none(side.trace.facets.len()) };
        Self { model, side, sag, inside: INSIDE * (model.size + model.center.norm()), shaped }
    }

    /// Largest distance of an element of the side from the surface that it stands for \[length\].
    pub fn deviation(&self, element: usize) -> f64 {
        DEVIATION * self.sag.of_facet(element)
    }

    /// The depths of an element; its points may be off the side by `more`.
    pub fn depths(&self, element: usize, more: f64) -> Depths {
        let deviation = self.deviation(element) + more;
        let coarse = if deviation == 0.0 && self.shaped { COARSE * self.thickness(element) } else { 0.0 };
        Depths { own: deviation.max(self.inside), certain: (CERTAIN * deviation).max(coarse) }
    }

    /// Thickness of the element behind an element of the side: twice the distance of their centres along the normal.
    fn thickness(&self, element: usize) -> f64 {
        let trace = &self.side.trace;
        let (space, facet) = (self.model.patches[self.side.patch_of(element)].body.space(), &trace.facets[element]);
        let (mut on_side, mut behind) = (MapTable::<S, N>::new(), MapTable::<N, N>::new());
        trace.space.map(element, &[cell::center(trace.space.cell(element))], Order::Gradients, &mut on_side);
        space.map(facet.element, &[cell::center(space.cell(facet.element))], Order::Values, &mut behind);
        let normal: Vector<N> = trace.normal(element, &on_side.jacobian[0]);
        2.0 * (on_side.x[0] - behind.x[0]).dot(&normal).abs()
    }
}
