//! Floor 2: quadrature rules on the reference cells (unit cube, unit simplex).

mod gauss;
mod per_element;
mod simplex;
mod tensor;

use crate::linalg::{Real, Vector};
use std::fmt::Debug;

pub use gauss::{gauss_legendre, gauss_lobatto_nodes};
pub use per_element::PerElement;
pub use simplex::simplex_rule;
pub use tensor::TensorRule;

/// Points and weights on a reference cell; the weights sum to its measure.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Rule<const D: usize, T: Real = f64> {
    /// Local coordinates of the points.
    pub points: Vec<Vector<D, T>>,
    /// One weight per point.
    pub weights: Vec<T>,
}

/// Quadrature rule of every element.
pub trait Quadrature<const D: usize, T: Real = f64>: Debug + Send + Sync {
    /// The rule of `element`, in its local coordinates.
    fn rule(&self, element: usize) -> &Rule<D, T>;
    /// The rules per direction of the element's block if the rule is their product (first axis fastest).
    ///
    /// Elements of a block that share these rules return the same objects; otherwise the block is not treated as one
    /// product.
    fn axes(&self, _element: usize) -> Option<[&dyn Quadrature<1, T>; D]> {
        None
    }
}

macro_rules! forward_quadrature {
    ($($pointer:ty),*) => {$(
        impl<const D: usize, T: Real, X: Quadrature<D, T> + ?Sized> Quadrature<D, T> for $pointer {
            fn rule(&self, element: usize) -> &Rule<D, T> { (**self).rule(element) }
            fn axes(&self, element: usize) -> Option<[&dyn Quadrature<1, T>; D]> { (**self).axes(element) }
        }
    )*};
}
forward_quadrature!(&X, Box<X>, std::sync::Arc<X>);

/// A rule is the same on every element.
impl<const D: usize, T: Real> Quadrature<D, T> for Rule<D, T> {
    fn rule(&self, _element: usize) -> &Rule<D, T> {
        self
    }
}
