//! `[solver]`: solvers and their tolerances.

use crate::place::Located;

/// Solver of linear systems.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Linear {
    /// The program chooses.
    Auto,
    /// Factorisation.
    Direct,
    /// Krylov.
    Iterative,
}

/// `[solver]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Solver {
    /// Name of the constraint solver: `auto`, `saddle-point`, `condensed`, `schur`, `uzawa`, or one of a registry.
    pub constraint: Located<String>,
    /// Linear solver.
    pub linear: Located<Linear>,
    /// Error and residual at which iterations end, relative.
    pub tolerance: Located<f64>,
    /// Most iterations of an iterative solver, `None`: auto.
    pub max_iterations: Option<Located<usize>>,
}
