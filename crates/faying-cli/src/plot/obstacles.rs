//! Rigid obstacles in a picture: outlines with hatching inside in the plane, faces that can be seen through in space.

use super::fields::View;
use super::simplify::{chained, straightened};
use super::solids::Camera;
use super::{FINE, GREY, INK, PlotError, Root, stroke, text, units};
use crate::marks::{RigidFace, RigidPicture, RigidShape};
use faying::contact::Hit;
use faying::geometry::Bounds;
use faying::linalg::Vector;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};
use rayon::prelude::*;

/// Size of the squares in which a piece of an outline is straight, distance and length of the strokes of a hatching, in pixels.
const SQUARE: f64 = 8.0;
const APART: f64 = 9.0;
const LENGTH: f64 = 8.0;
/// Distance of a name from its outline, and from the frame, in pixels.
const ASIDE: f64 = 20.0;
/// Points from which the nearest point of an obstacle is looked for.
const LOOKS: usize = 200;

/// The closest point of an obstacle to a point.
type Foot = dyn Fn(&Vector<2>) -> Option<Hit<1, 2>> + Send + Sync;

/// The box with the points of obstacles that are nearest to `points`, where they are no farther away than the box is large.
pub(super) fn reached(obstacles: &[RigidPicture], points: &[Vector<2>], bounds: Bounds<2>) -> Bounds<2> {
    let step = points.len().div_ceil(LOOKS).max(1);
    let nearest = |obstacle: &RigidPicture| {
        let RigidShape::Outline(foot) = &obstacle.shape else { return None };
        let feet = points.iter().step_by(step).filter_map(|x| Some((foot(x)?.x, x)));
        feet.map(|(foot, x)| (foot, (foot - x).norm())).min_by(|a, b| a.1.total_cmp(&b.1))
    };
    let near = obstacles.iter().filter_map(nearest).filter(|(_, distance)| *distance <= bounds.diagonal());
    near.fold(bounds, |all, (x, _)| all.union(&Bounds { lo: x, hi: x }))
}

/// The outline of an obstacle in a window, in pieces with the obstacle at their right: the zeros of the gap on the sides of squares of about
/// the size `square`, moved to the closest points.
fn outline(foot: &Foot, window: &Bounds<2>, square: f64) -> Vec<[Vector<2>; 2]> {
    let extent = window.hi - window.lo;
    let [n, m] = [0, 1].map(|k| (extent[k] / square).ceil().max(1.0) as usize);
    let place = |i: usize, j: usize| window.lo + Vector::<2>::new(extent[0] * i as f64 / n as f64, extent[1] * j as f64 / m as f64);
    let node = |k: usize| {
        let x = place(k % (n + 1), k / (n + 1));
        foot(&x).map(|hit| hit.gap).filter(|gap| gap.is_finite()).map(|gap| (x, gap))
    };
    let nodes: Vec<Option<(Vector<2>, f64)>> = (0..(n + 1) * (m + 1)).into_par_iter().map(node).collect();
    // the zero between two nodes, the same from both sides
    let zero = |a: (Vector<2>, f64), b: (Vector<2>, f64)| {
        let (a, b) = if a.1 < b.1 { (a, b) } else { (b, a) };
        let x = a.0 + (b.0 - a.0) * (a.1 / (a.1 - b.1));
        foot(&x).map_or(x, |hit| hit.x)
    };
    let piece = |k: usize| -> Vec<[Vector<2>; 2]> {
        let first = k % n + (n + 1) * (k / n);
        let Some(ring) = [0, 1, n + 2, n + 1].map(|more| nodes[first + more]).into_iter().collect::<Option<Vec<_>>>() else {
            return Vec::new();
        };
        // counterclockwise, a piece goes from where the obstacle begins to where it ends next
        let sides = (0..4).map(|e| (ring[e], ring[(e + 1) % 4])).filter(|(a, b)| (a.1 < 0.0) != (b.1 < 0.0));
        let mut crossings: Vec<(Vector<2>, bool)> = sides.map(|(a, b)| (zero(a, b), b.1 < 0.0)).collect();
        if crossings.first().is_some_and(|(_, begins)| !begins) {
            crossings.rotate_left(1);
        }
        crossings.chunks_exact(2).map(|pair| [pair[0].0, pair[1].0]).collect()
    };
    (0..n * m).into_par_iter().flat_map_iter(piece).collect()
}

