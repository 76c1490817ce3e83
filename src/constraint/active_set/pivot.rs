//! Which state of the contact rows comes next, and what keeps an iteration from running in a circle.
//!
//! The nominal step changes all wrong rows at once: the primal-dual active set, which is block principal pivoting on the linear
//! complementarity problem of the rows. Where it visits a state twice, single wrong rows change, the one of least index first, until
//! fewer rows are wrong than ever before; then all change at once again. With a positive definite matrix of the rows both phases end:
//! the number of wrong rows falls with every cycle, and single exchanges of least index never repeat a state.
//!
//! Sources: Murty, Linear Algebra Appl. 9 (1974) 65-108 (least index); Judice, Pires, Comput. Oper. Res. 21 (1994) 587-596;
//! Portugal, Judice, Vicente, Math. Comp. 63 (1994) 625-643 (blocks with exchanges of least index between them).

use super::super::Cycle;
use super::forces::Forces;
use std::collections::HashMap;

/// A state to try, and the number of rows that change on the way to it.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Try {
    pub state: Vec<bool>,
    pub changed: usize,
    /// All rows closed, as no other step was possible.
    pub all: bool,
    /// All rows closed, to begin again.
    pub again: bool,
}

impl Try {
    pub fn new(state: Vec<bool>, changed: usize) -> Self {
        Self { state, changed, all: false, again: false }
    }
}

/// What follows a state.
#[derive(Debug)]
pub(super) enum Next {
    /// No row is wrong.
    Settled,
    /// States in the order in which to try them: the next where one is singular.
    Tries(Vec<Try>),
    /// Even single exchanges came back to a state: the matrix of the rows is not positive definite.
    Circle,
}

/// Steps that open more than they close before a first guess counts as one that closes far too much.
const PATIENCE: usize = 4;

/// A first guess that closes too much is reduced once, from all rows closed: pressures of a scattered guess say little.
///
/// Tension alone peels rows from the rim of a zone, in the plane a share of it per iteration, on graded meshes a few rows: with
/// 64 elements some twenty to fifty systems. While the guess is reduced, rows open, too, that press less than it takes to close their
/// gaps at rest; what opens too far closes again in one stroke, and where all of it does, the plain step is taken after all.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Reduction {
    /// In that many steps more opened than closed.
    Waits(usize),
    /// After [`PATIENCE`] such steps: all rows are closed.
    Begins,
    /// All rows were closed, and none closed again.
    Goes,
    /// Rows closed again, or there was no guess.
    Done,
}

impl Reduction {
    /// The state after a step; `opens`: more rows open than close.
    fn after(self, opens: bool, first: bool, state: &[bool], all: &[bool]) -> Self {
        match self {
            // no row closed: there was no guess
            Self::Waits(_) if first && !state.contains(&true) => Self::Done,
            Self::Waits(_) | Self::Begins if opens && state == all => Self::Goes,
            Self::Waits(steps) if opens && steps == PATIENCE => Self::Begins,
            Self::Waits(steps) => Self::Waits(steps + usize::from(opens)),
            Self::Goes if opens => Self::Goes,
            _ => Self::Done,
        }
    }
}

/// The memory of an iteration.
#[derive(Debug)]
pub(super) struct Pivot {
    /// All rows that can be closed.
    pub all: Vec<bool>,
    /// Whether one row changes at a time.
    single: bool,
    /// States since the last change between blocks and single exchanges, and when.
    visited: HashMap<Vec<bool>, usize>,
    /// All states so far.
    states: Vec<Vec<bool>>,
    /// Fewest wrong rows so far.
    fewest: usize,
    /// How far the reduction of a first guess has come.
    reduction: Reduction,
    /// Force that closes each row's gap at rest.
    at_rest: Vec<f64>,
    /// Where the plain step would have led when the guess was reduced last.
    plain: Option<Try>,
    /// Whether a state was ever all rows closed.
    seen_all: bool,
    /// The cycles found.
    pub cycles: Vec<Cycle>,
}

impl Pivot {
    pub fn new(all: Vec<bool>, at_rest: Vec<f64>) -> Self {
        let states = Vec::new();
        Self {
            all,
            single: false,
            visited: HashMap::new(),
            states,
            fewest: usize::MAX,
            reduction: Reduction::Waits(0),
            at_rest,
            plain: None,
            seen_all: false,
            cycles: Vec::new(),
        }
    }

