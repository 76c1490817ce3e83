//! The two sweeps over a layer of elements, with their sizes and memory: tiles of contracted points, then sums per vector of pairs of the
//! fastest direction.

use super::cell::CellPoints;
use super::contract::{self, Tiles};
use super::map::{self, ElementScratch, Map, MapTile, numbers};
use super::rows::Directions;
use super::states::Physical;
use super::sweep::{Strip, SweepPlan, Window, Windows};
use super::tensor_field::{Curves, Tile};
use crate::assembly::source::Integrand;
use crate::parallel;
use pulp::{NullaryFnOnce, Simd, bytemuck};
use std::ops::Range;

/// Elements and points of the slowest direction.
#[derive(Clone, Debug)]
pub(super) struct Layer {
    pub elements: Range<usize>,
    pub points: Range<usize>,
}

/// Memory of one task.
pub(super) struct Scratch<'a, V> {
    geo: Vec<V>,
    tangents: Vec<V>,
    /// Physical gradients of the state, and what they come from.
    state: Vec<V>,
    slopes: Vec<V>,
    weight: Vec<V>,
    d: Vec<V>,
    pub sums: Vec<V>,
    tile: Tile<V>,
    weight_tile: Tile<V>,
    state_tile: Tile<V>,
    lanes: Vec<(usize, usize)>,
    element: ElementScratch<'a>,
    numbers: Vec<f64>,
}

/// Functions on the lines of the fastest direction, per point of the third direction.
#[derive(Debug, Default)]
pub(super) struct AxisLines {
    map: Vec<Curves>,
    weight: Vec<Curves>,
    state: Vec<Curves>,
    /// Memory of one contraction per point.
    planes: Vec<Vec<f64>>,
}

/// Sizes of a march and what its sweeps read.
pub(super) struct Sweep<'a, 'p, const N: usize> {
    pub plan: &'a SweepPlan<'a, 'p>,
    /// The directions.
    pub to: Directions<'a>,
    /// The functions of the fast and of the middle direction.
    pub fast: Strip,
    pub middle: Strip,
    /// The steps through the latter.
    pub windows: Windows,
    /// Whether several threads share the march.
    shared: bool,
    /// Element of every point of the second and of the third direction.
    owners: [Vec<usize>; 2],
    pub lanes: usize,
    pub slots: usize,
    /// Points of the slowest direction in a layer at most.
    pub points: usize,
    /// Points of the third direction in a layer at most: tasks of a tile.
    pub lines: usize,
    /// Tiles that are held at once.
    pub tiles: usize,
    /// Vectors of one pair of components in a task.
    pub chunk: usize,
    /// Vectors of one task.
    pub task: usize,
    /// Places of the points of the middle direction in the tiles.
    pub places: Vec<usize>,
    /// Vectors of pairs of the fastest direction, and sums of each.
    pub vectors: usize,
    pub vector: usize,
}

impl<'a, 'p, const N: usize> Sweep<'a, 'p, N> {
    pub fn new(plan: &'a SweepPlan<'a, 'p>, [fast, middle]: [Strip; 2], threads: usize, points: usize, slots: usize, lanes: usize) -> Self {
        let (axes, to, third) = (&plan.patch.axes, plan.patch.directions(), N == 3);
        let windows = Windows::new(to.middle, &middle, plan.window[usize::from(threads > 1)], lanes);
        let vectors = (fast.held.len() * axes[0].active).div_ceil(lanes);
        let (lines, tiles) = if third { (points, windows.tiles) } else { (1, points.div_ceil(lanes)) };
        let chunk = vectors * lanes * plan.components();
        let task = chunk * plan.pairs.len();
        let vector = plan.pairs.len() * middle.held.len() * to.sums(slots);
        let owners = [axes[1].owners(), axes[N - 1].owners()];
        let places = windows.ring_offsets(&middle, lanes, lines * task, plan.components());
        let shared = threads > 1;
        Self { plan, to, fast, middle, windows, shared, owners, lanes, slots, points, lines, tiles, chunk, task, places, vectors, vector }
    }

