//! Stress and energy of discrete fields.

use super::{Material, hoop_strain, is_of_revolution};
use crate::assembly::fields_keeping;
use crate::linalg::{Matrix, Operator, Real, Vector, lit, num};
use crate::quadrature::Quadrature;
use crate::space::{Field, FieldAt, Space, field_at};

/// A field and its stress at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stress<const C: usize, const N: usize, T: Real = f64> {
    /// Position \[length\].
    pub x: Vector<N, T>,
    /// u.
    pub value: Vector<C, T>,
    /// `gradient[(i, j)]` = du_i/dx_j.
    pub gradient: Matrix<C, N, T>,
    /// sigma of the model; for Poisson the row k grad u.
    pub stress: Matrix<C, N, T>,
    /// Components xx yy zz xy yz xz [force/area], including those out of the plane; of bodies of revolution rr, zz, the hoop stress, rz.
    pub spatial: [T; 6],
    /// The strain in the same order: eps_kl = (du_k/dx_l + du_l/dx_k) / 2, and the strains out of the plane; zero for Poisson.
    pub strain: [T; 6],
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
    let states = field_at::<C, N, T, S>(space, &Field { first: 0, components: C }, u, element, xi);
    let axis = if is_of_revolution(material) { space.bounds(element).diagonal() * lit(ON_AXIS) } else { T::zero() };
    states.iter().map(|state| stressed(material, state, axis)).collect()
}

/// `visit(element, stresses)` of every element, ascending: the field `u` and its stress at the points of its rule.
///
/// Cheaper than [`stress_at`] element by element: see [`crate::assembly::fields`].
///
/// # Panics
/// If `u` is shorter than C times the number of functions and not empty.
pub fn stresses<const C: usize, const N: usize, T, S, Q, M, R>(
    space: &S,
    quadrature: &Q,
    material: &M,
    u: &[T],
    visit: &(impl Fn(usize, &[Stress<C, N, T>]) -> R + Sync),
) -> Vec<R>
where
    T: Real,
    S: Space<N, N, T> + ?Sized,
    Q: Quadrature<N, T> + ?Sized,
    M: Material<C, N, T> + ?Sized,
    R: Send,
{
    fields_keeping(space, quadrature, u, &|stresses: &mut Vec<Stress<C, N, T>>, element, states: &[FieldAt<C, N, T>]| {
        stresses.clear();
        stresses.extend(states.iter().map(|state| stressed(material, state, T::zero())));
        visit(element, stresses)
    })
}

/// Points that are closer to the axis of revolution than this share of their element's size have the hoop strain of the axis.
const ON_AXIS: f64 = 1e-9;

/// Stress of `material` for the field and gradient `state` at a point; within `axis` of the axis of revolution it is that on the axis.
fn stressed<const C: usize, const N: usize, T, M>(material: &M, state: &FieldAt<C, N, T>, axis: T) -> Stress<C, N, T>
where
    T: Real,
    M: Material<C, N, T> + ?Sized,
{
    let FieldAt { x, value, gradient } = *state;
    let (mut stress, mut spatial) = (material.respond(&x, &gradient).stress, material.spatial_stress(&x, &gradient));
    let mut around = material.spatial_strain(&x, &gradient);
    if let Some(hoop) = material.hoop(&x) {
        let strain = hoop_strain(&x, &value, &gradient, axis);
        stress += hoop.coupling * strain;
        spatial[0] = stress[(0, 0)];
        (spatial[1], spatial[3]) = (stress[(1, 1)], stress[(0, 1)]);
        spatial[2] = hoop.stress(&gradient, strain);
        around[2] = strain;
    }
    Stress { x, value, gradient, stress, spatial, strain: around }
}

/// The von Mises stress of xx yy zz xy yz xz.
pub fn von_mises<T: Real>(s: &[T; 6]) -> T {
    let [xx, yy, zz, xy, yz, xz] = *s;
    let square = |a: T| a * a;
    let normal = square(xx - yy) + square(yy - zz) + square(zz - xx);
    let shear = square(xy) + square(yz) + square(xz);
    (normal * lit(0.5) + num::<T>(3) * shear).sqrt()
}

/// The eigenvalues of the symmetric tensor xx yy zz xy yz xz, the largest first; NaN where an entry is not finite.
pub fn principal(s: &[f64; 6]) -> [f64; 3] {
    // the iteration for eigenvalues would not end
    if !s.iter().all(|v| v.is_finite()) {
        return [f64::NAN; 3];
    }
    let [xx, yy, zz, xy, yz, xz] = *s;
    let mut values = Matrix::<3, 3>::new(xx, xy, xz, xy, yy, yz, xz, yz, zz).symmetric_eigenvalues();
    values.as_mut_slice().sort_by(|a, b| b.total_cmp(a));
    values.into()
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
