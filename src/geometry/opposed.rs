//! The closest point among what opposes a direction, on curves in the plane whose outward normals are known.
//!
//! What opposes the normal of a point is where the outward normals deviate from its reverse by at most 60 degrees. A point is paired
//! with a *foot*: a least distance along the curve where the line to the point is at right angles to the curve, or a kink between two
//! elements that both oppose, with the point in its fan. Where an element that opposes ends beside one that does not, the curve ends
//! for this point, as it does at a rim: points beyond have no foot there. Of the feet the closest counts,
//!
//! - in front of the point if the point is outside of the obstacle, behind it if it is inside, by the closest point of all;
//! - behind it only if nothing else that opposes is ten times nearer: else the point has come in beside that face and not through it.
//!
//! Where the closest point of all opposes, it is the answer and nothing else is looked at. Else elements without a foot are ruled out by
//! the tree of their boxes and cones of normals, so that the work stays far below one visit per element.

use super::closest::{DEPTH, PIECES, SAME_FACE, Sample, WORTH};
use super::cone::{Cone, turn};
use super::{Bounds, ClosestPoint, Geometry, MapTable, Projection, Tree};
use crate::basis::Order;
use crate::linalg::{Real, Vector, lit, num, to_f64};
use std::f64::consts::FRAC_PI_3;

/// Cosine of the largest angle between a normal and the reverse of the one that it opposes: 60 degrees.
const COSINE: f64 = 0.5;
/// Round-off of that cosine.
const ROUNDING: f64 = 1e-9;
/// Local coordinates closer than this to an element's end are at the end.
const AT_END: f64 = 1e-9;
/// Share of the size below which a distance has no direction.
const NO_DIRECTION: f64 = 1e-6;
/// A foot behind the point is hidden by what opposes within this share of its distance.
const NEARER: f64 = 0.1;

/// Whether two outward unit normals oppose each other: within 60 degrees one is the reverse of the other.
pub fn opposes<const N: usize, T: Real>(normal: &Vector<N, T>, other: &Vector<N, T>) -> bool {
    normal.dot(other) <= lit(ROUNDING - COSINE)
}

/// The outward normals of an oriented curve.
#[derive(Clone, Debug)]
pub(super) struct Facing {
    /// Cones of the normals of every element, with those of its neighbours at their common ends.
    elements: Vec<Cone>,
    /// Cones of the normals of every node of the tree.
    nodes: Vec<Cone>,
    /// The element and its end that are joined to the ends of every element.
    across: Vec<[Option<(usize, usize)>; 2]>,
}

/// A point to be paired: where it is, its outward normal, and the overhang that counts as round-off.
struct Asked<'a, const N: usize, T: Real> {
    p: &'a Vector<N, T>,
    normal: &'a Vector<N, T>,
    slack: T,
    /// Whether feet in front of the point count, and those behind it.
    counts: [bool; 2],
}

/// A foot on an element, and whether it is behind the point.
type Foot<const D: usize, const N: usize, T> = (Projection<D, N, T>, bool);

fn angle<const N: usize, T: Real>(v: &Vector<N, T>) -> f64 {
    to_f64(v[1]).atan2(to_f64(v[0]))
}

/// The unit normal of a curve in the plane with the derivative `d`, zero where that vanishes.
fn normal_of<const N: usize, T: Real>(d: &Vector<N, T>, outward: T) -> Vector<N, T> {
    let length = d.norm();
    if length <= T::zero() {
        return Vector::zeros();
    }
    let scale = outward / length;
    Vector::from_fn(|k, _| if k == 0 { d[1] * scale } else { -d[0] * scale })
}

/// The index of an end among the ends of the pieces.
const fn piece_end(end: usize) -> usize {
    end * PIECES
}

