//! Multiplier spaces named or given by the case, and their diagnostics.

use super::lower_context::LowerContext;
use super::places::Places;
use crate::case::Multiplier;
use crate::errors::Diagnostic;
use crate::place::Located;
use crate::registry::is_glue;
use crate::text_format::component_name;
use faying::coupling::multiplier::{MultiplierError, MultiplierKind, has_triangles};
use faying::problem::{self, Contents, Problem, SideView, Statement};
use std::sync::Arc;

/// The multiplier that every side has.
pub(super) const FULL: &str = "p/p";
/// Advice where no multiplier may do.
const NITSCHE: &str = ", or \"nitsche\" as coupling or method, which has no multiplier";

/// Returns the multiplier `wanted` by the case.
pub(super) fn multiplier<const S: usize, const N: usize>(
    context: &LowerContext<'_, S, N>,
    wanted: &Located<Multiplier>,
) -> Result<problem::Multiplier<S, N>, Box<Diagnostic>> {
    match &wanted.value {
        Multiplier::Named(word) => {
            context.names.multipliers.get(word).cloned().map_err(|unknown| Box::new(context.error("E064", unknown.to_string(), wanted.at)))
        }
        Multiplier::Data { degree, continuity, ends } => {
            Ok(MultiplierKind::Uniform { degree: *degree, continuity: *continuity, ends: *ends }.into())
        }
    }
}

/// Returns a warning (E061) if the multiplier `wanted` by the case is unstable, or is the unstable pairing p/p-k (p, k) under another name.
pub(super) fn unstable<const S: usize, const N: usize>(
    context: &LowerContext<'_, S, N>,
    name: &str,
    slave: &SideView<S, N>,
    wanted: &Located<Multiplier>,
    pairing: Option<(usize, usize)>,
) -> Option<Diagnostic> {
    let space = &*slave.trace().space;
    let shown = "; `faying infsup` shows it";
    let text = match &wanted.value {
        Multiplier::Named(word) if word.parse::<MultiplierKind>().is_ok_and(|k| k.is_unstable_on(space)) => {
            format!("multiplier \"{word}\" of \"{name}\" is not stable{shown}")
        }
        value => {
            let (degree, lowered) = pairing?;
            let word = match value {
                Multiplier::Named(word) => format!("\"{word}\""),
                _ => format!("of degree {}", degree - lowered),
            };
            if has_triangles(space) {
                format!(
                    "multiplier {word} of \"{name}\" jumps between triangles, which is not stable on a side of degree {degree}: its \
                     pressure oscillates"
                )
            } else {
                format!(
                    "multiplier {word} of \"{name}\" is p/p-{lowered} on this side of degree {degree}, which is not stable: its pressure \
                     oscillates{shown}"
                )
            }
        }
    };
    Some(context.warning("E061", text, wanted.at).with_help(stable_help(slave)))
}

/// Warns of unstable multipliers of ties.
pub(super) fn check<const S: usize, const N: usize>(context: &mut LowerContext<'_, S, N>, contents: &Contents<'_, S, N>) {
    let ties = context.case.interfaces.iter().filter(|t| !is_glue(&t.coupling.value));
    for (read, tie) in ties.zip(contents.ties()) {
        for slave in tie.sides().iter().filter(|slave| !slave.multipliers().is_empty()) {
            let found = unstable(context, tie.name(), slave.side(), &read.multiplier, slave.unstable());
            context.faults.items.extend(found);
        }
    }
}

/// The stable multiplier with positive functions that is `auto` on this side; its name is p/p where there is none of a lower degree.
pub(super) fn stable<const S: usize, const N: usize>(slave: &SideView<S, N>) -> String {
    MultiplierKind::Auto.resolved(&*slave.trace().space).to_string()
}

/// A multiplier with positive functions that exists on this side.
pub(super) fn positive_help<const S: usize, const N: usize>(slave: &SideView<S, N>) -> String {
    format!("write multiplier = \"{}\"", stable(slave))
}

/// The stable multipliers of this side, in place of an unstable one.
fn stable_help<const S: usize, const N: usize>(slave: &SideView<S, N>) -> String {
    match stable(slave) {
        name if name == FULL => "use p/p, or raise the degree of the slave".to_owned(),
        name => format!("use p/p or {name}"),
    }
}

