//! Parts of slave elements that merged integration of contacts across gaps loses, or covers twice.
//!
//! Such a part is told only where it may be pressed: where the gap at rest is at most what the largest displacements of both bodies close.

use super::warning::{Subject, Warning};
use crate::basis::Order;
use crate::geometry::{ClosestPoint, MapTable, cell, unit_normal};
use crate::linalg::{Matrix, Vector};
use crate::problem::model::{ContactModel, ContactPart, Model, Opposing};
use crate::problem::state::StepState;
use std::sync::Arc;

/// Points per direction of an element at which gaps are taken.
const SAMPLES: usize = 5;

/// Finds the contacts whose segments report such elements.
pub(super) fn lost_parts<const S: usize, const N: usize>(model: &Model<S, N>, state: &StepState<S, N>) -> Vec<Warning> {
    let of = |k: usize| {
        let contact = &model.contacts[k];
        let lost: Vec<Vector<N>> = contact.parts.iter().flat_map(|part| places(model, contact, part, state)).collect();
        let x = std::array::from_fn(|c| lost.first().map_or(0.0, |x| if c < N { x[c] } else { 0.0 }));
        (!lost.is_empty()).then(|| Warning::LostParts { of: Subject::contact(model, k), elements: lost.len(), x })
    };
    (0..model.contacts.len()).filter_map(of).collect()
}

/// The middles of elements that lose a part and may be pressed.
fn places<const S: usize, const N: usize>(
    model: &Model<S, N>,
    contact: &ContactModel<S, N>,
    part: &ContactPart<S, N>,
    state: &StepState<S, N>,
) -> Vec<Vector<N>> {
    let lost = &part.first.segments.report.lost;
    if lost.is_empty() {
        return Vec::new();
    }
    let Opposing::Side(master, _) = &part.against else { return Vec::new() };
    let (slave, closest) = (&part.slave.trace, ClosestPoint::new(Arc::clone(&master.trace.space)));
    let largest = |patch: usize| state.u[model.patches[patch].range()].iter().fold(0.0_f64, |m, u| m.max(u.abs())) * (N as f64).sqrt();
    let closes = largest(part.slave.patch) + part.masters.iter().map(|m| largest(m.patch)).fold(0.0, f64::max);
    let mut table = MapTable::new();
    let mut found = Vec::new();
    for &element in lost {
        let kind = slave.space.cell(element);
        let mut points = cell::grid::<S, f64>(kind, SAMPLES);
        points.push(cell::center(kind));
        slave.space.map(element, &points, Order::Gradients, &mut table);
        let gap = |(x, jacobian): (&Vector<N>, &Matrix<N, S>)| {
            let normal = unit_normal(jacobian, slave.outward[element]);
            let hit = closest.project(x)?;
            let distance = hit.distance * (hit.x - x).dot(&normal).signum();
            Some(contact.wanted(x, state.t, distance, part.closes))
        };
        let least = table.x.iter().zip(&table.jacobian).filter_map(gap).fold(f64::INFINITY, f64::min);
        if least <= closes {
            found.push(table.x[points.len() - 1]);
        }
    }
    found
}
