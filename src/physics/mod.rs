//! Floor 7: materials, stresses, fluxes. Poisson is elasticity with one component.

mod flux;
mod hooke;
mod hoop;
mod jet;
mod loads;
mod poisson;
mod stress;

use crate::assembly::{Coefficient, Form, Tangent};
use crate::linalg::{Matrix, Real, Vector, lit};
use std::fmt::Debug;

pub use flux::BodyFlux;
pub use hooke::{Assumption, Elastic, Hooke, MaterialError};
pub use hoop::{Hoop, hoop_strain, revolved_source, stress_of};
pub use jet::Jet;
pub use loads::{exact_traction, neumann, pressure, traction};
pub use poisson::Conductor;
pub use stress::{Stress, energy, principal, stress_at, stresses, von_mises};

/// Stress and its derivative at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Response<const C: usize, const N: usize, T: Real = f64> {
    /// sigma_(k,l) [force/area]; for Poisson the row k grad u.
    pub stress: Matrix<C, N, T>,
    /// d stress / d grad_u, indexed as [`Tangent`].
    pub tangent: Tangent<C, N, T>,
}

/// Stress as a function of place and displacement gradient; the tangent is symmetric (there is an energy).
pub trait Material<const C: usize, const N: usize, T: Real = f64>: Debug + Send + Sync {
    /// Stress and tangent at `x`, without what a hoop strain adds, for the gradient `grad_u[(i, j)]` = du_i/dx_j.
    fn respond(&self, x: &Vector<N, T>, grad_u: &Matrix<C, N, T>) -> Response<C, N, T>;
    /// A modulus [force/area] at `x` that scales penalty and Nitsche terms.
    fn modulus(&self, x: &Vector<N, T>) -> T;
    /// Terms of the strain around the axis in bodies of revolution; `None`: the material stands for no such bodies, or, with one component,
    /// has no stress around the axis. The same kind of answer at all places with `x[0]` > 0.
    fn hoop(&self, _x: &Vector<N, T>) -> Option<Hoop<C, N, T>> {
        None
    }
    /// Whether the tangent does not depend on `grad_u`, so that the stress is tangent : grad u; [`form`] requires it.
    fn is_linear(&self) -> bool {
        false
    }
    /// Whether the response does not depend on `x`.
    fn is_homogeneous(&self) -> bool {
        false
    }
    /// Whether its constants make a stable material at `x`; asked at quadrature points before anything is assembled.
    ///
    /// # Errors
    /// [`MaterialError`] with the constant that is beyond its limits.
    fn check(&self, _x: &Vector<N, T>) -> Result<(), MaterialError> {
        Ok(())
    }
    /// The stress in space, xx yy zz xy yz xz [force/area]: components that a plane model leaves out are added here.
    fn spatial_stress(&self, x: &Vector<N, T>, grad_u: &Matrix<C, N, T>) -> [T; 6] {
        let stress = self.respond(x, grad_u).stress;
        let at = |k: usize, l: usize| if k < C && l < N { stress[(k, l)] } else { T::zero() };
        [at(0, 0), at(1, 1), at(2, 2), at(0, 1), at(1, 2), at(0, 2)]
    }
    /// The strain in space, xx yy zz xy yz xz, of the gradient alone: zero with one component, and zero out of the plane unless the material
    /// deforms there.
    fn spatial_strain(&self, _x: &Vector<N, T>, grad_u: &Matrix<C, N, T>) -> [T; 6] {
        let at = |k: usize, l: usize| if C == N && k < N && l < N { (grad_u[(k, l)] + grad_u[(l, k)]) * lit(0.5) } else { T::zero() };
        [at(0, 0), at(1, 1), at(2, 2), at(0, 1), at(1, 2), at(0, 2)]
    }
    /// div sigma [force/volume], component i the sum of d sigma_ij/dx_j, for `hessian[i][(j, k)]` = d2u_i/dx_j dx_k.
    ///
    /// A material that depends on `x` adds the derivative of its constants, which this default implementation omits.
    fn divergence(&self, x: &Vector<N, T>, grad_u: &Matrix<C, N, T>, hessian: &[Matrix<N, N, T>; C]) -> Vector<C, T> {
        let tangent = self.respond(x, grad_u).tangent;
        Vector::from_fn(|k, _| {
            let mut sum = T::zero();
            for i in 0..C {
                for j in 0..N {
                    for l in 0..N {
                        sum += tangent[i][j][(k, l)] * hessian[i][(j, l)];
                    }
                }
            }
            sum
        })
    }
}

