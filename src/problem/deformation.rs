//! Sizes of strains and rotations, for small kinematics to hold.

use super::model::BodyModel;
use crate::basis::{Cell, Order, ShapeTable};
use crate::geometry::MapTable;
use crate::linalg::{Matrix, determinant, inverse};
use crate::parallel;
use crate::quadrature::{Quadrature, Rule, TensorRule, simplex_rule};
use nalgebra::DMatrix;

/// Elements handed to one task at a time.
const ELEMENTS_PER_TASK: usize = 64;

/// A number that is compared with a bound over a body.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Beyond {
    /// Its largest value.
    pub largest: f64,
    /// Share of the body's volume in which it is beyond the bound.
    pub share: f64,
}

/// Strains and rotations of a body.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Deformation {
    /// The largest principal strain of (grad u + grad uᵀ) / 2, by its absolute value.
    pub strain: Beyond,
    /// The angle of (grad u - grad uᵀ) / 2 \[radians\].
    pub rotation: Beyond,
}

impl<const S: usize, const N: usize> BodyModel<S, N> {
    /// The strains and rotations of a displacement at two Gauss points per direction, against `bound`; `u` holds the unknowns of all bodies.
    pub fn deformation(&self, u: &[f64], bound: f64) -> Deformation {
        let space = &**self.body.space();
        let rules: [Rule<N>; 2] = [TensorRule::<N>::gauss([2; N]).rule(0).clone(), simplex_rule::<N, f64>(2)];
        let elements: Vec<usize> = (0..space.num_elements()).collect();
        // largest strain and rotation, and the volumes beyond the bound and in all
        let of = |chunk: &[usize]| {
            let (mut ids, mut shapes, mut map) = (Vec::new(), ShapeTable::new(), MapTable::new());
            let mut sums = [0.0; 5];
            for &e in chunk {
                let rule = &rules[usize::from(space.cell(e) == Cell::Simplex)];
                space.active(e, &mut ids);
                space.evaluate(e, &rule.points, Order::Gradients, &mut shapes, &mut map);
                for (q, w) in rule.weights.iter().enumerate() {
                    // no derivative in space where the map is degenerate
                    let Some(back) = inverse(&map.jacobian[q]) else { continue };
                    let (mut gradient, mut outward) = (Matrix::<N, N>::zeros(), 0.0);
                    for ((&i, slope), value) in ids.iter().zip(shapes.grads(q)).zip(shapes.values(q)) {
                        outward += value * u[self.field.unknown(i, 0)];
                        let slope = back.transpose() * slope;
                        for c in 0..N {
                            for k in 0..N {
                                gradient[(c, k)] += u[self.field.unknown(i, c)] * slope[k];
                            }
                        }
                    }
                    let volume = w * determinant(&map.jacobian[q]).abs();
                    // of bodies of revolution the strain around the axis is another principal one
                    let around = if self.is_revolved() { (outward / map.x[q][0]).abs() } else { 0.0 };
                    let sizes = [strain(&gradient, bound).max(around), rotation(&gradient)];
                    for (k, size) in sizes.into_iter().enumerate() {
                        sums[k] = f64::max(sums[k], size);
                        sums[2 + k] += if size > bound { volume } else { 0.0 };
                    }
                    sums[4] += volume;
                }
            }
            sums
        };
        let parts: Vec<[f64; 5]> = parallel::map_ranges(elements.len(), ELEMENTS_PER_TASK, |range| of(&elements[range]));
        let mut all = [0.0; 5];
        for part in parts {
            (0..2).for_each(|k| all[k] = f64::max(all[k], part[k]));
            (2..5).for_each(|k| all[k] += part[k]);
        }
        let beyond = |k: usize| Beyond { largest: all[k], share: if all[4] > 0.0 { all[2 + k] / all[4] } else { 0.0 } };
        Deformation { strain: beyond(0), rotation: beyond(1) }
    }
}

/// The largest absolute eigenvalue of the symmetric part, exact where it is beyond `bound`, else at most its Frobenius norm.
fn strain<const N: usize>(gradient: &Matrix<N, N>, bound: f64) -> f64 {
    let symmetric = (gradient + gradient.transpose()) * 0.5;
    let norm = symmetric.norm();
    if norm <= bound {
        return norm / (N as f64).sqrt();
    }
    let eigen = DMatrix::from_fn(N, N, |i, j| symmetric[(i, j)]).symmetric_eigenvalues();
    eigen.iter().fold(0.0, |m: f64, v| m.max(v.abs()))
}

/// The length of the axial vector of the skew part.
fn rotation<const N: usize>(gradient: &Matrix<N, N>) -> f64 {
    ((gradient - gradient.transpose()) * 0.5).norm() / 2f64.sqrt()
}
