//! The regions of a slave facet: for every master facet near it, the part of the slave facet whose partners lie there.
//!
//! All edges of the candidates are traced once in the chart of the slave facet, so that neighbouring regions share the same
//! approximate edge and tile the facet to rounding, whatever its error. The chain of a master facet is walked so that it is
//! counter-clockwise in the chart if the two surfaces face each other; regions of negative area belong to facets that look away.

use super::chart::Chart;
use super::clip::clip;
use super::facets::Facets;
use super::owner::MasterSurface;
use super::piece::{EdgePiece, area};
use super::skeleton::Skeleton;
use super::trace::trace;
use crate::geometry::MapTable;
use crate::linalg::Vector;
use std::collections::HashMap;

/// Regions below this share of the cell are dropped.
const NOTHING: f64 = 1e-15;
/// Facets whose normals are farther apart than this everywhere are no candidates \[rad\].
const APART: f64 = 78.0 * std::f64::consts::PI / 180.0;

/// A region: the master facet, its boundary in the chart of the slave facet, and its area there.
#[derive(Debug)]
pub(super) struct Region {
    pub facet: usize,
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

/// Whether normals of two facets come within 78 degrees of each other; `sign`: whether they have one orientation (1) or opposite ones (-1).
pub(super) fn may_face(slave: &Facets<'_>, s: usize, master: &Facets<'_>, f: usize, sign: f64) -> bool {
    let (a, b) = (&slave.list[s], &master.list[f]);
    let angle = a.normal.cross(&b.normal).norm().atan2(a.normal.dot(&b.normal) * sign);
    angle - a.cone - b.cone <= APART
}

/// Makes the regions of a chart; `sign` is +1 where the chart and a master facet have one orientation, -1 where they have opposite ones.
pub(super) fn regions(
    chart: &mut Chart<'_>,
    master: &MasterSurface<'_>,
    candidates: &[usize],
    sign: impl Fn(usize) -> f64,
    table: &mut MapTable<2, 3>,
) -> Regions {
    let mut traced = Traced::new(&master.facets, &master.skeleton, chart, table);
    let mut out = Regions { list: Vec::new(), has_rim: false };
    for &facet in candidates {
        let chain = traced.chain(facet, sign(facet), sign(facet) * master.skeleton.sign[facet]);
        let chain = clip(traced.chart.polygon, chain);
        let area = area(&chain);
        if area > NOTHING {
            let pole = master.facets.list[facet]
                .pole
                .then(|| traced.vertex(master.skeleton.corners[facet][2], sign(facet) * master.skeleton.sign[facet]));
            out.list.push(Region { facet, chain, area, pole });
        }
    }
    out.has_rim = traced.rim_inside(&out.list);
    out
}

/// Edges and vertices of the other side in one chart.
pub(super) struct Traced<'t, 'a, 'c> {
    facets: &'t Facets<'a>,
    skeleton: &'t Skeleton,
    pub chart: &'t mut Chart<'c>,
    edges: HashMap<usize, Vec<EdgePiece>>,
    vertices: HashMap<usize, Vector<2>>,
    table: &'t mut MapTable<2, 3>,
}

impl<'t, 'a, 'c> Traced<'t, 'a, 'c> {
    pub fn new(facets: &'t Facets<'a>, skeleton: &'t Skeleton, chart: &'t mut Chart<'c>, table: &'t mut MapTable<2, 3>) -> Self {
        Self { facets, skeleton, chart, edges: HashMap::new(), vertices: HashMap::new(), table }
    }

    /// The boundary of a master facet, counter-clockwise in its own coordinates for the sign 1; `up` times the normals of the skeleton point
    /// to the side of the chart's.
    fn chain(&mut self, facet: usize, sign: f64, up: f64) -> Vec<EdgePiece> {
        let sides = self.facets.list[facet].polygon.sides();
        let walked = |k: usize| if sign < 0.0 { sides - 1 - k } else { k };
        (0..sides).flat_map(|k| self.side(facet, walked(k), sign, up)).collect()
    }

    /// The pieces of a side of a facet, walked with the facet counter-clockwise in its own coordinates for the sign 1.
    pub fn side(&mut self, facet: usize, k: usize, sign: f64, up: f64) -> Vec<EdgePiece> {
        let Some(edge) = self.skeleton.sides[facet][k] else { return Vec::new() };
        self.trace(edge, up);
        let pieces = &self.edges[&edge];
        match self.skeleton.is_forward(facet, k) == (sign > 0.0) {
            true => pieces.clone(),
            false => pieces.iter().rev().map(EdgePiece::reversed).collect(),
        }
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
        let pieces = if data.straight && self.chart.affine {
            vec![EdgePiece::Line(ends[0], ends[1])]
        } else {
            let (chart, table) = (&mut *self.chart, &mut *self.table);
            let (polygon, snap) = (chart.polygon, chart.snap);
            trace(polygon, snap, ends, &mut |t| {
                let (x, n) = skeleton.edge_point(facets, edge, t, table);
                chart.pull(&x, &(n * up))
            })
        };
        self.edges.insert(edge, pieces);
    }

    /// Whether a rim of a facet that has a region passes through the inside of the cell; of others, which look away, it ends nothing.
    fn rim_inside(&self, regions: &[Region]) -> bool {
        let polygon = self.chart.polygon;
        // chords pass through the cell between their ends; what lies on a side is no inside
        let within = |piece: &EdgePiece| match piece {
            EdgePiece::Curve(_) => polygon.depth(&piece.at(0.5)[0]) > self.chart.snap,
            EdgePiece::Line(a, b) => {
                let mut range = [0.0f64, 1.0];
                for k in 0..polygon.sides() {
                    let (da, db) = (polygon.distance(k, a) - self.chart.snap, polygon.distance(k, b) - self.chart.snap);
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
        };
        let ends = |e: usize| match self.skeleton.edges[e].at[..] {
            [(facet, _)] => regions.iter().any(|r| r.facet == facet),
            _ => false,
        };
        self.edges.iter().any(|(&e, pieces)| ends(e) && pieces.iter().any(within))
    }
}
