//! Derivatives in the coordinates of a triangle with a pole, p = u (1 - v), q = v, from those in (u, v).

use crate::linalg::{Matrix, Vector};

/// Points this near to a pole take derivatives from here, in the coordinate towards it.
pub(super) const BESIDE_POLE: f64 = 1e-6;

/// The point of a triangle with a pole, moved along its line away from the pole if it is too near.
pub(super) fn beside(p: &Vector<2>) -> Vector<2> {
    let left = 1.0 - p[1];
    if left >= BESIDE_POLE {
        return *p;
    }
    let u = if left.abs() > 1e-300 { (p[0] / left).clamp(0.0, 1.0) } else { 0.5 };
    Vector::<2>::new(u * BESIDE_POLE, 1.0 - BESIDE_POLE)
}

/// The Jacobian in (p, q) from that in (u, v).
pub(super) fn from_pole(p: &Vector<2>, j: &Matrix<3, 2>) -> Matrix<3, 2> {
    let left = 1.0 - p[1];
    let (u, by_u, by_v) = (p[0] / left, j.column(0).into_owned(), j.column(1).into_owned());
    Matrix::from_columns(&[by_u / left, by_v + by_u * (u / left)])
}

/// The second derivatives of a coordinate in (p, q) from its first and second ones in (u, v).
pub(super) fn from_pole_second(p: &Vector<2>, first: [f64; 2], h: &Matrix<2, 2>) -> Matrix<2, 2> {
    let left = 1.0 - p[1];
    let u = p[0] / left;
    let u_q = u / left;
    let pp = h[(0, 0)] / (left * left);
    let pq = (h[(0, 0)] * u_q + h[(0, 1)]) / left + first[0] / (left * left);
    let qq = h[(1, 1)] + 2.0 * h[(0, 1)] * u_q + h[(0, 0)] * u_q * u_q + first[0] * 2.0 * u / (left * left);
    Matrix::<2, 2>::new(pp, pq, pq, qq)
}
