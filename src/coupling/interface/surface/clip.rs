//! Sutherland-Hodgman clipping of a closed chain of pieces by the sides of the cell.
//!
//! Curved pieces lie in the cell and are kept; chords are cut, and gaps closed along the side that cut them. The cell is convex, so
//! the result has the exact area of the common part; what it covers twice, in opposite directions along a side, has none.

use super::piece::{EdgePiece, wedge};
use super::polygon::Polygon;
use crate::linalg::Vector;

/// Pieces shorter than this are points.
const POINT: f64 = 1e-15;
/// Lines with an end this near to their chord, up to rounding, are one.
pub(super) const COLLINEAR: f64 = 1e-15;

/// The part of a chain in the cell, its corners within `near` of a line left out.
pub(super) fn clip(polygon: Polygon, chain: Vec<EdgePiece>, near: f64) -> Vec<EdgePiece> {
    let mut chain = chain;
    for k in 0..polygon.sides() {
        let is_inside =
            |piece: &EdgePiece| piece.is_curve() || polygon.distance(k, &piece.from()) >= 0.0 && polygon.distance(k, &piece.to()) >= 0.0;
        if chain.iter().all(is_inside) {
            continue;
        }
        chain = halved(chain, |p| polygon.distance(k, p), |p| polygon.put_on(k, p));
        if chain.is_empty() {
            return chain;
        }
    }
    simplified(chain, near)
}

/// The part of a chain where the linear function `distance` is not negative; `put_on` moves points onto its zero line.
pub(super) fn halved(
    chain: Vec<EdgePiece>,
    distance: impl Fn(&Vector<2>) -> f64,
    put_on: impl Fn(&Vector<2>) -> Vector<2>,
) -> Vec<EdgePiece> {
    let mut out: Vec<EdgePiece> = Vec::with_capacity(chain.len() + 4);
    let mut push = |piece: EdgePiece| {
        if let Some(last) = out.last()
            && last.to() != piece.from()
        {
            let gap = EdgePiece::Line(last.to(), piece.from());
            out.push(gap);
        }
        out.push(piece);
    };
    for piece in chain {
        let EdgePiece::Line(a, b) = piece else {
            push(piece);
            continue;
        };
        let (da, db) = (distance(&a), distance(&b));
        let cut = || put_on(&(a + (b - a) * (da / (da - db))));
        match (da >= 0.0, db >= 0.0) {
            (true, true) => push(piece),
            (true, false) if da > 0.0 => push(EdgePiece::Line(a, cut())),
            (false, true) if db > 0.0 => push(EdgePiece::Line(cut(), b)),
            _ => {}
        }
    }
    if let (Some(first), Some(last)) = (out.first(), out.last())
        && last.to() != first.from()
    {
        let gap = EdgePiece::Line(last.to(), first.from());
        out.push(gap);
    }
    out
}

/// A chain without points, consecutive lines on one line to the distance `near` joined; spikes vanish with that.
pub(super) fn simplified(chain: Vec<EdgePiece>, near: f64) -> Vec<EdgePiece> {
    let mut out: Vec<EdgePiece> = Vec::with_capacity(chain.len());
    for piece in chain {
        if piece.chord() <= POINT && !piece.is_curve() {
            continue;
        }
        match out.last().and_then(|last| joined(last, &piece, near)) {
            Some(line) => {
                out.pop();
                if line.chord() > POINT {
                    out.push(line);
                }
            }
            None => out.push(piece),
        }
    }
    while out.len() > 2
        && let Some(line) = joined(&out[out.len() - 1], &out[0], near)
    {
        out.pop();
        out[0] = line;
        if out[0].chord() <= POINT {
            out.remove(0);
        }
    }
    if out.len() < 2 && !out.iter().any(EdgePiece::is_curve) { Vec::new() } else { out }
}

/// Two lines on one line to a distance as one.
fn joined(a: &EdgePiece, b: &EdgePiece, near: f64) -> Option<EdgePiece> {
    let (EdgePiece::Line(p, q), EdgePiece::Line(_, r)) = (a, b) else { return None };
    let (along, next) = (q - p, r - q);
    let scale = along.norm() + next.norm();
    let off = wedge(&along, &next).abs();
    (off <= near * scale).then_some(EdgePiece::Line(*p, *r))
}

#[cfg(test)]
mod tests {
    use super::super::piece::area;
    use super::*;

    fn polygon(points: &[[f64; 2]]) -> Vec<EdgePiece> {
        let at = |k: usize| Vector::<2>::from(points[k % points.len()]);
        (0..points.len()).map(|k| EdgePiece::Line(at(k), at(k + 1))).collect()
    }

    #[test]
    fn common_parts_of_polygons_have_their_area() {
        let cases: [(&[[f64; 2]], f64, usize); 6] = [
            (&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]], 1.0, 4),
            (&[[-1.0, -1.0], [0.5, -1.0], [0.5, 0.5], [-1.0, 0.5]], 0.25, 4),
            (&[[0.5, -0.5], [1.5, 0.5], [0.5, 1.5], [-0.5, 0.5]], 1.0, 4),
            (&[[2.0, 0.0], [3.0, 0.0], [3.0, 1.0]], 0.0, 0),
            (&[[1.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0]], 0.0, 0),
            (&[[0.25, 0.25], [0.75, 0.25], [0.5, 0.75]], 0.125, 3),
        ];
        for (points, expected, count) in cases {
            let found = clip(Polygon::Square, polygon(points), COLLINEAR);
            assert!((area(&found) - expected).abs() < 1e-15, "{points:?}: {found:?}");
            if expected > 0.0 {
                assert_eq!(found.len(), count, "{points:?}: {found:?}");
            }
        }
        let triangle = clip(Polygon::Triangle, polygon(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]), COLLINEAR);
        assert_eq!((area(&triangle), triangle.len()), (0.5, 3));
    }
}
