//! Contract of [`Body`]: the traces of its sides agree with its space, and outward signs point out of it.

use crate::basis::{Elements, Order, ShapeTable};
use crate::geometry::{Geometry, MapTable, cell, cross};
use crate::linalg::{Matrix, Real, Vector, lit, num};
use crate::quadrature::{Quadrature, TensorRule, simplex_rule};
use crate::space::{Body, SideError, Trace, measure};
use std::collections::HashSet;

/// Checks `body`, its space and the traces of all its sides.
///
/// Rules: spaces of body and sides keep those of [`basis`](super::basis()) and [`space`](super::space()), and their functions are
/// continuous where elements share a facet, which an `active` in another order than the table breaks; side names are listed once; an
/// unknown side is [`SideError::Unknown`]; a trace has one facet and one `outward` sign per element and one dof per function, no dof
/// twice; its map is the body's through the facets; its functions are the body's through `dofs`, and the body's other functions vanish
/// there; facets lie on the boundary of their cell; `outward` leaves it.
///
/// # Errors
/// A sentence that names the broken rule and the place.
pub fn body<const S: usize, const N: usize, T: Real, B: Body<S, N, T> + ?Sized>(body: &B) -> Result<(), String> {
    let of_body = |e: String| format!("the body's space: {e}");
    super::space::space(&**body.space()).map_err(of_body)?;
    super::basis::basis(&**body.space()).map_err(of_body)?;
    super::continuous::continuous(&**body.space(), Some(&outer(body))).map_err(of_body)?;
    let sides = body.sides();
    let nowhere = "no-such-side";
    if !matches!(body.trace(nowhere), Err(SideError::Unknown { .. })) {
        return Err(format!("asking for the side `{nowhere}` is not answered by SideError::Unknown"));
    }
    for (k, name) in sides.iter().enumerate() {
        if sides[..k].contains(name) {
            return Err(format!("the side `{name}` is listed twice"));
        }
        let trace = body.trace(name).map_err(|e| format!("the side `{name}` is listed but has no trace: {e}"))?;
        one_trace(body, &trace).map_err(|e| format!("side `{name}`: {e}"))?;
    }
    Ok(())
}

/// Element and face of the facets of all sides.
fn outer<const S: usize, const N: usize, T: Real, B: Body<S, N, T> + ?Sized>(body: &B) -> HashSet<(usize, usize)> {
    let mut faces = HashSet::new();
    for trace in body.sides().iter().filter_map(|name| body.trace(name).ok()) {
        for (e, facet) in trace.facets.iter().enumerate().filter(|(_, f)| f.element < body.space().num_elements()) {
            let corners: Vec<Vector<N, T>> = cell::corners::<S, T>(trace.space.cell(e)).iter().map(|c| facet.lift(c)).collect();
            faces.extend(cell::face_of(body.space().cell(facet.element), &corners, lit(1e-6)).map(|face| (facet.element, face)));
        }
    }
    faces
}

/// Checks `body` as [`body`] does, and that its sides are its whole boundary: Gauss' theorem.
///
///   ∮ n ds = 0,   ∮ x . n ds = N |body|
///
/// # Errors
/// A sentence that names the broken rule and the place.
pub fn closed_body<const S: usize, const N: usize, T: Real, B: Body<S, N, T> + ?Sized>(body: &B) -> Result<(), String> {
    self::body(body)?;
    let rules = [TensorRule::<S, T>::gauss([20; S]).rule(0).clone(), simplex_rule::<S, T>(39)];
    let mut table = MapTable::new();
    let (mut flux, mut volume, mut surface) = (Vector::<N, T>::zeros(), T::zero(), T::zero());
    for name in body.sides() {
        let trace = body.trace(&name).map_err(|e| e.to_string())?;
        for e in 0..trace.facets.len() {
            let rule = &rules[usize::from(trace.space.cell(e) == crate::basis::Cell::Simplex)];
            trace.space.map(e, &rule.points, Order::Gradients, &mut table);
            for (q, &w) in rule.weights.iter().enumerate() {
                let n = cross(&table.jacobian[q]) * (trace.outward[e] * w);
                flux += n;
                surface += n.norm();
                volume += table.x[q].dot(&n) / num(N);
            }
        }
    }
    let inside = measure(&**body.space());
    let near = T::default_epsilon() * num(20_000);
    if flux.norm() > surface * near {
        return Err(format!("the outward normals do not sum to zero: {flux:?} of a surface of {surface}"));
    }
    if (volume - inside).abs() > inside * near {
        return Err(format!("the volume seen from the sides is {volume}, from inside {inside}"));
    }
    Ok(())
}

