//! Fields along the slave sides of ties in the plane.

use super::arc_length::ArcLength;
use super::integrate::on_trace;
use super::side_field::{Field, SideField, SidePoint, centres, degree, normals};
use super::solved::State;
use super::tie_field::{TieField, component_rows, multiplier_at};
use crate::basis::Order;
use crate::contact::Surface;
use crate::geometry::{ClosestPoint, Geometry, MapTable, Projection};
use crate::linalg::Vector;
use std::cmp::Ordering;
use std::sync::Arc;

type Plane = Arc<dyn State<1, 2>>;

/// Fields along a slave side of a tie, by the numbers of both.
pub(super) fn tie_along(state: &Plane, [t, p]: [usize; 2]) -> SideField {
    let part = &state.model().ties[t].parts[p];
    let lambda = |sign: f64| -> Field<1> {
        let state = Arc::clone(state);
        let field = TieField::of(state.model(), &state.model().ties[t].parts[p], state.state().t);
        Box::new(move |element, xi| {
            let (model, solved) = (state.model(), state.state());
            let per_component = field.at(model, &model.ties[t].parts[p], solved, element, xi);
            (0..xi.len()).flat_map(|q| per_component.iter().map(move |v| sign * v[q]).collect::<Vec<_>>()).collect()
        })
    };
    let nearest: Box<dyn crate::contact::Obstacle<1, 2>> = Box::new(Surface::new(&part.pairings[0].master.trace, None));
    SideField {
        lambda: lambda(1.0),
        gap: Box::new(jumps(state, [t, p])),
        active: Box::new(|_, xi| vec![1.0; xi.len()]),
        traction: lambda(-1.0),
        normal: normals(&part.slave, nearest),
        degree: part.multipliers.iter().map(|m| degree(&**m)).max().unwrap_or_else(|| degree(&*part.slave.trace.space)),
        points: if part.multipliers.is_empty() { without_rows(state, [t, p]) } else { by_functions(state, [t, p]) },
    }
}

/// Returns the jump u_slave - u_master of a tie as a function of points of a slave element; in elasticity its component along the master's
/// outward normal, positive when open. Zero at points that no master faces.
fn jumps(state: &Plane, [t, p]: [usize; 2]) -> impl Fn(usize, &[Vector<1>]) -> Vec<f64> + Send + Sync + use<> {
    let state = Arc::clone(state);
    let surfaces: Vec<Surface> =
        state.model().ties[t].parts[p].pairings.iter().map(|pairing| Surface::new(&pairing.master.trace, None)).collect();
    move |element, xi| {
        let (model, u) = (state.model(), &state.state().u);
        let part = &model.ties[t].parts[p];
        let mut map = MapTable::new();
        part.slave.trace.space.map(element, xi, Order::Values, &mut map);
        let own = on_trace(&part.slave.trace, model.patches[part.slave.patch].field, u, element, xi);
        map.x
            .iter()
            .zip(own)
            .map(|(x, own)| {
                let hits = surfaces.iter().zip(&part.pairings).filter_map(|(s, pairing)| Some((s.closest(x)?, &pairing.master)));
                let nearest = hits.min_by(|(a, _), (b, _)| a.gap.abs().total_cmp(&b.gap.abs()));
                let Some((hit, master)) = nearest else { return 0.0 };
                let Some(at) = hit.at else { return 0.0 };
                let other = on_trace(&master.trace, model.patches[master.patch].field, u, at.element, &[at.xi])[0];
                match model.components {
                    1 => own[0] - other[0],
                    _ => (0..2).map(|k| (own[k] - other[k]) * hit.normal[k]).sum(),
                }
            })
            .collect()
    }
}

/// One point per function of a tie.
fn by_functions(state: &Plane, [t, p]: [usize; 2]) -> Vec<SidePoint> {
    let part = &state.model().ties[t].parts[p];
    let rows = component_rows(part);
    // components may have different functions at the ends: one point per function of the one with most
    let richest = (0..rows.len()).max_by_key(|&c| rows[c].len()).unwrap_or(0);
    let jump = jumps(state, [t, p]);
    let slave = ClosestPoint::new(&*part.slave.trace.space);
    let arc = ArcLength::new(&*part.slave.trace.space);
    let gap_at = |x: &Vector<2>| {
        let found = slave.project(x)?;
        jump(found.element, &[found.xi]).first().copied()
    };
    centres(&part.slave, &*part.multipliers[richest], Some(&arc))
        .into_iter()
        .enumerate()
        .map(|(j, (s, x))| {
            let lambda = if rows.iter().all(|r| r.len() == rows[richest].len()) {
                rows.iter().map(|r| state.state().lambda[r.start + j]).collect()
            } else {
                at_centre(state, [t, p], slave.project(&x))
            };
            SidePoint { s, x, lambda, gap: gap_at(&x), active: true }
        })
        .collect()
}

/// One point per point of the segments of a tie without multiplier, along the slave.
fn without_rows(state: &Plane, [t, p]: [usize; 2]) -> Vec<SidePoint> {
    let (model, solved) = (state.model(), state.state());
    let part = &model.ties[t].parts[p];
    let arc = ArcLength::new(&*part.slave.trace.space);
    let (field, jump) = (TieField::of(model, part, solved.t), jumps(state, [t, p]));
    let (mut rows, mut map) = (Vec::new(), MapTable::new());
    for (k, segments) in part.pairings.iter().map(|pairing| &pairing.segments).enumerate() {
        let lambda = field.on_segments(model, part, solved, k);
        for piece in 0..segments.num_pieces() {
            let (element, points) = (segments.slave[piece], segments.points(piece));
            let xi = &segments.slave_xi[points.clone()];
            part.slave.trace.space.map(element, xi, Order::Values, &mut map);
            for (i, gap) in jump(element, xi).into_iter().enumerate() {
                rows.push(SidePoint {
                    s: Some(arc.of(element, xi[i][0])),
                    x: map.x[i],
                    lambda: lambda.iter().map(|values| values[points.start + i]).collect(),
                    gap: Some(gap),
                    active: true,
                });
            }
        }
    }
    rows.sort_by(|a, b| a.s.partial_cmp(&b.s).unwrap_or(Ordering::Equal));
    rows
}

/// The multipliers of all components at a point of the slave, for components with different functions.
fn at_centre(state: &Plane, [t, p]: [usize; 2], at: Option<Projection<1, 2>>) -> Vec<f64> {
    let part = &state.model().ties[t].parts[p];
    let Some(found) = at else { return vec![0.0; part.multipliers.len()] };
    let lambda = &state.state().lambda;
    let values = part.multipliers.iter().zip(component_rows(part));
    values.map(|(psi, rows)| multiplier_at(&**psi, &lambda[rows], found.element, &[found.xi])[0]).collect()
}
