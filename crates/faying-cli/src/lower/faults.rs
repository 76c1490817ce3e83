//! Diagnostics for what a problem refuses.

use super::glue;
use super::lower_context::LowerContext;
use super::places::Places;
use super::refused::slave_fault;
use crate::errors::{Diagnostic, Diagnostics};
use crate::place::SourceSpan;
use crate::text_format::{component_name, coordinates, place, short, time_text};
use faying::assembly::DirichletError;
use faying::linalg::LinearError;
use faying::problem::{ErrorKind, Problem, ProblemError, ProblemErrors, RevolutionError};

/// One diagnostic per error of a problem.
pub(super) fn refused<const S: usize, const N: usize>(
    context: &LowerContext<'_, S, N>,
    problem: &Problem<S, N>,
    places: &Places,
    errors: &ProblemErrors,
) -> Vec<Diagnostic> {
    let one = |error: &ProblemError| match (&error.kind, error.of.last()) {
        (ErrorKind::Interface { slave, error: of_slave }, Some(of)) => slave_fault(context, (problem, places), *of, *slave, of_slave),
        _ => None,
    };
    errors.0.iter().map(|error| one(error).unwrap_or_else(|| fault(context, places, error))).collect()
}

/// The faults so far and those of `errors`.
pub(super) fn all<const S: usize, const N: usize>(
    context: &mut LowerContext<'_, S, N>,
    problem: &Problem<S, N>,
    places: &Places,
    errors: &ProblemErrors,
) -> Diagnostics {
    let found = refused(context, problem, places, errors);
    context.faults.items.extend(found);
    std::mem::take(&mut context.faults)
}

/// Returns the context's faults as `Err` if there is an error among them, with those of the bodies, loads and joints of the problem.
pub(super) fn stop<const S: usize, const N: usize>(
    context: &mut LowerContext<'_, S, N>,
    problem: &Problem<S, N>,
    places: &Places,
) -> Result<(), Diagnostics> {
    if !context.faults.has_errors() {
        return Ok(());
    }
    Err(match problem.check() {
        Ok(_) => std::mem::take(&mut context.faults),
        Err(errors) => all(context, problem, places, &errors),
    })
}

/// The diagnostic of data that are not finite, too large, or negative where they must not be.
fn data_fault<const S: usize, const N: usize>(
    context: &LowerContext<'_, S, N>,
    places: &Places,
    error: &ProblemError,
    at: SourceSpan,
) -> Diagnostic {
    let (code, x, t, value, component) = match &error.kind {
        ErrorKind::Negative { x, t, value, component } => ("E015", x, t, value, component),
        ErrorKind::TooLarge { x, t, value, component } => ("E015", x, t, value, component),
        ErrorKind::NotFinite { x, t, value, component } => ("E017", x, t, value, component),
        _ => return context.error("E015", error.to_string(), at),
    };
    let said = error.of.first().and_then(|of| places.said(*of));
    let Some((what, formula)) = said.and_then(|s| Some((s.what, s.formulas.get(*component).or(s.formulas.first())?))) else {
        return context.error(code, error.to_string(), at);
    };
    let x = place(&x[..N]) + &time_text(formula.value.depends_on_time(), *t);
    if matches!(error.kind, ErrorKind::Negative { .. }) {
        let text = format!("{what} of `{}` must not be negative, found {value:?} at {x}", error.names()[1]);
        return context.error(code, text, formula.at).with_help(
            "a spring or a foundation pulls back with the force stiffness times displacement, and weight is density times gravity: they are positive",
        );
    }
    let of = match error.of.iter().find_map(|of| places.patch(*of)) {
        Some(number) => format!("{what} in patch \"{}\"", context.case.patches[number].name.value),
        None => format!("{what} of `{}`", error.names()[1]),
    };
    if matches!(error.kind, ErrorKind::TooLarge { .. }) {
        let text = format!("{of} is too large at {x}: the square of {value:e} overflows");
        return context.error(code, text, formula.at).with_help("look for an exponent that slipped, or choose units of middling numbers");
    }
    let text = format!("{of}: `{}` is not finite at {x} (found {value})", formula.value.text());
    let help = "data are needed on the whole side or patch: give a formula that has a value at each of its points";
    context.error(code, text, formula.at).with_help(help)
}

