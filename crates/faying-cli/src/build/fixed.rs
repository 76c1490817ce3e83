//! Prescribed values at a given time, and the unknowns that supports eliminate.

use super::builder::Builder;
use super::built::Built;
use super::values::{time_text, times};
use crate::errors::Diagnostic;
use crate::words::component_name;
use faying::assembly::DirichletError;
use faying::linalg::LinearError;
use faying::problem::{Conflict, Fixed};

/// The unknowns of `model` that are prescribed or bound by an equation.
pub(super) fn fixed<const S: usize, const N: usize>(builder: &Builder<'_, S, N>, model: &Built<S, N>) -> Result<Fixed, Box<Diagnostic>> {
    Fixed::of(model, times(builder.case, true)).map_err(|c| Box::new(conflict(builder, model, &c)))
}

/// E052 for values that disagree, E017 for values that are not finite.
fn conflict<const S: usize, const N: usize>(builder: &Builder<'_, S, N>, model: &Built<S, N>, conflict: &Conflict) -> Diagnostic {
    let time = time_text(conflict.changes, conflict.t);
    let (first, second) = conflict.conditions.map(|(a, b)| (model.sources.of(a), model.sources.of(b))).unwrap_or_default();
    match &conflict.error {
        DirichletError::Conflict { component, at, first_value, second_value, .. } => {
            let name = component_name(*component, model.components);
            let place: Vec<String> = at[..N].iter().map(|x| format!("{x}")).collect();
            let lines = first.in_file().map_or(String::new(), |(line, _)| format!(" (line {line})"));
            builder
                .error(
                    "E052",
                    format!(
                        "component {name} is prescribed as {first_value}{lines} and as {second_value} at the common point ({}{time})",
                        place.join(", ")
                    ),
                    second,
                )
                .with_help("make the values equal there, or prescribe one of them")
        }
        DirichletError::Projection { source: LinearError::NotFinite, .. } => {
            builder.error("E017", format!("a prescribed value is not finite somewhere on its side{time}"), second)
        }
        other => builder.error("E072", other.to_string(), second),
    }
}
