//! Cuts of a set of points and edges in two halves and a small separator.

use super::flow::Network;
use super::frame::frame;
use super::graph::Piece;
use super::index;

/// Projections closer than this part of the extent count as equal, so that a cut follows a line of the grid.
const EQUAL: f64 = 1e-9;
/// Half width, as part of all vertices, of the band in which the smallest separator is sought.
const BAND: f64 = 0.1;
/// The same half width in separators of the straight cut, for large sets.
const LAYERS: usize = 2;
/// Edges along the directions of a grid to this part need no others.
const ALIGNED: f64 = 0.85;

/// Labels of a cut.
pub(super) const LEFT: u8 = 0;
pub(super) const RIGHT: u8 = 1;
pub(super) const SEPARATOR: u8 = 2;

/// The cheapest cut over the directions of the grid, or the axes and the longest direction of inertia; `None` where no cut leaves two
/// halves.
pub(super) fn best_cut(piece: &Piece) -> Option<Vec<u8>> {
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
    let mut planes: Vec<Plane> = directions.iter().filter_map(|d| Plane::through_median(piece, d)).collect();
    // the sort keeps the first of equal ones in front
    planes.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    let best = planes.into_iter().find_map(|plane| plane.cut(piece))?;
    if !best.straight {
        // oblique to the grid, or no grid: the smallest separator in a band around the median follows the mesh
        if let Some((cost, label)) = band_cut(piece, &best.t, best.label.iter().filter(|&&l| l == SEPARATOR).count())
            && cost < 0.98 * best.cost
        {
            return Some(label);
        }
    }
    Some(best.label)
}

/// A plane through the median of the vertices.
struct Plane {
    /// What its separator costs about: the weight of the smaller rim, more where the halves differ.
    cost: f64,
    /// Projections on the normal.
    t: Vec<f64>,
    /// What is below goes left.
    bound: f64,
    extent: f64,
}

impl Plane {
    fn through_median(piece: &Piece, normal: &[f64; 3]) -> Option<Self> {
        let n = piece.ids.len();
        let t: Vec<f64> = piece.at.iter().map(|x| x[0] * normal[0] + x[1] * normal[1] + x[2] * normal[2]).collect();
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
            if (t[v] - bound).abs() <= piece.reach[v] && piece.neighbours(v).iter().any(crosses) {
                rim[side] += w;
            }
        }
        let difference = halves[0].abs_diff(halves[1]) as f64 / (halves[0] + halves[1]) as f64;
        Some(Self { cost: rim[0].min(rim[1]) as f64 * (1.0 + difference * difference), t, bound, extent })
    }

    /// The separator is the rim of one half.
    fn cut(self, piece: &Piece) -> Option<Cut> {
        let Self { t, bound, extent, .. } = self;
        let n = t.len();
        let mut label: Vec<u8> = t.iter().map(|&x| if x < bound { LEFT } else { RIGHT }).collect();
        let (mut weight, mut rim, mut rims) = ([0u64; 2], [0u64; 2], [Vec::new(), Vec::new()]);
        for v in 0..n {
            let side = label[v];
            weight[side as usize] += u64::from(piece.weight[v]);
            if (t[v] - bound).abs() <= piece.reach[v] && piece.neighbours(v).iter().any(|&u| label[u as usize] != side) {
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
        Some(Cut { cost: cost(piece, &label)?, label, t, straight })
    }
}

/// A cut: labels, their cost, the projections behind it.
struct Cut {
    cost: f64,
    label: Vec<u8>,
    t: Vec<f64>,
    /// The separator is one line of equal projections.
    straight: bool,
}

/// The weight of a separator, more where the halves differ; `None` where a half is empty.
fn cost(piece: &Piece, label: &[u8]) -> Option<f64> {
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

/// The smallest separator between the lowest and the highest projections, by maximum flow through the band between them.
fn band_cut(piece: &Piece, t: &[f64], separator: usize) -> Option<(f64, Vec<u8>)> {
    let n = t.len();
    let mut values = t.to_vec();
    let width = ((BAND * n as f64) as usize).min(LAYERS * separator);
    let low = *values.select_nth_unstable_by(n / 2 - width, f64::total_cmp).1;
    let high = *values.select_nth_unstable_by((n / 2 + width).min(n - 1), f64::total_cmp).1;
    let mut label: Vec<u8> = t
        .iter()
        .map(|&x| {
            if x < low {
                LEFT
            } else if x > high {
                RIGHT
            } else {
                SEPARATOR
            }
        })
        .collect();
    // an edge across the band leaves no separator inside it: both of its ends may be one
    let across = |v: usize| match label[v] {
        LEFT => t[v] + piece.reach[v] > high && piece.neighbours(v).iter().any(|&u| label[u as usize] == RIGHT),
        RIGHT => t[v] - piece.reach[v] < low && piece.neighbours(v).iter().any(|&u| label[u as usize] == LEFT),
        _ => false,
    };
    let far: Vec<usize> = (0..n).filter(|&v| across(v)).collect();
    // places that say so little about the edges make the flow dear and win nothing
    if far.len() > n / 2 {
        return None;
    }
    far.into_iter().for_each(|v| label[v] = SEPARATOR);
    let band: Vec<usize> = (0..n).filter(|&v| label[v] == SEPARATOR).collect();
    let mut local = vec![u32::MAX; n];
    for (k, &v) in band.iter().enumerate() {
        local[v] = index(k);
    }
    // vertex k enters at 2 k and leaves at 2 k + 1, its weight is what it lets through
    let (source, sink) = (2 * band.len(), 2 * band.len() + 1);
    let touches = |v: usize, side| piece.neighbours(v).iter().any(|&u| label[u as usize] == side);
    let ends: Vec<[bool; 2]> = band.iter().map(|&v| [touches(v, LEFT), touches(v, RIGHT)]).collect();
    let mut arcs: Vec<(u32, u32, u32)> = Vec::new();
    let mut arc = |from, to, room| arcs.push((index(from), index(to), room));
    for (k, &v) in band.iter().enumerate() {
        arc(2 * k, 2 * k + 1, piece.weight[v]);
        if ends[k][0] {
            arc(source, 2 * k, u32::MAX);
        }
        if ends[k][1] {
            arc(2 * k + 1, sink, u32::MAX);
            continue;
        }
        // no way needs to come back to the source's neighbours, nor to go on from the sink's
        for &u in piece.neighbours(v) {
            let to = local[u as usize];
            if to != u32::MAX && !ends[to as usize][0] {
                arc(2 * k + 1, 2 * to as usize, u32::MAX);
            }
        }
    }
    let mut net = Network::new(sink + 1, &arcs);
    net.saturate(source, sink);
    let reached = net.reached(source);
    for (k, &v) in band.iter().enumerate() {
        label[v] = match (reached[2 * k], reached[2 * k + 1]) {
            (_, true) => LEFT,
            (true, false) => SEPARATOR,
            (false, false) => RIGHT,
        };
    }
    Some((cost(piece, &label)?, label))
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
