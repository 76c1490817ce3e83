//! Rule of the spaces of bodies: their functions are continuous where elements share a facet.

use super::geometry::chosen;
use crate::basis::{Cell, Order, ShapeTable};
use crate::geometry::{MapTable, cell};
use crate::linalg::{Real, Vector, lit, num, to_f64};
use crate::space::Space;
use std::collections::HashSet;

/// Largest jump of a function, in units of rounding of the largest value.
const JUMP: f64 = 1e5;

/// A facet of an element: its face, its corners in local coordinates, in space, and their ids (none if unknown).
struct Facet<const D: usize, const N: usize, T: Real> {
    face: usize,
    local: Vec<Vector<D, T>>,
    place: Vec<Vector<N, T>>,
    ids: Vec<usize>,
}

/// Checks that functions have one value from both sides of the facets that two elements share.
///
/// Elements with corner ids share the facets whose ids they share, others those at one place if as many functions live on both as the
/// facet has corners. `sides`: element and face of the facets on the boundary, which may lie at one place without being joined, as the
/// ends of an open ring do; `None` if they are not known, and then only functions that live on both elements are compared.
pub(super) fn continuous<const D: usize, const N: usize, T: Real>(
    space: &dyn Space<D, N, T>,
    sides: Option<&HashSet<(usize, usize)>>,
) -> Result<(), String> {
    let boxes = space.all_bounds();
    let (mut own, mut other) = (ShapeTable::new(), ShapeTable::new());
    let (mut own_ids, mut other_ids, mut map) = (Vec::new(), Vec::new(), MapTable::new());
    for e in chosen(space.num_elements()) {
        let near = (boxes[e].diagonal() + boxes[e].lo.amax()) * T::default_epsilon() * num(1000);
        let (around, own_facets) = (boxes[e].inflated(near), facets(space, e, near));
        for f in (0..boxes.len()).filter(|&f| f != e && around.meets(&boxes[f])) {
            for Shared { here, there, faces, named } in shared(&own_facets, &facets(space, f, near), near) {
                let (a, b) = (points(&here), points(&there));
                // corners at one place do not make one curve
                space.map(e, &a, Order::Values, &mut map);
                let x = map.x.clone();
                space.map(f, &b, Order::Values, &mut map);
                if x.iter().zip(&map.x).any(|(x, y)| (x - y).amax() > near) {
                    continue;
                }
                space.active(e, &mut own_ids);
                space.active(f, &mut other_ids);
                space.tabulate(e, &a, Order::Values, &mut own);
                space.tabulate(f, &b, Order::Values, &mut other);
                let common = own_ids.iter().filter(|i| other_ids.contains(i)).count();
                let inside = |sides: &HashSet<(usize, usize)>| !sides.contains(&(e, faces[0])) && !sides.contains(&(f, faces[1]));
                let joined = sides.is_some_and(inside) && (named || common >= here.len());
                for q in 0..a.len() {
                    let largest = own.values(q).iter().chain(other.values(q)).fold(0.0, |m: f64, v| m.max(to_f64(v.abs())));
                    let value = |ids: &[usize], table: &ShapeTable<D, T>, i: usize| {
                        ids.iter().position(|&j| j == i).map(|k| to_f64(table.values(q)[k]))
                    };
                    for &i in own_ids.iter().chain(&other_ids) {
                        let (left, right) = (value(&own_ids, &own, i), value(&other_ids, &other, i));
                        if !joined && (left.is_none() || right.is_none()) {
                            continue;
                        }
                        let jump = left.unwrap_or(0.0) - right.unwrap_or(0.0);
                        if jump.is_nan() || jump.abs() > JUMP * to_f64(T::default_epsilon()) * largest {
                            return Err(format!(
                                "function {i} jumps by {jump:e} from element {e} to {f} at {:?}; `active` may list other functions than the table",
                                x[q]
                            ));
                        }
                    }
                }
            }
        }
    }
    Ok(())
}

/// The facets of an element whose corners lie apart.
fn facets<const D: usize, const N: usize, T: Real>(space: &dyn Space<D, N, T>, e: usize, near: T) -> Vec<Facet<D, N, T>> {
    let kind = space.cell(e);
    let corners = cell::corners::<D, T>(kind);
    let (mut ids, mut map) = (Vec::new(), MapTable::new());
    space.corners(e, &mut ids);
    space.map(e, &corners, Order::Values, &mut map);
    let on = |face: usize, c: &Vector<D, T>| match kind {
        // of a simplex the last face is opposite to the origin
        Cell::Simplex if face == D => c.sum() == T::one(),
        Cell::Simplex => c[face] == T::zero(),
        Cell::Tensor => c[face / 2] == num::<T>(face % 2),
    };
    let count = if kind == Cell::Simplex { D + 1 } else { 2 * D };
    (0..count)
        .map(|face| {
            let list: Vec<usize> = (0..corners.len()).filter(|&k| on(face, &corners[k])).collect();
            Facet {
                face,
                local: list.iter().map(|&k| corners[k]).collect(),
                place: list.iter().map(|&k| map.x[k]).collect(),
                ids: list.iter().filter_map(|&k| ids.get(k).copied()).collect(),
            }
        })
        .filter(|f| (0..f.place.len()).all(|k| f.place[..k].iter().all(|x| (x - f.place[k]).amax() > near)))
        .collect()
}

/// A facet in the local coordinates of both elements, its corners in the same order; its faces, and whether both name it by the same ids.
struct Shared<const D: usize, T: Real> {
    here: Vec<Vector<D, T>>,
    there: Vec<Vector<D, T>>,
    faces: [usize; 2],
    named: bool,
}

/// Facets of the first list that are one of the second.
fn shared<const D: usize, const N: usize, T: Real>(own: &[Facet<D, N, T>], other: &[Facet<D, N, T>], near: T) -> Vec<Shared<D, T>> {
    let mut found = Vec::new();
    for here in own {
        for there in other.iter().filter(|f| f.place.len() == here.place.len()) {
            let named = !here.ids.is_empty() && !there.ids.is_empty();
            let same = |j: usize, k: usize| match named {
                true => here.ids[j] == there.ids[k],
                false => (here.place[j] - there.place[k]).amax() <= near,
            };
            let count = here.place.len();
            let order: Vec<usize> = (0..count).filter_map(|j| (0..count).find(|&k| same(j, k))).collect();
            if order.len() == count {
                let there_too = order.into_iter().map(|k| there.local[k]).collect();
                found.push(Shared { here: here.local.clone(), there: there_too, faces: [here.face, there.face], named });
            }
        }
    }
    found
}

/// Points of a facet given by its corners: their means with fixed weights, products of univariate ones on four corners.
fn points<const D: usize, T: Real>(corners: &[Vector<D, T>]) -> Vec<Vector<D, T>> {
    const SHARES: [[f64; 2]; 3] = [[0.21, 0.37], [0.63, 0.12], [0.08, 0.55]];
    let weights = |[s, t]: [f64; 2]| match corners.len() {
        1 => vec![1.0],
        2 => vec![1.0 - s, s],
        3 => vec![1.0 - s - t, s, t],
        _ => vec![(1.0 - s) * (1.0 - t), s * (1.0 - t), (1.0 - s) * t, s * t],
    };
    let mean = |w: Vec<f64>| corners.iter().zip(w).fold(Vector::zeros(), |x, (c, w)| x + c * lit::<T>(w));
    SHARES.iter().map(|&share| mean(weights(share))).collect()
}