/// The diagnostic of an error.
fn fault<const S: usize, const N: usize>(context: &LowerContext<'_, S, N>, places: &Places, error: &ProblemError) -> Diagnostic {
    let (case, components) = (context.case, context.case.model.components());
    let said = |k: usize| error.of.get(k).and_then(|of| places.said(*of));
    let at = error.of.last().map(|of| places.at(*of)).unwrap_or_default();
    let patch = || error.of.iter().find_map(|of| places.patch(*of));
    match &error.kind {
        ErrorKind::OutOfLimits { error: limit, x, t } => {
            let Some(number) = patch() else { return context.error("E053", error.to_string(), at) };
            let (patch, material) = (&case.patches[number].name.value, &case.materials[case.patches[number].material.value]);
            let x = place(&x[..N]) + &time_text(material.changes(), *t);
            let text = format!("material \"{}\" in patch \"{patch}\", at {x}: {limit}", material.name.value);
            context
                .error("E053", text, material.place_of(limit))
                .with_help("formulas of materials are checked at the quadrature points of the patches that use them")
        }
        ErrorKind::NotFinite { .. } | ErrorKind::TooLarge { .. } | ErrorKind::Negative { .. } => {
            data_fault::<S, N>(context, places, error, at)
        }
        ErrorKind::Faceted => context.error("E015", error.to_string(), at).with_help(
            "write mapping = \"exact\" or backend = \"iga\" in the patch, or prescribe components x, y, z; meshes of files have facets",
        ),
        ErrorKind::Slide(_) => context.error("E024", error.to_string(), at).with_help("refine the side, or fix all of its components"),
        ErrorKind::Glue(of_sides) => glue::fault(context, at, error.names(), of_sides),
        ErrorKind::SlaveTwice => {
            let first = said(0).and_then(|s| s.at.in_file()).map_or(String::new(), |(line, _)| format!(": in line {line} already"));
            let (slave, other) = (&error.names()[0], &error.names()[1]);
            let other = if slave == other { String::new() } else { format!(", with `{other}`") };
            let text = format!("`{slave}` has facets that are slave twice{other}{first}");
            let is_found = case.interfaces.iter().any(|tie| tie.between.is_some());
            context.error("E026", text, at).with_help(if is_found {
                "name slaves and masters in place of `between`, with tags that have no facets in common and `where` that end where others begin"
            } else {
                "let the `where` of one end where that of the other begins: facets count by their centres; of tags of a mesh name such as have no facets in common"
            })
        }
        ErrorKind::NoExact => {
            context.error("E062", "\"exact\" needs a manufactured solution; the case has none", at).with_help("give exact in [model]")
        }
        ErrorKind::ExactInPart => {
            let text = format!("patch \"{}\" has no `exact`, and patch \"{}\" has one", error.names()[1], error.names()[0]);
            context.error("E062", text, at).with_help("give `exact` in every patch, or in [model] for those that have none of their own")
        }
        ErrorKind::Prescribed { error: conflict, t, changes } => {
            let first = said(0).map(|s| s.at).unwrap_or_default();
            match conflict {
                DirichletError::Conflict { component, at: x, first_value, second_value, .. } => {
                    let name = component_name(*component, components);
                    let lines = first.in_file().map_or(String::new(), |(line, _)| format!(" (line {line})"));
                    let text = format!(
                        "component {name} is prescribed as {first_value}{lines} and as {second_value} at the common point ({}{})",
                        coordinates(&x[..N]),
                        time_text(*changes, *t)
                    );
                    context.error("E052", text, at).with_help("make the values equal there, or prescribe one of them")
                }
                DirichletError::Projection { source: LinearError::NotFinite, .. } => {
                    let text = format!("a prescribed value is not finite somewhere on its side{}", time_text(*changes, *t));
                    context.error("E017", text, at)
                }
                other => context.error("E072", other.to_string(), at),
            }
        }
        _ => held(context, places, error, at)
            .or_else(|| revolved(context, places, error, at))
            .unwrap_or_else(|| context.error("E015", error.to_string(), at)),
    }
}

