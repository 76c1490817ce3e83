//! Parts of sides that "all-outer" leaves out: a side of which a block names a part, or that is tied in part, stands in another block, and so
//! does the rest of it.

use super::lower_context::LowerContext;
use super::places::Places;
use super::sides::has_name;
use crate::case::SideRef;
use crate::errors::Diagnostic;
use crate::place::Located;
use crate::text_format::percent;
use faying::problem::{Contents, FacetOwners, Problem, SideView};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// Least share of a side that is told: facets of one curve differ in length by less.
const LEFT: f64 = 0.02;

/// Warns (E021) of sides of blocks with facets that none of the sides of all blocks, `given`, has, where "all-outer" stands for the boundary.
pub(super) fn tell_in_no_block<'s, const S: usize, const N: usize>(
    context: &mut LowerContext<'_, S, N>,
    problem: &mut Problem<S, N>,
    places: &Places,
    given: impl Iterator<Item = &'s Arc<SideView<S, N>>>,
) {
    let case = context.case;
    if !case.boundaries.iter().any(|b| b.all_outer) {
        return;
    }
    let mut owners = FacetOwners::default();
    given.for_each(|side| owners.add(side, 0));
    let blocks = case.boundaries.iter().filter(|b| !b.all_outer).flat_map(|b| &b.on);
    let ties = case.interfaces.iter().flat_map(|tie| tie.slave.iter().chain(&tie.master));
    let contacts = case.contacts.iter().flat_map(|contact| contact.slave.iter().chain(contact.masters()));
    for Located { value: SideRef { patch, side }, .. } in blocks.chain(ties).chain(contacts) {
        // edges, corners and what is wrong are seen elsewhere
        let Ok(whole) = problem.sides_of(places.bodies[*patch].side(side)) else { continue };
        for side in whole {
            let left = owners.free_measure(&side) / side.measure();
            if left > LEFT {
                let fault = left_out(context, &side, "stands in another block with a part of it", left);
                context.faults.push(fault);
                owners.add(&side, 0);
            }
        }
    }
}

/// Warns (E021) of tied sides of which a part meets nothing, where "all-outer" stands for the boundary and no other block names that part;
/// `named`: the sides of the other blocks.
pub(super) fn tell_uncovered<const S: usize, const N: usize>(
    context: &mut LowerContext<'_, S, N>,
    contents: &Contents<'_, S, N>,
    named: &[Arc<SideView<S, N>>],
) {
    if !context.case.boundaries.iter().any(|b| b.all_outer) {
        return;
    }
    // slaves and masters with the measure of what meets, of contacts the slaves whole
    let mut sides: Vec<(&SideView<S, N>, f64)> = Vec::new();
    for (interface, is_tied) in contents.ties().map(|t| (t, true)).chain(contents.contacts().map(|c| (c, false))) {
        for slave in interface.sides() {
            let (pairs, whole) = (slave.pairs(), slave.side().measure());
            let covered: f64 = pairs.iter().map(|pair| pair.covered()).sum();
            sides.push((slave.side(), if is_tied { covered } else { whole }));
            sides.extend(pairs.iter().map(|pair| (pair.master(), pair.covered())));
        }
    }
    sides.extend(named.iter().map(|side| (&**side, side.measure())));
    // sides with common facets count as one, and pieces of a side
    let (mut owners, mut pieces) = (FacetOwners::default(), BTreeMap::new());
    let mut groups: Vec<usize> = (0..sides.len()).collect();
    for (k, (side, _)) in sides.iter().enumerate() {
        let first = *pieces.entry((side.body(), side.label())).or_insert(k);
        for group in owners.of(*side).chain([first]).map(|other| groups[other]).collect::<BTreeSet<_>>() {
            let own = groups[k];
            groups.iter_mut().filter(|g| **g == group).for_each(|g| *g = own);
        }
        owners.add(side, k);
    }
    let (mut seen, mut measures) = (FacetOwners::default(), BTreeMap::new());
    for (k, (side, covered)) in sides.iter().enumerate() {
        let of: &mut (usize, f64, f64) = measures.entry(groups[k]).or_insert((k, 0.0, 0.0));
        of.1 += covered;
        of.2 += seen.free_measure(side);
        seen.add(side, k);
    }
    let tied = contents.ties().map(|tie| tie.sides().iter().map(|slave| 1 + slave.pairs().len()).sum::<usize>()).sum::<usize>();
    for (first, covered, measure) in measures.into_values() {
        let left = 1.0 - covered / measure;
        if left > LEFT && first < tied {
            let fault = left_out(context, sides[first].0, "is tied in part", left);
            context.faults.push(fault);
        }
    }
}

fn left_out<const S: usize, const N: usize>(context: &LowerContext<'_, S, N>, side: &SideView<S, N>, how: &str, share: f64) -> Diagnostic {
    let label = side.label();
    let at = context.case.boundaries.iter().find(|b| b.all_outer).map(|b| b.head.at).unwrap_or_default();
    let text = format!("`{label}` {how}, and \"all-outer\" leaves out the rest, {} % of it: nothing is given there", percent(share));
    let whole = label.split(" where ").next().unwrap_or(label);
    let help = if has_name(context.case, side.body(), side.name()) {
        format!("name that part in a block of its own, on = \"{whole}\" with `where`, if it is not to be free")
    } else {
        "give that part a tag of its own in the mesh, and a block, if it is not to be free".to_owned()
    };
    context.warning("E021", text, at).with_help(help)
}
