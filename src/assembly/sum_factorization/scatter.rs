//! Rows of the patches of a glued body to the rows of the whole.
//!
//! Patches follow each other. The rows of one stretch (a strip of the fast and of the middle direction, some functions of the
//! slowest) are handed out by their numbers in the whole, each to the task of its patch; a second function of the stretch with the
//! same number comes after all others. So every entry is summed in an order that does not depend on the threads.

use super::glue::Glue;
use super::sweep::{RowRange, SweepPlan, march};
use super::write::{Directions, RowScratch, Sums};
use crate::assembly::pattern::each_row;
use crate::linalg::{Csr, Real, Sparsity};
use rayon::prelude::*;
use std::ops::Range;

/// Tasks per thread of a stretch of rows.
const TASKS_PER_THREAD: usize = 2;

/// The matrix of one form, a plan per patch, to `matrix`; `add`: on top of what is there.
pub(super) fn fill<T: Real>(plans: &[SweepPlan<'_, '_>], glue: &Glue, add: bool, matrix: &mut Csr<T>) {
    let (coefficient, threads) = (plans[0].coefficient, rayon::current_num_threads());
    let c = coefficient.components;
    let graph = matrix.pattern().clone();
    assert_eq!(graph.block(), c, "the matrix has the pattern of the basis");
    let starts: Vec<usize> = graph.ptr().iter().map(|blocks| c * c * blocks).collect();
    let to = Target { glue, starts: &starts, graph: &graph, add };
    let values = matrix.vals_mut();
    if !add {
        each_row(&starts, values, |k, row| {
            if !glue.direct[k] {
                row.fill(T::zero());
            }
        });
    }
    for (plan, &first) in plans.iter().zip(&glue.first) {
        let directions = plan.patch.directions();
        // inside the pool, so that no pass has to enter it
        rayon::scope(|_| {
            // the order of sums of merged functions follows from the strips: they depend on nothing but the patch
            let strips = plan.strips();
            for (middle, fast) in strips[1].iter().flat_map(|middle| strips[0].iter().map(move |fast| (middle, fast))) {
                let part = RowRange { fast: fast.clone(), middle: middle.clone(), slow: 0..directions.slow.functions };
                march(plan, part, threads, &mut |sums: Sums<'_>, rows: Range<usize>| {
                    to.stretch(&sums, directions, first, [middle.clone(), rows], threads, values);
                });
            }
        });
    }
    if coefficient.symmetric && !add {
        to.mirror(values);
    }
}

/// The matrix of the whole.
#[derive(Clone, Copy)]
struct Target<'a> {
    glue: &'a Glue,
    /// First value of every function.
    starts: &'a [usize],
    graph: &'a Sparsity,
    add: bool,
}

