//! Lagrange multipliers: rows that hold exactly, lambda the sum of the multiplier's functions.

use super::ContactMethod;

/// Lagrange multipliers: C u + g >= 0, lambda <= 0, one of them zero in every row.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Lagrange;

impl<const S: usize, const N: usize> ContactMethod<S, N> for Lagrange {}
