//! Warning E065 if too few functions of the slave carry a contact for its force and its zone to be right.
//!
//! The end of a zone lies anywhere within an element, the end of its functions does not: with n functions across it, force and width are off
//! by about 1/n of themselves. Zones that are all of what faces the opponent end with the side and are not looked at.

use crate::case::Case;
use crate::errors::Diagnostic;
use faying::problem::{Model, StepState, zone_functions};

/// Least number of functions across a zone.
const FEWEST: usize = 4;

/// Returns at most one warning per contact.
pub fn warnings<const S: usize, const N: usize>(case: &Case, model: &Model<S, N>, state: &StepState<S, N>) -> Vec<Diagnostic> {
    let mut found = Vec::new();
    for ((contact, built), block) in model.contacts.iter().zip(&state.contacts).zip(&case.contacts) {
        let (mut closed, mut facing) = (0, 0);
        for (part, rows) in contact.parts.iter().zip(built) {
            let (own, all) = zone_functions(part, rows, &|row| state.active[row]);
            closed += own;
            facing += all;
        }
        // a half model has half of the zone, in one direction
        let least = FEWEST.pow(S as u32) / if contact.symmetry { 2 } else { 1 };
        if closed == 0 || closed >= least || closed == facing {
            continue;
        }
        let text = format!(
            "the zone of contact \"{}\" is too coarse: {closed} functions of the slave carry it, fewer than {least}; its force, pressure and \
             extent may be off by tens of percent",
            contact.name
        );
        let help = "give the slave side smaller elements where it touches (elements, grade, refine)";
        found.push(Diagnostic::warning("E065", text).at(&case.source, block.head.at).with_help(help));
    }
    found
}
