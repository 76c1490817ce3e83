//! Fields along the slave sides of contacts.

use super::arc_length::ArcLength;
use super::contact_field::PressureEvaluator;
use super::exact_lambda::exact_along;
use super::side_field::{Field, SideField, SidePoint, centres, degree, normals};
use super::solved::State;
use super::tie_field::multiplier_at;
use crate::contact::Obstacle;
use crate::linalg::Vector;
use std::cmp::Ordering;
use std::sync::Arc;

/// Fields along a slave side of a contact, by the numbers of both; `faced` is what it faces, `arc` the arc length along a curve.
pub(super) fn contact_along<const S: usize, const N: usize>(
    state: &Arc<dyn State<S, N>>,
    [c, p]: [usize; 2],
    faced: &dyn Fn() -> Box<dyn Obstacle<S, N>>,
    arc: Option<&ArcLength<'_, N>>,
) -> SideField<S, N> {
    let part = &state.model().contacts[c].parts[p];
    let facing = normals(&part.slave, faced());
    let (degree, ([lambda, gap, active, push], points)) = match &part.multiplier {
        Some(psi) => (degree(&**psi), by_functions(state, [c, p], arc)),
        None => (degree(&*part.slave.trace.space), by_points(state, [c, p], arc)),
    };
    let traction = move |e: usize, xi: &[Vector<S>]| -> Vec<f64> {
        let lambda = push(e, xi);
        facing(e, xi).iter().enumerate().map(|(k, n)| -lambda[k / N] * n).collect()
    };
    let exact = exact_along(state, state.model().contacts[c].id.into(), p);
    SideField { lambda, gap, active, traction: Box::new(traction), normal: normals(&part.slave, faced()), exact, degree, points }
}

/// lambda, gap, status and lambda again, and the rows of the table.
type Shown<const S: usize, const N: usize> = ([Field<S>; 4], Vec<SidePoint<N>>);

/// Fields of a contact with multiplier functions, and one point per function.
fn by_functions<const S: usize, const N: usize>(
    state: &Arc<dyn State<S, N>>,
    [c, p]: [usize; 2],
    arc: Option<&ArcLength<'_, N>>,
) -> Shown<S, N> {
    let (model, solved) = (state.model(), state.state());
    let part = &model.contacts[c].parts[p];
    let rows = part.rows();
    let gaps = part.gaps(model, &solved.contacts[c][p], &solved.u);
    let field = |coefficients: Vec<f64>| -> Field<S> {
        let state = Arc::clone(state);
        Box::new(move |element, xi| {
            let read = state.model().contacts[c].parts[p].read_through();
            read.map_or_else(Vec::new, |read| multiplier_at(read, &coefficients, element, xi))
        })
    };
    let lambda: Vec<f64> = solved.lambda[rows.clone()].to_vec();
    let shown = field(rows.clone().map(|j| f64::from(u8::from(solved.active[j]))).collect());
    let active: Field<S> = Box::new(move |e, xi| shown(e, xi).iter().map(|v| f64::from(u8::from(*v > 0.5))).collect());
    let fields = [field(lambda.clone()), field(gaps.iter().map(|g| g.unwrap_or(0.0)).collect()), active, field(lambda.clone())];
    let centres = part.multiplier.as_ref().map_or_else(Vec::new, |psi| centres(&part.slave, &**psi, arc)).into_iter().enumerate();
    let point = |(j, (s, x))| SidePoint { s, x, lambda: vec![lambda[j]], gap: gaps[j], active: solved.active[rows.start + j] };
    (fields, centres.map(point).collect())
}

/// Fields of a contact without multiplier, and one point per point of the segments, of curves along the slave.
fn by_points<const S: usize, const N: usize>(
    state: &Arc<dyn State<S, N>>,
    [c, p]: [usize; 2],
    arc: Option<&ArcLength<'_, N>>,
) -> Shown<S, N> {
    let (model, solved) = (state.model(), state.state());
    let part = &model.contacts[c].parts[p];
    let field = |of: fn([f64; 2]) -> f64| -> Field<S> {
        let state = Arc::clone(state);
        let field = PressureEvaluator::of(model, &model.contacts[c], part, solved.t);
        Box::new(move |element, xi| {
            let contact = &state.model().contacts[c];
            field.at(state.model(), contact, &contact.parts[p], state.state(), element, xi).into_iter().map(of).collect()
        })
    };
    let (lambda, gap) = (|[l, _]: [f64; 2]| l, |[_, g]: [f64; 2]| g);
    let fields = [field(lambda), field(gap), field(|[l, _]| f64::from(u8::from(l < 0.0))), field(lambda)];
    let (built, first) = (&solved.contacts[c][p], part.first_row);
    let gaps = part.gaps(model, built, &solved.u);
    let segments = &built.segments;
    let rows_of_points = built.row_of_points().unwrap_or_default();
    let mut rows: Vec<SidePoint<N>> = Vec::new();
    for piece in 0..segments.num_pieces() {
        for q in segments.points(piece) {
            let j = rows_of_points[q];
            rows.push(SidePoint {
                s: arc.map(|arc| arc.of(segments.slave[piece], segments.slave_xi[q][0])),
                x: built.frames.x[q],
                lambda: vec![solved.lambda[first + j]],
                gap: gaps[j],
                active: solved.active[first + j],
            });
        }
    }
    rows.sort_by(|a, b| a.s.partial_cmp(&b.s).unwrap_or(Ordering::Equal));
    (fields, rows)
}
