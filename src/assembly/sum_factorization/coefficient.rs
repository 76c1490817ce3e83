//! The coefficient of the contraction: tangents pulled back to local coordinates, one block per pair of components.
//!
//!   D^ce_ab = weight |det J| sum_lj (J^-1)_al tangent[e][j][(c,l)] (J^-1)_bj
//!
//! For a rational basis R_i = w_i N_i / W the contraction runs over N_i with indices (directions, value) and
//!
//!   E_ab = D_ab / W²,  E_0b = -sum_a (dW_a / W) E_ab,  E_00 = sum_ab (dW_a / W) (dW_b / W) E_ab,
//!
//! and the result is scaled by w_i w_j: grad R_i = w_i (grad N_i / W - N_i grad W / W²).

use super::map::numbers;
use super::point_operator;
use crate::assembly::source::Integrand;
use pulp::Simd;

/// A pair of components, or its transpose.
#[derive(Clone, Copy, Debug)]
pub(super) struct ComponentPair {
    /// Component of the test function.
    pub test: usize,
    /// Component of the trial function.
    pub trial: usize,
    /// D_ba in place of D_ab.
    pub transposed: bool,
    /// D_ab = D_ba.
    pub symmetric: bool,
    /// The pair whose upper half mirrors the lower half of this one.
    pub mirror: usize,
}

/// A form on vector fields of some components.
#[derive(Debug)]
pub(super) struct Coefficient<'a> {
    /// Components of the field.
    pub components: usize,
    /// Whether the form is symmetric.
    pub symmetric: bool,
    /// Integrand.
    pub source: Integrand<'a>,
}

impl Coefficient<'_> {
    /// Pairs of components to contract: all, and their transposes if the form is not symmetric.
    pub fn pairs(&self) -> Vec<ComponentPair> {
        let c = self.components;
        let pair = |k: usize, transposed| {
            let (test, trial) = (k / c, k % c);
            let symmetric = self.symmetric && test == trial;
            let mirror = if self.symmetric { trial * c + test } else { c * c + k };
            ComponentPair { test, trial, transposed, symmetric, mirror }
        };
        let all = (0..c * c).map(|k| pair(k, false));
        if self.symmetric { all.collect() } else { all.chain((0..c * c).map(|k| pair(k, true))).collect() }
    }

    /// Numbers of D per point over a rational or polynomial basis.
    pub fn stride<const N: usize>(&self, rational: bool) -> usize {
        match (&self.source, rational) {
            (Integrand::Mass, _) => 1,
            (_, false) => N * N,
            (_, true) => (N + 1) * (N + 1),
        }
    }

    /// Tangents of all points of a tile, where they vary: `out[point * C² N² + ..]`, points of the tile in lanes; `state` as in
    /// [`point_operator::tangents`].
    pub fn tangents<S: Simd, const N: usize>(&self, geo: &[S::f64s], state: &[S::f64s], buffer: &mut Vec<f64>, out: &mut [S::f64s]) {
        if let Integrand::PerPoint { at, .. } = &self.source {
            point_operator::tangents::<S, N>(at, self.components, geo, state, buffer, out);
        }
    }

    /// D of one pair at all points of a tile.
    ///
    /// `tangents` as above; `weight` holds W and its derivatives, `[point * (N + 1) + ..]`, for a rational basis.
    #[inline(always)]
    pub fn pull<S: Simd, const N: usize>(
        &self,
        simd: S,
        pair: &ComponentPair,
        geo: &[S::f64s],
        tangents: &[S::f64s],
        weight: Option<&[S::f64s]>,
        d: &mut [S::f64s],
    ) {
        let size = self.components * self.components * N * N;
        let start = (pair.test * self.components + pair.trial) * N * N;
        let mut m = [[simd.splat_f64s(0.0); N]; N];
        let mut multiple = None;
        if let Integrand::Constant(all) = &self.source {
            let all = &all[start..start + N * N];
            for l in 0..N {
                for j in 0..N {
                    m[l][j] = simd.splat_f64s(all[l * N + j]);
                }
            }
            let diagonal = (0..N * N).all(|k| all[k] == if k % (N + 1) == 0 { all[0] } else { 0.0 });
            multiple = diagonal.then_some(m[0][0]);
        }
        let stride = self.stride::<N>(weight.is_some());
        for (q, (geo, d)) in geo.chunks_exact(numbers(N)).zip(d.chunks_exact_mut(stride)).enumerate() {
            let mut local = [[simd.splat_f64s(0.0); N]; N];
            match &self.source {
                Integrand::Mass => {
                    d[0] = geo[N + N * N + 1];
                    if let Some(w) = weight {
                        let inverse = simd.div_f64s(simd.splat_f64s(1.0), w[q * (N + 1)]);
                        d[0] = simd.mul_f64s(d[0], simd.mul_f64s(inverse, inverse));
                    }
                    continue;
                }
                Integrand::Constant(_) => {
                    if let Some(k) = multiple {
                        isotropic::<S, N>(simd, geo, k, &mut local);
                    } else {
                        general::<S, N>(simd, geo, &m, &mut local);
                    }
                }
                Integrand::PerPoint { .. } => {
                    let here = &tangents[q * size + start..][..N * N];
                    for l in 0..N {
                        for j in 0..N {
                            m[l][j] = here[l * N + j];
                        }
                    }
                    general::<S, N>(simd, geo, &m, &mut local);
                }
            }
            if pair.transposed {
                for a in 0..N {
                    for b in a + 1..N {
                        (local[a][b], local[b][a]) = (local[b][a], local[a][b]);
                    }
                }
            }
            match weight {
                None => {
                    for a in 0..N {
                        for b in 0..N {
                            d[a * N + b] = local[a][b];
                        }
                    }
                }
                Some(w) => extend::<S, N>(simd, &w[q * (N + 1)..][..N + 1], &local, d),
            }
        }
    }
}

