//! Functions of a contact's multiplier that live on a sliver: what the slave faces ends within an element of it.
//!
//! The last functions on such an element face the master by a part of theirs that may be arbitrarily small, and nothing bounds the pressure
//! there: a hat function over 1e-4 of its element takes a tenth of the force with 5,000 times the mean pressure. So a function that lives on
//! elements covered in part alone, with less than [`SLIVER`] of its integral over these elements,
//!
//! ```text
//! ∫ |N_j| ds over what is covered  <  SLIVER ∫ |N_j| ds over the whole elements,
//! ```
//!
//! gives its share to a neighbour, N_k' = N_k + N_j: on curves the one with most of what is covered, on surfaces the one with which it has most in
//! common there, int |N_j| |N_k| ds. Several that are alike in this up to rounding get equal parts, so that rounding decides nothing. The functions
//! stay non-negative and sum to one. Where all functions of an element are of that kind the neighbour is one of the element beside it, of surfaces
//! of those at its corners, and without one they stay.

use super::covered::is_whole;
use crate::assembly::element_rule;
use crate::basis::{Basis, Extracted, Order, ShapeTable};
use crate::coupling::Segments;
use crate::geometry::{Geometry, MapTable};
use crate::linalg::{Real, Vector, lit, measure, to_f64};
use crate::quadrature::Quadrature;
use std::collections::{BTreeMap, HashMap};
use std::ops::Range;

/// Least share of the integral of a function over its elements.
pub const SLIVER: f64 = 0.1;
/// Integrals that differ by less than this share of them are the same.
const SAME: f64 = 1e-6;
/// Gauss points of an element beyond its degree and one.
const POINTS: usize = 3;

/// A function that lives on a sliver.
struct Sliver {
    function: usize,
    /// The functions that take its share, in equal parts.
    heirs: Vec<usize>,
}

/// Returns those with the greatest value, ascending; none without values.
fn greatest(values: impl Iterator<Item = (usize, f64)>) -> Vec<usize> {
    let all: Vec<(usize, f64)> = values.collect();
    let most = all.iter().fold(f64::NEG_INFINITY, |m, (_, v)| m.max(*v));
    let mut found: Vec<usize> = all.iter().filter(|(_, v)| *v >= most - SAME * most.abs()).map(|(i, _)| *i).collect();
    found.sort_unstable();
    found.dedup();
    found
}

/// The functions of `basis` that live on slivers of what `segments` cover of the side `space`.
pub(super) fn lives_on_sliver<const N: usize, T: Real>(
    basis: &dyn Basis<1, T>,
    space: &dyn Geometry<1, N, T>,
    segments: &Segments<1, T>,
) -> Vec<bool> {
    let mut out = vec![false; basis.num_functions()];
    slivers(basis, space, segments).iter().for_each(|s| out[s.function] = true);
    out
}

/// `basis` with the functions that live on slivers given to their neighbours; `segments`: what faces the side `space`.
pub fn without_slivers<const S: usize, const N: usize, T: Real>(
    basis: Box<dyn Basis<S, T>>,
    space: &dyn Geometry<S, N, T>,
    segments: &Segments<S, T>,
) -> Box<dyn Basis<S, T>> {
    let found = slivers(&*basis, space, segments);
    if found.is_empty() {
        return basis;
    }
    let mut of: Vec<Vec<usize>> = (0..basis.num_functions()).map(|i| vec![i]).collect();
    let mut kept = vec![true; of.len()];
    for Sliver { function, heirs } in found {
        (of[function], kept[function]) = (heirs, false);
    }
    let (mut number, mut functions) = (Vec::with_capacity(of.len()), 0);
    for &kept in &kept {
        number.push(functions);
        functions += usize::from(kept);
    }
    let row = |heirs: &Vec<usize>| heirs.iter().map(|&k| (number[k], T::one() / lit(heirs.len() as f64))).collect();
    let rows = of.iter().map(row).collect();
    Box::new(Extracted::new::<S>(basis, functions, rows))
}

