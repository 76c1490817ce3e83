//! Quadrature with positive weights on a region bounded by a closed chain of pieces.
//!
//! Four pieces are filled by the transfinite map of Coons and Gordon,
//!
//! ```text
//! x(s, t) = (1-t) c_0(s) + t c_2(s) + (1-s) c_3(t) + s c_1(t) - (bilinear map of the corners),
//! ```
//!
//! if its Jacobian is positive at all points; other regions by a fan of sectors x(r, t) = a + r (c(t) - a) with the weight
//! r (c - a) x c' dr dt, about an apex from which no sector is turned over. A region without such an apex is cut in halves. Every map takes
//! n x n Gauss points. The fan and Coons' map of one region differ by their quadrature errors alone: both carry the boundary's polynomials.
//!
//! Functions of a collapsed cell are smooth along every line into its pole and in the angle about it, not in the plane. So a region with
//! a corner at a pole is filled by triangles with that corner, and one that is near a pole is halved towards it.

use super::clip::{COLLINEAR, halved, simplified};
use super::piece::{EdgePiece, LineRule, area, wedge};
use super::region_maps::{at_pole, coons, sector};
use crate::linalg::Vector;

/// Sectors and regions below this share of the cell are dropped.
const NOTHING: f64 = 1e-15;
/// Sectors of less than this share of the region are dropped.
const NO_SECTOR: f64 = 1e-12;
/// Deepest cutting of a region.
const DEPTH: usize = 10;
/// Grid of apices.
const APICES: usize = 7;
/// A corner this near to a pole is at it.
const AT_POLE: f64 = 1e-11;
/// Pieces of triangles at a pole that are longer than this, in units of their distance, are halved.
const WIDE: f64 = 1.2;
/// Halvings of such pieces, and of regions near a pole.
const POLE_DEPTH: usize = 8;

/// Points and weights of a region, in the chart.
pub(super) type WeightedPoints = Vec<(Vector<2>, f64)>;

/// Appends the points of a region, given the poles of its two facets in the chart. What cannot be filled is missing in the sum of the weights.
pub(super) fn fill(chain: &[EdgePiece], poles: &[Vector<2>], rule: &LineRule, out: &mut WeightedPoints) {
    filled(chain, poles, rule, if poles.is_empty() { DEPTH } else { DEPTH + 2 * POLE_DEPTH }, out);
}

fn filled(chain: &[EdgePiece], poles: &[Vector<2>], rule: &LineRule, depth: usize, out: &mut WeightedPoints) {
    let whole = area(chain);
    if whole <= NOTHING {
        return;
    }
    let cut = match beside(chain, poles) {
        Beside::Nothing => {
            if chain.len() == 4 && coons(chain, whole, rule, out) {
                return;
            }
            if let Some(apex) = apex(chain, whole, rule) {
                for piece in chain.iter().filter(|piece| piece.area(&apex) > NO_SECTOR * whole) {
                    sector(&apex, piece, rule, out);
                }
                return;
            }
            longest(chain)
        }
        Beside::Near => longest(chain),
        Beside::Corner(start) => {
            if around_pole(chain, start, whole, rule, out) {
                return;
            }
            // across the way from the pole, in the middle
            let (pole, middle) = (chain[start].from(), mean(chain));
            let away = (middle - pole).try_normalize(0.0).unwrap_or_else(|| longest(chain).0);
            let far = chain.iter().map(|piece| away.dot(&(piece.from() - pole))).fold(0.0, f64::max);
            (away, away.dot(&pole) + 0.5 * far)
        }
    };
    if depth > 0 {
        for sign in [1.0, -1.0] {
            filled(&half(chain, &(cut.0 * sign), cut.1 * sign), poles, rule, depth - 1, out);
        }
    }
}

/// Position of a region to the poles.
enum Beside {
    Nothing,
    /// Near one that is no corner, or at several: to be halved.
    Near,
    /// At one, from which this piece leads away.
    Corner(usize),
}

fn beside(chain: &[EdgePiece], poles: &[Vector<2>]) -> Beside {
    if poles.is_empty() {
        return Beside::Nothing;
    }
    let (lo, hi) = extent(chain);
    let size = (hi - lo).amax();
    let starts: Vec<usize> = (0..chain.len()).filter(|&k| poles.iter().any(|pole| (chain[k].from() - pole).amax() <= AT_POLE)).collect();
    let is_near = |pole: &&Vector<2>| {
        let nearest = chain.iter().map(|piece| distance_to(piece, pole)).fold(f64::INFINITY, f64::min);
        nearest > AT_POLE && nearest < 0.5 * size
    };
    let may_halve = size > 0.5f64.powi(POLE_DEPTH as i32);
    match starts[..] {
        _ if may_halve && (starts.len() > 1 || poles.iter().any(|pole| is_near(&pole))) => Beside::Near,
        [] => Beside::Nothing,
        [start, ..] => Beside::Corner(start),
    }
}

