//! Tied interfaces: multipliers, segments and rows of every slave side.

use super::builder::Builder;
use super::built::Built;
use super::couples::{CoupleAt, Couples};
use super::multipliers::{held_help, judged, multiplier, multiplier_fault};
use super::sides::Sides;
use super::values::times;
use crate::case::{self, SideRef, Tie};
use crate::errors::Diagnostic;
use crate::place::{Located, Place};
use crate::registry::{CouplingOptions, has_mortar_rows, is_glue};
use crate::words::component_name;
use crate::words::{labels, short};
use faying::coupling::multiplier::MultiplierError;
use faying::coupling::nitsche::Variant;
use faying::coupling::{Coupling, CouplingError};
use faying::problem::{Fixed, InterfaceError, InterfaceRules, MakeMultiplier, Memberships, Model, SideModel, TieModel, TiePart, TieSetup};
use std::collections::BTreeSet;
use std::sync::{Arc, OnceLock};

/// Returns the sides of a list of references; errors go to the builder's faults.
pub(super) fn list<const S: usize, const N: usize>(
    builder: &mut Builder<'_, S, N>,
    model: &Model<S, N>,
    sides: &mut Sides<S, N>,
    wanted: &[Located<SideRef>],
) -> Vec<Arc<SideModel<S, N>>> {
    let mut out = Vec::new();
    for side in wanted {
        match sides.get(builder, &model.patches, side) {
            Ok(side) => out.push(side),
            Err(fault) => builder.faults.push(*fault),
        }
    }
    out
}

/// Builds all ties of the case; errors go to the builder's faults.
pub(super) fn build<const S: usize, const N: usize>(
    builder: &mut Builder<'_, S, N>,
    model: &mut Built<S, N>,
    couples: &Couples<S, N>,
    fixed: &Fixed,
) {
    let members = memberships(builder, model, couples);
    let case = builder.case;
    for (tie, couples) in case.interfaces.iter().zip(&couples.ties) {
        if is_glue(&tie.coupling.value) {
            continue;
        }
        let mut parts = Vec::new();
        for couple in couples {
            match part(builder, model, tie, couple, fixed, &members) {
                Ok((part, warning)) => {
                    model.rows += part.num_rows;
                    parts.push(part);
                    if let Some(warning) = warning {
                        builder.faults.push(warning);
                    }
                }
                Err(fault) => builder.faults.push(*fault),
            }
        }
        let exact = tie.exact.as_ref().map(|list| list.value.iter().map(|f| f.value.clone().into()).collect());
        model.ties.push(TieModel { name: tie.name.value.clone(), parts, exact });
    }
}

/// Counts the tied sides of every function; for contact, functions on tied sides are constrained.
pub(super) fn memberships<const S: usize, const N: usize>(
    builder: &Builder<'_, S, N>,
    model: &Model<S, N>,
    couples: &Couples<S, N>,
) -> Memberships {
    let mut members = Memberships::default();
    // couplings without rows constrain no functions
    let has_rows = |tie: &Tie| coupling_of(builder, tie).is_ok_and(|coupling| coupling.has_rows());
    for (_, list) in builder.case.interfaces.iter().zip(&couples.ties).filter(|(tie, _)| !is_glue(&tie.coupling.value) && has_rows(tie)) {
        // a side in two lists of one tie counts once
        let mut seen: BTreeSet<(usize, &str)> = BTreeSet::new();
        for side in list.iter().flat_map(|c| c.masters.iter().chain([&c.slave])) {
            if seen.insert((side.patch, &side.side)) {
                members.add(model, side);
            }
        }
    }
    members
}

/// Variant of Nitsche's method for a keyword of the case.
pub(super) fn nitsche_variant(word: case::Variant) -> Variant {
    match word {
        case::Variant::Unsymmetric => Variant::Unsymmetric,
        case::Variant::Incomplete => Variant::Incomplete,
        _ => Variant::Symmetric,
    }
}

/// Creates the coupling that a tie names.
pub(super) fn coupling_of<const S: usize, const N: usize>(
    builder: &Builder<'_, S, N>,
    tie: &Tie,
) -> Result<Box<dyn Coupling<S, N>>, Box<Diagnostic>> {
    let variant = nitsche_variant(tie.variant.value);
    match builder.names.couplings.get(&tie.coupling.value) {
        Ok(make) => Ok(make(CouplingOptions { factor: tie.factor.value, variant })),
        Err(unknown) => Err(Box::new(builder.error("E015", unknown.to_string(), tie.coupling.at))),
    }
}

