//! Compliance of the rows of a model, and the solution of contact systems with it.

use super::model::{Formulation, Model};
use super::observer::{Observer, Progress};
use crate::assembly::Blocks;
use crate::constraint::{
    Abilities, ActiveSet, ActiveSetReport, ConstrainedSolution, ConstrainedSystem, ConstraintSolver, IterationNews, Proximal, SolveError,
    penalty,
};
use crate::contact::Contact;
use crate::coupling::Rows;

/// Softness of the rows of a model: gap / lambda per row.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Softness {
    /// Softness of penalties; empty: all rows are exact.
    pub compliance: Vec<f64>,
    /// Softness of the rows that an augmented Lagrangian makes exact; empty: there are none.
    augmented: Vec<f64>,
    /// Error of the multipliers at which the augmented Lagrangian iteration ends.
    tolerance: f64,
}

impl Softness {
    /// Softness of all ties and contacts, by the stiffness of the bodies, which supports do not change.
    pub fn of<const S: usize, const N: usize>(
        model: &Model<S, N>,
        matrices: &Blocks<'_>,
        rows: &Rows,
        built: &[Vec<Contact<S, N>>],
    ) -> Self {
        let mut soft = Self { tolerance: f64::INFINITY, ..Self::default() };
        let ties = model.ties.iter().flat_map(|tie| &tie.parts);
        let penalties = ties.filter_map(|part| Some((part.first_row..part.first_row + part.num_rows, part.penalty?)));
        let contacts = model.contacts.iter().flat_map(|c| c.parts.iter().map(move |part| (c.formulation, part.rows())));
        let mut unit = None;
        let mut unit = |row: usize| unit.get_or_insert_with(|| penalty(&matrices.bodies_diagonal(), rows, model.rows, 1.0))[row];
        let mut soften = |list: &mut Vec<f64>, range: std::ops::Range<usize>, factor: f64| {
            list.resize(model.rows, 0.0);
            range.for_each(|row| list[row] = unit(row) / factor);
        };
        for (range, factor) in penalties {
            soften(&mut soft.compliance, range, factor);
        }
        for (formulation, range) in contacts {
            match formulation {
                Formulation::Penalty { factor } => soften(&mut soft.compliance, range, factor),
                Formulation::Augmented { factor, tolerance } => {
                    soft.tolerance = soft.tolerance.min(tolerance);
                    soften(&mut soft.augmented, range, factor);
                }
                // rows of Nitsche's method have their own compliance
                Formulation::Lagrange | Formulation::Nitsche(_) => {}
            }
        }
        for (part, built) in model.contacts.iter().flat_map(|c| &c.parts).zip(built.iter().flatten()) {
            if let Some(points) = &built.points {
                soft.compliance.resize(model.rows, 0.0);
                soft.compliance[part.rows()].copy_from_slice(&points.compliance);
            }
        }
        soft
    }

    /// Whether no row is made exact by an augmented Lagrangian.
    pub fn is_exact(&self) -> bool {
        self.augmented.is_empty()
    }

    /// Error of the multipliers that an augmented Lagrangian makes exact; zero if there are none.
    pub fn error(&self) -> f64 {
        if self.is_exact() { 0.0 } else { self.tolerance }
    }

    /// Solves a system with contact rows by `set`, with an augmented Lagrangian iteration if the model asks for it. `eased`: contact rows
    /// at points whose initial active set is arbitrary.
    ///
    /// # Errors
    /// Errors of the active set and of [`Proximal`].
    pub fn solve(
        &self,
        set: &mut ActiveSet<Box<dyn ConstraintSolver>>,
        system: &ConstrainedSystem<'_>,
        eased: Vec<bool>,
        observer: Observer<'_>,
    ) -> Result<ConstrainedSolution, SolveError> {
        let mut inner = Watched { set, observer, eased, done: 0 };
        if self.augmented.is_empty() {
            return inner.solve(system);
        }
        // rows without weight get no compliance; they face nothing
        Proximal { tolerance: self.tolerance, ..Proximal::new(inner, self.augmented.clone()) }.solve(system)
    }
}

/// Iterations after which an initial active set with points is considered a bad one.
const PATIENCE: usize = 10;
/// Factors by which rows of points are made softer on the way to a good first state.
const SOFTER: [f64; 4] = [1e4, 1e3, 1e2, 1e1];

/// Active set that reports its iterations; solved again it starts from its last set.
///
/// A set of points that is far too large, such as all of them, is peeled a few points per iteration: where bodies part, the fields
/// of the too large zone oscillate. Softer rows do not: each is open or closed by its own gap. Where points do not settle soon, they
/// settle on softer rows first, from each softness to the next.
struct Watched<'a> {
    set: &'a mut ActiveSet<Box<dyn ConstraintSolver>>,
    observer: Observer<'a>,
    /// Rows that are made softer on the way; empty: none.
    eased: Vec<bool>,
    /// Iterations so far.
    done: usize,
}

impl std::fmt::Debug for Watched<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Watched").field("set", &self.set).finish_non_exhaustive()
    }
}

impl Watched<'_> {
    /// Runs at most `most` iterations of the active set from its present state.
    fn run(&mut self, system: &ConstrainedSystem<'_>, most: usize) -> Result<ConstrainedSolution, SolveError> {
        let (observer, done, limit) = (self.observer, self.done, self.set.max_iterations);
        let mut last = 0;
        self.set.max_iterations = most;
        let solved = self.set.solve_watched(system, &mut |news: IterationNews| {
            last = news.iteration;
            let at = Progress::Iteration { iteration: done + news.iteration, active: news.active, rows: news.rows };
            observer(&at).is_continue()
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

impl ConstraintSolver<f64> for Watched<'_> {
    fn abilities(&self) -> Abilities {
        self.set.abilities()
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
