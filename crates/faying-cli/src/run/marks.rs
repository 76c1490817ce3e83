//! Supports and loads as marks of a picture.

use crate::case::{Boundary, Case, Components, Datum, SideRef};
use crate::formula::{Formula, Point};
use crate::marks::{Mark, MarkKind};
use faying::basis::{Elements, Order};
use faying::geometry::{Geometry, MapTable, cell};
use faying::linalg::Vector;
use faying::problem::{BodyId, BodyView, Contents};
use faying::space::Trace;

/// Marks along a side of a body in the plane, and on one in space.
const MOST: [usize; 2] = [7, 25];

/// The displacement at a local point of an element of a body.
type Moved<'a, const N: usize> = &'a dyn Fn(BodyId, usize, &Vector<N>) -> Vector<N>;

/// The marks of all boundary blocks in elasticity at a time, with the displacements at their points.
pub fn of<const S: usize, const N: usize>(case: &Case, contents: &Contents<'_, S, N>, t: f64, moved: Moved<'_, N>) -> Vec<Mark> {
    if contents.components() == 1 {
        return Vec::new();
    }
    let held = |side: &SideRef| contents.supports().any(|s| s.is_side && s.body == side.patch && s.name == side.side);
    let mut marks = Vec::new();
    for block in &case.boundaries {
        for side in block.on.iter().map(|side| &side.value) {
            let body = contents.body(side.patch);
            let Ok(trace) = body.body().trace(&side.side) else { continue };
            let holds = holds(block) && held(side);
            for place in places(&body, &trace, moved) {
                let at = Point::new(place.at.as_slice()).at_time(t);
                if block.filter.as_ref().is_some_and(|f| f.value.value(&at) == 0.0) {
                    continue;
                }
                let (at_point, moved, normal) = (padded(&place.at), padded(&place.u), padded(&place.normal));
                let mark = |toward: Vector<N>, kind| Mark { at: at_point, moved, normal, toward: padded(&toward), kind };
                marks.extend(holds.then(|| mark(-place.normal, MarkKind::Support)));
                marks.extend(load(block, &at, &place.normal).map(|along| mark(along, MarkKind::Load)));
            }
        }
    }
    marks
}

fn padded<const N: usize>(x: &Vector<N>) -> [f64; 3] {
    std::array::from_fn(|k| x.get(k).copied().unwrap_or(0.0))
}

/// Whether a block prescribes displacements.
fn holds(block: &Boundary) -> bool {
    block.dirichlet.iter().any(Option::is_some) || block.fix_normal.is_some() || block.fix_tangential.is_some()
}

/// A point of a side.
struct Spot<const N: usize> {
    at: Vector<N>,
    normal: Vector<N>,
    u: Vector<N>,
}

/// Points spread evenly over a side, on surfaces at most one per element.
fn places<const S: usize, const N: usize>(body: &BodyView<'_, S, N>, trace: &Trace<S, N>, moved: Moved<'_, N>) -> Vec<Spot<N>> {
    let (space, most) = (&trace.space, MOST[S - 1]);
    // boxes of elements tell their sizes well enough
    let mut ends: Vec<f64> = (0..space.num_elements()).map(|e| space.bounds(e).diagonal().powi(S as i32)).collect();
    let whole: f64 = ends.iter_mut().fold(0.0, |sum, size| {
        *size += sum;
        *size
    });
    let (mut table, mut found, mut last) = (MapTable::new(), Vec::new(), None);
    for k in 0..most {
        let at = (k as f64 + 0.5) / most as f64 * whole;
        let e = ends.partition_point(|end| *end < at);
        let begin = if e == 0 { 0.0 } else { ends[e - 1] };
        if e == ends.len() || (S > 1 && last.replace(e) == Some(e)) {
            continue;
        }
        let xi = if S == 1 { Vector::<S>::repeat((at - begin) / (ends[e] - begin)) } else { cell::center::<S, f64>(space.cell(e)) };
        space.map(e, &[xi], Order::Gradients, &mut table);
        let facet = &trace.facets[e];
        let u = moved(body.id(), facet.element, &facet.lift(&xi));
        found.push(Spot { at: table.x[0], normal: trace.normal(e, &table.jacobian[0]), u });
    }
    found
}

/// Direction of the load of a block at a point; `None` where there is none.
fn load<const N: usize>(block: &Boundary, at: &Point, normal: &Vector<N>) -> Option<Vector<N>> {
    let value = |f: &Formula| Some(f.value(at)).filter(|v| v.is_finite()).unwrap_or(0.0);
    let resultant =
        |list: &Components<Formula>| Vector::<N>::from_fn(|k, _| list.get(k).and_then(Option::as_ref).map_or(0.0, |f| value(&f.value)));
    let traction = Vector::<N>::from_fn(|k, _| match block.traction.get(k).and_then(Option::as_ref).map(|d| &d.value) {
        Some(Datum::Formula(f)) => value(f),
        _ => 0.0,
    });
    let pressed = traction - normal * block.pressure.as_ref().map_or(0.0, |p| value(&p.value));
    let loads = [pressed, resultant(&block.force), resultant(&block.rigid_force)];
    loads.into_iter().find(|v| v.norm() > 0.0).map(|v| v.normalize())
}
