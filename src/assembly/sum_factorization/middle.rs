//! Contraction along the middle direction of a solid: lanes are pairs of functions of the fastest one.
//!
//! Nine components (slow, middle, neither) x (slow, middle, neither) become four: derivative or value of test and trial
//! function in the slow direction.

use super::axis::Axis;
use super::lanes::rows;
use pulp::Simd;
use std::ops::Range;

/// Components on entry, (test, trial) with 0 slow, 1 middle, 2 neither.
pub(super) const COMPONENTS: usize = 9;

/// Places of the points of the middle direction.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tiles<'a> {
    /// Offset of all places.
    pub start: usize,
    /// First point that has a place.
    pub origin: usize,
    /// Places of the points.
    pub places: &'a [usize],
}

/// All pairs (i, j) of function `i` on some of its elements: `out[((j - i + active - 1) * points + point) * 4 + type]`, which must be zero.
///
/// `components` holds the place of each component (test, trial).
#[inline(always)]
pub(super) fn contract<S: Simd, const NP: usize>(
    simd: S,
    axis: &Axis,
    (i, elements): (usize, Range<usize>),
    t: &[S::f64s],
    at: Tiles<'_>,
    components: &[usize; COMPONENTS],
    out: &mut [S::f64s],
    [point, points]: [usize; 2],
) {
    let zero = simd.splat_f64s(0.0);
    let [xx, xy, xn, yx, yy, yn, nx, ny, nn] = *components;
    for e in elements {
        let a = i - axis.first[e];
        let mut acc = [[zero; 4]; NP];
        for q in axis.start[e]..axis.start[e + 1] {
            let place = at.start + at.places[q - at.origin];
            let t = &t[place..place + COMPONENTS];
            let (values, slopes) = (&rows::<NP>(&axis.values)[q], &rows::<NP>(&axis.slopes)[q]);
            let (v, s) = (simd.splat_f64s(values[a]), simd.splat_f64s(slopes[a]));
            let dd = simd.mul_f64s(t[xx], v);
            let ds = simd.mul_f64s(t[xy], v);
            let dv = simd.mul_f64s(t[xn], v);
            let zd = simd.mul_add_e_f64s(t[yx], s, simd.mul_f64s(t[nx], v));
            let zs = simd.mul_add_e_f64s(t[yy], s, simd.mul_f64s(t[ny], v));
            let zv = simd.mul_add_e_f64s(t[yn], s, simd.mul_f64s(t[nn], v));
            for b in 0..NP {
                let (v, s) = (simd.splat_f64s(values[b]), simd.splat_f64s(slopes[b]));
                acc[b][0] = simd.mul_add_e_f64s(dd, v, acc[b][0]);
                acc[b][1] = simd.mul_add_e_f64s(dv, v, simd.mul_add_e_f64s(ds, s, acc[b][1]));
                acc[b][2] = simd.mul_add_e_f64s(zd, v, acc[b][2]);
                acc[b][3] = simd.mul_add_e_f64s(zv, v, simd.mul_add_e_f64s(zs, s, acc[b][3]));
            }
        }
        for b in 0..NP {
            let place = ((b + NP - 1 - a) * points + point) * 4;
            let out = &mut out[place..place + 4];
            for k in 0..4 {
                out[k] = simd.add_f64s(out[k], acc[b][k]);
            }
        }
    }
}

/// As [`contract`] for products of values, one component: `out[(j - i + active - 1) * points + point]`.
#[inline(always)]
pub(super) fn values<S: Simd, const NP: usize>(
    simd: S,
    axis: &Axis,
    (i, elements): (usize, Range<usize>),
    t: &[S::f64s],
    at: Tiles<'_>,
    out: &mut [S::f64s],
    [point, points]: [usize; 2],
) {
    for e in elements {
        let a = i - axis.first[e];
        let mut acc = [simd.splat_f64s(0.0); NP];
        for q in axis.start[e]..axis.start[e + 1] {
            let values = &rows::<NP>(&axis.values)[q];
            let u = simd.mul_f64s(t[at.start + at.places[q - at.origin]], simd.splat_f64s(values[a]));
            for b in 0..NP {
                acc[b] = simd.mul_add_e_f64s(u, simd.splat_f64s(values[b]), acc[b]);
            }
        }
        for b in 0..NP {
            let out = &mut out[(b + NP - 1 - a) * points + point];
            *out = simd.add_f64s(*out, acc[b]);
        }
    }
}
