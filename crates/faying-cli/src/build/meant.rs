//! Contacts between wrong sides: suggestions for better ones, and overlaps deeper than a press fit.

use super::builder::Builder;
use super::sides::alias;
use super::values::times;
use crate::case;
use crate::errors::Diagnostic;
use crate::words::{labels, short};
use faying::basis::Order;
use faying::geometry::{ClosestPoint, MapTable, cell};
use faying::linalg::Vector;
use faying::problem::touching::facing;
use faying::problem::{Against, ContactModel, ContactPart, Model, PatchModel, SideModel};
use faying::space::{Space, Trace};
use std::collections::BTreeSet;
use std::sync::Arc;

/// Least share of a side that must face another one for a suggestion.
const SEEN: f64 = 0.25;
/// Sides are suggested if they are closer than this fraction of the distance of the named ones.
const NEARER: f64 = 0.5;
/// Tolerance of the point-in-body test, as a fraction of the depth.
const INSIDE: f64 = 1e-3;
/// Depths, in multiples of the overlap, at which the body is tested.
const DEPTHS: [f64; 4] = [0.5, 1.0, 1.5, 2.0];
/// Share of the overlapping area beyond which an overlap deeper than half the thickness is an error.
const TOO_DEEP: f64 = 0.5;

/// Normals with less than this along an axis are perpendicular to it.
const PERPENDICULAR: f64 = 1e-9;

/// The patches of a body, to ask whether a point is in it.
type Body<const N: usize> = Vec<ClosestPoint<N, N, Arc<dyn Space<N, N>>>>;

/// Returns `plain`, with a hint to the sides of both bodies that face each other best if they are much closer than the named ones.
pub(super) fn meant<const S: usize, const N: usize>(
    model: &Model<S, N>,
    slave: &SideModel<S, N>,
    masters: &[Arc<SideModel<S, N>>],
    plain: Box<Diagnostic>,
) -> Box<Diagnostic> {
    let patches: BTreeSet<usize> = masters.iter().map(|m| m.patch).collect();
    let own = skins(&model.patches[slave.patch]);
    let mut best: Option<(f64, String)> = None;
    for (name, trace) in &own {
        for &patch in &patches {
            for (other, facing) in &skins(&model.patches[patch]) {
                let Some(apart) = mean_distance(trace, facing, model.size) else { continue };
                if best.as_ref().is_none_or(|b| apart < b.0) {
                    let [a, b] = [(slave.patch, name), (patch, other)].map(|(p, s)| format!("{}.{}", model.patches[p].name, alias(s, N)));
                    best = Some((apart, format!("their normals must oppose; `{a}` on `{b}` would face each other: were these meant?")));
                }
            }
        }
    }
    // the named sides may be right but too far apart
    let named = masters.iter().filter_map(|m| mean_distance(&slave.trace, &m.trace, model.size)).fold(f64::INFINITY, f64::min);
    match best.filter(|b| b.0 < NEARER * named) {
        Some((_, help)) => Box::new((*plain).with_help(help)),
        None => plain,
    }
}

fn skins<const S: usize, const N: usize>(patch: &PatchModel<S, N>) -> Vec<(String, Trace<S, N>)> {
    patch.body.sides().into_iter().filter_map(|name| Some((name.clone(), patch.body.trace(&name).ok()?))).collect()
}

/// Returns the mean |gap| of the facets of a side that face another; `None` if too few do.
fn mean_distance<const S: usize, const N: usize>(side: &Trace<S, N>, other: &Trace<S, N>, reach: f64) -> Option<f64> {
    facing(side, other, reach).filter(|f| f.share > SEEN).map(|f| f.distance)
}

