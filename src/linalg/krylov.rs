//! Conjugate gradients: symmetric positive definite operators, with or without a matrix.
//!
//!   x_k minimises (x - A⁻¹ b)ᵀ A (x - A⁻¹ b) over x_0 + span{M⁻¹ r, M⁻¹ A M⁻¹ r, ..}
//!
//! Source: Hestenes, Stiefel, J. Res. Nat. Bur. Stand. 49 (1952) 409-436.

use super::precondition::Preconditioner;
use super::residual::{residual, row_scale};
use super::solver::NO_SYMMETRY;
use super::{Cancellation, Limits, LinearError, LinearSolver, Operator, Real, lit, to_f64};

/// Conjugate gradients.
///
/// Starts from the given x and stops where the preconditioned residual sqrt(rᵀ M⁻¹ r) has fallen to `tolerance` times that of x = 0;
/// then the true residual b - A x is checked.
#[derive(Clone, Debug)]
pub struct Cg<T: Real = f64> {
    /// Relative residual wanted.
    pub tolerance: f64,
    /// Iterations allowed; 0: ten times the number of unknowns, at least 100.
    pub max_iterations: usize,
    /// M; the diagonal if the operator has no matrix.
    pub preconditioner: Preconditioner,
    /// Cancellation callback, polled before every iteration.
    pub stop: Cancellation,
    inverse_diagonal: Vec<T>,
}

impl<T: Real> Cg<T> {
    /// Creates a solver that stops at the relative residual `tolerance`; M is the diagonal.
    pub fn new(tolerance: f64) -> Self {
        let preconditioner = Preconditioner::Diagonal;
        Self { tolerance, max_iterations: 0, preconditioner, stop: Cancellation::default(), inverse_diagonal: Vec::new() }
    }

    /// Uses symmetric Gauss-Seidel sweeps as M.
    #[must_use]
    pub fn with_gauss_seidel(mut self) -> Self {
        self.preconditioner = Preconditioner::GaussSeidel;
        self
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
        let limits = Limits { tolerance: self.tolerance, max_iterations: self.max_iterations, stop: self.stop.clone() };
        framed(a, self.inverse_diagonal.len(), &limits, b, x, |apply, b, x| {
            let mut precondition = |r: &[T], z: &mut [T]| {
                self.preconditioner.apply(a, &self.inverse_diagonal, r, z);
                Ok(())
            };
            conjugate_gradients(apply, &mut precondition, b, x, &limits)
        })
    }
}

/// A map of vectors that may fail.
pub(crate) type Map<'a, T> = dyn FnMut(&[T], &mut [T]) -> Result<(), LinearError> + 'a;

/// z = d r, entry by entry.
pub(crate) fn diagonal<T: Real>(d: &[T]) -> impl FnMut(&[T], &mut [T]) -> Result<(), LinearError> + '_ {
    move |r, z| {
        for ((z, &r), &d) in z.iter_mut().zip(r).zip(d) {
            *z = r * d;
        }
        Ok(())
    }
}