impl Target<'_> {
    /// Place of `other` among the neighbours of function `k`; `guess` is looked at first.
    #[inline]
    fn place(&self, k: usize, other: u32, guess: usize) -> usize {
        let row = self.graph.group(k);
        if row.get(guess) == Some(&other) {
            return guess;
        }
        row.binary_search(&other).expect("the matrix has the pattern of the basis")
    }

    /// Adds the rows of the strip of `sums`, of `middle` and of `slow` of the patch whose functions start at `first`.
    fn stretch<T: Real>(
        &self,
        sums: &Sums<'_>,
        to: Directions<'_>,
        first: usize,
        [middle, slow]: [Range<usize>; 2],
        threads: usize,
        values: &mut [T],
    ) {
        let (fast, n1) = (&sums.fast.rows, middle.len());
        let n0 = fast.len();
        let place = |line: usize| [middle.start + line % n1, slow.start + line / n1];
        let begin = |[middle, slow]: [usize; 2]| first + fast.start + to.fast.functions * (middle + to.middle.functions * slow);
        let lines = slow.len() * n1;
        let ids = (0..lines).flat_map(|line| &self.glue.ids[begin(place(line))..][..n0]);
        let mut order: Vec<(u32, usize)> = ids.copied().zip(0..).collect();
        order.sort_unstable();
        let mut slots: Vec<Option<&mut [T]>> = order.iter().map(|_| None).collect();
        let (mut rest, mut next, mut later) = (&mut *values, 0, Vec::new());
        for (n, &(id, i)) in order.iter().enumerate() {
            let (from, end) = (self.starts[id as usize], self.starts[id as usize + 1]);
            if n > 0 && order[n - 1].0 == id {
                later.push(i);
                continue;
            }
            let (own, others) = rest.split_at_mut(from - next).1.split_at_mut(end - from);
            (slots[i], rest, next) = (Some(own), others, end);
        }
        let share = lines.div_ceil(if threads == 1 { 1 } else { TASKS_PER_THREAD * threads }).max(1);
        slots.par_chunks_mut(share * n0).enumerate().for_each(|(task, slots)| {
            let mut scratch = RowScratch::default();
            for (k, slots) in slots.chunks_mut(n0).enumerate() {
                let line = task * share + k;
                self.line(sums, to, first, fast.clone(), place(line), slots, &mut scratch);
            }
        });
        drop(slots);
        later.sort_unstable();
        let mut scratch = RowScratch::default();
        for i in later {
            let [middle, slow] = place(i / n0);
            let id = self.glue.ids[begin([middle, slow]) + i % n0] as usize;
            let mut slot = [Some(&mut values[self.starts[id]..self.starts[id + 1]])];
            self.line(sums, to, first, fast.start + i % n0..fast.start + i % n0 + 1, [middle, slow], &mut slot, &mut scratch);
        }
    }

    /// The rows of functions (`fast`, middle, slow) that have a slot.
    fn line<T: Real>(
        &self,
        sums: &Sums<'_>,
        to: Directions<'_>,
        first: usize,
        fast: Range<usize>,
        [middle, slow]: [usize; 2],
        slots: &mut [Option<&mut [T]>],
        RowScratch { lines, row }: &mut RowScratch<T>,
    ) {
        let (n, own) = (sums.components, first + to.fast.functions * (middle + to.middle.functions * slow));
        lines.start(sums, to, [middle, slow]);
        for c in 0..n {
            lines.fill(sums, to.fast, c, fast.clone());
            for (i, slot) in fast.clone().zip(slots.iter_mut()) {
                let Some(out) = slot else { continue };
                let id = self.glue.ids[own + i] as usize;
                let length = out.len() / n;
                let out = &mut out[c * length..][..length];
                if self.glue.direct[id] && !self.add {
                    lines.row(sums, to.fast, i, c, out);
                    continue;
                }
                let (from, end) = to.fast.columns[i];
                let width = n * (end - from);
                row.resize(lines.runs.len() * width, T::zero());
                lines.row(sums, to.fast, i, c, row);
                let mut place = 0;
                for (run, values) in lines.runs.iter().zip(row.chunks_exact(width.max(1))) {
                    let (mut j, last) = (first + run.first + from, first + run.first + end);
                    let mut values = values;
                    while j < last {
                        let end = self.glue.run_end[j].min(last);
                        let (part, others) = values.split_at((end - j) * n);
                        place = self.place(id, self.glue.ids[j], place);
                        out[place * n..][..part.len()].iter_mut().zip(part).for_each(|(to, &value)| *to += value);
                        place += end - j;
                        (j, values) = (end, others);
                    }
                }
            }
        }
    }

    /// Gives entries opposite those of merged functions the same bits: theirs were summed in another order.
    fn mirror<T: Real>(&self, values: &mut [T]) {
        let n = self.graph.block();
        let at = |k: usize, c: usize, place: usize, e: usize| {
            let length = (self.starts[k + 1] - self.starts[k]) / n;
            self.starts[k] + c * length + place * n + e
        };
        for &k in &self.glue.merged {
            for (place, &j) in self.graph.group(k).iter().enumerate() {
                let j = j as usize;
                if j < k && self.glue.merged.binary_search(&j).is_ok() {
                    continue;
                }
                let opposite = self.place(j, k as u32, 0);
                for c in 0..n {
                    for e in if j == k { c + 1 } else { 0 }..n {
                        values[at(j, e, opposite, c)] = values[at(k, c, place, e)];
                    }
                }
            }
        }
    }
}