/// E023 where a contact overlaps at the first time by more than half the thickness of a body along the normal, at most of the points that
/// overlap: by the place of its sides or of its obstacle, or by the gap that its formula gives.
pub(super) fn overlap<const S: usize, const N: usize>(
    builder: &Builder<'_, S, N>,
    model: &Model<S, N>,
    built: &ContactModel<S, N>,
    part: &ContactPart<S, N>,
    contact: &case::Contact,
) -> Option<Diagnostic> {
    // what an obstacle does later is a motion
    let then = part.changes.then(|| built.at(model, part, times(builder.case, false)[0]).ok()).flatten();
    let first = then.as_ref().unwrap_or(&part.first);
    let (segments, frames) = (&first.segments, &first.frames);
    let pressed = |n: &Vector<N>| built.obstacle.iter().flat_map(|o| &o.pressed).any(|p| n[p.component].abs() > PERPENDICULAR);
    let mut groups: Option<Vec<Body<N>>> = None;
    let (mut overlapping, mut deep, mut worst) = (0.0, 0.0, (0.0, Vector::<N>::zeros(), false));
    for piece in 0..segments.num_pieces() {
        let e = segments.slave[piece];
        for q in segments.points(piece) {
            let (gap, normal) = (frames.gap[q], frames.normal[q]);
            let depth = -gap.min(first.at_rest[q]);
            // a force moves its obstacle out of the body
            if depth <= 0.0 || pressed(&normal) {
                continue;
            }
            overlapping += segments.ds[q];
            let mut sides = vec![(&part.slave.trace, part.slave.patch_of(e), e, frames.x[q], normal)];
            if let Against::Side(master, _) = &part.against {
                let f = segments.master[piece];
                sides.push((&master.trace, master.patch_of(f), f, frames.x[q] - normal * gap, -normal));
            }
            // most fits are less deep than the element behind the side
            if sides.iter().all(|(trace, patch, element, ..)| 2.0 * depth <= element_depth(model, trace, *patch, *element, &normal)) {
                continue;
            }
            let groups = groups.get_or_insert_with(|| {
                let masters: Vec<usize> = part.masters.iter().map(|m| m.patch).collect();
                vec![body(model, &[part.slave.patch]), body(model, &masters)]
            });
            let thin = sides.iter().zip(&*groups).any(|((.., x, inward), group)| {
                DEPTHS.iter().any(|d| {
                    let at = x + inward * (depth * (d - INSIDE));
                    !group.iter().any(|c| c.project_within(&at, depth * INSIDE + model.size * 1e-12).is_some())
                })
            });
            if thin {
                deep += segments.ds[q];
                if depth > worst.0 {
                    worst = (depth, frames.x[q], depth > -gap);
                }
            }
        }
    }
    if deep <= TOO_DEEP * overlapping {
        return None;
    }
    let (depth, x, by_formula) = worst;
    let at: Vec<String> = ["x", "y", "z"][..N].iter().zip(x.iter()).map(|(l, v)| format!("{l} = {}", short(*v))).collect();
    let (opponent, help) = match &part.against {
        Against::Side(..) => {
            (format!("the body of {}", labels(&part.masters)), "move the bodies apart, or choose the sides that face each other")
        }
        Against::Rigid(..) => (
            format!("the obstacle of contact \"{}\"", contact.name.value),
            "move the obstacle out of the body, or choose the side that faces it; what `move` prescribes may grow over [steps]",
        ),
    };
    let text = format!(
        "`{}` lies {} deep in {opponent}{} (at {}): more than half of a body's thickness",
        part.slave.label,
        short(depth),
        if by_formula { " by the formula of `gap`" } else { "" },
        at.join(", ")
    );
    if by_formula {
        let help = "`gap` is a length: g is the distance of the sides, \"g - 0.001\" a press fit";
        return Some(builder.error("E023", text, contact.gap.at).with_help(help));
    }
    let plain = Box::new(builder.error("E023", text, contact.head.at).with_help(help));
    Some(*if part.masters.is_empty() { plain } else { meant(model, &part.slave, &part.masters, plain) })
}

/// Depth of the element behind a facet: twice the distance between the centres of facet and cell along `normal`.
fn element_depth<const S: usize, const N: usize>(
    model: &Model<S, N>,
    trace: &Trace<S, N>,
    patch: usize,
    element: usize,
    normal: &Vector<N>,
) -> f64 {
    let space = model.patches[patch].body.space();
    let facet = &trace.facets[element];
    let mut table = MapTable::new();
    let points = [facet.lift(&cell::center(trace.space.cell(element))), cell::center(space.cell(facet.element))];
    space.map(facet.element, &points, Order::Values, &mut table);
    2.0 * (table.x[0] - table.x[1]).dot(normal).abs()
}

/// Returns the patches that form one body with `patches`: glued to them, or tied.
fn body<const S: usize, const N: usize>(model: &Model<S, N>, patches: &[usize]) -> Body<N> {
    let mut members: BTreeSet<usize> = patches.iter().copied().collect();
    loop {
        let before = members.len();
        let roots: BTreeSet<usize> = members.iter().map(|&k| model.glued.body(k)).collect();
        members.extend((0..model.patches.len()).filter(|&k| roots.contains(&model.glued.body(k))));
        for part in model.ties.iter().flat_map(|t| &t.parts) {
            let sides: Vec<usize> = part.pairings.iter().map(|p| p.master.patch).chain([part.slave.patch]).collect();
            if sides.iter().any(|k| members.contains(k)) {
                members.extend(sides);
            }
        }
        if members.len() == before {
            return members.into_iter().map(|k| ClosestPoint::new(Arc::clone(model.patches[k].body.space()))).collect();
        }
    }
}