impl<const D: usize, const N: usize, T: Real, G: Geometry<D, N, T>> ClosestPoint<D, N, G, T> {
    /// The closest point to `x` among what opposes `normal`, the outward unit normal at `x` (see the head of this file); `None` where
    /// nothing opposes it, and where the closest point is a rim that `x` overhangs by more than `slack` \[length\].
    ///
    /// Where the map is no curve in the plane with outward signs it is the closest point.
    pub fn project_opposed(&self, x: &Vector<N, T>, normal: &Vector<N, T>, slack: T) -> Option<Projection<D, N, T>> {
        let nearest = self.project(x)?;
        let mut table = MapTable::new();
        let Some(facing) = self.facing() else { return Some(nearest) };
        let asked = |counts| Asked { p: x, normal, slack, counts };
        let end = if nearest.xi[0] <= lit(AT_END) {
            Some(0)
        } else if nearest.xi[0] >= T::one() - lit::<T>(AT_END) {
            Some(1)
        } else {
            None
        };
        // where the closest point of all is seen from: positive in front
        let side = match end.map(|end| (end, facing.across[nearest.element][end])) {
            None => {
                let own = self.normal_at(nearest.element, nearest.xi, &mut table);
                if opposes(normal, &own) {
                    return Some(nearest);
                }
                (x - nearest.x).dot(&own)
            }
            Some((end, None)) => {
                let (own, along) = self.at_end(nearest.element, end, x);
                if opposes(normal, &own) {
                    return (along <= slack).then_some(nearest);
                }
                if along > slack { T::zero() } else { (x - nearest.x).dot(&own) }
            }
            Some((end, Some(other))) => {
                let ends = [(nearest.element, end), other];
                let seen = ends.map(|(e, k)| self.at_end(e, k, x));
                let opposed = seen.map(|(n, _)| opposes(normal, &n));
                if opposed == [true; 2] {
                    return Some(nearest);
                }
                for k in 0..2 {
                    if opposed[k] && seen[k].1 <= slack {
                        let xi = Vector::repeat(num(ends[k].1));
                        return Some(Projection { element: ends[k].0, xi, ..nearest });
                    }
                }
                (x - nearest.x).dot(&(seen[0].0 + seen[1].0))
            }
        };
        let counts = [side >= -slack, side <= slack];
        let (found, behind) = self.foot(facing, &asked(counts), nearest.distance, &mut table)?;
        if !behind || !self.hidden(facing, normal, x, found.distance) {
            return Some(found);
        }
        let in_front = [counts[0], false];
        self.foot(facing, &asked(in_front), nearest.distance, &mut table).map(|(found, _)| found)
    }

    /// Normals of an oriented curve in the plane.
    fn facing(&self) -> Option<&Facing> {
        self.facing
            .get_or_init(|| {
                let elements = self.nodes.len();
                if D != 1 || N != 2 || (0..elements).any(|e| self.geometry().outward(e).is_none()) {
                    return None;
                }
                let across = self.across();
                let of_elements: Vec<Cone> = (0..elements).map(|e| self.cone(e, &across)).collect();
                let nodes = self.tree().gathered(|e| of_elements[e], Cone::join);
                Some(Facing { elements: of_elements, nodes, across })
            })
            .as_ref()
    }

    fn outward(&self, element: usize) -> T {
        self.geometry().outward(element).unwrap_or_else(T::one)
    }

    fn normal_at(&self, element: usize, xi: Vector<D, T>, table: &mut MapTable<D, N, T>) -> Vector<N, T> {
        self.geometry().map(element, &[xi], Order::Gradients, table);
        normal_of(&table.jacobian[0].column(0).into_owned(), self.outward(element))
    }

    /// The normal at an end of an element, and how far `x` lies beyond it along the element's tangent.
    fn at_end(&self, element: usize, end: usize, x: &Vector<N, T>) -> (Vector<N, T>, T) {
        let node = &self.nodes[element][piece_end(end)];
        let length = node.d.norm();
        let along = (x - node.x).dot(&node.d);
        let along = if length > T::zero() { along / length } else { along };
        (normal_of(&node.d, self.outward(element)), if end == 0 { -along } else { along })
    }

    /// The pairs of ends that two elements, and no more, have in common.
    fn across(&self) -> Vec<[Option<(usize, usize)>; 2]> {
        let place = |k: usize| self.nodes[k / 2][piece_end(k % 2)].x;
        let tree = Tree::new((0..2 * self.nodes.len()).map(|k| Bounds { lo: place(k), hi: place(k) }).collect());
        let near = |k: usize| tree.meeting(&Bounds { lo: place(k), hi: place(k) }.inflated(self.size() * lit(SAME_FACE)));
        let other = |k: usize| match near(k)[..] {
            [a, b] => Some(if a == k { b } else { a }).map(|j| (j / 2, j % 2)),
            _ => None,
        };
        (0..self.nodes.len()).map(|e| [other(2 * e), other(2 * e + 1)]).collect()
    }

