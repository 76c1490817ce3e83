//! Entries (row, column, value) in the order they were met: coupling rows, never bulk matrices.

use super::{Csr, Real};

/// A sparse matrix under construction; equal places are summed by [`Triplets::to_csr`] in the order of `push`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Triplets<T: Real = f64> {
    /// Number of rows.
    pub rows: usize,
    /// Number of columns.
    pub cols: usize,
    /// Entries (row, column, value), repetitions allowed.
    pub entries: Vec<(usize, usize, T)>,
}

impl<T: Real> Triplets<T> {
    /// No entries, of the given shape.
    pub fn new(rows: usize, cols: usize) -> Self {
        Self { rows, cols, entries: Vec::new() }
    }

    /// Adds `value` at (`row`, `col`).
    #[inline]
    pub fn push(&mut self, row: usize, col: usize, value: T) {
        debug_assert!(row < self.rows && col < self.cols);
        self.entries.push((row, col, value));
    }

    /// Appends the entries of `other` `row_offset` rows further down; `rows` grows where needed.
    pub fn append_below(&mut self, other: &Self, row_offset: usize) {
        self.rows = self.rows.max(row_offset + other.rows);
        self.cols = self.cols.max(other.cols);
        self.entries.extend(other.entries.iter().map(|&(i, j, v)| (i + row_offset, j, v)));
    }

    /// Rows with ascending columns; repeated places summed in the order they were pushed.
    pub fn to_csr(&self) -> Csr<T> {
        let mut count = vec![0usize; self.rows + 1];
        for &(i, _, _) in &self.entries {
            count[i + 1] += 1;
        }
        for i in 0..self.rows {
            count[i + 1] += count[i];
        }
        let mut place = count.clone();
        let mut sorted: Vec<(u32, T)> = vec![(0, T::zero()); self.entries.len()];
        for &(i, j, v) in &self.entries {
            sorted[place[i]] = (u32::try_from(j).expect("fewer than 2^32 columns"), v);
            place[i] += 1;
        }
        let (mut ptr, mut cols, mut vals) = (vec![0usize], Vec::new(), Vec::new());
        for i in 0..self.rows {
            let row = &mut sorted[count[i]..count[i + 1]];
            row.sort_by_key(|e| e.0); // stable: equal places keep their order of push
            let first = cols.len();
            for &(j, v) in row.iter() {
                if cols.len() > first && cols.last() == Some(&j) {
                    *vals.last_mut().expect("a value per column") += v;
                } else {
                    cols.push(j);
                    vals.push(v);
                }
            }
            ptr.push(cols.len());
        }
        Csr::from_parts(self.cols, ptr, cols, vals)
    }
}