/// Draws the outlines of obstacles with hatching in a view, and their names where `named`.
pub(super) fn draw(root: &Root<'_, '_>, obstacles: &[RigidPicture], view: &View, named: bool) -> Result<(), PlotError> {
    for obstacle in obstacles {
        let RigidShape::Outline(foot) = &obstacle.shape else { continue };
        let pieces = outline(&**foot, &view.window, SQUARE / view.per_length());
        let lines = pieces.iter().map(|piece| piece.iter().map(|x| view.pixel(&[x[0], x[1]])).collect()).collect();
        let chains = chained(lines);
        for chain in &chains {
            let line = straightened(chain, 1.0);
            if line.len() > 1 && (line.len() > 2 || line[0] != line[1]) {
                root.draw(&PathElement::new(line, stroke(INK, 1.6)))?;
            }
            for (at, inward) in along(chain) {
                let end = [0, 1].map(|k| units(LENGTH * inward[k]));
                root.draw(&PathElement::new(vec![at, (at.0 + end[0], at.1 + end[1])], stroke(GREY, 0.9)))?;
            }
        }
        let middle = chains.iter().max_by_key(|chain| chain.len()).and_then(|chain| middle(chain)).filter(|_| named);
        if let Some((at, inward)) = middle {
            let [left, top, w, h] = view.frame;
            let inside = |v: i32, aside: f64, from: f64, length: f64| {
                (v + units(ASIDE * aside)).clamp(units(from + ASIDE), units(from + length - 0.5 * ASIDE))
            };
            let at = (inside(at.0, inward[0], left, w), inside(at.1, inward[1], top, h));
            root.draw(&Text::new(obstacle.name.clone(), at, text(11.5, INK, HPos::Center, VPos::Center)))?;
        }
    }
    Ok(())
}

/// A place on a chain and a direction there, of length 1, y downwards.
type Stroke = ((i32, i32), [f64; 2]);

/// The places of the strokes of a hatching, with their directions: to the right and back.
fn along(chain: &[(i32, i32)]) -> Vec<Stroke> {
    let mut strokes = Vec::new();
    let mut next = 0.5 * APART * FINE;
    for pair in chain.windows(2) {
        let d = [f64::from(pair[1].0 - pair[0].0), f64::from(pair[1].1 - pair[0].1)];
        let length = d[0].hypot(d[1]);
        while next < length {
            let (share, turned) = (next / length, 0.5f64.sqrt() / length);
            let at = (pair[0].0 + (share * d[0]).round() as i32, pair[0].1 + (share * d[1]).round() as i32);
            strokes.push((at, [turned * (-d[1] - d[0]), turned * (d[0] - d[1])]));
            next += APART * FINE;
        }
        next -= length;
    }
    strokes
}

/// The middle of a chain with the direction to its right.
fn middle(chain: &[(i32, i32)]) -> Option<Stroke> {
    let k = chain.len().checked_sub(2)? / 2;
    let (a, b) = (chain[k], chain[k + 1]);
    let d = [f64::from(b.0 - a.0), f64::from(b.1 - a.1)];
    let length = d[0].hypot(d[1]).max(1.0);
    Some((a, [-d[1] / length, d[0] / length]))
}

/// The faces of obstacles in space as the camera sees them, with the names.
pub(super) struct SeenFaces<'a> {
    name: &'a str,
    faces: Vec<(RigidFace, [[f64; 3]; 4])>,
}

impl<'a> SeenFaces<'a> {
    pub fn of(obstacles: &'a [RigidPicture], camera: &Camera) -> Vec<Self> {
        let seen = |obstacle: &'a RigidPicture| {
            let RigidShape::Faces(faces) = &obstacle.shape else { return None };
            let faces: Vec<_> = faces().into_iter().map(|face| (face, face.corners.map(|x| camera.see(&x)))).collect();
            (!faces.is_empty()).then_some(Self { name: &obstacle.name, faces })
        };
        obstacles.iter().filter_map(seen).collect()
    }

    /// All corners, as the camera sees them.
    pub fn corners(&self) -> impl Iterator<Item = &[f64; 3]> {
        self.faces.iter().flat_map(|(_, corners)| corners)
    }

    /// Draws the faces that look at the viewer, or those that look away and stand in front of what they press, with the name.
    pub fn draw(
        &self,
        root: &Root<'_, '_>,
        camera: &Camera,
        in_front: bool,
        pixel: &dyn Fn(&[f64; 3]) -> [f64; 2],
    ) -> Result<(), PlotError> {
        let looks = |face: &RigidFace| camera.faces(&face.normal);
        let mut shown: Vec<_> = self.faces.iter().filter(|(face, _)| looks(face) != in_front).collect();
        shown.sort_by(|a, b| depth(&a.1).total_cmp(&depth(&b.1)));
        for (_, corners) in &shown {
            let mut points: Vec<(i32, i32)> = corners.iter().map(pixel).map(|p| (units(p[0]), units(p[1]))).collect();
            root.draw(&Polygon::new(points.clone(), GREY.mix(0.16).filled()))?;
            points.push(points[0]);
            root.draw(&PathElement::new(points, stroke(GREY.mix(0.5), 0.5)))?;
        }
        if in_front {
            // above the highest corner
            let places = self.corners().map(pixel);
            if let Some([x, y]) = places.min_by(|a, b| a[1].total_cmp(&b[1])) {
                let name = format!("{} (rigid)", self.name);
                root.draw(&Text::new(name, (units(x), units(y - 4.0)), text(11.5, INK, HPos::Center, VPos::Bottom)))?;
            }
        }
        Ok(())
    }
}

