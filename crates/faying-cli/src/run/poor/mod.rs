//! Warnings about poor accuracy of a run without errors: from the model, and from the solution.
//!
//! | file | the number that is poor |
//! | --- | --- |
//! | `aspect` | digits, in cells that are thinner than 1e-8 of their length |
//! | `patch_test` | stresses, in coarse cells of rational maps that their Gauss points do not integrate |
//! | `facets` | gaps of sides that nearly fit, where facets leave their surface by as much |
//! | `flux_jumps` | errors against a piecewise exact solution whose flux jumps: its source is not that of the data |
//! | `left_open` | errors of lambda against a piecewise exact solution, where it is open which piece a side has |
//! | `loads` | loads, springs and moduli that jump inside of elements: the rule of integration misses a part |
//! | `rounding` | digits, where the condition number is large: moduli of high contrast |
//! | `zone` | forces and extents of zones that few functions of the slave carry |
//! | `moments` | moments that ties across a gap lose |
//! | `sinking` | places of bodies that a soft penalty lets sink into each other |
//! | `kinematics` | all, where bodies deform too far for small kinematics |
//! | `integration` | forces through an interface whose rule does not see the other side's functions |
//! | `sliding` | contact zones, where bodies slide so far that the normal at rest is no longer theirs |
//!
//! Motions that only soft springs hold are found with the other rigid motions, in [`weakly_held`].

mod aspect;
mod facets;
mod flux_jumps;
mod integration;
mod kinematics;
mod left_open;
mod loads;
mod moments;
mod patch_test;
mod rounding;
mod sinking;
mod sliding;
mod zone;

use crate::build::{Built, weakly_held};
use crate::case::Case;
use crate::errors::Diagnostic;
use crate::result::RunResult;
use faying::problem::{Model, StepState};

/// Returns the warnings about a model before it is solved.
pub fn of_model<const S: usize, const N: usize>(case: &Case, model: &Model<S, N>) -> Vec<Diagnostic> {
    let mut found = aspect::warnings(case, model);
    found.extend(patch_test::warnings(case, model));
    found.extend(facets::warnings(case, model));
    found.extend(weakly_held(case, model));
    found.extend(flux_jumps::warnings(case, model));
    found.extend(loads::warnings(case, model));
    found
}

/// Adds the warnings about a solution; each once over all steps.
pub fn of_state<const S: usize, const N: usize>(case: &Case, model: &Built<S, N>, state: &StepState<S, N>, result: &mut RunResult) {
    let mut found = integration::warnings(case, result);
    found.extend(left_open::warnings(case, model, result));
    found.extend(sliding::warnings(case, model, state));
    found.extend(rounding::warning(case, model, result));
    found.extend(zone::warnings(case, model, state));
    found.extend(moments::warnings(case, model, state));
    found.extend(sinking::warnings(case, model, result));
    found.extend(kinematics::warnings(case, model, state));
    for new in found {
        // the figures change from step to step, the source location and the subject do not
        let same = |old: &Diagnostic| old.code == new.code && old.line == new.line && old.help == new.help && subject(old) == subject(&new);
        if !result.warnings.iter().any(same) {
            result.warnings.push(new);
        }
    }
}

/// Returns the part of a message before its figures.
fn subject(d: &Diagnostic) -> &str {
    d.message.split(':').next().unwrap_or_default()
}
