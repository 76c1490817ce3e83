//! Normals and gaps beside the points of a list of segments.
//!
//! The normal n points out of the master (or the obstacle) at the slave point's partner, and
//!
//!   g = (x_slave - x_master) . n          \[length\], positive when open
//!
//! On a master with kinks the normal is that of the facet of the assigned element: it jumps with the master element, in
//! the rows and in the gap alike, so both speak of the same plane.

use super::{Hit, Target};
use crate::basis::Order;
use crate::coupling::{CouplingError, Segments};
use crate::geometry::{Geometry, MapTable, unit_normal};
use crate::linalg::{Real, Vector};
use crate::space::Trace;

/// One entry per point of the segments.
#[derive(Clone, Debug, PartialEq)]
pub struct Frames<const N: usize, T: Real = f64> {
    /// The slave point.
    pub x: Vec<Vector<N, T>>,
    /// Unit normal out of the master at its partner.
    pub normal: Vec<Vector<N, T>>,
    /// Geometric gap \[length\], positive when open.
    pub gap: Vec<T>,
}

impl<const N: usize, T: Real> Default for Frames<N, T> {
    fn default() -> Self {
        Self { x: Vec::new(), normal: Vec::new(), gap: Vec::new() }
    }
}

impl<const N: usize, T: Real> Frames<N, T> {
    /// Frames of segments against a deformable master.
    ///
    /// # Errors
    /// [`CouplingError::Missing`] where the master has no tangent.
    pub fn against_master<const S: usize>(
        slave: &dyn Geometry<S, N, T>,
        master: &Trace<S, N, T>,
        segments: &Segments<S, T>,
    ) -> Result<Self, CouplingError> {
        let mut frames = Self::default();
        let (mut here, mut there) = (MapTable::new(), MapTable::new());
        for piece in 0..segments.num_pieces() {
            let (points, other) = (segments.points(piece), segments.master[piece]);
            slave.map(segments.slave[piece], &segments.slave_xi[points.clone()], Order::Values, &mut here);
            master.space.map(other, &segments.master_xi[points], Order::Gradients, &mut there);
            for q in 0..here.x.len() {
                let normal = unit_normal(&there.jacobian[q], master.outward[other]);
                if normal == Vector::<N, T>::zeros() {
                    return Err(CouplingError::Missing(format!(
                        "element {other} of the master side has no tangent; its map is degenerate"
                    )));
                }
                frames.x.push(here.x[q]);
                frames.normal.push(normal);
                frames.gap.push((here.x[q] - there.x[q]).dot(&normal));
            }
        }
        Ok(frames)
    }

    /// The points of `segments` that face `target` within `reach`, and their frames.
    ///
    /// Points that face nothing are dropped and missing from the report's covered measure.
    pub fn against_target<const S: usize>(
        slave: &dyn Geometry<S, N, T>,
        target: &dyn Target<S, N, T>,
        segments: &Segments<S, T>,
        reach: Option<T>,
    ) -> (Segments<S, T>, Self) {
        let (mut kept, mut frames, mut table) = (Segments::new(), Self::default(), MapTable::new());
        let mut report = segments.report.clone();
        let mut measure = vec![[T::zero(); 2]; slave.num_elements()];
        (report.covered, report.distance) = (T::zero(), T::zero());
        let mut facing = Vec::new();
        for piece in 0..segments.num_pieces() {
            let (points, element) = (segments.points(piece), segments.slave[piece]);
            slave.map(element, &segments.slave_xi[points.clone()], Order::Values, &mut table);
            facing.clear();
            for (x, q) in table.x.iter().zip(points) {
                measure[element][1] += segments.ds[q];
                // what is no number is kept: the gap there is reported
                let near = |hit: &Hit<S, N, T>| reach.is_none_or(|r| (x - hit.x).norm() <= r || !hit.gap.is_finite());
                let Some(hit) = target.project(x).filter(near) else { continue };
                measure[element][0] += segments.ds[q];
                report.covered += segments.ds[q];
                report.distance = report.distance.max((x - hit.x).norm());
                facing.push((segments.slave_xi[q], segments.master_xi[q], segments.ds[q]));
                frames.x.push(*x);
                frames.normal.push(hit.normal);
                frames.gap.push(hit.gap);
            }
            if !facing.is_empty() {
                kept.push_piece(element, segments.master[piece], facing.drain(..));
            }
        }
        report.share = measure.iter().map(|&[part, all]| if all > T::zero() { part / all } else { T::zero() }).collect();
        kept.report = report;
        (kept, frames)
    }
}
