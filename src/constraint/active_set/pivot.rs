//! Choice of the next state of the contact rows, and prevention of cycling.
//!
//! - *Plain*: all wrong rows change at once: the primal-dual active set, which is block principal pivoting on the linear complementarity
//!   problem of the rows.
//! - *Wide*: if at least two rows open, and no fewer than close, every closed row whose function shares an element with that of an
//!   opening one opens as well. If too many rows are closed, the pressure of smooth multipliers ends in a root singularity of tension and
//!   its coefficients alternate there: only every other row is wrong, and plain steps move the end of the zone by one row per system.
//!   Multipliers whose functions share no elements use plain steps only.
//!
//! Wide steps come first, or plain ones if the start is near the solution; after [`PATIENCE`] systems without a new least number of wrong
//! rows they are swapped. A wide state visited before is replaced by the plain one. If that was visited, too, the state with the fewest
//! wrong rows so far is taken up again, and single wrong rows change, least index first, until fewer rows are wrong than ever before or as
//! many rows have changed as were wrong ([`EXCHANGES`] at least, twice as many after every cycle); then all wrong rows change at once
//! again. With a positive definite matrix of the rows this terminates: single exchanges of least index
//! never repeat a state, and their number grows until they suffice.
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
    /// Whether this is the state with all rows closed, tried if no other step is possible.
    pub all: bool,
}

impl Try {
    pub fn new(state: Vec<bool>, changed: usize) -> Self {
        Self { state, changed, all: false }
    }
}

/// Outcome of [`Pivot::next`].
#[derive(Debug)]
pub(super) enum Next {
    /// No row is wrong.
    Settled,
    /// States to try in this order until one is regular.
    Tries(Vec<Try>),
    /// Even single exchanges repeat a state: the matrix of the rows is not positive definite.
    Circle,
}

/// Systems without a new least number of wrong rows after which wide and plain steps are swapped.
const PATIENCE: usize = 4;

/// Single exchanges after the first cycle; few, as they are slow if the repeated state is far from the solution.
const EXCHANGES: usize = 4;

/// History of an iteration.
#[derive(Debug)]
pub(super) struct Pivot {
    /// State with all rows closed that can be.
    pub all: Vec<bool>,
    /// Rows whose functions share an element, one list per element.
    elements: Vec<Vec<usize>>,
    /// Whether the next step is wide.
    wide: bool,
    /// Single exchanges left before all wrong rows change at once again.
    single: usize,
    /// Single exchanges after the next cycle.
    exchanges: usize,
    /// States visited since the last switch between blocks and single exchanges, and their iterations.
    visited: HashMap<Vec<bool>, usize>,
    /// All states so far.
    states: Vec<Vec<bool>>,
    /// Number of wrong rows of each of them.
    counts: Vec<usize>,
    /// Fewest wrong rows so far.
    fewest: usize,
    /// Systems since that minimum, or since the last switch between wide and plain steps.
    waited: usize,
    /// Whether the state with all rows closed was visited.
    seen_all: bool,
    /// The cycles found.
    pub cycles: Vec<Cycle>,
}

impl Pivot {
    /// `elements`: rows whose functions share an element, one list per element; `wide`: whether wide steps come first.
    pub fn new(all: Vec<bool>, elements: Vec<Vec<usize>>, wide: bool) -> Self {
        Self {
            all,
            elements,
            wide,
            single: 0,
            exchanges: EXCHANGES,
            visited: HashMap::new(),
            states: Vec::new(),
            counts: Vec::new(),
            fewest: usize::MAX,
            waited: 0,
            seen_all: false,
            cycles: Vec::new(),
        }
    }

