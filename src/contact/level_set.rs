//! The obstacle f <= 0: its foot by Newton's method along the gradient, then along the surface.
//!
//! The foot y of x is where f(y) = 0 and x - y is parallel to grad f(y), so that the gap is the distance |x - y| with the sign of f(x). It
//! is found in two stages that alternate:
//!
//! - on a line along the gradient the zero of f is bracketed by Newton steps and found between its bounds by Newton's method with bisection,
//!   which converges where f has no slope at its zero, or hardly any far from it;
//! - from that zero y the point moves along the surface by the tangential part of x - y, with the step length of Barzilai and Borwein (in
//!   the plane: the secant method), shortened until |x - y| decreases.
//!
//! Source: J. Barzilai, J. M. Borwein, IMA J. Numer. Anal. 8 (1988) 141-148.

use super::line_zero::{Line, OnSurface};
use super::obstacles::unit;
use super::{Hit, Obstacle, opposes};
use crate::linalg::{Real, Vector, lit};
use std::fmt::{self, Debug};

/// Lines along gradients, one after another, on which a zero is looked for.
const LINES: usize = 40;
/// Steps along the surface; they converge as fast as a secant method.
const SLIDES: usize = 200;
/// Steps that leave a zero.
const LEAVING: usize = 16;
/// The first step that leaves a zero at the origin [length], and the growth of the next ones there.
const SMALLEST: f64 = 1e-30;
const GROWTH: f64 = 64.0;
/// Times that a step is shortened.
const SHORTER: usize = 40;
/// Tangential part of x - y, as a share of |x - y|, that ends the search.
const AT_RIGHT_ANGLES: f64 = 1e-13;
/// The share that is good enough where no step brings the foot nearer: the distance is then right to the square of it.
const GOOD_ENOUGH: f64 = 1e-7;

/// The obstacle f <= 0, for f and its gradient as a function of place.
///
/// The gap is the distance to the foot on f = 0 that is found along the gradient, positive where f is; with `along` it is f itself along
/// a fixed direction. Where that foot does not oppose the slave's normal, one is looked for along that normal. Where f or its gradient is
/// no number, or no zero of f is found, the gap is NaN, so that the caller can report it.
pub struct LevelSet<const N: usize, T: Real, F> {
    /// Value and gradient of f.
    pub function: F,
    /// A fixed unit direction of the gap.
    along: Option<Vector<N, T>>,
}

impl<const N: usize, T: Real, F: Fn(&Vector<N, T>) -> (T, Vector<N, T>) + Send + Sync> LevelSet<N, T, F> {
    /// The gap is the distance to f = 0.
    pub fn new(function: F) -> Self {
        Self { function, along: None }
    }

    /// The gap f along `direction` (any length); `None` if it is zero.
    pub fn try_along(function: F, direction: Vector<N, T>) -> Option<Self> {
        Some(Self { function, along: Some(unit(direction)?) })
    }

    /// Value and gradient where both are finite.
    fn at(&self, x: &Vector<N, T>) -> Option<(T, Vector<N, T>)> {
        let (value, gradient) = (self.function)(x);
        (value.is_finite() && gradient.iter().all(|g| g.is_finite())).then_some((value, gradient))
    }

    /// The foot of `x`; `None` if no zero of f is found.
    fn foot(&self, x: &Vector<N, T>, outward: &Vector<N, T>) -> Option<OnSurface<N, T>> {
        let (value, gradient) = self.at(x)?;
        // where f has no slope, out of the obstacle is towards the body
        let along = unit(gradient).unwrap_or(-outward);
        let first = self.surface(x, &along)?;
        // the gap has the sign of f, but for round-off on the surface
        let signed = |(y, normal): &OnSurface<N, T>| {
            let gap = (x - y).dot(normal);
            gap * value >= T::zero() || gap.abs() <= T::default_epsilon() * lit(16.0) * (x.amax() + y.amax())
        };
        let foot = self.slide(x, first).filter(signed)?;
        if opposes(outward, &foot.1) {
            return Some(foot);
        }
        // near an edge the nearest face is not the one that the body came in by
        let other = self.zero(x, &-outward, &along).filter(|start| opposes(outward, &start.1)).and_then(|start| self.slide(x, start));
        Some(other.filter(|found| opposes(outward, &found.1) && signed(found)).unwrap_or(foot))
    }

    /// A zero of f from `from` along the gradient; where it misses f = 0, from where a step of Newton's method leads to. `normal` is the one
    /// where f has no slope.
    fn surface(&self, from: &Vector<N, T>, normal: &Vector<N, T>) -> Option<OnSurface<N, T>> {
        let (mut from, mut along) = (*from, *normal);
        for _ in 0..LINES {
            let (value, gradient) = self.at(&from)?;
            let own = unit(gradient);
            along = own.unwrap_or(along);
            if let Some(found) = self.zero(&from, &along, &along) {
                return Some(found);
            }
            own?;
            let mut step = value / gradient.norm();
            let lower = (0..SHORTER).find_map(|_| {
                let next = from - along * step;
                step *= lit(0.5);
                let (there, _) = (self.function)(&next);
                (there.is_finite() && there.abs() < value.abs()).then_some(next)
            });
            from = lower?;
        }
        None
    }

