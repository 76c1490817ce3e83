//! Points of contacts that are closed, and rigid motions that they leave.

use super::model::{ContactPart, Model};
use super::state::StepState;
use super::supports::{free_motions, motion_texts};
use crate::contact::ContactRows;

/// Rigid motions that the closed contacts of a solution leave, a sentence per body; `None` without any, and without contacts.
pub fn remaining_motions<const S: usize, const N: usize>(model: &Model<S, N>, state: &StepState<S, N>) -> Option<Vec<String>> {
    if model.contacts.is_empty() {
        return None;
    }
    let contacts: Vec<Vec<_>> = state.contacts.iter().map(|c| c.iter().collect()).collect();
    let closed = closed_points(model, &contacts, &|row| state.active[row]);
    let free = free_motions(model, state.t, &contacts, &|k, p, q| closed[k][p][q]);
    (!free.is_empty()).then(|| motion_texts(model, &free))
}

/// Returns one flag per point of `contacts`: whether a function active there has a closed row.
pub fn closed_points<const S: usize, const N: usize>(
    model: &Model<S, N>,
    contacts: &[Vec<&ContactRows<S, N>>],
    closed: &dyn Fn(usize) -> bool,
) -> Vec<Vec<Vec<bool>>> {
    let mut ids = Vec::new();
    let mut of_part = |p: &ContactPart<S, N>, contact: &ContactRows<S, N>| {
        let s = &contact.segments;
        if let Some(row) = contact.row_of_points() {
            return row.iter().map(|j| closed(p.first_row + j)).collect();
        }
        let mut flags = vec![false; s.ds.len()];
        for piece in 0..s.num_pieces() {
            let Some(psi) = &p.multiplier else { continue };
            psi.active(s.slave[piece], &mut ids);
            let any = ids.iter().any(|j| closed(p.first_row + j));
            s.points(piece).for_each(|q| flags[q] = any);
        }
        flags
    };
    model.contacts.iter().zip(contacts).map(|(c, built)| c.parts.iter().zip(built).map(|(p, b)| of_part(p, b)).collect()).collect()
}

/// Functions of a slave side that face the opponent, each with whether it is closed; `None` of the others. Where rows belong to points they
/// are the elements of these.
pub fn zone_functions<const S: usize, const N: usize>(
    part: &ContactPart<S, N>,
    contact: &ContactRows<S, N>,
    closed: &dyn Fn(usize) -> bool,
) -> Vec<Option<bool>> {
    if let Some(row) = contact.row_of_points() {
        let s = &contact.segments;
        let mut elements = vec![None; part.slave.trace.space.num_elements()];
        for piece in 0..s.num_pieces() {
            let any = s.points(piece).any(|q| row.get(q).is_some_and(|j| closed(part.first_row + j)));
            *elements[s.slave[piece]].get_or_insert(false) |= any;
        }
        return elements;
    }
    contact.facing.iter().enumerate().map(|(j, &facing)| facing.then(|| closed(part.first_row + j))).collect()
}
