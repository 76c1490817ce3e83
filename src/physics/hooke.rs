//! Isotropic linear elasticity: plane strain, plane stress, bodies of revolution, three dimensions.
//!
//!   sigma = lambda tr(eps) I + 2 mu eps,   eps = (grad u + grad uᵀ) / 2
//!
//! Plane stress has lambda' = 2 lambda mu / (lambda + 2 mu) in the plane and sigma_zz = 0; plane strain has
//! sigma_zz = lambda tr(eps). In bodies of revolution tr(eps) has the hoop strain u_r / r, too ([`Hoop`](super::Hoop)).

use super::{Hoop, Jet, Material, Response};
use crate::linalg::{Matrix, Real, Vector, lit, num, to_f64};
use std::fmt::Debug;
use std::sync::Arc;

/// Assumption about the out-of-plane direction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Assumption {
    /// No strain out of the plane.
    PlaneStrain,
    /// No stress out of the plane.
    PlaneStress,
    /// Bodies of revolution: x = r, y = z, nothing moves around the axis x = 0.
    Axisymmetric,
    /// Three dimensions, no assumption.
    Solid,
}

impl Assumption {
    fn name(self) -> &'static str {
        match self {
            Self::PlaneStrain => "plane strain",
            Self::PlaneStress => "plane stress",
            Self::Axisymmetric => "the stiffness of bodies of revolution",
            Self::Solid => "the stiffness in three dimensions",
        }
    }
}

/// Two elastic constants.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Elastic<X> {
    /// Young's modulus [force/area] and Poisson's ratio.
    Young {
        /// E.
        young: X,
        /// nu.
        poisson: X,
    },
    /// Lamé's constants [force/area].
    Lame {
        /// lambda.
        lambda: X,
        /// mu.
        mu: X,
    },
}

/// Error of invalid material constants.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MaterialError {
    /// A constant must be positive.
    #[error("{name} = {value} is not allowed; it must be positive")]
    NotPositive {
        /// Name of the constant.
        name: &'static str,
        /// Its value.
        value: f64,
    },
    /// Poisson's ratio makes the stiffness singular.
    #[error("poisson = {value} makes {model} singular; allowed are {allowed}")]
    Singular {
        /// The ratio.
        value: f64,
        /// The model.
        model: &'static str,
        /// Allowed range.
        allowed: &'static str,
    },
    /// Poisson's ratio is outside the range of stable materials.
    #[error("poisson = {value} is not allowed; allowed are {allowed}")]
    Ratio {
        /// The ratio.
        value: f64,
        /// Allowed range.
        allowed: &'static str,
    },
    /// lambda is too small for mu.
    #[error("lambda = {lambda} with mu = {mu} gives no stable material; lambda must be above {least}")]
    Lambda {
        /// lambda.
        lambda: f64,
        /// mu.
        mu: f64,
        /// The limit.
        least: f64,
    },
}

impl<T: Real> Elastic<T> {
    /// Whether the constants make a stable material under `assumption`.
    ///
    /// # Errors
    /// [`MaterialError`] with the constant, its value and the allowed range.
    pub fn check(&self, assumption: Assumption) -> Result<(), MaterialError> {
        let positive = |name, value: T| {
            if value > T::zero() && value.is_finite() { Ok(()) } else { Err(MaterialError::NotPositive { name, value: to_f64(value) }) }
        };
        match *self {
            Self::Young { young, poisson } => {
                positive("young", young)?;
                let (value, half) = (to_f64(poisson), lit::<T>(0.5));
                let allowed = if assumption == Assumption::PlaneStress { "-1 < poisson <= 0.5" } else { "-1 < poisson < 0.5" };
                if poisson == half && assumption != Assumption::PlaneStress || poisson == -T::one() {
                    return Err(MaterialError::Singular { value, model: assumption.name(), allowed });
                }
                if poisson > -T::one() && poisson <= half { Ok(()) } else { Err(MaterialError::Ratio { value, allowed }) }
            }
            Self::Lame { lambda, mu } => {
                positive("mu", mu)?;
                // bulk modulus lambda + 2 mu / 3 > 0
                let least = -lit::<T>(2.0) * mu / lit(3.0);
                if lambda > least && lambda.is_finite() {
                    return Ok(());
                }
                Err(MaterialError::Lambda { lambda: to_f64(lambda), mu: to_f64(mu), least: to_f64(least) })
            }
        }
    }
}

