//! Rows of the matrix from complete sums: every value is written once, front to back.
//!
//! Sums hold pairs j >= i of the fastest direction; the others are the mirror image, pair (j, i) of all directions. On
//! the diagonal of the fastest direction the pair that comes first in the other directions is used for both, so that the
//! matrix is symmetric to the last bit. What belongs to one pair of the other directions lies scattered over the sums:
//! it is copied to one line first, from which all rows take their entries.
//!
//! The rows of one function of the outer directions: sums are copied to lines first, rows take their entries from these.
//!
//! A line holds all pairs (i, j >= i) of the fastest direction at `i * active + j - i`, for one pair of functions of the
//! outer directions. A row needs two of them: its own for j >= i, the mirrored pair's for j < i.
//!
//! Rows of the patches of a glued body to the rows of the whole.
//!
//! Patches follow each other. The rows of one stretch (a strip of the fast and of the middle direction, some functions of the
//! slowest) are handed out by their numbers in the whole, each to the task of its patch; a second function of the stretch with the
//! same number comes after all others. So every entry is summed in an order that does not depend on the threads.

use super::axis::AxisTable;
use super::coefficient::ComponentPair;
use super::contract::Ring;
use super::numbering::Glue;
use super::sweep::{RowRange, Strip, SweepPlan, march};
use crate::assembly::pattern::each_row;
use crate::linalg::{Csr, Real, Sparsity, lit};
use crate::parallel;
use std::cmp::Ordering;
use std::ops::Range;

/// Sums of a march and their layout.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sums<'a> {
    /// All sums.
    pub values: &'a [f64],
    /// Lanes of a vector.
    pub lanes: usize,
    /// Vectors per pair of components.
    pub pair: usize,
    /// Slots of the ring.
    pub slots: usize,
    /// Functions of the fast direction.
    pub fast: &'a Strip,
    /// First function of the middle direction that has sums.
    pub first: usize,
    /// Components of the field.
    pub components: usize,
    /// Pairs of components.
    pub pairs: &'a [ComponentPair],
    /// Whether the form is symmetric.
    pub symmetric: bool,
    /// One weight per function of a rational basis.
    pub weights: Option<&'a [f64]>,
}

/// The directions, fastest first; in the plane the middle one is [`AxisTable::none`].
#[derive(Clone, Copy, Debug)]
pub(super) struct Directions<'a> {
    /// Fastest.
    pub fast: &'a AxisTable,
    /// Middle.
    pub middle: &'a AxisTable,
    /// Slowest.
    pub slow: &'a AxisTable,
}

impl Directions<'_> {
    /// Place of the ring of the pair (i, j) of functions of the middle direction, the first of which that has sums is `first`.
    #[inline(always)]
    pub fn ring(&self, slots: usize, first: usize, i: usize, j: usize) -> Ring {
        let (active, pair) = (self.middle.active, 2 * self.middle.active - 1);
        Ring { slots, pair, start: (i - first) * slots * (2 * self.slow.active - 1) * pair + j + active - 1 - i }
    }

    /// Vectors of sums per function of the middle direction, pair of components and vector of pairs of the fastest one.
    pub fn sums(&self, slots: usize) -> usize {
        slots * (2 * self.slow.active - 1) * (2 * self.middle.active - 1)
    }

    /// Entries of the scalar matrix before function (0, middle, slow).
    pub fn entries(&self, middle: usize, slow: usize) -> usize {
        let (fast, mid) = (self.fast.sums[self.fast.functions], self.middle.sums[self.middle.functions]);
        let (from, to) = self.slow.columns.get(slow).copied().unwrap_or((0, 0));
        (self.slow.sums[slow] * mid + (to - from) * self.middle.sums[middle]) * fast
    }
}

impl Sums<'_> {
    /// The rows of functions (the strip's, middle, slow), `outer` are the last two, to `out`; `add`: adds to it.
    pub fn write<T: Real>(&self, to: Directions<'_>, outer: [usize; 2], add: bool, scratch: &mut RowScratch<T>, out: &mut [T]) {
        let (n, RowScratch { lines, row }) = (self.components, scratch);
        lines.start(self, to, outer);
        let (rows, step) = (self.fast.rows.clone(), lines.at_once(self, to.fast));
        // functions before those held have no element
        let reached = rows.start.max(self.fast.held.start)..rows.end;
        let blocks = reached.step_by(step).map(|from| from..(from + step).min(rows.end));
        for (c, block) in blocks.flat_map(|block| (0..n).map(move |c| (c, block.clone()))) {
            lines.fill(self, to.fast, c, block.clone());
            for i in block {
                let before = n * lines.runs.len() * (to.fast.sums[i] - to.fast.sums[rows.start]);
                let length = n * lines.runs.len() * (to.fast.sums[i + 1] - to.fast.sums[i]);
                let own = &mut out[n * before + c * length..][..length];
                if add {
                    row.resize(length, T::zero());
                    lines.row(self, to.fast, i, c, row);
                    own.iter_mut().zip(row.iter()).for_each(|(to, &value)| *to += value);
                } else {
                    lines.row(self, to.fast, i, c, own);
                }
            }
        }
    }
}

