//! Reference cells: one table for many elements, lists of functions, and maps as functions and points.

use super::geometry::chosen;
use super::points;
use crate::basis::{Basis, Order, ShapeTable};
use crate::geometry::{Geometry, MapTable};
use crate::linalg::{Matrix, Real, Vector, num};

/// Checks that the list of the functions of all elements repeats them.
pub(super) fn listed<const D: usize, T: Real>(basis: &dyn Basis<D, T>) -> Result<(), String> {
    let Some(listed) = basis.structure().listed() else { return Ok(()) };
    if listed.first.len() != basis.num_elements() + 1 || listed.first.last() != Some(&listed.ids.len()) {
        return Err("the list of functions is not of all elements".into());
    }
    let mut ids = Vec::new();
    for e in 0..basis.num_elements() {
        basis.active(e, &mut ids);
        if listed.ids.get(listed.first[e]..listed.first[e + 1]) != Some(&ids) {
            return Err(format!("element {e}: the list names other functions than those that are active"));
        }
    }
    Ok(())
}

/// Checks that elements with the same reference cell have the same table, to the last bit.
pub(super) fn references<const D: usize, T: Real>(basis: &dyn Basis<D, T>) -> Result<(), String> {
    let mut known: Vec<(usize, usize)> = Vec::new();
    let (mut table, mut first_table) = (ShapeTable::new(), ShapeTable::new());
    for e in chosen(basis.num_elements()) {
        let Some(reference) = basis.structure().reference(e) else { continue };
        let Some(&(_, first)) = known.iter().find(|(r, _)| *r == reference) else {
            known.push((reference, e));
            continue;
        };
        if basis.cell(e) != basis.cell(first) {
            return Err(format!("elements {first} and {e} name one reference cell, and their cells differ"));
        }
        let xi = points::inside::<D, T>(basis.cell(e), 5);
        basis.tabulate(first, &xi, Order::Gradients, &mut first_table);
        basis.tabulate(e, &xi, Order::Gradients, &mut table);
        let same = table.num_functions() == first_table.num_functions()
            && (0..xi.len()).all(|q| table.values(q) == first_table.values(q) && table.grads(q) == first_table.grads(q));
        if !same {
            return Err(format!("elements {first} and {e} name one reference cell, and their tables differ"));
        }
    }
    Ok(())
}

/// Checks that the functions and control points of a map reproduce it.
pub(super) fn control<const D: usize, const N: usize, T: Real, G: Geometry<D, N, T> + ?Sized>(geometry: &G) -> Result<(), String> {
    let Some(control) = geometry.map_structure().control() else { return Ok(()) };
    if control.basis.num_elements() != geometry.num_elements() || control.basis.num_functions() != control.points.len() {
        return Err("the functions of the map are not on its elements, or not as many as its points".into());
    }
    let (mut ids, mut table, mut map) = (Vec::new(), ShapeTable::new(), MapTable::new());
    for e in chosen(geometry.num_elements()) {
        let xi = points::inside::<D, T>(geometry.cell(e), 5);
        geometry.map(e, &xi, Order::Gradients, &mut map);
        control.basis.active(e, &mut ids);
        control.basis.tabulate(e, &xi, Order::Gradients, &mut table);
        let size = ids.iter().fold(geometry.bounds(e).diagonal(), |m, &i| m.max(control.points[i].amax()));
        let near = T::default_epsilon() * num(200) * size;
        for q in 0..xi.len() {
            let (mut x, mut jacobian) = (Vector::<N, T>::zeros(), Matrix::<N, D, T>::zeros());
            for (&i, (&value, grad)) in ids.iter().zip(table.values(q).iter().zip(table.grads(q))) {
                x += control.points[i] * value;
                jacobian += control.points[i] * grad.transpose();
            }
            if (x - map.x[q]).amax() > near || (jacobian - map.jacobian[q]).amax() > near * num(10) {
                return Err(format!("element {e}: functions and points give another map"));
            }
        }
    }
    Ok(())
}
