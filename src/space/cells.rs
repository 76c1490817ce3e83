//! Data of a mesh: points, cells with their nodes, named facets.

use crate::basis::{Cell, key_of};
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

/// Facets under a name: a side of the body where they lie on its boundary. Of one corner, or of two in space, they are points and edges:
/// none of its sides, but a place of supports and forces, as facets inside are.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FacetTag {
    /// Its name.
    pub name: String,
    /// Corner points of every facet in any order; `usize::MAX` where a facet has fewer than four corners.
    pub corners: Vec<[usize; 4]>,
}

impl FacetTag {
    /// 0 for points, 1 for edges, 2 for faces; `None` if it is empty.
    pub fn dimension(&self) -> Option<usize> {
        let corners = self.corners.first()?.iter().filter(|&&p| p != usize::MAX).count();
        Some(corners.saturating_sub(1).min(2))
    }

    /// Keys of the facets in vertices; `None` for one with a point that is no vertex. `vertex` gives the vertex at a point.
    pub(super) fn keys<'a>(&'a self, vertex: &'a [usize]) -> impl Iterator<Item = Option<[usize; 4]>> + 'a {
        let at = |p: usize| vertex.get(p).copied().filter(|&v| v != usize::MAX);
        self.corners.iter().map(move |points| {
            let corners = points.iter().filter(|&&p| p != usize::MAX).map(|&p| at(p));
            Some(key_of(corners.collect::<Option<Vec<usize>>>()?.into_iter()))
        })
    }
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
    /// Named sides, and edges and points, which may overlap.
    pub tags: Vec<FacetTag>,
}
