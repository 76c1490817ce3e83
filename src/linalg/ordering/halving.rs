//! Two halves of a set of vertices along a coordinate, and the separator between them.

use super::band::band_cut;
use super::graph::Subgraph;
use super::parts::{LEFT, RIGHT, SEPARATOR};

/// Coordinates closer than this part of the extent count as equal, so that a cut follows a line of the grid.
const EQUAL: f64 = 1e-9;

/// A coordinate of every vertex along which a set is cut.
pub(super) enum Coordinate {
    /// Projections on a direction.
    Projections(Vec<f64>),
    /// Levels: numbers of steps along edges.
    Levels(Vec<f64>),
}

impl Coordinate {
    /// Projections on a unit vector.
    pub(super) fn along(piece: &Subgraph, d: &[f64; 3]) -> Self {
        Self::Projections(piece.at.iter().map(|x| x[0] * d[0] + x[1] * d[1] + x[2] * d[2]).collect())
    }

    pub(super) fn values(&self) -> &[f64] {
        match self {
            Self::Projections(t) | Self::Levels(t) => t,
        }
    }

    /// Upper bound of the step of the coordinate along any edge of `v`.
    pub(super) fn reach(&self, piece: &Subgraph, v: usize) -> f64 {
        match self {
            Self::Projections(_) => piece.reach[v],
            Self::Levels(_) => 1.0,
        }
    }
}

/// A set halved at the median of a coordinate.
pub(super) struct Halving {
    /// Estimated cost of its separator: the weight of the smaller rim, more if the halves differ.
    pub cost: f64,
    coordinate: Coordinate,
    /// Vertices with a coordinate below this one go left.
    bound: f64,
    extent: f64,
}

impl Halving {
    pub(super) fn through_median(piece: &Subgraph, coordinate: Coordinate) -> Option<Self> {
        let (n, t) = (piece.ids.len(), coordinate.values());
        let (low, high) = t.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), &x| (l.min(x), h.max(x)));
        let extent = high - low;
        if extent <= 1e-12 * low.abs().max(high.abs()) {
            return None;
        }
        let mut values = t.to_vec();
        let median = *values.select_nth_unstable_by(n / 2, f64::total_cmp).1;
        let (before, after) = (median - EQUAL * extent, median + EQUAL * extent);
        // before or after the run of equal coordinates, whichever halves better
        let (num_before, num_after) = t.iter().fold((0, 0), |(b, a), &x| (b + usize::from(x < before), a + usize::from(x <= after)));
        let bound = if num_after == n || (num_before > 0 && n / 2 - num_before <= num_after - n / 2) { before } else { after };
        let (mut halves, mut rim) = ([0u64; 2], [0u64; 2]);
        for v in 0..n {
            let (w, side) = (u64::from(piece.weight[v]), usize::from(t[v] >= bound));
            halves[side] += w;
            let crosses = |&u: &u32| usize::from(t[u as usize] >= bound) != side;
            if (t[v] - bound).abs() <= coordinate.reach(piece, v) && piece.neighbours(v).iter().any(crosses) {
                rim[side] += w;
            }
        }
        let difference = halves[0].abs_diff(halves[1]) as f64 / (halves[0] + halves[1]) as f64;
        Some(Self { cost: rim[0].min(rim[1]) as f64 * (1.0 + difference * difference), coordinate, bound, extent })
    }

    /// Cuts the set; the separator is the rim of one half, or of the other if the rim is all of the first.
    pub(super) fn cut(self, piece: &Subgraph) -> Option<Cut> {
        let Self { coordinate, bound, extent, .. } = self;
        let (n, t) = (piece.ids.len(), coordinate.values());
        let mut label: Vec<u8> = t.iter().map(|&x| if x < bound { LEFT } else { RIGHT }).collect();
        let (mut weight, mut rim, mut rims) = ([0u64; 2], [0u64; 2], [Vec::new(), Vec::new()]);
        for v in 0..n {
            let side = label[v];
            weight[side as usize] += u64::from(piece.weight[v]);
            if (t[v] - bound).abs() <= coordinate.reach(piece, v) && piece.neighbours(v).iter().any(|&u| label[u as usize] != side) {
                rim[side as usize] += u64::from(piece.weight[v]);
                rims[side as usize].push(v);
            }
        }
        let from = if rim[0] < rim[1] || (rim[0] == rim[1] && weight[0] > weight[1]) { LEFT } else { RIGHT };
        let from = if rim[from as usize] == weight[from as usize] { RIGHT - from } else { from };
        let (mut first, mut last) = (f64::INFINITY, f64::NEG_INFINITY);
        for &v in &rims[from as usize] {
            label[v] = SEPARATOR;
            (first, last) = (first.min(t[v]), last.max(t[v]));
        }
        let straight = last - first <= 2.0 * EQUAL * extent;
        Some(Cut { cost: cost(piece, &label)?, label, straight, coordinate })
    }
}

/// A cut.
pub(super) struct Cut {
    pub cost: f64,
    pub label: Vec<u8>,
    /// The separator is one line of equal coordinates.
    pub straight: bool,
    coordinate: Coordinate,
}

impl Cut {
    /// The vertex at one end.
    pub(super) fn end(&self) -> usize {
        let t = self.coordinate.values();
        (0..t.len()).min_by(|&a, &b| t[a].total_cmp(&t[b])).unwrap_or(0)
    }

    /// The smallest separator near this one, if it is smaller.
    pub(super) fn smoothed(self, piece: &Subgraph) -> Self {
        let separator = self.label.iter().filter(|&&l| l == SEPARATOR).count();
        match band_cut(piece, &self.coordinate, separator) {
            Some((cost, label)) if cost < 0.98 * self.cost => Self { cost, label, ..self },
            _ => self,
        }
    }
}

/// Weight of a separator, more if the halves differ; `None` if a half is empty.
pub(super) fn cost(piece: &Subgraph, label: &[u8]) -> Option<f64> {
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
