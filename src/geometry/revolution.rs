//! Bodies of revolution: the half plane x = r >= 0, y = z stands for the circles on which its points go around the axis.

use crate::linalg::{Real, Vector, lit};

/// 2 pi r, the length of the circle of the point `x`, r = `x[0]` \[length\]. Integrals over the body or the surface of revolution are those
/// over the half plane, or a curve in it, with this factor.
pub fn circumference<const N: usize, T: Real>(x: &Vector<N, T>) -> T {
    lit::<T>(std::f64::consts::TAU) * x[0]
}
