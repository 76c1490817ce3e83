//! Enforcement of the rows of ties and contacts in a system: their compliance, and what changes them between systems.

use super::model::Model;
use super::observer::{Observer, Progress};
use super::start::Start;
use crate::assembly::Blocks;
use crate::constraint::{
    ActiveSet, ConstrainedSolution, ConstrainedSystem, ConstraintSolver, Outer, RowIteration, Softening, SolveError, penalty,
};
use crate::contact::{ContactError, ContactRows};
use crate::coupling::Rows;
use std::ops::Range;

/// Enforcement of rows.
#[derive(Debug, Default)]
pub(super) struct Enforced {
    /// gap / lambda per row; empty: all rows are exact.
    pub compliance: Vec<f64>,
    /// Contact rows that are made softer on the way to a first state.
    pub eased: Vec<bool>,
    /// Iterations of methods, with their rows.
    pub iterations: Vec<(Range<usize>, Box<dyn RowIteration>)>,
}

impl Enforced {
    /// The enforcement of all ties and contacts, by the stiffness of the bodies, which supports do not change; `first`: no step before says
    /// which rows are closed.
    ///
    /// # Errors
    /// [`ContactError::Rows`] for a method that has not one compliance per row.
    pub fn of<const S: usize, const N: usize>(
        model: &Model<S, N>,
        matrices: &Blocks<'_>,
        rows: &Rows,
        built: &[Vec<ContactRows<S, N>>],
        first: bool,
    ) -> Result<Self, ContactError> {
        let mut all = Self { eased: vec![false; model.rows], ..Self::default() };
        let unit = std::cell::OnceCell::new();
        let unit = |row: usize| unit.get_or_init(|| penalty(&matrices.bodies_diagonal(), rows, model.rows, 1.0))[row];
        for part in model.ties.iter().flat_map(|tie| &tie.parts) {
            let Some(factor) = part.penalty else { continue };
            all.compliance.resize(model.rows, 0.0);
            (part.first_row..part.first_row + part.num_rows).for_each(|row| all.compliance[row] = unit(row) / factor);
        }
        for (contact, built) in model.contacts.iter().zip(built) {
            let starts_anyhow = matches!(contact.start, Start::Auto | Start::All) && first;
            for (part, built) in contact.parts.iter().zip(built) {
                let begun = contact.method.begin(built, &|j| unit(part.first_row + j));
                if !begun.compliance.is_empty() {
                    if begun.compliance.len() != part.num_rows {
                        let (found, rows) = (begun.compliance.len(), part.num_rows);
                        return Err(ContactError::Rows(format!("{found} compliances of {rows} rows of \"{}\"", contact.name)));
                    }
                    all.compliance.resize(model.rows, 0.0);
                    all.compliance[part.rows()].copy_from_slice(&begun.compliance);
                }
                all.eased[part.rows()].fill(begun.eased && starts_anyhow);
                all.iterations.extend(begun.iteration.map(|iteration| (part.rows(), iteration)));
            }
        }
        Ok(all)
    }

    /// Solves a system with contact rows by `set`, and `iterations` of methods around it; `eased`: rows that are made softer first.
    ///
    /// # Errors
    /// Errors of the active set and of [`Outer`].
    pub fn solve(
        iterations: Vec<(Range<usize>, Box<dyn RowIteration>)>,
        eased: Vec<bool>,
        set: &mut ActiveSet<Box<dyn ConstraintSolver>>,
        system: &ConstrainedSystem<'_>,
        observer: Observer<'_>,
    ) -> Result<ConstrainedSolution, SolveError> {
        let mut watch = |done: usize, news: crate::constraint::SetIteration| {
            let at = Progress::Iteration { iteration: done + news.iteration, active: news.active, rows: news.rows };
            observer(&at).is_continue()
        };
        Outer::new(Softening::new(set, eased, &mut watch), iterations).solve(system)
    }
}
