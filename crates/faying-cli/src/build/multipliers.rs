//! Multiplier spaces named or given by the case, and their diagnostics.

use super::builder::Builder;
use super::built::Built;
use crate::case::{self, Multiplier};
use crate::errors::Diagnostic;
use crate::place::{Located, Place};
use crate::words::component_name;
use faying::basis::{Basis, Cell, Polynomials};
use faying::coupling::multiplier::{Ends, MultiplierError, MultiplierKind};
use faying::problem::{MakeMultiplier, Model, SideModel, wrapped};
use faying::space::Space;
use std::sync::OnceLock;

/// Returns what makes the multiplier space `wanted` by the case.
pub(super) fn multiplier<'a, const S: usize, const N: usize>(
    builder: &Builder<'a, S, N>,
    wanted: &Located<Multiplier>,
) -> Result<Box<MakeMultiplier<'a, S, N>>, Box<Diagnostic>> {
    let names = builder.names;
    match &wanted.value {
        Multiplier::Named(word) => match names.multipliers.get(word) {
            Ok(make) => Ok(Box::new(move |trace, constrained| make(trace, constrained))),
            Err(unknown) => Err(Box::new(builder.error("E064", unknown.to_string(), wanted.at))),
        },
        Multiplier::Data { degree, continuity, ends } => {
            let ends = match ends {
                case::Ends::Auto => Ends::Auto,
                case::Ends::Full => Ends::Full,
                case::Ends::Lowered => Ends::Lowered,
            };
            let kind = MultiplierKind::Uniform { degree: *degree, continuity: *continuity, ends };
            match &names.polynomials.0 {
                Some(make) => Ok(Box::new(move |trace, constrained| make(kind, trace, constrained))),
                None => Err(Box::new(builder.error("E019", "multipliers given by degree are not in this version here", wanted.at))),
            }
        }
        #[allow(unreachable_patterns)] // the enum may grow
        _ => Err(Box::new(builder.error("E019", "this multiplier is not in this version", wanted.at))),
    }
}

/// The multiplier of `make`, with a warning (E061) in `warning` if the first one that it makes is unstable.
pub(super) fn judged<'a, const S: usize, const N: usize>(
    builder: &'a Builder<'_, S, N>,
    model: &'a Model<S, N>,
    name: &'a str,
    slave: &'a SideModel<S, N>,
    wanted: &'a Located<Multiplier>,
    make: Box<MakeMultiplier<'a, S, N>>,
    warning: &'a OnceLock<Option<Diagnostic>>,
) -> Box<MakeMultiplier<'a, S, N>> {
    Box::new(move |trace, constrained| {
        let psi = wrapped(model, slave, constrained, make(trace, constrained)?);
        warning.get_or_init(|| unstable(builder, name, slave, wanted, &*psi));
        Ok(psi)
    })
}

/// Returns a warning (E061) if the multiplier `wanted` by the case, whose functions are `psi`, is unstable.
fn unstable<const S: usize, const N: usize>(
    builder: &Builder<'_, S, N>,
    name: &str,
    slave: &SideModel<S, N>,
    wanted: &Located<Multiplier>,
    psi: &dyn Basis<S>,
) -> Option<Diagnostic> {
    let text = match &wanted.value {
        Multiplier::Named(word) if word.parse::<MultiplierKind>().is_ok_and(|k| k.is_unstable()) => {
            format!("multiplier \"{word}\" of \"{name}\" is not stable; `faying infsup` shows it")
        }
        value => {
            let (degree, lowered) = by_another_name(value, &*slave.trace.space, psi)?;
            let word = match value {
                Multiplier::Named(word) => format!("\"{word}\""),
                _ => format!("of degree {}", degree - lowered),
            };
            format!(
                "multiplier {word} of \"{name}\" is p/p-{lowered} on this side of degree {degree}, which is not stable: its pressure \
                 oscillates; `faying infsup` shows it"
            )
        }
    };
    Some(builder.warning("E061", text, wanted.at).with_help(stable_help(slave)))
}

