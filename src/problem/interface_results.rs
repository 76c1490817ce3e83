//! Results of ties and contacts: forces between the bodies, and how well they meet.

use super::integrate::on_trace;
use super::model::{ContactModel, Model, TieModel};
use super::resultant::Resultant;
use super::state::StepState;
use super::tie_field::TieField;
use crate::basis::Order;
use crate::contact::{Contact, Transmitted};
use crate::geometry::{Geometry, MapTable};
use crate::linalg::Vector;

/// Force that a tie transmits, and jump of the unknown across it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TieResult {
    /// Force on the slave body \[force\], of conduction the flux into it; missing components are zero.
    pub force: [f64; 3],
    /// Moment of it about the origin, about x, y, z [force length]; zero in conduction.
    pub moment: [f64; 3],
    /// L2 norm of the multiplier over the tied part of the slave sides, [force/area] times the root of an area.
    pub multiplier: f64,
    /// L2 norm of u_slave - u_master over the tied part of the slave sides, \[length\] times the root of an area.
    pub jump: f64,
    /// Largest |u_slave - u_master| at a point of integration \[length\].
    pub largest_jump: f64,
    /// Area of the slave sides that is tied; of the pieces of integration.
    pub area: f64,
    /// Largest distance of tied points at rest \[length\].
    pub distance: f64,
    /// The largest [consistency error](crate::coupling::consistency) of the slave sides; zero where the rows are not mortar rows.
    pub consistency: f64,
}

/// Pressure and gap of a contact, and the force that it transmits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactResult<const N: usize> {
    /// Force on the slave body \[force\].
    pub force: Vector<N>,
    /// Moment of it about the origin, about x, y, z [force length].
    pub moment: [f64; 3],
    /// Area of the slave side under pressure.
    pub area: f64,
    /// Largest pressure [force/area]; -inf where nothing is faced.
    pub largest_pressure: f64,
    /// Least gap of a row \[length\]; inf where nothing is faced.
    pub least_gap: f64,
    /// Number of closed rows.
    pub active: usize,
}

impl<const S: usize, const N: usize> TieModel<S, N> {
    /// Its result in a state.
    pub fn result(&self, model: &Model<S, N>, state: &StepState<S, N>) -> TieResult {
        let (mut result, mut pull, mut squares) = (TieResult::default(), Resultant::default(), 0.0);
        let mut map = MapTable::new();
        for part in &self.parts {
            let (space, field) = (&part.slave.trace.space, TieField::of(model, part, state.t));
            for (k, pairing) in part.pairings.iter().enumerate() {
                let s = &pairing.segments;
                let lambda = field.on_segments(model, part, state, k);
                for values in &lambda {
                    squares += s.ds.iter().zip(values).map(|(ds, v)| ds * v.powi(2)).sum::<f64>();
                }
                for piece in 0..s.num_pieces() {
                    let points = s.points(piece);
                    space.map(s.slave[piece], &s.slave_xi[points.clone()], Order::Values, &mut map);
                    for (x, q) in map.x.iter().zip(points) {
                        let force: [f64; 3] = std::array::from_fn(|c| lambda.get(c).map_or(0.0, |values| -values[q]));
                        pull.add(x, &force, s.ds[q]);
                    }
                }
                result.area += s.measure();
                result.distance = result.distance.max(s.report.distance);
            }
        }
        (result.force, result.multiplier) = (pull.force, squares.sqrt());
        if model.components > 1 {
            result.moment = pull.moment;
        }
        (result.jump, result.largest_jump) = self.jumps(model, &state.u);
        result.consistency = self.consistency(state);
        result
    }

    /// The L2 norm of u_slave - u_master over its segments, and its largest size at their points.
    pub(super) fn jumps(&self, model: &Model<S, N>, u: &[f64]) -> (f64, f64) {
        let (mut sum, mut largest) = (0.0, 0.0_f64);
        for part in &self.parts {
            for pairing in &part.pairings {
                let (s, [slave, master]) = (&pairing.segments, [&part.slave, &pairing.master]);
                let [of_slave, of_master] = [slave, master].map(|side| model.patches[side.patch].field);
                for piece in 0..s.num_pieces() {
                    let points = s.points(piece);
                    let own = on_trace(&slave.trace, of_slave, u, s.slave[piece], &s.slave_xi[points.clone()]);
                    let other = on_trace(&master.trace, of_master, u, s.master[piece], &s.master_xi[points.clone()]);
                    for (k, q) in points.enumerate() {
                        let square = (0..3).map(|c| (own[k][c] - other[k][c]).powi(2)).sum::<f64>();
                        sum += s.ds[q] * square;
                        largest = largest.max(square);
                    }
                }
            }
        }
        (sum.sqrt(), largest.sqrt())
    }
}

impl<const S: usize, const N: usize> ContactModel<S, N> {
    /// Its result in a state, `built` at the time of the state.
    pub(super) fn result(&self, model: &Model<S, N>, built: &[Contact<S, N>], state: &StepState<S, N>) -> ContactResult<N> {
        let mut sum = ContactResult {
            force: Vector::zeros(),
            moment: [0.0; 3],
            area: 0.0,
            largest_pressure: f64::NEG_INFINITY,
            least_gap: self.least_gap(model, built, &state.u),
            active: 0,
        };
        for (part, rows) in self.parts.iter().zip(built) {
            let sent: Transmitted<N> = part.transmitted(rows, &state.lambda[part.rows()]);
            sum.force += sent.force;
            (0..3).for_each(|k| sum.moment[k] += sent.moment[k]);
            sum.area += sent.area;
            sum.largest_pressure = sum.largest_pressure.max(sent.largest_pressure);
            sum.active += part.rows().filter(|&j| state.active[j]).count();
        }
        sum
    }
}
