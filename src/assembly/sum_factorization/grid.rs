//! The walk over the grid of points: tiles of points of the slowest direction in lanes, cell by cell of the others.
//!
//! Map, weight function and values derived from them are held for one cell only; only the result of a visitor per point of
//! the slowest direction grows with the patch.
//!
//! Points of a cell passed to a closure, and its values put back in lanes.

use super::Patch;
use super::axis::AxisTable;
use super::cell::{CellPoints, FromNet, Here, ask_cell, fill_asked};
use super::interpolate::{self, Coefficients, Interpolation};
use super::map::{Map, MapEvaluator, MapEvaluators, numbers};
use super::numbering::PatchNumbering;
use super::simd::Aligned;
use super::states::{Gradients, State};
use super::tensor_field::TensorField;
use crate::assembly::source::Integrand;
use crate::parallel;
use pulp::{NullaryFnOnce, Simd, bytemuck};
use std::ops::Range;

/// Bytes of results of tiles that are held at a time.
const BATCH_BYTES: usize = 4 << 20;
/// Tasks per thread of a batch.
const TASKS_PER_THREAD: usize = 2;

/// Visitor of the cells of the grid, with memory of its own.
pub(super) trait Visit<S: Simd, const N: usize>: Send {
    /// A tile starts.
    fn start(&mut self, simd: S, lanes: &[(usize, usize)]);
    /// An element of the middle direction starts; in the plane there is one per tile.
    fn open(&mut self, simd: S, element: usize);
    /// All cells of a line along the first direction at once, if that is faster than one by one; returns whether it did so.
    /// `middle` as in [`Here`], `kept` for all points of the line.
    fn line(&mut self, _simd: S, _middle: (usize, usize), _kept: &[S::f64s]) -> bool {
        false
    }
    /// A cell.
    fn cell(&mut self, simd: S, here: Here<'_>, cell: CellPoints<'_, S::f64s>);
    /// An element of the middle direction ends.
    fn close(&mut self, simd: S, element: usize);
    /// A tile ends: its results to `out`, as many numbers for every lane.
    fn end(&mut self, simd: S, out: &mut [f64]);
}

/// Takes the results of some points of the slowest direction, those of one point together (lanes beyond the last point
/// too); points ascend.
pub(super) type Sink<'a> = dyn FnMut(Range<usize>, &[f64]) + Send + 'a;

