//! First guess of the active set by the contact rows alone: sets decided in the Schur complement take no solution of the unknowns.
//!
//! - Groups of rows come first where there are many rows ([`super::groups`]): few sets of few groups find the edges of the zone, however
//!   many rows there are.
//! - Then all rows, where sets of theirs cost little beside a factor.
//! - If the reaction differs from the constraint, the rows are those of the system with C in place of B, integrated differently: the sets
//!   differ in few rows.
//!
//! The whole system decides: it is solved with the guess, and with other sets if it asks for them.

use super::super::rows_alone::RowsAlone;
use super::super::{ActiveSetEvent, ActiveSetReport, ConstrainedSolution, ConstrainedSystem, ConstraintSolver, RowKind, SolveError};
use super::forces::Measure;
use super::groups::{Groups, Summed};
use super::{ActiveSet, SetIteration};

/// Rows from which groups come first.
const MANY: usize = 64;
/// Most sets of groups, or of rows.
const MOST: usize = 200;
/// Relative size below which forces of rows alone count as zero: they are not refined.
const ROUGH: f64 = 1e-8;

/// Guess of the active set.
#[derive(Debug)]
pub(super) struct Guess {
    /// Whether each row is closed.
    pub closed: Vec<bool>,
    /// Number of active rows or groups in each set that was decided to find it.
    sets: Vec<usize>,
    events: Vec<ActiveSetEvent>,
}

impl Guess {
    /// Records this guess in the `report` of the iteration that started from it.
    pub fn told(self, report: &mut ActiveSetReport) {
        report.sets.splice(0..0, self.sets);
        report.events.splice(0..0, self.events);
    }

    fn add(&mut self, report: ActiveSetReport) {
        self.sets.extend(report.history);
        self.events.extend(report.events.into_iter().map(|event| ActiveSetEvent::Alone(Box::new(event))));
    }
}

impl<C: ConstraintSolver<f64>> ActiveSet<C> {
    /// Computes the guess; `None` if the rows alone cannot decide, or no less is paid for that.
    ///
    /// # Errors
    /// [`SolveError::Stopped`] if `goes_on` returns false.
    pub(super) fn guess(
        &mut self,
        system: &ConstrainedSystem<'_, f64>,
        goes_on: &mut dyn FnMut(SetIteration) -> bool,
    ) -> Result<Option<Guess>, SolveError> {
        let differs = system.reaction.is_some_and(|b| b != system.constraint);
        if differs && self.near || self.start.len() > system.offset.len() {
            return Ok(None);
        }
        let symmetric = ConstrainedSystem { reaction: None, ..*system };
        let mut goes_on = |news: SetIteration| goes_on(SetIteration { iteration: 1, ..news });
        let guess = match self.decided(&symmetric, &mut goes_on) {
            Err(SolveError::Stopped { .. }) => return Err(SolveError::Stopped { iterations: 0, best: None }),
            // a guess is never why a system is not solved
            Err(_) => return Ok(None),
            Ok(guess) => guess,
        };
        let told = |mut guess: Guess| {
            if differs {
                guess.events = vec![ActiveSetEvent::Symmetric { sets: guess.sets.len() }];
            }
            guess
        };
        Ok(guess.map(told))
    }

    fn decided(
        &mut self,
        system: &ConstrainedSystem<'_, f64>,
        goes_on: &mut dyn FnMut(SetIteration) -> bool,
    ) -> Result<Option<Guess>, SolveError> {
        super::check_shape(system)?;
        let m = system.offset.len();
        let measure = Measure::of(system);
        let rows: Vec<usize> = (0..measure.contact.len()).filter(|&k| measure.has_entries(k)).map(|k| measure.contact[k]).collect();
        let mut guess = Guess { closed: vec![false; m], sets: Vec::new(), events: Vec::new() };
        rows.iter().for_each(|&j| guess.closed[j] = self.start.get(j).is_none_or(|&closed| closed));
        let mut near = self.near;
        if rows.len() > MANY && !near {
            near = self.by_groups(system, &rows, &mut guess, goes_on)?;
        }
        let lists: Vec<Vec<usize>> = rows.iter().map(|&j| vec![j]).collect();
        let Some(alone) = self.inner.rows_alone(system, &lists, !guess.sets.is_empty())? else {
            return Ok(Some(guess).filter(|guess| !guess.sets.is_empty()));
        };
        let start: Vec<bool> = rows.iter().map(|&j| guess.closed[j]).collect();
        let mut place = vec![None; m];
        rows.iter().enumerate().for_each(|(k, &j)| place[j] = Some(k));
        let own = |list: &Vec<usize>| list.iter().filter_map(|&j| place[j]).collect();
        let elements = self.elements.iter().map(own).collect();
        let found = self.alone(system, alone, &lists, (start, near, elements), &mut guess, goes_on)?;
        rows.iter().zip(found).for_each(|(&j, closed)| guess.closed[j] = closed);
        Ok(Some(guess))
    }

    /// Guesses by groups of `rows`, halved near the edges of the zone; returns whether there is one.
    fn by_groups(
        &mut self,
        system: &ConstrainedSystem<'_, f64>,
        rows: &[usize],
        guess: &mut Guess,
        goes_on: &mut dyn FnMut(SetIteration) -> bool,
    ) -> Result<bool, SolveError> {
        let Some(mut groups) = Groups::of(system, rows, &guess.closed) else { return Ok(false) };
        let mut near = false;
        loop {
            let lists = groups.lists();
            let Some(alone) = self.inner.rows_alone(system, &lists, near)? else { break };
            match self.alone(system, alone, &lists, (groups.closed.clone(), near, Vec::new()), guess, goes_on) {
                Ok(closed) => groups.closed = closed,
                Err(SolveError::Stopped { iterations, best }) => return Err(SolveError::Stopped { iterations, best }),
                Err(_) => break,
            }
            near = true;
            if guess.sets.len() > MOST || !groups.refine() {
                break;
            }
        }
        if near {
            guess.closed = groups.states(system.offset.len());
        }
        Ok(near)
    }

    /// The set that rows, or groups of rows, alone decide, from a start that may be near it and lists of rows on one element.
    fn alone(
        &self,
        system: &ConstrainedSystem<'_, f64>,
        alone: RowsAlone,
        lists: &[Vec<usize>],
        (start, near, elements): (Vec<bool>, bool, Vec<Vec<usize>>),
        guess: &mut Guess,
        goes_on: &mut dyn FnMut(SetIteration) -> bool,
    ) -> Result<Vec<bool>, SolveError> {
        let summed = Summed::of(system, lists);
        let of_rows = ConstrainedSystem {
            constraint: &summed.rows,
            reaction: None,
            offset: &summed.offset,
            kind: &vec![RowKind::Contact; lists.len()],
            compliance: &summed.compliance,
            ..*system
        };
        let mut set =
            ActiveSet { inner: alone, max_iterations: MOST, c: self.c, start, near, elements, retreat: self.retreat, zero: ROUGH };
        let mut solution: ConstrainedSolution = match set.iterate(&of_rows, goes_on) {
            Ok(solution) => solution,
            Err(SolveError::Cycling { best, .. } | SolveError::TooManyIterations { best, .. }) => *best,
            Err(other) => return Err(other),
        };
        guess.add(solution.active_set.take().unwrap_or_default());
        Ok(solution.active)
    }
}
