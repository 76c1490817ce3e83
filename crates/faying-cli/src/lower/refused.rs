//! Diagnostics of ties and contacts that cannot be built.

use super::lower_context::LowerContext;
use super::multipliers::{held_help, multiplier_fault, positive_help, stable, too_many};
use super::obstacles::{turned_away, turned_round};
use super::places::Places;
use super::warned::meant;
use crate::case::{self, Master, Tie};
use crate::errors::Diagnostic;
use crate::formula::Point;
use crate::place::SourceSpan;
use crate::text_format::{component_name, labels, place, short, time_text};
use faying::contact::{ContactError, MethodError};
use faying::coupling::CouplingError;
use faying::coupling::multiplier::{MultiplierError, has_triangles};
use faying::problem::{InterfaceError, InterfaceId, Problem, SideView, Statement};
use std::sync::Arc;

/// A problem, and the places of its statements.
type Source<'a, const S: usize, const N: usize> = (&'a Problem<S, N>, &'a Places);

/// The diagnostic of a slave side, the one with the number `slave` of the tie or contact `of`.
pub(super) fn slave_fault<const S: usize, const N: usize>(
    context: &LowerContext<'_, S, N>,
    source: Source<'_, S, N>,
    of: Statement,
    number: usize,
    error: &InterfaceError,
) -> Option<Diagnostic> {
    let (problem, places) = source;
    let said = places.said(of)?;
    let at = said.slaves.get(number).copied().unwrap_or(said.at);
    let (slave, masters) = problem.slave_and_masters(of, number)?;
    match problem.interface(of)? {
        InterfaceId::Tie(_) => {
            let tie = context.case.interfaces.get(said.block?)?;
            Some(tie_fault(context, source, tie, (&slave, &masters, at), error))
        }
        id @ InterfaceId::Contact(_) => {
            let contact = context.case.contacts.get(said.block?)?;
            Some(*fault(context, source, contact, (id, number), (&slave, &masters, at), error))
        }
    }
}

/// Builds the diagnostic of a tie that cannot be built.
fn tie_fault<const S: usize, const N: usize>(
    context: &LowerContext<'_, S, N>,
    source: Source<'_, S, N>,
    tie: &Tie,
    (slave, masters, at): (&SideView<S, N>, &[Arc<SideView<S, N>>], SourceSpan),
    error: &InterfaceError,
) -> Diagnostic {
    let (name, components) = (&tie.name.value, context.case.components());
    match error {
        InterfaceError::Held { components: held, by_equations } => {
            let text = format!(
                "the multiplier of \"{name}\" on `{}` is over-constrained: component {} has 0 free unknowns",
                slave.label(),
                component_name(held[0], components)
            );
            context.error("E024", text, at).with_some_help(held_help(source, (slave, masters), held, *by_equations))
        }
        InterfaceError::Multiplier { component, error } => {
            let mut fault = multiplier_fault(context, name, slave, error, &tie.multiplier, N.max(2));
            let at_rim = matches!(error, MultiplierError::NothingLeft { .. } | MultiplierError::NothingLeftAtEdge { .. });
            if let Some(c) = component.filter(|_| at_rim) {
                fault.message = format!("{} (component {})", fault.message, component_name(c, components));
            }
            fault
        }
        InterfaceError::Counts(error) => {
            let fault = multiplier_fault(context, name, slave, error, &tie.multiplier, components);
            match error {
                MultiplierError::TooMany { component, .. } => {
                    fault.with_some_help(held_help(source, (slave, masters), &[*component], false))
                }
                _ => fault,
            }
        }
        InterfaceError::Apart(error) => {
            let (slave, masters) = (slave.label(), labels(masters));
            match error {
                CouplingError::Apart { distance, at: x, allowed } => {
                    too_far(context, (slave, &masters), (*distance, &x[..N], *allowed), at)
                }
                CouplingError::Lost { .. } => context
                    .error("E023", format!("`{slave}` and {masters}: {error}"), at)
                    .with_help("refine the sides, or exchange slave and master"),
                other => context.error("E023", format!("`{slave}` and {masters} do not meet: {other}"), at).with_help(CLOSER),
            }
        }
        InterfaceError::Uncovered { share } => {
            let text = format!("only {} % of the slave side `{}` meets {}", percent(*share), slave.label(), labels(masters));
            context
                .error("E025", text, at)
                .with_help("a tied slave must be covered: swap slave and master, or add the missing master sides")
        }
        InterfaceError::Doubled { share } => {
            let text = format!("{} % of the slave side `{}` meets two of {}", percent(*share), slave.label(), labels(masters));
            context
                .error("E025", text, at)
                .with_help("a tied slave must be covered once: leave out one of the masters, or a part of it by `where`")
        }
        InterfaceError::Carries { .. } => context
            .error("E019", format!("interface \"{name}\": {error}"), tie.coupling.at)
            .with_help("write coupling = \"mortar\", or state what the side carries on another part of it, by `where`"),
        other => context.error("E015", format!("interface \"{name}\": {other}"), tie.head.at),
    }
}

