//! The closest point of a surface in space, as what a contact faces: a side of a body, the boundary of a solid, a surface.

use super::edges::{ElementEdge, SAME_PLACE, edges};
use super::normal_cone::{NormalCone, angle};
use super::several::Several;
use super::surface_feet::SMOOTH;
use super::{Hit, Location, Obstacle, OutlinePiece, opposes, pieces};
use crate::basis::{Elements, Order};
use crate::geometry::{Bounds, ClosestPoint, Geometry, MapTable, Oriented, cell, cross, foot_step, unit_normal};
use crate::linalg::{Matrix, Vector};
use crate::space::Trace;
use std::sync::Arc;

/// Points per direction at which the normals of an element are sampled.
const GRID: usize = 4;
/// Overhang beyond an edge that counts as round-off, as a share of the size of the surface.
const RIM: f64 = 1e-8;
/// Local coordinates nearer than this to an edge of their element are on it.
const AT_EDGE: f64 = 1e-9;
/// Normals shorter than this share of the squares of the tangents are those of a pole.
const POLE: f64 = 1e-12;
/// Steps of Newton's method to a foot; it converges in three to five.
const STEPS: usize = 20;

/// The closest point of a surface in space among what opposes the slave's normal, with the outward normal of the element that owns it.
///
/// Points beyond a rim of the surface, or of what opposes, face nothing. At a kink between elements that all oppose, points take the
/// element whose normal is nearest to the line to them, continued beyond its edge; points with a foot on both faces of an edge (10 degrees
/// and more) take the one that opposes more. Points inside the obstacle have a negative gap.
#[derive(Debug)]
pub struct FacingSurface {
    pub(super) closest: ClosestPoint<2, 3, Oriented<Several<Arc<dyn Geometry<2, 3>>>>>,
    /// The edges of every element; `is_alone` are the rims.
    pub(super) edges: Vec<Vec<ElementEdge>>,
    /// Local coordinates, places and normals of a grid on every element.
    pub(super) looks: Vec<Vec<(Vector<2>, Vector<3>, Vector<3>)>>,
    /// Cones of the normals of every element with those beside it, and of every node of the tree.
    pub(super) cones: [Vec<NormalCone>; 2],
    /// Overhang that counts as round-off \[length\].
    pub(super) slack: f64,
    /// Whether two elements meet in an edge that is sharp.
    pub(super) has_corners: bool,
}

impl FacingSurface {
    /// The side of a body.
    pub fn new(trace: &Trace<2, 3>) -> Self {
        Self::of_pieces(pieces(trace))
    }

    /// The obstacle with an outline of `pieces` in any order; those with coincident edges are joined.
    pub fn of_pieces(pieces: Vec<OutlinePiece<2, 3>>) -> Self {
        let outward = pieces.iter().map(|p| p.outward).collect();
        let map = Several { elements: pieces.into_iter().map(|p| (p.map, p.element)).collect() };
        let (count, edges) = (map.num_elements(), edges(&map));
        let closest = ClosestPoint::new(Oriented { map, outward });
        let slack = closest.size() * RIM;
        let mut new = Self { closest, edges, looks: Vec::new(), cones: [Vec::new(), Vec::new()], slack, has_corners: false };
        new.looks = (0..count).map(|e| new.look(e)).collect();
        let own: Vec<NormalCone> = (0..count).map(|e| new.cone(e)).collect();
        let wide: Vec<NormalCone> = (0..count).map(|e| new.beside(e).into_iter().fold(own[e], |cone, g| cone.join(own[g]))).collect();
        let nodes = new.closest.tree().gathered(|e| wide[e], NormalCone::join);
        new.cones = [wide, nodes];
        new.has_corners = (0..count).any(|e| new.edges[e].iter().any(|edge| new.is_sharp(e, edge)));
        // edges that lie on another element, of which they are no edge, are no rims
        for e in 0..count {
            for k in 0..new.edges[e].len() {
                let ElementEdge { x, is_alone, .. } = new.edges[e][k];
                new.edges[e][k].is_alone = is_alone && new.holding(&x).into_iter().all(|(g, _)| g == e);
            }
        }
        new
    }

    fn is_sharp(&self, element: usize, edge: &ElementEdge) -> bool {
        let at = |e: usize, edge: &ElementEdge| self.normal(e, &(edge.from + edge.along * 0.5));
        edge.across.is_some_and(|(other, k)| at(element, edge).dot(&at(other, &self.edges[other][k])) < SMOOTH)
    }

    fn look(&self, element: usize) -> Vec<(Vector<2>, Vector<3>, Vector<3>)> {
        let geometry = self.closest.geometry();
        let (points, mut table) = (cell::grid::<2, f64>(geometry.cell(element), GRID), MapTable::new());
        geometry.map(element, &points, Order::Values, &mut table);
        points.into_iter().zip(&table.x).map(|(xi, x)| (xi, *x, self.normal(element, &xi))).collect()
    }

    /// The cone of the sampled normals of an element, wider by their largest turn between two samples.
    fn cone(&self, element: usize) -> NormalCone {
        let normals: Vec<Vector<3>> = self.looks[element].iter().map(|look| look.2).collect();
        let turn = |a: usize, b: usize| angle(&normals[a], &normals[b]);
        let across = (0..GRID * GRID).filter(|q| q % GRID > 0).map(|q| turn(q - 1, q));
        let along = (GRID..GRID * GRID).map(|q| turn(q - GRID, q));
        NormalCone::around(&normals, across.chain(along).fold(0.0, f64::max))
    }

