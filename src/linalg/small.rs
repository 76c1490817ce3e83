//! Determinant, inverse and measure of matrices of one to three columns, written out for generic sizes.

use super::{Matrix, Real};

/// det A for D = 0..3, by cofactors.
///
/// # Panics
/// If D > 3.
#[inline]
pub fn determinant<const D: usize, T: Real>(a: &Matrix<D, D, T>) -> T {
    match D {
        0 => T::one(),
        1 => a[(0, 0)],
        2 => a[(0, 0)] * a[(1, 1)] - a[(0, 1)] * a[(1, 0)],
        3 => a[(0, 0)] * minor(a, [1, 2], [1, 2]) - a[(0, 1)] * minor(a, [1, 2], [0, 2]) + a[(0, 2)] * minor(a, [1, 2], [0, 1]),
        _ => panic!("determinants are written out up to three rows, not {D}"),
    }
}

/// A⁻¹ for D = 1..3, by cofactors; `None` if det A is zero or not finite.
///
/// # Panics
/// If D > 3.
#[inline]
pub fn inverse<const D: usize, T: Real>(a: &Matrix<D, D, T>) -> Option<Matrix<D, D, T>> {
    let det = determinant(a);
    if det == T::zero() || !det.is_finite() {
        return None;
    }
    let f = T::one() / det;
    let mut b = Matrix::<D, D, T>::zeros();
    match D {
        1 => b[(0, 0)] = f,
        2 => {
            b[(0, 0)] = a[(1, 1)] * f;
            b[(0, 1)] = -a[(0, 1)] * f;
            b[(1, 0)] = -a[(1, 0)] * f;
            b[(1, 1)] = a[(0, 0)] * f;
        }
        _ => {
            for i in 0..D {
                for j in 0..D {
                    // cyclic indices carry the sign of the cofactor
                    let (r, c) = ([(j + 1) % 3, (j + 2) % 3], [(i + 1) % 3, (i + 2) % 3]);
                    b[(i, j)] = minor(a, r, c) * f;
                }
            }
        }
    }
    Some(b)
}

/// Measure sqrt(det JᵀJ) >= 0 of a Jacobian J (N x D, D <= N): the scale of lengths, areas or volumes.
///
/// # Panics
/// If D > 3.
#[inline]
pub fn measure<const N: usize, const D: usize, T: Real>(j: &Matrix<N, D, T>) -> T {
    match (N, D) {
        (_, 1) => (0..N).fold(T::zero(), |s, k| s + j[(k, 0)] * j[(k, 0)]).sqrt(),
        (2, 2) => (j[(0, 0)] * j[(1, 1)] - j[(0, 1)] * j[(1, 0)]).abs(),
        (3, 2) => {
            // the length of the cross product keeps digits that det JᵀJ loses on slender cells
            let c = [minor(j, [1, 2], [0, 1]), minor(j, [2, 0], [0, 1]), minor(j, [0, 1], [0, 1])];
            (c[0] * c[0] + c[1] * c[1] + c[2] * c[2]).sqrt()
        }
        (3, 3) => {
            (j[(0, 0)] * minor(j, [1, 2], [1, 2]) - j[(0, 1)] * minor(j, [1, 2], [0, 2]) + j[(0, 2)] * minor(j, [1, 2], [0, 1])).abs()
        }
        _ => {
            let mut gram = Matrix::<D, D, T>::zeros();
            for a in 0..D {
                for b in 0..D {
                    gram[(a, b)] = (0..N).fold(T::zero(), |s, k| s + j[(k, a)] * j[(k, b)]);
                }
            }
            determinant(&gram).max(T::zero()).sqrt()
        }
    }
}

/// The 2 x 2 determinant of two rows and two columns.
#[inline]
fn minor<const R: usize, const C: usize, T: Real>(a: &Matrix<R, C, T>, r: [usize; 2], c: [usize; 2]) -> T {
    a[(r[0], c[0])] * a[(r[1], c[1])] - a[(r[0], c[1])] * a[(r[1], c[0])]
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn inverse_times_matrix_is_the_identity_in_one_to_three_rows() {
        fn check<const D: usize>(a: Matrix<D, D>, det: f64) {
            assert!((determinant(&a) - det).abs() < 1e-14);
            let product = inverse(&a).unwrap() * a;
            assert!((product - Matrix::<D, D>::identity()).amax() < 1e-14);
        }
        check(Matrix::<1, 1>::new(4.0), 4.0);
        check(Matrix::<2, 2>::new(1.0, 2.0, 3.0, 4.0), -2.0);
        check(Matrix::<3, 3>::new(2.0, 1.0, 0.5, 0.0, 3.0, 1.0, 1.0, -1.0, 2.0), 13.5);
        assert!(inverse(&Matrix::<2, 2>::new(1.0, 2.0, 2.0, 4.0)).is_none());
    }

    #[test]
    fn measure_is_the_root_of_the_gram_determinant_in_all_shapes() {
        assert!((measure(&Matrix::<2, 1>::new(3.0, -4.0)) - 5.0).abs() < 1e-15);
        assert!((measure(&Matrix::<2, 2>::new(1.0, 2.0, 3.0, 4.0)) - 2.0).abs() < 1e-15);
        // columns (1, 0, 1) and (0, 2, 0): cross product (-2, 0, 2)
        assert!((measure(&Matrix::<3, 2>::new(1.0, 0.0, 0.0, 2.0, 1.0, 0.0)) - 8f64.sqrt()).abs() < 1e-15);
        assert!((measure(&Matrix::<3, 3>::new(2.0, 1.0, 0.5, 0.0, 3.0, 1.0, 1.0, -1.0, 2.0)) - 13.5).abs() < 1e-13);
    }
}