/// The diagnostic of what is prescribed or held twice, or loaded and held.
fn held<const S: usize, const N: usize>(
    context: &LowerContext<'_, S, N>,
    places: &Places,
    error: &ProblemError,
    at: SourceSpan,
) -> Option<Diagnostic> {
    let name = |component: &usize| component_name(*component, context.case.model.components());
    let line = |k: usize, before: &str, after: &str| {
        let at = error.of.get(k).and_then(|of| places.said(*of)?.at.in_file());
        at.map_or(String::new(), |(line, _)| format!("{before}{line}{after}"))
    };
    let [own, other] = [0, 1].map(|k| error.names().get(k).map_or("?", String::as_str));
    let (text, help) = match &error.kind {
        ErrorKind::Twice { component } => {
            let first = line(0, ", first in line ", "");
            (format!("component {} of `{own}` is prescribed twice{first}", name(component)), "drop one of the two")
        }
        ErrorKind::Held { component } => (
            format!(
                "component {} of `{own}` is loaded, and prescribed{} wherever the load acts",
                name(component),
                line(0, " in line ", "")
            ),
            "each component of a side is prescribed once, or loaded",
        ),
        ErrorKind::HeldAlong => (
            format!("what acts on `{own}` acts along directions that are held{} wherever it acts", line(0, " in line ", "")),
            "load directions that are free, or another side: supports alone would carry this",
        ),
        ErrorKind::HeldAsOne { component } => {
            let (name, line) = (name(component), line(0, " (line ", ")"));
            let text =
                format!("`{own}` moves as one along {name}, which `{other}`{line} prescribes in a part of it: the force has no effect");
            (text, "prescribe the component of the side itself, or leave it free where both sides meet")
        }
        ErrorKind::SlideBeside => {
            let text = format!("`{own}` is curved and slides, and `{other}`{} holds facets of it, too", line(0, " (line ", ")"));
            (text, "hold each facet of a curved side once: all components, its normals, or its tangents")
        }
        ErrorKind::Contradiction { defect, t, changes } => {
            let others = error.names().iter().skip(1).enumerate().map(|(k, name)| format!("`{name}`{}", line(k, " (line ", ")")));
            let (others, when, by) = (others.collect::<Vec<_>>().join(" and "), time_text(*changes, *t), short(*defect));
            let text = format!("the condition on `{own}` contradicts {others} where they meet, by {by}{when}");
            (text, "make the values agree in common points, or drop one of the conditions")
        }
        _ => return None,
    };
    Some(context.error("E052", text, at).with_help(help))
}

/// The diagnostic of what bodies of revolution cannot have.
fn revolved<const S: usize, const N: usize>(
    context: &LowerContext<'_, S, N>,
    places: &Places,
    error: &ProblemError,
    at: SourceSpan,
) -> Option<Diagnostic> {
    let name = error.names().first()?;
    let (code, text, at, help) = match &error.kind {
        ErrorKind::Revolution(RevolutionError::BeyondAxis { x }) => {
            let number = error.of.iter().find_map(|of| places.patch(*of))?;
            let text = format!("patch \"{name}\" has points beyond the axis x = 0, such as {}", place(&x[..N]));
            let help = "x is the radius here: keep to x >= 0, half of the section is all of the body of revolution";
            ("E041", text, context.case.patches[number].geometry.at, help)
        }
        ErrorKind::Revolution(RevolutionError::OnAxis) => {
            let text = format!("`{name}` lies on the axis x = 0, where u.x is zero and areas are");
            ("E015", text, at, "leave it out: u.x is held there without a word, and u.y is prescribed or free as elsewhere")
        }
        ErrorKind::Revolution(RevolutionError::RadialForce) => {
            let text = format!("a force presses the obstacle of contact \"{name}\" along x, the radius");
            ("E015", text, at, "bodies of revolution move along y alone; `move` takes x, as for a mandrel that opens")
        }
        _ => return None,
    };
    Some(context.error(code, text, at).with_help(help))
}
