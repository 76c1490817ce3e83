//! Side pairs of the interfaces: slaves with their masters, given by name or found by a search for touching sides.

use super::builder::Builder;
use super::couple::{Couple, Couples, Pair, pair};
use super::joined::{Known, disjoint};
use super::near::{self, nearest};
use super::sides::Sides;
use super::touch::{SAME_PLACE, Touching, sag, touching_sides};
use super::unjoined;
use crate::case::{SideRef, Tie};
use crate::errors::Diagnostic;
use crate::place::{Located, Place};
use crate::words::{labels, short};
use faying::geometry::Sag;
use faying::problem::{PatchModel, SideModel};
use faying::space::clearance;
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;
use std::sync::Arc;

/// Sides farther apart than this share of the thickness of the thinner body are not nearly together, however coarse their facets are.
const SEPARATE: f64 = 0.1;
/// Search radius of named sides, as a fraction of the facet size.
const NAMED: f64 = 0.25;

/// Finds the side pairs of all interfaces; errors go to the builder's faults.
///
/// `files` lists the patches that came from one file, with the source location of its name: their touching sides are glued.
pub(super) fn find<const S: usize, const N: usize>(
    builder: &mut Builder<'_, S, N>,
    patches: &[PatchModel<S, N>],
    sides: &mut Sides<S, N>,
    files: &[(Range<usize>, Place)],
) -> Couples<S, N> {
    let mut couples = Couples { ties: Vec::new(), seams: Vec::new(), sides: BTreeSet::new() };
    let case = builder.case;
    for (k, patch) in case.patches.iter().enumerate() {
        let Some(closed) = &patch.closed else { continue };
        match ring(builder, patches, sides, k, closed) {
            Ok(couple) => couples.seams.push(couple),
            Err(fault) => builder.faults.push(*fault),
        }
    }
    let mut known = Known::new(explicit(builder), listed(builder, patches));
    for (range, at) in files {
        match touching(builder, patches, sides, &range.clone().collect::<Vec<_>>(), &known, *at, None) {
            Ok(found) => couples.seams.extend(found),
            Err(fault) => builder.faults.push(*fault),
        }
    }
    // groups of one mesh share the functions of common facets
    for joint in &case.joints {
        let mut side = |k: usize| sides.get(builder, patches, &Located::new(joint.sides[k].clone(), joint.at));
        match side(0).and_then(|slave| Ok((slave, side(1)?))) {
            Ok((slave, master)) => {
                couples.seams.push(Couple { slave, masters: vec![master], at: joint.at, tolerance: None, is_named: false, explained: None })
            }
            Err(fault) => builder.faults.push(*fault),
        }
    }
    // patches listed by an interface are not glued by their file; from here on they may be paired, but glued sides stay glued
    known.join_lists();
    couples.seams.iter().for_each(|c| known.add(c));
    couples.ties.resize_with(case.interfaces.len(), Vec::new);
    // order: interfaces with named sides, then lists of patches, then "all"
    let rank = |tie: &Tie| tie.between.as_ref().map_or(0, |b| if is_all(b) { 2 } else { 1 });
    let mut order: Vec<usize> = (0..case.interfaces.len()).collect();
    order.sort_by_key(|&k| rank(&case.interfaces[k]));
    for k in order {
        let tie = &case.interfaces[k];
        let found = match &tie.between {
            None => named(builder, patches, sides, tie),
            Some(between) => match wanted(builder, patches, between)
                .and_then(|bodies| touching(builder, patches, sides, &bodies, &known, between.at, tie.tolerance.value))
            {
                Ok(found) if found.is_empty() => {
                    let nearest = match wanted(builder, patches, between) {
                        Ok(bodies) => nearest(builder, patches, sides, &bodies, &known, false, between.at),
                        Err(_) => BTreeMap::new(),
                    };
                    let least = nearest.into_values().reduce(|a, b| if b.is_nearer(&a) { b } else { a });
                    let text = format!(
                        "no sides of the patches of interface \"{}\" touch each other that are not joined yet{}",
                        tie.name.value,
                        least.map_or(String::new(), |pair| format!("; the nearest, {}", pair.text()))
                    );
                    let help = "name slave and master, or raise `tolerance`; a list of patches parts those that a file or a mesh joins";
                    builder.faults.push(builder.error("E023", text, between.at).with_help(help));
                    found
                }
                Ok(found) => found,
                Err(fault) => {
                    builder.faults.push(*fault);
                    Vec::new()
                }
            },
        };
        found.iter().for_each(|c| known.add(c));
        couples.ties[k] = found;
    }
    let key = |s: &Arc<SideModel<S, N>>| (s.patch, s.side.clone());
    let all = couples.ties.iter().flatten().chain(&couples.seams);
    couples.sides = all.flat_map(|c| c.masters.iter().chain([&c.slave])).map(key).collect();
    slave_twice(builder, &couples);
    near::warn(builder, patches, sides, &couples.ties, &mut known);
    unjoined::warn(builder, patches, sides, &couples, &known);
    couples
}

