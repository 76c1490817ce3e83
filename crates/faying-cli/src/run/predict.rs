//! Memory that a run of a model will take, predicted before anything is assembled.

use super::need::Need;
use faying::problem::Model;
use serde::Serialize;

/// Predicted sizes of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Prediction {
    /// Entries of the stiffness.
    pub entries: u64,
    /// Entries of its factor, within a factor of about 1.5.
    pub factor: u64,
    /// Peak memory in bytes.
    pub memory: u64,
}

/// Bytes per entry of the factor, the largest front included.
const BYTES_PER_FACTOR: f64 = 8.5;
/// Bytes of the program itself.
pub(super) const PROGRAM: f64 = 2e7;

/// Bytes per unknown of a step that is kept: the solution and the support forces.
const BYTES_PER_STATE: f64 = 16.0;
/// Bytes per entry for the comparison with a second matrix of a pattern: half of the values.
const BYTES_TO_COMPARE: f64 = 4.0;

impl Need {
    /// Computes the prediction; values that do not fit into 64 bits saturate.
    pub(super) fn prediction(&self) -> Prediction {
        let memory = PROGRAM + self.matrices + BYTES_PER_FACTOR * self.factor + self.beside + self.other;
        Prediction { entries: self.entries as u64, factor: self.factor as u64, memory: memory as u64 }
    }
}

/// Predicts the need of `model` in a number of steps, whose states are kept for the files; `factor`: whether a factor is computed.
pub fn predict<const S: usize, const N: usize>(model: &Model<S, N>, steps: usize, factor: bool) -> Prediction {
    let mut all = Need { unknowns: model.rows as f64, ..Need::default() };
    let mut held = vec![false; model.unknowns];
    for condition in &model.conditions {
        let (trace, field) = (&condition.side.trace, model.patches[condition.side.patch].field);
        for &dof in &trace.dofs {
            held[field.first + field.components * dof + condition.component] = true;
        }
    }
    for patch in &model.patches {
        let unknowns = patch.num_unknowns();
        let free = held[patch.range()].iter().filter(|h| !**h).count();
        all = all.and(&Need::of_space::<N>(&**patch.body.space(), patch.field.components, free as f64 / unknowns.max(1) as f64));
    }
    // ties without rows: entries between the bodies, and twice the factor where the matrix is not symmetric
    for part in model.ties.iter().flat_map(|tie| &tie.parts).filter(|part| !part.stiffness.entries.is_empty()) {
        all.add_entries(part.stiffness.entries.len() as f64);
    }
    for part in model.contacts.iter().flat_map(|c| &c.parts) {
        let points = part.first.points.as_ref().map_or(0, |p| p.stiffness.entries.len());
        all.add_entries((points + part.first.rows.slave.entries.len() + part.first.rows.master.entries.len()) as f64);
    }
    if factor {
        let parts = model.contacts.iter().flat_map(|c| &c.parts);
        all.add_interface(parts.map(|part| part.first.rows.slave.rows).sum::<usize>() as f64);
    }
    if steps > 1 || !model.contacts.is_empty() {
        all.matrices += BYTES_TO_COMPARE * all.entries;
    }
    let mut prediction = if factor { all } else { all.without_factor() }.prediction();
    let kept = BYTES_PER_STATE * (model.unknowns + model.rows) as f64 * steps.saturating_sub(1) as f64;
    prediction.memory = (prediction.memory as f64 + kept) as u64;
    prediction
}

/// Formats a number of bytes.
pub fn bytes(n: u64) -> String {
    let x = n as f64;
    if x >= 1e9 {
        format!("{:.1} GB", x / 1e9)
    } else if x >= 1e6 {
        format!("{:.0} MB", x / 1e6)
    } else {
        format!("{:.0} kB", x / 1e3)
    }
}
