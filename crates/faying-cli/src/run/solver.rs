//! The constraint solver that a case names.

use crate::case;
use crate::registry::{Fault, Registry, SolverOptions, solver_name};
use crate::run_control::RunControl;
use faying::constraint::ConstraintSolver;
use faying::linalg::Limits;

/// The solver that `wanted` names, stopped by `watch`.
///
/// # Errors
/// [`Fault`] if the registry has none of this name, or the name and the other keys do not go together.
pub fn solver(registry: &Registry, wanted: &case::Solver, watch: &RunControl) -> Result<Box<dyn ConstraintSolver>, Fault> {
    let make = registry.solvers.get(solver_name(&wanted.constraint.value)).map_err(|e| Fault::new("E015", e.to_string()))?;
    let limits =
        Limits { tolerance: wanted.tolerance.value, max_iterations: wanted.max_iterations.map_or(0, |m| m.value), stop: watch.stop_sign() };
    make(&SolverOptions { linear: wanted.linear.value, limits })
}
