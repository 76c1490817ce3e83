//! Rows of all curved sides that slide, ties and contacts as one system, and the initial guess of the closed contacts.

use super::guess::Guess;
use super::model::Model;
use super::state::{StepError, StepState};
use crate::constraint::RowKind;
use crate::contact::ContactRows;
use crate::coupling::Rows;
use crate::linalg::Triplets;

/// Gaps at rest below this part of the lengths that they come from are rounding.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

/// C, B, g and kinds of all rows in all unknowns.
#[derive(Debug)]
pub(super) struct InterfaceSystem<const S: usize, const N: usize> {
    pub(super) rows: Rows,
    pub(super) reaction: Option<Rows>,
    pub(super) offset: Vec<f64>,
    pub(super) kind: Vec<RowKind>,
    pub(super) start: Vec<bool>,
    /// Rows whose multiplier functions share an element of the slave side, one list per element.
    pub(super) elements: Vec<Vec<usize>>,
    pub(super) contacts: Vec<Vec<ContactRows<S, N>>>,
}

pub(super) fn empty(rows: usize, unknowns: usize) -> Rows {
    Rows { slave: Triplets::new(rows, unknowns), master: Triplets::new(rows, unknowns) }
}

pub(super) fn append(sum: &mut Rows, part: &Rows, first: usize) {
    sum.slave.append_below(&part.slave, first);
    sum.master.append_below(&part.master, first);
}

impl<const S: usize, const N: usize> InterfaceSystem<S, N> {
    /// Builds the rows at time `t`.
    ///
    /// `before`: step whose active rows are the initial guess; `place`: unknowns with the displacements of force-driven obstacles (`None`:
    /// zero).
    pub(super) fn of(model: &Model<S, N>, t: f64, before: Option<&StepState<S, N>>, place: Option<&[f64]>) -> Result<Self, StepError> {
        let m = model.rows;
        let mut rows = empty(m, model.unknowns);
        let (mut reaction, mut differs) = (empty(m, model.unknowns), false);
        let (mut offset, mut kind) = (vec![0.0; m], vec![RowKind::Equal; m]);
        let (mut guess, mut elements) = (Guess::new(model, t, before), Vec::new());
        for part in &model.slides {
            rows.slave.append_below(&part.rows, part.first_row);
            reaction.slave.append_below(&part.rows, part.first_row);
        }
        for part in model.ties.iter().flat_map(|tie| &tie.parts) {
            append(&mut rows, &part.rows, part.first_row);
            append(&mut reaction, part.reaction.as_ref().unwrap_or(&part.rows), part.first_row);
            differs |= part.reaction.is_some();
        }
        let rounding = ROUNDING * (model.size + model.center.norm());
        let mut contacts = Vec::with_capacity(model.contacts.len());
        for contact in &model.contacts {
            let mut parts = Vec::with_capacity(contact.parts.len());
            for part in &contact.parts {
                let built = contact.at_place(model, part, t, place)?;
                let transformed = built.transformed(&built.rows);
                append(&mut rows, &transformed, part.first_row);
                let pulls = built.reaction.as_ref().map(|b| built.transformed(b));
                append(&mut reaction, pulls.as_ref().unwrap_or(&transformed), part.first_row);
                differs |= built.reaction.is_some();
                let (own, weights) = (built.transformed_offset(), built.transformed_weights());
                for (j, (&g, k)) in own.iter().zip(built.kinds()).enumerate() {
                    let row = part.first_row + j;
                    // sides that touch: what rounding leaves of their gap is none
                    let g = if g.abs() <= rounding * weights[j].abs() { 0.0 } else { g };
                    (offset[row], kind[row]) = (g, k);
                    guess.take(contact, row, k, g, weights[j]);
                }
                if let Some(psi) = &part.multiplier {
                    elements.extend((0..psi.num_elements()).map(|e| {
                        let mut functions = Vec::new();
                        psi.active(e, &mut functions);
                        functions.iter().map(|j| part.first_row + j).collect()
                    }));
                }
                parts.push(built);
            }
            contacts.push(parts);
        }
        guess.close_nearest(&rows);
        let (start, reaction) = (guess.closed, differs.then_some(reaction));
        Ok(Self { rows, reaction, offset, kind, start, elements, contacts })
    }
}
