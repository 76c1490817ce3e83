//! The two sweeps over a layer of elements: tiles of contracted points, then sums per vector of pairs.

use super::axis::Axis;
use super::map::{self, ElementScratch, Map, Place, numbers};
use super::march::Plan;
use super::middle::{self, Tiles};
use super::net::Tile;
use super::write::Directions;
use super::{fast, groups, slow};
use crate::assembly::source::Source;
use pulp::{NullaryFnOnce, Simd, bytemuck};
use rayon::prelude::*;
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
    weight: Vec<V>,
    d: Vec<V>,
    sums: Vec<V>,
    tile: Tile<V>,
    weight_tile: Tile<V>,
    lanes: Vec<(usize, usize)>,
    element: ElementScratch<'a>,
    numbers: Vec<f64>,
}

/// Functions on the lines of the fastest direction, per point of the third direction.
#[derive(Debug, Default)]
pub(super) struct Lines {
    map: Vec<Vec<f64>>,
    weight: Vec<Vec<f64>>,
    /// Memory of one contraction per point.
    planes: Vec<Vec<f64>>,
}

/// Sizes of a march and what its sweeps read.
pub(super) struct Sweep<'a, 'p, const N: usize> {
    plan: &'a Plan<'a, 'p>,
    none: Axis,
    /// Element of every point of the second and of the third direction.
    owners: [Vec<usize>; 2],
    lanes: usize,
    slots: usize,
    /// Points of the slowest direction in a layer at most.
    points: usize,
    /// Tiles per point of the third direction; in the plane tiles of a layer.
    tiles: usize,
    /// Vectors of one pair of components in a tile.
    chunk: usize,
    /// Tasks of a layer at most, and vectors of one.
    pub tasks: usize,
    pub task: usize,
    /// Vectors of pairs of the fastest direction, and sums of each.
    pub vectors: usize,
    pub vector: usize,
}

impl<'a, 'p, const N: usize> Sweep<'a, 'p, N> {
    pub fn new(plan: &'a Plan<'a, 'p>, points: usize, slots: usize, lanes: usize) -> Self {
        let axes = &plan.patch.axes;
        let (none, third) = (Axis::none(), N == 3);
        let vectors = (axes[0].functions * axes[0].active).div_ceil(lanes);
        let tiles = if third { axes[1].points() } else { points }.div_ceil(lanes);
        let tasks = if third { tiles * points } else { tiles };
        let chunk = vectors * lanes * plan.components();
        let middle = if third { &axes[1] } else { &none };
        let vector = plan.pairs.len() * Directions { fast: &axes[0], middle, slow: &axes[N - 1] }.sums(slots);
        let owners = [axes[1].owners(), axes[N - 1].owners()];
        Self { plan, owners, lanes, slots, points, tiles, chunk, tasks, task: chunk * plan.pairs.len(), vectors, vector, none }
    }

    fn middle(&self) -> &Axis {
        if N == 3 { &self.plan.patch.axes[1] } else { &self.none }
    }

    pub fn scratch<S: Simd>(&self, simd: S) -> Scratch<'p, S::f64s> {
        let (patch, form) = (self.plan.patch, self.plan.coefficient);
        let zeros = |n: usize| vec![simd.splat_f64s(0.0); n];
        let points = patch.axes[0].points();
        let varies = matches!(form.source, Source::PerPoint(_));
        let rational = patch.weight.is_some();
        Scratch {
            geo: zeros(points * numbers(N)),
            tangents: zeros(if varies { points * form.components * form.components * N * N } else { 0 }),
            weight: zeros(if rational { points * (N + 1) } else { 0 }),
            d: zeros(points * form.stride::<N>(rational)),
            sums: zeros((2 * self.middle().active - 1) * self.points * 4),
            tile: Tile::default(),
            weight_tile: Tile::default(),
            lanes: Vec::with_capacity(self.lanes),
            element: ElementScratch::new(&patch.map),
            numbers: Vec::new(),
        }
    }

    /// Room for the lines of a layer.
    pub fn lines(&self) -> Lines {
        let count = if N == 3 { self.points } else { 1 };
        Lines { map: vec![Vec::new(); count], weight: vec![Vec::new(); count], planes: vec![Vec::new(); count] }
    }

    /// Contracts the nets of map and weights for the points of a layer; in the plane they do not change.
    pub fn fill_lines(&self, layer: &Layer, lines: &mut Lines) {
        let patch = self.plan.patch;
        let net = if let Map::Net(net) = &patch.map { Some(net) } else { None };
        let weight = patch.weight.as_ref().map(|w| &w.0);
        for (net, all) in [(net, &mut lines.map), (weight, &mut lines.weight)] {
            let Some(net) = net else { continue };
            if N == 2 && !all[0].is_empty() {
                continue;
            }
            let lines = all.par_iter_mut().zip(&mut lines.planes).take(layer.points.len()).enumerate();
            lines.for_each(|(k, (out, plane))| {
                let q = layer.points.start + k;
                net.lines::<N>(q, self.owners[1][q], out, plane);
            });
        }
    }

    /// Number of tasks of a layer.
    pub fn tasks_of(&self, layer: &Layer) -> usize {
        if N == 3 { self.tiles * layer.points.len() } else { layer.points.len().div_ceil(self.lanes) }
    }

    /// Task `k` of a layer: one tile through map, coefficient and the fastest direction.
    pub fn fast<S: Simd>(&self, simd: S, layer: &Layer, k: usize, lines: &Lines, scratch: &mut Scratch<'p, S::f64s>, out: &mut [S::f64s]) {
        let patch = self.plan.patch;
        let (line, first, end) = if N == 3 {
            (k / self.tiles, (k % self.tiles) * self.lanes, patch.axes[1].points())
        } else {
            (0, layer.points.start + k * self.lanes, layer.points.end)
        };
        let slow = if N == 3 { (layer.points.start + line, self.owners[1][layer.points.start + line]) } else { (0, 0) };
        scratch.lanes.clear();
        scratch.lanes.extend((first..first + self.lanes).map(|q| q.min(end - 1)).map(|q| (q, self.owners[0][q])));
        map::fill_elements::<S, N>(simd, &patch.axes, Place { lanes: &scratch.lanes, slow }, &mut scratch.element, &mut scratch.geo);
        simd.vectorize(Fast { simd, sweep: self, slow, line, lines, scratch, out });
    }

    /// Adds a layer to the sums of vector `r` of pairs of the fastest direction.
    pub fn sums<S: Simd>(
        &self,
        simd: S,
        layer: &Layer,
        r: usize,
        tiles: &[S::f64s],
        scratch: &mut Scratch<'p, S::f64s>,
        sums: &mut [S::f64s],
    ) {
        simd.vectorize(Add { simd, sweep: self, layer, r, tiles, scratch: &mut scratch.sums, sums });
    }
}

