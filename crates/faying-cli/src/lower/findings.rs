//! Sentences of what a search for touching sides finds, and of its errors.

use super::lower_context::LowerContext;
use super::sides::{has_name, side_fault};
use crate::case::{Physics, SideRef, Tie};
use crate::errors::Diagnostic;
use crate::place::{Located, SourceSpan};
use crate::text_format::{labels, place, short};
use faying::problem::SideView;
use faying::problem::touching::{Finding, NEAR, NearPair, Position, Search, THIN, TouchError};
use faying::space::Clearance;

/// Most pairs of unjoined sides that are named.
const NAMED: usize = 8;
/// Advice for sides that are not tied.
const TIE: &str = "if they are meant to be tied, name slave and master of an [[interface]], or give `tolerance`";

/// Builds the diagnostic of a search that fails; `interface` is the name of the one it is for.
pub(super) fn fault<const S: usize, const N: usize>(
    context: &LowerContext<'_, S, N>,
    search: &Search<'_, S, N>,
    error: &TouchError<S, N>,
    interface: &str,
    at: SourceSpan,
) -> Diagnostic {
    match error {
        TouchError::Side { patch, side, error } => {
            side_fault(context, &search.body(*patch), error, &Located::new(SideRef { patch: *patch, side: side.clone() }, at))
        }
        TouchError::Nothing { nearest } => {
            let nearest = nearest.as_ref().map_or(String::new(), |pair| format!("; the nearest, {}", distance(pair)));
            let text = format!("no sides of the patches of interface \"{interface}\" touch each other that are not joined yet{nearest}");
            let help = "name slave and master, or raise `tolerance`; a list of patches parts those that a file or a mesh joins";
            context.error("E023", text, at).with_help(help)
        }
        other => {
            context.error("E023", other.to_string(), at).with_help("name slave and master, or give the touching part one tag of its own")
        }
    }
}

/// Builds the warning of a finding.
pub(super) fn warning<const S: usize, const N: usize>(
    context: &LowerContext<'_, S, N>,
    finding: &Finding<S, N>,
    at: SourceSpan,
) -> Diagnostic {
    let (text, help) = match finding {
        Finding::NotTied { sides: [a, b], clearance } => {
            (format!("`{}` and `{}` are {}. They are not tied", a.label(), b.label(), apart(clearance)), TIE.to_owned())
        }
        Finding::NotExplained { slave, masters, clearance } => (
            format!("`{}` and {} are {}. They are tied because they are named", slave.label(), labels(masters), apart(clearance)),
            "move the bodies together, refine the sides, or write `tolerance` if they are meant to be tied so".to_owned(),
        ),
        Finding::Near(pair) => (
            format!("{}, less than {NEAR} of their facets and {THIN} of the bodies behind them. They are not tied", distance(pair)),
            TIE.to_owned(),
        ),
        Finding::Unjoined { sides: [a, b], position } => {
            let how = match position {
                Position::Touch if a.body() == b.body() => "coincide".to_owned(),
                Position::Touch => "touch".to_owned(),
                Position::Apart(d) => format!("are {} apart", short(*d)),
                Position::Overlap(d) => format!("are {} deep in each other", short(*d)),
            };
            (format!("`{}` and `{}` {how}, and nothing joins them", a.label(), b.label()), joining(context, a, b))
        }
        Finding::Overlap { patches, x } => {
            let [a, b] = patches.map(|k| &context.case.patches[k].name.value);
            (
                format!("patches \"{a}\" and \"{b}\" overlap (at {}), and nothing joins them", place(x.as_slice())),
                "move them apart, join sides that touch by [[interface]], or press them together by [[contact]]".to_owned(),
            )
        }
    };
    context.warning("E023", text, at).with_help(help)
}

/// Warns of sides and patches that nothing joins, at their patches; beyond [`NAMED`] pairs of sides are counted.
pub(super) fn unjoined<const S: usize, const N: usize>(context: &mut LowerContext<'_, S, N>, found: &[Finding<S, N>]) {
    let case = context.case;
    let pairs = found.iter().take_while(|f| matches!(f, Finding::Unjoined { .. })).count();
    let tell = |context: &mut LowerContext<'_, S, N>, list: &[Finding<S, N>]| {
        for finding in list {
            let warning = warning(context, finding, case.patches[finding.patches()[1]].head.at);
            context.faults.push(warning);
        }
    };
    tell(context, &found[..pairs.min(NAMED)]);
    if pairs > NAMED {
        let text = format!("{} more pairs of sides touch or nearly touch, and nothing joins them", pairs - NAMED);
        let at = case.patches.first().map_or_else(Default::default, |p| p.head.at);
        context.faults.push(context.warning("E023", text, at).with_help("[[interface]] with between = \"all\" ties all that touch"));
    }
    tell(context, &found[pairs..]);
}

/// "on average 0.01 apart (at most 0.02); faceting would explain 0.001".
fn apart(c: &Clearance) -> String {
    let [mean, greatest, allowed] = [c.mean(), c.greatest, c.allowed()].map(short);
    format!("on average {mean} apart (at most {greatest}); faceting would explain {allowed}")
}

/// "`a.top` and `b.bottom` are 0.001 apart".
fn distance<const S: usize, const N: usize>(pair: &NearPair<S, N>) -> String {
    let word = if pair.facing.gap < 0.0 { "deep in each other" } else { "apart" };
    format!("`{}` and `{}` are {} {word}", pair.sides[0].label(), pair.sides[1].label(), short(pair.facing.distance))
}

/// The line that joins two sides.
fn joining<const S: usize, const N: usize>(context: &LowerContext<'_, S, N>, a: &SideView<S, N>, b: &SideView<S, N>) -> String {
    let case = context.case;
    if a.body() == b.body() {
        let (axis, patch) = (&a.name()[..1], &case.patches[a.body()].name.value);
        return format!(
            "write closed = \"{axis}\" in patch \"{patch}\" to make a ring of it; name both in [[boundary]] if they are to be open"
        );
    }
    let tie = if [a, b].iter().all(|side| has_name(case, side.body(), side.name()) && !side.label().contains(" where ")) {
        format!("[[interface]] with slave = \"{}\" and master = \"{}\"", b.label(), a.label())
    } else {
        let names = [a, b].map(|side| case.patches[side.body()].name.value.as_str());
        let is_joined = |tie: &Tie| {
            tie.between.as_ref().is_some_and(|list| names.iter().all(|name| list.value.iter().any(|n| n == "all" || n == name)))
        };
        if case.interfaces.iter().any(is_joined) {
            "[[interface]] with that part, by a tag of its own or by `where`,".to_owned()
        } else {
            format!("[[interface]] with between = [\"{}\", \"{}\"]", names[0], names[1])
        }
    };
    if case.model.physics.value == Physics::Poisson {
        format!("write {tie} to tie them; name one in [[boundary]] if they are to be apart")
    } else {
        format!("write {tie} to tie them, or [[contact]] with these to let them part; name one in [[boundary]] if they are to be apart")
    }
}
