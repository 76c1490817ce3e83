//! Matrices, products, diagonals and norms of the terms of lower order of a form, element by element.

use super::fields::field_at;
use super::lower_order::LowerFn;
use super::pattern::Pattern;
use super::plain;
use super::scratch::Scratch;
use super::{Form, vectors};
use crate::linalg::{Csr, Matrix, Real, Vector};
use crate::parallel;
use crate::quadrature::Quadrature;
use crate::space::Space;

/// Adds the matrix of the terms to `matrix`, which has the pattern `pattern.csr(C)`, element by element.
pub(super) fn add_matrix<const C: usize, const N: usize, T, S, Q>(
    pattern: &Pattern,
    space: &S,
    quadrature: &Q,
    lower: &LowerFn<'_, C, N, T>,
    symmetric: bool,
    matrix: &mut Csr<T>,
) where
    T: Real,
    S: Space<N, N, T> + ?Sized,
    Q: Quadrature<N, T> + ?Sized,
{
    plain::add_elements(pattern, C, matrix, |scratch: &mut Scratch<N, N, T>, element, out| {
        scratch.gradients(space, element, quadrature.rule(element));
        element_terms(scratch, lower, symmetric, out);
    });
}

/// The matrix of a form on one element, `out[((a * C + c) * n + b) * C + e]`.
pub(crate) fn element_matrix<const C: usize, const N: usize, T: Real>(
    scratch: &mut Scratch<N, N, T>,
    form: &Form<'_, C, N, T>,
    out: &mut [T],
) {
    plain::element_stiffness(scratch, form, out);
    if let Some(lower) = &form.lower {
        let mut own = vec![T::zero(); out.len()];
        element_terms(scratch, &**lower, form.symmetric, &mut own);
        out.iter_mut().zip(own).for_each(|(sum, v)| *sum += v);
    }
}

/// The matrix of the terms on one element, `out[((a * C + c) * n + b) * C + e]`.
///
///   sum_q dx ( N_a C_ce + B_e(c,l) d_l N_a ) N_b + dx N_a B_c(e,j) d_j N_b
fn element_terms<const C: usize, const N: usize, T: Real>(
    scratch: &mut Scratch<N, N, T>,
    lower: &LowerFn<'_, C, N, T>,
    symmetric: bool,
    out: &mut [T],
) {
    let (points, n) = (scratch.dx.len(), scratch.ids.len());
    let terms = (1 + N) * points;
    scratch.planes.clear();
    scratch.planes.resize(C * C * n * n, T::zero());
    scratch.factors.clear();
    scratch.factors.resize(n * C * C * terms, T::zero());
    let mut is_mixed = false;
    for q in 0..points {
        let (at, dx) = (lower(&scratch.map.x[q]), scratch.dx[q]);
        is_mixed |= at.mixed.is_some();
        let values = scratch.shapes.values(q);
        for a in 0..n {
            for c in 0..C {
                for e in 0..C {
                    let factors = &mut scratch.factors[((a * C + c) * C + e) * terms..][..terms];
                    factors[q] = dx * at.value[(c, e)] * values[a];
                    let Some(mixed) = &at.mixed else { continue };
                    for j in 0..N {
                        factors[q] += dx * mixed[e][(c, j)] * scratch.grads[(j * points + q) * n + a];
                        factors[(1 + j) * points + q] = dx * values[a] * mixed[c][(e, j)];
                    }
                }
            }
        }
    }
    for a in 0..n {
        let from = if symmetric { a } else { 0 };
        for ce in 0..C * C {
            let factors = &scratch.factors[(a * C * C + ce) * terms..][..terms];
            let row = &mut scratch.planes[(ce * n + a) * n..][from..n];
            for (q, &f) in factors[..points].iter().enumerate().filter(|(_, f)| **f != T::zero()) {
                for (r, &value) in row.iter_mut().zip(&scratch.shapes.values(q)[from..]) {
                    *r += f * value;
                }
            }
            if is_mixed {
                plain::add_products(row, &factors[points..], &scratch.grads, n, from);
            }
        }
    }
    plain::fill(n, C, symmetric, out, |a, c, b, e| scratch.planes[((c * C + e) * n + a) * n + b]);
}

