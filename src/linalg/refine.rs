//! Solves by a factor with iterative refinement on the matrix itself, with residuals in twice the working precision.

use super::double_double::residual_rows;
use super::residual::{RESIDUAL_LIMIT, max, ratio, relative, residual};
use super::{Buffer, LinearError, Operator};

/// Limit of refinements, even if the residual still falls.
const MAX_REFINEMENTS: usize = 10;

/// Solves by `inverse` and refines on `a` until the correction stalls; returns the number of refinements.
pub(crate) fn refine(
    a: &dyn Operator<f64>,
    scale: &[f64],
    b: &[f64],
    x: &mut [f64],
    mut inverse: impl FnMut(&mut [f64]) -> Result<(), LinearError>,
) -> Result<usize, LinearError> {
    let n = a.size();
    for found in [b.len(), x.len(), scale.len()] {
        if found != n {
            return Err(LinearError::Shape { expected: n, found });
        }
    }
    if b.iter().any(|v| !v.is_finite()) {
        return Err(LinearError::NotFinite);
    }
    let largest = |x: &[f64]| x.iter().fold(0.0, |m, &v| max(m, v.abs()));
    x.copy_from_slice(b);
    inverse(x)?;
    let mut r = Buffer::try_zeros(n).ok_or(LinearError::Memory)?;
    let mut size = accurate_residual(a, scale, b, x, &mut r);
    let (mut step, mut steps) = (f64::INFINITY, 0);
    while steps < MAX_REFINEMENTS && size > 0.0 {
        inverse(&mut r)?;
        let next = ratio(largest(&r), largest(x));
        if next.is_nan() || next > 0.5 * step {
            break;
        }
        for i in 0..n {
            x[i] += r[i];
        }
        size = accurate_residual(a, scale, b, x, &mut r);
        steps += 1;
        // corrections shrink at a steady rate: the next one would be lost in rounding
        if next * ratio(next, step.min(1.0)) <= f64::EPSILON {
            break;
        }
        step = next;
    }
    if size.is_nan() || size > RESIDUAL_LIMIT {
        return Err(LinearError::Singular { residual: if size.is_finite() { size } else { 1.0 } });
    }
    Ok(steps)
}

/// [`residual`] in twice the working precision if the operator has a matrix.
fn accurate_residual(a: &dyn Operator<f64>, scale: &[f64], b: &[f64], x: &[f64], r: &mut [f64]) -> f64 {
    let Some(matrix) = a.csr() else {
        return residual(a, scale, b, x, r);
    };
    let [top, bottom] = residual_rows(matrix, x, r, &|i, mut sum| {
        sum.add(b[i]);
        (sum.value(), [sum.value().abs() * scale[i], sum.size * scale[i]])
    });
    relative(top, bottom)
}