/// Reports E026 if a side found by the search is slave already.
fn slave_twice<const S: usize, const N: usize>(builder: &mut Builder<'_, S, N>, couples: &Couples<S, N>) {
    let mut first: BTreeMap<(usize, &str), usize> = BTreeMap::new();
    let case = builder.case;
    for (k, (list, tie)) in couples.ties.iter().zip(&case.interfaces).enumerate() {
        for couple in list {
            let before = first.insert((couple.slave.patch, &couple.slave.side), k);
            if let Some(before) = before.filter(|_| tie.between.is_some() || case.interfaces[k].between.is_some()) {
                let names = [&case.interfaces[before].name.value, &tie.name.value];
                let text = format!("`{}` is slave twice: in interfaces \"{}\" and \"{}\"", couple.slave.label, names[0], names[1]);
                let fault = builder.error("E026", text, couple.at).with_help("name slaves and masters in place of `between`");
                builder.faults.push(fault);
            }
        }
    }
}

/// Returns the side pairs of an interface whose slaves and masters are named.
fn named<const S: usize, const N: usize>(
    builder: &mut Builder<'_, S, N>,
    patches: &[PatchModel<S, N>],
    sides: &mut Sides<S, N>,
    tie: &Tie,
) -> Vec<Couple<S, N>> {
    let mut list = |builder: &mut Builder<'_, S, N>, wanted: &[Located<SideRef>]| {
        let mut out = Vec::new();
        for side in wanted {
            match sides.get(builder, patches, side) {
                Ok(found) => out.push((found, side.at)),
                Err(fault) => builder.faults.push(*fault),
            }
        }
        out
    };
    let slaves = list(builder, &tie.slave);
    let masters: Vec<_> = list(builder, &tie.master).into_iter().map(|(side, _)| side).collect();
    let tolerance = tie.tolerance.value;
    let couple = |(slave, at)| Couple { slave, masters: masters.clone(), at, tolerance, is_named: true, explained: None };
    let mut couples: Vec<Couple<S, N>> = slaves.into_iter().map(couple).collect();
    for couple in couples.iter_mut().filter(|c| c.tolerance.is_none()) {
        match explained(builder, patches, couple) {
            Ok(within) => couple.explained = within,
            Err(warning) => builder.faults.push(*warning),
        }
    }
    couples
}

/// Returns the largest admissible distance of points of named sides if faceting explains their distance; `None` if the maps are exact or
/// the sides are out of reach.
///
/// # Errors
/// A warning if faceting does not explain the distance; the sides are tied nevertheless, because they are named.
fn explained<const S: usize, const N: usize>(
    builder: &Builder<'_, S, N>,
    patches: &[PatchModel<S, N>],
    couple: &Couple<S, N>,
) -> Result<Option<f64>, Box<Diagnostic>> {
    let exact = |s: &SideModel<S, N>| patches[s.patch].exact_map;
    if exact(&couple.slave) && couple.masters.iter().all(|m| exact(m)) {
        // exact sides may be 1e-8 of their size apart; more is reported as an error when they are tied
        return Ok(None);
    }
    let all: Vec<&Arc<SideModel<S, N>>> = std::iter::once(&couple.slave).chain(&couple.masters).collect();
    let sags: Vec<Sag<S, N>> = all.iter().map(|s| sag(builder.case, patches, s)).collect();
    let boxes = all.iter().flat_map(|s| s.trace.space.all_bounds());
    let floor = boxes.reduce(|a, b| a.union(&b)).map_or(0.0, |b| b.diagonal()) * SAME_PLACE;
    let masters: Vec<_> = couple.masters.iter().zip(&sags[1..]).map(|(m, s)| (&m.trace, s)).collect();
    let found = clearance((&couple.slave.trace, &sags[0]), &masters, NAMED, floor);
    if found.is_empty() {
        return Ok(None);
    }
    if found.touches(floor) {
        return Ok(Some(widest(&sags, floor)));
    }
    let text = format!(
        "`{}` and {} are {} apart in the mean, up to {}; their facets explain {} in the mean. They are tied because they are named",
        couple.slave.label,
        labels(&couple.masters),
        short(found.mean()),
        short(found.greatest),
        short(found.allowed())
    );
    let help = "move the bodies together, refine the sides, or write `tolerance` if they are meant to be tied so";
    Err(Box::new(builder.warning("E023", text, couple.at).with_help(help)))
}

