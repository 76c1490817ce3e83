//! Numbers of ties and contacts by which their accuracy is judged.

use super::model::{ContactModel, ContactPart, Model, TieModel, TiePart};
use super::state::StepState;
use crate::contact::ContactRows;

impl<const S: usize, const N: usize> TieModel<S, N> {
    /// The largest [consistency error](crate::coupling::consistency) of its slave sides; zero where its rows are no mortar rows.
    pub fn consistency(&self, state: &StepState<S, N>) -> f64 {
        let of = |part: &TiePart<S, N>| {
            let lambda = &state.lambda[part.first_row..part.first_row + part.num_rows];
            let of_rows = part.finer.as_ref().map(|f| f.estimate(&part.rows, part.reaction.as_ref(), None, &state.u, lambda));
            of_rows.or_else(|| Some(part.finer_stiffness.as_ref()?.estimate(&part.stiffness, &state.u)))
        };
        self.parts.iter().filter_map(of).fold(0.0, f64::max)
    }
}

impl<const S: usize, const N: usize> ContactModel<S, N> {
    /// The largest [consistency error](crate::coupling::consistency) of its slave sides, `built` at the time of the state; zero against
    /// obstacles and without multiplier.
    pub fn consistency(&self, built: &[ContactRows<S, N>], state: &StepState<S, N>) -> f64 {
        let of = |(part, rows): (&ContactPart<S, N>, &ContactRows<S, N>)| {
            let (lambda, closed) = (&state.lambda[part.rows()], &state.active[part.rows()]);
            part.finer.as_ref().map(|f| f.estimate(&rows.rows, rows.reaction.as_ref(), Some(closed), &state.u, lambda))
        };
        self.parts.iter().zip(built).filter_map(of).fold(0.0, f64::max)
    }

    /// The least gap of a row \[length\], `built` at the time of `u`; inf where nothing is faced.
    pub fn least_gap(&self, model: &Model<S, N>, built: &[ContactRows<S, N>], u: &[f64]) -> f64 {
        let parts = self.parts.iter().zip(built);
        parts.flat_map(|(part, rows)| part.gaps(model, rows, u)).flatten().fold(f64::INFINITY, f64::min)
    }
}
