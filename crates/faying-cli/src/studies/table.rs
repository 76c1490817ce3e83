//! The table of a study for people, and the summary around it.

use super::quantities::Asked;
use super::rows::Row;
use super::study::{Study, Tolerance, word};
use crate::result::RunResult;
use crate::table::{Table, decimals, short};
use std::fmt::Write as _;

/// Constants that differ by more than this are shown in both measures.
const BENT: f64 = 1e-9;

/// A number, or a dash if it is not finite.
fn number(v: f64, digits: usize) -> String {
    if v.is_finite() { short(v, digits) } else { "-".to_owned() }
}

/// The words, or a dash if there are none.
fn text(words: &str) -> String {
    if words.is_empty() { "-".to_owned() } else { words.to_owned() }
}

/// Largest difference of a row from the reference.
fn difference(row: &Row) -> String {
    let largest = row.differences.iter().map(|(_, d)| *d).fold(0.0, |a: f64, d| if d.is_nan() { d } else { a.max(d) });
    if row.differences.is_empty() { "-".to_owned() } else { number(largest, 2) }
}

/// Number of checks that passed, of those performed.
fn passed(result: &RunResult) -> String {
    let passed = result.checks.iter().filter(|c| c.ok && !c.skipped).count();
    if result.checks_performed > 0 { format!("{passed} of {}", result.checks_performed) } else { "-".to_owned() }
}

impl Study {
    /// The table as text: a column for every axis that varies, every error with its rate, every quantity.
    pub fn table(&self) -> Table {
        let (errors, levels) = (self.shown_errors(), self.axes.levels > 1);
        let quantities: Vec<&Asked> = self.asked.iter().filter(|a| a.compared && !errors.contains(&a.quantity)).collect();
        let any = |of: &dyn Fn(&Row) -> bool| self.rows.iter().any(of);
        let (differs, checked) = (any(&|r| !r.differences.is_empty()), any(&|r| r.result.checks_performed > 0));
        let (sides, constants) = (any(&|r| r.interface.is_some()), any(&|r| r.beta.is_some()));
        // on straight sides both measures agree
        let bent = any(&|r| r.beta.zip(r.parametric).is_some_and(|(b, p)| (b - p).abs() > BENT));
        let axes = &self.axes;
        let (pairings, rules, points) = (!axes.pairings.is_empty(), !axes.integrations.is_empty(), !axes.extra_points.is_empty());
        let mut head: Vec<&str> = vec!["row"];
        head.extend(axes.vary.iter().map(|v| v.key.as_str()));
        head.push("degree");
        let chosen = [(pairings, "multiplier"), (rules, "integration"), (points, "points"), (sides, "interface")];
        head.extend(chosen.iter().filter(|(there, _)| *there).map(|(_, name)| name));
        if levels {
            head.extend(["level", "h"]);
        }
        head.push("unknowns");
        for name in &errors {
            head.push(name);
            if levels {
                head.push("rate");
            }
        }
        head.extend(quantities.iter().map(|a| a.name.as_str()));
        let found = [
            (constants, "beta"),
            (bent, "in parameter"),
            (constants && levels, "rate"),
            (constants, "verdict"),
            (differs, "difference"),
            (checked, "checks"),
            (true, "status"),
        ];
        head.extend(found.iter().filter(|(there, _)| *there).map(|(_, name)| name));
        let mut table = Table::new(head);
        for row in &self.rows {
            let r = &row.result;
            let mut cells = vec![row.spec.name().to_owned()];
            cells.extend(row.spec.vary.iter().map(|(_, value)| value.clone()));
            cells.push(text(&row.degree));
            let side = row.interface.as_deref().unwrap_or_default();
            let chosen = [(pairings, &*row.pairing), (rules, &*row.integration), (points, &*row.extra_points), (sides, side)];
            cells.extend(chosen.into_iter().filter(|(there, _)| *there).map(|(_, words)| text(words)));
            if levels {
                cells.push(row.spec.level.to_string());
                cells.push(if r.geometry.h > 0.0 { short(r.geometry.h, 3) } else { "-".to_owned() });
            }
            cells.push(if row.unknowns() > 0 { row.unknowns().to_string() } else { "-".to_owned() });
            for name in &errors {
                let value = r.errors.get(name).copied().filter(|_| row.solved());
                cells.push(number(value.unwrap_or(f64::NAN), 4));
                if levels {
                    cells.push(row.rates.get(name).map_or("-".to_owned(), |rate| decimals(*rate, 2)));
                }
            }
            cells.extend(quantities.iter().map(|a| number(a.value(row), 8)));
            if constants {
                cells.push(number(row.beta.unwrap_or(f64::NAN), 6));
                if bent {
                    cells.push(number(row.parametric.unwrap_or(f64::NAN), 6));
                }
                if levels {
                    cells.push(row.rates.get("beta").map_or("-".to_owned(), |rate| decimals(*rate, 2)));
                }
                cells.push(text(row.verdict.as_deref().unwrap_or_default()));
            }
            if differs {
                cells.push(difference(row));
            }
            if checked {
                cells.push(passed(&row.result));
            }
            cells.push(row.code().map_or_else(|| word(r.status), |code| format!("{} ({code})", word(r.status))));
            table.row(cells);
        }
        table
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
        for note in &self.notes {
            let _ = writeln!(text, "{note}");
        }
        if !self.notes.is_empty() {
            text.push('\n');
        }
        let failed: Vec<String> = self.failed_checks();
        if !failed.is_empty() {
            let _ = writeln!(text, "failed checks: {}\n", failed.join("; "));
        }
        if self.stopped.is_some() {
            let _ = writeln!(text, "{}\n", self.left());
        }
        if let Some(folder) = folder {
            let _ = writeln!(text, "results in {folder}");
        }
        text
    }

    /// Number of missing rows in words: "rows that were not begun: 3 of 8".
    pub(super) fn left(&self) -> String {
        // a row may stand in the table once per interface
        let mut begun: Vec<_> = self.rows.iter().map(|row| &row.spec).collect();
        begun.dedup();
        format!("rows that were not begun: {} of {}; `--resume` goes on", self.planned - begun.len(), self.planned)
    }

    /// Largest difference in words: "largest difference 1e-9 (fe, degree 2)".
    pub(super) fn largest(&self, t: &Tolerance) -> String {
        match t.largest.is_finite() {
            true if t.largest == 0.0 => "no difference".to_owned(),
            true => format!("largest difference {} ({})", short(t.largest, 3), self.label(t.row)),
            false => format!("no value in {}", self.label(t.row)),
        }
    }
}