/// Largest admissible distance of points of faceted sides: four times the largest of the `sags`, at least twice `floor`.
fn widest<const S: usize, const N: usize>(sags: &[Sag<S, N>], floor: f64) -> f64 {
    (4.0 * sags.iter().map(Sag::greatest).fold(0.0, f64::max)).max(2.0 * floor)
}

/// Side pair of a closed patch: for `closed = "u"` the slave u1 with the master u0, and so on.
fn ring<const S: usize, const N: usize>(
    builder: &Builder<'_, S, N>,
    patches: &[PatchModel<S, N>],
    sides: &mut Sides<S, N>,
    patch: usize,
    closed: &Located<String>,
) -> Result<Couple<S, N>, Box<Diagnostic>> {
    let directions = &["u", "v", "w"][..N];
    let axis = closed.value.as_str();
    if !directions.contains(&axis) {
        let text = format!("`closed` must be one of {}, found {axis:?}", directions.join(", "));
        return Err(Box::new(builder.error("E015", text, closed.at)));
    }
    let mut side = |end: usize| sides.get(builder, patches, &Located::new(SideRef { patch, side: format!("{axis}{end}") }, closed.at));
    let (slave, master) = (side(1)?, side(0)?);
    Ok(Couple { slave, masters: vec![master], at: closed.at, tolerance: None, is_named: false, explained: None })
}

fn is_all(between: &Located<Vec<String>>) -> bool {
    between.value.iter().any(|name| name == "all")
}

/// Returns the patches of every `between` that is a list, not "all".
fn listed<const S: usize, const N: usize>(builder: &Builder<'_, S, N>, patches: &[PatchModel<S, N>]) -> Vec<BTreeSet<usize>> {
    let lists = builder.case.interfaces.iter().filter_map(|t| t.between.as_ref()).filter(|b| !is_all(b));
    lists.filter_map(|b| Some(wanted(builder, patches, b).ok()?.into_iter().collect())).collect()
}

/// The patches that `between` names.
pub(super) fn wanted<const S: usize, const N: usize>(
    builder: &Builder<'_, S, N>,
    patches: &[PatchModel<S, N>],
    between: &Located<Vec<String>>,
) -> Result<Vec<usize>, Box<Diagnostic>> {
    if is_all(between) {
        return Ok((0..patches.len()).collect());
    }
    let find = |name: &String| {
        patches
            .iter()
            .position(|p| p.name == *name)
            .ok_or_else(|| Box::new(builder.error("E021", format!("there is no patch {name:?}"), between.at)))
    };
    between.value.iter().map(find).collect()
}

/// Side pairs that interfaces and contacts of the case name.
fn explicit<const S: usize, const N: usize>(builder: &Builder<'_, S, N>) -> BTreeSet<Pair> {
    let case = builder.case;
    let ties = case.interfaces.iter().map(|t| (&t.slave, t.master.as_slice()));
    let contacts = case.contacts.iter().map(|c| match &c.master {
        crate::case::Master::Sides(list) => (&c.slave, list.as_slice()),
        crate::case::Master::Rigid(_) => (&c.slave, &[][..]),
    });
    let pairs = ties.chain(contacts);
    let key = |s: &Located<SideRef>| (s.value.patch, s.value.side.clone());
    pairs.flat_map(|(slaves, masters)| slaves.iter().flat_map(move |s| masters.iter().map(move |m| pair(key(s), key(m))))).collect()
}

