//! Linear operators: the interface of a stiffness to solvers and constraint algorithms.

use super::{Csr, Real};
use std::fmt::Debug;

/// A square linear operator y = A x.
///
/// A matrix is optional ([`Operator::csr`]), so that matrix-free forms fit.
pub trait Operator<T: Real = f64>: Debug + Send + Sync {
    /// Number of unknowns n; A is n x n.
    fn size(&self) -> usize;
    /// y = A x, both of length n; y is overwritten.
    fn apply(&self, x: &[T], y: &mut [T]);
    /// The n diagonal entries: row scales and Jacobi need them of any operator.
    fn diagonal(&self) -> Vec<T>;
    /// The matrix; `None` if the operator is matrix-free.
    fn csr(&self) -> Option<&Csr<T>> {
        None
    }
    /// Coordinates of the unknowns, one point each, or empty; used for orderings, coarse grids and partitions.
    fn dof_coordinates(&self) -> &[[f64; 3]] {
        &[]
    }
}

macro_rules! forward_operator {
    ($($pointer:ty),*) => {$(
        impl<T: Real, X: Operator<T> + ?Sized> Operator<T> for $pointer {
            fn size(&self) -> usize { (**self).size() }
            fn apply(&self, x: &[T], y: &mut [T]) { (**self).apply(x, y) }
            fn diagonal(&self) -> Vec<T> { (**self).diagonal() }
            fn csr(&self) -> Option<&Csr<T>> { (**self).csr() }
            fn dof_coordinates(&self) -> &[[f64; 3]] { (**self).dof_coordinates() }
        }
    )*};
}
forward_operator!(&X, Box<X>, std::sync::Arc<X>);
