//! The march along the slowest direction, layer by layer: contract, add to the ring, hand on the rows that are complete.
//!
//! A march makes the rows of (a strip of the fast direction) x (a strip of the middle one) x (functions of the slowest), see
//! [`Strip`]: in space the sums that it holds do not grow with the patch. Marches share nothing and are made in any order.
//!
//! Every entry is summed over the elements of the slowest direction in ascending order: the bits depend
//! neither on threads nor on strips, windows or layers nor on where a march starts, but for functions of a patch that are one of the whole
//! (`rows`): they depend on the strips, and these on the patch alone.
//!
//! Strips of the fast and of the middle direction, which a march holds at once, and windows of the latter, the steps in
//! which a layer goes through it.
//!
//! A strip has functions whose rows it makes, and the elements under them. Rows need the pairs with their neighbours on
//! both sides, so that sums of some functions beside the strip are held too: of the middle direction on both sides, for
//! its pairs are held both ways; of the fast direction only before it, for there the pair (i, j > i) is used for (j, i) too.
//! A pair of which one function belongs to the strip has all its elements there; others are not complete, and not read.
//!
//! A layer goes through a strip of the middle direction in windows: the contracted tiles of a few functions at a time,
//! in a ring, so that they are read again while they are in cache.

use super::Patch;
use super::axis::AxisTable;
use super::coefficient::{Coefficient, ComponentPair};
use super::contract::{self, ContractionGroup};
use super::numbering::PatchNumbering;
use super::rows::{Directions, Sums};
use super::simd::Aligned;
use super::states::State;
use super::tensor_field::TensorField;
use super::tile::{Add, Layer, Scratch, Sweep};
use crate::assembly::source::Integrand;
use crate::parallel;
use pulp::{Simd, bytemuck};
use std::ops::Range;

/// Bytes of contracted tiles that a layer of elements aims at: they stay in the second cache in the plane; in space one
/// element of the slowest direction fills more than that.
const LAYER_BYTES: usize = 1 << 20;
/// Groups of tasks per thread in a pass.
const GROUPS_PER_THREAD: usize = 4;
/// Bytes of sums that a strip of the fast and of the middle direction aims at: they stay in the third cache, or in a share
/// of it, however large the patch is.
const STRIP_BYTES: usize = 3 << 20;
/// Functions of a strip of the fast direction per active function where a patch is cut as often as it may be: at most this, and never
/// less than half of it. One element less than are active is contracted beside its rows.
const FAST_PER_ACTIVE: f64 = 6.5;
/// Functions of a strip of the fast direction in the plane: what a thread keeps of a line of points stays in its cache.
const LINE: usize = 512;
/// Functions of a strip of the middle direction per active function, about and never less than three quarters of it: beside
/// these rows sums are held on both sides.
const MIDDLE_PER_ACTIVE: f64 = 5.5;
/// Functions of the middle direction that one thread contracts at once, and several threads, which meet twice per window.
const WINDOW: [usize; 2] = [2, 8];

/// Functions of the fast and of the middle direction in a strip of a patch that has `bytes` of sums. In space the fast one is
/// cut first; in the plane a line of sums is short, and cut where it is long.
fn sizes(to: Directions<'_>, bytes: usize) -> [usize; 2] {
    let (fast, middle) = (to.fast.functions, to.middle.functions);
    let per_active = |axis: &AxisTable, size: f64| axis.functions as f64 / (size * axis.active as f64);
    let count = |bytes: usize, most: f64| bytes.div_ceil(STRIP_BYTES).min(most as usize).max(1);
    let fasts = if middle > 1 { count(bytes, per_active(to.fast, FAST_PER_ACTIVE).ceil()) } else { fast.div_ceil(LINE).max(1) };
    let middles = count(bytes / fasts, per_active(to.middle, MIDDLE_PER_ACTIVE).round());
    [fast.div_ceil(fasts), middle.div_ceil(middles)]
}

