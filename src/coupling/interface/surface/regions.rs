//! The regions of a slave facet: for every master facet near it, the part of the slave facet whose partners lie there.
//!
//! All edges of the candidates are traced once in the chart of the slave facet, so that neighbouring regions share the same
//! approximate edge and tile the facet to rounding, whatever its error. The chain of a master facet is walked so that it is
//! counter-clockwise in the chart if the two surfaces face each other; regions of negative area belong to facets that look away.

use super::chart::Chart;
use super::clip::clip;
use super::facets::Facets;
use super::numbers::ByNumber;
use super::owner::MasterSurface;
use super::piece::{EdgePiece, area};
use super::skeleton::Skeleton;
use super::trace::trace;
use crate::geometry::MapTable;
use crate::linalg::Vector;

/// Regions below this share of the cell are dropped.
const NOTHING: f64 = 1e-15;
/// Facets whose normals are farther apart than this everywhere are no candidates \[rad\].
const APART: f64 = 78.0 * std::f64::consts::PI / 180.0;
/// A cosine of less than that angle: these need no angle.
const APART_COSINE: f64 = 0.21;

/// A region: the master facet, its boundary in the chart of the slave facet, and its area there.
#[derive(Debug)]
pub(super) struct Region {
    pub facet: usize,
    /// +1 where the facet has the chart's orientation, -1 where it has the opposite one.
    sign: f64,
    pub chain: Vec<EdgePiece>,
    pub area: f64,
    /// The pole of the master facet in the chart.
    pub pole: Option<Vector<2>>,
}

/// The regions of one slave facet.
#[derive(Debug)]
pub(super) struct Regions {
    pub list: Vec<Region>,
    /// Whether a rim of one of these master facets lies inside the slave facet.
    pub has_rim: bool,
}

impl Regions {
    /// Sum of the areas, as a share of the cell.
    pub fn share(&self, cell: f64) -> f64 {
        self.list.iter().map(|r| r.area).sum::<f64>() / cell
    }
}

/// Whether the normals of two facets, each within an angle of a mean one, are farther apart than 78 degrees everywhere; `sign`: whether they have
/// one orientation (1) or opposite ones (-1).
pub(super) fn are_apart(a: (&Vector<3>, f64), b: (&Vector<3>, f64), sign: f64) -> bool {
    let along = a.0.dot(b.0) * sign;
    along < APART_COSINE && a.0.cross(b.0).norm().atan2(along) - a.1 - b.1 > APART
}

/// Makes the regions of a chart from master facets, each with +1 where it has the chart's orientation, -1 where it has the opposite one.
pub(super) fn regions(
    chart: &mut Chart<'_>,
    master: &MasterSurface<'_>,
    candidates: &[(usize, f64)],
    table: &mut MapTable<2, 3>,
) -> Regions {
    let mut traced = Traced::new(&master.facets, &master.skeleton, chart, table);
    let mut out = Regions { list: Vec::new(), has_rim: false };
    for &(facet, sign) in candidates {
        let up = sign * master.skeleton.sign[facet];
        if traced.is_beyond(facet, up) {
            continue;
        }
        let chain = traced.chain(facet, sign, up);
        // a corner that rounding leaves within a side would take points of its own, and more of them far from the origin
        let chain = clip(traced.chart.polygon, chain, traced.chart.rounding());
        let area = area(&chain);
        if area > NOTHING {
            let pole = master.facets.list[facet].pole.then(|| traced.vertex(master.skeleton.corners[facet][2], up));
            out.list.push(Region { facet, sign, chain, area, pole });
        }
    }
    // rims of others, which look away, end nothing
    out.has_rim = out.list.iter().any(|region| traced.has_rim_inside(region.facet, region.sign * master.skeleton.sign[region.facet]));
    out
}

/// Edges and vertices of the other side in one chart.
pub(super) struct Traced<'t, 'a, 'c> {
    facets: &'t Facets<'a>,
    skeleton: &'t Skeleton,
    pub chart: &'t mut Chart<'c>,
    edges: ByNumber<usize, Vec<EdgePiece>>,
    vertices: ByNumber<usize, Vector<2>>,
    table: &'t mut MapTable<2, 3>,
}

impl<'t, 'a, 'c> Traced<'t, 'a, 'c> {
    pub fn new(facets: &'t Facets<'a>, skeleton: &'t Skeleton, chart: &'t mut Chart<'c>, table: &'t mut MapTable<2, 3>) -> Self {
        Self { facets, skeleton, chart, edges: ByNumber::default(), vertices: ByNumber::default(), table }
    }

