//! Primal-dual active set iteration around any solver of equalities: a semismooth Newton method.
//!
//! ```text
//! row j is active next iff lambda_j s_j + c k_j (gap_j - compliance_j lambda_j) / s_j < 0      (both terms are forces)
//! ```
//!
//! k_j, s_j: stiffness and weight of the row ([`super::scale::row_scales`]). Where both terms are within 1e-12 of their scale the row
//! keeps its state: all nine combinations of signs are decided, none by rounding. In a linear system the second term of an active row
//! and the first of an open one are zero by construction and taken as such: the result does not depend on c.
//!
//! - The contact rows alone decide sets first, without the unknowns (`first_guess`), where there are many by groups of them (`groups`);
//!   iterations are the systems solved as a whole after that.
//! - Rows whose functions share an element with an opening row open as well, as long as this makes progress (`pivot`).
//! - A repeated state is a cycle; single exchanges of least index break it (`pivot`).
//! - A singular system, or one with a condition above 1 / ε, leaves a body free: part of the rows that were to open stay closed, and a
//!   singular start is replaced by all rows closed. If no partial step helps, the iteration restarts from the set found with weak springs
//!   (`springs`).
//! - The best iterate is kept: least norm of the force lambda_j s_j - min(0, lambda_j s_j + k_j gap_j / s_j).
//!
//! Sources: Hintermueller, Ito, Kunisch, SIAM J. Optim. 13 (2002) 865-888 (active sets as Newton's method); Alart, Curnier, Comput.
//! Methods Appl. Mech. Eng. 92 (1991) 353-375 (c); the nine cases: Brivadis, defence slides, Pavia 2017.

mod first_guess;
mod forces;
mod groups;
mod pivot;
mod softening;
mod springs;

use super::scale::check_shape;
use super::verified::complete;
use super::{Abilities, ActiveSetEvent, ActiveSetReport, ConstrainedSolution, ConstrainedSystem, ConstraintSolver, SolveError};
use crate::linalg::LinearError;
use forces::{Measure, ZERO};
use pivot::{Next, Pivot, Try};

pub use forces::sign_case_of_rows;
pub(super) use forces::violated;
pub use softening::Softening;

/// Active set iteration around `inner`; rows of kind `Equal` and `Open` stay what they are.
///
/// ```text
/// row j is active next iff lambda_j s_j + c k_j (gap_j - compliance_j lambda_j) / s_j < 0
/// ```
///
/// with the stiffness k_j and the weight s_j of [`row_scales`](super::scale::row_scales): both terms are forces, c is a pure number. One of
/// them is zero by construction in every row, so the result does not depend on c.
///
/// It ends [converged](ConstrainedSolution), or with an error that carries the best iterate, the one of least
/// |lambda_j s_j - min(0, lambda_j s_j + k_j gap_j / s_j)|:
///
/// | outcome | error |
/// | --- | --- |
/// | cycling: a state was repeated, and single exchanges did not converge either | [`SolveError::Cycling`] |
/// | iterations: the limit was reached without a cycle | [`SolveError::TooManyIterations`] |
/// | rigid motion left: every step leaves a body free | [`SolveError::RigidMotion`] |
/// | stopped | [`SolveError::Stopped`] |
///
/// Sources: Hintermueller, Ito, Kunisch, SIAM J. Optim. 13 (2002) 865-888; Alart, Curnier, Comput. Methods Appl. Mech. Eng. 92 (1991)
/// 353-375; single exchanges: Murty, Linear Algebra Appl. 9 (1974) 65-108; Judice, Pires, Comput. Oper. Res. 21 (1994) 587-596.
#[derive(Clone, Debug)]
pub struct ActiveSet<C> {
    /// Solves the systems with equalities.
    pub inner: C,
    /// Linear systems allowed; as many again may turn out singular.
    pub max_iterations: usize,
    /// Weight of the gap's force against the multiplier's, a pure number.
    pub c: f64,
    /// First state, one per row (only contact rows are read); empty: all contact rows active.
    pub start: Vec<bool>,
    /// Whether the start is near the solution, as from the previous load step: then plain steps come first, otherwise wide ones.
    pub near: bool,
    /// Rows whose multiplier functions live on the same slave element, one list per element (rows of other kinds are not read); empty:
    /// plain steps only.
    ///
    /// In a wide step every closed row that shares an element with an opening one opens as well.
    pub elements: Vec<Vec<usize>>,
    /// Whether steps that leave a body free are tried in part; if false, the first one ends the iteration.
    pub retreat: bool,
    /// Relative size below which forces count as zero: 1e-12, that of rounding.
    pub zero: f64,
}

