//! Vertices and edges of the facets of a surface, found by the places of their corners, with one normal along each edge.
//!
//! An edge leads from its vertex of lower number to the other one, t from 0 to 1. With m(t) the mean of the normals of the two
//! facets that share it and v_0, v_1 the mean normals of all facets at its vertices,
//!
//! ```text
//! n(t) = unit( m(t) + (1 - t) (v_0 - m(0)) + t (v_1 - m(1)) )
//! ```
//!
//! is the same from both facets, continuous at vertices, and the normal itself wherever the surface is smooth. On a rim m is that of the
//! only facet. The normals of one connected part of a surface point to one side of it; their signs are found by walking shared edges.

use super::facets::{Facet, Facets};
use super::numbers::ByNumber;
use crate::basis::Order;
use crate::geometry::{MapTable, unit_normal};
use crate::linalg::{Union, Vector};
use crate::parallel;

/// Corners closer than this share of the shorter facet are one vertex.
const SAME_VERTEX: f64 = 1e-7;
/// A direction that meshes are not aligned with, a little shorter than 1: its components have no simple ratios.
const ALONG: [f64; 3] = [0.618_034, 0.414_214, 0.667_9];
/// Middles of sides between the same vertices closer than this share of the facet belong to one edge.
const SAME_EDGE: f64 = 0.1;
/// Normals are one to this difference.
const SMOOTH: f64 = 1e-9;
/// Normals are one, and points on one line, to this share.
const STRAIGHT: f64 = 1e-14;

/// An edge and the facets that share it.
#[derive(Clone, Debug)]
pub(super) struct FacetEdge {
    /// (facet, side) of the first facet and, unless the edge is a rim, of the second.
    sides: [(usize, usize); 2],
    count: usize,
    pub vertices: [usize; 2],
    /// Whether its points lie on one line and its normals are one.
    pub straight: bool,
    /// Whether the normals of its facets and vertices agree along it.
    pub smooth: bool,
    /// m(0) and m(1).
    means: [Vector<3>; 2],
}

impl FacetEdge {
    /// (facet, side) of the one or two facets that have the edge.
    pub fn at(&self) -> &[(usize, usize)] {
        &self.sides[..self.count]
    }

    /// Whether only one facet has the edge.
    pub fn is_rim(&self) -> bool {
        self.count == 1
    }
}

/// A vertex: its place and the mean normal of the facets there.
#[derive(Clone, Copy, Debug)]
pub(super) struct Vertex {
    pub x: Vector<3>,
    pub normal: Vector<3>,
}

/// Connectivity of the facets of one surface.
#[derive(Debug)]
pub(super) struct Skeleton {
    pub vertices: Vec<Vertex>,
    pub edges: Vec<FacetEdge>,
    /// Vertices at the corners of every facet.
    pub corners: Vec<[usize; 4]>,
    /// Edges of the sides of every facet; none where a side is a point.
    pub sides: Vec<[Option<usize>; 4]>,
    /// +1 or -1 per facet: its normal times this points to the same side as its neighbour's.
    pub sign: Vec<f64>,
    /// Connected part of every facet.
    pub part: Vec<usize>,
}

impl Skeleton {
    pub fn new(facets: &Facets<'_>) -> Self {
        let mut table = MapTable::new();
        let corners = merged_corners(facets, &mut table);
        let count = corners.iter().flatten().filter(|&&v| v != usize::MAX).max().map_or(0, |&v| v + 1);
        let (edges, sides) = joined_sides(facets, &corners, &mut table);
        let mut skeleton = Self {
            vertices: vec![Vertex { x: Vector::zeros(), normal: Vector::zeros() }; count],
            edges,
            corners,
            sides,
            sign: Vec::new(),
            part: Vec::new(),
        };
        skeleton.walk(facets.list.len());
        let at_corner = |table: &mut MapTable<2, 3>, f: usize, k: usize| {
            let (x, jacobian) = facets.one(f, &facets.list[f].polygon.corner(k), table);
            let is_pole = facets.list[f].pole && k == 2;
            Vertex { x, normal: if is_pole { facets.normal_at_pole(f, table) } else { unit_normal(&jacobian, 1.0) } }
        };
        let of_facet = |table: &mut MapTable<2, 3>, f: usize| {
            let mut own = [Vertex { x: Vector::zeros(), normal: Vector::zeros() }; 4];
            (0..facets.list[f].polygon.sides()).for_each(|k| own[k] = at_corner(table, f, k));
            own
        };
        for (f, own) in parallel::map_init(facets.list.len(), MapTable::new, of_facet).iter().enumerate() {
            for (&id, corner) in skeleton.corners[f].iter().zip(own).take(facets.list[f].polygon.sides()) {
                let vertex = &mut skeleton.vertices[id];
                (vertex.x, vertex.normal) = (corner.x, vertex.normal + corner.normal * skeleton.sign[f]);
            }
        }
        for vertex in &mut skeleton.vertices {
            let length = vertex.normal.norm();
            vertex.normal /= if length > 1e-6 { length } else { 1.0 };
        }
        let kinds = parallel::map_init(skeleton.edges.len(), MapTable::new, |table, e| skeleton.kind(facets, e, table));
        for (edge, kind) in skeleton.edges.iter_mut().zip(kinds) {
            (edge.straight, edge.smooth, edge.means) = kind;
        }
        skeleton
    }

