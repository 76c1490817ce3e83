//! Contract of `Operator`: linearity, declared size, consistent diagonal and matrix.

use crate::linalg::Operator;

/// Checks `a`: y is overwritten, y = A x is linear, `diagonal` and `csr` agree with `apply`, `places` has one point per unknown or none.
///
/// # Errors
/// A sentence that names the broken rule and the place.
pub fn operator(a: &dyn Operator) -> Result<(), String> {
    let n = a.size();
    let wave = |k: f64| -> Vec<f64> { (0..n).map(|i| (1.0 + k * i as f64).sin() + 0.1 * k).collect() };
    let apply = |x: &[f64], fill: f64| {
        let mut y = vec![fill; n];
        a.apply(x, &mut y);
        y
    };
    let (x, z) = (wave(0.7), wave(1.3));
    let (ax, az) = (apply(&x, 0.0), apply(&z, 0.0));
    if ax.iter().any(|v| !v.is_finite()) {
        return Err("operator: A x is not finite for a finite x".into());
    }
    if apply(&x, f64::NAN) != ax {
        return Err("operator: y depends on what it held before; it has to be overwritten".into());
    }
    let scale = ax.iter().chain(&az).fold(0.0, |m: f64, v| m.max(v.abs()));
    let sum: Vec<f64> = (0..n).map(|i| 2.0 * x[i] - 3.0 * z[i]).collect();
    let asum = apply(&sum, 0.0);
    if let Some(i) = (0..n).find(|&i| (asum[i] - 2.0 * ax[i] + 3.0 * az[i]).abs() > 1e-11 * scale) {
        return Err(format!("operator: not linear, entry {i} of A (2 x - 3 z) is {} instead of {}", asum[i], 2.0 * ax[i] - 3.0 * az[i]));
    }
    let diagonal = a.diagonal();
    if diagonal.len() != n {
        return Err(format!("operator: {} diagonal entries for {n} unknowns", diagonal.len()));
    }
    let mut unit = vec![0.0; n];
    for i in (0..n).step_by((n / 64).max(1)) {
        unit[i] = 1.0;
        let column = apply(&unit, 0.0);
        unit[i] = 0.0;
        let size = column.iter().fold(diagonal[i].abs(), |m, v| m.max(v.abs()));
        if (column[i] - diagonal[i]).abs() > 1e-11 * size {
            return Err(format!("operator: diagonal entry {i} is {}, A e_{i} has {}", diagonal[i], column[i]));
        }
        if let Some(matrix) = a.csr()
            && let Some(k) = (0..n).find(|&k| (matrix.get(k, i) - column[k]).abs() > 1e-11 * size)
        {
            return Err(format!("operator: the matrix has {} at ({k}, {i}), A e_{i} has {}", matrix.get(k, i), column[k]));
        }
    }
    if let Some(matrix) = a.csr() {
        if (matrix.num_rows(), matrix.num_cols()) != (n, n) {
            return Err(format!("operator: the matrix is {} x {}, the size {n}", matrix.num_rows(), matrix.num_cols()));
        }
        for i in 0..n {
            if !matrix.row(i).0.is_sorted_by(|a, b| a < b) {
                return Err(format!("operator: columns of row {i} do not ascend"));
            }
        }
    }
    let places = a.dof_coordinates();
    if !(places.is_empty() || places.len() == n) {
        return Err(format!("operator: {} places for {n} unknowns; one each, or none", places.len()));
    }
    if let Some(i) = places.iter().position(|p| p.iter().any(|x| !x.is_finite())) {
        return Err(format!("operator: the place of unknown {i} is not finite"));
    }
    Ok(())
}
