//! LDLᵀ of dense symmetric quasi-definite matrices, without pivoting.

use super::dense_panel::eliminate;
use super::faer_kernels;
use super::{Buffer, LinearError};
use faer::linalg::matmul::matmul;
use faer::{Accum, MatMut, MatRef, Par};

/// Dense matrix with its first rows eliminated; memory is kept for the next one.
#[derive(Debug, Default)]
pub(crate) struct DenseLdlt {
    n: usize,
    /// Rows that are eliminated.
    count: usize,
    /// L below the diagonal, D on it, column after column; then the Schur complement of the eliminated rows, lower triangle.
    factor: Buffer<f64>,
    scaled: Buffer<f64>,
}

impl DenseLdlt {
    /// Bytes for a matrix of `n` rows.
    pub fn bytes(n: usize) -> usize {
        16 * n * n
    }

    /// Eliminates the first `count` rows of the matrix of `n` rows whose lower triangle is `entry`(row, column).
    ///
    /// # Errors
    /// [`LinearError::Singular`] if a pivot is zero or infinite, [`LinearError::Memory`].
    pub fn eliminate(&mut self, n: usize, count: usize, entry: impl Fn(usize, usize) -> f64) -> Result<(), LinearError> {
        faer_kernels::take()?;
        for memory in [&mut self.factor, &mut self.scaled] {
            if memory.len() != n * n {
                *memory = Buffer::default();
                *memory = Buffer::try_zeros(n * n).ok_or(LinearError::Memory)?;
            }
        }
        (self.n, self.count) = (n, count);
        for (j, column) in self.factor.chunks_exact_mut(n.max(1)).enumerate() {
            column[..j].fill(0.0);
            column[j..].iter_mut().zip(j..).for_each(|(v, i)| *v = entry(i, j));
        }
        if count == 0 {
            return Ok(());
        }
        let (first, rest) = self.factor.split_at_mut(n * count);
        eliminate(first, n, count, &mut self.scaled[..n * count]).ok_or(LinearError::Singular { residual: 1.0 })?;
        if count < n {
            let below = |columns| MatRef::from_column_major_slice(columns, n, count).split_at_row(count).1;
            let (l, scaled) = (below(&*first), below(&self.scaled[..n * count]));
            let target = MatMut::from_column_major_slice_mut(rest, n, n - count).split_at_row_mut(count).1;
            matmul(target, Accum::Add, scaled, l.transpose(), -1.0, Par::Seq);
        }
        Ok(())
    }

    /// D.
    pub fn pivots(&self) -> impl Iterator<Item = f64> {
        (0..self.count).map(|i| self.factor[i * (self.n + 1)])
    }

    /// x = A⁻¹ x for the block A of the eliminated rows.
    pub fn solve(&self, x: &mut [f64]) {
        let column = |j: usize| &self.factor[j * (self.n + 1)..j * self.n + self.count];
        for j in 0..self.count {
            let (own, rest) = x[j..self.count].split_first_mut().expect("as long as the matrix");
            rest.iter_mut().zip(&column(j)[1..]).for_each(|(x, l)| *x -= l * *own);
        }
        for j in (0..self.count).rev() {
            let (own, rest) = x[j..self.count].split_first_mut().expect("as long as the matrix");
            *own /= column(j)[0];
            *own -= rest.iter().zip(&column(j)[1..]).map(|(x, l)| l * x).sum::<f64>();
        }
    }

    /// y = B x with the Schur complement B of the eliminated rows; one value per remaining row.
    pub fn multiply_rest(&self, x: &[f64], y: &mut [f64]) {
        y.fill(0.0);
        for (j, &own) in x.iter().enumerate() {
            let column = &self.factor[(self.count + j) * (self.n + 1)..(self.count + j + 1) * self.n];
            let mut sum = column[0] * own;
            for ((y, &x), &v) in y[j + 1..].iter_mut().zip(&x[j + 1..]).zip(&column[1..]) {
                *y += v * own;
                sum += v * x;
            }
            y[j] += sum;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::residual::trial_numbers;

    #[test]
    fn quasi_definite_matrices_of_all_sizes_are_solved() {
        for n in [0, 1, 5, 16, 17, 40, 100] {
            let numbers = trial_numbers(n * n);
            let entry = |i: usize, j: usize| numbers[i.max(j) * n + i.min(j)];
            let diagonal: Vec<f64> = (0..n).map(|i| if i % 3 == 1 { -(n as f64) - 1.0 } else { n as f64 + 2.0 }).collect();
            let whole = |i: usize, j: usize| entry(i, j) + if i == j { diagonal[i] } else { 0.0 };
            let x = trial_numbers(n);
            let product = |x: &[f64]| (0..n).map(|i| (0..n).map(|j| whole(i, j) * x[j]).sum()).collect::<Vec<f64>>();
            let mut dense = DenseLdlt::default();
            for count in [n, n / 2, 0] {
                dense.eliminate(n, count, whole).unwrap();
                assert_eq!(dense.pivots().filter(|&d| d < 0.0).count(), (0..count).filter(|i| i % 3 == 1).count());
                // if y solves the first rows, the product of the other rows is that of the Schur complement
                let mut y = x.clone();
                y[..count].fill(0.0);
                let mut first = product(&y);
                dense.solve(&mut first[..count]);
                (0..count).for_each(|i| y[i] = -first[i]);
                let (expected, mut found) = (product(&y), vec![f64::NAN; n - count]);
                dense.multiply_rest(&x[count..], &mut found);
                assert!(expected[..count].iter().all(|v| v.abs() < 1e-12), "{n} {count}: {expected:?}");
                assert!(expected[count..].iter().zip(&found).all(|(a, b)| (a - b).abs() < 1e-11), "{n} {count}");
            }
            dense.eliminate(n, n, whole).unwrap();
            let mut y = product(&x);
            dense.solve(&mut y);
            assert!(x.iter().zip(&y).all(|(x, y)| (x - y).abs() < 1e-13), "{n}: {x:?} {y:?}");
        }
        assert!(DenseLdlt::default().eliminate(1, 1, |_, _| 0.0).is_err());
    }
}