    /// Elements whose boxes meet a corner of an element.
    fn beside(&self, element: usize) -> Vec<usize> {
        let geometry = self.closest.geometry();
        let (corners, mut table) = (cell::corners::<2, f64>(geometry.cell(element)), MapTable::new());
        geometry.map(element, &corners, Order::Values, &mut table);
        table.x.iter().flat_map(|x| self.closest.tree().meeting(&self.near(x))).collect()
    }

    fn near(&self, x: &Vector<3>) -> Bounds<3> {
        Bounds { lo: *x, hi: *x }.inflated(SAME_PLACE * self.closest.size())
    }

    /// The elements on which a point of the surface lies, and its local coordinates there, in ascending order.
    fn holding(&self, x: &Vector<3>) -> Vec<(usize, Vector<2>)> {
        let mut found = self.closest.tree().meeting(&self.near(x));
        found.sort_unstable();
        let at = |g: usize| {
            let there = self.closest.project_on(g, x);
            (there.distance <= SAME_PLACE * self.closest.size()).then_some((g, there.xi))
        };
        found.into_iter().filter_map(at).collect()
    }

    /// The elements that meet at the place `xi` of an element, with their local coordinates there: itself alone inside of it.
    pub(super) fn around(&self, element: usize, xi: &Vector<2>, x: &Vector<3>) -> Vec<(usize, Vector<2>)> {
        let mut all = vec![(element, *xi)];
        if self.edges_at(element, xi).next().is_some() {
            all.extend(self.holding(x).into_iter().filter(|(g, _)| *g != element));
        }
        all
    }

    /// The edges of an element on which its place `xi` lies.
    pub(super) fn edges_at<'a>(&'a self, element: usize, xi: &'a Vector<2>) -> impl Iterator<Item = &'a ElementEdge> + 'a {
        self.edges[element].iter().filter(move |edge| (xi - edge.from).perp(&edge.along).abs() <= AT_EDGE)
    }

    /// The outward unit normal at a place; at a pole, where a tangent vanishes, its limit from the inside of the element.
    pub(super) fn normal(&self, element: usize, xi: &Vector<2>) -> Vector<3> {
        let (geometry, mut table) = (self.closest.geometry(), MapTable::new());
        let outward = geometry.outward[element];
        geometry.map(element, &[*xi], Order::Gradients, &mut table);
        let j = table.jacobian[0];
        if cross(&j).norm() > POLE * j.norm_squared() {
            return unit_normal(&j, outward);
        }
        geometry.map(element, &[*xi], Order::Hessians, &mut table);
        let inward = cell::center::<2, f64>(geometry.cell(element)) - xi;
        let change = Matrix::<3, 2>::from_fn(|i, k| (0..2).map(|l| table.hessian[0][i][(k, l)] * inward[l]).sum());
        let normal = change.column(0).cross(&j.column(1)) + j.column(0).cross(&change.column(1));
        normal.try_normalize(0.0).map_or_else(Vector::zeros, |n| n * outward)
    }

    /// The hit of a foot: at a kink on the element whose normal is nearest to the line to `x`, continued beyond its edges.
    pub(super) fn hit(&self, x: &Vector<3>, outward: &Vector<3>, (element, xi, at): (usize, Vector<2>, Vector<3>)) -> Hit<2, 3> {
        let line = x - at;
        let mut own = (element, xi);
        if line.norm() > self.slack {
            let mut best = self.normal(element, &xi).dot(&line).abs();
            for (g, eta) in self.around(element, &xi, &at) {
                let normal = self.normal(g, &eta);
                let along = normal.dot(&line).abs();
                if opposes(outward, &normal) && along > best + AT_EDGE * line.norm() {
                    (own, best) = ((g, eta), along);
                }
            }
        }
        let (geometry, mut table) = (self.closest.geometry(), MapTable::new());
        let (element, mut eta) = own;
        for _ in 0..STEPS {
            geometry.map(element, &[eta], Order::Hessians, &mut table);
            let (step, _) = foot_step(&(x - table.x[0]), &table.jacobian[0], table.hessian.first());
            let next = (eta + step).map(|v| v.clamp(-1.0, 2.0));
            let moved = (next - eta).amax();
            eta = next;
            if moved <= 4.0 * f64::EPSILON {
                break;
            }
        }
        let normal = self.normal(element, &eta);
        geometry.map(element, &[eta], Order::Values, &mut table);
        let at = table.x[0];
        Hit { x: at, normal, gap: (x - at).dot(&normal), at: Some(Location { element, xi: eta }) }
    }
}

impl Obstacle<2, 3> for FacingSurface {
    fn project(&self, x: &Vector<3>, outward: &Vector<3>) -> Option<Hit<2, 3>> {
        let foot = self.faced(x, outward)?;
        let hit = self.hit(x, outward, foot);
        Some(self.across_edge(x, outward, &hit).unwrap_or(hit))
    }
    fn extent(&self) -> Option<Bounds<3>> {
        self.closest.tree().bounds()
    }
}