    /// The cone of an element's normals: sampled, wider by the largest turn between samples, and with the ends of its neighbours.
    fn cone(&self, element: usize, across: &[[Option<(usize, usize)>; 2]]) -> Cone {
        let normals = self.nodes[element].map(|node| normal_of(&node.d, self.outward(element)));
        if normals.iter().any(|n| n.norm() <= T::zero()) {
            return Cone::ALL;
        }
        let first = angle(&normals[0]);
        let (mut at, mut lo, mut hi, mut most) = (first, first, first, 0.0_f64);
        for n in &normals[1..] {
            let step = turn(angle(n) - at);
            at += step;
            (lo, hi, most) = (lo.min(at), hi.max(at), most.max(step.abs()));
        }
        let (mut lo, mut hi) = (lo - most, hi + most);
        for (end, from) in [(0, first), (1, at)] {
            if let Some((other, k)) = across[element][end] {
                let kink = from + turn(angle(&self.at_end(other, k, &Vector::zeros()).0) - from);
                (lo, hi) = (lo.min(kink), hi.max(kink));
            }
        }
        Cone::between(lo, hi)
    }

    /// Whether a cone of normals may oppose the asked one and, with a foot in the box, point to or from the point.
    fn may_face(&self, cone: &Cone, bounds: &Bounds<N, T>, asked: &Asked<'_, N, T>) -> bool {
        if !cone.holds(angle(&-asked.normal), FRAC_PI_3) {
            return false;
        }
        let away = asked.p - bounds.center();
        let (radius, distance) = (to_f64(bounds.diagonal()) * 0.5, to_f64(away.norm()));
        if distance <= radius + to_f64(self.size()) * NO_DIRECTION {
            return true;
        }
        let spread = (radius / distance).asin() + to_f64(asked.slack) / distance;
        asked.counts[0] && cone.holds(angle(&away), spread) || asked.counts[1] && cone.holds(angle(&-away), spread)
    }

    /// The closest foot that counts; `hint` is the distance of the closest point of all.
    fn foot(&self, facing: &Facing, asked: &Asked<'_, N, T>, hint: T, table: &mut MapTable<D, N, T>) -> Option<Foot<D, N, T>> {
        let reach = (self.tree().bounds()?.diagonal() + hint) * lit(2.0) + T::one();
        let mut best: Option<Foot<D, N, T>> = None;
        let keep = |number: usize, is_item: bool| match is_item {
            true => self.may_face(&facing.elements[number], self.tree().item(number), asked),
            false => self.may_face(&facing.nodes[number], self.tree().node(number), asked),
        };
        let worth = self.size() * lit(WORTH);
        self.tree().nearest_among(asked.p, reach, keep, |element| {
            self.ends(facing, element, asked, &mut best);
            self.inner(element, asked, reach, &mut best, table);
            best.as_ref().map_or(reach, |b| (b.0.distance - worth).max(T::zero()))
        });
        best
    }

    fn offer(&self, asked: &Asked<'_, N, T>, normal: &Vector<N, T>, at: (usize, T, Vector<N, T>), best: &mut Option<Foot<D, N, T>>) {
        let (element, t, x) = at;
        let away = asked.p - x;
        let (distance, behind) = (away.norm(), away.dot(normal) < T::zero());
        if asked.counts[usize::from(behind)] && best.as_ref().is_none_or(|b| distance < b.0.distance) {
            *best = Some((Projection { element, xi: Vector::repeat(t), x, distance, rim: false }, behind));
        }
    }

    /// Feet at the ends of an element: in the fan of a kink, and within round-off of where what opposes ends.
    fn ends(&self, facing: &Facing, element: usize, asked: &Asked<'_, N, T>, best: &mut Option<Foot<D, N, T>>) {
        for end in 0..2 {
            let (normal, along) = self.at_end(element, end, asked.p);
            if along < T::zero() || !opposes(asked.normal, &normal) {
                continue;
            }
            let beyond_both = facing.across[element][end].is_some_and(|(other, k)| {
                let (next, further) = self.at_end(other, k, asked.p);
                opposes(asked.normal, &next) && further >= T::zero()
            });
            if beyond_both || along <= asked.slack {
                let x = self.nodes[element][piece_end(end)].x;
                self.offer(asked, &normal, (element, num(end), x), best);
            }
        }
    }

