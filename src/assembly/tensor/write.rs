//! Rows of the matrix from complete sums: every value is written once, front to back.
//!
//! Sums hold pairs j >= i of the fastest direction; the others are the mirror image, pair (j, i) of all directions. On
//! the diagonal of the fastest direction the pair that comes first in the other directions speaks for both, so that the
//! matrix is symmetric to the last bit.

use super::axis::Axis;
use super::coefficient::Pair;
use super::slow::Ring;
use crate::linalg::{Real, lit};
use std::cmp::Ordering;

/// Where sums lie.
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
    /// Components of the field.
    pub components: usize,
    /// Pairs of components.
    pub pairs: &'a [Pair],
    /// Whether the form is symmetric.
    pub symmetric: bool,
    /// One weight per function of a rational basis.
    pub weights: Option<&'a [f64]>,
}

/// The directions, fastest first; in the plane the middle one is [`Axis::none`].
#[derive(Clone, Copy, Debug)]
pub(super) struct Directions<'a> {
    /// Fastest.
    pub fast: &'a Axis,
    /// Middle.
    pub middle: &'a Axis,
    /// Slowest.
    pub slow: &'a Axis,
}

impl Directions<'_> {
    /// Place of the ring of function `middle`.
    pub fn ring(&self, slots: usize, middle: usize) -> Ring {
        let width = 2 * self.middle.active - 1;
        let size = slots * (2 * self.slow.active - 1) * width;
        Ring { slots, pair: width, start: middle * size }
    }

    /// Vectors of sums per pair of components and vector of pairs of the fastest direction.
    pub fn sums(&self, slots: usize) -> usize {
        self.middle.functions * slots * (2 * self.slow.active - 1) * (2 * self.middle.active - 1)
    }

    /// Entries of the scalar matrix before function (0, middle, slow).
    pub fn entries(&self, middle: usize, slow: usize) -> usize {
        let (fast, mid) = (self.fast.sums[self.fast.functions], self.middle.sums[self.middle.functions]);
        let (from, to) = self.slow.columns.get(slow).copied().unwrap_or((0, 0));
        (self.slow.sums[slow] * mid + (to - from) * self.middle.sums[middle]) * fast
    }
}

impl Sums<'_> {
    /// The rows of functions (.., `middle`, `slow`) to `out`; `add`: on top of what is there.
    pub fn write<T: Real>(&self, to: Directions<'_>, middle: usize, slow: usize, add: bool, scratch: &mut RowScratch<T>, out: &mut [T]) {
        let (fast, lanes) = (to.fast, self.lanes);
        let vector = self.pairs.len() * self.pair * lanes;
        let RowScratch { places, runs, row: buffer } = scratch;
        self.runs(to, middle, slow, runs);
        let mut rest = out;
        for i in 0..fast.functions {
            let (from, end) = fast.columns[i];
            places.clear();
            places.extend((from..end).map(|j| {
                let r = i.min(j) * fast.active + i.max(j) - i.min(j);
                (r / lanes) * vector + r % lanes
            }));
            let row = Row { i, number: i + fast.functions * (middle + to.middle.functions * slow), from, places };
            for c in 0..self.components {
                let (own, others) = std::mem::take(&mut rest).split_at_mut(self.components * runs.len() * (end - from));
                rest = others;
                if add {
                    buffer.clear();
                    buffer.resize(own.len(), T::zero());
                    self.row(row, c, runs, buffer);
                    own.iter_mut().zip(buffer.iter()).for_each(|(to, &value)| *to += value);
                } else {
                    self.row(row, c, runs, own);
                }
            }
        }
    }

    /// Where the runs of the rows of (.., `middle`, `slow`) come from.
    fn runs(&self, to: Directions<'_>, middle: usize, slow: usize, runs: &mut Vec<Run>) {
        let (w, own) = (to.middle.active - 1, to.ring(self.slots, middle));
        runs.clear();
        for js in to.slow.columns[slow].0..to.slow.columns[slow].1 {
            for jm in to.middle.columns[middle].0..to.middle.columns[middle].1 {
                runs.push(Run {
                    upper: own.at(to.slow.active, slow, js) + jm + w - middle,
                    mirror: to.ring(self.slots, jm).at(to.slow.active, js, slow) + middle + w - jm,
                    order: (js, jm).cmp(&(slow, middle)),
                    first: to.fast.functions * (jm + to.middle.functions * js),
                });
            }
        }
    }

    /// Component `c` of a row.
    #[inline(always)]
    fn row<T: Real>(&self, row: Row<'_>, c: usize, runs: &[Run], out: &mut [T]) {
        let n = self.components;
        let lower = row.i - row.from;
        for (run, out) in runs.iter().zip(out.chunks_exact_mut((row.places.len() * n).max(1))) {
            for e in 0..n {
                let mirror = &self.values[(self.pairs[c * n + e].mirror * self.pair + run.mirror) * self.lanes..];
                let upper = &self.values[((c * n + e) * self.pair + run.upper) * self.lanes..];
                let turned = self.symmetric && (run.order == Ordering::Less || (run.order == Ordering::Equal && c > e));
                let (left, right) = row.places.split_at(lower + usize::from(turned));
                if n == 1 {
                    let (first, second) = out.split_at_mut(left.len());
                    put(first.iter_mut(), left, mirror);
                    put(second.iter_mut(), right, upper);
                } else {
                    let mut entries = out[e..].iter_mut().step_by(n);
                    put(entries.by_ref().take(left.len()), left, mirror);
                    put(entries, right, upper);
                }
            }
            if let Some(weights) = self.weights {
                // R_i = w_i N_i / W
                for (k, values) in out.chunks_exact_mut(n).enumerate() {
                    let factor = lit::<T>(weights[row.number] * weights[run.first + row.from + k]);
                    values.iter_mut().for_each(|v| *v *= factor);
                }
            }
        }
    }
}

/// Memory of [`Sums::write`].
#[derive(Clone, Debug)]
pub(super) struct RowScratch<T> {
    places: Vec<usize>,
    runs: Vec<Run>,
    row: Vec<T>,
}

impl<T> Default for RowScratch<T> {
    fn default() -> Self {
        Self { places: Vec::new(), runs: Vec::new(), row: Vec::new() }
    }
}

/// The functions of the fastest direction beside one pair of functions of the others.
#[derive(Clone, Copy, Debug)]
struct Run {
    /// Place of the sums of pairs j >= i.
    upper: usize,
    /// Place of the sums of pairs (j, i) of all directions.
    mirror: usize,
    /// How the other function compares with the row's.
    order: Ordering,
    /// Number of the first function that has this pair.
    first: usize,
}

/// A row: its function of the fastest direction, its number, its first column there, the places of its pairs.
#[derive(Clone, Copy, Debug)]
struct Row<'a> {
    i: usize,
    number: usize,
    from: usize,
    places: &'a [usize],
}

#[inline(always)]
fn put<'a, T: Real>(out: impl Iterator<Item = &'a mut T>, places: &[usize], sums: &[f64]) {
    for (to, &place) in out.zip(places) {
        *to = lit(sums[place]);
    }
}
