//! A cell of the grid of points: its position, and its map, from the line of a tensor field or evaluated element by element.

use super::axis::AxisTable;
use super::interpolate;
use super::map::{self, MapEvaluator, numbers};
use super::tensor_field::TensorField;
use pulp::{NullaryFnOnce, Simd};

/// Position of a cell in the grid.
#[derive(Clone, Copy, Debug)]
pub(super) struct Here<'a> {
    /// First element of the grid.
    pub first_element: usize,
    /// Element of the first direction.
    pub first: usize,
    /// Point of the middle direction and its number within its element; 0 in the plane.
    pub middle: (usize, usize),
    /// Element of the middle direction; 0 in the plane.
    pub middle_element: usize,
    /// (point, element) of the slowest direction per lane; lanes beyond the last point repeat it.
    pub lanes: &'a [(usize, usize)],
}

/// The points of a cell: one element of the first direction, one point of the middle one, a tile of the slowest one.
#[derive(Clone, Copy)]
pub(in crate::assembly) struct CellPoints<'a, V> {
    /// Number of points.
    pub points: usize,
    /// The map, `[point * numbers(N) + k]`, see `map`; empty if other data were stored.
    pub map: &'a [V],
    /// Data stored in place of the map, `[point * size + k]`.
    pub kept: &'a [V],
    /// W and its derivatives, `[point * (N + 1) + k]`, of a rational basis.
    pub weight: Option<&'a [V]>,
    /// Physical gradients of the state, `[(point * components + c) * N + k]`; empty if there is none.
    pub state: &'a [V],
}

/// F / W and its local derivatives at point `q` from those of the numerator F, where the basis is rational.
#[inline(always)]
pub(super) fn quotient<S: Simd, const N: usize>(simd: S, cell: CellPoints<'_, S::f64s>, q: usize, g: &mut [S::f64s]) {
    let Some(weight) = cell.weight else { return };
    let w = &weight[q * (N + 1)..][..N + 1];
    let inverse = simd.div_f64s(simd.splat_f64s(1.0), w[0]);
    g[N] = simd.mul_f64s(g[N], inverse);
    for k in 0..N {
        g[k] = simd.mul_f64s(simd.negate_mul_add_e_f64s(g[N], w[1 + k], g[k]), inverse);
    }
}

/// The map of a cell from the line of a net; compiled once for all visitors.
pub(super) struct FromNet<'a, S: Simd, const N: usize> {
    pub simd: S,
    /// The net of the map.
    pub net: &'a TensorField,
    /// First direction of the grid, and its element.
    pub axis: &'a AxisTable,
    pub first: usize,
    pub line: &'a [S::f64s],
    /// Weights of the other directions.
    pub outer: S::f64s,
    pub out: &'a mut [S::f64s],
}

impl<S: Simd, const N: usize> NullaryFnOnce for FromNet<'_, S, N> {
    type Output = ();
    #[inline(always)]
    fn call(self) {
        let Self { simd, net, axis, first, line, outer, out } = self;
        for (q, out) in (axis.start[first]..axis.start[first + 1]).zip(out.chunks_exact_mut(numbers(N))) {
            let weight = simd.mul_f64s(outer, simd.splat_f64s(axis.weights[q]));
            let at = (q, first);
            let (x, t) = match (N, net.width) {
                (2, 2) => map::position(simd, interpolate::at::<S, N, 2>(simd, &net.axes[0], at, line)),
                (_, 3) => map::position(simd, interpolate::at::<S, N, 3>(simd, &net.axes[0], at, line)),
                _ => map::position(simd, interpolate::at::<S, N, 4>(simd, &net.axes[0], at, line)),
            };
            map::finish(simd, &x, &t, weight, out);
        }
    }
}

/// The map of a cell from its positions and tangents, which `out` holds.
#[inline(always)]
pub(super) fn fill_asked<S: Simd, const N: usize>(simd: S, weights: &[f64], outer: S::f64s, out: &mut [S::f64s]) {
    for (&weight, out) in weights.iter().zip(out.chunks_exact_mut(numbers(N))) {
        let (mut x, mut t) = ([outer; N], [[outer; N]; N]);
        for c in 0..N {
            x[c] = out[c];
            for d in 0..N {
                t[d][c] = out[N + d * N + c];
            }
        }
        map::finish(simd, &x, &t, simd.mul_f64s(outer, simd.splat_f64s(weight)), out);
    }
}

/// Positions and tangents of a cell from a map that is evaluated element by element.
pub(super) fn ask_cell<const N: usize>(
    axes: &[AxisTable],
    here: Here<'_>,
    ask: &mut MapEvaluator<'_>,
    xi: &mut Vec<f64>,
    asked: &mut Vec<f64>,
    lanes: usize,
    out: &mut [f64],
) {
    let along = axes[0].start[here.first]..axes[0].start[here.first + 1];
    let counts = [axes[0].elements(), if N == 3 { axes[1].elements() } else { 1 }];
    let mut from = 0;
    while from < here.lanes.len() {
        let slow = here.lanes[from].1;
        let to = from + here.lanes[from..].iter().take_while(|p| p.1 == slow).count();
        xi.clear();
        for &(q, _) in &here.lanes[from..to] {
            for first in along.clone() {
                xi.push(axes[0].xi[first]);
                if N == 3 {
                    xi.push(axes[1].xi[here.middle.0]);
                }
                xi.push(axes[N - 1].xi[q]);
            }
        }
        ask(here.first_element + here.first + counts[0] * (here.middle_element + counts[1] * slow), xi, asked);
        let mut all = asked.chunks_exact(N + N * N);
        for lane in from..to {
            for q in 0..along.len() {
                let point = all.next().expect("numbers of every point that was asked for");
                for (k, &value) in point.iter().enumerate() {
                    out[(q * numbers(N) + k) * lanes + lane] = value;
                }
            }
        }
        from = to;
    }
}
