//! Restarted GMRES: any square operator, symmetric or not.
//!
//!   x_k = x_0 + M⁻¹ y,  y in span{r, A M⁻¹ r, (A M⁻¹)² r, ..},  |b - A x_k| least
//!
//! Right preconditioning, so the residual is the true one. Dot products are summed from first to last: the same bits on any number of
//! threads. Orthogonalised twice by modified Gram-Schmidt.
//!
//! Source: Saad, Schultz, SIAM J. Sci. Stat. Comput. 7 (1986) 856-869; "twice is enough": Giraud, Langou, Rozloznik, van den Eshof,
//! Numer. Math. 101 (2005) 87-100.

use super::krylov::{Map, diagonal, dot, framed};
use super::{Cancellation, Limits, LinearError, LinearSolver, Operator, Real, lit, to_f64};

/// GMRES, preconditioned by the diagonal from the right.
///
/// Starts from the given x and stops where |b - A x| <= `tolerance` |b|, computed from the operator itself.
/// Keeps `restart` + 1 vectors of the length of x.
#[derive(Clone, Debug)]
pub struct Gmres<T: Real = f64> {
    /// Relative residual wanted.
    pub tolerance: f64,
    /// Iterations allowed; 0: ten times the number of unknowns, at least 100.
    pub max_iterations: usize,
    /// Vectors kept before a restart.
    pub restart: usize,
    /// Cancellation callback, polled before every iteration.
    pub stop: Cancellation,
    inverse_diagonal: Vec<T>,
}

/// Default number of vectors kept.
const RESTART: usize = 100;

impl<T: Real> Gmres<T> {
    /// Creates a solver that stops at the relative residual `tolerance` and keeps 100 vectors.
    pub fn new(tolerance: f64) -> Self {
        Self { tolerance, max_iterations: 0, restart: RESTART, stop: Cancellation::default(), inverse_diagonal: Vec::new() }
    }

    /// Sets the number of vectors kept before a restart.
    #[must_use]
    pub fn with_restart(mut self, restart: usize) -> Self {
        self.restart = restart;
        self
    }
}

impl<T: Real> Default for Gmres<T> {
    fn default() -> Self {
        Self::new(1e-12)
    }
}

impl<T: Real> LinearSolver<T> for Gmres<T> {
    fn prepare(&mut self, a: &dyn Operator<T>) -> Result<(), LinearError> {
        let diagonal = a.diagonal();
        if diagonal.iter().any(|d| !to_f64(*d).is_finite()) {
            return Err(LinearError::NotFinite);
        }
        // zero diagonal entries, as in saddle points, are not used as scale
        self.inverse_diagonal = diagonal.iter().map(|&d| if d == T::zero() { T::one() } else { T::one() / d }).collect();
        Ok(())
    }

    fn solve(&self, a: &dyn Operator<T>, b: &[T], x: &mut [T]) -> Result<usize, LinearError> {
        let limits = Limits { tolerance: self.tolerance, max_iterations: self.max_iterations, stop: self.stop.clone() };
        framed(a, self.inverse_diagonal.len(), &limits, b, x, |apply, b, x| {
            gmres(apply, &mut diagonal(&self.inverse_diagonal), self.restart, b, x, &limits)
        })
    }
}