fn depth(corners: &[[f64; 3]; 4]) -> f64 {
    corners.iter().map(|c| c[2]).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use faying::contact::{HalfPlane, Obstacle, Sphere};

    fn foot(obstacle: impl Obstacle<1, 2> + 'static) -> Box<Foot> {
        Box::new(move |x| obstacle.project(x, &Vector::<2>::new(0.0, -1.0)))
    }

    #[test]
    fn outlines_lie_on_obstacles_and_have_them_at_their_right() {
        let window = Bounds { lo: Vector::<2>::new(-1.0, -1.0), hi: Vector::<2>::new(2.0, 1.0) };
        let length = |pieces: &[[Vector<2>; 2]]| pieces.iter().map(|[a, b]| (b - a).norm()).sum::<f64>();
        let disc = Sphere::<2> { center: Vector::<2>::new(0.3, 0.1), radius: 0.7, inside: false };
        let pieces = outline(&*foot(disc), &window, 0.05);
        for [a, b] in &pieces {
            for x in [a, b] {
                assert!(((x - disc.center).norm() - 0.7).abs() < 1e-14, "{x:?}");
            }
            let right = Vector::<2>::new(b[1] - a[1], a[0] - b[0]);
            assert!(right.dot(&(disc.center - a)) > 0.0);
        }
        // chords of at most sqrt(2) squares: 2 pi r (1 - (h / r)^2 / 24) or more
        let around = 2.0 * std::f64::consts::PI * 0.7;
        assert!(length(&pieces) < around && length(&pieces) > around * (1.0 - 0.005 / 0.49 / 24.0), "{}", length(&pieces));
        // every piece ends where another one begins: the outline is closed
        assert!(pieces.iter().all(|[_, b]| pieces.iter().any(|[a, _]| a == b)));
        // a line of slope 1/2 through the window's middle line, from one end to the other
        let plane = HalfPlane::<2>::try_new(Vector::<2>::new(0.5, 0.0), Vector::<2>::new(-1.0, 2.0)).expect("a normal");
        let pieces = outline(&*foot(plane), &window, 0.07);
        assert!((length(&pieces) - 3.0 * 1.25f64.sqrt()).abs() < 1e-12);
        assert!(pieces.iter().flatten().all(|x| (x[1] - 0.5 * (x[0] - 0.5)).abs() < 1e-14));
        assert!(pieces.iter().all(|[a, b]| b[0] > a[0]), "the obstacle lies below");
    }

    #[test]
    fn strokes_stand_at_equal_distances_inside() {
        // a line to the right: the right of its direction is below, y downwards
        let strokes = along(&[(0, 0), (units(10.0), 0), (units(90.0), 0)]);
        assert_eq!(strokes.len(), 10);
        assert!(strokes.windows(2).all(|pair| pair[1].0.0 - pair[0].0.0 == units(APART)));
        assert!(strokes.iter().all(|(_, d)| (d[0] + 0.5f64.sqrt()).abs() < 1e-12 && (d[1] - 0.5f64.sqrt()).abs() < 1e-12));
        assert_eq!(middle(&[(0, 0), (80, 0)]), Some(((0, 0), [0.0, 1.0])));
    }

    #[test]
    fn a_near_obstacle_is_in_the_picture() {
        let bounds = Bounds { lo: Vector::<2>::new(0.0, 0.0), hi: Vector::<2>::new(1.0, 1.0) };
        let of = |depth: f64| {
            let plane = HalfPlane::<2>::try_new(Vector::<2>::new(0.0, -depth), Vector::<2>::new(0.0, 1.0)).expect("a normal");
            vec![RigidPicture { name: "floor".into(), shape: RigidShape::Outline(foot(plane)) }]
        };
        let points = [bounds.lo, bounds.hi];
        assert_eq!(reached(&of(0.5), &points, bounds).lo, Vector::<2>::new(0.0, -0.5));
        assert_eq!(reached(&of(5.0), &points, bounds), bounds);
    }
}
