//! The rows of one function of the outer directions: sums are copied to lines first, rows take their entries from these.
//!
//! A line holds all pairs (i, j >= i) of the fastest direction at `i * active + j - i`, for one pair of functions of the
//! outer directions. A row needs two of them: its own for j >= i, the mirrored pair's for j < i.

use super::axis::Axis;
use super::write::{Directions, Sums};
use crate::linalg::{Real, lit};
use std::cmp::Ordering;
use std::ops::Range;

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
pub(super) struct Lines {
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

impl Lines {
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
    pub fn at_once(&self, sums: &Sums<'_>, axis: &Axis) -> usize {
        let per_function = 2 * self.runs.len() * sums.components * axis.active * size_of::<f64>();
        (BYTES_AT_ONCE / per_function.max(1)).max(ROWS_AT_LEAST)
    }

    /// Copies the sums of component `c` of the test function, as far as the rows of `functions` need them.
    pub fn fill(&mut self, sums: &Sums<'_>, axis: &Axis, c: usize, functions: Range<usize>) {
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
    pub fn row<T: Real>(&self, sums: &Sums<'_>, axis: &Axis, i: usize, c: usize, out: &mut [T]) {
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
