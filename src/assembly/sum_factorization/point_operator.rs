//! Pointwise action of the pulled-back tangent on a gradient (the D of Bᵀ D B), in local coordinates on both sides.
//!
//!   t_ca = weight |det J| sum_l (J^-1)_al sum_ej tangent[e][j][(c,l)] sum_b (J^-1)_bj g_eb

use super::cell::CellPoints;
use super::map::{inverse, numbers};
use crate::assembly::source::{Integrand, PointTangent};
use pulp::{Simd, bytemuck};

/// A tangent, classified by its structure.
pub(in crate::assembly) enum PointOperator<'a> {
    /// A multiple of the gradient, component by component.
    Multiple(f64),
    /// Of N components: entries (cc, cc), (cc, ee), and the shear that (cl) and (lc) share.
    Aligned([f64; 3]),
    /// A general tangent, `((c * C + e) * N + l) * N + j`.
    Full(&'a [f64]),
    /// A tangent per physical point.
    PerPoint(&'a PointTangent<'a>),
    /// Stored tangents in local coordinates with the weights included, rows (component, a), columns (component, b); if
    /// `symmetric` the columns from the diagonal on.
    Kept { symmetric: bool },
}

impl<'a> PointOperator<'a> {
    /// The law of `source` for fields of `components` components in N dimensions; `None` for [`Integrand::Mass`].
    pub fn new<const N: usize>(source: &'a Integrand<'a>, components: usize) -> Option<Self> {
        let all = match source {
            Integrand::Mass => return None,
            Integrand::PerPoint { at, .. } => return Some(Self::PerPoint(&**at)),
            Integrand::Constant(all) => all,
        };
        let c = components;
        let is = |entry: &dyn Fn(usize, usize, usize, usize) -> f64| {
            all.iter().enumerate().all(|(k, &value)| value == entry(k / N / N / c, k / N / N % c, k / N % N, k % N))
        };
        if is(&|c, e, l, j| if c == e && l == j { all[0] } else { 0.0 }) {
            return Some(Self::Multiple(all[0]));
        }
        if c == N {
            let at = |c: usize, e: usize, l: usize, j: usize| all[((c * N + e) * N + l) * N + j];
            let [along, across, shear] = [at(0, 0, 0, 0), at(0, 1, 0, 1), at(0, 0, 1, 1)];
            let aligned = |c: usize, e: usize, l: usize, j: usize| match (c == l, e == j, c == e && l == j || c == j && l == e) {
                (true, true, true) => along,
                (true, true, false) => across,
                (_, _, true) => shear,
                _ => 0.0,
            };
            if is(&aligned) {
                return Some(Self::Aligned([along, across, shear]));
            }
        }
        Some(Self::Full(all))
    }

    /// Tangents at the points of a cell, where they vary: `out[point * C² N² + ..]`.
    #[inline(always)]
    pub fn tangents<S: Simd, const N: usize>(
        &self,
        simd: S,
        components: usize,
        cell: CellPoints<'_, S::f64s>,
        buffer: &mut Vec<f64>,
        out: &mut Vec<S::f64s>,
    ) {
        let Self::PerPoint(at) = self else { return };
        out.resize(cell.points * components * components * N * N, simd.splat_f64s(0.0));
        tangents::<S, N>(at, components, cell.map, cell.state, buffer, out);
    }

    /// Replaces local gradients `g[component * (N + 1) + d]` (d = N: value, of a rational basis) by the factors of the
    /// derivatives of the test functions (d = N: of their value); `scratch`: 2 N vectors per component.
    #[inline(always)]
    pub fn respond<S: Simd, const N: usize>(
        &self,
        simd: S,
        map: &[S::f64s],
        weight: Option<&[S::f64s]>,
        tangent: &[S::f64s],
        g: &mut [S::f64s],
        scratch: &mut [S::f64s],
    ) {
        let zero = simd.splat_f64s(0.0);
        let (mut r, mut f) = ([[zero; N]; N], zero);
        if !matches!(self, Self::Kept { .. }) {
            for a in 0..N {
                for l in 0..N {
                    r[a][l] = map[N + a * N + l];
                }
            }
            f = map[N + N * N];
        }
        let mut inverse = zero;
        let mut dw = [zero; N];
        if let Some(w) = weight {
            inverse = simd.div_f64s(simd.splat_f64s(1.0), w[0]);
            for k in 0..N {
                dw[k] = simd.mul_f64s(w[1 + k], inverse);
            }
            // gradients of F / W
            for g in g.chunks_exact_mut(N + 1) {
                for k in 0..N {
                    g[k] = simd.mul_f64s(simd.negate_mul_add_e_f64s(g[N], dw[k], g[k]), inverse);
                }
            }
        }
        if let Self::Multiple(k) = self {
            let k = simd.mul_f64s(f, simd.splat_f64s(*k));
            for g in g.chunks_exact_mut(N + 1) {
                let h = physical::<S, N>(simd, &r, g);
                local::<S, N>(simd, &r, k, &h, g);
            }
        } else if !matches!(self, Self::Kept { .. }) {
            let (h, s) = scratch.split_at_mut(scratch.len() / 2);
            for (g, h) in g.chunks_exact(N + 1).zip(h.chunks_exact_mut(N)) {
                h.copy_from_slice(&physical::<S, N>(simd, &r, g));
            }
            self.stress::<S, N>(simd, tangent, h, s);
            for (g, s) in g.chunks_exact_mut(N + 1).zip(s.chunks_exact(N)) {
                local::<S, N>(simd, &r, f, s, g);
            }
        }
        if let Self::Kept { symmetric } = *self {
            if symmetric && g.len() == N + 1 {
                kept_scalar::<S, N>(simd, tangent, g);
            } else {
                let h = &mut scratch[..g.len() / (N + 1) * N];
                for (g, h) in g.chunks_exact(N + 1).zip(h.chunks_exact_mut(N)) {
                    h.copy_from_slice(&g[..N]);
                }
                kept::<S, N>(simd, tangent, symmetric, h, g);
            }
        }
        if weight.is_some() {
            quotients::<S, N>(simd, inverse, &dw, g);
        }
    }
}

