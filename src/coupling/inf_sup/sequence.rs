//! Evaluation of a sequence of constants: slope against the mesh size, verdict, dependence on the degree.

use std::fmt::{self, Display};

/// A constant below this is zero: round-off.
pub const ZERO: f64 = 1e-10;
/// Up to this slope of log beta against log h a sequence is flat: the pair is stable.
pub const FLAT: f64 = 0.05;
/// From this slope on a sequence falls: the pair is unstable. The weakest loss that is known on curves, h^1/2, is above it.
pub const FALLING: f64 = 0.25;
/// Number of finest levels that the verdict is based on.
const DECIDING: usize = 3;

/// Whether a pair of spaces is stable.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// beta stays away from zero.
    Stable,
    /// beta is zero, or falls with the mesh size.
    Unstable,
    /// Too few levels, or a slope in between.
    Undecided,
}

impl Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Stable => "stable",
            Self::Unstable => "unstable",
            Self::Undecided => "undecided",
        })
    }
}

/// Fitted slope of log beta against log h over the three finest levels, by least squares; `points` are (h, beta) from coarse
/// to fine. `None` with fewer than three levels, or if one of these constants is zero.
pub fn slope(points: &[(f64, f64)]) -> Option<f64> {
    let finest = &points[points.len().checked_sub(DECIDING)?..];
    let logs: Option<Vec<(f64, f64)>> = finest.iter().map(|&(h, beta)| (beta > ZERO && h > 0.0).then(|| (h.ln(), beta.ln()))).collect();
    fitted(&logs?)
}

/// The verdict of the constants (h, beta) of one pair, from coarse to fine.
///
/// Unstable: the finest beta is zero (below [`ZERO`]), or both the slope and the last rate are at least [`FALLING`]; a fall that ends
/// is an effect of coarse grids. Stable: the slope is at most [`FLAT`] (a beta that rises is bounded below). Undecided: anything else.
pub fn verdict(points: &[(f64, f64)]) -> Verdict {
    let last = |points: &[(f64, f64)]| match points {
        [.., (coarse, before), (fine, beta)] => (before / beta).ln() / (coarse / fine).ln(),
        _ => 0.0,
    };
    match (points.last(), slope(points)) {
        (Some(&(_, beta)), _) if beta <= ZERO => Verdict::Unstable,
        (_, Some(s)) if s >= FALLING && last(points) >= FALLING => Verdict::Unstable,
        (_, Some(s)) if s <= FLAT => Verdict::Stable,
        _ => Verdict::Undecided,
    }
}

/// Exponent a of beta ~ p^a, fitted to constants (p, beta) of several degrees; `None` with fewer than two, or if one is zero.
pub fn degree_exponent(points: &[(f64, f64)]) -> Option<f64> {
    let logs: Option<Vec<(f64, f64)>> = points.iter().map(|&(p, beta)| (beta > ZERO && p > 0.0).then(|| (p.ln(), beta.ln()))).collect();
    fitted(&logs?)
}

/// Slope of the line through points by least squares; `None` if it is not determined.
fn fitted(points: &[(f64, f64)]) -> Option<f64> {
    let n = points.len() as f64;
    let (x, y) = points.iter().fold((0.0, 0.0), |(x, y), p| (x + p.0 / n, y + p.1 / n));
    let (top, bottom) = points.iter().fold((0.0, 0.0), |(t, b), p| (t + (p.0 - x) * (p.1 - y), b + (p.0 - x) * (p.0 - x)));
    (points.len() > 1 && bottom > 0.0).then(|| top / bottom)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(levels: usize, beta: impl Fn(f64) -> f64) -> Vec<(f64, f64)> {
        (0..levels).map(|k| 0.5f64.powi(k as i32)).map(|h| (h, beta(h))).collect()
    }

    #[test]
    fn flat_sequences_are_stable_and_falling_ones_are_not() {
        assert_eq!(verdict(&line(5, |h| 0.8 + 0.01 * h)), Verdict::Stable);
        assert_eq!(verdict(&line(5, |h| 0.8 - 0.1 * h)), Verdict::Stable);
        assert_eq!(verdict(&line(5, |h| h)), Verdict::Unstable);
        assert_eq!(verdict(&line(5, f64::sqrt)), Verdict::Unstable);
        assert_eq!(verdict(&line(5, |h| h.powf(0.1))), Verdict::Undecided);
        assert!((slope(&line(5, |h| 3.0 * h * h)).unwrap() - 2.0).abs() < 1e-12);
    }

    #[test]
    fn a_fall_that_ends_decides_nothing() {
        let points = [(1.0, 9.25e-4), (0.5, 4.71e-4), (0.25, 4.27e-4)];
        assert_eq!(verdict(&points), Verdict::Undecided);
        assert_eq!(verdict(&[points[0], points[1], (0.25, 4.27e-4), (0.125, 4.2e-4), (0.0625, 4.17e-4)]), Verdict::Stable);
    }

    #[test]
    fn a_zero_decides_alone_and_few_levels_decide_nothing_else() {
        assert_eq!(verdict(&line(1, |_| 0.0)), Verdict::Unstable);
        assert_eq!(verdict(&line(2, |_| 0.8)), Verdict::Undecided);
        assert_eq!(verdict(&[]), Verdict::Undecided);
        // over-constrained on one element alone
        assert_eq!(verdict(&line(4, |h| if h == 1.0 { 0.0 } else { 0.7 })), Verdict::Stable);
    }

    #[test]
    fn the_exponent_of_the_degree_is_that_of_a_power() {
        let betas: Vec<(f64, f64)> = (2..7).map(|p| (p as f64, (p as f64).powf(-0.6))).collect();
        assert!((degree_exponent(&betas).unwrap() + 0.6).abs() < 1e-12);
        assert_eq!(degree_exponent(&betas[..1]), None);
    }
}
