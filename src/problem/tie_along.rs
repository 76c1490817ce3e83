//! Fields along the slave sides of ties.

use super::arc_length::ArcLength;
use super::exact_lambda::exact_along;
use super::integrate::on_trace;
use super::model::{BodySide, TiePart};
use super::side_field::{Field, SideField, SidePoint, centres, degree};
use super::solved::State;
use super::tie_field::{TractionEvaluator, component_rows, multiplier_at};
use crate::basis::Order;
use crate::geometry::{ClosestPoint, Geometry, MapTable, Projection};
use crate::linalg::Vector;
use crate::space::Space;
use std::cmp::Ordering;
use std::sync::Arc;

/// Fields along a slave side of a tie, by the numbers of both; `arc` the arc length along a curve.
pub(super) fn tie_along<const S: usize, const N: usize>(
    state: &Arc<dyn State<S, N>>,
    [t, p]: [usize; 2],
    arc: Option<&ArcLength<'_, N>>,
) -> SideField<S, N> {
    let part = &state.model().ties[t].parts[p];
    let lambda = |sign: f64| -> Field<S> {
        let state = Arc::clone(state);
        let field = TractionEvaluator::of(state.model(), &state.model().ties[t].parts[p], state.state().t);
        Box::new(move |element, xi| {
            let (model, solved) = (state.model(), state.state());
            let per_component = field.at(model, &model.ties[t].parts[p], solved, element, xi);
            (0..xi.len()).flat_map(|q| per_component.iter().map(move |v| sign * v[q]).collect::<Vec<_>>()).collect()
        })
    };
    SideField {
        lambda: lambda(1.0),
        gap: Box::new(jumps(state, [t, p])),
        active: Box::new(|_, xi| vec![1.0; xi.len()]),
        traction: lambda(-1.0),
        normal: normals(state, [t, p]),
        exact: exact_along(state, state.model().ties[t].id.into(), p),
        degree: part.multipliers.iter().map(|m| degree(&**m)).max().unwrap_or_else(|| degree(&*part.slave.trace.space)),
        points: if part.multipliers.is_empty() { without_rows(state, [t, p], arc) } else { by_functions(state, [t, p], arc) },
    }
}

/// The search for the closest point of all masters of a tied part.
struct Masters<const S: usize, const N: usize>(Vec<ClosestPoint<S, N, Arc<dyn Space<S, N>>>>);

impl<const S: usize, const N: usize> Masters<S, N> {
    fn of(part: &TiePart<S, N>) -> Self {
        Self(part.pairings.iter().map(|pairing| ClosestPoint::new(Arc::clone(&pairing.master.trace.space))).collect())
    }

    /// The closest point to `x`, with its master and the unit normal out of that; `None` beyond the rim of all masters.
    fn facing<'a>(&self, part: &'a TiePart<S, N>, x: &Vector<N>) -> Option<(&'a BodySide<S, N>, Projection<S, N>, Vector<N>)> {
        let feet = self.0.iter().zip(&part.pairings).filter_map(|(search, pairing)| Some((&pairing.master, search.project(x)?)));
        let inside = feet.filter(|(_, foot)| !foot.rim);
        let (master, foot) = inside.min_by(|(_, a), (_, b)| a.distance.total_cmp(&b.distance))?;
        let mut map = MapTable::new();
        let normal = master.trace.normals(foot.element, &[foot.xi], &mut map)[0];
        Some((master, foot, normal))
    }
}

/// Returns the jump u_slave - u_master of a tie as a function of points of a slave element; in elasticity its component along the master's
/// outward normal, positive when open. Zero at points that no master faces.
fn jumps<const S: usize, const N: usize>(
    state: &Arc<dyn State<S, N>>,
    [t, p]: [usize; 2],
) -> impl Fn(usize, &[Vector<S>]) -> Vec<f64> + Send + Sync + use<S, N> {
    let (state, masters) = (Arc::clone(state), Masters::of(&state.model().ties[t].parts[p]));
    move |element, xi| {
        let (model, u) = (state.model(), &state.state().u);
        let part = &model.ties[t].parts[p];
        let mut map = MapTable::new();
        part.slave.trace.space.map(element, xi, Order::Values, &mut map);
        let own = on_trace(&part.slave.trace, model.patches[part.slave.patch].field, u, element, xi);
        let jump = |(x, own): (&Vector<N>, [f64; 3])| {
            let Some((master, foot, normal)) = masters.facing(part, x) else { return 0.0 };
            let other = on_trace(&master.trace, model.patches[master.patch].field, u, foot.element, &[foot.xi])[0];
            match model.components {
                1 => own[0] - other[0],
                _ => (0..N).map(|k| (own[k] - other[k]) * normal[k]).sum(),
            }
        };
        map.x.iter().zip(own).map(jump).collect()
    }
}

