//! Detection of touching sides: facets against the sides nearest to them, pairs of sides by all their distances.

use super::lengths::SAME_PLACE;
use crate::basis::Cell;
use crate::geometry::{Bounds, MapTable, Sag, Tree, cell};
use crate::linalg::Vector;
use crate::parallel;
use crate::problem::model::BodySide;
use crate::space::{Clearance, Sight, Skin, SkinPoint, raised, skin_points};
use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// Sides within this fraction of a facet that do not touch are reported as a warning.
const CLOSE: f64 = 1e-3;
/// Search radius of a facet in multiples of its sag: three, and the bulge.
const REACH: f64 = 4.0;
/// Distance of the points near the corners of a facet from them, as a share of the facet: sides that overlap by less do not touch.
const INSET: f64 = 1e-3;
/// Greatest growth of the gap beside the centre of a facet, as a share of the way, where the centre lies on the rim of a side: with more both sides
/// only meet in an edge.
const INCLINED: f64 = 0.3;

/// Result of the search for touching sides.
#[derive(Debug, Default)]
pub(super) struct Touching {
    /// The share of facets of side a that lie on side b, for all pairs (a, b) that touch.
    pub shares: BTreeMap<(usize, usize), f64>,
    /// The share of facets of every side that lie on any other.
    pub touched: Vec<f64>,
    /// Whether a corner of a facet of every side lies on no other.
    pub ends_beyond: Vec<bool>,
    /// Pairs (the lesser first) that are near each other and do not touch.
    pub near: Vec<([usize; 2], Clearance)>,
}

/// Sides near a facet: number, whether the facet's centre lies on it, and the distances of the facet.
type Seen = Vec<(usize, bool, Clearance)>;

