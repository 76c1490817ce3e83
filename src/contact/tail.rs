//! End of a contact zone from the tail of its pressure.
//!
//! Between smooth bodies the pressure ends at a like p = sqrt(d) (1 + g u), u = d / l, d = a - s, l = a - s_0, whatever it is farther inside.
//! With the moments over s > s_0
//!
//! ```text
//! m_k = ∫ p (s - s_0)^k ds / ∫ p ds = l^k (A_k + g B_1k) / (A_0 + g B_10),   A_k = B_0k,   B_jk = ∫ u^(j + 1/2) (1 - u)^k du over 0 < u < 1,
//! ```
//!
//! eliminating g from k = 1 and 2 leaves a quadratic equation for l, l² - 7 m_1 l + 63/8 m_2 = 0, of which l is the smaller root. Equilibrium
//! keeps moments accurate even if single pressures are not. From 0.8 of the zone on, errors of a with exact pressures are below 0.02 % for
//! Hertz, a wedge and punches with rounded corners, from 0.5 on below 0.4 %; a maximum of the pressure has to lie before the tail.
//!
//! Longer tails need more terms: with half the zone h those of Hertz' pressure sqrt(d) sqrt(1 - d / 2h), beyond the linear one, in A_k.

use crate::linalg::{Real, lit, num};

/// Coefficients of (d/h)² and on of sqrt(1 - d / 2h).
const HERTZ: [f64; 4] = [-1.0 / 32.0, -1.0 / 128.0, -5.0 / 2048.0, -7.0 / 8192.0];
/// Fixed-point iterations of a fit to Hertz' terms, which depend on its end; each gains a digit.
const ROUNDS: usize = 10;

/// The pressure behind a point of the side.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tail<T: Real> {
    /// The point s_0, an arc length \[length\].
    pub begin: T,
    /// m_1 \[length\].
    pub mean: T,
    /// m_2 [length²].
    pub square: T,
}

impl<T: Real> Tail<T> {
    /// The end a; `None` if no pressure of two terms that is positive up to its end has these moments.
    pub fn end(&self) -> Option<T> {
        let (length, slope) = self.fit(&[])?;
        (slope >= -T::one()).then(|| self.begin + length)
    }

    /// The end a by the terms of Hertz' pressure around `middle`, and the difference of g from that of Hertz; `None` as [`Tail::end`].
    pub fn like_hertz(&self, middle: T) -> Option<(T, T)> {
        let mut end = self.end()?;
        let mut slope = T::zero();
        for _ in 0..ROUNDS {
            let share = (end - self.begin) / (end - middle);
            let mut power = share;
            let terms = HERTZ.map(|c| {
                power *= share;
                power * lit(c)
            });
            let (length, g) = self.fit(&terms)?;
            (end, slope) = (self.begin + length, g + share * lit(0.25));
        }
        Some((end, slope))
    }

    /// l and g for the coefficients `terms` of u² and on.
    fn fit(&self, terms: &[T]) -> Option<(T, T)> {
        let a = [0, 1, 2].map(|k| terms.iter().enumerate().fold(beta::<T>(0, k), |sum, (j, &c)| sum + c * beta::<T>(j + 2, k)));
        let b = [0, 1, 2].map(|k| beta::<T>(1, k));
        let minor = |i: usize, k: usize| a[i] * b[k] - b[i] * a[k];
        // m_1 l minor(2, 0) - l² minor(2, 1) = m_2 minor(1, 0)
        let (half, square) = (self.mean * minor(2, 0) * lit(0.5), minor(2, 1));
        let root = half * half - square * minor(1, 0) * self.square;
        let length = (half - root.max(T::zero()).sqrt()) / square;
        let share = self.mean / length;
        let slope = (a[1] - share * a[0]) / (share * b[0] - b[1]);
        (root >= T::zero() && length > T::zero() && share * b[0] > b[1]).then_some((length, slope))
    }
}

