//! Pieces of a side between its kinks: faces of elements, corners in the plane, where the normal jumps.
//!
//! With n and m the unit normals of two elements beside the middle of their common face, the face turns if |n - m| > 1e-2, which is 0.6 degrees.
//!
//! Facets that stand for one smooth surface turn at their faces, too. They are told from the faces of a body by what lies between: elements that no
//! turning face parts make a plane (or a smooth surface) if two of them have a common face that meets no turning one. Where two such planes meet at
//! more than 5 degrees their edge is a kink; a chain of facets has no planes. A single element is a wall, like a plane, if it has turning faces to
//! one neighbour alone (it ends the side), to planes alone or a plane and an end (a chamfer), or in the plane if it turns out of one neighbour's plane to the
//! outer side and out of another's to the inner side (a step, a zigzag). Facets that meet at more than 50 degrees belong to different surfaces, be
//! they planes or not.

use super::{Bounds, Geometry, MapTable, Tree, cell, unit_normal};
use crate::basis::Order;
use crate::linalg::{Real, Union, Vector, lit, num};
use crate::parallel;
use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};

/// Distance of unit normals from which on a face turns: 0.6 degrees.
const TURNING: f64 = 1e-2;
/// Distance of unit normals from which on the edge of two planes is a kink: 5 degrees.
const KINK: f64 = 0.0872;
/// Distance of unit normals from which on facets belong to different surfaces: 50 degrees.
const SHARP: f64 = 0.845;
/// Distance of unit normals above which facets do not resolve a smooth surface: 20 degrees.
const STEEP: f64 = 0.3473;
/// Normals are compared this share of the way from the middle of the face to the centres of both elements, since maps may be singular there.
const INSIDE: f64 = 1e-6;
/// Corners nearer than this share of an element are one vertex.
const SAME_VERTEX: f64 = 1e-7;

/// Faces of elements that part the pieces of a side.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kinks {
    /// All that turn: for maps that are the surface itself.
    All,
    /// Edges of planes: for facets that may stand for a smooth surface.
    OfPlanes,
    /// Edges of planes and walls, and all of more than 50 degrees.
    OfWalls,
    /// Edges of walls as above, but for those of two single elements that have no other neighbours: they may be two chords of an arc.
    OfSureWalls,
    /// The kinks `OfWalls`, and all of more than 20 degrees: no facets of a surface that is resolved.
    Steep,
}

/// A face of two elements.
struct Joint<const N: usize, T: Real> {
    elements: [usize; 2],
    vertices: Vec<usize>,
    /// Distance of the normals.
    turn: T,
    /// Whether each element lies on the outer side of the other one's plane.
    is_hollow: bool,
}

/// The elements of every piece of `side` between its kinks, ascending; `outward` as of a [trace](crate::space::Trace). One piece where there are no
/// kinks, even if elements are apart.
pub fn smooth_pieces<const D: usize, const N: usize, T: Real, G>(side: &G, outward: &[T], kinks: Kinks) -> Vec<Vec<usize>>
where
    G: Geometry<D, N, T> + ?Sized,
{
    let whole = || vec![(0..side.num_elements()).collect()];
    let joints = joints(side, outward);
    if joints.iter().all(|j| j.turn <= lit(TURNING)) {
        return whole();
    }
    let regions = FlatRegions::of(side.num_elements(), &joints);
    let is_kink = |joint: &&Joint<N, T>| match kinks {
        Kinks::All => joint.turn > lit(TURNING),
        Kinks::OfPlanes => joint.turn > lit(KINK) && regions.is_edge(&regions.is_plane, joint.elements),
        Kinks::OfWalls | Kinks::OfSureWalls | Kinks::Steep => {
            let steep = if kinks == Kinks::Steep { STEEP } else { SHARP };
            let is_edge = joint.turn > lit(KINK) && regions.is_edge(&regions.is_wall, joint.elements);
            joint.turn > lit(steep) || is_edge && !(kinks == Kinks::OfSureWalls && regions.are_two_facets(joint.elements))
        }
    };
    if !joints.iter().any(|j| is_kink(&j)) {
        return whole();
    }
    let mut sets = Union::new(side.num_elements());
    joints.iter().filter(|j| !is_kink(j)).for_each(|j| sets.unite(j.elements[0], j.elements[1]));
    let (number, count) = sets.numbers();
    let mut pieces = vec![Vec::new(); count];
    number.into_iter().enumerate().for_each(|(e, k)| pieces[k].push(e));
    pieces
}

/// Elements that no turning face parts.
struct FlatRegions {
    of: Vec<usize>,
    /// Whether two elements have a common face away from all turning ones.
    is_plane: Vec<bool>,
    /// Whether it is a plane, or a wall by its turning faces of 50 degrees and less.
    is_wall: Vec<bool>,
    /// Whether it turns to one neighbour alone.
    is_end: Vec<bool>,
}

