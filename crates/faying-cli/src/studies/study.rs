//! A study with all its rows: solved in order, compared, judged.

use super::axes::Axes;
use super::method::Method;
use super::quantities::{Asked, asked};
use super::rates;
use super::rows::{Base, Row, Spec};
use super::stored_rows::{self, StoredRows};
use crate::case::Case;
use crate::errors::{Diagnostic, Diagnostics};
use crate::registry::Registry;
use crate::result::Status;
use crate::run_control::{RunControl, Stop};
use indexmap::IndexMap;
use std::collections::BTreeMap;

/// Codes in the order in which they decide the exit code of several rows.
const PRECEDENCE: [i32; 7] = [130, 70, 4, 6, 5, 3, 1];

/// Result of `--tol` for one quantity.
#[derive(Clone, Debug, PartialEq)]
pub struct Tolerance {
    /// Name of the quantity in the table.
    pub quantity: String,
    /// Largest relative difference from the first row; not finite if a row has no value.
    pub largest: f64,
    /// Position of the row with it.
    pub row: usize,
    /// Whether every row is within the tolerance.
    pub ok: bool,
}

/// Definition of a study.
#[derive(Clone, Debug)]
pub struct StudyPlan<'a> {
    /// "compare", "convergence", ...
    pub command: &'a str,
    /// The case as written.
    pub written: &'a Case,
    /// The case before a row changes it.
    pub base: Base<'a>,
    /// The registry of names.
    pub registry: &'a Registry,
    /// The axes to vary.
    pub axes: Axes,
    /// Names of probes or quantities; empty: the default of [`asked`].
    pub quantities: &'a [String],
    /// Whether rows are compared with the first one of the same degree, level and keys.
    pub compares: bool,
    /// Largest relative difference that is allowed between them.
    pub tol: Option<f64>,
    /// Rows of an earlier study.
    pub kept: Option<&'a StoredRows>,
}

/// A study and its rows.
#[derive(Clone, Debug)]
pub struct Study {
    /// "compare", ...
    pub command: String,
    /// The case file's name.
    pub case: String,
    /// The case's title.
    pub title: String,
    /// The axes.
    pub axes: Axes,
    /// The quantities.
    pub asked: Vec<Asked>,
    /// Every row that was begun.
    pub rows: Vec<Row>,
    /// Rows that were to be solved.
    pub planned: usize,
    /// Reason for missing last rows, if there are any.
    pub stopped: Option<Stop>,
    /// The tolerance of differences and what it found.
    pub tolerance: Option<(f64, Vec<Tolerance>)>,
    /// Warnings about the study as a whole.
    pub warnings: Vec<Diagnostic>,
    /// Sentences on all rows together.
    pub notes: Vec<String>,
    /// Text of the file for `--resume`: every row with a key of its inputs.
    pub stored: String,
}

