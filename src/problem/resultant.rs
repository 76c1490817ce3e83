//! Forces with their moments.

use crate::assembly::Moments;
use crate::linalg::Vector;

/// A force and its moment about the origin.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Resultant {
    /// Sum of the forces.
    pub force: [f64; 3],
    /// Sum of the moments.
    pub moment: [f64; 3],
}

impl Resultant {
    /// Resultant of a force field with these moments; components that the field or space lacks are zero.
    pub(super) fn of<const C: usize, const N: usize>(moments: &Moments<C, N>) -> Self {
        // ∫ x_i f_j dx
        let first = |i: usize, j: usize| if i < N && j < C.min(N) { moments.first[(j, i)] } else { 0.0 };
        Self {
            force: std::array::from_fn(|k| if k < C { moments.total[k] } else { 0.0 }),
            moment: std::array::from_fn(|k| {
                let (i, j) = ((k + 1) % 3, (k + 2) % 3);
                first(i, j) - first(j, i)
            }),
        }
    }

    /// Adds a force times `weight` at `x`.
    pub(super) fn add<const N: usize>(&mut self, x: &Vector<N>, force: &[f64], weight: f64) {
        let moment = cross(x, force);
        for k in 0..3 {
            self.force[k] += weight * force.get(k).copied().unwrap_or(0.0);
            self.moment[k] += weight * moment[k];
        }
    }

    /// Adds another resultant.
    pub fn sum(&mut self, other: &Self) {
        for k in 0..3 {
            self.force[k] += other.force[k];
            self.moment[k] += other.moment[k];
        }
    }
}

/// x cross f: (0, 0, m) in the plane.
pub(super) fn cross<const N: usize>(x: &Vector<N>, f: &[f64]) -> [f64; 3] {
    let at = |v: &[f64], k: usize| v.get(k).copied().filter(|_| k < N).unwrap_or(0.0);
    let x = x.as_slice();
    std::array::from_fn(|k| {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        at(x, i) * at(f, j) - at(x, j) * at(f, i)
    })
}