/// A side with the points of it that are covered.
struct Covered<'a, const S: usize, const N: usize, T: Real> {
    basis: &'a dyn Basis<S, T>,
    space: &'a dyn Geometry<S, N, T>,
    segments: &'a Segments<S, T>,
    /// Points of each element.
    own: Vec<Vec<Range<usize>>>,
    /// Integral of each function over what is covered of the elements that are covered in part.
    covered: Vec<f64>,
    is_sliver: Vec<bool>,
}

impl<'a, const S: usize, const N: usize, T: Real> Covered<'a, S, N, T> {
    fn new(basis: &'a dyn Basis<S, T>, space: &'a dyn Geometry<S, N, T>, segments: &'a Segments<S, T>) -> Self {
        let mut own: Vec<Vec<Range<usize>>> = vec![Vec::new(); basis.num_elements()];
        (0..segments.num_pieces()).for_each(|piece| own[segments.slave[piece]].push(segments.points(piece)));
        Self { basis, space, segments, own, covered: Vec::new(), is_sliver: Vec::new() }
    }

    /// Elements that are covered in part.
    fn in_part(&self) -> Vec<usize> {
        let own = |e: usize| &self.own[e];
        (0..self.own.len()).filter(|&e| !own(e).is_empty() && !is_whole(self.segments, e, own(e))).collect()
    }

    /// Finds the functions that live on slivers.
    fn measure(&mut self, in_part: &[usize]) {
        let (basis, segments, n) = (self.basis, self.segments, self.basis.num_functions());
        let (mut ids, mut table, mut map) = (Vec::new(), ShapeTable::new(), MapTable::new());
        let mut on_whole = vec![false; n];
        for e in (0..self.own.len()).filter(|e| !self.own[*e].is_empty() && in_part.binary_search(e).is_err()) {
            basis.active(e, &mut ids);
            ids.iter().for_each(|&i| on_whole[i] = true);
        }
        // integrals over what is covered, and over whole elements
        let (mut covered, mut whole) = (vec![0.0; n], vec![0.0; n]);
        for &e in in_part {
            basis.active(e, &mut ids);
            for points in &self.own[e] {
                basis.tabulate(e, &segments.slave_xi[points.clone()], Order::Values, &mut table);
                for (q, ds) in segments.ds[points.clone()].iter().enumerate() {
                    ids.iter().zip(table.values(q)).for_each(|(&i, v)| covered[i] += to_f64(v.abs() * *ds));
                }
            }
            let rules = element_rule(basis, e, POINTS);
            let rule = rules.rule(0);
            basis.tabulate(e, &rule.points, Order::Values, &mut table);
            self.space.map(e, &rule.points, Order::Gradients, &mut map);
            for (q, &w) in rule.weights.iter().enumerate() {
                let ds = w * measure(&map.jacobian[q]);
                ids.iter().zip(table.values(q)).for_each(|(&i, v)| whole[i] += to_f64(v.abs() * ds));
            }
        }
        self.is_sliver = (0..n).map(|i| !on_whole[i] && covered[i] > 0.0 && covered[i] < (1.0 - SAME) * SLIVER * whole[i]).collect();
        self.covered = covered;
    }

    /// The functions with most of what is covered of those that live on no sliver.
    fn most_covered(&self, ids: impl Iterator<Item = usize>) -> Vec<usize> {
        greatest(ids.filter(|&i| !self.is_sliver[i]).map(|i| (i, self.covered[i])))
    }

    /// The functions on slivers that share elements with others, each with the one with which it has most in common on the elements `in_part`.
    fn by_common(&self, in_part: &[usize]) -> Vec<Sliver> {
        let (mut ids, mut table, mut common) = (Vec::new(), ShapeTable::new(), BTreeMap::<usize, BTreeMap<usize, f64>>::new());
        for &e in in_part {
            self.basis.active(e, &mut ids);
            for points in &self.own[e] {
                self.basis.tabulate(e, &self.segments.slave_xi[points.clone()], Order::Values, &mut table);
                for (q, ds) in self.segments.ds[points.clone()].iter().enumerate() {
                    let at = || ids.iter().copied().zip(table.values(q));
                    for (j, a) in at().filter(|(j, _)| self.is_sliver[*j]) {
                        let with = common.entry(j).or_default();
                        at().filter(|(k, _)| !self.is_sliver[*k])
                            .for_each(|(k, b)| *with.entry(k).or_default() += to_f64((*a * *b).abs() * *ds));
                    }
                }
            }
        }
        let found = common.into_iter().map(|(function, with)| Sliver { function, heirs: greatest(with.into_iter()) });
        found.filter(|sliver| !sliver.heirs.is_empty()).collect()
    }

