//! Contacts between wrong sides: suggestions for better ones, and overlaps deeper than a press fit.

use super::Builder;
use super::sides::alias;
use super::ties::{labels, short};
use crate::case;
use crate::errors::Diagnostic;
use faying::basis::Order;
use faying::geometry::{ClosestPoint, MapTable, Sag, cell};
use faying::linalg::Vector;
use faying::problem::{Against, ContactPart, Model, PatchModel, SideModel};
use faying::space::{Skin, Space, Trace, raised, skin_points};
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

/// Closest-point searches on the patches of a body, to test whether a point is inside.
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
    let [own, far] = [side, other].map(|t| Sag::none(t.facets.len()));
    let (skin, mut table) = (Skin::new(other, &far), MapTable::new());
    let (mut sum, mut seen, mut all) = (0.0, 0.0, 0.0);
    for (f, bounds) in side.space.all_bounds().iter().enumerate() {
        let weight = bounds.diagonal().powi(S as i32);
        all += weight;
        let middle = raised(side, &own, f, &skin_points(side.space.cell(f))[..1], &mut table)[0];
        if let Some(sight) = skin.sight(&middle, reach, 0.0, &mut table) {
            sum += sight.gap.abs() * weight;
            seen += weight;
        }
    }
    (seen > SEEN * all).then(|| sum / seen)
}

/// Returns E023 if the sides overlap at rest by more than half the thickness of a body along the normal, on more than half of the
/// overlapping area.
pub(super) fn overlap<const S: usize, const N: usize>(
    builder: &Builder<'_, S, N>,
    model: &Model<S, N>,
    part: &ContactPart<S, N>,
    contact: &case::Contact,
) -> Option<Diagnostic> {
    let Against::Side(master, _) = &part.against else { return None };
    let (segments, frames) = (&part.first.segments, &part.first.frames);
    let traces = [&part.slave.trace, &master.trace];
    let mut groups: Option<[Body<N>; 2]> = None;
    let (mut overlapping, mut deep, mut worst) = (0.0, 0.0, (0.0, Vector::<N>::zeros()));
    for piece in 0..segments.num_pieces() {
        let (e, f) = (segments.slave[piece], segments.master[piece]);
        for q in segments.points(piece) {
            let depth = -frames.gap[q];
            if depth <= 0.0 {
                continue;
            }
            overlapping += segments.ds[q];
            // most overlaps are less deep than half the element behind the side
            let owner = [part.slave.patch_of(e), master.patch_of(f)];
            let behind = [(0, e), (1, f)].map(|(k, element)| element_depth(model, traces[k], owner[k], element, &frames.normal[q]));
            if behind.iter().all(|b| 2.0 * depth <= *b) {
                continue;
            }
            let groups = groups.get_or_insert_with(|| {
                let masters: Vec<usize> = part.masters.iter().map(|m| m.patch).collect();
                [body(model, &[part.slave.patch]), body(model, &masters)]
            });
            let inward = [frames.normal[q], -frames.normal[q]];
            let foot = frames.x[q] + frames.normal[q] * depth;
            let ends = [(frames.x[q], inward[0]), (foot, inward[1])];
            let thin = (0..2).any(|k| {
                let (x, way) = ends[k];
                DEPTHS.iter().any(|d| {
                    let at = x + way * (depth * (d - INSIDE));
                    !groups[k].iter().any(|c| c.project_within(&at, depth * INSIDE + model.size * 1e-12).is_some())
                })
            });
            if thin {
                deep += segments.ds[q];
                if depth > worst.0 {
                    worst = (depth, frames.x[q]);
                }
            }
        }
    }
    if deep <= TOO_DEEP * overlapping {
        return None;
    }
    let at: Vec<String> = ["x", "y", "z"][..N].iter().zip(worst.1.iter()).map(|(l, v)| format!("{l} = {}", short(*v))).collect();
    let text = format!(
        "`{}` lies {} deep in the body of {} (at {}): more than half of a body's thickness",
        part.slave.label,
        short(worst.0),
        labels(&part.masters),
        at.join(", ")
    );
    let plain =
        Box::new(builder.error("E023", text, contact.head.at).with_help("move the bodies apart, or choose the sides that face each other"));
    Some(*meant(model, &part.slave, &part.masters, plain))
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
