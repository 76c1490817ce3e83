//! Rules on the unit simplex: products of Gauss-Jacobi rules, collapsed.

use super::Rule;
use super::gauss::gauss_jacobi;
use crate::linalg::{Real, Vector};

/// A rule on the unit simplex of dimension `D`, exact for polynomials of total degree `degree`.
///
///   xi_1 = u_1,  xi_2 = u_2 (1 - u_1),  xi_3 = u_3 (1 - u_1) (1 - u_2)
///
/// The powers of (1 - u_k) in the measure are the weights of Gauss-Jacobi rules, so (degree / 2 + 1)^D points are
/// enough; all lie inside and all weights are positive. They sum to 1 / D!.
///
/// Source: Karniadakis, Sherwin, Spectral/hp Element Methods for CFD (2005), section 4.1.1.
pub fn simplex_rule<const D: usize, T: Real>(degree: usize) -> Rule<D, T> {
    let n = degree / 2 + 1;
    let lines: Vec<Rule<1, T>> = (0..D).map(|k| gauss_jacobi(n, D - 1 - k)).collect();
    let count = n.pow(D as u32);
    let mut rule = Rule { points: Vec::with_capacity(count), weights: Vec::with_capacity(count) };
    for q in 0..count {
        let (mut rest, mut scale, mut weight) = (q, T::one(), T::one());
        let mut point = Vector::<D, T>::zeros();
        for (k, line) in lines.iter().enumerate() {
            let i = rest % n;
            rest /= n;
            let u = line.points[i][0];
            point[k] = u * scale;
            scale *= T::one() - u;
            weight *= line.weights[i];
        }
        rule.points.push(point);
        rule.weights.push(weight);
    }
    rule
}
