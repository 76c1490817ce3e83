//! Diagnostics of the warnings about a run without errors: from the model, and from the solution.

mod loads;
mod of_model;
mod of_state;

use crate::case::Case;
use crate::errors::Diagnostic;
use crate::lower::LoweredCase;
use crate::result::RunResult;
use faying::problem::{Solution, Subject, Warning};

/// Returns the warnings about a model before it is solved.
pub fn of_model<const S: usize, const N: usize>(case: &Case, model: &LoweredCase<S, N>) -> Vec<Diagnostic> {
    model.system.accuracy_warnings().iter().filter_map(|w| of_model::diagnostic(case, model, w)).collect()
}

/// Adds the warnings about a solution, each once over all steps: those that were `told` are not repeated with other figures. Of a state that
/// is none, because its step failed, zones are not judged.
pub fn of_solution<const S: usize, const N: usize>(
    case: &Case,
    (solution, failed): (&Solution<S, N>, bool),
    told: &mut Vec<Warning>,
    result: &mut RunResult,
) {
    let found = solution.warnings();
    let open = found.iter().filter(|w| matches!(w, Warning::LeftOpen { .. })).filter_map(Warning::subject);
    let open: Vec<String> = open.map(|of| of_state::left_open(&of.name)).collect();
    result.errors_reason = (!open.is_empty()).then(|| open.join("; "));
    // sides that come apart by a poor integration are not told to be coarse
    let inexact = |of: Option<&Subject>| found.iter().any(|w| matches!(w, Warning::Integration { .. }) && w.subject() == of);
    let is_void = |w: &Warning| match w {
        Warning::CoarseTie { .. } => inexact(w.subject()),
        Warning::CoarseZone { .. } => failed,
        _ => false,
    };
    for new in found.iter().filter(|w| !is_void(w)) {
        if !told.iter().any(|old| old.repeats(new)) {
            result.warnings.extend(of_state::diagnostic(case, new));
            told.push(new.clone());
        }
    }
}
