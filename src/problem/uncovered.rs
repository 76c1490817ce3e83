//! Slave sides of ties of which the masters leave a part uncovered.
//!
//! Facets that stand for one curved surface end beside each other at its rim: by the part of their distance that lies along the surface. With
//! h the greatest deviations of slave and master from that surface ([`Sag`](crate::geometry::Sag)), together, a slave element of the
//! diameter d whose share s is covered loses a strip of a width that they explain if
//!
//! ```text
//! (1 - s) d <= h.
//! ```
//!
//! On other sides nothing explains a part that is uncovered.

use super::model::{BodySide, Model, Pairing, TiePart};
use super::touching::sag;
use crate::geometry::{Bounds, Geometry};

/// Largest share of a slave side that may be uncovered.
pub(super) const UNCOVERED: f64 = 1e-6;

impl<const S: usize, const N: usize> Model<S, N> {
    /// Whether facets explain what is uncovered of every element of a slave side.
    pub(super) fn facets_explain(&self, slave: &BodySide<S, N>, pairings: &[Pairing<S, N>]) -> bool {
        let of_masters = pairings.iter().map(|p| sag(&self.patches, &p.master).greatest()).fold(0.0, f64::max);
        let explained = sag(&self.patches, slave).greatest() + of_masters;
        let boxes = slave.trace.space.all_bounds();
        let open = |element: usize| 1.0 - pairings.iter().map(|p| p.segments.report.share[element]).sum::<f64>();
        boxes.iter().map(Bounds::diagonal).enumerate().all(|(element, diameter)| open(element) * diameter <= explained)
    }
}

impl<const S: usize, const N: usize> TiePart<S, N> {
    /// The share of the slave side that is not tied, where it is more than rounding.
    pub(super) fn uncovered(&self) -> Option<f64> {
        let total = self.pairings.first()?.segments.report.slave_measure;
        let covered: f64 = self.pairings.iter().map(|p| p.segments.report.covered).sum();
        (covered < (1.0 - UNCOVERED) * total).then(|| 1.0 - covered / total)
    }
}
