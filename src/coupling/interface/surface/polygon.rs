//! The reference cells of facets as convex polygons: corners counter-clockwise, distances to sides, least points of quadratics.

use crate::linalg::{Matrix, Vector, inverse};

/// The unit square, or the triangle with the corners (0, 0), (1, 0), (0, 1).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Polygon {
    Square,
    Triangle,
}

impl Polygon {
    /// Number of corners, and of sides: side k leads from corner k to corner k + 1.
    pub fn sides(self) -> usize {
        match self {
            Self::Square => 4,
            Self::Triangle => 3,
        }
    }

    pub fn area(self) -> f64 {
        match self {
            Self::Square => 1.0,
            Self::Triangle => 0.5,
        }
    }

    /// Corner `k` modulo their number.
    pub fn corner(self, k: usize) -> Vector<2> {
        let at: &[[f64; 2]] = match self {
            Self::Square => &[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]],
            Self::Triangle => &[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]],
        };
        Vector::from(at[k % at.len()])
    }

    pub fn center(self) -> Vector<2> {
        (0..self.sides()).fold(Vector::zeros(), |s: Vector<2>, k| s + self.corner(k)) / self.sides() as f64
    }

    /// The point at `t` of side `k`, 0 and 1 at its corners.
    pub fn on_side(self, k: usize, t: f64) -> Vector<2> {
        let (a, b) = (self.corner(k), self.corner(k + 1));
        if t == 1.0 { b } else { a + (b - a) * t }
    }

    /// The linear function of side `k` that is zero on it and positive inside: v, 1 - u, 1 - v, u of the square, q, 1 - p - q, p of the triangle.
    pub fn distance(self, k: usize, at: &Vector<2>) -> f64 {
        match (self, k) {
            (_, 0) => at[1],
            (Self::Square, 1) => 1.0 - at[0],
            (Self::Square, 2) => 1.0 - at[1],
            (Self::Triangle, 1) => 1.0 - at[0] - at[1],
            _ => at[0],
        }
    }

    /// The least distance to a side: positive inside, negative outside.
    pub fn depth(self, at: &Vector<2>) -> f64 {
        (0..self.sides()).map(|k| self.distance(k, at)).fold(f64::INFINITY, f64::min)
    }

    /// The side of the least distance.
    pub fn nearest_side(self, at: &Vector<2>) -> usize {
        (1..self.sides()).fold(0, |best, k| if self.distance(k, at) < self.distance(best, at) { k } else { best })
    }

    /// The point moved onto the line of side `k`.
    pub fn put_on(self, k: usize, at: &Vector<2>) -> Vector<2> {
        match (self, k) {
            (_, 0) => Vector::<2>::new(at[0], 0.0),
            (Self::Square, 1) => Vector::<2>::new(1.0, at[1]),
            (Self::Square, 2) => Vector::<2>::new(at[0], 1.0),
            (Self::Triangle, 1) => {
                // of p and q the larger one takes the rounding
                if at[0] > at[1] { Vector::<2>::new(1.0 - at[1], at[1]) } else { Vector::<2>::new(at[0], 1.0 - at[0]) }
            }
            _ => Vector::<2>::new(0.0, at[1]),
        }
    }

    /// The point, on every side that is within `snap`.
    pub fn snapped(self, at: &Vector<2>, snap: f64) -> Vector<2> {
        let near = |k: usize, p: &Vector<2>| self.distance(k, p).abs() <= snap;
        let mut p = *at;
        // the slanted side last: it keeps a coordinate that is zero
        for k in [0, 2, 3, 1].into_iter().filter(|&k| k < self.sides()) {
            if near(k, &p) {
                p = self.put_on(k, &p);
            }
        }
        p
    }

    /// The least point of d·H d / 2 - g·d over all `from` + d in the closed polygon, for a positive definite H.
    pub fn least(self, from: &Vector<2>, h: &Matrix<2, 2>, g: &Vector<2>) -> Vector<2> {
        if let Some(free) = inverse(h).map(|inv| from + inv * g)
            && self.depth(&free) >= 0.0
        {
            return free;
        }
        let value = |at: &Vector<2>| {
            let d = at - from;
            0.5 * d.dot(&(h * d)) - g.dot(&d)
        };
        let mut best = (f64::INFINITY, *from);
        for k in 0..self.sides() {
            let (start, along) = (self.corner(k), self.corner(k + 1) - self.corner(k));
            let curvature = along.dot(&(h * along));
            let slope = along.dot(&(g - h * (start - from)));
            let t = if curvature > 0.0 { (slope / curvature).clamp(0.0, 1.0) } else { 0.0 };
            let at = self.on_side(k, t);
            if value(&at) < best.0 {
                best = (value(&at), at);
            }
        }
        best.1
    }

    /// The number of the point (i, j) / (n - 1) in [`grid`](Self::grid)`(n)`.
    pub fn grid_index(self, n: usize, i: usize, j: usize) -> usize {
        match self {
            Self::Square => j * n + i,
            // rows of n, n - 1, ... points
            Self::Triangle => j * (2 * n + 1 - j) / 2 + i,
        }
    }

    /// The number of point `i` of side `k` in [`grid`](Self::grid)`(n)`, counted from corner k.
    pub fn side_index(self, n: usize, k: usize, i: usize) -> usize {
        let back = n - 1 - i;
        let (a, b) = match (self, k) {
            (_, 0) => (i, 0),
            (Self::Square, 1) => (n - 1, i),
            (Self::Square, 2) => (back, n - 1),
            (Self::Triangle, 1) => (back, i),
            _ => (0, back),
        };
        self.grid_index(n, a, b)
    }

    /// All points of a grid with `n` points along a side, ends included.
    pub fn grid(self, n: usize) -> Vec<Vector<2>> {
        let step = 1.0 / (n - 1) as f64;
        let keep = |i: usize, j: usize| self == Self::Square || i + j < n;
        let all = (0..n * n).map(|q| (q % n, q / n)).filter(|&(i, j)| keep(i, j));
        all.map(|(i, j)| Vector::<2>::new(i as f64 * step, j as f64 * step)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sides_are_where_their_distance_is_zero_and_the_inside_is_positive() {
        for polygon in [Polygon::Square, Polygon::Triangle] {
            assert!(polygon.depth(&polygon.center()) > 0.0);
            for k in 0..polygon.sides() {
                for t in [0.0, 0.3, 1.0] {
                    assert!(polygon.distance(k, &polygon.on_side(k, t)).abs() < 1e-15);
                    let near = polygon.on_side(k, t) + (polygon.center() - polygon.on_side(k, t)) * 1e-15;
                    assert_eq!(polygon.distance(k, &polygon.snapped(&near, 1e-14)), 0.0);
                }
                for i in 0..5 {
                    let on = polygon.on_side(k, i as f64 * 0.25);
                    assert_eq!(polygon.grid(5)[polygon.side_index(5, k, i)], on);
                }
            }
        }
    }

    #[test]
    fn the_least_point_of_a_quadratic_is_inside_or_on_the_side_it_is_pushed_to() {
        let h = Matrix::<2, 2>::new(2.0, 0.5, 0.5, 1.0);
        for polygon in [Polygon::Square, Polygon::Triangle] {
            for target in [[0.2, 0.3], [2.0, 0.5], [-1.0, -1.0], [0.9, 0.9], [-0.3, 0.4]] {
                let (from, target) = (polygon.center(), Vector::<2>::from(target));
                let found = polygon.least(&from, &h, &(h * (target - from)));
                let value = |p: &Vector<2>| (p - target).dot(&(h * (p - target)));
                assert!(polygon.depth(&found) >= -1e-15);
                assert!(polygon.grid(41).iter().all(|p| value(p) >= value(&found) - 1e-12), "{target:?} {found:?}");
            }
        }
    }
}
