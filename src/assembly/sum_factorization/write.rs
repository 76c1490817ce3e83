//! Rows of the matrix from complete sums: every value is written once, front to back.
//!
//! Sums hold pairs j >= i of the fastest direction; the others are the mirror image, pair (j, i) of all directions. On
//! the diagonal of the fastest direction the pair that comes first in the other directions is used for both, so that the
//! matrix is symmetric to the last bit. What belongs to one pair of the other directions lies scattered over the sums:
//! it is copied to one line first, from which all rows take their entries.

use super::axis::Axis;
use super::coefficient::ComponentPair;
use super::row::Lines;
use super::slow::Ring;
use super::strip::Strip;
use crate::linalg::Real;

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
    pub lines: Lines,
    pub row: Vec<T>,
}

impl<T> Default for RowScratch<T> {
    fn default() -> Self {
        Self { lines: Lines::default(), row: Vec::new() }
    }
}