impl<const N: usize, T: Real> Elastic<Jet<N, T>> {
    /// (lambda of the model, mu).
    fn lame(self, assumption: Assumption) -> (Jet<N, T>, Jet<N, T>) {
        let c = |x: f64| Jet::constant(lit(x));
        match self {
            Self::Young { young, poisson } => {
                let mu = young / (c(2.0) * (c(1.0) + poisson));
                let lambda = match assumption {
                    // finite for poisson = 0.5
                    Assumption::PlaneStress => young * poisson / (c(1.0) - poisson * poisson),
                    _ => young * poisson / ((c(1.0) + poisson) * (c(1.0) - c(2.0) * poisson)),
                };
                (lambda, mu)
            }
            Self::Lame { lambda, mu } => match assumption {
                Assumption::PlaneStress => (c(2.0) * lambda * mu / (lambda + c(2.0) * mu), mu),
                _ => (lambda, mu),
            },
        }
    }
}

/// Hooke's law.
#[derive(Clone)]
pub struct Hooke<const N: usize, T: Real = f64> {
    assumption: Assumption,
    law: Law<N, T>,
}

#[derive(Clone)]
enum Law<const N: usize, T: Real> {
    Constant(T, T),
    Varying(Arc<dyn Fn(&Vector<N, T>) -> Elastic<Jet<N, T>> + Send + Sync>),
}

impl<const N: usize, T: Real> Debug for Hooke<N, T> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let mut out = f.debug_struct("Hooke");
        out.field("assumption", &self.assumption);
        if let Law::Constant(lambda, mu) = &self.law {
            out.field("lambda", lambda).field("mu", mu);
        }
        out.finish_non_exhaustive()
    }
}

impl<T: Real> Hooke<2, T> {
    /// Plane strain of `young` [force/area] and `poisson`.
    ///
    /// # Errors
    /// [`MaterialError`] for constants that make no stable material.
    pub fn plane_strain(young: T, poisson: T) -> Result<Self, MaterialError> {
        Self::try_new(Elastic::Young { young, poisson }, Assumption::PlaneStrain)
    }

    /// Plane stress of `young` [force/area] and `poisson`.
    ///
    /// # Errors
    /// [`MaterialError`] for constants that make no stable material.
    pub fn plane_stress(young: T, poisson: T) -> Result<Self, MaterialError> {
        Self::try_new(Elastic::Young { young, poisson }, Assumption::PlaneStress)
    }

    /// Bodies of revolution of `young` [force/area] and `poisson`.
    ///
    /// # Errors
    /// [`MaterialError`] for constants that make no stable material.
    pub fn axisymmetric(young: T, poisson: T) -> Result<Self, MaterialError> {
        Self::try_new(Elastic::Young { young, poisson }, Assumption::Axisymmetric)
    }
}

impl<T: Real> Hooke<3, T> {
    /// Three dimensions, `young` [force/area] and `poisson`.
    ///
    /// # Errors
    /// [`MaterialError`] for constants that make no stable material.
    pub fn solid(young: T, poisson: T) -> Result<Self, MaterialError> {
        Self::try_new(Elastic::Young { young, poisson }, Assumption::Solid)
    }
}

impl<const N: usize, T: Real> Hooke<N, T> {
    /// Creates the homogeneous material of `constants` under `assumption`.
    ///
    /// # Errors
    /// [`MaterialError`] for constants that make no stable material.
    pub fn try_new(constants: Elastic<T>, assumption: Assumption) -> Result<Self, MaterialError> {
        constants.check(assumption)?;
        let jets = match constants {
            Elastic::Young { young, poisson } => Elastic::Young { young: Jet::constant(young), poisson: Jet::constant(poisson) },
            Elastic::Lame { lambda, mu } => Elastic::Lame { lambda: Jet::constant(lambda), mu: Jet::constant(mu) },
        };
        let (lambda, mu) = Elastic::<Jet<N, T>>::lame(jets, assumption);
        Ok(Self { assumption, law: Law::Constant(lambda.value, mu.value) })
    }

    /// Constants with their gradients at every point; they must pass [`Elastic::check`] there.
    pub fn varying(constants: impl Fn(&Vector<N, T>) -> Elastic<Jet<N, T>> + Send + Sync + 'static, assumption: Assumption) -> Self {
        Self { assumption, law: Law::Varying(Arc::new(constants)) }
    }

    /// Assumption about the out-of-plane direction.
    pub fn assumption(&self) -> Assumption {
        self.assumption
    }

    /// (lambda of the model, mu) [force/area] with their gradients at `x`.
    pub fn lame(&self, x: &Vector<N, T>) -> (Jet<N, T>, Jet<N, T>) {
        match &self.law {
            Law::Constant(lambda, mu) => (Jet::constant(*lambda), Jet::constant(*mu)),
            Law::Varying(at) => at(x).lame(self.assumption),
        }
    }
}

