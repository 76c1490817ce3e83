//! Compressed sparse rows, in blocks if the field has components; the pattern is fixed, values are refilled in place.

use super::{Buffer, Columns, Operator, Real, Sparsity};
use std::ops::Range;
use std::sync::Arc;

/// A sparse matrix by rows; columns ascend within a row.
///
/// Values lie row by row, whatever the block of the pattern. Copies share the pattern.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Csr<T: Real = f64> {
    pattern: Arc<Sparsity>,
    vals: Buffer<T>,
    places: Vec<[f64; 3]>,
}

impl<T: Real> Csr<T> {
    /// Builds a matrix of its parts: `ptr` has one entry more than rows, columns ascend within each row.
    ///
    /// # Panics
    /// If the lengths do not fit or if there are 2^32 columns or more.
    pub fn from_parts(num_cols: usize, ptr: Vec<usize>, cols: Vec<u32>, vals: Vec<T>) -> Self {
        Self::with_values(Arc::new(Sparsity::new(1, num_cols, ptr, cols)), vals)
    }

    /// A matrix with entries at `pattern`: one value per entry, row by row.
    ///
    /// # Panics
    /// If the lengths do not fit.
    pub fn with_values(pattern: Arc<Sparsity>, vals: Vec<T>) -> Self {
        Self::of(pattern, vals.into())
    }

    pub(crate) fn of(pattern: Arc<Sparsity>, vals: Buffer<T>) -> Self {
        assert_eq!(pattern.num_entries(), vals.len(), "one value per entry");
        Self { pattern, vals, places: Vec::new() }
    }

    /// A matrix with entries at `pattern`, all zero.
    pub fn zeros(pattern: Arc<Sparsity>) -> Self {
        let vals = Buffer::zeros(pattern.num_entries());
        Self::of(pattern, vals)
    }

    /// Sets the coordinates of the unknowns (one point per row), see [`Operator::dof_coordinates`].
    #[must_use]
    pub fn with_dof_coordinates(mut self, places: Vec<[f64; 3]>) -> Self {
        self.places = places;
        self
    }

    /// Number of rows.
    pub fn num_rows(&self) -> usize {
        self.pattern.num_rows()
    }

    /// Number of columns.
    pub fn num_cols(&self) -> usize {
        self.pattern.num_cols()
    }

    /// Number of stored entries.
    pub fn num_entries(&self) -> usize {
        self.vals.len()
    }

    /// Sparsity pattern.
    pub fn pattern(&self) -> &Arc<Sparsity> {
        &self.pattern
    }

    /// Bytes of values, pattern and coordinates.
    pub fn bytes(&self) -> usize {
        size_of_val(&*self.vals) + self.pattern.bytes() + size_of_val(&*self.places)
    }

    /// Value of every entry.
    pub fn vals(&self) -> &[T] {
        &self.vals
    }

    /// Values to refill in place; the pattern stays.
    pub fn vals_mut(&mut self) -> &mut [T] {
        &mut self.vals
    }

    /// Range of the values of row `i`.
    pub fn entries(&self, i: usize) -> Range<usize> {
        self.pattern.entries(i)
    }

    /// Columns and values of row `i`.
    #[inline]
    pub fn row(&self, i: usize) -> (Columns<'_>, &[T]) {
        (self.pattern.row(i), &self.vals[self.pattern.entries(i)])
    }

    /// Columns of row `i`, and its values to change.
    #[inline]
    pub fn row_mut(&mut self, i: usize) -> (Columns<'_>, &mut [T]) {
        (self.pattern.row(i), &mut self.vals[self.pattern.entries(i)])
    }

    /// Entry (i, j), zero if not stored.
    pub fn get(&self, i: usize, j: usize) -> T {
        let (cols, vals) = self.row(i);
        cols.position_of(j).map_or_else(T::zero, |k| vals[k])
    }

