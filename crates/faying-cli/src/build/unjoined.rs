//! Sides that touch, nearly touch or overlap and that nothing joins: one hears of them, with the line that is missing.
//!
//! Looked at are sides of different patches, and opposite sides of one spline patch, which `closed` would join. Left out are pairs that an
//! interface, a contact, a file or a mesh joins; bodies that a contact lets touch, whatever its sides are; and sides that a boundary block
//! names, as outer sides that somebody has thought of.

use super::builder::Builder;
use super::couple::Couples;
use super::joined::{Known, Marks};
use super::meant::facing;
use super::overlap;
use super::sides::Sides;
use super::touch::{SAME_PLACE, Touching, sag, touching_sides};
use crate::case::{Master, Physics, SideRef};
use crate::place::Located;
use crate::words::short;
use faying::geometry::{Bounds, Sag, Tree};
use faying::problem::{PatchModel, SideModel};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// Sides nearer than this share of their facets may have been meant to be joined.
const NEAR: f64 = 0.1;
/// Of one of them more than this share must face the other.
const COVERED: f64 = 0.5;
/// Most pairs that are named.
const NAMED: usize = 8;

/// Position of two sides to each other.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Lie {
    Touch,
    Apart(f64),
    Overlap(f64),
}

/// A side with the box around it and the mean size of its facets.
struct Candidate<const S: usize, const N: usize> {
    side: Arc<SideModel<S, N>>,
    bounds: Bounds<N>,
    facet: f64,
}

/// Warns of every such pair; `known` has what interfaces, files and meshes join.
pub(super) fn warn<const S: usize, const N: usize>(
    builder: &mut Builder<'_, S, N>,
    patches: &[PatchModel<S, N>],
    sides: &mut Sides<S, N>,
    couples: &Couples<S, N>,
    known: &Known,
) {
    let all = candidates(builder, patches, sides);
    let groups = groups(patches.len(), couples);
    let apart = parted(builder, &groups);
    let named = outer(builder, patches, sides);
    let (marks, outside): (Vec<Marks>, Vec<bool>) = all.iter().map(|c| (known.marks(&c.side), !named.marks(&c.side).is_empty())).unzip();
    let allowed = |a: usize, b: usize| {
        let (p, q) = (all[a].side.patch, all[b].side.patch);
        let ring = p == q && opposite(&all[a].side.side, &all[b].side.side) && !is_mesh(builder, p);
        (p != q || ring)
            && !(outside[a] || outside[b])
            && !apart.contains(&[groups[p].min(groups[q]), groups[p].max(groups[q])])
            && !known.hold((&all[a].side, &marks[a]), (&all[b].side, &marks[b]))
    };
    let tree = Tree::new(all.iter().map(|c| c.bounds.inflated(NEAR * c.facet)).collect());
    let mut pairs: BTreeSet<[usize; 2]> = BTreeSet::new();
    for a in 0..all.len() {
        let met = tree.meeting(tree.item(a)).into_iter().filter(|&b| a < b);
        pairs.extend(met.filter(|&b| allowed(a, b)).map(|b| [a, b]));
    }
    let found = if pairs.is_empty() { BTreeMap::new() } else { lies(builder, patches, &all, &pairs, &groups) };
    tell(builder, &all, &found);
    let told: BTreeSet<[usize; 2]> = found.keys().map(|&[a, b]| [all[a].side.patch, all[b].side.patch]).collect();
    overlap::warn(builder, patches, &|a, b| {
        let groups = [groups[a].min(groups[b]), groups[a].max(groups[b])];
        groups[0] != groups[1] && !apart.contains(&groups) && !told.contains(&[a, b])
    });
}

/// All sides of all patches.
fn candidates<const S: usize, const N: usize>(
    builder: &Builder<'_, S, N>,
    patches: &[PatchModel<S, N>],
    sides: &mut Sides<S, N>,
) -> Vec<Candidate<S, N>> {
    let mut all = Vec::new();
    for (patch, read) in builder.case.patches.iter().enumerate() {
        for side in patches[patch].body.sides() {
            let Ok(side) = sides.get(builder, patches, &Located::new(SideRef { patch, side }, read.head.at)) else { continue };
            let boxes = side.trace.space.all_bounds();
            let facet = boxes.iter().map(Bounds::diagonal).sum::<f64>() / boxes.len().max(1) as f64;
            if let Some(bounds) = boxes.into_iter().reduce(|a, b| a.union(&b)) {
                all.push(Candidate { side, bounds, facet });
            }
        }
    }
    all
}

/// The least patch that every patch hangs together with by couples.
fn groups<const S: usize, const N: usize>(patches: usize, couples: &Couples<S, N>) -> Vec<usize> {
    let mut group: Vec<usize> = (0..patches).collect();
    for couple in couples.ties.iter().flatten().chain(&couples.seams) {
        for master in &couple.masters {
            let (a, b) = (group[couple.slave.patch], group[master.patch]);
            group.iter_mut().filter(|g| **g == a.max(b)).for_each(|g| *g = a.min(b));
        }
    }
    group
}

/// Pairs of groups that a contact lets touch.
fn parted<const S: usize, const N: usize>(builder: &Builder<'_, S, N>, groups: &[usize]) -> BTreeSet<[usize; 2]> {
    let mut apart = BTreeSet::new();
    for contact in &builder.case.contacts {
        let Master::Sides(masters) = &contact.master else { continue };
        for (slave, master) in contact.slave.iter().flat_map(|s| masters.iter().map(move |m| (s, m))) {
            let (a, b) = (groups[slave.value.patch], groups[master.value.patch]);
            apart.insert([a.min(b), a.max(b)]);
        }
    }
    apart
}

