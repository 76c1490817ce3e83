//! Conduction: flux k grad u, one component.

use super::{Jet, Material, MaterialError, Response};
use crate::linalg::{Matrix, Real, Vector, to_f64};
use std::fmt::Debug;
use std::sync::Arc;

/// A conductor with the conductivity k, constant or varying.
#[derive(Clone)]
pub struct Conductor<const N: usize, T: Real = f64> {
    law: Law<N, T>,
}

#[derive(Clone)]
enum Law<const N: usize, T: Real> {
    Constant(T),
    Varying(Arc<dyn Fn(&Vector<N, T>) -> Jet<N, T> + Send + Sync>),
}

impl<const N: usize, T: Real> Debug for Conductor<N, T> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match &self.law {
            Law::Constant(k) => f.debug_tuple("Conductor").field(k).finish(),
            Law::Varying(_) => f.write_str("Conductor(k(x))"),
        }
    }
}

impl<const N: usize, T: Real> Conductor<N, T> {
    /// Creates a conductor of constant `conductivity`.
    ///
    /// # Errors
    /// [`MaterialError::NotPositive`] unless `conductivity` is positive.
    pub fn try_new(conductivity: T) -> Result<Self, MaterialError> {
        if conductivity > T::zero() && conductivity.is_finite() {
            Ok(Self { law: Law::Constant(conductivity) })
        } else {
            Err(MaterialError::NotPositive { name: "conductivity", value: to_f64(conductivity) })
        }
    }

    /// The conductivity `k` with its gradient at every point; it must be positive.
    pub fn varying(k: impl Fn(&Vector<N, T>) -> Jet<N, T> + Send + Sync + 'static) -> Self {
        Self { law: Law::Varying(Arc::new(k)) }
    }

    /// k and its gradient at `x`.
    pub fn conductivity(&self, x: &Vector<N, T>) -> Jet<N, T> {
        match &self.law {
            Law::Constant(k) => Jet::constant(*k),
            Law::Varying(k) => k(x),
        }
    }
}

impl<const N: usize, T: Real> Material<1, N, T> for Conductor<N, T> {
    fn respond(&self, x: &Vector<N, T>, grad_u: &Matrix<1, N, T>) -> Response<1, N, T> {
        let k = self.conductivity(x).value;
        let mut tangent = [[Matrix::zeros(); N]; 1];
        for (j, entry) in tangent[0].iter_mut().enumerate() {
            entry[(0, j)] = k;
        }
        Response { stress: grad_u * k, tangent }
    }
    fn modulus(&self, x: &Vector<N, T>) -> T {
        self.conductivity(x).value
    }
    fn is_linear(&self) -> bool {
        true
    }
    fn is_homogeneous(&self) -> bool {
        matches!(self.law, Law::Constant(_))
    }
    fn check(&self, x: &Vector<N, T>) -> Result<(), MaterialError> {
        Self::try_new(self.conductivity(x).value).map(|_| ())
    }
    fn divergence(&self, x: &Vector<N, T>, grad_u: &Matrix<1, N, T>, hessian: &[Matrix<N, N, T>; 1]) -> Vector<1, T> {
        let k = self.conductivity(x);
        let along = (0..N).fold(T::zero(), |s, j| s + k.gradient[j] * grad_u[(0, j)]);
        Vector::from_element((0..N).fold(along, |s, j| s + k.value * hessian[0][(j, j)]))
    }
}
