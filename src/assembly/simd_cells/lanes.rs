//! Kernels with one cell per SIMD lane: every number of a cell is a vector over the cells of a batch.
//!
//! Lanes never mix and products are fused at every width, so that the matrices of a batch have the same bits for any number of
//! lanes.

use super::tables::{Products, TILE, Tables};
use pulp::Simd;

/// Jacobians of a batch.
#[derive(Debug)]
pub(super) struct Jacobians<V, const N: usize> {
    /// The adjugate of dx/dxi: det times dxi_k/dx_i at `[k][i]`.
    pub adjugate: Vec<[[V; N]; N]>,
    /// det, of either sign.
    pub det: Vec<V>,
}

/// One tangent between two components: (i, j, t_ij) of its entries that are not zero.
pub(super) type Entries = Vec<(usize, usize, f64)>;

/// J = sum_b node_b grad M_b at the first `points` points of the rule, `nodes[b][i]`.
#[inline(always)]
pub(super) fn jacobians<S: Simd, const N: usize>(
    simd: S,
    tables: &Tables<N>,
    points: usize,
    nodes: &[[S::f64s; N]],
    out: &mut Jacobians<S::f64s, N>,
) {
    let zero = simd.splat_f64s(0.0);
    out.adjugate.clear();
    out.det.clear();
    for grads in tables.at.map_grads.chunks_exact(tables.at.nodes).take(points) {
        let mut j = [[zero; N]; N];
        for (x, g) in nodes.iter().zip(grads) {
            for k in 0..N {
                let g = simd.splat_f64s(g[k]);
                for i in 0..N {
                    j[i][k] = simd.mul_add_e_f64s(x[i], g, j[i][k]);
                }
            }
        }
        let mut adjugate = [[zero; N]; N];
        let mut det = zero;
        if N == 2 {
            adjugate[0][0] = j[1][1];
            adjugate[0][1] = simd.neg_f64s(j[0][1]);
            adjugate[1][0] = simd.neg_f64s(j[1][0]);
            adjugate[1][1] = j[0][0];
        } else {
            for k in 0..N {
                for i in 0..N {
                    // cyclic indices carry the sign
                    let (a, b, c, d) = ((i + 1) % N, (i + 2) % N, (k + 1) % N, (k + 2) % N);
                    let minus = simd.mul_f64s(j[a][d], j[b][c]);
                    adjugate[k][i] = simd.mul_add_e_f64s(j[a][c], j[b][d], simd.neg_f64s(minus));
                }
            }
        }
        for k in 0..N {
            det = simd.mul_add_e_f64s(j[0][k], adjugate[k][0], det);
        }
        out.adjugate.push(adjugate);
        out.det.push(det);
    }
}

/// Tolerance of the test for affine maps, relative to the largest coordinate of the nodes: smaller deviations are within the
/// rounding of the coordinates.
const STRAIGHT: f64 = 2.0 * f64::EPSILON;

/// Test for affine maps: not above zero in lanes whose Jacobian is the same at all points, up to rounding of the nodes' coordinates.
#[inline(always)]
pub(super) fn bent<S: Simd, const N: usize>(simd: S, bends: &[f64], nodes: &[[S::f64s; N]]) -> S::f64s {
    let zero = simd.splat_f64s(0.0);
    let (mut largest, mut most) = (zero, zero);
    for x in nodes {
        for k in 0..N {
            largest = simd.max_f64s(largest, simd.abs_f64s(x[k]));
        }
    }
    for row in bends.chunks_exact(nodes.len()) {
        let mut sum = [zero; N];
        for (x, &share) in nodes.iter().zip(row) {
            let share = simd.splat_f64s(share);
            for k in 0..N {
                // shares sum to zero: distances from the first node, so that it does not matter where the cell lies
                sum[k] = simd.mul_add_e_f64s(simd.sub_f64s(x[k], nodes[0][k]), share, sum[k]);
            }
        }
        for k in 0..N {
            most = simd.max_f64s(most, simd.abs_f64s(sum[k]));
        }
    }
    simd.sub_f64s(most, simd.mul_f64s(largest, simd.splat_f64s(STRAIGHT)))
}