impl<C> ActiveSet<C> {
    /// Creates a solver with at most 100 iterations, c = 1, all contact rows active at first, and plain steps.
    pub fn new(inner: C) -> Self {
        Self { inner, max_iterations: 100, c: 1.0, start: Vec::new(), near: false, elements: Vec::new(), retreat: true, zero: ZERO }
    }

    /// Sets the first state, one entry per row.
    #[must_use]
    pub fn starting_from(mut self, start: Vec<bool>) -> Self {
        self.start = start;
        self
    }
}

/// A linear system that an active set is about to solve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct SetIteration {
    /// Number of the iteration, from 1; a system tried after a singular one has the same number.
    pub iteration: usize,
    /// Active contact rows in it.
    pub active: usize,
    /// All contact rows.
    pub rows: usize,
}

impl<C: ConstraintSolver<f64>> ConstraintSolver<f64> for ActiveSet<C> {
    fn abilities(&self) -> Abilities {
        Abilities { contact: true, ..self.inner.abilities() }
    }

    fn tolerance(&self) -> f64 {
        self.inner.tolerance()
    }

    fn solve(&mut self, system: &ConstrainedSystem<'_, f64>) -> Result<ConstrainedSolution<f64>, SolveError> {
        self.solve_observed(system, &mut |_| true)
    }
}

/// Report and best iterate of an iteration so far.
#[derive(Default)]
struct Found {
    report: ActiveSetReport,
    /// Violation and solution of the best iterate.
    best: Option<(f64, ConstrainedSolution<f64>)>,
}

impl Found {
    fn with_report(&self, mut solution: ConstrainedSolution<f64>) -> ConstrainedSolution<f64> {
        solution.active_set = Some(self.report.clone());
        solution
    }

    fn best(&mut self) -> Option<Box<ConstrainedSolution<f64>>> {
        let (_, solution) = self.best.take()?;
        Some(Box::new(self.with_report(solution)))
    }

    fn stopped(&mut self) -> SolveError {
        SolveError::Stopped { iterations: self.report.iterations, best: self.best() }
    }

    /// Error of an iteration that did not converge: [`SolveError::Cycling`] after a cycle, else [`SolveError::TooManyIterations`].
    fn unsettled(&mut self) -> SolveError {
        let cycle = self.report.cycles().next().cloned();
        let (iterations, best) = (self.report.iterations, self.best().unwrap_or_default());
        match cycle {
            Some(c) => SolveError::Cycling { first: c.first, second: c.second, rows: c.rows, iterations, best },
            None => SolveError::TooManyIterations { iterations, best },
        }
    }
}

/// Outcome of the states tried in one step.
enum Tried {
    Solved(usize, Box<ConstrainedSolution<f64>>),
    Singular,
    Stopped,
}

impl<C: ConstraintSolver<f64>> ActiveSet<C> {
    /// Solves `system`; calls `goes_on` before every linear system and stops if it returns false.
    ///
    /// # Errors
    /// [`SolveError::Stopped`] if `goes_on` returns false, and all others of [`ConstraintSolver::solve`].
    pub fn solve_observed(
        &mut self,
        system: &ConstrainedSystem<'_, f64>,
        goes_on: &mut dyn FnMut(SetIteration) -> bool,
    ) -> Result<ConstrainedSolution<f64>, SolveError> {
        let Some(mut guess) = self.guess(system, goes_on)? else { return self.without_guess(system, goes_on) };
        let start = std::mem::replace(&mut self.start, std::mem::take(&mut guess.closed));
        let near = std::mem::replace(&mut self.near, true);
        let ended = self.iterate(system, goes_on);
        (self.start, self.near) = (start, near);
        match ended {
            Ok(mut solution) => {
                if let Some(report) = &mut solution.active_set {
                    guess.told(report);
                }
                Ok(solution)
            }
            Err(SolveError::Stopped { iterations, best }) => Err(SolveError::Stopped { iterations, best }),
            Err(_) => self.without_guess(system, goes_on),
        }
    }

    /// Solves `system` from the start, with springs if that leaves a body free.
    fn without_guess(
        &mut self,
        system: &ConstrainedSystem<'_, f64>,
        goes_on: &mut dyn FnMut(SetIteration) -> bool,
    ) -> Result<ConstrainedSolution<f64>, SolveError> {
        match self.iterate(system, goes_on) {
            Err(SolveError::RigidMotion { iteration, open, best }) if self.retreat => {
                self.on_springs(system, SolveError::RigidMotion { iteration, open, best }, goes_on)
            }
            ended => ended,
        }
    }