/// Finds the sides that touch; a facet may touch those that are nearest to its centre. Sides that overlap where no facet has its centre,
/// as at a T-junction of coarse grids, touch by the corners of their facets, with a share of zero.
///
/// `tolerance`: largest distance of facets' centres, without any other condition. `None`: sides touch if the deviation `sags` of their
/// facets explains their distance ([`Clearance::touches`]); distances below `floor` count as zero. Pairs for which `left_out` holds are
/// skipped. One tree of boxes over all facets.
pub(super) fn touching_sides<const S: usize, const N: usize>(
    sides: &[Arc<BodySide<S, N>>],
    tolerance: Option<f64>,
    sags: &[Sag<S, N>],
    floor: f64,
    left_out: &dyn Fn(usize, usize) -> bool,
) -> Touching {
    let sags = explaining(sides, tolerance, sags);
    let facets: Vec<(usize, usize)> = sides.iter().enumerate().flat_map(|(k, s)| (0..s.trace.facets.len()).map(move |f| (k, f))).collect();
    let boxes: Vec<Bounds<N>> = sides.iter().flat_map(|s| s.trace.space.all_bounds()).collect();
    let reach: Vec<f64> = (facets.iter().zip(&boxes))
        .map(|(&(a, f), b)| tolerance.unwrap_or((sags[a].of_facet(f) * REACH).max(b.diagonal() * CLOSE).max(floor)))
        .collect();
    let tree = Tree::new(boxes.iter().zip(&reach).map(|(b, r)| b.inflated(*r)).collect());
    // the centre, then the points near the corners
    let looked_at = |i: usize, table: &mut MapTable<S, N>| {
        let (a, f) = facets[i];
        let trace = &sides[a].trace;
        raised(trace, &sags[a], f, &centre_and_corners(trace.space.cell(f)), table)
    };
    let candidates = candidates(&facets, &tree, &reach, looked_at);
    let mut allowed: BTreeMap<(usize, usize), bool> = BTreeMap::new();
    for ((a, _), found) in facets.iter().zip(&candidates) {
        for &b in found.iter().flat_map(BTreeMap::keys) {
            allowed.entry((*a, b)).or_insert_with(|| !left_out(*a, b));
        }
    }
    let used: BTreeSet<usize> = allowed.iter().filter(|(_, ok)| **ok).map(|(&(_, b), _)| b).collect();
    let skins: BTreeMap<usize, Skin<'_, S, N>> = used.into_iter().map(|b| (b, Skin::new(&sides[b].trace, &sags[b]))).collect();
    // the sides nearest to a point of facet i, among those near it, that some of the points beside it see alike
    let nearest = |i: usize, point: &SkinPoint<N>, beside: &[SkinPoint<N>], near: &BTreeMap<usize, f64>, table: &mut MapTable<S, N>| {
        let close = boxes[i].diagonal() * CLOSE;
        let near = near.iter().filter(|(b, _)| allowed[&(facets[i].0, **b)]);
        let mut at: Vec<(usize, f64, Sight)> =
            near.filter_map(|(&b, &r)| Some((b, r, skins[&b].sight(point, r * (1.0 + SAME_PLACE), floor, table)?))).collect();
        at.retain(|(_, _, s)| tolerance.map_or_else(|| s.nearly(close), |t| s.distance <= t));
        at.retain(|(b, r, s)| faces_beside(&skins[b], (point, s), beside, (*r, floor), table));
        let far = |s: &Sight| if tolerance.is_some() { s.distance } else { s.gap.abs() };
        let least = at.iter().map(|(_, _, s)| far(s)).fold(f64::INFINITY, f64::min);
        at.retain(|(_, _, s)| far(s) <= least + floor);
        at
    };
    let seen: Vec<(Seen, Vec<Vec<usize>>)> = parallel::map_init(facets.len(), MapTable::new, |table, i| {
        if candidates[i].iter().flat_map(BTreeMap::keys).all(|&b| !allowed[&(facets[i].0, b)]) {
            return (Seen::new(), Vec::new());
        }
        let looked_at = looked_at(i, table);
        let at_corners = looked_at.iter().zip(&candidates[i]).skip(1).map(|(point, near)| {
            let at = nearest(i, point, &[], near, table);
            at.iter().filter(|(_, _, s)| tolerance.is_some() || s.touches(floor)).map(|(b, _, _)| *b).collect()
        });
        let at_corners: Vec<Vec<usize>> = at_corners.collect();
        let (a, f) = facets[i];
        let trace = &sides[a].trace;
        let beside = raised(trace, &sags[a], f, &beside_centre(trace.space.cell(f)), table);
        let at = nearest(i, &looked_at[0], &beside, &candidates[i][0], table);
        if at.is_empty() {
            return (Seen::new(), at_corners);
        }
        let points = raised(trace, &sags[a], f, &skin_points(trace.space.cell(f)), table);
        let weight = boxes[i].diagonal().powi(S as i32) / points.len() as f64;
        let seen = at.iter().map(|(b, reach, first)| {
            let mut all = Clearance::new();
            for point in points.iter().filter(|_| tolerance.is_none()) {
                if let Some(s) = skins[b].sight(point, reach * (1.0 + SAME_PLACE), floor, table) {
                    all.see(&s, weight, floor);
                }
            }
            (*b, tolerance.is_some() || first.touches(floor), all)
        });
        (seen.collect(), at_corners)
    });
    let (seen, at_corners): (Vec<Seen>, Vec<Vec<Vec<usize>>>) = seen.into_iter().unzip();
    let mut out = decided(sides, &facets, &seen, tolerance.is_some(), floor);
    by_corners(&facets, &at_corners, &mut out);
    out
}

/// The sags that explain distances: none with a given tolerance, where distances are those of the facets themselves.
fn explaining<'a, const S: usize, const N: usize>(
    sides: &[Arc<BodySide<S, N>>],
    tolerance: Option<f64>,
    sags: &'a [Sag<S, N>],
) -> Cow<'a, [Sag<S, N>]> {
    match tolerance {
        Some(_) => sides.iter().map(|s| Sag::none(s.trace.facets.len())).collect(),
        None => Cow::Borrowed(sags),
    }
}

/// The centre of a cell, and points beside its corners.
fn centre_and_corners<const S: usize>(kind: Cell) -> Vec<Vector<S>> {
    let centre = skin_points::<S, f64>(kind)[0];
    let corners = cell::corners::<S, f64>(if S == 1 { Cell::Tensor } else { kind });
    std::iter::once(centre).chain(corners.into_iter().map(|x| x + (centre - x) * (2.0 * INSET))).collect()
}

/// Whether points `beside` a point see a side as the point itself does: all of them, or some with the gap that the point sees, within `reach`.
fn faces_beside<const S: usize, const N: usize>(
    skin: &Skin<'_, S, N>,
    (point, sight): (&SkinPoint<N>, &Sight),
    beside: &[SkinPoint<N>],
    (reach, floor): (f64, f64),
    table: &mut MapTable<S, N>,
) -> bool {
    let lengths = beside.iter().map(|p| (p.x - point.x).norm());
    let seen: Vec<(Option<Sight>, f64)> = beside.iter().zip(lengths).map(|(p, l)| (skin.sight(p, reach + l, floor, table), l)).collect();
    let alike = |(other, length): &(Option<Sight>, f64)| other.is_some_and(|o| (o.gap - sight.gap).abs() <= length * INCLINED + floor);
    seen.iter().all(|(other, _)| other.is_some()) || seen.iter().any(alike)
}

