//! Tied interfaces: multipliers, segments and rows of every slave side.

use super::boundary::component_name;
use super::couples::{Couple, Couples};
use super::fixed::Fixed;
use super::multipliers::{held_help, multiplier, multiplier_fault};
use super::sides::Sides;
use super::{Builder, Built};
use crate::case::{self, Integration, SideRef, Tie};
use crate::errors::Diagnostic;
use crate::place::{Located, Place};
use crate::registry::{CouplingOptions, has_mortar_rows, is_glue};
use faying::basis::{Basis, Elements};
use faying::coupling::consistency::Finer;
use faying::coupling::interface::{Partners, Tolerance};
use faying::coupling::multiplier::check_counts;
use faying::coupling::nitsche::Variant;
use faying::coupling::{Coupling, CouplingError, Interface, Rows, Segments, Side};
use faying::linalg::Triplets;
use faying::problem::{Model, Pairing, SideModel, TieModel, TiePart, function_sums};
use std::collections::{BTreeSet, HashMap, HashSet};
use std::sync::Arc;

/// Largest share of a slave side that may be uncovered.
const UNCOVERED: f64 = 1e-6;
/// Points per segment of the finer rule beyond those of the rule whose consistency error it estimates.
pub(super) const FINER_POINTS: usize = 2;

/// Number of sides of tied interfaces on which each function of a body lies.
#[derive(Debug, Default)]
pub(super) struct Memberships(HashMap<usize, usize>);

impl Memberships {
    pub(super) fn add<const S: usize, const N: usize>(&mut self, model: &Model<S, N>, side: &SideModel<S, N>) {
        let mut functions: Vec<usize> = side.trace.dofs.iter().map(|&dof| model.function(side.patch, dof)).collect();
        functions.sort_unstable();
        functions.dedup();
        for function in functions {
            *self.0.entry(function).or_default() += 1;
        }
    }

