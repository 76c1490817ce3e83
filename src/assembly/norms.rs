//! Norms of errors: L2, H1 semi-norm, energy.

use super::fields::{field_at, tangent_at};
use super::kernels::{Kernels, map_of};
use super::sum_factorization::QuadraturePoints;
use super::{Form, contract, lower_sums, scratch::Scratch};
use crate::linalg::{Matrix, Real, Vector, lit, to_f64};
use crate::parallel;
use crate::quadrature::Quadrature;
use crate::space::Space;

/// Norms of a field.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Norms<T: Real = f64> {
    /// (∫ |u|² dx)^1/2.
    pub l2: T,
    /// Semi-norm (∫ |grad u|² dx)^1/2.
    pub h1: T,
    /// a(u, u)^1/2.
    pub energy: T,
}

impl<T: Real> Norms<T> {
    /// The norms over two bodies from the norms over each.
    #[must_use]
    pub fn hypot(self, other: Self) -> Self {
        let h = |a: T, b: T| (a * a + b * b).sqrt();
        Self { l2: h(self.l2, other.l2), h1: h(self.h1, other.h1), energy: h(self.energy, other.energy) }
    }
}

/// Norms of the error and of the exact field.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Errors<T: Real = f64> {
    /// Of u - exact.
    pub error: Norms<T>,
    /// Of the exact field.
    pub exact: Norms<T>,
}

impl<T: Real> Errors<T> {
    /// The norms over two bodies from the norms over each.
    #[must_use]
    pub fn hypot(self, other: Self) -> Self {
        Self { error: self.error.hypot(other.error), exact: self.exact.hypot(other.exact) }
    }
}

/// Norms of `u` minus an exact field, given as value and gradient at a physical point.
///
/// `u` holds unknown = C * function + component; an empty `u` is zero. Take more points than for the stiffness.
/// Same bits for any number of threads.
///
/// # Panics
/// If `u` is shorter than C times the number of functions and not empty, or if the state of `form` is neither empty nor C times as
/// long as the number of functions.
pub fn errors<const C: usize, const N: usize, T, S, Q>(
    space: &S,
    quadrature: &Q,
    form: &Form<'_, C, N, T>,
    u: &[T],
    exact: &(impl Fn(&Vector<N, T>) -> (Vector<C, T>, Matrix<C, N, T>) + Sync + ?Sized),
) -> Errors<T>
where
    T: Real,
    S: Space<N, N, T> + ?Sized,
    Q: Quadrature<N, T> + ?Sized,
{
    difference(space, quadrature, form, u, &|_, _, x| exact(x))
}

/// Norms of `u` minus another field, given as value and gradient at (element, local point, physical point): fields on
/// other spaces over the same or a nested grid need no search.
///
/// # Panics
/// If `u` is shorter than C times the number of functions and not empty, or if the state of `form` is neither empty nor C times as
/// long as the number of functions.
pub fn difference<const C: usize, const N: usize, T, S, Q>(
    space: &S,
    quadrature: &Q,
    form: &Form<'_, C, N, T>,
    u: &[T],
    other: &(impl Fn(usize, &Vector<N, T>, &Vector<N, T>) -> (Vector<C, T>, Matrix<C, N, T>) + Sync + ?Sized),
) -> Errors<T>
where
    T: Real,
    S: Space<N, N, T> + ?Sized,
    Q: Quadrature<N, T> + ?Sized,
{
    form.check_state(space.num_functions());
    let map = || map_of::<N, N, T, S>(space);
    let answer = |sites: &QuadraturePoints, out: &mut [f64]| {
        let per_lane = sites.xi.len() / (N * sites.elements.len().max(1));
        let points = sites.x.chunks_exact(N).zip(sites.xi.chunks_exact(N));
        for (k, ((x, xi), out)) in points.zip(out.chunks_exact_mut(C + C * N)).enumerate() {
            let vector = |x: &[f64]| Vector::<N, T>::from_fn(|k, _| lit(x[k]));
            let (value, gradient) = other(sites.elements[k / per_lane], &vector(xi), &vector(x));
            for c in 0..C {
                out[c] = to_f64(value[c]);
                for j in 0..N {
                    out[C + c * N + j] = to_f64(gradient[(c, j)]);
                }
            }
        }
    };
    let whole = |mut total: [T; 6]| {
        if let Some(lower) = &form.lower {
            let [error, exact] = lower_sums::squares(space, quadrature, &**lower, u, &|e, xi, x| other(e, xi, x));
            total[2] += error;
            total[5] += exact;
        }
        roots(total)
    };
    if let Some(squares) = Kernels::new(space, quadrature, &map).deviation(form, u, &answer) {
        return whole(squares.map(lit));
    }
    let squares: Vec<[T; 6]> = parallel::map_init(space.num_elements(), Scratch::<N, N, T>::default, |scratch, e| {
        let rule = quadrature.rule(e);
        scratch.gradients(space, e, rule);
        let mut sums = [T::zero(); 6];
        for q in 0..scratch.dx.len() {
            let (dx, x) = (scratch.dx[q], scratch.map.x[q]);
            let (value, gradient) = other(e, &rule.points[q], &x);
            let at = field_at::<C, N, T>(scratch, u, q);
            let tangent = tangent_at(scratch, form, q);
            let (ev, eg) = (at.value - value, at.gradient - gradient);
            let terms = [
                ev.norm_squared(),
                eg.norm_squared(),
                contract(&tangent, &eg).dot(&eg),
                value.norm_squared(),
                gradient.norm_squared(),
                contract(&tangent, &gradient).dot(&gradient),
            ];
            for (sum, term) in sums.iter_mut().zip(terms) {
                *sum += dx * term;
            }
        }
        sums
    });
    let mut total = [T::zero(); 6];
    for element in &squares {
        for (sum, &term) in total.iter_mut().zip(element) {
            *sum += term;
        }
    }
    whole(total)
}

/// The norms of sums of squares.
fn roots<T: Real>(total: [T; 6]) -> Errors<T> {
    // a rounded energy of almost nothing may be below zero; what is no number stays none
    let [l2, h1, energy, l2_exact, h1_exact, energy_exact] = total.map(|s| if s < T::zero() { T::zero() } else { s.sqrt() });
    Errors { error: Norms { l2, h1, energy }, exact: Norms { l2: l2_exact, h1: h1_exact, energy: energy_exact } }
}
