//! Construction of a model from a case: bodies, supports, loads, interfaces, contacts; errors of the input are found before solving.

mod bodies;
mod boundary;
mod builder;
mod built;
mod contacts;
mod couples;
mod faults;
mod findings;
mod glue;
mod materials;
mod meetings;
mod meshes;
mod multipliers;
mod obstacles;
mod patches;
mod places;
mod refused;
mod sides;
mod supports;
mod ties;
mod warned;

use super::registry::Names;
use crate::case::Case;
use crate::errors::{Diagnostic, Diagnostics};
use crate::reference::on_case;
use crate::shapes::MakeNet;
use bodies::supported;
pub(crate) use builder::Builder;
use couples::Couples;
use faying::problem::{InterfaceSide, Problem, ProblemErrors, Warning};
use faying::space::Trace;

pub use built::Built;
pub(crate) use meshes::{body as mesh_body, counts as mesh_counts, unshared_text};
pub(crate) use patches::specification;
pub(crate) use places::Places;

/// A case as a problem that is not assembled yet, with what its statements stand for in the case.
pub(crate) struct Stated<'a, const S: usize, const N: usize> {
    /// The case, the registered names, and the warnings so far.
    pub builder: Builder<'a, S, N>,
    /// The problem.
    pub problem: Problem<S, N>,
    /// Source locations of its statements.
    pub places: Places,
    /// Sides that are glued or tied.
    couples: Couples<S, N>,
}

impl<const S: usize, const N: usize> Stated<'_, S, N> {
    /// One diagnostic per error of the problem.
    pub fn refused(&self, errors: &ProblemErrors) -> Vec<Diagnostic> {
        faults::refused(&self.builder, &self.problem, &self.places, errors)
    }
}

/// Says everything in `case` to a problem.
///
/// # Errors
/// Everything that is wrong with bodies, sides, loads and data, with its places.
pub(crate) fn stated<'a, const S: usize, const N: usize>(
    case: &'a Case,
    names: &'a Names<S, N>,
    net: MakeNet<N>,
) -> Result<Stated<'a, S, N>, Diagnostics>
where
    Trace<S, N>: InterfaceSide<S, N>,
{
    let mut builder = Builder { case, names, faults: Diagnostics::new() };
    let (mut problem, mut places, couples) = supported(&mut builder, net)?;
    ties::say(&mut builder, &mut problem, &mut places, &couples);
    contacts::say(&mut builder, &mut problem, &mut places);
    faults::stop(&mut builder, &problem, &places)?;
    Ok(Stated { builder, problem, places, couples })
}

/// Builds the model of `case` with the bodies, multipliers and couplings of `names`.
///
/// # Errors
/// Everything that is wrong with the case, with its places.
pub fn build<const S: usize, const N: usize>(case: &Case, names: &Names<S, N>, net: MakeNet<N>) -> Result<Built<S, N>, Diagnostics>
where
    Trace<S, N>: InterfaceSide<S, N>,
{
    let Stated { mut builder, problem, places, couples } = stated(case, names, net)?;
    let system = problem.assemble_movable().map_err(|errors| faults::all(&mut builder, &problem, &places, &errors))?;
    let mut built = Built { system, glued_sides: couples.glued_sides(case), reference: None, places, warnings: Diagnostics::new() };
    let (found, contents) = (built.system.statement_warnings(), built.system.contents());
    multipliers::check(&mut builder, &contents);
    warned::tell(&mut builder, &built.places, found.iter().filter(|w| matches!(w, Warning::CornerValues { .. })));
    contacts::check(&mut builder, &problem, &built, &found);
    builder.stop()?;
    supports::check(&mut builder, &built, &found);
    builder.stop()?;
    built.reference = on_case::build(&builder, &contents, net).map_err(|fault| Diagnostics::from(*fault))?;
    built.warnings.extend(std::mem::take(&mut builder.faults));
    Ok(built)
}