impl FlatRegions {
    fn of<const N: usize, T: Real>(elements: usize, joints: &[Joint<N, T>]) -> Self {
        let turning: HashSet<usize> = joints.iter().filter(|j| j.turn > lit(TURNING)).flat_map(|j| j.vertices.iter().copied()).collect();
        let mut sets = Union::new(elements);
        let flat = || joints.iter().filter(|j| j.turn <= lit(TURNING));
        flat().for_each(|j| sets.unite(j.elements[0], j.elements[1]));
        let (of, count) = sets.numbers();
        let mut is_plane = vec![false; count];
        flat().filter(|j| j.vertices.iter().all(|v| !turning.contains(v))).for_each(|j| is_plane[of[j.elements[0]]] = true);
        // the regions beside each, and whether one turns to the outer or to the inner side
        let (mut beside, mut turns) = (vec![BTreeSet::new(); count], vec![[false; 2]; count]);
        for joint in joints.iter().filter(|j| j.turn > lit(TURNING) && j.turn <= lit(SHARP)) {
            let [a, b] = joint.elements.map(|e| of[e]);
            if a != b {
                beside[a].insert(b);
                beside[b].insert(a);
                [a, b].iter().for_each(|&k| turns[k][usize::from(joint.is_hollow)] |= joint.turn > lit(KINK));
            }
        }
        let is_end: Vec<bool> = beside.iter().map(|beside| beside.len() == 1).collect();
        let is_chamfer = |k: usize| beside[k].iter().any(|&o| is_plane[o]) && beside[k].iter().all(|&o| is_plane[o] || is_end[o]);
        // facets of a curved surface beside an edge of it turn both ways, too: across and along
        let is_step = |k: usize| N == 2 && turns[k] == [true; 2];
        let is_wall = |k: usize| is_plane[k] || is_end[k] || is_chamfer(k) || is_step(k);
        let is_wall = (0..count).map(is_wall).collect();
        Self { of, is_plane, is_wall, is_end }
    }

    /// Whether both elements are those of different regions that are `wanted`.
    fn is_edge(&self, wanted: &[bool], [a, b]: [usize; 2]) -> bool {
        self.of[a] != self.of[b] && [a, b].iter().all(|&e| wanted[self.of[e]])
    }

    /// Whether two elements beside each other are of regions that turn to each other alone, and no planes.
    fn are_two_facets(&self, elements: [usize; 2]) -> bool {
        elements.iter().all(|&e| self.is_end[self.of[e]] && !self.is_plane[self.of[e]])
    }
}

fn center_of<const N: usize, T: Real>(corners: &[Vector<N, T>]) -> Vector<N, T> {
    corners.iter().fold(Vector::zeros(), |s: Vector<N, T>, x| s + x) / num::<T>(corners.len().max(1))
}

