//! The map on the grid of points: positions, cofactors of the Jacobian, weights.
//!
//! Per point: x (N numbers), the rows of det J times the inverse of J (N x N), weight / |det J|, weight |det J|, det J.

use super::axis::AxisTable;
use super::tensor_field::{Curves, TensorField, Tile};
use pulp::{Simd, bytemuck};
use std::fmt::Debug;
use std::ops::Range;

/// Evaluates the map of an element at local points, N numbers each: per point N numbers of x, then dx_c/dxi_d at `d * N + c`.
pub(in crate::assembly) type MapEvaluator<'a> = dyn FnMut(usize, &[f64], &mut Vec<f64>) + Send + 'a;
/// Makes one [`MapEvaluator`] per task, so that each keeps its own tables.
pub(in crate::assembly) type MapEvaluators<'a> = dyn Fn() -> Box<MapEvaluator<'a>> + Sync + 'a;

/// Source of the map.
pub(super) enum Map<'a> {
    /// Control points, with weights as last number where it is rational.
    TensorField(TensorField),
    /// Any map, element by element, and the first element of the patch.
    Elements(&'a MapEvaluators<'a>, usize),
}

impl Debug for Map<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(if matches!(self, Self::TensorField(_)) { "Net" } else { "Elements" })
    }
}

/// Numbers per point.
pub(in crate::assembly) const fn numbers(n: usize) -> usize {
    n + n * n + 3
}

/// J^-1 from the map of a point.
#[inline(always)]
pub(in crate::assembly) fn inverse<S: Simd, const N: usize>(simd: S, map: &[S::f64s]) -> [[S::f64s; N]; N] {
    let inverse = simd.div_f64s(simd.splat_f64s(1.0), map[N + N * N + 2]);
    let mut r = [[inverse; N]; N];
    for a in 0..N {
        for l in 0..N {
            r[a][l] = simd.mul_f64s(map[N + a * N + l], inverse);
        }
    }
    r
}

/// One tile of the grid: points of some elements of the first direction, up to a lane's worth of the second, one of the third.
#[derive(Clone, Copy, Debug)]
pub(super) struct MapTile<'a> {
    /// Elements of the first direction, from and to.
    pub along: [usize; 2],
    /// (point, element) of the second direction per lane; lanes beyond the last point repeat it.
    pub lanes: &'a [(usize, usize)],
    /// Point and element of the third direction.
    pub slow: (usize, usize),
}

impl MapTile<'_> {
    /// Points of the first direction.
    #[inline(always)]
    fn points(&self, axes: &[AxisTable]) -> Range<usize> {
        axes[0].start[self.along[0]]..axes[0].start[self.along[1]]
    }
}

/// The map of a tile to `out[point * numbers(N) + k]`, points counted from the first of the tile, as in `curves`.
#[inline(always)]
pub(super) fn fill_net<S: Simd, const N: usize>(
    simd: S,
    net: &TensorField,
    axes: &[AxisTable],
    place: MapTile<'_>,
    curves: &Curves,
    tile: &Tile<S::f64s>,
    out: &mut [S::f64s],
) {
    let weight = weights(simd, axes, place);
    let along = &axes[0].weights[place.points(axes)];
    for (q, (out, &first)) in out.chunks_exact_mut(numbers(N)).zip(along).enumerate() {
        let (x, t) = match (N, net.width) {
            (2, 2) => position(simd, net.at::<S, N, 2>(simd, q, curves, tile)),
            (_, 3) => position(simd, net.at::<S, N, 3>(simd, q, curves, tile)),
            _ => position(simd, net.at::<S, N, 4>(simd, q, curves, tile)),
        };
        finish(simd, &x, &t, simd.mul_f64s(weight, simd.splat_f64s(first)), out);
    }
}

/// Weights of the second and third direction.
#[inline(always)]
fn weights<S: Simd>(simd: S, axes: &[AxisTable], place: MapTile<'_>) -> S::f64s {
    let slow = axes.get(2).map_or(1.0, |axis| axis.weights[place.slow.0]);
    let mut weight = simd.splat_f64s(0.0);
    let lanes: &mut [f64] = bytemuck::cast_slice_mut(std::slice::from_mut(&mut weight));
    for (w, &(q, _)) in lanes.iter_mut().zip(place.lanes) {
        *w = axes[1].weights[q] * slow;
    }
    weight
}

/// Position and tangents from a net of M numbers per point: x = A and dx = dA, or, where the last is a weight W beyond
/// the coordinates, x = A / W and dx = (dA - x dW) / W.
#[inline(always)]
pub(super) fn position<S: Simd, const N: usize, const M: usize>(
    simd: S,
    (value, slope): ([S::f64s; M], [[S::f64s; M]; N]),
) -> ([S::f64s; N], [[S::f64s; N]; N]) {
    let zero = simd.splat_f64s(0.0);
    let (mut x, mut t) = ([zero; N], [[zero; N]; N]);
    let inverse = simd.div_f64s(simd.splat_f64s(1.0), value[M - 1]);
    for c in 0..N.min(M) {
        x[c] = if M > N { simd.mul_f64s(value[c], inverse) } else { value[c] };
        for k in 0..N {
            t[k][c] = if M > N {
                let rest = simd.negate_mul_add_e_f64s(x[c], slope[k][M - 1], slope[k][c]);
                simd.mul_f64s(rest, inverse)
            } else {
                slope[k][c]
            };
        }
    }
    (x, t)
}

