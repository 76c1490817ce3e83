//! Fields along the slave sides of contacts in the plane.

use super::arc_length::ArcLength;
use super::contact_field::ContactField;
use super::model::Opposing;
use super::side_field::{Field, SideField, SidePoint, centres, degree, normals};
use super::solved::State;
use super::tie_field::multiplier_at;
use crate::contact::{Obstacle, Surface};
use std::sync::Arc;

type Plane = Arc<dyn State<1, 2>>;

/// Fields along a slave side of a contact, by the numbers of both.
pub(super) fn contact_along(state: &Plane, [c, p]: [usize; 2]) -> SideField {
    let part = &state.model().contacts[c].parts[p];
    let target = || -> Box<dyn Obstacle<1, 2>> {
        match &part.against {
            Opposing::Side(master, _) => Box::new(Surface::new(&master.trace, None)),
            Opposing::Rigid(obstacle, _) => obstacle.target(state.state().t, Some(&state.state().u)),
        }
    };
    let facing = normals(&part.slave, target());
    let (degree, ([lambda, gap, active, push], points)) = match &part.multiplier {
        Some(psi) => (degree(&**psi), by_functions(state, [c, p])),
        None => (degree(&*part.slave.trace.space), by_points(state, [c, p])),
    };
    let traction = move |e: usize, xi: &[crate::linalg::Vector<1>]| -> Vec<f64> {
        let lambda = push(e, xi);
        facing(e, xi).iter().enumerate().map(|(k, n)| -lambda[k / 2] * n).collect()
    };
    SideField { lambda, gap, active, traction: Box::new(traction), normal: normals(&part.slave, target()), degree, points }
}

/// lambda, gap, status and lambda again of a contact with multiplier functions, and one point per function.
fn by_functions(state: &Plane, [c, p]: [usize; 2]) -> ([Field; 4], Vec<SidePoint>) {
    let (model, solved) = (state.model(), state.state());
    let part = &model.contacts[c].parts[p];
    let rows = part.rows();
    let gaps = part.gaps(model, &solved.contacts[c][p], &solved.u);
    let field = |coefficients: Vec<f64>| -> Field {
        let state = Arc::clone(state);
        Box::new(move |element, xi| {
            let read = state.model().contacts[c].parts[p].read_through();
            read.map_or_else(Vec::new, |read| multiplier_at(read, &coefficients, element, xi))
        })
    };
    let lambda: Vec<f64> = solved.lambda[rows.clone()].to_vec();
    let shown = field(rows.clone().map(|j| f64::from(u8::from(solved.active[j]))).collect());
    let active: Field = Box::new(move |e, xi| shown(e, xi).iter().map(|v| f64::from(u8::from(*v > 0.5))).collect());
    let fields = [field(lambda.clone()), field(gaps.iter().map(|g| g.unwrap_or(0.0)).collect()), active, field(lambda.clone())];
    let centres = part.multiplier.as_ref().map_or_else(Vec::new, |psi| centres(&part.slave, &**psi)).into_iter().enumerate();
    let point = |(j, (s, x))| SidePoint { s, x, lambda: vec![lambda[j]], gap: gaps[j], active: solved.active[rows.start + j] };
    (fields, centres.map(point).collect())
}

/// lambda, gap, status and lambda again of a contact without multiplier, and one point per point of the segments, along the slave.
fn by_points(state: &Plane, [c, p]: [usize; 2]) -> ([Field; 4], Vec<SidePoint>) {
    let (model, solved) = (state.model(), state.state());
    let part = &model.contacts[c].parts[p];
    let field = |of: fn([f64; 2]) -> f64| -> Field {
        let state = Arc::clone(state);
        let field = ContactField::of(model, &model.contacts[c], part, solved.t);
        Box::new(move |element, xi| {
            let contact = &state.model().contacts[c];
            field.at(state.model(), contact, &contact.parts[p], state.state(), element, xi).into_iter().map(of).collect()
        })
    };
    let (lambda, gap) = (|[l, _]: [f64; 2]| l, |[_, g]: [f64; 2]| g);
    let fields = [field(lambda), field(gap), field(|[l, _]| f64::from(u8::from(l < 0.0))), field(lambda)];
    let (built, first) = (&solved.contacts[c][p], part.first_row);
    let gaps = part.gaps(model, built, &solved.u);
    let arc = ArcLength::new(&*part.slave.trace.space);
    let segments = &built.segments;
    let rows_of_points = built.row_of_points().unwrap_or_default();
    let mut rows: Vec<SidePoint> = Vec::new();
    for piece in 0..segments.num_pieces() {
        for q in segments.points(piece) {
            let j = rows_of_points[q];
            rows.push(SidePoint {
                s: arc.of(segments.slave[piece], segments.slave_xi[q][0]),
                x: built.frames.x[q],
                lambda: vec![solved.lambda[first + j]],
                gap: gaps[j],
                active: solved.active[first + j],
            });
        }
    }
    rows.sort_by(|a, b| a.s.total_cmp(&b.s));
    (fields, rows)
}
