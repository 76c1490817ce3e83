//! Floor 9: algorithms for constrained linear systems. They see matrices only.
//!
//!   K u + Bᵀ lambda = f,   rows C u + g: zero, soft, or a gap that stays open

mod active_set;
mod augmented;
mod complement;
mod condensed;
mod direct;
mod free;
mod interface;
mod krylov;
mod penalised;
mod proximal;
mod quasidefinite;
mod refinement;
pub mod scale;
mod schur;

use crate::coupling::Rows;
use crate::linalg::{LinearError, Operator, Real};
use std::fmt::Debug;

pub use active_set::{ActiveSet, IterationNews, sign_case_of_rows};
pub use augmented::{Augmented, Uzawa};
pub use condensed::Condensed;
pub use direct::Direct;
pub use free::Free;
pub use interface::InterfaceWork;
pub use krylov::Krylov;
pub use proximal::Proximal;
pub use scale::penalty;
pub use schur::Schur;

/// What a row of constraints asks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum RowKind {
    /// (C u + g)_i = compliance_i lambda_i.
    Equal,
    /// (C u + g)_i >= 0, lambda_i <= 0, product zero.
    Contact,
    /// Not enforced: lambda_i = 0.
    Open,
}

/// A linear system with constraints.
#[derive(Clone, Copy, Debug)]
pub struct ConstrainedSystem<'a, T: Real = f64> {
    /// K.
    pub stiffness: &'a dyn Operator<T>,
    /// f.
    pub load: &'a [T],
    /// C = slave + master.
    pub constraint: &'a Rows<T>,
    /// B where it differs from C.
    pub reaction: Option<&'a Rows<T>>,
    /// g, one per row.
    pub offset: &'a [T],
    /// Kind of every row.
    pub kind: &'a [RowKind],
    /// Softness of every row, gap / lambda; empty: all exact.
    pub compliance: &'a [T],
}

/// Counts of the nine sign cases: rows lambda < 0, = 0, > 0; columns gap = 0, > 0, < 0.
pub type SignCases = [usize; 9];

/// A state of the contact rows that an active set visited twice.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Cycle {
    /// Iteration of the first visit.
    pub first: usize,
    /// Iteration in which it would have come back.
    pub second: usize,
    /// Rows that change between the states of the cycle.
    pub rows: Vec<usize>,
}

/// What happened in an active set beside its nominal steps.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum ActiveSetEvent {
    /// The state wanted left a body free; all rows were closed in its place.
    AllClosed {
        /// The iteration that began with all rows closed.
        iteration: usize,
    },
    /// The state wanted left a body free; only some of the rows changed.
    Part {
        /// The iteration.
        iteration: usize,
        /// Rows that changed.
        changed: usize,
        /// Rows that were to change.
        wanted: usize,
    },
    /// The start was the set of the system with C in place of B, whose sets share one factor.
    Symmetric {
        /// Its sets; they are no part of the iterations.
        sets: usize,
    },
    /// Every step left a body free: it was put on weak springs, and what was closed there is where the iteration began again without them.
    Springs {
        /// The iteration whose system was singular.
        iteration: usize,
    },
    /// A state came back; single exchanges followed.
    Cycle(Cycle),
}

impl ActiveSetEvent {
    /// The same after `before` iterations of an earlier active set.
    pub(crate) fn after(self, before: usize) -> Self {
        match self {
            Self::AllClosed { iteration } => Self::AllClosed { iteration: before + iteration },
            Self::Symmetric { sets } => Self::Symmetric { sets },
            Self::Springs { iteration } => Self::Springs { iteration: before + iteration },
            Self::Part { iteration, changed, wanted } => Self::Part { iteration: before + iteration, changed, wanted },
            Self::Cycle(c) => Self::Cycle(Cycle { first: before + c.first, second: before + c.second, rows: c.rows }),
        }
    }
}

/// How an active set iteration went.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ActiveSetReport {
    /// Number of linear systems solved.
    pub iterations: usize,
    /// Number of active rows in each of them.
    pub history: Vec<usize>,
    /// Sign cases after each of them.
    pub sign_cases: Vec<SignCases>,
    /// Updates of the multipliers by an augmented Lagrangian around it; 0 without one.
    pub updates: usize,
    /// The iteration of the best iterate, from 1: the last one where it settled. It is what errors carry.
    pub best: usize,
    /// Cycles, and steps that were not taken whole.
    pub events: Vec<ActiveSetEvent>,
}

