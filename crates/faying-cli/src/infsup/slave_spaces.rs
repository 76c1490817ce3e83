//! Trace and multiplier spaces of slave sides, one pair per scalar problem, for the inf-sup test.

use crate::case::{Case, Multiplier};
use crate::errors::{Diagnostic, Diagnostics};
use crate::lower::{LowerContext, specification, stated};
use crate::registry::Names;
use crate::shapes::MakeControlNet;
use crate::text_format::component_name;
use faying::coupling::multiplier::MultiplierKind;
use faying::problem::{InterfaceSide, SlaveEnds, SlaveSpace};
use faying::space::Trace;

/// The spaces of one scalar problem on one slave side, in the words of the case.
#[derive(Debug)]
pub(super) struct SlaveSpaces<const S: usize, const N: usize> {
    /// The interface or contact.
    pub name: String,
    /// Component: "x", "y", "u"; "normal" for contacts.
    pub component: &'static str,
    /// Name of the multiplier, with `auto` resolved; `None` if it is given by data.
    pub pairing: Option<String>,
    /// Lengths (areas) of the elements in the parameters of the side, as fractions of the whole; equal if it has none.
    pub shares: Vec<f64>,
    /// The spaces.
    pub spaces: SlaveSpace<S, N>,
}

/// Builds the spaces of every slave side and component of `case`, in its order. No segments, no rows, no bulk integrals.
///
/// # Errors
/// All errors of the bodies, sides and multipliers, with their source locations.
pub(super) fn slave_spaces<const S: usize, const N: usize>(
    case: &Case,
    names: &Names<S, N>,
    net: MakeControlNet<N>,
    ends: SlaveEnds,
) -> Result<Vec<SlaveSpaces<S, N>>, Diagnostics>
where
    Trace<S, N>: InterfaceSide<S, N>,
{
    let stated = stated(case, names, net)?;
    let found = stated.problem.slave_spaces(ends).map_err(|errors| {
        let mut faults: Vec<Diagnostic> = Vec::new();
        for fault in stated.refused(&errors) {
            if !faults.contains(&fault) {
                faults.push(fault);
            }
        }
        Diagnostics { items: faults }
    })?;
    let components = case.model.components();
    let of = |spaces: SlaveSpace<S, N>| {
        let block = stated.places.said(spaces.of).and_then(|said| said.block)?;
        let (name, multiplier) = match spaces.component {
            Some(_) => (&case.interfaces[block].name.value, &case.interfaces[block].multiplier),
            None => (&case.contacts[block].name.value, &case.contacts[block].multiplier),
        };
        let pairing = match &multiplier.value {
            Multiplier::Named(word) => {
                let kind = word.parse::<MultiplierKind>().map(|kind| kind.resolved(&*spaces.side.trace().space).to_string());
                Some(kind.unwrap_or_else(|_| word.clone()))
            }
            _ => None,
        };
        let n = spaces.side.trace().space.num_elements();
        let own = shares(&stated.context, spaces.side.body(), spaces.side.name(), net);
        let shares = own.filter(|s| s.len() == n).unwrap_or_else(|| vec![1.0 / n as f64; n]);
        let component = spaces.component.map_or("normal", |c| component_name(c, components));
        Some(SlaveSpaces { name: name.clone(), component, pairing, shares, spaces })
    };
    Ok(found.into_iter().filter_map(of).collect())
}

/// Lengths (areas) of the elements of a side in its parameters, as fractions of the whole, in their order; `None` for meshes.
fn shares<const S: usize, const N: usize>(
    context: &LowerContext<'_, S, N>,
    patch: usize,
    side: &str,
    net: MakeControlNet<N>,
) -> Option<Vec<f64>> {
    let patch = &context.case.patches[patch];
    let spec = specification(context, patch, net).ok()??;
    let across = ["u0", "u1", "v0", "v1", "w0", "w1"].iter().position(|name| *name == side)? / 2;
    let mut all = vec![1.0];
    for axis in (0..N).filter(|axis| *axis != across) {
        let points = &spec.breakpoints[axis];
        let length = points.last()? - points.first()?;
        // the first direction runs fastest
        all = points.windows(2).flat_map(|p| all.iter().map(move |share| share * (p[1] - p[0]) / length)).collect();
    }
    Some(all)
}
