//! Unknowns that supports eliminate.

use super::model::{Model, Value};
use super::prescribed::Conditions;
use crate::assembly::DirichletError;

/// Prescribed values that contradict each other or do not exist at a time.
#[derive(Clone, Debug)]
pub struct Conflict {
    /// The error.
    pub error: DirichletError,
    /// The conditions that have it.
    pub conditions: Conditions,
    /// The time.
    pub t: f64,
    /// Whether values change with the time.
    pub changes: bool,
}

/// Unknowns eliminated by supports.
#[derive(Clone, Debug)]
pub struct Fixed {
    taken: Vec<bool>,
}

impl Fixed {
    /// The unknowns of `model` that are prescribed or bound by an equation; values are found at all `times` if they change, else at the
    /// first.
    ///
    /// # Errors
    /// [`Conflict`] at the first time that has one.
    pub fn of<const S: usize, const N: usize>(model: &Model<S, N>, times: &[f64]) -> Result<Self, Box<Conflict>> {
        let mut taken = vec![false; model.unknowns];
        let values = model.conditions.iter().map(|c| &c.value).chain(model.pins.iter().map(|p| &p.value));
        let changes = values.into_iter().any(|value| match value {
            Value::Zero => false,
            Value::Exact => model.exact.as_ref().is_some_and(|e| e.depends_on_time()),
            Value::Data(f) => f.depends_on_time(),
        });
        let times = if changes { times } else { &times[..times.len().min(1)] };
        // values that contradict each other at a later time are reported now, too
        for &t in times {
            let prescribed = model.prescribed(t).map_err(|e| Conflict { error: e.0, conditions: e.1, t, changes })?;
            prescribed.iter().for_each(|&(unknown, _)| taken[unknown] = true);
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
