//! Numbers of ties and contacts by which their accuracy is judged.

use super::model::{ContactModel, ContactPart, Model, TieModel, TiePart};
use super::state::StepState;
use crate::contact::ContactRows;

/// Sizes of lambda below this multiple of its rounding count as it: what is left of a defect that is rounding, too, is no doubt.
const ABOVE_ROUNDING: f64 = 1e6;

impl<const S: usize, const N: usize> TieModel<S, N> {
    /// The largest [consistency error](crate::coupling::consistency) of its slave sides; zero where its rows are no mortar rows.
    pub fn consistency(&self, model: &Model<S, N>, state: &StepState<S, N>) -> f64 {
        let least = ABOVE_ROUNDING * self.rounding_traction(model, state);
        let of = |part: &TiePart<S, N>| {
            let lambda = &state.lambda[part.first_row..part.first_row + part.num_rows];
            let of_rows = part
                .finer
                .as_ref()
                .map(|f| f.estimate([&part.rows, part.reaction.as_ref().unwrap_or(&part.rows)], None, &state.u, lambda, least));
            of_rows.or_else(|| Some(part.finer_stiffness.as_ref()?.estimate(&part.stiffness, &state.u, least)))
        };
        self.parts.iter().filter_map(of).fold(0.0, f64::max)
    }
}

impl<const S: usize, const N: usize> ContactModel<S, N> {
    /// The largest [consistency error](crate::coupling::consistency) of its slave sides, `built` at the time of the state; zero against
    /// obstacles. Where rows belong to points, that of the mean pressures of elements.
    pub fn consistency(&self, model: &Model<S, N>, built: &[ContactRows<S, N>], state: &StepState<S, N>) -> f64 {
        let least = ABOVE_ROUNDING * self.rounding_pressure(model, state);
        let of = |(part, rows): (&ContactPart<S, N>, &ContactRows<S, N>)| {
            let (lambda, closed) = (&state.lambda[part.rows()], &state.active[part.rows()]);
            let finer = part.finer.as_ref()?;
            let Some(own) = &part.by_elements else {
                let reaction = rows.reaction.as_ref().unwrap_or(&rows.rows);
                return Some(finer.estimate([&rows.rows, reaction], Some(closed), &state.u, lambda, least));
            };
            let means = part.mean_pressures(rows, lambda);
            Some(finer.estimate([own, own], Some(&vec![false; means.len()]), &state.u, &means, least))
        };
        self.parts.iter().zip(built).filter_map(of).fold(0.0, f64::max)
    }

    /// The least gap of a row \[length\], `built` at the time of `u`; inf where nothing is faced.
    pub fn least_gap(&self, model: &Model<S, N>, built: &[ContactRows<S, N>], u: &[f64]) -> f64 {
        let parts = self.parts.iter().zip(built);
        parts.flat_map(|(part, rows)| part.gaps(model, rows, u)).flatten().fold(f64::INFINITY, f64::min)
    }
}

impl<const S: usize, const N: usize> ContactPart<S, N> {
    /// The mean multiplier of every element of the slave [force/area], of rows that belong to points; zero without points.
    fn mean_pressures(&self, rows: &ContactRows<S, N>, lambda: &[f64]) -> Vec<f64> {
        let (s, row) = (&rows.segments, rows.row_of_points().unwrap_or_default());
        let mut sums = vec![[0.0; 2]; self.slave.trace.space.num_elements()];
        for piece in 0..s.num_pieces() {
            let [area, force] = &mut sums[s.slave[piece]];
            for q in s.points(piece) {
                *area += s.ds[q];
                *force += s.ds[q] * row.get(q).map_or(0.0, |&j| lambda[j]);
            }
        }
        sums.iter().map(|[area, force]| if *area > 0.0 { force / area } else { 0.0 }).collect()
    }
}
