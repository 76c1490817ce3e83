//! Sides as their pieces between kinks.
//!
//! A multiplier that is continuous across a kink cannot follow the tractions there, which jump with the normal: it does not hold states of constant
//! stress exactly, and the error beside the kink does not fall with the size of the elements. So slave sides are taken as their pieces, as if these
//! were stated as a list. A multiplier by data or by a function of the user is one of the whole side.

use super::builder::Problem;
use super::coupled::{Multiplier, TiePair};
use super::error::{ProblemError, ProblemErrors};
use super::handles::Statement;
use super::model::{BodyModel, BodySide, Whole};
use crate::assembly::planar_normal;
use crate::basis::Order;
use crate::coupling::multiplier::MultiplierKind;
use crate::geometry::{ClosestPoint, Geometry, Kinks, MapTable, cell, smooth_pieces};
use std::collections::HashSet;
use std::sync::Arc;

/// Distance of the centre of a refined facet from the facet it is part of, as a share of its size.
const ON_FACET: f64 = 0.1;

/// A tie or a contact, and the place of a slave side in it.
type StatedSlave = (Statement, usize);

impl<const S: usize, const N: usize> Problem<S, N> {
    /// The pieces of a side that slides, between all its kinks; the side itself if it has none, or cells of several shapes.
    pub(super) fn pieces_between_kinks(&self, side: &Arc<BodySide<S, N>>) -> Vec<Arc<BodySide<S, N>>> {
        if planar_normal(&side.trace).is_some() {
            return vec![side.clone()];
        }
        self.parts(side, &smooth_pieces(&*side.trace.space, &side.trace.outward, Kinks::All))
    }

    /// Makes something of the problem with the slave sides of ties and contacts as their pieces between kinks. Sides that have a piece without
    /// room for its multiplier, a wall of a single element, are parted at the edges of planes alone.
    pub(super) fn between_kinks<R>(&self, make: impl Fn(&Self) -> Result<R, ProblemErrors>) -> Result<R, ProblemErrors> {
        let (mut narrow, mut first) = (HashSet::new(), None);
        loop {
            let pieces = self.pieces_of_slaves(&narrow);
            let errors = match make(pieces.as_ref().unwrap_or(self)) {
                Ok(made) => return Ok(made),
                Err(errors) => errors,
            };
            let before = narrow.len();
            if pieces.is_some() {
                narrow.extend(errors.0.iter().filter_map(ProblemError::slave_without_room));
            }
            // parted less it may have other errors, of which the first ones are the reason
            let first = first.get_or_insert(errors);
            if narrow.len() == before {
                return Err(first.clone());
            }
        }
    }

    /// The problem with slave sides as their pieces, the `narrow` ones as those between planes; `None` if no slave has several.
    fn pieces_of_slaves(&self, narrow: &HashSet<StatedSlave>) -> Option<Self> {
        let mut own = self.clone();
        let mut changed = false;
        let mut pieces = |side: &Arc<BodySide<S, N>>, place: StatedSlave| {
            let elements = if narrow.contains(&place) {
                elements_between(&self.bodies, side, Kinks::OfPlanes)
            } else {
                walls(&self.bodies, side, Kinks::OfWalls)
            };
            let pieces = self.parts(side, &elements);
            changed |= pieces.len() > 1;
            pieces
        };
        for tie in own.ties.iter_mut().filter(|t| follows_kinks(&t.multiplier)) {
            let id = Statement::from(tie.id());
            let pairs = std::mem::take(&mut tie.own.pairs).into_iter().enumerate();
            let parted = |(k, pair): (usize, TiePair<S, N>)| {
                pieces(&pair.slave, (id, k)).into_iter().map(move |slave| TiePair { slave, ..pair.clone() })
            };
            tie.own.pairs = pairs.flat_map(parted).collect();
        }
        for contact in own.contacts.iter_mut().filter(|c| follows_kinks(&c.multiplier)) {
            let id = Statement::from(contact.id());
            contact.own.slaves = contact.own.slaves.iter().enumerate().flat_map(|(k, slave)| pieces(slave, (id, k))).collect();
        }
        changed.then_some(own)
    }

