//! Contact rows that prescribed values hold closed beyond zero: no pressure moves what they consist of.

use super::model::{Condition, Model};
use super::rigid::short;
use super::state::StepError;
use super::system::InterfaceSystem;
use crate::constraint::RowKind;
use crate::coupling::Rows;
use std::collections::HashSet;

/// Rows whose free coefficients sum up to less than this share of all of them have none.
const NONE: f64 = 1e-12;
/// Depths below this fraction of the model's size are rounding.
const ROUNDING: f64 = 1e-9;

/// Sums of the absolute coefficients of every row.
fn sizes(rows: &Rows, count: usize) -> Vec<f64> {
    let mut sums = vec![0.0; count];
    rows.slave.entries.iter().chain(&rows.master.entries).for_each(|&(i, _, value)| sums[i] += value.abs());
    sums
}

/// The deepest overlap in a row without free unknowns; `free` and `offset`: the rows of `interface` in free unknowns. None of methods
/// without multipliers: their points have other rows beside them.
pub(super) fn blocked<const S: usize, const N: usize>(
    model: &Model<S, N>,
    interface: &InterfaceSystem<S, N>,
    free: &Rows,
    offset: &[f64],
) -> Option<StepError> {
    let (all, free) = (sizes(&interface.rows, model.rows), sizes(free, model.rows));
    let mut deepest: Option<(usize, usize, usize, f64)> = None;
    for (k, (contact, built)) in model.contacts.iter().zip(&interface.contacts).enumerate() {
        for (part, rows) in contact.parts.iter().zip(built).filter(|(part, _)| part.multiplier.is_some()) {
            for (row, weight) in part.rows().zip(rows.transformed_weights()) {
                let stuck = interface.kind[row] == RowKind::Contact && free[row] <= NONE * all[row] && weight > 0.0;
                let depth = if stuck { -offset[row] / weight } else { 0.0 };
                if depth > deepest.map_or(ROUNDING * (model.size + model.center.norm()), |d| d.3) {
                    deepest = Some((k, part.number, row, depth));
                }
            }
        }
    }
    let (k, slave, row, depth) = deepest?;
    let rows = &interface.rows;
    let mine = rows.slave.entries.iter().chain(&rows.master.entries).filter(|e| e.0 == row);
    let unknowns: HashSet<usize> = mine.map(|e| model.glued.unknown(e.1)).collect();
    let holds = |c: &&Condition<S, N>| {
        c.side.trace.dofs.iter().any(|&dof| unknowns.contains(&model.glued.unknown(c.side.field.unknown(dof, c.component))))
    };
    let mut of: Vec<_> = model.conditions.iter().filter(holds).map(|c| c.of).collect();
    of.sort_unstable();
    of.dedup();
    let contact = &model.contacts[k];
    let faced = if contact.obstacle.is_some() { "the obstacle" } else { "the master" };
    let named = model.contact_rows(&[row]).pop()?;
    let near = named.place.map_or(String::new(), |x| {
        let at: Vec<String> = x.iter().map(|x| short(*x, model.size)).collect();
        format!(", near ({})", at.join(", "))
    });
    let (side, deep) = (&named.slave, short(depth, 0.0));
    let what = format!("prescribed values hold `{side}` {deep} deep in {faced} of contact \"{}\"{near}", contact.name);
    Some(StepError::Blocked { contact: contact.id, slave, of, what })
}
