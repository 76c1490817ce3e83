//! Multipliers by the words of the case, and what is wrong with them.

use super::Builder;
use super::boundary::component_name;
use super::model::{Model, SideModel};
use crate::basis::Basis;
use crate::coupling::multiplier::{Ends, MultiplierError, MultiplierKind};
use crate::io::case::{self, Multiplier};
use crate::io::errors::Diagnostic;
use crate::io::place::{Located, Place};

/// A multiplier by its words, and the warning it deserves.
#[allow(clippy::type_complexity)]
pub(super) fn multiplier<const S: usize, const N: usize>(
    builder: &Builder<'_, S, N>,
    name: &str,
    slave: &SideModel<S, N>,
    wanted: &Located<Multiplier>,
    constrained: &dyn Fn(usize) -> bool,
    component: Option<usize>,
) -> Result<(Box<dyn Basis<S>>, Option<Diagnostic>), Box<Diagnostic>> {
    let mut warning = None;
    let made = match &wanted.value {
        Multiplier::Named(word) => match builder.names.multipliers.get(word) {
            Ok(make) => {
                if word.parse::<MultiplierKind>().is_ok_and(|k| k.is_unstable()) {
                    let text = format!("multiplier \"{word}\" of \"{name}\" is not stable; `faying infsup` shows it");
                    warning = Some(builder.warning("E061", text, wanted.at).with_help("use p/p or p/p-2"));
                }
                make(&slave.trace, constrained)
            }
            Err(unknown) => match word.parse::<MultiplierKind>() {
                Err(e @ MultiplierError::NotYet { .. }) => Err(e),
                _ => return Err(Box::new(builder.error("E064", unknown.to_string(), wanted.at))),
            },
        },
        Multiplier::Data { degree, continuity, ends } => {
            let ends = match ends {
                case::Ends::Auto => Ends::Auto,
                case::Ends::Full => Ends::Full,
                case::Ends::Lowered => Ends::Lowered,
            };
            let kind = MultiplierKind::Uniform { degree: *degree, continuity: *continuity, ends };
            match &builder.names.polynomials.0 {
                Some(make) => make(kind, &slave.trace, constrained),
                None => return Err(Box::new(builder.error("E019", "multipliers given by degree are not in this version here", wanted.at))),
            }
        }
        #[allow(unreachable_patterns)] // the enum may grow
        _ => return Err(Box::new(builder.error("E019", "this multiplier is not in this version", wanted.at))),
    };
    made.map(|psi| (psi, warning)).map_err(|e| {
        let mut fault = multiplier_fault(builder, name, slave, &e, wanted.at, N.max(2));
        if let (MultiplierError::NothingLeft { .. }, Some(c)) = (&e, component) {
            fault.message = format!("{} (component {})", fault.message, component_name(c, 2));
        }
        Box::new(fault)
    })
}

/// The diagnostic of a multiplier that cannot be.
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
        MultiplierError::NotYet { .. } => builder.error("E019", error.to_string(), at),
        MultiplierError::NotHere { .. } | MultiplierError::Unknown { .. } => {
            builder.error("E064", format!("\"{name}\" on `{}`: {error}", slave.label), at)
        }
        MultiplierError::NothingLeft { .. } => builder
            .error("E024", format!("the multiplier of \"{name}\" on `{}` cannot be lowered at an end: {error}", slave.label), at)
            .with_help(format!("give patch \"{patch}\" more elements along `{}`, or take p/p-2", slave.label)),
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
    }
}

/// What to do about a side that is held itself in one of `components`: names the conditions; none where there is none.
pub(super) fn held_help<const S: usize, const N: usize>(
    model: &Model<S, N>,
    slave: &SideModel<S, N>,
    components: &[usize],
    slides: bool,
) -> Option<String> {
    let mine = model.conditions.iter().filter(|c| c.side.patch == slave.patch && c.side.side == slave.side);
    let mut places: Vec<String> = mine
        .filter(|c| components.contains(&c.component))
        .map(|c| {
            let line = c.at.in_file().map_or(String::new(), |(line, _)| format!(" (line {line})"));
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
