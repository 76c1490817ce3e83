//! Pressures that are rounding: where nothing presses, multipliers are sums of forces that cancel.
//!
//! Forces of the size E |u| h, E the larger modulus, |u| the largest displacement of the bodies, h the least diameter of a facet of the slave, are
//! added up to zero; what is left of them over an area h² is ε E |u| / h, times the number of terms.

use super::model::{BodySide, ContactModel, ContactPart, Model, TieModel};
use super::state::StepState;
use crate::contact::ContactRows;
use crate::geometry::{Bounds, Geometry};

/// Number of terms of a sum that cancels.
const TERMS: f64 = 100.0;

impl<const S: usize, const N: usize> TieModel<S, N> {
    /// Traction of which at most this much is rounding [force/area].
    pub(super) fn rounding_traction(&self, model: &Model<S, N>, state: &StepState<S, N>) -> f64 {
        let masters = self.parts.iter().flat_map(|part| part.pairings.iter().map(|pairing| &*pairing.master));
        rounding(model, state, (self.parts.iter().map(|part| &*part.slave).collect(), masters.collect()))
    }
}

impl<const S: usize, const N: usize> ContactModel<S, N> {
    /// Pressure of which at most this much is rounding [force/area].
    pub(super) fn rounding_pressure(&self, model: &Model<S, N>, state: &StepState<S, N>) -> f64 {
        let masters = self.parts.iter().flat_map(|part| part.masters.iter().map(|side| &**side));
        rounding(model, state, (self.parts.iter().map(|part| &*part.slave).collect(), masters.collect()))
    }

    /// Whether a pressure in a state is more than rounding, `built` at the time of the state.
    pub(super) fn presses(&self, model: &Model<S, N>, built: &[ContactRows<S, N>], state: &StepState<S, N>) -> bool {
        let rounding = self.rounding_pressure(model, state);
        let largest =
            |(part, rows): (&ContactPart<S, N>, &ContactRows<S, N>)| part.transmitted(rows, &state.lambda[part.rows()]).largest_pressure;
        self.parts.iter().zip(built).map(largest).any(|pressure| pressure > rounding)
    }
}

/// Rounding of the tractions between sides, slaves and masters.
fn rounding<const S: usize, const N: usize>(
    model: &Model<S, N>,
    state: &StepState<S, N>,
    (slaves, masters): (Vec<&BodySide<S, N>>, Vec<&BodySide<S, N>>),
) -> f64 {
    let sides = || masters.iter().chain(&slaves);
    let middle = |bounds: Option<Bounds<N>>| bounds.map_or(model.center, |b| b.center());
    let modulus = sides().map(|side| model.patches[side.patch].physics_at(state.t).modulus(&middle(side.trace.space.extent())));
    let moved = sides().flat_map(|side| &state.u[model.patches[side.patch].range()]).fold(0.0_f64, |m, u| m.max(u.abs()));
    let facets = slaves.iter().flat_map(|slave| slave.trace.space.all_bounds());
    let least = facets.map(|b| b.diagonal()).fold(f64::INFINITY, f64::min);
    TERMS * f64::EPSILON * modulus.fold(0.0, f64::max) * moved / least
}
