//! Unknowns that supports eliminate.

use super::error::{ErrorKind, ProblemError};
use super::handles::Statement;
use super::model::{Model, Value};
use super::prescribed::Conditions;

/// Unknowns eliminated by supports.
#[derive(Clone, Debug)]
pub struct Eliminated {
    taken: Vec<bool>,
    prescribed: Vec<bool>,
}

impl Eliminated {
    /// The unknowns of `model` that are prescribed or bound by an equation; values are found at all `times` if they change, else at the
    /// first.
    ///
    /// # Errors
    /// [`ErrorKind::Prescribed`], [`ErrorKind::Contradiction`] at the first time that has one.
    pub fn of<const S: usize, const N: usize>(model: &Model<S, N>, times: &[f64]) -> Result<Self, ProblemError> {
        let mut taken = vec![false; model.unknowns];
        let (changes, times) = model.times_of_values(times);
        // values that contradict each other at a later time are reported now, too
        for &t in times {
            let prescribed = model.prescribed(t).map_err(|e| {
                let (error, conditions) = *e;
                ProblemError::new(ErrorKind::Prescribed { error, t, changes }, statements(model, conditions), Vec::new())
            })?;
            if let Some(error) = model.contradiction(&prescribed, t, changes) {
                return Err(error);
            }
            prescribed.iter().for_each(|&(unknown, _)| taken[unknown] = true);
        }
        let mut values = taken.clone();
        for equation in model.equations.iter().map(|e| &e.equation) {
            // the reduction binds the unknown with the largest coefficient that is still free
            let free = equation.terms.iter().map(|&(i, c)| (model.glued.unknown(i), c)).filter(|(i, _)| !taken[*i]);
            if let Some((i, _)) = free.fold(None, |best: Option<(usize, f64)>, t| best.filter(|b| b.1.abs() >= t.1.abs()).or(Some(t))) {
                taken[i] = true;
            }
        }
        // a function glued to a held function is held
        for held in [&mut taken, &mut values] {
            for i in 0..model.unknowns {
                held[i] = held[model.glued.unknown(i)];
            }
            for (a, terms) in model.glued.combined() {
                for c in 0..model.components {
                    held[model.components * a + c] |= terms.iter().all(|&(b, _)| held[model.components * b + c]);
                }
            }
        }
        Ok(Self { taken, prescribed: values })
    }

    /// Whether `unknown` has a prescribed value.
    pub fn is_prescribed(&self, unknown: usize) -> bool {
        self.prescribed[unknown]
    }

    /// Whether `unknown` is eliminated.
    pub fn is(&self, unknown: usize) -> bool {
        self.taken[unknown]
    }
}

impl<const S: usize, const N: usize> Model<S, N> {
    /// Whether prescribed values change with the time, and those of `times` at which they are to be checked: else the first.
    pub(super) fn times_of_values<'a>(&self, times: &'a [f64]) -> (bool, &'a [f64]) {
        let of_sides = self.conditions.iter().map(|c| (&c.value, c.side.patch));
        let changes = of_sides.chain(self.pins.iter().map(|p| (&p.value, p.rim.patch))).any(|(value, patch)| match value {
            Value::Zero => false,
            Value::Exact => self.patches[patch].exact.as_ref().is_some_and(|e| e.depends_on_time()),
            Value::Data(f) => f.depends_on_time(),
        });
        (changes, if changes { times } else { &times[..times.len().min(1)] })
    }
}

/// The statements of two conditions.
fn statements<const S: usize, const N: usize>(model: &Model<S, N>, conditions: Conditions) -> Vec<Statement> {
    let statement = |k: usize| {
        let of_pin = || model.pins.get(k - model.conditions.len()).map(|p| p.of);
        model.conditions.get(k).map(|c| c.of).or_else(of_pin)
    };
    conditions.iter().flat_map(|&(a, b)| [statement(a), statement(b)]).flatten().collect()
}
