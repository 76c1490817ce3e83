//! Rational bases: NURBS, and the quotient of any basis by a weight function.

use super::{Basis, BasisStructure, Block, Cell, Elements, Order, Polynomials, ShapeTable, TensorPatch};
use crate::linalg::{Matrix, Real, Vector, to_f64};

/// Error of invalid weights.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum WeightError {
    /// A weight is zero, negative, infinite or not a number.
    #[error("the weight at index {index} is {value}; weights must be positive")]
    NotPositive {
        /// Its index, from 0.
        index: usize,
        /// Its value.
        value: f64,
    },
    /// There is not one weight per function.
    #[error("there are {found} weights for {expected} functions; give one per function")]
    Counts {
        /// Number of weights given.
        found: usize,
        /// Number of functions.
        expected: usize,
    },
}

/// Checks that there are `expected` weights, all positive and finite.
///
/// # Errors
/// [`WeightError`] for a wrong number of weights, or with the first invalid weight.
pub fn check_weights<T: Real>(weights: &[T], expected: usize) -> Result<(), WeightError> {
    if weights.len() != expected {
        return Err(WeightError::Counts { found: weights.len(), expected });
    }
    match weights.iter().position(|&w| !(w > T::zero() && w.is_finite())) {
        Some(index) => Err(WeightError::NotPositive { index, value: to_f64(weights[index]) }),
        None => Ok(()),
    }
}

/// R_i = w_i N_i / W,  W = sum_j w_j N_j, over any basis that sums to one.
#[derive(Clone, Debug, PartialEq)]
pub struct Rational<B, T: Real = f64> {
    basis: B,
    weights: Vec<T>,
}

impl<B, T: Real> Rational<B, T> {
    /// The quotient of `basis` by the weight function of `weights`.
    ///
    /// # Panics
    /// If [`Rational::try_new`] fails.
    pub fn new<const D: usize>(basis: B, weights: Vec<T>) -> Self
    where
        B: Basis<D, T>,
    {
        Self::try_new(basis, weights).expect("one positive weight per function")
    }

    /// The quotient of `basis` by the weight function of `weights`.
    ///
    /// # Errors
    /// [`WeightError`] unless there is one positive weight per function.
    pub fn try_new<const D: usize>(basis: B, weights: Vec<T>) -> Result<Self, WeightError>
    where
        B: Basis<D, T>,
    {
        check_weights(&weights, basis.num_functions())?;
        Ok(Self { basis, weights })
    }

    /// The underlying basis.
    pub fn basis(&self) -> &B {
        &self.basis
    }

    /// One weight per function.
    pub fn weights(&self) -> &[T] {
        &self.weights
    }
}

impl<B: Elements, T: Real> Elements for Rational<B, T> {
    fn num_elements(&self) -> usize {
        self.basis.num_elements()
    }
    fn cell(&self, element: usize) -> Cell {
        self.basis.cell(element)
    }
    fn corners(&self, element: usize, ids: &mut Vec<usize>) {
        self.basis.corners(element, ids);
    }
}

impl<const D: usize, B: Basis<D, T>, T: Real> Basis<D, T> for Rational<B, T> {
    fn num_functions(&self) -> usize {
        self.basis.num_functions()
    }
    fn degree(&self, element: usize) -> [usize; D] {
        self.basis.degree(element)
    }
    fn active(&self, element: usize, ids: &mut Vec<usize>) {
        self.basis.active(element, ids);
    }
    fn tabulate(&self, element: usize, xi: &[Vector<D, T>], order: Order, table: &mut ShapeTable<D, T>) {
        let mut inner = table.inner.take().unwrap_or_default();
        let mut ids = std::mem::take(&mut table.ids);
        self.basis.active(element, &mut ids);
        self.basis.tabulate(element, xi, order, &mut inner);
        table.resize(xi.len(), ids.len(), order);
        let mut weights = std::mem::take(&mut table.numbers);
        weights.clear();
        weights.extend(ids.iter().map(|&i| self.weights[i]));
        for q in 0..xi.len() {
            let (values, grads, hessians) = table.point_mut(q);
            let n = inner.values(q);
            let total = weights.iter().zip(n).fold(T::zero(), |s, (&w, &v)| s + w * v);
            let inverse = T::one() / total;
            for ((r, &w), &n) in values.iter_mut().zip(&weights).zip(n) {
                *r = w * n * inverse;
            }
            if order < Order::Gradients {
                continue;
            }
            // R' = (w N' - R W') / W
            let dn = inner.grads(q);
            let dtotal = weights.iter().zip(dn).fold(Vector::<D, T>::zeros(), |s, (&w, g)| s + g * w);
            for (((dr, &r), &w), dn) in grads.iter_mut().zip(&*values).zip(&weights).zip(dn) {
                *dr = (dn * w - dtotal * r) * inverse;
            }
            if order < Order::Hessians {
                continue;
            }
            // R'' = (w N'' - R' ⊗ W' - W' ⊗ R' - R W'') / W
            let ddn = inner.hessians(q);
            let ddtotal = weights.iter().zip(ddn).fold(Matrix::<D, D, T>::zeros(), |s, (&w, h)| s + h * w);
            for ((((ddr, dr), &r), &w), ddn) in hessians.iter_mut().zip(&*grads).zip(&*values).zip(&weights).zip(ddn) {
                let mixed = dr * dtotal.transpose();
                *ddr = (ddn * w - mixed - mixed.transpose() - ddtotal * r) * inverse;
            }
        }
        table.numbers = weights;
        table.inner = Some(inner);
        table.ids = ids;
    }
    fn structure(&self) -> &dyn BasisStructure<D, T> {
        self
    }
    fn polynomials(&self, wanted: Polynomials) -> Option<Box<dyn Basis<D, T>>> {
        self.basis.polynomials(wanted)
    }
}

impl<const D: usize, B: Basis<D, T>, T: Real> BasisStructure<D, T> for Rational<B, T> {
    fn block(&self, element: usize) -> Option<Block<'_, D, T>> {
        let block = self.basis.structure().block(element)?;
        let functions: usize = block.axes.iter().map(|axis| axis.num_functions()).product();
        // a run that is only part of the functions has numbers of its own, which the weights do not follow
        (block.weights.is_none() && functions == self.weights.len()).then_some(Block { weights: Some(&self.weights), ..block })
    }
    fn patches(&self) -> Option<Vec<TensorPatch<'_, D, T>>> {
        let mut patches = self.basis.structure().patches()?;
        for patch in &mut patches {
            // weights follow the numbers of the basis
            let follow = patch.ids.len() == self.weights.len() && patch.ids.iter().enumerate().all(|(i, &id)| i == id);
            if patch.block.weights.is_some() || !follow {
                return None;
            }
            patch.block.weights = Some(&self.weights);
        }
        Some(patches)
    }
}
