//! Middles and outward normals of the sides of a spline patch.

use super::splines::{face, map_of, spans};
use faying::basis::Order;
use faying::geometry::{Geometry, MapTable};
use faying::linalg::Vector;
use faying_files::{FileError, SplinePatch};
use serde::Serialize;

/// Points nearer than this share of the size of a patch are one.
const SAME: f64 = 1e-9;

/// Middle and outward normal of a side.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct SidePlace {
    /// The point in the middle of its parameters.
    pub middle: [f64; 3],
    /// Unit normal out of the patch there; none of sides that bound nothing.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub normal: Option<[f64; 3]>,
    /// The side opposite that is the same: the patch is closed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub closed_with: Option<String>,
}

impl SidePlace {
    /// The place of the end 0 or 1 of an axis.
    ///
    /// # Errors
    /// [`FileError`] where knots, points and weights do not fit.
    pub fn of(patch: &SplinePatch, axis: usize, end: usize) -> Result<Self, FileError> {
        let (middle, normal) = match patch.dimension() {
            2 => looked::<2>(patch, axis, end)?,
            _ => looked::<3>(patch, axis, end)?,
        };
        let side = |end: usize| format!("{}{end}", ["u", "v", "w"][axis]);
        let closed_with = is_closed(patch, axis).then(|| side(1 - end));
        let collapsed = patch.collapsed_sides().contains(&side(end));
        let normal = normal.filter(|_| closed_with.is_none() && !collapsed);
        Ok(Self { middle: middle.into(), normal: normal.map(Into::into), closed_with })
    }
}

/// Middle and outward normal of the end of an axis; no normal where the map has no tangent across.
fn looked<const D: usize>(patch: &SplinePatch, axis: usize, end: usize) -> Result<(Vector<3>, Option<Vector<3>>), FileError> {
    let map = map_of::<D>(patch)?;
    let (mut element, mut stride, mut xi) = (0, 1, Vector::<D>::zeros());
    for k in 0..D {
        let n = spans(patch.degree[k], &patch.knots[k]).max(1);
        let (own, at) = match (k == axis, end) {
            (true, 0) => (0, 0.0),
            (true, _) => (n - 1, 1.0),
            // between the middle elements of an even number
            (false, _) => (n / 2, if n.is_multiple_of(2) { 0.0 } else { 0.5 }),
        };
        (element, stride, xi[k]) = (element + stride * own, stride * n, at);
    }
    let mut table = MapTable::new();
    map.map(element, &[xi], Order::Gradients, &mut table);
    let column = |k: usize| Vector::<3>::from_fn(|i, _| table.jacobian[0][(i, k)]);
    // the tangent across the side without its part along it
    let mut along: Vec<Vector<3>> = Vec::new();
    let rest = |v: Vector<3>, along: &[Vector<3>]| along.iter().fold(v, |v, t| v - t * t.dot(&v));
    for k in (0..D).filter(|k| *k != axis) {
        along.extend(rest(column(k), &along).try_normalize(0.0));
    }
    let across = rest(column(axis), &along) * if end == 0 { -1.0 } else { 1.0 };
    Ok((table.x[0], across.try_normalize(0.0)))
}

/// Whether both ends of an axis are one side.
fn is_closed(patch: &SplinePatch, axis: usize) -> bool {
    let [first, last] = [0, 1].map(|end| face(patch, axis, end));
    let distance = |a: &[f64; 3], b: &[f64; 3]| (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt();
    let size = patch.points.iter().map(|p| distance(p, &patch.points[0])).fold(0.0, f64::max);
    first.points.len() == last.points.len() && first.points.iter().zip(&last.points).all(|(a, b)| distance(a, b) <= SAME * size)
}