/// Adds the product of the matrix of the terms with `x` to `y`.
pub(super) fn add_product<const C: usize, const N: usize, T, S, Q>(
    space: &S,
    quadrature: &Q,
    lower: &LowerFn<'_, C, N, T>,
    x: &[T],
    y: &mut [T],
) where
    T: Real,
    S: Space<N, N, T> + ?Sized,
    Q: Quadrature<N, T> + ?Sized,
{
    let kernel = |scratch: &mut Scratch<N, N, T>, out: &mut [Vector<C, T>]| {
        for (q, &dx) in scratch.dx.iter().enumerate() {
            let at = field_at::<C, N, T>(scratch, x, q);
            let (stress, force) = lower(&at.x).respond(&at.value, &at.gradient);
            for ((a, out), &value) in out.iter_mut().enumerate().zip(scratch.shapes.values(q)) {
                *out += (stress * scratch.grad(q, a) + force * value) * dx;
            }
        }
    };
    vectors::add_elements(space, quadrature, kernel, y);
}

/// Adds the diagonal of the matrix of the terms to `diagonal`.
pub(super) fn add_diagonal<const C: usize, const N: usize, T, S, Q>(
    space: &S,
    quadrature: &Q,
    lower: &LowerFn<'_, C, N, T>,
    diagonal: &mut [T],
) where
    T: Real,
    S: Space<N, N, T> + ?Sized,
    Q: Quadrature<N, T> + ?Sized,
{
    let kernel = |scratch: &mut Scratch<N, N, T>, out: &mut [Vector<C, T>]| {
        for (q, &dx) in scratch.dx.iter().enumerate() {
            let at = lower(&scratch.map.x[q]);
            for ((a, out), &value) in out.iter_mut().enumerate().zip(scratch.shapes.values(q)) {
                for c in 0..C {
                    let unit = Vector::<C, T>::from_fn(|e, _| if e == c { value } else { T::zero() });
                    let slope = scratch.grad(q, a);
                    let gradient = Matrix::<C, N, T>::from_fn(|e, j| if e == c { slope[j] } else { T::zero() });
                    out[c] += at.square(&unit, &gradient) * dx;
                }
            }
        }
    };
    vectors::add_elements(space, quadrature, kernel, diagonal);
}

/// A field at (element, local point, physical point): value and gradient.
type OtherFn<'a, const C: usize, const N: usize, T> =
    dyn Fn(usize, &Vector<N, T>, &Vector<N, T>) -> (Vector<C, T>, Matrix<C, N, T>) + Sync + 'a;

/// The terms with u = v of the difference between the field `u` and another one, and of the other one.
pub(super) fn squares<const C: usize, const N: usize, T, S, Q>(
    space: &S,
    quadrature: &Q,
    lower: &LowerFn<'_, C, N, T>,
    u: &[T],
    other: &OtherFn<'_, C, N, T>,
) -> [T; 2]
where
    T: Real,
    S: Space<N, N, T> + ?Sized,
    Q: Quadrature<N, T> + ?Sized,
{
    let of_element = |scratch: &mut Scratch<N, N, T>, element: usize| {
        let rule = quadrature.rule(element);
        scratch.gradients(space, element, rule);
        let mut sums = [T::zero(); 2];
        for (q, &dx) in scratch.dx.iter().enumerate() {
            let at = field_at::<C, N, T>(scratch, u, q);
            let (value, gradient) = other(element, &rule.points[q], &at.x);
            let terms = lower(&at.x);
            sums[0] += terms.square(&(at.value - value), &(at.gradient - gradient)) * dx;
            sums[1] += terms.square(&value, &gradient) * dx;
        }
        sums
    };
    let all: Vec<[T; 2]> = parallel::map_init(space.num_elements(), Scratch::default, of_element);
    all.into_iter().fold([T::zero(); 2], |sum, own| [sum[0] + own[0], sum[1] + own[1]])
}
