//! Progress callbacks and cancellation.

use faying::linalg::Cancellation;
use std::fmt::Debug;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

/// Progress report of a running case.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Progress<'a> {
    /// A phase begins: "build", "assemble", "solve", "measure", ...; the seconds of each go to the manifest.
    Phase(&'a str),
    /// A load step begins.
    Step {
        /// Its number, from 1.
        step: usize,
        /// Number of load steps.
        of: usize,
    },
    /// A line for the log.
    Note(&'a str),
    /// An iteration of the active set begins.
    Iteration {
        /// Its number, from 1.
        iteration: usize,
        /// Active rows in it.
        active: usize,
        /// All contact rows.
        rows: usize,
    },
}

/// Reason to end a run early.
///
/// Checked before every linear system, in every iteration of iterative solvers, and between phases; a factorisation, an assembly or a
/// picture that has begun is completed.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Stop {
    /// The user or the system asked for it (Ctrl-C; SIGTERM, SIGHUP): exit 130.
    Interrupted,
    /// The time limit has passed: E081, exit 6.
    TimeLimit {
        /// The limit in seconds.
        seconds: f64,
    },
}

/// Progress listener, limits and cancellation flag of a run. The default has no listener and never stops a run.
#[derive(Default)]
pub struct RunControl {
    /// Set by the caller to end the run.
    pub interrupted: Arc<AtomicBool>,
    /// Time at which the run must end, with the limit in seconds.
    pub deadline: Option<(Instant, f64)>,
    /// Memory limit in bytes, compared with the prediction before anything is allocated (E081, exit 6). Limits of the process (address
    /// space, control group) apply in addition, also without it.
    pub max_memory: Option<u64>,
    /// Receiver of progress reports.
    pub listener: Option<Box<dyn Fn(Progress<'_>) + Send + Sync>>,
}

impl Debug for RunControl {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Watch").field("deadline", &self.deadline).field("max_memory", &self.max_memory).finish_non_exhaustive()
    }
}

impl RunControl {
    /// Passes `news` to the listener, if there is one.
    pub fn report(&self, news: Progress<'_>) {
        if let Some(listener) = &self.listener {
            listener(news);
        }
    }

    /// Reports that a phase begins.
    pub fn phase(&self, name: &str) {
        self.report(Progress::Phase(name));
    }

    /// Stopping criterion for iterative solvers, evaluated in every iteration.
    pub fn stop_sign(&self) -> Cancellation {
        let (interrupted, deadline) = (Arc::clone(&self.interrupted), self.deadline);
        Cancellation::new(move || interrupted.load(Ordering::Relaxed) || deadline.is_some_and(|(end, _)| Instant::now() >= end))
    }

    /// Returns the reason to stop now, if any; called between phases, steps and iterations.
    pub fn stop(&self) -> Option<Stop> {
        if self.interrupted.load(Ordering::Relaxed) {
            return Some(Stop::Interrupted);
        }
        self.deadline.filter(|(end, _)| Instant::now() >= *end).map(|(_, seconds)| Stop::TimeLimit { seconds })
    }
}
