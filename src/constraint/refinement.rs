//! Iterative refinement of a constrained solution on its true residual, by a factor or by an iterative method.
//!
//! ```text
//! r1 = f - K u - Bᵀ l,   r2 = -g - C u + s l   in the scaled rows of super::scale, summed in twice the working precision
//! ```

use super::scale::Scaled;
use crate::linalg::double_double::residual_rows;
use crate::linalg::residual::{RESIDUAL_LIMIT, max, ratio, relative};
use crate::linalg::{Limits, LinearError};

/// Corrections of an iterative method: each gains several digits.
const MAX_CORRECTIONS: usize = 20;

/// Gaps below this part of the largest unknown, or of the largest force over its stiffness, all in scaled rows, are rounding.
const ROUNDING: f64 = 16.0 * f64::EPSILON;

/// A solution and its residuals.
#[derive(Debug)]
pub(super) struct Refinement<'a, 'b> {
    system: &'a Scaled<'b>,
    /// Measures rows of r1: the reciprocal of a diagonal. Rows of r2 are measured by 1 / k_i.
    scale: &'a [f64],
    u: Vec<f64>,
    l: Vec<f64>,
    pub r1: Vec<f64>,
    /// Zero on open rows.
    pub r2: Vec<f64>,
    /// Size of the residual relative to its terms.
    pub size: f64,
    /// Corrections so far.
    count: usize,
    /// Relative size of the last one; infinite up to the first.
    step: f64,
}

impl<'a, 'b> Refinement<'a, 'b> {
    /// Initial guess zero; the residuals are the load and -g on enforced rows.
    pub fn begin(system: &'a Scaled<'b>, scale: &'a [f64]) -> Self {
        let (n, m) = (system.num_unknowns(), system.num_rows());
        let r1 = system.load.to_vec();
        let r2: Vec<f64> = (0..m).map(|a| if system.enforced[a] { -system.offset[a] } else { 0.0 }).collect();
        let size = if r1.iter().chain(&r2).any(|&r| r != 0.0) { 1.0 } else { 0.0 };
        Self { system, scale, u: vec![0.0; n], l: vec![0.0; m], r1, r2, size, count: 0, step: f64::INFINITY }
    }

    /// Adds a correction by the factor, unless corrections stall at rounding level; returns whether another may gain digits.
    pub fn improve(&mut self, du: &[f64], dl: &[f64]) -> bool {
        let first = self.count == 0;
        let next = self.share(du, dl);
        if !first && (next.is_nan() || (next > 0.5 * self.step && self.size <= RESIDUAL_LIMIT)) {
            return false;
        }
        self.add(du, dl);
        // corrections shrink at a steady rate: the next one would be lost in rounding
        let lost = !first && self.size <= RESIDUAL_LIMIT && next * ratio(next, self.step.min(1.0)) <= f64::EPSILON;
        self.step = if first { f64::INFINITY } else { next };
        self.count += 1;
        self.size > 0.0 && !lost
    }

    /// u += du, l += dl, and updates the residuals.
    fn add(&mut self, du: &[f64], dl: &[f64]) {
        self.u.iter_mut().zip(du).for_each(|(u, du)| *u += du);
        self.l.iter_mut().zip(dl).for_each(|(l, dl)| *l += dl);
        self.size = self.system.residual(self.scale, &self.u, &self.l, &mut self.r1, &mut self.r2);
    }

    /// Size of a correction relative to the solution. The scaled multipliers are lengths like u; each part is measured by itself.
    fn share(&self, du: &[f64], dl: &[f64]) -> f64 {
        let largest = |x: &[f64]| x.iter().fold(0.0, |m, &v| max(m, v.abs()));
        max(ratio(largest(du), largest(&self.u)), ratio(largest(dl), largest(&self.l)))
    }

    /// (u, l, residual).
    pub fn end(self) -> (Vec<f64>, Vec<f64>, f64) {
        (self.u, self.l, self.size)
    }

    /// Further corrections by the factor until they stall: (du, dl) = `correct`(r1, r2). Returns (u, l, residual).
    pub fn finished(
        mut self,
        max_steps: usize,
        mut correct: impl FnMut(&[f64], &[f64]) -> Result<(Vec<f64>, Vec<f64>), LinearError>,
    ) -> Result<(Vec<f64>, Vec<f64>, f64), LinearError> {
        while self.count <= max_steps {
            let (du, dl) = correct(&self.r1, &self.r2)?;
            if !self.improve(&du, &dl) {
                break;
            }
        }
        Ok(self.end())
    }
}

