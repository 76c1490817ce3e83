//! MINRES: symmetric operators, definite or not.
//!
//!   x_k in x_0 + span{M⁻¹ r, M⁻¹ A M⁻¹ r, ..},  (b - A x_k)ᵀ M⁻¹ (b - A x_k) least,  M symmetric positive definite
//!
//! Three vectors are kept whatever the number of iterations: saddle points without a factor.
//!
//! Source: Paige, Saunders, SIAM J. Numer. Anal. 12 (1975) 617-629; the form with a preconditioner: Elman, Silvester, Wathen, Finite
//! Elements and Fast Iterative Solvers, 2nd ed. (2014), algorithm 4.1.

use super::krylov::{Map, diagonal, dot, framed};
use super::{Cancellation, Limits, LinearError, LinearSolver, Operator, Real, lit, to_f64};

/// MINRES, preconditioned by the sizes of the diagonal.
///
/// Starts from the given x and stops when sqrt(rᵀ M⁻¹ r) has fallen to `tolerance` times that of x = 0; then the true residual b - A x is
/// checked.
#[derive(Clone, Debug)]
pub struct Minres<T: Real = f64> {
    /// Relative residual wanted.
    pub tolerance: f64,
    /// Iterations allowed; 0: ten times the number of unknowns, at least 100.
    pub max_iterations: usize,
    /// Cancellation callback, polled before every iteration.
    pub stop: Cancellation,
    inverse_diagonal: Vec<T>,
}

impl<T: Real> Minres<T> {
    /// Creates a solver that stops at the relative residual `tolerance`.
    pub fn new(tolerance: f64) -> Self {
        Self { tolerance, max_iterations: 0, stop: Cancellation::default(), inverse_diagonal: Vec::new() }
    }
}

impl<T: Real> Default for Minres<T> {
    fn default() -> Self {
        Self::new(1e-12)
    }
}

impl<T: Real> LinearSolver<T> for Minres<T> {
    fn prepare(&mut self, a: &dyn Operator<T>) -> Result<(), LinearError> {
        let diagonal = a.diagonal();
        if diagonal.iter().any(|d| !to_f64(*d).is_finite()) {
            return Err(LinearError::NotFinite);
        }
        self.inverse_diagonal = diagonal.iter().map(|&d| if d == T::zero() { T::one() } else { T::one() / d.abs() }).collect();
        Ok(())
    }

    fn solve(&self, a: &dyn Operator<T>, b: &[T], x: &mut [T]) -> Result<usize, LinearError> {
        let limits = Limits { tolerance: self.tolerance, max_iterations: self.max_iterations, stop: self.stop.clone() };
        framed(a, self.inverse_diagonal.len(), &limits, b, x, |apply, b, x| {
            minres(apply, &mut diagonal(&self.inverse_diagonal), b, x, &limits)
        })
    }
}

/// MINRES for A = `apply`, symmetric, with M⁻¹ = `precondition`, symmetric positive definite; returns the iterations. Starts from x.
pub(crate) fn minres<T: Real>(
    apply: &mut Map<'_, T>,
    precondition: &mut Map<'_, T>,
    b: &[T],
    x: &mut [T],
    limits: &Limits,
) -> Result<usize, LinearError> {
    let n = b.len();
    let zeros = || vec![T::zero(); n];
    let (mut z, mut q) = (zeros(), zeros());
    precondition(b, &mut z)?;
    let reference = dot(b, &z);
    if !to_f64(reference).is_finite() || x.iter().any(|v| !to_f64(*v).is_finite()) {
        return Err(LinearError::NotFinite);
    }
    if reference <= T::zero() {
        x.fill(T::zero());
        return Ok(0);
    }
    let reference = reference.sqrt();
    let goal = reference * lit::<T>(limits.tolerance);
    let most = limits.most((10 * n).max(100));
    // v, z: Lanczos vectors and M⁻¹ times them; w: directions of the solution
    let (mut v_before, mut v) = (zeros(), b.to_vec());
    apply(x, &mut q)?;
    for i in 0..n {
        v[i] -= q[i];
    }
    precondition(&v, &mut z)?;
    let (mut w_before, mut w) = (zeros(), zeros());
    let one = T::one();
    let (mut gamma_before, mut gamma) = (one, dot(&v, &z).max(T::zero()).sqrt());
    let mut eta = gamma;
    let (mut c_before, mut c, mut s_before, mut s) = (one, one, T::zero(), T::zero());
    let mut iterations = 0;
    while eta.abs() > goal {
        let relative = to_f64(eta.abs() / reference);
        limits.allow(iterations, most, relative)?;
        z.iter_mut().for_each(|x| *x /= gamma);
        apply(&z, &mut q)?;
        let delta = dot(&q, &z);
        let (own, old) = (delta / gamma, gamma / gamma_before);
        for i in 0..n {
            let next = q[i] - own * v[i] - old * v_before[i];
            v_before[i] = v[i];
            v[i] = next;
        }
        let direction = std::mem::replace(&mut z, zeros());
        precondition(&v, &mut z)?;
        let next = dot(&v, &z).max(T::zero()).sqrt();
        let a0 = c * delta - c_before * s * gamma;
        let a1 = (a0 * a0 + next * next).sqrt();
        let a2 = s * delta + c_before * c * gamma;
        let a3 = s_before * gamma;
        if !to_f64(a1).is_finite() {
            return Err(LinearError::NotFinite);
        }
        iterations += 1;
        if a1 == T::zero() {
            return Err(LinearError::Singular { residual: relative });
        }
        (c_before, c, s_before, s) = (c, a0 / a1, s, next / a1);
        for i in 0..n {
            let d = (direction[i] - a3 * w_before[i] - a2 * w[i]) / a1;
            w_before[i] = w[i];
            w[i] = d;
            x[i] += c * eta * d;
        }
        eta = -s * eta;
        (gamma_before, gamma) = (gamma, next);
        if gamma == T::zero() && eta.abs() > goal {
            // the Krylov space is exhausted and contains no solution
            return Err(LinearError::Singular { residual: relative });
        }
    }
    Ok(iterations)
}
