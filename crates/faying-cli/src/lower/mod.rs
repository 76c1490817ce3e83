//! Construction of a model from a case: bodies, supports, loads, interfaces, contacts; errors of the input are found before solving.

mod bodies;
mod boundary;
mod contacts;
mod faults;
mod findings;
mod glue;
mod left_out;
mod lower_context;
mod lowered_case;
mod materials;
mod meetings;
mod meshes;
mod multipliers;
mod obstacles;
mod parts;
mod patches;
mod places;
mod refused;
mod side_pairs;
mod sides;
mod supports;
mod ties;
mod warned;

use super::registry::Names;
use crate::case::Case;
use crate::errors::{Diagnostic, Diagnostics};
use crate::reference::on_case;
use crate::shapes::MakeControlNet;
use bodies::supported;
use faying::problem::{InterfaceSide, Problem, ProblemErrors, Warning};
use faying::space::Trace;
pub(crate) use lower_context::LowerContext;
use side_pairs::SidePairs;

pub use lowered_case::LoweredCase;
pub(crate) use meshes::{body as mesh_body, counts as mesh_counts, unshared_text};
pub(crate) use patches::specification;
pub(crate) use places::Places;
pub(crate) use sides::names as side_names;

/// A case as a problem that is not assembled yet, with what its statements stand for in the case.
pub(crate) struct Stated<'a, const S: usize, const N: usize> {
    /// The case, the registered names, and the warnings so far.
    pub context: LowerContext<'a, S, N>,
    /// The problem.
    pub problem: Problem<S, N>,
    /// Source locations of its statements.
    pub places: Places,
    /// Sides that are glued or tied.
    couples: SidePairs<S, N>,
}

impl<const S: usize, const N: usize> Stated<'_, S, N> {
    /// One diagnostic per error of the problem.
    pub fn refused(&self, errors: &ProblemErrors) -> Vec<Diagnostic> {
        faults::refused(&self.context, &self.problem, &self.places, errors)
    }
}

/// Says everything in `case` to a problem.
///
/// # Errors
/// Everything that is wrong with bodies, sides, loads and data, with its places.
pub(crate) fn stated<'a, const S: usize, const N: usize>(
    case: &'a Case,
    names: &'a Names<S, N>,
    net: MakeControlNet<N>,
) -> Result<Stated<'a, S, N>, Diagnostics>
where
    Trace<S, N>: InterfaceSide<S, N>,
{
    let mut context = LowerContext { case, names, faults: Diagnostics::new() };
    let (mut problem, mut places, couples) = supported(&mut context, net)?;
    ties::say(&mut context, &mut problem, &mut places, &couples);
    contacts::say(&mut context, &mut problem, &mut places);
    faults::stop(&mut context, &problem, &places)?;
    Ok(Stated { context, problem, places, couples })
}

/// Builds the model of `case` with the bodies, multipliers and couplings of `names`.
///
/// # Errors
/// Everything that is wrong with the case, with its places.
pub fn build<const S: usize, const N: usize>(
    case: &Case,
    names: &Names<S, N>,
    net: MakeControlNet<N>,
) -> Result<LoweredCase<S, N>, Diagnostics>
where
    Trace<S, N>: InterfaceSide<S, N>,
{
    let Stated { mut context, problem, places, couples } = stated(case, names, net)?;
    let system = problem.assemble_movable().map_err(|errors| faults::all(&mut context, &problem, &places, &errors))?;
    let (glued_sides, free_measures) = (couples.glued_sides(case), couples.free_measures(&system.contents()));
    let mut built = LoweredCase { system, glued_sides, free_measures, reference: None, places, warnings: Diagnostics::new() };
    let (found, contents) = (built.system.statement_warnings(), built.system.contents());
    multipliers::check(&mut context, &contents);
    left_out::tell_uncovered(&mut context, &contents, &couples.named);
    warned::tell(&mut context, &built.places, found.iter().filter(|w| matches!(w, Warning::CornerValues { .. })));
    contacts::check(&mut context, &problem, &built, &found);
    context.stop()?;
    supports::check(&mut context, &built, &found);
    context.stop()?;
    built.reference = on_case::build(&context, &contents, net).map_err(|fault| Diagnostics::from(*fault))?;
    built.warnings.extend(std::mem::take(&mut context.faults));
    Ok(built)
}
