//! Cuts of a set of points and edges in two halves and a small separator.

use super::flow::Network;
use super::{Piece, index};

/// Projections closer than this part of the extent count as equal, so that a cut follows a line of the grid.
const EQUAL: f64 = 1e-9;
/// Half width, as part of all vertices, of the band in which the smallest separator is sought.
const BAND: f64 = 0.1;
/// The same half width in separators of the straight cut, for large sets.
const LAYERS: usize = 8;

/// Labels of a cut.
pub(super) const LEFT: u8 = 0;
pub(super) const RIGHT: u8 = 1;
pub(super) const SEPARATOR: u8 = 2;

/// The cheapest cut over the axes and the longest direction of inertia; `None` where no cut leaves two halves.
pub(super) fn best_cut(piece: &Piece) -> Option<Vec<u8>> {
    let mut best: Option<Cut> = None;
    let mut directions = vec![[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    directions.extend(oblique_direction(&piece.at));
    for direction in directions {
        let t: Vec<f64> = piece.at.iter().map(|x| x[0] * direction[0] + x[1] * direction[1] + x[2] * direction[2]).collect();
        if let Some(cut) = median_cut(piece, t) {
            // the first of two equal cuts: the result does not depend on rounding of a later one
            if best.as_ref().is_none_or(|b| cut.cost < 0.999 * b.cost) {
                best = Some(cut);
            }
        }
    }
    let best = best?;
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

/// Cuts the projections at their median; the separator is the rim of one half.
fn median_cut(piece: &Piece, t: Vec<f64>) -> Option<Cut> {
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
    let (num_before, num_after) = (t.iter().filter(|&&x| x < before).count(), t.iter().filter(|&&x| x <= after).count());
    let bound = if num_after == n || (num_before > 0 && n / 2 - num_before <= num_after - n / 2) { before } else { after };
    let mut label: Vec<u8> = t.iter().map(|&x| if x < bound { LEFT } else { RIGHT }).collect();
    let mut weight = [0u64; 2];
    let mut rim = [0u64; 2];
    for v in 0..n {
        let side = label[v];
        weight[side as usize] += u64::from(piece.weight[v]);
        if piece.neighbours(v).iter().any(|&u| label[u as usize] != side) {
            rim[side as usize] += u64::from(piece.weight[v]);
        }
    }
    let from = if rim[0] < rim[1] || (rim[0] == rim[1] && weight[0] > weight[1]) { LEFT } else { RIGHT };
    let other = 1 - from;
    let separator: Vec<usize> =
        (0..n).filter(|&v| label[v] == from && piece.neighbours(v).iter().any(|&u| label[u as usize] == other)).collect();
    let (mut first, mut last) = (f64::INFINITY, f64::NEG_INFINITY);
    for v in separator {
        label[v] = SEPARATOR;
        (first, last) = (first.min(t[v]), last.max(t[v]));
    }
    let straight = last - first <= 2.0 * EQUAL * extent;
    Some(Cut { cost: cost(piece, &label)?, label, t, straight })
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
    let band: Vec<usize> = (0..n).filter(|&v| label[v] == SEPARATOR).collect();
    let mut local = vec![u32::MAX; n];
    for (k, &v) in band.iter().enumerate() {
        local[v] = index(k);
    }
    // vertex k enters at 2 k and leaves at 2 k + 1, its weight is what it lets through
    let (source, sink) = (2 * band.len(), 2 * band.len() + 1);
    let mut net = Network::new(sink + 1);
    for (k, &v) in band.iter().enumerate() {
        net.arc(2 * k, 2 * k + 1, piece.weight[v]);
        let (mut left, mut right) = (false, false);
        for &u in piece.neighbours(v) {
            match label[u as usize] {
                LEFT => left = true,
                RIGHT => right = true,
                _ => net.arc(2 * k + 1, 2 * local[u as usize] as usize, u32::MAX),
            }
        }
        if left {
            net.arc(source, 2 * k, u32::MAX);
        }
        if right {
            net.arc(2 * k + 1, sink, u32::MAX);
        }
    }
    // an edge across the band leaves no separator inside it
    if (0..n).any(|v| label[v] == LEFT && piece.neighbours(v).iter().any(|&u| label[u as usize] == RIGHT)) {
        return None;
    }
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
