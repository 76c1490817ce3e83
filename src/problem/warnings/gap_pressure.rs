//! Pressures of methods with fluxes that come from gaps and not from the stress of the bodies.
//!
//! P = sigma + γ g: where a contact is closed, g is zero in the limit, and P the stress. γ g is what the size of the elements, facets that
//! leave the surface they stand for, and rounding of the gap times γ put into P. The force, a mean, hardly knows of it; values at points do.
//!
//! Facets are waves of the height a of their sag over the length L of an element, and points see them as they are: pressed flat, a wave has
//! the pressure
//!
//! ```text
//! π E* a / L,   1/E* = 1/E_slave + 1/E_master
//! ```
//!
//! (K. L. Johnson, Contact Mechanics, Cambridge 1985, section 13.2), which is told where it is more than the same share of the pressure.
//! Multipliers of fewer functions, such as p/p-2, see its mean. Facets of both sides that coincide are no waves: a is at most what the gap of both
//! sides varies by.

use super::warning::{Subject, Warning};
use crate::geometry::{Bounds, Geometry};
use crate::problem::model::{BodySide, ContactPart, Model};
use crate::problem::state::StepState;
use crate::problem::touching::sag;
use std::f64::consts::PI;

/// Largest |γ g|, or pressure of a wave, as a share of the largest pressure, without a warning.
const LARGEST: f64 = 0.15;

/// Finds the contacts whose pressures at points are so far from the stress.
pub(super) fn gap_pressures<const S: usize, const N: usize>(model: &Model<S, N>, state: &StepState<S, N>) -> Vec<Warning> {
    let mut found = Vec::new();
    for (k, (contact, built)) in model.contacts.iter().zip(&state.contacts).enumerate() {
        if !contact.presses(model, built, state) {
            continue;
        }
        let largest = contact.parts.iter().flat_map(|part| &state.lambda[part.rows()]).fold(0.0_f64, |m, l| m.max(-l));
        let mut worst: Option<(f64, f64, f64, Vec<f64>)> = None;
        for (part, rows) in contact.parts.iter().zip(built).filter(|_| contact.method.needs().fluxes) {
            let Some(row) = rows.row_of_points() else { continue };
            let gaps = part.point_gaps(model, rows, &state.u);
            for (q, &j) in row.iter().enumerate().filter(|(_, j)| state.active[part.first_row + **j]) {
                let from_gap = gaps[q] * rows.weights[j] / rows.compliance.get(j).copied().unwrap_or(f64::INFINITY);
                if from_gap.abs() > worst.as_ref().map_or(LARGEST * largest, |w| w.0.abs()) {
                    worst = Some((from_gap, gaps[q], -state.lambda[part.first_row + j], rows.frames.x[q].as_slice().to_vec()));
                }
            }
        }
        if let Some((from_gap, gap, pressure, x)) = worst {
            found.push(Warning::GapPressure { of: Subject::contact(model, k), pressure, from_gap: -from_gap, gap, x });
        } else if largest > 0.0 {
            let has_waves = |part: &&ContactPart<S, N>| sees_waves(part) && contact.follows_sides(part, state.t, model.size);
            let waves = contact.parts.iter().filter(has_waves).map(|part| wave(model, part, state.t));
            let (wave, height) = waves.fold((0.0, 0.0), |a, b| if b.0 > a.0 { b } else { a });
            if wave > LARGEST * largest {
                found.push(Warning::WavyFacets { of: Subject::contact(model, k), height, wave, pressure: largest });
            }
        }
    }
    found
}

/// Whether lambda belongs to points, or has as many functions as a side of degree 2 and more, but for the lowered ones: these follow waves
/// within an element.
fn sees_waves<const S: usize, const N: usize>(part: &ContactPart<S, N>) -> bool {
    let Some(psi) = &part.multiplier else { return true };
    let (ends, functions) = (2 * S, part.slave.trace.space.num_functions());
    part.slave.degree() >= 2 && psi.num_functions() + ends >= functions && psi.num_functions() > part.slave.trace.space.num_elements()
}

/// Largest pressure that flattens the waves of the facets of both sides [force/area], and their height [length]; zero against obstacles, and
/// where the contact adjusts, which takes the waves for none.
fn wave<const S: usize, const N: usize>(model: &Model<S, N>, part: &ContactPart<S, N>, t: f64) -> (f64, f64) {
    if part.masters.is_empty() || part.closes > 0.0 {
        return (0.0, 0.0);
    }
    let slope = |side: &BodySide<S, N>| {
        let (sag, space) = (sag(&model.patches, side), &*side.trace.space);
        let of = |e: usize| (sag.of_facet(e) / space.bounds(e).diagonal(), sag.of_facet(e));
        (0..space.num_elements()).map(of).fold((0.0, 0.0), |a: (f64, f64), b| if b.0 > a.0 { b } else { a })
    };
    let stiffness = |side: &BodySide<S, N>| {
        let patch = &model.patches[side.patch];
        patch.physics_at(t).modulus(&side.trace.space.extent().map_or(model.center, |b: Bounds<N>| b.center()))
    };
    let soft = part.masters.iter().map(|m| 1.0 / stiffness(m)).fold(0.0, f64::max) + 1.0 / stiffness(&part.slave);
    let (slopes, heights) = part.masters.iter().map(|m| slope(m)).fold(slope(&part.slave), |a, b| (a.0 + b.0, a.1 + b.1));
    let (least, most) = part.first.frames.gap.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), &g| (a.min(g), b.max(g)));
    let seen = (most - least).clamp(0.0, heights);
    (PI * slopes / soft * if heights > 0.0 { seen / heights } else { 0.0 }, seen)
}
