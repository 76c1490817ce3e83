//! Source and traction of an exact solution in a body.

use super::data::{Exact, Point, continued_slope, field_derivatives, field_slope};
use super::physics::Physics;
use crate::linalg::{Matrix, Vector};
use crate::physics::{self, Material};

impl<const N: usize> Physics<N> {
    /// -div sigma(exact): the source that makes it a solution, of bodies of revolution if `is_revolved`.
    pub(super) fn exact_source(&self, exact: &dyn Exact, at: &Point, x: &Vector<N>, is_revolved: bool, out: &mut [f64]) {
        match self {
            Self::Scalar(m) => out.copy_from_slice(source::<1, N>(&**m, exact, at, x, is_revolved).as_slice()),
            Self::Vector(m) => out.copy_from_slice(source::<N, N>(&**m, exact, at, x, is_revolved).as_slice()),
        }
    }

    /// sigma n (k du/dn) of the exact solution.
    pub fn exact_traction(&self, exact: &dyn Exact, at: &Point, x: &Vector<N>, normal: &Vector<N>, out: &mut [f64]) {
        match self {
            Self::Scalar(m) => out.copy_from_slice(traction(&**m, x, field_slope::<1, N>(exact, at), normal).as_slice()),
            Self::Vector(m) => out.copy_from_slice(traction(&**m, x, field_slope::<N, N>(exact, at), normal).as_slice()),
        }
    }

    /// sigma n (k du/dn) at the point `at` of the piece of the exact solution that holds at `inside`, with the moduli at `place`.
    pub(super) fn piece_traction(
        &self,
        exact: &dyn Exact,
        at: &Point,
        [inside, place]: [&Vector<N>; 2],
        normal: &Vector<N>,
        out: &mut [f64],
    ) {
        let own = Point::new(inside.as_slice()).at_time(at.t);
        match self {
            Self::Scalar(m) => out.copy_from_slice(traction(&**m, place, continued_slope::<1, N>(exact, at, &own), normal).as_slice()),
            Self::Vector(m) => out.copy_from_slice(traction(&**m, place, continued_slope::<N, N>(exact, at, &own), normal).as_slice()),
        }
    }
}

/// -div sigma of an exact solution.
fn source<const C: usize, const N: usize>(
    material: &dyn Material<C, N>,
    exact: &dyn Exact,
    at: &Point,
    x: &Vector<N>,
    is_revolved: bool,
) -> Vector<C> {
    let (gradient, hessian) = field_derivatives::<C, N>(exact, at);
    if !is_revolved {
        return -material.divergence(x, &gradient, &hessian);
    }
    let value = Vector::from_fn(|c, _| exact.value(c, at));
    physics::revolved_source(material, x, &value, &gradient, &hessian)
}

/// sigma n of a field with its value and gradient.
fn traction<const C: usize, const N: usize>(
    material: &dyn Material<C, N>,
    x: &Vector<N>,
    (value, gradient): (Vector<C>, Matrix<C, N>),
    normal: &Vector<N>,
) -> Vector<C> {
    physics::stress_of(material, x, &value, &gradient) * normal
}
