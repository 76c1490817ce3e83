//! Penalty coupling: the rows of mortar, softened by a compliance.
//!
//! ```text
//! C u = S lambda,   S diagonal,   s_i = w_i² / (factor k_i)
//! ```
//!
//! w_i = sum_j |C_ij| is the weight of row i, k_i the mean stiffness of its slave unknowns
//! ([`constraint::penalty`](crate::constraint::penalty)). With elements of size h and a modulus E the jump is about
//! h lambda / (factor E): the penalty is factor * E / h and `factor` is free of units. The error falls like 1 / factor down to that
//! of the mortar coupling, and lambda is a multiplier like any other; the system keeps its form and its condition, however large
//! the factor is.
//!
//! Source: Babuška, Math. Comp. 27 (1973) 221-228.

use super::{Coupling, CouplingBlocks, CouplingError, Interface, Mortar};
use crate::linalg::{Real, lit};

/// Mortar rows with a diagonal compliance: C u = S lambda.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Penalty {
    /// Stiffness of the penalty against that of the slave's elements, a pure number.
    pub factor: f64,
}

impl Penalty {
    /// The factor of `factor = "auto"`: jumps of a billionth of an element's own displacement under the same traction.
    pub const AUTO: f64 = 1e9;
}

impl Default for Penalty {
    fn default() -> Self {
        Self { factor: Self::AUTO }
    }
}

impl<const S: usize, const N: usize, T: Real> Coupling<S, N, T> for Penalty {
    fn rows_are_mortar(&self) -> bool {
        true
    }
    fn assemble(&self, interface: &Interface<'_, S, N, T>, unknowns: usize) -> Result<CouplingBlocks<T>, CouplingError> {
        if !(self.factor > 0.0 && self.factor.is_finite()) {
            return Err(CouplingError::Missing(format!("the factor of a penalty must be positive, found {}", self.factor)));
        }
        Ok(CouplingBlocks { penalty: Some(lit(self.factor)), ..Mortar.assemble(interface, unknowns)? })
    }
}
