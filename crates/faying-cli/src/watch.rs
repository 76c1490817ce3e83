//! The way from a running case to those who wait for it: progress out, requests to stop in.

use faying::linalg::StopSign;
use std::fmt::Debug;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

/// News of a running case.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Progress<'a> {
    /// A phase begins: "build", "assemble", "solve", "measure", ...; the seconds of each go to the manifest.
    Phase(&'a str),
    /// A load step begins.
    Step {
        /// Its number, from 1.
        step: usize,
        /// How many there are.
        of: usize,
    },
    /// A line for those who read along.
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

/// Why a run should end early.
///
/// Asked before every linear system, in every iteration of iterative solvers, and between phases; a factorisation, an assembly or a picture that has begun comes to its end.
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

/// What a run reports to and asks while it works. The default one hears nothing and never stops.
#[derive(Default)]
pub struct Watch {
    /// Set from outside to end the run.
    pub interrupted: Arc<AtomicBool>,
    /// When the run must end, and the limit in seconds it came from.
    pub deadline: Option<(Instant, f64)>,
    /// Most bytes the run may use; it compares its prediction before it allocates (E081, exit 6). Limits of the process (address space, control
    /// group) stand beside it, and hold without it.
    pub max_memory: Option<u64>,
    /// Who hears the news.
    pub listener: Option<Box<dyn Fn(Progress<'_>) + Send + Sync>>,
}

impl Debug for Watch {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Watch").field("deadline", &self.deadline).field("max_memory", &self.max_memory).finish_non_exhaustive()
    }
}

impl Watch {
    /// Tells the listener.
    pub fn report(&self, news: Progress<'_>) {
        if let Some(listener) = &self.listener {
            listener(news);
        }
    }

    /// A phase begins.
    pub fn phase(&self, name: &str) {
        self.report(Progress::Phase(name));
    }

    /// The same question for iterative solvers, which ask it in every iteration.
    pub fn stop_sign(&self) -> StopSign {
        let (interrupted, deadline) = (Arc::clone(&self.interrupted), self.deadline);
        StopSign::new(move || interrupted.load(Ordering::Relaxed) || deadline.is_some_and(|(end, _)| Instant::now() >= end))
    }

    /// Whether to end now; asked between phases, steps and iterations.
    pub fn stop(&self) -> Option<Stop> {
        if self.interrupted.load(Ordering::Relaxed) {
            return Some(Stop::Interrupted);
        }
        self.deadline.filter(|(end, _)| Instant::now() >= *end).map(|(_, seconds)| Stop::TimeLimit { seconds })
    }
}
