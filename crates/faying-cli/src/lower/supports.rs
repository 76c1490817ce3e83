//! Rigid motions that are left when every contact is closed.

use super::lower_context::LowerContext;
use super::lowered_case::LoweredCase;
use super::warned::tell;
use faying::problem::Warning;

/// E051 for every body that can still move with all points of ties held and all contacts closed; E024 where multipliers hold less than
/// points.
pub fn check<const S: usize, const N: usize>(context: &mut LowerContext<'_, S, N>, built: &LoweredCase<S, N>, found: &[Warning]) {
    let motions = built.system.rigid_motions();
    if motions.is_empty() {
        return tell(context, &built.places, found.iter().filter(|w| matches!(w, Warning::TooFewFunctions { .. })));
    }
    for motion in motions {
        let sentence = motion.sentence;
        let text = if context.case.contacts.is_empty() { sentence } else { format!("{sentence}, even with every contact closed") };
        let help = match built.places.patch(motion.of) {
            None => "leave the component out of `force`: the obstacle is held there then; or support the body that it presses on",
            Some(_) => "prescribe what is left by [[boundary]], or tie the body to one that is supported",
        };
        let fault = context.error("E051", text, built.places.at(motion.of)).with_help(help);
        context.faults.push(fault);
    }
}
