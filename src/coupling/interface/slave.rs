//! Slave integration: the slave's own Gauss points, each with its closest point on the master.
//!
//! The master's functions have kinks inside the slave's elements, so integrals converge slowly; merged integration
//! does not have that error. For rigid targets there is no master and the rule is exact.

use super::merged_curve::{Part, join};
use super::pairing::{MasterCurve, size_of};
use super::{Coverage, InterfaceQuadrature, Partners, Segments, Tolerance};
use crate::basis::Order;
use crate::coupling::CouplingError;
use crate::geometry::{Geometry, MapTable};
use crate::linalg::{Real, Vector, measure};
use crate::quadrature::{Quadrature, gauss_legendre};
use rayon::prelude::*;

/// Gauss points on the slave elements.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SlaveRule<T: Real = f64> {
    /// Gauss points per slave element.
    pub points: usize,
    /// Which points are partners.
    pub partners: Partners<T>,
}

impl<T: Real> SlaveRule<T> {
    /// For tied sides that carry the same curve, or approximate it within `tolerance`.
    pub fn tied(points: usize, tolerance: Tolerance<T>) -> Self {
        Self { points, partners: Partners::Touching(tolerance) }
    }

    /// For sides in contact, possibly across a gap of at most `reach` (none: the size of the slave side).
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
        let other = MasterCurve::new(master, slave_size);
        let gauss = gauss_legendre::<T>(self.points.max(1));
        let is_tied = matches!(self.partners, Partners::Touching(_));
        let one_element = |tables: &mut (MapTable<1, N, T>, MapTable<1, N, T>), element: usize| {
            let (table, foot) = tables;
            slave.map(element, &gauss.points, Order::Gradients, table);
            let mut part = Part::new(element);
            let ds: Vec<T> = (0..gauss.points.len()).map(|q| table.jacobian[q].column(0).norm() * gauss.weights[q]).collect();
            let length = ds.iter().fold(T::zero(), |s, &v| s + v);
            for q in 0..gauss.points.len() {
                part.measure += ds[q];
                let x = table.x[q];
                let Some(place) = other.place(&x).filter(|p| !p.beyond) else { continue };
                let (allowed, _) = self.partners.allowed(other.size(), slave_size, [length, other.chain().lengths[place.element]]);
                if !is_tied && place.distance > allowed {
                    continue;
                }
                let mut eta = [Vector::<1, T>::new(place.xi)];
                other.feet(place.element, &[x], &mut eta, foot);
                part.covered += ds[q];
                part.see(&x, (x - foot.x[0]).norm(), allowed);
                let point = (gauss.points[q], eta[0], ds[q]);
                match part.pieces.last_mut() {
                    Some((owner, points)) if *owner == place.element => points.push(point),
                    _ => part.pieces.push((place.element, vec![point])),
                }
            }
            part
        };
        let parts: Vec<Part<T>> =
            (0..slave.num_elements()).into_par_iter().map_init(|| (MapTable::new(), MapTable::new()), one_element).collect();
        join(parts, is_tied)
    }
}

/// The points of `rule` on every element of `slave`, without a master: for rigid targets. Master ids and coordinates
/// are zero and mean nothing.
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
    out.report = Coverage { slave_measure: whole, covered: whole, share: vec![T::one(); slave.num_elements()], ..Coverage::default() };
    out
}