fn part<const S: usize, const N: usize>(
    builder: &Builder<'_, S, N>,
    model: &Built<S, N>,
    tie: &Tie,
    couple: &CoupleAt<S, N>,
    fixed: &Fixed,
    members: &Memberships,
) -> Result<(TiePart<S, N>, Option<Diagnostic>), Box<Diagnostic>> {
    let coupling = coupling_of(builder, tie)?;
    let warning = OnceLock::new();
    let multiplier: Box<MakeMultiplier<'_, S, N>> = match coupling.has_rows() {
        true => judged(builder, model, &tie.name.value, &couple.slave, &tie.multiplier, multiplier(builder, &tie.multiplier)?, &warning),
        false => Box::new(|_, _| unreachable!("a coupling without rows has no multipliers")),
    };
    let setup = TieSetup {
        slave: &couple.slave,
        masters: &couple.masters,
        coupling,
        mortar_rows: has_mortar_rows(&tie.coupling.value),
        multiplier: &*multiplier,
        // the reaction of a tie is integrated by the rule of the constraint, along the master
        rules: rules(builder, &tie.integration, tie.extra_points.value, None)?,
        tolerance: tie.tolerance.value,
        explained: couple.explained,
        t: times(builder.case, false)[0],
    };
    let part = model.tie_part(setup, fixed, members).map_err(|e| Box::new(tie_fault(builder, model, tie, couple, &e)))?;
    Ok((part, warning.get().cloned().flatten()))
}

/// Returns the rules of an interface by its keywords; `second`: the name of the rule of mixed integration, `None` for that of the first.
pub(super) fn rules<'a, const S: usize, const N: usize>(
    builder: &Builder<'a, S, N>,
    integration: &Located<String>,
    extra_points: usize,
    second: Option<&str>,
) -> Result<InterfaceRules<'a, S, N>, Box<Diagnostic>> {
    let names = &builder.names.integrations;
    let get = |word: &str| names.get(word).map(|make| &**make).map_err(|e| Box::new(builder.error("E019", e.to_string(), integration.at)));
    let mixed = integration.value == "mixed";
    let word = if mixed { "slave" } else { integration.value.as_str() };
    let second = mixed.then(|| get(second.unwrap_or(word))).transpose()?;
    Ok(InterfaceRules { rule: get(word)?, second, finer: get("merged").ok(), extra_points })
}

/// Builds the diagnostic of a tie that cannot be built.
fn tie_fault<const S: usize, const N: usize>(
    builder: &Builder<'_, S, N>,
    model: &Built<S, N>,
    tie: &Tie,
    couple: &CoupleAt<S, N>,
    error: &InterfaceError,
) -> Diagnostic {
    let (slave, masters, at, name) = (&couple.slave, &couple.masters[..], couple.at, &tie.name.value);
    match error {
        InterfaceError::Held { components, by_equations } => {
            let text = format!(
                "the multiplier of \"{name}\" on `{}` is over-constrained: component {} has 0 free unknowns",
                slave.label,
                component_name(components[0], model.components)
            );
            let fault = builder.error("E024", text, at);
            match held_help(model, slave, components, *by_equations) {
                Some(help) => fault.with_help(help),
                None => fault,
            }
        }
        InterfaceError::Multiplier { component, error } => {
            let mut fault = multiplier_fault(builder, name, slave, error, tie.multiplier.at, N.max(2));
            if let (MultiplierError::NothingLeft { .. }, Some(c)) = (error, component) {
                fault.message = format!("{} (component {})", fault.message, component_name(*c, 2));
            }
            fault
        }
        InterfaceError::Counts(error) => multiplier_fault(builder, name, slave, error, tie.multiplier.at, model.components),
        InterfaceError::Apart(error) => apart(builder, slave, masters, error, at),
        InterfaceError::Uncovered { share } => {
            let text = format!("only {} % of the slave side `{}` meets {}", percent(*share), slave.label, labels(masters));
            builder
                .error("E025", text, at)
                .with_help("a tied slave must be covered: swap slave and master, or add the missing master sides")
        }
        other => builder.error("E015", format!("interface \"{name}\": {other}"), tie.head.at),
    }
}

fn apart<const S: usize, const N: usize>(
    builder: &Builder<'_, S, N>,
    slave: &SideModel<S, N>,
    masters: &[Arc<SideModel<S, N>>],
    error: &CouplingError,
    at: Place,
) -> Diagnostic {
    let help = "move the bodies together or raise `tolerance`; use [[contact]] if a gap is meant";
    let masters = labels(masters);
    match error {
        CouplingError::Apart { distance, at: place, allowed } => {
            let coordinates: Vec<String> = ["x", "y", "z"][..N].iter().zip(place).map(|(l, v)| format!("{l} = {}", short(*v))).collect();
            builder
                .error(
                    "E023",
                    format!(
                        "`{}` and {masters} are up to {} apart (at {}); allowed {}",
                        slave.label,
                        short(*distance),
                        coordinates.join(", "),
                        short(*allowed)
                    ),
                    at,
                )
                .with_help(help)
        }
        other => builder.error("E023", format!("`{}` and {masters} do not meet: {other}", slave.label), at).with_help(help),
    }
}

/// Formats a share in percent, rounded down to four decimals but for round-off.
fn percent(share: f64) -> String {
    format!("{}", (share * 1e6 + 1e-3).floor() / 1e4)
}
