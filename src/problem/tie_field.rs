//! lambda of a tie at any point of its slave side: that of its multiplier, or where it has none, that of the fluxes by its coupling.

use super::model::{Model, Pairing, TiePart};
use super::state::StepState;
use super::tie_fluxes::Fluxes;
use crate::basis::{Basis, Order, ShapeTable};
use crate::coupling::Segments;
use crate::geometry::{ClosestPoint, Geometry, MapTable};
use crate::linalg::Vector;
use crate::space::Space;
use std::sync::Arc;

/// lambda of a tied part at a time, as a function of the state.
#[derive(Debug)]
pub struct TractionEvaluator<const S: usize, const N: usize>(Option<WithoutRows<S, N>>);

/// Fluxes at the time, and the search for partners on the masters.
#[derive(Debug)]
struct WithoutRows<const S: usize, const N: usize> {
    fluxes: Arc<Fluxes<S, N>>,
    masters: Vec<ClosestPoint<S, N, Arc<dyn Space<S, N>>>>,
}

impl<const S: usize, const N: usize> TractionEvaluator<S, N> {
    /// Creates the evaluator of `part` at time `t`.
    pub fn of(model: &Model<S, N>, part: &TiePart<S, N>, t: f64) -> Self {
        let closest = |p: &Pairing<S, N>| ClosestPoint::new(Arc::clone(&p.master.trace.space));
        let without = || WithoutRows { fluxes: part.fluxes(model, t), masters: part.pairings.iter().map(closest).collect() };
        Self(part.multipliers.is_empty().then(without))
    }

    /// lambda at the points of the segments with master `k`: `[component][point]`.
    pub fn on_segments(&self, model: &Model<S, N>, part: &TiePart<S, N>, state: &StepState<S, N>, k: usize) -> Vec<Vec<f64>> {
        if let Some(own) = &self.0 {
            return part.numerical_flux(model, k, &own.fluxes, None, &state.u);
        }
        let (s, rows) = (&part.pairings[k].segments, component_rows(part));
        let on_piece = |c: usize, piece: usize| {
            let xi = &s.slave_xi[s.points(piece)];
            multiplier_at(&*part.multipliers[c], &state.lambda[rows[c].clone()], s.slave[piece], xi)
        };
        (0..rows.len()).map(|c| (0..s.num_pieces()).flat_map(|piece| on_piece(c, piece)).collect()).collect()
    }

    /// lambda at local points of a slave element: `[component][point]`.
    pub fn at(
        &self,
        model: &Model<S, N>,
        part: &TiePart<S, N>,
        state: &StepState<S, N>,
        element: usize,
        xi: &[Vector<S>],
    ) -> Vec<Vec<f64>> {
        let Some(own) = &self.0 else {
            let rows = component_rows(part);
            let of = |c: usize| multiplier_at(&*part.multipliers[c], &state.lambda[rows[c].clone()], element, xi);
            return (0..rows.len()).map(of).collect();
        };
        let mut map = MapTable::new();
        part.slave.trace.space.map(element, xi, Order::Values, &mut map);
        // the partner of a point is the nearest point of the nearest master
        let mut all = vec![vec![f64::NAN; xi.len()]; model.components];
        let mut asked: Vec<(Segments<S>, Vec<usize>)> = part.pairings.iter().map(|_| (Segments::new(), Vec::new())).collect();
        for (q, x) in map.x.iter().enumerate() {
            let feet = own.masters.iter().enumerate().filter_map(|(k, m)| Some((k, m.project(x)?)));
            let Some((k, foot)) = feet.min_by(|a, b| a.1.distance.total_cmp(&b.1.distance)) else { continue };
            asked[k].0.push_piece(element, foot.element, [(xi[q], foot.xi, 0.0)]);
            asked[k].1.push(q);
        }
        for (k, (segments, points)) in asked.iter().enumerate().filter(|(_, (_, points))| !points.is_empty()) {
            let found = part.numerical_flux(model, k, &own.fluxes, Some(segments), &state.u);
            for (all, found) in all.iter_mut().zip(&found) {
                points.iter().zip(found).for_each(|(&q, &v)| all[q] = v);
            }
        }
        all
    }
}

/// A multiplier at local points of an element.
pub fn multiplier_at<const S: usize>(basis: &dyn Basis<S>, lambda: &[f64], element: usize, xi: &[Vector<S>]) -> Vec<f64> {
    let (mut ids, mut table) = (Vec::new(), ShapeTable::new());
    basis.active(element, &mut ids);
    basis.tabulate(element, xi, Order::Values, &mut table);
    (0..xi.len()).map(|q| ids.iter().zip(table.values(q)).map(|(&j, v)| lambda[j] * v).sum()).collect()
}

/// The rows of each component of a tied part.
pub fn component_rows<const S: usize, const N: usize>(part: &TiePart<S, N>) -> Vec<std::ops::Range<usize>> {
    let mut first = part.first_row;
    part.multipliers
        .iter()
        .map(|m| {
            let range = first..first + m.num_functions();
            first = range.end;
            range
        })
        .collect()
}
