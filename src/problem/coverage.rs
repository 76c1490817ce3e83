//! Shares of the slave side of a tie that its masters cover, and that two of them cover.
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
//! A master that is farther than twice the others and covers no more than such a strip of what they cover wholly is none of the slave: it is that
//! of a neighbour, beyond a corner or a step.
//!
//! Across a gap, masters that meet at an angle have such a strip, of up to twice the gap, of which a thin element is the larger share: h includes
//! eight times the gap for what is doubled. On other sides nothing explains it.
//!
//! What is half of the side or more is no strip: there masters lie behind each other.

use super::model::{BodySide, Model, Pairing, TiePart};
use super::touching::sag;
use crate::geometry::{Bounds, Geometry, MapTable};

/// Largest share of a slave side that may be uncovered, or covered twice.
const ROUNDING: f64 = 1e-6;

/// Distance over that of all others from which on a master may be that of a neighbour.
const FARTHER: f64 = 2.0;
/// Width over gap, and diameter over width, of a strip that two masters cover where they meet at an angle, together.
const STRIP: f64 = 8.0;
/// Share of the side that a strip is less than.
const HALF: f64 = 0.5;

/// The shares of a slave side's elements that the masters of a tie cover.
#[derive(Debug)]
pub(super) struct SlaveCoverage {
    /// Measure and sum of the shares of every slave element.
    elements: Vec<(f64, f64)>,
}

impl SlaveCoverage {
    pub fn of<'a, const S: usize, const N: usize>(slave: &BodySide<S, N>, pairings: impl IntoIterator<Item = &'a Pairing<S, N>>) -> Self {
        let (mut map, pairings) = (MapTable::new(), pairings.into_iter().collect::<Vec<_>>());
        let of = |e: usize| (slave.measure_of(e, &mut map), pairings.iter().map(|p| p.segments.report.share[e]).sum());
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
    /// The number of a master that is none of the slave side, if there is one: others cover the side, nearer than a half.
    pub(super) fn master_of_neighbour(&self, slave: &BodySide<S, N>, pairings: &[Pairing<S, N>]) -> Option<usize> {
        if pairings.len() < 2 {
            return None;
        }
        let distance = |p: &Pairing<S, N>| p.segments.report.distance;
        let (k, farthest) = pairings.iter().enumerate().max_by(|a, b| distance(a.1).total_cmp(&distance(b.1)))?;
        let others = || pairings.iter().enumerate().filter(|(other, _)| *other != k).map(|(_, p)| p);
        let next = others().map(distance).fold(0.0, f64::max);
        let covered = SlaveCoverage::of(slave, others());
        if distance(farthest) <= FARTHER * next || !covered.is_whole() {
            return None;
        }
        let explained = sag(&self.patches, slave).greatest() + sag(&self.patches, &farthest.master).greatest();
        let strip = explained + STRIP * distance(farthest);
        let boxes = slave.trace.space.all_bounds();
        let is_narrow = SlaveCoverage::of(slave, [farthest]).covered() < HALF;
        let is_strip = is_narrow && boxes.iter().zip(&farthest.segments.report.share).all(|(b, share)| share * b.diagonal() <= strip);
        is_strip.then_some(k)
    }

    /// Whether facets explain what is uncovered, and what is covered twice, of every element of a slave side.
    pub(super) fn facets_explain(&self, slave: &BodySide<S, N>, pairings: &[Pairing<S, N>], coverage: &SlaveCoverage) -> [bool; 2] {
        if coverage.is_whole() && coverage.doubled() <= ROUNDING {
            return [true; 2];
        }
        let of_masters = pairings.iter().map(|p| sag(&self.patches, &p.master).greatest()).fold(0.0, f64::max);
        let explained = sag(&self.patches, slave).greatest() + of_masters;
        let gap = if coverage.doubled() < HALF { pairings.iter().map(|p| p.segments.report.distance).fold(0.0, f64::max) } else { 0.0 };
        let boxes = slave.trace.space.all_bounds();
        let elements = || boxes.iter().map(Bounds::diagonal).zip(coverage.elements.iter().map(|e| e.1));
        [
            coverage.is_whole() || elements().all(|(d, s)| (1.0 - s) * d <= explained),
            coverage.doubled() <= ROUNDING || elements().all(|(d, s)| (s - 1.0) * d <= explained + STRIP * gap),
        ]
    }
}

impl<const S: usize, const N: usize> TiePart<S, N> {
    /// The share of the slave side that is not tied, where it is more than rounding.
    pub(super) fn uncovered(&self) -> Option<f64> {
        let coverage = SlaveCoverage::of(&self.slave, &self.pairings);
        (!coverage.is_whole()).then(|| 1.0 - coverage.covered())
    }
}
