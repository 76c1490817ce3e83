//! The closest foot of a point on a surface in space among what opposes its normal, as on curves in the plane.
//!
//! A point is paired with a *foot*: a least distance on an element where the line to the point is at right angles to it and
//! its normal opposes, or a kink between elements that all oppose, with the point in its fan. Where an element that opposes ends beside one
//! that does not, the surface ends for this point, as it does at a rim: points beyond have no foot there. Of the feet the closest counts,
//!
//! - in front of the point if the point is outside of the obstacle, behind it if it is inside, by the closest point of all;
//! - behind it only if nothing else that opposes is ten times nearer: else the point has come in beside that face and not through it.
//!
//! Where the closest point of all is such a foot, it is the answer and nothing else is looked at.

use super::facing_surface::FacingSurface;
use super::normal_cone::{NormalCone, angle};
use super::{Hit, opposes};
use crate::basis::{Elements, Order};
use crate::geometry::{Bounds, Geometry, MapTable, cell};
use crate::linalg::Vector;
use std::f64::consts::{FRAC_PI_3, PI};

/// Elements are searched unless they are farther than the best foot by this share of the size.
const WORTH: f64 = 1e-11;
/// Round-off of the direction to a least distance, whose square is accurate to rounding.
const SQUARE: f64 = 1e-8;
/// Deviation from a right angle \[rad\] beyond which a search has ended without a least distance, as it may beside a pole.
const STUCK: f64 = 1e-5;
/// A small step towards a corner or the centre of an element, as a share of the way.
const NUDGE: f64 = 1e-3;
/// Share of the size below which a distance has no direction.
const NO_DIRECTION: f64 = 1e-6;
/// A foot behind the point is hidden by what opposes within this share of its distance.
const NEARER: f64 = 0.1;
/// Least distances of an element are searched downhill from at most so many points of a grid, this far apart in local coordinates.
const STARTS: usize = 3;
const APART: f64 = 0.34;
/// Cosine of the turn between two elements above which they have no corner: 10 degrees, more than facets of meshes have.
pub(super) const SMOOTH: f64 = 0.984_807_753_012_208;
/// Cosines that differ by less are the same.
const ROUNDING: f64 = 1e-9;
/// The face that opposes more may be farther than the closest one by this factor.
const FARTHER: f64 = 10.0;
/// A search starts from points whose normals, times the reverse of the one to be opposed, are at least this.
const TURNED: f64 = -0.25;
/// Weight of an element that meets a vertex with no angle.
const LEAST_ANGLE: f64 = 1e-3;

/// A foot: element, local coordinates, place.
pub(super) type Foot = (usize, Vector<2>, Vector<3>);

/// A point to be paired, and its outward normal.
struct Asked<'a> {
    p: &'a Vector<3>,
    normal: &'a Vector<3>,
    /// Whether feet in front of the point count, and those behind it.
    counts: [bool; 2],
    /// Distance beyond which nothing counts, and the product of both normals from which on nothing opposes enough.
    within: [f64; 2],
}

/// The closest foot so far, its distance, and whether it is behind the point.
type Best = Option<(Foot, f64, bool)>;

impl FacingSurface {
    /// The closest foot of `p` that opposes its outward `normal`.
    pub(super) fn faced(&self, p: &Vector<3>, normal: &Vector<3>) -> Option<Foot> {
        let nearest = self.closest.project(p)?;
        let around = self.around(nearest.element, &nearest.xi, &nearest.x);
        let first = |(element, xi): &(usize, Vector<2>)| {
            let foot = (*element, *xi, nearest.x);
            self.is_foot(p, normal, &foot).then_some(foot)
        };
        if let Some(foot) = around.iter().find_map(first) {
            return Some(foot);
        }
        let side = self.side(p, &around, &nearest.x);
        let counts = [side >= -self.slack, side <= self.slack];
        let within = [(self.closest.tree().bounds()?.diagonal() + nearest.distance) * 2.0, f64::INFINITY];
        let (foot, distance, behind) = self.foot(&Asked { p, normal, counts, within })?;
        if !behind || !self.hidden(normal, p, distance) {
            return Some(foot);
        }
        self.foot(&Asked { p, normal, counts: [counts[0], false], within }).map(|(foot, ..)| foot)
    }

