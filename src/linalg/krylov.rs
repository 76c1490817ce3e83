//! Conjugate gradients: symmetric positive definite operators, with or without a matrix.

use super::residual::{residual, row_scale};
use super::solver::NO_SYMMETRY;
use super::{LinearError, LinearSolver, Operator, Real, lit, to_f64};

/// Conjugate gradients, preconditioned by the diagonal.
///
/// Starts from the given x and stops where the preconditioned residual sqrt(rᵀ D⁻¹ r) has fallen to `tolerance` times that of x = 0.
#[derive(Clone, Debug)]
pub struct Cg<T: Real = f64> {
    /// Relative residual wanted.
    pub tolerance: f64,
    /// Iterations allowed; 0: ten times the number of unknowns, at least 100.
    pub max_iterations: usize,
    inverse_diagonal: Vec<T>,
}

impl<T: Real> Cg<T> {
    /// Stops at the relative residual `tolerance`.
    pub fn new(tolerance: f64) -> Self {
        Self { tolerance, max_iterations: 0, inverse_diagonal: Vec::new() }
    }
}

impl<T: Real> Default for Cg<T> {
    fn default() -> Self {
        Self::new(1e-12)
    }
}

impl<T: Real> LinearSolver<T> for Cg<T> {
    fn prepare(&mut self, a: &dyn Operator<T>) -> Result<(), LinearError> {
        let diagonal = a.diagonal();
        if diagonal.iter().any(|d| !to_f64(*d).is_finite()) {
            return Err(LinearError::NotFinite);
        }
        if diagonal.iter().any(|&d| d <= T::zero()) {
            // not positive definite
            return Err(LinearError::Singular { residual: 1.0 });
        }
        if a.csr().is_some_and(|matrix| !matrix.is_symmetric(NO_SYMMETRY)) {
            return Err(LinearError::NotSymmetric);
        }
        self.inverse_diagonal = diagonal.iter().map(|&d| T::one() / d).collect();
        Ok(())
    }

    fn solve(&self, a: &dyn Operator<T>, b: &[T], x: &mut [T]) -> Result<usize, LinearError> {
        let n = a.size();
        for found in [b.len(), x.len(), self.inverse_diagonal.len()] {
            if found != n {
                return Err(LinearError::Shape { expected: n, found });
            }
        }
        let d = &self.inverse_diagonal;
        let dot = |x: &[T], y: &[T]| x.iter().zip(y).fold(T::zero(), |s, (&a, &b)| s + a * b);
        let weighted = |r: &[T]| r.iter().zip(d).fold(T::zero(), |s, (&r, &d)| s + r * r * d);
        let reference = weighted(b);
        if !to_f64(reference).is_finite() || x.iter().any(|v| !to_f64(*v).is_finite()) {
            return Err(LinearError::NotFinite);
        }
        if reference == T::zero() {
            x.fill(T::zero());
            return Ok(0);
        }
        let limit = if self.max_iterations == 0 { (10 * n).max(100) } else { self.max_iterations };
        let goal = reference * lit::<T>(self.tolerance) * lit::<T>(self.tolerance);
        let (mut r, mut q) = (vec![T::zero(); n], vec![T::zero(); n]);
        a.apply(x, &mut q);
        for i in 0..n {
            r[i] = b[i] - q[i];
        }
        let mut z: Vec<T> = r.iter().zip(d).map(|(&r, &d)| r * d).collect();
        let mut p = z.clone();
        let mut rz = dot(&r, &z);
        let mut iterations = 0;
        while rz > goal {
            let relative = to_f64((rz / reference).sqrt());
            if iterations == limit {
                return Err(LinearError::NotConverged { iterations, residual: relative, tolerance: self.tolerance });
            }
            a.apply(&p, &mut q);
            let curvature = dot(&p, &q);
            if curvature <= T::zero() || !to_f64(curvature).is_finite() {
                return Err(LinearError::Singular { residual: relative });
            }
            let step = rz / curvature;
            for i in 0..n {
                x[i] += step * p[i];
                r[i] -= step * q[i];
                z[i] = r[i] * d[i];
            }
            let next = dot(&r, &z);
            let turn = next / rz;
            rz = next;
            for i in 0..n {
                p[i] = z[i] + turn * p[i];
            }
            iterations += 1;
        }
        // the recursive residual drifts: ask the operator itself
        let size = residual(a, &row_scale(a), b, x, &mut r);
        let allowed = (100.0 * self.tolerance).max(1e3 * to_f64(T::default_epsilon()));
        if size.is_nan() || size > allowed {
            return Err(LinearError::NotConverged { iterations, residual: size, tolerance: self.tolerance });
        }
        Ok(iterations)
    }
}
