//! Methods that solve a row of a study: a run, or another computation on a case.

use super::rows::Row;
use crate::case::Case;
use crate::registry::Registry;
use crate::run_control::RunControl;

/// Computation of a command on the case of every row.
pub trait Method {
    /// Solves `case`, which `row` describes: returns the row with its numbers, or several copies of it with one result each. Failures are
    /// reported by the status of the row.
    fn solve(&self, row: Row, case: &Case, watch: &RunControl) -> Vec<Row>;

    /// Evaluates all rows together, in the order of the table; `case` is the case as written. Changes nothing by default.
    fn judge(&self, _rows: &mut [Row], _case: &Case) {}

    /// Sentences on all rows together; called after [`Method::judge`].
    fn notes(&self, _rows: &[Row]) -> Vec<String> {
        Vec::new()
    }

    /// The options that affect its results: rows of an earlier study are kept if they agree.
    fn options(&self) -> String {
        String::new()
    }

    /// Whether rows evaluate the probes of the case and the quantities that a study adds to them.
    fn answers_quantities(&self) -> bool {
        true
    }
}

/// Method of runs: every row is a run without its fields.
#[derive(Clone, Copy, Debug)]
pub struct Runs<'a> {
    /// The registry of names.
    pub registry: &'a Registry,
}

impl Method for Runs<'_> {
    fn solve(&self, mut row: Row, case: &Case, watch: &RunControl) -> Vec<Row> {
        let command = row.result.command.clone();
        row.result = crate::run::numbers(&command, case, self.registry, watch);
        vec![row]
    }
}