/// Finds the touching sides of `bodies` and returns them as slaves with masters, without the pairs in `known`, every facet once. Among
/// sides that touch one another the slaves are those that are fully covered, or else the finer ones.
///
/// Touching facets are found by a tree of boxes. To glue the patches of a file, call it with their numbers and push the
/// couples to [`Couples::seams`]; [`find`] does so for its `files`.
pub(super) fn touching<const S: usize, const N: usize>(
    builder: &mut Builder<'_, S, N>,
    patches: &[PatchModel<S, N>],
    sides: &mut Sides<S, N>,
    bodies: &[usize],
    known: &Known,
    at: Place,
    tolerance: Option<f64>,
) -> Result<Vec<Couple<S, N>>, Box<Diagnostic>> {
    let mut all = Vec::new();
    for &patch in bodies {
        for side in patches[patch].body.sides() {
            all.push(sides.get(builder, patches, &Located::new(SideRef { patch, side }, at))?);
        }
    }
    let marks: Vec<_> = all.iter().map(|s| known.marks(s)).collect();
    let left_out = |a: usize, b: usize| all[a].patch == all[b].patch || known.hold((&all[a], &marks[a]), (&all[b], &marks[b]));
    let sags: Vec<Sag<S, N>> = all.iter().map(|s| sag(builder.case, patches, s)).collect();
    let boxes = all.iter().flat_map(|s| s.trace.space.all_bounds());
    let floor = boxes.reduce(|a, b| a.union(&b)).map_or(0.0, |b| b.diagonal()) * SAME_PLACE;
    let explained = widest(&sags, floor);
    let Touching { mut shares, touched, near } = touching_sides(&all, tolerance, &sags, floor, &left_out);
    // facets as coarse as this explain nothing
    let apart = |[a, b]: [usize; 2]| SEPARATE * near::thickness(patches, &all[a]).min(near::thickness(patches, &all[b]));
    for ([a, b], found) in near.into_iter().filter(|(pair, found)| found.mean() <= apart(*pair)) {
        let text = format!(
            "`{}` and `{}` are {} apart in the mean, up to {}; their facets explain {} in the mean. They are not tied",
            all[a].label,
            all[b].label,
            short(found.mean()),
            short(found.greatest),
            short(found.allowed())
        );
        let help = "if they are meant to be tied, name slave and master of an [[interface]], or give `tolerance`";
        builder.faults.push(builder.warning("E023", text, at).with_help(help));
    }
    if let Err([lost, other]) = disjoint(&all, &mut shares, &touched) {
        let text = format!("`{}` touches `{}` beyond the sides with which it shares facets", all[lost].label, all[other].label);
        return Err(Box::new(
            builder.error("E023", text, at).with_help("name slave and master, or give the touching part one tag of its own"),
        ));
    }
    Ok(oriented(&all, &shares)
        .into_iter()
        .map(|(slave, masters)| Couple {
            slave: all[slave].clone(),
            masters: masters.into_iter().map(|m| all[m].clone()).collect(),
            at,
            tolerance,
            is_named: false,
            explained: Some(explained),
        })
        .collect())
}

/// Tolerance of the covered share of a side's facets: a side is fully covered from 1 - `ALL` on.
const ALL: f64 = 1e-9;

/// Chooses slaves and masters from `shares`, the share of facets of one side that another covers.
fn oriented<const S: usize, const N: usize>(
    all: &[Arc<SideModel<S, N>>],
    shares: &BTreeMap<(usize, usize), f64>,
) -> Vec<(usize, Vec<usize>)> {
    let mut neighbours: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for &(a, b) in shares.keys() {
        for (a, b) in [(a, b), (b, a)] {
            let list = neighbours.entry(a).or_default();
            if !list.contains(&b) {
                list.push(b);
            }
        }
    }
    let mut class: BTreeMap<usize, usize> = BTreeMap::new();
    let mut out = Vec::new();
    for &start in neighbours.keys() {
        if class.contains_key(&start) {
            continue;
        }
        // connected group of touching sides, divided into two classes
        let mut members = vec![start];
        class.insert(start, 0);
        let mut next = 0;
        while let Some(&a) = members.get(next) {
            next += 1;
            for &b in &neighbours[&a] {
                if !class.contains_key(&b) {
                    class.insert(b, 1 - class[&a]);
                    members.push(b);
                }
            }
        }
        let covered = |a: usize| -> f64 { neighbours[&a].iter().filter_map(|&b| shares.get(&(a, b))).sum() };
        let of = |c: usize| members.iter().copied().filter(|m| class[m] == c).collect::<Vec<_>>();
        let classes = [of(0), of(1)];
        let whole = classes.each_ref().map(|list| list.iter().all(|&a| covered(a) >= 1.0 - ALL));
        let facets = classes.each_ref().map(|list| list.iter().map(|&a| all[a].trace.facets.len()).sum::<usize>());
        let slave = if whole[0] != whole[1] { usize::from(whole[1]) } else { usize::from(facets[1] > facets[0]) };
        for &a in &classes[slave] {
            let mut masters: Vec<usize> = neighbours[&a].iter().copied().filter(|b| class[b] != class[&a]).collect();
            masters.sort_unstable();
            out.push((a, masters));
        }
    }
    out
}
