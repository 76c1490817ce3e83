//! Sides that nearly touch: `between` ties none of them, and one hears of it.

use super::builder::Builder;
use super::couple::Couple;
use super::couples::wanted;
use super::joined::{Known, Marks};
use super::meant::{Facing, facing};
use super::sides::Sides;
use crate::case::{Master, SideRef};
use crate::place::{Located, Place};
use crate::words::short;
use faying::geometry::Bounds;
use faying::problem::{PatchModel, SideModel};
use faying::space::measure;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Sides nearer than this share of their facets may have been meant to be tied, if they are also nearer than `THIN` of the bodies behind
/// them: coarse facets alone say nothing about what was meant.
const NEAR: f64 = 0.1;
/// Share of the thickness of the thinner body.
const THIN: f64 = 0.02;
/// Of one of them more than this share must face the other.
const COVERED: f64 = 0.5;

/// Two sides of different patches that face each other.
#[derive(Debug)]
pub(super) struct Pair<const S: usize, const N: usize> {
    sides: [Arc<SideModel<S, N>>; 2],
    found: Facing,
}

impl<const S: usize, const N: usize> Pair<S, N> {
    /// "`a.top` and `b.bottom` are 0.001 apart".
    pub fn text(&self) -> String {
        let word = if self.found.gap < 0.0 { "deep in each other" } else { "apart" };
        format!("`{}` and `{}` are {} {word}", self.sides[0].label, self.sides[1].label, short(self.found.distance))
    }

    /// Whether its sides are nearer to each other.
    pub fn is_nearer(&self, other: &Self) -> bool {
        self.found.distance < other.found.distance
    }
}

/// Mean thickness of the body behind a side: its volume over the area of the side \[length\].
pub(super) fn thickness<const S: usize, const N: usize>(patches: &[PatchModel<S, N>], side: &SideModel<S, N>) -> f64 {
    measure::<N, N, f64, _>(&**patches[side.patch].body.space()) / measure::<S, N, f64, _>(&*side.trace.space)
}

/// The nearest sides of every two of `bodies`, of those that are part of no couple; with `near` only where they are so for the size of
/// their facets, else at least those that are nearest of all.
///
/// Sides that overlap through bodies that are joined are the far faces of thin ones.
pub(super) fn nearest<const S: usize, const N: usize>(
    builder: &Builder<'_, S, N>,
    patches: &[PatchModel<S, N>],
    sides: &mut Sides<S, N>,
    bodies: &[usize],
    known: &Known,
    near: bool,
    at: Place,
) -> BTreeMap<[usize; 2], Pair<S, N>> {
    let names = bodies.iter().flat_map(|&patch| patches[patch].body.sides().into_iter().map(move |side| SideRef { patch, side }));
    let all = names.filter_map(|side| sides.get(builder, patches, &Located::new(side, at)).ok());
    let free: Vec<_> = all
        .filter(|side| known.marks(side).is_empty())
        .filter_map(|side| {
            let boxes = side.trace.space.all_bounds();
            let facet = boxes.iter().map(Bounds::diagonal).sum::<f64>() / boxes.len() as f64;
            let whole = boxes.iter().copied().reduce(|a, b| a.union(&b))?;
            Some((side, whole, facet, boxes))
        })
        .collect();
    let size = free.iter().map(|f| f.1).reduce(|a, b| a.union(&b)).map_or(0.0, |b| b.diagonal());
    let none = Marks::new();
    let (mut best, mut least): (BTreeMap<[usize; 2], Pair<S, N>>, f64) = (BTreeMap::new(), size);
    for (k, (a, of_a, facet_a, boxes_a)) in free.iter().enumerate() {
        for (b, of_b, facet_b, boxes_b) in free[k + 1..].iter().filter(|f| f.0.patch != a.patch) {
            let reach = if near { NEAR * facet_a.min(*facet_b) } else { size };
            if !of_a.inflated(reach.min(least)).meets(of_b) || known.hold((a, &none), (b, &none)) {
                continue;
            }
            // neighbours in one plane meet in a rim
            if !mostly(boxes_a, &of_b.inflated(reach)) && !mostly(boxes_b, &of_a.inflated(reach)) {
                continue;
            }
            let seen = [(a, b), (b, a)].into_iter().filter_map(|(a, b)| facing(&a.trace, &b.trace, reach));
            let Some(found) = seen.filter(|f| f.share > COVERED).reduce(|a, b| if b.share > a.share { b } else { a }) else { continue };
            if found.gap < 0.0 && known.are_joined(a.patch, b.patch) {
                continue;
            }
            if near && found.distance > THIN * thickness(patches, a).min(thickness(patches, b)) {
                continue;
            }
            if !near {
                least = least.min(found.distance);
            }
            let key = [a.patch.min(b.patch), a.patch.max(b.patch)];
            if best.get(&key).is_none_or(|other| found.distance < other.found.distance) {
                best.insert(key, Pair { sides: [a.clone(), b.clone()], found });
            }
        }
    }
    best
}

/// Whether more than the share of facets, by their size, that must face another side meets its box.
fn mostly<const N: usize>(facets: &[Bounds<N>], near: &Bounds<N>) -> bool {
    let size = |b: &Bounds<N>| b.diagonal().powi(N as i32 - 1);
    facets.iter().filter(|b| near.meets(b)).map(size).sum::<f64>() > COVERED * facets.iter().map(size).sum::<f64>()
}

/// Warns of sides that `between` leaves apart though they are near for the size of their facets.
pub(super) fn warn<const S: usize, const N: usize>(
    builder: &mut Builder<'_, S, N>,
    patches: &[PatchModel<S, N>],
    sides: &mut Sides<S, N>,
    ties: &[Vec<Couple<S, N>>],
    known: &mut Known,
) {
    let case = builder.case;
    for contact in &case.contacts {
        let Master::Sides(masters) = &contact.master else { continue };
        // what is wrong with a side is reported where its contact is built
        let of = |list: &[Located<SideRef>], sides: &mut Sides<S, N>| -> Vec<Arc<SideModel<S, N>>> {
            list.iter().filter_map(|side| sides.get(builder, patches, side).ok()).collect()
        };
        let (slaves, masters) = (of(&contact.slave, sides), of(masters, sides));
        known.add_sides(&slaves, &masters);
    }
    for (tie, found) in case.interfaces.iter().zip(ties) {
        let Some(between) = tie.between.as_ref().filter(|_| tie.tolerance.value.is_none() && !found.is_empty()) else { continue };
        let Ok(bodies) = wanted(builder, patches, between) else { continue };
        for pair in nearest(builder, patches, sides, &bodies, known, true, between.at).values() {
            let named = |message: &str| pair.sides.iter().all(|s| message.contains(&format!("`{}`", s.label)));
            if builder.faults.items.iter().any(|d| named(&d.message)) {
                continue;
            }
            let text = format!("{}, less than {NEAR} of their facets and {THIN} of the bodies behind them. They are not tied", pair.text());
            let help = "if they are meant to be tied, name slave and master of an [[interface]], or give `tolerance`";
            builder.faults.push(builder.warning("E023", text, between.at).with_help(help));
        }
    }
}