/// Writes a point from its position and its tangents `t[direction][component]`.
#[inline(always)]
pub(in crate::assembly) fn finish<S: Simd, const N: usize>(
    simd: S,
    x: &[S::f64s; N],
    t: &[[S::f64s; N]; N],
    weight: S::f64s,
    out: &mut [S::f64s],
) {
    out[..N].copy_from_slice(x);
    let det;
    if N == 2 {
        // rows (t1_y, -t1_x) and (-t0_y, t0_x)
        out[N] = t[1][1];
        out[N + 1] = simd.neg_f64s(t[1][0]);
        out[N + 2] = simd.neg_f64s(t[0][1]);
        out[N + 3] = t[0][0];
        det = minor(simd, t[0][0], t[1][1], t[0][1], t[1][0]);
    } else {
        for a in 0..3 {
            // row a is the cross product of the two other tangents
            let (u, v) = (&t[(a + 1) % 3], &t[(a + 2) % 3]);
            for c in 0..3 {
                let (i, j) = ((c + 1) % 3, (c + 2) % 3);
                out[N + 3 * a + c] = minor(simd, u[i], v[j], u[j], v[i]);
            }
        }
        let along = simd.mul_add_e_f64s(t[0][1], out[N + 1], simd.mul_f64s(t[0][0], out[N]));
        det = simd.mul_add_e_f64s(t[0][2], out[N + 2], along);
    }
    let size = simd.abs_f64s(det);
    out[N + N * N] = simd.div_f64s(weight, size);
    out[N + N * N + 1] = simd.mul_f64s(weight, size);
    out[N + N * N + 2] = det;
}

/// a d - b c, as a d + (-b) c.
#[inline(always)]
fn minor<S: Simd>(simd: S, a: S::f64s, d: S::f64s, b: S::f64s, c: S::f64s) -> S::f64s {
    simd.negate_mul_add_e_f64s(b, c, simd.mul_f64s(a, d))
}

/// Memory of [`fill_elements`].
pub(super) struct ElementScratch<'a> {
    ask: Option<(Box<MapEvaluator<'a>>, usize)>,
    points: Vec<f64>,
    numbers: Vec<f64>,
}

impl<'a> ElementScratch<'a> {
    /// Memory for `map`; a net needs no evaluator.
    pub fn new(map: &Map<'a>) -> Self {
        let ask = if let Map::Elements(asks, first) = map { Some((asks(), *first)) } else { None };
        Self { ask, points: Vec::new(), numbers: Vec::new() }
    }
}

/// As [`fill_net`] for any map, evaluated element by element at the points of the tile; does nothing for a net.
pub(super) fn fill_elements<S: Simd, const N: usize>(
    simd: S,
    axes: &[AxisTable],
    place: MapTile<'_>,
    scratch: &mut ElementScratch<'_>,
    out: &mut [S::f64s],
) {
    let ElementScratch { ask: Some((ask, first)), points, numbers: asked } = scratch else { return };
    let (lanes, width) = (S::F64_LANES, numbers(N));
    let numbers: &mut [f64] = bytemuck::cast_slice_mut(out);
    let counts: [usize; 2] = [axes[0].elements(), axes[1].elements()];
    let origin = place.points(axes).start;
    let mut from = 0;
    while from < place.lanes.len() {
        let e1 = place.lanes[from].1;
        let to = from + place.lanes[from..].iter().take_while(|p| p.1 == e1).count();
        for e0 in place.along[0]..place.along[1] {
            let along = axes[0].start[e0]..axes[0].start[e0 + 1];
            points.clear();
            for &(q1, _) in &place.lanes[from..to] {
                points.extend(along.clone().flat_map(|q0| (0..N).map(move |k| axes[k].xi[[q0, q1, place.slow.0][k]])));
            }
            let element = e0 + counts[0] * (e1 + if N == 3 { counts[1] * place.slow.1 } else { 0 });
            ask(*first + element, points, asked);
            let mut all = asked.chunks_exact(N + N * N);
            for lane in from..to {
                for q in along.clone() {
                    let point = all.next().expect("numbers of every point that was asked for");
                    for (k, &value) in point.iter().enumerate() {
                        numbers[((q - origin) * width + k) * lanes + lane] = value;
                    }
                }
            }
        }
        from = to;
    }
    simd.vectorize(Finish::<'_, S, N> { simd, axes, place, out });
}

struct Finish<'a, S: Simd, const N: usize> {
    simd: S,
    axes: &'a [AxisTable],
    place: MapTile<'a>,
    out: &'a mut [S::f64s],
}

impl<S: Simd, const N: usize> pulp::NullaryFnOnce for Finish<'_, S, N> {
    type Output = ();
    #[inline(always)]
    fn call(self) {
        let Self { simd, axes, place, out } = self;
        let weight = weights(simd, axes, place);
        for (&first, out) in axes[0].weights[place.points(axes)].iter().zip(out.chunks_exact_mut(numbers(N))) {
            let (mut x, mut t) = ([weight; N], [[weight; N]; N]);
            for c in 0..N {
                x[c] = out[c];
                for d in 0..N {
                    t[d][c] = out[N + d * N + c];
                }
            }
            finish(simd, &x, &t, simd.mul_f64s(weight, simd.splat_f64s(first)), out);
        }
    }
}
