//! Directions along which the functions of a contact side are pressed, and along which they cannot move.

use super::model::{BodySide, Model, Opposing};
use crate::basis::{Order, ShapeTable};
use crate::contact::opposed;
use crate::geometry::{ClosestPoint, MapTable, cell};
use crate::linalg::Vector;
use std::collections::HashMap;

/// Function values below this count as zero.
const NO_VALUE: f64 = 1e-10;

/// Directions along which the functions of a side cannot move by conditions between components: inclined sliding.
pub fn slides<const S: usize, const N: usize>(model: &Model<S, N>, side: &BodySide<S, N>) -> Vec<(usize, Vector<N>)> {
    let field = model.patches[side.patch].field;
    let range = model.patches[side.patch].range();
    let mut out = Vec::new();
    for e in model.equations.iter().map(|e| &e.equation) {
        let place = |i: usize| range.contains(&i).then(|| ((i - field.first) / field.components, (i - field.first) % field.components));
        let Some((function, _)) = e.terms.first().and_then(|t| place(t.0)) else { continue };
        let mut d = Vector::<N>::zeros();
        let mut own = true;
        for &(i, value) in &e.terms {
            match place(i) {
                Some((f, c)) if f == function => d[c] += value,
                _ => own = false,
            }
        }
        if own && d.norm() > 0.0 {
            out.push((function, d / d.norm()));
        }
    }
    out
}

/// The direction of contact of every function, where it is largest among `n` points per direction of each element that
/// it does not vanish at: the normal of what is faced, the side's own where nothing is. Two points are the corners.
pub fn directions<const S: usize, const N: usize>(
    side: &BodySide<S, N>,
    against: Option<&Opposing<S, N>>,
    t: f64,
    n: usize,
) -> HashMap<usize, Vector<N>> {
    let (space, trace) = (&*side.trace.space, &side.trace);
    let mut other = MapTable::new();
    let (closest, target) = match against {
        Some(Opposing::Side(master, _)) => (Some(ClosestPoint::new(master.trace.oriented())), None),
        Some(Opposing::Rigid(obstacle, ..)) => (None, Some(obstacle.target(t, None))),
        None => (None, None),
    };
    let mut facing = |x: &Vector<N>, own: &Vector<N>| match against {
        Some(Opposing::Rigid(..)) => opposed(&**target.as_ref()?, x, own).map(|hit| hit.normal),
        Some(Opposing::Side(master, _)) => {
            let closest = closest.as_ref()?;
            // beyond an end of the master its direction there counts
            let foot = closest.project_opposed(x, own, closest.size())?;
            master.trace.space.map(foot.element, &[foot.xi], Order::Gradients, &mut other);
            Some(master.trace.normal(foot.element, &other.jacobian[0]))
        }
        None => None,
    };
    let (mut shapes, mut map, mut ids) = (ShapeTable::new(), MapTable::new(), Vec::new());
    let mut out: HashMap<usize, (f64, Vector<N>)> = HashMap::new();
    for e in 0..space.num_elements() {
        let points = cell::grid::<S, f64>(space.cell(e), n);
        space.active(e, &mut ids);
        space.evaluate(e, &points, Order::Gradients, &mut shapes, &mut map);
        for q in 0..points.len() {
            let own = trace.normal(e, &map.jacobian[q]);
            let normal = facing(&map.x[q], &own).unwrap_or(own);
            if !normal.iter().all(|v| v.is_finite()) {
                continue;
            }
            for (&i, value) in ids.iter().zip(shapes.values(q)) {
                if value.abs() > NO_VALUE {
                    let best = out.entry(trace.dofs[i]).or_insert((0.0, normal));
                    if value.abs() > best.0 {
                        *best = (value.abs(), normal);
                    }
                }
            }
        }
    }
    out.into_iter().map(|(f, (_, normal))| (f, normal)).collect()
}

/// Normal of a side at every function: where it is largest at corners, or inside of elements if it vanishes at corners.
pub fn normals<const S: usize, const N: usize>(side: &BodySide<S, N>) -> HashMap<usize, Vector<N>> {
    let mut normals = directions(side, None, 0.0, side.degree() + 2);
    normals.extend(directions(side, None, 0.0, 2));
    normals
}