/// Source of the map, or of data stored in its place.
#[derive(Clone, Copy)]
pub(super) enum PointSource<'a, 'p> {
    /// Control points, with weights as last number where it is rational.
    TensorField(&'a TensorField),
    /// Any map, element by element.
    Elements(&'a MapEvaluators<'p>),
    /// The map as stored on this processor, `numbers(N)` vectors per point; tile by tile, the first direction fastest.
    Map(&'a [f64]),
    /// Other data stored in the same way, with the number of vectors per point.
    Other(&'a [f64], usize),
}

/// A grid of points with its map and weight function.
#[derive(Clone, Copy)]
pub(super) struct QuadratureGrid<'a, 'p> {
    /// The directions.
    pub axes: &'a [AxisTable],
    /// The weight function of a rational basis.
    pub weight: Option<&'a TensorField>,
    /// The state whose gradients are evaluated; none where other data were stored in place of the map.
    pub state: Option<State<'a>>,
    /// The map.
    pub points: PointSource<'a, 'p>,
    /// First element.
    pub first_element: usize,
    /// The instruction set.
    pub arch: pulp::Arch,
}

impl<'p> Patch<'p> {
    pub(super) fn grid(&self) -> QuadratureGrid<'_, 'p> {
        let points = match &self.map {
            Map::TensorField(net) => PointSource::TensorField(net),
            Map::Elements(asks, _) => PointSource::Elements(*asks),
        };
        let weight = self.weight.as_ref().map(|(net, _)| net);
        QuadratureGrid { axes: &self.axes, weight, state: None, points, first_element: self.first_element, arch: self.arch }
    }
}

/// Memory of one task.
struct Scratch<'a, V> {
    map: Interpolation<V>,
    weight: Interpolation<V>,
    state: Gradients<V>,
    numbers: Aligned<V>,
    weights: Aligned<V>,
    lanes: Vec<(usize, usize)>,
    ask: Option<Box<MapEvaluator<'a>>>,
    xi: Vec<f64>,
    asked: Vec<f64>,
}

impl<'a, 'p> QuadratureGrid<'a, 'p> {
    /// The grid with the state of `source`, of whose unknowns the patch has the share `part`.
    pub fn with_state(self, part: PatchNumbering<'a>, source: &'a Integrand<'_>) -> Self {
        Self { state: source.state().map(|u| State { part, u }), ..self }
    }

    /// Walks the grid; every point of the slowest direction has `size` numbers as result.
    pub fn walk<S: Simd, const N: usize, V: Visit<S, N>>(&self, simd: S, size: usize, new: impl Fn() -> V + Sync, sink: &mut Sink<'_>) {
        let lanes = S::F64_LANES;
        let slow = &self.axes[N - 1];
        let owners = slow.owners();
        let tiles = slow.points().div_ceil(lanes);
        let threads = rayon::current_num_threads();
        let waiting = (BATCH_BYTES / (8 * size * lanes).max(1)).max(threads).min(tiles);
        let tasks = if threads == 1 { 1 } else { TASKS_PER_THREAD * threads };
        let share = waiting.div_ceil(tasks).max(1);
        let mut results = vec![0.0; waiting * lanes * size];
        // inside the pool, so that no batch has to enter it
        rayon::scope(|_| {
            let mut memory: Vec<(Scratch<'_, S::f64s>, V)> = (0..waiting.div_ceil(share)).map(|_| (self.scratch(), new())).collect();
            for from in (0..tiles).step_by(waiting) {
                let count = waiting.min(tiles - from);
                let results = &mut results[..count * lanes * size];
                let shares = results.chunks_mut((share * lanes * size).max(1)).zip(&mut memory).enumerate();
                parallel::for_each(shares, |(k, (out, (scratch, visit)))| {
                    for (j, out) in out.chunks_exact_mut((lanes * size).max(1)).enumerate() {
                        let tile = from + k * share + j;
                        scratch.lanes.clear();
                        let points = (tile * lanes..(tile + 1) * lanes).map(|q| q.min(slow.points() - 1));
                        scratch.lanes.extend(points.map(|q| (q, owners[q])));
                        let points = self.tile(tile, tiles);
                        simd.vectorize(Tile::<'_, '_, S, N, V> { simd, grid: QuadratureGrid { points, ..*self }, scratch, visit, out });
                    }
                });
                sink(from * lanes..((from + count) * lanes).min(slow.points()), results);
            }
        });
    }

    /// Source of the map on tile `k` of `tiles`: its part of stored data.
    fn tile(&self, k: usize, tiles: usize) -> PointSource<'a, 'p> {
        let part = |all: &'a [f64]| &all[k * (all.len() / tiles)..(k + 1) * (all.len() / tiles)];
        match self.points {
            PointSource::Map(all) => PointSource::Map(part(all)),
            PointSource::Other(all, size) => PointSource::Other(part(all), size),
            other => other,
        }
    }

    fn scratch<V>(&self) -> Scratch<'p, V> {
        let ask = if let PointSource::Elements(asks) = self.points { Some(asks()) } else { None };
        Scratch {
            map: Interpolation::default(),
            weight: Interpolation::default(),
            state: Gradients::default(),
            numbers: Aligned::default(),
            weights: Aligned::default(),
            lanes: Vec::new(),
            ask,
            xi: Vec::new(),
            asked: Vec::new(),
        }
    }
}

struct Tile<'a, 'p, S: Simd, const N: usize, V> {
    simd: S,
    grid: QuadratureGrid<'a, 'p>,
    scratch: &'a mut Scratch<'p, S::f64s>,
    visit: &'a mut V,
    out: &'a mut [f64],
}

impl<S: Simd, const N: usize, V: Visit<S, N>> NullaryFnOnce for Tile<'_, '_, S, N, V> {
    type Output = ();
    #[inline(always)]
    fn call(self) {
        let Self { simd, grid, scratch, visit, out } = self;
        let Scratch { map, weight, state, numbers: filled, weights, lanes, ask, xi, asked } = scratch;
        let axes = grid.axes;
        let (map_net, weight_net) = (if let PointSource::TensorField(net) = grid.points { Some(net) } else { None }, grid.weight);
        let (read_map, read_weight) = (reader(map_net), reader(weight_net));
        let of_map = map_net.map(|net| Coefficients { axes: &net.axes, width: net.width, read: &read_map });
        let of_weight = weight_net.map(|net| Coefficients { axes: &net.axes, width: 1, read: &read_weight });
        let read_state = |from: usize, to: &mut [f64]| grid.state.iter().for_each(|state| state.read(from, to));
        let of_state = grid.state.map(|state| Coefficients { axes, width: state.part.width, read: &read_state });
        for (spread, field) in [(&mut *map, of_map), (&mut *weight, of_weight), (&mut state.spread, of_state)] {
            field.into_iter().for_each(|field| spread.planes(simd, field, lanes));
        }
        visit.start(simd, lanes);
        let slow = slow_weights(simd, &axes[N - 1], lanes);
        for e in 0..if N == 3 { axes[1].elements() } else { 1 } {
            for (spread, field) in [(&mut *map, of_map), (&mut *weight, of_weight), (&mut state.spread, of_state)] {
                field.into_iter().for_each(|field| spread.lines::<S, N>(simd, field, e));
            }
            visit.open(simd, e);
            for (k, q) in (if N == 3 { axes[1].start[e]..axes[1].start[e + 1] } else { 0..1 }).enumerate() {
                let outer = if N == 3 { simd.mul_f64s(slow, simd.splat_f64s(axes[1].weights[q])) } else { slow };
                if let (PointSource::Other(all, size), None) = (grid.points, grid.weight) {
                    let line = axes[0].points() * size * S::F64_LANES;
                    if visit.line(simd, (q, k), bytemuck::cast_slice(&all[q * line..][..line])) {
                        continue;
                    }
                }
                for first in 0..axes[0].elements() {
                    let here = Here { first_element: grid.first_element, first, middle: (q, k), middle_element: e, lanes };
                    let points = axes[0].start[first]..axes[0].start[first + 1];
                    let mut cell = CellPoints { points: points.len(), map: &[], kept: &[], weight: None, state: &[] };
                    let part = |all, size: usize| {
                        let line = size * S::F64_LANES;
                        let all: &[f64] = all;
                        bytemuck::cast_slice(&all[(q * axes[0].points() + points.start) * line..][..points.len() * line])
                    };
                    match grid.points {
                        PointSource::Map(all) => cell.map = part(all, numbers(N)),
                        PointSource::Other(all, size) => cell.kept = part(all, size),
                        PointSource::TensorField(net) => {
                            filled.resize(points.len() * numbers(N));
                            let line = of_map.map_or(&[][..], |field| map.line::<N>(field, k));
                            simd.vectorize(FromNet::<'_, S, N> { simd, net, axis: &axes[0], first, line, outer, out: filled });
                            cell.map = filled;
                        }
                        PointSource::Elements(_) => {
                            filled.resize(points.len() * numbers(N));
                            if let Some(ask) = ask {
                                ask_cell::<N>(axes, here, ask, xi, asked, S::F64_LANES, bytemuck::cast_slice_mut(&mut filled[..]));
                            }
                            fill_asked::<S, N>(simd, &axes[0].weights[points.clone()], outer, filled);
                            cell.map = filled;
                        }
                    }
                    if let Some(field) = of_weight {
                        weights.resize(points.len() * (N + 1));
                        fill_weights::<S, N>(simd, &field.axes[0], (points, first), weight.line::<N>(field, k), weights);
                        cell.weight = Some(weights);
                    }
                    if let Some(field) = of_state {
                        cell.state = state.of::<S, N>(simd, field, here, cell);
                    }
                    visit.cell(simd, here, cell);
                }
            }
            visit.close(simd, e);
        }
        visit.end(simd, out);
    }
}

/// W and its derivatives at the points of a cell.
#[inline(always)]
fn fill_weights<S: Simd, const N: usize>(
    simd: S,
    axis: &AxisTable,
    (points, e): (Range<usize>, usize),
    line: &[S::f64s],
    weights: &mut [S::f64s],
) {
    for (q, out) in points.zip(weights.chunks_exact_mut(N + 1)) {
        let (value, slope) = interpolate::at::<S, N, 1>(simd, axis, (q, e), line);
        out[0] = value[0];
        for k in 0..N {
            out[1 + k] = slope[k][0];
        }
    }
}

/// Copies coefficients of a net.
fn reader(net: Option<&TensorField>) -> impl Fn(usize, &mut [f64]) + Sync + '_ {
    move |from, to| {
        if let Some(net) = net {
            to.copy_from_slice(&net.coefficients[from..from + to.len()]);
        }
    }
}

/// Weights of the points in lanes.
#[inline(always)]
fn slow_weights<S: Simd>(simd: S, axis: &AxisTable, lanes: &[(usize, usize)]) -> S::f64s {
    let mut weights = simd.splat_f64s(0.0);
    let numbers: &mut [f64] = bytemuck::cast_slice_mut(std::slice::from_mut(&mut weights));
    for (w, &(q, _)) in numbers.iter_mut().zip(lanes) {
        *w = axis.weights[q];
    }
    weights
}

/// The points of a cell, those of one lane together.
#[derive(Clone, Debug, Default)]
pub(in crate::assembly) struct QuadraturePoints {
    /// Physical points, N numbers each.
    pub x: Vec<f64>,
    /// Element per lane.
    pub elements: Vec<usize>,
    /// Local points, N numbers each; set by [`Self::locate`] or the caller.
    pub xi: Vec<f64>,
    /// First point per lane, counted in the rule of its element; set as `xi`.
    pub first: Vec<usize>,
    /// Physical gradients of the state, component by component; empty if there is none.
    pub gradients: Vec<f64>,
    answers: Vec<f64>,
}

/// Closure that writes values at all points of a cell, `size` numbers each.
pub(in crate::assembly) type PointCallback<'a> = dyn Fn(&QuadraturePoints, &mut [f64]) + Sync + 'a;

impl QuadraturePoints {
    /// Calls `answer` at all points of a cell: `out[point * size + number]`, zero in lanes beyond the last point.
    #[inline(always)]
    pub(in crate::assembly) fn ask<S: Simd, const N: usize>(
        &mut self,
        simd: S,
        cell: CellPoints<'_, S::f64s>,
        lanes: &[(usize, usize)],
        answer: &PointCallback<'_>,
        size: usize,
        out: &mut Vec<S::f64s>,
    ) {
        let valid = 1 + lanes.windows(2).take_while(|w| w[0].0 != w[1].0).count();
        let (width, count) = (S::F64_LANES, cell.points);
        self.x.resize(valid * count * N, 0.0);
        let map: &[f64] = bytemuck::cast_slice(cell.map);
        for lane in 0..valid {
            for q in 0..count {
                for k in 0..N {
                    self.x[(lane * count + q) * N + k] = map[(q * numbers(N) + k) * width + lane];
                }
            }
        }
        let rows = cell.state.len() / count.max(1);
        self.gradients.resize(valid * count * rows, 0.0);
        let state: &[f64] = bytemuck::cast_slice(cell.state);
        for (lane, own) in self.gradients.chunks_exact_mut((count * rows).max(1)).enumerate() {
            own.iter_mut().enumerate().for_each(|(k, g)| *g = state[k * width + lane]);
        }
        self.answers.resize(valid * count * size, 0.0);
        let mut answers = std::mem::take(&mut self.answers);
        answer(self, &mut answers);
        out.clear();
        out.resize(count * size, simd.splat_f64s(0.0));
        let numbers: &mut [f64] = bytemuck::cast_slice_mut(out);
        for (lane, answers) in answers.chunks_exact((count * size).max(1)).enumerate() {
            for (k, &value) in answers.iter().enumerate() {
                numbers[k * width + lane] = value;
            }
        }
        self.answers = answers;
    }

    /// Sets elements and local points of a cell, for closures that depend on them.
    pub(super) fn locate<const N: usize>(&mut self, axes: &[AxisTable], here: Here<'_>) {
        let along = axes[0].start[here.first]..axes[0].start[here.first + 1];
        let counts = [axes[0].elements(), if N == 3 { axes[1].elements() } else { 1 }];
        self.elements.clear();
        self.xi.clear();
        self.first.clear();
        let middle = if N == 3 { axes[1].start[here.middle_element + 1] - axes[1].start[here.middle_element] } else { 1 };
        for &(q, slow) in here.lanes {
            self.elements.push(here.first_element + here.first + counts[0] * (here.middle_element + counts[1] * slow));
            self.first.push(along.len() * (here.middle.1 + middle * (q - axes[N - 1].start[slow])));
            for first in along.clone() {
                self.xi.push(axes[0].xi[first]);
                if N == 3 {
                    self.xi.push(axes[1].xi[here.middle.0]);
                }
                self.xi.push(axes[N - 1].xi[q]);
            }
        }
    }
}
