//! Floor 9: algorithms for constrained linear systems, given as matrices only.
//!
//! ```text
//! K u + Bᵀ lambda = f,   rows C u + g: zero, compliant, or a non-negative gap
//! ```

mod abilities;
mod active_set;
mod augmented;
mod complement;
mod condensed;
mod direct;
mod free;
mod interface;
mod interface_set;
mod krylov;
mod outer;
mod penalised;
mod quasidefinite;
mod refinement;
mod rows_alone;
pub mod scale;
mod schur;
mod verified;

use crate::coupling::Rows;
use crate::linalg::residual::RESIDUAL_LIMIT;
use crate::linalg::{LinearError, Operator, Real};
use std::fmt::Debug;

pub use abilities::Abilities;
pub use active_set::{ActiveSet, SetIteration, Softening, sign_case_of_rows};
pub use augmented::{Augmented, Uzawa};
pub use condensed::Condensed;
pub use direct::Direct;
pub use free::PenaltyElimination;
pub use interface::InterfaceWork;
pub use krylov::Krylov;
pub use outer::{Answered, Next, Outer, RowChange, RowIteration};
pub use rows_alone::RowsAlone;
pub use scale::penalty;
pub use schur::Schur;
pub use verified::verified;

/// Kind of a constraint row: equality, contact inequality, or not enforced.
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
    /// Iteration that would have repeated it.
    pub second: usize,
    /// Rows that change between the states of the cycle.
    pub rows: Vec<usize>,
}

/// Deviation of an active-set iteration from its nominal steps.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum ActiveSetEvent {
    /// The wanted state left a body free; all rows were closed instead.
    AllClosed {
        /// The iteration that began with all rows closed.
        iteration: usize,
    },
    /// The wanted state left a body free; only some of its rows changed.
    Part {
        /// The iteration.
        iteration: usize,
        /// Rows that changed.
        changed: usize,
        /// Rows that were to change.
        wanted: usize,
    },
    /// The initial guess was decided by the rows of the system with C in place of B.
    Symmetric {
        /// Number of its sets, which do not count as iterations.
        sets: usize,
    },
    /// An event among the sets that the rows alone decided; its iterations are numbers of sets.
    Alone(Box<ActiveSetEvent>),
    /// Every step left a body free: the iteration restarted from the active set found with weak springs to the ground.
    Springs {
        /// The iteration whose system was singular.
        iteration: usize,
    },
    /// A state was repeated; single exchanges followed.
    Cycle(Cycle),
}

impl ActiveSetEvent {
    /// Shifts the iteration numbers by the `before` iterations of an earlier active set.
    pub(crate) fn after(self, before: usize) -> Self {
        match self {
            Self::AllClosed { iteration } => Self::AllClosed { iteration: before + iteration },
            Self::Symmetric { .. } | Self::Alone(_) => self,
            Self::Springs { iteration } => Self::Springs { iteration: before + iteration },
            Self::Part { iteration, changed, wanted } => Self::Part { iteration: before + iteration, changed, wanted },
            Self::Cycle(c) => Self::Cycle(Cycle { first: before + c.first, second: before + c.second, rows: c.rows }),
        }
    }
}

/// Report of an active-set iteration.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ActiveSetReport {
    /// Number of linear systems solved.
    pub iterations: usize,
    /// Number of active rows in each of them.
    pub history: Vec<usize>,
    /// Number of active rows, or groups of rows, in each set that the rows alone decided before.
    pub sets: Vec<usize>,
    /// Sign cases after each of them.
    pub sign_cases: Vec<SignCases>,
    /// Updates of the multipliers by an enclosing augmented Lagrangian; 0 without one.
    pub updates: usize,
    /// Iteration of the best iterate, counted from 1; the last one on convergence. Errors carry this iterate.
    pub best: usize,
    /// Cycles and other deviations from nominal steps.
    pub events: Vec<ActiveSetEvent>,
}

