//! Tied interfaces of the case, said one by one.

use super::lower_context::LowerContext;
use super::multipliers::multiplier;
use super::places::{Places, Said};
use super::side_pairs::SidePairs;
use crate::case::Tie;
use crate::errors::Diagnostic;
use crate::place::Located;
use crate::registry::{Fault, is_glue};
use faying::coupling::Coupling;
use faying::coupling::multiplier::MultiplierKind;
use faying::problem::{Integration, Multiplier, Problem, Rule};

/// Says all ties of the case; errors go to the context's faults.
pub(super) fn say<const S: usize, const N: usize>(
    context: &mut LowerContext<'_, S, N>,
    problem: &mut Problem<S, N>,
    places: &mut Places,
    couples: &SidePairs<S, N>,
) {
    let case = context.case;
    for (k, (tie, list)) in case.interfaces.iter().zip(&couples.ties).enumerate().filter(|(_, (t, _))| !is_glue(&t.coupling.value)) {
        let (coupling, multiplier, rule) = match choices(context, tie) {
            Ok(found) => found,
            Err(fault) => {
                context.faults.push(*fault);
                continue;
            }
        };
        let said = problem.tie_couples(list.iter().map(|c| c.couple.clone()).collect());
        said.named(&tie.name.value).coupling(coupling).multiplier(multiplier).rule(rule).extra_points(tie.extra_points.value);
        said.exact(tie.exact.iter().flat_map(|list| &list.value).map(|f| f.value.clone().into()).collect());
        if let Some(distance) = tie.tolerance.value {
            said.tolerance(distance);
        }
        let slaves = list.iter().map(|c| c.at).collect();
        places.keep(said.id().into(), Said { at: tie.head.at, block: Some(k), slaves, ..Said::default() });
    }
}

/// Coupling, multiplier and rule of a tie.
type Choices<const S: usize, const N: usize> = (Box<dyn Coupling<S, N>>, Multiplier<S, N>, Rule<S, N>);

fn choices<const S: usize, const N: usize>(context: &LowerContext<'_, S, N>, tie: &Tie) -> Result<Choices<S, N>, Box<Diagnostic>> {
    let name = &tie.coupling;
    let entry = context.names.couplings.get(&name.value).map_err(|e| context.error("E015", e.to_string(), name.at))?;
    let refused = |fault: &Fault| context.error(fault.code, fault.message.clone(), tie.given.at(fault.key).unwrap_or(name.at));
    let coupling = (entry.make)(&tie.given).map_err(|fault| refused(&fault))?;
    // a coupling without rows has no multiplier
    let multiplier = if coupling.has_rows() { multiplier(context, &tie.multiplier)? } else { MultiplierKind::Auto.into() };
    Ok((coupling, multiplier, rule(context, &tie.integration)?))
}

/// The rule of an interface by its keyword.
pub(super) fn rule<const S: usize, const N: usize>(
    context: &LowerContext<'_, S, N>,
    integration: &Located<String>,
) -> Result<Rule<S, N>, Box<Diagnostic>> {
    let names = &context.names.integrations;
    if integration.value == "mixed" && names.get("slave").is_ok() {
        return Ok(Integration::Mixed.into());
    }
    let word = if integration.value == "mixed" { "slave" } else { &integration.value };
    names.get(word).cloned().map_err(|e| Box::new(context.error("E019", e.to_string(), integration.at)))
}