/// The normal of the master that faces each point of a slave element; minus that of the slave where none does.
fn normals<const S: usize, const N: usize>(state: &Arc<dyn State<S, N>>, [t, p]: [usize; 2]) -> Field<S> {
    let (state, masters) = (Arc::clone(state), Masters::of(&state.model().ties[t].parts[p]));
    Box::new(move |element, xi| {
        let part = &state.model().ties[t].parts[p];
        let mut map = MapTable::new();
        let own = part.slave.trace.normals(element, xi, &mut map);
        let normal = |(x, own): (&Vector<N>, &Vector<N>)| masters.facing(part, x).map_or(-own, |(_, _, normal)| normal);
        map.x.iter().zip(&own).flat_map(|at| normal(at).into_iter().copied().collect::<Vec<_>>()).collect()
    })
}

/// One point per function of a tie.
fn by_functions<const S: usize, const N: usize>(
    state: &Arc<dyn State<S, N>>,
    [t, p]: [usize; 2],
    arc: Option<&ArcLength<'_, N>>,
) -> Vec<SidePoint<N>> {
    let part = &state.model().ties[t].parts[p];
    let rows = component_rows(part);
    // components whose functions differ, as those that are lowered at other ends, have other centres, be their number the same
    let all: Vec<Vec<(Option<f64>, Vector<N>)>> = part.multipliers.iter().map(|psi| centres(&part.slave, &**psi, arc)).collect();
    let alike = all.windows(2).all(|pair| pair[0] == pair[1]);
    let jump = jumps(state, [t, p]);
    let slave = ClosestPoint::new(&*part.slave.trace.space);
    let gap_at = |x: &Vector<N>| {
        let found = slave.project(x)?;
        jump(found.element, &[found.xi]).first().copied()
    };
    // one point per function of the component with most
    let richest = all.into_iter().max_by_key(Vec::len).unwrap_or_default();
    let point = |(j, (s, x)): (usize, (Option<f64>, Vector<N>))| {
        let lambda = match alike {
            true => rows.iter().map(|r| state.state().lambda[r.start + j]).collect(),
            false => at_centre(state, [t, p], slave.project(&x)),
        };
        SidePoint { s, x, lambda, gap: gap_at(&x), active: true }
    };
    richest.into_iter().enumerate().map(point).collect()
}

/// One point per point of the segments of a tie without multiplier, of curves along the slave.
fn without_rows<const S: usize, const N: usize>(
    state: &Arc<dyn State<S, N>>,
    [t, p]: [usize; 2],
    arc: Option<&ArcLength<'_, N>>,
) -> Vec<SidePoint<N>> {
    let (model, solved) = (state.model(), state.state());
    let part = &model.ties[t].parts[p];
    let (field, jump) = (TractionEvaluator::of(model, part, solved.t), jumps(state, [t, p]));
    let (mut rows, mut map) = (Vec::new(), MapTable::new());
    for (k, segments) in part.pairings.iter().map(|pairing| &pairing.segments).enumerate() {
        let lambda = field.on_segments(model, part, solved, k);
        for piece in 0..segments.num_pieces() {
            let (element, points) = (segments.slave[piece], segments.points(piece));
            let xi = &segments.slave_xi[points.clone()];
            part.slave.trace.space.map(element, xi, Order::Values, &mut map);
            for (i, gap) in jump(element, xi).into_iter().enumerate() {
                rows.push(SidePoint {
                    s: arc.map(|arc| arc.of(element, xi[i][0])),
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
fn at_centre<const S: usize, const N: usize>(state: &Arc<dyn State<S, N>>, [t, p]: [usize; 2], at: Option<Projection<S, N>>) -> Vec<f64> {
    let part = &state.model().ties[t].parts[p];
    let Some(found) = at else { return vec![0.0; part.multipliers.len()] };
    let lambda = &state.state().lambda;
    let values = part.multipliers.iter().zip(component_rows(part));
    values.map(|(psi, rows)| multiplier_at(&**psi, &lambda[rows], found.element, &[found.xi])[0]).collect()
}
