//! Contacts that slide so far along a curved surface that their gap at rest is no longer correct.
//!
//! Small kinematics take the gap along the normal at rest, g + (u_slave - u_master) . n. A point that moves by u_t along a surface of
//! radius R is |u_t|² / 2R farther from it (nearer, inside of a hole). With d the distance neglected by this first order, measured at the
//! closed points by the closest point of the surface at rest to their position moved by u_slave - u_master,
//!
//! ```text
//! e = mean |d| / ( mean |g| + mean |u_master . n - its mean| ),
//! ```
//!
//! the error of the gap over the closing distance: the initial gaps, and the yielding of the master. The area and the half width of the
//! zone are wrong by about as much. A rotation of the master itself is not detected, nor are distances below the rounding of places: in
//! bodies that fit exactly both sums are nothing else.

use super::warning::{Subject, Warning};
use crate::basis::Order;
use crate::contact::{ContactRows, opposed};
use crate::geometry::{ClosestPoint, MapTable};
use crate::linalg::Vector;
use crate::problem::integrate::on_trace;
use crate::problem::model::{ContactModel, ContactPart, Model, Opposing};
use crate::problem::state::StepState;

/// Error e above which the warning is given.
const POOR: f64 = 0.1;
/// Segments sampled per side, at most.
const SAMPLES: usize = 200;
/// Normals that differ by less than this belong to a plane.
const PLANE: f64 = 1e-10;
/// Distances below this share of the size of the model, and of its distance from the origin, are rounding of closest points.
const ROUNDING: f64 = 1e-12;

/// A closed point.
struct Closed<const N: usize> {
    x: Vector<N>,
    normal: Vector<N>,
    /// The gap by the gap formula.
    gap: f64,
    /// u_slave - u_master.
    shift: Vector<N>,
    /// u_master . n.
    gives_way: f64,
    ds: f64,
}

/// Finds the contacts that slide too far.
pub(super) fn sliding<const S: usize, const N: usize>(model: &Model<S, N>, state: &StepState<S, N>) -> Vec<Warning> {
    let mut found = Vec::new();
    for (number, (contact, built)) in model.contacts.iter().zip(&state.contacts).enumerate() {
        let (mut left_out, mut scale, mut length) = (0.0, 0.0, 0.0);
        for (part, rows) in contact.parts.iter().zip(built) {
            let points = closed(model, contact, part, rows, state);
            let Some(first) = points.first() else { continue };
            if points.iter().all(|p| (p.normal - first.normal).norm() < PLANE) {
                continue;
            }
            let size: f64 = points.iter().map(|p| p.ds).sum();
            let level = points.iter().map(|p| p.ds * p.gives_way).sum::<f64>() / size;
            scale += points.iter().map(|p| p.ds * (p.gap.abs() + (p.gives_way - level).abs())).sum::<f64>();
            left_out += second_order(part, state, &points);
            length += size;
        }
        let rounding = ROUNDING * (model.size + model.center.norm()) * length;
        if left_out > (POOR * scale).max(rounding) {
            found.push(Warning::Sliding { of: Subject::contact(model, number), error: left_out / scale });
        }
    }
    found
}

/// Samples the points that carry pressure, from some of the closed segments; none for Nitsche's method.
fn closed<const S: usize, const N: usize>(
    model: &Model<S, N>,
    contact: &ContactModel<S, N>,
    part: &ContactPart<S, N>,
    rows: &ContactRows<S, N>,
    state: &StepState<S, N>,
) -> Vec<Closed<N>> {
    let (s, frames) = (&rows.segments, &rows.frames);
    let active: Vec<bool> = match &part.multiplier {
        // a segment carries pressure if all functions active on it are closed
        Some(psi) => {
            let mut ids = Vec::new();
            (0..s.num_pieces())
                .map(|piece| {
                    psi.active(s.slave[piece], &mut ids);
                    ids.iter().all(|&j| state.active[part.first_row + j])
                })
                .collect()
        }
        None => return Vec::new(),
    };
    let pieces: Vec<usize> = (0..s.num_pieces()).filter(|&piece| active[piece]).collect();
    let mut found = Vec::new();
    for &piece in pieces.iter().step_by(pieces.len().div_ceil(SAMPLES).max(1)) {
        let points = s.points(piece);
        let field = model.patches[part.slave.patch].field;
        let own = on_trace(&part.slave.trace, field, &state.u, s.slave[piece], &s.slave_xi[points.clone()]);
        let other = match &part.against {
            Opposing::Side(master, _) => on_trace(&master.trace, master.field, &state.u, s.master[piece], &s.master_xi[points.clone()]),
            // the gap is measured from the present position of the obstacle
            Opposing::Rigid(..) => vec![[0.0; 3]; points.len()],
        };
        for (k, q) in points.enumerate() {
            let (x, normal) = (frames.x[q], frames.normal[q]);
            let vector = |v: &[f64; 3]| Vector::<N>::from_fn(|c, _| v[c]);
            let wanted = contact.wanted(&x, state.t, frames.gap[q], part.closes);
            let (shift, gives_way) = (vector(&own[k]) - vector(&other[k]), vector(&other[k]).dot(&normal));
            found.push(Closed { x, normal, gap: wanted, shift, gives_way, ds: s.ds[q] });
        }
    }
    found
}

/// ∫ |d| ds over points; points that slide beyond the edge of the master are left out, and so is what the contact closes as a matter of facets.
fn second_order<const S: usize, const N: usize>(part: &ContactPart<S, N>, state: &StepState<S, N>, points: &[Closed<N>]) -> f64 {
    let size = |d: f64| if d.abs() <= part.closes { 0.0 } else { d.abs() };
    match &part.against {
        Opposing::Side(master, _) => {
            let surface = ClosestPoint::new(master.trace.oriented());
            let mut table = MapTable::new();
            let mut gap = |x: &Vector<N>, normal: &Vector<N>| {
                let foot = surface.project_opposed(x, &-normal, 0.0).filter(|f| !f.rim)?;
                master.trace.space.map(foot.element, &[foot.xi], Order::Gradients, &mut table);
                Some((x - foot.x).dot(&master.trace.normal(foot.element, &table.jacobian[0])))
            };
            // the gap along a normal of the slave is not that of the closest point: only the change by the shift counts
            points
                .iter()
                .filter_map(|p| Some(p.ds * size(gap(&(p.x + p.shift), &p.normal)? - gap(&p.x, &p.normal)? - p.shift.dot(&p.normal))))
                .sum()
        }
        Opposing::Rigid(obstacle, ..) => {
            let target = obstacle.target(state.t, Some(&state.u));
            let gap = |x: &Vector<N>, normal: &Vector<N>| opposed(&*target, x, &-normal).map(|hit| hit.gap);
            let moved =
                |p: &Closed<N>| Some(p.ds * size(gap(&(p.x + p.shift), &p.normal)? - gap(&p.x, &p.normal)? - p.shift.dot(&p.normal)));
            // level sets given by the case may have no value there
            points.iter().filter_map(moved).filter(|d| d.is_finite()).sum()
        }
    }
}
