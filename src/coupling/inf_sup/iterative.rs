//! The smallest eigenvalue of B G_W⁻¹ Bᵀ phi = lambda G_M phi by Lanczos with shifts, on sparse factors.
//!
//! (B G_W⁻¹ Bᵀ - sigma G_M) phi = G_M v is solved as
//!
//! ```text
//! [ G_W  Bᵀ        ] [w  ]   [ 0       ]
//! [ B    sigma G_M ] [phi] = [ -G_M v  ]
//! ```
//!
//! Below zero the matrix is quasi-definite: LDLᵀ needs no pivots, and eigenvalues near zero stand apart at once. Then the
//! shift moves up to just below the smallest Ritz value, where LU takes over: edges of bands, where eigenvalues lie as close as
//! n⁻², are resolved in a few shifts. A Ritz value of the wrong sign proves that an eigenvalue lies below a shift; the shift
//! moves down then. Every beta is the Rayleigh quotient of a vector, so it is never too small; it is taken as a norm, so
//! that a zero comes out at round-off, not at its root.

use super::{Grams, InfSupError};
use crate::linalg::{Csr, Ldlt, LinearError, LinearSolver, Lu, Triplets};
use nalgebra::DMatrix;

/// The first shift is minus this part of the largest eigenvalue possible, 1.
const FIRST_SHIFT: f64 = 1e-6;
/// Lanczos vectors per shift.
const STEPS: usize = 40;
/// Largest number of shifts.
const MAX_SHIFTS: usize = 40;
/// Wanted relative accuracy of lambda = beta².
const TOLERANCE: f64 = 1e-10;
/// Least distance of a shift below lambda, as a share of it: nearer, the matrix is singular to working precision.
const NEAREST: f64 = 1e-7;
/// Below this lambda the vector is polished by inverse iteration, so that its beta is that of an exact zero.
const NEARLY_ZERO: f64 = 1e-7;
/// Inverse iterations of the polish.
const POLISH: usize = 4;

/// Result of one shift.
struct Found {
    /// The vector with the smallest Rayleigh quotient, of unit norm.
    phi: Vec<f64>,
    /// beta of `phi`.
    beta: f64,
    /// Bound of the distance from beta² to an eigenvalue.
    error: f64,
    /// Whether a negative Ritz value proves an eigenvalue below the shift.
    below: bool,
}

/// Computes beta and the number of linear systems; there must be at least as many trace functions as multipliers.
pub(super) fn smallest(grams: &Grams) -> Result<(f64, usize), InfSupError> {
    let mut pencil = Pencil::new(grams)?;
    let mut best = pencil.lanczos(-FIRST_SHIFT, None)?;
    let (mut room, mut change) = (1.0, f64::INFINITY);
    for _ in 0..MAX_SHIFTS {
        let lambda = best.beta * best.beta;
        if lambda <= NEARLY_ZERO {
            return pencil.polished(best.phi).map(|beta| (beta, pencil.solves));
        }
        // converged, and the last shift shows no eigenvalue below it
        if best.error <= TOLERANCE * lambda && !best.below {
            return Ok((best.beta, pencil.solves));
        }
        let gap = room * (2.0 * best.error).max(NEAREST * lambda);
        let shift = if gap < lambda { lambda - gap } else { -FIRST_SHIFT };
        let found = pencil.lanczos(shift, Some(&best.phi))?;
        // an eigenvalue below the shift: the next one must be farther away
        room = if found.below { 10.0 * room } else { 1.0 };
        change = (lambda - found.beta * found.beta).abs() / lambda;
        let keep = found.beta <= best.beta * (1.0 + TOLERANCE);
        best = if keep { found } else { Found { below: found.below, ..best } };
    }
    Err(InfSupError::NotSettled { iterations: pencil.solves, change })
}

/// The matrices, the factor of G_W and the saddle point pattern.
struct Pencil<'a> {
    grams: &'a Grams,
    of_trace: Ldlt,
    n: usize,
    m: usize,
    solves: usize,
}

impl<'a> Pencil<'a> {
    fn new(grams: &'a Grams) -> Result<Self, InfSupError> {
        let mut of_trace = Ldlt::new();
        let dependent = |space| {
            move |e| match e {
                LinearError::Memory => InfSupError::Linear(e),
                _ => InfSupError::Dependent { space },
            }
        };
        of_trace.prepare(&grams.trace).map_err(dependent("trace"))?;
        Ldlt::new().prepare(&grams.multiplier).map_err(dependent("multiplier"))?;
        Ok(Self { grams, of_trace, n: grams.trace.num_rows(), m: grams.multiplier.num_rows(), solves: 0 })
    }

    /// The saddle point matrix with `shift`.
    fn matrix(&self, shift: f64) -> Csr {
        let (n, g) = (self.n, self.grams);
        let mut all = Triplets::new(n + self.m, n + self.m);
        for i in 0..n {
            let (cols, vals) = g.trace.row(i);
            cols.zip(vals).for_each(|(j, &v)| all.push(i, j, v));
        }
        for i in 0..self.m {
            let (cols, vals) = g.mixed.row(i);
            for (j, &v) in cols.zip(vals) {
                all.push(n + i, j, v);
                all.push(j, n + i, v);
            }
            let (cols, vals) = g.multiplier.row(i);
            cols.zip(vals).for_each(|(j, &v)| all.push(n + i, n + j, shift * v));
        }
        all.to_csr()
    }

    fn factor(&self, shift: f64, matrix: &Csr) -> Result<Box<dyn LinearSolver>, InfSupError> {
        let mut solver: Box<dyn LinearSolver> = if shift < 0.0 { Box::new(Ldlt::new()) } else { Box::new(Lu::new()) };
        solver.prepare(matrix)?;
        Ok(solver)
    }

