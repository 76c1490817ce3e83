//! Memory that a run takes, forecast before anything is assembled.

use super::model::Model;
use super::sizes::Sizes;

/// Forecast sizes of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Forecast {
    /// Entries of the stiffness.
    pub entries: u64,
    /// Entries of its factor, within a factor of about 1.5.
    pub factor: u64,
    /// Peak memory in bytes, [`PROGRAM`](Self::PROGRAM) included.
    pub memory: u64,
}

/// Bytes per entry of the factor, the largest front included.
const BYTES_PER_FACTOR: f64 = 8.5;
/// Bytes per unknown of a step that is kept: the solution and the support forces.
const BYTES_PER_STATE: f64 = 16.0;
/// Bytes per entry for the comparison with a second matrix of a pattern: half of the values.
const BYTES_TO_COMPARE: f64 = 4.0;

impl Forecast {
    /// Bytes of a program that does nothing yet.
    pub const PROGRAM: u64 = 20_000_000;
}

impl Sizes {
    /// The forecast of a run of one step; values that do not fit into 64 bits saturate.
    pub fn forecast(&self) -> Forecast {
        let memory = Forecast::PROGRAM as f64 + self.matrices + BYTES_PER_FACTOR * self.factor + self.beside + self.other;
        Forecast { entries: self.entries as u64, factor: self.factor as u64, memory: memory as u64 }
    }
}

impl<const S: usize, const N: usize> Model<S, N> {
    /// The forecast of a run of a number of `steps`, whose states are kept; `factor`: whether a factor is computed.
    pub(super) fn forecast(&self, factor: bool, steps: usize) -> Forecast {
        let mut all = Sizes { unknowns: self.rows as f64, ..Sizes::default() };
        let mut held = vec![false; self.unknowns];
        for condition in &self.conditions {
            let (trace, field) = (&condition.side.trace, self.patches[condition.side.patch].field);
            for &dof in &trace.dofs {
                held[field.first + field.components * dof + condition.component] = true;
            }
        }
        for patch in &self.patches {
            let unknowns = patch.num_unknowns();
            let free = held[patch.range()].iter().filter(|h| !**h).count();
            all = all.and(&Sizes::of_space::<N>(&**patch.body.space(), patch.field.components, free as f64 / unknowns.max(1) as f64));
        }
        // ties without rows: entries between the bodies, and twice the factor where the matrix is not symmetric
        for part in self.ties.iter().flat_map(|tie| &tie.parts).filter(|part| !part.stiffness.entries.is_empty()) {
            all.add_entries(part.stiffness.entries.len() as f64);
        }
        for part in self.contacts.iter().flat_map(|c| &c.parts) {
            let points = part.first.stiffness.as_ref().map_or(0, |stiffness| stiffness.entries.len());
            all.add_entries((points + part.first.rows.slave.entries.len() + part.first.rows.master.entries.len()) as f64);
        }
        all.add_entries(self.slides.iter().map(|part| part.rows.entries.len()).sum::<usize>() as f64);
        if factor {
            let parts = self.contacts.iter().flat_map(|c| &c.parts);
            all.add_interface(parts.map(|part| part.first.rows.slave.rows).sum::<usize>() as f64);
        }
        if steps > 1 || !self.contacts.is_empty() {
            all.matrices += BYTES_TO_COMPARE * all.entries;
        }
        let mut forecast = if factor { all } else { all.without_factor() }.forecast();
        let kept = BYTES_PER_STATE * (self.unknowns + self.rows) as f64 * steps.saturating_sub(1) as f64;
        forecast.memory = (forecast.memory as f64 + kept) as u64;
        forecast
    }
}