impl StudyPlan<'_> {
    /// The rows in their order.
    ///
    /// # Errors
    /// The number of rows if there are too many; see [`Axes::rows`].
    pub fn rows(&self) -> Result<Vec<Spec>, usize> {
        self.axes.rows(&self.base, self.registry)
    }

    /// Reads and solves every row of `specs` by `method`; calls `begins` before each with position, number of rows, name.
    ///
    /// A row that fails stays and the next ones are solved; after a stop by `watch` no further row is begun.
    pub fn solve(self, specs: &[Spec], method: &dyn Method, watch: &RunControl, mut begins: impl FnMut(usize, usize, &str)) -> Study {
        let asked = if method.answers_quantities() { asked(self.written, self.quantities, self.axes.levels) } else { Vec::new() };
        let added = asked.iter().filter(|a| a.is_added()).map(|a| (a.probe.clone(), a.quantity.clone())).collect();
        let mut base = self.base.clone();
        base.options.changes.quantities = added;
        // the case as written with all defaults, to compare rows with
        let as_written = base.read(&Spec::default()).map(|case| case.effective_toml().to_owned()).unwrap_or_default();
        let (mut rows, mut keys) = (Vec::with_capacity(specs.len()), Vec::with_capacity(specs.len()));
        let command = format!("{} {}", self.command, method.options());
        let mut stopped = None;
        for (k, spec) in specs.iter().enumerate() {
            stopped = watch.stop().filter(|_| k > 0);
            if stopped.is_some() {
                break;
            }
            let case = base.read(spec);
            let key = stored_rows::key(&command, &base, spec, case.as_ref().ok());
            let known = self.kept.and_then(|kept| kept.rows(&key, self.command, spec, &base));
            let found = known.unwrap_or_else(|| {
                begins(k, specs.len(), &label(spec, &self.axes));
                // a method without answers to quantities decides its checks itself
                let checked = self.compares
                    || !method.answers_quantities()
                    || case.as_ref().is_ok_and(|case| same_case(case.effective_toml(), &as_written));
                let mut rows = Row::begun(self.command, spec, &base).solved_by(method, case.as_ref().map_err(Clone::clone), &base, watch);
                rows.iter_mut().filter(|_| !checked).for_each(Row::leave_checks);
                rows
            });
            keys.extend(std::iter::repeat_n(key, found.len()));
            rows.extend(found);
        }
        let stored = stored_rows::text(&rows, &keys);
        let mut study = Study {
            command: self.command.to_owned(),
            case: self.base.name.to_owned(),
            title: self.written.title.value.clone(),
            axes: self.axes,
            asked,
            rows,
            planned: specs.len(),
            stopped,
            tolerance: None,
            warnings: Vec::new(),
            notes: Vec::new(),
            stored,
        };
        rates::fill(&mut study.rows, &study.asked);
        rates::decide(&mut study.rows, self.written, &study.asked);
        method.judge(&mut study.rows, self.written);
        study.notes = method.notes(&study.rows);
        if self.compares {
            study.compare();
        }
        study.tolerance = self.tol.map(|tol| (tol, study.within(tol)));
        for row in &mut study.rows {
            for probe in &mut row.result.probes {
                if let Some(a) = study.asked.iter().find(|a| a.probe == probe.name) {
                    probe.name.clone_from(&a.name);
                }
            }
        }
        // from here on probes have the names of the table
        study.asked.iter_mut().for_each(|a| a.probe.clone_from(&a.name));
        study
    }
}

impl Study {
    /// Compares every row with the first one of the same degree position, level and keys.
    fn compare(&mut self) {
        let mut firsts = BTreeMap::new();
        for k in 0..self.rows.len() {
            let spec = &self.rows[k].spec;
            let first = *firsts.entry((spec.degree, spec.level, spec.vary.clone())).or_insert(k);
            if first == k {
                continue;
            }
            let differences: IndexMap<String, f64> = self
                .asked
                .iter()
                .filter(|a| a.compared)
                .map(|a| (a.name.clone(), difference(a.value(&self.rows[first]), a.value(&self.rows[k]))))
                .collect();
            self.rows[k].differences = differences;
        }
    }

    fn within(&self, tol: f64) -> Vec<Tolerance> {
        let of = |a: &Asked| {
            let found = self.rows.iter().enumerate().filter_map(|(k, row)| row.differences.get(&a.name).map(|d| (k, *d)));
            // a missing value is the largest difference
            let worse = |new: f64, old: f64| new.is_nan() && !old.is_nan() || new > old;
            let (row, largest) = found.fold((0, 0.0), |(at, most), (k, d)| if worse(d, most) { (k, d) } else { (at, most) });
            Tolerance { quantity: a.name.clone(), largest, row, ok: largest <= tol }
        };
        self.asked.iter().filter(|a| a.compared).map(of).collect()
    }