    pub fn scratch<S: Simd>(&self, simd: S) -> Scratch<'p, S::f64s> {
        let (patch, form) = (self.plan.patch, self.plan.coefficient);
        let zeros = |n: usize| vec![simd.splat_f64s(0.0); n];
        let points = self.fast.points.len();
        let varies = matches!(form.source, Integrand::PerPoint { .. });
        let gradients = self.plan.state.as_ref().map_or(0, |net| points * net.width);
        let rational = patch.weight.is_some();
        Scratch {
            geo: zeros(points * numbers(N)),
            tangents: zeros(if varies { points * form.components * form.components * N * N } else { 0 }),
            state: zeros(gradients * N),
            slopes: zeros(gradients * (N + 1)),
            weight: zeros(if rational { points * (N + 1) } else { 0 }),
            d: zeros(points * form.stride::<N>(rational)),
            sums: zeros((2 * self.to.middle.active - 1) * self.points * 4),
            tile: Tile::default(),
            weight_tile: Tile::default(),
            state_tile: Tile::default(),
            lanes: Vec::with_capacity(self.lanes),
            element: ElementScratch::new(&patch.map),
            numbers: Vec::new(),
        }
    }

    /// Room for the lines of a layer.
    pub fn lines(&self) -> AxisLines {
        let count = if N == 3 { self.points } else { 1 };
        let curves = || vec![Curves::default(); count];
        AxisLines { map: curves(), weight: curves(), state: curves(), planes: vec![Vec::new(); count] }
    }

    /// Contracts the nets of map, weights and state for the points of a layer; in the plane once for all elements of the march, `slow`.
    pub fn fill_lines(&self, layer: &Layer, slow: &Range<usize>, lines: &mut AxisLines) {
        let patch = self.plan.patch;
        let net = if let Map::TensorField(net) = &patch.map { Some(net) } else { None };
        let weight = patch.weight.as_ref().map(|w| &w.0);
        let elements = [&self.fast.elements, if N == 3 { &self.middle.elements } else { slow }];
        let state = self.plan.state.as_ref();
        for (net, all) in [(net, &mut lines.map), (weight, &mut lines.weight), (state, &mut lines.state)] {
            let Some(net) = net else { continue };
            if N == 2 && !all[0].is_empty() {
                continue;
            }
            let line = |(k, (out, plane)): (usize, (&mut Curves, &mut Vec<f64>))| {
                let q = layer.points.start + k;
                net.curves::<N>((q, self.owners[1][q]), elements, out, plane);
            };
            // a march of one thread must not wait for another, which would begin a march meanwhile: its sums are large
            let tasks = all.iter_mut().zip(&mut lines.planes).take(layer.points.len()).enumerate();
            if self.shared {
                parallel::for_each(tasks, line);
            } else {
                tasks.for_each(line);
            }
        }
    }

    /// Tiles that a layer contracts for `window`; in the plane all of its points.
    pub fn tiles_of(&self, layer: &Layer, window: &Window) -> Range<usize> {
        if N == 3 { window.tiles.clone() } else { 0..layer.points.len().div_ceil(self.lanes) }
    }

    /// Tile `tile` at point `line` of the third direction through map, coefficient and the fastest direction.
    pub fn fast<S: Simd>(
        &self,
        simd: S,
        layer: &Layer,
        [tile, line]: [usize; 2],
        lines: &AxisLines,
        scratch: &mut Scratch<'p, S::f64s>,
        out: &mut [S::f64s],
    ) {
        let patch = self.plan.patch;
        let points = if N == 3 { &self.middle.points } else { &layer.points };
        let (first, end) = (points.start + tile * self.lanes, points.end);
        let slow = if N == 3 { (layer.points.start + line, self.owners[1][layer.points.start + line]) } else { (0, 0) };
        scratch.lanes.clear();
        scratch.lanes.extend((first..first + self.lanes).map(|q| q.min(end - 1)).map(|q| (q, self.owners[0][q])));
        let place = MapTile { along: [self.fast.elements.start, self.fast.elements.end], lanes: &scratch.lanes, slow };
        map::fill_elements::<S, N>(simd, &patch.axes, place, &mut scratch.element, &mut scratch.geo);
        simd.vectorize(Fast { simd, sweep: self, slow, line, lines, scratch, out });
    }
}

struct Fast<'a, 'p, S: Simd, const N: usize> {
    simd: S,
    sweep: &'a Sweep<'a, 'p, N>,
    slow: (usize, usize),
    line: usize,
    lines: &'a AxisLines,
    scratch: &'a mut Scratch<'p, S::f64s>,
    out: &'a mut [S::f64s],
}

