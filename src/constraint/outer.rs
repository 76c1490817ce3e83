//! The loop around a solver of contact rows in which methods change their rows from one system to the next.
//!
//! Every system has what [`RowIteration::row`] of the method of a row says: another kind, a shift of its offset, a compliance. Each method
//! looks at the answer to its own rows, until all of them are done. Rows of no method stay as they are: exact contact, ties and penalties
//! may be in the same system.

use super::scale::{RowScales, check_shape, combined, gaps, row_scales};
use super::verified::complete;
use super::{Abilities, ActiveSetReport, ConstrainedSolution, ConstrainedSystem, ConstraintSolver, RowKind, SolveError};
use crate::linalg::Csr;
use std::fmt::Debug;
use std::ops::Range;

/// Default limit of the number of systems.
const MAX_UPDATES: usize = 200;

/// Changes of a row in the next system.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RowChange {
    /// Its kind; `None`: that of the system.
    pub kind: Option<RowKind>,
    /// Added to its offset g_j.
    pub shift: f64,
    /// Its compliance, gap / lambda; `None`: that of the system.
    pub compliance: Option<f64>,
}

/// The last system and its answer, as the method of some of its rows sees them.
#[derive(Debug)]
pub struct Answered<'a> {
    /// The system without changes of rows.
    pub system: &'a ConstrainedSystem<'a>,
    /// The answer to the changed system; its gaps C u + g are those of the rows without changes.
    pub solution: &'a ConstrainedSolution,
    /// Stiffness and weight of every row of the system.
    pub scales: &'a RowScales<f64>,
    /// C, all rows of the system.
    pub rows: &'a Csr,
    /// Rows of the method.
    pub range: Range<usize>,
}

/// Decision of a method about an answer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Next {
    /// The rows are as they shall be.
    Done,
    /// Another system is needed.
    Again {
        /// Error of the answer, relative to the largest multiplier.
        error: f64,
        /// Error wanted.
        tolerance: f64,
    },
    /// No other system would help.
    Failed {
        /// Error of the answer, relative to the largest multiplier.
        error: f64,
        /// Error wanted.
        tolerance: f64,
    },
}

/// An iteration that changes rows between systems. Rows are counted from the first of the method.
pub trait RowIteration: Debug + Send {
    /// Name in descriptions of the linear algebra.
    fn name(&self) -> &'static str;
    /// Changes of row `j` in the next system.
    fn row(&self, j: usize) -> RowChange;
    /// Takes the answer and decides what follows.
    fn next(&mut self, answered: &Answered<'_>) -> Next;
    /// Error of the multipliers at which it ends, relative to the largest; the check of the answer is as loose as the loosest of all.
    fn tolerance(&self) -> f64;
    /// Asks for an error of at most `tolerance`: rows of one system are as accurate as those of the strictest iteration, as an error in
    /// some is one in all. Iterations without a tolerance of their own ignore it.
    fn tighten(&mut self, tolerance: f64) {
        let _ = tolerance;
    }
}

/// Solver that changes rows between the systems of another.
#[derive(Debug)]
pub struct Outer<C> {
    /// Solves the systems.
    pub inner: C,
    /// Iterations with their rows, which do not overlap.
    pub parts: Vec<(Range<usize>, Box<dyn RowIteration>)>,
    /// Systems allowed.
    pub max_updates: usize,
}

impl<C> Outer<C> {
    /// Iterates `inner` until all `parts` are done, to the least of their tolerances, in at most 200 systems.
    pub fn new(inner: C, mut parts: Vec<(Range<usize>, Box<dyn RowIteration>)>) -> Self {
        let least = parts.iter().map(|(_, part)| part.tolerance()).fold(f64::INFINITY, f64::min);
        parts.iter_mut().for_each(|(_, part)| part.tighten(least));
        Self { inner, parts, max_updates: MAX_UPDATES }
    }

    /// Name of the iterations, each once.
    fn name(&self) -> String {
        let mut names: Vec<&str> = self.parts.iter().map(|(_, part)| part.name()).collect();
        names.dedup();
        names.join(", ")
    }
}

impl<C: ConstraintSolver<f64>> ConstraintSolver<f64> for Outer<C> {
    fn abilities(&self) -> Abilities {
        self.inner.abilities()
    }

    fn tolerance(&self) -> f64 {
        self.parts.iter().fold(self.inner.tolerance(), |most, (_, part)| most.max(part.tolerance()))
    }

