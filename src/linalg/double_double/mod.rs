//! Products with a matrix in twice the working precision, row by row.
//!
//! Source: Ogita, Rump, Oishi, SIAM J. Sci. Comput. 26 (2005) 1955-1988.

mod sum;

use super::Csr;
use super::residual::max;
use crate::parallel;
use pulp::{Arch, Simd, WithSimd};
use sum::{SUMS, dot};

pub(crate) use sum::Sum;

/// Groups of rows whose values of the vector are gathered at once: a wide load has to wait for narrow stores just made.
const TOGETHER: usize = 32;
/// Groups of rows that a thread takes at once.
const SHARE: usize = 64 * TOGETHER;

/// Computes `r[i]` and two measures by `row(i, sum)` for every row i, with `sum` = -(A x)_i; returns the largest of each measure.
///
/// Rows are summed independently: the result does not depend on the number of threads. Many rows are shared among the threads of the
/// pool, so a caller must not hold a lock that other tasks of the pool wait for.
///
/// # Panics
/// If the lengths do not fit.
pub(crate) fn residual_rows(a: &Csr<f64>, x: &[f64], r: &mut [f64], row: &(impl Fn(usize, Sum) -> (f64, [f64; 2]) + Sync)) -> [f64; 2] {
    rows_with(Arch::new(), a, x, r, row)
}

fn rows_with(arch: Arch, a: &Csr<f64>, x: &[f64], r: &mut [f64], row: &(impl Fn(usize, Sum) -> (f64, [f64; 2]) + Sync)) -> [f64; 2] {
    assert_eq!((r.len(), x.len()), (a.num_rows(), a.num_cols()), "rows and columns of the matrix");
    let share = SHARE * a.pattern().block();
    let part = |(k, r): (usize, &mut [f64])| arch.dispatch(Rows { a, x, first: SHARE * k, r, row });
    let larger = |a: [f64; 2], b: [f64; 2]| [max(a[0], b[0]), max(a[1], b[1])];
    // few rows are not worth a hand-over to another thread
    if r.len() <= share || rayon::current_num_threads() == 1 {
        return r.chunks_mut(share).enumerate().map(part).fold([0.0; 2], larger);
    }
    parallel::map_each(r.chunks_mut(share).enumerate(), part).into_iter().fold([0.0; 2], larger)
}

/// The rows of `r`, groups from `first` on.
struct Rows<'a, F> {
    a: &'a Csr<f64>,
    x: &'a [f64],
    first: usize,
    r: &'a mut [f64],
    row: &'a F,
}

impl<F: Fn(usize, Sum) -> (f64, [f64; 2])> WithSimd for Rows<'_, F> {
    type Output = [f64; 2];

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> [f64; 2] {
        match S::F64_LANES {
            8 => self.in_vectors::<S, 1>(simd),
            4 => self.in_vectors::<S, 2>(simd),
            2 => self.in_vectors::<S, 4>(simd),
            _ => self.in_vectors::<S, SUMS>(simd),
        }
    }
}

