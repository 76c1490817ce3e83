//! Bulk matrices: sum factorisation on spaces of tensor-product patches, loops over elements on others.

use super::kernels::{map_of, patches};
use super::pattern::Pattern;
use super::simd_cells::CellSpace;
use super::sum_factorization::Glue;
use super::{Form, dof_coordinates, lower_sums, plain};
use crate::linalg::{Csr, Real};
use crate::quadrature::{Quadrature, TensorRule};
use crate::space::Space;
use std::sync::Arc;

/// The matrix of `form` on `space`, unknown = C * function + component, with the coordinates of its unknowns.
///
/// Unit: that of the tangent times length^(N - 2). Symmetric to the last bit where the form is. Same bits for any number
/// of threads.
///
/// # Panics
/// If there are 2^32 unknowns or more, or if the state of `form` is neither empty nor of the size of the matrix.
pub fn stiffness<const C: usize, const N: usize, T, S, Q>(space: &S, quadrature: &Q, form: &Form<'_, C, N, T>) -> Csr<T>
where
    T: Real,
    S: Space<N, N, T> + ?Sized,
    Q: Quadrature<N, T> + ?Sized,
{
    form.check_state(space.num_functions());
    let map = || map_of::<N, N, T, S>(space);
    if let Some(products) = patches(space, quadrature, &map, None) {
        let two = TensorRule::gauss([2; N]);
        let coarse = patches(space, &two, &map, products.glue());
        let mut matrix = products.csr(C).with_dof_coordinates(coarse.map(|p| p.mean_coordinates(C)).unwrap_or_default());
        products.stiffness(form, false, &mut matrix);
        add_lower(None, space, quadrature, form, &mut matrix);
        return matrix;
    }
    let mut pattern = Pattern::new(space);
    let places = dof_coordinates(space, &pattern, C);
    let cells = CellSpace::new(&pattern, space, quadrature);
    // terms of lower order are added to rows of the pattern afterwards
    let new = if cells.is_some() && form.lower.is_none() { pattern.csr_once(C) } else { pattern.csr(C) };
    let mut matrix = new.with_dof_coordinates(places);
    // cells write zeros before they add: reading a new page of memory before writing it costs two page faults
    let add = cells.is_none();
    elements(cells, &pattern, space, quadrature, form, add, &mut matrix);
    matrix
}

/// Adds the terms of lower order of `form`; without a `pattern` the graph is built for them.
fn add_lower<const C: usize, const N: usize, T, S, Q>(
    pattern: Option<&Pattern>,
    space: &S,
    quadrature: &Q,
    form: &Form<'_, C, N, T>,
    matrix: &mut Csr<T>,
) where
    T: Real,
    S: Space<N, N, T> + ?Sized,
    Q: Quadrature<N, T> + ?Sized,
{
    let Some(lower) = &form.lower else { return };
    let add = |pattern: &Pattern, matrix| lower_sums::add_matrix(pattern, space, quadrature, &**lower, form.symmetric, matrix);
    match pattern {
        Some(pattern) => add(pattern, matrix),
        None => add(&Pattern::new(space), matrix),
    }
}

/// Assembles the matrix of `form` element by element, in SIMD lanes if there are `cells`; `add`: adds to the values of `matrix`.
fn elements<const C: usize, const N: usize, T, S, Q>(
    cells: Option<CellSpace<'_, N, N, T>>,
    pattern: &Pattern,
    space: &S,
    quadrature: &Q,
    form: &Form<'_, C, N, T>,
    add: bool,
    matrix: &mut Csr<T>,
) where
    T: Real,
    S: Space<N, N, T> + ?Sized,
    Q: Quadrature<N, T> + ?Sized,
{
    match cells {
        Some(cells) => cells.stiffness(pattern, form, add, matrix),
        None => {
            if !add {
                matrix.vals_mut().fill(T::zero());
            }
            plain::add_stiffness(pattern, space, quadrature, form, matrix);
        }
    }
    add_lower(Some(pattern), space, quadrature, form, matrix);
}

/// Adds the matrix of `form` to `matrix`, which has the pattern `pattern.csr(C)`.
///
/// # Panics
/// If the shapes do not fit.
pub fn add_stiffness<const C: usize, const N: usize, T, S, Q>(
    pattern: &Pattern,
    space: &S,
    quadrature: &Q,
    form: &Form<'_, C, N, T>,
    matrix: &mut Csr<T>,
) where
    T: Real,
    S: Space<N, N, T> + ?Sized,
    Q: Quadrature<N, T> + ?Sized,
{
    form.check_state(space.num_functions());
    let map = || map_of::<N, N, T, S>(space);
    match patches(space, quadrature, &map, None) {
        Some(patches) => {
            patches.stiffness(form, true, matrix);
            add_lower(Some(pattern), space, quadrature, form, matrix);
        }
        None => elements(CellSpace::new(pattern, space, quadrature), pattern, space, quadrature, form, true, matrix),
    }
}

/// Writes the matrix of `form` over the values of `matrix`, which [`stiffness`] made for this space: pattern and memory
/// stay. Same bits as a fresh matrix.
///
/// Unless the space is one product of directions, its graph is rebuilt; an [`Assembler`](super::Assembler) stores it.
///
/// # Panics
/// If the shapes do not fit.
pub fn refill_stiffness<const C: usize, const N: usize, T, S, Q>(space: &S, quadrature: &Q, form: &Form<'_, C, N, T>, matrix: &mut Csr<T>)
where
    T: Real,
    S: Space<N, N, T> + ?Sized,
    Q: Quadrature<N, T> + ?Sized,
{
    form.check_state(space.num_functions());
    let map = || map_of::<N, N, T, S>(space);
    match patches(space, quadrature, &map, None) {
        Some(patches) => {
            patches.stiffness(form, false, matrix);
            add_lower(None, space, quadrature, form, matrix);
        }
        None => {
            let pattern = Pattern::new(space);
            elements(CellSpace::new(&pattern, space, quadrature), &pattern, space, quadrature, form, false, matrix);
        }
    }
}

/// Stored graph of a space: refilling a matrix on the same functions costs only its values.
///
/// The map and the rule may change from one matrix to the next.
#[derive(Clone, Debug)]
pub struct Assembler {
    /// `None` for spaces made of products of directions, whose graph is known in closed form.
    pattern: Option<Pattern>,
    /// Numbering of glued patches.
    glue: Option<Arc<Glue>>,
}

impl Assembler {
    /// Builds the graph for assembling on `space` with `quadrature`.
    ///
    /// # Panics
    /// If there are 2^32 functions or elements or more.
    pub fn new<const N: usize, T, S, Q>(space: &S, quadrature: &Q) -> Self
    where
        T: Real,
        S: Space<N, N, T> + ?Sized,
        Q: Quadrature<N, T> + ?Sized,
    {
        let map = || map_of::<N, N, T, S>(space);
        match patches(space, quadrature, &map, None) {
            Some(patches) => Self { pattern: None, glue: patches.glue().cloned() },
            None => Self { pattern: Some(Pattern::new(space)), glue: None },
        }
    }

    /// Writes the matrix of `form` over the values of `matrix`, as [`refill_stiffness`] does.
    ///
    /// # Panics
    /// If the shapes do not fit.
    pub fn refill_stiffness<const C: usize, const N: usize, T, S, Q>(
        &self,
        space: &S,
        quadrature: &Q,
        form: &Form<'_, C, N, T>,
        matrix: &mut Csr<T>,
    ) where
        T: Real,
        S: Space<N, N, T> + ?Sized,
        Q: Quadrature<N, T> + ?Sized,
    {
        form.check_state(space.num_functions());
        if let Some(pattern) = &self.pattern {
            elements(CellSpace::new(pattern, space, quadrature), pattern, space, quadrature, form, false, matrix);
            return;
        }
        let map = || map_of::<N, N, T, S>(space);
        match patches(space, quadrature, &map, self.glue.as_ref()) {
            Some(patches) => {
                patches.stiffness(form, false, matrix);
                add_lower(None, space, quadrature, form, matrix);
            }
            // another rule than the one the graph was made for
            None => refill_stiffness(space, quadrature, form, matrix),
        }
    }
}

/// The matrix ∫ N_a N_b dx, one component; curves and surfaces in space too.
///
/// # Panics
/// If there are 2^32 functions or more.
pub fn mass<const D: usize, const N: usize, T, S, Q>(space: &S, quadrature: &Q) -> Csr<T>
where
    T: Real,
    S: Space<D, N, T> + ?Sized,
    Q: Quadrature<D, T> + ?Sized,
{
    let map = || map_of::<D, N, T, S>(space);
    if let Some(products) = patches(space, quadrature, &map, None) {
        let two = TensorRule::gauss([2; D]);
        let coarse = patches(space, &two, &map, products.glue());
        let mut matrix = products.csr(1).with_dof_coordinates(coarse.map(|p| p.mean_coordinates(1)).unwrap_or_default());
        products.mass(&mut matrix);
        return matrix;
    }
    let pattern = Pattern::new(space);
    let mut matrix = pattern.csr(1).with_dof_coordinates(dof_coordinates(space, &pattern, 1));
    match CellSpace::new(&pattern, space, quadrature) {
        Some(cells) => cells.mass(&pattern, &mut matrix),
        None => plain::add_mass(&pattern, space, quadrature, &mut matrix),
    }
    matrix
}
