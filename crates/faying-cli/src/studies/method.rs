//! What solves a row of a study: a run, or whatever else looks at a case and answers with numbers.

use super::rows::Row;
use crate::case::Case;
use crate::registry::Registry;
use crate::watch::Watch;

/// What a command does with the case of every row.
pub trait Method {
    /// Solves `case`, which `row` describes: the row with its numbers, or several copies of it with one answer each. What fails is a
    /// status of the row.
    fn solve(&self, row: Row, case: &Case, watch: &Watch) -> Vec<Row>;

    /// Looks at all rows together, in the order of the table; `case` is the case as written. Changes nothing unless a method says so.
    fn judge(&self, _rows: &mut [Row], _case: &Case) {}

    /// What all rows together say, in sentences; after [`Method::judge`].
    fn notes(&self, _rows: &[Row]) -> Vec<String> {
        Vec::new()
    }

    /// The options that decide about its answers: rows of an earlier study are kept where they agree.
    fn options(&self) -> String {
        String::new()
    }

    /// Whether rows answer the probes of the case and the quantities that a study adds to them.
    fn answers_quantities(&self) -> bool {
        true
    }
}

/// Every row is a run without its fields.
#[derive(Clone, Copy, Debug)]
pub struct Runs<'a> {
    /// The names of the case.
    pub registry: &'a Registry,
}

impl Method for Runs<'_> {
    fn solve(&self, mut row: Row, case: &Case, watch: &Watch) -> Vec<Row> {
        let command = row.result.command.clone();
        row.result = crate::run::numbers(&command, case, self.registry, watch);
        vec![row]
    }
}
