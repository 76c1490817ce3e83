//! Maps of the unit square onto regions, and their points: Coons' map of four pieces, sectors, triangles at a pole.

use super::cell_rule::WeightedPoints;
use super::piece::{EdgePiece, LineRule, wedge};
use crate::linalg::Vector;

/// Least product of the sides at a corner of a Coons map, as a share of the area.
const CORNER: f64 = 0.03;

/// Appends the points of the sector between an apex and a piece.
pub(super) fn sector(apex: &Vector<2>, piece: &EdgePiece, rule: &LineRule, out: &mut WeightedPoints) {
    for (q, &wt) in rule.weights.iter().enumerate() {
        let [c, d] = rule.at(piece, q);
        let across = wedge(&(c - apex), &d);
        for (&r, &wr) in rule.t.iter().zip(&rule.weights) {
            out.push((apex + (c - apex) * r, (wt * wr * r * across).max(0.0)));
        }
    }
}

/// Fills four pieces around `whole` by Coons' map; false, and nothing appended, where its Jacobian is not positive.
pub(super) fn coons(chain: &[EdgePiece], whole: f64, rule: &LineRule, out: &mut WeightedPoints) -> bool {
    let p: [Vector<2>; 4] = std::array::from_fn(|k| chain[k].from());
    if (0..4).any(|k| wedge(&(p[(k + 1) % 4] - p[k]), &(p[(k + 3) % 4] - p[k])) <= CORNER * whole) {
        return false;
    }
    let n = rule.t.len();
    positive(rule, out, |i, j| {
        let (s, t) = (rule.t[i], rule.t[j]);
        let ([c0, d0], [c1, d1]) = (rule.at(&chain[0], i), rule.at(&chain[1], j));
        // Gauss points are symmetric: the opposite sides are walked backwards
        let ([c2, d2], [c3, d3]) = (rule.at(&chain[2], n - 1 - i), rule.at(&chain[3], n - 1 - j));
        let low = p[0] * (1.0 - s) + p[1] * s;
        let high = p[3] * (1.0 - s) + p[2] * s;
        let x = c0 * (1.0 - t) + c2 * t + c3 * (1.0 - s) + c1 * s - low * (1.0 - t) - high * t;
        let by_s = d0 * (1.0 - t) - d2 * t - c3 + c1 - (p[1] - p[0]) * (1.0 - t) - (p[2] - p[3]) * t;
        let by_t = c2 - c0 - d3 * (1.0 - s) + d1 * s - (high - low);
        (x, wedge(&by_s, &by_t))
    })
}

/// Fills the triangle between a pole, the sides `left` and `right` that leave it, and the piece `far` from the end of the first to that of
/// the second:
///
/// ```text
/// x(s, t) = (1-t) left(s) + t right(s) + s (far(t) - (1-t) a - t b)
/// ```
///
/// False, and nothing appended, where the Jacobian is not positive.
pub(super) fn at_pole(left: &EdgePiece, far: &EdgePiece, right: &EdgePiece, rule: &LineRule, out: &mut WeightedPoints) -> bool {
    let (a, b) = (far.from(), far.to());
    positive(rule, out, |i, j| {
        let (s, t) = (rule.t[i], rule.t[j]);
        let ([l, dl], [r, dr], [c, dc]) = (rule.at(left, i), rule.at(right, i), rule.at(far, j));
        let bulge = c - a * (1.0 - t) - b * t;
        let x = l * (1.0 - t) + r * t + bulge * s;
        let by_s = dl * (1.0 - t) + dr * t + bulge;
        let by_t = r - l + (dc + a - b) * s;
        (x, wedge(&by_s, &by_t))
    })
}

/// Appends the points of a map given by position and Jacobian at points (i, j) of the rule, if that is positive at all of them.
fn positive(rule: &LineRule, out: &mut WeightedPoints, map: impl Fn(usize, usize) -> (Vector<2>, f64)) -> bool {
    let (n, start) = (rule.t.len(), out.len());
    for (i, j) in (0..n * n).map(|q| (q / n, q % n)) {
        let (x, jacobian) = map(i, j);
        if jacobian <= 0.0 {
            out.truncate(start);
            return false;
        }
        out.push((x, rule.weights[i] * rule.weights[j] * jacobian));
    }
    true
}