impl<S: Simd, const N: usize> NullaryFnOnce for Fast<'_, '_, S, N> {
    type Output = ();
    #[inline(always)]
    fn call(self) {
        let Self { simd, sweep, slow, line, lines, scratch, out } = self;
        let (plan, patch) = (sweep.plan, sweep.plan.patch);
        let place = MapTile { along: [sweep.fast.elements.start, sweep.fast.elements.end], lanes: &scratch.lanes, slow };
        if let Map::TensorField(net) = &patch.map {
            net.tile(simd, &scratch.lanes, &mut scratch.tile);
            map::fill_net::<S, N>(simd, net, &patch.axes, place, &lines.map[line], &scratch.tile, &mut scratch.geo);
        }
        let weight = patch.weight.as_ref().map(|(net, _)| {
            net.tile(simd, &scratch.lanes, &mut scratch.weight_tile);
            for (q, out) in scratch.weight.chunks_exact_mut(N + 1).enumerate() {
                let (value, slope) = net.at::<S, N, 1>(simd, q, &lines.weight[line], &scratch.weight_tile);
                out[0] = value[0];
                for k in 0..N {
                    out[1 + k] = slope[k][0];
                }
            }
            &scratch.weight[..]
        });
        if let Some(net) = &plan.state {
            net.tile(simd, &scratch.lanes, &mut scratch.state_tile);
            for (k, out) in scratch.slopes.chunks_exact_mut(N + 1).enumerate() {
                let (value, slope) = net.one::<S, N>(simd, (k / net.width, k % net.width), &lines.state[line], &scratch.state_tile);
                out[..N].copy_from_slice(&slope);
                out[N] = value;
            }
            let cell = CellPoints { points: scratch.geo.len() / numbers(N), map: &scratch.geo, kept: &[], weight, state: &[] };
            simd.vectorize(Physical::<'_, S, N> { simd, cell, width: net.width, g: &mut scratch.slopes, out: &mut scratch.state });
        }
        plan.coefficient.tangents::<S, N>(&scratch.geo, &scratch.state, &mut scratch.numbers, &mut scratch.tangents);
        let stride = plan.coefficient.stride::<N>(patch.weight.is_some());
        for (pair, out) in plan.pairs.iter().zip(out.chunks_exact_mut(sweep.chunk)) {
            plan.coefficient.pull::<S, N>(simd, pair, &scratch.geo, &scratch.tangents, weight, &mut scratch.d);
            let groups = &plan.groups[usize::from(!pair.symmetric)];
            let (axis, strip, out) = (&patch.axes[0], &sweep.fast, bytemuck::cast_slice_mut(out));
            let components = plan.components();
            simd.vectorize(contract::Contract { simd, axis, strip, d: &scratch.d, stride, groups, components, out });
        }
    }
}

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
            let components = contract::component_order(pair.symmetric);
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
                            2 if types == 1 => contract::values_middle::<S, 2>(simd, middle, i, tiles, at, scratch, [q, points]),
                            3 if types == 1 => contract::values_middle::<S, 3>(simd, middle, i, tiles, at, scratch, [q, points]),
                            4 if types == 1 => contract::values_middle::<S, 4>(simd, middle, i, tiles, at, scratch, [q, points]),
                            5 if types == 1 => contract::values_middle::<S, 5>(simd, middle, i, tiles, at, scratch, [q, points]),
                            6 if types == 1 => contract::values_middle::<S, 6>(simd, middle, i, tiles, at, scratch, [q, points]),
                            2 => contract::contract_middle::<S, 2>(simd, middle, i, tiles, at, &components, scratch, [q, points]),
                            3 => contract::contract_middle::<S, 3>(simd, middle, i, tiles, at, &components, scratch, [q, points]),
                            4 => contract::contract_middle::<S, 4>(simd, middle, i, tiles, at, &components, scratch, [q, points]),
                            5 => contract::contract_middle::<S, 5>(simd, middle, i, tiles, at, &components, scratch, [q, points]),
                            _ => contract::contract_middle::<S, 6>(simd, middle, i, tiles, at, &components, scratch, [q, points]),
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
                        2 if types == 1 => contract::values_slow::<S, 2>(simd, slow, e, t, sizes, ring, sums),
                        3 if types == 1 => contract::values_slow::<S, 3>(simd, slow, e, t, sizes, ring, sums),
                        4 if types == 1 => contract::values_slow::<S, 4>(simd, slow, e, t, sizes, ring, sums),
                        5 if types == 1 => contract::values_slow::<S, 5>(simd, slow, e, t, sizes, ring, sums),
                        6 if types == 1 => contract::values_slow::<S, 6>(simd, slow, e, t, sizes, ring, sums),
                        2 => contract::contract_slow::<S, 2>(simd, slow, e, t, sizes, ring, sums),
                        3 => contract::contract_slow::<S, 3>(simd, slow, e, t, sizes, ring, sums),
                        4 => contract::contract_slow::<S, 4>(simd, slow, e, t, sizes, ring, sums),
                        5 => contract::contract_slow::<S, 5>(simd, slow, e, t, sizes, ring, sums),
                        _ => contract::contract_slow::<S, 6>(simd, slow, e, t, sizes, ring, sums),
                    }
                }
            }
        }
    }
}