/// GMRES for A = `apply` with M⁻¹ = `precondition` from the right; returns the iterations. Starts from x.
pub(crate) fn gmres<T: Real>(
    apply: &mut Map<'_, T>,
    precondition: &mut Map<'_, T>,
    restart: usize,
    b: &[T],
    x: &mut [T],
    limits: &Limits,
) -> Result<usize, LinearError> {
    let n = b.len();
    let norm = |v: &[T]| dot(v, v).sqrt();
    let reference = norm(b);
    if !to_f64(reference).is_finite() || x.iter().any(|v| !to_f64(*v).is_finite()) {
        return Err(LinearError::NotFinite);
    }
    if reference == T::zero() {
        x.fill(T::zero());
        return Ok(0);
    }
    let goal = reference * lit::<T>(limits.tolerance);
    let most = limits.most((10 * n).max(100));
    let (mut z, mut w) = (vec![T::zero(); n], vec![T::zero(); n]);
    let mut iterations = 0;
    loop {
        apply(x, &mut w)?;
        let mut r: Vec<T> = (0..n).map(|i| b[i] - w[i]).collect();
        let beta = norm(&r);
        if !to_f64(beta).is_finite() {
            return Err(LinearError::NotFinite);
        }
        if beta <= goal {
            return Ok(iterations);
        }
        r.iter_mut().for_each(|v| *v /= beta);
        let mut space = Krylov::new(r, beta);
        while space.columns.len() < restart.max(1) {
            let relative = to_f64(space.residual() / reference);
            limits.allow(iterations, most, relative)?;
            precondition(&space.basis[space.columns.len()], &mut z)?;
            apply(&z, &mut w)?;
            let size = norm(&w);
            let column = space.orthogonalise(&mut w);
            let mut below = norm(&w);
            if !to_f64(below).is_finite() {
                return Err(LinearError::NotFinite);
            }
            // the Krylov space is exhausted: the rest is rounding
            let exhausted = below <= size * lit::<T>(10.0) * T::default_epsilon();
            if exhausted {
                below = T::zero();
            }
            iterations += 1;
            if !space.push(column, below, size * T::default_epsilon()) {
                return Err(LinearError::Singular { residual: relative });
            }
            if exhausted || space.residual() <= goal {
                break;
            }
            w.iter_mut().for_each(|v| *v /= below);
            space.basis.push(w.clone());
        }
        space.minimiser(&mut w);
        precondition(&w, &mut z)?;
        for i in 0..n {
            x[i] += z[i];
        }
    }
}

/// Orthonormal basis of a Krylov space, and the least-squares problem of the Hessenberg matrix in it.
struct Krylov<T: Real> {
    basis: Vec<Vec<T>>,
    /// Columns of the triangular factor of the Hessenberg matrix.
    columns: Vec<Vec<T>>,
    /// Cosine and sine of its rotations.
    rotations: Vec<(T, T)>,
    /// Rotated right-hand side; its last entry is the residual.
    turned: Vec<T>,
}

impl<T: Real> Krylov<T> {
    /// Starts from the residual: its direction `r` and its norm `beta`.
    fn new(r: Vec<T>, beta: T) -> Self {
        Self { basis: vec![r], columns: Vec::new(), rotations: Vec::new(), turned: vec![beta] }
    }

    /// Norm of the least residual in the space.
    fn residual(&self) -> T {
        self.turned[self.columns.len()].abs()
    }

    /// Makes `w` orthogonal to the basis, twice, and returns its components in the basis.
    fn orthogonalise(&self, w: &mut [T]) -> Vec<T> {
        let mut column = vec![T::zero(); self.basis.len()];
        for _ in 0..2 {
            for (i, v) in self.basis.iter().enumerate() {
                let h = dot(w, v);
                column[i] += h;
                for (wj, &vj) in w.iter_mut().zip(v) {
                    *wj -= h * vj;
                }
            }
        }
        column
    }

    /// Adds a column of the Hessenberg matrix with the entry `below` its diagonal. Returns false for a diagonal entry of at most `zero`
    /// after the rotations: the triangular factor is singular, A M⁻¹ has a kernel in the Krylov space.
    fn push(&mut self, mut column: Vec<T>, below: T, zero: T) -> bool {
        let k = self.columns.len();
        for (i, &(c, s)) in self.rotations.iter().enumerate() {
            (column[i], column[i + 1]) = (c * column[i] + s * column[i + 1], c * column[i + 1] - s * column[i]);
        }
        let length = (column[k] * column[k] + below * below).sqrt();
        if length <= zero {
            return false;
        }
        let (c, s) = (column[k] / length, below / length);
        column[k] = length;
        self.rotations.push((c, s));
        self.columns.push(column);
        let last = self.turned[k];
        self.turned[k] = c * last;
        self.turned.push(-s * last);
        true
    }

    /// Writes the vector of the space with the least residual to `w`.
    fn minimiser(&self, w: &mut [T]) {
        let k = self.columns.len();
        let mut y = self.turned[..k].to_vec();
        for i in (0..k).rev() {
            for j in i + 1..k {
                let (a, b) = (self.columns[j][i], y[j]);
                y[i] -= a * b;
            }
            y[i] /= self.columns[i][i];
        }
        w.fill(T::zero());
        for (v, &yk) in self.basis.iter().zip(&y) {
            for (wi, &vi) in w.iter_mut().zip(v) {
                *wi += yk * vi;
            }
        }
    }
}
