//! Dual (biorthogonal) multipliers of surfaces: one per function of the slave side, element by element.
//!
//! On an element with functions N_i and polynomials q_k that span those of p/p of the side, with s the area
//!
//! ```text
//! G_ki = ∫ q_k N_i ds,   d_i = ∫ N_i ds,   psi_j = sum_k A_jk q_k,   A = diag(d) G⁻¹
//! ```
//!
//! as on curves ([`dual`](super::dual())): ∫ psi_j N_i ds = delta_ij d_i on every element, the psi_j sum to one, and D of the mortar rows is
//! diagonal. Constrained functions give their multiplier to one beside them, which keeps duality to all free functions. The lumped weights,
//! sums of d_i, must be positive: on triangles of degree 2 those of vertices are zero.
//!
//! Contact takes them where elements are covered as a whole or not at all; the pressure is read with the functions of the side.

use super::covered::is_whole;
use super::dual::NO_WEIGHT;
use super::handed_on::handed_on;
use super::{MultiplierError, instead};
use crate::assembly::gauss_rules;
use crate::basis::{Basis, Cell, Elements, Order, Polynomials, ShapeTable};
use crate::coupling::Segments;
use crate::geometry::MapTable;
use crate::linalg::{Matrix, Real, Vector, measure, to_f64};
use crate::quadrature::Quadrature;
use crate::space::Space;
use nalgebra::{DMatrix, Dyn, LU};
use std::ops::Range;
use std::sync::Arc;

/// Gauss points per direction beyond degree + 1, since areas of curved elements are no polynomials.
const EXTRA_POINTS: usize = 8;
/// Largest error of duality, as a share of the largest weight.
const NOT_DUAL: f64 = 1e-9;

/// A pair of multipliers and the functions by which their values are read.
type Pair<T> = (Box<dyn Basis<2, T>>, Box<dyn Basis<2, T>>);

/// Functions that are sums of orthonormal polynomials on every element.
#[derive(Debug)]
struct Combined<T: Real> {
    of: Box<dyn Basis<2, T>>,
    ids: Vec<Vec<usize>>,
    /// Per element the matrix that makes the functions of `of` orthonormal, and Aᵀ: a column per function.
    sums: Vec<[DMatrix<T>; 2]>,
    functions: usize,
}

/// Builds the dual multipliers of a surface; `constrained` functions have no free unknown.
///
/// # Errors
/// [`MultiplierError::NoDual`] where a lumped weight is not positive, an element has no dual functions, or the side offers no polynomials;
/// [`MultiplierError::NothingFree`] where all functions are constrained that elements join.
pub(super) fn dual_surface<const N: usize, T: Real>(
    space: &Arc<dyn Space<2, N, T>>,
    constrained: &[bool],
) -> Result<Box<dyn Basis<2, T>>, MultiplierError> {
    let psi = combined(&**space).map_err(|error| instead(error, &**space as &dyn Basis<2, T>))?;
    if constrained.contains(&true) { handed_on(Box::new(psi), constrained) } else { Ok(Box::new(psi)) }
}

/// `dual_surface` of a contact with what faces the points of `segments`, and the functions by which its pressure is read.
///
/// # Errors
/// Those of `dual_surface`, and [`MultiplierError::NoDual`] where an element is covered in part.
pub fn dual_on_surface<const N: usize, T: Real>(
    space: &Arc<dyn Space<2, N, T>>,
    constrained: &[bool],
    segments: &Segments<2, T>,
) -> Result<Pair<T>, MultiplierError> {
    let mut points: Vec<Vec<Range<usize>>> = vec![Vec::new(); space.num_elements()];
    (0..segments.num_pieces()).for_each(|piece| points[segments.slave[piece]].push(segments.points(piece)));
    let in_part = points.iter().enumerate().position(|(e, own)| !own.is_empty() && !is_whole(segments, e, own));
    if let Some(element) = in_part {
        let reason = format!("element {element} faces its opponent in part, and those of surfaces need whole elements");
        return Err(instead(MultiplierError::NoDual { reason, known: String::new() }, &**space as &dyn Basis<2, T>));
    }
    let own: Box<dyn Basis<2, T>> = Box::new(Arc::clone(space));
    let reading = if constrained.contains(&true) { handed_on(own, constrained)? } else { own };
    Ok((dual_surface(space, constrained)?, reading))
}

