//! Bodies with their gluing, boundary conditions and loads, without ties and contacts.

use super::lower_context::LowerContext;
use super::places::Places;
use super::side_pairs::SidePairs;
use super::{boundary, glue, meshes, patches, side_pairs};
use crate::errors::Diagnostics;
use crate::shapes::MakeControlNet;
use faying::physics::Assumption;
use faying::problem::{InterfaceSide, Problem};
use faying::space::Trace;

/// A problem without ties and contacts, the places of its statements, and which sides are coupled.
pub(super) type Supported<const S: usize, const N: usize> = (Problem<S, N>, Places, SidePairs<S, N>);

/// Says bodies, gluing, boundary conditions and loads.
pub(super) fn supported<const S: usize, const N: usize>(
    context: &mut LowerContext<'_, S, N>,
    net: MakeControlNet<N>,
) -> Result<Supported<S, N>, Diagnostics>
where
    Trace<S, N>: InterfaceSide<S, N>,
{
    let case = context.case;
    let problem = if case.model.assumption.value == Assumption::Axisymmetric { Problem::axisymmetric() } else { Problem::new() };
    let (mut problem, mut places) = (problem, Places::default());
    problem.times(case.times(true));
    let most = case.contacts.iter().map(|c| c.active_set.max_iterations.value).max().unwrap_or(1);
    problem.active_set(case.contacts.first().map_or(1.0, |c| c.active_set.c.value), most);
    if let Some(exact) = &case.model.exact {
        problem.exact(crate::formula::exact(&exact.value));
    }
    patches::say(context, net, &mut problem, &mut places);
    context.stop()?;
    for (patch, body) in case.patches.iter().zip(&places.bodies) {
        if let Some(exact) = &patch.exact {
            problem.exact_in(*body, crate::formula::exact(&exact.value)).expect("a body of the problem");
        }
    }
    meshes::unshared(context);
    // patches of files with several patches: their touching sides are glued
    let mut couples = side_pairs::find(context, &mut problem, &places, &case.glued_files());
    glue::say(context, &mut problem, &mut places, &couples);
    couples.named = boundary::say(context, &mut problem, &mut places, &couples);
    Ok((problem, places, couples))
}
