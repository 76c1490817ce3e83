//! Contraction along the fastest direction: lanes are points of the next one.
//!
//!   T_AB(i, j) = sum_q N_i^(A)(q) D_AB(q) N_j^(B)(q),   j = i, i + 1, .., i + p
//!
//! Components of D that differ only in how they meet this direction (value or derivative of test and trial function)
//! end in one component of T.

use super::axis::Axis;
use super::lanes::{COMPONENTS_AT_ONCE, rows};
use super::strip::Strip;
use pulp::{NullaryFnOnce, Simd, bytemuck};

/// Value of the test function times value of the trial function.
pub(super) const VV: u8 = 1;
/// Derivative of the test function times value of the trial function.
pub(super) const SV: u8 = 2;
/// Value of the test function times derivative of the trial function.
pub(super) const VS: u8 = 4;
/// Derivative times derivative.
pub(super) const SS: u8 = 8;
const SV_VV: u8 = SV | VV;
const VS_VV: u8 = VS | VV;
const ALL: u8 = VV | SV | VS | SS;

/// Components of T that are contracted together, because they share the factors of the trial function.
#[derive(Clone, Copy, Debug)]
pub(super) struct ContractionGroup {
    /// Bit mask of the products summed: [`VV`], [`SV`], [`VS`], [`SS`].
    pub mask: u8,
    /// Number of components.
    pub count: usize,
    /// Their place in D, per bit of the mask.
    pub from: [[usize; COMPONENTS_AT_ONCE]; 4],
    /// Their place in T.
    pub to: [usize; COMPONENTS_AT_ONCE],
}

/// [`contract`] of one tile, entered with the instruction set: compiled once for plane and solid patches.
pub(super) struct Contract<'a, S: Simd> {
    pub simd: S,
    pub axis: &'a Axis,
    pub strip: &'a Strip,
    pub d: &'a [S::f64s],
    pub stride: usize,
    pub groups: &'a [ContractionGroup],
    pub components: usize,
    pub out: &'a mut [f64],
}

impl<S: Simd> NullaryFnOnce for Contract<'_, S> {
    type Output = ();
    #[inline(always)]
    fn call(self) {
        let Self { simd, axis, strip, d, stride, groups, components, out } = self;
        match axis.active {
            2 => contract::<S, 2>(simd, axis, strip, d, stride, groups, components, out),
            3 => contract::<S, 3>(simd, axis, strip, d, stride, groups, components, out),
            4 => contract::<S, 4>(simd, axis, strip, d, stride, groups, components, out),
            5 => contract::<S, 5>(simd, axis, strip, d, stride, groups, components, out),
            _ => contract::<S, 6>(simd, axis, strip, d, stride, groups, components, out),
        }
    }
}

/// All pairs of the strip for one tile: `d[point * stride + component]` with the tile's points in lanes, to
/// `out[(((r / V) * V + lane) * components + component) * V + r % V]`, r = i * active + (j - i), points and functions i
/// counted from the first of the strip.
#[inline(always)]
fn contract<S: Simd, const NP: usize>(
    simd: S,
    axis: &Axis,
    strip: &Strip,
    d: &[S::f64s],
    stride: usize,
    groups: &[ContractionGroup],
    components: usize,
    out: &mut [f64],
) {
    for g in groups {
        match (g.count, g.mask) {
            (3, VV) => group::<S, NP, 3, VV>(simd, axis, strip, d, stride, g, components, out),
            (1, VV) => group::<S, NP, 1, VV>(simd, axis, strip, d, stride, g, components, out),
            (2, SV) => group::<S, NP, 2, SV>(simd, axis, strip, d, stride, g, components, out),
            (1, SV) => group::<S, NP, 1, SV>(simd, axis, strip, d, stride, g, components, out),
            (2, VS) => group::<S, NP, 2, VS>(simd, axis, strip, d, stride, g, components, out),
            (1, VS) => group::<S, NP, 1, VS>(simd, axis, strip, d, stride, g, components, out),
            (1, SS) => group::<S, NP, 1, SS>(simd, axis, strip, d, stride, g, components, out),
            (1, SV_VV) => group::<S, NP, 1, SV_VV>(simd, axis, strip, d, stride, g, components, out),
            (1, VS_VV) => group::<S, NP, 1, VS_VV>(simd, axis, strip, d, stride, g, components, out),
            (1, ALL) => group::<S, NP, 1, ALL>(simd, axis, strip, d, stride, g, components, out),
            _ => unreachable!("groups are made for these kernels"),
        }
    }
}