impl Scaled<'_> {
    /// Residuals r1 and r2 (zero on open rows), and their size relative to their terms.
    ///
    /// Rows of r1 are measured by `scale` (the reciprocal of a diagonal), rows of r2 by 1 / k_i.
    pub(super) fn residual(&self, scale: &[f64], u: &[f64], l: &[f64], r1: &mut [f64], r2: &mut [f64]) -> f64 {
        let [top1, bottom1] = residual_rows(self.stiffness, u, r1, &|i, mut sum| {
            sum.add(self.load[i]);
            let (rows, vals) = self.columns.row(i);
            for (a, &v) in rows.zip(vals).filter(|(a, _)| self.enforced[*a]) {
                sum.add_product(-v, l[a]);
            }
            (sum.value(), [sum.value().abs() * scale[i], sum.size * scale[i]])
        });
        let [top2, bottom2] = residual_rows(&self.rows, u, r2, &|a, mut sum| {
            if !self.enforced[a] {
                return (0.0, [0.0; 2]);
            }
            sum.add(-self.offset[a]);
            sum.add_product(self.compliance[a], l[a]);
            (sum.value(), [sum.value().abs() / self.k[a], sum.size / self.k[a]])
        });
        // rows that fix their unknowns at zero have terms of rounding size only: rounding of the unknowns or of K⁻¹ f is no residual
        let unknown = u.iter().fold(bottom1, |m, &v| max(m, v.abs()));
        let second = if top2 <= ROUNDING * unknown { 0.0 } else { relative(top2, bottom2) };
        max(relative(top1, bottom1), second)
    }

    /// Adds corrections until they stall: u += du, l += dl with (du, dl) = `correct`(r1, r2). Returns (u, l, residual).
    pub(super) fn refined(
        &self,
        scale: &[f64],
        max_steps: usize,
        correct: impl FnMut(&[f64], &[f64]) -> Result<(Vec<f64>, Vec<f64>), LinearError>,
    ) -> Result<(Vec<f64>, Vec<f64>, f64), LinearError> {
        let state = Refinement::begin(self, scale);
        if state.size == 0.0 { Ok(state.end()) } else { state.finished(max_steps, correct) }
    }

    /// Adds corrections of an iterative method until error and residual are below the tolerance: u += du, l += dl with
    /// (du, dl, iterations) = `correct`(r1, r2, its own limits). Returns (u, l, residual, iterations).
    ///
    /// Every correction is solved to the residual `inner` (or the tolerance, if larger); the next one starts from the true residual, which
    /// decides convergence. The remaining error is estimated from the last two corrections.
    ///
    /// # Errors
    /// [`LinearError::NotConverged`] with the tolerance of `limits` and the true residual, and those of `correct`.
    pub(super) fn iterated(
        &self,
        scale: &[f64],
        limits: &Limits,
        inner: f64,
        mut correct: impl FnMut(&[f64], &[f64], &Limits) -> Result<(Vec<f64>, Vec<f64>, usize), LinearError>,
    ) -> Result<(Vec<f64>, Vec<f64>, f64, usize), LinearError> {
        let mut state = Refinement::begin(self, scale);
        let goal = limits.tolerance.max(f64::EPSILON);
        let most = limits.most((10 * (state.u.len() + state.l.len())).max(100));
        let stopped = |done: usize, residual: f64| LinearError::NotConverged { iterations: done, residual, tolerance: limits.tolerance };
        let (mut done, mut before) = (0, f64::INFINITY);
        for round in 0..MAX_CORRECTIONS {
            let size = state.size;
            if size == 0.0 {
                break;
            }
            if size.is_nan() {
                return Err(LinearError::NotFinite);
            }
            if done >= most {
                return Err(stopped(done, size));
            }
            let own = Limits { tolerance: inner.max(limits.tolerance), max_iterations: most - done, stop: limits.stop.clone() };
            let (du, dl, iterations) = correct(&state.r1, &state.r2, &own).map_err(|error| match error {
                LinearError::NotConverged { iterations, residual, .. } => stopped(done + iterations, residual * size),
                LinearError::Stopped { iterations } => LinearError::Stopped { iterations: done + iterations },
                other => other,
            })?;
            done += iterations;
            state.add(&du, &dl);
            let step = state.share(&du, &dl);
            let rate = if round > 0 { ratio(step, before) } else { 1.0 };
            before = step;
            if state.size <= goal && (step <= goal || step * rate <= goal || rate > 0.5 && round > 0) {
                break;
            }
            if rate > 0.5 && round > 0 {
                // stalled by rounding
                break;
            }
        }
        let Refinement { u, l, size, .. } = state;
        if size.is_nan() || size > RESIDUAL_LIMIT.max(goal) {
            return Err(stopped(done, size));
        }
        Ok((u, l, size, done))
    }
}
