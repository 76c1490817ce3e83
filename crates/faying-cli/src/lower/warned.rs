//! Diagnostics of warnings that are found while a case is built.

use super::lower_context::LowerContext;
use super::places::Places;
use crate::case::alias;
use crate::errors::Diagnostic;
use crate::text_format::{component_name, coordinates, place, short, time_text};
use faying::problem::{Subject, SubjectKind, Warning};

/// Adds the diagnostics of warnings to the context's faults.
pub(super) fn tell<'w, const S: usize, const N: usize>(
    context: &mut LowerContext<'_, S, N>,
    places: &Places,
    found: impl Iterator<Item = &'w Warning>,
) {
    for warning in found {
        let diagnostic = match warning {
            Warning::CornerValues { of, sides: [a, b], component, values: [u, v], x, t } => {
                let line = places.at(of[0]).in_file().map_or(String::new(), |(line, _)| format!(" (line {line})"));
                let text = format!(
                    "component {} is prescribed as {} on `{a}`{line} and as {} on `{b}` at their common point ({}{}), where the bodies are \
                     tied: the interface has to carry the jump",
                    component_name(*component, context.case.components()),
                    short(*u),
                    short(*v),
                    coordinates(x),
                    time_text(context.case.steps.value.len() > 1, *t)
                );
                let warning = context.warning("E052", text, places.at(of[1]));
                Some(warning.with_help("make the values equal there, or prescribe one of them"))
            }
            Warning::Overlap { .. } => overlap(context, warning),
            Warning::TooFewFunctions { .. } => too_few_functions(context, warning),
            _ => None,
        };
        context.faults.items.extend(diagnostic);
    }
}

/// Help that names sides which face each other.
pub(super) fn meant<const S: usize, const N: usize>(context: &LowerContext<'_, S, N>, sides: &[(usize, String); 2]) -> String {
    let [a, b] = sides.each_ref().map(|(patch, side)| format!("{}.{}", context.case.patches[*patch].name.value, alias(side, N)));
    format!("their normals must oppose; `{a}` on `{b}` would face each other: were these meant?")
}

/// E023 of an overlap.
fn overlap<const S: usize, const N: usize>(context: &LowerContext<'_, S, N>, found: &Warning) -> Option<Diagnostic> {
    let Warning::Overlap { of, slave, masters, depth, x, by_formula, meant: better } = found else { return None };
    let contact = &context.case.contacts[of.number];
    let bodies: Vec<String> = masters.iter().map(|label| format!("`{label}`")).collect();
    let (opponent, help) = match bodies.as_slice() {
        [] => (
            format!("the obstacle of contact \"{}\"", of.name),
            "move the obstacle out of the body, or choose the side that faces it; what `move` prescribes may grow over [steps]",
        ),
        _ => (format!("the body of {}", bodies.join(", ")), "move the bodies apart, or choose the sides that face each other"),
    };
    let by = if *by_formula { " by the formula of `gap`" } else { "" };
    let text = format!("`{slave}` lies {} deep in {opponent}{by} (at {}): more than half of a body's thickness", short(*depth), place(x));
    let at = if *by_formula { contact.gap.at } else { contact.head.at };
    let fault = context.error("E023", text, at);
    Some(match better {
        Some(sides) => fault.with_help(meant(context, sides)),
        None if *by_formula => fault.with_help("`gap` is a length: g is the distance of the sides, \"g - 0.001\" a press fit"),
        None => fault.with_help(help),
    })
}

/// E024 of a multiplier with too few functions.
fn too_few_functions<const S: usize, const N: usize>(context: &LowerContext<'_, S, N>, found: &Warning) -> Option<Diagnostic> {
    let Warning::TooFewFunctions { of: Subject { kind, number, name }, slave, slave_body, functions, body, motions } = found else {
        return None;
    };
    let (along, at) = match kind {
        SubjectKind::Contact => (" along the normal", context.case.contacts[*number].multiplier.at),
        _ => (" per component", context.case.interfaces.iter().find(|t| t.name.value == *name)?.multiplier.at),
    };
    let closed = if context.case.contacts.is_empty() { "" } else { ", even with every contact closed" };
    let number = if *functions == 1 { "one function".to_string() } else { format!("{functions} functions") } + along;
    let text = format!(
        "the multiplier of \"{name}\" on `{slave}` has too few functions ({number}) to hold body \"{}\", which can still move: {}{closed}",
        body.name,
        motions.join(", ")
    );
    let help =
        format!("give patch \"{}\" more elements along `{slave}`, or take a multiplier with more functions, such as p/p", slave_body.name);
    Some(context.error("E024", text, at).with_help(help))
}