/// D_kl = w |det J| sum_ij (J^-1)_ki t_ij (J^-1)_lj at a point.
#[inline(always)]
pub(super) fn pulled_back<S: Simd, const N: usize>(
    simd: S,
    jacobians: &Jacobians<S::f64s, N>,
    q: usize,
    weight: f64,
    entries: impl Iterator<Item = (usize, usize, S::f64s)>,
) -> [[S::f64s; N]; N] {
    let adjugate = &jacobians.adjugate[q];
    // a singular map gives values that are not finite
    let scale = simd.div_f64s(simd.splat_f64s(weight), simd.abs_f64s(jacobians.det[q]));
    let mut d = [[simd.splat_f64s(0.0); N]; N];
    for (i, j, t) in entries {
        let t = simd.mul_f64s(t, scale);
        for k in 0..N {
            let left = simd.mul_f64s(adjugate[k][i], t);
            for l in 0..N {
                d[k][l] = simd.mul_add_e_f64s(left, adjugate[l][j], d[k][l]);
            }
        }
    }
    d
}

/// Output layout of a kernel: entry (a, b) at `(a * padded + b) * stride + offset`.
#[derive(Clone, Copy, Debug)]
pub(super) struct OutputLayout {
    pub stride: usize,
    pub offset: usize,
    /// Whether only b >= a is computed.
    pub upper: bool,
}

/// sum_q sum_kl B_ak(q) D_kl(q) B_bl(q) of all a and b, or of b >= a.
///
/// The test function first: its products with D are made once per point, then TILE trial functions share them.
#[inline(always)]
pub(super) fn products<S: Simd, const K: usize>(
    simd: S,
    tables: &Products<K>,
    d: &[[[S::f64s; K]; K]],
    tested: &mut Vec<[S::f64s; K]>,
    layout: OutputLayout,
    out: &mut [S::f64s],
) {
    let zero = simd.splat_f64s(0.0);
    let points = tables.points;
    for (a, rows) in tables.test.chunks_exact(points).enumerate() {
        tested.clear();
        for (row, d) in rows.iter().zip(d) {
            let mut u = [zero; K];
            for k in 0..K {
                let row = simd.splat_f64s(row[k]);
                for l in 0..K {
                    u[l] = simd.mul_add_e_f64s(row, d[k][l], u[l]);
                }
            }
            tested.push(u);
        }
        let from = if layout.upper { a / TILE } else { 0 };
        for (tile, columns) in tables.trial.chunks_exact(points).enumerate().skip(from) {
            let mut sums = [zero; TILE];
            for (u, column) in tested.iter().zip(columns) {
                for k in 0..K {
                    for t in 0..TILE {
                        sums[t] = simd.mul_add_e_f64s(u[k], simd.splat_f64s(column[k][t]), sums[t]);
                    }
                }
            }
            let first = (a * tables.padded() + tile * TILE) * layout.stride + layout.offset;
            for t in 0..TILE {
                out[first + t * layout.stride] = sums[t];
            }
        }
    }
}

/// sum_kl D_kl S_ab,kl of all a and b, or of b >= a, with sums S over the points: D is constant.
#[inline(always)]
pub(super) fn constant<S: Simd, const N: usize>(
    simd: S,
    tables: &Tables<N>,
    d: &[[S::f64s; N]; N],
    layout: OutputLayout,
    out: &mut [S::f64s],
) {
    let zero = simd.splat_f64s(0.0);
    let padded = tables.grads.padded();
    for (a, row) in tables.sums.chunks_exact(tables.at.functions).enumerate() {
        let from = if layout.upper { a } else { 0 };
        for (b, s) in row.iter().enumerate().skip(from) {
            let mut sum = zero;
            for k in 0..N {
                for l in 0..N {
                    sum = simd.mul_add_e_f64s(d[k][l], simd.splat_f64s(s[k][l]), sum);
                }
            }
            out[(a * padded + b) * layout.stride + layout.offset] = sum;
        }
    }
}