/// Advice for sides that are too far apart to be tied.
const CLOSER: &str = "move the bodies together or raise `tolerance`; use [[contact]] if a gap is meant";

/// E023 of a slave and its masters that are farther apart at a point than is allowed.
pub(super) fn too_far<const S: usize, const N: usize>(
    context: &LowerContext<'_, S, N>,
    (slave, masters): (&str, &str),
    (distance, x, allowed): (f64, &[f64], f64),
    at: SourceSpan,
) -> Diagnostic {
    let text = format!("`{slave}` and {masters} are up to {} apart (at {}); allowed {}", short(distance), place(x), short(allowed));
    context.error("E023", text, at).with_help(CLOSER)
}

/// Formats a share in percent, rounded down to four decimals but for round-off.
fn percent(share: f64) -> String {
    format!("{}", (share * 1e6 + 1e-3).floor() / 1e4)
}

/// Builds the diagnostic of a slave side of a contact that cannot be built.
fn fault<const S: usize, const N: usize>(
    context: &LowerContext<'_, S, N>,
    source: Source<'_, S, N>,
    contact: &case::Contact,
    (of, number): (InterfaceId, usize),
    (slave, masters, at): (&SideView<S, N>, &[Arc<SideView<S, N>>], SourceSpan),
    error: &InterfaceError,
) -> Box<Diagnostic> {
    let name = &contact.name.value;
    Box::new(match error {
        InterfaceError::Method(e) => {
            let key = if matches!(e, MethodError::Tolerance(_)) { "tolerance" } else { "factor" };
            context.error("E015", format!("contact \"{name}\": {e}"), contact.given.at(key).unwrap_or(contact.method.at))
        }
        InterfaceError::Refused { .. } => {
            let text = format!("method = {:?} against an obstacle that a `force` presses is not in this version", contact.method.value);
            context.error("E019", text, contact.method.at).with_help("write method = \"lagrange\", or give the obstacle a `move`")
        }
        InterfaceError::Carries { .. } => context
            .error("E019", format!("contact \"{name}\": {error}"), contact.method.at)
            .with_help("write method = \"lagrange\", or state what the side carries on another part of it, by `where`"),
        InterfaceError::Segments(e) => context.error("E023", format!("contact \"{name}\": {e}"), at),
        InterfaceError::Contact(e) => contact_fault(context, contact, slave, masters, e, at),
        InterfaceError::Gap { at, geometric, t } => gap_fault(context, contact, (&at[..N], *t), *geometric),
        InterfaceError::TurnedRound { t } => turned_round(context, contact, slave, *t, at),
        InterfaceError::NothingFaces => {
            let plain = contact_fault(context, contact, slave, masters, &ContactError::NoTarget, at);
            if masters.is_empty() {
                return turned_away(context, contact, source.0, (of, number), slave, Box::new(plain));
            }
            plain.with_some_help(source.0.meant_sides(slave, masters).map(|sides| meant(context, &sides)))
        }
        InterfaceError::Held { components, by_equations } => {
            let text = format!(
                "the multiplier of \"{name}\" on `{}` is over-constrained: the normal direction has 0 free unknowns",
                slave.label()
            );
            let help = held_help(source, (slave, masters), components, *by_equations);
            context.error("E024", text, at).with_help(help.unwrap_or_else(|| "free the side, or give it more elements".into()))
        }
        InterfaceError::Shared => {
            let text = format!("the multiplier of \"{name}\" on `{}` has no functions: {error}", slave.label());
            context.error("E024", text, at).with_help("name the elements as one side, or refine the body")
        }
        InterfaceError::TooMany { multipliers, free, components, by_equations } => {
            let fault = too_many(context, name, slave, "the normal direction", (*multipliers, *free), &contact.multiplier);
            fault.with_some_help(held_help(source, (slave, masters), components, *by_equations))
        }
        InterfaceError::Multiplier { error, .. } => multiplier_fault(context, name, slave, error, &contact.multiplier, N.max(2)),
        other => context.error("E041", format!("contact \"{name}\": {other}"), at),
    })
}

