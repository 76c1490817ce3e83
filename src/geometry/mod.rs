//! Floor 4: maps from elements to space; independent of unknowns.

mod best_point;
mod bounds;
mod bvh;
pub mod cell;
mod closest;
mod collapse;
mod cone;
mod control;
mod embedded;
mod embedding;
mod feasible_step;
mod foot;
mod frame;
mod hull;
mod inversion;
mod net;
mod net_moves;
mod opposed;
mod oriented;
mod revolution;
mod rim_corners;
mod sag;
mod sampler;
pub mod shapes;
mod smooth_pieces;
mod structure;

use crate::basis::{Elements, NoStructure, Order, ScratchSlot, ShapeTable};
use crate::linalg::{Matrix, Real, Vector};
use crate::parallel;

pub use bounds::Bounds;
pub use bvh::Tree;
pub use closest::{ClosestPoint, Projection, closest_point};
pub use collapse::{CollapsedFace, collapsed_faces};
pub use control::ControlPoints;
pub(crate) use control::combine;
pub use embedded::Embedded;
pub use embedding::Embedding;
pub(crate) use foot::foot_step;
pub use frame::{cross, unit_normal, unit_tangent};
pub use hull::hull;
pub use net::{ControlNet, NetError};
pub use net_moves::{turn, turn_about};
pub use opposed::opposes;
pub use oriented::Oriented;
pub use revolution::circumference;
pub use sag::Sag;
pub use sampler::Sampler;
pub use smooth_pieces::{Kinks, smooth_pieces};
pub use structure::{Control, MapBlock, MapStructure};

/// Positions and derivatives of a map at a batch of points; caller-owned, keeps its memory between calls.
#[derive(Clone, Debug)]
pub struct MapTable<const D: usize, const N: usize, T: Real = f64> {
    /// x(xi_q), \[length\].
    pub x: Vec<Vector<N, T>>,
    /// dx_i/dxi_k at `jacobian[q][(i, k)]`; filled from [`Order::Gradients`] on.
    pub jacobian: Vec<Matrix<N, D, T>>,
    /// d2x_i/dxi_k dxi_l at `hessian[q][i][(k, l)]`; filled from [`Order::Hessians`] on.
    pub hessian: Vec<[Matrix<D, D, T>; N]>,
    /// Scratch of implementors: shape functions of the map.
    pub shapes: ShapeTable<D, T>,
    /// Scratch of implementors: ids.
    pub ids: Vec<usize>,
    /// Scratch of implementors: the table of an inner map of the same dimension.
    pub inner: Option<Box<MapTable<D, N, T>>>,
    /// Scratch of implementors: the table of a map of another dimension, with its points.
    pub embedded: ScratchSlot,
}

impl<const D: usize, const N: usize, T: Real> Default for MapTable<D, N, T> {
    fn default() -> Self {
        let embedded = ScratchSlot::default();
        Self { x: Vec::new(), jacobian: Vec::new(), hessian: Vec::new(), shapes: ShapeTable::new(), ids: Vec::new(), inner: None, embedded }
    }
}

impl<const D: usize, const N: usize, T: Real> MapTable<D, N, T> {
    /// An empty table.
    pub fn new() -> Self {
        Self::default()
    }

    /// Makes room for `points` points up to `order`, all zero; implementors call it first.
    pub fn reset(&mut self, points: usize, order: Order) {
        self.x.clear();
        self.x.resize(points, Vector::zeros());
        self.jacobian.clear();
        self.hessian.clear();
        if order >= Order::Gradients {
            self.jacobian.resize(points, Matrix::zeros());
        }
        if order >= Order::Hessians {
            self.hessian.resize(points, [Matrix::zeros(); N]);
        }
    }
}

/// A map x(xi) per element.
///
/// A new map implements evaluation and a box; [`map_structure`](Geometry::map_structure) is for those that have more to tell.
pub trait Geometry<const D: usize, const N: usize, T: Real = f64>: Elements {
    /// Positions and derivatives at the local points `xi`; continues the element's own functions outside its cell.
    fn map(&self, element: usize, xi: &[Vector<D, T>], order: Order, table: &mut MapTable<D, N, T>);
    /// A box that contains the element, for search trees.
    fn bounds(&self, element: usize) -> Bounds<N, T>;
    /// [`bounds`](Self::bounds) of every element; implementations may share the work between elements of one reference cell.
    fn all_bounds(&self) -> Vec<Bounds<N, T>> {
        parallel::map(self.num_elements(), |e| self.bounds(e))
    }
    /// The box around [`all_bounds`](Self::all_bounds); `None` without elements. Elements known to lie within others may be left out.
    fn extent(&self) -> Option<Bounds<N, T>> {
        self.all_bounds().into_iter().reduce(|a, b| a.union(&b))
    }
    /// +1 or -1: times the cross product of the element's tangents it points out of the body; `None` where no body is known.
    fn outward(&self, _element: usize) -> Option<T> {
        None
    }
    /// Structure that assembly can use; nothing by default.
    fn map_structure(&self) -> &dyn MapStructure<D, N, T> {
        &NoStructure
    }
}

macro_rules! forward_geometry {
    ($($pointer:ty),*) => {$(
        impl<const D: usize, const N: usize, T: Real, X: Geometry<D, N, T> + ?Sized> Geometry<D, N, T> for $pointer {
            fn map(&self, element: usize, xi: &[Vector<D, T>], order: Order, table: &mut MapTable<D, N, T>) {
                (**self).map(element, xi, order, table)
            }
            fn bounds(&self, element: usize) -> Bounds<N, T> { (**self).bounds(element) }
            fn all_bounds(&self) -> Vec<Bounds<N, T>> { (**self).all_bounds() }
            fn extent(&self) -> Option<Bounds<N, T>> { (**self).extent() }
            fn outward(&self, element: usize) -> Option<T> { (**self).outward(element) }
            fn map_structure(&self) -> &dyn MapStructure<D, N, T> { (**self).map_structure() }
        }
    )*};
}
forward_geometry!(&X, Box<X>, std::sync::Arc<X>);
