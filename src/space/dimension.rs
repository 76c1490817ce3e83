//! Dimensions whose bodies are compiled with the library: programs that use them do not compile their numerics again.

use super::{Mapping, Mesh, MeshCells, MeshError, Patch, PatchSpec, SideError, Space, SpecError, Trace};
use crate::basis::Cell;
use crate::geometry::Embedding;
use std::sync::Arc;

/// Bodies of the plane with their curves, and of space with their surfaces: implemented by their sides, [`Trace<1, 2>`](Trace) and
/// [`Trace<2, 3>`](Trace).
pub trait Dimension<const S: usize, const N: usize>: Sized {
    /// [`Patch::try_new`].
    ///
    /// # Errors
    /// Those of the patch.
    fn patch(spec: &PatchSpec<N>) -> Result<Patch<S, N>, SpecError>;

    /// A side of a patch.
    ///
    /// # Errors
    /// [`SideError`] if it has none of this name.
    fn side_of_patch(patch: &Patch<S, N>, name: &str) -> Result<Self, SideError>;

    /// [`Mesh::from_patch`].
    ///
    /// # Errors
    /// Those of the mesh.
    fn mesh_of_patch(spec: &PatchSpec<N>) -> Result<Mesh<S, N>, SpecError>;

    /// [`Mesh::from_cells`].
    ///
    /// # Errors
    /// Those of the mesh.
    fn mesh_of_cells(cells: &MeshCells<N>, degree: usize, mapping: Mapping) -> Result<Mesh<S, N>, MeshError>;

    /// A side of a mesh.
    ///
    /// # Errors
    /// [`SideError`] if it has none of this name.
    fn side_of_mesh(mesh: &Mesh<S, N>, name: &str) -> Result<Self, SideError>;

    /// [`Trace::from_facets`].
    ///
    /// # Errors
    /// [`SideError`] of the side.
    fn side_of_facets(space: &Arc<dyn Space<N, N>>, facets: Vec<Embedding<S, N>>, kind: Cell) -> Result<Self, SideError>;
}

macro_rules! dimension {
    ($s:literal, $n:literal) => {
        impl Dimension<$s, $n> for Trace<$s, $n> {
            fn patch(spec: &PatchSpec<$n>) -> Result<Patch<$s, $n>, SpecError> {
                Patch::made(spec)
            }
            fn side_of_patch(patch: &Patch<$s, $n>, name: &str) -> Result<Self, SideError> {
                patch.side(name)
            }
            fn mesh_of_patch(spec: &PatchSpec<$n>) -> Result<Mesh<$s, $n>, SpecError> {
                Mesh::made_from_patch(spec)
            }
            fn mesh_of_cells(cells: &MeshCells<$n>, degree: usize, mapping: Mapping) -> Result<Mesh<$s, $n>, MeshError> {
                Mesh::made_from_cells(cells, degree, mapping)
            }
            fn side_of_mesh(mesh: &Mesh<$s, $n>, name: &str) -> Result<Self, SideError> {
                mesh.side(name)
            }
            fn side_of_facets(space: &Arc<dyn Space<$n, $n>>, facets: Vec<Embedding<$s, $n>>, kind: Cell) -> Result<Self, SideError> {
                Self::from_facets(space, facets, kind)
            }
        }
    };
}
dimension!(1, 2);
dimension!(2, 3);
