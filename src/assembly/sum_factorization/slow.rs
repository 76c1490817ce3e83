//! Contraction along the slowest direction, one element at a time, into the ring of sums.
//!
//! u0 = N_i' T_dd + N_i T_0d, u1 = N_i' T_d0 + N_i T_00, sum_(i,j) += u0 N_j' + u1 N_j: 4 + 2 (p + 1) products.

use super::axis::Axis;
use super::lanes::rows;
use pulp::Simd;

/// Sums of pairs (i, j) of the slowest direction that are not complete yet, at slot max(i, j) mod `slots`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ring {
    /// Number of slots.
    pub slots: usize,
    /// Distance of neighbouring pairs of one slot.
    pub pair: usize,
    /// Start.
    pub start: usize,
}

impl Ring {
    /// Place of the pair (i, j) of an axis with `active` functions per element.
    #[inline(always)]
    pub fn at(&self, active: usize, i: usize, j: usize) -> usize {
        self.start + ((i.max(j) % self.slots) * (2 * active - 1) + (i + active - 1 - j)) * self.pair
    }
}

/// Adds element `e` to `count` neighbouring pairs of the middle direction: `t[(pair * points + point - origin) * 4 + type]`.
///
/// The first element of a pair writes, later ones add. Pairs of the middle direction run inside, because their sums follow
/// each other in memory.
#[inline(always)]
pub(super) fn contract<S: Simd, const NP: usize>(
    simd: S,
    axis: &Axis,
    e: usize,
    t: &[S::f64s],
    [count, points, origin]: [usize; 3],
    ring: Ring,
    sums: &mut [S::f64s],
) {
    let zero = simd.splat_f64s(0.0);
    let first = axis.first[e];
    let range = axis.start[e]..axis.start[e + 1];
    let (values, slopes) = (&rows::<NP>(&axis.values)[range.clone()], &rows::<NP>(&axis.slopes)[range.clone()]);
    let width = range.len() * 4;
    for a in 0..NP {
        let (mut places, mut starts) = ([0; NP], [false; NP]);
        for b in 0..NP {
            places[b] = ring.at(NP, first + a, first + b);
            starts[b] = axis.support[first + a.max(b)].0 == e;
        }
        let mut from = (range.start - origin) * 4;
        for k in 0..count {
            let mut acc = [zero; NP];
            let here = t[from..from + width].chunks_exact(4);
            for (t, (values, slopes)) in here.zip(values.iter().zip(slopes)) {
                let (v, s) = (simd.splat_f64s(values[a]), simd.splat_f64s(slopes[a]));
                let u0 = simd.mul_add_e_f64s(t[0], s, simd.mul_f64s(t[2], v));
                let u1 = simd.mul_add_e_f64s(t[1], s, simd.mul_f64s(t[3], v));
                for b in 0..NP {
                    let (v, s) = (simd.splat_f64s(values[b]), simd.splat_f64s(slopes[b]));
                    acc[b] = simd.mul_add_e_f64s(u1, v, simd.mul_add_e_f64s(u0, s, acc[b]));
                }
            }
            for b in 0..NP {
                let sum = &mut sums[places[b] + k];
                *sum = if starts[b] { acc[b] } else { simd.add_f64s(*sum, acc[b]) };
            }
            from += points * 4;
        }
    }
}

/// As [`contract`] for products of values: `t[pair * points + point - origin]`.
#[inline(always)]
pub(super) fn values<S: Simd, const NP: usize>(
    simd: S,
    axis: &Axis,
    e: usize,
    t: &[S::f64s],
    [count, points, origin]: [usize; 3],
    ring: Ring,
    sums: &mut [S::f64s],
) {
    let first = axis.first[e];
    let range = axis.start[e]..axis.start[e + 1];
    let tables = &rows::<NP>(&axis.values)[range.clone()];
    for a in 0..NP {
        let mut from = range.start - origin;
        for k in 0..count {
            let mut acc = [simd.splat_f64s(0.0); NP];
            for (t, values) in t[from..from + range.len()].iter().zip(tables) {
                let u = simd.mul_f64s(*t, simd.splat_f64s(values[a]));
                for b in 0..NP {
                    acc[b] = simd.mul_add_e_f64s(u, simd.splat_f64s(values[b]), acc[b]);
                }
            }
            for b in 0..NP {
                let sum = &mut sums[ring.at(NP, first + a, first + b) + k];
                let starts = axis.support[first + a.max(b)].0 == e;
                *sum = if starts { acc[b] } else { simd.add_f64s(*sum, acc[b]) };
            }
            from += points;
        }
    }
}
