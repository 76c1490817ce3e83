//! Master-side sums of surfaces: the master's own Gauss points, each with the slave point that faces it along the master's normal.
//!
//! A master point x_m with tangents J_m faces the slave point whose closest point it is, Jₘᵀ (x_s(xi) - x_m(eta)) = 0; differentiating gives
//! the slave's measure in the master's coordinates, with the second derivatives H of the master:
//!
//! ```text
//! dxi/deta = B⁻¹ A,   A = Jₘᵀ Jₘ - sum_c (x_s - x_m)_c H_c,   B = Jₘᵀ J_s,   ds = |t_1 x t_2|_s |det A / det B| deta
//! ```
//!
//! so the sums tend to the same integrals over the slave as slave-side and merged ones. What faces what is told by merged integration: an
//! element that its regions cover is integrated by its own Gauss points, with no regard to the slave's edges, which is the error of this
//! rule. Where the slave ends, the part of the element that it covers has points of its own (`covered.rs`), n x n of them if that has four
//! straight sides. Parts of elements in the fan of a kink keep the points of merged integration. A point that several slave elements share
//! counts in equal parts for each: a multiplier may jump there.

use super::super::slave_pieces::join;
use super::super::{InterfaceQuadrature, Partners, Segments};
use super::cell_rule::WeightedPoints;
use super::element::{Scratch, Sides};
use super::facets::polygon_of;
use crate::basis::{Cell, Order};
use crate::coupling::CouplingError;
use crate::geometry::{Geometry, MapTable, cell, cross};
use crate::linalg::{Matrix, Vector, determinant, inverse};
use crate::parallel;
use crate::quadrature::{Quadrature, Rule, TensorRule, simplex_rule};
use std::collections::BTreeMap;

/// Deviation of the regions of an element from the part that they cover that is an error of their quadrature.
const WHOLE: f64 = 1e-5;
/// Deviation of the part that is covered from the element that is rounding.
const SAME: f64 = 1e-8;
/// A partner this far outside of its element, in local coordinates, is in it.
const INSIDE: f64 = 1e-9;
/// Steps of Newton's method; it converges in three to six.
const STEPS: usize = 30;
/// A step after which the next one is below rounding.
const SETTLED: f64 = 1e-13;

/// Gauss points on the master elements of surfaces, for the master part of the reaction of contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MasterSurfaceSums {
    /// Gauss points per direction of a master element; triangles take a rule of the same degree.
    pub points: usize,
    /// Pairing rule.
    pub partners: Partners,
}

impl MasterSurfaceSums {
    /// Creates the rule for sides in contact, possibly across a gap of at most `reach` (`None`: the size of the slave side).
    pub fn facing(points: usize, reach: Option<f64>) -> Self {
        Self { points, partners: Partners::Facing { reach } }
    }
}

/// A pair of partners: slave element, its local coordinates, those of the master, and the weight.
type Pair = (usize, Vector<2>, Vector<2>, f64);

impl InterfaceQuadrature<2, 3> for MasterSurfaceSums {
    fn segments(&self, slave: &dyn Geometry<2, 3>, master: &dyn Geometry<2, 3>) -> Result<Segments<2>, CouplingError> {
        if master.num_elements() == 0 {
            return Err(CouplingError::NothingFaces);
        }
        let points = self.points.max(1);
        let sides = Sides::new(slave, master, self.partners, points)?;
        let parts = parallel::map_init(slave.num_elements(), Scratch::default, |scratch, e| sides.element(e, scratch));
        let merged = join(parts, master, false)?;
        let mut of_master: Vec<Vec<Pair>> = vec![Vec::new(); master.num_elements()];
        for piece in 0..merged.num_pieces() {
            let points = merged.points(piece).map(|q| (merged.slave[piece], merged.slave_xi[q], merged.master_xi[q], merged.ds[q]));
            of_master[merged.master[piece]].extend(points);
        }
        let rules = [TensorRule::<2>::gauss([points; 2]).rule(0).clone(), simplex_rule(2 * points - 1)];
        let rule = |f: usize| &rules[usize::from(master.cell(f) == Cell::Simplex)];
        let own = |(f, merged): (usize, Vec<Pair>)| own_points(&sides, f, &merged, rule(f)).unwrap_or(merged);
        let summed: Vec<Vec<Pair>> = parallel::map_each(of_master.into_iter().enumerate(), own);
        let mut pieces: BTreeMap<(usize, usize), Vec<_>> = BTreeMap::new();
        for (f, list) in summed.into_iter().enumerate() {
            for (element, xi, eta, ds) in list {
                pieces.entry((element, f)).or_default().push((xi, eta, ds));
            }
        }
        let mut out = Segments::new();
        pieces.into_iter().for_each(|((element, f), points)| out.push_piece(element, f, points));
        out.report = merged.report.clone();
        out.report.covered = out.measure();
        out.count(master);
        Ok(out)
    }
}

