//! Parts of sides that "all-outer" leaves out: a side that is tied in part stands in another block, and so does the rest of it.

use super::lower_context::LowerContext;
use crate::text_format::percent;
use faying::problem::{Contents, SideView};
use std::collections::BTreeMap;

/// Least share of a side that is told: facets of one curve differ in length by less.
const LEFT: f64 = 0.02;

/// Warns (E021) of tied sides whose free rest is in no block where "all-outer" stands for the boundary.
pub(super) fn tell<const S: usize, const N: usize>(context: &mut LowerContext<'_, S, N>, contents: &Contents<'_, S, N>) {
    let case = context.case;
    let Some(outer) = case.boundaries.iter().find(|b| b.all_outer) else { return };
    // per side its label, and what of it is tied
    let mut tied: BTreeMap<(usize, String), (String, f64)> = BTreeMap::new();
    let mut add = |side: &SideView<S, N>, measure: f64| {
        let entry = tied.entry((side.body(), side.name().to_owned())).or_insert_with(|| (side.label().to_owned(), 0.0));
        entry.1 += measure;
    };
    for slave in contents.ties().flat_map(|tie| tie.sides()) {
        for pair in slave.pairs() {
            add(slave.side(), pair.covered());
            add(pair.master(), pair.covered());
        }
    }
    for ((body, name), (label, measure)) in tied {
        let view = contents.body(body);
        let Ok(trace) = view.body().trace(&name) else { continue };
        let left = 1.0 - measure / view.side_measure(&trace);
        let named = case.boundaries.iter().filter(|b| !b.all_outer).flat_map(|b| &b.on);
        if left > LEFT && !named.clone().any(|side| side.value.patch == body && side.value.side == name) {
            let text = format!(
                "`{label}` is tied in part, and \"all-outer\" leaves out the rest, {} % of it: nothing is given there",
                percent(left)
            );
            let side = label.split(" where ").next().unwrap_or(&label);
            let help = format!("name that part in a block of its own, on = \"{side}\" with `where`, if it is not to be free");
            let warning = context.warning("E021", text, outer.head.at).with_help(help);
            context.faults.push(warning);
        }
    }
}
