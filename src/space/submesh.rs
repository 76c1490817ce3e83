//! Named points, edges and faces of the elements of a body that are none of its sides.

use crate::linalg::{Real, Vector};

/// Points, edges or faces of elements: inside the body, or of a lower dimension than its sides. Supports and forces act on them.
#[derive(Clone, Debug, PartialEq)]
pub struct Submesh<const N: usize, T: Real = f64> {
    /// 0 for points, 1 for edges, 2 for faces.
    pub dimension: usize,
    /// Per point, edge or face one of its elements, and the local coordinates of its corners there: of edges and faces in the order of
    /// [`cell::corners`](crate::geometry::cell::corners).
    pub cells: Vec<(usize, Vec<Vector<N, T>>)>,
}
