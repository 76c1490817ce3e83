//! The direction around the axis of bodies of revolution: x = r, y = z, u = (u_r, u_z), and the strain e_tt = u_r / r.
//!
//! With the stress sigma in the half plane and the hoop stress s_tt, both linear in grad u and e_tt, the virtual work per volume is
//!
//! ```text
//! sigma : grad v + s_tt v_r / r,    sigma = tangent : grad u + coupling e_tt,    s_tt = coupling : grad u + modulus e_tt,
//! ```
//!
//! and the force per volume in equilibrium with it
//!
//! ```text
//! -(div sigma)_k - (sigma_kr - delta_kr s_tt) / r.
//! ```
//!
//! Source: Timoshenko, Goodier, Theory of Elasticity, 3rd ed. (1970), art. 117.

use super::Material;
use crate::assembly::LowerOrder;
use crate::linalg::{Matrix, Real, Vector};

/// Terms that a linear material adds around the axis, at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hoop<const C: usize, const N: usize, T: Real = f64> {
    /// d sigma / d e_tt, and d s_tt / d grad u [force/area].
    pub coupling: Matrix<C, N, T>,
    /// The divergence of `coupling`, zero where the material is homogeneous [force/volume].
    pub divergence: Vector<C, T>,
    /// d s_tt / d e_tt [force/area].
    pub modulus: T,
}

impl<const C: usize, const N: usize, T: Real> Hoop<C, N, T> {
    /// The terms of the form at the distance `r` from the axis.
    pub(super) fn terms(&self, r: T) -> LowerOrder<C, N, T> {
        let mixed = std::array::from_fn(|e| if e == 0 { self.coupling / r } else { Matrix::zeros() });
        let value = Matrix::from_fn(|c, e| if (c, e) == (0, 0) { self.modulus / (r * r) } else { T::zero() });
        LowerOrder { mixed: Some(mixed), value }
    }

    /// s_tt for a gradient and a hoop strain.
    pub(super) fn stress(&self, gradient: &Matrix<C, N, T>, strain: T) -> T {
        self.coupling.dot(gradient) + self.modulus * strain
    }

    /// Part of the hoop strain in twice the energy per volume [energy/volume].
    pub(crate) fn energy(&self, gradient: &Matrix<C, N, T>, strain: T) -> T {
        (self.coupling.dot(gradient) + self.stress(gradient, strain)) * strain
    }
}

/// e_tt = u_r / r; within `axis` of the axis du_r/dr, its limit where u_r vanishes on the axis.
pub fn hoop_strain<const C: usize, const N: usize, T: Real>(
    x: &Vector<N, T>,
    value: &Vector<C, T>,
    gradient: &Matrix<C, N, T>,
    axis: T,
) -> T {
    if x[0].abs() > axis { value[0] / x[0] } else { gradient[(0, 0)] }
}

/// sigma of a field of `value` and `gradient` at `x`, the part of the hoop strain included where the material has one.
pub fn stress_of<const C: usize, const N: usize, T: Real, M: Material<C, N, T> + ?Sized>(
    material: &M,
    x: &Vector<N, T>,
    value: &Vector<C, T>,
    gradient: &Matrix<C, N, T>,
) -> Matrix<C, N, T> {
    let stress = material.respond(x, gradient).stress;
    match material.hoop(x) {
        Some(hoop) => stress + hoop.coupling * hoop_strain(x, value, gradient, T::zero()),
        None => stress,
    }
}

/// The force per volume -div sigma of a field around the axis, for its second derivatives `hessian[i][(j, k)]` = d2u_i/dx_j dx_k; `x[0] > 0`.
///
/// Of a material without hoop strain, conduction, it is -(div sigma + sigma_r / r).
pub fn revolved_source<const C: usize, const N: usize, T: Real, M: Material<C, N, T> + ?Sized>(
    material: &M,
    x: &Vector<N, T>,
    value: &Vector<C, T>,
    gradient: &Matrix<C, N, T>,
    hessian: &[Matrix<N, N, T>; C],
) -> Vector<C, T> {
    let r = x[0];
    let mut divergence = material.divergence(x, gradient, hessian) + stress_of(material, x, value, gradient).column(0) / r;
    if let Some(hoop) = material.hoop(x) {
        let strain = value[0] / r;
        // d e_tt / dx_l
        let slope = Vector::<N, T>::from_fn(|l, _| (gradient[(0, l)] - if l == 0 { strain } else { T::zero() }) / r);
        divergence += hoop.coupling * slope + hoop.divergence * strain;
        divergence[0] -= hoop.stress(gradient, strain) / r;
    }
    -divergence
}