    /// Signs and connected parts, from facet to facet across edges that two share.
    fn walk(&mut self, count: usize) {
        self.sign = vec![0.0; count];
        self.part = vec![usize::MAX; count];
        let mut parts = 0;
        for first in 0..count {
            if self.part[first] != usize::MAX {
                continue;
            }
            (self.sign[first], self.part[first]) = (1.0, parts);
            let mut open = vec![first];
            while let Some(f) = open.pop() {
                for (k, edge) in self.sides[f].iter().enumerate() {
                    let Some(edge) = edge else { continue };
                    let other = self.edges[*edge].at().iter().find(|at| **at != (f, k));
                    let Some(&(g, j)) = other else { continue };
                    if self.part[g] == usize::MAX {
                        // neighbours of one orientation walk their common edge in opposite directions
                        let same = self.is_forward(f, k) != self.is_forward(g, j);
                        (self.sign[g], self.part[g]) = (if same { self.sign[f] } else { -self.sign[f] }, parts);
                        open.push(g);
                    }
                }
            }
            parts += 1;
        }
    }

    /// Whether side `k` of a facet leads from the first vertex of its edge to the second one.
    pub fn is_forward(&self, f: usize, k: usize) -> bool {
        let ids = &self.corners[f];
        let sides = if ids[3] == usize::MAX { 3 } else { 4 };
        ids[k] < ids[(k + 1) % sides]
    }

    /// Local points of facet `at` of an edge at the parameter t of the edge.
    fn local(&self, facets: &Facets<'_>, (f, k): (usize, usize), t: f64) -> Vector<2> {
        facets.list[f].polygon.on_side(k, if self.is_forward(f, k) { t } else { 1.0 - t })
    }

    /// The position and the signed unit normal of a facet on its side at t of the edge.
    fn on_facet(&self, facets: &Facets<'_>, at: (usize, usize), t: f64, table: &mut MapTable<2, 3>) -> (Vector<3>, Vector<3>) {
        let facet = &facets.list[at.0];
        let local = self.local(facets, at, t);
        let (x, jacobian) = facets.one(at.0, &local, table);
        let is_pole = facet.pole && local == Vector::<2>::new(0.0, 1.0);
        let normal = if is_pole { facets.normal_at_pole(at.0, table) } else { unit_normal(&jacobian, 1.0) };
        (x, normal * self.sign[at.0])
    }

    /// Whether an edge is straight, whether it is smooth, and its mean normals at the ends.
    fn kind(&self, facets: &Facets<'_>, e: usize, table: &mut MapTable<2, 3>) -> (bool, bool, [Vector<3>; 2]) {
        let edge = &self.edges[e];
        let ends = edge.vertices.map(|v| self.vertices[v]);
        let (mut apart, mut bent, mut means) = (0.0f64, 0.0f64, [Vector::zeros(); 2]);
        let chord = ends[1].x - ends[0].x;
        // normals of affine facets are constant and their sides straight
        let of_facets = || edge.at().iter().map(|at| &facets.list[at.0]);
        let is_affine = of_facets().all(|facet| facet.affine);
        let parts = if is_affine { 1 } else { 8 };
        for i in 0..=parts {
            let t = f64::from(i) / f64::from(parts);
            let mut own = [Vector::zeros(); 2];
            let mut x = Vector::zeros();
            for (normal, &at) in own.iter_mut().zip(edge.at()) {
                (x, *normal) = self.on_facet(facets, at, t, table);
            }
            // m(t)
            let sum = own[0] + own[1];
            let length = sum.norm();
            let mean = sum / if length > 1e-6 { length } else { 1.0 };
            if i == 0 {
                means[0] = mean;
            }
            means[1] = mean;
            for normal in &own[..edge.at().len()] {
                apart = apart.max((normal - mean).norm());
            }
            let off = x - ends[0].x;
            bent = bent.max(off.cross(&chord).norm() / chord.norm_squared()).max((mean - means[0]).norm());
        }
        for (mean, end) in means.iter().zip(&ends) {
            apart = apart.max((mean - end.normal).norm());
        }
        // normals of thin facets are rounded as their shortest side is
        let of_facet = |facet: &Facet| facet.rounding / (f64::EPSILON * facet.size);
        let far = if is_affine { of_facets().map(of_facet).fold(0.0, f64::max) } else { 0.0 }.max(ends[0].x.norm() / chord.norm());
        (apart.max(bent) <= STRAIGHT * (1.0 + far), apart <= SMOOTH, means)
    }

