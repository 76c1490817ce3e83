//! Results of ties and contacts: forces between the bodies, and how well they meet.

use super::contact_zone::{ContactZone, HalfWidth};
use super::integrate::on_trace;
use super::model::{ContactModel, Model, Opposing, TieModel};
use super::resultant::Resultant;
use super::state::{NO_CONTACT, StepState};
use super::tie_field::TractionEvaluator;
use crate::basis::Order;
use crate::contact::{ContactRows, NoHalfWidth, SideEnd};
use crate::geometry::{Geometry, MapTable};
use crate::linalg::Vector;
use std::collections::BTreeMap;

/// Distance from the axis of revolution, relative to the size of the model, below which a point is on it.
const ON_AXIS: f64 = 1e-12;
/// Displacement relative to the largest of the body below which a point does not move: rounding.
const AT_REST: f64 = 1e-12;

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
    /// The largest [consistency error](crate::coupling::consistency) of the slave sides; zero where its rows are no mortar rows.
    pub consistency: f64,
    /// Sum of the forces on both sides over the sum of their magnitudes: round-off unless the integration is mixed.
    pub balance: f64,
    /// Number of pieces of integration.
    pub pieces: usize,
    /// Largest distance of a point of integration from the cell of its master element, in local coordinates.
    pub outside: f64,
    /// Number of slave elements that the pieces do not tile though the master does not end there.
    pub lost: usize,
}

/// Pressure and gap of a contact, and the force that it transmits.
#[derive(Clone, Debug, PartialEq)]
pub struct ContactResult<const N: usize> {
    /// Force on the slave body \[force\].
    pub force: Vector<N>,
    /// Moment of it about the origin, about x, y, z [force length].
    pub moment: [f64; 3],
    /// Area of the slave side under pressure, of more than rounding.
    pub area: f64,
    /// Least pressure at a point of integration [force/area]; inf where nothing is faced.
    pub least_pressure: f64,
    /// Largest pressure [force/area]; -inf where nothing is faced.
    pub largest_pressure: f64,
    /// Least gap of a row \[length\]; inf where nothing is faced.
    pub least_gap: f64,
    /// Least gap at a point of integration \[length\]; inf where nothing is faced.
    pub least_point_gap: f64,
    /// Number of closed rows.
    pub active: usize,
    /// Violation of the conditions of contact.
    pub violation: Violation,
    /// Number of rows per sign case: lambda < 0, = 0, > 0 by gap = 0, > 0, < 0.
    pub sign_cases: [usize; 9],
    /// Number of pieces of integration, which face the opponent.
    pub pieces: usize,
    /// Largest distance of a point of integration from the cell of its master element, in local coordinates; zero against obstacles.
    pub outside: f64,
    /// Number of slave elements that the pieces do not tile though the master does not end there; zero against obstacles.
    pub lost: usize,
    /// Their measure [length^S].
    pub measure: f64,
    /// Half the extent of the zone along the slave sides \[length\], see [`crate::contact::half_width`]; `None` on surfaces.
    pub half_width: Option<Result<f64, NoHalfWidth>>,
    /// Translation of a rigid obstacle, prescribed or found \[length\]; `None` between bodies.
    pub displacement: Option<Vector<N>>,
    /// The largest [consistency error](crate::coupling::consistency) of the slave sides; zero against obstacles and without multiplier.
    pub consistency: f64,
    /// Sum of the forces on both bodies over the sum of their magnitudes: round-off unless the integration is mixed; zero against
    /// obstacles.
    pub balance: f64,
}

/// Violation of the conditions lambda <= 0, gap >= 0, lambda gap = 0 by the rows of a contact, in the variables of its cone.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Violation {
    /// Largest positive multiplier.
    pub lambda: f64,
    /// Largest negative gap, as a positive number \[length\].
    pub gap: f64,
    /// Largest |lambda gap|.
    pub product: f64,
}

