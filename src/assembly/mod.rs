//! Floor 6: sums over elements. Gets coefficients per point, never a material.

mod blocks;
mod bulk;
mod cells;
mod dirichlet;
mod fields;
mod graph;
mod load;
mod matrix_free;
pub mod norms;
mod pattern;
mod places;
mod plain;
mod reduce;
mod reduced_matrix;
mod rim;
mod rules;
mod scratch;
mod source;
mod tensor;

use crate::linalg::{Matrix, Real, Vector};
use std::fmt::Debug;

pub use blocks::Blocks;
pub use bulk::{Assembler, add_stiffness, mass, refill_stiffness, stiffness};
pub use dirichlet::{DirichletError, Fixed, SideCorner, dirichlet, dirichlet_with, planar_normal, side_corners};
pub use fields::fields;
pub(crate) use fields::fields_keeping;
pub use load::{Moments, load, load_with_moments, measure, trace_load, trace_springs};
pub use matrix_free::MatrixFree;
pub use norms::{Errors, Norms, difference, errors};
pub use pattern::Pattern;
pub use places::places;
pub(crate) use plain::element_stiffness;
pub use reduce::{Equation, Reduced, ReductionError};
pub use rim::{Pinned, Rim};
pub use rules::element_rule;
pub use rules::{gauss_rules, gauss_rules_along, points_of_curved_cells};
pub(crate) use scratch::{Scratch, inverse_or_nan};

/// d stress / d grad_u: `tangent[i][j][(k, l)]` = d sigma_(k,l) / d (grad u)_(i,j), i, k components, j, l directions.
/// One C x N matrix (shaped like the stress) per entry (i, j) of grad_u.
pub type Tangent<const C: usize, const N: usize, T = f64> = [[Matrix<C, N, T>; N]; C];

/// The tangent at the points of an element.
#[non_exhaustive]
pub enum Coefficient<'a, const C: usize, const N: usize, T: Real = f64> {
    /// One tangent everywhere.
    Constant(Tangent<C, N, T>),
    /// A tangent per physical point.
    PerPoint(Box<dyn Fn(&Vector<N, T>) -> Tangent<C, N, T> + Send + Sync + 'a>),
}

impl<const C: usize, const N: usize, T: Real> Debug for Coefficient<'_, C, N, T> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Constant(tangent) => f.debug_tuple("Constant").field(tangent).finish(),
            Self::PerPoint(_) => f.write_str("PerPoint(..)"),
        }
    }
}

impl<const C: usize, const N: usize, T: Real> Coefficient<'_, C, N, T> {
    /// The tangent at the physical point `x`.
    pub fn at(&self, x: &Vector<N, T>) -> Tangent<C, N, T> {
        match self {
            Self::Constant(tangent) => *tangent,
            Self::PerPoint(f) => f(x),
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

impl<const C: usize, const N: usize, T: Real> Form<'_, C, N, T> {
    /// ∫ grad v : grad u dx, component by component.
    pub fn laplace() -> Self {
        let mut tangent = [[Matrix::zeros(); N]; C];
        for (i, row) in tangent.iter_mut().enumerate() {
            for (j, entry) in row.iter_mut().enumerate() {
                entry[(i, j)] = T::one();
            }
        }
        Self { coefficient: Coefficient::Constant(tangent), symmetric: true }
    }
}

/// tangent : grad, the stress of the gradient `grad`.
#[inline]
pub fn contract<const C: usize, const N: usize, T: Real>(tangent: &Tangent<C, N, T>, grad: &Matrix<C, N, T>) -> Matrix<C, N, T> {
    let mut stress = Matrix::zeros();
    for (i, row) in tangent.iter().enumerate() {
        for (j, entry) in row.iter().enumerate() {
            stress += entry * grad[(i, j)];
        }
    }
    stress
}
