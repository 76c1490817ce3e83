//! The map at the points of a cell: from the line of a net, or evaluated element by element.

use super::axis::Axis;
use super::cell::Here;
use super::interpolate;
use super::map::{self, Ask, numbers};
use super::tensor_field::TensorField;
use pulp::{NullaryFnOnce, Simd};

/// The map of a cell from the line of a net; compiled once for all visitors.
pub(super) struct FromNet<'a, S: Simd, const N: usize> {
    pub simd: S,
    /// The net of the map.
    pub net: &'a TensorField,
    /// First direction of the grid, and its element.
    pub axis: &'a Axis,
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
    axes: &[Axis],
    here: Here<'_>,
    ask: &mut Ask<'_>,
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