    /// Computes (B G_W⁻¹ Bᵀ - sigma G_M)⁻¹ G_M v, where `weighted` = G_M v.
    fn inverse(&mut self, solver: &dyn LinearSolver, matrix: &Csr, weighted: &[f64]) -> Result<Vec<f64>, InfSupError> {
        let mut right = vec![0.0; self.n + self.m];
        right[self.n..].iter_mut().zip(weighted).for_each(|(r, v)| *r = -v);
        let mut x = vec![0.0; self.n + self.m];
        solver.solve(matrix, &right, &mut x)?;
        self.solves += 1;
        Ok(x.split_off(self.n))
    }

    /// G_M v.
    fn weighted(&self, v: &[f64]) -> Vec<f64> {
        let mut y = vec![0.0; self.m];
        self.grams.multiplier.mul(v, &mut y);
        y
    }

    /// beta of a multiplier: |G_W⁻¹ Bᵀ phi|_W / |phi|_M.
    fn beta(&self, phi: &[f64]) -> Result<f64, InfSupError> {
        let mut right = vec![0.0; self.n];
        self.grams.mixed.add_transposed_mul(phi, &mut right);
        let mut w = vec![0.0; self.n];
        self.of_trace.solve(&self.grams.trace, &right, &mut w)?;
        let square = dot(&w, &right).max(0.0);
        Ok((square / dot(phi, &self.weighted(phi))).sqrt().min(1.0))
    }

    /// Lanczos with full orthogonalisation at one shift, from `start` and noise.
    fn lanczos(&mut self, shift: f64, start: Option<&[f64]>) -> Result<Found, InfSupError> {
        let matrix = self.matrix(shift);
        let solver = self.factor(shift, &matrix)?;
        let mut v = noise(self.m);
        if let Some(start) = start {
            // noise keeps components that an earlier vector has lost
            let (a, b) = (norm(&self.weighted(start), start), norm(&self.weighted(&v), &v));
            v.iter_mut().zip(start).for_each(|(v, s)| *v = s / a + 0.1 * *v / b);
        }
        let (mut vectors, mut weights): (Vec<Vec<f64>>, Vec<Vec<f64>>) = (Vec::new(), Vec::new());
        let (mut diagonal, mut beside): (Vec<f64>, Vec<f64>) = (Vec::new(), Vec::new());
        let mut size = norm(&self.weighted(&v), &v);
        let mut left = 0.0;
        while vectors.len() < STEPS.min(self.m) && size > 0.0 {
            v.iter_mut().for_each(|x| *x /= size);
            let weighted = self.weighted(&v);
            let mut next = self.inverse(&*solver, &matrix, &weighted)?;
            diagonal.push(dot(&next, &weighted));
            let before = norm(&self.weighted(&next), &next);
            vectors.push(v);
            weights.push(weighted);
            // two passes of Gram-Schmidt are enough
            for _ in 0..2 {
                for (u, gu) in vectors.iter().zip(&weights) {
                    let part = dot(&next, gu);
                    next.iter_mut().zip(u).for_each(|(x, u)| *x -= part * u);
                }
            }
            left = norm(&self.weighted(&next), &next);
            // an invariant subspace: the iteration ends
            size = if left > 1e-14 * before { left } else { 0.0 };
            left = size;
            beside.push(size);
            v = next;
        }
        let k = vectors.len();
        let mut small = DMatrix::zeros(k, k);
        for i in 0..k {
            small[(i, i)] = diagonal[i];
            if i + 1 < k {
                small[(i, i + 1)] = beside[i];
                small[(i + 1, i)] = beside[i];
            }
        }
        let eigen = small.symmetric_eigen();
        // eigenvalues nu = 1 / (lambda - shift): the largest is the nearest above the shift; negative ones lie below it, the
        // most negative nearest
        let values = &eigen.eigenvalues;
        let (least, most) =
            (0..k).fold((0, 0), |(l, m), i| (if values[i] < values[l] { i } else { l }, if values[i] > values[m] { i } else { m }));
        let below = values[least] < 0.0;
        let chosen = if below { least } else { most };
        let mut phi = vec![0.0; self.m];
        for (i, u) in vectors.iter().enumerate() {
            let part = eigen.eigenvectors[(i, chosen)];
            phi.iter_mut().zip(u).for_each(|(x, u)| *x += part * u);
        }
        let nu = eigen.eigenvalues[chosen];
        let residual = left * eigen.eigenvectors[(k - 1, chosen)].abs();
        Ok(Found { beta: self.beta(&phi)?, phi, error: residual / (nu * nu), below })
    }

    /// beta after some inverse iterations from `phi` at the first shift.
    fn polished(&mut self, mut phi: Vec<f64>) -> Result<f64, InfSupError> {
        let matrix = self.matrix(-FIRST_SHIFT);
        let solver = self.factor(-FIRST_SHIFT, &matrix)?;
        for _ in 0..POLISH {
            let weighted = self.weighted(&phi);
            phi = self.inverse(&*solver, &matrix, &weighted)?;
            let size = norm(&self.weighted(&phi), &phi);
            phi.iter_mut().for_each(|x| *x /= size);
        }
        self.beta(&phi)
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// |v|_M, given G_M v.
fn norm(weighted: &[f64], v: &[f64]) -> f64 {
    dot(weighted, v).max(0.0).sqrt()
}

/// Deterministic pseudo-random numbers in -1..1 (splitmix64).
fn noise(n: usize) -> Vec<f64> {
    let number = |k: usize| {
        let mut z = (k as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    };
    (0..n).map(number).collect()
}