    /// The states to try after `state`, the one of system `iteration`; `rows`: their numbers.
    pub fn next(&mut self, state: &[bool], forces: &Forces, c: f64, iteration: usize, rows: &[usize]) -> Next {
        let wrong = forces.wrong(c);
        self.states.push(state.to_vec());
        self.visited.insert(state.to_vec(), iteration);
        self.seen_all |= state == self.all;
        if wrong.is_empty() {
            return Next::Settled;
        }
        if self.single && wrong.len() < self.fewest {
            self.begin(false, state, iteration);
        }
        self.fewest = self.fewest.min(wrong.len());
        let opening = wrong.iter().filter(|&&k| state[k]).count();
        self.reduction = self.reduction.after(2 * opening > wrong.len(), iteration == 1, state, &self.all);
        let again = self.reduction == Reduction::Begins && !self.seen_all && !self.single;
        let mut tries = if self.single { self.exchanges(state, &wrong) } else { self.blocks(state, &wrong, forces) };
        let comes_back = |visited: &HashMap<Vec<bool>, usize>, tries: &[Try]| tries.first().is_none_or(|t| visited.contains_key(&t.state));
        if !self.single
            && comes_back(&self.visited, &tries)
            && let Some(plain) = self.plain.take().filter(|t| !self.visited.contains_key(&t.state))
        {
            // the reduction went too far and all of it closed again: that is no cycle of the iteration
            self.reduction = Reduction::Done;
            tries = vec![plain];
        }
        if !self.single && comes_back(&self.visited, &tries) {
            let back = tries.first().map_or_else(|| state.to_vec(), |t| t.state.clone());
            self.note(&back, iteration, rows);
            self.begin(true, state, iteration);
            tries = self.exchanges(state, &wrong);
        }
        let known = tries.first().map(|t| t.state.clone());
        tries.retain(|t| !self.visited.contains_key(&t.state));
        if tries.is_empty() {
            self.note(&known.expect("a wrong row makes a step"), iteration, rows);
            return Next::Circle;
        }
        if !self.seen_all {
            let changed = (0..state.len()).filter(|&k| state[k] != self.all[k]).count();
            let all = Try { all: !again, again, ..Try::new(self.all.clone(), changed) };
            tries.insert(if again { 0 } else { tries.len() }, all);
        }
        Next::Tries(tries)
    }

    /// Begins to change single rows, or all again.
    fn begin(&mut self, single: bool, state: &[bool], iteration: usize) {
        self.single = single;
        self.visited.clear();
        self.visited.insert(state.to_vec(), iteration);
    }

    fn note(&mut self, back: &[bool], iteration: usize, rows: &[usize]) {
        let Some(&first) = self.visited.get(back) else { return };
        let cycle = &self.states[first - 1..];
        let flips = |k: usize| cycle.iter().any(|s| s[k] != back[k]);
        self.cycles.push(Cycle { first, second: iteration + 1, rows: (0..back.len()).filter(|&k| flips(k)).map(|k| rows[k]).collect() });
    }

    /// One wrong row at a time, least index first.
    fn exchanges(&self, state: &[bool], wrong: &[usize]) -> Vec<Try> {
        wrong.iter().map(|&k| changed(state, &[k])).collect()
    }

    /// All wrong rows; where that is singular, of those that open the half that pulls most, a quarter, and so on to the worst and to none.
    fn blocks(&mut self, state: &[bool], wrong: &[usize], forces: &Forces) -> Vec<Try> {
        let close: Vec<usize> = wrong.iter().copied().filter(|&k| !state[k]).collect();
        let reduced = self.reduction == Reduction::Goes;
        let pull = |k: usize| if reduced { forces.multiplier[k] + self.at_rest[k] } else { forces.multiplier[k] };
        let mut open: Vec<usize> = if reduced {
            (0..state.len()).filter(|&k| state[k] && (wrong.binary_search(&k).is_ok() || pull(k) > 0.0)).collect()
        } else {
            wrong.iter().copied().filter(|&k| state[k]).collect()
        };
        if reduced && open.len() + close.len() > wrong.len() {
            self.plain = Some(changed(state, wrong));
        }
        open.sort_by(|&a, &b| pull(b).total_cmp(&pull(a)));
        let mut tries = Vec::new();
        let mut part = open.len();
        loop {
            if part + close.len() > 0 {
                tries.push(changed(state, &[&close[..], &open[..part]].concat()));
            }
            if part == 0 {
                return tries;
            }
            part /= 2;
        }
    }
}

fn changed(state: &[bool], rows: &[usize]) -> Try {
    let mut state = state.to_vec();
    rows.iter().for_each(|&k| state[k] = !state[k]);
    Try::new(state, rows.len())
}
