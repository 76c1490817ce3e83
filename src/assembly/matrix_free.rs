//! The matrix of a form as an operator that stores no matrix.

use super::fields::tangent_at;
use super::kernels::{map_of, patches};
use super::scratch::Scratch;
use super::sum_factorization::Free;
use super::vectors::add_elements;
use super::{Form, Pattern, contract, dof_coordinates, lower_sums};
use crate::linalg::{Matrix, Operator, Real, Vector};
use crate::quadrature::{Quadrature, TensorRule};
use crate::space::Space;
use std::fmt::Debug;

/// y = A x with the matrix A of a form, computed from the form at every product.
///
/// Where the space is made of patches, each a product of directions, the field is contracted with the grid of points
/// direction by direction and back: about 2 N (p + 1) products per point and component, in lanes, no memory of the size
/// of A. Other spaces, and patches two of whose functions are glued to each other, take a loop over elements that stores
/// nothing. The quadrature is the one of the matrix: both agree to rounding. Same bits
/// for any number of threads.
///
/// | map | tangent | kept per quadrature point |
/// |---|---|---|
/// | any | one component | N (N + 1) / 2 numbers, N² where the form is not symmetric |
/// | any | several components, per point or per state | C N (C N + 1) / 2, or (C N)² |
/// | product of directions | several components, constant | nothing |
/// | any other | several components, constant | N² + N + 3 |
///
/// Terms of [lower order](super::LowerOrder) are added by a loop over elements that keeps nothing.
///
/// [`lean`](Self::lean) keeps nothing and evaluates map, state and tangent at every product.
pub struct MatrixFree<'a, const C: usize, const N: usize, T: Real, S: ?Sized, Q: ?Sized> {
    space: &'a S,
    quadrature: &'a Q,
    form: &'a Form<'a, C, N, T>,
    grid: Option<Free>,
    places: Vec<[f64; 3]>,
}

impl<const C: usize, const N: usize, T: Real, S: Debug + ?Sized, Q: ?Sized> Debug for MatrixFree<'_, C, N, T, S, Q> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("MatrixFree").field("space", &self.space).field("form", &self.form).finish_non_exhaustive()
    }
}

impl<'a, const C: usize, const N: usize, T, S, Q> MatrixFree<'a, C, N, T, S, Q>
where
    T: Real,
    S: Space<N, N, T> + ?Sized,
    Q: Quadrature<N, T> + ?Sized,
{
    /// Creates the operator of `form` on `space`, unknown = C * function + component, with data kept at the points as tabulated
    /// in [`MatrixFree`].
    ///
    /// # Panics
    /// If the state of `form` is neither empty nor C times as long as the number of functions.
    pub fn new(space: &'a S, quadrature: &'a Q, form: &'a Form<'a, C, N, T>) -> Self {
        Self::with(space, quadrature, form, true)
    }

    /// Creates the operator of [`new`](Self::new) without keeping data at the points.
    pub fn lean(space: &'a S, quadrature: &'a Q, form: &'a Form<'a, C, N, T>) -> Self {
        Self::with(space, quadrature, form, false)
    }

    fn with(space: &'a S, quadrature: &'a Q, form: &'a Form<'a, C, N, T>, keeps: bool) -> Self {
        form.check_state(space.num_functions());
        let map = || map_of::<N, N, T, S>(space);
        let grid = patches(space, quadrature, &map, None).and_then(|patches| Free::new(patches, form, keeps));
        let places = match patches(space, &TensorRule::gauss([2; N]), &map, None) {
            Some(patches) => patches.mean_coordinates(C),
            None => dof_coordinates(space, &Pattern::new(space), C),
        };
        Self { space, quadrature, form, grid, places }
    }

    /// Whether products use sum factorisation on the grid of points; otherwise they loop over elements.
    pub fn is_contracted(&self) -> bool {
        self.grid.is_some()
    }

    /// Adds the products with the terms of lower order.
    fn add_lower(&self, x: &[T], y: &mut [T]) {
        if let Some(lower) = &self.form.lower {
            lower_sums::add_product(self.space, self.quadrature, &**lower, x, y);
        }
    }

    fn add_lower_diagonal(&self, diagonal: &mut [T]) {
        if let Some(lower) = &self.form.lower {
            lower_sums::add_diagonal(self.space, self.quadrature, &**lower, diagonal);
        }
    }

    /// Bytes kept between products, without univariate tables and coordinates of unknowns.
    pub fn bytes(&self) -> usize {
        self.grid.as_ref().map_or(0, Free::bytes)
    }
}

impl<const C: usize, const N: usize, T, S, Q> Operator<T> for MatrixFree<'_, C, N, T, S, Q>
where
    T: Real,
    S: Space<N, N, T> + ?Sized,
    Q: Quadrature<N, T> + ?Sized,
{
    fn size(&self) -> usize {
        C * self.space.num_functions()
    }

    fn apply(&self, x: &[T], y: &mut [T]) {
        if let Some(grid) = &self.grid {
            grid.apply(self.form, &|| map_of::<N, N, T, S>(self.space), x, y);
            self.add_lower(x, y);
            return;
        }
        let kernel = |scratch: &mut Scratch<N, N, T>, out: &mut [Vector<C, T>]| {
            for q in 0..scratch.dx.len() {
                let mut gradient = Matrix::<C, N, T>::zeros();
                for (a, &i) in scratch.ids.iter().enumerate() {
                    gradient += Vector::<C, T>::from_fn(|c, _| x[C * i + c]) * scratch.grad(q, a).transpose();
                }
                let stress = contract(&tangent_at(scratch, self.form, q), &gradient) * scratch.dx[q];
                for (a, out) in out.iter_mut().enumerate() {
                    *out += stress * scratch.grad(q, a);
                }
            }
        };
        y.fill(T::zero());
        add_elements(self.space, self.quadrature, kernel, y);
        self.add_lower(x, y);
    }

    fn diagonal(&self) -> Vec<T> {
        let mut diagonal = vec![T::zero(); self.size()];
        if let Some(grid) = &self.grid {
            grid.diagonal(self.form, &|| map_of::<N, N, T, S>(self.space), &mut diagonal);
            self.add_lower_diagonal(&mut diagonal);
            return diagonal;
        }
        let kernel = |scratch: &mut Scratch<N, N, T>, out: &mut [Vector<C, T>]| {
            for q in 0..scratch.dx.len() {
                let tangent = tangent_at(scratch, self.form, q);
                for (a, out) in out.iter_mut().enumerate() {
                    let g = scratch.grad(q, a);
                    for c in 0..C {
                        let mut sum = T::zero();
                        for j in 0..N {
                            for l in 0..N {
                                sum += tangent[c][j][(c, l)] * g[j] * g[l];
                            }
                        }
                        out[c] += sum * scratch.dx[q];
                    }
                }
            }
        };
        add_elements(self.space, self.quadrature, kernel, &mut diagonal);
        self.add_lower_diagonal(&mut diagonal);
        diagonal
    }

    fn dof_coordinates(&self) -> &[[f64; 3]] {
        &self.places
    }
}
