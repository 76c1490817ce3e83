//! Progress and cancellation.

use crate::constraint::ActiveSetReport;
use std::ops::ControlFlow;

/// Progress of a solution.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub enum Progress<'a> {
    /// The system of a step is about to be assembled, or solved.
    System,
    /// An iteration of the active set is about to begin.
    Iteration {
        /// Its number, from 1.
        iteration: usize,
        /// Active rows in it.
        active: usize,
        /// All contact rows.
        rows: usize,
    },
    /// The active set has settled.
    ActiveSet(&'a ActiveSetReport),
}

/// Called with the progress of a solution; [`ControlFlow::Break`] cancels it.
pub type Observer<'a> = &'a (dyn Fn(&Progress<'_>) -> ControlFlow<()> + Sync);
