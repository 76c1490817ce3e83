//! Obstacles behind surfaces in space.

use super::edges::edges;
use super::several::Several;
use super::{OutlineError, OutlinePiece};
use crate::basis::{BSpline, Order, Rational, TensorProduct};
use crate::geometry::{ControlNet, ControlPoints, Geometry, MapTable, cross};
use crate::linalg::{Matrix, Vector};
use std::sync::Arc;

/// Normals shorter than this share of the squares of the tangents are none.
const NO_NORMAL: f64 = 1e-12;
/// Points per direction at which normals are looked at.
const LOOKS: usize = 5;

/// The outline of the obstacle behind surfaces: their normals t_1 x t_2 point out of it.
///
/// What closes on itself, one surface or several that meet edge to edge, is the boundary of its inside, whatever the order of its
/// parameters.
///
/// # Errors
/// [`OutlineError`].
///
/// # Example
/// The square from (0, 0, 0) to (1, 1, 0), walked x first, has its obstacle below.
/// ```
/// use faying::{contact::{FacingSurface, Obstacle, surface_outline}, geometry::ControlNet, linalg::Vector};
/// let knots = || vec![0.0, 0.0, 1.0, 1.0];
/// let points = (0..4).map(|k| Vector::<3>::new(f64::from(k % 2), f64::from(k / 2), 0.0)).collect();
/// let net = ControlNet::from_knots([1, 1], [knots(), knots()], points, None)?;
/// let floor = FacingSurface::of_pieces(surface_outline(vec![net])?);
/// let hit = floor.project(&Vector::<3>::new(0.3, 0.4, 2.0), &-Vector::<3>::z()).expect("it faces what is above it");
/// assert!((hit.gap - 2.0).abs() < 1e-15 && (hit.normal[2] - 1.0).abs() < 1e-15);
/// assert!(floor.project(&Vector::<3>::new(1.5, 0.4, 2.0), &-Vector::<3>::z()).is_none());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn surface_outline(nets: Vec<ControlNet<2, 3>>) -> Result<Vec<OutlinePiece<2, 3>>, OutlineError> {
    let mut all: Vec<OutlinePiece<2, 3>> = Vec::new();
    for net in nets {
        let map = surface(net)?;
        all.extend((0..map.num_elements()).map(|element| OutlinePiece { map: Arc::clone(&map), element, outward: 1.0 }));
    }
    let looks: Vec<Vector<2>> =
        (1..LOOKS - 1).flat_map(|i| (1..LOOKS - 1).map(move |j| [i, j].map(|k| k as f64 / (LOOKS - 1) as f64).into())).collect();
    let mut table = MapTable::new();
    for (element, piece) in all.iter().enumerate() {
        piece.map.map(piece.element, &looks, Order::Gradients, &mut table);
        let none = |j: &Matrix<3, 2>| {
            let length = cross(j).norm();
            length.is_nan() || length <= NO_NORMAL * j.norm_squared()
        };
        if let Some(q) = table.jacobian.iter().position(none) {
            return Err(OutlineError::NoNormal { element, x: table.x[q].into() });
        }
    }
    turn_out(&mut all);
    Ok(all)
}

/// The map of a net.
fn surface(net: ControlNet<2, 3>) -> Result<Arc<dyn Geometry<2, 3>>, OutlineError> {
    let ControlNet { axes, points, weights } = net;
    let basis: TensorProduct<2, BSpline> = TensorProduct::new(axes);
    Ok(match weights {
        Some(weights) => Arc::new(ControlPoints { basis: Rational::try_new::<2>(basis, weights)?, points }),
        None => Arc::new(ControlPoints { basis, points }),
    })
}

/// Turns the normals of what has no rim outwards.
fn turn_out(all: &mut [OutlinePiece<2, 3>]) {
    let joined = Several { elements: all.iter().map(|p| (Arc::clone(&p.map), p.element)).collect() };
    let edges = edges(&joined);
    let origin = joined.extent().map_or_else(Vector::zeros, |b| b.center());
    let mut seen = vec![false; all.len()];
    for first in 0..all.len() {
        let mut part = vec![first];
        let mut next = 0;
        if std::mem::replace(&mut seen[first], true) {
            continue;
        }
        // signs with which neighbours walk their common edge in opposite directions
        let mut signs = vec![1.0];
        while next < part.len() {
            let (element, sign) = (part[next], signs[next]);
            next += 1;
            for edge in &edges[element] {
                let Some((other, k)) = edge.across else { continue };
                if !std::mem::replace(&mut seen[other], true) {
                    part.push(other);
                    signs.push(if edge.tangent.dot(&edges[other][k].tangent) > 0.0 { -sign } else { sign });
                }
            }
        }
        let is_closed = part.iter().all(|&e| edges[e].iter().all(|edge| edge.is_point || edge.across.is_some()));
        if is_closed {
            let volume: f64 = part.iter().zip(&signs).map(|(&e, sign)| sign * volume(&joined, e, &origin)).sum();
            part.iter().zip(&signs).for_each(|(&e, sign)| all[e].outward = sign * volume.signum());
        }
    }
}

/// Integral of x . (t_1 x t_2) / 3 over an element by midpoints of a grid: the volume of the cone to `origin`.
fn volume(map: &dyn Geometry<2, 3>, element: usize, origin: &Vector<3>) -> f64 {
    const CELLS: usize = 8;
    let middle = |k: usize| (k as f64 + 0.5) / CELLS as f64;
    let points: Vec<Vector<2>> = (0..CELLS * CELLS).map(|q| [middle(q % CELLS), middle(q / CELLS)].into()).collect();
    let mut table = MapTable::new();
    map.map(element, &points, Order::Gradients, &mut table);
    table.x.iter().zip(&table.jacobian).map(|(x, j)| (x - origin).dot(&cross(j))).sum::<f64>() / (3 * CELLS * CELLS) as f64
}