/// B_jk for k up to 2.
fn beta<T: Real>(j: usize, k: usize) -> T {
    let of = |j: usize| T::one() / (num::<T>(j) + lit(1.5));
    match k {
        0 => of(j),
        1 => of(j) - of(j + 1),
        _ => of(j) - of(j + 1) * lit(2.0) + of(j + 2),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The tail from `begin` to `end` of a pressure that is a root at `end`.
    fn tail(begin: f64, end: f64, p: impl Fn(f64) -> f64) -> Tail<f64> {
        let n = 20_000;
        let mut m = [0.0; 3];
        for k in 0..n {
            // s = end - l t² takes the root out of the sums
            let (l, t) = (end - begin, (f64::from(k) + 0.5) / f64::from(n));
            let s = end - l * t * t;
            (0..3).for_each(|i| m[i] += p(s) * t * (s - begin).powi(i as i32));
        }
        Tail { begin, mean: m[1] / m[0], square: m[2] / m[0] }
    }

    /// The pressure under a flat punch of half width 1 with rounded corners, pressed down to `b`: flat punches of growing width
    /// c > max(1, s) on top of each other (Jäger, Arch. Appl. Mech. 65, 1995).
    fn rounded(b: f64) -> impl Fn(f64) -> f64 {
        move |s: f64| {
            let (from, n) = (s.max(1.0), 400);
            let part = |k: i32| {
                let t = (f64::from(k) + 0.5) / f64::from(n);
                let c = from + (b - from) * t * t;
                2.0 * t * (b - from) * c * (1.0 / c).min(1.0).acos() / (c * c - s * s).max(1e-300).sqrt()
            };
            (0..n).map(part).sum::<f64>() / f64::from(n)
        }
    }

    #[test]
    fn two_terms_have_their_end() {
        for g in [-0.99, -0.4, 0.0, 0.7, 20.0] {
            let found = tail(0.3, 1.7, |s| (1.7 - s).sqrt() * (1.0 + g * (1.7 - s) / 1.4)).end().unwrap();
            assert!((found - 1.7).abs() < 1e-6, "{g}: {found}");
        }
        // a pressure that is negative before the end, and none at all
        assert!(tail(0.0, 1.0, |s| (1.0 - s).sqrt() * (0.8 - (1.0 - s))).end().is_none());
        assert!(Tail { begin: 0.0, mean: 0.3, square: 0.2 }.end().is_none());
    }

    #[test]
    fn the_pressure_of_hertz_is_known_by_its_slope() {
        let hertz = |s: f64| (1.0 - s * s).max(0.0).sqrt();
        for from in [0.0, 0.1, 0.3, 0.6] {
            let (end, slope) = tail(from, 1.0, hertz).like_hertz(0.0).unwrap();
            assert!((end - 1.0).abs() < 1e-3 && slope.abs() < 0.01, "{from}: {end} {slope}");
        }
        // parts of other pressures show in the slope before they move the end
        for p in [&(|s: f64| hertz(s) * (1.0 + 0.3 * s * s)) as &dyn Fn(f64) -> f64, &|s| hertz(s) + 0.2 * (1.0 / s).max(1.0).acosh()] {
            let (end, slope) = tail(0.1, 1.0, p).like_hertz(0.0).unwrap();
            assert!(slope.abs() > 0.05 && (end - 1.0).abs() < 0.02, "{end} {slope}");
        }
    }

    #[test]
    fn pressures_of_four_shapes_end_where_they_end() {
        let hertz = |s: f64| (1.0 - s * s).max(0.0).sqrt();
        let wedge = |s: f64| (1.0 / s).max(1.0).acosh();
        for (from, within) in [(0.8, 2e-4), (0.5, 4e-3)] {
            for p in [&hertz as &dyn Fn(f64) -> f64, &wedge] {
                let found = tail(from, 1.0, p).end().unwrap();
                assert!((found - 1.0).abs() < within, "{from}: {found}");
            }
        }
        // the greatest pressure is near the corner
        for (b, greatest) in [(1.2, 0.89), (1.5, 0.77), (2.0, 0.64), (5.0, 0.38)] {
            let found = tail(b * greatest, b, rounded(b)).end().unwrap();
            assert!((found / b - 1.0).abs() < 3e-3, "{b}: {found}");
        }
    }
}