impl<const N: usize, T: Real> Material<N, N, T> for Hooke<N, T> {
    fn respond(&self, x: &Vector<N, T>, grad_u: &Matrix<N, N, T>) -> Response<N, N, T> {
        let (lambda, mu) = self.lame(x);
        let (lambda, mu) = (lambda.value, mu.value);
        let mut tangent = [[Matrix::zeros(); N]; N];
        for i in 0..N {
            for j in 0..N {
                let entry: &mut Matrix<N, N, T> = &mut tangent[i][j];
                entry[(i, j)] += mu;
                entry[(j, i)] += mu;
                if i == j {
                    for k in 0..N {
                        entry[(k, k)] += lambda;
                    }
                }
            }
        }
        Response { stress: stress(lambda, mu, grad_u), tangent }
    }
    fn modulus(&self, x: &Vector<N, T>) -> T {
        let (lambda, mu) = self.lame(x);
        lambda.value + num::<T>(2) * mu.value
    }
    fn hoop(&self, x: &Vector<N, T>) -> Option<Hoop<N, N, T>> {
        if self.assumption != Assumption::Axisymmetric {
            return None;
        }
        let (lambda, mu) = self.lame(x);
        let modulus = lambda.value + num::<T>(2) * mu.value;
        Some(Hoop { coupling: Matrix::identity() * lambda.value, divergence: lambda.gradient, modulus })
    }
    fn is_linear(&self) -> bool {
        true
    }
    fn is_homogeneous(&self) -> bool {
        matches!(self.law, Law::Constant(..))
    }
    fn check(&self, x: &Vector<N, T>) -> Result<(), MaterialError> {
        let Law::Varying(at) = &self.law else { return Ok(()) };
        let values = match at(x) {
            Elastic::Young { young, poisson } => Elastic::Young { young: young.value, poisson: poisson.value },
            Elastic::Lame { lambda, mu } => Elastic::Lame { lambda: lambda.value, mu: mu.value },
        };
        values.check(self.assumption)
    }
    fn spatial_stress(&self, x: &Vector<N, T>, grad_u: &Matrix<N, N, T>) -> [T; 6] {
        let (lambda, mu) = self.lame(x);
        let stress = stress(lambda.value, mu.value, grad_u);
        let at = |k: usize, l: usize| if k < N && l < N { stress[(k, l)] } else { T::zero() };
        let zz = if N < 3 && self.assumption == Assumption::PlaneStrain { lambda.value * trace(grad_u) } else { at(2, 2) };
        [at(0, 0), at(1, 1), zz, at(0, 1), at(1, 2), at(0, 2)]
    }
    fn spatial_strain(&self, x: &Vector<N, T>, grad_u: &Matrix<N, N, T>) -> [T; 6] {
        let at = |k: usize, l: usize| if k < N && l < N { (grad_u[(k, l)] + grad_u[(l, k)]) * lit(0.5) } else { T::zero() };
        let zz = if self.assumption == Assumption::PlaneStress {
            // sigma_zz = 0 with lambda' = 2 lambda mu / (lambda + 2 mu)
            let (lambda, mu) = self.lame(x);
            -lambda.value / (num::<T>(2) * mu.value) * trace(grad_u)
        } else {
            at(2, 2)
        };
        [at(0, 0), at(1, 1), zz, at(0, 1), at(1, 2), at(0, 2)]
    }
    fn divergence(&self, x: &Vector<N, T>, grad_u: &Matrix<N, N, T>, hessian: &[Matrix<N, N, T>; N]) -> Vector<N, T> {
        let (lambda, mu) = self.lame(x);
        let divergence = trace(grad_u);
        // grad lambda tr eps + 2 eps grad mu + (lambda + mu) grad div u + mu lap u
        Vector::from_fn(|k, _| {
            let mut sum = lambda.gradient[k] * divergence;
            for j in 0..N {
                sum += mu.gradient[j] * (grad_u[(k, j)] + grad_u[(j, k)]);
                sum += (lambda.value + mu.value) * hessian[j][(j, k)] + mu.value * hessian[k][(j, j)];
            }
            sum
        })
    }
}

/// lambda tr(eps) I + 2 mu eps.
fn stress<const N: usize, T: Real>(lambda: T, mu: T, grad_u: &Matrix<N, N, T>) -> Matrix<N, N, T> {
    let pressure = lambda * trace(grad_u);
    Matrix::from_fn(|k, l| {
        let shear = mu * (grad_u[(k, l)] + grad_u[(l, k)]);
        if k == l { shear + pressure } else { shear }
    })
}

fn trace<const N: usize, T: Real>(a: &Matrix<N, N, T>) -> T {
    (0..N).fold(T::zero(), |s, k| s + a[(k, k)])
}
