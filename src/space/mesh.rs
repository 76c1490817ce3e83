//! Lagrange meshes: finite elements.

use super::grid::ElementGrid;
use super::mesh_trace::FacetSides;
use super::{
    Body, Dimension, FunctionSpace, Mapping, MeshCells, MeshError, PatchSpec, Quality, SideError, Space, SpecError, Submesh, Trace,
};
use crate::basis::{Basis, LagrangeLine, TensorProduct};
use crate::geometry::{Embedding, Geometry};
use crate::linalg::Vector;
use std::collections::HashMap;
use std::sync::Arc;

/// A Lagrange mesh, tensor or simplex cells, isoparametric or on the exact map. (S, N) stands for (N - 1, N).
///
/// Made by [`Mesh::from_patch`] and [`Mesh::from_cells`].
#[derive(Clone, Debug)]
pub struct Mesh<const S: usize, const N: usize> {
    /// Element grid of the patch; `None` for a mesh of cells.
    pub(super) grid: Option<ElementGrid<N>>,
    pub(super) space: Arc<dyn Space<N, N>>,
    pub(super) sides: FacetTables<S, N>,
    pub(super) quality: Quality<N>,
    pub(super) named: MeshPoints<N>,
    /// Whether its sides lie exactly on those of a patch.
    pub(super) exact: bool,
}

/// Data from which the traces of a mesh are built.
#[derive(Clone, Debug)]
pub(super) enum FacetTables<const S: usize, const N: usize> {
    /// Products of lines along the sides of a patch.
    Lines(HashMap<String, MeshSide<S, N>>),
    /// Facets of cells.
    Facets(FacetSides<N>),
}

/// Data of one side of a patch mesh: Lagrange lines, functions, map, facets.
#[derive(Clone, Debug)]
pub(super) struct MeshSide<const S: usize, const N: usize> {
    /// Lagrange lines along the side.
    pub lines: [LagrangeLine<f64>; S],
    /// Function of the mesh for each product of the lines; products at a collapsed edge share one.
    pub ids: Vec<usize>,
    pub geometry: Arc<dyn Geometry<S, N>>,
    pub facets: Vec<Embedding<S, N>>,
}

/// The points of a mesh of cells.
#[derive(Clone, Debug, Default)]
pub(super) struct MeshPoints<const N: usize> {
    pub points: Vec<Vector<N>>,
    /// The function whose node is there, [`usize::MAX`] for none.
    pub function: Vec<usize>,
}

impl<const S: usize, const N: usize> Mesh<S, N>
where
    Trace<S, N>: Dimension<S, N>,
{
    /// Builds the mesh of `spec`, whose continuity and basis are ignored.
    ///
    /// Simplex cells cut every quadrilateral by the diagonal from its (u0, v0) corner to its (u1, v1) corner, and every
    /// hexahedron into six tetrahedra around the diagonal from (u0, v0, w0) to (u1, v1, w1).
    /// Isoparametric nodes lie on the exact map; at a collapsed edge the simplices without volume are dropped, and the
    /// others take the whole cell. On the exact map both triangles stay, with the functions on the edge merged;
    /// tetrahedra are refused there.
    /// # Errors
    /// [`SpecError`] for degrees and breakpoints out of range, simplex cells of mixed degree, tetrahedra on the exact map of
    /// a geometry with collapsed edges, and inverted elements.
    pub fn from_patch(spec: &PatchSpec<N>) -> Result<Self, SpecError> {
        Trace::<S, N>::mesh_of_patch(spec)
    }

    /// Builds the body of an unstructured mesh, with a space of `degree` on every cell: 1 to 8, with simplices 1 to 4.
    ///
    /// [`Mapping::Exact`] keeps the cells' own map. [`Mapping::Isoparametric`] interpolates it in `degree` at the nodes of the space: the
    /// same map where `degree` is not below the geometry order, else one of lower degree with its nodes on the cells.
    ///
    /// Elements are the cells in the order of the blocks; left-handed ones are mirrored by exchanging their first two axes. Functions are
    /// numbered along a space-filling curve, whatever the order of cells and points is: [`Mesh::function_at`] finds them. Sides
    /// are the tags whose facets all lie on the boundary, and [`Mesh::untagged`]; a tag inside the mesh is no side, and its
    /// trace is [`SideError::Interior`](super::SideError::Interior). Tags of one name are one side. In the plane the facets of a side
    /// follow one another with the body on their left. n log n in the number of cells.
    ///
    /// # Errors
    /// [`MeshError`]
    pub fn from_cells(cells: &MeshCells<N>, degree: usize, mapping: Mapping) -> Result<Self, MeshError> {
        Trace::<S, N>::mesh_of_cells(cells, degree, mapping)
    }
}

