//! Initial guess for systems with B != C, in which every set needs its own factor: the active set of the system with C in place of B,
//! whose sets share one factor.
//!
//! C and B are the same rows integrated differently, so the sets differ in few rows. The non-symmetric system decides.

use super::super::{ActiveSetEvent, ActiveSetReport, ConstrainedSystem, ConstraintSolver, SolveError};
use super::{ActiveSet, IterationNews};

/// Active set of the symmetric system.
pub(super) struct Guess {
    /// Whether each row is closed.
    pub closed: Vec<bool>,
    /// Number of sets solved to find it.
    pub sets: usize,
}

impl Guess {
    /// Records this guess in the `report` of the iteration that started from it.
    pub fn told(&self, report: &mut ActiveSetReport) {
        report.events.insert(0, ActiveSetEvent::Symmetric { sets: self.sets });
    }
}

impl<C: ConstraintSolver<f64>> ActiveSet<C> {
    /// Computes the guess; `None` if it is not needed, would take a factor for each set, or is not found.
    ///
    /// # Errors
    /// [`SolveError::Stopped`] if `goes_on` returns false.
    pub(super) fn guess(
        &mut self,
        system: &ConstrainedSystem<'_, f64>,
        goes_on: &mut dyn FnMut(IterationNews) -> bool,
    ) -> Result<Option<Guess>, SolveError> {
        let symmetric = ConstrainedSystem { reaction: None, ..*system };
        let differs = system.reaction.is_some_and(|b| b != system.constraint);
        // a guess is never why a system is not solved
        if self.near || !differs || !matches!(self.inner.shares_factor(&symmetric), Ok(true)) {
            return Ok(None);
        }
        let of = |solution: super::ConstrainedSolution| {
            let sets = solution.active_set.map_or(0, |report| report.iterations);
            Guess { closed: solution.active, sets }
        };
        match self.iterate(&symmetric, goes_on) {
            Ok(solution) => Ok(Some(of(solution))),
            Err(SolveError::Stopped { .. }) => Err(SolveError::Stopped { iterations: 0, best: None }),
            Err(_) => Ok(None),
        }
    }
}
