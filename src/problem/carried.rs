//! Sides of ties and contacts by fluxes that carry something else as well.
//!
//! Nitsche's method takes the stress of a side for what crosses the interface. Where the side has a load t, springs k, a support or another
//! interface with the pressure p in the same points, the stress is
//!
//! ```text
//! sigma n = lambda + t - k u + reaction + p n
//! ```
//!
//! and the method would be wrong by the rest of it, on every mesh. Of contacts only the part along the normal counts. Components in which
//! elements of both sides that face each other are held do no harm: nothing moves there.

use super::assemble::of_slave;
use super::data::Point;
use super::error::ProblemError;
use super::footprint::{Footprint, Joint, SidePlace};
use super::interface_error::{Carried, InterfaceError};
use super::model::{BodySide, Model};
use crate::linalg::Vector;
use std::collections::{BTreeMap, BTreeSet};

/// Components of a unit vector below this count as zero.
const PERPENDICULAR: f64 = 1e-9;

/// A direction in which a support holds points of a side.
#[derive(Clone, Copy)]
enum HeldAlong<const N: usize> {
    /// Anywhere the same.
    Along(Vector<N>),
    /// The normals, which turn.
    Normals,
    /// The tangents.
    Tangents,
}

impl<const N: usize> HeldAlong<N> {
    fn is_along(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Along(a), Self::Along(b)) => (a - b * a.dot(b)).norm() < PERPENDICULAR,
            (Self::Normals, Self::Normals) | (Self::Tangents, Self::Tangents) => true,
            _ => false,
        }
    }
}

impl<const S: usize, const N: usize> Model<S, N> {
    /// An error for each slave side of ties and contacts by fluxes, one of whose sides carries something else at one of the `times`.
    pub(super) fn carried(&self, times: &[f64]) -> Vec<ProblemError> {
        let ties = self.ties.iter().any(|tie| tie.parts.iter().any(|part| part.coupling.needs_fluxes()));
        if !ties && !self.contacts.iter().any(|contact| contact.method.needs().fluxes) {
            return Vec::new();
        }
        // an obstacle that moves faces other points at other times
        let moves = self.contacts.iter().any(|contact| contact.obstacle.as_ref().is_some_and(|obstacle| obstacle.changes));
        let mut found = BTreeMap::new();
        for times in times.chunks(if moves { 1 } else { times.len() }) {
            let joints = self.joints_at(times[0]);
            for (k, joint) in joints.iter().enumerate().filter(|(_, joint)| joint.by_fluxes) {
                if !found.contains_key(&k)
                    && let Some(error) = self.carried_by(joint, &joints, times)
                {
                    found.insert(k, error);
                }
            }
        }
        found.into_values().collect()
    }

