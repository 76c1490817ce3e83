//! Multiplier spaces named or given by the case, and their diagnostics.

use super::boundary::component_name;
use super::{Builder, Built};
use crate::case::{self, Multiplier};
use crate::errors::Diagnostic;
use crate::place::{Located, Place};
use faying::basis::{Basis, Cell, Extracted, Order, Polynomials, ShapeTable};
use faying::coupling::multiplier::{Ends, MultiplierError, MultiplierKind};
use faying::linalg::Vector;
use faying::problem::{Model, SideModel};
use faying::space::Space;
use std::collections::{BTreeMap, HashMap, HashSet};

/// Builds the multiplier space `wanted` by the case; also returns a warning (E061) if it is unstable.
#[allow(clippy::type_complexity)]
pub(super) fn multiplier<const S: usize, const N: usize>(
    builder: &Builder<'_, S, N>,
    model: &Model<S, N>,
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
                    warning = Some(builder.warning("E061", text, wanted.at).with_help(stable_help(slave)));
                }
                make(&slave.trace, constrained)
            }
            Err(unknown) => return Err(Box::new(builder.error("E064", unknown.to_string(), wanted.at))),
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
    let made = made.map(|psi| wrapped(model, slave, constrained, psi));
    if let (Ok(psi), None) = (&made, &warning)
        && let Some((degree, lowered)) = by_another_name(&wanted.value, &*slave.trace.space, &**psi)
    {
        let word = match &wanted.value {
            Multiplier::Named(word) => format!("\"{word}\""),
            _ => format!("of degree {}", degree - lowered),
        };
        let text = format!(
            "multiplier {word} of \"{name}\" is p/p-{lowered} on this side of degree {degree}, which is not stable: its pressure oscillates; \
             `faying infsup` shows it"
        );
        warning = Some(builder.warning("E061", text, wanted.at).with_help(stable_help(slave)));
    }
    made.map(|psi| (psi, warning)).map_err(|e| {
        let mut fault = multiplier_fault(builder, name, slave, &e, wanted.at, N.max(2));
        if let (MultiplierError::NothingLeft { .. }, Some(c)) = (&e, component) {
            fault.message = format!("{} (component {})", fault.message, component_name(c, 2));
        }
        Box::new(fault)
    })
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

/// Function values below this count as zero.
const NO_VALUE: f64 = 1e-10;

/// Returns `psi` on a side that is glued to itself: its functions that belong to one function of the trace where the side closes become
/// one. Multipliers with as many functions as the closed trace, or fewer, have no end there and stay as they are. A multiplier numbered
/// like the trace follows the numbers of the trace; of any other, functions that are the only nonzero ones at a corner are matched.
pub(super) fn wrapped<const S: usize, const N: usize>(
    model: &Model<S, N>,
    slave: &SideModel<S, N>,
    constrained: &dyn Fn(usize) -> bool,
    psi: Box<dyn Basis<S>>,
) -> Box<dyn Basis<S>> {
    let space = &*slave.trace.space;
    let whole: HashSet<usize> = slave.trace.dofs.iter().map(|&dof| model.function(slave.patch, dof)).collect();
    if whole.len() == slave.trace.dofs.len() || psi.num_functions() <= whole.len() {
        return psi;
    }
    let (mut ids, mut others, mut table) = (Vec::new(), Vec::new(), ShapeTable::new());
    let numbered_alike = psi.num_functions() == space.num_functions()
        && (0..space.num_elements()).all(|element| {
            space.active(element, &mut ids);
            psi.active(element, &mut others);
            ids == others
        });
    let mut alone = |basis: &dyn Basis<S>, element: usize, corner: &Vector<S>| {
        basis.active(element, &mut ids);
        basis.tabulate(element, std::slice::from_ref(corner), Order::Values, &mut table);
        let mut there = ids.iter().zip(table.values(0)).filter(|(_, value)| value.abs() > NO_VALUE).map(|(&i, _)| i);
        there.next().filter(|_| there.next().is_none())
    };
    // the multiplier of a function of the model, if both are the only nonzero ones at a corner
    let mut first: HashMap<usize, usize> = HashMap::new();
    let mut twin: BTreeMap<usize, usize> = BTreeMap::new();
    for element in 0..space.num_elements() {
        for k in 0..1usize << S {
            let corner = Vector::<S>::from_fn(|d, _| f64::from(u8::from(k >> d & 1 == 1)));
            let Some(i) = alone(&space, element, &corner).filter(|&i| !constrained(slave.trace.dofs[i])) else { continue };
            let Some(j) = Some(i).filter(|_| numbered_alike).or_else(|| alone(&*psi, element, &corner)) else { continue };
            let one = *first.entry(model.function(slave.patch, slave.trace.dofs[i])).or_insert(j);
            if one != j {
                twin.insert(j, one);
            }
        }
    }
    let mut next = 0;
    let mut number = vec![0; psi.num_functions()];
    for (j, n) in number.iter_mut().enumerate() {
        if !twin.contains_key(&j) {
            *n = next;
            next += 1;
        }
    }
    let rows = (0..number.len()).map(|j| vec![(number[*twin.get(&j).unwrap_or(&j)], 1.0)]).collect();
    if twin.is_empty() { psi } else { Box::new(Extracted::new::<S>(psi, next, rows)) }
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
