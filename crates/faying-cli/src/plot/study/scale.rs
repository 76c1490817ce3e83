//! Axes of a panel: positions of values between the ends, and ticks with labels.

use crate::plot::{labels, ticks};

/// The scale of an axis.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Axis {
    /// Logarithmic; values are positive.
    #[default]
    Log,
    /// Linear.
    Linear,
    /// Categories at 0, 1, 2, ... with these labels.
    Places(Vec<String>),
}

/// An axis with its ends, logarithms of values on a logarithmic one.
#[derive(Clone, Debug)]
pub struct Scale<'a> {
    axis: &'a Axis,
    lo: f64,
    hi: f64,
}

impl<'a> Scale<'a> {
    /// The axis for `values` with room around them, at least `room` decades on a logarithmic one; `None` without values.
    pub fn of(axis: &'a Axis, values: impl Iterator<Item = f64>, room: f64) -> Option<Self> {
        if let Axis::Places(words) = axis {
            return (values.count() > 0).then(|| Self { axis, lo: -0.5, hi: words.len() as f64 - 0.5 });
        }
        let log = *axis == Axis::Log;
        let values = values.map(|v| if log { v.log10() } else { v });
        let (lo, hi) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), v| (lo.min(v), hi.max(v)));
        let least = match (log, hi - lo) {
            (true, _) => room,
            // one value, or equal values: a range of their size
            (false, 0.0) => {
                if lo == 0.0 {
                    0.5
                } else {
                    0.1 * lo.abs()
                }
            }
            (false, span) => 0.08 * span,
        };
        (lo <= hi).then(|| Self { axis, lo: lo - least.max(0.05 * (hi - lo)), hi: hi + least.max(0.05 * (hi - lo)) })
    }

    /// Whether a value can be drawn: finite, and positive on a logarithmic axis.
    pub fn knows(axis: &Axis, value: f64) -> bool {
        value.is_finite() && (*axis != Axis::Log || value > 0.0)
    }

    /// Distance of the ends: in decades, or in units of the values.
    pub fn span(&self) -> f64 {
        self.hi - self.lo
    }

    /// Position of `value`: 0 at the lower and 1 at the upper end.
    pub fn at(&self, value: f64) -> f64 {
        let v = if *self.axis == Axis::Log { value.log10() } else { value };
        (v - self.lo) / (self.hi - self.lo)
    }

    /// Ticks: values with their labels.
    pub fn marks(&self) -> Vec<(f64, String)> {
        match self.axis {
            Axis::Log => labelled(logarithmic([self.lo, self.hi]), 3),
            Axis::Linear => labelled(ticks(self.lo, self.hi, 6), 6),
            Axis::Places(words) => {
                // at most 12, so that labels do not overlap
                let every = words.len().div_ceil(12).max(1);
                words.iter().enumerate().step_by(every).map(|(k, word)| (k as f64, word.clone())).collect()
            }
        }
    }
}

/// Values with labels that differ.
fn labelled(values: Vec<f64>, digits: usize) -> Vec<(f64, String)> {
    let words = labels(&values, digits);
    values.into_iter().zip(words).collect()
}

/// Round numbers between 10^lo and 10^hi, at least three: powers of ten, few enough; with 2 and 5 below two decades and where powers
/// alone are too few; evenly spaced ones where these are.
fn logarithmic([lo, hi]: [f64; 2]) -> Vec<f64> {
    let (first, last) = (lo.floor() as i32, hi.ceil() as i32);
    let decades = hi - lo;
    let every = ((decades / 8.0).ceil() as i32).max(1);
    let of = |steps: &[f64]| -> Vec<f64> {
        let all = (first..=last).filter(|d| d.rem_euclid(every) == 0).flat_map(|d| steps.iter().map(move |m| m * 10f64.powi(d)));
        all.filter(|v| (lo..=hi).contains(&v.log10())).collect()
    };
    let finer = [if decades < 2.0 { 3 } else { 1 }, 3].map(|n| of(&[1.0, 2.0, 5.0][..n]));
    let found = finer.into_iter().find(|found| found.len() > 2);
    found.unwrap_or_else(|| ticks(10f64.powf(lo), 10f64.powf(hi), 4))
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn marks_are_powers_of_ten_and_finer_on_short_axes() {
        assert_eq!(logarithmic([0.0, 3.0]), [1.0, 10.0, 100.0, 1000.0]);
        assert_eq!(logarithmic([-0.1, 1.1]), [1.0, 2.0, 5.0, 10.0]);
        assert!(logarithmic([-17.0, 3.0]).len() <= 9);
        assert!(logarithmic([0.41, 0.6]).len() > 2);
        assert_eq!(logarithmic([0.1, 2.6]), [2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0]);
    }

    #[test]
    fn values_stand_between_the_ends_of_their_axis() {
        for (axis, values) in [(Axis::Log, [1e-3, 1.0]), (Axis::Linear, [-2.0, 5.0]), (Axis::Linear, [3.0, 3.0])] {
            let scale = Scale::of(&axis, values.into_iter(), 0.2).unwrap();
            assert!(values.iter().all(|v| (0.0..=1.0).contains(&scale.at(*v))) && scale.marks().len() > 1, "{axis:?}");
        }
        let words = Axis::Places(["a", "b"].map(String::from).to_vec());
        let scale = Scale::of(&words, [0.0].into_iter(), 0.2).unwrap();
        assert_eq!((scale.at(0.0), scale.at(1.0), scale.marks().len()), (0.25, 0.75, 2));
        assert!(Scale::of(&Axis::Log, std::iter::empty(), 0.2).is_none());
        assert!(!Scale::knows(&Axis::Log, 0.0) && Scale::knows(&Axis::Linear, 0.0) && !Scale::knows(&Axis::Linear, f64::NAN));
    }
}
