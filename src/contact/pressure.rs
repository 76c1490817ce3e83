//! What a contact transmits: pressure, force, moment, and the zone where it is closed.
//!
//! lambda = sum_j lambda_j ψ_j is the normal stress sigma_N <= 0, pressure = -lambda [force/area]. With n out of the
//! master the traction on the slave is -lambda n: what the master does to the slave.

use super::Contact;
use crate::basis::{Basis, Order, ShapeTable};
use crate::coupling::interface::Chain;
use crate::geometry::Geometry;
use crate::linalg::{Real, Vector, lit};

/// Pressures below this share of the largest are round-off.
const NO_PRESSURE: f64 = 1e-10;
/// A zone that ends within this share of the side's length of an end of the side ends there.
const AT_SIDE_END: f64 = 1e-9;

/// Sums and extremes over a contact side.
#[derive(Clone, Debug, PartialEq)]
pub struct Transmitted<const N: usize, T: Real = f64> {
    /// What the master does to the slave [force; 2D: per thickness].
    pub force: Vector<N, T>,
    /// Its moment about the origin: (0, 0, m) in 2D.
    pub moment: [T; 3],
    /// Least pressure at the points of the segments.
    pub least_pressure: T,
    /// Largest pressure there.
    pub largest_pressure: T,
    /// Measure of the zone with pressure, integrated on segments.
    pub area: T,
    /// Pressure per point of the segments.
    pub pressure: Vec<T>,
}

impl<const S: usize, const N: usize, T: Real> Contact<S, N, T> {
    /// Pressure at the points of the segments for the multipliers `lambda`.
    pub fn pressure(&self, multiplier: &dyn Basis<S, T>, lambda: &[T]) -> Vec<T> {
        let mut pressure = Vec::with_capacity(self.segments.ds.len());
        let (mut table, mut ids) = (ShapeTable::new(), Vec::new());
        for piece in 0..self.segments.num_pieces() {
            let (element, points) = (self.segments.slave[piece], self.segments.points(piece));
            multiplier.active(element, &mut ids);
            multiplier.tabulate(element, &self.segments.slave_xi[points.clone()], Order::Values, &mut table);
            pressure.extend((0..points.len()).map(|q| -ids.iter().zip(table.values(q)).fold(T::zero(), |s, (&j, &v)| s + lambda[j] * v)));
        }
        pressure
    }

    /// Force, moment, pressures and zone for the multipliers `lambda`.
    pub fn transmitted(&self, multiplier: &dyn Basis<S, T>, lambda: &[T]) -> Transmitted<N, T> {
        let pressure = self.pressure(multiplier, lambda);
        let largest = pressure.iter().fold(T::zero(), |m, &p| m.max(p));
        let mut out = Transmitted {
            force: Vector::zeros(),
            moment: [T::zero(); 3],
            least_pressure: pressure.iter().copied().reduce(|a, b| a.min(b)).unwrap_or_else(T::zero),
            largest_pressure: pressure.iter().copied().reduce(|a, b| a.max(b)).unwrap_or_else(T::zero),
            area: T::zero(),
            pressure: Vec::new(),
        };
        for (q, &p) in pressure.iter().enumerate() {
            let ds = self.segments.ds[q];
            let pull = self.frames.normal[q] * (p * ds);
            out.force += pull;
            let at = |v: &Vector<N, T>, k: usize| if k < N { v[k] } else { T::zero() };
            for k in 0..3 {
                let (i, j) = ((k + 1) % 3, (k + 2) % 3);
                out.moment[k] += at(&self.frames.x[q], i) * at(&pull, j) - at(&self.frames.x[q], j) * at(&pull, i);
            }
            if p > largest * lit(NO_PRESSURE) {
                out.area += ds;
            }
        }
        out.pressure = pressure;
        out
    }
}

/// Half the extent of the zone with pressure along the slave side; all of it where it ends at an end of the side, as in
/// half models. Zero without pressure.
///
/// The extent is measured along the curve, between the outermost points with pressure, each carried on to the end of its
/// piece.
pub fn half_width<const N: usize, T: Real>(slave: &dyn Geometry<1, N, T>, contact: &Contact<1, N, T>, pressure: &[T]) -> T {
    let chain = Chain::of(slave);
    let walk = chain.walk();
    let largest = pressure.iter().fold(T::zero(), |m, &p| m.max(p));
    // length of every element, by the same points as its pieces where they cover it
    let mut zone = vec![[T::zero(); 2]; slave.num_elements()]; // first and last arc length with pressure, within the element
    let mut touched = vec![false; slave.num_elements()];
    let mut length = chain.lengths.clone();
    for run in contact.segments.runs() {
        let element = contact.segments.slave[run.start];
        let mut at = T::zero();
        for piece in run {
            for q in contact.segments.points(piece) {
                let ds = contact.segments.ds[q];
                if pressure[q] > largest * lit(NO_PRESSURE) {
                    if !touched[element] {
                        (touched[element], zone[element][0]) = (true, at);
                    }
                    zone[element][1] = at + ds;
                }
                at += ds;
            }
        }
        length[element] = length[element].max(at);
    }
    let (mut start, mut first, mut last) = (T::zero(), None, T::zero());
    for &(element, reversed) in &walk {
        if touched[element] {
            let [a, b] = zone[element];
            let [a, b] = if reversed { [length[element] - b, length[element] - a] } else { [a, b] };
            first = first.or(Some(start + a));
            last = start + b;
        }
        start += length[element];
    }
    let Some(first) = first else { return T::zero() };
    let is_closed = walk.first().is_some_and(|&(e, r)| chain.neighbour(e, usize::from(r)).is_some());
    let margin = start * lit(AT_SIDE_END);
    if !is_closed && (first <= margin || last >= start - margin) { last - first } else { (last - first) * lit(0.5) }
}
