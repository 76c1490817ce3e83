//! A first guess where every set takes a factor of its own, since B differs from C: the set of the system with C in place of B,
//! whose sets share one factor.
//!
//! C and B are the same rows in different measures, so their sets differ in few rows. The system without symmetry decides.

use super::super::{ActiveSetEvent, ActiveSetReport, ConstrainedSystem, ConstraintSolver, SolveError};
use super::{ActiveSet, IterationNews};

/// What the symmetric system says.
pub(super) struct Guess {
    /// Whether each row is closed.
    pub closed: Vec<bool>,
    /// Its sets, counted.
    pub sets: usize,
}

impl Guess {
    /// The report of an iteration that began with this guess.
    pub fn told(&self, report: &mut ActiveSetReport) {
        report.events.insert(0, ActiveSetEvent::Symmetric { sets: self.sets });
    }
}

impl<C: ConstraintSolver<f64>> ActiveSet<C> {
    /// The guess; `None` where it is not needed, would take a factor for each set, or is not found.
    ///
    /// # Errors
    /// [`SolveError::Stopped`] where `goes_on` says no.
    pub(super) fn guess(
        &mut self,
        system: &ConstrainedSystem<'_, f64>,
        goes_on: &mut dyn FnMut(IterationNews) -> bool,
    ) -> Result<Option<Guess>, SolveError> {
        let symmetric = ConstrainedSystem { reaction: None, ..*system };
        let differs = system.reaction.is_some_and(|b| b != system.constraint);
        if self.near || !differs || !self.inner.shares_factor(&symmetric)? {
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