impl ActiveSetReport {
    /// The cycles found.
    pub fn cycles(&self) -> impl Iterator<Item = &Cycle> {
        self.events.iter().filter_map(|e| if let ActiveSetEvent::Cycle(cycle) = e { Some(cycle) } else { None })
    }

    /// Rows that violate the contact conditions after each system: in tension, or penetrating.
    pub fn wrong(&self) -> impl Iterator<Item = usize> {
        self.sign_cases.iter().map(|c| c[2] + c[5] + c[6] + c[7] + c[8])
    }
}

impl ActiveSetReport {
    /// The report of both, this one after `before`.
    pub fn after(self, before: &Self) -> Self {
        Self {
            iterations: before.iterations + self.iterations,
            history: before.history.iter().copied().chain(self.history).collect(),
            sign_cases: before.sign_cases.iter().copied().chain(self.sign_cases).collect(),
            updates: before.updates + self.updates,
            best: before.iterations + self.best,
            events: before.events.iter().cloned().chain(self.events.into_iter().map(|e| e.after(before.iterations))).collect(),
        }
    }
}

/// The answer of a constraint solver.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ConstrainedSolution<T: Real = f64> {
    /// u.
    pub unknowns: Vec<T>,
    /// lambda, one per row; zero on open rows.
    pub multipliers: Vec<T>,
    /// (C u + g)_i of every row, open ones too.
    pub gap: Vec<T>,
    /// Whether each row was enforced at the end.
    pub active: Vec<bool>,
    /// Relative residual of the true system.
    pub residual: f64,
    /// An estimate, right to a factor of a few, of the condition of D^-1/2 K D^-1/2 in the spectral norm, D the diagonal, among motions that
    /// keep the enforced rows: how many times errors of the load may grow. None where no factor tells it.
    pub condition: Option<f64>,
    /// What was done, in words: "saddle-point, direct".
    pub method: String,
    /// Iterations of the linear algebra, summed over all systems of an active set; 0 where all was done by factors. Of Uzawa's
    /// iteration over a factor its own, over conjugate gradients theirs.
    pub iterations: usize,
    /// The active set iteration, where there was one.
    pub active_set: Option<ActiveSetReport>,
}

impl<T: Real> ConstrainedSolution<T> {
    /// The same with what was done before it in its report.
    pub fn done_after(mut self, before: &ActiveSetReport) -> Self {
        self.active_set = Some(self.active_set.take().unwrap_or_default().after(before));
        self
    }
}