    /// The exit code of all rows, of the tolerance, and of what stopped the study.
    pub fn exit(&self) -> i32 {
        let beyond = self.tolerance.as_ref().is_some_and(|(_, found)| found.iter().any(|t| !t.ok));
        let stopped = self.stopped.map(|stop| if stop == Stop::Interrupted { Status::Interrupted } else { Status::Limit }.exit());
        let codes = || self.rows.iter().map(|r| r.result.exit).chain(beyond.then_some(1)).chain(stopped);
        PRECEDENCE.into_iter().find(|code| codes().any(|c| c == *code)).unwrap_or(0)
    }

    /// The status that belongs to the exit code: that of the first row that has it.
    pub fn status(&self) -> Status {
        let exit = self.exit();
        let of_rows = self.rows.iter().map(|r| r.result.status).find(|s| s.exit() == exit);
        of_rows.unwrap_or(match exit {
            0 => Status::Ok,
            6 => Status::Limit,
            130 => Status::Interrupted,
            _ => Status::CheckFailed,
        })
    }

    /// Label of row `k`: "fe, degree 2, level 1".
    pub fn label(&self, k: usize) -> String {
        let row = &self.rows[k];
        let level = if self.axes.levels > 1 { format!(", level {}", row.spec.level) } else { String::new() };
        self.line(k) + &level
    }

    /// Label of the line of row `k`: all rows that differ from it in the level alone.
    pub fn line(&self, k: usize) -> String {
        let row = &self.rows[k];
        let side = row.interface.as_ref().map_or(String::new(), |name| format!(", {name}"));
        row.spec.label(&row.degree) + &side
    }

    /// The positions of the rows of every line of the picture: rows that differ in the level alone.
    pub fn lines(&self) -> Vec<Vec<usize>> {
        let mut lines: Vec<Vec<usize>> = Vec::new();
        for (k, row) in self.rows.iter().enumerate() {
            // rows of several interfaces alternate within the levels of one line
            let recent = lines.iter_mut().rev().take_while(|line| self.rows[line[0]].spec.same_line(&row.spec));
            match recent.into_iter().find(|line| self.rows[line[0]].interface == row.interface) {
                Some(line) => line.push(k),
                None => lines.push(vec![k]),
            }
        }
        lines
    }

    /// Errors and warnings of all rows, each once; one that does not concern every row names its rows.
    pub fn messages(&self) -> (Vec<Diagnostic>, Vec<Diagnostic>) {
        let gather = |of: &dyn Fn(&Row) -> &[Diagnostic]| {
            let mut found: Vec<(&Diagnostic, serde_json::Value, Vec<usize>)> = Vec::new();
            for (k, row) in self.rows.iter().enumerate() {
                for d in of(row) {
                    // rows of an earlier study lack the texts that are not stored
                    let told = d.to_json();
                    match found.iter_mut().find(|(_, known, _)| *known == told) {
                        Some((_, _, rows)) if rows.last() != Some(&k) => rows.push(k),
                        Some(_) => {}
                        None => found.push((d, told, vec![k])),
                    }
                }
            }
            let named = |(d, _, rows): (&Diagnostic, serde_json::Value, Vec<usize>)| {
                let mut d = d.clone();
                if rows.len() < self.rows.len() {
                    let more = if rows.len() > 3 { format!(" and {} more", rows.len() - 3) } else { String::new() };
                    let names: Vec<String> = rows.iter().take(3).map(|k| self.label(*k)).collect();
                    d.message = format!("{} (row {}{more})", d.message, names.join("; "));
                }
                d
            };
            found.into_iter().map(named).collect::<Vec<_>>()
        };
        let warnings = self.warnings.iter().cloned().chain(gather(&|row| &row.result.warnings)).collect();
        (gather(&|row| &row.result.diagnostics), warnings)
    }

    /// Messages in one list, errors first.
    pub fn diagnostics(&self) -> Diagnostics {
        let (errors, warnings) = self.messages();
        Diagnostics { items: errors.into_iter().chain(warnings).collect() }
    }