    fn carried_by(&self, joint: &Joint<'_, S, N>, joints: &[Joint<'_, S, N>], times: &[f64]) -> Option<ProblemError> {
        let held: Vec<_> = joint.sides.iter().map(|side| self.held_along(side, joint.is_tie())).collect();
        let own = joint.sides.iter().enumerate().find_map(|(k, side)| {
            let support = || held_alone(joint, &held, k).then_some(Carried::Support);
            Some((side, self.load(side, joint.is_tie(), times).or_else(support)?))
        });
        let others = || joints.iter().filter(|other| other.id != joint.id).find_map(|other| common(joint, other));
        let (side, carried) = own.or_else(others)?;
        let error = InterfaceError::Carries { side: side.side.label.clone(), carried };
        Some(of_slave(joint.id, joint.number, joint.name, joint.sides[0].side, error))
    }

    /// A load, or springs, at the points of a side.
    fn load(&self, side: &Footprint<'_, S, N>, is_tie: bool, times: &[f64]) -> Option<Carried> {
        let counts = |force: &[f64], n: &Vector<N>| match is_tie {
            true => force.iter().any(|f| *f != 0.0),
            false => {
                force.iter().zip(n.iter()).map(|(f, n)| f * n).sum::<f64>().abs()
                    > PERPENDICULAR * force.iter().map(|f| f.abs()).sum::<f64>()
            }
        };
        let mut force = vec![0.0; self.components];
        for load in self.loads.iter().filter(|load| load.side.patch == side.side.patch) {
            let places: Vec<&SidePlace<N>> = side.places_of(&load.side).collect();
            let mut acts = |&t: &f64| {
                let physics = self.patches[load.side.patch].physics_at(t);
                places.iter().any(|(x, n)| {
                    self.side_force(load, &physics, t, x, n, &mut force);
                    counts(&force, n)
                })
            };
            if !places.is_empty() && times.iter().any(&mut acts) {
                return Some(Carried::Load(load.name.clone()));
            }
        }
        for spring in self.springs.iter().filter(|spring| spring.side.patch == side.side.patch) {
            let mut acts = |(x, n): &SidePlace<N>| {
                times.iter().any(|&t| {
                    force.fill(0.0);
                    force[spring.component] = spring.stiffness.value(&Point::new(x.as_slice()).at_time(t));
                    counts(&force, n)
                })
            };
            if side.places_of(&spring.side).any(&mut acts) {
                return Some(Carried::Spring(spring.name.clone()));
            }
        }
        None
    }

    /// Directions in which supports hold elements of the side; of a contact those that have a part along the normal.
    fn held_along(&self, side: &Footprint<'_, S, N>, is_tie: bool) -> HeldElements<N> {
        let unit = |c: usize| Vector::<N>::from_fn(|k, _| if k == c { 1.0 } else { 0.0 });
        let mut held: HeldElements<N> = Vec::new();
        let mut add = |of: &BodySide<S, N>, along: HeldAlong<N>| {
            let elements = side.elements_of(of);
            match held.iter_mut().find(|(other, _)| along.is_along(other)) {
                Some((_, known)) => known.extend(elements),
                None if elements.is_empty() => {}
                None => held.push((along, elements)),
            }
        };
        let counts = |of: &BodySide<S, N>, d: &Vector<N>| is_tie || side.places_of(of).any(|(_, n)| d.dot(n).abs() > PERPENDICULAR);
        let mut hold = |of: &BodySide<S, N>, d: Vector<N>| {
            if counts(of, &d) {
                add(of, HeldAlong::Along(d));
            }
        };
        for c in self.conditions.iter() {
            hold(&c.side, unit(c.component));
        }
        for h in &self.held {
            hold(&h.side, h.direction);
        }
        for r in &self.rigid_sides {
            r.sides.iter().for_each(|of| hold(of, unit(r.component)));
        }
        // tangents count in ties alone
        for slide in self.slides.iter().filter(|slide| is_tie || slide.along_normal()) {
            let mut normals = side.places_of(slide.side()).map(|(_, n)| HeldAlong::Along(*n));
            let Some(first) = normals.next() else { continue };
            let along = match slide.along_normal() {
                false => HeldAlong::Tangents,
                true if normals.all(|n| n.is_along(&first)) => first,
                true => HeldAlong::Normals,
            };
            add(slide.side(), along);
        }
        held
    }
}

/// Directions, and the elements of a side that are held in each.
type HeldElements<const N: usize> = Vec<(HeldAlong<N>, BTreeSet<usize>)>;

/// Whether an element of side `k` of `joint` is held in a direction in which the one that it faces is not, or faces an obstacle.
fn held_alone<const S: usize, const N: usize>(joint: &Joint<'_, S, N>, held: &[HeldElements<N>], k: usize) -> bool {
    let is_held = |side: usize, along: &HeldAlong<N>, element: usize| {
        held[side].iter().any(|(own, elements)| own.is_along(along) && elements.contains(&element))
    };
    held[k].iter().any(|(along, elements)| {
        joint.pairs.is_empty()
            || joint.pairs.iter().any(|&(slave, side, master)| match k {
                0 => elements.contains(&slave) && !is_held(side, along, master),
                _ => side == k && elements.contains(&master) && !is_held(0, along, slave),
            })
    })
}

/// A side of `joint` that has points in common with another interface.
fn common<'a, const S: usize, const N: usize>(
    joint: &'a Joint<'a, S, N>,
    other: &Joint<'_, S, N>,
) -> Option<(&'a Footprint<'a, S, N>, Carried)> {
    let side = joint.sides.iter().find(|a| other.sides.iter().any(|b| a.meets(b)))?;
    Some((side, Carried::Interface(other.name.to_owned())))
}