/// Returns the degree of the side and k, if `psi` is an unstable p/p-k of `space` by another name: constants, or a space given as data.
///
/// k = 1 is unstable on every side of tensor cells, k = 3, 5, ... on those of splines with one function per element: continuous
/// functions of degree 3 have bubbles enough for constants. On triangles p/p-1 is another space.
fn by_another_name<const S: usize, const N: usize>(
    wanted: &Multiplier,
    space: &dyn Space<S, N>,
    psi: &dyn Basis<S>,
) -> Option<(usize, usize)> {
    let is_tensor = S == 1 || (0..space.num_elements()).all(|e| space.cell(e) == Cell::Tensor);
    let could = matches!(wanted, Multiplier::Data { .. }) || matches!(wanted, Multiplier::Named(word) if word == "constant");
    if !is_tensor || !could {
        return None;
    }
    let least = |basis: &dyn Fn(usize) -> [usize; S]| (0..space.num_elements()).flat_map(basis).min();
    let degree = least(&|e| space.degree(e))?;
    let lowered = degree.checked_sub((0..space.num_elements()).flat_map(|e| psi.degree(e)).max()?)?;
    let smooth = || {
        let grow = |axis: &dyn Basis<1>| axis.num_functions() == axis.num_elements() + axis.degree(0)[0];
        space.structure().block(0).is_some_and(|b| b.axes.iter().all(|axis| grow(*axis)))
    };
    let unstable = lowered == 1 || (lowered % 2 == 1 && smooth());
    let same = space.polynomials(Polynomials::Lowered(lowered)).is_none_or(|named| named.num_functions() == psi.num_functions());
    (unstable && same).then_some((degree, lowered))
}

/// Whether p/p-2 exists on this side; p/p does on every side.
pub(super) fn has_lowered<const S: usize, const N: usize>(slave: &SideModel<S, N>) -> bool {
    let space = &*slave.trace.space;
    let least = (0..space.num_elements()).flat_map(|e| space.degree(e)).min();
    least >= Some(2) && space.polynomials(Polynomials::Lowered(2)).is_some()
}

/// A multiplier with positive functions that exists on this side.
pub(super) fn positive_help<const S: usize, const N: usize>(slave: &SideModel<S, N>) -> &'static str {
    if has_lowered(slave) { "write multiplier = \"p/p-2\"" } else { "write multiplier = \"p/p\"" }
}

/// The stable multipliers of this side, in place of an unstable one.
fn stable_help<const S: usize, const N: usize>(slave: &SideModel<S, N>) -> &'static str {
    if has_lowered(slave) { "use p/p or p/p-2" } else { "use p/p, or raise the degree of the slave" }
}

/// Builds the diagnostic of a multiplier that cannot be built.
pub(super) fn multiplier_fault<const S: usize, const N: usize>(
    builder: &Builder<'_, S, N>,
    name: &str,
    slave: &SideModel<S, N>,
    error: &MultiplierError,
    at: Place,
    components: usize,
) -> Diagnostic {
    let patch = slave.label.split('.').next().unwrap_or(&slave.label);
    match error {
        MultiplierError::NoDual { .. } => {
            builder.error("E064", format!("\"{name}\" on `{}`: {error}", slave.label), at).with_help(positive_help(slave))
        }
        MultiplierError::NothingLeft { .. } => builder
            .error("E024", format!("the multiplier of \"{name}\" on `{}` cannot be lowered at an end: {error}", slave.label), at)
            .with_help(format!(
                "give patch \"{patch}\" more elements along `{}`{}",
                slave.label,
                if has_lowered(slave) { ", or take p/p-2" } else { "" }
            )),
        MultiplierError::TooMany { component, multipliers, free } => builder
            .error(
                "E024",
                format!(
                    "the multiplier of \"{name}\" on `{}` is over-constrained: component {} has {multipliers} functions for {free} free unknowns",
                    slave.label,
                    component_name(*component, components)
                ),
                at,
            )
            .with_help(format!("give patch \"{patch}\" more elements along `{}`, or take a multiplier of lower degree", slave.label)),
        _ => builder.error("E064", format!("\"{name}\" on `{}`: {error}", slave.label), at),
    }
}

/// Help text for a side prescribed in one of `components` itself, naming the conditions; `None` if there are none.
pub(super) fn held_help<const S: usize, const N: usize>(
    model: &Built<S, N>,
    slave: &SideModel<S, N>,
    components: &[usize],
    slides: bool,
) -> Option<String> {
    let all = model.conditions.iter().zip(&model.sources.conditions);
    let mine = all.filter(|(c, _)| c.side.patch == slave.patch && c.side.side == slave.side);
    let mut places: Vec<String> = mine
        .filter(|(c, _)| components.contains(&c.component))
        .map(|(c, at)| {
            let line = at.in_file().map_or(String::new(), |(line, _)| format!(" (line {line})"));
            format!("component {} by `fix` or `dirichlet`{line}", component_name(c.component, model.components))
        })
        .collect();
    places.dedup();
    if places.is_empty() && slides && model.supports.iter().any(|s| s.patch == slave.patch && s.side == slave.side) {
        places.push("by fix = [\"normal\"] or fix = [\"tangential\"]".into());
    }
    (!places.is_empty()).then(|| {
        format!("`{}` is prescribed itself: {}; drop that condition, or let another side be the slave", slave.label, places.join(", "))
    })
}
