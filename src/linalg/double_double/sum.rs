//! Sums of products in twice the working precision: term by term, and in lanes.
//!
//! The rounding error of a product is computed by a fused multiply-add in SIMD lanes, and by Veltkamp splitting term by term or if the
//! processor has none: the same number, as long as nothing overflows or underflows.

use pulp::Simd;

/// Partial sums of a row, the same number for all SIMD widths, so that all instruction sets give the same bits.
pub(super) const SUMS: usize = 8;
/// Splits a number in two of 26 bits: 2^27 + 1.
const SPLIT: f64 = 134_217_729.0;

/// A sum of products in twice the working precision.
///
/// Refinement with such residuals makes the solution itself accurate, not only its residual: two methods then agree
/// on bodies of very different stiffness.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Sum {
    pub(super) high: f64,
    pub(super) low: f64,
    /// Sum of the magnitudes of all terms.
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
        self.low += cut_off(a, b, product);
        self.add(product);
    }

    #[inline]
    pub(crate) fn value(&self) -> f64 {
        self.high + self.low
    }
}

/// a b - `product` without the instruction for it, which would be a library call.
#[inline(always)]
fn cut_off(a: f64, b: f64, product: f64) -> f64 {
    let halves = |a: f64| {
        let c = SPLIT * a;
        let high = c - (c - a);
        [high, a - high]
    };
    let ([a1, a2], [b1, b2]) = (halves(a), halves(b));
    a2 * b2 - (((product - a1 * b1) - a2 * b1) - a1 * b2)
}

/// Partial sums in V vectors.
struct Partial<S: Simd, const V: usize> {
    high: [S::f64s; V],
    low: [S::f64s; V],
    size: [S::f64s; V],
}

impl<S: Simd, const V: usize> Partial<S, V> {
    #[inline(always)]
    fn add_product(&mut self, simd: S, a: [S::f64s; V], b: [S::f64s; V]) {
        for k in 0..V {
            let (before, product) = (self.high[k], simd.mul_f64s(a[k], b[k]));
            let sum = simd.add_f64s(before, product);
            let part = simd.sub_f64s(sum, before);
            let lost = simd.add_f64s(simd.sub_f64s(before, simd.sub_f64s(sum, part)), simd.sub_f64s(product, part));
            let lost = simd.add_f64s(vector_cut_off(simd, a[k], b[k], product), lost);
            self.low[k] = simd.add_f64s(self.low[k], lost);
            self.high[k] = sum;
            self.size[k] = simd.add_f64s(self.size[k], simd.abs_f64s(product));
        }
    }
}

/// [`cut_off`] in lanes.
#[inline(always)]
fn vector_cut_off<S: Simd>(simd: S, a: S::f64s, b: S::f64s, product: S::f64s) -> S::f64s {
    if !S::IS_SCALAR {
        return simd.mul_add_f64s(a, b, simd.neg_f64s(product));
    }
    let split = simd.splat_f64s(SPLIT);
    let halves = |a: S::f64s| {
        let c = simd.mul_f64s(split, a);
        let high = simd.sub_f64s(c, simd.sub_f64s(c, a));
        [high, simd.sub_f64s(a, high)]
    };
    let ([a1, a2], [b1, b2]) = (halves(a), halves(b));
    let rest = simd.sub_f64s(simd.sub_f64s(product, simd.mul_f64s(a1, b1)), simd.mul_f64s(a2, b1));
    simd.sub_f64s(simd.mul_f64s(a2, b2), simd.sub_f64s(rest, simd.mul_f64s(a1, b2)))
}

/// The sum of all a x.
#[inline(always)]
pub(super) fn dot<S: Simd, const V: usize>(simd: S, a: &[f64], x: &[f64]) -> Sum {
    let zero = simd.splat_f64s(0.0);
    let mut sums = Partial::<S, V> { high: [zero; V], low: [zero; V], size: [zero; V] };
    let ((a, a_rest), (x, x_rest)) = (a.as_chunks::<SUMS>(), x.as_chunks::<SUMS>());
    let whole = |part: &[f64; SUMS]| -> [S::f64s; V] {
        let lanes = S::as_simd_f64s(part).0;
        std::array::from_fn(|k| lanes[k])
    };
    for (a, x) in a.iter().zip(x) {
        sums.add_product(simd, whole(a), whole(x));
    }
    if !a_rest.is_empty() {
        let part = |rest: &[f64]| -> [S::f64s; V] {
            let mut rest = rest.chunks(S::F64_LANES);
            std::array::from_fn(|_| simd.partial_load_f64s(rest.next().unwrap_or(&[])))
        };
        sums.add_product(simd, part(a_rest), part(x_rest));
    }
    let out = |lanes: [S::f64s; V]| {
        let mut numbers = [0.0; SUMS];
        S::as_mut_simd_f64s(&mut numbers).0.copy_from_slice(&lanes);
        numbers
    };
    let [[high], [low], [size]] = half::<2, 1>(half::<4, 2>(half::<SUMS, 4>([out(sums.high), out(sums.low), out(sums.size)])));
    Sum { high, low, size }
}

