//! Errors of meshes from which no body can be built.

use super::InvertedElement;
use crate::linalg::Vector;

/// Error when no body can be built from a mesh. Cells and points are counted from zero, cells through all blocks.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MeshError {
    /// There are no cells.
    #[error("the mesh has no cells of dimension {dimension}")]
    Empty {
        /// The dimension of the body.
        dimension: usize,
    },
    /// The degree of the space is out of range.
    #[error("degree {degree} is out of range; {kind} take 1 to {max}")]
    Degree {
        /// The degree given.
        degree: usize,
        /// The largest degree allowed.
        max: usize,
        /// Name of the kind of cells.
        kind: &'static str,
    },
    /// The geometry order is out of range.
    #[error("cells of geometry order {order} are not in this version; orders are 1 to {max}")]
    Order {
        /// The order found.
        order: usize,
        /// The largest order allowed.
        max: usize,
    },
    /// The number of nodes of a block is no multiple of the nodes per cell.
    #[error("block {block} has {nodes} nodes; its cells have {each} each")]
    Nodes {
        /// The block.
        block: usize,
        /// Nodes found.
        nodes: usize,
        /// Nodes per cell.
        each: usize,
    },
    /// A cell refers to a point that does not exist.
    #[error("cell {cell} names point {point}, but there are {points} points")]
    NoPoint {
        /// The cell.
        cell: usize,
        /// The point's index.
        point: usize,
        /// Number of points.
        points: usize,
    },
    /// A coordinate is not finite.
    #[error("point {point} has a coordinate that is not finite")]
    NotFinite {
        /// The point.
        point: usize,
    },
    /// A cell has one point at two corners.
    #[error("cell {cell} has point {point} at two of its corners; collapsed cells are not in this version")]
    Collapsed {
        /// The cell.
        cell: usize,
        /// The point.
        point: usize,
    },
    /// Two cells lie on the same side of a common facet.
    #[error("cells {} and {} overlap at {at:?}: they lie on the same side of a common facet; one is inverted, or listed twice", .cells[0], .cells[1])]
    Folded {
        /// The two cells.
        cells: [usize; 2],
        /// Centre of the facet's corners; coordinates beyond the dimension are zero.
        at: [f64; 3],
    },
    /// More than two cells share a facet.
    #[error("a facet at {at:?} belongs to more than two cells, among them {} and {}", .cells[0], .cells[1])]
    Branched {
        /// Two of the cells.
        cells: [usize; 2],
        /// Centre of the facet's corners; coordinates beyond the dimension are zero.
        at: [f64; 3],
    },
    /// A triangle of one cell lies on a quadrilateral of another.
    #[error("at {at:?} a triangular face of cell {} lies on a quadrilateral face of cell {}; hexahedra and tetrahedra must not touch", .cells[0], .cells[1])]
    Mismatch {
        /// The cell with the triangle and the cell with the quadrilateral.
        cells: [usize; 2],
        /// Centre of the quadrilateral's corners.
        at: [f64; 3],
    },
    /// Neighbours do not agree on the shape of their common facet.
    #[error(
        "cell {cell} and a neighbour are {distance:.4e} apart on their common facet at {at:?}; their nodes there must be the same points"
    )]
    Torn {
        /// One of the cells.
        cell: usize,
        /// Distance \[length\].
        distance: f64,
        /// Position; coordinates beyond the dimension are zero.
        at: [f64; 3],
    },
    /// A facet, an edge or a point of a tag belongs to no cell.
    #[error("facet {facet} of `{tag}` is no facet, edge or corner of any cell")]
    NoFacet {
        /// The side.
        tag: String,
        /// Its index in the tag's list.
        facet: usize,
    },
    /// A side has no facets.
    #[error("side `{tag}` has no facets")]
    EmptyTag {
        /// The side.
        tag: String,
    },
    /// The map folds over.
    #[error(transparent)]
    Inverted(#[from] InvertedElement),
}

impl MeshError {
    /// The error with other numbers of its cells and points, such as those of the file that the mesh was read from.
    #[must_use]
    pub fn renumbered(mut self, id: impl Fn(usize) -> usize, node: impl Fn(usize) -> usize) -> Self {
        match &mut self {
            Self::Inverted(inverted) => inverted.element = id(inverted.element),
            Self::Collapsed { cell, point } => (*cell, *point) = (id(*cell), node(*point)),
            Self::Folded { cells, .. } | Self::Branched { cells, .. } | Self::Mismatch { cells, .. } => *cells = cells.map(id),
            Self::Torn { cell, .. } => *cell = id(*cell),
            Self::NotFinite { point } => *point = node(*point),
            _ => {}
        }
        self
    }
}

/// Coordinates of a point for errors, padded with zeros to three.
pub(super) fn place<const N: usize>(x: &Vector<N>) -> [f64; 3] {
    std::array::from_fn(|k| if k < N { x[k] } else { 0.0 })
}
