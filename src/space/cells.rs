//! Data of a mesh: points, cells with their nodes, named facets.

use crate::basis::Cell;
use crate::linalg::Vector;

/// Cells of one shape and order with their nodes.
///
/// Nodes are equispaced in the reference cell and listed with the first axis fastest: (i, j, k) at (i, j, k) / order, on simplices those
/// with i + j + k <= order. A cell of dimension N has (order + 1)^N nodes, or binomial(order + N, N).
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CellBlock {
    /// Shape of the cells.
    pub cell: Cell,
    /// Geometry order, 1 or more.
    pub order: usize,
    /// Points of all cells, cell after cell.
    pub nodes: Vec<usize>,
}

/// Facets under a name: a side of the body.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FacetTag {
    /// Its name.
    pub name: String,
    /// Corner points of every facet in any order; `usize::MAX` where a facet has fewer than four corners.
    pub corners: Vec<[usize; 4]>,
}

/// A mesh of cells of dimension N in N dimensions, as stored in mesh files.
///
/// Cells may be left-handed, shapes and orders may be mixed where neighbours agree on their common facet.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeshCells<const N: usize> {
    /// Points \[length\]; points of no cell are ignored.
    pub points: Vec<Vector<N>>,
    /// The cells; elements of a mesh made of them are numbered in this order.
    pub blocks: Vec<CellBlock>,
    /// Named sides, which may overlap.
    pub tags: Vec<FacetTag>,
}
