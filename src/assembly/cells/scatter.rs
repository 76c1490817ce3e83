//! Adds the matrices of cells to the rows of a range, in the order of the cells.

use super::batch::Matrices;
use super::slots::Place;
use crate::assembly::pattern::Pattern;
use crate::linalg::{Real, lit};
use std::ops::Range;

/// The rows of some functions: whoever owns them adds every cell in the same order, so that sums have the same bits for any number of
/// owners.
pub(super) struct Rows<'a, P, T> {
    pub pattern: &'a Pattern,
    /// Where the entries of an element begin in `places`.
    pub first: &'a [usize],
    pub places: &'a [P],
    pub functions: Range<usize>,
    /// Whether only the upper half of the matrices of cells is there.
    pub upper: bool,
    /// The values of the rows.
    pub values: &'a mut [T],
}

impl<P: Place, T: Real> Rows<'_, P, T> {
    /// Adds the matrices of `batch`, fields of C components.
    pub fn add<const C: usize>(&mut self, batch: &[u32], matrices: Matrices<'_>) {
        // the number of lanes is a constant, so that picking one costs nothing
        match matrices.lanes {
            2 => self.add_lanes::<C, 2>(batch, matrices),
            4 => self.add_lanes::<C, 4>(batch, matrices),
            8 => self.add_lanes::<C, 8>(batch, matrices),
            _ => unreachable!("there are registers of 2, 4 and 8 numbers"),
        }
    }

    fn add_lanes<const C: usize, const L: usize>(&mut self, batch: &[u32], matrices: Matrices<'_>) {
        let numbers = matrices.values.as_chunks::<L>().0;
        let ptr = self.pattern.ptr();
        let base = C * C * ptr[self.functions.start];
        // blocks of C x C numbers from one row of the matrix of a cell to the next
        let down = matrices.padded;
        for (lane, &e) in batch.iter().enumerate().take(L) {
            let ids = self.pattern.ids(e as usize);
            let n = ids.len();
            let places = &self.places[self.first[e as usize]..][..n * n];
            for (a, (&i, places)) in ids.iter().zip(places.chunks_exact(n)).enumerate() {
                let i = i as usize;
                if !self.functions.contains(&i) {
                    continue;
                }
                let length = C * (ptr[i + 1] - ptr[i]);
                let row = &mut self.values[C * C * ptr[i] - base..][..C * length];
                let (left, right) = places.split_at(if self.upper { a } else { 0 });
                let across = &numbers[(a * down + left.len()) * C * C..][..right.len() * C * C];
                // what is left of the diagonal is the mirror image of what is above it
                if C == 1 {
                    for (b, place) in left.iter().enumerate() {
                        row[place.get()] += lit(numbers[b * down + a][lane]);
                    }
                    for (place, number) in right.iter().zip(across) {
                        row[place.get()] += lit(number[lane]);
                    }
                    continue;
                }
                for (b, place) in left.iter().enumerate() {
                    let block = &numbers[(b * down + a) * C * C..][..C * C];
                    add_block::<C, T>(row, length, place.get(), |c, e| block[e * C + c][lane]);
                }
                for (b, (place, block)) in right.iter().zip(across.chunks_exact(C * C)).enumerate() {
                    if self.upper && b == 0 {
                        // one half of the block on the diagonal, for the other is equal up to rounding
                        add_block::<C, T>(row, length, place.get(), |c, e| block[c.min(e) * C + c.max(e)][lane]);
                    } else {
                        add_block::<C, T>(row, length, place.get(), |c, e| block[c * C + e][lane]);
                    }
                }
            }
        }
    }
}

/// Adds the block of one pair of functions to the C rows of a function, `length` entries each.
#[inline(always)]
fn add_block<const C: usize, T: Real>(rows: &mut [T], length: usize, place: usize, number: impl Fn(usize, usize) -> f64) {
    for c in 0..C {
        let to = &mut rows[c * length + C * place..][..C];
        for (e, to) in to.iter_mut().enumerate() {
            *to += lit(number(c, e));
        }
    }
}
