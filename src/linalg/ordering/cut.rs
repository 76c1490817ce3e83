//! Cuts of a set of points and edges in two halves and a small separator.

use super::band::band_cut;
use super::frame::frame;
use super::graph::Piece;
use super::level::levels;

/// Projections closer than this part of the extent count as equal, so that a cut follows a line of the grid.
const EQUAL: f64 = 1e-9;
/// Edges along the directions of a grid to this part need no others.
const ALIGNED: f64 = 0.85;
/// A separator this many times a set of levels, or the side of a square or cube of as many vertices, says that places mislead.
const WIDE: f64 = 2.0;

/// Labels of a cut.
pub(super) const LEFT: u8 = 0;
pub(super) const RIGHT: u8 = 1;
pub(super) const SEPARATOR: u8 = 2;

/// The cheapest cut over the directions of the grid, or the axes and the longest direction of inertia, and over the levels of the graph
/// where that takes more than the level of a body of this `width`; `None` where no cut leaves two halves.
pub(super) fn best_cut(piece: &Piece, width: f64) -> Option<Vec<u8>> {
    let plane = plane_cut(piece);
    if plane.as_ref().is_some_and(|cut| cut.cost <= WIDE * width.min(side(piece))) {
        return plane.map(|cut| cut.label);
    }
    // places say little about the edges: thin cells along a bend, say
    let (hops, _) = levels(piece, plane.as_ref().map_or(0, Cut::end));
    let by_levels = Plane::through_median(piece, hops, true).and_then(|plane| plane.cut(piece)).map(|cut| cut.smoothed(piece));
    [plane, by_levels].into_iter().flatten().min_by(|a, b| a.cost.total_cmp(&b.cost)).map(|cut| cut.label)
}

/// Weight of a separator along the side of a square, or a cube where places leave a plane, of as many vertices with as many neighbours.
fn side(piece: &Piece) -> f64 {
    let n = piece.ids.len() as f64;
    let dim = if piece.at.iter().all(|x| x[2] == piece.at[0][2]) { 2.0 } else { 3.0 };
    let weight: u64 = piece.weight.iter().map(|&w| u64::from(w)).sum();
    // a vertex sees as far to both sides
    let layers = 0.5 * (piece.num_edges() as f64 / n + 1.0).powf(1.0 / dim);
    weight as f64 * (layers / n.powf(1.0 / dim)).min(1.0)
}

/// The cheapest cut by planes.
fn plane_cut(piece: &Piece) -> Option<Cut> {
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
    let projected = |d: &[f64; 3]| piece.at.iter().map(|x| x[0] * d[0] + x[1] * d[1] + x[2] * d[2]).collect();
    let mut planes: Vec<Plane> = directions.iter().filter_map(|d| Plane::through_median(piece, projected(d), false)).collect();
    // the sort keeps the first of equal ones in front
    planes.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    let best = planes.into_iter().find_map(|plane| plane.cut(piece))?;
    // oblique to the grid, or no grid: the smallest separator in a band around the median follows the mesh
    Some(if best.straight { best } else { best.smoothed(piece) })
}

/// A plane through the median of the vertices, or a level of the graph.
struct Plane {
    /// What its separator costs about: the weight of the smaller rim, more where the halves differ.
    cost: f64,
    /// Projections on the normal, or levels.
    t: Vec<f64>,
    hops: bool,
    /// What is below goes left.
    bound: f64,
    extent: f64,
}

