//! The three contractions, along the fastest, the middle and the slowest direction.
//!
//! First the components of D that enter each component of the contraction along the fastest direction.
//! Directions of local coordinates: 0 is the fastest; 1 in the plane, 2 and 1 in space are the outer ones; index N is
//! the value itself. An outer direction keeps its component; the fastest one and the value share "neither".
//!
//! Contraction along the fastest direction: lanes are points of the next one.
//!
//!   T_AB(i, j) = sum_q N_i^(A)(q) D_AB(q) N_j^(B)(q),   j = i, i + 1, .., i + p
//!
//! Components of D that differ only in how they meet this direction (value or derivative of test and trial function)
//! end in one component of T.
//!
//! Contraction along the middle direction of a solid: lanes are pairs of functions of the fastest one.
//!
//! Nine components (slow, middle, neither) x (slow, middle, neither) become four: derivative or value of test and trial
//! function in the slow direction.
//!
//! Contraction along the slowest direction, one element at a time, into the ring of sums.
//!
//! u0 = N_i' T_dd + N_i T_0d, u1 = N_i' T_d0 + N_i T_00, sum_(i,j) += u0 N_j' + u1 N_j: 4 + 2 (p + 1) products.

use super::axis::AxisTable;
use super::simd::{COMPONENTS_AT_ONCE, rows};
use super::sweep::Strip;
use pulp::{NullaryFnOnce, Simd, bytemuck};
use std::ops::Range;

/// Components of the contraction along the fastest direction in N dimensions: (outer directions + 1)².
pub(super) const fn components(n: usize) -> usize {
    n * n
}

/// The groups of a form; `symmetric`: D_ab = D_ba, `extended`: D has the value as index N.
pub(super) fn groups<const N: usize>(symmetric: bool, extended: bool) -> Vec<ContractionGroup> {
    let outer: &[usize] = if N == 2 { &[1] } else { &[2, 1] };
    let (o, m) = (outer.len(), if extended { N + 1 } else { N });
    let d = |a: usize, b: usize| a * m + b;
    let t = |a: usize, b: usize| a * (o + 1) + b;
    let blank = |mask, count| ContractionGroup { mask, count, from: [[0; COMPONENTS_AT_ONCE]; 4], to: [0; COMPONENTS_AT_ONCE] };
    let pairs: Vec<(usize, usize)> = (0..o).flat_map(|a| (0..o).map(move |b| (a, b))).filter(|&(a, b)| !symmetric || a <= b).collect();
    let mut groups = Vec::new();
    for part in pairs.chunks(COMPONENTS_AT_ONCE) {
        let mut group = blank(VV, part.len());
        for (k, &(a, b)) in part.iter().enumerate() {
            group.from[0][k] = d(outer[a], outer[b]);
            group.to[k] = t(a, b);
        }
        groups.push(group);
    }
    if extended {
        for (k, &a) in outer.iter().enumerate() {
            let (mut row, mut column) = (blank(SV | VV, 1), blank(VS | VV, 1));
            (row.from[1][0], row.from[0][0], row.to[0]) = (d(0, a), d(N, a), t(o, k));
            (column.from[2][0], column.from[0][0], column.to[0]) = (d(a, 0), d(a, N), t(k, o));
            groups.extend([row, column]);
        }
    } else {
        let (mut row, mut column) = (blank(SV, o), blank(VS, o));
        for (k, &a) in outer.iter().enumerate() {
            (row.from[1][k], row.to[k]) = (d(0, a), t(o, k));
            (column.from[2][k], column.to[k]) = (d(a, 0), t(k, o));
        }
        groups.extend([row, column]);
    }
    let mut corner = blank(if extended { VV | SV | VS | SS } else { SS }, 1);
    corner.from[3][0] = d(0, 0);
    if extended {
        (corner.from[2][0], corner.from[1][0], corner.from[0][0]) = (d(N, 0), d(0, N), d(N, N));
    }
    corner.to[0] = t(o, o);
    groups.push(corner);
    groups
}

/// The group of products of values: one component of D, one of the contraction.
pub(super) fn mass() -> Vec<ContractionGroup> {
    vec![ContractionGroup { mask: VV, count: 1, from: [[0; COMPONENTS_AT_ONCE]; 4], to: [0; COMPONENTS_AT_ONCE] }]
}

/// Places of the components for the middle contraction: for a symmetric D (middle, slow) is read at (slow, middle).
pub(super) fn component_order(symmetric: bool) -> [usize; COMPONENTS] {
    let mut places: [usize; COMPONENTS] = std::array::from_fn(|k| k);
    if symmetric {
        places[3] = places[1];
    }
    places
}

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
    pub axis: &'a AxisTable,
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
            2 => contract_fast::<S, 2>(simd, axis, strip, d, stride, groups, components, out),
            3 => contract_fast::<S, 3>(simd, axis, strip, d, stride, groups, components, out),
            4 => contract_fast::<S, 4>(simd, axis, strip, d, stride, groups, components, out),
            5 => contract_fast::<S, 5>(simd, axis, strip, d, stride, groups, components, out),
            _ => contract_fast::<S, 6>(simd, axis, strip, d, stride, groups, components, out),
        }
    }
}

/// All pairs of the strip for one tile: `d[point * stride + component]` with the tile's points in lanes, to
/// `out[(((r / V) * V + lane) * components + component) * V + r % V]`, r = i * active + (j - i), points and functions i
/// counted from the first of the strip.
#[inline(always)]
fn contract_fast<S: Simd, const NP: usize>(
    simd: S,
    axis: &AxisTable,
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
    axis: &AxisTable,
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
    axis: &AxisTable,
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
pub(super) fn contract_middle<S: Simd, const NP: usize>(
    simd: S,
    axis: &AxisTable,
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
pub(super) fn values_middle<S: Simd, const NP: usize>(
    simd: S,
    axis: &AxisTable,
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
pub(super) fn contract_slow<S: Simd, const NP: usize>(
    simd: S,
    axis: &AxisTable,
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
pub(super) fn values_slow<S: Simd, const NP: usize>(
    simd: S,
    axis: &AxisTable,
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