impl ActiveSetReport {
    /// The cycles found.
    pub fn cycles(&self) -> impl Iterator<Item = &Cycle> {
        self.events.iter().filter_map(|e| if let ActiveSetEvent::Cycle(cycle) = e { Some(cycle) } else { None })
    }

    /// Rows that violate the contact conditions after each system: in tension, or penetrating.
    pub fn violated(&self) -> impl Iterator<Item = usize> {
        self.sign_cases.iter().map(|c| c[2] + c[5] + c[6] + c[7] + c[8])
    }
}

impl ActiveSetReport {
    /// Appends this report to `before`.
    #[must_use]
    pub fn after(self, before: &Self) -> Self {
        Self {
            iterations: before.iterations + self.iterations,
            history: before.history.iter().copied().chain(self.history).collect(),
            sets: before.sets.iter().copied().chain(self.sets).collect(),
            sign_cases: before.sign_cases.iter().copied().chain(self.sign_cases).collect(),
            updates: before.updates + self.updates,
            best: before.iterations + self.best,
            events: before.events.iter().cloned().chain(self.events.into_iter().map(|e| e.after(before.iterations))).collect(),
        }
    }
}

/// Solution of a constrained system.
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
    /// Estimate, within a small factor, of the spectral condition number of D^-1/2 K D^-1/2, D the diagonal, on the null space of the
    /// enforced rows: the amplification of relative errors of the load. `None` if the method has no factor to compute it.
    pub condition: Option<f64>,
    /// Name of the method used, e.g. "saddle-point, direct".
    pub method: String,
    /// Linear iterations, summed over all systems of an active set; 0 for direct solvers. Uzawa's iteration counts its own iterations
    /// over a factor, and the inner ones over conjugate gradients.
    pub iterations: usize,
    /// Report of the active-set iteration; `None` without one.
    pub active_set: Option<ActiveSetReport>,
}

impl<T: Real> ConstrainedSolution<T> {
    /// Prepends the report `before` to that of this solution.
    #[must_use]
    pub fn done_after(mut self, before: &ActiveSetReport) -> Self {
        self.active_set = Some(self.active_set.take().unwrap_or_default().after(before));
        self
    }
}

/// Error of a constraint solver.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SolveError {
    /// An inner linear solver failed.
    #[error(transparent)]
    Linear(#[from] LinearError),
    /// The solver handles equalities only; wrap it in [`ActiveSet`].
    #[error("constraint row {row} is a contact row; use an active-set solver")]
    ContactRow {
        /// The row.
        row: usize,
    },
    /// The solver needs a symmetric system, B = C.
    #[error("the reaction differs from the transposed constraint; use a solver for non-symmetric systems")]
    NotSymmetric,
    /// The solver handles soft rows only; wrap it in [`Augmented`].
    #[error("constraint row {row} is exact; this solver knows soft rows only, an augmented Lagrangian around it knows exact ones")]
    ExactRow {
        /// The row.
        row: usize,
    },
    /// There are more rows than slave unknowns to eliminate.
    #[error("constraint row {row} has no slave unknown left that it could determine; {rows} rows are too many")]
    OverConstrained {
        /// The row without a slave unknown.
        row: usize,
        /// Number of rows.
        rows: usize,
    },
    /// With the open contact rows a body has a rigid motion.
    #[error("a rigid motion is left: with {} contact rows open the system is singular (iteration {iteration})", open.len())]
    RigidMotion {
        /// The iteration, counted from 1, whose system is singular.
        iteration: usize,
        /// Contact rows that are open in it.
        open: Vec<usize>,
        /// The best iterate, if any.
        best: Option<Box<ConstrainedSolution<f64>>>,
    },
    /// The active set visited a state twice, and single exchanges did not converge.
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
    /// The active set did not converge within the iteration limit.
    #[error("the active set did not settle within {iterations} iterations")]
    TooManyIterations {
        /// The limit.
        iterations: usize,
        /// The best iterate.
        best: Box<ConstrainedSolution<f64>>,
    },
    /// An augmented Lagrangian did not reach its tolerance.
    #[error(
        "the augmented Lagrangian stopped after {updates} updates of the multipliers with a relative error of {error:.1e}; wanted {tolerance:.1e}"
    )]
    Multipliers {
        /// Updates done.
        updates: usize,
        /// The greater of what the multipliers still have to change and of the gaps left times the stiffness of the bodies, as forces,
        /// relative to the largest multiplier.
        error: f64,
        /// The tolerance.
        tolerance: f64,
        /// The last state computed.
        last: Box<ConstrainedSolution<f64>>,
    },
    /// Cancelled by the observer.
    #[error("the active set was stopped after {iterations} iterations")]
    Stopped {
        /// Linear systems solved.
        iterations: usize,
        /// The best iterate, if any.
        best: Option<Box<ConstrainedSolution<f64>>>,
    },
    /// The answer of a solver does not solve the system.
    #[error("the answer of the constraint solver leaves the relative residual {residual:.1e}; its tolerance is {tolerance:.1e}")]
    Residual {
        /// The true residual.
        residual: f64,
        /// The largest one that the solver promises.
        tolerance: f64,
    },
    /// The answer of a solver breaks the conditions of contact.
    #[error(
        "the answer of the constraint solver breaks the conditions of contact: row {row} has the multiplier {multiplier:.3e} at the gap {gap:.3e}"
    )]
    Conditions {
        /// The row.
        row: usize,
        /// Its multiplier.
        multiplier: f64,
        /// Its gap.
        gap: f64,
    },
    /// Shapes of the system disagree.
    #[error("{what}: {found} given, {expected} expected")]
    Shape {
        /// Name of the part.
        what: &'static str,
        /// Its size.
        found: usize,
        /// Expected size.
        expected: usize,
    },
}

