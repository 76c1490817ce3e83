//! Penalty: rows softened by the stiffness of their slave unknowns times a factor.
//!
//! ```text
//! C u + g = S lambda where closed,   S diagonal,   s_j = w_j² / (factor k_j)
//! ```

use super::{Begun, ContactMethod, MethodError, positive, softened};
use crate::contact::ContactRows;
use crate::coupling::Penalty;

impl<const S: usize, const N: usize> ContactMethod<S, N> for Penalty {
    fn check(&self) -> Result<(), MethodError> {
        positive(self.factor)
    }

    fn begin(&self, rows: &ContactRows<S, N>, unit: &dyn Fn(usize) -> f64) -> Begun {
        Begun { compliance: softened(rows, unit, self.factor), ..Begun::default() }
    }
}