/// The Gauss points of a master element, or of the part that the regions of `merged` cover, with their partners; `None` if that part has
/// none, or one has no partner.
fn own_points(sides: &Sides<'_>, f: usize, merged: &[Pair], rule: &Rule<2>) -> Option<Vec<Pair>> {
    let (slave, master) = (sides.slave.map, sides.master.facets.map);
    let mut work = Work { slave, own: MapTable::new(), other: MapTable::new() };
    let cell: f64 = rule.weights.iter().sum();
    let mut covered = 0.0;
    for (element, xi, eta, ds) in merged {
        master.map(f, &[*eta], Order::Hessians, &mut work.other);
        slave.map(*element, &[*xi], Order::Gradients, &mut work.own);
        covered += ds / work.rate()?;
    }
    // merged pairs are in the order of slave elements
    let groups: Vec<&[Pair]> = merged.chunk_by(|a, b| a.0 == b.0).collect();
    let by: Vec<usize> = groups.iter().map(|group| group[0].0).collect();
    let is = |area: f64| (covered - area).abs() <= WHOLE * cell;
    let part = if is(cell) && !sides.ends_at(&by) { None } else { sides.part_of_master(f, &by) };
    let area = part.as_ref().map_or(cell, |part| part.iter().map(|p| p.1).sum());
    if !is(area) {
        return None;
    }
    let points: WeightedPoints = match part {
        Some(part) if (area / cell - 1.0).abs() > SAME => part,
        _ => rule.points.iter().copied().zip(rule.weights.iter().copied()).collect(),
    };
    // starts: one point per slave element
    points
        .iter()
        .map(|(eta, weight)| {
            let nearest = |group: &&[Pair]| {
                let all = group.iter().map(|(element, xi, at, _)| ((at - eta).norm(), *element, *xi));
                all.min_by(|a, b| a.0.total_cmp(&b.0)).expect("a group has a pair")
            };
            let mut order: Vec<(f64, usize, Vector<2>)> = groups.iter().map(nearest).collect();
            order.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            master.map(f, &[*eta], Order::Hessians, &mut work.other);
            let mut found = Vec::new();
            for (_, element, start) in order {
                let Some((xi, rate)) = work.partner(element, start).and_then(|xi| Some((xi, work.rate()?))) else { continue };
                found.push((element, xi, *eta, weight * rate));
                if polygon_of(slave.cell(element)).depth(&xi) > INSIDE {
                    break;
                }
            }
            let share = 1.0 / found.len() as f64;
            found.iter_mut().for_each(|pair| pair.3 *= share);
            (!found.is_empty()).then_some(found)
        })
        .collect::<Option<Vec<_>>>()
        .map(|found| found.concat())
}

/// Both maps at a pair of points.
struct Work<'a> {
    slave: &'a dyn Geometry<2, 3>,
    own: MapTable<2, 3>,
    other: MapTable<2, 3>,
}

impl Work<'_> {
    /// ds / deta at the pair in the tables; `None` where the slave is parallel to the master's normal.
    fn rate(&self) -> Option<f64> {
        let (j, away) = (self.other.jacobian[0], self.own.x[0] - self.other.x[0]);
        let mut a = j.tr_mul(&j);
        for c in 0..3 {
            a -= self.other.hessian[0][c] * away[c];
        }
        let b: Matrix<2, 2> = j.tr_mul(&self.own.jacobian[0]);
        let rate = cross(&self.own.jacobian[0]).norm() * (determinant(&a) / determinant(&b)).abs();
        (rate.is_finite() && rate > 0.0).then_some(rate)
    }

    /// The point of a slave element on the normal of the master point in `other`, if it is there; its map is left in `own`.
    fn partner(&mut self, element: usize, start: Vector<2>) -> Option<Vector<2>> {
        let (x, j) = (self.other.x[0], self.other.jacobian[0]);
        let mut xi = start;
        for _ in 0..STEPS {
            self.slave.map(element, &[xi], Order::Gradients, &mut self.own);
            let step = inverse(&j.tr_mul(&self.own.jacobian[0]))? * j.tr_mul(&(x - self.own.x[0]));
            let length = step.amax();
            xi += if length > 0.5 { step * (0.5 / length) } else { step };
            if length <= SETTLED {
                break;
            }
        }
        self.slave.map(element, &[xi], Order::Gradients, &mut self.own);
        let apart = j.tr_mul(&(x - self.own.x[0])).norm();
        let is_found = apart <= INSIDE * j.norm() * self.own.jacobian[0].norm();
        (is_found && cell::contains(self.slave.cell(element), &xi, INSIDE)).then_some(xi)
    }
}
