//! Identities of problems, by which handles of one problem are told from those of another.

use super::handles::{Kind, Statement};
use std::sync::atomic::{AtomicU64, Ordering};

/// Number of problems made so far.
static MADE: AtomicU64 = AtomicU64::new(0);

/// Number of statements of each kind, in the order of [`Kind`].
pub(super) type Counts = [usize; 5];

/// The number of a problem, and of those that it was cloned from: it knows the handles that they had made by then.
#[derive(Clone, Debug)]
pub(super) struct Identity {
    id: u64,
    /// Oldest first.
    origins: Vec<(u64, Counts)>,
}

impl Identity {
    /// Identity of a problem without statements.
    pub fn new() -> Self {
        Self { id: MADE.fetch_add(1, Ordering::Relaxed), origins: Vec::new() }
    }

    /// Identity of a clone of the problem, which has `counts` statements.
    pub fn heir(&self, counts: Counts) -> Self {
        let origins = self.origins.iter().copied().chain([(self.id, counts)]).collect();
        Self { id: MADE.fetch_add(1, Ordering::Relaxed), origins }
    }

    /// Number of the problem that made a statement.
    pub fn maker(&self, kind: Kind, number: usize) -> u64 {
        self.origins.iter().find(|(_, counts)| number < counts[kind as usize]).map_or(self.id, |(id, _)| *id)
    }

    /// Whether the problem has made this handle, or has it from those that it was cloned from.
    pub fn knows(&self, handle: impl Into<Statement>) -> bool {
        let of = handle.into();
        of.problem == self.maker(of.kind, of.number)
    }
}
