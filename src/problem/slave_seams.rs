//! Functions that several slave sides of contacts share.
//!
//! A function of the model on k slave sides takes part in k gaps. It has as many free motions along their normals as these have independent
//! directions; with more multipliers the system is singular, or pressures oscillate. So many sides keep it, those with the fewest functions of
//! their own first; on the others it counts as constrained, and the multiplier is lowered there. Across an edge the normals are independent and each
//! side keeps its own.

use super::builder::Problem;
use super::coupled::Contact;
use super::directions::normals;
use super::fixed::Eliminated;
use super::model::{BodySide, Model};
use crate::linalg::Vector;
use std::collections::{BTreeMap, HashMap, HashSet};
use std::sync::Arc;

/// Sine of the angle between a normal and the span of others from which on it is a direction of its own: 20 degrees.
const INDEPENDENT: f64 = 0.342;
/// Length of the free part of a unit normal up to which it is held.
const IMMOBILE: f64 = 1e-6;

/// A slave side of a contact that carries multipliers.
struct Carrier<'a, const S: usize, const N: usize> {
    side: &'a Arc<BodySide<S, N>>,
    /// Whether its multiplier is as rich as the side.
    is_rich: bool,
}

impl<const S: usize, const N: usize> Problem<S, N> {
    /// The functions of the model that have no multiplier on a slave side, since other sides press them along all free directions.
    pub(super) fn seams(&self, model: &Model<S, N>, fixed: &Eliminated) -> SlaveSeams<S, N> {
        let carriers: Vec<_> = self.contacts.iter().filter(|c| c.own.method.needs().multiplier).flat_map(carriers_of).collect();
        // a side that faces several opponents is one
        let first = first_of_each(&carriers.iter().map(|c| c.side).collect::<Vec<_>>());
        let mut sides_of = BTreeMap::<usize, Vec<(usize, usize)>>::new();
        let mut count = vec![0; carriers.len()];
        for (k, carrier) in carriers.iter().enumerate().filter(|(k, _)| first[*k] == *k) {
            for &dof in &carrier.side.trace.dofs {
                let sides = sides_of.entry(model.function(carrier.side.patch, dof)).or_default();
                // a function of a closed side has two places on it
                if sides.last().is_none_or(|&(other, _)| other != k) {
                    sides.push((k, dof));
                    count[k] += 1;
                }
            }
        }
        let (mut shared, mut alone) = (Vec::new(), count.clone());
        let mut normals_of = HashMap::<usize, HashMap<usize, Vector<N>>>::new();
        for (function, mut sides) in sides_of {
            let patch = carriers[sides[0].0].side.patch;
            // multipliers that are poorer than their side are stable beside each other
            if sides.iter().all(|&(k, _)| carriers[k].side.patch == patch) {
                sides.retain(|&(k, _)| carriers[k].is_rich);
            }
            if sides.len() > 1 {
                let mut free = |(k, dof): (usize, usize)| {
                    alone[k] -= 1;
                    let field = model.patches[carriers[k].side.patch].field;
                    let normal = normals_of.entry(k).or_insert_with(|| normals(carriers[k].side)).get(&dof).copied();
                    let normal = normal.unwrap_or_else(Vector::zeros);
                    (k, Vector::<N>::from_fn(|c, _| if fixed.is(field.unknown(dof, c)) { 0.0 } else { normal[c] }))
                };
                shared.push((function, sides.into_iter().map(&mut free).collect::<Vec<_>>()));
            }
        }
        // small sides have the least to give; those that would keep nothing come before them
        let mut poor = HashSet::new();
        loop {
            let mut stuck: Vec<HashSet<usize>> = vec![HashSet::new(); carriers.len()];
            for (function, sides) in &mut shared {
                sides.sort_by_key(|&(k, _)| (!poor.contains(&k), alone[k], count[k], k));
                let mut span = Vec::new();
                sides.iter().filter(|(_, free)| !extends(&mut span, free)).for_each(|&(k, _)| _ = stuck[k].insert(*function));
            }
            let before = poor.len();
            poor.extend((0..carriers.len()).filter(|&k| count[k] > 0 && stuck[k].len() == count[k]));
            if poor.len() == before {
                let of = |k: usize| (Arc::as_ptr(carriers[k].side), stuck[first[k]].clone());
                return SlaveSeams((0..carriers.len()).map(of).filter(|(_, functions)| !functions.is_empty()).collect());
            }
        }
    }
}

/// The functions of the model without a multiplier on each slave side.
pub(super) struct SlaveSeams<const S: usize, const N: usize>(HashMap<*const BodySide<S, N>, HashSet<usize>>);

impl<const S: usize, const N: usize> SlaveSeams<S, N> {
    /// Whether a function of the model has none on a side.
    pub fn hold(&self, side: &Arc<BodySide<S, N>>, function: usize) -> bool {
        self.0.get(&Arc::as_ptr(side)).is_some_and(|functions| functions.contains(&function))
    }
}

fn carriers_of<const S: usize, const N: usize>(contact: &Contact<S, N>) -> impl Iterator<Item = Carrier<'_, S, N>> {
    contact.own.slaves.iter().map(|side| Carrier { side, is_rich: contact.multiplier.lowers_ends(side) })
}

/// For each side the first one that is the same elements of one side.
fn first_of_each<const S: usize, const N: usize>(sides: &[&Arc<BodySide<S, N>>]) -> Vec<usize> {
    let mut alike = HashMap::<(usize, &[usize]), Vec<usize>>::new();
    let first = |(k, side): (usize, &&Arc<BodySide<S, N>>)| {
        let others = alike.entry((side.patch, &sides[k].trace.dofs)).or_default();
        others.iter().copied().find(|&other| coincide(sides[other], side)).unwrap_or_else(|| {
            others.push(k);
            k
        })
    };
    sides.iter().enumerate().map(first).collect()
}

/// Whether both are the same elements of one side.
fn coincide<const S: usize, const N: usize>(a: &Arc<BodySide<S, N>>, b: &Arc<BodySide<S, N>>) -> bool {
    Arc::ptr_eq(a, b) || (a.patch == b.patch && a.side == b.side && a.trace.facets == b.trace.facets)
}

/// Adds the direction of `n` to orthonormal ones, if it is none of their span; whether it did.
fn extends<const N: usize>(span: &mut Vec<Vector<N>>, n: &Vector<N>) -> bool {
    let rest = span.iter().fold(*n, |rest, d| rest - d * rest.dot(d));
    let is_new = n.norm() > IMMOBILE && rest.norm() > INDEPENDENT * n.norm();
    if is_new {
        span.push(rest / rest.norm());
    }
    is_new
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn normals_of_a_smooth_side_are_one_direction() {
        let at = |degrees: f64| Vector::<2>::new(degrees.to_radians().sin(), degrees.to_radians().cos());
        for (normals, expected) in [
            (vec![at(0.0), at(19.0)], vec![true, false]),
            (vec![at(0.0), at(21.0)], vec![true, true]),
            (vec![at(0.0), at(90.0), at(45.0)], vec![true, true, false]),
            (vec![at(0.0) * 1e-7, at(90.0)], vec![false, true]),
        ] {
            let mut span = Vec::new();
            assert_eq!(normals.iter().map(|n| extends(&mut span, n)).collect::<Vec<_>>(), expected);
        }
    }
}
