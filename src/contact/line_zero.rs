//! The zero of a function on a line: bracketed by steps of Newton's method, then found between its bounds by Newton's method with bisection.
//!
//! It converges where f has no slope at its zero, or hardly any far from it.

use super::obstacles::unit;
use crate::linalg::{Real, Vector, lit};

/// Steps that look for a change of sign; each doubles the last one or is a step of Newton's method.
const BRACKETING: usize = 100;
/// Steps of Newton's method, before those that only double.
const NEWTON: usize = 8;
/// Steps between the bounds of a zero; bisection alone needs 53 for double precision.
const NARROWING: usize = 400;
/// Doublings of a step that leaves a place where f is zero.
const LEAVING: usize = 16;
/// Share of the bounds' distance below which a step of Newton's method is short.
const CLOSE: f64 = 1e-3;

/// A point of f = 0 and the unit normal there.
pub(super) type OnSurface<const N: usize, T> = (Vector<N, T>, Vector<N, T>);

/// A line on which a zero of f is looked for, from a point where f is not zero.
pub(super) struct Line<'a, const N: usize, T: Real, F> {
    /// f and its gradient.
    pub function: &'a F,
    pub from: &'a Vector<N, T>,
    /// A unit vector on which f is taken to grow.
    pub along: &'a Vector<N, T>,
    /// f at `from`.
    pub value: T,
    /// Largest coordinate of `from`.
    pub length: T,
}

/// End of the search for bounds of a zero.
enum Bracket<const N: usize, T: Real> {
    /// Places on the line between which f changes its sign.
    Bounds(T, T),
    /// The zero, met by a step of Newton's method.
    Zero(OnSurface<N, T>),
}

impl<const N: usize, T: Real, F: Fn(&Vector<N, T>) -> (T, Vector<N, T>)> Line<'_, N, T, F> {
    /// The zero of f towards smaller |f| and the normal there; `gradient`: that of f at the start, `direction`: the normal where f has no
    /// slope.
    pub fn zero(&self, gradient: &Vector<N, T>, direction: Vector<N, T>) -> Option<OnSurface<N, T>> {
        match self.bracket(gradient, &direction)? {
            Bracket::Zero(found) => Some(found),
            Bracket::Bounds(lo, hi) => self.narrow(lo, hi, direction),
        }
    }

    /// Bounds of a zero of f on the line, which starts with the slope of `gradient`, or the zero itself where a step of Newton's method ends on
    /// it; `direction` is the normal where f has no slope.
    fn bracket(&self, gradient: &Vector<N, T>, direction: &Vector<N, T>) -> Option<Bracket<N, T>> {
        let (value, length, towards) = (self.value, self.length, self.towards());
        let slope = gradient.dot(self.along);
        // f that grows on the way has its zero elsewhere
        if self.leads_away(slope) {
            return None;
        }
        let without_slope = towards * if length > T::zero() { length } else { T::one() };
        let mut step = self.newton(value, slope).or_else(|| self.newton(value, gradient.norm())).unwrap_or(without_slope);
        let (mut lo, mut steps) = (T::zero(), 0);
        for _ in 0..BRACKETING {
            let s = lo + step;
            let (next, gradient) = (self.function)(&self.at(s));
            let slope = gradient.dot(self.along);
            let crosses = || {
                // f may vanish over some length by rounding; what is zero from there on, by underflow, has no zero
                let (mut beyond, mut aside) = (next, step * lit(CLOSE));
                for _ in 0..LEAVING {
                    if beyond != T::zero() {
                        break;
                    }
                    beyond = (self.function)(&self.at(s + aside)).0;
                    aside *= lit(2.0);
                }
                self.is_crossed(beyond)
            };
            let same = next == T::zero() || (next > T::zero()) == (value > T::zero());
            if !next.is_finite() || same && self.leads_away(slope) {
                // beyond where f is defined, or beyond its least value on the line
                step *= lit(0.5);
            } else if crosses() {
                return Some(Bracket::Bounds(lo, s));
            } else {
                let further = self.newton(next, slope);
                steps += 1;
                if let Some(last) = further.filter(|n| next != T::zero() && n.abs() <= self.rounding(s)) {
                    let foot = s + last;
                    // f that only touches zero does not change its sign there
                    let aside = T::default_epsilon().sqrt() * (length + foot.abs()) * towards;
                    let changes = self.is_crossed((self.function)(&self.at(foot + aside)).0);
                    return changes.then(|| Bracket::Zero((self.at(foot), unit(gradient).unwrap_or(*direction))));
                }
                lo = s;
                // short steps lead to a zero without a slope: they are stretched after a few
                step = further.filter(|n| steps < NEWTON || n.abs() > step.abs() * lit(2.0)).unwrap_or(step * lit(2.0));
            }
        }
        None
    }

    /// The zero of f between two bounds on the line; `direction` is the normal where f has no slope.
    fn narrow(&self, mut lo: T, mut hi: T, mut direction: Vector<N, T>) -> Option<OnSurface<N, T>> {
        let mut s = (lo + hi) * lit(0.5);
        let mut steps = [(hi - lo).abs(); 2];
        for _ in 0..NARROWING {
            let (here, gradient) = (self.function)(&self.at(s));
            if !here.is_finite() {
                return None;
            }
            // a gradient that vanishes at the zero, or has no bound there, is taken beside it
            direction = unit(gradient).unwrap_or(direction);
            if here == T::zero() || (hi - lo).abs() <= self.rounding(s) {
                return Some((self.at(s), direction));
            }
            if (here > T::zero()) == (self.value > T::zero()) {
                lo = s
            } else {
                hi = s
            }
            let step = -here / gradient.dot(self.along);
            if step.abs() <= self.rounding(s) {
                return Some((self.at(s + step), direction));
            }
            // steps of Newton's method must halve the one before the last, or else the bounds are halved; short ones are doubled, so
            // that the zero is between close bounds
            let far = if step.abs() < (hi - lo).abs() * lit(CLOSE) { step * lit(2.0) } else { step };
            let inside = (s + far - lo) * (s + far - hi) < T::zero();
            let next = if inside && step.abs() < steps[0] * lit(0.5) { s + far } else { (lo + hi) * lit(0.5) };
            steps = [steps[1], (next - s).abs()];
            s = next;
        }
        None
    }

    fn at(&self, s: T) -> Vector<N, T> {
        self.from + self.along * s
    }

    /// The sign of the way to smaller |f|.
    fn towards(&self) -> T {
        if self.value > T::zero() { -T::one() } else { T::one() }
    }

    /// A step of Newton's method, if it leads towards smaller |f|.
    fn newton(&self, value: T, slope: T) -> Option<T> {
        let step = -value / slope;
        (step.is_finite() && step * self.towards() > T::zero()).then_some(step)
    }

    /// Whether |f| grows on the way.
    fn leads_away(&self, slope: T) -> bool {
        slope * self.value * self.towards() > T::zero()
    }

    /// Whether f has the other sign than at the start where it is `beyond`.
    fn is_crossed(&self, beyond: T) -> bool {
        beyond != T::zero() && (beyond > T::zero()) != (self.value > T::zero())
    }

    fn rounding(&self, s: T) -> T {
        T::default_epsilon() * lit(4.0) * (self.length + s.abs())
    }
}
