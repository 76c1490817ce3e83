//! The smallest singular value of the whole matrix L_M⁻¹ B L_W⁻ᵀ.
//!
//! Singular values, not eigenvalues of the square: a beta that is zero comes out at 1e-16, not at 1e-8.

use super::{Grams, InfSupError};
use crate::linalg::Csr;
use nalgebra::DMatrix;

/// Computes beta; there must be at least as many trace functions as multipliers.
pub(super) fn smallest(grams: &Grams) -> Result<f64, InfSupError> {
    let of_trace = factor(&grams.trace, "trace")?;
    let of_multiplier = factor(&grams.multiplier, "multiplier")?;
    // X = L_M⁻¹ B first, then Y = L_W⁻¹ Xᵀ: its singular values are those of X L_W⁻ᵀ
    let mut x = full(&grams.mixed);
    let solvable = of_multiplier.solve_lower_triangular_mut(&mut x);
    let mut y = x.transpose();
    let solvable = solvable && of_trace.solve_lower_triangular_mut(&mut y);
    if !solvable || y.iter().any(|v| !v.is_finite()) {
        return Err(InfSupError::Dependent { space: "trace" });
    }
    Ok(y.singular_values().iter().copied().fold(f64::INFINITY, f64::min).clamp(0.0, 1.0))
}

/// Cholesky factor L of a symmetric positive definite matrix.
fn factor(a: &Csr, space: &'static str) -> Result<DMatrix<f64>, InfSupError> {
    Ok(full(a).cholesky().ok_or(InfSupError::Dependent { space })?.unpack())
}

fn full(a: &Csr) -> DMatrix<f64> {
    let mut b = DMatrix::zeros(a.num_rows(), a.num_cols());
    for i in 0..a.num_rows() {
        let (cols, vals) = a.row(i);
        for (j, &v) in cols.zip(vals) {
            b[(i, j)] = v;
        }
    }
    b
}