/// Memory of [`Sums::write`].
#[derive(Clone, Debug)]
pub(super) struct RowScratch<T> {
    pub lines: ComponentLines,
    pub row: Vec<T>,
}

impl<T> Default for RowScratch<T> {
    fn default() -> Self {
        Self { lines: ComponentLines::default(), row: Vec::new() }
    }
}

/// Bytes of lines that rows are taken from at once.
const BYTES_AT_ONCE: usize = 16 << 10;
/// Fewest rows at once: the pairs of some rows before them are copied too.
const ROWS_AT_LEAST: usize = 32;

/// Functions of the fastest direction beside one pair of functions of the others.
#[derive(Clone, Copy, Debug)]
pub(super) struct FunctionRun {
    /// Place of the sums of pairs j >= i.
    upper: usize,
    /// Place of the sums of pairs (j, i) of all directions.
    mirror: usize,
    /// Order of the other function's (slow, middle) relative to the row's.
    order: Ordering,
    /// Number of the first function of the line of the other function.
    pub first: usize,
}

/// Lines of one component of the test function, and the memory for them.
#[derive(Clone, Debug, Default)]
pub(super) struct ComponentLines {
    /// One per pair of functions of the outer directions, columns ascending.
    pub runs: Vec<FunctionRun>,
    /// The mirrored and the own line of every run and component of the trial function.
    values: Vec<f64>,
    /// Numbers of a line, the first that is copied, and the first that has sums.
    width: usize,
    from: usize,
    origin: usize,
    /// First number of the line of the rows.
    first: usize,
}

impl ComponentLines {
    /// The runs of the rows of (.., `middle`, `slow`).
    pub fn start(&mut self, sums: &Sums<'_>, to: Directions<'_>, [middle, slow]: [usize; 2]) {
        self.first = to.fast.functions * (middle + to.middle.functions * slow);
        self.runs.clear();
        for js in to.slow.columns[slow].0..to.slow.columns[slow].1 {
            for jm in to.middle.columns[middle].0..to.middle.columns[middle].1 {
                self.runs.push(FunctionRun {
                    upper: to.ring(sums.slots, sums.first, middle, jm).at(to.slow.active, slow, js),
                    mirror: to.ring(sums.slots, sums.first, jm, middle).at(to.slow.active, js, slow),
                    order: (js, jm).cmp(&(slow, middle)),
                    first: to.fast.functions * (jm + to.middle.functions * js),
                });
            }
        }
    }

    /// Functions of the fastest direction whose lines stay in the first cache, `ROWS_AT_LEAST` or more.
    pub fn at_once(&self, sums: &Sums<'_>, axis: &AxisTable) -> usize {
        let per_function = 2 * self.runs.len() * sums.components * axis.active * size_of::<f64>();
        (BYTES_AT_ONCE / per_function.max(1)).max(ROWS_AT_LEAST)
    }

    /// Copies the sums of component `c` of the test function, as far as the rows of `functions` need them.
    pub fn fill(&mut self, sums: &Sums<'_>, axis: &AxisTable, c: usize, functions: Range<usize>) {
        let first = sums.fast.held.start;
        let from = (functions.start + 1).saturating_sub(axis.active).max(first);
        let pairs = (from - first) * axis.active..(functions.end - first) * axis.active;
        self.origin = first * axis.active;
        match sums.lanes {
            2 => self.copy::<2>(sums, c, pairs),
            4 => self.copy::<4>(sums, c, pairs),
            8 => self.copy::<8>(sums, c, pairs),
            lanes => unreachable!("processors have 2, 4 or 8 lanes, not {lanes}"),
        }
    }

