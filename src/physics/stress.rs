//! Stress and energy of discrete fields.

use super::Material;
use crate::linalg::{Matrix, Operator, Real, Vector, lit, num};
use crate::space::{Field, Space, field_at};

/// A field and its stress at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stress<const C: usize, const N: usize, T: Real = f64> {
    /// Where.
    pub x: Vector<N, T>,
    /// u.
    pub value: Vector<C, T>,
    /// `gradient[(i, j)]` = du_i/dx_j.
    pub gradient: Matrix<C, N, T>,
    /// sigma of the model; for Poisson the row k grad u.
    pub stress: Matrix<C, N, T>,
    /// xx yy zz xy yz xz [force/area] with what a plane model leaves out.
    pub spatial: [T; 6],
}

/// The field `u` (unknown = C * function + component) and its stress at the local points `xi` of `element`.
///
/// # Panics
/// If `u` is shorter than C times the number of functions.
pub fn stress_at<const C: usize, const N: usize, T, S, M>(
    space: &S,
    material: &M,
    u: &[T],
    element: usize,
    xi: &[Vector<N, T>],
) -> Vec<Stress<C, N, T>>
where
    T: Real,
    S: Space<N, N, T> + ?Sized,
    M: Material<C, N, T> + ?Sized,
{
    field_at::<C, N, T, S>(space, &Field { first: 0, components: C }, u, element, xi)
        .into_iter()
        .map(|s| Stress {
            x: s.x,
            value: s.value,
            gradient: s.gradient,
            stress: material.respond(&s.x, &s.gradient).stress,
            spatial: material.spatial_stress(&s.x, &s.gradient),
        })
        .collect()
}

/// The von Mises stress of xx yy zz xy yz xz.
pub fn von_mises<T: Real>(s: &[T; 6]) -> T {
    let [xx, yy, zz, xy, yz, xz] = *s;
    let square = |a: T| a * a;
    let normal = square(xx - yy) + square(yy - zz) + square(zz - xx);
    let shear = square(xy) + square(yz) + square(xz);
    (normal * lit(0.5) + num::<T>(3) * shear).sqrt()
}

/// The strain energy 1/2 uᵀ K u of a linear material.
///
/// # Panics
/// If `u` is not as long as the operator is large.
pub fn energy<T: Real>(stiffness: &dyn Operator<T>, u: &[T]) -> T {
    let mut y = vec![T::zero(); stiffness.size()];
    stiffness.apply(u, &mut y);
    u.iter().zip(&y).fold(T::zero(), |s, (&a, &b)| s + a * b) * lit(0.5)
}
