//! The space on a side of a body, and where each of its elements lies in the body.

use super::Space;
use crate::geometry::Embedding;
use crate::linalg::Real;
use std::sync::Arc;

/// A space one dimension lower than its body, with facets. (S, N) stands for (N - 1, N).
#[derive(Clone, Debug)]
pub struct Trace<const S: usize, const N: usize, T: Real = f64> {
    /// Functions and map of the side, on its own elements.
    pub space: Arc<dyn Space<S, N, T>>,
    /// The body's function behind each function of the side.
    pub dofs: Vec<usize>,
    /// Where each element of the side lies in the body.
    pub facets: Vec<Embedding<S, N, T>>,
    /// Per element: +1 or -1 times the cross product of the tangents points out of the body (curves: the tangent
    /// turned clockwise, (t_y, -t_x)).
    pub outward: Vec<T>,
}