    /// The hit on the other face of a sharp edge beside `hit`, if that face opposes `normal` more and `p` lies on its side of the plane along
    /// `normal` through the edge; the nearer face is then not the one that the body came in by. The edge is where the tangent planes at
    /// both feet meet.
    pub(super) fn across_edge(&self, p: &Vector<3>, normal: &Vector<3>, hit: &Hit<2, 3>) -> Option<Hit<2, 3>> {
        if !self.has_corners {
            return None;
        }
        let within = [hit.gap.abs() * FARTHER, hit.normal.dot(normal) - ROUNDING];
        let (foot, ..) = self.foot(&Asked { p, normal, counts: [hit.gap > 0.0, hit.gap < 0.0], within })?;
        let other = self.hit(p, normal, foot);
        let (own, out) = (hit.normal, other.normal);
        let turn = own.dot(&out);
        let is_convex = (other.x - hit.x).dot(&own) < 0.0 && (hit.x - other.x).dot(&out) < 0.0;
        if turn > SMOOTH || other.gap * hit.gap <= 0.0 || !is_convex {
            return None;
        }
        // from the edge to the point: the combination of both normals that has both gaps
        let [a, b] = [hit.gap - turn * other.gap, other.gap - turn * hit.gap].map(|v| v / (1.0 - turn * turn));
        let (away, end) = (own * a + out * b, own - out * turn);
        let across = normal.cross(&own.cross(&out));
        (away.dot(&end) < 0.0 && away.dot(&across) * end.dot(&across) < 0.0).then_some(other)
    }

    /// Whether a least distance of an element is a foot.
    fn is_foot(&self, p: &Vector<3>, normal: &Vector<3>, (element, xi, x): &Foot) -> bool {
        let own = self.normal(*element, xi);
        if !opposes(normal, &own) {
            return false;
        }
        let away = p - x;
        let overhang = (away - own * away.dot(&own)).norm();
        let is_inside = self.edges_at(*element, xi).next().is_none();
        let least = away.norm() - WORTH * self.closest.size();
        if overhang <= self.slack.max(away.norm() * if is_inside { STUCK } else { SQUARE }) {
            return is_inside || !self.comes_nearer(*element, xi, p, least);
        }
        if is_inside {
            return false;
        }
        // a kink, if this is the least distance of all elements that meet here
        let around = self.around(*element, xi, x);
        around.len() > 1
            && around.iter().all(|(g, eta)| {
                opposes(normal, &self.normal(*g, eta))
                    && self.edges_at(*g, eta).all(|edge| !edge.is_alone)
                    && self.closest.descend_from(*g, p, *eta).distance >= least
                    && !self.comes_nearer(*g, eta, p, least)
            })
    }

    /// Whether a small step into an element comes nearer to `p` than `least`: a search that begins at a pole may stay there.
    fn comes_nearer(&self, element: usize, xi: &Vector<2>, p: &Vector<3>, least: f64) -> bool {
        let (geometry, mut table) = (self.closest.geometry(), MapTable::new());
        let mut ahead = cell::corners::<2, f64>(geometry.cell(element));
        ahead.push(cell::center(geometry.cell(element)));
        let points: Vec<Vector<2>> = ahead.iter().map(|to| xi + (to - xi) * NUDGE).collect();
        geometry.map(element, &points, Order::Values, &mut table);
        table.x.iter().any(|x| (x - p).norm() < least)
    }

    /// Distance of `p` in front of the surface at its closest point, where the elements `around` meet; zero beyond a rim.
    fn side(&self, p: &Vector<3>, around: &[(usize, Vector<2>)], x: &Vector<3>) -> f64 {
        let sum: Vector<3> = around.iter().map(|(e, xi)| self.normal(*e, xi) * self.angle_at(*e, xi)).sum();
        let (away, normal) = (p - x, sum.try_normalize(0.0).unwrap_or_else(Vector::zeros));
        let along = away.dot(&normal);
        let at_rim = around.iter().any(|(e, xi)| self.edges_at(*e, xi).any(|edge| edge.is_alone));
        if at_rim && (away - normal * along).norm() > self.slack { 0.0 } else { along }
    }