    /// Names of the errors that any row has, those relative to the exact size left out.
    pub fn errors(&self) -> Vec<String> {
        let names = names_of(&self.rows, |row| row.result.errors.keys());
        names.into_iter().filter(|name| !name.ends_with(".rel")).collect()
    }

    /// The error that the picture shows first: the first that is asked for, else `error.u.L2`.
    pub fn main_error(&self) -> Option<String> {
        let known = self.errors();
        let asked = self.asked.iter().find(|a| a.compared && a.is_error() && known.contains(&a.quantity.trim().to_owned()));
        asked.map(|a| a.quantity.trim().to_owned()).or_else(|| known.into_iter().find(|name| name == "error.u.L2"))
    }

    /// Errors that the table shows: those that were asked for, or all but energies and those of single interfaces.
    pub fn shown_errors(&self) -> Vec<String> {
        let all = self.errors();
        let wished: Vec<String> = all.iter().filter(|n| self.asked.iter().any(|a| a.compared && a.quantity == **n)).cloned().collect();
        if wished.is_empty() {
            all.into_iter().filter(|n| !n.ends_with(".energy") && n.matches('.').count() == 2).collect()
        } else {
            wished
        }
    }

    /// The checks that failed, by row.
    pub fn failed_checks(&self) -> Vec<String> {
        let of = |(k, row): (usize, &Row)| {
            let failed: Vec<&str> = row.result.checks.iter().filter(|c| !c.ok && !c.skipped).map(|c| c.name.as_str()).collect();
            (!failed.is_empty()).then(|| format!("{} in {}", failed.join(", "), self.label(k)))
        };
        self.rows.iter().enumerate().filter_map(of).collect()
    }
}

/// Names that any row has, each once, in the order of their first appearance.
pub(super) fn names_of<'a, I: Iterator<Item = &'a String>>(rows: &'a [Row], of: impl Fn(&'a Row) -> I) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    for name in rows.iter().flat_map(of) {
        if !names.iter().any(|known| known == name) {
            names.push(name.to_owned());
        }
    }
    names
}

/// Whether two effective cases are the same, however their numbers are spelt: 1 and 1.0.
fn same_case(a: &str, b: &str) -> bool {
    a == b || matches!((a.parse::<toml::Table>(), b.parse::<toml::Table>()), (Ok(a), Ok(b)) if same_table(&a, &b))
}

fn same_table(a: &toml::Table, b: &toml::Table) -> bool {
    a.len() == b.len() && a.iter().all(|(key, value)| b.get(key).is_some_and(|other| same_value(value, other)))
}

fn same_value(a: &toml::Value, b: &toml::Value) -> bool {
    match (a, b) {
        (toml::Value::Integer(a), toml::Value::Float(b)) | (toml::Value::Float(b), toml::Value::Integer(a)) => *a as f64 == *b,
        (toml::Value::Array(a), toml::Value::Array(b)) => a.len() == b.len() && a.iter().zip(b).all(|(a, b)| same_value(a, b)),
        (toml::Value::Table(a), toml::Value::Table(b)) => same_table(a, b),
        _ => a == b,
    }
}

/// |a - b| / max(|a|, |b|); 0 if both are zero, NaN if one is not finite.
fn difference(a: f64, b: f64) -> f64 {
    if !(a.is_finite() && b.is_finite()) {
        return f64::NAN;
    }
    let size = a.abs().max(b.abs());
    if size == 0.0 { 0.0 } else { (a - b).abs() / size }
}

/// The word of a status.
pub(super) fn word(status: Status) -> String {
    serde_json::to_value(status).ok().and_then(|v| v.as_str().map(str::to_owned)).unwrap_or_default()
}

fn label(spec: &Spec, axes: &Axes) -> String {
    let level = if axes.levels > 1 { format!(", level {}", spec.level) } else { String::new() };
    spec.label(&spec.changes.degree.map_or(String::new(), |p| p.to_string())) + &level
}
