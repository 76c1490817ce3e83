//! Zones that too few functions of the slave carry for their force and extent to be right.
//!
//! The end of a zone lies anywhere within an element, the end of its functions does not: with n functions across it, force and width are off
//! by about 1/n of themselves. Functions whose pressure is rounding carry nothing. Points in the opponent while no function is closed are a zone that was missed. Zones that are all
//! of what faces the opponent end with the side and are not looked at, unless the opponent ends within the functions that carry them.

use super::warning::{Subject, Warning};
use super::zone_extent::{FEWEST, ZoneExtent};
use crate::contact::ContactRows;
use crate::coupling::interface::slave_segments;
use crate::coupling::mortar::multiplier_magnitudes;
use crate::coupling::multiplier::PiecewiseConstant;
use crate::problem::closed_points::zone_functions;
use crate::problem::model::{ContactModel, ContactPart, Model};
use crate::problem::state::StepState;

/// Least number of functions across half a zone of degree 1, 2, and higher: one function decides what is in the middle.
const FEWEST_OF_HALF: [usize; 3] = [4, 3, 5];
/// Least number of functions from the axis of revolution on, of degree 1 and 2, 3, and higher: little area stands behind the pressure there.
const FEWEST_FROM_AXIS: [usize; 3] = [4, 7, 11];

/// Share of the functions of a zone, by their integrals, below which the opponent ends within them.
const COVERED: f64 = 0.9;
/// Least number of functions across a zone that ends with the opponent.
const FEWEST_TO_ITS_END: usize = 3;

/// Distance from the axis of revolution, relative to the size of the model, below which a side is on it.
const ON_AXIS: f64 = 1e-12;
/// Depth of points in the opponent, relative to the size of the model, beyond which a zone without functions was missed.
const MISSED: f64 = 1e-6;

/// Finds the contacts with such zones.
pub(super) fn coarse_zones<const S: usize, const N: usize>(model: &Model<S, N>, state: &StepState<S, N>) -> Vec<Warning> {
    let mut found = Vec::new();
    for (k, (contact, built)) in model.contacts.iter().zip(&state.contacts).enumerate() {
        let (mut closed, mut facing, mut deepest, mut extent) = (0, 0, 0.0_f64, ZoneExtent::new());
        for (part, rows) in contact.parts.iter().zip(built) {
            deepest = part.point_gaps(model, rows, &state.u).into_iter().fold(deepest, |d, gap| d.max(-gap));
            let functions = zone_functions(part, rows, &|row| state.active[row]);
            closed += functions.iter().filter(|f| **f == Some(true)).count();
            facing += functions.iter().flatten().count();
            if S > 1 {
                extent.add(part, rows, &functions);
            }
        }
        if closed > 0 && !contact.presses(model, built, state) {
            closed = 0;
        }
        let of_surface = (S > 1 && 0 < closed && closed < facing).then(|| {
            let whole = extent.across();
            if whole.is_some_and(|(n, least)| n < least as f64) { whole } else { extent.across_strips().or(whole) }
        });
        let of_surface = of_surface.flatten();
        let covered = if closed > 0 { covered(model, contact, built, state) } else { 1.0 };
        let to_its_end = (covered < COVERED).then(|| ((covered * closed as f64).powf(1.0 / S as f64), FEWEST_TO_ITS_END));
        let (across, least) = match to_its_end.filter(|(n, least)| *n < *least as f64).or(of_surface) {
            Some((n, least)) => (Some(n), least),
            None => (None, least(model, contact)),
        };
        let few = match across {
            Some(n) => n < least as f64,
            None => S == 1 && 0 < closed && closed < least && closed != facing,
        };
        // a force that presses an obstacle is carried, and none where it vanishes
        let is_pressed = contact.obstacle.as_ref().is_some_and(|obstacle| !obstacle.pressed.is_empty());
        let missed = closed == 0 && deepest > MISSED * model.size && !is_pressed;
        if missed || few {
            found.push(Warning::CoarseZone { of: Subject::contact(model, k), closed, across, least });
        }
    }
    found
}

/// The share of the closed functions of a contact, by their integrals, that faces the opponent.
fn covered<const S: usize, const N: usize>(
    model: &Model<S, N>,
    contact: &ContactModel<S, N>,
    built: &[ContactRows<S, N>],
    state: &StepState<S, N>,
) -> f64 {
    // their integrals have the weight of the radius
    if model.is_revolved() {
        return 1.0;
    }
    let [mut facing, mut all] = [0.0; 2];
    for (part, rows) in contact.parts.iter().zip(built) {
        let space = &*part.slave.trace.space;
        let constants = PiecewiseConstant::of(space);
        let psi = part.multiplier.as_deref().filter(|_| rows.row_of_points().is_none()).unwrap_or(&constants);
        let whole = multiplier_magnitudes(psi, &slave_segments(space, &part.slave.rules));
        let faced = multiplier_magnitudes(psi, &rows.segments);
        for (j, _) in zone_functions(part, rows, &|row| state.active[row]).iter().enumerate().filter(|(_, f)| **f == Some(true)) {
            facing += faced[j];
            all += whole[j];
        }
    }
    if all > 0.0 { facing / all } else { 1.0 }
}

/// The least number of functions that carry a zone well.
fn least<const S: usize, const N: usize>(model: &Model<S, N>, contact: &ContactModel<S, N>) -> usize {
    let degree = contact.parts.iter().map(|part| part.slave.degree()).max().unwrap_or(1);
    let is_on_axis = |part: &ContactPart<S, N>| part.slave.trace.space.extent().is_some_and(|b| b.lo[0] <= ON_AXIS * model.size);
    if model.is_revolved() && contact.parts.iter().any(is_on_axis) {
        FEWEST_FROM_AXIS[degree.clamp(2, 4) - 2]
    } else if contact.symmetry {
        FEWEST_OF_HALF[degree.clamp(1, 3) - 1]
    } else {
        FEWEST
    }
}