    /// y = A x for any shape.
    pub fn mul(&self, x: &[T], y: &mut [T]) {
        match self.pattern.block() {
            1 => self.mul_blocks::<1>(x, y),
            2 => self.mul_blocks::<2>(x, y),
            3 => self.mul_blocks::<3>(x, y),
            _ => {
                for (i, yi) in y.iter_mut().enumerate() {
                    let (cols, vals) = self.row(i);
                    *yi = cols.zip(vals).fold(T::zero(), |s, (j, &v)| s + v * x[j]);
                }
            }
        }
    }

    /// y = A x for blocks of B rows: a part of x is read once per block, every row is summed from its first column to its last.
    fn mul_blocks<const B: usize>(&self, x: &[T], y: &mut [T]) {
        let mut rest = &*self.vals;
        for (i, y) in y.chunks_exact_mut(B).enumerate() {
            let blocks = self.pattern.group(i);
            let (own, others) = rest.split_at(B * B * blocks.len());
            rest = others;
            let rows: [&[T]; B] = std::array::from_fn(|k| &own[k * B * blocks.len()..(k + 1) * B * blocks.len()]);
            let mut sum = [T::zero(); B];
            for (b, &j) in blocks.iter().enumerate() {
                let x = &x[B * j as usize..][..B];
                for k in 0..B {
                    let row = &rows[k][B * b..][..B];
                    for l in 0..B {
                        sum[k] += row[l] * x[l];
                    }
                }
            }
            y.copy_from_slice(&sum);
        }
    }

    /// y += Aᵀ x for any shape.
    pub fn add_transposed_mul(&self, x: &[T], y: &mut [T]) {
        for (i, &xi) in x.iter().enumerate() {
            let (cols, vals) = self.row(i);
            for (j, &v) in cols.zip(vals) {
                y[j] += v * xi;
            }
        }
    }

    /// Whether no value is infinite or not a number.
    pub(crate) fn is_finite(&self) -> bool {
        all_finite(&self.vals)
    }

    /// Aᵀ, rows sorted, in blocks of the same size; linear in the number of entries.
    pub fn transposed(&self) -> Self {
        let (own, c, ptr) = (&*self.pattern, self.pattern.block(), self.pattern.ptr());
        let (pattern, target) = own.transposed();
        let mut result = Self::zeros(Arc::new(pattern));
        let (from, to, other) = (self.vals(), &mut *result.vals, &*result.pattern);
        for i in 0..ptr.len() - 1 {
            for (at, &j) in own.group(i).iter().enumerate() {
                let j = j as usize;
                let opposite = target[ptr[i] + at] - other.ptr()[j];
                for k in 0..c {
                    for l in 0..c {
                        to[other.place(j, opposite, l, k)] = from[own.place(i, at, k, l)];
                    }
                }
            }
        }
        result
    }
}

impl<T: Real> Operator<T> for Csr<T> {
    fn size(&self) -> usize {
        self.num_rows()
    }
    fn apply(&self, x: &[T], y: &mut [T]) {
        self.mul(x, y);
    }
    fn diagonal(&self) -> Vec<T> {
        (0..self.num_rows()).map(|i| self.get(i, i)).collect()
    }
    fn csr(&self) -> Option<&Csr<T>> {
        Some(self)
    }
    fn dof_coordinates(&self) -> &[[f64; 3]] {
        &self.places
    }
}

/// Largest magnitude of the values, by four partial maxima.
pub(crate) fn largest<T: Real>(vals: &[T]) -> T {
    let (parts, rest) = vals.as_chunks::<4>();
    let mut most = [T::zero(); 4];
    for part in parts {
        for k in 0..4 {
            let size = part[k].abs();
            most[k] = if size > most[k] { size } else { most[k] };
        }
    }
    rest.iter().map(|v| v.abs()).chain(most).fold(T::zero(), |m, v| if v > m { v } else { m })
}

/// Whether no value is infinite or not a number.
pub(crate) fn all_finite<T: Real>(vals: &[T]) -> bool {
    vals.chunks(256).all(|part| part.iter().fold(true, |good, v| good & v.is_finite()))
}