/// Constant data of a march.
pub(super) struct SweepPlan<'a, 'p> {
    pub patch: &'a Patch<'p>,
    pub coefficient: &'a Coefficient<'a>,
    /// The state that the tangent depends on.
    pub state: Option<TensorField>,
    pub pairs: Vec<ComponentPair>,
    /// Groups of pairs whose D is symmetric, and of the others.
    pub groups: [Vec<ContractionGroup>; 2],
    /// Functions of the fast and of the middle direction in a strip, at most.
    pub strip: [usize; 2],
    /// Functions of the middle direction in a window, for one thread and for several.
    pub window: [usize; 2],
}

impl<'a, 'p> SweepPlan<'a, 'p> {
    /// Creates the plan of `patch`, which has the share `part` of the unknowns.
    pub fn new(patch: &'a Patch<'p>, part: PatchNumbering<'_>, coefficient: &'a Coefficient<'a>) -> Self {
        let extended = patch.weight.is_some();
        let groups = match (&coefficient.source, patch.axes.len()) {
            (Integrand::Mass, _) => [contract::mass(), contract::mass()],
            (_, 2) => [true, false].map(|symmetric| contract::groups::<2>(symmetric, extended)),
            _ => [true, false].map(|symmetric| contract::groups::<3>(symmetric, extended)),
        };
        let pairs = coefficient.pairs();
        let to = patch.directions();
        let per_pair = to.fast.active * to.sums(to.slow.active) * pairs.len() * size_of::<f64>();
        let strip = sizes(to, to.fast.functions * to.middle.functions * per_pair);
        let state = coefficient.source.state().map(|u| State { part, u }.net(patch));
        Self { patch, coefficient, state, pairs, groups, strip, window: WINDOW }
    }

    /// The functions of the fast and of the middle direction in strips.
    pub fn strips(&self) -> [Vec<Range<usize>>; 2] {
        let to = self.patch.directions();
        [cut(to.fast.functions, self.strip[0]), cut(to.middle.functions, self.strip[1])]
    }

    /// Components of the contraction along the fastest direction.
    pub fn components(&self) -> usize {
        if matches!(self.coefficient.source, Integrand::Mass) { 1 } else { contract::components(self.patch.axes.len()) }
    }
}

/// Takes complete sums: of all functions whose number in the slowest direction is in the range, which follow each other.
pub(super) type Sink<'a> = dyn FnMut(Sums<'_>, Range<usize>) + Send + 'a;

/// Rows made by a march, as a range of functions per direction.
#[derive(Clone, Debug)]
pub(super) struct RowRange {
    pub fast: Range<usize>,
    pub middle: Range<usize>,
    pub slow: Range<usize>,
}

/// Runs the march through `part`, with `threads` threads sharing a layer.
///
/// No type parameter reaches the kernels from outside, so that they are compiled once.
pub(super) fn march(plan: &SweepPlan<'_, '_>, part: RowRange, threads: usize, sink: &mut Sink<'_>) {
    let arch = plan.patch.arch;
    match plan.patch.axes.len() {
        2 => arch.dispatch(March::<2> { plan, part, threads, sink }),
        _ => arch.dispatch(March::<3> { plan, part, threads, sink }),
    }
}

struct March<'a, 'p, 's, const N: usize> {
    plan: &'a SweepPlan<'a, 'p>,
    part: RowRange,
    threads: usize,
    sink: &'a mut Sink<'s>,
}

impl<const N: usize> pulp::WithSimd for March<'_, '_, '_, N> {
    type Output = ();
    fn with_simd<S: Simd>(self, simd: S) {
        if !S::IS_SCALAR {
            run(simd, self);
        }
    }
}

/// Elements of the slowest direction that a layer takes.
fn layer_elements<const N: usize>(axes: &[AxisTable], fast: &Strip, components: usize) -> usize {
    let slow = &axes[N - 1];
    let per_point = if N == 3 { axes[1].points() } else { 1 } * fast.held.len() * axes[0].active * components;
    let per_element = slow.points().div_ceil(slow.elements()) * per_point * size_of::<f64>();
    (LAYER_BYTES / per_element.max(1)).clamp(1, slow.elements())
}

