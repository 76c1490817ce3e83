//! Floor 6: sums over elements. Gets coefficients per point, never a material.

mod blocks;
mod bulk;
mod dirichlet;
mod dof_coordinates;
mod fields;
mod graph;
mod halved;
mod internal_force;
mod kernels;
mod load;
mod lower_order;
mod lower_sums;
mod matrix_free;
pub mod norms;
mod pattern;
mod plain;
mod reduce;
mod reduced_matrix;
mod rim;
mod rules;
mod scratch;
mod simd_cells;
mod source;
mod sum_factorization;
mod vectors;

use crate::linalg::{Matrix, Real, Vector};
use std::fmt::Debug;

pub use blocks::Blocks;
pub use bulk::{Assembler, add_stiffness, mass, refill_stiffness, stiffness};
pub use dirichlet::{DirichletError, Prescribed, SideCorner, dirichlet, dirichlet_with, planar_normal, side_corners};
pub use dof_coordinates::dof_coordinates;
pub use fields::fields;
pub(crate) use fields::fields_keeping;
pub use halved::{Halved, HalvedScratch};
pub use internal_force::{Collapsed, internal_force};
pub use load::{Moments, load, load_with_moments, measure, trace_load, trace_springs};
pub use lower_order::LowerOrder;
pub(crate) use lower_sums::element_matrix;
pub use matrix_free::MatrixFree;
pub use norms::{Errors, Norms, difference, errors};
pub use pattern::Pattern;
pub(crate) use reduce::consistent;
pub use reduce::{Equation, Reduced, ReductionError};
pub use rim::{Pinned, Rim};
pub use rules::element_rule;
pub use rules::{gauss_rules, gauss_rules_along, points_of_curved_cells, revolved};
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
    /// A tangent per physical point and gradient of [`Form::state`] there, `gradient[(i, j)]` = du_i/dx_j: the linearisation
    /// of a stress that is not linear in grad u.
    PerState(Box<dyn Fn(&Vector<N, T>, &Matrix<C, N, T>) -> Tangent<C, N, T> + Send + Sync + 'a>),
}

impl<const C: usize, const N: usize, T: Real> Debug for Coefficient<'_, C, N, T> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Constant(tangent) => f.debug_tuple("Constant").field(tangent).finish(),
            Self::PerPoint(_) => f.write_str("PerPoint(..)"),
            Self::PerState(_) => f.write_str("PerState(..)"),
        }
    }
}

impl<const C: usize, const N: usize, T: Real> Coefficient<'_, C, N, T> {
    /// The tangent at the physical point `x`, where the state has the gradient `gradient`.
    pub fn at(&self, x: &Vector<N, T>, gradient: &Matrix<C, N, T>) -> Tangent<C, N, T> {
        match self {
            Self::Constant(tangent) => *tangent,
            Self::PerPoint(f) => f(x),
            Self::PerState(f) => f(x, gradient),
        }
    }
}

/// The bilinear form a(u, v) = ∫ grad v : tangent : grad u dx, with terms of [lower order](LowerOrder) if it has any.
///
/// Terms of lower order are added element by element to whatever way computes the others: matrices, products of [`MatrixFree`] and energy
/// norms have them all.
///
/// With [`Coefficient::PerState`] the tangent at a point depends on the gradient of a known field, the state. For the derivative
/// of a stress with respect to grad u, the matrix of the form is the derivative of [`internal_force`] with respect to its
/// unknowns, taken at the state. All ways to assemble a form, and [`MatrixFree`], evaluate the state along with the map;
/// nothing is stored per point, except by [`MatrixFree::new`].
pub struct Form<'a, const C: usize, const N: usize, T: Real = f64> {
    /// The tangent.
    pub coefficient: Coefficient<'a, C, N, T>,
    /// Whether `tangent[i][j][(k, l)] = tangent[k][l][(i, j)]`.
    pub symmetric: bool,
    /// The unknowns of the state, unknown = C * function + component, of the space on which the form is assembled; empty: its
    /// gradient is zero. Only [`Coefficient::PerState`] depends on it.
    pub state: &'a [T],
    lower: Option<Box<lower_order::LowerFn<'a, C, N, T>>>,
}

impl<const C: usize, const N: usize, T: Real> Debug for Form<'_, C, N, T> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let mut out = f.debug_struct("Form");
        out.field("coefficient", &self.coefficient).field("symmetric", &self.symmetric).field("state", &self.state);
        out.field("lower", &self.lower.as_ref().map(|_| "..")).finish()
    }
}

impl<'a, const C: usize, const N: usize, T: Real> Form<'a, C, N, T> {
    /// Creates the form of `coefficient` at a state whose gradient is zero.
    pub fn new(coefficient: Coefficient<'a, C, N, T>, symmetric: bool) -> Self {
        Self { coefficient, symmetric, state: &[], lower: None }
    }

    /// The form at the state of the unknowns `state`.
    #[must_use]
    pub fn with_state(self, state: &'a [T]) -> Self {
        Self { state, ..self }
    }

    /// The form with terms of lower order beside those that it has; `lower` returns them at a physical point. `symmetric` holds for them, too.
    #[must_use]
    pub fn with_lower_order(mut self, lower: impl Fn(&Vector<N, T>) -> LowerOrder<C, N, T> + Send + Sync + 'a) -> Self {
        self.lower = Some(match self.lower.take() {
            None => Box::new(lower),
            Some(before) => Box::new(move |x| before(x).plus(lower(x))),
        });
        self
    }

    /// Panics unless the state is empty or has C unknowns for each of the `functions` of a space.
    fn check_state(&self, functions: usize) {
        check_field::<C, T>(self.state, functions);
    }

    /// ∫ grad v : grad u dx, component by component.
    pub fn laplace() -> Self {
        let mut tangent = [[Matrix::zeros(); N]; C];
        for (i, row) in tangent.iter_mut().enumerate() {
            for (j, entry) in row.iter_mut().enumerate() {
                entry[(i, j)] = T::one();
            }
        }
        Self::new(Coefficient::Constant(tangent), true)
    }
}

/// Panics unless `u` is empty or has C unknowns for each of the `functions` of a space.
fn check_field<const C: usize, T>(u: &[T], functions: usize) {
    let (found, wanted) = (u.len(), C * functions);
    assert!(found == 0 || found == wanted, "a state of {C} components on {functions} functions has {wanted} unknowns, not {found}");
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
