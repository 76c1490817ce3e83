//! Rows of the matrix from complete sums: every value is written once, front to back.
//!
//! Sums hold pairs j >= i of the fastest direction; the others are the mirror image, pair (j, i) of all directions. On
//! the diagonal of the fastest direction the pair that comes first in the other directions speaks for both, so that the
//! matrix is symmetric to the last bit.

use super::axis::Axis;
use super::coefficient::Pair;
use super::slow::Ring;
use crate::linalg::{Real, lit};

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
    #[inline(always)]
    pub fn write<T: Real>(&self, to: Directions<'_>, middle: usize, slow: usize, add: bool, scratch: &mut RowScratch<T>, out: &mut [T]) {
        let (fast, lanes) = (to.fast, self.lanes);
        let vector = self.pairs.len() * self.pair * lanes;
        let length = |columns: (usize, usize)| columns.1 - columns.0;
        let runs = self.components * length(to.middle.columns[middle]) * length(to.slow.columns[slow]);
        let RowScratch { places, row: buffer } = scratch;
        let mut rest = out;
        for i in 0..fast.functions {
            let (from, end) = fast.columns[i];
            places.clear();
            places.extend((from..end).map(|j| {
                let r = i.min(j) * fast.active + i.max(j) - i.min(j);
                (r / lanes) * vector + r % lanes
            }));
            let row = Row { i, middle, slow, lower: i - from };
            for c in 0..self.components {
                let (own, others) = std::mem::take(&mut rest).split_at_mut(runs * (end - from));
                rest = others;
                if add {
                    buffer.clear();
                    buffer.resize(own.len(), T::zero());
                    self.row(to, row, c, places, buffer);
                    own.iter_mut().zip(buffer.iter()).for_each(|(to, &value)| *to += value);
                } else {
                    self.row(to, row, c, places, own);
                }
            }
        }
    }

    #[inline(always)]
    fn row<T: Real>(&self, to: Directions<'_>, row: Row, c: usize, places: &[usize], out: &mut [T]) {
        let Row { i, middle, slow, lower } = row;
        let mut runs = out.chunks_exact_mut((places.len() * self.components).max(1));
        let own = to.ring(self.slots, middle);
        for js in to.slow.columns[slow].0..to.slow.columns[slow].1 {
            for jm in to.middle.columns[middle].0..to.middle.columns[middle].1 {
                let w = to.middle.active - 1;
                let upper = own.at(to.slow.active, slow, js) + jm + w - middle;
                let mirror = to.ring(self.slots, jm).at(to.slow.active, js, slow) + middle + w - jm;
                let run = runs.next().expect("one run per pair of the other directions");
                if self.components == 1 {
                    let (upper, mirror) = (upper * self.lanes, (self.pairs[0].mirror * self.pair + mirror) * self.lanes);
                    let diagonal = if self.symmetric && (js, jm) < (slow, middle) { mirror } else { upper };
                    let (left, right) = run.split_at_mut(lower);
                    put(left, &places[..lower], &self.values[mirror..]);
                    put(&mut right[..1], &places[lower..=lower], &self.values[diagonal..]);
                    put(&mut right[1..], &places[lower + 1..], &self.values[upper..]);
                } else {
                    self.blocks(c, [upper, mirror], lower, (js, jm).cmp(&(slow, middle)), places, run);
                }
                if let Some(weights) = self.weights {
                    self.scale(to, i, [middle, slow], [jm, js], weights, run);
                }
            }
        }
    }

    /// A run of a vector field, component fastest.
    #[inline(always)]
    fn blocks<T: Real>(
        &self,
        c: usize,
        [upper, mirror]: [usize; 2],
        lower: usize,
        order: std::cmp::Ordering,
        places: &[usize],
        run: &mut [T],
    ) {
        let n = self.components;
        for e in 0..n {
            let direct = (((c * n + e) * self.pair) + upper) * self.lanes;
            let turned = ((self.pairs[c * n + e].mirror * self.pair) + mirror) * self.lanes;
            let first = match order {
                _ if !self.symmetric => true,
                std::cmp::Ordering::Less => false,
                std::cmp::Ordering::Equal => c <= e,
                std::cmp::Ordering::Greater => true,
            };
            for (k, &place) in places.iter().enumerate() {
                let from = if k > lower || (k == lower && first) { direct } else { turned };
                run[k * n + e] = lit(self.values[from + place]);
            }
        }
    }

    /// Times w_i w_j.
    fn scale<T: Real>(&self, to: Directions<'_>, i: usize, at: [usize; 2], other: [usize; 2], weights: &[f64], run: &mut [T]) {
        let number = |i: usize, [middle, slow]: [usize; 2]| i + to.fast.functions * (middle + to.middle.functions * slow);
        let own = weights[number(i, at)];
        for (values, j) in run.chunks_exact_mut(self.components).zip(to.fast.columns[i].0..) {
            let factor = lit::<T>(own * weights[number(j, other)]);
            values.iter_mut().for_each(|v| *v *= factor);
        }
    }
}

/// Memory of [`Sums::write`].
#[derive(Clone, Debug)]
pub(super) struct RowScratch<T> {
    places: Vec<usize>,
    row: Vec<T>,
}

impl<T> Default for RowScratch<T> {
    fn default() -> Self {
        Self { places: Vec::new(), row: Vec::new() }
    }
}

/// A row and how many of its entries in a run lie left of the diagonal of the fastest direction.
#[derive(Clone, Copy, Debug)]
struct Row {
    i: usize,
    middle: usize,
    slow: usize,
    lower: usize,
}

#[inline(always)]
fn put<T: Real>(out: &mut [T], places: &[usize], sums: &[f64]) {
    for (to, &place) in out.iter_mut().zip(places) {
        *to = lit(sums[place]);
    }
}