    fn factors(&self) -> usize {
        self.inner.factors()
    }

    fn solve(&mut self, system: &ConstrainedSystem<'_, f64>) -> Result<ConstrainedSolution<f64>, SolveError> {
        if self.parts.is_empty() {
            return self.inner.solve(system);
        }
        check_shape(system)?;
        let (n, m) = (system.stiffness.size(), system.offset.len());
        if let Some((range, _)) = self.parts.iter().find(|(range, _)| range.end > m) {
            return Err(SolveError::Shape { what: "rows of an iteration", found: range.end, expected: m });
        }
        let scales = row_scales(&system.stiffness.diagonal(), system.constraint, m);
        let rows = combined(system.constraint, m, n);
        let (mut offset, mut kind) = (system.offset.to_vec(), system.kind.to_vec());
        let mut compliance: Vec<f64> = (0..m).map(|j| system.compliance.get(j).copied().unwrap_or(0.0)).collect();
        let mut report = ActiveSetReport::default();
        let mut last: Option<ConstrainedSolution<f64>> = None;
        let mut linear = 0;
        loop {
            for (range, part) in &self.parts {
                for (j, row) in range.clone().enumerate() {
                    let change = part.row(j);
                    offset[row] = system.offset[row] + change.shift;
                    kind[row] = change.kind.unwrap_or(system.kind[row]);
                    compliance[row] = change.compliance.unwrap_or_else(|| system.compliance.get(row).copied().unwrap_or(0.0));
                }
            }
            let changed = ConstrainedSystem { offset: &offset, kind: &kind, compliance: &compliance, ..*system };
            let mut solution = match self.inner.solve(&changed) {
                Ok(solution) => complete(&changed, &solution).map(|()| solution)?,
                Err(error) => return Err(with_last(error, system, &report, last)),
            };
            solution.gap = gaps(system, &solution.unknowns);
            linear += solution.iterations;
            solution.iterations = linear;
            solution = solution.done_after(&report);
            report = solution.active_set.clone().unwrap_or_default();
            report.updates += 1;
            solution.active_set = Some(report.clone());
            let (mut again, mut failed): (Option<(f64, f64)>, bool) = (None, false);
            for (range, part) in &mut self.parts {
                let answered = Answered { system, solution: &solution, scales: &scales, rows: &rows, range: range.clone() };
                match part.next(&answered) {
                    Next::Done => {}
                    Next::Again { error, tolerance } => again = worse(again, (error, tolerance)),
                    Next::Failed { error, tolerance } => {
                        failed = true;
                        again = worse(again, (error, tolerance));
                    }
                }
            }
            let Some((error, tolerance)) = again else {
                solution.method = format!("{}, {}", self.name(), solution.method);
                return Ok(solution);
            };
            if failed || report.updates >= self.max_updates {
                return Err(SolveError::Multipliers { updates: report.updates, error, tolerance, last: Box::new(solution) });
            }
            last = Some(solution);
        }
    }
}

/// The error and tolerance of the greater error.
fn worse(known: Option<(f64, f64)>, new: (f64, f64)) -> Option<(f64, f64)> {
    Some(known.filter(|known| known.0 >= new.0).unwrap_or(new))
}

/// Converts the `error` of a system to one of the whole iteration, with its last iterate or, if it has none, that of `before`.
fn with_last(
    error: SolveError,
    system: &ConstrainedSystem<'_, f64>,
    report: &ActiveSetReport,
    before: Option<ConstrainedSolution<f64>>,
) -> SolveError {
    let whole = |last: Option<Box<ConstrainedSolution<f64>>>| match last {
        Some(mut last) if last.unknowns.len() == system.load.len() => {
            last.gap = gaps(system, &last.unknowns);
            Some(Box::new(last.done_after(report)))
        }
        _ => before.clone().map(Box::new),
    };
    match error {
        SolveError::RigidMotion { iteration, open, best } => SolveError::RigidMotion { iteration, open, best: whole(best) },
        SolveError::Stopped { iterations, best } => SolveError::Stopped { iterations: report.iterations + iterations, best: whole(best) },
        SolveError::Cycling { first, second, rows, iterations, best } => {
            SolveError::Cycling { first, second, rows, iterations, best: whole(Some(best)).unwrap_or_default() }
        }
        SolveError::TooManyIterations { iterations, best } => {
            SolveError::TooManyIterations { iterations, best: whole(Some(best)).unwrap_or_default() }
        }
        other => other,
    }
}
