//! Residuals that do not depend on units, and numerical kernel vectors of a matrix.

use super::csr::largest;
use super::{Csr, Operator, Real, to_f64};

/// Largest relative residual accepted from a direct solve.
pub(crate) const RESIDUAL_LIMIT: f64 = 1e-10;
/// Bound of |A v| / (|A| |v|) below which v belongs to the kernel: 50 units of rounding.
pub(crate) const KERNEL: f64 = 1e-14;

/// Growth in one step of inverse iteration that a kernel vector with a share of 1e-5 in the trial vector exceeds: the kernel vector itself
/// grows by the reciprocal of [`KERNEL`] and of a row's number of entries.
pub(crate) const SAFE_GROWTH: f64 = 1e7;

/// r = b - A x and its size relative to |A| |x| + |b|; every row is measured by its largest entry.
///
/// Without a matrix, |A| |x| is taken as |A x| + |diag A| |x|.
pub(crate) fn residual<T: Real>(a: &dyn Operator<T>, scale: &[f64], b: &[T], x: &[T], r: &mut [T]) -> f64 {
    a.apply(x, r);
    let diagonal = if a.csr().is_none() { a.diagonal() } else { Vec::new() };
    let (mut top, mut bottom) = (0.0f64, 0.0f64);
    for i in 0..b.len() {
        let product = to_f64(r[i]);
        let size = match a.csr() {
            Some(matrix) => {
                let (cols, vals) = matrix.row(i);
                cols.zip(vals).map(|(j, &v)| (to_f64(v) * to_f64(x[j])).abs()).sum()
            }
            None => product.abs() + (to_f64(diagonal[i]) * to_f64(x[i])).abs(),
        };
        r[i] = b[i] - r[i];
        top = max(top, to_f64(r[i]).abs() * scale[i]);
        bottom = max(bottom, (size + to_f64(b[i]).abs()) * scale[i]);
    }
    relative(top, bottom)
}

/// Reciprocal of the largest entry of every row (of the diagonal, without a matrix); one for empty rows.
pub(crate) fn row_scale<T: Real>(a: &dyn Operator<T>) -> Vec<f64> {
    let largest: Vec<f64> = match a.csr() {
        Some(matrix) => (0..matrix.num_rows()).map(|i| to_f64(largest(matrix.row(i).1))).collect(),
        None => a.diagonal().iter().map(|&d| to_f64(d).abs()).collect(),
    };
    largest.iter().map(|&m| if m > 0.0 && m.is_finite() { 1.0 / m } else { 1.0 }).collect()
}

/// Larger of two numbers; NaN if either is NaN.
pub(crate) fn max(a: f64, b: f64) -> f64 {
    if b > a || b.is_nan() { b } else { a }
}

/// Size `top` of a residual relative to the size `bottom` of its terms; NaN if the terms overflow.
pub(crate) fn relative(top: f64, bottom: f64) -> f64 {
    if bottom.is_infinite() { f64::NAN } else { ratio(top, bottom) }
}

/// top / bottom with 0 / 0 = 0; NaN stays NaN.
pub(crate) fn ratio(top: f64, bottom: f64) -> f64 {
    if top == 0.0 { 0.0 } else { top / bottom }
}

/// A fixed sequence of numbers in (-0.5, 1.5), with a component in all translations and rotations.
pub(crate) fn trial_numbers(n: usize) -> Vec<f64> {
    let mut state = 0x9e37_79b9_7f4a_7c15_u64;
    (0..n)
        .map(|_| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1u64 << 53) as f64 * 2.0 - 0.5
        })
        .collect()
}

/// Softest vector of a matrix found by inverse iteration.
#[derive(Clone, Debug)]
pub(crate) struct Soft {
    pub vector: Vec<f64>,
    /// Growth of a vector of size one in the last step of inverse iteration.
    pub growth: f64,
}

