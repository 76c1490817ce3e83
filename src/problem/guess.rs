//! Initial guess of the closed contact rows.

use super::model::{ContactModel, Model};
use super::start::Start;
use super::state::{NO_CONTACT, StepState};
use super::supports::floating;
use crate::constraint::RowKind;
use crate::coupling::Rows;

/// Gaps below this share of the lengths they come from count as zero.
const ZERO: f64 = 1e-12;

/// Initial guess row by row.
pub(super) struct Guess<'a, const S: usize, const N: usize> {
    model: &'a Model<S, N>,
    t: f64,
    before: Option<&'a StepState<S, N>>,
    /// Whether each row is closed.
    pub closed: Vec<bool>,
    /// Row and gap at rest of every facing row of a contact with `start = "auto"`.
    auto: Vec<(usize, f64)>,
}

impl<'a, const S: usize, const N: usize> Guess<'a, S, N> {
    /// Starts with all rows closed at time `t`; `before`: the step whose active rows are the guess.
    pub fn new(model: &'a Model<S, N>, t: f64, before: Option<&'a StepState<S, N>>) -> Self {
        Self { model, t, before, closed: vec![true; model.rows], auto: Vec::new() }
    }

    /// Round-off of a gap, as a fraction of the lengths it is computed from.
    fn rounding(&self) -> f64 {
        ZERO * self.model.size.max(self.model.center.norm())
    }

    /// Takes a row of `contact` with its offset and weight.
    pub fn take(&mut self, contact: &ContactModel<S, N>, row: usize, kind: RowKind, offset: f64, weight: f64) {
        if contact.start == Start::Auto && kind == RowKind::Contact {
            self.auto.push((row, offset / weight));
        }
        self.closed[row] = match self.known(row) {
            Some(active) => active,
            None => match contact.start {
                Start::All => true,
                Start::Gap => offset <= self.rounding() * weight.abs(),
                Start::Seed(seed) => {
                    // SplitMix64 of seed and row: the same on every machine
                    let mut z = seed.wrapping_add((row + 1) as u64).wrapping_mul(0x9E37_79B9_7F4A_7C15);
                    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
                    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
                    (z ^ (z >> 31)) & 1 == 1
                }
                // for `auto`, `close_nearest` decides
                _ => false,
            },
        };
    }

    /// Whether the step before had a row closed; none of rows that faced nothing.
    fn known(&self, row: usize) -> Option<bool> {
        self.before.filter(|b| b.sign_case[row] != NO_CONTACT).map(|b| b.active[row])
    }

    /// Closes rows for `start = "auto"`: the quarter of least gap at rest, with all of the same gap, and for every floating body that no
    /// other row holds those of its least gap.
    pub fn close_nearest(&mut self, rows: &Rows) {
        if self.auto.is_empty() {
            return;
        }
        let mut gaps: Vec<f64> = self.auto.iter().map(|r| r.1).collect();
        gaps.sort_by(f64::total_cmp);
        let most = gaps[gaps.len().div_ceil(4) - 1] + self.rounding();
        for &(row, gap) in &self.auto {
            if self.known(row).is_none() {
                self.closed[row] = gap <= most;
            }
        }
        if self.before.is_some() {
            return;
        }
        for body in floating(self.model, self.t) {
            let mut holds = vec![false; self.closed.len()];
            for &(row, unknown, _) in rows.slave.entries.iter().chain(&rows.master.entries) {
                holds[row] |= body.iter().any(|range| range.contains(&unknown));
            }
            let contacts = || self.model.contacts.iter().flat_map(|c| &c.parts).flat_map(|part| part.rows());
            if contacts().any(|row| holds[row] && self.closed[row]) {
                continue;
            }
            let least = self.auto.iter().filter(|r| holds[r.0]).fold(f64::INFINITY, |least, r| least.min(r.1)) + self.rounding();
            self.auto.iter().filter(|r| holds[r.0] && r.1 <= least).for_each(|r| self.closed[r.0] = true);
        }
    }
}
