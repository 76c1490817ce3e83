//! Linear operators: what solvers and constraint algorithms may ask of a stiffness.

use super::{Csr, Real};
use std::fmt::Debug;

/// A square linear operator y = A x.
///
/// A matrix is asked for ([`Operator::csr`]), not assumed, so that matrix-free forms fit.
pub trait Operator<T: Real = f64>: Debug + Send + Sync {
    /// Number of unknowns n; A is n x n.
    fn size(&self) -> usize;
    /// y = A x, both of length n; y is overwritten.
    fn apply(&self, x: &[T], y: &mut [T]);
    /// The n diagonal entries: row scales and Jacobi need them of any operator.
    fn diagonal(&self) -> Vec<T>;
    /// The matrix, where there is one.
    fn csr(&self) -> Option<&Csr<T>> {
        None
    }
    /// Where the unknowns live, one point each, or empty: orderings, coarse grids, partitions.
    fn places(&self) -> &[[f64; 3]] {
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
            fn places(&self) -> &[[f64; 3]] { (**self).places() }
        }
    )*};
}
forward_operator!(&X, Box<X>, std::sync::Arc<X>);