/// An algorithm for constrained linear systems.
pub trait ConstraintSolver<T: Real = f64>: Debug + Send {
    /// Solves `system`. Data kept from an earlier call with the same pattern may be reused.
    ///
    /// # Errors
    /// [`SolveError`] if no accurate solution was found.
    fn solve(&mut self, system: &ConstrainedSystem<'_, T>) -> Result<ConstrainedSolution<T>, SolveError>;

    /// Systems that it solves; the answer is the same before and after every system.
    fn abilities(&self) -> Abilities;

    /// Largest relative residual of its answers: [`verified`] refuses larger ones. Iterative methods return their tolerance.
    fn tolerance(&self) -> f64 {
        RESIDUAL_LIMIT
    }

    /// Solves `system` with a set of contact rows closed and all others open; `closed` has one entry per row, of which those of contact
    /// rows are read. Data may be shared between sets, as the contact rows stay the same. `_again`: the last call was this one with
    /// another set, and the system has not changed since.
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

    /// The contact rows of `system` alone, whose sets take no solution of the unknowns; `groups`: lists of contact rows, each summed up as
    /// one row. `None` where sets take no less that way. `_again`: the last call was this one with other groups, and the system has not
    /// changed since.
    ///
    /// # Errors
    /// [`SolveError`] if the system itself is invalid, or its factor fails.
    fn rows_alone(
        &mut self,
        _system: &ConstrainedSystem<'_, T>,
        _groups: &[Vec<usize>],
        _again: bool,
    ) -> Result<Option<RowsAlone>, SolveError> {
        Ok(None)
    }

    /// Number of factorisations of whole systems so far.
    fn factors(&self) -> usize {
        0
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

    fn abilities(&self) -> Abilities {
        (**self).abilities()
    }

    fn tolerance(&self) -> f64 {
        (**self).tolerance()
    }

    fn solve_set(&mut self, system: &ConstrainedSystem<'_, T>, closed: &[bool], again: bool) -> Result<ConstrainedSolution<T>, SolveError> {
        (**self).solve_set(system, closed, again)
    }

    fn rows_alone(
        &mut self,
        system: &ConstrainedSystem<'_, T>,
        groups: &[Vec<usize>],
        again: bool,
    ) -> Result<Option<RowsAlone>, SolveError> {
        (**self).rows_alone(system, groups, again)
    }

    fn factors(&self) -> usize {
        (**self).factors()
    }
}