    fn iterate(
        &mut self,
        system: &ConstrainedSystem<'_, f64>,
        goes_on: &mut dyn FnMut(SetIteration) -> bool,
    ) -> Result<ConstrainedSolution<f64>, SolveError> {
        check_shape(system)?;
        let m = system.offset.len();
        if !self.start.is_empty() && self.start.len() != m {
            return Err(SolveError::Shape { what: "start states", found: self.start.len(), expected: m });
        }
        let measure = Measure::of(system);
        let all: Vec<bool> = (0..measure.contact.len()).map(|k| measure.has_entries(k)).collect();
        let start: Vec<bool> = measure.contact.iter().zip(&all).map(|(&j, &a)| a && self.start.get(j).is_none_or(|&s| s)).collect();
        let mut tries = vec![Try::new(start, 0)];
        if tries[0].state != all {
            tries.push(Try { all: true, ..Try::new(all.clone(), 0) });
        }
        let mut pivot = Pivot::new(all, measure.among_contact(&self.elements, m), !self.near);
        let (mut found, mut linear, mut singular) = (Found::default(), 0, 0);
        loop {
            let iteration = found.report.iterations + 1;
            if iteration > self.max_iterations {
                return Err(found.unsettled());
            }
            let wanted = tries[0].changed;
            let (taken, mut solution) = match self.first_regular(system, &measure, &pivot.all, &tries, iteration, &mut singular, goes_on)? {
                Tried::Solved(taken, solution) => (tries.swap_remove(taken), *solution),
                Tried::Stopped => return Err(found.stopped()),
                Tried::Singular => {
                    let open = measure.contact.iter().zip(&tries[0].state).filter(|(_, active)| !**active).map(|(&j, _)| j).collect();
                    return Err(SolveError::RigidMotion { iteration, open, best: found.best() });
                }
            };
            linear += solution.iterations;
            solution.iterations = linear;
            let report = &mut found.report;
            if taken.all {
                report.events.push(ActiveSetEvent::AllClosed { iteration });
            } else if taken.changed < wanted {
                report.events.push(ActiveSetEvent::Part { iteration, changed: taken.changed, wanted });
            }
            let forces = measure.forces(&solution, true, self.zero);
            report.iterations = iteration;
            report.history.push(taken.state.iter().filter(|&&a| a).count());
            report.sign_cases.push(forces.sign_cases());
            let cycles = pivot.cycles.len();
            let next = pivot.next(&taken.state, &forces, self.c, iteration, &measure.contact);
            report.events.extend(pivot.cycles[cycles..].iter().cloned().map(ActiveSetEvent::Cycle));
            if matches!(next, Next::Settled) {
                report.best = iteration;
                return Ok(found.with_report(solution));
            }
            let violation = forces.violation();
            if found.best.as_ref().is_none_or(|(least, _)| violation < *least) {
                report.best = iteration;
                found.best = Some((violation, solution));
            }
            match next {
                Next::Tries(next) => tries = next,
                _ => return Err(found.unsettled()),
            }
        }
    }

    /// Solves the first regular system among `tries`.
    fn first_regular(
        &mut self,
        system: &ConstrainedSystem<'_, f64>,
        measure: &Measure<'_>,
        all: &[bool],
        tries: &[Try],
        iteration: usize,
        singular: &mut usize,
        goes_on: &mut dyn FnMut(SetIteration) -> bool,
    ) -> Result<Tried, SolveError> {
        let mut closed = vec![false; system.kind.len()];
        for (number, attempt) in tries.iter().enumerate() {
            let active = attempt.state.iter().filter(|&&a| a).count();
            if !goes_on(SetIteration { iteration, active, rows: measure.contact.len() }) {
                return Ok(Tried::Stopped);
            }
            for (k, &j) in measure.contact.iter().enumerate() {
                closed[j] = attempt.state[k];
            }
            let solved = self.inner.solve_set(system, &closed, iteration > 1 || number > 0);
            // a solver from outside may return less
            solved.as_ref().map_or(Ok(()), |solution| complete(system, solution))?;
            match solved {
                // with all rows closed there is no other state to try
                Ok(solution) if attempt.state == all || solution.condition.is_none_or(|c| c * f64::EPSILON < 1.0) => {
                    return Ok(Tried::Solved(number, Box::new(solution)));
                }
                Err(SolveError::Linear(LinearError::Stopped { .. })) => return Ok(Tried::Stopped),
                // of all rows closed: the body has no support at all
                Err(error) if attempt.state == all || !matches!(error, SolveError::Linear(LinearError::Singular { .. })) => {
                    return Err(error);
                }
                // singular, or so ill-conditioned that no digit is correct
                _ => {
                    *singular += 1;
                    if !self.retreat && iteration > 1 || *singular > self.max_iterations {
                        break;
                    }
                }
            }
        }
        Ok(Tried::Singular)
    }
}
