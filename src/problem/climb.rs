//! Search for the greatest value of a function on a unit cube, from a good point of it.

use crate::linalg::{Matrix, Vector, inverse};

/// Rounds of a search, at most.
const ROUNDS: usize = 60;
/// Smallest half width of the box of a round.
const SMALLEST: f64 = 1e-9;
/// Half width from which on a search ends when a round gains nothing but rounding.
const SMOOTH: f64 = 2e-4;
/// A gain below this share of the value is rounding.
const ROUNDING: f64 = 1e-15;
/// Shrinking of the box where the greatest value lies within it.
const SHRINK: f64 = 0.25;

/// Climbs from `start`, whose value is `value`, to a greatest value of `f` on the unit cube near it.
///
/// Each round evaluates the 3^D points of a box of half width `h` around the best point, moved into the cube, and the greatest value of the
/// quadratic function through them; the box follows the best point, and shrinks where that is inside. `f` takes points in batches.
pub(super) fn climb<const D: usize>(
    f: &mut dyn FnMut(&[Vector<D>]) -> Vec<f64>,
    (start, value): (Vector<D>, f64),
    h: f64,
) -> (Vector<D>, f64) {
    let (mut best, mut h) = ((start, value), h.min(0.5));
    let mut idle = 0;
    for _ in 0..ROUNDS {
        let center = best.0.map(|x| x.clamp(h, 1.0 - h));
        let points: Vec<Vector<D>> = (0..count(D)).map(|i| center + offset::<D>(i) * h).collect();
        let values = f(&points);
        let before = best;
        let mut take = |x: Vector<D>, v: f64| {
            if v > best.1 {
                best = (x, v);
            }
        };
        points.iter().zip(&values).for_each(|(x, v)| take(*x, *v));
        if let Some(y) = greatest::<D>(&values) {
            let x = center + y * h;
            take(x, f(&[x])[0]);
        }
        let gain = best.1 - before.1;
        idle = if gain <= ROUNDING * best.1.abs() { idle + 1 } else { 0 };
        if h < SMALLEST || (h < SMOOTH && idle > 1) {
            break;
        }
        // at the border of the box, but not of the cube, the box moves on
        let away = (best.0 - center).amax() > 0.9 * h && (best.0 - before.0).amax() > 0.5 * h;
        if !away {
            h *= SHRINK;
        }
    }
    best
}

/// 3^d.
fn count(d: usize) -> usize {
    3usize.pow(d as u32)
}

/// The i-th of the points -1, 0, 1 in every direction, the first fastest.
fn offset<const D: usize>(mut i: usize) -> Vector<D> {
    Vector::from_fn(|_, _| {
        let digit = i % 3;
        i /= 3;
        digit as f64 - 1.0
    })
}

/// Place of the greatest value on [-1, 1]^D of the quadratic function through the `values` at [`offset`]; `None` if they are not finite.
fn greatest<const D: usize>(values: &[f64]) -> Option<Vector<D>> {
    if values.iter().any(|v| !v.is_finite()) {
        return None;
    }
    let (middle, step) = ((count(D) - 1) / 2, |k: usize| count(k));
    let at = |k: usize, s: isize| values[middle.wrapping_add_signed(s * step(k) as isize)];
    let mixed = |k: usize, l: usize, s: isize, t: isize| values[middle.wrapping_add_signed(s * step(k) as isize + t * step(l) as isize)];
    let slope = Vector::<D>::from_fn(|k, _| (at(k, 1) - at(k, -1)) * 0.5);
    let bend = Matrix::<D, D>::from_fn(|k, l| match k == l {
        true => at(k, 1) - 2.0 * values[middle] + at(k, -1),
        false => (mixed(k, l, 1, 1) - mixed(k, l, 1, -1) - mixed(k, l, -1, 1) + mixed(k, l, -1, -1)) * 0.25,
    });
    let model = |y: &Vector<D>| slope.dot(y) + 0.5 * (bend * y).dot(y);
    let mut best: Option<(Vector<D>, f64)> = None;
    // every face of the box: directions at its lower end, free, or at its upper end
    for face in 0..count(D) {
        let fixed = offset::<D>(face);
        let Some(y) = stationary(&slope, &bend, &fixed) else { continue };
        if y.iter().all(|v| v.abs() <= 1.0) {
            let value = model(&y);
            if best.as_ref().is_none_or(|b| value > b.1) {
                best = Some((y, value));
            }
        }
    }
    best.map(|b| b.0)
}

/// The point where the quadratic function has no slope along the directions that are 0 in `fixed`, which gives the others.
fn stationary<const D: usize>(slope: &Vector<D>, bend: &Matrix<D, D>, fixed: &Vector<D>) -> Option<Vector<D>> {
    let free = |k: usize| fixed[k] == 0.0;
    let matrix = Matrix::<D, D>::from_fn(|k, l| match (free(k), k == l) {
        (true, _) => bend[(k, l)],
        (false, true) => 1.0,
        (false, false) => 0.0,
    });
    let right = Vector::<D>::from_fn(|k, _| if free(k) { -slope[k] } else { fixed[k] });
    inverse(&matrix).map(|m| m * right).filter(|y| y.iter().all(|v| v.is_finite()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found<const D: usize>(f: impl Fn(&Vector<D>) -> f64, start: [f64; D]) -> (Vector<D>, f64, usize) {
        let mut asked = 0;
        let start = Vector::from(start);
        let value = f(&start);
        let mut batch = |x: &[Vector<D>]| {
            asked += x.len();
            x.iter().map(&f).collect::<Vec<f64>>()
        };
        let (x, v) = climb(&mut batch, (start, value), 0.25);
        (x, v, asked)
    }

    #[test]
    fn the_top_is_found_inside_on_faces_and_in_corners() {
        let hill =
            |x: &Vector<2>| -(x[0] - 0.3).powi(2) - 3.0 * (x[1] - 0.6).powi(2) + (x[0] - 0.3) * (x[1] - 0.6) + 0.2 * (x[0] - 0.3).powi(3);
        let (x, v, asked) = found(hill, [0.5, 0.5]);
        assert!(v.abs() < 1e-15 && (x - Vector::from([0.3, 0.6])).norm() < 1e-6 && asked < 300, "{x} {v} {asked}");
        let ridge = |x: &Vector<3>| (1.5 * x[0] - (x[1] - 0.7).powi(2)).sin() - (x[2] - 0.2).powi(4);
        let (x, v, asked) = found(ridge, [0.5, 0.5, 0.5]);
        assert!((v - 1.5f64.sin()).abs() < 1e-13 && x[0] == 1.0 && asked < 1500, "{x} {v} {asked}");
        let (x, _, _) = found(|x: &Vector<3>| (x[0] + 2.0 * x[1] - x[2]).exp(), [0.5, 0.5, 0.5]);
        assert_eq!(x, Vector::from([1.0, 1.0, 0.0]));
        // a kink
        let (_, v, asked) = found(|x: &Vector<2>| -(x[0] - 0.411).hypot(x[1] - 0.222), [0.5, 0.5]);
        assert!(v > -1e-8 && asked < 400, "{v} {asked}");
    }
}