    /// Position and unit normal at t of an edge.
    pub fn edge_point(&self, facets: &Facets<'_>, e: usize, t: f64, table: &mut MapTable<2, 3>) -> (Vector<3>, Vector<3>) {
        let edge = &self.edges[e];
        for (k, &v) in edge.vertices.iter().enumerate() {
            if t == k as f64 {
                return (self.vertices[v].x, self.vertices[v].normal);
            }
        }
        let (x, own) = self.on_facet(facets, edge.sides[0], t, table);
        if edge.smooth {
            return (x, own);
        }
        let mut mean = own;
        if let Some(&at) = edge.at().get(1) {
            mean += self.on_facet(facets, at, t, table).1;
            mean /= mean.norm().max(1e-6);
        }
        let ends = edge.vertices.map(|v| self.vertices[v].normal);
        let n = mean + (ends[0] - edge.means[0]) * (1.0 - t) + (ends[1] - edge.means[1]) * t;
        (x, n / n.norm().max(f64::MIN_POSITIVE))
    }
}

/// The vertex at every corner of every facet: corners at the same place share it.
fn merged_corners(facets: &Facets<'_>, table: &mut MapTable<2, 3>) -> Vec<[usize; 4]> {
    let (mut places, mut size_at) = (Vec::new(), Vec::new());
    for (f, facet) in facets.list.iter().enumerate() {
        let points: [Vector<2>; 4] = std::array::from_fn(|k| facet.polygon.corner(k));
        facets.at(f, &points[..facet.polygon.sides()], Order::Values, table);
        places.extend_from_slice(&table.x);
        size_at.extend(table.x.iter().map(|_| facet.size * SAME_VERTEX));
    }
    let floor = |a: usize| places[a].amax() * 1e-14;
    // places that are near are near along any direction: one that meshes are not aligned with
    let along = Vector::<3>::from(ALONG);
    let mut order: Vec<(f64, usize)> = places.iter().map(|x| along.dot(x)).zip(0..).collect();
    order.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let mut sets = Union::new(places.len());
    for (i, &(s, a)) in order.iter().enumerate() {
        let reach = 2.0 * (size_at[a] + 4.0 * floor(a));
        for &(_, b) in order[i + 1..].iter().take_while(|next| next.0 - s <= reach) {
            if (places[a] - places[b]).norm() <= size_at[a].min(size_at[b]) + floor(a.min(b)) {
                sets.unite(a, b);
            }
        }
    }
    // places are those of the corners of all facets, one after another
    let mut numbers = sets.numbers().0.into_iter();
    let mut corners = Vec::with_capacity(facets.list.len());
    for facet in &facets.list {
        let mut own = [usize::MAX; 4];
        own.iter_mut().take(facet.polygon.sides()).zip(&mut numbers).for_each(|(vertex, number)| *vertex = number);
        corners.push(own);
    }
    corners
}

/// The edges, and the edge of every side: sides between the same vertices with the same middle are one.
fn joined_sides(facets: &Facets<'_>, corners: &[[usize; 4]], table: &mut MapTable<2, 3>) -> (Vec<FacetEdge>, Vec<[Option<usize>; 4]>) {
    let mut edges: Vec<FacetEdge> = Vec::new();
    let mut middles: Vec<Vector<3>> = Vec::new();
    // the last edge between two vertices, and the one before every edge
    let mut between: ByNumber<(usize, usize), usize> = ByNumber::default();
    let mut before: Vec<Option<usize>> = Vec::new();
    let mut sides = Vec::with_capacity(facets.list.len());
    for (f, facet) in facets.list.iter().enumerate() {
        let n = facet.polygon.sides();
        let points: [Vector<2>; 4] = std::array::from_fn(|k| facet.polygon.on_side(k % n, 0.5));
        facets.at(f, &points[..n], Order::Values, table);
        let mut own = [None; 4];
        for (k, edge) in own.iter_mut().enumerate().take(n) {
            let (a, b) = (corners[f][k], corners[f][(k + 1) % n]);
            if a == b {
                continue;
            }
            let key = (a.min(b), a.max(b));
            let is_near = |e: &usize| edges[*e].is_rim() && (middles[*e] - table.x[k]).norm() <= SAME_EDGE * facet.size;
            let last = between.get(&key).copied();
            // the first that is near, as they were found
            let found = std::iter::successors(last, |&e| before[e]).filter(is_near).last();
            let e = found.unwrap_or_else(|| {
                before.push(last);
                between.insert(key, edges.len());
                middles.push(table.x[k]);
                edges.push(FacetEdge {
                    sides: [(f, k); 2],
                    count: 0,
                    vertices: [key.0, key.1],
                    straight: false,
                    smooth: false,
                    means: [Vector::zeros(); 2],
                });
                edges.len() - 1
            });
            let joined = &mut edges[e];
            joined.sides[joined.count] = (f, k);
            joined.count += 1;
            *edge = Some(e);
        }
        sides.push(own);
    }
    (edges, sides)
}