/// Why a constrained system was not solved.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SolveError {
    /// The linear systems inside failed.
    #[error(transparent)]
    Linear(#[from] LinearError),
    /// This solver knows equalities only; wrap it in an active set.
    #[error("constraint row {row} is a contact row; use an active-set solver")]
    ContactRow {
        /// The row.
        row: usize,
    },
    /// This solver needs B = C.
    #[error("the reaction differs from the transposed constraint; use a solver for non-symmetric systems")]
    NotSymmetric,
    /// This solver knows soft rows only; wrap it in `Augmented`.
    #[error("constraint row {row} is exact; this solver knows soft rows only, an augmented Lagrangian around it knows exact ones")]
    ExactRow {
        /// The row.
        row: usize,
    },
    /// More rows than slave unknowns that can carry them.
    #[error("constraint row {row} has no slave unknown left that it could determine; {rows} rows are too many")]
    OverConstrained {
        /// The row that found none.
        row: usize,
        /// Number of rows.
        rows: usize,
    },
    /// With some contact rows open nothing holds a body any more.
    #[error("a rigid motion is left: with {} contact rows open the system is singular (iteration {iteration})", open.len())]
    RigidMotion {
        /// The iteration, counted from 1, whose system is singular.
        iteration: usize,
        /// Contact rows that are open in it.
        open: Vec<usize>,
        /// The best iterate, where there is one.
        best: Option<Box<ConstrainedSolution<f64>>>,
    },
    /// The active set visited a state twice, and single exchanges did not lead to an end.
    #[error(
        "the active set visited the same state twice (iterations {first} and {second}) and did not settle within {iterations} iterations"
    )]
    Cycling {
        /// First visit.
        first: usize,
        /// Second visit.
        second: usize,
        /// Rows that change between the states of the cycle.
        rows: Vec<usize>,
        /// Linear systems solved.
        iterations: usize,
        /// The best iterate.
        best: Box<ConstrainedSolution<f64>>,
    },
    /// The active set did not settle within the iterations allowed.
    #[error("the active set did not settle within {iterations} iterations")]
    TooManyIterations {
        /// The limit.
        iterations: usize,
        /// The best iterate.
        best: Box<ConstrainedSolution<f64>>,
    },
    /// An augmented Lagrangian did not reach its tolerance.
    #[error(
        "the augmented Lagrangian stopped after {updates} updates of the multipliers at the relative change {error:.1e}; wanted {tolerance:.1e}"
    )]
    Multipliers {
        /// Updates done.
        updates: usize,
        /// Last change of the multipliers, as forces, relative to the largest.
        error: f64,
        /// The error that was wanted.
        tolerance: f64,
        /// The last state computed.
        last: Box<ConstrainedSolution<f64>>,
    },
    /// Who watches the iteration ended it.
    #[error("the active set was stopped after {iterations} iterations")]
    Stopped {
        /// Linear systems solved.
        iterations: usize,
        /// The best iterate, where there is one.
        best: Option<Box<ConstrainedSolution<f64>>>,
    },
    /// Shapes of the system disagree.
    #[error("{what}: {found} given, {expected} expected")]
    Shape {
        /// Which part.
        what: &'static str,
        /// Its size.
        found: usize,
        /// The size that fits.
        expected: usize,
    },
}

/// An algorithm for constrained linear systems.
pub trait ConstraintSolver<T: Real = f64>: Debug + Send {
    /// Solves `system`. Called again with the same pattern, it may reuse what it kept.
    ///
    /// # Errors
    /// [`SolveError`] instead of a wrong answer.
    fn solve(&mut self, system: &ConstrainedSystem<'_, T>) -> Result<ConstrainedSolution<T>, SolveError>;

    /// Solves `system` with a set of contact rows closed and all others open; `closed` has one entry per row, of which those of contact
    /// rows are read. What one set teaches may serve the next: the rows that may close stay the same. `_again`: nothing of the system has
    /// changed since the last call, which was this one with another set.
    ///
    /// # Errors
    /// As [`ConstraintSolver::solve`] of the system with closed rows as equalities.
    fn solve_set(
        &mut self,
        system: &ConstrainedSystem<'_, T>,
        closed: &[bool],
        _again: bool,
    ) -> Result<ConstrainedSolution<T>, SolveError> {
        self.solve(&ConstrainedSystem { kind: &kinds_of_set(system.kind, closed), ..*system })
    }

    /// Whether all sets of the contact rows of `system` share one factor in [`ConstraintSolver::solve_set`].
    ///
    /// # Errors
    /// [`SolveError`] where the system itself is at fault.
    fn shares_factor(&mut self, _system: &ConstrainedSystem<'_, T>) -> Result<bool, SolveError> {
        Ok(false)
    }
}

/// Kinds of rows with a set of the contact rows closed, the others open.
pub(crate) fn kinds_of_set(kind: &[RowKind], closed: &[bool]) -> Vec<RowKind> {
    let of = |(&kind, &closed): (&RowKind, &bool)| match kind {
        RowKind::Contact if closed => RowKind::Equal,
        RowKind::Contact => RowKind::Open,
        other => other,
    };
    kind.iter().zip(closed).map(of).collect()
}

impl<T: Real, X: ConstraintSolver<T> + ?Sized> ConstraintSolver<T> for Box<X> {
    fn solve(&mut self, system: &ConstrainedSystem<'_, T>) -> Result<ConstrainedSolution<T>, SolveError> {
        (**self).solve(system)
    }

    fn solve_set(&mut self, system: &ConstrainedSystem<'_, T>, closed: &[bool], again: bool) -> Result<ConstrainedSolution<T>, SolveError> {
        (**self).solve_set(system, closed, again)
    }

    fn shares_factor(&mut self, system: &ConstrainedSystem<'_, T>) -> Result<bool, SolveError> {
        (**self).shares_factor(system)
    }
}