/// Inverse iteration with a matrix M, scaled by |diagonal|, one solution at a time.
///
/// Rigid motions grow by the reciprocal of rounding errors in one step, all others by at most the condition.
#[derive(Debug)]
pub(crate) struct InverseIteration<'a> {
    diagonal: &'a [f64],
    vector: Vec<f64>,
    size: f64,
    growth: f64,
}

impl<'a> InverseIteration<'a> {
    pub(crate) fn begin(diagonal: &'a [f64]) -> Self {
        let mut vector = trial_numbers(diagonal.len());
        let size = vector.iter().map(|x| x * x).sum::<f64>().sqrt();
        vector.iter_mut().zip(diagonal).for_each(|(x, &d)| *x *= weight(d).sqrt());
        Self { diagonal, vector, size, growth: 0.0 }
    }

    /// The right-hand side of the next step, to be replaced by the solution.
    pub(crate) fn right_side(&mut self) -> &mut [f64] {
        if self.growth > 0.0 {
            self.vector.iter_mut().zip(self.diagonal).for_each(|(x, &d)| *x *= weight(d));
        }
        &mut self.vector
    }

    /// Ends a step; `None` if the solution overflowed.
    pub(crate) fn solved(&mut self) -> Option<()> {
        let norm = self.vector.iter().zip(self.diagonal).map(|(x, &d)| x * x * weight(d)).sum::<f64>().sqrt();
        if !norm.is_finite() || norm == 0.0 {
            return None;
        }
        self.growth = norm / self.size;
        self.size = 1.0;
        self.vector.iter_mut().for_each(|x| *x /= norm);
        Some(())
    }

    pub(crate) fn end(self) -> Soft {
        Soft { vector: self.vector, growth: self.growth }
    }
}

fn weight(diagonal: f64) -> f64 {
    if diagonal > 0.0 { diagonal } else { 1.0 }
}

/// Runs `steps` steps of inverse iteration with M; `None` if `solve` overflows.
pub(crate) fn softest(diagonal: &[f64], steps: usize, mut solve: impl FnMut(&mut [f64])) -> Option<Soft> {
    let mut iteration = InverseIteration::begin(diagonal);
    for _ in 0..steps {
        solve(iteration.right_side());
        iteration.solved()?;
    }
    Some(iteration.end())
}

/// Condition of D^-1/2 A D^-1/2, D = |diagonal|: its largest absolute row sum over its Rayleigh quotient at the soft vector v.
pub(crate) fn scaled_condition(a: &Csr<f64>, diagonal: &[f64], v: &[f64]) -> f64 {
    let n = a.num_rows();
    let weight: Vec<f64> = diagonal.iter().map(|&d| weight(d)).collect();
    let root: Vec<f64> = weight.iter().map(|w| 1.0 / w.sqrt()).collect();
    let (mut largest, mut energy, mut size) = (0.0, 0.0, 0.0);
    for i in 0..n {
        let (cols, vals) = a.row(i);
        let (mut sum, mut product) = (0.0, 0.0);
        for (j, &x) in cols.zip(vals) {
            sum += x.abs() * root[j];
            product += x * v[j];
        }
        largest = max(largest, sum * root[i]);
        energy += v[i] * product;
        size += weight[i] * v[i] * v[i];
    }
    largest * size / energy.abs()
}

/// Size of A v relative to |A| |v|, with rows scaled by `scale`: rounding level for a kernel vector.
pub(crate) fn kernel_ratio(a: &Csr<f64>, scale: &[f64], v: &[f64]) -> f64 {
    let (mut top, mut bottom) = (0.0f64, 0.0f64);
    for i in 0..a.num_rows() {
        let (cols, vals) = a.row(i);
        let (mut sum, mut size) = (0.0, 0.0);
        for (j, &x) in cols.zip(vals) {
            sum += x * v[j];
            size += (x * v[j]).abs();
        }
        top = max(top, (sum * scale[i]).abs());
        bottom = max(bottom, size * scale[i]);
    }
    ratio(top, bottom)
}