/// D = f k r_a . r_b.
#[inline(always)]
fn isotropic<S: Simd, const N: usize>(simd: S, geo: &[S::f64s], k: S::f64s, local: &mut [[S::f64s; N]; N]) {
    let f = simd.mul_f64s(geo[N + N * N], k);
    for a in 0..N {
        for b in a..N {
            let mut sum = simd.mul_f64s(geo[N + a * N], geo[N + b * N]);
            for l in 1..N {
                sum = simd.mul_add_e_f64s(geo[N + a * N + l], geo[N + b * N + l], sum);
            }
            local[a][b] = simd.mul_f64s(f, sum);
            local[b][a] = local[a][b];
        }
    }
}

/// D = f r_a . m r_b.
#[inline(always)]
fn general<S: Simd, const N: usize>(simd: S, geo: &[S::f64s], m: &[[S::f64s; N]; N], local: &mut [[S::f64s; N]; N]) {
    let f = geo[N + N * N];
    for b in 0..N {
        let mut s = [f; N];
        for l in 0..N {
            s[l] = simd.mul_f64s(m[l][0], geo[N + b * N]);
            for j in 1..N {
                s[l] = simd.mul_add_e_f64s(m[l][j], geo[N + b * N + j], s[l]);
            }
        }
        for a in 0..N {
            let mut sum = simd.mul_f64s(geo[N + a * N], s[0]);
            for l in 1..N {
                sum = simd.mul_add_e_f64s(geo[N + a * N + l], s[l], sum);
            }
            local[a][b] = simd.mul_f64s(f, sum);
        }
    }
}

/// E of the directions and the value, which is last, from D and (W, dW).
#[inline(always)]
fn extend<S: Simd, const N: usize>(simd: S, w: &[S::f64s], local: &[[S::f64s; N]; N], d: &mut [S::f64s]) {
    let inverse = simd.div_f64s(simd.splat_f64s(1.0), w[0]);
    let square = simd.mul_f64s(inverse, inverse);
    let mut g = [inverse; N];
    for a in 0..N {
        g[a] = simd.mul_f64s(w[1 + a], inverse);
    }
    let zero = simd.splat_f64s(0.0);
    let (mut rows, mut cols, mut corner) = ([zero; N], [zero; N], zero);
    for a in 0..N {
        for b in 0..N {
            let e = simd.mul_f64s(local[a][b], square);
            d[a * (N + 1) + b] = e;
            rows[a] = simd.negate_mul_add_e_f64s(e, g[b], rows[a]);
            cols[b] = simd.negate_mul_add_e_f64s(e, g[a], cols[b]);
        }
        corner = simd.negate_mul_add_e_f64s(rows[a], g[a], corner);
    }
    for a in 0..N {
        d[a * (N + 1) + N] = rows[a];
        d[N * (N + 1) + a] = cols[a];
    }
    d[N * (N + 1) + N] = corner;
}