fn run<S: Simd, const N: usize>(simd: S, march: March<'_, '_, '_, N>) {
    let March { plan, part: RowRange { fast, middle, slow: rows }, threads, sink } = march;
    let axes = &plan.patch.axes;
    let slow = &axes[N - 1];
    let mut reached = rows.clone().filter(|&i| slow.support[i].1 > 0);
    let Some(lowest) = reached.next() else { return };
    let highest = reached.next_back().unwrap_or(lowest);
    let to = plan.patch.directions();
    let (Some(fast), Some(middle)) = (Strip::one_way(to.fast, fast), Strip::both_ways(to.middle, middle)) else { return };
    let (begin, end) = (slow.support[lowest].0, slow.support[highest].1);
    let step = layer_elements::<N>(axes, &fast, plan.pairs.len() * plan.components());
    let layers: Vec<Range<usize>> = (begin..end).step_by(step).map(|e| e..(e + step).min(end)).collect();
    let slots = layers.iter().map(|l| slow.first[l.end - 1] + slow.active - slow.first[l.start]).max().unwrap_or(0);
    let points = layers.iter().map(|l| slow.start[l.end] - slow.start[l.start]).max().unwrap_or(0);
    let sweep = Sweep::<N>::new(plan, [fast, middle], threads, points, slots, S::F64_LANES);
    let groups = if threads == 1 { 1 } else { GROUPS_PER_THREAD * threads };
    let mut scratch: Vec<Scratch<'_, S::f64s>> = (0..groups).map(|_| sweep.scratch(simd)).collect();
    // written before they are read
    let mut tiles = Aligned::<S::f64s>::new(sweep.tiles * sweep.lines * sweep.task);
    let mut ring = Aligned::<S::f64s>::new(sweep.vectors * sweep.vector);
    let (tiles, ring) = (&mut tiles[..], &mut ring[..]);
    let mut lines = sweep.lines();
    let mut next = rows.start;
    for elements in layers {
        let layer = Layer { points: slow.start[elements.start]..slow.start[elements.end], elements };
        sweep.fill_lines(&layer, &(begin..end), &mut lines);
        for window in &sweep.windows.steps {
            let mut new = sweep.tiles_of(&layer, window);
            while !new.is_empty() {
                // up to the end of the ring of tiles
                let slot = new.start % sweep.tiles;
                let count = new.len().min(sweep.tiles - slot);
                let tasks = count * sweep.lines;
                let share = tasks.div_ceil(groups).max(1);
                let out = &mut tiles[slot * sweep.lines * sweep.task..][..tasks * sweep.task];
                parallel::for_each(out.chunks_mut(share * sweep.task).zip(&mut scratch).enumerate(), |(k, (chunk, scratch))| {
                    for (j, out) in chunk.chunks_exact_mut(sweep.task).enumerate() {
                        let task = k * share + j;
                        let (tile, line) = (new.start + task / sweep.lines, task % sweep.lines);
                        if N == 2 || line < layer.points.len() {
                            sweep.fast(simd, &layer, [tile, line], &lines, scratch, out);
                        }
                    }
                });
                new.start += count;
            }

            let share = sweep.vectors.div_ceil(groups).max(1);
            let (sweep, layer, tiles) = (&sweep, &layer, &*tiles);
            parallel::for_each(ring.chunks_mut(share * sweep.vector).zip(&mut scratch).enumerate(), |(k, (chunk, scratch))| {
                for (j, sums) in chunk.chunks_exact_mut(sweep.vector).enumerate() {
                    simd.vectorize(Add { simd, sweep, layer, window, r: k * share + j, tiles, scratch: &mut scratch.sums, sums });
                }
            });
        }

        let first = next;
        while next < rows.end && slow.support[next].1 <= layer.elements.end {
            next += 1;
        }
        let sums = Sums {
            values: bytemuck::cast_slice(ring),
            lanes: S::F64_LANES,
            pair: sweep.vector / plan.pairs.len(),
            slots,
            fast: &sweep.fast,
            first: sweep.middle.held.start,
            components: plan.coefficient.components,
            pairs: &plan.pairs,
            symmetric: plan.coefficient.symmetric,
            weights: plan.patch.weight.as_ref().map(|w| &w.1[..]),
        };
        sink(sums, first..next);
    }
}

