//! Outlines of obstacles: curves and the boundaries of areas in the plane, surfaces and the boundaries of solids in space.

use crate::basis::{Cell, Elements, Order, Rational, WeightError};
use crate::geometry::{Bounds, ClosestPoint, ControlNet, ControlPoints, Geometry, MapTable, Tree, cell, unit_normal};
use crate::linalg::{Real, Vector};
use crate::space::{Body, SideError, Space, Trace};
use std::sync::Arc;

/// Pieces nearer than this share of the outline's size touch.
const TOUCHING: f64 = 1e-8;
/// Touching pieces of two bodies have opposite normals: their product is below this.
const OPPOSITE: f64 = -0.5;
/// Tangents shorter than this fraction of the curve's size count as zero.
const STANDS_STILL: f64 = 1e-12;
/// Points of an element at which its tangent is checked.
const LOOKS: usize = 5;

/// One element of an obstacle's outline; (S, N) stands for (N - 1, N).
#[derive(Clone, Debug)]
pub struct OutlinePiece<const S: usize = 1, const N: usize = 2, T: Real = f64> {
    /// The curve or surface that it is part of.
    pub map: Arc<dyn Geometry<S, N, T>>,
    /// Its element there.
    pub element: usize,
    /// +1 or -1: sign that makes the tangent turned clockwise, or the cross product of the tangents, a normal out of the obstacle.
    pub outward: T,
}

/// Error of a curve or a surface that is no outline.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum OutlineError {
    /// Weights that are not positive, or too few.
    #[error(transparent)]
    Weights(#[from] WeightError),
    /// A curve without a tangent at a point.
    #[error("element {element} of the curve stands still at ({}, {}): it has no normal there", .x[0], .x[1])]
    StandsStill {
        /// The element.
        element: usize,
        /// The point \[length\].
        x: [f64; 2],
    },
    /// A surface without a normal inside of an element.
    #[error("element {element} of the surface has no normal at ({}, {}, {})", .x[0], .x[1], .x[2])]
    NoNormal {
        /// The element.
        element: usize,
        /// The point \[length\].
        x: [f64; 3],
    },
}

/// The elements of a trace with their outward signs.
pub fn pieces<const S: usize, const N: usize, T: Real>(trace: &Trace<S, N, T>) -> Vec<OutlinePiece<S, N, T>> {
    let space: Arc<dyn Space<S, N, T>> = Arc::clone(&trace.space);
    let map: Arc<dyn Geometry<S, N, T>> = space;
    (0..map.num_elements()).map(|e| OutlinePiece { map: Arc::clone(&map), element: e, outward: trace.outward[e] }).collect()
}

/// The outline of the obstacle to the right of a curve: normals are the direction of travel turned by +90 degrees.
///
/// # Errors
/// [`OutlineError`].
pub fn curve_outline(net: ControlNet<1, 2>) -> Result<Vec<OutlinePiece>, OutlineError> {
    let ControlNet { axes: [axis], points, weights } = net;
    let map: Arc<dyn Geometry<1, 2>> = match weights {
        Some(weights) => {
            let basis = Rational::try_new::<1>(axis, weights)?;
            Arc::new(ControlPoints { basis, points })
        }
        None => Arc::new(ControlPoints { basis: axis, points }),
    };
    let size = map.extent().map_or(0.0, |b| b.diagonal());
    let looks: Vec<Vector<1>> = (0..LOOKS).map(|k| Vector::<1>::new(k as f64 / (LOOKS - 1) as f64)).collect();
    let mut table = MapTable::new();
    for e in 0..map.num_elements() {
        map.map(e, &looks, Order::Gradients, &mut table);
        if let Some(q) = table.jacobian.iter().position(|j| j.norm().is_nan() || j.norm() <= STANDS_STILL * size) {
            return Err(OutlineError::StandsStill { element: e, x: table.x[q].into() });
        }
    }
    Ok((0..map.num_elements()).map(|element| OutlinePiece { map: Arc::clone(&map), element, outward: -1.0 }).collect())
}

/// The boundary of an area or a solid, with outward normals: the sides of a body.
///
/// # Errors
/// [`SideError`] of the body.
pub fn body_outline<const S: usize, const N: usize>(
    body: &dyn Body<S, N>,
    sides: impl IntoIterator<Item = String>,
) -> Result<Vec<OutlinePiece<S, N>>, SideError> {
    let mut all = Vec::new();
    for side in sides {
        all.extend(pieces(&body.trace(&side)?));
    }
    Ok(all)
}

/// Returns the pieces that touch no other; seams between areas or solids, or of one with itself, are interior.
pub fn without_seams<const S: usize, const N: usize>(all: Vec<OutlinePiece<S, N>>) -> Vec<OutlinePiece<S, N>> {
    let bounds: Vec<Bounds<N>> = all.iter().map(|p| p.map.bounds(p.element)).collect();
    let tree = Tree::new(bounds);
    let tolerance = TOUCHING * tree.bounds().map_or(0.0, |b| b.diagonal());
    let mut table = MapTable::new();
    let mut at = |p: &OutlinePiece<S, N>, xi: Vector<S>| {
        p.map.map(p.element, &[xi], Order::Gradients, &mut table);
        (table.x[0], unit_normal(&table.jacobian[0], p.outward))
    };
    let inside: Vec<bool> = (0..all.len())
        .map(|k| {
            let (x, normal) = at(&all[k], cell::center(all[k].map.cell(all[k].element)));
            let near = tree.meeting(&Bounds { lo: x, hi: x }.inflated(tolerance));
            near.into_iter().filter(|&j| j != k).any(|j| {
                let one = OneElement { piece: &all[j] };
                let foot = ClosestPoint::<S, N, _>::new(one).project_within(&x, 2.0 * tolerance);
                foot.is_some_and(|f| f.distance <= tolerance && normal.dot(&at(&all[j], f.xi).1) < OPPOSITE)
            })
        })
        .collect();
    all.into_iter().zip(inside).filter(|(_, inside)| !inside).map(|(p, _)| p).collect()
}

/// One element of a map as a map.
struct OneElement<'a, const S: usize, const N: usize> {
    piece: &'a OutlinePiece<S, N>,
}

impl<const S: usize, const N: usize> std::fmt::Debug for OneElement<'_, S, N> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_tuple("OneElement").field(&self.piece.element).finish()
    }
}

impl<const S: usize, const N: usize> Elements for OneElement<'_, S, N> {
    fn num_elements(&self) -> usize {
        1
    }
    fn cell(&self, _: usize) -> Cell {
        self.piece.map.cell(self.piece.element)
    }
}

impl<const S: usize, const N: usize> Geometry<S, N> for OneElement<'_, S, N> {
    fn map(&self, _: usize, xi: &[Vector<S>], order: Order, table: &mut MapTable<S, N>) {
        self.piece.map.map(self.piece.element, xi, order, table);
    }
    fn bounds(&self, _: usize) -> Bounds<N> {
        self.piece.map.bounds(self.piece.element)
    }
}