    /// States to try after `state`, the one of system `iteration`; `rows`: numbers of the contact rows in the system.
    pub fn next(&mut self, state: &[bool], forces: &Forces, c: f64, iteration: usize, rows: &[usize]) -> Next {
        let wrong = forces.violated(c);
        self.states.push(state.to_vec());
        self.counts.push(wrong.len());
        self.visited.insert(state.to_vec(), iteration);
        self.seen_all |= state == self.all;
        if wrong.is_empty() {
            return Next::Settled;
        }
        let fewer = wrong.len() < self.fewest;
        if self.single > 0 {
            self.single = if fewer { 0 } else { self.single - 1 };
            if self.single == 0 {
                self.begin(state, iteration);
            }
        } else {
            self.waited += 1;
        }
        if fewer {
            (self.fewest, self.waited) = (wrong.len(), 0);
        }
        if self.waited == PATIENCE {
            (self.wide, self.waited) = (!self.wide, 0);
        }
        let mut tries = if self.single > 0 { exchanges(state, &wrong) } else { blocks(state, &wrong, forces) };
        let wide = if self.wide && self.single == 0 { self.widened(state, &wrong) } else { None };
        match wide.filter(|t| !self.visited.contains_key(&t.state)) {
            Some(wide) => tries.insert(0, wide),
            None if self.single == 0 && self.visited.contains_key(&tries[0].state) => {
                self.note(&tries[0].state, iteration, rows);
                self.begin(state, iteration);
                let best = (0..self.states.len()).min_by_key(|&k| self.counts[k]).expect("this state is one");
                (self.single, self.exchanges) = (self.exchanges.max(self.counts[best]), 2 * self.exchanges);
                tries = if self.counts[best] < wrong.len() {
                    let rows: Vec<usize> = (0..state.len()).filter(|&k| state[k] != self.states[best][k]).collect();
                    // the exchanges begin there, and may come through this state
                    self.visited.clear();
                    vec![changed(state, &rows)]
                } else {
                    exchanges(state, &wrong)
                };
            }
            None => {}
        }
        let known = tries[0].state.clone();
        tries.retain(|t| !self.visited.contains_key(&t.state));
        if tries.is_empty() {
            self.note(&known, iteration, rows);
            return Next::Circle;
        }
        if !self.seen_all {
            let changed = (0..state.len()).filter(|&k| state[k] != self.all[k]).count();
            tries.push(Try { all: true, ..Try::new(self.all.clone(), changed) });
        }
        Next::Tries(tries)
    }

    /// The wide step; `None` if it equals the plain one or must not be taken.
    fn widened(&self, state: &[bool], wrong: &[usize]) -> Option<Try> {
        let opening = wrong.iter().filter(|&&k| state[k]).count();
        if opening < 2 || 2 * opening < wrong.len() {
            return None;
        }
        let mut changes = vec![false; state.len()];
        wrong.iter().for_each(|&k| changes[k] = true);
        for element in &self.elements {
            if element.iter().any(|&k| state[k] && wrong.binary_search(&k).is_ok()) {
                element.iter().filter(|&&k| state[k]).for_each(|&k| changes[k] = true);
            }
        }
        let rows: Vec<usize> = (0..state.len()).filter(|&k| changes[k]).collect();
        let next = changed(state, &rows);
        (rows.len() > wrong.len() && next.state.contains(&true)).then_some(next)
    }

    /// Forgets the visited states but `state`.
    fn begin(&mut self, state: &[bool], iteration: usize) {
        self.visited.clear();
        self.visited.insert(state.to_vec(), iteration);
    }

    fn note(&mut self, back: &[bool], iteration: usize, rows: &[usize]) {
        let Some(&first) = self.visited.get(back) else { return };
        let cycle = &self.states[first - 1..];
        let flips = |k: usize| cycle.iter().any(|s| s[k] != back[k]);
        self.cycles.push(Cycle { first, second: iteration + 1, rows: (0..back.len()).filter(|&k| flips(k)).map(|k| rows[k]).collect() });
    }
}

/// One wrong row at a time, least index first.
fn exchanges(state: &[bool], wrong: &[usize]) -> Vec<Try> {
    wrong.iter().map(|&k| changed(state, &[k])).collect()
}

