//! A field with its gradient at the points of all elements.

use super::kernels::{Kernels, map_of};
use super::scratch::Scratch;
use super::{Coefficient, Form, Tangent};
use crate::linalg::{Matrix, Real, Vector};
use crate::parallel;
use crate::quadrature::Quadrature;
use crate::space::{FieldAt, Space};

/// `visit(element, states)` of every element, ascending: the field of the unknowns `u` at the points of its rule.
///
/// `u` holds unknown = C * function + component; an empty `u` is zero. Patches of products are contracted direction by
/// direction, holding some planes of points across the slowest direction. Cells with common tables use SIMD lanes.
/// The results do not depend on the number of threads.
///
/// # Panics
/// If `u` is shorter than C times the number of functions and not empty.
pub fn fields<const C: usize, const N: usize, T, S, Q, R>(
    space: &S,
    quadrature: &Q,
    u: &[T],
    visit: &(impl Fn(usize, &[FieldAt<C, N, T>]) -> R + Sync),
) -> Vec<R>
where
    T: Real,
    S: Space<N, N, T> + ?Sized,
    Q: Quadrature<N, T> + ?Sized,
    R: Send,
{
    fields_keeping::<C, N, T, S, Q, (), R>(space, quadrature, u, &|(), element, states| visit(element, states))
}

/// [`fields`] for a visitor with memory of its own, which is not allocated per element. Elements share a `W` in an undefined way: results
/// must not depend on its content.
pub(crate) fn fields_keeping<const C: usize, const N: usize, T, S, Q, W, R>(
    space: &S,
    quadrature: &Q,
    u: &[T],
    visit: &(impl Fn(&mut W, usize, &[FieldAt<C, N, T>]) -> R + Sync),
) -> Vec<R>
where
    T: Real,
    S: Space<N, N, T> + ?Sized,
    Q: Quadrature<N, T> + ?Sized,
    W: Default,
    R: Send,
{
    assert!(u.is_empty() || u.len() >= C * space.num_functions(), "a field of {C} components needs an unknown per component and function");
    let map = || map_of::<N, N, T, S>(space);
    if let Some(found) = Kernels::new(space, quadrature, &map).states(u, visit) {
        return found;
    }
    let of_element = |(scratch, states, kept): &mut (Scratch<N, N, T>, Vec<FieldAt<C, N, T>>, W), element: usize| {
        scratch.gradients(space, element, quadrature.rule(element));
        states.clear();
        states.extend((0..scratch.dx.len()).map(|q| field_at::<C, N, T>(scratch, u, q)));
        visit(kept, element, states)
    };
    parallel::map_init(space.num_elements(), Default::default, of_element)
}

/// The field of coefficients `u` at point `q` of the element in `scratch`.
pub(super) fn field_at<const C: usize, const N: usize, T: Real>(scratch: &Scratch<N, N, T>, u: &[T], q: usize) -> FieldAt<C, N, T> {
    let (mut value, mut gradient) = (Vector::<C, T>::zeros(), Matrix::<C, N, T>::zeros());
    if !u.is_empty() {
        for (a, (&i, &n)) in scratch.ids.iter().zip(scratch.shapes.values(q)).enumerate() {
            let g = scratch.grad(q, a);
            for c in 0..C {
                let coefficient = u[C * i + c];
                value[c] += coefficient * n;
                for j in 0..N {
                    gradient[(c, j)] += coefficient * g[j];
                }
            }
        }
    }
    FieldAt { x: scratch.map.x[q], value, gradient }
}

/// The tangent of `form` at point `q` of the element in `scratch`.
#[inline]
pub(super) fn tangent_at<const C: usize, const N: usize, T: Real>(
    scratch: &Scratch<N, N, T>,
    form: &Form<'_, C, N, T>,
    q: usize,
) -> Tangent<C, N, T> {
    let gradient = match form.coefficient {
        Coefficient::PerState(_) => field_at::<C, N, T>(scratch, form.state, q).gradient,
        _ => Matrix::zeros(),
    };
    form.coefficient.at(&scratch.map.x[q], &gradient)
}