    /// The zero of f on the line through `from` along `along`, a unit vector on which f is taken to grow, towards smaller |f|; `normal` is
    /// the one where f has no slope.
    fn zero(&self, from: &Vector<N, T>, along: &Vector<N, T>, normal: &Vector<N, T>) -> Option<OnSurface<N, T>> {
        let (value, gradient) = self.at(from)?;
        let direction = unit(gradient).unwrap_or(*normal);
        if value == T::zero() {
            return self.separates(from, &direction).then_some((*from, direction));
        }
        Line { function: &self.function, from, along, value, length: from.amax() }.zero(&gradient, direction)
    }

    /// Whether f is positive on one side of a zero and negative on the other: it is climbed and descended from there in steps along its
    /// gradient, the first one along `normal`; they grow where f has not that sign yet, which may be rounding.
    fn separates(&self, zero: &Vector<N, T>, normal: &Vector<N, T>) -> bool {
        // at the origin nothing tells the size of rounding
        let (first, growth) = match zero.amax() {
            length if length > T::zero() => (T::default_epsilon().sqrt() * length, lit(2.0)),
            _ => (lit(SMALLEST), lit(GROWTH)),
        };
        [T::one(), -T::one()].into_iter().all(|sign| {
            let (mut x, mut along, mut step) = (*zero, *normal, first);
            (0..LEAVING).any(|_| {
                x += along * (step * sign);
                let Some((value, gradient)) = self.at(&x) else { return false };
                along = unit(gradient).unwrap_or(along);
                step *= growth;
                value * sign > T::zero()
            })
        })
    }

    /// Moves a point of f = 0 along the surface to where its distance to `x` is least.
    fn slide(&self, x: &Vector<N, T>, (mut y, mut normal): OnSurface<N, T>) -> Option<OnSurface<N, T>> {
        let tangential = |y: &Vector<N, T>, n: &Vector<N, T>| {
            let away = x - y;
            away - n * away.dot(n)
        };
        let small = T::default_epsilon() * lit::<T>(4.0) * (x.amax() + y.amax());
        let (mut residual, mut scale) = (tangential(&y, &normal), T::one());
        for _ in 0..SLIDES {
            let distance = (x - y).norm();
            if residual.norm() <= distance * lit(AT_RIGHT_ANGLES) + small {
                return Some((y, normal));
            }
            let mut moved = None;
            for _ in 0..SHORTER {
                let target = y + residual * scale;
                if let Some((next, n)) = self.surface(&target, &normal) {
                    let (apart, left) = ((x - next).norm(), tangential(&next, &n));
                    if apart < distance - small || apart <= distance + small && left.norm() < residual.norm() {
                        moved = Some((next, n, left));
                        break;
                    }
                }
                // rounding of f may hide what shorter steps gain
                if residual.norm() <= distance * lit(GOOD_ENOUGH) {
                    return Some((y, normal));
                }
                scale *= lit(0.25);
            }
            let Some((next, n, left)) = moved else {
                // the distance is off by the square of the tangential part over twice the distance
                let off = residual.norm();
                return (off * off <= distance * small * lit(2.0)).then_some((y, normal));
            };
            let (way, change) = (next - y, residual - left);
            let quotient = way.norm_squared() / way.dot(&change);
            scale = if quotient.is_finite() && quotient > T::zero() { quotient } else { T::one() };
            (y, normal, residual) = (next, n, left);
        }
        None
    }
}

impl<const N: usize, T: Real, F> Debug for LevelSet<N, T, F> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("LevelSet").field("along", &self.along).finish_non_exhaustive()
    }
}

impl<const D: usize, const N: usize, T: Real, F: Fn(&Vector<N, T>) -> (T, Vector<N, T>) + Send + Sync> Obstacle<D, N, T>
    for LevelSet<N, T, F>
{
    fn project(&self, x: &Vector<N, T>, outward: &Vector<N, T>) -> Option<Hit<D, N, T>> {
        let found = match self.along {
            Some(along) => self.at(x).map(|(gap, _)| (x - along * gap, along, gap)),
            None => self.foot(x, outward).map(|(y, normal)| (y, normal, (x - y).dot(&normal))),
        };
        let none = lit::<T>(f64::NAN);
        let (x, normal, gap) = found.unwrap_or((Vector::repeat(none), Vector::repeat(none), none));
        Some(Hit { x, normal, gap, at: None })
    }
}