struct Fast<'a, 'p, S: Simd, const N: usize> {
    simd: S,
    sweep: &'a Sweep<'a, 'p, N>,
    slow: (usize, usize),
    line: usize,
    lines: &'a Lines,
    scratch: &'a mut Scratch<'p, S::f64s>,
    out: &'a mut [S::f64s],
}

impl<S: Simd, const N: usize> NullaryFnOnce for Fast<'_, '_, S, N> {
    type Output = ();
    #[inline(always)]
    fn call(self) {
        let Self { simd, sweep, slow, line, lines, scratch, out } = self;
        let (plan, patch) = (sweep.plan, sweep.plan.patch);
        let place = Place { lanes: &scratch.lanes, slow };
        if let Map::Net(net) = &patch.map {
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
        plan.coefficient.tangents::<S, N>(simd, &scratch.geo, &mut scratch.numbers, &mut scratch.tangents);
        let stride = plan.coefficient.stride::<N>(patch.weight.is_some());
        for (pair, out) in plan.pairs.iter().zip(out.chunks_exact_mut(sweep.chunk)) {
            plan.coefficient.pull::<S, N>(simd, pair, &scratch.geo, &scratch.tangents, weight, &mut scratch.d);
            let groups = &plan.groups[usize::from(!pair.symmetric)];
            let (axis, out) = (&patch.axes[0], bytemuck::cast_slice_mut(out));
            let components = plan.components();
            simd.vectorize(fast::Contract { simd, axis, d: &scratch.d, stride, groups, components, out });
        }
    }
}

struct Add<'a, 'p, S: Simd, const N: usize> {
    simd: S,
    sweep: &'a Sweep<'a, 'p, N>,
    layer: &'a Layer,
    r: usize,
    tiles: &'a [S::f64s],
    scratch: &'a mut [S::f64s],
    sums: &'a mut [S::f64s],
}

impl<S: Simd, const N: usize> NullaryFnOnce for Add<'_, '_, S, N> {
    type Output = ();
    #[inline(always)]
    fn call(self) {
        let Self { simd, sweep, layer, r, tiles, scratch, sums } = self;
        let (plan, lanes, task) = (sweep.plan, sweep.lanes, sweep.task);
        let axes = &plan.patch.axes;
        let (middle, slow) = (sweep.middle(), &axes[N - 1]);
        let to = Directions { fast: &axes[0], middle, slow };
        let points = layer.points.len();
        let width = 2 * middle.active - 1;
        let vector = r * lanes * plan.components();
        let types = if plan.components() == 1 { 1 } else { 4 };
        for (k, (pair, sums)) in plan.pairs.iter().zip(sums.chunks_exact_mut(to.sums(sweep.slots))).enumerate() {
            let start = k * sweep.chunk + vector;
            let components = groups::places(pair.symmetric);
            for i in 0..middle.functions {
                if N == 3 {
                    scratch[..width * points * types].fill(simd.splat_f64s(0.0));
                    for q in 0..points {
                        let at = Tiles { tile: task, start: start + q * sweep.tiles * task };
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
                let (from, to_) = middle.columns[i];
                let t = &scratch[(from + middle.active - 1 - i) * points * types..];
                let ring = to.ring(sweep.slots, i, from);
                let sizes = [to_ - from, points, layer.points.start];
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