/// Tangents at points in lanes, `out[point * C² N² + ..]`, from the map and from the physical gradients of a state,
/// `state[point * C N + ..]` or nothing.
#[inline(always)]
pub(super) fn tangents<S: Simd, const N: usize>(
    at: &PointTangent<'_>,
    components: usize,
    map: &[S::f64s],
    state: &[S::f64s],
    buffer: &mut Vec<f64>,
    out: &mut [S::f64s],
) {
    let (lanes, size) = (S::F64_LANES, components * components * N * N);
    let rows = if state.is_empty() { 0 } else { components * N };
    buffer.resize(size + rows, 0.0);
    let (tangent, gradient) = buffer.split_at_mut(size);
    let (map, state, out): (&[f64], &[f64], &mut [f64]) =
        (bytemuck::cast_slice(map), bytemuck::cast_slice(state), bytemuck::cast_slice_mut(out));
    for (q, (map, out)) in map.chunks_exact(numbers(N) * lanes).zip(out.chunks_exact_mut(size * lanes)).enumerate() {
        let state = &state[q * rows * lanes..][..rows * lanes];
        for lane in 0..lanes {
            let mut x = [0.0; N];
            for k in 0..N {
                x[k] = map[k * lanes + lane];
            }
            for (k, g) in gradient.iter_mut().enumerate() {
                *g = state[k * lanes + lane];
            }
            at(&x, gradient, tangent);
            for (k, &value) in tangent.iter().enumerate() {
                out[k * lanes + lane] = value;
            }
        }
    }
}

/// Factors of the derivatives (d = N: of the value) of the test functions for a stress at a point, `t[component * (N + 1) + d]`:
/// weight |det J| J^-1 stress, for functions over a `weight` function those of their numerators.
#[inline(always)]
pub(in crate::assembly) fn tested<S: Simd, const N: usize>(
    simd: S,
    map: &[S::f64s],
    weight: Option<&[S::f64s]>,
    stress: &[S::f64s],
    t: &mut [S::f64s],
) {
    let zero = simd.splat_f64s(0.0);
    let (r, dx) = (inverse::<S, N>(simd, map), map[N + N * N + 1]);
    for (t, s) in t.chunks_exact_mut(N + 1).zip(stress.chunks_exact(N)) {
        local::<S, N>(simd, &r, dx, s, t);
        t[N] = zero;
    }
    if let Some(w) = weight {
        let inverse = simd.div_f64s(simd.splat_f64s(1.0), w[0]);
        let mut dw = [zero; N];
        for k in 0..N {
            dw[k] = simd.mul_f64s(w[1 + k], inverse);
        }
        quotients::<S, N>(simd, inverse, &dw, t);
    }
}

/// Factors of derivatives and value of N from those of the derivatives of N / W, with 1 / W and dW / W.
#[inline(always)]
fn quotients<S: Simd, const N: usize>(simd: S, inverse: S::f64s, dw: &[S::f64s; N], t: &mut [S::f64s]) {
    for t in t.chunks_exact_mut(N + 1) {
        t[N] = simd.splat_f64s(0.0);
        for k in 0..N {
            t[k] = simd.mul_f64s(t[k], inverse);
            t[N] = simd.negate_mul_add_e_f64s(t[k], dw[k], t[N]);
        }
    }
}

