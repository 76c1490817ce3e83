//! Functions of a contact's multiplier that live on a sliver: the master ends within an element of the slave.
//!
//! The last functions on such an element face the master by a part of theirs that may be arbitrarily small, and nothing bounds the pressure
//! there: a hat function over 1e-4 of its element takes a tenth of the force with 5,000 times the mean pressure. So a function that lives on
//! elements covered in part alone, with less than [`SLIVER`] of its integral over these elements,
//!
//! ```text
//! ∫ |N_j| ds over what is covered  <  SLIVER ∫ |N_j| ds over the whole elements,
//! ```
//!
//! gives its share to the neighbour with most of what is covered: N_k' = N_k + N_j. The functions stay non-negative and sum to one. Where all
//! functions of an element are of that kind the neighbour is one of the element beside it, and without one they stay.

use super::covered::is_whole;
use crate::basis::{Basis, Extracted, Order, ShapeTable};
use crate::coupling::Segments;
use crate::geometry::{Geometry, MapTable};
use crate::linalg::{Real, Vector, measure, to_f64};
use crate::quadrature::gauss_legendre;
use std::ops::Range;

/// Least share of the integral of a function over its elements.
pub const SLIVER: f64 = 0.1;
/// Gauss points of an element beyond its degree.
const POINTS: usize = 4;

/// A function that lives on a sliver.
struct Sliver {
    function: usize,
    /// The function that takes its share.
    heir: usize,
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
pub fn without_slivers<const N: usize, T: Real>(
    basis: Box<dyn Basis<1, T>>,
    space: &dyn Geometry<1, N, T>,
    segments: &Segments<1, T>,
) -> Box<dyn Basis<1, T>> {
    let found = slivers(&*basis, space, segments);
    if found.is_empty() {
        return basis;
    }
    let (mut number, mut functions) = (Vec::with_capacity(basis.num_functions()), 0);
    for i in 0..basis.num_functions() {
        number.push(functions);
        functions += usize::from(found.iter().all(|s| s.function != i));
    }
    let mut rows: Vec<Vec<(usize, T)>> = number.iter().map(|&k| vec![(k, T::one())]).collect();
    for s in &found {
        rows[s.function] = vec![(number[s.heir], T::one())];
    }
    Box::new(Extracted::new::<1>(basis, functions, rows))
}

fn slivers<const N: usize, T: Real>(basis: &dyn Basis<1, T>, space: &dyn Geometry<1, N, T>, segments: &Segments<1, T>) -> Vec<Sliver> {
    let elements = basis.num_elements();
    let mut own: Vec<Vec<Range<usize>>> = vec![Vec::new(); elements];
    (0..segments.num_pieces()).for_each(|piece| own[segments.slave[piece]].push(segments.points(piece)));
    let in_part: Vec<usize> = (0..elements).filter(|&e| !own[e].is_empty() && !is_whole(segments, &own[e])).collect();
    if in_part.is_empty() {
        return Vec::new();
    }
    let (mut ids, mut table, mut map) = (Vec::new(), ShapeTable::new(), MapTable::new());
    let mut on_whole = vec![false; basis.num_functions()];
    for e in (0..elements).filter(|e| !own[*e].is_empty() && in_part.binary_search(e).is_err()) {
        basis.active(e, &mut ids);
        ids.iter().for_each(|&i| on_whole[i] = true);
    }
    // integrals over what is covered, and over whole elements
    let n = basis.num_functions();
    let (mut covered, mut whole) = (vec![0.0; n], vec![0.0; n]);
    for &e in &in_part {
        basis.active(e, &mut ids);
        for points in &own[e] {
            basis.tabulate(e, &segments.slave_xi[points.clone()], Order::Values, &mut table);
            for (q, ds) in segments.ds[points.clone()].iter().enumerate() {
                ids.iter().zip(table.values(q)).for_each(|(&i, v)| covered[i] += to_f64(v.abs() * *ds));
            }
        }
        let rule = gauss_legendre::<T>(basis.degree(e)[0] + POINTS);
        basis.tabulate(e, &rule.points, Order::Values, &mut table);
        space.map(e, &rule.points, Order::Gradients, &mut map);
        for (q, &w) in rule.weights.iter().enumerate() {
            let ds = w * measure(&map.jacobian[q]);
            ids.iter().zip(table.values(q)).for_each(|(&i, v)| whole[i] += to_f64(v.abs() * ds));
        }
    }
    let is_sliver = |i: usize| !on_whole[i] && covered[i] > 0.0 && covered[i] < SLIVER * whole[i];
    let end = |map: &mut MapTable<1, N, T>, e: usize, at: usize| {
        space.map(e, &[Vector::<1, T>::new(if at == 0 { T::zero() } else { T::one() })], Order::Values, map);
        map.x[0]
    };
    let mut found = Vec::new();
    for &e in &in_part {
        basis.active(e, &mut ids);
        let mine: Vec<usize> = ids.iter().copied().filter(|&i| is_sliver(i)).collect();
        let mut heir = ids.iter().copied().filter(|&i| !is_sliver(i)).max_by(|&a, &b| covered[a].total_cmp(&covered[b]));
        if heir.is_none() {
            // the element at the end that is covered
            let xi = || own[e].iter().flat_map(|p| &segments.slave_xi[p.clone()]).map(|xi| to_f64(xi[0]));
            let (first, last) = (xi().fold(1.0, f64::min), xi().fold(0.0, f64::max));
            let here = end(&mut map, e, usize::from(first >= 1.0 - last));
            let others = (0..elements).filter(|&b| b != e && !own[b].is_empty());
            let apart = others.flat_map(|b| [0, 1].map(|at| (b, at))).map(|(b, at)| (to_f64((end(&mut map, b, at) - here).norm()), b, at));
            let nearest = apart.min_by(|a, b| a.0.total_cmp(&b.0));
            heir = nearest.and_then(|(_, b, at)| {
                basis.active(b, &mut ids);
                basis.tabulate(b, &[Vector::<1, T>::new(if at == 0 { T::zero() } else { T::one() })], Order::Values, &mut table);
                let values = ids.iter().zip(table.values(0)).filter(|(i, _)| !is_sliver(**i));
                values.max_by(|a, b| to_f64(*a.1).total_cmp(&to_f64(*b.1))).map(|(i, _)| *i)
            });
        }
        let Some(heir) = heir else { continue };
        found.extend(mine.into_iter().map(|function| Sliver { function, heir }));
    }
    found.sort_by_key(|s| s.function);
    found.dedup_by_key(|s| s.function);
    found
}
