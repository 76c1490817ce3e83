//! Force-driven rigid obstacles, whose translation is an unknown of the system.
//!
//! ```text
//! gap_j = C_j u + g_j,   C_jd = -∫ ψ_j n . e ds   for the translation d along e
//! ```
//!
//! The row of d in K u + Cᵀ lambda = f is the equilibrium of the obstacle: ∫ lambda n . e ds = -F, where F is the force on it.

use super::ContactRows;
use crate::basis::Basis;
use crate::coupling::mortar::weighted_sums;
use crate::linalg::{Real, Vector};

impl<const S: usize, const N: usize, T: Real> ContactRows<S, N, T> {
    /// Lets the obstacle translate along `direction` by the value of `unknown`, whose present value is `at` \[length\].
    ///
    /// Normals and gaps stay those of the position `at`: exact for half-planes; for others build the contact again at the new
    /// position.
    ///
    /// # Panics
    /// If the rows have no such unknown.
    pub fn add_translation(&mut self, multiplier: &dyn Basis<S, T>, direction: &Vector<N, T>, unknown: usize, at: T) {
        assert!(unknown < self.rows.master.cols, "unknown {unknown} of {}", self.rows.master.cols);
        self.translations.push((*direction, unknown, at));
        let column = weighted_sums(multiplier, &self.segments, |q| -self.frames.normal[q].dot(direction));
        for (j, value) in column.into_iter().enumerate() {
            if self.facing[j] && value != T::zero() {
                self.rows.master.push(j, unknown, value);
                self.offset[j] -= value * at;
            }
        }
    }
}