    /// The angle that an element takes up around a place on its boundary \[rad\].
    fn angle_at(&self, element: usize, xi: &Vector<2>) -> f64 {
        let (geometry, mut table) = (self.closest.geometry(), MapTable::new());
        let mut at = self.edges_at(element, xi);
        let (Some(a), Some(b)) = (at.next(), at.next()) else { return PI };
        geometry.map(element, &[*xi], Order::Gradients, &mut table);
        // both edges are walked on from the corner
        let inward = cell::center::<2, f64>(geometry.cell(element)) - xi;
        let [a, b] = [a, b].map(|edge| table.jacobian[0] * (edge.along * edge.along.dot(&inward)));
        angle(&a, &b).max(LEAST_ANGLE)
    }

    /// The closest foot that counts.
    fn foot(&self, asked: &Asked<'_>) -> Best {
        let (tree, reach) = (self.closest.tree(), asked.within[0]);
        let mut best: Best = None;
        let keep = |number: usize, is_item: bool| match is_item {
            true => self.may_face(&self.cones[0][number], tree.item(number), asked),
            false => self.may_face(&self.cones[1][number], tree.node(number), asked),
        };
        let worth = self.closest.size() * WORTH;
        tree.nearest_among(asked.p, reach, keep, |element| {
            self.search(element, asked, &mut best);
            best.as_ref().map_or(reach, |b| (b.1 - worth).max(0.0))
        });
        best
    }

    /// Feet of an element.
    fn search(&self, element: usize, asked: &Asked<'_>, best: &mut Best) {
        let mut order: Vec<(f64, Vector<2>)> = self.looks[element]
            .iter()
            .filter(|(_, _, normal)| -normal.dot(asked.normal) >= TURNED)
            .map(|(xi, x, _)| ((x - asked.p).norm(), *xi))
            .collect();
        order.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut starts: Vec<Vector<2>> = Vec::new();
        for (_, xi) in order {
            if starts.len() < STARTS && starts.iter().all(|s| (s - xi).amax() > APART) {
                starts.push(xi);
            }
        }
        for start in starts {
            let at = self.closest.descend_from(element, asked.p, start);
            let normal = self.normal(element, &at.xi);
            let behind = (asked.p - at.x).dot(&normal) < 0.0;
            let counts = asked.counts[usize::from(behind)] && normal.dot(asked.normal) < asked.within[1];
            let nearer = at.distance < best.as_ref().map_or(asked.within[0], |b| b.1);
            let foot = (element, at.xi, at.x);
            if counts && nearer && self.is_foot(asked.p, asked.normal, &foot) {
                *best = Some((foot, at.distance, behind));
            }
        }
    }

    /// Whether a cone of normals may oppose the asked one and, with a foot in the box, point to or from the point.
    fn may_face(&self, cone: &NormalCone, bounds: &Bounds<3>, asked: &Asked<'_>) -> bool {
        if !cone.holds(&-asked.normal, FRAC_PI_3) {
            return false;
        }
        let away = asked.p - bounds.center();
        let (radius, distance) = (bounds.diagonal() * 0.5, away.norm());
        if distance <= radius + self.closest.size() * NO_DIRECTION {
            return true;
        }
        let spread = (radius / distance).asin() + self.slack / distance;
        asked.counts[0] && cone.holds(&away, spread) || asked.counts[1] && cone.holds(&-away, spread)
    }

    /// Whether something that opposes `normal` is much nearer to `p` than `distance`.
    fn hidden(&self, normal: &Vector<3>, p: &Vector<3>, distance: f64) -> bool {
        let mut found = false;
        let keep = |number: usize, is_item: bool| self.cones[usize::from(!is_item)][number].holds(&-normal, FRAC_PI_3);
        let near = distance * NEARER;
        self.closest.tree().nearest_among(p, near, keep, |element| {
            let at = self.closest.project_on(element, p);
            found |= at.distance < near && opposes(normal, &self.normal(element, &at.xi));
            if found { -1.0 } else { near }
        });
        found
    }
}
