//! The part of an element that elements of the other side cover, as one region.
//!
//! Rules on the own points of a side divide its elements only where the other side ends. The part is bounded by the sides of the covering
//! facets that no two of them share, seen in the chart of the element: in that of a slave element along the normals of the master, in that
//! of a master element at their closest points. So it has few pieces, and points as an element has them: n x n on four straight ones.

use super::cell_rule::{WeightedPoints, fill};
use super::chart::Chart;
use super::clip::{COLLINEAR, clip, simplified};
use super::element::Sides;
use super::facets::Facets;
use super::piece::{EdgePiece, area, wedge};
use super::regions::Traced;
use super::skeleton::Skeleton;
use crate::geometry::MapTable;
use crate::linalg::Vector;
use std::collections::{BTreeMap, HashSet};

/// Areas below this share of the cell are none.
const NOTHING: f64 = 1e-12;
/// Distance from the chord, in local coordinates, at which a curve is a line and lines are one: the error of curves.
const STRAIGHT: f64 = 1e-10;
/// Deviation of the sum of the weights from the area that is rounding.
const FILLED: f64 = 1e-9;

impl Sides<'_> {
    /// Points and weights of the part of a slave element that master elements cover, in its local coordinates; `None` where these or the
    /// element are cut into facets, or the part has holes.
    pub fn part_of_slave(&self, element: usize, by: &[usize]) -> Option<WeightedPoints> {
        let (own, other) = (&self.slave, &self.master);
        let s = single(own, element)?;
        self.part((own, s), (&other.facets, &other.skeleton), by, 1.0, |f| self.sign(s, f))
    }

    /// Points and weights of the part of a master element that slave elements cover, in its local coordinates; `None` where these or the
    /// element are cut into facets, the element ends in the fan of a kink, or the part has holes.
    pub fn part_of_master(&self, element: usize, by: &[usize]) -> Option<WeightedPoints> {
        let (own, skeleton) = (&self.master.facets, &self.master.skeleton);
        let f = single(own, element)?;
        if skeleton.sides[f].iter().flatten().any(|&e| !skeleton.edges[e].is_rim() && !skeleton.edges[e].smooth) {
            return None;
        }
        // no normal: points are seen at their closest points
        self.part((own, f), (&self.slave, &self.skeleton), by, 0.0, |s| self.sign(s, f))
    }

    /// Whether one of these slave elements has a side that no other element shares.
    pub fn ends_at(&self, elements: &[usize]) -> bool {
        let sides = elements.iter().flat_map(|&e| self.slave.of(e)).flat_map(|s| self.skeleton.sides[s]);
        sides.flatten().any(|e| self.skeleton.edges[e].is_rim())
    }

    fn part(
        &self,
        (own, facet): (&Facets<'_>, usize),
        (other, skeleton): (&Facets<'_>, &Skeleton),
        by: &[usize],
        along: f64,
        sign: impl Fn(usize) -> f64,
    ) -> Option<WeightedPoints> {
        let by: Vec<usize> = by.iter().map(|&e| single(other, e)).collect::<Option<_>>()?;
        let rounding = by.iter().map(|&f| other.list[f].rounding).fold(0.0, f64::max);
        let (mut chart, mut table) = (Chart::new(own, facet, rounding), MapTable::new());
        let (polygon, mut points, mut whole) = (chart.polygon, Vec::new(), 0.0);
        let mut traced = Traced::new(other, skeleton, &mut chart, &mut table);
        for outline in outlines(other, skeleton, &by, &sign)? {
            let mut chain = Vec::new();
            for &(f, k) in &outline {
                traced.side(f, k, sign(f), sign(f) * skeleton.sign[f] * along, &mut chain);
            }
            let chain = clip(polygon, chain, COLLINEAR);
            let chain = simplified(chain.into_iter().map(straightened).collect(), STRAIGHT);
            let inside = area(&chain);
            if inside < -NOTHING {
                return None;
            }
            let n = if chain.iter().any(EdgePiece::is_curve) { (self.points + 3).max(5) } else { self.points };
            fill(&chain, &[], &self.lines[n], &mut points);
            whole += inside;
        }
        let sum: f64 = points.iter().map(|p: &(Vector<2>, f64)| p.1).sum();
        ((sum - whole).abs() <= FILLED * polygon.area()).then_some(points)
    }
}

/// A curve that is a line to the rounding of closest points.
fn straightened(piece: EdgePiece) -> EdgePiece {
    let EdgePiece::Curve(points) = piece else { return piece };
    let (from, along) = (piece.from(), piece.to() - piece.from());
    let is_near = |p: &Vector<2>| wedge(&(p - from), &along).abs() < STRAIGHT * along.norm();
    if points.iter().all(is_near) { EdgePiece::Line(from, piece.to()) } else { piece }
}

/// The facet of an element that is one.
fn single(facets: &Facets<'_>, element: usize) -> Option<usize> {
    let all = facets.of(element);
    (all.len() == 1 && facets.is_whole(all.start)).then_some(all.start)
}

/// Closed walks along the sides (facet, side) that only one of `list` has, facets of the sign 1 counter-clockwise in their own coordinates;
/// `None` where they do not close.
fn outlines(facets: &Facets<'_>, skeleton: &Skeleton, list: &[usize], sign: impl Fn(usize) -> f64) -> Option<Vec<Vec<(usize, usize)>>> {
    let in_list: HashSet<usize> = list.iter().copied().collect();
    let mut leaving: BTreeMap<usize, Vec<(usize, (usize, usize))>> = BTreeMap::new();
    for &f in list {
        let sides = facets.list[f].polygon.sides();
        for k in 0..sides {
            let Some(edge) = skeleton.sides[f][k] else { continue };
            if skeleton.edges[edge].at().iter().all(|at| *at == (f, k) || !in_list.contains(&at.0)) {
                let ends = [skeleton.corners[f][k], skeleton.corners[f][(k + 1) % sides]];
                let [from, to] = if sign(f) < 0.0 { [ends[1], ends[0]] } else { ends };
                leaving.entry(from).or_default().push((to, (f, k)));
            }
        }
    }
    let mut all = Vec::new();
    while let Some(start) = leaving.iter().find(|(_, sides)| !sides.is_empty()).map(|(v, _)| *v) {
        let (mut outline, mut at) = (Vec::new(), start);
        loop {
            let (to, side) = leaving.get_mut(&at)?.pop()?;
            outline.push(side);
            at = to;
            if at == start {
                break;
            }
        }
        all.push(outline);
    }
    Some(all)
}