/// The facets of sides that boundary blocks name.
fn outer<const S: usize, const N: usize>(builder: &Builder<'_, S, N>, patches: &[PatchModel<S, N>], sides: &mut Sides<S, N>) -> Known {
    let mut named = Known::default();
    for side in builder.case.boundaries.iter().filter(|b| !b.all_outer).flat_map(|b| &b.on) {
        // edges, corners and what is wrong are seen where the block is built
        if let Ok(side) = sides.get(builder, patches, side) {
            named.add_sides(&[side], &[]);
        }
    }
    named
}

fn is_mesh<const S: usize, const N: usize>(builder: &Builder<'_, S, N>, patch: usize) -> bool {
    builder.case.patches[patch].geometry.shape.part().is_some_and(|p| p.is_mesh())
}

/// Whether two sides are the ends of one direction: u0 and u1.
fn opposite(a: &str, b: &str) -> bool {
    a != b && a.len() == 2 && a.len() == b.len() && a[..1] == b[..1]
}

/// Positions of the sides of `pairs` to each other, where they touch or nearly do.
fn lies<const S: usize, const N: usize>(
    builder: &Builder<'_, S, N>,
    patches: &[PatchModel<S, N>],
    all: &[Candidate<S, N>],
    pairs: &BTreeSet<[usize; 2]>,
    groups: &[usize],
) -> BTreeMap<[usize; 2], Lie> {
    let used: Vec<usize> = pairs.iter().flatten().copied().collect::<BTreeSet<_>>().into_iter().collect();
    let place: BTreeMap<usize, usize> = used.iter().enumerate().map(|(k, &i)| (i, k)).collect();
    let sides: Vec<_> = used.iter().map(|&i| all[i].side.clone()).collect();
    let sags: Vec<Sag<S, N>> = sides.iter().map(|s| sag(builder.case, patches, s)).collect();
    let floor = used.iter().map(|&i| all[i].bounds).reduce(|a, b| a.union(&b)).map_or(0.0, |b| b.diagonal()) * SAME_PLACE;
    let left_out = |a: usize, b: usize| !pairs.contains(&[used[a].min(used[b]), used[a].max(used[b])]);
    let Touching { shares, .. } = touching_sides(&sides, None, &sags, floor, &left_out);
    let mut found = BTreeMap::new();
    for &[a, b] in pairs {
        let (k, l) = (place[&a], place[&b]);
        if shares.contains_key(&(k, l)) || shares.contains_key(&(l, k)) {
            found.insert([a, b], Lie::Touch);
            continue;
        }
        // the far faces of thin bodies that are joined lie in each other, and those of one body are apart
        let (p, q) = (all[a].side.patch, all[b].side.patch);
        if groups[p] == groups[q] {
            continue;
        }
        let reach = NEAR * all[a].facet.min(all[b].facet);
        let seen = [(a, b), (b, a)].into_iter().filter_map(|(a, b)| facing(&all[a].side.trace, &all[b].side.trace, reach));
        let Some(best) = seen.filter(|f| f.share > COVERED).reduce(|a, b| if b.share > a.share { b } else { a }) else { continue };
        found.insert([a, b], if best.gap < 0.0 { Lie::Overlap(best.distance) } else { Lie::Apart(best.distance) });
    }
    found
}

/// One warning per pair, and one that counts those beyond [`NAMED`].
fn tell<const S: usize, const N: usize>(builder: &mut Builder<'_, S, N>, all: &[Candidate<S, N>], found: &BTreeMap<[usize; 2], Lie>) {
    let case = builder.case;
    let mut told = 0;
    for (&[a, b], lie) in found {
        let (a, b) = (&all[a].side, &all[b].side);
        let both = |message: &str| [a, b].iter().all(|s| message.contains(&format!("`{}`", s.label)));
        if builder.faults.items.iter().any(|d| both(&d.message)) {
            continue;
        }
        told += 1;
        if told > NAMED {
            continue;
        }
        let how = match lie {
            Lie::Touch if a.patch == b.patch => "coincide".to_owned(),
            Lie::Touch => "touch".to_owned(),
            Lie::Apart(d) => format!("are {} apart", short(*d)),
            Lie::Overlap(d) => format!("are {} deep in each other", short(*d)),
        };
        let at = case.patches[b.patch].head.at;
        let text = format!("`{}` and `{}` {how}, and nothing joins them", a.label, b.label);
        let tie = format!("[[interface]] with slave = \"{}\" and master = \"{}\"", b.label, a.label);
        let help = if a.patch == b.patch {
            format!(
                "write closed = \"{}\" in patch \"{}\" to make a ring of it; name both in [[boundary]] if they are to be open",
                &a.side[..1],
                case.patches[a.patch].name.value
            )
        } else if case.model.physics.value == Physics::Poisson {
            format!("write {tie} to tie them; name one in [[boundary]] if they are to be apart")
        } else {
            format!("write {tie} to tie them, or [[contact]] with these to let them part; name one in [[boundary]] if they are to be apart")
        };
        let warning = builder.warning("E023", text, at).with_help(help);
        builder.faults.push(warning);
    }
    if told > NAMED {
        let text = format!("{} more pairs of sides touch or nearly touch, and nothing joins them", told - NAMED);
        let at = case.patches.first().map_or_else(Default::default, |p| p.head.at);
        builder.faults.push(builder.warning("E023", text, at).with_help("[[interface]] with between = \"all\" ties all that touch"));
    }
}
