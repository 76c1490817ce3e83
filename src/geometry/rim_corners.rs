//! Corners of a surface's rim, as elements see them that have no edge there.
//!
//! A triangle may touch the rim in a vertex alone. Where that vertex is the closest point to p, p lies beyond the rim if it does so of an edge of
//! the rim that ends there: with the outward direction c of the edge in the tangent plane of its element,
//!
//! ```text
//! c = J d - t (t . J d) / |t|²,   (p - x) . c > 0
//! ```
//!
//! d outward in local coordinates and t along the edge. In the fan of a kink that ends at the rim p - x has no part along c.

use super::{Bounds, Geometry, MapTable, Tree, cell};
use crate::basis::{Cell, Order};
use crate::linalg::{Real, Vector};

/// The corners of the edges of a rim.
#[derive(Clone, Debug)]
pub(super) struct RimCorners<const D: usize, const N: usize, T: Real> {
    tree: Tree<N, T>,
    /// Per corner the element, its face of the rim, and the corner's number in the element.
    edges: Vec<(usize, usize, usize)>,
}

impl<const D: usize, const N: usize, T: Real> RimCorners<D, N, T> {
    /// The corners of `loose` faces, which are given per element and face; none of maps that are no surfaces.
    pub fn of(geometry: &impl Geometry<D, N, T>, loose: &[Vec<bool>]) -> Self {
        let (mut boxes, mut edges, mut table) = (Vec::new(), Vec::new(), MapTable::new());
        for (e, own) in loose.iter().enumerate().filter(|(_, own)| D == 2 && own.contains(&true)) {
            let kind = geometry.cell(e);
            geometry.map(e, &cell::corners(kind), Order::Values, &mut table);
            for (f, face) in cell::faces::<D, T>(kind).iter().enumerate().filter(|(f, _)| own[*f]) {
                for &corner in &face.corners {
                    boxes.push(Bounds { lo: table.x[corner], hi: table.x[corner] });
                    edges.push((e, f, corner));
                }
            }
        }
        Self { tree: Tree::new(boxes), edges }
    }

    /// Whether `x + away` lies beyond an edge of the rim that ends at `x`, by more than `allowed` \[length\].
    pub fn beyond(&self, geometry: &impl Geometry<D, N, T>, x: &Vector<N, T>, away: &Vector<N, T>, [same, allowed]: [T; 2]) -> bool {
        let mut table = MapTable::new();
        self.tree.meeting(&Bounds { lo: *x, hi: *x }.inflated(same)).into_iter().any(|k| {
            let (element, f, corner) = self.edges[k];
            let kind = geometry.cell(element);
            let (corners, faces) = (cell::corners::<D, T>(kind), cell::faces::<D, T>(kind));
            geometry.map(element, &[corners[corner]], Order::Gradients, &mut table);
            let ends = &faces[f].corners;
            let along = table.jacobian[0] * (corners[ends[1]] - corners[ends[0]]);
            let out = table.jacobian[0] * outward::<D, T>(kind, f);
            let square = along.norm_squared();
            let across = if square > T::zero() { out - along * (along.dot(&out) / square) } else { out };
            let length = across.norm();
            length > T::zero() && away.dot(&across) / length > allowed
        })
    }
}

/// The local direction out of a cell at face `f`.
fn outward<const D: usize, T: Real>(kind: Cell, f: usize) -> Vector<D, T> {
    let unit = |axis: usize, sign: T| Vector::<D, T>::from_fn(|k, _| if k == axis { sign } else { T::zero() });
    match kind {
        Cell::Tensor => unit(f / 2, if f.is_multiple_of(2) { -T::one() } else { T::one() }),
        Cell::Simplex if f < D => unit(f, -T::one()),
        Cell::Simplex => Vector::repeat(T::one()),
    }
}