/// Tries all wrong rows, then, of those that open, only the half with the largest tension, a quarter, and so on down to one and none.
fn blocks(state: &[bool], wrong: &[usize], forces: &Forces) -> Vec<Try> {
    let (mut open, close): (Vec<usize>, Vec<usize>) = wrong.iter().partition(|&&k| state[k]);
    open.sort_by(|&a, &b| forces.multiplier[b].total_cmp(&forces.multiplier[a]));
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

fn changed(state: &[bool], rows: &[usize]) -> Try {
    let mut state = state.to_vec();
    rows.iter().for_each(|&k| state[k] = !state[k]);
    Try::new(state, rows.len())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rows of `wrong` pull where they are closed and penetrate where they are open.
    fn forces(closed: &[bool], wrong: &[usize]) -> Forces {
        let sign = |k: usize| if wrong.contains(&k) { 1.0 } else { -1.0 };
        let rows = 0..closed.len();
        Forces {
            multiplier: rows.clone().map(|k| if closed[k] { sign(k) } else { 0.0 }).collect(),
            gap: rows.clone().map(|k| if closed[k] { 0.0 } else { -sign(k) }).collect(),
            zero: rows.map(|_| 1e-12).collect(),
            closed: closed.to_vec(),
        }
    }

    /// Rows of a linear multiplier on a line.
    fn line(rows: usize, wide: bool) -> Pivot {
        Pivot::new(vec![true; rows], (1..rows).map(|k| vec![k - 1, k]).collect(), wide)
    }

    /// "110010": the closed rows.
    fn state(text: &str) -> Vec<bool> {
        text.chars().map(|c| c == '1').collect()
    }

    /// The first state to try after one of which `wrong` are wrong.
    fn after(pivot: &mut Pivot, from: &str, wrong: &[usize], iteration: usize) -> String {
        let from = state(from);
        let rows: Vec<usize> = (0..from.len()).collect();
        match pivot.next(&from, &forces(&from, wrong), 1.0, iteration, &rows) {
            Next::Tries(tries) => tries[0].state.iter().map(|&a| if a { '1' } else { '0' }).collect(),
            other => format!("{other:?}"),
        }
    }

    #[test]
    fn a_wide_step_opens_what_shares_an_element_with_an_opening_row() {
        let next = |from: &str, wrong: &[usize]| after(&mut line(6, true), from, wrong, 1);
        assert_eq!(next("111111", &[3, 5]), "110000");
        // rows that close do so beside it, and open rows are no part of it
        assert_eq!(next("110111", &[2, 4, 5]), "111000");
        // one row opens; more close than open; no row would be left
        assert_eq!(next("111111", &[5]), "111110");
        assert_eq!(next("111000", &[1, 2, 3, 4, 5]), "100111");
        assert_eq!(next("111111", &[1, 4]), "101101");
        // near the answer, and of functions that share nothing
        assert_eq!(after(&mut line(6, false), "111111", &[3, 5], 1), "111010");
        assert_eq!(after(&mut Pivot::new(vec![true; 6], Vec::new(), true), "111111", &[3, 5], 1), "111010");
    }

    #[test]
    fn wide_and_plain_steps_take_turns_where_nothing_is_won() {
        let mut pivot = line(9, true);
        // the first four rows count the states
        for iteration in 1..=12 {
            let from = format!("{iteration:04b}11111");
            let next = after(&mut pivot, &from, &[6, 8], iteration);
            let plain = (5..9).contains(&iteration);
            assert_eq!(&next[4..], if plain { "11010" } else { "10000" }, "{iteration}");
        }
        // a new least number of wrong rows begins the count again
        let mut pivot = line(9, true);
        for iteration in 1..=8 {
            let from = format!("{iteration:04b}11111");
            let wrong: &[usize] = if iteration < 4 { &[5, 6, 8] } else { &[6, 8] };
            let next = after(&mut pivot, &from, wrong, iteration);
            assert_eq!(&next[5..], if iteration == 8 { "1010" } else { "0000" }, "{iteration}");
        }
    }

    #[test]
    fn a_wide_state_that_was_there_gives_way_to_the_plain_one_and_that_to_single_exchanges() {
        let mut pivot = line(6, true);
        after(&mut pivot, "110000", &[2], 1);
        assert_eq!(after(&mut pivot, "111111", &[3, 5], 2), "111010");
        assert!(pivot.cycles.is_empty());
        let mut pivot = line(6, true);
        after(&mut pivot, "110000", &[2], 1);
        after(&mut pivot, "111010", &[1], 2);
        // from the state with the fewest wrong rows
        assert_eq!(after(&mut pivot, "111111", &[3, 5], 3), "110000");
        assert_eq!(pivot.cycles, [Cycle { first: 2, second: 4, rows: vec![3, 5] }]);
        assert_eq!(after(&mut pivot, "110000", &[2], 4), "111000");
        // exchanges from there may come through the state in which the circle was found
        let mut pivot = line(6, false);
        after(&mut pivot, "111011", &[2, 3, 4], 1);
        after(&mut pivot, "110000", &[2], 2);
        assert_eq!(after(&mut pivot, "111000", &[4, 5], 3), "110000");
        assert_eq!(after(&mut pivot, "110000", &[2], 4), "111000");
        assert_eq!(after(&mut pivot, "111000", &[4, 5], 5), "111010");
        // of a circle whose states are equally wrong, from where it is found
        let mut pivot = line(6, false);
        after(&mut pivot, "111111", &[3, 5], 1);
        assert_eq!(after(&mut pivot, "111010", &[3, 5], 2), "111110");
    }
}
