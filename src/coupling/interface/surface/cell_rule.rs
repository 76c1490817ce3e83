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

use super::clip::{halved, simplified};
use super::piece::{LineRule, Piece, area, wedge};
use crate::linalg::Vector;

/// Sectors and regions below this share of the cell are dropped.
const NOTHING: f64 = 1e-15;
/// Sectors of less than this share of the region are dropped.
const NO_SECTOR: f64 = 1e-12;
/// Least product of the sides at a corner of a Coons map, as a share of the area.
const CORNER: f64 = 0.03;
/// Deepest cutting of a region.
const DEPTH: usize = 10;
/// Grid of apices.
const APICES: usize = 7;

/// Points and weights of a region, in the chart.
pub(super) type Points = Vec<(Vector<2>, f64)>;

/// Appends the points of a region; returns the area that could not be filled.
pub(super) fn fill(chain: &[Piece], rule: &LineRule, out: &mut Points) -> f64 {
    filled(chain, rule, DEPTH, out)
}

fn filled(chain: &[Piece], rule: &LineRule, depth: usize, out: &mut Points) -> f64 {
    let whole = area(chain);
    if whole <= NOTHING {
        return 0.0;
    }
    if chain.len() == 4 && coons(chain, whole, rule, out) {
        return 0.0;
    }
    if let Some(apex) = apex(chain, whole, rule) {
        for piece in chain.iter().filter(|piece| piece.area(&apex) > NO_SECTOR * whole) {
            sector(&apex, piece, rule, out);
        }
        return 0.0;
    }
    if depth == 0 {
        return whole;
    }
    let (lo, hi) = extent(chain);
    let axis = if hi[0] - lo[0] >= hi[1] - lo[1] { 0 } else { 1 };
    let middle = 0.5 * (lo[axis] + hi[axis]);
    [1.0, -1.0].iter().map(|&sign| filled(&half(chain, axis, middle, sign), rule, depth - 1, out)).sum()
}

/// An apex from which all sectors have an area of at least zero, everywhere.
fn apex(chain: &[Piece], whole: f64, rule: &LineRule) -> Option<Vector<2>> {
    let sees = |apex: &Vector<2>| {
        chain.iter().all(|piece| match piece {
            Piece::Line(..) => piece.area(apex) >= -NO_SECTOR * whole,
            Piece::Curve(_) => (0..rule.t.len()).all(|q| {
                let [c, d] = rule.at(piece, q);
                wedge(&(c - apex), &d) >= 0.0
            }),
        })
    };
    let corners = chain.iter().map(Piece::from);
    let count = chain.len() as f64;
    let mean = chain.iter().fold(Vector::zeros(), |s: Vector<2>, piece| s + piece.from()) / count;
    let (lo, hi) = extent(chain);
    let grid = (0..APICES * APICES).map(|q| {
        let t = |i: usize| (i as f64 + 0.5) / APICES as f64;
        let (i, j) = (t(q % APICES), t(q / APICES));
        Vector::<2>::new(lo[0] + (hi[0] - lo[0]) * i, lo[1] + (hi[1] - lo[1]) * j)
    });
    corners.chain([mean]).chain(grid).find(sees)
}

/// Box around the points of a chain.
fn extent(chain: &[Piece]) -> (Vector<2>, Vector<2>) {
    let mut points: Vec<Vector<2>> = chain.iter().map(Piece::from).collect();
    for piece in chain {
        if let Piece::Curve(nodes) = piece {
            points.extend_from_slice(nodes);
        }
    }
    points.iter().fold((points[0], points[0]), |(lo, hi), p| (lo.inf(p), hi.sup(p)))
}

fn sector(apex: &Vector<2>, piece: &Piece, rule: &LineRule, out: &mut Points) {
    for (q, &wt) in rule.weights.iter().enumerate() {
        let [c, d] = rule.at(piece, q);
        let across = wedge(&(c - apex), &d);
        for (&r, &wr) in rule.t.iter().zip(&rule.weights) {
            out.push((apex + (c - apex) * r, (wt * wr * r * across).max(0.0)));
        }
    }
}

