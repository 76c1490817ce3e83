//! Compressed sparse rows with 4-byte columns: pattern first, values refilled in place.

use super::{Operator, Real};

/// A sparse matrix by rows; columns ascend within a row.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Csr<T: Real = f64> {
    num_cols: usize,
    ptr: Vec<usize>,
    cols: Vec<u32>,
    vals: Vec<T>,
    places: Vec<[f64; 3]>,
}

impl<T: Real> Csr<T> {
    /// A matrix of its parts: `ptr` has one entry more than rows, columns ascend within each row.
    ///
    /// # Panics
    /// If the lengths do not fit.
    pub fn from_parts(num_cols: usize, ptr: Vec<usize>, cols: Vec<u32>, vals: Vec<T>) -> Self {
        assert_eq!(ptr.last().copied(), Some(cols.len()), "the last row pointer is the number of entries");
        assert_eq!(cols.len(), vals.len(), "one value per column index");
        Self { num_cols, ptr, cols, vals, places: Vec::new() }
    }

    /// The same pattern with all values zero, made of row pointers and columns alone.
    pub fn from_pattern(num_cols: usize, ptr: Vec<usize>, cols: Vec<u32>) -> Self {
        let n = cols.len();
        Self::from_parts(num_cols, ptr, cols, vec![T::zero(); n])
    }

    /// Says where the unknowns live (one point per row), see [`Operator::places`].
    pub fn with_places(mut self, places: Vec<[f64; 3]>) -> Self {
        self.places = places;
        self
    }

    /// Number of rows.
    pub fn num_rows(&self) -> usize {
        self.ptr.len() - 1
    }

    /// Number of columns.
    pub fn num_cols(&self) -> usize {
        self.num_cols
    }

    /// Number of stored entries.
    pub fn num_entries(&self) -> usize {
        self.cols.len()
    }

    /// Row pointers: row i owns the entries `ptr[i]..ptr[i + 1]`.
    pub fn ptr(&self) -> &[usize] {
        &self.ptr
    }

    /// Column of every entry.
    pub fn cols(&self) -> &[u32] {
        &self.cols
    }

    /// Value of every entry.
    pub fn vals(&self) -> &[T] {
        &self.vals
    }

    /// Values to refill in place; the pattern stays.
    pub fn vals_mut(&mut self) -> &mut [T] {
        &mut self.vals
    }

    /// Pattern and values at once: (row pointers, columns, values to refill).
    pub fn parts_mut(&mut self) -> (&[usize], &[u32], &mut [T]) {
        (&self.ptr, &self.cols, &mut self.vals)
    }

    /// Columns and values of row `i`.
    pub fn row(&self, i: usize) -> (&[u32], &[T]) {
        let range = self.ptr[i]..self.ptr[i + 1];
        (&self.cols[range.clone()], &self.vals[range])
    }

    /// Entry (i, j), zero where nothing is stored.
    pub fn get(&self, i: usize, j: usize) -> T {
        let (cols, vals) = self.row(i);
        u32::try_from(j).ok().and_then(|j| cols.binary_search(&j).ok()).map_or_else(T::zero, |k| vals[k])
    }

    /// y = A x for any shape.
    pub fn mul(&self, x: &[T], y: &mut [T]) {
        for (i, yi) in y.iter_mut().enumerate() {
            let (cols, vals) = self.row(i);
            *yi = cols.iter().zip(vals).fold(T::zero(), |s, (&j, &v)| s + v * x[j as usize]);
        }
    }

    /// y += Aᵀ x for any shape.
    pub fn add_transposed_mul(&self, x: &[T], y: &mut [T]) {
        for (i, &xi) in x.iter().enumerate() {
            let (cols, vals) = self.row(i);
            for (&j, &v) in cols.iter().zip(vals) {
                y[j as usize] += v * xi;
            }
        }
    }

    /// Aᵀ, rows sorted; linear in the number of entries.
    pub fn transposed(&self) -> Self {
        let mut ptr = vec![0usize; self.num_cols + 1];
        for &j in &self.cols {
            ptr[j as usize + 1] += 1;
        }
        for j in 0..self.num_cols {
            ptr[j + 1] += ptr[j];
        }
        let (mut place, mut cols, mut vals) = (ptr.clone(), vec![0u32; self.cols.len()], vec![T::zero(); self.cols.len()]);
        for i in 0..self.num_rows() {
            let (row_cols, row_vals) = self.row(i);
            for (&j, &v) in row_cols.iter().zip(row_vals) {
                let k = place[j as usize];
                cols[k] = u32::try_from(i).expect("fewer than 2^32 rows");
                vals[k] = v;
                place[j as usize] += 1;
            }
        }
        Self::from_parts(self.num_rows(), ptr, cols, vals)
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
    fn places(&self) -> &[[f64; 3]] {
        &self.places
    }
}