/// Distance of a point to the chord of a piece.
fn distance_to(piece: &EdgePiece, x: &Vector<2>) -> f64 {
    let (a, along) = (piece.from(), piece.to() - piece.from());
    let square = along.norm_squared();
    let t = if square > 0.0 { ((x - a).dot(&along) / square).clamp(0.0, 1.0) } else { 0.0 };
    (a + along * t - x).norm()
}

/// Fills a region by triangles with a corner at the pole from which the piece `start` leads away.
fn around_pole(chain: &[EdgePiece], start: usize, whole: f64, rule: &LineRule, out: &mut WeightedPoints) -> bool {
    let n = chain.len();
    let (first, last, pole) = (chain[start], chain[(start + n - 1) % n].reversed(), chain[start].from());
    if n < 3 || first.from() != last.from() {
        return false;
    }
    let mut far = Vec::new();
    for k in 1..n - 1 {
        narrow(chain[(start + k) % n], &pole, POLE_DEPTH, &mut far);
    }
    let from = out.len();
    for (k, piece) in far.iter().enumerate() {
        let left = if k == 0 { first } else { EdgePiece::Line(pole, piece.from()) };
        let right = if k + 1 == far.len() { last } else { EdgePiece::Line(pole, piece.to()) };
        let is_nothing = !(left.is_curve() || right.is_curve() || piece.is_curve()) && piece.area(&pole).abs() <= NO_SECTOR * whole;
        if !is_nothing && !at_pole(&left, piece, &right, rule, out) {
            out.truncate(from);
            return false;
        }
    }
    true
}

/// Halves a piece until its parts are short beside their distance from a pole.
fn narrow(piece: EdgePiece, pole: &Vector<2>, depth: usize, into: &mut Vec<EdgePiece>) {
    if depth == 0 || piece.chord() <= WIDE * distance_to(&piece, pole) {
        into.push(piece);
    } else {
        narrow(piece.part(0.0, 0.5), pole, depth - 1, into);
        narrow(piece.part(0.5, 1.0), pole, depth - 1, into);
    }
}

/// The line across the longer extent of a region in its middle: unit normal and offset.
fn longest(chain: &[EdgePiece]) -> (Vector<2>, f64) {
    let (lo, hi) = extent(chain);
    let k = if hi[0] - lo[0] >= hi[1] - lo[1] { 0 } else { 1 };
    (Vector::from_fn(|i, _| if i == k { 1.0 } else { 0.0 }), 0.5 * (lo[k] + hi[k]))
}

/// The mean of the corners.
fn mean(chain: &[EdgePiece]) -> Vector<2> {
    chain.iter().fold(Vector::zeros(), |s: Vector<2>, piece| s + piece.from()) / chain.len() as f64
}

/// An apex from which all sectors have an area of at least zero, everywhere, up to rounding: a piece may be a sliver.
fn apex(chain: &[EdgePiece], whole: f64, rule: &LineRule) -> Option<Vector<2>> {
    let sees = |apex: &Vector<2>| {
        chain.iter().all(|piece| match piece {
            EdgePiece::Line(..) => piece.area(apex) >= -NO_SECTOR * whole,
            EdgePiece::Curve(_) => (0..rule.t.len()).all(|q| {
                let [c, d] = rule.at(piece, q);
                wedge(&(c - apex), &d) >= -NO_SECTOR * whole
            }),
        })
    };
    let corners = chain.iter().map(EdgePiece::from);
    let (lo, hi) = extent(chain);
    let grid = (0..APICES * APICES).map(|q| {
        let t = |i: usize| (i as f64 + 0.5) / APICES as f64;
        let (i, j) = (t(q % APICES), t(q / APICES));
        Vector::<2>::new(lo[0] + (hi[0] - lo[0]) * i, lo[1] + (hi[1] - lo[1]) * j)
    });
    corners.chain([mean(chain)]).chain(grid).find(sees)
}

/// Box around the points of a chain.
fn extent(chain: &[EdgePiece]) -> (Vector<2>, Vector<2>) {
    let first = chain.first().map_or_else(Vector::zeros, EdgePiece::from);
    let grown = |(lo, hi): (Vector<2>, Vector<2>), p: &Vector<2>| (lo.inf(p), hi.sup(p));
    chain.iter().fold((first, first), |box_, piece| match piece {
        EdgePiece::Line(a, _) => grown(box_, a),
        EdgePiece::Curve(nodes) => nodes.iter().fold(box_, grown),
    })
}

