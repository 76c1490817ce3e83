//! Points of meshes, scaled, rotated and translated as their geometry says.

use super::given::coordinates;
use crate::case::{Geometry, Patch};
use faying::geometry::{turn, turn_about};
use faying::linalg::Vector;

/// Scales, rotates and translates the points of a mesh as `geometry` says.
///
/// # Errors
/// A sentence for an axis without direction.
pub(crate) fn placed_points<const N: usize>(points: &[Vector<N>], geometry: &Geometry) -> Result<Vec<Vector<N>>, String> {
    let turn = turn_of(geometry)?;
    Ok(points.iter().map(|x| moved(x, geometry, &turn)).collect())
}

/// Rows of the rotation matrix of a geometry, `None` without rotation; in the plane the axis is z.
fn turn_of(geometry: &Geometry) -> Result<Option<[[f64; 3]; 3]>, String> {
    let Some(degrees) = geometry.rotate_deg.as_ref().map(|d| d.value) else { return Ok(None) };
    let rows = match &geometry.axis {
        None => {
            let q = turn(degrees);
            [[q[(0, 0)], q[(0, 1)], 0.0], [q[(1, 0)], q[(1, 1)], 0.0], [0.0, 0.0, 1.0]]
        }
        Some(axis) => {
            let axis = Vector::<3>::from(coordinates(&axis.value));
            let q = turn_about(&axis, degrees).ok_or("`axis` of a rotation must not be zero")?;
            std::array::from_fn(|i| std::array::from_fn(|k| q[(i, k)]))
        }
    };
    Ok(Some(rows))
}

/// Scales, rotates and translates a point.
fn moved<const N: usize>(x: &Vector<N>, geometry: &Geometry, turn: &Option<[[f64; 3]; 3]>) -> Vector<N> {
    let mut x = *x;
    if let Some(factor) = &geometry.scale {
        x *= factor.value;
    }
    if let Some(rows) = turn {
        x = Vector::from_fn(|i, _| (0..N).map(|k| rows[i][k] * x[k]).sum());
    }
    if let Some(by) = &geometry.translate {
        x += Vector::from(coordinates(&by.value));
    }
    x
}

/// Position of a named point of the mesh that a patch is read from.
pub(crate) fn named_point<const N: usize>(patch: &Patch, name: &str) -> Option<Vector<N>> {
    let geometry = &patch.geometry;
    let x = geometry.shape.part()?.point(name)?;
    Some(moved(&Vector::<N>::from_fn(|k, _| x[k]), geometry, &turn_of(geometry).ok()?))
}

/// Position of a point of the mesh that a patch is read from, by its index in the file.
pub(crate) fn point_of<const N: usize>(patch: &Patch, point: usize) -> Option<Vector<N>> {
    let geometry = &patch.geometry;
    let x = geometry.shape.part()?.place_of::<N>(point)?;
    Some(moved(&x, geometry, &turn_of(geometry).ok()?))
}