    fn copy<const L: usize>(&mut self, sums: &Sums<'_>, c: usize, pairs: Range<usize>) {
        let n = sums.components;
        let (from, per_vector) = (sums.values.as_chunks::<L>().0, sums.pairs.len() * sums.pair);
        let (first, vectors) = (pairs.start / L, pairs.end.div_ceil(L) - pairs.start / L);
        (self.from, self.width) = (self.origin + first * L, vectors * L);
        self.values.resize(self.runs.len() * n * 2 * self.width, 0.0);
        let out = self.values.as_chunks_mut::<L>().0;
        for (r, from) in from.chunks_exact(per_vector).skip(first).take(vectors).enumerate() {
            for e in 0..n {
                let (mirror, upper) = (&from[sums.pairs[c * n + e].mirror * sums.pair..], &from[(c * n + e) * sums.pair..]);
                let mut at = 2 * e * vectors + r;
                for run in &self.runs {
                    out[at] = mirror[run.mirror];
                    out[at + vectors] = upper[run.upper];
                    at += 2 * n * vectors;
                }
            }
        }
    }

    /// Row `i` of component `c` to `out`, the component of the trial function fastest.
    pub fn row<T: Real>(&self, sums: &Sums<'_>, axis: &AxisTable, i: usize, c: usize, out: &mut [T]) {
        let n = sums.components;
        let (from, to) = axis.columns[i];
        let inside = from + axis.active == i + 1 && to == i + axis.active;
        for ((run, lines), out) in
            self.runs.iter().zip(self.values.chunks_exact(2 * n * self.width)).zip(out.chunks_exact_mut((n * (to - from)).max(1)))
        {
            match (n, axis.active) {
                (1, 2) if inside => self.inner::<T, 1, 2, 3>(lines, i, out),
                (1, 3) if inside => self.inner::<T, 1, 3, 5>(lines, i, out),
                (1, 4) if inside => self.inner::<T, 1, 4, 7>(lines, i, out),
                (1, 5) if inside => self.inner::<T, 1, 5, 9>(lines, i, out),
                (2, 3) if inside => self.inner::<T, 2, 3, 5>(lines, i, out),
                (2, 4) if inside => self.inner::<T, 2, 4, 7>(lines, i, out),
                (3, 2) if inside => self.inner::<T, 3, 2, 3>(lines, i, out),
                (3, 3) if inside => self.inner::<T, 3, 3, 5>(lines, i, out),
                (3, 4) if inside => self.inner::<T, 3, 4, 7>(lines, i, out),
                _ => self.any(lines, axis.active, i, from..to, n, out),
            }
            if sums.symmetric && run.order != Ordering::Greater {
                // on the diagonal the pair that comes first is used for both
                let turned = if run.order == Ordering::Less { n } else { c };
                for e in 0..turned {
                    out[(i - from) * n + e] = lit(lines[2 * e * self.width + i * axis.active - self.from]);
                }
            }
            if let Some(weights) = sums.weights {
                // R_i = w_i N_i / W
                for (k, values) in out.chunks_exact_mut(n).enumerate() {
                    let factor = lit::<T>(weights[self.first + i] * weights[run.first + from + k]);
                    values.iter_mut().for_each(|v| *v *= factor);
                }
            }
        }
    }

    /// A run whose row has neighbours on both sides as far as the degree reaches: NP functions per element, M = 2 NP - 1.
    #[inline(always)]
    fn inner<T: Real, const C: usize, const NP: usize, const M: usize>(&self, lines: &[f64], i: usize, out: &mut [T]) {
        let first = i + 1 - NP;
        let out = &mut out.as_chunks_mut::<C>().0[..M];
        for e in 0..C {
            let (mirror, upper) = (&lines[2 * e * self.width..], &lines[(2 * e + 1) * self.width..]);
            let mirror = &mirror[first * (NP - 1) + i - self.from..][..(NP - 2) * (NP - 1) + 1];
            let upper = &upper[i * NP - self.from..][..NP];
            for a in 0..NP - 1 {
                out[a][e] = lit(mirror[a * (NP - 1)]);
            }
            for a in 0..NP {
                out[NP - 1 + a][e] = lit(upper[a]);
            }
        }
    }

    fn any<T: Real>(&self, lines: &[f64], active: usize, i: usize, columns: Range<usize>, n: usize, out: &mut [T]) {
        for (j, out) in columns.zip(out.chunks_exact_mut(n)) {
            for (e, out) in out.iter_mut().enumerate() {
                let half = usize::from(j >= i);
                *out = lit(lines[(2 * e + half) * self.width + i.min(j) * active + i.abs_diff(j) - self.from]);
            }
        }
    }
}

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
        parallel::for_each(slots.chunks_mut(share * n0).enumerate(), |(task, slots)| {
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
