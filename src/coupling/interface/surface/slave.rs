//! Slave integration on surfaces: the slave's own Gauss points, each with its closest point on the master.
//!
//! The master's functions have kinks inside the slave's elements, so integrals converge slowly; merged integration does not have that
//! error. An element of which a rim of the master leaves a part uncovered takes the regions of merged integration, so that what is covered
//! is integrated and no more. Where the closest point lies on an edge or a vertex of the master, the point belongs to the element there
//! whose normal is nearest to the line to it: the fan of a kink is halved.

use super::super::slave_pieces::{Point, SlavePieces, join};
use super::super::{InterfaceQuadrature, Partners, Segments, Tolerance};
use super::element::Sides;
use super::polygon::Polygon;
use crate::basis::{Cell, Order};
use crate::coupling::CouplingError;
use crate::geometry::{Geometry, MapTable, cross, opposes, unit_normal};
use crate::quadrature::{Quadrature, Rule, TensorRule, simplex_rule};
use rayon::prelude::*;
use std::collections::BTreeMap;

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
        let parts: Vec<SlavePieces<2, f64>> = (0..slave.num_elements()).into_par_iter().map(|e| own.element(e)).collect();
        join(parts, master, matches!(self.partners, Partners::Touching(_)))
    }
}

/// Both sides with the rules of the slave's cells.
struct OwnPoints<'s, 'a> {
    sides: &'s Sides<'a>,
    rules: [Rule<2>; 2],
}

impl OwnPoints<'_, '_> {
    fn element(&self, element: usize) -> SlavePieces<2, f64> {
        if self.sides.may_end(element) {
            let merged = self.sides.element(element);
            if !merged.whole {
                return merged;
            }
        }
        self.at_own_points(element)
    }

    fn at_own_points(&self, element: usize) -> SlavePieces<2, f64> {
        let (sides, mut part) = (self.sides, SlavePieces::new(element));
        let slave = sides.slave.map;
        let rule = &self.rules[usize::from(slave.cell(element) == Cell::Simplex)];
        let (mut here, mut table) = (MapTable::new(), MapTable::new());
        slave.map(element, &rule.points, Order::Gradients, &mut here);
        let ds: Vec<f64> = here.jacobian.iter().zip(&rule.weights).map(|(j, w)| cross(j).norm() * w).collect();
        part.measure = ds.iter().sum();
        let own_size = sides.slave.of(element).map(|s| sides.slave.list[s].size).fold(f64::INFINITY, f64::min);
        let outward = sides.partners.outward(slave, element);
        let mut pieces: BTreeMap<usize, Vec<Point<2, f64>>> = BTreeMap::new();
        let mut paired = 0;
        for (q, x) in here.x.iter().enumerate() {
            let Some((f, foot)) = sides.master.place(x, &mut table) else { continue };
            let master = &sides.master.facets;
            let facet = &master.list[f];
            let (allowed, is_error) = sides.partners.allowed(sides.sizes[1], sides.sizes[0], [own_size, facet.size]);
            let distance = (x - foot.x).norm();
            if !is_error && distance > allowed {
                continue;
            }
            if let Some((a, b)) = outward.zip(master.map.outward(facet.element)) {
                master.at(f, &[foot.eta], Order::Gradients, &mut table);
                if !opposes(&unit_normal(&here.jacobian[q], a), &unit_normal(&table.jacobian[0], b)) {
                    continue;
                }
            }
            part.covered += ds[q];
            part.see(x, distance, allowed);
            paired += 1;
            pieces.entry(facet.element).or_default().push((rule.points[q], facet.local(&foot.eta), ds[q]));
        }
        part.whole = paired == ds.len();
        part.pieces = pieces.into_iter().collect();
        part
    }
}

impl Sides<'_> {
    /// Whether a rim of the master may cross a slave element: one of its candidates has a rim.
    fn may_end(&self, element: usize) -> bool {
        let skeleton = &self.master.skeleton;
        let ends = |f: &usize| {
            let polygon: Polygon = self.master.facets.list[*f].polygon;
            skeleton.sides[*f][..polygon.sides()].iter().flatten().any(|e| skeleton.edges[*e].at.len() == 1)
        };
        self.near(element).iter().any(ends)
    }
}
