//! Parts of slave elements that merged integration of contacts across gaps loses, or covers twice.

use super::warning::{Subject, Warning};
use crate::basis::Order;
use crate::geometry::{MapTable, cell};
use crate::problem::model::Model;

/// Finds the contacts whose segments report such elements.
pub(super) fn lost_parts<const S: usize, const N: usize>(model: &Model<S, N>) -> Vec<Warning> {
    let of = |k: usize| {
        let parts = &model.contacts[k].parts;
        let lost = || parts.iter().flat_map(|part| part.first.segments.report.lost.iter().map(move |&element| (part, element)));
        let (part, element) = lost().next()?;
        let space = &part.slave.trace.space;
        let mut table = MapTable::new();
        space.map(element, &[cell::center(space.cell(element))], Order::Values, &mut table);
        let x = std::array::from_fn(|c| if c < N { table.x[0][c] } else { 0.0 });
        Some(Warning::LostParts { of: Subject::contact(model, k), elements: lost().count(), x })
    };
    (0..model.contacts.len()).filter_map(of).collect()
}
