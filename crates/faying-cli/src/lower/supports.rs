//! Rigid motions that are left when every contact is closed.

use super::builder::Builder;
use super::built::Built;
use super::warned::tell;
use faying::problem::Warning;

/// E051 for every body that can still move with all points of ties held and all contacts closed; E024 where multipliers hold less than
/// points.
pub fn check<const S: usize, const N: usize>(builder: &mut Builder<'_, S, N>, built: &Built<S, N>, found: &[Warning]) {
    let motions = built.system.rigid_motions();
    if motions.is_empty() {
        return tell(builder, &built.places, found.iter().filter(|w| matches!(w, Warning::TooFewFunctions { .. })));
    }
    for motion in motions {
        let sentence = motion.sentence;
        let text = if builder.case.contacts.is_empty() { sentence } else { format!("{sentence}, even with every contact closed") };
        let help = match built.places.patch(motion.of) {
            None => "leave the component out of `force`: the obstacle is held there then; or support the body that it presses on",
            Some(_) => "prescribe what is left by [[boundary]], or tie the body to one that is supported",
        };
        let fault = builder.error("E051", text, built.places.at(motion.of)).with_help(help);
        builder.faults.push(fault);
    }
}