impl<const S: usize, const N: usize> TieModel<S, N> {
    /// Its result in a state.
    pub fn result(&self, model: &Model<S, N>, state: &StepState<S, N>) -> TieResult {
        let (mut result, mut pull, mut squares) = (TieResult::default(), Resultant::default(), 0.0);
        let (mut map, mut balance) = (MapTable::new(), self.row_balance(model, state));
        for part in &self.parts {
            result.pieces += part.pairings.iter().map(|p| p.segments.num_pieces()).sum::<usize>();
            // forces of the added stiffness satisfy action and reaction, too
            let mut forces: BTreeMap<usize, f64> = BTreeMap::new();
            let changed = if part.changes(model) { part.stiffness_at(model, state.t).ok() } else { None };
            for &(i, j, value) in &changed.as_ref().unwrap_or(&part.stiffness).entries {
                *forces.entry(i).or_default() += value * state.u[j];
            }
            forces.iter().for_each(|(&i, &force)| balance.push(model, i, force));
            let (space, field) = (&part.slave.trace.space, TractionEvaluator::of(model, part, state.t));
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
                result.outside = result.outside.max(s.report.outside);
                result.lost += s.report.lost.len();
            }
        }
        (result.force, result.multiplier) = (pull.force, squares.sqrt());
        if model.components > 1 {
            result.moment = model.in_space(pull).moment;
        }
        (result.jump, result.largest_jump) = self.jumps(model, &state.u);
        result.consistency = self.consistency(model, state);
        result.balance = balance.defect();
        result
    }

    /// Measure of its segments [length^S].
    pub(super) fn measure(&self) -> f64 {
        self.parts.iter().flat_map(|part| &part.pairings).map(|pairing| pairing.segments.measure()).sum()
    }

    /// The root mean square of u_slave - u_master over its segments.
    pub(super) fn mean_jump(&self, model: &Model<S, N>, u: &[f64]) -> f64 {
        self.jumps(model, u).0 / self.measure().sqrt()
    }

    /// The L2 norm of u_slave - u_master over its segments, and its largest size at their points.
    fn jumps(&self, model: &Model<S, N>, u: &[f64]) -> (f64, f64) {
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
    /// Its result in a state, `built` at the time of the state; `half_width` of zones.
    pub(super) fn result(
        &self,
        model: &Model<S, N>,
        built: &[ContactRows<S, N>],
        state: &StepState<S, N>,
        half_width: HalfWidth<S, N>,
    ) -> ContactResult<N> {
        let mut sum = ContactResult {
            force: Vector::zeros(),
            moment: [0.0; 3],
            area: 0.0,
            least_pressure: f64::INFINITY,
            largest_pressure: f64::NEG_INFINITY,
            least_gap: f64::INFINITY,
            least_point_gap: f64::INFINITY,
            active: 0,
            violation: Violation::default(),
            sign_cases: [0; 9],
            pieces: 0,
            outside: 0.0,
            lost: 0,
            measure: 0.0,
            half_width: None,
            displacement: self.obstacle.as_ref().map(|o| o.displacement(state.t, Some(&state.u))),
            consistency: self.consistency(model, built, state),
            balance: self.row_balance(model, built, state).defect(),
        };
        let mut zones = Vec::new();
        let rounding = self.rounding_pressure(model, state);
        for (part, rows) in self.parts.iter().zip(built) {
            let lambda = &state.lambda[part.rows()];
            let mut sent = part.transmitted(rows, lambda);
            if sent.largest_pressure <= rounding {
                sent.area = 0.0;
                sent.closed.fill(false);
            }
            sum.force += sent.force;
            (0..3).for_each(|k| sum.moment[k] += sent.moment[k]);
            sum.area += sent.area;
            sum.least_pressure = sum.least_pressure.min(sent.least_pressure);
            sum.largest_pressure = sum.largest_pressure.max(sent.largest_pressure);
            for ((gap, &l), j) in part.gaps(model, rows, &state.u).into_iter().zip(&state.mu[part.rows()]).zip(part.rows()) {
                sum.active += usize::from(state.active[j]);
                if state.sign_case[j] < NO_CONTACT {
                    sum.sign_cases[usize::from(state.sign_case[j])] += 1;
                }
                let Some(gap) = gap else { continue };
                sum.least_gap = sum.least_gap.min(gap);
                let worst = &mut sum.violation;
                worst.lambda = worst.lambda.max(l);
                worst.gap = worst.gap.max(-gap);
                worst.product = worst.product.max((l * gap).abs());
            }
            sum.least_point_gap = part.point_gaps(model, rows, &state.u).into_iter().fold(sum.least_point_gap, f64::min);
            sum.pieces += rows.segments.num_pieces();
            sum.measure += rows.segments.measure();
            if let Opposing::Side(..) = part.against {
                sum.outside = sum.outside.max(rows.segments.report.outside);
                sum.lost += rows.segments.report.lost.len();
            }
            zones.push(ContactZone { slave: &*part.slave.trace.space, segments: model.along_curve(&rows.segments, &part.slave), sent });
        }
        sum.moment = model.in_space(Resultant { moment: sum.moment, ..Resultant::default() }).moment;
        sum.half_width = half_width(&zones, &|zone, element, xi| self.side_end(model, &state.u, (zone, element, xi)));
        sum
    }

    /// The behaviour of a zone at an end of a slave side: part, element and local coordinate. On the axis of bodies of revolution it goes on.
    fn side_end(&self, model: &Model<S, N>, u: &[f64], (part, element, xi): (usize, usize, f64)) -> SideEnd {
        let slave = &self.parts[part].slave;
        let (at, mut map) = ([Vector::<S>::repeat(xi)], MapTable::new());
        slave.trace.space.map(element, &at, Order::Gradients, &mut map);
        if self.symmetry || model.is_revolved() && map.x[0][0].abs() <= ON_AXIS * model.size {
            return SideEnd::Mirrored;
        }
        let tangent = map.jacobian[0].column(0).normalize();
        let moved = on_trace(&slave.trace, model.patches[slave.patch].field, u, element, &at)[0];
        let along = tangent.iter().zip(moved).map(|(t, u)| t * u).sum::<f64>();
        let largest = u[model.patches[slave.patch].range()].iter().fold(0.0_f64, |m, u| m.max(u.abs()));
        if along.abs() <= AT_REST * largest { SideEnd::Held } else { SideEnd::Free }
    }
}