impl Plane {
    fn through_median(piece: &Piece, t: Vec<f64>, hops: bool) -> Option<Self> {
        let n = piece.ids.len();
        let (low, high) = t.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), &x| (l.min(x), h.max(x)));
        let extent = high - low;
        if extent <= 1e-12 * low.abs().max(high.abs()) {
            return None;
        }
        let mut values = t.clone();
        let median = *values.select_nth_unstable_by(n / 2, f64::total_cmp).1;
        let (before, after) = (median - EQUAL * extent, median + EQUAL * extent);
        // before or after the run of equal projections, whichever halves better
        let (num_before, num_after) = t.iter().fold((0, 0), |(b, a), &x| (b + usize::from(x < before), a + usize::from(x <= after)));
        let bound = if num_after == n || (num_before > 0 && n / 2 - num_before <= num_after - n / 2) { before } else { after };
        let (mut halves, mut rim) = ([0u64; 2], [0u64; 2]);
        for v in 0..n {
            let (w, side) = (u64::from(piece.weight[v]), usize::from(t[v] >= bound));
            halves[side] += w;
            let crosses = |&u: &u32| usize::from(t[u as usize] >= bound) != side;
            if (t[v] - bound).abs() <= reach(piece, hops, v) && piece.neighbours(v).iter().any(crosses) {
                rim[side] += w;
            }
        }
        let difference = halves[0].abs_diff(halves[1]) as f64 / (halves[0] + halves[1]) as f64;
        Some(Self { cost: rim[0].min(rim[1]) as f64 * (1.0 + difference * difference), t, hops, bound, extent })
    }

    /// The separator is the rim of one half.
    fn cut(self, piece: &Piece) -> Option<Cut> {
        let Self { t, hops, bound, extent, .. } = self;
        let n = t.len();
        let mut label: Vec<u8> = t.iter().map(|&x| if x < bound { LEFT } else { RIGHT }).collect();
        let (mut weight, mut rim, mut rims) = ([0u64; 2], [0u64; 2], [Vec::new(), Vec::new()]);
        for v in 0..n {
            let side = label[v];
            weight[side as usize] += u64::from(piece.weight[v]);
            if (t[v] - bound).abs() <= reach(piece, hops, v) && piece.neighbours(v).iter().any(|&u| label[u as usize] != side) {
                rim[side as usize] += u64::from(piece.weight[v]);
                rims[side as usize].push(v);
            }
        }
        let from = if rim[0] < rim[1] || (rim[0] == rim[1] && weight[0] > weight[1]) { LEFT } else { RIGHT };
        let (mut first, mut last) = (f64::INFINITY, f64::NEG_INFINITY);
        for &v in &rims[from as usize] {
            label[v] = SEPARATOR;
            (first, last) = (first.min(t[v]), last.max(t[v]));
        }
        let straight = last - first <= 2.0 * EQUAL * extent;
        Some(Cut { cost: cost(piece, &label)?, label, t, hops, straight })
    }
}

/// A cut: labels, their cost, the projections behind it.
struct Cut {
    cost: f64,
    label: Vec<u8>,
    t: Vec<f64>,
    hops: bool,
    /// The separator is one line of equal projections.
    straight: bool,
}

impl Cut {
    /// The vertex at one end.
    fn end(&self) -> usize {
        (0..self.t.len()).min_by(|&a, &b| self.t[a].total_cmp(&self.t[b])).unwrap_or(0)
    }

    /// The smallest separator near this one, if it is smaller.
    fn smoothed(self, piece: &Piece) -> Self {
        let separator = self.label.iter().filter(|&&l| l == SEPARATOR).count();
        match band_cut(piece, &self.t, self.hops, separator) {
            Some((cost, label)) if cost < 0.98 * self.cost => Self { cost, label, ..self },
            _ => self,
        }
    }
}

/// No edge of `v` makes a larger step in the projections.
pub(super) fn reach(piece: &Piece, hops: bool, v: usize) -> f64 {
    if hops { 1.0 } else { piece.reach[v] }
}

/// The weight of a separator, more where the halves differ; `None` where a half is empty.
pub(super) fn cost(piece: &Piece, label: &[u8]) -> Option<f64> {
    let mut weight = [0u64; 3];
    for v in 0..label.len() {
        weight[label[v] as usize] += u64::from(piece.weight[v]);
    }
    if weight[0] == 0 || weight[1] == 0 {
        return None;
    }
    let difference = weight[0].abs_diff(weight[1]) as f64 / (weight[0] + weight[1]) as f64;
    Some(weight[2] as f64 * (1.0 + difference * difference))
}

/// The direction in which the points spread most, where it is clearly longest and no axis.
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
