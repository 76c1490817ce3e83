//! Floor 7: materials, stresses, fluxes. Poisson is elasticity with one component.

use crate::assembly::Tangent;
use crate::linalg::{Matrix, Real, Vector};
use std::fmt::Debug;

/// Stress and its derivative at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Response<const C: usize, const N: usize, T: Real = f64> {
    /// sigma_(k,l) [force/area]; for Poisson the row k grad u.
    pub stress: Matrix<C, N, T>,
    /// d stress / d grad_u.
    pub tangent: Tangent<C, N, T>,
}

/// Stress as a function of place and displacement gradient.
pub trait Material<const C: usize, const N: usize, T: Real = f64>: Debug + Send + Sync {
    /// Stress and tangent at `x` for the gradient `grad_u[(i, j)]` = du_i/dx_j.
    fn respond(&self, x: &Vector<N, T>, grad_u: &Matrix<C, N, T>) -> Response<C, N, T>;
    /// A modulus [force/area] at `x` that scales penalty and Nitsche terms.
    fn modulus(&self, x: &Vector<N, T>) -> T;
    /// Whether the tangent does not depend on `grad_u`.
    fn is_linear(&self) -> bool {
        false
    }
}

impl<const C: usize, const N: usize, T: Real, X: Material<C, N, T> + ?Sized> Material<C, N, T> for Box<X> {
    fn respond(&self, x: &Vector<N, T>, grad_u: &Matrix<C, N, T>) -> Response<C, N, T> {
        (**self).respond(x, grad_u)
    }
    fn modulus(&self, x: &Vector<N, T>) -> T {
        (**self).modulus(x)
    }
    fn is_linear(&self) -> bool {
        (**self).is_linear()
    }
}

/// sigma n (k du/dn) at a batch of points as a linear map of unknowns.
#[derive(Clone, Debug, Default)]
pub struct FluxTable<T: Real = f64> {
    /// The unknowns.
    pub dofs: Vec<usize>,
    /// Number of components of the flux.
    pub components: usize,
    /// `values[(q * components + component) * dofs.len() + a]`.
    pub values: Vec<T>,
}

/// The flux of a body on one of its traces. (S, N) stands for (N - 1, N).
pub trait Flux<const S: usize, const N: usize, T: Real = f64>: Debug + Send + Sync {
    /// sigma n at local points `xi` of the trace's `element`.
    fn tabulate(&self, element: usize, xi: &[Vector<S, T>], table: &mut FluxTable<T>);
    /// A bound of the flux by the energy on the element behind [modulus / length].
    fn stabilisation(&self, element: usize) -> T;
}
