//! Sides and corners of spline patches, and the relative orientation of two common sides.

use super::SplinePatch;

/// Names of the sides: direction d has the sides 2 d and 2 d + 1.
pub(super) const SIDES: [&str; 6] = ["u0", "u1", "v0", "v1", "w0", "w1"];

/// The number of a side.
pub(super) fn side_number(name: &str) -> Option<usize> {
    SIDES.iter().position(|s| *s == name)
}

/// Functions per direction.
pub(super) fn counts(patch: &SplinePatch) -> Vec<usize> {
    patch.degree.iter().zip(&patch.knots).map(|(p, knots)| knots.len().saturating_sub(p + 1)).collect()
}

/// The control point at a corner: bit k of `bits` is the end of direction k.
pub(super) fn corner_point(patch: &SplinePatch, bits: usize) -> [f64; 3] {
    let mut place = 0;
    let mut stride = 1;
    for (k, n) in counts(patch).into_iter().enumerate() {
        if bits >> k & 1 == 1 {
            place += stride * (n - 1);
        }
        stride *= n;
    }
    patch.points[place]
}

/// Directions along a side, rising.
pub(super) fn tangents(dimension: usize, side: usize) -> Vec<usize> {
    (0..dimension).filter(|d| *d != side / 2).collect()
}

/// The corner of the patch at a corner of its side: bit i of `bits` is the end of the i-th direction along the side.
pub(super) fn side_corner(dimension: usize, side: usize, bits: usize) -> usize {
    let along = tangents(dimension, side).into_iter().enumerate();
    along.fold((side & 1) << (side / 2), |all, (i, d)| all | (bits >> i & 1) << d)
}

/// Orientation of one side relative to another: permutation and signs of the directions along them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Lie {
    /// Whether the first direction of one is the second of the other.
    pub swap: bool,
    /// Per direction of the first side, whether the two run against each other.
    pub flip: [bool; 2],
}

impl Lie {
    /// Direction along the second side that corresponds to direction i along the first.
    pub(super) fn direction(self, i: usize) -> usize {
        if self.swap { 1 - i } else { i }
    }

    /// The corner of the second side at a corner of the first, whose sides have `directions` directions.
    pub(super) fn corner(self, bits: usize, directions: usize) -> usize {
        (0..directions).fold(0, |all, i| all | ((bits >> i & 1) ^ usize::from(self.flip[i])) << self.direction(i))
    }
}

/// Orientation of the side of one patch on that of another that brings the corners nearest together.
pub(super) fn lie(one: (&SplinePatch, usize), other: (&SplinePatch, usize)) -> Lie {
    let dimension = one.0.dimension();
    let directions = dimension - 1;
    let apart = |lie: &Lie| {
        (0..1usize << directions)
            .map(|bits| {
                let a = corner_point(one.0, side_corner(dimension, one.1, bits));
                let b = corner_point(other.0, side_corner(dimension, other.1, lie.corner(bits, directions)));
                (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>()
            })
            .sum::<f64>()
    };
    let all = (0..8usize).map(|k| Lie { swap: k & 4 != 0, flip: [k & 1 != 0, k & 2 != 0] });
    let fits = |lie: &Lie| (directions == 2 || !lie.swap) && (0..2).all(|i| i < directions || !lie.flip[i]);
    all.filter(fits).min_by(|a, b| apart(a).total_cmp(&apart(b))).unwrap_or_default()
}

/// Whether the corners of two common sides are the same points, up to a millionth of the first patch's size.
pub(super) fn touch(one: (&SplinePatch, usize), other: (&SplinePatch, usize), lie: Lie) -> bool {
    const TOLERANCE: f64 = 1e-6;
    let dimension = one.0.dimension();
    let distance = |a: [f64; 3], b: [f64; 3]| (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt();
    let first = one.0.points[0];
    let size = one.0.points.iter().map(|p| distance(*p, first)).fold(0.0, f64::max);
    (0..1usize << (dimension - 1)).all(|bits| {
        let a = corner_point(one.0, side_corner(dimension, one.1, bits));
        let b = corner_point(other.0, side_corner(dimension, other.1, lie.corner(bits, dimension - 1)));
        distance(a, b) <= TOLERANCE * size
    })
}

/// Whether the knots of two common sides agree, up to the origin and the length of the parameters.
pub(super) fn knots_agree(one: (&SplinePatch, usize), other: (&SplinePatch, usize), lie: Lie) -> bool {
    /// Largest difference of knots on the unit interval that counts as rounding.
    const TOLERANCE: f64 = 1e-12;
    let dimension = one.0.dimension();
    let unit = |patch: &SplinePatch, d: usize, turn: bool| {
        let knots = &patch.knots[d];
        let (a, b) = (knots[0], knots[knots.len() - 1]);
        let mut all: Vec<f64> = knots.iter().map(|t| if turn { (b - t) / (b - a) } else { (t - a) / (b - a) }).collect();
        if turn {
            all.reverse();
        }
        all
    };
    let second = tangents(dimension, other.1);
    tangents(dimension, one.1).into_iter().enumerate().all(|(i, d)| {
        let e = second[lie.direction(i)];
        let (a, b) = (unit(one.0, d, false), unit(other.0, e, lie.flip[i]));
        one.0.degree[d] == other.0.degree[e] && a.len() == b.len() && a.iter().zip(&b).all(|(x, y)| (x - y).abs() <= TOLERANCE)
    })
}