/// The faces of two elements with the turn of their normals; none where a face has collapsed.
fn joints<const D: usize, const N: usize, T: Real, G: Geometry<D, N, T> + ?Sized>(side: &G, outward: &[T]) -> Vec<Joint<N, T>> {
    // places of the corners, the size, and the normals at the faces
    let elements: Vec<(Vec<Vector<N, T>>, T, Vec<Vector<N, T>>)> = parallel::map_init(side.num_elements(), MapTable::new, |table, e| {
        let kind = side.cell(e);
        let center = cell::center::<D, T>(kind);
        side.map(e, &cell::corners::<D, T>(kind), Order::Values, table);
        let corners = table.x.clone();
        let size = Bounds::around(&corners).map_or_else(T::zero, |b| b.diagonal());
        let inside: Vec<_> = cell::faces::<D, T>(kind).iter().map(|f| f.center + (center - f.center) * lit::<T>(INSIDE)).collect();
        side.map(e, &inside, Order::Gradients, table);
        (corners, size, table.jacobian.iter().map(|j| unit_normal(j, outward[e])).collect())
    });
    let places: Vec<(usize, Vector<N, T>)> = elements.iter().enumerate().flat_map(|(e, of)| of.0.iter().map(move |x| (e, *x))).collect();
    let tree = Tree::new(places.iter().map(|(_, x)| Bounds { lo: *x, hi: *x }).collect());
    let vertices = parallel::map(places.len(), |i| {
        let (e, x) = places[i];
        let here = Bounds { lo: x, hi: x }.inflated(elements[e].1 * lit(SAME_VERTEX));
        tree.meeting(&here).into_iter().min().unwrap_or(i)
    });
    let (mut first, mut open) = (0, HashMap::<Vec<usize>, (usize, Vector<N, T>)>::new());
    let mut found = BTreeMap::new();
    for (e, (corners, _, normals)) in elements.iter().enumerate() {
        for (face, &normal) in cell::faces::<D, T>(side.cell(e)).iter().zip(normals) {
            let mut own: Vec<usize> = face.corners.iter().map(|&c| vertices[first + c]).collect();
            own.sort_unstable();
            if own.windows(2).any(|w| w[0] == w[1]) {
                continue;
            }
            let Some((other, there)) = open.insert(own.clone(), (e, normal)) else { continue };
            let is_hollow = normal.dot(&(center_of(&elements[other].0) - center_of(corners))) > T::zero();
            let joint = Joint { elements: [other, e], vertices: own.clone(), turn: (normal - there).norm(), is_hollow };
            found.insert((e, other, own), joint);
        }
        first += corners.len();
    }
    found.into_values().collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::basis::{BSpline, TensorProduct};
    use crate::geometry::ControlPoints;

    fn pieces(points: Vec<[f64; 2]>, kinks: Kinks) -> Vec<Vec<usize>> {
        let line = ControlPoints {
            basis: BSpline::uniform(1, points.len() - 1, 0),
            points: points.into_iter().map(|[x, y]| Vector::<2>::new(x, y)).collect(),
        };
        let n = line.points.len() - 1;
        smooth_pieces(&line, &vec![1.0; n], kinks)
    }

    #[test]
    fn planes_of_two_segments_meet_in_kinks() {
        let roof = |height: f64| (0..=4i32).map(|k| [f64::from(k), height * f64::from(2 - (k - 2).abs())]).collect::<Vec<_>>();
        // turns of 90, 22.6 and 1.1 degrees
        assert_eq!(pieces(roof(1.0), Kinks::OfPlanes), [vec![0, 1], vec![2, 3]]);
        assert_eq!(pieces(roof(0.2), Kinks::OfPlanes), [vec![0, 1], vec![2, 3]]);
        assert_eq!(pieces(roof(0.01), Kinks::OfPlanes).len(), 1);
        assert_eq!(pieces(roof(0.01), Kinks::All).len(), 2);
    }

    /// A bore with a chamfer of 45 degrees in facets, which turn to the inner side around it and to the outer side along it.
    #[test]
    fn facets_of_a_bore_with_a_chamfer_are_no_walls() {
        let profile = [(0.0, 2.0), (1.0, 2.0), (1.5, 2.5)];
        let at = |&(z, r): &(f64, f64), k: usize| {
            let angle = (11.25 * k as f64).to_radians();
            Vector::<3>::new(r * angle.cos(), r * angle.sin(), z)
        };
        let bore = ControlPoints {
            basis: TensorProduct::new([BSpline::uniform(1, 8, 0), BSpline::uniform(1, 2, 0)]),
            points: profile.iter().flat_map(|row| (0..=8).map(move |k| at(row, k))).collect(),
        };
        for outward in [1.0, -1.0] {
            assert_eq!(smooth_pieces(&bore, &[outward; 16], Kinks::OfWalls).len(), 1);
        }
    }

    #[test]
    fn chords_of_a_circle_have_none() {
        for n in [3, 8, 100] {
            let at = |k: usize| [(k as f64 / n as f64).cos(), (k as f64 / n as f64).sin()];
            let chords: Vec<[f64; 2]> = (0..=n).map(at).collect();
            assert_eq!(pieces(chords, Kinks::OfPlanes).len(), 1);
        }
        // a bend of one segment between two planes
        let bend = vec![[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [2.7, 0.7], [2.7, 1.7], [2.7, 2.7]];
        assert_eq!(pieces(bend, Kinks::OfPlanes).len(), 1);
    }

    #[test]
    fn single_elements_are_walls_at_an_end_and_between_planes() {
        // turns of 45 degrees
        let end = vec![[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [2.7, 0.7]];
        assert_eq!(pieces(end.clone(), Kinks::OfPlanes).len(), 1);
        assert_eq!(pieces(end.clone(), Kinks::OfSureWalls).len(), 2);
        assert_eq!(pieces(end[1..].to_vec(), Kinks::OfWalls).len(), 2);
        assert_eq!(pieces(end[1..].to_vec(), Kinks::OfSureWalls).len(), 1);
        assert_eq!(pieces(end, Kinks::OfWalls), [vec![0, 1], vec![2]]);
        let chamfer = vec![[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [2.7, 0.7], [2.7, 1.7], [2.7, 2.7]];
        assert_eq!(pieces(chamfer, Kinks::OfWalls), [vec![0, 1], vec![2], vec![3, 4]]);
        // chords of a circle, alone and between planes
        let at = |k: usize| [(k as f64 * 0.4).sin(), 1.0 - (k as f64 * 0.4).cos()];
        let chords: Vec<[f64; 2]> = (0..=3).map(at).collect();
        assert_eq!(pieces(chords.clone(), Kinks::OfWalls).len(), 1);
        let straight = [[-2.0, 0.0], [-1.0, 0.0]].into_iter().chain(chords.clone()).collect();
        assert_eq!(pieces(straight, Kinks::OfWalls).len(), 1);
        assert_eq!(pieces(chords, Kinks::Steep).len(), 3);
        // a zigzag, and a step before the end
        let zigzag = (0..5).map(|k| [f64::from(k), 0.15 * f64::from(k % 2)]).collect();
        assert_eq!(pieces(zigzag, Kinks::OfWalls).len(), 4);
        let step = vec![[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [2.2, 0.1], [3.0, 0.1]];
        assert_eq!(pieces(step, Kinks::OfWalls).len(), 3);
    }
}
