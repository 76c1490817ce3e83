//! Prescribed values at a given time, and the unknowns that supports eliminate.

use super::boundary::component_name;
use super::values::{time_text, times};
use super::{Builder, Built};
use crate::errors::Diagnostic;
use faying::assembly::DirichletError;
use faying::linalg::LinearError;
use faying::problem::{Conditions, Value};

/// Unknowns eliminated by supports.
#[derive(Clone, Debug)]
pub(super) struct Fixed {
    taken: Vec<bool>,
}

impl Fixed {
    /// The unknowns of `model` that are prescribed or bound by an equation.
    pub fn of<const S: usize, const N: usize>(builder: &Builder<'_, S, N>, model: &Built<S, N>) -> Result<Self, Box<Diagnostic>> {
        let mut taken = vec![false; model.unknowns];
        let changes = model.conditions.iter().any(|c| match &c.value {
            Value::Zero => false,
            Value::Exact => builder.case.model.exact.iter().flat_map(|e| &e.value).any(|f| f.depends_on_time()),
            Value::Data(f) => f.depends_on_time(),
        });
        // values that contradict each other at a later time are reported now, too
        for &t in times(builder.case, changes) {
            for (unknown, _) in model.prescribed(t).map_err(|e| conflict(builder, model, &e.0, e.1, &time_text(changes, t)))? {
                taken[unknown] = true;
            }
        }
        for equation in &model.equations {
            // the reduction binds the unknown with the largest coefficient that is still free
            let free = equation.terms.iter().map(|&(i, c)| (model.glued.unknown(i), c)).filter(|(i, _)| !taken[*i]);
            if let Some((i, _)) = free.fold(None, |best: Option<(usize, f64)>, t| best.filter(|b| b.1.abs() >= t.1.abs()).or(Some(t))) {
                taken[i] = true;
            }
        }
        // a function glued to a held function is held
        for i in 0..model.unknowns {
            taken[i] = taken[model.glued.unknown(i)];
        }
        for (a, terms) in model.glued.combined() {
            for c in 0..model.components {
                taken[model.components * a + c] |= terms.iter().all(|&(b, _)| taken[model.components * b + c]);
            }
        }
        Ok(Self { taken })
    }

    /// Whether `unknown` is eliminated.
    pub fn is(&self, unknown: usize) -> bool {
        self.taken[unknown]
    }
}

/// E052 for values that disagree, E017 for values that are not finite.
fn conflict<const S: usize, const N: usize>(
    builder: &Builder<'_, S, N>,
    model: &Built<S, N>,
    error: &DirichletError,
    conditions: Conditions,
    time: &str,
) -> Diagnostic {
    let (first, second) = conditions.map(|(a, b)| (model.sources.of(a), model.sources.of(b))).unwrap_or_default();
    match error {
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
