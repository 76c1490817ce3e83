//! Facets whose map is a polynomial of at most degree 2 in each coordinate, by its coefficients: evaluated without a table of functions.

use super::polygon::Polygon;
use crate::linalg::{Matrix, Vector};

/// x(u, v) = x_0 + sum over i, j <= 2 of c_ij a^i b^j with (a, b) = (u - 1/2, v - 1/2) and c_ij at 3 j + i.
#[derive(Clone, Copy, Debug)]
pub(super) struct Biquadratic {
    origin: Vector<3>,
    c: [Vector<3>; 9],
}

impl Biquadratic {
    /// The polynomial with the values `x(i, j)` at (i, j) / 2: those in the cell, which make it one of total degree 2 on a triangle. Its
    /// coefficients are sums of differences to `origin`.
    pub fn through(polygon: Polygon, origin: &Vector<3>, x: impl Fn(usize, usize) -> Vector<3>) -> Self {
        let mut c = [Vector::zeros(); 9];
        let inside = |i: usize, j: usize| polygon == Polygon::Square || i + j <= 2;
        for (i, j) in (0..9).map(|k| (k % 3, k / 3)).filter(|&(i, j)| inside(i, j)) {
            c[3 * j + i] = x(i, j) - origin;
        }
        if polygon == Polygon::Triangle {
            // third differences vanish
            let (u, v) = (c[1] - c[0], c[3] - c[0]);
            let (uu, uv, vv) = (c[2] - c[1] - u, c[4] - c[3] - u, c[6] - c[3] - v);
            c[5] = c[2] + v + uv * 2.0;
            c[7] = c[6] + u + uv * 2.0;
            c[8] = c[0] + (u + v) * 2.0 + uu + vv + uv * 4.0;
        }
        for (first, step) in [(0, 1), (3, 1), (6, 1), (0, 3), (1, 3), (2, 3)] {
            let [low, middle, high] = [0, 1, 2].map(|k| c[first + k * step]);
            c[first] = middle;
            c[first + step] = high - low;
            c[first + 2 * step] = (high - middle + (low - middle)) * 2.0;
        }
        Self { origin: *origin, c }
    }

    /// Position and Jacobian.
    pub fn at(&self, p: &Vector<2>) -> (Vector<3>, Matrix<3, 2>) {
        let (a, b, c) = (p[0] - 0.5, p[1] - 0.5, &self.c);
        let row = |j: usize| c[3 * j] + (c[3 * j + 1] + c[3 * j + 2] * a) * a;
        let slope = |j: usize| c[3 * j + 1] + c[3 * j + 2] * (2.0 * a);
        let (middle, high) = (row(1), row(2));
        let x = self.origin + (row(0) + (middle + high * b) * b);
        let by_u = slope(0) + (slope(1) + slope(2) * b) * b;
        (x, Matrix::from_columns(&[by_u, middle + high * (2.0 * b)]))
    }

    /// Second derivatives of every component.
    pub fn hessian(&self, p: &Vector<2>) -> [Matrix<2, 2>; 3] {
        let (a, b, c) = (p[0] - 0.5, p[1] - 0.5, &self.c);
        let uu = (c[2] + (c[5] + c[8] * b) * b) * 2.0;
        let uv = c[4] + c[5] * (2.0 * a) + (c[7] + c[8] * (2.0 * a)) * (2.0 * b);
        let vv = (c[6] + (c[7] + c[8] * a) * a) * 2.0;
        std::array::from_fn(|k| Matrix::<2, 2>::new(uu[k], uv[k], uv[k], vv[k]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polynomials_are_their_values_with_all_derivatives_inside_and_outside() {
        for (polygon, mixed) in [(Polygon::Square, 0.7), (Polygon::Triangle, 0.0)] {
            // x, x_u, x_v, x_uu, x_uv, x_vv of polynomials that the cell has
            let of = |u: f64, v: f64| {
                let high = mixed * (u * u * v - 0.4 * u * v * v + 0.2 * u * u * v * v);
                Vector::<3>::new(1e3 + u - 0.3 * v * v, v + 0.2 * u * u - 0.1 * u * v, 0.3 - u * v + high)
            };
            let by_u =
                |u: f64, v: f64| Vector::<3>::new(1.0, 0.4 * u - 0.1 * v, -v + mixed * (2.0 * u * v - 0.4 * v * v + 0.4 * u * v * v));
            let by_v = |u: f64, v: f64| Vector::<3>::new(-0.6 * v, 1.0 - 0.1 * u, -u + mixed * (u * u - 0.8 * u * v + 0.4 * u * u * v));
            let second = |u: f64, v: f64| {
                let uu = [0.0, 0.4, mixed * (2.0 * v + 0.4 * v * v)];
                let uv = [0.0, -0.1, -1.0 + mixed * (2.0 * u - 0.8 * v + 0.8 * u * v)];
                let vv = [-0.6, 0.0, mixed * (-0.8 * u + 0.4 * u * u)];
                [0, 1, 2].map(|k| Matrix::<2, 2>::new(uu[k], uv[k], uv[k], vv[k]))
            };
            let center = polygon.center();
            let form = Biquadratic::through(polygon, &of(center[0], center[1]), |i, j| of(0.5 * i as f64, 0.5 * j as f64));
            for (u, v) in [(0.0, 0.0), (0.2, 0.7), (1.0, 0.0), (0.3, 0.3), (-0.8, 1.9), (1.7, 0.4)] {
                let p = Vector::<2>::new(u, v);
                let (x, j) = form.at(&p);
                assert!((x - of(u, v)).amax() < 2e-12, "{polygon:?} {u} {v}");
                assert!((j - Matrix::from_columns(&[by_u(u, v), by_v(u, v)])).amax() < 4e-12, "{polygon:?} {u} {v}");
                for (found, expected) in form.hessian(&p).iter().zip(second(u, v)) {
                    assert!((found - expected).amax() < 8e-12, "{polygon:?} {u} {v}");
                }
            }
        }
    }
}
