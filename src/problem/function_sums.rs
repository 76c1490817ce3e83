//! Integrals of multiplier functions.

use crate::linalg::Vector;

/// Sums of a multiplier function against one master.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FunctionSums<const N: usize> {
    /// ∫ ψ ds.
    pub(super) sum: f64,
    /// ∫ ψ (x - middle of the slave's patch) ds \[length\].
    pub(super) lever: Vector<N>,
    /// ∫ |ψ| ds.
    pub(super) size: f64,
}