    /// The boundary of a master facet, counter-clockwise in its own coordinates for the sign 1; `up` times the normals of the skeleton point
    /// to the side of the chart's.
    fn chain(&mut self, facet: usize, sign: f64, up: f64) -> Vec<EdgePiece> {
        let sides = self.facets.list[facet].polygon.sides();
        let mut chain = Vec::with_capacity(2 * sides);
        for k in 0..sides {
            self.side(facet, if sign < 0.0 { sides - 1 - k } else { k }, sign, up, &mut chain);
        }
        chain
    }

    /// Appends the pieces of a side of a facet, walked with the facet counter-clockwise in its own coordinates for the sign 1.
    pub fn side(&mut self, facet: usize, k: usize, sign: f64, up: f64, chain: &mut Vec<EdgePiece>) {
        let Some(edge) = self.skeleton.sides[facet][k] else { return };
        let forward = self.skeleton.is_forward(facet, k) == (sign > 0.0);
        if self.is_line(edge) {
            let ends = self.skeleton.edges[edge].vertices.map(|v| self.vertex(v, up));
            let [a, b] = if forward { ends } else { [ends[1], ends[0]] };
            chain.push(EdgePiece::Line(a, b));
            return;
        }
        self.trace(edge, up);
        let pieces = &self.edges[&edge];
        match forward {
            true => chain.extend_from_slice(pieces),
            false => chain.extend(pieces.iter().rev().map(EdgePiece::reversed)),
        }
    }

    /// Whether an edge is one line in the chart.
    fn is_line(&self, edge: usize) -> bool {
        self.chart.affine && self.skeleton.edges[edge].straight
    }

    /// Whether all of a facet with straight edges lies beyond one side of the cell.
    fn is_beyond(&mut self, facet: usize, up: f64) -> bool {
        let (polygon, sides) = (self.chart.polygon, self.facets.list[facet].polygon.sides());
        if !self.skeleton.sides[facet][..sides].iter().flatten().all(|&edge| self.is_line(edge)) {
            return false;
        }
        let mut beyond = [true; 4];
        for &v in &self.skeleton.corners[facet][..sides] {
            let at = self.vertex(v, up);
            (0..polygon.sides()).for_each(|k| beyond[k] &= polygon.distance(k, &at) <= 0.0);
        }
        beyond[..polygon.sides()].contains(&true)
    }

    fn vertex(&mut self, v: usize, up: f64) -> Vector<2> {
        let place = self.skeleton.vertices[v];
        let chart = &mut *self.chart;
        *self.vertices.entry(v).or_insert_with(|| chart.pull(&place.x, &(place.normal * up)))
    }

    fn trace(&mut self, edge: usize, up: f64) {
        if self.edges.contains_key(&edge) {
            return;
        }
        let (facets, skeleton) = (self.facets, self.skeleton);
        let data = &skeleton.edges[edge];
        let ends = data.vertices.map(|v| self.vertex(v, up));
        let (chart, table) = (&mut *self.chart, &mut *self.table);
        let (polygon, snap) = (chart.polygon, chart.snap);
        let pieces = trace(polygon, snap, ends, &mut |t| {
            let (x, n) = skeleton.edge_point(facets, edge, t, table);
            chart.pull(&x, &(n * up))
        });
        self.edges.insert(edge, pieces);
    }

    /// Whether a rim of a facet passes through the inside of the cell.
    fn has_rim_inside(&mut self, facet: usize, up: f64) -> bool {
        let skeleton = self.skeleton;
        let mut pieces = Vec::new();
        for (k, edge) in skeleton.sides[facet].iter().enumerate() {
            if edge.is_some_and(|edge| skeleton.edges[edge].is_rim()) {
                self.side(facet, k, 1.0, up, &mut pieces);
            }
        }
        let (polygon, snap) = (self.chart.polygon, self.chart.snap);
        // chords pass through the cell between their ends; what lies on a side is no inside
        pieces.iter().any(|piece| match piece {
            EdgePiece::Curve(_) => polygon.depth(&piece.at(0.5)[0]) > snap,
            EdgePiece::Line(a, b) => {
                let mut range = [0.0f64, 1.0];
                for k in 0..polygon.sides() {
                    let (da, db) = (polygon.distance(k, a) - snap, polygon.distance(k, b) - snap);
                    if da <= 0.0 && db <= 0.0 {
                        return false;
                    }
                    let t = da / (da - db);
                    if da < 0.0 {
                        range[0] = range[0].max(t);
                    } else if db < 0.0 {
                        range[1] = range[1].min(t);
                    }
                }
                range[1] > range[0]
            }
        })
    }
}