    /// Functions of the element beside the end of element `e` of a curve that is covered.
    fn beside_on_curve(&self, e: usize) -> Vec<usize> {
        let (mut map, mut table, mut ids) = (MapTable::new(), ShapeTable::new(), Vec::new());
        let at_end = |at: usize| Vector::<S, T>::repeat(if at == 0 { T::zero() } else { T::one() });
        let mut end = |e: usize, at: usize| {
            self.space.map(e, &[at_end(at)], Order::Values, &mut map);
            map.x[0]
        };
        // the element at the end that is covered
        let xi = || self.own[e].iter().flat_map(|p| &self.segments.slave_xi[p.clone()]).map(|xi| to_f64(xi[0]));
        let (first, last) = (xi().fold(1.0, f64::min), xi().fold(0.0, f64::max));
        let here = end(e, usize::from(first >= 1.0 - last));
        let others = (0..self.own.len()).filter(|&b| b != e && !self.own[b].is_empty());
        let apart = others.flat_map(|b| [0, 1].map(|at| (b, at))).map(|(b, at)| (to_f64((end(b, at) - here).norm()), b, at));
        let Some((_, b, at)) = apart.min_by(|a, b| a.0.total_cmp(&b.0)) else { return Vec::new() };
        self.basis.active(b, &mut ids);
        self.basis.tabulate(b, &[at_end(at)], Order::Values, &mut table);
        greatest(ids.iter().zip(table.values(0)).filter(|(i, _)| !self.is_sliver[**i]).map(|(&i, v)| (i, to_f64(*v))))
    }

    /// Elements at every corner, by its id.
    fn at_corners(&self) -> HashMap<usize, Vec<usize>> {
        let (mut at, mut ids) = (HashMap::<usize, Vec<usize>>::new(), Vec::new());
        for e in 0..self.own.len() {
            self.basis.corners(e, &mut ids);
            ids.iter().for_each(|&id| at.entry(id).or_default().push(e));
        }
        at
    }

    /// Functions of the elements at the corners of element `e` of a surface.
    fn beside_on_surface(&self, e: usize, at_corners: &HashMap<usize, Vec<usize>>) -> Vec<usize> {
        let (mut corners, mut ids, mut all) = (Vec::new(), Vec::new(), Vec::new());
        self.basis.corners(e, &mut corners);
        for &other in corners.iter().flat_map(|id| &at_corners[id]).filter(|&&b| b != e && !self.own[b].is_empty()) {
            self.basis.active(other, &mut ids);
            all.extend_from_slice(&ids);
        }
        self.most_covered(all.into_iter())
    }
}

fn slivers<const S: usize, const N: usize, T: Real>(
    basis: &dyn Basis<S, T>,
    space: &dyn Geometry<S, N, T>,
    segments: &Segments<S, T>,
) -> Vec<Sliver> {
    let mut side = Covered::new(basis, space, segments);
    let in_part = side.in_part();
    if in_part.is_empty() {
        return Vec::new();
    }
    side.measure(&in_part);
    let at_corners = if S == 1 { HashMap::new() } else { side.at_corners() };
    let (mut ids, mut found) = (Vec::new(), side.by_common(if S == 1 { &[] } else { &in_part }));
    for &e in &in_part {
        basis.active(e, &mut ids);
        let mut mine = ids.iter().copied().filter(|&i| side.is_sliver[i]).peekable();
        if mine.peek().is_none() {
            continue;
        }
        let beside = || if S == 1 { side.beside_on_curve(e) } else { side.beside_on_surface(e, &at_corners) };
        let mut heirs = side.most_covered(ids.iter().copied());
        if heirs.is_empty() {
            heirs = beside();
        }
        if !heirs.is_empty() {
            found.extend(mine.map(|function| Sliver { function, heirs: heirs.clone() }));
        }
    }
    found.sort_by_key(|s| s.function);
    found.dedup_by_key(|s| s.function);
    found
}