/// E017 of a gap that is no number in a point at a time, where the geometric gap is `geometric`.
fn gap_fault<const S: usize, const N: usize>(
    context: &LowerContext<'_, S, N>,
    contact: &case::Contact,
    (x, t): (&[f64], f64),
    geometric: f64,
) -> Diagnostic {
    let (name, there) = (&contact.name.value, place(x) + &time_text(context.case.steps.value.len() > 1, t));
    let obstacle = match &contact.master {
        Master::Rigid(obstacle) if !geometric.is_finite() => obstacle,
        _ => {
            let text = format!("contact \"{name}\": the gap `{}` is not finite at {there}", contact.gap.value.text());
            let help = "the formula is needed at all points of the slave side that face something, at all times of [steps]";
            return context.error("E017", text, contact.gap.at).with_help(help);
        }
    };
    let case::ObstacleShape::LevelSet { f, .. } = &obstacle.shape.value else {
        return context.error("E017", format!("contact \"{name}\": the obstacle has no finite gap at {there}"), obstacle.at);
    };
    if !f.value.value(&Point::new(x).at_time(t)).is_finite() {
        let text = format!("contact \"{name}\": `{}` is not finite at {there}", f.value.text());
        return context
            .error("E017", text, f.at)
            .with_help("`f` is needed at and around all points of the slave side, at all times of [steps]");
    }
    let text = format!("contact \"{name}\": `{}`: found no zero at which its sign changes, looked for from {there}", f.value.text());
    let help = "`f` is positive outside of the obstacle and negative inside, and its zero is found along its gradient, which jumps at an edge of the obstacle and may turn the search back: `along` takes f itself as the gap";
    context.error("E017", text, f.at).with_help(help)
}

pub(super) fn contact_fault<const S: usize, const N: usize>(
    context: &LowerContext<'_, S, N>,
    contact: &case::Contact,
    slave: &SideView<S, N>,
    masters: &[Arc<SideView<S, N>>],
    error: &ContactError,
    at: SourceSpan,
) -> Diagnostic {
    let text = format!("contact \"{}\": {error}", contact.name.value);
    match error {
        ContactError::Weight { .. } => context.error("E064", text, contact.multiplier.at).with_help(positive_help(slave)),
        ContactError::NoGreville => {
            // no multiplier of triangles has such points
            let or = match has_triangles(&*slave.trace().space) {
                true => String::new(),
                false => format!(", or take a multiplier such as {}", stable(slave)),
            };
            context.error("E064", text, contact.cone.at).with_help(format!("write cone = \"weights\" or \"coefficients\"{or}"))
        }
        ContactError::ConeWeight { .. } => {
            context.error("E064", text, contact.cone.at).with_help("take a multiplier of lower degree, or cone = \"coefficients\"")
        }
        ContactError::ConeSize { .. } => {
            context.error("E081", text, contact.cone.at).with_help("write cone = \"coefficients\", or give the slave side fewer elements")
        }
        ContactError::NoTarget if masters.is_empty() => context
            .error("E023", format!("no part of `{}` faces the obstacle of contact \"{}\"", slave.label(), contact.name.value), at)
            .with_help("turn the obstacle's normal towards the body, move an obstacle that begins deep within the body out of it, or raise `reach`; an obstacle of less than 1/128 of an element is not found, give the side smaller ones"),
        ContactError::NoTarget => context
            .error("E023", format!("no part of `{}` faces {}", slave.label(), labels(masters)), at)
            .with_help("raise `reach`, or choose the sides that face each other"),
        _ => context.error("E041", text, at),
    }
}