/// The part of a chain where normal · x >= offset, for a unit normal.
fn half(chain: &[EdgePiece], normal: &Vector<2>, offset: f64) -> Vec<EdgePiece> {
    let distance = |p: &Vector<2>| normal.dot(p) - offset;
    let mut split = Vec::with_capacity(chain.len() + 2);
    for piece in chain {
        match piece {
            EdgePiece::Line(..) => split.push(*piece),
            EdgePiece::Curve(_) => {
                let mut cuts = vec![0.0];
                cuts.extend(crossings(piece, &distance));
                cuts.push(1.0);
                for w in cuts.windows(2) {
                    let part = piece.part(w[0], w[1]);
                    // what lies beyond is a chord, which is cut away
                    let stays = distance(&part.at(0.5)[0]) >= 0.0;
                    split.push(if stays { part } else { EdgePiece::Line(part.from(), part.to()) });
                }
            }
        }
    }
    // ends of parts lie on the line to rounding only: those of kept curves stay where they are
    simplified(halved(split, distance, |p| p - normal * distance(p)), COLLINEAR)
}

/// Parameters at which a curved piece crosses the zero line of a linear function.
fn crossings(piece: &EdgePiece, distance: &impl Fn(&Vector<2>) -> f64) -> Vec<f64> {
    const PARTS: usize = 16;
    let at = |t: f64| distance(&piece.at(t)[0]);
    let values: Vec<f64> = (0..=PARTS).map(|i| at(i as f64 / PARTS as f64)).collect();
    let mut found = Vec::new();
    for i in 0..PARTS {
        if (values[i] < 0.0) != (values[i + 1] < 0.0) {
            let (mut lo, mut hi) = (i as f64 / PARTS as f64, (i + 1) as f64 / PARTS as f64);
            for _ in 0..52 {
                let t = 0.5 * (lo + hi);
                if (at(t) < 0.0) == (values[i] < 0.0) { lo = t } else { hi = t }
            }
            found.push(0.5 * (lo + hi));
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::super::piece::nodes;
    use super::*;

    fn polygon(points: &[[f64; 2]]) -> Vec<EdgePiece> {
        let at = |k: usize| Vector::<2>::from(points[k % points.len()]);
        (0..points.len()).map(|k| EdgePiece::Line(at(k), at(k + 1))).collect()
    }

    fn integral(points: &WeightedPoints, f: impl Fn(&Vector<2>) -> f64) -> f64 {
        points.iter().map(|(x, w)| f(x) * w).sum()
    }

    #[test]
    fn straight_regions_are_integrated_exactly() {
        let rule = LineRule::new(3);
        let chains: [&[[f64; 2]]; 4] = [
            &[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]],
            &[[0.1, 0.2], [0.9, 0.1], [0.8, 0.7], [0.2, 0.9]],
            &[[0.1, 0.2], [0.9, 0.1], [0.4, 0.9]],
            // not convex: no corner sees all of it
            &[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.8, 1.0], [0.8, 0.2], [0.2, 0.2], [0.2, 1.0], [0.0, 1.0]],
        ];
        for points in chains {
            let (chain, mut out) = (polygon(points), Vec::new());
            fill(&chain, &[], &rule, &mut out);
            assert!(out.iter().all(|(_, w)| *w >= 0.0));
            assert!((integral(&out, |_| 1.0) - area(&chain)).abs() < 1e-15, "{points:?}");
            // the moments of x^2 y by Green's theorem: the integral of x^3 y / 3 dy
            let line = LineRule::new(4);
            let green: f64 = chain
                .iter()
                .map(|piece| {
                    (0..4)
                        .map(|q| {
                            let [c, d] = line.at(piece, q);
                            line.weights[q] * c[0].powi(3) * c[1] / 3.0 * d[1]
                        })
                        .sum::<f64>()
                })
                .sum();
            assert!((integral(&out, |x| x[0] * x[0] * x[1]) - green).abs() < 1e-15, "{points:?}");
        }
    }

    #[test]
    fn curved_regions_converge_to_green_and_have_no_negative_weight() {
        let at = |k: usize, t: f64| {
            let (a, bulge) = (std::f64::consts::FRAC_PI_2 * (k as f64 + t), 0.1 * (9.0 * (k as f64 + t)).sin());
            Vector::<2>::new(a.cos() * (0.5 + bulge), a.sin() * (0.5 + bulge))
        };
        let mut chain: Vec<EdgePiece> = (0..4).map(|k| EdgePiece::Curve(nodes().map(|t| at(k, t)))).collect();
        let closed = chain[0].from();
        let end = chain[3].to();
        chain.push(EdgePiece::Line(end, closed));
        let line = LineRule::new(20);
        let green: f64 = chain
            .iter()
            .map(|piece| {
                (0..20)
                    .map(|q| {
                        let [c, d] = line.at(piece, q);
                        line.weights[q] * c[0].powi(3) / 3.0 * d[1]
                    })
                    .sum::<f64>()
            })
            .sum();
        // exact: degrees 2 + 1 along the rays, 3 · 8 + 7 across
        let rule = LineRule::new(16);
        let mut out = Vec::new();
        fill(&chain, &[], &rule, &mut out);
        assert!(out.iter().all(|(_, w)| *w >= 0.0));
        assert!((integral(&out, |_| 1.0) - area(&chain)).abs() < 1e-12);
        assert!((integral(&out, |x| x[0] * x[0]) - green).abs() < 1e-12);
    }
}