    /// Feet inside of an element: where the derivative of the squared distance changes its sign from minus to plus.
    fn inner(&self, element: usize, asked: &Asked<'_, N, T>, reach: T, best: &mut Option<Foot<D, N, T>>, table: &mut MapTable<D, N, T>) {
        let p = asked.p;
        let samples: [Sample<N, T>; PIECES + 1] = std::array::from_fn(|i| self.nodes[element][i].seen(num::<T>(i) / num(PIECES), p));
        let mut pieces: Vec<(Sample<N, T>, Sample<N, T>, usize)> = samples.windows(2).map(|w| (w[0], w[1], 0)).collect();
        while let Some((a, b, depth)) = pieces.pop() {
            let within = best.as_ref().map_or(reach, |b| b.0.distance);
            if self.below(element, p, &a, &b) > within {
                continue;
            }
            if a.slope < T::zero() && b.slope > T::zero() {
                let mut last = a;
                self.newton(element, p, (a, b), table, |s| last = *s);
                let normal = self.normal_at(element, Vector::repeat(last.t), table);
                if opposes(asked.normal, &normal) {
                    self.offer(asked, &normal, (element, last.t, last.x), best);
                }
            } else if b.slope == T::zero() {
                // the foot is an end of pieces; it is the least distance if that grows on the other side
                let normal = self.normal_at(element, Vector::repeat(b.t), table);
                if a.slope < T::zero() && opposes(asked.normal, &normal) {
                    self.offer(asked, &normal, (element, b.t, b.x), best);
                }
            }
            if self.convex(element, p, &a, &b) || depth == DEPTH {
                continue;
            }
            let middle = self.sample(element, (a.t + b.t) * lit(0.5), p, table);
            pieces.extend([(a, middle, depth + 1), (middle, b, depth + 1)]);
        }
    }

    /// Whether something that opposes `normal` is much nearer to `x` than `distance`.
    fn hidden(&self, facing: &Facing, normal: &Vector<N, T>, x: &Vector<N, T>, distance: T) -> bool {
        let mut found = false;
        let keep = |number: usize, is_item: bool| {
            let cone = if is_item { &facing.elements[number] } else { &facing.nodes[number] };
            cone.holds(angle(&-normal), FRAC_PI_3)
        };
        let near = distance * lit(NEARER);
        self.tree().nearest_among(x, near, keep, |element| {
            let outward = self.outward(element);
            found |= self.nodes[element].iter().any(|node| (node.x - x).norm() < near && opposes(normal, &normal_of(&node.d, outward)));
            if found { -T::one() } else { near }
        });
        found
    }
}

#[cfg(test)]
mod tests {
    use super::super::{ControlPoints, Oriented};
    use super::*;
    use crate::basis::BSpline;

    /// The polygon through `points` with the obstacle to its right.
    fn polygon(points: &[[f64; 2]]) -> ClosestPoint<1, 2, Oriented<ControlPoints<BSpline, 2>>> {
        let n = points.len() - 1;
        let map = ControlPoints { basis: BSpline::uniform(1, n, 0), points: points.iter().map(|&p| p.into()).collect() };
        ClosestPoint::new(Oriented { map, outward: vec![-1.0; n] })
    }

    const UP: [f64; 2] = [0.0, 1.0];
    const DOWN: [f64; 2] = [0.0, -1.0];

    fn foot(c: &ClosestPoint<1, 2, Oriented<ControlPoints<BSpline, 2>>>, x: [f64; 2], normal: [f64; 2]) -> Option<[f64; 2]> {
        c.project_opposed(&x.into(), &normal.into(), 1e-10).map(|p| [p.x[0], p.x[1]])
    }

    #[test]
    fn what_opposes_deviates_by_at_most_60_degrees() {
        for degrees in 0..=180 {
            let (s, c) = f64::from(degrees).to_radians().sin_cos();
            assert_eq!(opposes(&Vector::<2>::new(0.0, -1.0), &Vector::<2>::new(s, c)), degrees <= 60, "{degrees}");
        }
        assert!(!opposes(&Vector::<2>::new(0.0, f64::NAN), &Vector::<2>::new(0.0, 1.0)));
    }

    #[test]
    fn a_point_beside_the_corner_of_a_box_takes_the_face_that_opposes_or_none() {
        // the outline of a box, clockwise, in any size
        for size in [1e-3, 1.0, 1e3] {
            let at = |p: [f64; 2]| p.map(|v| v * size);
            let outline = polygon(&[[-1.0, 0.0], [-1.0, 2.0], [1.0, 2.0], [1.0, 0.0], [-1.0, 0.0]].map(at));
            // deep, the side is far nearer than the bottom
            for x in [0.0, 0.5, 0.999, -0.999, 1.0 - 1e-7] {
                let found = foot(&outline, at([x, 0.02]), UP).unwrap_or_else(|| panic!("nothing faces {x} in the size {size}"));
                assert!((found[0] - x * size).abs() < 1e-14 * size && found[1].abs() < 1e-14 * size, "{found:?}");
            }
            // beside, level with the corner, in its fan and above: no face
            for (x, y) in [(1.001, 0.02), (1.2, 0.0), (1.05, -0.02), (1.05, 1.0), (-1.5, 0.3)] {
                assert_eq!(foot(&outline, at([x, y]), UP), None, "{x} {y}");
            }
            // a point above takes the top, if its normal points down, and nothing if it points up or aside
            assert_eq!(foot(&outline, at([0.25, 2.5]), DOWN), Some(at([0.25, 2.0])));
            assert_eq!(foot(&outline, at([0.25, 2.5]), UP), None);
            assert_eq!(foot(&outline, at([0.25, 2.5]), [1.0, 0.0]), None);
        }
    }