fn combined<const N: usize, T: Real>(space: &dyn Space<2, N, T>) -> Result<Combined<T>, MultiplierError> {
    let no_dual = |reason: String| MultiplierError::NoDual { reason, known: String::new() };
    let basis: &dyn Basis<2, T> = space;
    let of = basis.polynomials(Polynomials::Lowered(0)).ok_or_else(|| no_dual("the side offers no polynomials".into()))?;
    let rules = gauss_rules(space, EXTRA_POINTS);
    let n = basis.num_functions();
    let (mut weight, mut area, mut home) = (vec![T::zero(); n], vec![T::zero(); n], vec![0; n]);
    let (mut ids, mut shapes, mut q, mut map) = (Vec::new(), ShapeTable::new(), ShapeTable::new(), MapTable::<2, N, T>::new());
    let (mut all, mut sums) = (Vec::with_capacity(basis.num_elements()), Vec::with_capacity(basis.num_elements()));
    for e in 0..basis.num_elements() {
        let rule = rules.rule(e);
        basis.active(e, &mut ids);
        space.evaluate(e, &rule.points, Order::Gradients, &mut shapes, &mut map);
        of.tabulate(e, &rule.points, Order::Values, &mut q);
        let ds: Vec<T> = rule.weights.iter().zip(&map.jacobian).map(|(&w, j)| w * measure(j)).collect();
        let whole = ds.iter().fold(T::zero(), |s, &w| s + w);
        let sum = |f: &dyn Fn(usize) -> T| (0..ds.len()).fold(T::zero(), |s, k| s + ds[k] * f(k));
        let d: Vec<T> = (0..ids.len()).map(|a| sum(&|k| shapes.values(k)[a])).collect();
        for (&i, &own) in ids.iter().zip(&d) {
            weight[i] += own;
            area[i] += whole;
            home[i] = e;
        }
        let none = || no_dual(format!("the functions on element {e} have no dual ones"));
        let n = q.values(0).len();
        let values = DMatrix::from_fn(n, ds.len(), |k, at| q.values(at)[k]);
        let orthonormal = orthonormal(&values, &ds).ok_or_else(none)?;
        let values = &orthonormal * values;
        let products = DMatrix::from_fn(ids.len(), n, |i, k| sum(&|at| values[(k, at)] * shapes.values(at)[i]));
        sums.push([orthonormal, dual_of(&products, &d).ok_or_else(none)?]);
        all.push(ids.clone());
    }
    for i in 0..n {
        // NaN is not positive either
        if to_f64(weight[i]).is_nan() || to_f64(weight[i]) <= NO_WEIGHT * to_f64(area[i]) {
            let value = to_f64(weight[i]);
            let word = if value > 0.0 { "zero up to rounding" } else { "not positive" };
            return Err(no_dual(format!("the lumped weight of function {i} on element {} is {value:.3e}, {word}", home[i])));
        }
    }
    Ok(Combined { of, ids: all, sums, functions: n })
}

/// L⁻¹ of the Gram matrix L Lᵀ of functions with these values at points of the weights `ds`: it makes them orthonormal, as far as their
/// condition allows, which leaves G with the root of that of the Gram matrix.
fn orthonormal<T: Real>(values: &DMatrix<T>, ds: &[T]) -> Option<DMatrix<T>> {
    let n = values.nrows();
    let gram = DMatrix::from_fn(n, n, |k, l| (0..ds.len()).fold(T::zero(), |s, at| s + ds[at] * values[(k, at)] * values[(l, at)]));
    gram.cholesky()?.l().solve_lower_triangular(&DMatrix::identity(n, n))
}

/// Aᵀ from Gᵀ Aᵀ = diag(d), with one correction; `None` if there is none.
fn dual_of<T: Real>(products: &DMatrix<T>, d: &[T]) -> Option<DMatrix<T>> {
    if products.nrows() != products.ncols() {
        return None;
    }
    let wanted = DMatrix::from_fn(d.len(), d.len(), |i, j| if i == j { d[i] } else { T::zero() });
    let lu: LU<T, Dyn, Dyn> = products.clone().lu();
    let first = lu.solve(&wanted)?;
    let found = &first + lu.solve(&(&wanted - products * &first))?;
    let missed = to_f64((&wanted - products * &found).amax());
    (missed <= NOT_DUAL * to_f64(wanted.amax())).then_some(found)
}

impl<T: Real> Elements for Combined<T> {
    fn num_elements(&self) -> usize {
        self.of.num_elements()
    }
    fn cell(&self, element: usize) -> Cell {
        self.of.cell(element)
    }
    fn corners(&self, element: usize, ids: &mut Vec<usize>) {
        self.of.corners(element, ids);
    }
}

impl<T: Real> Basis<2, T> for Combined<T> {
    fn num_functions(&self) -> usize {
        self.functions
    }
    fn degree(&self, element: usize) -> [usize; 2] {
        self.of.degree(element)
    }
    fn active(&self, element: usize, ids: &mut Vec<usize>) {
        ids.clone_from(&self.ids[element]);
    }
    fn tabulate(&self, element: usize, xi: &[Vector<2, T>], order: Order, table: &mut ShapeTable<2, T>) {
        let mut q = ShapeTable::new();
        self.of.tabulate(element, xi, order, &mut q);
        let [orthonormal, sums] = &self.sums[element];
        let (n, functions) = (sums.nrows(), sums.ncols());
        table.reset(xi.len(), functions, order);
        for at in 0..xi.len() {
            for k in 0..n {
                // an orthonormal polynomial, and what it gives to every function
                let of = |f: &dyn Fn(usize) -> T| (0..n).fold(T::zero(), |s, l| s + orthonormal[(k, l)] * f(l));
                let value = of(&|l| q.values(at)[l]);
                (0..functions).for_each(|j| table.values_mut(at)[j] += value * sums[(k, j)]);
                if order >= Order::Gradients {
                    let slope = Vector::<2, T>::from_fn(|a, _| of(&|l| q.grads(at)[l][a]));
                    (0..functions).for_each(|j| table.grads_mut(at)[j] += slope * sums[(k, j)]);
                }
                if order >= Order::Hessians {
                    let bend = Matrix::<2, 2, T>::from_fn(|a, b| of(&|l| q.hessians(at)[l][(a, b)]));
                    (0..functions).for_each(|j| table.hessians_mut(at)[j] += bend * sums[(k, j)]);
                }
            }
        }
    }
}
