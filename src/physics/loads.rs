//! Loads on sides as functions of place and outward normal, for [`trace_load`](crate::assembly::trace_load).

use super::Material;
use crate::linalg::{Matrix, Real, Vector};

/// Pressure [force/area] along minus the outward normal.
pub fn pressure<const N: usize, T: Real>(p: impl Fn(&Vector<N, T>) -> T) -> impl Fn(&Vector<N, T>, &Vector<N, T>) -> Vector<N, T> {
    move |x, n| n * -p(x)
}

/// Force per area.
pub fn traction<const N: usize, T: Real>(
    t: impl Fn(&Vector<N, T>) -> Vector<N, T>,
) -> impl Fn(&Vector<N, T>, &Vector<N, T>) -> Vector<N, T> {
    move |x, _| t(x)
}

/// The flux k du/dn.
pub fn neumann<const N: usize, T: Real>(g: impl Fn(&Vector<N, T>) -> T) -> impl Fn(&Vector<N, T>, &Vector<N, T>) -> Vector<1, T> {
    move |x, _| Vector::from_element(g(x))
}

/// sigma n (k du/dn) of a field with the gradient `grad_u`, without what a hoop strain adds ([`stress_of`](super::stress_of) has it).
pub fn exact_traction<const C: usize, const N: usize, T: Real, M: Material<C, N, T> + ?Sized>(
    material: &M,
    grad_u: impl Fn(&Vector<N, T>) -> Matrix<C, N, T>,
) -> impl Fn(&Vector<N, T>, &Vector<N, T>) -> Vector<C, T> {
    move |x, n| material.respond(x, &grad_u(x)).stress * n
}
