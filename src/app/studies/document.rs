//! A study with all its rows: the table for people, `result.json`, `study.csv`.

use super::axes::Axes;
use super::quantities::{Asked, asked};
use super::rates;
use super::rows::{Base, Row};
use crate::app::json;
use crate::app::named::Named;
use crate::app::registry::Registry;
use crate::app::result::Status;
use crate::app::watch::Watch;
use crate::io::case::Case;
use crate::io::errors::{Diagnostic, Diagnostics};
use crate::io::table::{Table, csv_field, exact, short};
use serde_json::{Map, Value, json};
use std::fmt::Write as _;

/// Codes in the order in which they decide the exit code of several rows.
const PRECEDENCE: [i32; 7] = [130, 70, 4, 6, 5, 3, 1];

/// What `--tol` found about one quantity.
#[derive(Clone, Debug, PartialEq)]
pub struct Tolerance {
    /// The quantity as the table calls it.
    pub quantity: String,
    /// Largest relative difference from the first row; not finite where a row has no value.
    pub largest: f64,
    /// Position of the row with it.
    pub row: usize,
    /// Whether every row is within the tolerance.
    pub ok: bool,
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
    /// What was varied.
    pub axes: Axes,
    /// What was asked.
    pub asked: Vec<Asked>,
    /// Every row that was begun.
    pub rows: Vec<Row>,
    /// The tolerance of differences and what it found.
    pub tolerance: Option<(f64, Vec<Tolerance>)>,
    /// Warnings about the study as a whole.
    pub warnings: Vec<Diagnostic>,
}

impl Study {
    /// Reads and solves every row of `axes`, `begins` told before each: position, number of rows, its name.
    ///
    /// `written` is the case as written. A row that fails stays, the next ones are solved; where `watch` says to stop, no further
    /// row is begun.
    pub fn run(
        command: &str,
        written: &Case,
        base: &Base<'_>,
        (axes, wanted, tol): (Axes, &[String], Option<f64>),
        registry: &Registry,
        watch: &Watch,
        mut begins: impl FnMut(usize, usize, &str),
    ) -> Self {
        let asked = asked(written, wanted, axes.levels);
        let added = asked.iter().filter(|a| a.is_added()).map(|a| (a.probe.clone(), a.quantity.clone())).collect();
        let mut base = base.clone();
        base.options.changes.quantities = added;
        let specs = axes.rows(&base);
        let mut rows = Vec::with_capacity(specs.len());
        for (k, spec) in specs.iter().enumerate() {
            if k > 0 && watch.stop().is_some() {
                break;
            }
            begins(k, specs.len(), &label(spec, &axes));
            rows.push(Row::solve(command, spec, &base, registry, watch));
        }
        let (case, title) = (base.name.to_owned(), written.title.value.clone());
        let warnings = Vec::new();
        let mut study = Self { command: command.to_owned(), case, title, axes, asked, rows, tolerance: None, warnings };
        rates::fill(&mut study.rows, &study.asked);
        rates::decide(&mut study.rows, written, &study.asked);
        study.compare();
        study.tolerance = tol.map(|tol| (tol, study.within(tol)));
        for row in &mut study.rows {
            for probe in &mut row.result.probes {
                if let Some(a) = study.asked.iter().find(|a| a.probe == probe.name) {
                    probe.name.clone_from(&a.name);
                }
            }
        }
        // from here on probes go by the names of the table
        study.asked.iter_mut().for_each(|a| a.probe.clone_from(&a.name));
        study
    }

    /// The first row of the same degree position, level and keys: what a row is compared with.
    fn first_of(&self, k: usize) -> usize {
        let spec = &self.rows[k].spec;
        let same = |row: &Row| row.spec.degree == spec.degree && row.spec.level == spec.level && row.spec.vary == spec.vary;
        self.rows.iter().position(same).unwrap_or(k)
    }

