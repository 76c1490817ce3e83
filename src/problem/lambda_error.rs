//! Errors of lambda against the exact solution.

use super::data::Point;
use super::model::{BodySide, ContactModel, Model, TieModel};
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

/// The exact traction on the slave's side at a point of it with the outward `normal`, from the side's own piece of the solution; NaN
/// where it is open which one that is.
fn exact_traction<const S: usize, const N: usize>(
    model: &Model<S, N>,
    own: &OwnSide<'_, S, N>,
    slave: &BodySide<S, N>,
    t: f64,
    element: usize,
    [x, normal]: [&Vector<N>; 2],
) -> [f64; 3] {
    let patch = &model.patches[slave.patch_of(element)];
    let (Some(exact), physics) = (patch.exact.as_deref(), patch.physics_at(t)) else { return [0.0; 3] };
    let found = physics.own_traction(exact, t, x, [normal, &-normal], own.depths(element, 0.0));
    found.unwrap_or([f64::NAN; 3])
}

impl<const S: usize, const N: usize> TieModel<S, N> {
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
                    let mut wanted = vec![0.0; model.components];
                    for (k, q) in points.enumerate() {
                        if let Some(list) = &self.exact {
                            let at = Point::new(x[k].as_slice()).at_time(state.t);
                            wanted.iter_mut().zip(list).for_each(|(w, f)| *w = f.value(&at));
                        } else {
                            let traction = exact_traction(model, &own, &part.slave, state.t, s.slave[piece], [&x[k], &normals[k]]);
                            wanted.iter_mut().zip(traction).for_each(|(w, traction)| *w = -traction);
                        }
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
                    let wanted = if let Some(f) = &self.exact {
                        f.value(&Point::new(x[k].as_slice()).at_time(state.t))
                    } else {
                        let traction = exact_traction(model, &own, &part.slave, state.t, s.slave[piece], [&x[k], &normals[k]]);
                        traction.iter().zip(normals[k].iter()).map(|(t, n)| t * n).sum()
                    };
                    sum.error += s.ds[q] * (-pressure[q] - wanted).powi(2);
                    sum.exact += s.ds[q] * wanted.powi(2);
                }
            });
        }
        sum
    }
}
