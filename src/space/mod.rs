//! Floor 5: spaces (a basis over a geometry), bodies with named sides, traces.

mod cells;
mod clearance;
mod connected;
mod curve;
mod deformed;
mod diameter;
mod dimension;
mod divisions;
mod field;
mod glue;
mod grid;
mod joined;
mod mesh;
mod mesh_error;
mod mesh_facets;
mod mesh_from_cells;
mod mesh_from_patch;
mod mesh_tetrahedra;
mod mesh_trace;
mod multipatch;
mod off_collapsed;
mod patch;
mod quality;
pub mod refine;
mod refine_cells;
mod spec;
mod submesh;
mod trace;

use crate::basis::{Basis, BasisStructure, Cell, Elements, Order, Polynomials, ShapeTable};
use crate::geometry::{Bounds, ControlPoints, Embedded, Geometry, MapStructure, MapTable};
use crate::linalg::{Real, Vector};
use std::fmt::Debug;
use std::sync::Arc;

pub use cells::{CellBlock, FacetTag, MeshCells};
pub use clearance::{Clearance, Sight, Skin, SkinPoint, clearance, raised, skin_points};
pub use connected::{Connected, Unshared, unshared_points};
pub use deformed::Deformed;
pub use diameter::diameter;
pub use dimension::Dimension;
pub use divisions::{DivisionError, Divisions, Grading, divided};
pub use field::{FieldAt, Located, Locator, OutsideBody, field_at, locate};
pub use glue::{GlueError, GlueRow, GluedFacet, Near, glue, glue_facets};
pub use joined::DirectSum;
pub use mesh::Mesh;
pub use mesh_error::MeshError;
pub use mesh_from_cells::MAX_ORDER;
pub use multipatch::{JoinedSide, MultiPatch, MultiPatchError, Seam};
pub use off_collapsed::off_collapsed;
pub use patch::Patch;
pub use quality::{InvertedElement, Quality, measure, quality, revolved_measure};
pub use refine_cells::{corner_places, facet_key, facets, nodes_per_cell, refine_cells};
pub use spec::{BasisKind, MAX_DEGREE_SIMPLEX, MAX_DEGREE_SPLINE, MAX_DEGREE_TENSOR, Mapping, PatchSpec, SpecError};
pub use submesh::Submesh;
pub use trace::Trace;

/// Scalar functions and a map on the same elements.
pub trait Space<const D: usize, const N: usize, T: Real = f64>: Basis<D, T> + Geometry<D, N, T> {
    /// Both tables at once; isoparametric spaces override it to evaluate their functions only once.
    fn evaluate(&self, element: usize, xi: &[Vector<D, T>], order: Order, shapes: &mut ShapeTable<D, T>, map: &mut MapTable<D, N, T>) {
        self.tabulate(element, xi, order, shapes);
        self.map(element, xi, order, map);
    }
}

macro_rules! forward_space {
    ($($pointer:ty),*) => {$(
        impl<const D: usize, const N: usize, T: Real, X: Space<D, N, T> + ?Sized> Space<D, N, T> for $pointer {
            fn evaluate(&self, element: usize, xi: &[Vector<D, T>], order: Order, shapes: &mut ShapeTable<D, T>, map: &mut MapTable<D, N, T>) {
                (**self).evaluate(element, xi, order, shapes, map)
            }
        }
    )*};
}
forward_space!(&X, Box<X>, Arc<X>);

/// Any basis over any geometry on the same elements.
#[derive(Clone, Copy, Debug)]
pub struct FunctionSpace<B, G> {
    /// The functions.
    pub basis: B,
    /// The map.
    pub geometry: G,
}

impl<B: Elements, G: Elements> Elements for FunctionSpace<B, G> {
    fn num_elements(&self) -> usize {
        self.basis.num_elements()
    }
    fn cell(&self, element: usize) -> Cell {
        self.basis.cell(element)
    }
    fn corners(&self, element: usize, ids: &mut Vec<usize>) {
        self.basis.corners(element, ids);
    }
}

impl<const D: usize, T: Real, B: Basis<D, T>, G: Elements> Basis<D, T> for FunctionSpace<B, G> {
    fn num_functions(&self) -> usize {
        self.basis.num_functions()
    }
    fn degree(&self, element: usize) -> [usize; D] {
        self.basis.degree(element)
    }
    fn active(&self, element: usize, ids: &mut Vec<usize>) {
        self.basis.active(element, ids);
    }
    fn tabulate(&self, element: usize, xi: &[Vector<D, T>], order: Order, table: &mut ShapeTable<D, T>) {
        self.basis.tabulate(element, xi, order, table);
    }
    fn structure(&self) -> &dyn BasisStructure<D, T> {
        self.basis.structure()
    }
    fn polynomials(&self, wanted: Polynomials) -> Option<Box<dyn Basis<D, T>>> {
        self.basis.polynomials(wanted)
    }
}

