//! Rigid motions that are left when every contact is closed.

use super::builder::Builder;
use super::built::Built;
use super::warned::tell;
use faying::problem::{Ties, free_by, sentences};

/// E051 for every body that can still move with all points of ties held and all contacts closed; E024 where multipliers hold less than
/// points.
pub fn check<const S: usize, const N: usize>(builder: &mut Builder<'_, S, N>, model: &Built<S, N>) {
    let first: Vec<Vec<_>> = model.contacts.iter().map(|c| c.parts.iter().map(|p| &p.first).collect()).collect();
    let free = free_by(model, &first, &|_, _, _| true, Ties::Points);
    if free.is_empty() {
        return tell(builder, model, &model.too_few_functions());
    }
    for (f, sentence) in free.iter().zip(sentences(model, &free)) {
        let obstacle = f.body.checked_sub(model.patches.len());
        let at = match obstacle {
            Some(contact) => builder.case.contacts[contact].head.at,
            None => builder.case.patches[f.body].head.at,
        };
        let text = if model.contacts.is_empty() { sentence } else { format!("{sentence}, even with every contact closed") };
        let help = match obstacle {
            Some(_) => "leave the component out of `force`: the obstacle is held there then; or support the body that it presses on",
            None => "prescribe what is left by [[boundary]], or tie the body to one that is supported",
        };
        let fault = builder.error("E051", text, at).with_help(help);
        builder.faults.push(fault);
    }
}
