//! Floor 6: sums over elements. Gets coefficients per point, never a material.

use crate::linalg::{Matrix, Real, Vector};
use std::fmt::Debug;

/// d stress / d grad_u: `tangent[i][j][(k, l)]` = d sigma_(k,l) / d (grad u)_(i,j), i, k components, j, l directions.
/// One C x N matrix (shaped like the stress) per entry (i, j) of grad_u.
pub type Tangent<const C: usize, const N: usize, T = f64> = [[Matrix<C, N, T>; N]; C];

/// The tangent at the points of an element.
#[non_exhaustive]
pub enum Coefficient<'a, const C: usize, const N: usize, T: Real = f64> {
    /// One tangent everywhere.
    Constant(Tangent<C, N, T>),
    /// A tangent per physical point.
    PerPoint(&'a (dyn Fn(&Vector<N, T>) -> Tangent<C, N, T> + Sync)),
}

impl<const C: usize, const N: usize, T: Real> Debug for Coefficient<'_, C, N, T> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Constant(tangent) => f.debug_tuple("Constant").field(tangent).finish(),
            Self::PerPoint(_) => f.write_str("PerPoint(..)"),
        }
    }
}

/// The bilinear form a(u, v) = ∫ grad v : tangent : grad u dx.
#[derive(Debug)]
pub struct Form<'a, const C: usize, const N: usize, T: Real = f64> {
    /// The tangent.
    pub coefficient: Coefficient<'a, C, N, T>,
    /// Whether `tangent[i][j][(k, l)] = tangent[k][l][(i, j)]`.
    pub symmetric: bool,
}