impl<const D: usize, const N: usize, T: Real, B: Elements, G: Geometry<D, N, T>> Geometry<D, N, T> for FunctionSpace<B, G> {
    fn map(&self, element: usize, xi: &[Vector<D, T>], order: Order, table: &mut MapTable<D, N, T>) {
        self.geometry.map(element, xi, order, table);
    }
    fn bounds(&self, element: usize) -> Bounds<N, T> {
        self.geometry.bounds(element)
    }
    fn all_bounds(&self) -> Vec<Bounds<N, T>> {
        self.geometry.all_bounds()
    }
    fn extent(&self) -> Option<Bounds<N, T>> {
        self.geometry.extent()
    }
    fn map_structure(&self) -> &dyn MapStructure<D, N, T> {
        self.geometry.map_structure()
    }
}

impl<const D: usize, const N: usize, T: Real, B: Basis<D, T>, G: Geometry<D, N, T>> Space<D, N, T> for FunctionSpace<B, G> {}

/// Control points over a basis are an isoparametric space: one table serves the functions and the map.
impl<const D: usize, const N: usize, T: Real, B: Basis<D, T>> Space<D, N, T> for ControlPoints<B, N, T> {
    fn evaluate(&self, element: usize, xi: &[Vector<D, T>], order: Order, shapes: &mut ShapeTable<D, T>, map: &mut MapTable<D, N, T>) {
        let mut ids = std::mem::take(&mut map.ids);
        self.basis.active(element, &mut ids);
        self.basis.tabulate(element, xi, order, shapes);
        self.combine(&ids, shapes, xi.len(), order, map);
        map.ids = ids;
    }
}

impl<const S: usize, const D: usize, const N: usize, T: Real, X: Space<D, N, T>> Space<S, N, T> for Embedded<S, D, X, T> {}

/// Numbering of the unknowns of a vector field: unknown = first + components * function + component.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Field {
    /// First unknown of the body.
    pub first: usize,
    /// Number of components.
    pub components: usize,
}

impl Field {
    /// Index of the unknown of `component` of `function`.
    #[inline]
    pub fn unknown(&self, function: usize, component: usize) -> usize {
        self.first + self.components * function + component
    }
}

/// Error when a side has no trace.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum SideError {
    /// The body has no side of that name.
    #[error("there is no side `{side}`; sides are {known}")]
    Unknown {
        /// The name given.
        side: String,
        /// The names of all sides, separated by commas.
        known: String,
    },
    /// A facet lies inside the body.
    #[error("facet {facet} of the side lies inside the body; a side must be on its boundary")]
    Interior {
        /// The facet's number.
        facet: usize,
    },
    /// The name stands for points, or for edges of a body in space.
    #[error("`{name}` consists of {}, it is no side", if *.dimension == 0 { "points" } else { "edges" })]
    Lower {
        /// The name given.
        name: String,
        /// Dimension of what it stands for: 0 for points, 1 for edges.
        dimension: usize,
    },
    /// The side is collapsed to a point or an edge.
    #[error("side `{side}` is collapsed to a point and is no side")]
    Collapsed {
        /// The name given.
        side: String,
    },
}

/// A space with named sides. (S, N) stands for (N - 1, N).
pub trait Body<const S: usize, const N: usize, T: Real = f64>: Debug + Send + Sync {
    /// The space on the interior of the body: its functions and map.
    fn space(&self) -> &Arc<dyn Space<N, N, T>>;
    /// Names of the sides, aliases left out.
    fn sides(&self) -> Vec<String>;
    /// Returns the space on a side, with its facets in the body.
    ///
    /// # Errors
    /// [`SideError`] for an unknown name, a collapsed side, or a facet inside the body.
    fn trace(&self, side: &str) -> Result<Trace<S, N, T>, SideError>;
    /// Points, edges and faces under a name that is no side; `None` if there are none.
    fn submesh(&self, _name: &str) -> Option<Submesh<N, T>> {
        None
    }
    /// Quality of the map, as [`quality()`] returns it for the space; `None` if the body has not computed it.
    fn known_quality(&self) -> Option<&Quality<N>> {
        None
    }
    /// Whether its sides lie exactly on those of the geometry that it stands for: splines, meshes on an exact map, polynomials of at most
    /// the degree of a mesh. `false` where nothing is known of a geometry.
    fn is_exact(&self) -> bool {
        false
    }
}

macro_rules! forward_body {
    ($($pointer:ty),*) => {$(
        impl<const S: usize, const N: usize, T: Real, X: Body<S, N, T> + ?Sized> Body<S, N, T> for $pointer {
            fn space(&self) -> &Arc<dyn Space<N, N, T>> { (**self).space() }
            fn sides(&self) -> Vec<String> { (**self).sides() }
            fn trace(&self, side: &str) -> Result<Trace<S, N, T>, SideError> { (**self).trace(side) }
            fn submesh(&self, name: &str) -> Option<Submesh<N, T>> { (**self).submesh(name) }
            fn known_quality(&self) -> Option<&Quality<N>> { (**self).known_quality() }
            fn is_exact(&self) -> bool { (**self).is_exact() }
        }
    )*};
}
forward_body!(&X, Box<X>, Arc<X>);