fn one_trace<const S: usize, const N: usize, T: Real, B: Body<S, N, T> + ?Sized>(body: &B, trace: &Trace<S, N, T>) -> Result<(), String> {
    let of_side = |e: String| format!("its space: {e}");
    super::space::space(&*trace.space).map_err(of_side)?;
    super::basis::basis(&*trace.space).map_err(of_side)?;
    super::continuous::continuous(&*trace.space, None).map_err(of_side)?;
    let (elements, functions) = (trace.space.num_elements(), trace.space.num_functions());
    if trace.facets.len() != elements || trace.outward.len() != elements {
        return Err(format!("{} facets and {} signs for {elements} elements", trace.facets.len(), trace.outward.len()));
    }
    if trace.dofs.len() != functions {
        return Err(format!("{} dofs for {functions} functions", trace.dofs.len()));
    }
    let space = &**body.space();
    let mut seen = vec![false; space.num_functions()];
    for &dof in &trace.dofs {
        if dof >= seen.len() || std::mem::replace(&mut seen[dof], true) {
            return Err(format!("dof {dof} is listed twice or is none of the body"));
        }
    }
    let near = T::default_epsilon() * num(2000);
    let (mut side, mut inside) = (ShapeTable::new(), ShapeTable::new());
    let (mut side_map, mut inside_map) = (MapTable::new(), MapTable::new());
    let (mut side_ids, mut inside_ids) = (Vec::new(), Vec::new());
    for e in 0..elements {
        let facet = &trace.facets[e];
        let kind = trace.space.cell(e);
        let parent = space.cell(facet.element);
        let corners: Vec<Vector<N, T>> = cell::corners::<S, T>(kind).iter().map(|c| facet.lift(c)).collect();
        if cell::face_of(parent, &corners, lit(1e-6)).is_none() || !corners.iter().all(|c| cell::contains(parent, c, lit(1e-6))) {
            return Err(format!("facet {e} is not on the boundary of its cell"));
        }
        let points = super::geometry::sample_points::<S, T>(kind);
        let lifted: Vec<Vector<N, T>> = points.iter().map(|xi| facet.lift(xi)).collect();
        trace.space.evaluate(e, &points, Order::Gradients, &mut side, &mut side_map);
        space.evaluate(facet.element, &lifted, Order::Gradients, &mut inside, &mut inside_map);
        trace.space.active(e, &mut side_ids);
        space.active(facet.element, &mut inside_ids);
        let size = space.bounds(facet.element).diagonal() + inside_map.x[0].amax();
        for q in 0..points.len() {
            let at = format!("element {e}, xi = {:?}", points[q]);
            let tangents: Matrix<N, S, T> = inside_map.jacobian[q] * facet.axes;
            if (side_map.x[q] - inside_map.x[q]).amax() > near * size || (side_map.jacobian[q] - tangents).amax() > near * size {
                return Err(format!("{at}: its map is not the body's, {:?} against {:?}", side_map.x[q], inside_map.x[q]));
            }
            for (a, &i) in inside_ids.iter().enumerate() {
                let own = side_ids.iter().position(|&j| trace.dofs[j] == i).map_or(T::zero(), |b| side.values(q)[b]);
                if (own - inside.values(q)[a]).abs() > near {
                    return Err(format!("{at}: function {i} of the body has the value {}, on the side {own}", inside.values(q)[a]));
                }
            }
            for (b, &j) in side_ids.iter().enumerate() {
                if !inside_ids.contains(&trace.dofs[j]) && side.values(q)[b].abs() > near {
                    return Err(format!("{at}: function {j} lives on the side but its dof does not live in the cell behind"));
                }
            }
        }
        looks_out(trace, space, e)?;
    }
    Ok(())
}

/// Checks that a step along the normal from the middle of the facet leaves the cell.
fn looks_out<const S: usize, const N: usize, T: Real>(
    trace: &Trace<S, N, T>,
    space: &dyn crate::space::Space<N, N, T>,
    e: usize,
) -> Result<(), String> {
    let facet = &trace.facets[e];
    let parent = space.cell(facet.element);
    let xi = facet.lift(&cell::center::<S, T>(trace.space.cell(e)));
    let mut map = MapTable::new();
    space.map(facet.element, &[xi], Order::Gradients, &mut map);
    let tangents: Matrix<N, S, T> = map.jacobian[0] * facet.axes;
    let Some(inverse) = crate::linalg::inverse(&map.jacobian[0]) else { return Ok(()) };
    let step = inverse * trace.normal(e, &tangents);
    let step = step * (lit::<T>(1e-3) / step.norm());
    if (trace.outward[e].abs() - T::one()).abs() > T::zero() {
        return Err(format!("the sign of facet {e} is {}, neither 1 nor -1", trace.outward[e]));
    }
    if cell::contains(parent, &(xi + step), T::zero()) || !cell::contains(parent, &(xi - step), T::zero()) {
        return Err(format!("the normal of facet {e} at {:?} does not point out of the body", map.x[0]));
    }
    Ok(())
}