    /// Number of tied sides that contain `function` of `patch`, or one that is glued to it.
    pub fn count<const S: usize, const N: usize>(&self, model: &Model<S, N>, patch: usize, function: usize) -> usize {
        self.0.get(&model.function(patch, function)).copied().unwrap_or(0)
    }
}

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
                Ok((part, warnings)) => {
                    model.rows += part.num_rows;
                    parts.push(part);
                    for warning in warnings {
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

#[allow(clippy::result_large_err)]
fn part<const S: usize, const N: usize>(
    builder: &Builder<'_, S, N>,
    model: &Built<S, N>,
    tie: &Tie,
    couple: &Couple<S, N>,
    fixed: &Fixed,
    members: &Memberships,
) -> Result<(TiePart<S, N>, Vec<Diagnostic>), Box<Diagnostic>> {
    let (slave, masters, at) = (&couple.slave, &couple.masters[..], couple.at);
    let mut warnings = Vec::new();
    let name = &tie.name.value;
    let coupling = coupling_of(builder, tie)?;
    let field = model.patches[slave.patch].field;
    // multipliers, one per component: ends are constrained per component
    let mut multipliers = Vec::with_capacity(model.components);
    for c in (0..model.components).filter(|_| coupling.has_rows()) {
        if slave.trace.dofs.iter().all(|&function| fixed.is(field.unknown(function, c)))
            && let Some(help) = held_help(model, slave, &[c], !model.equations.is_empty())
        {
            let text = format!(
                "the multiplier of \"{name}\" on `{}` is over-constrained: component {} has 0 free unknowns",
                slave.label,
                component_name(c, model.components)
            );
            return Err(Box::new(builder.error("E024", text, at).with_help(help)));
        }
        let constrained = |function: usize| fixed.is(field.unknown(function, c)) || members.count(model, slave.patch, function) > 1;
        let (psi, warning) =
            multiplier(builder, model, name, slave, &tie.multiplier, &constrained, Some(c).filter(|_| model.components > 1))?;
        multipliers.push(psi);
        if c == 0 {
            warnings.extend(warning);
        }
    }
    // functions that are glued to each other count once
    let mut known = HashSet::new();
    let twins: HashSet<usize> = slave.trace.dofs.iter().copied().filter(|&f| !known.insert(model.function(slave.patch, f))).collect();
    let counted = |function: usize, c: usize| fixed.is(field.unknown(function, c)) || twins.contains(&function);
    if coupling.has_rows() {
        let borrowed: Vec<&dyn Basis<S>> = multipliers.iter().map(|m| &**m).collect();
        check_counts(&slave.trace, model.components, &borrowed, &counted)
            .map_err(|e| Box::new(multiplier_fault(builder, name, slave, &e, tie.multiplier.at, model.components)))?;
    }
    // segments against every master
    let mut pairings: Vec<Pairing<S, N>> = Vec::new();
    let mut finer: Vec<Segments<S>> = Vec::new();
    let mut missed: Option<CouplingError> = None;
    for master in masters {
        match segments(builder, model, tie, couple, master)? {
            Ok((segments, second)) => {
                pairings.push(Pairing { master: master.clone(), segments, second });
                finer.extend(finer_segments(builder, tie, slave, master));
            }
            Err(e) => missed = Some(e),
        }
    }
    if let Some(error) = missed.filter(|e| pairings.is_empty() || !matches!(e, CouplingError::NothingFaces)) {
        return Err(Box::new(apart(builder, slave, masters, &error, at)));
    }
    let total = pairings.first().map_or(0.0, |p| p.segments.report.slave_measure);
    let covered: f64 = pairings.iter().map(|p| p.segments.report.covered).sum();
    if covered < (1.0 - UNCOVERED) * total {
        let text = format!("only {} % of the slave side `{}` meets {}", percent(covered / total), slave.label, labels(masters));
        return Err(Box::new(
            builder
                .error("E025", text, at)
                .with_help("a tied slave must be covered: swap slave and master, or add the missing master sides"),
        ));
    }
    let mut part = TiePart {
        slave: slave.clone(),
        multipliers,
        coupling,
        pairings,
        rows: empty(0, model.unknowns),
        reaction: None,
        function_sums: Vec::new(),
        stiffness: Triplets::new(model.unknowns, model.unknowns),
        penalty: None,
        finer: None,
        first_row: model.rows,
        num_rows: 0,
    };
    let (mut reaction, mut differs) = (empty(0, model.unknowns), false);
    let fluxes = part.fluxes(model, builder.case.steps.value.first().copied().unwrap_or(1.0));
    for k in 0..part.pairings.len() {
        let blocks = part
            .blocks(&*part.coupling, model, k, &fluxes)
            .map_err(|e| Box::new(builder.error("E015", format!("interface \"{name}\": {e}"), tie.head.at)))?;
        differs |= blocks.reaction.is_some();
        add(&mut reaction, blocks.reaction.as_ref().unwrap_or(&blocks.constraint));
        add(&mut part.rows, &blocks.constraint);
        part.stiffness.append_below(&blocks.stiffness, 0);
        part.penalty = blocks.penalty.or(part.penalty);
    }
    if part.rows.slave.entries.is_empty() && part.rows.master.entries.is_empty() && !part.stiffness.entries.is_empty() {
        part.multipliers.clear();
    }
    part.reaction = differs.then_some(reaction);
    if has_mortar_rows(&tie.coupling.value) {
        part.function_sums = function_sums(model, &part);
    }
    if has_mortar_rows(&tie.coupling.value) && finer.len() == part.pairings.len() {
        let borrowed: Vec<&dyn Basis<S>> = part.multipliers.iter().map(|m| &**m).collect();
        let interfaces: Vec<Interface<'_, S, N>> = part
            .pairings
            .iter()
            .zip(&finer)
            .map(|(pairing, segments)| Interface {
                slave: Side { trace: &slave.trace, field, flux: None },
                master: Some(Side { trace: &pairing.master.trace, field: model.patches[pairing.master.patch].field, flux: None }),
                multiplier: &borrowed,
                segments,
                master_segments: None,
                direction: None,
            })
            .collect();
        part.finer = Finer::try_new(&interfaces, model.unknowns).ok();
    }
    part.num_rows = part.multipliers.iter().map(|m| m.num_functions()).sum();
    Ok((part, warnings))
}

fn empty(rows: usize, unknowns: usize) -> Rows {
    Rows { slave: Triplets::new(rows, unknowns), master: Triplets::new(rows, unknowns) }
}

fn add(sum: &mut Rows, other: &Rows) {
    sum.slave.append_below(&other.slave, 0);
    sum.master.append_below(&other.master, 0);
}

/// Labels of sides in messages.
pub(super) fn labels<const S: usize, const N: usize>(sides: &[Arc<SideModel<S, N>>]) -> String {
    sides.iter().map(|s| format!("`{}`", s.label)).collect::<Vec<_>>().join(", ")
}

/// Highest degree of a side.
pub(super) fn degree<const S: usize, const N: usize>(side: &SideModel<S, N>) -> usize {
    let space = &side.trace.space;
    (0..space.num_elements()).flat_map(|e| space.degree(e)).max().unwrap_or(1)
}

type Found<const S: usize> = Result<(Segments<S>, Option<Segments<S>>), CouplingError>;

fn segments<const S: usize, const N: usize>(
    builder: &Builder<'_, S, N>,
    model: &Model<S, N>,
    tie: &Tie,
    couple: &Couple<S, N>,
    master: &SideModel<S, N>,
) -> Result<Found<S>, Box<Diagnostic>> {
    let slave = &*couple.slave;
    let points = degree(slave).max(degree(master)) + 1 + tie.extra_points.value;
    let is_exact = model.patches[slave.patch].exact_map && model.patches[master.patch].exact_map;
    let tolerance = match tie.tolerance.value {
        Some(distance) => Tolerance::Given(distance),
        None if is_exact => Tolerance::Exact,
        None => couple.explained.map_or(Tolerance::Local, Tolerance::Given),
    };
    let word = if tie.integration.value == Integration::Merged { "merged" } else { "slave" };
    let make = builder.names.integrations.get(word).map_err(|e| Box::new(builder.error("E019", e.to_string(), tie.integration.at)))?;
    let first = make(points, Partners::Touching(tolerance)).segments(&*slave.trace.space, &*master.trace.space);
    Ok(first.and_then(|first| {
        let second = match tie.integration.value {
            // a master may be longer than its slave
            Integration::Mixed => {
                Some(make(points, Partners::Near(tolerance)).segments(&*master.trace.space, &*slave.trace.space)?.swapped())
            }
            _ => None,
        };
        Ok((first, second))
    }))
}

/// Segments for checking the rows: merged, with more points, without a limit on the distance, which has been checked.
fn finer_segments<const S: usize, const N: usize>(
    builder: &Builder<'_, S, N>,
    tie: &Tie,
    slave: &SideModel<S, N>,
    master: &SideModel<S, N>,
) -> Option<Segments<S>> {
    let points = degree(slave).max(degree(master)) + 1 + tie.extra_points.value + FINER_POINTS;
    let make = builder.names.integrations.get("merged").ok()?;
    make(points, Partners::Touching(Tolerance::Given(f64::INFINITY))).segments(&*slave.trace.space, &*master.trace.space).ok()
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

/// Formats a number with four digits.
pub(crate) fn short(x: f64) -> String {
    format!("{x:.3e}").parse::<f64>().map_or_else(|_| x.to_string(), |v| format!("{v}"))
}