/// Points beside the centre of a cell.
fn beside_centre<const S: usize>(kind: Cell) -> Vec<Vector<S>> {
    let points = centre_and_corners::<S>(kind);
    points[1..].iter().map(|corner| points[0] + (corner - points[0]) * INSET).collect()
}

/// Adds pairs of sides that touch by corners alone, with a share of zero, and finds the sides of which a corner lies on no other; given the
/// sides that every corner of every facet lies on.
fn by_corners(facets: &[(usize, usize)], at_corners: &[Vec<Vec<usize>>], out: &mut Touching) {
    let near: BTreeSet<[usize; 2]> = out.near.iter().map(|(pair, _)| *pair).collect();
    for (&(a, _), corners) in facets.iter().zip(at_corners) {
        for &b in corners.iter().flatten() {
            if !near.contains(&[a.min(b), a.max(b)]) && !out.shares.contains_key(&(b, a)) {
                out.shares.entry((a, b)).or_default();
            }
        }
    }
    let touch = |a: usize, b: usize| out.shares.contains_key(&(a, b)) || out.shares.contains_key(&(b, a));
    for (&(a, _), corners) in facets.iter().zip(at_corners) {
        out.ends_beyond[a] |= corners.is_empty() || corners.iter().any(|on| !on.iter().any(|&b| touch(a, b)));
    }
}

/// Returns, per facet and point of it, the other sides with a facet whose box is near the point, and the search radius each needs.
fn candidates<const S: usize, const N: usize>(
    facets: &[(usize, usize)],
    tree: &Tree<N>,
    reach: &[f64],
    points: impl Fn(usize, &mut MapTable<S, N>) -> Vec<SkinPoint<N>> + Sync,
) -> Vec<Vec<BTreeMap<usize, f64>>> {
    let near_point = |i: usize, x: Vector<N>| {
        let mut found: BTreeMap<usize, f64> = BTreeMap::new();
        for j in tree.meeting(&Bounds { lo: x, hi: x }.inflated(reach[i])).into_iter().filter(|&j| facets[j].0 != facets[i].0) {
            let most = found.entry(facets[j].0).or_insert(reach[i]);
            *most = most.max(reach[j]);
        }
        found
    };
    let near = |table: &mut MapTable<S, N>, i: usize| points(i, table).iter().map(|point| near_point(i, point.x)).collect();
    parallel::map_init(facets.len(), MapTable::new, near)
}

/// Separates pairs that touch, their distance explained by faceting, from those that are merely near; with `given` no explanation is
/// needed.
fn decided<const S: usize, const N: usize>(
    sides: &[Arc<BodySide<S, N>>],
    facets: &[(usize, usize)],
    seen: &[Seen],
    given: bool,
    floor: f64,
) -> Touching {
    let mut pairs: BTreeMap<[usize; 2], (Clearance, bool)> = BTreeMap::new();
    for (&(a, _), list) in facets.iter().zip(seen) {
        for (b, lies, found) in list {
            let pair = pairs.entry([a.min(*b), a.max(*b)]).or_insert((Clearance::new(), false));
            pair.0.join(found);
            pair.1 |= lies;
        }
    }
    let touches = |a: usize, b: usize| pairs.get(&[a.min(b), a.max(b)]).is_some_and(|(all, lies)| *lies && (given || all.touches(floor)));
    let mut out = Touching { touched: vec![0.0; sides.len()], ends_beyond: vec![false; sides.len()], ..Touching::default() };
    for (&(a, _), list) in facets.iter().zip(seen) {
        let one = 1.0 / sides[a].trace.facets.len() as f64;
        let mut lies = false;
        for (b, _, _) in list.iter().filter(|(b, lies, _)| *lies && touches(a, *b)) {
            *out.shares.entry((a, *b)).or_default() += one;
            lies = true;
        }
        if lies {
            out.touched[a] += one;
        }
    }
    out.near = pairs.iter().filter(|(p, _)| !touches(p[0], p[1])).map(|(p, (all, _))| (*p, *all)).collect();
    out
}
