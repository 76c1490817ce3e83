//! End of a contact zone from the tail of its pressure.
//!
//! Between smooth bodies the pressure ends at a like p = sqrt(d) (c_0 + c_1 d), d = a - s, whatever it is farther inside. With l = a - s_0,
//! g = c_1 l / c_0 and the moments over s > s_0
//!
//!   m_k = ∫ p (s - s_0)^k ds / ∫ p ds = l^k (B_0k + g B_1k) / (B_00 + g B_10),   B_jk = ∫ u^(j + 1/2) (1 - u)^k du over 0 < u < 1,
//!
//! eliminating g from k = 1 and 2 leaves l² - 7 m_1 l + 63/8 m_2 = 0, of which l is the smaller root. Equilibrium keeps moments accurate
//! even if single pressures are not. From 0.8 of the zone on, errors of a with exact pressures are below 0.02 % for Hertz, a wedge and
//! punches with rounded corners, from 0.5 on below 0.4 %; a maximum of the pressure has to lie before the tail.

use crate::linalg::{Real, lit};

/// -g of Hertz' pressure over the share of the tail in half its zone.
pub(super) const SLOPE_OF_HERTZ: f64 = 0.29;

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

/// The pressure of this form.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fit<T: Real> {
    /// The end a \[length\].
    pub end: T,
    /// g.
    pub slope: T,
}

impl<T: Real> Tail<T> {
    /// Fits the pressure; `None` if none of this form that is positive up to its end has these moments.
    pub fn fit(&self) -> Option<Fit<T>> {
        let root = self.mean * self.mean * lit(49.0) - self.square * lit(31.5);
        let length = (self.mean * lit(7.0) - root.max(T::zero()).sqrt()) * lit(0.5);
        let share = self.mean / length;
        // g >= -1 where m_1 <= 4/7 l
        let positive = root >= T::zero() && length > T::zero() && share <= lit(4.0 / 7.0);
        positive.then(|| Fit { end: self.begin + length, slope: (lit::<T>(14.0) - share * lit(35.0)) / (share * lit(21.0) - lit(6.0)) })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The tail from `begin` to `end` of a pressure that is a root at `end`.
    fn tail(begin: f64, end: f64, p: impl Fn(f64) -> f64) -> Tail<f64> {
        let n = 40_000;
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
            let found = tail(0.3, 1.7, |s| (1.7 - s).sqrt() * (1.0 + g * (1.7 - s) / 1.4)).fit().unwrap();
            assert!((found.end - 1.7).abs() < 1e-6 && (found.slope - g).abs() < 1e-4 * (1.0 + g * g), "{g}: {found:?}");
        }
        // a pressure that is negative before the end, and none at all
        assert!(tail(0.0, 1.0, |s| (1.0 - s).sqrt() * (0.8 - (1.0 - s))).fit().is_none());
        assert!(Tail { begin: 0.0, mean: 0.3, square: 0.2 }.fit().is_none());
    }

    #[test]
    fn the_pressure_of_hertz_is_known_by_its_slope() {
        let hertz = |s: f64| (1.0 - s * s).max(0.0).sqrt();
        for from in [0.1, 0.2, 0.3, 0.5] {
            let found = tail(from, 1.0, hertz).fit().unwrap();
            assert!((found.slope / (from - 1.0) - SLOPE_OF_HERTZ).abs() < 0.02 && (found.end - 1.0).abs() < 2e-3, "{from}: {found:?}");
        }
        // a pressure that is half that of a wedge
        let found = tail(0.2, 1.0, |s| hertz(s) + 0.5 * (1.0 / s).max(1.0).acosh()).fit().unwrap();
        assert!(found.slope > 0.1, "{found:?}");
    }

    #[test]
    fn pressures_of_four_shapes_end_where_they_end() {
        let hertz = |s: f64| (1.0 - s * s).max(0.0).sqrt();
        let wedge = |s: f64| (1.0 / s).max(1.0).acosh();
        for (from, within) in [(0.8, 2e-4), (0.5, 4e-3)] {
            for p in [&hertz as &dyn Fn(f64) -> f64, &wedge] {
                let found = tail(from, 1.0, p).fit().unwrap().end;
                assert!((found - 1.0).abs() < within, "{from}: {found}");
            }
        }
        // the greatest pressure is near the corner
        for (b, greatest) in [(1.2, 0.89), (1.5, 0.77), (2.0, 0.64), (5.0, 0.38)] {
            let found = tail(b * greatest, b, rounded(b)).fit().unwrap().end;
            assert!((found / b - 1.0).abs() < 3e-3, "{b}: {found}");
        }
    }
}
