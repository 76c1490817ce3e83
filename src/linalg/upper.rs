//! The upper triangle of a symmetric matrix, as the factorisation takes it.

use super::Csr;
use std::sync::Arc;

/// Rows of the upper triangle, diagonal included and first in every row.
#[derive(Clone, Debug, Default)]
pub(crate) struct Upper {
    /// Row pointers and ascending columns; shared with the analysis.
    pub pattern: Arc<(Vec<usize>, Vec<usize>)>,
    /// Values.
    pub vals: Vec<f64>,
}

impl Upper {
    /// The upper triangle of `a`; a diagonal that is not stored becomes a stored zero.
    pub(crate) fn of(a: &Csr<f64>) -> Self {
        let n = a.num_rows();
        let (mut ptr, mut cols, mut vals) = (Vec::with_capacity(n + 1), Vec::new(), Vec::new());
        ptr.push(0);
        for i in 0..n {
            let (row, row_vals) = a.row(i);
            let first = row.below(i);
            if row.get(first) != Some(i) {
                cols.push(i);
                vals.push(0.0);
            }
            cols.extend(row.skip(first));
            vals.extend_from_slice(&row_vals[first..]);
            ptr.push(cols.len());
        }
        Self { pattern: Arc::new((ptr, cols)), vals }
    }

    /// The upper triangle of `a` where its `pattern` is known from [`Upper::of`] a matrix with the same entries.
    pub(crate) fn refilled(pattern: &Arc<(Vec<usize>, Vec<usize>)>, a: &Csr<f64>) -> Self {
        let (ptr, cols) = &**pattern;
        let mut vals = Vec::with_capacity(cols.len());
        for i in 0..a.num_rows() {
            let (row, row_vals) = a.row(i);
            let wanted = ptr[i + 1] - ptr[i];
            let first = row_vals.len().saturating_sub(wanted);
            if row_vals.len() >= wanted && row.get(first) == Some(i) {
                vals.extend_from_slice(&row_vals[first..]);
            } else {
                // no diagonal is stored
                vals.push(0.0);
                vals.extend_from_slice(&row_vals[row_vals.len() + 1 - wanted..]);
            }
        }
        Self { pattern: pattern.clone(), vals }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::Triplets;

    #[test]
    fn a_known_pattern_is_refilled_with_and_without_stored_diagonals() {
        let mut t = Triplets::new(4, 4);
        t.entries.extend([(0, 0, 2.0), (0, 3, 1.0), (1, 2, -1.0), (2, 1, -1.0), (3, 0, 1.0), (3, 3, 4.0)]);
        let mut a = t.to_csr();
        let first = Upper::of(&a);
        assert_eq!(*first.pattern, (vec![0, 2, 4, 5, 6], vec![0, 3, 1, 2, 2, 3]));
        assert_eq!(first.vals, [2.0, 1.0, 0.0, -1.0, 0.0, 4.0]);
        a.vals_mut().iter_mut().for_each(|v| *v *= 3.0);
        let again = Upper::refilled(&first.pattern, &a);
        assert_eq!(again.vals, Upper::of(&a).vals);
        assert!(Arc::ptr_eq(&again.pattern, &first.pattern));
    }
}
