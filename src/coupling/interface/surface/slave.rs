//! Slave integration on surfaces: the slave's own Gauss points, each with its closest point on the master.
//!
//! The master's functions have kinks inside the slave's elements, so integrals converge slowly; merged integration does not have that
//! error. Of an element of which a rim of the master leaves a part uncovered, the part that is covered has points of its own (`covered.rs`),
//! n x n of them if it has four straight sides. Where the closest point lies on an edge or a vertex of the master, the point belongs to the
//! element there whose normal is nearest to the line to it: the fan of a kink is halved.

use super::super::slave_pieces::{Point, SlavePieces, join};
use super::super::{InterfaceQuadrature, Partners, Segments, Tolerance};
use super::element::{Scratch, Sides};
use super::polygon::Polygon;
use crate::basis::{Cell, Order};
use crate::coupling::CouplingError;
use crate::geometry::{Geometry, MapTable, cross, opposes, unit_normal};
use crate::linalg::Vector;
use crate::parallel;
use crate::quadrature::{Quadrature, Rule, TensorRule, simplex_rule};
use std::collections::BTreeMap;

/// Deviation of a part from the regions that cover it, in local coordinates, that is rounding.
const SAME_PART: f64 = 1e-8;

/// Gauss points on the slave elements of surfaces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SlaveSurface {
    /// Gauss points per direction of a slave element; triangles take a rule of the same degree.
    pub points: usize,
    /// Pairing rule.
    pub partners: Partners,
}

impl SlaveSurface {
    /// Creates the rule for tied sides that carry the same surface, or approximate it within `tolerance`.
    pub fn tied(points: usize, tolerance: Tolerance) -> Self {
        Self { points, partners: Partners::Touching(tolerance) }
    }

    /// Creates the rule for sides in contact, possibly across a gap of at most `reach` (`None`: the size of the slave side).
    pub fn facing(points: usize, reach: Option<f64>) -> Self {
        Self { points, partners: Partners::Facing { reach } }
    }
}

impl InterfaceQuadrature<2, 3> for SlaveSurface {
    fn segments(&self, slave: &dyn Geometry<2, 3>, master: &dyn Geometry<2, 3>) -> Result<Segments<2>, CouplingError> {
        if master.num_elements() == 0 {
            return Err(CouplingError::NothingFaces);
        }
        let points = self.points.max(1);
        let sides = Sides::new(slave, master, self.partners, points)?;
        let own = OwnPoints { sides: &sides, rules: [TensorRule::<2>::gauss([points; 2]).rule(0).clone(), simplex_rule(2 * points - 1)] };
        let parts: Vec<SlavePieces<2, f64>> =
            parallel::map_init(slave.num_elements(), Scratch::default, |scratch, e| own.element(e, scratch));
        join(parts, master, matches!(self.partners, Partners::Touching(_)))
    }
}

/// Both sides with the rules of the slave's cells.
struct OwnPoints<'s, 'a> {
    sides: &'s Sides<'a>,
    rules: [Rule<2>; 2],
}

impl OwnPoints<'_, '_> {
    fn element(&self, element: usize, scratch: &mut Scratch) -> SlavePieces<2, f64> {
        if self.sides.may_end(element, scratch) {
            let merged = self.sides.element(element, scratch);
            if !merged.whole {
                return self.on_part(&merged).unwrap_or(merged);
            }
        }
        self.at_own_points(element)
    }

    /// Points of the part of an element that the regions of `merged` cover; `None` if that part has none, or one has no partner.
    fn on_part(&self, merged: &SlavePieces<2, f64>) -> Option<SlavePieces<2, f64>> {
        let mut by: Vec<usize> = merged.pieces.iter().map(|piece| piece.0).collect();
        by.sort_unstable();
        by.dedup();
        let (points, weights): (Vec<Vector<2>>, Vec<f64>) = self.sides.part_of_slave(merged.element, &by)?.into_iter().unzip();
        let (mut here, mut covered) = (MapTable::new(), 0.0);
        for (_, list) in &merged.pieces {
            let xi: Vec<Vector<2>> = list.iter().map(|point| point.0).collect();
            self.sides.slave.map.map(merged.element, &xi, Order::Gradients, &mut here);
            covered += list.iter().zip(&here.jacobian).map(|(point, j)| point.2 / cross(j).norm()).sum::<f64>();
        }
        let mut part = SlavePieces::new(merged.element);
        let all = self.at(&points, &weights, &mut part);
        (part.measure, part.lost) = (merged.measure, merged.lost);
        (all && (weights.iter().sum::<f64>() - covered).abs() <= SAME_PART).then_some(part)
    }