impl<const S: usize, const N: usize> Mesh<S, N> {
    /// Elements per direction of the patch; a simplex mesh cuts each in two or six. `None` for a mesh of cells.
    pub fn elements(&self) -> Option<[usize; N]> {
        self.grid.as_ref().map(ElementGrid::counts)
    }

    /// Names of the faces of the patch that are points or edges; empty for a mesh of cells.
    pub fn collapsed_sides(&self) -> Vec<String> {
        self.grid.as_ref().map(ElementGrid::collapsed_sides).unwrap_or_default()
    }

    /// Least Jacobian, orientation, degenerate points.
    pub fn quality(&self) -> &Quality<N> {
        &self.quality
    }

    /// A side by its name.
    pub(super) fn side(&self, side: &str) -> Result<Trace<S, N>, SideError> {
        let name = match &self.grid {
            Some(grid) => grid.side(side)?.name(),
            None => side.to_string(),
        };
        let side = match &self.sides {
            FacetTables::Facets(sides) => return sides.trace(&self.space, &name),
            FacetTables::Lines(sides) => &sides[&name],
        };
        let (basis, dofs): (Box<dyn Basis<S>>, _) = super::grid::merge::<S>(TensorProduct::new(side.lines.clone()), &side.ids);
        let space = FunctionSpace { basis, geometry: side.geometry.clone() };
        Ok(Trace::on_boundary(&self.space, Arc::new(space), dofs, side.facets.clone()))
    }

    /// Name of the side of a mesh of cells that holds the boundary facets without a tag: `untagged`, with underscores appended
    /// until it differs from all tags; `None` if every boundary facet has a tag.
    pub fn untagged(&self) -> Option<&str> {
        match &self.sides {
            FacetTables::Lines(_) => None,
            FacetTables::Facets(sides) => sides.named.untagged.as_deref(),
        }
    }

    /// Coordinates of a point that is a vertex of a mesh of cells or another node of its space \[length\]; `None` for other points.
    ///
    /// `point` is an index into the points given to [`Mesh::from_cells`].
    pub fn vertex(&self, point: usize) -> Option<Vector<N>> {
        self.function_at(point).map(|_| self.named.points[point])
    }

    /// Function whose node is a point of a mesh of cells; its coefficient is the field's value there. `None` if there is none.
    ///
    /// All corners of cells are nodes; of the points between them those that the nodes of the space coincide with.
    pub fn function_at(&self, point: usize) -> Option<usize> {
        self.named.function.get(point).copied().filter(|&i| i != usize::MAX)
    }
}

impl<const S: usize, const N: usize> Body<S, N> for Mesh<S, N>
where
    Trace<S, N>: Dimension<S, N>,
{
    fn space(&self) -> &Arc<dyn Space<N, N>> {
        &self.space
    }

    fn known_quality(&self) -> Option<&Quality<N>> {
        Some(&self.quality)
    }

    fn is_exact(&self) -> bool {
        self.exact
    }

    fn sides(&self) -> Vec<String> {
        match &self.sides {
            FacetTables::Lines(_) => self.grid.as_ref().map(ElementGrid::sides).unwrap_or_default(),
            FacetTables::Facets(sides) => sides.names(),
        }
    }

    fn submesh(&self, name: &str) -> Option<Submesh<N>> {
        match &self.sides {
            FacetTables::Lines(_) => None,
            FacetTables::Facets(sides) => sides.submesh(name),
        }
    }

    fn trace(&self, side: &str) -> Result<Trace<S, N>, SideError> {
        Trace::side_of_mesh(self, side)
    }
}
