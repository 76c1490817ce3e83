//! The rows of all ties and contacts as one system, and the first guess of which contacts are closed.

use super::solve::{NO_CONTACT, StepError, StepState};
use crate::app::build::{ContactModel, Model};
use crate::constraint::RowKind;
use crate::contact::Contact;
use crate::coupling::Rows;
use crate::io::case::Start;
use crate::linalg::Triplets;

/// Gaps below this share of the lengths they come from count as zero where a start looks at gaps.
const ZERO: f64 = 1e-12;

/// C, B, g and kinds of all rows in all unknowns.
pub(super) struct System<const S: usize, const N: usize> {
    pub(super) rows: Rows,
    pub(super) reaction: Option<Rows>,
    pub(super) offset: Vec<f64>,
    pub(super) kind: Vec<RowKind>,
    pub(super) start: Vec<bool>,
    /// Rows of points that start closed whatever their gap is.
    pub(super) eased: Vec<bool>,
    pub(super) contacts: Vec<Vec<Contact<S, N>>>,
}

pub(super) fn empty(rows: usize, unknowns: usize) -> Rows {
    Rows { slave: Triplets::new(rows, unknowns), master: Triplets::new(rows, unknowns) }
}

fn append(sum: &mut Rows, part: &Rows, first: usize) {
    sum.slave.append_below(&part.slave, first);
    sum.master.append_below(&part.master, first);
}

impl<const S: usize, const N: usize> System<S, N> {
    /// `before`: the step whose active rows are the first guess.
    ///
    /// `place`: unknowns that say where obstacles are that forces press; none: at rest.
    pub(super) fn of(model: &Model<S, N>, t: f64, before: Option<&StepState<S, N>>, place: Option<&[f64]>) -> Result<Self, StepError> {
        let m = model.rows;
        let mut rows = empty(m, model.unknowns);
        let (mut reaction, mut differs) = (empty(m, model.unknowns), false);
        let (mut offset, mut kind, mut start) = (vec![0.0; m], vec![RowKind::Equal; m], vec![true; m]);
        for part in model.ties.iter().flat_map(|tie| &tie.parts) {
            append(&mut rows, &part.rows, part.first_row);
            append(&mut reaction, part.reaction.as_ref().unwrap_or(&part.rows), part.first_row);
            differs |= part.reaction.is_some();
        }
        let mut eased = vec![false; m];
        let mut contacts = Vec::with_capacity(model.contacts.len());
        for contact in &model.contacts {
            let mut parts = Vec::with_capacity(contact.parts.len());
            for part in &contact.parts {
                let built = contact.at_place(model, part, t, place)?;
                let turned = built.turned(&built.rows);
                append(&mut rows, &turned, part.first_row);
                let pulls = built.reaction.as_ref().map(|b| built.turned(b));
                append(&mut reaction, pulls.as_ref().unwrap_or(&turned), part.first_row);
                differs |= built.reaction.is_some();
                let (own, weights) = (built.turned_offset(), built.turned_weights());
                for (j, (&g, k)) in own.iter().zip(built.kinds()).enumerate() {
                    offset[part.first_row + j] = g;
                    kind[part.first_row + j] = k;
                    let row = part.first_row + j;
                    // rows that faced nothing say nothing
                    let known = before.filter(|b| b.sign_case[row] != NO_CONTACT);
                    start[row] = known.map_or_else(|| starts_active(model, contact, (g, weights[j]), j, part.first_row), |b| b.active[row]);
                }
                eased[part.rows()].fill(built.points.is_some() && contact.start == Start::All && before.is_none());
                parts.push(built);
            }
            contacts.push(parts);
        }
        Ok(Self { rows, reaction: differs.then_some(reaction), offset, kind, start, eased, contacts })
    }
}

fn starts_active<const S: usize, const N: usize>(
    model: &Model<S, N>,
    contact: &ContactModel<S, N>,
    (offset, weight): (f64, f64),
    j: usize,
    first: usize,
) -> bool {
    match contact.start {
        Start::All => true,
        Start::None => false,
        // bodies that touch have gaps of round-off: zero within a share of the lengths the gaps come from
        Start::Gap => offset <= ZERO * model.size.max(model.center.norm()) * weight.abs(),
        Start::Seed(seed) => {
            // SplitMix64 of seed and row: the same on every machine
            let mut z = seed.wrapping_add((first + j + 1) as u64).wrapping_mul(0x9E37_79B9_7F4A_7C15);
            z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
            z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
            (z ^ (z >> 31)) & 1 == 1
        }
    }
}
