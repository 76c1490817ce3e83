//! How much of the slave side of a tie its masters cover, and how much of it twice.
//!
//! With s_e the sum of the shares of element e that each master covers, and m_e its measure,
//!
//! ```text
//! covered = Σ m_e min(1, s_e) / Σ m_e,   doubled = Σ m_e max(0, s_e - 1) / Σ m_e.
//! ```
//!
//! Facets that stand for one curved surface end beside each other at its rim: by the part of their distance that lies along the surface. With
//! h the greatest deviations of slave and master from that surface ([`Sag`](crate::geometry::Sag)), together, a slave element of the
//! diameter d has a strip that is covered by none, or by two, of a width that they explain if
//!
//! ```text
//! |1 - s_e| d <= h.
//! ```
//!
//! Across a gap, masters that meet at an angle have such a strip as wide as the gap: h includes it for what is doubled. On other sides nothing
//! explains it.

use super::model::{BodySide, Model, Pairing, TiePart};
use super::touching::sag;
use crate::basis::Order;
use crate::geometry::{Bounds, Geometry, MapTable};
use crate::linalg::measure;
use crate::quadrature::Quadrature;

/// Largest share of a slave side that may be uncovered, or covered twice.
const ROUNDING: f64 = 1e-6;

/// What the masters of a tie cover of a slave side.
#[derive(Debug)]
pub(super) struct Coverage {
    /// Measure and sum of the shares of every slave element.
    elements: Vec<(f64, f64)>,
}

impl Coverage {
    pub fn of<const S: usize, const N: usize>(slave: &BodySide<S, N>, pairings: &[Pairing<S, N>]) -> Self {
        let mut map = MapTable::new();
        let of = |e: usize| {
            let rule = slave.rules.rule(e);
            slave.trace.space.map(e, &rule.points, Order::Gradients, &mut map);
            let size = rule.weights.iter().zip(&map.jacobian).map(|(w, j)| w * measure(j)).sum();
            (size, pairings.iter().map(|p| p.segments.report.share[e]).sum())
        };
        Self { elements: (0..slave.trace.space.num_elements()).map(of).collect() }
    }

    /// The share of the side that some master covers.
    pub fn covered(&self) -> f64 {
        self.share(|s| s.min(1.0))
    }

    /// The share of the side that two masters cover.
    pub fn doubled(&self) -> f64 {
        self.share(|s| (s - 1.0).max(0.0))
    }

    pub fn is_whole(&self) -> bool {
        self.covered() >= 1.0 - ROUNDING
    }

    fn share(&self, of: impl Fn(f64) -> f64) -> f64 {
        self.elements.iter().map(|(size, s)| size * of(*s)).sum::<f64>() / self.elements.iter().map(|e| e.0).sum::<f64>()
    }
}

impl<const S: usize, const N: usize> Model<S, N> {
    /// Whether facets explain what is uncovered, and what is covered twice, of every element of a slave side.
    pub(super) fn facets_explain(&self, slave: &BodySide<S, N>, pairings: &[Pairing<S, N>], coverage: &Coverage) -> [bool; 2] {
        if coverage.is_whole() && coverage.doubled() <= ROUNDING {
            return [true; 2];
        }
        let of_masters = pairings.iter().map(|p| sag(&self.patches, &p.master).greatest()).fold(0.0, f64::max);
        let explained = sag(&self.patches, slave).greatest() + of_masters;
        let gap = pairings.iter().map(|p| p.segments.report.distance).fold(0.0, f64::max);
        let boxes = slave.trace.space.all_bounds();
        let elements = || boxes.iter().map(Bounds::diagonal).zip(coverage.elements.iter().map(|e| e.1));
        [
            coverage.is_whole() || elements().all(|(d, s)| (1.0 - s) * d <= explained),
            coverage.doubled() <= ROUNDING || elements().all(|(d, s)| (s - 1.0) * d <= explained + gap),
        ]
    }
}

impl<const S: usize, const N: usize> TiePart<S, N> {
    /// The share of the slave side that is not tied, where it is more than rounding.
    pub(super) fn uncovered(&self) -> Option<f64> {
        let coverage = Coverage::of(&self.slave, &self.pairings);
        (!coverage.is_whole()).then(|| 1.0 - coverage.covered())
    }
}
