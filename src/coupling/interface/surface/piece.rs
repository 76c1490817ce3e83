//! Pieces of edges in the chart of a facet: chords, and polynomials of degree 8 through Chebyshev-Lobatto points.

use crate::linalg::Vector;
use crate::quadrature::gauss_legendre;
use std::sync::LazyLock;

/// Nodes of a curved piece.
pub(super) const NODES: usize = 9;

/// A directed piece of an edge.
#[derive(Clone, Copy, Debug)]
pub(super) enum EdgePiece {
    Line(Vector<2>, Vector<2>),
    /// Points at the parameters of [`nodes`].
    Curve([Vector<2>; NODES]),
}

/// Chebyshev-Lobatto points on [0, 1], (1 - cos(i pi / 8)) / 2.
pub(super) fn nodes() -> [f64; NODES] {
    static AT: LazyLock<[f64; NODES]> = LazyLock::new(|| {
        std::array::from_fn(
            |i| if i + 1 == NODES { 1.0 } else { (0.5 * std::f64::consts::PI * i as f64 / (NODES - 1) as f64).sin().powi(2) },
        )
    });
    *AT
}

/// The product of the other factors t_i - t_j of every Lagrange polynomial of [`nodes`], inverted.
static SPANS: LazyLock<[f64; NODES]> = LazyLock::new(|| {
    let at = nodes();
    std::array::from_fn(|i| (0..NODES).filter(|&j| j != i).map(|j| 1.0 / (at[i] - at[j])).product())
});

/// Values and derivatives at t of the Lagrange polynomials of [`nodes`].
fn lagrange(t: f64) -> [[f64; NODES]; 2] {
    let away = nodes().map(|node| t - node);
    // products of the factors before and behind every one, with their derivatives
    let (mut before, mut behind) = ([[1.0, 0.0]; NODES], [[1.0, 0.0]; NODES]);
    let times = |[value, slope]: [f64; 2], factor: f64| [value * factor, slope * factor + value];
    for i in 1..NODES {
        before[i] = times(before[i - 1], away[i - 1]);
        behind[NODES - 1 - i] = times(behind[NODES - i], away[NODES - i]);
    }
    let mut out = [[0.0; NODES]; 2];
    for (i, span) in SPANS.iter().enumerate() {
        let ([a, da], [b, db]) = (before[i], behind[i]);
        (out[0][i], out[1][i]) = (a * b * span, (da * b + a * db) * span);
    }
    out
}

/// Gauss points on [0, 1] with weights, and the Lagrange polynomials there.
#[derive(Clone, Debug)]
pub(super) struct LineRule {
    pub t: Vec<f64>,
    pub weights: Vec<f64>,
    shapes: Vec<[[f64; NODES]; 2]>,
}

impl LineRule {
    pub fn new(n: usize) -> Self {
        let rule = gauss_legendre::<f64>(n);
        let t: Vec<f64> = rule.points.iter().map(|p| p[0]).collect();
        let shapes = t.iter().map(|&t| lagrange(t)).collect();
        Self { t, weights: rule.weights, shapes }
    }

    /// Position and derivative of `piece` at point q of the rule.
    pub fn at(&self, piece: &EdgePiece, q: usize) -> [Vector<2>; 2] {
        match piece {
            EdgePiece::Line(a, b) => [a + (b - a) * self.t[q], b - a],
            EdgePiece::Curve(points) => combined(points, &self.shapes[q]),
        }
    }
}

/// The rule that integrates areas of curved pieces exactly.
static EXACT: LazyLock<LineRule> = LazyLock::new(|| LineRule::new(NODES));

fn combined(points: &[Vector<2>; NODES], shapes: &[[f64; NODES]; 2]) -> [Vector<2>; 2] {
    [0, 1].map(|k| points.iter().zip(&shapes[k]).fold(Vector::zeros(), |s: Vector<2>, (p, &l)| s + p * l))
}

/// a x b in the plane.
pub(super) fn wedge(a: &Vector<2>, b: &Vector<2>) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

impl EdgePiece {
    pub fn from(&self) -> Vector<2> {
        match self {
            Self::Line(a, _) => *a,
            Self::Curve(points) => points[0],
        }
    }

    pub fn to(&self) -> Vector<2> {
        match self {
            Self::Line(_, b) => *b,
            Self::Curve(points) => points[NODES - 1],
        }
    }

    pub fn is_curve(&self) -> bool {
        matches!(self, Self::Curve(_))
    }

    /// The piece walked the other way.
    pub fn reversed(&self) -> Self {
        match self {
            Self::Line(a, b) => Self::Line(*b, *a),
            Self::Curve(points) => Self::Curve(std::array::from_fn(|i| points[NODES - 1 - i])),
        }
    }

    /// Position and derivative at t.
    pub fn at(&self, t: f64) -> [Vector<2>; 2] {
        match self {
            Self::Line(a, b) => [a + (b - a) * t, b - a],
            Self::Curve(points) => combined(points, &lagrange(t)),
        }
    }

    /// The part between the parameters `a` and `b`; exact, since it is a polynomial of the same degree.
    pub fn part(&self, a: f64, b: f64) -> Self {
        let at = |t: f64| {
            if t == 0.0 {
                self.from()
            } else if t == 1.0 {
                self.to()
            } else {
                self.at(t)[0]
            }
        };
        match self {
            Self::Line(..) => Self::Line(at(a), at(b)),
            Self::Curve(_) => {
                let nodes = nodes();
                Self::Curve(std::array::from_fn(|i| at(if i + 1 == NODES { b } else { a + (b - a) * nodes[i] })))
            }
        }
    }

    /// Integral of (c - apex) x c' / 2: its part of the area of a closed chain.
    pub fn area(&self, apex: &Vector<2>) -> f64 {
        match self {
            Self::Line(a, b) => 0.5 * wedge(&(a - apex), &(b - apex)),
            Self::Curve(_) => {
                let rule = &*EXACT;
                (0..rule.t.len())
                    .map(|q| {
                        let [c, d] = rule.at(self, q);
                        0.5 * rule.weights[q] * wedge(&(c - apex), &d)
                    })
                    .sum()
            }
        }
    }

    /// The length of the chord.
    pub fn chord(&self) -> f64 {
        (self.to() - self.from()).norm()
    }
}

/// Signed area inside a closed chain.
pub(super) fn area(chain: &[EdgePiece]) -> f64 {
    let apex = chain.first().map_or_else(Vector::zeros, EdgePiece::from);
    chain.iter().map(|piece| piece.area(&apex)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polynomials_of_degree_8_are_kept_in_parts_and_their_areas_exact() {
        let of = |t: f64| Vector::<2>::new(t - 0.3 * t.powi(8), t * t - 0.2 * t.powi(7));
        let piece = EdgePiece::Curve(nodes().map(of));
        let slope = |t: f64| Vector::<2>::new(1.0 - 2.4 * t.powi(7), 2.0 * t - 1.4 * t.powi(6));
        for t in [0.0, 0.1, 0.77, 1.0] {
            let [c, d] = piece.at(t);
            assert!((c - of(t)).amax() < 1e-14 && (d - slope(t)).amax() < 1e-12, "{t}");
            assert!((piece.part(0.2, 0.9).at(t)[0] - of(0.2 + 0.7 * t)).amax() < 1e-14, "{t}");
        }
        let split = area(&[piece.part(0.0, 0.4), piece.part(0.4, 1.0)]);
        assert!((area(&[piece]) - split).abs() < 1e-15);
        assert!((area(&[piece]) + area(&[piece.reversed()])).abs() < 1e-15);
    }
}
