//! Product and sum of two sparse matrices.

use super::{Csr, Operator, Real};
use crate::parallel;

/// A B for any shapes that fit; columns ascend, products that cancel stay as stored zeros.
///
/// Every entry is summed in the order of the columns of A, so the result does not depend on the number of threads.
///
/// # Panics
/// If A has not as many columns as B has rows.
pub fn product<T: Real>(a: &Csr<T>, b: &Csr<T>) -> Csr<T> {
    assert_eq!(a.num_cols(), b.num_rows(), "columns of the first are rows of the second");
    let rows: Vec<(Vec<u32>, Vec<T>)> = parallel::map_init(
        a.num_rows(),
        || (vec![T::zero(); b.num_cols()], vec![false; b.num_cols()]),
        |(sum, used), i| {
            let mut cols: Vec<u32> = Vec::new();
            let (a_cols, a_vals) = a.row(i);
            for (k, &x) in a_cols.zip(a_vals) {
                let (b_cols, b_vals) = b.row(k);
                for (j, &y) in b_cols.zip(b_vals) {
                    if !used[j] {
                        used[j] = true;
                        cols.push(u32::try_from(j).expect("a column index"));
                    }
                    sum[j] += x * y;
                }
            }
            cols.sort_unstable();
            let vals = cols.iter().map(|&j| sum[j as usize]).collect();
            for &j in &cols {
                sum[j as usize] = T::zero();
                used[j as usize] = false;
            }
            (cols, vals)
        },
    );
    let mut ptr = vec![0usize];
    let (mut cols, mut vals) = (Vec::new(), Vec::new());
    for (row_cols, row_vals) in rows {
        cols.extend(row_cols);
        vals.extend(row_vals);
        ptr.push(cols.len());
    }
    Csr::from_parts(b.num_cols(), ptr, cols, vals)
}

/// a A + b B for matrices of the same shape; every place that either stores is stored. The places of unknowns are those of A.
///
/// # Panics
/// If the shapes differ.
pub fn sum<T: Real>(a: T, left: &Csr<T>, b: T, right: &Csr<T>) -> Csr<T> {
    assert_eq!((left.num_rows(), left.num_cols()), (right.num_rows(), right.num_cols()), "matrices of one shape");
    let most = left.num_entries() + right.num_entries();
    let (mut ptr, mut cols, mut vals) = (vec![0usize], Vec::with_capacity(most), Vec::with_capacity(most));
    for i in 0..left.num_rows() {
        let ((l_cols, l_vals), (r_cols, r_vals)) = (left.row(i), right.row(i));
        let (mut l, mut r) = (l_cols.zip(l_vals).peekable(), r_cols.zip(r_vals).peekable());
        loop {
            let (x, y) = (l.peek().map_or(usize::MAX, |e| e.0), r.peek().map_or(usize::MAX, |e| e.0));
            let column = x.min(y);
            if column == usize::MAX {
                break;
            }
            let mut v = T::zero();
            if let Some((_, &value)) = l.next_if(|e| e.0 == column) {
                v += a * value;
            }
            if let Some((_, &value)) = r.next_if(|e| e.0 == column) {
                v += b * value;
            }
            cols.push(u32::try_from(column).expect("a column index"));
            vals.push(v);
        }
        ptr.push(cols.len());
    }
    Csr::from_parts(left.num_cols(), ptr, cols, vals).with_dof_coordinates(left.dof_coordinates().to_vec())
}
