//! Compressed sparse rows with 4-byte columns: pattern first, values refilled in place.

use super::{Operator, Real, lit};

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

    /// Whether |a_ij - a_ji| <= `tolerance` (m_i m_j)^1/2 everywhere, m_i the largest |entry| of row i; linear in the number of entries.
    pub fn is_symmetric(&self, tolerance: f64) -> bool {
        let n = self.num_rows();
        if n != self.num_cols {
            return false;
        }
        let largest = |i: usize| self.row(i).1.iter().fold(T::zero(), |m, v| m.max(v.abs()));
        let limit: Vec<T> = (0..n).map(|i| (largest(i) * lit(tolerance)).sqrt()).collect();
        // rows ascend: the next entry of row j left of its diagonal is the one that row i asks for, or has no partner
        let mut next: Vec<usize> = self.ptr[..n].to_vec();
        let same = |i: usize, j: usize, a: T, b: T| (a - b).abs() <= limit[i] * limit[j];
        for i in 0..n {
            for k in self.ptr[i]..self.ptr[i + 1] {
                let j = self.cols[k] as usize;
                if j <= i {
                    continue;
                }
                while next[j] < self.ptr[j + 1] && (self.cols[next[j]] as usize) < i {
                    if !same(j, self.cols[next[j]] as usize, self.vals[next[j]], T::zero()) {
                        return false;
                    }
                    next[j] += 1;
                }
                let partner = next[j] < self.ptr[j + 1] && self.cols[next[j]] as usize == i;
                let other = if partner { self.vals[next[j]] } else { T::zero() };
                if !same(i, j, self.vals[k], other) {
                    return false;
                }
                next[j] += usize::from(partner);
            }
        }
        // what is left of the diagonal and was never asked for
        (0..n).all(|j| {
            (next[j]..self.ptr[j + 1])
                .take_while(|&k| (self.cols[k] as usize) < j)
                .all(|k| same(j, self.cols[k] as usize, self.vals[k], T::zero()))
        })
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::Triplets;

    fn matrix(entries: &[(usize, usize, f64)]) -> Csr {
        Triplets { rows: 4, cols: 4, entries: entries.to_vec() }.to_csr()
    }

    #[test]
    fn symmetry_is_seen_with_and_without_partners() {
        let even = [(0, 0, 2.0), (0, 3, 1.0), (3, 0, 1.0), (1, 2, -1.0), (2, 1, -1.0), (3, 3, 4.0), (2, 2, 1.0), (1, 1, 1.0)];
        assert!(matrix(&even).is_symmetric(0.0));
        for odd in [(0, 1, 1e-3), (1, 0, 1e-3), (3, 2, 1e-3), (2, 3, 1e-3), (3, 0, 1e-3), (1, 2, 1e-3)] {
            let more: Vec<_> = even.iter().copied().chain([odd]).collect();
            assert!(!matrix(&more).is_symmetric(1e-6), "{odd:?}");
            assert!(matrix(&more).is_symmetric(1e-2), "{odd:?}");
        }
    }
}