/// Functions of one direction whose rows are made by one march.
#[derive(Clone, Debug)]
pub(super) struct Strip {
    /// Functions whose rows are made.
    pub rows: Range<usize>,
    /// Functions whose sums are held.
    pub held: Range<usize>,
    /// Elements under the rows.
    pub elements: Range<usize>,
    /// Points of these elements.
    pub points: Range<usize>,
}

impl Strip {
    /// The strip of `rows` with sums of pairs both ways; `None` if no row has an element.
    pub fn both_ways(axis: &AxisTable, rows: Range<usize>) -> Option<Self> {
        let mut reached = rows.clone().filter(|&i| axis.support[i].1 > 0);
        let first = reached.next()?;
        let last = reached.next_back().unwrap_or(first);
        let elements = axis.support[first].0..axis.support[last].1;
        let points = axis.start[elements.start]..axis.start[elements.end];
        let held = axis.columns[first].0..axis.columns[last].1;
        Some(Self { rows, held, elements, points })
    }

    /// The strip of `rows` with sums of pairs (i, j >= i) only.
    pub fn one_way(axis: &AxisTable, rows: Range<usize>) -> Option<Self> {
        let strip = Self::both_ways(axis, rows)?;
        Some(Self { held: strip.held.start..strip.rows.end, ..strip })
    }

    /// Elements of function `i` that the strip has.
    #[inline(always)]
    pub fn support(&self, axis: &AxisTable, i: usize) -> Range<usize> {
        axis.support[i].0.max(self.elements.start)..axis.support[i].1.min(self.elements.end)
    }

    /// Functions j whose pair (i, j) is held both ways: all neighbours of a row, the rows among those of another function.
    pub fn pairs(&self, axis: &AxisTable, i: usize) -> Range<usize> {
        let (from, to) = axis.columns[i];
        if self.rows.contains(&i) { from..to } else { from.max(self.rows.start)..to.min(self.rows.end) }
    }
}

/// A few functions of a strip.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Window {
    /// The functions.
    pub functions: Range<usize>,
    /// Tiles that are contracted before they are summed, counted from the first point of the strip.
    pub tiles: Range<usize>,
}

/// The steps through a strip of the middle direction.
#[derive(Clone, Debug)]
pub(super) struct Windows {
    /// The steps.
    pub steps: Vec<Window>,
    /// Tiles that are held at once.
    pub tiles: usize,
}

impl Windows {
    /// `strip` in windows of `step` functions, with `lanes` points per tile.
    pub fn new(axis: &AxisTable, strip: &Strip, step: usize, lanes: usize) -> Self {
        let (mut windows, mut done, step) = (Self { steps: Vec::new(), tiles: 0 }, 0, step.max(1));
        for from in strip.held.clone().step_by(step) {
            let functions = from..(from + step).min(strip.held.end);
            let mut reached = functions.clone().map(|i| strip.support(axis, i)).filter(|e| !e.is_empty());
            let Some(first) = reached.next() else { continue };
            let last = reached.next_back().map_or(first.end, |last| last.end);
            let begin = (axis.start[first.start] - strip.points.start) / lanes;
            let end = (axis.start[last] - strip.points.start).div_ceil(lanes).max(done);
            windows.tiles = windows.tiles.max(end - begin.min(done));
            windows.steps.push(Window { functions, tiles: done..end });
            done = end;
        }
        windows
    }

    /// Offsets of the points of `strip` in the ring of tiles, with `tile` vectors per tile and `point` vectors per point.
    pub fn ring_offsets(&self, strip: &Strip, lanes: usize, tile: usize, point: usize) -> Vec<usize> {
        (0..strip.points.len()).map(|q| q / lanes % self.tiles * tile + q % lanes * point).collect()
    }
}

/// `functions` in strips of `size`, as even as they can be.
pub(super) fn cut(functions: usize, size: usize) -> Vec<Range<usize>> {
    let count = functions.div_ceil(size.max(1)).max(1);
    (0..count).map(|k| k * functions / count..(k + 1) * functions / count).collect()
}