    fn at_own_points(&self, element: usize) -> SlavePieces<2, f64> {
        let mut part = SlavePieces::new(element);
        let rule = &self.rules[usize::from(self.sides.slave.map.cell(element) == Cell::Simplex)];
        part.whole = self.at(&rule.points, &rule.weights, &mut part);
        part
    }

    /// Appends points of the element of `part`, and their measure; returns whether all have partners.
    fn at(&self, points: &[Vector<2>], weights: &[f64], part: &mut SlavePieces<2, f64>) -> bool {
        let (sides, element) = (self.sides, part.element);
        let (mut here, mut table) = (MapTable::new(), MapTable::new());
        sides.slave.map.map(element, points, Order::Gradients, &mut here);
        let ds: Vec<f64> = here.jacobian.iter().zip(weights).map(|(j, w)| cross(j).norm() * w).collect();
        part.measure = ds.iter().sum();
        let own_size = sides.slave.of(element).map(|s| sides.slave.list[s].size).fold(f64::INFINITY, f64::min);
        let at = |q: usize| Own { x: here.x[q], normal: cross(&here.jacobian[q]), xi: points[q], ds: ds[q] };
        sides.closest(own_size, (0..ds.len()).map(at), part, &mut table)
    }
}

/// A point of a slave element: place, a normal, local coordinates and weight.
pub(super) struct Own {
    pub x: Vector<3>,
    pub normal: Vector<3>,
    pub xi: Vector<2>,
    pub ds: f64,
}

impl Sides<'_> {
    /// Appends points of the element of `part`, of a facet of the size `own_size`, each with its closest point on the master; returns whether
    /// all have one.
    pub(super) fn closest(
        &self,
        own_size: f64,
        points: impl Iterator<Item = Own>,
        part: &mut SlavePieces<2, f64>,
        table: &mut MapTable<2, 3>,
    ) -> bool {
        let outward = self.partners.outward(self.slave.map, part.element);
        let mut pieces: BTreeMap<usize, Vec<Point<2, f64>>> = BTreeMap::new();
        let mut all = true;
        for own in points {
            let found = self.master.place(&own.x, table).filter(|(f, foot)| {
                let (master, facet) = (&self.master.facets, &self.master.facets.list[*f]);
                let (allowed, is_error) = self.partners.allowed(self.sizes[1], self.sizes[0], [own_size, facet.size]);
                if !is_error && (own.x - foot.x).norm() > allowed {
                    return false;
                }
                outward.zip(master.map.outward(facet.element)).is_none_or(|(a, b)| {
                    master.at(*f, &[foot.eta], Order::Gradients, table);
                    opposes(&(own.normal * (a / own.normal.norm().max(f64::MIN_POSITIVE))), &unit_normal(&table.jacobian[0], b))
                })
            });
            let Some((f, foot)) = found else {
                all = false;
                continue;
            };
            let facet = &self.master.facets.list[f];
            let (allowed, _) = self.partners.allowed(self.sizes[1], self.sizes[0], [own_size, facet.size]);
            part.covered += own.ds;
            part.see(&own.x, (own.x - foot.x).norm(), allowed);
            pieces.entry(facet.element).or_default().push((own.xi, facet.local(&foot.eta), own.ds));
        }
        part.pieces.extend(pieces);
        all
    }

    /// Whether a rim of the master may cross a slave element: one of its candidates has a rim.
    fn may_end(&self, element: usize, scratch: &mut Scratch) -> bool {
        let skeleton = &self.master.skeleton;
        let ends = |f: &usize| {
            let polygon: Polygon = self.master.facets.list[*f].polygon;
            skeleton.sides[*f][..polygon.sides()].iter().flatten().any(|e| skeleton.edges[*e].is_rim())
        };
        self.near(element, &mut scratch.table).iter().any(ends)
    }
}