/// Advice to divide a side further: "give patch "a" more elements along `a.top`".
fn more_elements<const S: usize, const N: usize>(side: &SideView<S, N>) -> String {
    let patch = side.label().split('.').next().unwrap_or(side.label());
    format!("give patch \"{patch}\" more elements along `{}`", side.label())
}

/// Builds the diagnostic of a multiplier that cannot be built.
pub(super) fn multiplier_fault<const S: usize, const N: usize>(
    context: &LowerContext<'_, S, N>,
    name: &str,
    slave: &SideView<S, N>,
    error: &MultiplierError,
    wanted: &Located<Multiplier>,
    components: usize,
) -> Diagnostic {
    let at = wanted.at;
    match error {
        MultiplierError::NoDual { .. } => {
            context.error("E064", format!("\"{name}\" on `{}`: {error}", slave.label()), at).with_help(positive_help(slave))
        }
        MultiplierError::NothingLeft { .. } | MultiplierError::NothingLeftAtEdge { .. } | MultiplierError::NothingFree => {
            let at_what = if S == 1 { "an end" } else { "an edge" };
            let or = match stable(slave) {
                name if name == FULL => String::new(),
                name => format!(", or take {name}"),
            };
            context
                .error("E024", format!("the multiplier of \"{name}\" on `{}` cannot be lowered at {at_what}: {error}", slave.label()), at)
                .with_help(more_elements(slave) + &or + NITSCHE)
        }
        MultiplierError::TooMany { component, multipliers, free } => {
            let direction = format!("component {}", component_name(*component, components));
            too_many(context, name, slave, &direction, (*multipliers, *free), wanted)
        }
        MultiplierError::Revolution => {
            context.error("E019", format!("\"{name}\" on `{}`: {error}", slave.label()), at).with_help(positive_help(slave))
        }
        _ => context.error("E064", format!("\"{name}\" on `{}`: {error}", slave.label()), at),
    }
}

/// E024 for more functions of a multiplier than free unknowns in a direction.
pub(super) fn too_many<const S: usize, const N: usize>(
    context: &LowerContext<'_, S, N>,
    name: &str,
    slave: &SideView<S, N>,
    direction: &str,
    (multipliers, free): (usize, usize),
    wanted: &Located<Multiplier>,
) -> Diagnostic {
    let text = format!(
        "the multiplier of \"{name}\" on `{}` is over-constrained: {direction} has {multipliers} functions for {free} free unknowns",
        slave.label()
    );
    let is_full = match &wanted.value {
        Multiplier::Named(word) => word.parse::<MultiplierKind>().is_ok_and(|k| k.resolved(&*slave.trace().space).to_string() == FULL),
        Multiplier::Data { .. } => false,
    };
    let or = if is_full { ", or take a multiplier of lower degree" } else { ", or take p/p, which is lowered where the side is held" };
    context.error("E024", text, wanted.at).with_help(more_elements(slave) + or + NITSCHE)
}

/// Help text for a side that conditions hold in one of `components`, naming them; `None` if there are none. Obstacles, which have no side,
/// cannot be the slave.
pub(super) fn held_help<const S: usize, const N: usize>(
    (problem, places): (&Problem<S, N>, &Places),
    (slave, masters): (&SideView<S, N>, &[Arc<SideView<S, N>>]),
    components: &[usize],
    slides: bool,
) -> Option<String> {
    let named = |found: Vec<(Statement, usize)>, by: &str| -> Vec<String> {
        let mut named: Vec<String> = found
            .into_iter()
            .filter(|(_, component)| components.contains(component))
            .map(|(of, component)| {
                let line = places.at(of).in_file().map_or(String::new(), |(line, _)| format!(" (line {line})"));
                format!("component {} by {by}{line}", component_name(component, problem.components()))
            })
            .collect();
        named.dedup();
        named
    };
    let (mut held, mut how) = (named(problem.supports_of(slave), "`fix` or `dirichlet`"), "is prescribed itself");
    if held.is_empty() {
        (held, how) = (named(problem.moved_as_one(slave), "`rigid_force`"), "moves as one");
    }
    if held.is_empty() && slides && problem.is_supported(slave) {
        (held, how) = (vec!["by fix = [\"normal\"] or fix = [\"tangential\"]".into()], "is prescribed itself");
    }
    let or = if masters.is_empty() { "" } else { ", or let another side be the slave" };
    (!held.is_empty()).then(|| format!("`{}` {how}: {}; drop that condition{or}", slave.label(), held.join(", ")))
}
