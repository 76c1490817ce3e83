//! Newton steps that stay within the closed cell of an element.

use crate::basis::Cell;
use crate::linalg::{Matrix, Real, Vector, lit};

/// Newton step -H⁻¹ slope in the directions that no active face blocks, cut at the first face it meets; `None` if no direction
/// is left or the step does not descend.
pub(super) fn feasible_step<const D: usize, T: Real>(
    kind: Cell,
    xi: &Vector<D, T>,
    slope: &Vector<D, T>,
    h: &Matrix<D, D, T>,
) -> Option<Vector<D, T>> {
    let tiny = T::default_epsilon() * lit(4.0);
    let simplex = kind == Cell::Simplex;
    let mut low: [bool; D] = std::array::from_fn(|k| xi[k] <= tiny && slope[k] > T::zero());
    let mut high: [bool; D] = std::array::from_fn(|k| !simplex && xi[k] >= T::one() - tiny && slope[k] < T::zero());
    let mut slant = simplex && xi.sum() >= T::one() - tiny && (0..D).filter(|&k| !low[k]).fold(T::zero(), |s, k| s + slope[k]) < T::zero();
    for _ in 0..=2 * D + 1 {
        let free: Vec<usize> = (0..D).filter(|&k| !low[k] && !high[k]).collect();
        // columns of z span the free directions; on the slanted face they keep the sum
        let z: Vec<Vector<D, T>> = if slant {
            let (&last, rest) = free.split_last()?;
            rest.iter()
                .map(|&k| {
                    Vector::from_fn(|i, _| {
                        if i == k {
                            T::one()
                        } else if i == last {
                            -T::one()
                        } else {
                            T::zero()
                        }
                    })
                })
                .collect()
        } else {
            free.iter().map(|&k| Vector::from_fn(|i, _| if i == k { T::one() } else { T::zero() })).collect()
        };
        if z.is_empty() {
            return None;
        }
        let n = z.len();
        let matrix = nalgebra::DMatrix::from_fn(n, n, |a, b| z[a].dot(&(h * z[b])));
        let right = nalgebra::DVector::from_fn(n, |a, _| -z[a].dot(slope));
        let y = matrix.lu().solve(&right)?;
        let step = z.iter().zip(y.iter()).fold(Vector::zeros(), |s: Vector<D, T>, (z, &y)| s + z * y);
        if !step.iter().all(|v| v.is_finite()) || step.dot(slope) >= T::zero() {
            return None;
        }
        // the first face on the way
        let mut room = T::one();
        let mut hit = None;
        for k in 0..D {
            if step[k] < T::zero() && xi[k] < -step[k] * room {
                (room, hit) = (xi[k] / -step[k], Some((k, 0)));
            }
            if !simplex && step[k] > T::zero() && T::one() - xi[k] < step[k] * room {
                (room, hit) = ((T::one() - xi[k]) / step[k], Some((k, 1)));
            }
        }
        let (sum, grows) = (xi.sum(), step.sum());
        if simplex && !slant && grows > T::zero() && T::one() - sum < grows * room {
            (room, hit) = ((T::one() - sum) / grows, Some((0, 2)));
        }
        match hit {
            Some((k, which)) if room * step.amax() <= tiny => match which {
                0 => low[k] = true,
                1 => high[k] = true,
                _ => slant = true,
            },
            _ => return Some(step * room.max(T::zero())),
        }
    }
    None
}

/// Clamps `xi` to the closed cell, which it leaves by rounding only.
pub(super) fn into_cell<const D: usize, T: Real>(kind: Cell, xi: Vector<D, T>) -> Vector<D, T> {
    match kind {
        Cell::Tensor => xi.map(|v| v.clamp(T::zero(), T::one())),
        Cell::Simplex => {
            let xi = xi.map(|v| v.max(T::zero()));
            let sum = xi.sum();
            if sum > T::one() { xi / sum } else { xi }
        }
    }
}
