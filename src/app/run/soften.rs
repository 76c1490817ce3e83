//! Softness of the rows of a model, and the contact solver that goes with it.

use crate::app::build::{Formulation, Model};
use crate::app::watch::{Progress, Watch};
use crate::assembly::Blocks;
use crate::constraint::{
    ActiveSet, ConstrainedSolution, ConstrainedSystem, ConstraintSolver, IterationNews, Proximal, SolveError, penalty,
};
use crate::contact::Contact;
use crate::coupling::Rows;

/// What is soft in a model: gap / lambda per row.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Softness {
    /// Of penalties; empty: all rows are exact.
    pub compliance: Vec<f64>,
    /// Of the rows that an augmented Lagrangian makes exact; empty: there are none.
    augmented: Vec<f64>,
    /// Error of the multipliers at which its iteration ends.
    tolerance: f64,
}

impl Softness {
    /// Of all ties and contacts, by the stiffness of the bodies, which supports do not change.
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
                // rows at points bring their own
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

    /// Solves a system with contact rows by `set`, made exact where the model asks for an augmented Lagrangian.
    ///
    /// # Errors
    /// Those of the active set and of [`Proximal`].
    pub fn solve(
        &self,
        set: &mut ActiveSet<Box<dyn ConstraintSolver>>,
        system: &ConstrainedSystem<'_>,
        watch: &Watch,
    ) -> Result<ConstrainedSolution, SolveError> {
        let mut inner = Watched { set, watch, done: 0 };
        if self.augmented.is_empty() {
            return inner.solve(system);
        }
        // rows that have no weight cannot be softened, and face nothing
        Proximal { tolerance: self.tolerance, ..Proximal::new(inner, self.augmented.clone()) }.solve(system)
    }
}

/// An active set that tells of its iterations; solved again it starts from where it ended.
#[derive(Debug)]
struct Watched<'a> {
    set: &'a mut ActiveSet<Box<dyn ConstraintSolver>>,
    watch: &'a Watch,
    /// Linear systems of the solves before.
    done: usize,
}

impl ConstraintSolver<f64> for Watched<'_> {
    fn solve(&mut self, system: &ConstrainedSystem<'_, f64>) -> Result<ConstrainedSolution<f64>, SolveError> {
        let (watch, done) = (self.watch, self.done);
        let solution = self.set.solve_watched(system, &mut |news: IterationNews| {
            if watch.stop().is_some() {
                return false;
            }
            watch.report(Progress::Iteration { iteration: done + news.iteration, active: news.active, rows: news.rows });
            true
        })?;
        self.done += solution.active_set.as_ref().map_or(0, |r| r.iterations);
        self.set.start.clone_from(&solution.active);
        Ok(solution)
    }
}
