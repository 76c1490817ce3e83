//! The march along the slowest direction, layer by layer: contract, add to the ring, hand on the rows that are complete.
//!
//! Every entry is summed over the elements of the slowest direction in ascending order, whoever does it: the bits depend
//! neither on threads nor on layers nor on where a march starts.

use super::Patch;
use super::axis::Axis;
use super::coefficient::{Coefficient, Pair};
use super::fast::Group;
use super::groups;
use super::layer::{Layer, Scratch, Sweep};
use super::write::Sums;
use crate::assembly::source::Source;
use pulp::{Simd, bytemuck};
use rayon::prelude::*;
use std::ops::Range;

/// Bytes of contracted tiles that a layer of elements aims at: they stay in the second cache in the plane; in space one
/// element of the slowest direction fills more than that.
const LAYER_BYTES: usize = 1 << 20;
/// Groups of tasks per thread in a pass.
const GROUPS_PER_THREAD: usize = 4;

/// All that a march needs and does not change.
pub(super) struct Plan<'a, 'p> {
    pub patch: &'a Patch<'p>,
    pub coefficient: &'a Coefficient<'a>,
    pub pairs: Vec<Pair>,
    /// Groups of pairs whose D is symmetric, and of the others.
    pub groups: [Vec<Group>; 2],
}

impl<'a, 'p> Plan<'a, 'p> {
    pub fn new(patch: &'a Patch<'p>, coefficient: &'a Coefficient<'a>) -> Self {
        let extended = patch.weight.is_some();
        let groups = match (&coefficient.source, patch.axes.len()) {
            (Source::Mass, _) => [groups::mass(), groups::mass()],
            (_, 2) => [true, false].map(|symmetric| groups::groups::<2>(symmetric, extended)),
            _ => [true, false].map(|symmetric| groups::groups::<3>(symmetric, extended)),
        };
        Self { patch, coefficient, pairs: coefficient.pairs(), groups }
    }

    /// Components of the contraction along the fastest direction.
    pub fn components(&self) -> usize {
        if matches!(self.coefficient.source, Source::Mass) { 1 } else { groups::components(self.patch.axes.len()) }
    }
}

/// Takes complete sums: of all functions whose number in the slowest direction is in the range, which follow each other.
pub(super) type Sink<'a> = dyn FnMut(Sums<'_>, Range<usize>) + Send + 'a;

/// The march over the functions `rows` of the slowest direction, `threads` of them sharing a layer.
///
/// No type parameter reaches the kernels from outside, so that they are compiled once.
pub(super) fn march(plan: &Plan<'_, '_>, rows: Range<usize>, threads: usize, sink: &mut Sink<'_>) {
    let arch = plan.patch.arch;
    match plan.patch.axes.len() {
        2 => arch.dispatch(March::<2> { plan, rows, threads, sink }),
        _ => arch.dispatch(March::<3> { plan, rows, threads, sink }),
    }
}

struct March<'a, 'p, 's, const N: usize> {
    plan: &'a Plan<'a, 'p>,
    rows: Range<usize>,
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
fn layer_elements<const N: usize>(axes: &[Axis], components: usize) -> usize {
    let slow = &axes[N - 1];
    let per_point = if N == 3 { axes[1].points() } else { 1 } * axes[0].functions * axes[0].active * components;
    let per_element = slow.points().div_ceil(slow.elements()) * per_point * size_of::<f64>();
    (LAYER_BYTES / per_element.max(1)).clamp(1, slow.elements())
}

fn run<S: Simd, const N: usize>(simd: S, march: March<'_, '_, '_, N>) {
    let March { plan, rows, threads, sink } = march;
    let axes = &plan.patch.axes;
    let slow = &axes[N - 1];
    let mut reached = rows.clone().filter(|&i| slow.support[i].1 > 0);
    let (Some(lowest), Some(highest)) = (reached.clone().next(), reached.next_back()) else { return };
    let (begin, end) = (slow.support[lowest].0, slow.support[highest].1);
    let step = layer_elements::<N>(axes, plan.pairs.len() * plan.components());
    let layers: Vec<Range<usize>> = (begin..end).step_by(step).map(|e| e..(e + step).min(end)).collect();
    let slots = layers.iter().map(|l| slow.first[l.end - 1] + slow.active - slow.first[l.start]).max().unwrap_or(0);
    let points = layers.iter().map(|l| slow.start[l.end] - slow.start[l.start]).max().unwrap_or(0);
    let sweep = Sweep::<N>::new(plan, points, slots, S::F64_LANES);
    let zero = simd.splat_f64s(0.0);
    let groups = if threads == 1 { 1 } else { GROUPS_PER_THREAD * threads };
    let mut scratch: Vec<Scratch<'_, S::f64s>> = (0..groups).map(|_| sweep.scratch(simd)).collect();
    let mut tiles = vec![zero; sweep.tasks * sweep.task];
    let mut ring = vec![zero; sweep.vectors * sweep.vector];
    let mut lines = sweep.lines();
    let mut next = rows.start;
    for elements in layers {
        let layer = Layer { points: slow.start[elements.start]..slow.start[elements.end], elements };
        sweep.fill_lines(&layer, &mut lines);

        let tasks = sweep.tasks_of(&layer);
        let share = tasks.div_ceil(groups).max(1);
        tiles[..tasks * sweep.task].par_chunks_mut(share * sweep.task).zip(&mut scratch).enumerate().for_each(|(k, (chunk, scratch))| {
            for (j, out) in chunk.chunks_exact_mut(sweep.task).enumerate() {
                sweep.fast(simd, &layer, k * share + j, &lines, scratch, out);
            }
        });

        let share = sweep.vectors.div_ceil(groups).max(1);
        ring.par_chunks_mut(share * sweep.vector).zip(&mut scratch).enumerate().for_each(|(k, (chunk, scratch))| {
            for (j, sums) in chunk.chunks_exact_mut(sweep.vector).enumerate() {
                sweep.sums(simd, &layer, k * share + j, &tiles, scratch, sums);
            }
        });

        let first = next;
        while next < rows.end && slow.support[next].1 <= layer.elements.end {
            next += 1;
        }
        let sums = Sums {
            values: bytemuck::cast_slice(&ring),
            lanes: S::F64_LANES,
            pair: sweep.vector / plan.pairs.len(),
            slots,
            components: plan.coefficient.components,
            pairs: &plan.pairs,
            symmetric: plan.coefficient.symmetric,
            weights: plan.patch.weight.as_ref().map(|w| &w.1[..]),
        };
        sink(sums, first..next);
    }
}