    /// The parts of a side with these elements; the side itself if it is one part, or a part has cells of several shapes.
    fn parts(&self, side: &Arc<BodySide<S, N>>, parts: &[Vec<usize>]) -> Vec<Arc<BodySide<S, N>>> {
        let space = &*side.trace.space;
        let is_uniform = |part: &Vec<usize>| part.iter().all(|&e| space.cell(e) == space.cell(part[0]));
        if parts.len() == 1 || !parts.iter().all(is_uniform) {
            return vec![side.clone()];
        }
        let part = |elements: &Vec<usize>| {
            let own = side.part(&self.bodies, self.compiled, elements, side.label.clone());
            let of_whole = |&e: &usize| side.whole.as_ref().map_or(e, |whole| whole.elements[e]);
            Arc::new(BodySide { whole: Some(Whole { side: side.said(), elements: elements.iter().map(of_whole).collect() }), ..own })
        };
        parts.iter().map(part).collect()
    }
}

/// The elements of the walls of a slave side, between `Kinks::OfWalls` or `Kinks::Steep`. Single facets that stand for a known geometry, as chords of
/// a circle do, are no walls: edges of planes alone part such sides.
pub(super) fn walls<const S: usize, const N: usize>(patches: &[BodyModel<S, N>], side: &BodySide<S, N>, kinks: Kinks) -> Vec<Vec<usize>> {
    let walls = elements_between(patches, side, kinks);
    if patches[side.patch].is_shaped && walls.iter().any(|wall| wall.len() == 1) {
        return elements_between(patches, side, Kinks::OfPlanes);
    }
    walls
}

/// The elements of the pieces of a side: facets of a refined mesh are judged by those that it was refined from. One piece where a refined facet is
/// none of these.
fn elements_between<const S: usize, const N: usize>(patches: &[BodyModel<S, N>], side: &BodySide<S, N>, kinks: Kinks) -> Vec<Vec<usize>> {
    let space = &side.trace.space;
    let whole = patches[side.patch].unrefined.as_ref().and_then(|body| body.trace(&side.side).ok());
    let Some(whole) = whole else {
        return smooth_pieces(&**space, &side.trace.outward, kinks);
    };
    let (pieces, one) = (smooth_pieces(&*whole.space, &whole.outward, kinks), || vec![(0..space.num_elements()).collect()]);
    if pieces.len() == 1 {
        return one();
    }
    let mut of = vec![0; whole.facets.len()];
    pieces.iter().enumerate().for_each(|(k, piece)| piece.iter().for_each(|&e| of[e] = k));
    let (closest, mut map) = (ClosestPoint::new(Arc::clone(&whole.space)), MapTable::new());
    let mut parts = vec![Vec::new(); pieces.len()];
    for e in 0..space.num_elements() {
        space.map(e, &[cell::center::<S, f64>(space.cell(e))], Order::Values, &mut map);
        let Some(foot) = closest.project_within(&map.x[0], space.bounds(e).diagonal() * ON_FACET) else { return one() };
        parts[of[foot.element]].push(e);
    }
    parts.retain(|part| !part.is_empty());
    parts
}

/// Whether a multiplier is one of the library's by name.
fn follows_kinks<const S: usize, const N: usize>(multiplier: &Multiplier<S, N>) -> bool {
    matches!(multiplier, Multiplier::Kind(kind) if !matches!(kind, MultiplierKind::Uniform { .. }))
}

/// The place in the statement of every slave side: pieces of one side have that of the side.
pub(super) fn places_of<'a, const S: usize, const N: usize>(slaves: impl Iterator<Item = &'a Arc<BodySide<S, N>>>) -> Vec<usize> {
    let mut before: Option<(&Arc<BodySide<S, N>>, usize)> = None;
    let place = |slave: &'a Arc<BodySide<S, N>>| {
        let place = before.map_or(0, |(other, place)| place + usize::from(!are_pieces(other, slave)));
        before = Some((slave, place));
        place
    };
    slaves.map(place).collect()
}

/// Whether both are pieces of one side.
pub(super) fn are_pieces<const S: usize, const N: usize>(a: &BodySide<S, N>, b: &BodySide<S, N>) -> bool {
    a.whole.as_ref().zip(b.whole.as_ref()).is_some_and(|(a, b)| Arc::ptr_eq(&a.side, &b.side))
}
