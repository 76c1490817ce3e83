//! Solution of the system of a problem at a time.

use super::enforced::Enforced;
use super::equilibrium::Unheld;
use super::linearised::StepSystem;
use super::matrices::Matrices;
use super::model::Model;
use super::observer::{Observer, Progress};
use super::solver::ProblemSolver;
use super::state::{StepError, StepState, Unsolved};
use crate::constraint::{ConstrainedSolution, ConstraintSolver, SolveError, verified};
use crate::linalg::LinearError;

/// Solves the system with obstacles displaced by their entries of `place`, the active set started as it ended in `before`.
pub(super) fn once<const S: usize, const N: usize>(
    model: &Model<S, N>,
    matrices: &Matrices,
    solver: &mut ProblemSolver,
    t: f64,
    before: Option<&StepState<S, N>>,
    place: Option<&[f64]>,
    observer: Observer<'_>,
) -> Result<StepState<S, N>, Unsolved<Box<StepState<S, N>>>> {
    matrices.with_blocks(model, |blocks| {
        let mut system = StepSystem::of(model, blocks, t, before, place)?;
        if observer(&Progress::System).is_break() {
            return Err(SolveError::Stopped { iterations: 0, best: None }.into());
        }
        let factors = solver.set.inner.factors();
        let missing = if system.has_contact() { system.unheld_load(model) } else { None };
        // backtracking does not help if no pressure balances the loads
        let solved = solved(&mut system, model, solver, before.is_some(), missing.is_none(), observer);
        let factors = solver.set.inner.factors() - factors;
        let finish = |solution: ConstrainedSolution| {
            if let Some(report) = &solution.active_set {
                // a request to stop finds the system solved
                let _ = observer(&Progress::ActiveSet(report));
            }
            StepState { factors, ..system.finished(model, blocks, solution) }
        };
        solved.map(&finish).map_err(|error| {
            let usable = |l: &ConstrainedSolution| l.unknowns.len() == system.reduced.num_free() && l.multipliers.len() == model.rows;
            let last = last_iterate(&error).filter(|l| usable(l)).map(|l| Box::new(finish(*l)));
            Unsolved { error: explained(error, missing), best: last }
        })
    })?
}

/// Returns the error of a step whose system ended with `error`: where no pressure balances the loads, that is why.
fn explained(error: SolveError, missing: Option<Unheld>) -> StepError {
    match (missing, StepError::from(error)) {
        (Some(Unheld { what, coarse }), StepError::Solve(e)) if !matches!(e, SolveError::Stopped { .. }) => {
            if coarse {
                StepError::Coarse { what }
            } else {
                StepError::Infeasible { what }
            }
        }
        (_, error) => error,
    }
}

/// Solves the system and checks the answer; `near` and `retreat` as of the [active set](crate::constraint::ActiveSet). The iterations of
/// methods begin once: the system has none afterwards.
fn solved<const S: usize, const N: usize>(
    system: &mut StepSystem<S, N>,
    model: &Model<S, N>,
    solver: &mut ProblemSolver,
    near: bool,
    retreat: bool,
    observer: Observer<'_>,
) -> Result<ConstrainedSolution, SolveError> {
    if system.reduced.num_free() + model.rows == 0 {
        return Ok(ConstrainedSolution { method: "nothing to solve".into(), ..ConstrainedSolution::default() });
    }
    let by_set = system.has_contact() && !(solver.abilities().contact && system.enforced.iterations.is_empty());
    // rows that an iteration makes exact are closed up to its tolerance
    let tolerance = system.enforced.iterations.iter().fold(solver.set.inner.tolerance(), |most, (_, i)| most.max(i.tolerance()));
    let (iterations, eased) = (std::mem::take(&mut system.enforced.iterations), std::mem::take(&mut system.enforced.eased));
    let rows = system.constrained();
    let solution = if by_set {
        let set = &mut solver.set;
        set.start.clone_from(&system.interface.start);
        set.near = near;
        set.elements.clone_from(&system.interface.elements);
        set.max_iterations = model.max_iterations;
        set.c = model.c;
        set.retreat = retreat;
        Enforced::solve(iterations, eased, set, &rows, observer)?
    } else {
        solver.set.inner.solve(&rows).map_err(as_stopped)?
    };
    verified(&rows, solution, tolerance)
}

/// Turns the error of linear algebra that was cancelled into that of a cancelled step.
fn as_stopped(error: SolveError) -> SolveError {
    match error {
        SolveError::Linear(LinearError::Stopped { .. }) => SolveError::Stopped { iterations: 0, best: None },
        other => other,
    }
}

/// Best or last iterate of an algorithm that ended with `error`, if it has one.
fn last_iterate(error: &SolveError) -> Option<Box<ConstrainedSolution>> {
    match error {
        SolveError::Cycling { best: last, .. }
        | SolveError::TooManyIterations { best: last, .. }
        | SolveError::Multipliers { last, .. } => Some(last.clone()),
        SolveError::RigidMotion { best, .. } | SolveError::Stopped { best, .. } => best.clone(),
        _ => None,
    }
}
