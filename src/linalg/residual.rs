//! Residuals that do not depend on units, and vectors that a matrix maps to rounding errors.

use super::csr::largest;
use super::{Csr, Operator, Real, to_f64};

/// A direct solve with a larger relative residual than this is an error.
pub(crate) const RESIDUAL_LIMIT: f64 = 1e-10;
/// A vector v with |A v| below this part of |A| |v| belongs to the kernel: 50 units of rounding.
pub(crate) const KERNEL: f64 = 1e-14;

/// A vector of the kernel with a share of 1e-5 in the trial vector grows more than this in one step of inverse iteration: its own factor
/// is the reciprocal of [`KERNEL`] and of a row's number of entries.
pub(crate) const SAFE_GROWTH: f64 = 1e7;

/// r = b - A x and its size relative to |A| |x| + |b|; every row is measured by its largest entry.
///
/// Where the operator has no matrix, |A| |x| is taken as |A x| + |diag A| |x|.
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
    ratio(top, bottom)
}

/// A sum of products in twice the working precision (Ogita, Rump, Oishi, SIAM J. Sci. Comput. 26 (2005) 1955-1988).
///
/// Refinement with such residuals makes the solution itself accurate, not only its residual: two methods then agree
/// on bodies of very different stiffness.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Sum {
    high: f64,
    low: f64,
    /// Sum of the sizes of all terms.
    pub size: f64,
}

impl Sum {
    #[inline]
    pub(crate) fn add(&mut self, x: f64) {
        let sum = self.high + x;
        let part = sum - self.high;
        self.low += (self.high - (sum - part)) + (x - part);
        self.high = sum;
        self.size += x.abs();
    }

    #[inline]
    pub(crate) fn add_product(&mut self, a: f64, b: f64) {
        let product = a * b;
        // Veltkamp's halves: without the instruction, a fused multiply-add is a library call
        let (a1, a2) = halves(a);
        let (b1, b2) = halves(b);
        self.low += a2 * b2 - (((product - a1 * b1) - a2 * b1) - a1 * b2);
        self.add(product);
    }

    #[inline]
    pub(crate) fn value(&self) -> f64 {
        self.high + self.low
    }
}

#[inline]
fn halves(a: f64) -> (f64, f64) {
    let c = 134_217_729.0 * a; // 2^27 + 1
    let high = c - (c - a);
    (high, a - high)
}

/// Reciprocal of the largest entry of every row (of the diagonal, where there is no matrix); one for empty rows.
pub(crate) fn row_scale<T: Real>(a: &dyn Operator<T>) -> Vec<f64> {
    let largest: Vec<f64> = match a.csr() {
        Some(matrix) => (0..matrix.num_rows()).map(|i| to_f64(largest(matrix.row(i).1))).collect(),
        None => a.diagonal().iter().map(|&d| to_f64(d).abs()).collect(),
    };
    largest.iter().map(|&m| if m > 0.0 && m.is_finite() { 1.0 / m } else { 1.0 }).collect()
}

/// The larger of two numbers; not a number if one is not.
pub(crate) fn max(a: f64, b: f64) -> f64 {
    if b > a || b.is_nan() { b } else { a }
}

/// top / bottom with 0 / 0 = 0; not a number stays one.
pub(crate) fn ratio(top: f64, bottom: f64) -> f64 {
    if top == 0.0 { 0.0 } else { top / bottom }
}

/// A fixed sequence of numbers in (-0.5, 1.5): all translations and rotations have a part in it.
pub(crate) fn trial_numbers(n: usize) -> Vec<f64> {
    let mut state = 0x9e37_79b9_7f4a_7c15_u64;
    (0..n)
        .map(|_| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1u64 << 53) as f64 * 2.0 - 0.5
        })
        .collect()
}

/// A vector that a matrix maps to little.
#[derive(Clone, Debug)]
pub(crate) struct Soft {
    pub vector: Vec<f64>,
    /// How much the last step of inverse iteration made of a vector of size one.
    pub growth: f64,
}

/// Steps of inverse iteration with M, scaled by |diagonal|; `None` if `solve` overflows.
///
/// Rigid motions grow by the reciprocal of rounding errors in one step, all else by at most the condition.
pub(crate) fn softest(diagonal: &[f64], steps: usize, mut solve: impl FnMut(&mut [f64])) -> Option<Soft> {
    let weight = |i: usize| if diagonal[i] > 0.0 { diagonal[i] } else { 1.0 };
    let mut v = trial_numbers(diagonal.len());
    let mut size = v.iter().map(|x| x * x).sum::<f64>().sqrt();
    v.iter_mut().enumerate().for_each(|(i, x)| *x *= weight(i).sqrt());
    let mut growth = 0.0;
    for step in 0..steps {
        if step > 0 {
            for i in 0..v.len() {
                v[i] *= weight(i);
            }
        }
        solve(&mut v);
        let norm = (0..v.len()).map(|i| v[i] * v[i] * weight(i)).sum::<f64>().sqrt();
        if !norm.is_finite() || norm == 0.0 {
            return None;
        }
        growth = norm / size;
        size = 1.0;
        for x in &mut v {
            *x /= norm;
        }
    }
    Some(Soft { vector: v, growth })
}

/// Condition of D^-1/2 A D^-1/2, D = |diagonal|: the largest row sum of its sizes over its Rayleigh quotient at the soft vector v.
pub(crate) fn scaled_condition(a: &Csr<f64>, diagonal: &[f64], v: &[f64]) -> f64 {
    let n = a.num_rows();
    let weight: Vec<f64> = diagonal.iter().map(|&d| if d > 0.0 { d } else { 1.0 }).collect();
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

/// Size of A v relative to |A| |v|, rows measured by `scale`: at rounding for a vector of the kernel.
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
