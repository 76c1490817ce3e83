//! The second sweep over a layer of elements: sums per vector of pairs of the fastest direction.

use super::middle::{self, Tiles};
use super::strip::Window;
use super::tile::{Layer, Sweep};
use super::{groups, slow};
use pulp::{NullaryFnOnce, Simd};

/// Adds a layer to the sums of vector `r` of pairs of the fastest direction, for the functions of a window.
pub(super) struct Add<'a, 'p, S: Simd, const N: usize> {
    pub simd: S,
    pub sweep: &'a Sweep<'a, 'p, N>,
    pub layer: &'a Layer,
    pub window: &'a Window,
    pub r: usize,
    pub tiles: &'a [S::f64s],
    pub scratch: &'a mut [S::f64s],
    pub sums: &'a mut [S::f64s],
}

impl<S: Simd, const N: usize> NullaryFnOnce for Add<'_, '_, S, N> {
    type Output = ();
    #[inline(always)]
    fn call(self) {
        let Self { simd, sweep, layer, window, r, tiles, scratch, sums } = self;
        let (plan, strip, lanes, task, to) = (sweep.plan, &sweep.middle, sweep.lanes, sweep.task, sweep.to);
        let (middle, slow) = (to.middle, to.slow);
        let points = layer.points.len();
        let width = 2 * middle.active - 1;
        let vector = r * lanes * plan.components();
        let types = if plan.components() == 1 { 1 } else { 4 };
        for (k, (pair, sums)) in plan.pairs.iter().zip(sums.chunks_exact_mut(sweep.vector / plan.pairs.len())).enumerate() {
            let start = k * sweep.chunk + vector;
            let components = groups::places(pair.symmetric);
            for i in window.functions.clone() {
                let pairs = strip.pairs(middle, i);
                if pairs.is_empty() {
                    continue;
                }
                if N == 3 {
                    scratch[..width * points * types].fill(simd.splat_f64s(0.0));
                    for q in 0..points {
                        let at = Tiles { start: start + q * task, origin: strip.points.start, places: &sweep.places };
                        let i = (i, strip.support(middle, i));
                        match middle.active {
                            2 if types == 1 => middle::values::<S, 2>(simd, middle, i, tiles, at, scratch, [q, points]),
                            3 if types == 1 => middle::values::<S, 3>(simd, middle, i, tiles, at, scratch, [q, points]),
                            4 if types == 1 => middle::values::<S, 4>(simd, middle, i, tiles, at, scratch, [q, points]),
                            5 if types == 1 => middle::values::<S, 5>(simd, middle, i, tiles, at, scratch, [q, points]),
                            6 if types == 1 => middle::values::<S, 6>(simd, middle, i, tiles, at, scratch, [q, points]),
                            2 => middle::contract::<S, 2>(simd, middle, i, tiles, at, &components, scratch, [q, points]),
                            3 => middle::contract::<S, 3>(simd, middle, i, tiles, at, &components, scratch, [q, points]),
                            4 => middle::contract::<S, 4>(simd, middle, i, tiles, at, &components, scratch, [q, points]),
                            5 => middle::contract::<S, 5>(simd, middle, i, tiles, at, &components, scratch, [q, points]),
                            _ => middle::contract::<S, 6>(simd, middle, i, tiles, at, &components, scratch, [q, points]),
                        }
                    }
                } else {
                    for q in 0..points {
                        let from = start + (q / lanes) * task + (q % lanes) * types;
                        scratch[q * types..(q + 1) * types].copy_from_slice(&tiles[from..from + types]);
                    }
                }
                let t = &scratch[(pairs.start + middle.active - 1 - i) * points * types..];
                let ring = to.ring(sweep.slots, strip.held.start, i, pairs.start);
                let sizes = [pairs.len(), points, layer.points.start];
                for e in layer.elements.clone() {
                    match slow.active {
                        2 if types == 1 => slow::values::<S, 2>(simd, slow, e, t, sizes, ring, sums),
                        3 if types == 1 => slow::values::<S, 3>(simd, slow, e, t, sizes, ring, sums),
                        4 if types == 1 => slow::values::<S, 4>(simd, slow, e, t, sizes, ring, sums),
                        5 if types == 1 => slow::values::<S, 5>(simd, slow, e, t, sizes, ring, sums),
                        6 if types == 1 => slow::values::<S, 6>(simd, slow, e, t, sizes, ring, sums),
                        2 => slow::contract::<S, 2>(simd, slow, e, t, sizes, ring, sums),
                        3 => slow::contract::<S, 3>(simd, slow, e, t, sizes, ring, sums),
                        4 => slow::contract::<S, 4>(simd, slow, e, t, sizes, ring, sums),
                        5 => slow::contract::<S, 5>(simd, slow, e, t, sizes, ring, sums),
                        _ => slow::contract::<S, 6>(simd, slow, e, t, sizes, ring, sums),
                    }
                }
            }
        }
    }
}
