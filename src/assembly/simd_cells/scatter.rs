//! Adds the matrices of cells to the rows of a range, in the order of the batches.

use super::batch::Matrices;
use super::slots::{BATCH, Batch, Slot, Slots};
use crate::linalg::{Real, lit};
use std::ops::Range;

/// Row start of functions of other owners: beyond all values.
const ELSEWHERE: usize = usize::MAX / 2;

/// The rows of a range of functions: every owner adds the cells in the same order, so that sums have the same bits for any number of
/// owners and of lanes.
///
/// Of every batch the entries (a, b) and (b, a) of all its cells are added at once, and a sum has the terms of (i, j) and (j, i) in one
/// order: symmetric matrices stay so to the last bit.
pub(super) struct Rows<'a, P, T> {
    /// Row pointers of the scalar matrix.
    pub ptr: &'a [usize],
    pub slots: &'a Slots,
    pub places: &'a [P],
    pub functions: Range<usize>,
    /// Whether only the upper half of the matrices of cells is there.
    pub upper: bool,
    /// The values of the rows.
    pub values: &'a mut [T],
    /// Number of initialised values; the values after them are set to zero before they are added to.
    pub ready: usize,
    /// Start of the rows and length of one row, per local function and cell of a batch.
    pub starts: Vec<([usize; BATCH], [usize; BATCH])>,
}

impl<P: Slot, T: Real> Rows<'_, P, T> {
    /// Adds the matrices of the cells of `batch` that `lanes` has a bit for, fields of C components.
    pub fn add<const C: usize>(&mut self, batch: &Batch, lanes: u8, matrices: Matrices<'_>) {
        self.begin::<C>(batch, lanes);
        // the number of lanes is a constant, so that picking one costs nothing
        match matrices.lanes {
            2 => self.add_lanes::<C, 2>(batch, matrices),
            4 => self.add_lanes::<C, 4>(batch, matrices),
            8 => self.add_lanes::<C, 8>(batch, matrices),
            _ => unreachable!("there are registers of 2, 4 and 8 numbers"),
        }
    }

    /// Sets values to zero up to those of function `end`: shortly before they are added to, while they are in the cache.
    pub fn make_ready<const C: usize>(&mut self, end: usize) {
        let ptr = self.ptr;
        let end = C * C * (ptr[end.clamp(self.functions.start, self.functions.end)] - ptr[self.functions.start]);
        if self.ready < end {
            self.values[self.ready..end].fill(T::zero());
            self.ready = end;
        }
    }

    fn begin<const C: usize>(&mut self, batch: &Batch, lanes: u8) {
        self.make_ready::<C>(batch.end as usize);
        let ptr = self.ptr;
        let base = C * C * ptr[self.functions.start];
        self.starts.clear();
        self.starts.resize(batch.functions, ([ELSEWHERE; BATCH], [0; BATCH]));
        for (lane, ids) in self.slots.ids(batch).enumerate() {
            if lanes >> lane & 1 == 0 {
                continue;
            }
            for (&i, (starts, lengths)) in ids.iter().zip(&mut self.starts) {
                let i = i as usize;
                if self.functions.contains(&i) {
                    starts[lane] = C * C * ptr[i] - base;
                    lengths[lane] = C * (ptr[i + 1] - ptr[i]);
                }
            }
        }
    }

    fn add_lanes<const C: usize, const L: usize>(&mut self, batch: &Batch, matrices: Matrices<'_>) {
        let (n, across, upper) = (batch.functions, matrices.padded, self.upper);
        let (values, starts) = (&mut *self.values, &self.starts[..n]);
        let numbers = matrices.values.as_chunks::<L>().0;
        // entries of a part
        let part = numbers.len() * L / BATCH;
        let mut octets = self.places[batch.first..][..n * n * BATCH].as_chunks::<BATCH>().0.iter();
        let mut next = || octets.next().expect("one octet per entry");
        for a in 0..n {
            let diagonal = next();
            let block = &numbers[(a * across + a) * C * C..];
            // one half of the block on the diagonal, for the other is equal up to rounding
            let pick = |c: usize, e: usize| if upper { c.min(e) * C + c.max(e) } else { c * C + e };
            for lane in 0..BATCH {
                let (at, length) = (starts[a].0[lane], starts[a].1[lane]);
                let number = |c: usize, e: usize| block[lane / L * part + pick(c, e)][lane % L];
                add_block::<C, T>(values, at, length, diagonal[lane].get(), number);
            }
            for b in a + 1..n {
                let (right, left) = (next(), next());
                let block = &numbers[(a * across + b) * C * C..];
                let mirror = if upper { block } else { &numbers[(b * across + a) * C * C..] };
                // blocks below the diagonal are the transposes of those above it
                let turned = |c: usize, e: usize| if upper { e * C + c } else { c * C + e };
                let (row, other) = (&starts[a], &starts[b]);
                for lane in 0..BATCH {
                    let from = lane / L * part;
                    let number = |c: usize, e: usize| block[from + c * C + e][lane % L];
                    add_block::<C, T>(values, row.0[lane], row.1[lane], right[lane].get(), number);
                    let number = |c: usize, e: usize| mirror[from + turned(c, e)][lane % L];
                    add_block::<C, T>(values, other.0[lane], other.1[lane], left[lane].get(), number);
                }
            }
        }
    }
}

/// Adds the block of one pair of functions to the C rows of a function, which begin at `start` with `length` entries each; does nothing if
/// the rows belong to another owner.
#[inline(always)]
fn add_block<const C: usize, T: Real>(values: &mut [T], start: usize, length: usize, place: usize, number: impl Fn(usize, usize) -> f64) {
    if C == 1 {
        if let Some(to) = values.get_mut(start + place) {
            *to += lit(number(0, 0));
        }
        return;
    }
    for c in 0..C {
        let at = start + c * length + C * place;
        let Some(to) = values.get_mut(at..at + C) else { return };
        for (e, to) in to.iter_mut().enumerate() {
            *to += lit(number(c, e));
        }
    }
}