/// The second half of partial sums (high, low, size) added to the first.
#[inline(always)]
fn half<const FROM: usize, const TO: usize>([high, low, size]: [[f64; FROM]; 3]) -> [[f64; TO]; 3] {
    let [mut sums, mut lost, mut sizes] = [[0.0; TO]; 3];
    for k in 0..TO {
        let (a, b) = (high[k], high[k + TO]);
        sums[k] = a + b;
        let part = sums[k] - a;
        lost[k] = (low[k] + low[k + TO]) + ((a - (sums[k] - part)) + (b - part));
        sizes[k] = size[k] + size[k + TO];
    }
    [sums, lost, sizes]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::residual::trial_numbers;
    use pulp::{Arch, WithSimd};

    /// What rounding cuts off by the fused multiply-add of the processor, if it has one.
    fn fused(a: f64, b: f64) -> Option<f64> {
        struct Fused([f64; 2]);
        impl WithSimd for Fused {
            type Output = Option<f64>;
            #[inline(always)]
            fn with_simd<S: Simd>(self, simd: S) -> Option<f64> {
                let [a, b] = self.0.map(|v| simd.splat_f64s(v));
                let mut out = [0.0; SUMS];
                S::as_mut_simd_f64s(&mut out).0[0] = vector_cut_off(simd, a, b, simd.mul_f64s(a, b));
                (!S::IS_SCALAR).then_some(out[0])
            }
        }
        Arch::new().dispatch(Fused([a, b]))
    }

    #[test]
    fn one_fused_product_cuts_off_what_halves_do() {
        let numbers = trial_numbers(2000);
        let mut seen = 0;
        for (k, pair) in numbers.windows(2).enumerate() {
            // sizes from 2^-480 to 2^480: products and their parts of 2^-53 neither overflow nor underflow
            let power = |k: usize| 2.0f64.powi((k * 7919 % 961) as i32 - 480);
            let (a, b) = (pair[0] * power(k), pair[1] * power(31 * k + 5));
            let halves = cut_off(a, b, a * b);
            // the part lost is below half a unit of the last place
            assert!(halves.abs() <= 0.5 * f64::EPSILON * (a * b).abs(), "{a:e} {b:e}: {halves:e}");
            seen += usize::from(halves != 0.0);
            if let Some(fused) = fused(a, b) {
                assert_eq!(fused.to_bits(), halves.to_bits(), "{a:e} {b:e}");
            }
        }
        assert!(seen > 1900, "random products are rounded: {seen}");
        let extreme =
            [0.0, 1.0, -1.0, 1.0 + f64::EPSILON, 2.0 - f64::EPSILON, 1.0 / 3.0, 1e150, -3e151, 1e-120, -7e-121, SPLIT, 94_906_265.625];
        for a in extreme {
            for b in extreme {
                if let Some(fused) = fused(a, b) {
                    assert_eq!(fused, cut_off(a, b, a * b), "{a:e} {b:e}");
                }
            }
        }
        // (1 + e)^2 = 1 + 2 e + e^2
        assert_eq!(cut_off(1.0 + f64::EPSILON, 1.0 + f64::EPSILON, 1.0 + 2.0 * f64::EPSILON), f64::EPSILON * f64::EPSILON);
    }

    #[test]
    fn beyond_the_range_of_halves_a_fused_product_still_is_exact() {
        // 2^27 a overflows, the product does not
        let (a, b) = (1.7e308, 1.0 + f64::EPSILON);
        assert!(cut_off(a, b, a * b).is_nan());
        if let Some(fused) = fused(a, b) {
            let unit = a * f64::EPSILON;
            assert!(fused.is_finite() && fused.abs() <= unit, "{fused:e}");
            assert_eq!((a * b - a) + fused, unit, "a b = a + a e");
        }
    }
}
