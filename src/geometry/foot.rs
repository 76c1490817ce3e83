//! Steps to the foot of a point on a continued surface.

use crate::linalg::{Matrix, Vector, inverse};

/// Share of JᵀJ below which the second derivatives are left out: beyond the centre of curvature.
const LEAST_SLOPE: f64 = 0.1;

/// A Newton step of |x - x_m|² / 2, at most 0.5, and whether it has second derivatives: those that leave it convex.
pub(crate) fn foot_step(r: &Vector<3>, j: &Matrix<3, 2>, hessian: Option<&[Matrix<2, 2>; 3]>) -> (Vector<2>, bool) {
    let gauss = j.tr_mul(j);
    let mut full = gauss;
    if let Some(hessian) = hessian {
        for c in 0..3 {
            full -= hessian[c] * r[c];
        }
    }
    let rest = full - gauss * LEAST_SLOPE;
    let convex = rest[(0, 0)] > 0.0 && rest[(0, 0)] * rest[(1, 1)] > rest[(0, 1)] * rest[(1, 0)];
    let step = inverse(if convex { &full } else { &gauss }).map_or_else(Vector::zeros, |inv| inv * j.tr_mul(r));
    let length = step.amax();
    (if length > 0.5 { step * (0.5 / length) } else { step }, convex && hessian.is_some())
}
