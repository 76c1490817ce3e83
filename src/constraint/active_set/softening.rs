//! Rows at points made softer on the way to a good first state of the active set.
//!
//! A set of points that is far too large, such as all of them, is peeled a few points per iteration: where bodies part, the fields of the
//! too large zone oscillate. Softer rows do not: each is open or closed by its own gap. Where points do not settle soon, they settle on
//! softer rows first, from each softness to the next.

use super::{ActiveSet, SetIteration};
use crate::constraint::{Abilities, ActiveSetReport, ConstrainedSolution, ConstrainedSystem, ConstraintSolver, SolveError};
use std::fmt::{Debug, Formatter};

/// Iterations after which an initial active set with points is considered a bad one.
const PATIENCE: usize = 10;
/// Factors by which rows of points are made softer on the way to a good first state.
const SOFTER: [f64; 4] = [1e4, 1e3, 1e2, 1e1];

/// Active set that reports its iterations and may ease some rows first; solved again it starts from its last set.
pub struct Softening<'a, C> {
    set: &'a mut ActiveSet<C>,
    /// Called before every system with (iterations before it, the system); `false` stops.
    watch: &'a mut (dyn FnMut(usize, SetIteration) -> bool + Send),
    /// Rows that are made softer on the way; empty: none.
    eased: Vec<bool>,
    /// Iterations so far.
    done: usize,
}

impl<C: Debug> Debug for Softening<'_, C> {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Softening").field("set", &self.set).finish_non_exhaustive()
    }
}

impl<'a, C: ConstraintSolver<f64>> Softening<'a, C> {
    /// Solves by `set`; `eased`: rows that are made softer first, one flag per row or none; `watch`: called before every system with the
    /// number of iterations of earlier calls and the system, and returns whether to go on.
    pub fn new(set: &'a mut ActiveSet<C>, eased: Vec<bool>, watch: &'a mut (dyn FnMut(usize, SetIteration) -> bool + Send)) -> Self {
        Self { set, watch, eased, done: 0 }
    }

    /// Runs at most `most` iterations of the active set from its present state.
    fn run(&mut self, system: &ConstrainedSystem<'_>, most: usize) -> Result<ConstrainedSolution, SolveError> {
        let (done, limit) = (self.done, self.set.max_iterations);
        let (mut last, watch) = (0, &mut *self.watch);
        self.set.max_iterations = most;
        let solved = self.set.solve_observed(system, &mut |news: SetIteration| {
            last = news.iteration;
            watch(done, news)
        });
        self.set.max_iterations = limit;
        self.done += last;
        if let Ok(solution) = &solved {
            self.set.start.clone_from(&solution.active);
            self.set.near = true;
        }
        solved
    }
}

/// Returns the last state of an iteration that did not converge; other errors are passed on.
fn unsettled(error: SolveError) -> Result<Option<Box<ConstrainedSolution>>, SolveError> {
    match error {
        SolveError::TooManyIterations { best, .. } | SolveError::Cycling { best, .. } => Ok(Some(best)),
        SolveError::RigidMotion { best, .. } => Ok(best),
        other => Err(other),
    }
}

impl<C: ConstraintSolver<f64>> ConstraintSolver<f64> for Softening<'_, C> {
    fn abilities(&self) -> Abilities {
        self.set.abilities()
    }

    fn tolerance(&self) -> f64 {
        self.set.tolerance()
    }

    fn factors(&self) -> usize {
        self.set.factors()
    }

    fn solve(&mut self, system: &ConstrainedSystem<'_, f64>) -> Result<ConstrainedSolution<f64>, SolveError> {
        let (eased, most) = (std::mem::take(&mut self.eased), self.set.max_iterations);
        let mut before = ActiveSetReport::default();
        if eased.contains(&true) && most > PATIENCE {
            let first = self.set.start.clone();
            match self.run(system, PATIENCE) {
                Ok(solution) => return Ok(solution),
                Err(error) => before = unsettled(error)?.and_then(|last| last.active_set).unwrap_or_default(),
            }
            self.set.start = first;
            for softer in SOFTER {
                let soft = |j: usize| system.compliance.get(j).copied().unwrap_or(0.0) * if eased[j] { softer } else { 1.0 };
                let compliance: Vec<f64> = (0..eased.len()).map(soft).collect();
                let solved = self.run(&ConstrainedSystem { compliance: &compliance, ..*system }, PATIENCE);
                match solved.map_or_else(unsettled, |solution| Ok(Some(Box::new(solution))))? {
                    Some(solution) => {
                        self.set.start.clone_from(&solution.active);
                        before = solution.active_set.unwrap_or_default().after(&before);
                    }
                    None => break,
                }
            }
        }
        self.run(system, most).map(|solution| solution.done_after(&before))
    }
}