macro_rules! forward_material {
    ($($pointer:ty),*) => {$(
        impl<const C: usize, const N: usize, T: Real, X: Material<C, N, T> + ?Sized> Material<C, N, T> for $pointer {
            fn respond(&self, x: &Vector<N, T>, grad_u: &Matrix<C, N, T>) -> Response<C, N, T> { (**self).respond(x, grad_u) }
            fn modulus(&self, x: &Vector<N, T>) -> T { (**self).modulus(x) }
            fn hoop(&self, x: &Vector<N, T>) -> Option<Hoop<C, N, T>> { (**self).hoop(x) }
            fn is_linear(&self) -> bool { (**self).is_linear() }
            fn is_homogeneous(&self) -> bool { (**self).is_homogeneous() }
            fn check(&self, x: &Vector<N, T>) -> Result<(), MaterialError> { (**self).check(x) }
            fn spatial_stress(&self, x: &Vector<N, T>, grad_u: &Matrix<C, N, T>) -> [T; 6] { (**self).spatial_stress(x, grad_u) }
            fn spatial_strain(&self, x: &Vector<N, T>, grad_u: &Matrix<C, N, T>) -> [T; 6] { (**self).spatial_strain(x, grad_u) }
            fn divergence(&self, x: &Vector<N, T>, grad_u: &Matrix<C, N, T>, hessian: &[Matrix<N, N, T>; C]) -> Vector<C, T> {
                (**self).divergence(x, grad_u, hessian)
            }
        }
    )*};
}
forward_material!(&X, Box<X>, std::sync::Arc<X>);

/// Error of a nonlinear material where a linear one is required.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{material} is not linear: its tangent at rest is another law; a linear material says so by `Material::is_linear`")]
#[non_exhaustive]
pub struct NotLinear {
    /// The material as it prints itself, at most 80 characters.
    pub material: String,
}

/// Returns `material` if it is linear.
///
/// # Errors
/// [`NotLinear`] for any other.
pub(crate) fn linear<const C: usize, const N: usize, T: Real, M: Material<C, N, T> + ?Sized>(material: &M) -> Result<&M, NotLinear> {
    if material.is_linear() { Ok(material) } else { Err(NotLinear { material: format!("{material:?}").chars().take(80).collect() }) }
}

/// The form ∫ sigma(grad u) : grad v of a linear `material`, with the work of the hoop stress where it has one: rules of bodies of revolution
/// carry 2 pi r in their weights ([`revolved`](crate::assembly::revolved)).
///
/// # Errors
/// [`NotLinear`] if [`Material::is_linear`] is false: the form would change with the state.
pub fn form<const C: usize, const N: usize, T: Real, M: Material<C, N, T> + ?Sized>(material: &M) -> Result<Form<'_, C, N, T>, NotLinear> {
    let material = linear(material)?;
    let coefficient = if material.is_homogeneous() {
        Coefficient::Constant(material.respond(&Vector::zeros(), &Matrix::zeros()).tangent)
    } else {
        Coefficient::PerPoint(Box::new(move |x: &Vector<N, T>| material.respond(x, &Matrix::zeros()).tangent))
    };
    let form = Form::new(coefficient, true);
    if !is_of_revolution(material) {
        return Ok(form);
    }
    Ok(form.with_lower_order(|x| material.hoop(x).expect("a material has a hoop strain everywhere or nowhere").terms(x[0])))
}

/// Whether a material has a strain around the axis of bodies of revolution.
pub(crate) fn is_of_revolution<const C: usize, const N: usize, T: Real, M: Material<C, N, T> + ?Sized>(material: &M) -> bool {
    material.hoop(&Vector::repeat(T::one())).is_some()
}

/// sigma n (k du/dn) at a batch of points as a linear map of unknowns.
#[derive(Clone, Debug)]
pub struct FluxTable<T: Real = f64> {
    /// The unknowns.
    pub dofs: Vec<usize>,
    /// Number of components of the flux.
    pub components: usize,
    /// `values[(q * components + component) * dofs.len() + a]`.
    pub values: Vec<T>,
}

impl<T: Real> Default for FluxTable<T> {
    fn default() -> Self {
        Self { dofs: Vec::new(), components: 0, values: Vec::new() }
    }
}

/// The flux of a body on one of its traces. (S, N) stands for (N - 1, N).
pub trait Flux<const S: usize, const N: usize, T: Real = f64>: Debug + Send + Sync {
    /// sigma n at local points `xi` of the trace's `element`.
    fn tabulate(&self, element: usize, xi: &[Vector<S, T>], table: &mut FluxTable<T>);
    /// A bound of the flux by the energy of the body's element at the facet [modulus / length]:
    /// ∫ |sigma n|² over the facet <= stabilisation ∫ sigma : grad u over the element.
    fn stabilisation(&self, element: usize) -> T;
    /// Bound of the sum over the facet of `ds` |sigma n|² over the local points `xi`, whose weights may be those of another
    /// side. By default that of the facet's own measure.
    fn stabilisation_of_sum(&self, element: usize, _xi: &[Vector<S, T>], _ds: &[T]) -> T {
        self.stabilisation(element)
    }
}