/// Fills four pieces by Coons' map; nothing where its Jacobian is not positive.
fn coons(chain: &[Piece], whole: f64, rule: &LineRule, out: &mut Points) -> bool {
    let p: [Vector<2>; 4] = std::array::from_fn(|k| chain[k].from());
    if (0..4).any(|k| wedge(&(p[(k + 1) % 4] - p[k]), &(p[(k + 3) % 4] - p[k])) <= CORNER * whole) {
        return false;
    }
    let (n, start) = (rule.t.len(), out.len());
    for i in 0..n {
        for j in 0..n {
            let (s, t) = (rule.t[i], rule.t[j]);
            let ([c0, d0], [c1, d1]) = (rule.at(&chain[0], i), rule.at(&chain[1], j));
            // Gauss points are symmetric: the opposite sides are walked backwards
            let ([c2, d2], [c3, d3]) = (rule.at(&chain[2], n - 1 - i), rule.at(&chain[3], n - 1 - j));
            let low = p[0] * (1.0 - s) + p[1] * s;
            let high = p[3] * (1.0 - s) + p[2] * s;
            let x = c0 * (1.0 - t) + c2 * t + c3 * (1.0 - s) + c1 * s - low * (1.0 - t) - high * t;
            let by_s = d0 * (1.0 - t) - d2 * t - c3 + c1 - (p[1] - p[0]) * (1.0 - t) - (p[2] - p[3]) * t;
            let by_t = c2 - c0 - d3 * (1.0 - s) + d1 * s - (high - low);
            let jacobian = wedge(&by_s, &by_t);
            if jacobian <= 0.0 {
                out.truncate(start);
                return false;
            }
            out.push((x, rule.weights[i] * rule.weights[j] * jacobian));
        }
    }
    true
}

/// The part of a chain on one side of a line x_axis = value: the upper one for the sign 1, the lower one for -1.
fn half(chain: &[Piece], axis: usize, value: f64, sign: f64) -> Vec<Piece> {
    let distance = |p: &Vector<2>| (p[axis] - value) * sign;
    let mut split = Vec::with_capacity(chain.len() + 2);
    for piece in chain {
        match piece {
            Piece::Line(..) => split.push(*piece),
            Piece::Curve(_) => {
                let mut cuts = vec![0.0];
                cuts.extend(crossings(piece, &distance));
                cuts.push(1.0);
                for w in cuts.windows(2) {
                    let part = piece.part(w[0], w[1]);
                    // what lies beyond is a chord, which is cut away
                    let stays = distance(&part.at(0.5)[0]) >= 0.0;
                    split.push(if stays { part } else { Piece::Line(part.from(), part.to()) });
                }
            }
        }
    }
    // ends of parts lie on the line to rounding only: those of kept curves stay where they are
    simplified(halved(split, distance, |p| {
        let mut on = *p;
        on[axis] = value;
        on
    }))
}

/// Parameters at which a curved piece crosses the zero line of a linear function.
fn crossings(piece: &Piece, distance: &impl Fn(&Vector<2>) -> f64) -> Vec<f64> {
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

    fn polygon(points: &[[f64; 2]]) -> Vec<Piece> {
        let at = |k: usize| Vector::<2>::from(points[k % points.len()]);
        (0..points.len()).map(|k| Piece::Line(at(k), at(k + 1))).collect()
    }

    fn integral(points: &Points, f: impl Fn(&Vector<2>) -> f64) -> f64 {
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
            assert_eq!(fill(&chain, &rule, &mut out), 0.0);
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
        let mut chain: Vec<Piece> = (0..4).map(|k| Piece::Curve(nodes().map(|t| at(k, t)))).collect();
        let closed = chain[0].from();
        let end = chain[3].to();
        chain.push(Piece::Line(end, closed));
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
        assert_eq!(fill(&chain, &rule, &mut out), 0.0);
        assert!(out.iter().all(|(_, w)| *w >= 0.0));
        assert!((integral(&out, |_| 1.0) - area(&chain)).abs() < 1e-12);
        assert!((integral(&out, |x| x[0] * x[0]) - green).abs() < 1e-12);
    }
}
