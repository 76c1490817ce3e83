//! The depth up to which a slave point that lies inside its opponent has a partner.
//!
//! With d the depths of the points, distances to what opposes them, and r their distances to the nearest surface, whatever it opposes, no
//! partner is deeper than
//!
//! ```text
//! max(6 max r, L / 100),   L the diagonal of the box around the side
//! ```
//!
//! A side that is pressed in as a whole has d = r in its middle. A side that runs into an opponent edge on, beside the one that is pressed,
//! lies just below its surface and would find what opposes it at the far end of the opponent.

use super::{Obstacle, opposed};
use crate::linalg::{Real, Vector, lit};

/// Largest depth over the greatest distance to the nearest surface.
const DEEPEST: f64 = 6.0;
/// Share of the size of the side up to which any depth is accepted: fits, facets and round-off.
const SHALLOW: f64 = 1e-2;

/// Returns the greatest depth of a partner on a side of this `size`; `depth`: positive ones at the points, `nearest` the distance of one of
/// them to the nearest surface.
pub(super) fn deepest<T: Real>(size: T, depth: &[(usize, T)], mut nearest: impl FnMut(usize) -> T) -> T {
    let Some(&(first, most)) = depth.iter().reduce(|a, b| if b.1 > a.1 { b } else { a }) else { return T::zero() };
    let mut bound = size * lit(SHALLOW);
    if bound < most {
        bound = bound.max(nearest(first) * lit(DEEPEST));
    }
    for &(point, _) in depth {
        if bound >= most {
            break;
        }
        bound = bound.max(nearest(point) * lit(DEEPEST));
    }
    bound
}

/// Returns the distance of `x` to the nearest surface of an obstacle that opposes any of the axes or of the diagonals between them.
pub(super) fn to_surface<const D: usize, const N: usize, T: Real>(target: &dyn Obstacle<D, N, T>, x: &Vector<N, T>) -> Option<T> {
    let mut least: Option<T> = None;
    for a in 0..N {
        for b in a..N {
            for signs in [[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]] {
                let mut direction = Vector::<N, T>::zeros();
                (direction[a], direction[b]) = (lit(signs[0]), lit(signs[1]));
                let Some(hit) = opposed(target, x, &direction.normalize()).filter(|hit| hit.gap.is_finite()) else { continue };
                let distance = (x - hit.x).norm();
                least = Some(least.map_or(distance, |l| l.min(distance)));
            }
        }
    }
    least
}
