//! Contact kinematics at the points of a list of segments: normals and gaps.
//!
//! The normal n points out of the master (or the obstacle) at the slave point's partner, and
//!
//! ```text
//! g = (x_slave - x_master) . n          [length], positive when open
//! ```
//!
//! On a master with kinks the normal is that of the facet of the assigned element: it jumps with the master element, in
//! the rows and in the gap alike, so both refer to the same plane.

use super::depth::{deepest, to_surface};
use super::{Hit, Obstacle, opposed, opposes};
use crate::basis::Order;
use crate::coupling::{CouplingError, Segments};
use crate::geometry::{ClosestPoint, MapTable, unit_normal};
use crate::linalg::{Real, Vector, lit};
use crate::space::Trace;
use std::sync::Arc;

/// Deviation of the length of an obstacle's normal from one beyond which it is no unit normal.
const UNIT: f64 = 1e-9;

/// Positions, normals and gaps, one per point of the segments.
#[derive(Clone, Debug, PartialEq)]
pub struct ContactKinematics<const N: usize, T: Real = f64> {
    /// The slave point.
    pub x: Vec<Vector<N, T>>,
    /// Unit normal out of the master at its partner.
    pub normal: Vec<Vector<N, T>>,
    /// Geometric gap \[length\], positive when open.
    pub gap: Vec<T>,
}

impl<const N: usize, T: Real> Default for ContactKinematics<N, T> {
    fn default() -> Self {
        Self { x: Vec::new(), normal: Vec::new(), gap: Vec::new() }
    }
}

impl<const N: usize, T: Real> ContactKinematics<N, T> {
    /// Returns the points of `segments` at which `slave` and `master` face each other, and their frames.
    ///
    /// Outward normals oppose there ([`opposes`]); other points are dropped, also from the report's covered measure.
    ///
    /// # Errors
    /// [`CouplingError::Missing`] if the master has no tangent.
    pub fn against_master<const S: usize>(
        slave: &Trace<S, N, T>,
        master: &Trace<S, N, T>,
        segments: &Segments<S, T>,
    ) -> Result<(Segments<S, T>, Self), CouplingError> {
        let mut frames = Self::default();
        let (mut here, mut there) = (MapTable::new(), MapTable::new());
        let mut faces = Vec::with_capacity(segments.ds.len());
        for piece in 0..segments.num_pieces() {
            let (points, element, other) = (segments.points(piece), segments.slave[piece], segments.master[piece]);
            slave.space.map(element, &segments.slave_xi[points.clone()], Order::Gradients, &mut here);
            master.space.map(other, &segments.master_xi[points], Order::Gradients, &mut there);
            for q in 0..here.x.len() {
                let normal = unit_normal(&there.jacobian[q], master.outward[other]);
                if normal == Vector::<N, T>::zeros() {
                    return Err(CouplingError::Missing(format!(
                        "element {other} of the master side has no tangent; its map is degenerate"
                    )));
                }
                faces.push(opposes(&slave.normal(element, &here.jacobian[q]), &normal));
                frames.x.push(here.x[q]);
                frames.normal.push(normal);
                frames.gap.push((here.x[q] - there.x[q]).dot(&normal));
            }
        }
        let inside = frames.depths(&faces);
        let mut surface = None;
        let bound = deepest(extent(slave), &inside, |q| {
            let surface = surface.get_or_insert_with(|| ClosestPoint::new(Arc::clone(&master.space)));
            surface.project(&frames.x[q]).map_or_else(T::zero, |foot| foot.distance)
        });
        inside.iter().filter(|(_, depth)| *depth > bound).for_each(|&(q, _)| faces[q] = false);
        frames.keep(&faces);
        let kept = if faces.contains(&false) { only(segments, &faces) } else { segments.clone() };
        Ok((kept, frames))
    }

