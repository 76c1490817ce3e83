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
mod traces;
mod values;
mod warned;

use super::registry::Names;
use crate::case::Case;
use crate::errors::Diagnostics;
use crate::reference::on_case;
use crate::shapes::MakeNet;
use bodies::supported;
pub(crate) use builder::Builder;
use faying::problem::{InterfaceSide, Warning};
use faying::space::Trace;

pub use built::Built;
pub(crate) use meshes::{body as mesh_body, counts as mesh_counts, unshared_text};
pub(crate) use patches::{elements_along, specification};
pub(crate) use sides::canonical as canonical_side;
pub use traces::{SlaveSpaces, slave_spaces};

/// Builds the model of `case` with the bodies, multipliers and couplings of `names`.
///
/// # Errors
/// Everything that is wrong with the case, with its places.
pub fn build<const S: usize, const N: usize>(case: &Case, names: &Names<S, N>, net: MakeNet<N>) -> Result<Built<S, N>, Diagnostics>
where
    Trace<S, N>: InterfaceSide<S, N>,
{
    let mut builder = Builder { case, names, faults: Diagnostics::new() };
    let (mut problem, mut places, couples) = supported(&mut builder, net)?;
    ties::say(&mut builder, &mut problem, &mut places, &couples);
    contacts::say(&mut builder, &mut problem, &mut places);
    faults::stop(&mut builder, &problem, &places)?;
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