/// Runs an iterative `method` with checks: sizes must agree with the size it was `prepared` for, and the true residual of the solution is
/// computed with the operator, because the recurrence for the residual inside a method drifts.
pub(crate) fn framed<T: Real>(
    a: &dyn Operator<T>,
    prepared: usize,
    limits: &Limits,
    b: &[T],
    x: &mut [T],
    method: impl FnOnce(&mut Map<'_, T>, &[T], &mut [T]) -> Result<usize, LinearError>,
) -> Result<usize, LinearError> {
    let n = a.size();
    for found in [b.len(), x.len(), prepared] {
        if found != n {
            return Err(LinearError::Shape { expected: n, found });
        }
    }
    let mut apply = |p: &[T], q: &mut [T]| {
        a.apply(p, q);
        Ok(())
    };
    let iterations = method(&mut apply, b, x)?;
    // rows are scaled, so that rows of small entries count as much as others
    let size = residual(a, &row_scale(a), b, x, &mut vec![T::zero(); n]);
    let allowed = (100.0 * limits.tolerance).max(1e3 * to_f64(T::default_epsilon()));
    if size.is_nan() || size > allowed {
        return Err(LinearError::NotConverged { iterations, residual: size, tolerance: limits.tolerance });
    }
    Ok(iterations)
}

/// Σ x_i y_i from the first to the last: the same bits on any number of threads.
pub(crate) fn dot<T: Real>(x: &[T], y: &[T]) -> T {
    x.iter().zip(y).fold(T::zero(), |s, (&a, &b)| s + a * b)
}

/// Conjugate gradients for A = `apply` and M⁻¹ = `precondition`, both symmetric positive definite; returns the iterations.
///
/// Starts from x; ends at rᵀ M⁻¹ r <= tolerance² bᵀ M⁻¹ b for the recursively updated residual r.
pub(crate) fn conjugate_gradients<T: Real>(
    apply: &mut Map<'_, T>,
    precondition: &mut Map<'_, T>,
    b: &[T],
    x: &mut [T],
    limits: &Limits,
) -> Result<usize, LinearError> {
    watched(apply, precondition, b, x, limits, &mut |_, _| {})
}

/// Conjugate gradients that pass the coefficients of every iteration to `hears`: step lengths alpha_k and direction updates beta_k, which
/// define the Lanczos matrix of M⁻¹ A.
fn watched<T: Real>(
    apply: &mut Map<'_, T>,
    precondition: &mut Map<'_, T>,
    b: &[T],
    x: &mut [T],
    limits: &Limits,
    hears: &mut dyn FnMut(T, T),
) -> Result<usize, LinearError> {
    let n = b.len();
    let (mut r, mut q, mut z) = (vec![T::zero(); n], vec![T::zero(); n], vec![T::zero(); n]);
    precondition(b, &mut z)?;
    let reference = dot(b, &z);
    if !to_f64(reference).is_finite() || x.iter().any(|v| !to_f64(*v).is_finite()) {
        return Err(LinearError::NotFinite);
    }
    if reference <= T::zero() {
        x.fill(T::zero());
        return Ok(0);
    }
    let most = limits.most((10 * n).max(100));
    let goal = reference * lit::<T>(limits.tolerance) * lit::<T>(limits.tolerance);
    apply(x, &mut q)?;
    for i in 0..n {
        r[i] = b[i] - q[i];
    }
    precondition(&r, &mut z)?;
    let mut p = z.clone();
    let mut rz = dot(&r, &z);
    let mut iterations = 0;
    while rz > goal {
        let relative = to_f64((rz / reference).sqrt());
        limits.allow(iterations, most, relative)?;
        apply(&p, &mut q)?;
        let curvature = dot(&p, &q);
        if curvature <= T::zero() || !to_f64(curvature).is_finite() {
            return Err(LinearError::Singular { residual: relative });
        }
        let step = rz / curvature;
        for i in 0..n {
            x[i] += step * p[i];
            r[i] -= step * q[i];
        }
        precondition(&r, &mut z)?;
        let next = dot(&r, &z);
        let turn = next / rz;
        hears(step, turn);
        rz = next;
        for i in 0..n {
            p[i] = z[i] + turn * p[i];
        }
        iterations += 1;
    }
    if to_f64(rz).is_nan() {
        return Err(LinearError::NotFinite);
    }
    Ok(iterations)
}

/// Whether conjugate gradients on a trial load `b` find an eigenvalue of M⁻¹ A that is not above `least`.
///
/// The eigenvalues of the Lanczos matrix of alpha_k and beta_k lie within the spectrum; a Sturm sequence detects one below `least`.
/// The trial ends at the tolerance of `limits`; the relative component of the load in the sought modes must be larger.
///
/// # Errors
/// [`LinearError::Stopped`] and [`LinearError::NotFinite`].
pub(crate) fn meets_kernel(
    apply: &mut Map<'_, f64>,
    precondition: &mut Map<'_, f64>,
    b: &[f64],
    least: f64,
    limits: &Limits,
) -> Result<bool, LinearError> {
    let (mut before, mut pivot, mut found) = (None, 1.0, false);
    let mut x = vec![0.0; b.len()];
    let trial = watched(apply, precondition, b, &mut x, limits, &mut |step, turn| {
        // diagonal 1 / alpha_k + beta_k-1 / alpha_k-1, beside it sqrt(beta_k-1) / alpha_k-1
        let (shift, square) = before.map_or((0.0, 0.0), |(step, turn): (f64, f64)| (turn / step, turn / (step * step)));
        pivot = 1.0 / step + shift - least - square / pivot;
        found |= pivot <= 0.0;
        before = Some((step, turn));
    });
    match trial {
        Ok(_) | Err(LinearError::NotConverged { .. }) => Ok(found),
        Err(LinearError::Singular { .. }) => Ok(true),
        Err(other) => Err(other),
    }
}