    /// Returns the points of `segments` that face `target` within `reach`, and their frames.
    ///
    /// Points that face nothing, since nothing there opposes their normal, are dropped and missing from the report's covered measure.
    ///
    /// # Errors
    /// [`CouplingError::Missing`] if a normal of the obstacle has not the length one.
    pub fn against_obstacle<const S: usize>(
        slave: &Trace<S, N, T>,
        target: &dyn Obstacle<S, N, T>,
        segments: &Segments<S, T>,
        reach: Option<T>,
    ) -> Result<(Segments<S, T>, Self), CouplingError> {
        let (mut all, mut faces, mut table) = (Self::default(), Vec::with_capacity(segments.ds.len()), MapTable::new());
        let mut feet = Vec::with_capacity(segments.ds.len());
        for piece in 0..segments.num_pieces() {
            let (points, element) = (segments.points(piece), segments.slave[piece]);
            slave.space.map(element, &segments.slave_xi[points.clone()], Order::Gradients, &mut table);
            for (x, jacobian) in table.x.iter().zip(&table.jacobian) {
                // a gap that is not finite is kept, to be reported
                let near = |hit: &Hit<S, N, T>| !hit.gap.is_finite() || reach.is_none_or(|r| (x - hit.x).norm() <= r);
                let hit = opposed(target, x, &slave.normal(element, jacobian)).filter(near);
                if let Some(hit) = hit.filter(|hit| hit.gap.is_finite() && (hit.normal.norm() - T::one()).abs() > lit(UNIT)) {
                    let text =
                        format!("the normal of the obstacle at {:?} has the length {}, not one", hit.x.as_slice(), hit.normal.norm());
                    return Err(CouplingError::Missing(text));
                }
                faces.push(hit.is_some());
                let hit = hit.unwrap_or(Hit { x: *x, normal: Vector::zeros(), gap: T::zero(), at: None });
                all.x.push(*x);
                all.normal.push(hit.normal);
                all.gap.push(hit.gap);
                feet.push(hit.x);
            }
        }
        let inside = all.depths(&faces);
        let bound = deepest(extent(slave), &inside, |q| to_surface(target, &all.x[q]).unwrap_or_else(T::zero));
        inside.iter().filter(|(_, depth)| *depth > bound).for_each(|&(q, _)| faces[q] = false);
        let mut kept = Segments::new();
        let mut report = segments.report.clone();
        let mut measure = vec![[T::zero(); 2]; slave.facets.len()];
        (report.covered, report.distance) = (T::zero(), T::zero());
        for piece in 0..segments.num_pieces() {
            let element = segments.slave[piece];
            let mut facing = Vec::new();
            for q in segments.points(piece) {
                measure[element][1] += segments.ds[q];
                if faces[q] {
                    measure[element][0] += segments.ds[q];
                    report.covered += segments.ds[q];
                    report.distance = report.distance.max((all.x[q] - feet[q]).norm());
                    facing.push((segments.slave_xi[q], segments.master_xi[q], segments.ds[q]));
                }
            }
            if !facing.is_empty() {
                kept.push_piece(element, segments.master[piece], facing);
            }
        }
        all.keep(&faces);
        report.share = measure.iter().map(|&[part, all]| if all > T::zero() { part / all } else { T::zero() }).collect();
        kept.report = report;
        Ok((kept, all))
    }

    /// The points inside of the opponent that face it, with their depths \[length\].
    fn depths(&self, faces: &[bool]) -> Vec<(usize, T)> {
        (0..faces.len()).filter(|&q| faces[q] && self.gap[q] < T::zero()).map(|q| (q, -self.gap[q])).collect()
    }

    /// Keeps the marked points.
    fn keep(&mut self, marked: &[bool]) {
        let mut marks = marked.iter();
        self.x.retain(|_| marks.next() == Some(&true));
        let mut marks = marked.iter();
        self.normal.retain(|_| marks.next() == Some(&true));
        let mut marks = marked.iter();
        self.gap.retain(|_| marks.next() == Some(&true));
    }
}

/// The diagonal of the box around a side \[length\].
fn extent<const S: usize, const N: usize, T: Real>(side: &Trace<S, N, T>) -> T {
    side.space.extent().map_or_else(T::zero, |bounds| bounds.diagonal())
}

/// Restricts `segments` to the points marked in `keep`.
fn only<const S: usize, T: Real>(segments: &Segments<S, T>, keep: &[bool]) -> Segments<S, T> {
    let mut kept = Segments::new();
    let mut report = segments.report.clone();
    let mut measure = vec![[T::zero(); 2]; report.share.len()];
    for piece in 0..segments.num_pieces() {
        let element = segments.slave[piece];
        let mut points = Vec::new();
        for q in segments.points(piece) {
            let ds = segments.ds[q];
            if let Some(sums) = measure.get_mut(element) {
                sums[1] += ds;
                sums[0] += if keep[q] { ds } else { T::zero() };
            }
            if keep[q] {
                points.push((segments.slave_xi[q], segments.master_xi[q], ds));
            }
        }
        if !points.is_empty() {
            kept.push_piece(element, segments.master[piece], points);
        }
    }
    for (share, [part, all]) in report.share.iter_mut().zip(measure) {
        if part < all {
            *share *= part / all;
        }
    }
    report.covered = kept.measure();
    kept.report = report;
    kept
}
