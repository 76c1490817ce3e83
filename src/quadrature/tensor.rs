//! Products of univariate rules.

use super::{Quadrature, Rule, gauss_legendre};
use crate::linalg::{Real, Vector};

/// The product of one univariate rule per direction, the same on every element; first axis fastest.
#[derive(Clone, Debug, PartialEq)]
pub struct TensorRule<const D: usize, T: Real = f64> {
    axes: [Rule<1, T>; D],
    product: Rule<D, T>,
}

impl<const D: usize, T: Real> TensorRule<D, T> {
    /// The product of `axes`.
    pub fn new(axes: [Rule<1, T>; D]) -> Self {
        let count = axes.iter().map(|a| a.weights.len()).product();
        let mut product = Rule { points: Vec::with_capacity(count), weights: Vec::with_capacity(count) };
        for q in 0..count {
            let (mut rest, mut point, mut weight) = (q, Vector::<D, T>::zeros(), T::one());
            for (k, axis) in axes.iter().enumerate() {
                let i = rest % axis.weights.len();
                rest /= axis.weights.len();
                point[k] = axis.points[i][0];
                weight *= axis.weights[i];
            }
            product.points.push(point);
            product.weights.push(weight);
        }
        Self { axes, product }
    }

    /// Gauss-Legendre rules with `n[k]` points in direction k.
    pub fn gauss(n: [usize; D]) -> Self {
        Self::new(n.map(gauss_legendre))
    }
}

impl<const D: usize, T: Real> Quadrature<D, T> for TensorRule<D, T> {
    fn rule(&self, _element: usize) -> &Rule<D, T> {
        &self.product
    }
    fn axes(&self, _element: usize) -> Option<[&dyn Quadrature<1, T>; D]> {
        Some(self.axes.each_ref().map(|a| a as &dyn Quadrature<1, T>))
    }
}
