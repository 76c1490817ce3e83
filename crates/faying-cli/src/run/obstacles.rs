//! Rigid obstacles of pictures: where they are in a solution.

use super::Solved;
use crate::marks::{RigidFace, RigidPicture, RigidShape};
use faying::basis::{Cell, Elements, Order};
use faying::contact::{Hit, Obstacle, opposed};
use faying::geometry::{Geometry, MapTable};
use faying::linalg::Vector;
use faying::problem::InterfaceView;
use faying::space::Trace;
use std::f64::consts::FRAC_PI_4;
use std::sync::Arc;

/// Most faces of an obstacle in space, as far as elements are not divided, and most per direction of an element.
const FACES: usize = 600;
const FINEST: usize = 6;

/// The contacts against obstacles with these.
fn obstacles<const S: usize, const N: usize>(
    solved: &Arc<Solved<S, N>>,
) -> impl Iterator<Item = (InterfaceView<'_, S, N>, Box<dyn Obstacle<S, N>>)> {
    let solution = &solved.solution;
    let place = |of: InterfaceView<'_, S, N>| of.obstacle(solution.t(), Some(solution.unknowns()));
    solution.contents().contacts().filter_map(move |of| Some((of, place(of)?)))
}

/// The obstacles of a plane case.
pub fn in_plane(solved: &Arc<Solved<1, 2>>) -> Vec<RigidPicture> {
    let picture = |(of, obstacle): (InterfaceView<'_, 1, 2>, Box<dyn Obstacle<1, 2>>)| RigidPicture {
        name: of.name().to_owned(),
        shape: RigidShape::Outline(Box::new(move |x| closest(&*obstacle, x))),
    };
    obstacles(solved).map(picture).collect()
}

/// The closest point of an obstacle: the closest one of those that oppose eight directions.
fn closest(obstacle: &dyn Obstacle<1, 2>, x: &Vector<2>) -> Option<Hit<1, 2>> {
    let directions = (0..8).map(|k| FRAC_PI_4 * f64::from(k)).map(|angle| Vector::<2>::new(angle.cos(), angle.sin()));
    let distance = |hit: &Hit<1, 2>| (hit.x - x).norm();
    directions.filter_map(|outward| obstacle.project(x, &outward)).min_by(|a, b| distance(a).total_cmp(&distance(b)))
}

/// The obstacles of a case in space.
pub fn in_space(solved: &Arc<Solved<2, 3>>) -> Vec<RigidPicture> {
    let picture = |(of, obstacle): (InterfaceView<'_, 2, 3>, Box<dyn Obstacle<2, 3>>)| {
        let (id, solved) = (of.id(), Arc::clone(solved));
        let faces = move || {
            let same = solved.solution.contents().contacts().filter(|of| of.id() == id);
            same.flat_map(|of| of.sides()).flat_map(|slave| faced(&*obstacle, slave.side().trace())).collect()
        };
        RigidPicture { name: of.name().to_owned(), shape: RigidShape::Faces(Box::new(faces)) }
    };
    obstacles(solved).map(picture).collect()
}

/// The surface of an obstacle that a slave side faces, element by element of the side.
fn faced(obstacle: &dyn Obstacle<2, 3>, trace: &Trace<2, 3>) -> Vec<RigidFace> {
    let (mut table, mut faces) = (MapTable::new(), Vec::new());
    let elements = trace.space.num_elements();
    let m = (FACES as f64 / elements.max(1) as f64).sqrt().floor().clamp(1.0, FINEST as f64) as usize;
    // a triangle is a square one side of which is a point
    let place = |simplex: bool, i: usize, j: usize| {
        let [s, t] = [i, j].map(|k| k as f64 / m as f64);
        Vector::<2>::new(if simplex { s * (1.0 - t) } else { s }, t)
    };
    for e in 0..elements {
        let simplex = trace.space.cell(e) == Cell::Simplex;
        let points: Vec<Vector<2>> = (0..(m + 1) * (m + 1)).map(|k| place(simplex, k % (m + 1), k / (m + 1))).collect();
        trace.space.map(e, &points, Order::Gradients, &mut table);
        let hit = |k: usize| opposed(obstacle, &table.x[k], &trace.normal(e, &table.jacobian[k]));
        let hits: Vec<Option<Hit<2, 3>>> = (0..points.len()).map(hit).collect();
        for first in (0..m * m).map(|k| k % m + (m + 1) * (k / m)) {
            let [Some(a), Some(b), Some(c), Some(d)] = [0, 1, m + 2, m + 1].map(|more| hits[first + more]) else { continue };
            faces.push(RigidFace { corners: [a.x, b.x, c.x, d.x], normal: a.normal });
        }
    }
    faces
}