impl PointOperator<'_> {
    /// Writes the stress of the gradient `h[component * N + direction]` in the same layout; does nothing for [`Self::Kept`].
    #[inline(always)]
    pub fn stress<S: Simd, const N: usize>(&self, simd: S, tangent: &[S::f64s], h: &[S::f64s], stress: &mut [S::f64s]) {
        let zero = simd.splat_f64s(0.0);
        match self {
            Self::Multiple(k) => {
                for (s, h) in stress.iter_mut().zip(h) {
                    *s = simd.mul_f64s(simd.splat_f64s(*k), *h);
                }
            }
            Self::Aligned(numbers) => {
                let [along, across, shear] = [simd.splat_f64s(numbers[0]), simd.splat_f64s(numbers[1]), simd.splat_f64s(numbers[2])];
                let (h, stress) = (&h[..N * N], &mut stress[..N * N]);
                for c in 0..N {
                    for l in 0..N {
                        if l != c {
                            stress[c * N + l] = simd.mul_f64s(shear, simd.add_f64s(h[c * N + l], h[l * N + c]));
                        }
                    }
                    let mut s = simd.mul_f64s(along, h[c * N + c]);
                    for e in 0..N {
                        if e != c {
                            s = simd.mul_add_e_f64s(across, h[e * N + e], s);
                        }
                    }
                    stress[c * N + c] = s;
                }
            }
            Self::Full(_) | Self::PerPoint(_) => {
                let components = h.len() / N;
                for (c, s) in stress.chunks_exact_mut(N).enumerate() {
                    let mut sums = [zero; N];
                    for (e, h) in h.chunks_exact(N).enumerate() {
                        let from = (c * components + e) * N * N;
                        for l in 0..N {
                            for j in 0..N {
                                let k = from + l * N + j;
                                let entry = if let Self::Full(all) = self { simd.splat_f64s(all[k]) } else { tangent[k] };
                                sums[l] = simd.mul_add_e_f64s(entry, h[j], sums[l]);
                            }
                        }
                    }
                    s.copy_from_slice(&sums);
                }
            }
            Self::Kept { .. } => {}
        }
    }
}

/// h_j = sum_b g_b r_bj: det J times the physical gradient.
#[inline(always)]
pub(in crate::assembly) fn physical<S: Simd, const N: usize>(simd: S, r: &[[S::f64s; N]; N], g: &[S::f64s]) -> [S::f64s; N] {
    let mut h = [g[0]; N];
    for j in 0..N {
        h[j] = simd.mul_f64s(g[0], r[0][j]);
        for b in 1..N {
            h[j] = simd.mul_add_e_f64s(g[b], r[b][j], h[j]);
        }
    }
    h
}

/// t_a = f r_a . s.
#[inline(always)]
fn local<S: Simd, const N: usize>(simd: S, r: &[[S::f64s; N]; N], f: S::f64s, s: &[S::f64s], t: &mut [S::f64s]) {
    for a in 0..N {
        let mut sum = simd.mul_f64s(r[a][0], s[0]);
        for l in 1..N {
            sum = simd.mul_add_e_f64s(r[a][l], s[l], sum);
        }
        t[a] = simd.mul_f64s(f, sum);
    }
}

/// t = D g of one component, D stored from the diagonal on.
#[inline(always)]
pub(super) fn kept_scalar<S: Simd, const N: usize>(simd: S, d: &[S::f64s], g: &mut [S::f64s]) {
    let zero = simd.splat_f64s(0.0);
    let (mut h, mut t) = ([zero; N], [zero; N]);
    h.copy_from_slice(&g[..N]);
    let d = &d[..N * (N + 1) / 2];
    let mut k = 0;
    for a in 0..N {
        t[a] = simd.mul_add_e_f64s(d[k], h[a], t[a]);
        k += 1;
        for b in a + 1..N {
            t[a] = simd.mul_add_e_f64s(d[k], h[b], t[a]);
            t[b] = simd.mul_add_e_f64s(d[k], h[a], t[b]);
            k += 1;
        }
    }
    g[..N].copy_from_slice(&t);
}

/// t = D h of all components, `t[component * (N + 1) + d]`.
#[inline(always)]
fn kept<S: Simd, const N: usize>(simd: S, d: &[S::f64s], symmetric: bool, h: &[S::f64s], t: &mut [S::f64s]) {
    let zero = simd.splat_f64s(0.0);
    let place = |row: usize| row / N * (N + 1) + row % N;
    for row in 0..h.len() {
        t[place(row)] = zero;
    }
    let mut k = 0;
    for row in 0..h.len() {
        let first = if symmetric { row } else { 0 };
        let mut sum = zero;
        for column in first..h.len() {
            sum = simd.mul_add_e_f64s(d[k], h[column], sum);
            if symmetric && column > row {
                t[place(column)] = simd.mul_add_e_f64s(d[k], h[row], t[place(column)]);
            }
            k += 1;
        }
        t[place(row)] = simd.add_f64s(t[place(row)], sum);
    }
}
