//! Tangents and normals of curves and surfaces.

use crate::linalg::{Matrix, Real, Vector};

/// The cross product of the tangents (the columns of the Jacobian); its length is the surface measure.
///
/// Curves in the plane: the tangent turned clockwise, (t_y, -t_x). Surfaces: t_1 x t_2. (S, N) stands for (N - 1, N).
///
/// # Panics
/// If N is not 2 or 3.
#[inline]
pub fn cross<const S: usize, const N: usize, T: Real>(jacobian: &Matrix<N, S, T>) -> Vector<N, T> {
    const { assert!(S + 1 == N, "a normal needs one tangent less than dimensions") };
    let j = jacobian;
    let mut normal = Vector::zeros();
    match N {
        2 => {
            normal[0] = j[(1, 0)];
            normal[1] = -j[(0, 0)];
        }
        3 => {
            for k in 0..3 {
                let (a, b) = ((k + 1) % 3, (k + 2) % 3);
                normal[k] = j[(a, 0)] * j[(b, 1)] - j[(b, 0)] * j[(a, 1)];
            }
        }
        _ => panic!("normals are known in 2 and 3 dimensions, not {N}"),
    }
    normal
}

/// The unit normal `outward * cross / |cross|`, zero where the tangents are dependent.
///
/// With the `outward` sign of a trace it points out of the body.
#[inline]
pub fn unit_normal<const S: usize, const N: usize, T: Real>(jacobian: &Matrix<N, S, T>, outward: T) -> Vector<N, T> {
    let normal = cross(jacobian);
    let length = normal.norm();
    if length > T::zero() { normal * (outward / length) } else { Vector::zeros() }
}

/// The unit tangent of a curve, zero where the derivative vanishes.
#[inline]
pub fn unit_tangent<const N: usize, T: Real>(jacobian: &Matrix<N, 1, T>) -> Vector<N, T> {
    let t: Vector<N, T> = jacobian.column(0).into_owned();
    let length = t.norm();
    if length > T::zero() { t / length } else { t }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn normals_are_the_tangent_turned_clockwise_and_the_cross_product() {
        let along_x = Matrix::<2, 1>::new(2.0, 0.0);
        assert_eq!(cross(&along_x), Vector::<2>::new(0.0, -2.0));
        assert_eq!(unit_normal(&along_x, -1.0), Vector::<2>::new(0.0, 1.0));
        let plane = Matrix::<3, 2>::new(2.0, 0.0, 0.0, 3.0, 0.0, 0.0);
        assert_eq!(cross(&plane), Vector::<3>::new(0.0, 0.0, 6.0));
        assert_eq!(unit_normal(&Matrix::<3, 2>::zeros(), 1.0), Vector::<3>::zeros());
        assert_eq!(unit_tangent(&along_x), Vector::<2>::new(1.0, 0.0));
    }
}
