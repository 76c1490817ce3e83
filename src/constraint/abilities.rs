//! Abilities of constraint solvers, said before they are asked to solve.

/// Abilities of a constraint solver, beyond symmetric systems whose rows are independent equalities.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Abilities {
    /// Contact rows are decided; without this ability they are refused with [`SolveError::ContactRow`](super::SolveError::ContactRow), and
    /// an [`ActiveSet`](super::ActiveSet) around the solver decides them.
    pub contact: bool,
    /// Systems are solved whose reaction is not the transposed constraint or whose stiffness is not symmetric; without this ability they
    /// are refused with [`SolveError::NotSymmetric`](super::SolveError::NotSymmetric) or its counterpart of linear algebra.
    pub unsymmetric: bool,
    /// Systems with more soft rows than slave unknowns are solved; without this ability they are refused with
    /// [`SolveError::OverConstrained`](super::SolveError::OverConstrained).
    pub more_rows_than_unknowns: bool,
}
