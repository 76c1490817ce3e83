//! Multiplier fields, jumps and tractions at the points of segments, for reports and error norms.

use super::{CouplingError, Interface, Segments, Side};
use crate::basis::{Basis, Order, ShapeTable};
use crate::geometry::{Geometry, MapTable};
use crate::linalg::{Real, Vector};
use crate::physics::FluxTable;

/// Evaluates lambda at a local point of a slave element, one value per component.
///
/// `multiplier` and `lambda` as in the rows of [`super::Mortar`]: one space for all components, or one each; component
/// after component.
pub fn multiplier_at<const S: usize, T: Real>(
    multiplier: &[&dyn Basis<S, T>],
    components: usize,
    lambda: &[T],
    element: usize,
    xi: &Vector<S, T>,
) -> Vec<T> {
    let (mut table, mut ids, mut first) = (ShapeTable::new(), Vec::new(), 0);
    (0..components)
        .map(|c| {
            let psi = multiplier[if multiplier.len() == 1 { 0 } else { c }];
            psi.active(element, &mut ids);
            psi.tabulate(element, &[*xi], Order::Values, &mut table);
            let value = ids.iter().zip(table.values(0)).fold(T::zero(), |s, (&j, &v)| s + lambda[first + j] * v);
            first += psi.num_functions();
            value
        })
        .collect()
}

/// Evaluates lambda at the points of `segments`: `values[component][point]`.
pub fn multiplier_values<const S: usize, T: Real>(
    multiplier: &[&dyn Basis<S, T>],
    components: usize,
    lambda: &[T],
    segments: &Segments<S, T>,
) -> Vec<Vec<T>> {
    let (mut table, mut ids, mut first) = (ShapeTable::new(), Vec::new(), 0);
    (0..components)
        .map(|c| {
            let psi = multiplier[if multiplier.len() == 1 { 0 } else { c }];
            let mut values = Vec::with_capacity(segments.ds.len());
            for piece in 0..segments.num_pieces() {
                let points = segments.points(piece);
                psi.active(segments.slave[piece], &mut ids);
                psi.tabulate(segments.slave[piece], &segments.slave_xi[points.clone()], Order::Values, &mut table);
                let at = |q: usize| ids.iter().zip(table.values(q)).fold(T::zero(), |s, (&j, &v)| s + lambda[first + j] * v);
                values.extend((0..points.len()).map(at));
            }
            first += psi.num_functions();
            values
        })
        .collect()
}

/// The slave points of `segments`, and the outward unit normals of the slave there.
pub fn slave_points<const S: usize, const N: usize, T: Real>(
    side: &Side<'_, S, N, T>,
    segments: &Segments<S, T>,
) -> (Vec<Vector<N, T>>, Vec<Vector<N, T>>) {
    let (mut places, mut normals, mut map) = (Vec::new(), Vec::new(), MapTable::new());
    for piece in 0..segments.num_pieces() {
        let element = segments.slave[piece];
        side.trace.space.map(element, &segments.slave_xi[segments.points(piece)], Order::Gradients, &mut map);
        places.extend_from_slice(&map.x);
        normals.extend(map.jacobian.iter().map(|j| side.trace.normal(element, j)));
    }
    (places, normals)
}

/// u_slave - u_master at the points of the segments: `values[component][point]`; without a master u_slave.
pub fn jumps<const S: usize, const N: usize, T: Real>(interface: &Interface<'_, S, N, T>, unknowns: &[T]) -> Vec<Vec<T>> {
    let segments = interface.segments;
    let mut values = vec![vec![T::zero(); segments.ds.len()]; interface.slave.field.components];
    let (mut table, mut ids) = (ShapeTable::new(), Vec::new());
    let sides = [(Some(&interface.slave), T::one()), (interface.master.as_ref(), -T::one())];
    for (k, (side, sign)) in sides.into_iter().enumerate() {
        let Some(side) = side else { continue };
        for piece in 0..segments.num_pieces() {
            let points = segments.points(piece);
            let element = if k == 0 { segments.slave[piece] } else { segments.master[piece] };
            let xi = if k == 0 { &segments.slave_xi } else { &segments.master_xi };
            side.trace.space.active(element, &mut ids);
            side.trace.space.tabulate(element, &xi[points.clone()], Order::Values, &mut table);
            for (at, q) in points.enumerate() {
                for (c, values) in values.iter_mut().enumerate() {
                    let u = |i: usize| unknowns[side.field.unknown(side.trace.dofs[i], c)];
                    values[q] += ids.iter().zip(table.values(at)).fold(T::zero(), |s, (&i, &v)| s + u(i) * v) * sign;
                }
            }
        }
    }
    values
}

/// Minus the slave's traction sigma n at the points of the segments: `values[component][point]`.
///
/// # Errors
/// [`CouplingError::Missing`] where the slave has no flux.
pub fn slave_flux<const S: usize, const N: usize, T: Real>(
    interface: &Interface<'_, S, N, T>,
    unknowns: &[T],
) -> Result<Vec<Vec<T>>, CouplingError> {
    let (segments, side) = (interface.segments, &interface.slave);
    let flux = side.flux.ok_or_else(|| CouplingError::Missing("the traction of the slave needs the flux of its body".into()))?;
    let (components, mut table) = (side.field.components, FluxTable::default());
    let mut values = vec![Vec::with_capacity(segments.ds.len()); components];
    for piece in 0..segments.num_pieces() {
        let points = segments.points(piece);
        flux.tabulate(segments.slave[piece], &segments.slave_xi[points.clone()], &mut table);
        for q in 0..points.len() {
            for (c, values) in values.iter_mut().enumerate() {
                let row = &table.values[(q * components + c) * table.dofs.len()..][..table.dofs.len()];
                values.push(row.iter().zip(&table.dofs).fold(T::zero(), |s, (&t, &i)| s - t * unknowns[i]));
            }
        }
    }
    Ok(values)
}

/// (∫ sum_c v_c² ds)^1/2 of values at the points of `segments`, as returned by [`jumps`] and [`multiplier_values`].
pub fn norm<const S: usize, T: Real>(values: &[Vec<T>], segments: &Segments<S, T>) -> T {
    let square = |q: usize| values.iter().fold(T::zero(), |s, v| s + v[q] * v[q]);
    segments.ds.iter().enumerate().fold(T::zero(), |s, (q, &ds)| s + square(q) * ds).sqrt()
}

/// ∫ v ds per component of values at the points of `segments`.
pub fn integral<const S: usize, T: Real>(values: &[Vec<T>], segments: &Segments<S, T>) -> Vec<T> {
    values.iter().map(|v| v.iter().zip(&segments.ds).fold(T::zero(), |s, (&v, &ds)| s + v * ds)).collect()
}