impl<F: Fn(usize, Sum) -> (f64, [f64; 2])> Rows<'_, F> {
    #[inline(always)]
    fn in_vectors<S: Simd, const V: usize>(self, simd: S) -> [f64; 2] {
        match self.a.pattern().block() {
            1 => self.in_blocks::<S, V, 1>(simd),
            2 => self.in_blocks::<S, V, 2>(simd),
            3 => self.in_blocks::<S, V, 3>(simd),
            _ => self.in_blocks::<S, V, 0>(simd),
        }
    }

    /// Blocks of B, of any size where B = 0.
    #[inline(always)]
    fn in_blocks<S: Simd, const V: usize, const B: usize>(self, simd: S) -> [f64; 2] {
        let Self { a, x, first, r, row } = self;
        let (ptr, vals, block) = (a.pattern().ptr(), a.vals(), if B == 0 { a.pattern().block() } else { B });
        let (mut gathered, mut most) = (Vec::<f64>::new(), [0.0; 2]);
        for (k, r) in r.chunks_mut(TOGETHER * block).enumerate() {
            let first = first + TOGETHER * k;
            let columns = a.pattern().groups(first..first + r.len() / block);
            if gathered.len() < block * columns.len() {
                gathered.resize(block * columns.len(), 0.0);
            }
            for (to, &j) in gathered.chunks_exact_mut(block).zip(columns) {
                to.copy_from_slice(&x[block * j as usize..][..block]);
            }
            for (i, r) in (first..).zip(r.chunks_exact_mut(block)) {
                let width = block * (ptr[i + 1] - ptr[i]);
                let x = &gathered[block * (ptr[i] - ptr[first])..][..width];
                let own = &vals[block * block * ptr[i]..][..block * width];
                for l in 0..block {
                    let Sum { high, low, size } = dot::<S, V>(simd, &own[l * width..][..width], x);
                    let (value, measures) = row(block * i + l, Sum { high: -high, low: -low, size });
                    r[l] = value;
                    most = [max(most[0], measures[0]), max(most[1], measures[1])];
                }
            }
        }
        most
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::residual::trial_numbers;
    use crate::linalg::{Sparsity, Triplets};
    use std::sync::Arc;

    /// A matrix in blocks with rows of all lengths up to `longest` blocks, some empty.
    fn matrix(block: usize, groups: usize, longest: usize) -> Csr {
        let (mut ptr, mut cols) = (vec![0], Vec::new());
        for i in 0..groups {
            let mut own: Vec<u32> = (0..i * 7 % (longest + 1)).map(|k| ((i + 11 * k) % groups) as u32).collect();
            own.sort_unstable();
            own.dedup();
            cols.extend(own);
            ptr.push(cols.len());
        }
        let pattern = Sparsity::new(block, groups, ptr, cols);
        let mut vals = trial_numbers(pattern.num_entries());
        // terms that cancel: sizes over twelve powers of ten
        vals.iter_mut().enumerate().for_each(|(k, v)| *v *= 10.0f64.powi((k * 31 % 13) as i32 - 6));
        Csr::with_values(Arc::new(pattern), vals)
    }

    fn rows(arch: Arch, a: &Csr, x: &[f64], b: &[f64]) -> (Vec<u64>, [u64; 2]) {
        let mut r = vec![0.0; b.len()];
        let most = rows_with(arch, a, x, &mut r, &|i, mut sum| {
            sum.add(b[i]);
            (sum.value(), [sum.value().abs(), sum.size])
        });
        (r.iter().map(|r| r.to_bits()).collect(), most.map(f64::to_bits))
    }

    #[test]
    fn rows_are_those_of_sums_term_by_term() {
        for block in [1, 2, 3, 4] {
            let a = matrix(block, 150, 40);
            let (x, b) = (trial_numbers(a.num_rows()), trial_numbers(2 * a.num_rows())[a.num_rows()..].to_vec());
            let (r, most) = rows(Arch::new(), &a, &x, &b);
            let (mut top, mut bottom) = (0.0f64, 0.0f64);
            for i in 0..a.num_rows() {
                let mut sum = Sum::default();
                sum.add(b[i]);
                let (cols, vals) = a.row(i);
                cols.zip(vals).for_each(|(j, &v)| sum.add_product(-v, x[j]));
                let found = f64::from_bits(r[i]);
                // both are exact but for 2^-106 of the sizes and the last rounding
                let bound = f64::EPSILON * sum.value().abs() + 1e-29 * sum.size;
                assert!((found - sum.value()).abs() <= bound, "row {i}: {found:e} {:e}", sum.value());
                top = top.max(found.abs());
                bottom = bottom.max(sum.size);
            }
            let [found_top, found_bottom] = most.map(f64::from_bits);
            assert_eq!(found_top, top);
            assert!((found_bottom - bottom).abs() < 1e-13 * bottom);
        }
    }

    #[test]
    fn rows_have_the_same_bits_with_any_lanes_and_any_number_of_threads() {
        for block in [1, 2, 3, 4] {
            let a = matrix(block, 3 * SHARE + 100, 23);
            let (x, b) = (trial_numbers(a.num_rows()), vec![0.25; a.num_rows()]);
            let known = rows(Arch::Scalar, &a, &x, &b);
            let pool = |threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
            for threads in [1, 2, 3] {
                assert!(pool(threads).install(|| rows(Arch::new(), &a, &x, &b)) == known, "{threads} threads");
            }
            #[cfg(target_arch = "x86_64")]
            {
                use pulp::x86::{V3, V4};
                if let Some(v3) = V3::try_new() {
                    assert!(rows(Arch::V3(v3), &a, &x, &b) == known, "AVX2");
                }
                if let Some(v4) = V4::try_new() {
                    assert!(rows(Arch::V4(v4), &a, &x, &b) == known, "AVX-512");
                }
            }
        }
    }

    #[test]
    fn a_rectangle_and_numbers_that_are_none() {
        let mut all = Triplets::new(3, 5);
        all.push(0, 4, 2.0);
        all.push(2, 0, 1.0);
        let a = all.to_csr();
        let (r, _) = rows(Arch::new(), &a, &[3.0, 0.0, 0.0, 0.0, 5.0], &[1.0, 1.0, 1.0]);
        assert_eq!(r.into_iter().map(f64::from_bits).collect::<Vec<_>>(), [-9.0, 1.0, -2.0]);
        let (_, most) = rows(Arch::new(), &a, &[f64::NAN, 0.0, 0.0, 0.0, 5.0], &[1.0, 1.0, 1.0]);
        assert!(most.map(f64::from_bits).iter().all(|m| m.is_nan()));
    }

    #[test]
    fn what_is_no_number_in_one_row_is_none_of_all() {
        // a column of its own for the first row, numbers for all that follow it
        let n = 3 * SHARE;
        let mut all = Triplets::new(n, n + 1);
        (0..n).for_each(|i| all.push(i, if i == 0 { n } else { i }, 1.0));
        let (a, b) = (all.to_csr(), vec![1.0; n]);
        for odd in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let mut x = vec![2.0; n + 1];
            x[n] = odd;
            for threads in [1, 3] {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
                let [top, bottom] = pool.install(|| rows(Arch::new(), &a, &x, &b)).1.map(f64::from_bits);
                assert!(!top.is_finite() && !bottom.is_finite(), "{odd} on {threads} threads: {top} {bottom}");
            }
        }
    }
}
