//! Errors of lambda against the exact one.

use super::data::Point;
use super::model::{BodySide, ContactModel, Model, TieModel};
use super::own_piece::Depths;
use super::own_side::OwnSide;
use super::state::StepState;
use super::tie_field::TractionEvaluator;
use crate::basis::Order;
use crate::contact::ContactRows;
use crate::coupling::Segments;
use crate::geometry::MapTable;
use crate::linalg::Vector;

/// Squares of the L2 norms of an error and of the exact field.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SquaredError {
    /// ∫ |lambda - lambda*|² ds.
    pub error: f64,
    /// ∫ |lambda*|² ds.
    pub exact: f64,
}

/// Calls `visit(piece, points, outward normals of the slave)` for the pieces of a slave side.
fn each_piece<const S: usize, const N: usize>(
    slave: &BodySide<S, N>,
    segments: &Segments<S>,
    mut visit: impl FnMut(usize, &[Vector<N>], &[Vector<N>]),
) {
    let (mut map, mut normals) = (MapTable::new(), Vec::new());
    for piece in 0..segments.num_pieces() {
        let element = segments.slave[piece];
        slave.trace.space.map(element, &segments.slave_xi[segments.points(piece)], Order::Gradients, &mut map);
        normals.clear();
        normals.extend(map.jacobian.iter().map(|j| slave.trace.normal(element, j)));
        visit(piece, &map.x, &normals);
    }
}

/// The exact traction on the slave's side at a point of an element with the outward `normal`, from the side's own piece of the solution;
/// NaN where it is open which one that is.
fn exact_traction<const S: usize, const N: usize>(
    model: &Model<S, N>,
    slave: &BodySide<S, N>,
    t: f64,
    (element, depths): (usize, Depths),
    [x, normal]: [&Vector<N>; 2],
) -> [f64; 3] {
    let patch = &model.patches[slave.patch_of(element)];
    let (Some(exact), physics) = (patch.exact.as_deref(), patch.physics_at(t)) else { return [0.0; 3] };
    let found = physics.own_traction(exact, t, x, [normal, &-normal], depths);
    found.unwrap_or([f64::NAN; 3])
}

impl<const S: usize, const N: usize> TieModel<S, N> {
    /// lambda at a point of a slave element with the outward normal there: the tie's exact data, or else minus the traction of the exact
    /// solution of the model.
    pub(super) fn exact_at(
        &self,
        model: &Model<S, N>,
        slave: &BodySide<S, N>,
        t: f64,
        place: (usize, Depths),
        [x, normal]: [&Vector<N>; 2],
    ) -> Vec<f64> {
        if let Some(list) = &self.exact {
            let at = Point::new(x.as_slice()).at_time(t);
            return list.iter().take(model.components).map(|f| f.value(&at)).collect();
        }
        exact_traction(model, slave, t, place, [x, normal]).into_iter().take(model.components).map(|traction| -traction).collect()
    }

    /// The error of lambda against its exact data, or else against the exact solution of the model; NaN if it is open which piece of that a
    /// slave side has.
    pub fn lambda_error(&self, model: &Model<S, N>, state: &StepState<S, N>) -> SquaredError {
        let mut sum = SquaredError::default();
        for part in &self.parts {
            let own = OwnSide::new(model, &part.slave);
            let lambda = TractionEvaluator::of(model, part, state.t);
            for (pairing, s) in part.pairings.iter().map(|p| &p.segments).enumerate() {
                let found = lambda.on_segments(model, part, state, pairing);
                each_piece(&part.slave, s, |piece, x, normals| {
                    let points = s.points(piece);
                    for (k, q) in points.enumerate() {
                        let place = (s.slave[piece], own.depths(s.slave[piece], 0.0));
                        let wanted = self.exact_at(model, &part.slave, state.t, place, [&x[k], &normals[k]]);
                        for (c, w) in wanted.iter().enumerate() {
                            sum.error += s.ds[q] * (found[c][q] - w).powi(2);
                            sum.exact += s.ds[q] * w.powi(2);
                        }
                    }
                });
            }
        }
        sum
    }
}

impl<const S: usize, const N: usize> ContactModel<S, N> {
    /// lambda at a point of a slave element with the outward normal there: the contact's exact data, or else the normal part of the traction
    /// of the exact solution of the model.
    pub(super) fn exact_at(
        &self,
        model: &Model<S, N>,
        slave: &BodySide<S, N>,
        t: f64,
        place: (usize, Depths),
        [x, normal]: [&Vector<N>; 2],
    ) -> f64 {
        match &self.exact {
            Some(f) => f.value(&Point::new(x.as_slice()).at_time(t)),
            None => exact_traction(model, slave, t, place, [x, normal]).iter().zip(normal.iter()).map(|(t, n)| t * n).sum(),
        }
    }

    /// The error of the pressure against its exact data, or else against the exact solution of the model, `built` at the time of the state;
    /// NaN if it is open which piece of that a slave side has.
    pub fn lambda_error(&self, model: &Model<S, N>, built: &[ContactRows<S, N>], state: &StepState<S, N>) -> SquaredError {
        let mut sum = SquaredError::default();
        for (part, rows) in self.parts.iter().zip(built) {
            let s = &rows.segments;
            let pressure = part.transmitted(rows, &state.lambda[part.rows()]).pressure;
            let own = OwnSide::new(model, &part.slave);
            each_piece(&part.slave, s, |piece, x, normals| {
                let points = s.points(piece);
                for (k, q) in points.enumerate() {
                    let place = (s.slave[piece], own.depths(s.slave[piece], 0.0));
                    let wanted = self.exact_at(model, &part.slave, state.t, place, [&x[k], &normals[k]]);
                    sum.error += s.ds[q] * (-pressure[q] - wanted).powi(2);
                    sum.exact += s.ds[q] * wanted.powi(2);
                }
            });
        }
        sum
    }
}
