//! Outlines of obstacles in the plane: curves, and the boundaries of areas.

use super::surface::{OutlinePiece, pieces};
use crate::basis::{Elements, Order, Rational, WeightError};
use crate::geometry::{Bounds, ClosestPoint, ControlNet, ControlPoints, Geometry, MapTable, Tree, unit_normal};
use crate::linalg::Vector;
use crate::space::{Body, SideError};
use std::sync::Arc;

/// Pieces nearer than this share of the outline's size touch.
const TOUCHING: f64 = 1e-8;
/// Touching pieces of two areas have opposite normals: their product is below this.
const OPPOSITE: f64 = -0.5;
/// Tangents shorter than this fraction of the curve's size count as zero.
const STANDS_STILL: f64 = 1e-12;
/// Points of an element at which its tangent is checked.
const LOOKS: usize = 5;

/// Error of a curve that is no outline.
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
    Ok((0..map.num_elements()).map(|element| OutlinePiece { curve: Arc::clone(&map), element, outward: -1.0 }).collect())
}

/// The boundary of an area, with outward normals: the sides of a body.
///
/// # Errors
/// [`SideError`] of the body.
pub fn area_outline(body: &dyn Body<1, 2>, sides: impl IntoIterator<Item = String>) -> Result<Vec<OutlinePiece>, SideError> {
    let mut all = Vec::new();
    for side in sides {
        all.extend(pieces(&body.trace(&side)?));
    }
    Ok(all)
}

/// Returns the pieces that touch no other; seams between areas, or of an area with itself, are interior.
pub fn without_seams(all: Vec<OutlinePiece>) -> Vec<OutlinePiece> {
    let bounds: Vec<Bounds<2>> = all.iter().map(|p| p.curve.bounds(p.element)).collect();
    let tree = Tree::new(bounds);
    let tolerance = TOUCHING * tree.bounds().map_or(0.0, |b| b.diagonal());
    let (middle, mut table) = ([Vector::<1>::new(0.5)], MapTable::new());
    let mut at = |p: &OutlinePiece, xi: &[Vector<1>; 1]| {
        p.curve.map(p.element, xi, Order::Gradients, &mut table);
        (table.x[0], unit_normal(&table.jacobian[0], p.outward))
    };
    let inside: Vec<bool> = (0..all.len())
        .map(|k| {
            let (x, normal) = at(&all[k], &middle);
            let near = tree.meeting(&Bounds { lo: x, hi: x }.inflated(tolerance));
            near.into_iter().filter(|&j| j != k).any(|j| {
                let one = OneElement { piece: &all[j] };
                let foot = ClosestPoint::<1, 2, _>::new(one).project_within(&x, 2.0 * tolerance);
                foot.is_some_and(|f| f.distance <= tolerance && normal.dot(&at(&all[j], &[f.xi]).1) < OPPOSITE)
            })
        })
        .collect();
    all.into_iter().zip(inside).filter(|(_, inside)| !inside).map(|(p, _)| p).collect()
}

/// One element of a curve as a curve.
struct OneElement<'a> {
    piece: &'a OutlinePiece,
}

impl std::fmt::Debug for OneElement<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_tuple("OneElement").field(&self.piece.element).finish()
    }
}

impl Elements for OneElement<'_> {
    fn num_elements(&self) -> usize {
        1
    }
}

impl Geometry<1, 2> for OneElement<'_> {
    fn map(&self, _: usize, xi: &[Vector<1>], order: Order, table: &mut MapTable<1, 2>) {
        self.piece.curve.map(self.piece.element, xi, order, table);
    }
    fn bounds(&self, _: usize) -> Bounds<2> {
        self.piece.curve.bounds(self.piece.element)
    }
}
