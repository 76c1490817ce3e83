//! The stiffness with the rows as springs, K + Cᵀ W C, and a test for zero-energy modes that needs no factor.

use super::scale::Scaled;
use crate::linalg::residual::trial_numbers;
use crate::linalg::{Csr, Limits, LinearError, Operator, gauss_seidel, meets_kernel, product, sum};

/// Residual tolerance for a trial load, below its component in a zero-energy mode.
const TRIAL: f64 = 1e-4;
/// Eigenvalues of the matrix over its Gauss-Seidel preconditioner, which lie in (0, 1\], below this one are rounding.
const FREE: f64 = 1e-13;

/// K + Cᵀ W C; rows of weight zero stay in the pattern. `places`: coordinates of the unknowns.
pub(crate) fn penalised(s: &Scaled<'_>, columns: &Csr<f64>, w: &[f64], places: &[[f64; 3]]) -> Csr<f64> {
    let mut weighted = s.rows.clone();
    for (a, &wa) in w.iter().enumerate() {
        weighted.row_mut(a).1.iter_mut().for_each(|v| *v *= wa);
    }
    sum(1.0, s.stiffness, 1.0, &product(columns, &weighted)).with_dof_coordinates(places.to_vec())
}

/// 1 / diagonal of a matrix that should be positive definite.
pub(crate) fn inverse_diagonal(a: &Csr<f64>) -> Result<Vec<f64>, LinearError> {
    let diagonal = a.diagonal();
    if diagonal.iter().any(|d| !d.is_finite()) {
        return Err(LinearError::NotFinite);
    }
    if diagonal.iter().any(|&d| d <= 0.0) {
        return Err(LinearError::Singular { residual: 1.0 });
    }
    Ok(diagonal.iter().map(|d| 1.0 / d).collect())
}

/// Returns [`LinearError::Singular`] if a symmetric matrix has a zero-energy mode.
pub(crate) fn refuse_motions(a: &Csr<f64>, inverse_diagonal: &[f64], limits: &Limits) -> Result<(), LinearError> {
    let load: Vec<f64> = trial_numbers(a.num_rows()).iter().zip(inverse_diagonal).map(|(v, d)| v / d.sqrt()).collect();
    let found = meets_kernel(
        &mut |p, q| {
            a.apply(p, q);
            Ok(())
        },
        &mut |r, z| {
            gauss_seidel(a, inverse_diagonal, r, z);
            Ok(())
        },
        &load,
        FREE,
        &Limits { tolerance: TRIAL, max_iterations: 0, stop: limits.stop.clone() },
    )?;
    if found { Err(LinearError::Singular { residual: 1.0 }) } else { Ok(()) }
}
