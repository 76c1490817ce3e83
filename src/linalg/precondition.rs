//! Preconditioners made of the matrix alone, without a factor.

use super::{Csr, Operator, Real};

/// Approximate inverse M⁻¹ of a symmetric matrix A = L + D + Lᵀ.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Preconditioner {
    /// D⁻¹.
    #[default]
    Diagonal,
    /// (D + Lᵀ)⁻¹ D (D + L)⁻¹, a forward and a backward sweep; D⁻¹ if the operator has no matrix.
    ///
    /// Positive definite for every D > 0, so it never breaks down (Axelsson, Iterative Solution Methods, 1994, section 7.2).
    GaussSeidel,
}

impl Preconditioner {
    /// z = M⁻¹ r.
    pub(crate) fn apply<T: Real>(self, a: &dyn Operator<T>, inverse_diagonal: &[T], r: &[T], z: &mut [T]) {
        match (self, a.csr()) {
            (Self::GaussSeidel, Some(matrix)) => gauss_seidel(matrix, inverse_diagonal, r, z),
            _ => {
                for i in 0..r.len() {
                    z[i] = r[i] * inverse_diagonal[i];
                }
            }
        }
    }
}

/// z = (D + Lᵀ)⁻¹ D (D + L)⁻¹ r; the rows of a symmetric matrix hold both triangles.
pub(crate) fn gauss_seidel<T: Real>(a: &Csr<T>, inverse_diagonal: &[T], r: &[T], z: &mut [T]) {
    let n = r.len();
    for i in 0..n {
        let (cols, vals) = a.row(i);
        let mut sum = r[i];
        for (j, &v) in cols.zip(vals) {
            if j >= i {
                break;
            }
            sum -= v * z[j];
        }
        z[i] = sum * inverse_diagonal[i];
    }
    // D y = D (D + L)⁻¹ r, so (D + Lᵀ) z = D y means z_i = y_i - sum_j>i a_ij z_j / d_i
    for i in (0..n).rev() {
        let (cols, vals) = a.row(i);
        let mut sum = T::zero();
        for (j, &v) in cols.zip(vals).rev() {
            if j <= i {
                break;
            }
            sum += v * z[j];
        }
        z[i] -= sum * inverse_diagonal[i];
    }
}
