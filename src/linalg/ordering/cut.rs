//! The cheapest cut of a set of points and edges in two halves and a small separator.

use super::frame::frame;
use super::graph::Subgraph;
use super::halving::{Coordinate, Cut, Halving};
use super::level::Levels;

/// Alignment of the edges with the directions of a grid above which no other directions are tried.
const ALIGNED: f64 = 0.85;
/// Ratio of a separator's width to the expected one above which coordinates are considered misleading.
const WIDE: f64 = 2.0;
/// A separator among the levels is taken if it is smaller than this fraction of the plane's: its halves are less compact.
const CLEARLY: f64 = 0.6;

/// Labels of the best cut, and the width of the body that the halves belong to; `None` if no cut leaves two halves.
///
/// The cheapest plane, unless its separator is wider than twice the mean level of a body of this `width`, or than twice the side of a
/// square or cube of as many vertices. Then disconnected parts are separated, or the levels of the graph are tried.
pub(super) fn best_cut(piece: &Subgraph, width: f64) -> Option<(Vec<u8>, f64)> {
    let plane = plane_cut(piece);
    if plane.as_ref().is_some_and(|cut| cut.cost <= WIDE * width.min(side(piece))) {
        return plane.map(|cut| (cut.label, width));
    }
    // coordinates say little about the edges, as for thin cells along a bend
    let levels = Levels::of(piece, plane.as_ref().map_or(0, Cut::end));
    let width = levels.width;
    if let Some(label) = levels.parted() {
        return Some((label, width));
    }
    let cut =
        Halving::through_median(piece, Coordinate::Levels(levels.level)).and_then(|half| half.cut(piece)).map(|cut| cut.smoothed(piece));
    let (plane, cut) = match (plane, cut) {
        (Some(plane), Some(cut)) if cut.cost >= CLEARLY * plane.cost => (Some(plane), None),
        both => both,
    };
    cut.or(plane).map(|cut| (cut.label, width))
}

/// Weight of a separator along the side of a square (planar coordinates) or cube of as many vertices with as many neighbours.
fn side(piece: &Subgraph) -> f64 {
    let n = piece.ids.len() as f64;
    let dim = if piece.at.iter().all(|x| x[2] == piece.at[0][2]) { 2.0 } else { 3.0 };
    // the neighbours of a vertex lie on both sides
    let layers = 0.5 * (piece.degrees() as f64 / n + 1.0).powf(1.0 / dim);
    piece.total_weight() as f64 * (layers / n.powf(1.0 / dim)).min(1.0)
}

/// The cheapest cut over the directions of the grid, or the axes and the longest direction of inertia.
fn plane_cut(piece: &Subgraph) -> Option<Cut> {
    let mut directions = vec![[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    match frame(piece) {
        Some((axes, share)) if share > ALIGNED => directions = axes.to_vec(),
        found => {
            let more = found.into_iter().flat_map(|f| f.0).chain(oblique_direction(&piece.at));
            // a direction met before gives the same plane
            more.for_each(|d| {
                if !directions.contains(&d) {
                    directions.push(d);
                }
            });
        }
    }
    let halved = |d: &[f64; 3]| Halving::through_median(piece, Coordinate::along(piece, d));
    let mut planes: Vec<Halving> = directions.iter().filter_map(halved).collect();
    // the sort keeps the first of equal ones in front
    planes.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    let best = planes.into_iter().find_map(|plane| plane.cut(piece))?;
    // oblique to the grid, or no grid: the smallest separator in a band around the median follows the mesh
    Some(if best.straight { best } else { best.smoothed(piece) })
}

/// Direction of the largest spread of the points; `None` unless it is clearly the largest and no axis.
fn oblique_direction(points: &[[f64; 3]]) -> Option<[f64; 3]> {
    let n = points.len() as f64;
    let mut mean = [0.0; 3];
    for x in points {
        for d in 0..3 {
            mean[d] += x[d] / n;
        }
    }
    let mut c = [[0.0; 3]; 3];
    for x in points {
        for a in 0..3 {
            for b in 0..3 {
                c[a][b] += (x[a] - mean[a]) * (x[b] - mean[b]);
            }
        }
    }
    let trace = c[0][0] + c[1][1] + c[2][2];
    if trace <= 0.0 {
        return None;
    }
    // power iteration from the column of the largest variance: a rough direction is enough
    let k = (0..3).max_by(|&a, &b| c[a][a].total_cmp(&c[b][b])).expect("three axes");
    let mut v = [c[0][k], c[1][k], c[2][k]];
    let mut value = 0.0;
    for _ in 0..16 {
        let length = (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt();
        let unit = [v[0] / length, v[1] / length, v[2] / length];
        for a in 0..3 {
            v[a] = c[a][0] * unit[0] + c[a][1] * unit[1] + c[a][2] * unit[2];
        }
        value = (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt();
    }
    let unit = [v[0] / value, v[1] / value, v[2] / value];
    let along_axis = unit.iter().any(|x| x.abs() > 0.99);
    (value > 0.6 * trace && !along_axis).then_some(unit)
}
