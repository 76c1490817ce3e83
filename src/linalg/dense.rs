//! LDLᵀ of dense symmetric quasi-definite matrices, without pivoting.

use super::faer_kernels;
use super::faer_panel::eliminate;
use super::{Buffer, LinearError};

/// A factorised matrix; memory is kept from one to the next.
#[derive(Debug, Default)]
pub(crate) struct DenseLdlt {
    n: usize,
    /// L below the diagonal, D on it, column after column.
    factor: Buffer<f64>,
    scaled: Buffer<f64>,
}

impl DenseLdlt {
    /// Bytes for a matrix of `n` rows.
    pub fn bytes(n: usize) -> usize {
        16 * n * n
    }

    /// Factorises `lower` + diag `diagonal`, of which the lower triangle is read column after column.
    ///
    /// # Errors
    /// [`LinearError::Singular`] where a pivot is zero or infinite, [`LinearError::Memory`].
    pub fn factorise(&mut self, lower: &[f64], diagonal: &[f64]) -> Result<(), LinearError> {
        let n = diagonal.len();
        faer_kernels::take()?;
        for memory in [&mut self.factor, &mut self.scaled] {
            if memory.len() != n * n {
                *memory = Buffer::default();
                *memory = Buffer::try_zeros(n * n).ok_or(LinearError::Memory)?;
            }
        }
        self.n = n;
        self.factor.copy_from_slice(lower);
        (0..n).for_each(|i| self.factor[i * (n + 1)] += diagonal[i]);
        if n == 0 { Ok(()) } else { eliminate(&mut self.factor, n, n, &mut self.scaled).ok_or(LinearError::Singular { residual: 1.0 }) }
    }

    /// D.
    pub fn pivots(&self) -> impl Iterator<Item = f64> {
        (0..self.n).map(|i| self.factor[i * (self.n + 1)])
    }

    /// x = A⁻¹ x.
    pub fn solve(&self, x: &mut [f64]) {
        let column = |j: usize| &self.factor[j * (self.n + 1)..(j + 1) * self.n];
        for j in 0..self.n {
            let (own, rest) = x[j..].split_first_mut().expect("as long as the matrix");
            rest.iter_mut().zip(&column(j)[1..]).for_each(|(x, l)| *x -= l * *own);
        }
        for j in (0..self.n).rev() {
            let (own, rest) = x[j..].split_first_mut().expect("as long as the matrix");
            *own /= column(j)[0];
            *own -= rest.iter().zip(&column(j)[1..]).map(|(x, l)| l * x).sum::<f64>();
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
            let mut lower = vec![f64::NAN; n * n];
            (0..n).for_each(|j| (j..n).for_each(|i| lower[j * n + i] = entry(i, j)));
            let x = trial_numbers(n);
            let mut y: Vec<f64> = (0..n).map(|i| diagonal[i] * x[i] + (0..n).map(|j| entry(i, j) * x[j]).sum::<f64>()).collect();
            let mut dense = DenseLdlt::default();
            dense.factorise(&lower, &diagonal).unwrap();
            dense.solve(&mut y);
            assert!(x.iter().zip(&y).all(|(x, y)| (x - y).abs() < 1e-13), "{n}: {x:?} {y:?}");
            assert_eq!(dense.pivots().filter(|&d| d < 0.0).count(), (0..n).filter(|i| i % 3 == 1).count());
        }
        assert!(DenseLdlt::default().factorise(&[1.0], &[-1.0]).is_err());
    }
}