    #[test]
    fn the_floor_of_a_groove_is_seen_past_the_ends_of_its_teeth() {
        let close = |found: Option<[f64; 2]>, [x, y]: [f64; 2]| found.is_some_and(|f| (f[0] - x).abs() < 1e-14 && (f[1] - y).abs() < 1e-14);
        // teeth at y = 0, a groove of depth 0.5 between them; the obstacle is above
        let teeth = polygon(&[[3.0, 0.0], [1.0, 0.0], [1.0, 0.5], [-1.0, 0.5], [-1.0, 0.0], [-3.0, 0.0]]);
        for x in [-0.99, -0.3, 0.0, 0.9] {
            assert!(close(foot(&teeth, [x, -0.01], UP), [x, 0.5]), "{x}");
        }
        assert!(close(foot(&teeth, [1.5, 0.03], UP), [1.5, 0.0]));
        // a floor beside a wall whose top is a unit higher: what overlaps the wall is not paired with its top
        let wall = polygon(&[[-3.0, 0.0], [0.0, 0.0], [0.0, 1.0], [3.0, 1.0]]);
        for y in [0.0, -0.001, 0.05] {
            assert_eq!(foot(&wall, [0.01, y], DOWN), None, "{y}");
        }
        // a low step, deep below both treads, is no wall
        let step = polygon(&[[-3.0, 0.0], [0.0, 0.0], [0.0, 0.01], [3.0, 0.01]]);
        assert!(close(foot(&step, [0.001, -0.02], DOWN), [0.001, 0.01]));
        assert!(close(foot(&step, [-0.001, -0.02], DOWN), [-0.001, 0.0]));
        assert!(close(foot(&wall, [0.01, 0.999], DOWN), [0.01, 1.0]));
        assert!(close(foot(&wall, [-0.01, 0.1], DOWN), [-0.01, 0.0]));
    }

    #[test]
    fn kinks_between_faces_that_oppose_both_keep_their_fan() {
        let roof = polygon(&[[-1.0, -0.5], [0.0, 0.0], [1.0, -0.5]]);
        assert_eq!(foot(&roof, [0.0, 0.3], DOWN), Some([0.0, 0.0]));
        assert_eq!(foot(&roof, [0.05, 0.3], DOWN), Some([0.0, 0.0]));
        // one of them is turned away by more than 60 degrees from this normal
        let (s, c) = 40f64.to_radians().sin_cos();
        assert_eq!(foot(&roof, [0.05, 0.3], [s, -c]), None);
        assert!(foot(&roof, [-0.4, 0.3], [s, -c]).is_some());
    }

    #[test]
    fn boxes_and_cones_rule_out_what_has_no_foot() {
        // 4096 facets of the top of a plate, and points that overhang it: nearest is the side, and no facet of the top has a foot
        let n = 4096;
        let mut points: Vec<[f64; 2]> = (0..=n).map(|k| [f64::from(k) / f64::from(n), 0.0]).collect();
        points.push([1.0, -1.0]);
        let plate = polygon(&points);
        let facing = plate.facing().unwrap();
        for x in [1.01, 1.5, 3.0] {
            let asked = Asked { p: &[x, 0.001].into(), normal: &DOWN.into(), slack: 1e-10, counts: [true; 2] };
            let visited = std::cell::Cell::new(0);
            let keep = |number: usize, is_item: bool| {
                visited.set(visited.get() + 1);
                let (cone, bounds) = match is_item {
                    true => (&facing.elements[number], plate.tree().item(number)),
                    false => (&facing.nodes[number], plate.tree().node(number)),
                };
                plate.may_face(cone, bounds, &asked)
            };
            plate.tree().nearest_among(asked.p, 10.0, keep, |_| 10.0);
            assert!(visited.get() < 60, "{x}: {}", visited.get());
            assert_eq!(foot(&plate, [x, -0.001], DOWN), None);
        }
    }
}