    fn compare(&mut self) {
        for k in 0..self.rows.len() {
            let first = self.first_of(k);
            if first == k {
                continue;
            }
            let differences: Named<f64> = self
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

    /// The exit code of all rows and of the tolerance together.
    pub fn exit(&self) -> i32 {
        let beyond = self.tolerance.as_ref().is_some_and(|(_, found)| found.iter().any(|t| !t.ok));
        let codes = || self.rows.iter().map(|r| r.result.exit).chain(beyond.then_some(1));
        PRECEDENCE.into_iter().find(|code| codes().any(|c| c == *code)).unwrap_or(0)
    }

    /// The status that belongs to the exit code: that of the first row that has it.
    pub fn status(&self) -> Status {
        let exit = self.exit();
        let of_rows = self.rows.iter().map(|r| r.result.status).find(|s| s.exit() == exit);
        of_rows.unwrap_or(if exit == 0 { Status::Ok } else { Status::CheckFailed })
    }

    /// What to call row `k` where a word must do: "fe, degree 2, level 1".
    pub fn label(&self, k: usize) -> String {
        let row = &self.rows[k];
        label_of(row.spec.name(), &row.degree, self.axes.levels > 1, &row.spec.vary, row.spec.level)
    }

    /// Errors and warnings of all rows, each once; what does not concern every row names those it concerns.
    pub fn messages(&self) -> (Vec<Diagnostic>, Vec<Diagnostic>) {
        let gather = |of: &dyn Fn(&Row) -> Vec<Diagnostic>| {
            let mut found: Vec<(Diagnostic, Vec<usize>)> = Vec::new();
            for (k, row) in self.rows.iter().enumerate() {
                for d in of(row) {
                    match found.iter_mut().find(|(known, _)| *known == d) {
                        Some((_, rows)) if rows.last() != Some(&k) => rows.push(k),
                        Some(_) => {}
                        None => found.push((d, vec![k])),
                    }
                }
            }
            let named = |(mut d, rows): (Diagnostic, Vec<usize>)| {
                if rows.len() < self.rows.len() {
                    let more = if rows.len() > 3 { format!(" and {} more", rows.len() - 3) } else { String::new() };
                    let names: Vec<String> = rows.iter().take(3).map(|k| self.label(*k)).collect();
                    d.message = format!("{} (row {}{more})", d.message, names.join("; "));
                }
                d
            };
            found.into_iter().map(named).collect::<Vec<_>>()
        };
        let warnings = self.warnings.iter().cloned().chain(gather(&|row| row.result.warnings.clone())).collect();
        (gather(&|row| row.result.diagnostics.clone()), warnings)
    }

    /// Messages in one list, errors first.
    pub fn diagnostics(&self) -> Diagnostics {
        let (errors, warnings) = self.messages();
        Diagnostics { items: errors.into_iter().chain(warnings).collect() }
    }

    /// Names of the errors that any row has, those relative to the exact size left out.
    pub fn errors(&self) -> Vec<String> {
        let mut names: Vec<String> = Vec::new();
        for (name, _) in self.rows.iter().flat_map(|r| r.result.errors.iter()).filter(|(name, _)| !name.ends_with(".rel")) {
            if !names.iter().any(|known| known == name) {
                names.push(name.to_owned());
            }
        }
        names
    }

    /// The error that the table and the picture show: the first that is asked for, else `error.u.L2`.
    pub fn main_error(&self) -> Option<String> {
        let known = self.errors();
        let asked = self.asked.iter().find(|a| a.compared && a.is_error() && known.contains(&a.quantity.trim().to_owned()));
        asked.map(|a| a.quantity.trim().to_owned()).or_else(|| known.into_iter().find(|name| name == "error.u.L2"))
    }

    /// The table for people.
    pub fn table(&self) -> Table {
        let (errors, levels) = (self.shown_errors(), self.axes.levels > 1);
        let quantities: Vec<&Asked> = self.asked.iter().filter(|a| a.compared && !errors.contains(&a.quantity)).collect();
        let differs = self.rows.iter().any(|r| !r.differences.is_empty());
        let checked = self.rows.iter().any(|r| r.result.checks_expected > 0);
        let mut head = vec!["row".to_owned()];
        head.extend(self.axes.vary.iter().map(|v| v.key.clone()));
        head.push("degree".to_owned());
        if levels {
            head.extend(["level", "h"].map(str::to_owned));
        }
        head.push("unknowns".to_owned());
        for name in &errors {
            head.push(name.clone());
            if levels {
                head.push("rate".to_owned());
            }
        }
        head.extend(quantities.iter().map(|a| a.name.clone()));
        if differs {
            head.push("difference".to_owned());
        }
        if checked {
            head.push("checks".to_owned());
        }
        head.push("status".to_owned());
        let mut table = Table::new(head);
        let number = |v: f64, digits: usize| if v.is_finite() { short(v, digits) } else { "-".to_owned() };
        for row in &self.rows {
            let r = &row.result;
            let mut cells = vec![row.spec.name().to_owned()];
            cells.extend(row.spec.vary.iter().map(|(_, value)| value.clone()));
            cells.push(if row.degree.is_empty() { "-".to_owned() } else { row.degree.clone() });
            if levels {
                cells.push(row.spec.level.to_string());
                cells.push(if r.geometry.h > 0.0 { short(r.geometry.h, 3) } else { "-".to_owned() });
            }
            cells.push(if row.unknowns() > 0 { row.unknowns().to_string() } else { "-".to_owned() });
            for name in &errors {
                let value = r.errors.get(name).copied().filter(|_| row.solved());
                cells.push(number(value.unwrap_or(f64::NAN), 4));
                if levels {
                    cells.push(row.rates.get(name).map_or("-".to_owned(), |rate| format!("{rate:.2}")));
                }
            }
            cells.extend(quantities.iter().map(|a| number(a.value(row), 8)));
            if differs {
                let largest = row.differences.iter().map(|(_, d)| *d).fold(0.0, |a: f64, d| if d.is_nan() { d } else { a.max(d) });
                cells.push(if row.differences.is_empty() { "-".to_owned() } else { number(largest, 2) });
            }
            if checked {
                let passed = r.checks.iter().filter(|c| c.ok && !c.skipped).count();
                cells.push(format!("{passed} of {}", r.checks_performed));
            }
            cells.push(row.code().map_or_else(|| word(r.status), |code| format!("{} ({code})", word(r.status))));
            table.row(cells);
        }
        table
    }

    /// Errors that the table shows: none where the quantities were chosen and are others.
    fn shown_errors(&self) -> Vec<String> {
        let all = self.errors();
        let wished: Vec<String> = all.iter().filter(|n| self.asked.iter().any(|a| a.compared && a.quantity == **n)).cloned().collect();
        if wished.is_empty() {
            all.into_iter().filter(|n| !n.ends_with(".energy") && n.matches('.').count() == 2).collect()
        } else {
            wished
        }
    }

    /// The summary on stdout.
    pub fn summary(&self, folder: Option<&str>) -> String {
        let mut text = String::new();
        // writing to a String cannot fail
        let _ = writeln!(text, "{}: {}", self.case, word(self.status()));
        let _ = writeln!(text, "\n{}", self.table());
        if let Some((tol, found)) = &self.tolerance {
            for t in found {
                let verdict = if t.ok { "within" } else { "BEYOND" };
                let _ = writeln!(text, "{}: {}, {verdict} {}", t.quantity, self.largest(t), short(*tol, 3));
            }
            text.push('\n');
        }
        let failed: Vec<String> = self.failed_checks();
        if !failed.is_empty() {
            let _ = writeln!(text, "failed checks: {}\n", failed.join("; "));
        }
        if let Some(folder) = folder {
            let _ = writeln!(text, "results in {folder}");
        }
        text
    }

    /// "largest difference 1e-9 (fe, degree 2)".
    pub(super) fn largest(&self, t: &Tolerance) -> String {
        match t.largest.is_finite() {
            true if t.largest == 0.0 => "no difference".to_owned(),
            true => format!("largest difference {} ({})", short(t.largest, 3), self.label(t.row)),
            false => format!("no value in {}", self.label(t.row)),
        }
    }

    pub(super) fn failed_checks(&self) -> Vec<String> {
        let of = |(k, row): (usize, &Row)| {
            let failed: Vec<&str> = row.result.checks.iter().filter(|c| !c.ok && !c.skipped).map(|c| c.name.as_str()).collect();
            (!failed.is_empty()).then(|| format!("{} in {}", failed.join(", "), self.label(k)))
        };
        self.rows.iter().enumerate().filter_map(of).collect()
    }

    /// The JSON document, which says that `files` were written.
    pub fn to_json(&self, files: &[String]) -> String {
        let (errors, warnings) = self.messages();
        let rows: Vec<Value> = self.rows.iter().map(|row| self.row(row)).collect();
        let mut document = json!({
            "schema": "faying.result/1",
            "version": env!("CARGO_PKG_VERSION"),
            "command": self.command,
            "status": self.status(),
            "exit": self.exit(),
            "case": self.case,
            "quantities": self.asked.iter().filter(|a| a.compared).map(|a| json!({"name": a.name, "quantity": a.quantity})).collect::<Vec<_>>(),
            "rows": rows,
        });
        let map = document.as_object_mut().expect("a document is an object");
        if let Some((tol, found)) = &self.tolerance {
            let of = |t: &Tolerance| {
                let mut value = json!({"quantity": t.quantity, "largest": t.largest, "row": t.row, "ok": t.ok});
                if !t.largest.is_finite() {
                    value["reason"] = json!("a row has no value");
                }
                value
            };
            map.insert("tolerance".into(), json!(tol));
            map.insert("differences".into(), found.iter().map(of).collect());
        }
        map.insert("warnings".into(), json!(warnings));
        map.insert("diagnostics".into(), json!(errors));
        map.insert("files".into(), json!(files));
        json::text(&document)
    }

    fn row(&self, row: &Row) -> Value {
        let r = &row.result;
        let whole = r.to_value();
        let or_null = |text: &str| if text.is_empty() { Value::Null } else { json!(text) };
        let degree = row.degree.parse::<usize>().map_or_else(|_| or_null(&row.degree), |p| json!(p));
        let extra_points = row.extra_points.parse::<usize>().map_or_else(|_| or_null(&row.extra_points), |n| json!(n));
        let built = r.geometry.elements > 0;
        let mut map = Map::new();
        let mut put = |key: &str, value: Value| drop(map.insert(key.to_owned(), value));
        put("name", json!(row.spec.name()));
        put("backend", json!(if r.backend.is_empty() { row.spec.name() } else { &r.backend }));
        put("backends", json!(r.backends));
        put("degree", degree);
        put("level", json!(row.spec.level));
        put("pairing", or_null(&row.pairing));
        put("integration", or_null(&row.integration));
        put("extra_points", extra_points);
        put("vary", Value::Object(row.spec.vary.iter().map(|(k, v)| (k.clone(), json!(v))).collect()));
        put("elements", if built { json!(r.geometry.elements) } else { Value::Null });
        put("h", if built { json!(r.geometry.h) } else { Value::Null });
        for key in ["unknowns", "contact", "interface", "energy", "errors"] {
            put(key, whole.get(key).cloned().unwrap_or(Value::Null));
        }
        put("rates", json!(row.rates));
        let mut differences = json!(row.differences);
        json::add_reasons(&mut differences);
        put("differences", differences);
        for key in ["probes", "checks", "checks_performed", "checks_expected", "checks_skipped", "status", "exit"] {
            put(key, whole.get(key).cloned().unwrap_or(Value::Null));
        }
        if let Some(d) = r.diagnostics.first() {
            put("reason", json!(d.message));
            put("code", json!(d.code));
        } else if !row.solved() {
            put("reason", json!("nothing was solved"));
        }
        put("diagnostics", json!(r.diagnostics));
        Value::Object(map)
    }

    /// `study.csv`: the names of the rows in `result.json` with dots, errors and rates as the quantities they are.
    pub fn csv(&self) -> String {
        let errors: Vec<String> = {
            let mut names: Vec<String> = Vec::new();
            for (name, _) in self.rows.iter().flat_map(|r| r.result.errors.iter()) {
                if !names.iter().any(|known| known == name) {
                    names.push(name.to_owned());
                }
            }
            names
        };
        let collect = |of: &dyn Fn(&Row) -> Vec<String>| {
            let mut names: Vec<String> = Vec::new();
            self.rows.iter().flat_map(of).for_each(|n| {
                if !names.contains(&n) {
                    names.push(n);
                }
            });
            names
        };
        let rates = collect(&|r| r.rates.iter().map(|(n, _)| n.to_owned()).collect());
        let probes = collect(&|r| r.result.probes.iter().map(|p| p.name.clone()).collect());
        let differences = collect(&|r| r.differences.iter().map(|(n, _)| n.to_owned()).collect());
        let mut head: Vec<String> =
            ["name", "backend", "degree", "level", "pairing", "integration", "extra_points"].map(str::to_owned).to_vec();
        head.extend(self.axes.vary.iter().map(|v| format!("vary.{}", v.key)));
        head.extend(["elements", "h", "unknowns.primal", "unknowns.multipliers", "energy"].map(str::to_owned));
        head.extend(errors.iter().cloned());
        head.extend(rates.iter().map(|n| format!("rate.{n}")));
        head.extend(probes.iter().map(|n| format!("probes.{n}")));
        head.extend(differences.iter().map(|n| format!("differences.{n}")));
        head.extend(["status", "exit", "code"].map(str::to_owned));
        let line = |cells: &[String]| cells.iter().map(|c| csv_field(c)).collect::<Vec<_>>().join(",") + "\n";
        let mut text = line(&head);
        for row in &self.rows {
            let r = &row.result;
            let built = r.geometry.elements > 0;
            let count = |n: usize| if built { n.to_string() } else { String::new() };
            let solved = |v: f64| if row.solved() { exact(v) } else { String::new() };
            let backend = if r.backend.is_empty() { row.spec.name() } else { &r.backend };
            let mut cells = vec![row.spec.name().to_owned(), backend.to_owned(), row.degree.clone(), row.spec.level.to_string()];
            cells.extend([row.pairing.clone(), row.integration.clone(), row.extra_points.clone()]);
            cells.extend(row.spec.vary.iter().map(|(_, v)| v.clone()));
            cells.push(count(r.geometry.elements));
            cells.push(if built { exact(r.geometry.h) } else { String::new() });
            cells.extend([count(r.unknowns.primal), count(r.unknowns.multipliers), solved(r.energy)]);
            cells.extend(errors.iter().map(|n| r.errors.get(n).map_or(String::new(), |v| solved(*v))));
            cells.extend(rates.iter().map(|n| row.rates.get(n).map_or(String::new(), |v| exact(*v))));
            let probe = |n: &String| r.probes.iter().find(|p| p.name == *n).map_or(String::new(), |p| solved(p.value));
            cells.extend(probes.iter().map(probe));
            cells.extend(differences.iter().map(|n| row.differences.get(n).map_or(String::new(), |v| exact(*v))));
            cells.extend([word(r.status), r.exit.to_string(), row.code().unwrap_or_default().to_owned()]);
            text.push_str(&line(&cells));
        }
        text
    }
}

/// |a - b| / max(|a|, |b|), zero where both are; not a number where one is missing.
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

fn label(spec: &super::rows::Spec, axes: &Axes) -> String {
    let degree = spec.changes.degree.map_or(String::new(), |p| p.to_string());
    label_of(spec.name(), &degree, axes.levels > 1, &spec.vary, spec.level)
}

fn label_of(name: &str, degree: &str, levels: bool, vary: &[(String, String)], level: usize) -> String {
    let mut text = name.to_owned();
    if !degree.is_empty() {
        let _ = write!(text, ", degree {degree}");
    }
    for (key, value) in vary {
        let _ = write!(text, ", {key} = {value}");
    }
    if levels {
        let _ = write!(text, ", level {level}");
    }
    text
}
