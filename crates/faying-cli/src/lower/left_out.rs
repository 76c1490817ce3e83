//! Parts of sides that "all-outer" leaves out: a side of which a part is tied, or named by `where`, stands in another block, and so does the
//! rest of it.

use super::lower_context::LowerContext;
use super::places::Places;
use crate::case::SideRef;
use crate::text_format::percent;
use faying::problem::{Contents, Problem, SideView};
use indexmap::IndexMap;
use std::collections::{BTreeMap, HashSet};

/// Least share of a side that is told: facets of one curve differ in length by less.
const LEFT: f64 = 0.02;

/// Warns (E021) of tied sides whose free rest is in no block where "all-outer" stands for the boundary.
pub(super) fn tell<const S: usize, const N: usize>(context: &mut LowerContext<'_, S, N>, contents: &Contents<'_, S, N>) {
    let case = context.case;
    let Some(outer) = case.boundaries.iter().find(|b| b.all_outer) else { return };
    // what a search found of a side that another block joins in part is tied as a side of its own
    let cuts = case.interfaces.iter().filter(|tie| tie.filter.is_some()).flat_map(|tie| &tie.slave);
    let is_cut = |side: &SideView<S, N>| cuts.clone().any(|cut| cut.value.patch == side.body() && cut.value.side == side.name());
    let is_own = |side: &SideView<S, N>| side.label().contains(" where ") && !is_cut(side);
    // per side its label, the measure of what is tied, and of all of it
    let mut tied: BTreeMap<(usize, String, Option<String>), (String, f64, f64)> = BTreeMap::new();
    let mut add = |side: &SideView<S, N>, covered: f64| {
        let (view, label) = (contents.body(side.body()), side.label().to_owned());
        let own = is_own(side).then(|| label.clone());
        let whole = if own.is_none() { view.body().trace(side.name()).ok() } else { None };
        let measure = || view.side_measure(whole.as_ref().unwrap_or(side.trace()));
        tied.entry((side.body(), side.name().to_owned(), own)).or_insert_with(|| (label, 0.0, measure())).1 += covered;
    };
    for slave in contents.ties().flat_map(|tie| tie.sides()) {
        for pair in slave.pairs() {
            add(slave.side(), pair.covered());
            add(pair.master(), pair.covered());
        }
    }
    for ((body, name, _), (label, covered, measure)) in tied {
        let left = 1.0 - covered / measure;
        let named = case.boundaries.iter().filter(|b| !b.all_outer).flat_map(|b| &b.on);
        if left > LEFT && !named.clone().any(|side| side.value.patch == body && side.value.side == name) {
            let text = format!(
                "`{label}` is tied in part, and \"all-outer\" leaves out the rest, {} % of it: nothing is given there",
                percent(left)
            );
            let warning = context.warning("E021", text, outer.head.at).with_help(help(label.split(" where ").next().unwrap_or(&label)));
            context.faults.push(warning);
        }
    }
}

/// Warns (E021) of sides of which boundary blocks name no more than a part by `where`, and no other block anything, where "all-outer" stands for
/// the boundary; `kept`: the measure of the parts.
pub(super) fn tell_cut<const S: usize, const N: usize>(
    context: &mut LowerContext<'_, S, N>,
    problem: &mut Problem<S, N>,
    places: &Places,
    kept: &IndexMap<&SideRef, f64>,
) {
    let case = context.case;
    let Some(outer) = case.boundaries.iter().find(|b| b.all_outer) else { return };
    let whole = case.boundaries.iter().filter(|b| b.filter.is_none() && !b.all_outer).flat_map(|b| &b.on);
    let whole = whole.chain(case.interfaces.iter().flat_map(|tie| tie.slave.iter().chain(&tie.master)));
    let whole = whole.chain(case.contacts.iter().flat_map(|contact| contact.slave.iter().chain(contact.masters())));
    let whole: HashSet<&SideRef> = whole.map(|side| &side.value).collect();
    for (side, measure) in kept.iter().filter(|(side, _)| !whole.contains(*side)) {
        let on = places.bodies[side.patch].side(&side.side);
        let left = 1.0 - measure / problem.measure(on).unwrap_or(*measure);
        if left > LEFT {
            let label = problem.sides_of(on).ok().and_then(|sides| Some(sides.first()?.label().to_owned())).unwrap_or_default();
            let text = format!(
                "`{label}` is named with `where` alone, and \"all-outer\" leaves out the rest, {} % of it: nothing is given there",
                percent(left)
            );
            context.faults.push(context.warning("E021", text, outer.head.at).with_help(help(&label)));
        }
    }
}

fn help(side: &str) -> String {
    format!("name that part in a block of its own, on = \"{side}\" with `where`, if it is not to be free")
}
