//! The elements of a space as polygons of a picture of faces: all of a plane body, the outer faces of a solid.

use super::faces::Polygon;
use super::solids::{divided, outer_faces};
use faying::basis::{Cell, Order};
use faying::geometry::MapTable;
use faying::linalg::Vector;
use faying::space::Space;

/// Pieces per direction of a curved face.
const FINE: usize = 4;
/// Points nearer than this share of the size of a face to where straight edges would put them are there.
const STRAIGHT: f64 = 1e-6;

/// Appends the elements of a body in the plane.
pub fn of_plane(space: &dyn Space<2, 2>, part: usize, out: &mut Vec<Polygon>) {
    let mut table = MapTable::new();
    for e in 0..space.num_elements() {
        let mut map = |points: &[[f64; 2]]| {
            let xi: Vec<Vector<2>> = points.iter().map(|p| Vector::from(*p)).collect();
            space.map(e, &xi, Order::Values, &mut table);
            table.x.iter().map(|x| [x[0], x[1], 0.0]).collect()
        };
        append(space.cell(e) == Cell::Simplex, &mut map, part, out);
    }
}

/// Appends the outer faces of a solid.
pub fn of_solid(space: &dyn Space<3, 3>, part: usize, out: &mut Vec<Polygon>) {
    let mut table = MapTable::new();
    for face in outer_faces(space) {
        let mut map = |points: &[[f64; 2]]| {
            let xi: Vec<Vector<3>> = points.iter().map(|p| face.place(*p)).collect();
            space.map(face.element, &xi, Order::Values, &mut table);
            table.x.iter().map(|x| (*x).into()).collect()
        };
        append(face.is_triangle(), &mut map, part, out);
    }
}

/// Places of points of the unit square or triangle.
type MapFace<'a> = &'a mut dyn FnMut(&[[f64; 2]]) -> Vec<[f64; 3]>;

/// Appends a face: as a whole, in pieces where it is curved.
fn append(simplex: bool, map: MapFace<'_>, part: usize, out: &mut Vec<Polygon>) {
    let pieces = if is_straight(simplex, map) { 1 } else { FINE };
    for (corners, edges) in divided(simplex, pieces) {
        let (points, n) = (map(&corners), corners.len());
        let lines = (0..n).filter(|k| edges[*k]).map(|k| [points[k], points[(k + 1) % n]]).collect();
        out.push(Polygon { lines: if pieces == 1 { None } else { Some(lines) }, points, part });
    }
}

/// Whether a face lies where its corners and straight edges put it, looked at in points that no symmetry shares.
fn is_straight(simplex: bool, map: MapFace<'_>) -> bool {
    let (corners, looks): (&[[f64; 2]], &[[f64; 2]]) = if simplex {
        (&[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]], &[[0.3, 0.0], [0.7, 0.3], [0.0, 0.7], [0.2, 0.3]])
    } else {
        (&[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]], &[[0.3, 0.0], [1.0, 0.3], [0.7, 1.0], [0.0, 0.7], [0.3, 0.6]])
    };
    let (at, found) = (map(corners), map(looks));
    let weights = |[s, t]: [f64; 2]| match simplex {
        true => vec![1.0 - s - t, s, t],
        false => vec![(1.0 - s) * (1.0 - t), s * (1.0 - t), (1.0 - s) * t, s * t],
    };
    let distance = |a: &[f64; 3], b: &[f64; 3]| (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt();
    let size = at.iter().map(|x| distance(x, &at[0])).fold(0.0, f64::max);
    looks.iter().zip(&found).all(|(p, x)| {
        let w = weights(*p);
        let straight = std::array::from_fn(|k| w.iter().zip(&at).map(|(w, x)| w * x[k]).sum());
        distance(&straight, x) <= STRAIGHT * size
    })
}
