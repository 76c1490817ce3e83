//! Lagrange meshes: finite elements.

use super::grid::Grid;
use super::{Body, Over, Quality, SideError, Space, Trace};
use crate::basis::{Basis, Cell, LagrangeLine, TensorProduct};
use crate::geometry::{Embedded, Embedding, Geometry};
use std::collections::HashMap;
use std::sync::Arc;

/// A Lagrange mesh of a patch, tensor or simplex cells, isoparametric or on the exact map. (S, N) stands for (N - 1, N).
///
/// Made by [`Mesh::from_patch`].
#[derive(Clone, Debug)]
pub struct Mesh<const S: usize, const N: usize> {
    pub(super) grid: Grid<N>,
    pub(super) space: Arc<dyn Space<N, N>>,
    /// The map of the mesh's elements.
    pub(super) geometry: Arc<dyn Geometry<N, N>>,
    pub(super) sides: HashMap<String, MeshSide<S, N>>,
    pub(super) quality: Quality<N>,
}

/// What the trace of a side is made of.
#[derive(Clone, Debug)]
pub(super) struct MeshSide<const S: usize, const N: usize> {
    /// Lagrange lines along the side.
    pub lines: [LagrangeLine<f64>; S],
    /// The mesh's function behind each product of theirs; several are one at a collapsed edge.
    pub ids: Vec<usize>,
    pub facets: Vec<Embedding<S, N>>,
}

impl<const S: usize, const N: usize> Mesh<S, N> {
    /// Elements per direction of the patch; a simplex mesh cuts each in two (or six).
    pub fn elements(&self) -> [usize; N] {
        self.grid.counts()
    }

    /// Faces of the patch that are points or edges.
    pub fn collapsed_sides(&self) -> Vec<String> {
        self.grid.collapsed_sides()
    }

    /// Least Jacobian, orientation, degenerate points.
    pub fn quality(&self) -> &Quality<N> {
        &self.quality
    }
}

impl<const S: usize, const N: usize> Body<S, N> for Mesh<S, N> {
    fn space(&self) -> &Arc<dyn Space<N, N>> {
        &self.space
    }

    fn sides(&self) -> Vec<String> {
        self.grid.sides()
    }

    fn trace(&self, side: &str) -> Result<Trace<S, N>, SideError> {
        let name = self.grid.side(side)?.name();
        let side = &self.sides[&name];
        let (basis, dofs): (Box<dyn Basis<S>>, _) = super::grid::merge::<S>(TensorProduct::new(side.lines.clone()), &side.ids);
        let geometry = Embedded::new(self.geometry.clone(), side.facets.clone(), Cell::Tensor);
        Ok(Trace::on_boundary(&self.space, Arc::new(Over { basis, geometry }), dofs, side.facets.clone()))
    }
}
