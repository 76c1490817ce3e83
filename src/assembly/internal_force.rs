//! The internal forces of a state and its energy: the residual to which a form with a state is the derivative.

use super::check_field;
use super::fields::field_at;
use super::kernels::{Kernels, map_of};
use super::scratch::Scratch;
use super::sum_factorization::QuadraturePoints;
use super::vectors::add_elements;
use crate::linalg::{Matrix, Real, Vector, lit, to_f64};
use crate::quadrature::Quadrature;
use crate::space::Space;
use std::sync::Mutex;

/// Error of a state that has no stress at a quadrature point, for example because det(I + grad u) <= 0 there.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, thiserror::Error)]
#[error("the state has no stress at point {point} of element {element}")]
pub struct Collapsed {
    /// The first element with such a point.
    pub element: usize,
    /// Its first such point, as a position in its quadrature rule.
    pub point: usize,
}

/// The internal forces ∫ P(x, grad u) : grad N dX and the energy ∫ W(x, grad u) dX of the unknowns `u`.
///
/// `answer` returns the stress P [force/area], shaped like grad u (C x N, `grad_u[(i, j)]` = du_i/dx_j), and the energy density W
/// [energy/volume] at a physical point, or `None` where they do not exist. `u` holds unknown = C * function + component; an empty
/// `u` is zero. The first result has C numbers per function, ∫ sum_j P_cj dN_a/dx_j dX for unknown C * a + c, in units of P times
/// length^(N - 1); the second is in units of W times length^N.
///
/// Sign: the forces are those that the body exerts against u growing, the gradient of the energy with respect to the unknowns
/// where P = dW/d(grad u). In equilibrium they equal the [`load`](super::load()). Their derivative with respect to the unknowns
/// is the matrix of the [`Form`](super::Form) with the tangent dP/d(grad u) as
/// [`Coefficient::PerState`](super::Coefficient::PerState) at the state `u`. For finite deformations (Bonet, Wood: Nonlinear
/// Continuum Mechanics for Finite Element Analysis, 2nd ed., 2008) all integrals are over the reference configuration, P is the
/// first Piola-Kirchhoff stress and F = I + grad u.
///
/// Patches of products are contracted direction by direction, cells with common tables use SIMD lanes, others are taken element
/// by element. `answer` is called once per point. Same bits for any number of threads.
///
/// # Errors
/// [`Collapsed`] with the first element and point for which `answer` returns `None`.
///
/// # Panics
/// If `u` is neither empty nor C times as long as the number of functions.
pub fn internal_force<const C: usize, const N: usize, T, S, Q>(
    space: &S,
    quadrature: &Q,
    u: &[T],
    answer: &(impl Fn(&Vector<N, T>, &Matrix<C, N, T>) -> Option<(Matrix<C, N, T>, T)> + Sync + ?Sized),
) -> Result<(Vec<T>, T), Collapsed>
where
    T: Real,
    S: Space<N, N, T> + ?Sized,
    Q: Quadrature<N, T> + ?Sized,
{
    check_field::<C, T>(u, space.num_functions());
    let first = Mutex::new(None::<Collapsed>);
    let in_lanes = |sites: &QuadraturePoints, out: &mut [f64]| {
        let per_lane = sites.xi.len() / (N * sites.elements.len().max(1));
        let points = sites.x.chunks_exact(N).zip(sites.gradients.chunks_exact(C * N));
        for (k, ((x, g), out)) in points.zip(out.chunks_exact_mut(C * N + 1)).enumerate() {
            let (x, g) = (Vector::from_fn(|k, _| lit(x[k])), Matrix::from_fn(|c, j| lit(g[c * N + j])));
            let Some((stress, energy)) = answer(&x, &g) else {
                let (lane, q) = (k / per_lane, k % per_lane);
                let here = Collapsed { element: sites.elements[lane], point: sites.first[lane] + q };
                let mut first = first.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
                *first = Some(first.map_or(here, |before| before.min(here)));
                continue;
            };
            for c in 0..C {
                for j in 0..N {
                    out[c * N + j] = to_f64(stress[(c, j)]);
                }
            }
            out[C * N] = to_f64(energy);
        }
    };
    let map = || map_of::<N, N, T, S>(space);
    let Some((forces, energy)) = Kernels::new(space, quadrature, &map).internal_force::<C>(space, u, &in_lanes) else {
        return plain(space, quadrature, u, answer);
    };
    match first.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner) {
        Some(collapsed) => Err(collapsed),
        None => Ok((forces, lit(energy))),
    }
}

/// [`internal_force`] element by element, for any space.
fn plain<const C: usize, const N: usize, T, S, Q>(
    space: &S,
    quadrature: &Q,
    u: &[T],
    answer: &(impl Fn(&Vector<N, T>, &Matrix<C, N, T>) -> Option<(Matrix<C, N, T>, T)> + Sync + ?Sized),
) -> Result<(Vec<T>, T), Collapsed>
where
    T: Real,
    S: Space<N, N, T> + ?Sized,
    Q: Quadrature<N, T> + ?Sized,
{
    let mut forces = vec![T::zero(); C * space.num_functions()];
    let kernel = |scratch: &mut Scratch<N, N, T>, out: &mut [Vector<C, T>]| {
        let mut sum = T::zero();
        for (q, &dx) in scratch.dx.iter().enumerate() {
            let at = field_at::<C, N, T>(scratch, u, q);
            let (stress, energy) = answer(&at.x, &at.gradient).ok_or(q)?;
            sum += energy * dx;
            for (a, out) in out.iter_mut().enumerate() {
                *out += stress * scratch.grad(q, a) * dx;
            }
        }
        Ok(sum)
    };
    let mut energy = T::zero();
    for (element, own) in add_elements(space, quadrature, kernel, &mut forces).into_iter().enumerate() {
        energy += own.map_err(|point| Collapsed { element, point })?;
    }
    Ok((forces, energy))
}
