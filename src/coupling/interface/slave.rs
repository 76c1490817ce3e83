//! Slave integration: the slave's own Gauss points, each with its closest point on the master.
//!
//! The master's functions have kinks inside the slave's elements, so integrals converge slowly; merged integration
//! does not have that error. An element in which the master ends is cut there, so that the part that is covered is
//! integrated and no more: masters in a row share a slave element, and mixed integration uses this rule on masters that
//! are longer than the slave. For rigid targets there is no master and the rule is exact.

use super::cuts::Cuts;
use super::pairing::{MasterCurve, size_of};
use super::slave_pieces::{SlavePieces, join};
use super::{Coverage, InterfaceQuadrature, Partners, Segments, Tolerance};
use crate::basis::Order;
use crate::coupling::CouplingError;
use crate::geometry::{Geometry, MapTable};
use crate::linalg::{Real, Vector, measure};
use crate::parallel;
use crate::quadrature::{Quadrature, Rule, gauss_legendre};

/// Gauss points on the slave elements.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SlaveRule<T: Real = f64> {
    /// Gauss points per slave element.
    pub points: usize,
    /// Pairing rule.
    pub partners: Partners<T>,
}

impl<T: Real> SlaveRule<T> {
    /// Creates the rule for tied sides that carry the same curve, or approximate it within `tolerance`.
    pub fn tied(points: usize, tolerance: Tolerance<T>) -> Self {
        Self { points, partners: Partners::Touching(tolerance) }
    }

    /// Creates the rule for sides in contact, possibly across a gap of at most `reach` (`None`: the size of the slave side).
    pub fn facing(points: usize, reach: Option<T>) -> Self {
        Self { points, partners: Partners::Facing { reach } }
    }
}

impl<const N: usize, T: Real> InterfaceQuadrature<1, N, T> for SlaveRule<T> {
    fn segments(&self, slave: &dyn Geometry<1, N, T>, master: &dyn Geometry<1, N, T>) -> Result<Segments<1, T>, CouplingError> {
        if master.num_elements() == 0 {
            return Err(CouplingError::NothingFaces);
        }
        let slave_size = size_of(slave);
        let sides = Sides {
            slave,
            master: MasterCurve::new(master, slave_size),
            slave_size,
            partners: self.partners,
            gauss: gauss_legendre::<T>(self.points.max(1)),
        };
        let parts: Vec<SlavePieces<1, T>> = parallel::map_init(slave.num_elements(), Work::new, |work, e| sides.element(e, work));
        join(parts, master, matches!(self.partners, Partners::Touching(_)))
    }
}

struct Sides<'a, const N: usize, T: Real> {
    slave: &'a dyn Geometry<1, N, T>,
    master: MasterCurve<&'a dyn Geometry<1, N, T>, N, T>,
    slave_size: T,
    partners: Partners<T>,
    gauss: Rule<1, T>,
}

struct Work<const N: usize, T: Real> {
    slave: MapTable<1, N, T>,
    foot: MapTable<1, N, T>,
    cuts: Cuts<N, T>,
    xi: Vec<Vector<1, T>>,
}

impl<const N: usize, T: Real> Work<N, T> {
    fn new() -> Self {
        Self { slave: MapTable::new(), foot: MapTable::new(), cuts: Cuts::new(), xi: Vec::new() }
    }
}

impl<const N: usize, T: Real> Sides<'_, N, T> {
    /// Integrates an element at its Gauss points; if the master ends inside it, at those of each of its parts.
    fn element(&self, element: usize, work: &mut Work<N, T>) -> SlavePieces<1, T> {
        let mut part = SlavePieces::new(element);
        let outward = self.partners.outward(self.slave, element);
        work.cuts.at_rims(self.slave, element, &self.master, outward, &mut work.slave);
        for k in 1..work.cuts.at.len() {
            let (from, width) = (work.cuts.at[k - 1], work.cuts.at[k] - work.cuts.at[k - 1]);
            work.xi.clear();
            work.xi.extend(self.gauss.points.iter().map(|p| Vector::<1, T>::new(from + width * p[0])));
            self.slave.map(element, &work.xi, Order::Gradients, &mut work.slave);
            let ds: Vec<T> = work.slave.jacobian.iter().zip(&self.gauss.weights).map(|(j, &w)| j.column(0).norm() * w * width).collect();
            let length = ds.iter().fold(T::zero(), |s, &v| s + v) / width;
            for (q, &ds) in ds.iter().enumerate() {
                part.measure += ds;
                let x = work.slave.x[q];
                let place = self.master.faced_place(&x, &work.slave.jacobian[q].column(0).into_owned(), outward);
                let Some(place) = place.filter(|p| self.partners.face(p, self.master.size())) else { continue };
                let lengths = [length, self.master.chain().lengths[place.element]];
                let (allowed, is_error) = self.partners.allowed(self.master.size(), self.slave_size, lengths);
                if !is_error && place.distance > allowed {
                    continue;
                }
                let mut eta = [Vector::<1, T>::new(place.xi)];
                self.master.feet(place.element, &[x], &mut eta, &mut work.foot);
                part.covered += ds;
                part.see(&x, (x - work.foot.x[0]).norm(), allowed);
                let point = (work.xi[q], eta[0], ds);
                match part.pieces.last_mut() {
                    Some((owner, points)) if *owner == place.element => points.push(point),
                    _ => part.pieces.push((place.element, vec![point])),
                }
            }
        }
        part
    }
}

/// Segments with the points of `rule` on every element of `slave`, without a master: for rigid targets. Master ids and
/// coordinates are zero and unused.
pub fn slave_segments<const D: usize, const N: usize, T: Real>(
    slave: &dyn Geometry<D, N, T>,
    rule: &dyn Quadrature<D, T>,
) -> Segments<D, T> {
    let (mut out, mut table) = (Segments::new(), MapTable::<D, N, T>::new());
    for element in 0..slave.num_elements() {
        let rule = rule.rule(element);
        slave.map(element, &rule.points, Order::Gradients, &mut table);
        let points = rule.points.iter().zip(&rule.weights).zip(&table.jacobian);
        let points = points.map(|((xi, &w), jacobian)| (*xi, Vector::zeros(), w * measure(jacobian)));
        out.push_piece(element, 0, points);
    }
    let whole = out.measure();
    let (share, pieces) = (vec![T::one(); slave.num_elements()], out.num_pieces());
    out.report = Coverage { slave_measure: whole, covered: whole, share, pieces, ..Coverage::default() };
    out
}