#[inline(always)]
fn group<S: Simd, const NP: usize, const K: usize, const MASK: u8>(
    simd: S,
    axis: &Axis,
    strip: &Strip,
    d: &[S::f64s],
    stride: usize,
    g: &ContractionGroup,
    components: usize,
    out: &mut [f64],
) {
    let lanes = S::F64_LANES;
    for (own, i) in strip.held.clone().enumerate() {
        let mut acc = [[simd.splat_f64s(0.0); NP]; K];
        for e in strip.support(axis, i) {
            let d = &d[(axis.start[e] - strip.points.start) * stride..];
            // the local number is a constant: accumulators stay in registers
            match i - axis.first[e] {
                0 => segment::<S, NP, K, MASK, 0>(simd, axis, e, d, stride, g, &mut acc),
                1 => segment::<S, NP, K, MASK, 1>(simd, axis, e, d, stride, g, &mut acc),
                2 => segment::<S, NP, K, MASK, 2>(simd, axis, e, d, stride, g, &mut acc),
                3 => segment::<S, NP, K, MASK, 3>(simd, axis, e, d, stride, g, &mut acc),
                4 => segment::<S, NP, K, MASK, 4>(simd, axis, e, d, stride, g, &mut acc),
                _ => segment::<S, NP, K, MASK, 5>(simd, axis, e, d, stride, g, &mut acc),
            }
        }
        for k in 0..K {
            let sums: &[f64] = bytemuck::cast_slice(&acc[k]);
            let place = |r: usize| ((r / lanes) * lanes * components + g.to[k]) * lanes + r % lanes;
            // lanes of points become lanes of pairs
            if lanes.is_multiple_of(NP) {
                // all pairs of a function are neighbours in one vector
                let mut at = place(own * NP);
                for lane in 0..lanes {
                    let mut row = [0.0; NP];
                    for c in 0..NP {
                        row[c] = sums[c * lanes + lane];
                    }
                    out[at..at + NP].copy_from_slice(&row);
                    at += components * lanes;
                }
                continue;
            }
            for c in 0..NP {
                let mut at = place(own * NP + c);
                for lane in 0..lanes {
                    out[at] = sums[c * lanes + lane];
                    at += components * lanes;
                }
            }
        }
    }
}

/// Adds the points of element `e`, which `d` starts with and on which the test function is the local function `A`.
#[inline(always)]
fn segment<S: Simd, const NP: usize, const K: usize, const MASK: u8, const A: usize>(
    simd: S,
    axis: &Axis,
    e: usize,
    d: &[S::f64s],
    stride: usize,
    g: &ContractionGroup,
    acc: &mut [[S::f64s; NP]; K],
) {
    if A >= NP {
        return;
    }
    let range = axis.start[e]..axis.start[e + 1];
    let points = d[..range.len() * stride].chunks_exact(stride);
    let tables = rows::<NP>(&axis.values)[range.clone()].iter().zip(&rows::<NP>(&axis.slopes)[range]);
    for (d, (values, slopes)) in points.zip(tables) {
        let (v, s) = (simd.splat_f64s(values[A]), simd.splat_f64s(slopes[A]));
        if MASK & (VV | SV) != 0 {
            let mut u = [v; K];
            for k in 0..K {
                if MASK & SV != 0 {
                    u[k] = simd.mul_f64s(d[g.from[1][k]], s);
                    if MASK & VV != 0 {
                        u[k] = simd.mul_add_e_f64s(d[g.from[0][k]], v, u[k]);
                    }
                } else {
                    u[k] = simd.mul_f64s(d[g.from[0][k]], v);
                }
            }
            add::<S, NP, K, A>(simd, &u, values, acc);
        }
        if MASK & (VS | SS) != 0 {
            let mut u = [v; K];
            for k in 0..K {
                if MASK & SS != 0 {
                    u[k] = simd.mul_f64s(d[g.from[3][k]], s);
                    if MASK & VS != 0 {
                        u[k] = simd.mul_add_e_f64s(d[g.from[2][k]], v, u[k]);
                    }
                } else {
                    u[k] = simd.mul_f64s(d[g.from[2][k]], v);
                }
            }
            add::<S, NP, K, A>(simd, &u, slopes, acc);
        }
    }
}

/// acc[k][c] += u[k] trial[A + c].
#[inline(always)]
fn add<S: Simd, const NP: usize, const K: usize, const A: usize>(
    simd: S,
    u: &[S::f64s; K],
    trial: &[f64; NP],
    acc: &mut [[S::f64s; NP]; K],
) {
    for c in 0..NP {
        if A + c < NP {
            let b = simd.splat_f64s(trial[A + c]);
            for k in 0..K {
                acc[k][c] = simd.mul_add_e_f64s(u[k], b, acc[k][c]);
            }
        }
    }
}
