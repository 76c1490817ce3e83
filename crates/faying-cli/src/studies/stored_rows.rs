//! `rows.json`: every row of a study with a key of its inputs, for `--resume`.
//!
//! The key of a row is a hash of everything that determines it: version, command, text of the case, options, its place on the axes,
//! bytes of the files that the case names. Solved rows are restored bit for bit; rows that a limit ended are solved again.

use super::rows::{Base, Row, Spec};
use crate::case::{Case, sha256};
use crate::codes;
use crate::errors::{Diagnostic, Severity};
use crate::json;
use crate::result::{CheckReport, LineReport, ProbeReport, RunResult, Status};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::fmt::Write as _;

/// The schema of the file.
const SCHEMA: &str = "faying.rows/1";

/// Rows of an earlier study, by their keys.
#[derive(Clone, Debug, Default)]
pub struct StoredRows {
    rows: BTreeMap<String, Vec<Value>>,
}

/// Key of a row, a SHA-256 of its inputs; `None` if its case cannot be read.
pub(super) fn key(command: &str, base: &Base<'_>, spec: &Spec, case: Option<&Case>) -> Option<String> {
    let case = case?;
    let options = &base.options;
    let mut text = format!("{} {command} {:?}\n", env!("CARGO_PKG_VERSION"), base.name);
    // writing to a String cannot fail
    let _ = writeln!(text, "{:?} {:?} {:?}", options.sets, options.backend, options.changes);
    let _ = writeln!(text, "{:?} {} {:?} {:?}", spec.backend, spec.degree, spec.vary, spec.changes);
    case.files.iter().for_each(|f| {
        let _ = writeln!(text, "{:?} {}", f.name, f.sha256);
    });
    text.push_str(base.text);
    Some(sha256(text.as_bytes()))
}

/// The text of the file; rows without a key are left out.
pub(super) fn text(rows: &[Row], keys: &[Option<String>]) -> String {
    let of = |(row, key): (&Row, &Option<String>)| {
        let key = key.as_ref()?;
        Some(json!({
            "key": key,
            "seconds": row.seconds,
            "degree": row.degree,
            "pairing": row.pairing,
            "integration": row.integration,
            "extra_points": row.extra_points,
            "interface": row.interface,
            "beta": row.beta,
            "parametric": row.parametric,
            "h": row.result.geometry.h,
            "elements": row.result.geometry.elements,
            "solved": row.result.solved,
            "warnings": row.result.warnings,
            "result": row.document,
        }))
    };
    let list: Vec<Value> = rows.iter().zip(keys).filter_map(of).collect();
    json::text(&json!({"schema": SCHEMA, "version": env!("CARGO_PKG_VERSION"), "rows": list}))
}

impl StoredRows {
    /// Reads the file; `None` if it is not a file of this schema.
    pub fn read(text: &str) -> Option<Self> {
        let document: Value = serde_json::from_str(text).ok()?;
        if document["schema"] != SCHEMA {
            return None;
        }
        let mut kept = Self::default();
        for row in document["rows"].as_array()? {
            kept.rows.entry(row["key"].as_str()?.to_owned()).or_default().push(row.clone());
        }
        Some(kept)
    }

    /// Number of rows.
    pub fn len(&self) -> usize {
        self.rows.values().map(Vec::len).sum()
    }

    /// Whether there is no row.
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// The rows of a key; `None` unless all of them are there and were finished.
    pub(super) fn rows(&self, key: &Option<String>, command: &str, spec: &Spec, base: &Base<'_>) -> Option<Vec<Row>> {
        let stored = self.rows.get(key.as_ref()?)?;
        stored.iter().map(|stored| row(stored, command, spec, base)).collect()
    }
}

fn row(stored: &Value, command: &str, spec: &Spec, base: &Base<'_>) -> Option<Row> {
    let word = |name: &str| stored[name].as_str().map(str::to_owned);
    let document = stored["result"].clone();
    let mut row = Row::begun(command, spec, base);
    row.result = result(&document, command, base.name)?;
    row.result.solved = stored["solved"].as_bool()?;
    row.result.warnings = stored["warnings"].as_array()?.iter().map(diagnostic).collect::<Option<_>>()?;
    row.result.geometry.h = stored["h"].as_f64().unwrap_or(0.0);
    row.result.geometry.elements = count(&stored["elements"]);
    (row.degree, row.pairing) = (word("degree")?, word("pairing")?);
    (row.integration, row.extra_points) = (word("integration")?, word("extra_points")?);
    (row.interface, row.beta) = (word("interface"), stored["beta"].as_f64());
    row.parametric = stored["parametric"].as_f64();
    row.seconds = stored["seconds"].as_f64().unwrap_or(0.0);
    (row.document, row.kept) = (document, true);
    Some(row)
}

fn count(value: &Value) -> usize {
    value.as_u64().and_then(|n| usize::try_from(n).ok()).unwrap_or(0)
}

// a number that was not finite is null in the file
fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or(f64::NAN)
}

/// The members of a finished result that a study reads; the others stay in the document alone. `None` if it was not finished.
fn result(document: &Value, command: &str, name: &str) -> Option<RunResult> {
    let mut result = RunResult::new(command, name);
    result.status = match document["status"].as_str()? {
        "ok" => Status::Ok,
        "check-failed" => Status::CheckFailed,
        "not-converged" => Status::NotConverged,
        "singular" => Status::Singular,
        "not-finite" => Status::NotFinite,
        _ => return None,
    };
    result.exit = result.status.exit();
    result.backend = document["backend"].as_str().unwrap_or_default().to_owned();
    if let Some(map) = document["backends"].as_object() {
        result.backends = map.iter().map(|(k, v)| (k.clone(), v.as_str().unwrap_or_default().to_owned())).collect();
    }
    result.unknowns.primal = count(&document["unknowns"]["primal"]);
    result.unknowns.multipliers = count(&document["unknowns"]["multipliers"]);
    result.energy = number(&document["energy"]);
    if let Some(map) = document["errors"].as_object() {
        result.errors_reason = text_of(&document["errors"]["reason"]);
        result.errors = map.iter().filter(|(k, _)| *k != "reason").map(|(k, v)| (k.clone(), number(v))).collect();
    }
    result.probes = document["probes"].as_array()?.iter().map(probe).collect::<Option<_>>()?;
    result.lines = document["lines"].as_array().map_or(Some(Vec::new()), |all| all.iter().map(line).collect())?;
    result.checks = document["checks"].as_array()?.iter().map(check).collect::<Option<_>>()?;
    result.checks_performed = count(&document["checks_performed"]);
    result.checks_expected = count(&document["checks_expected"]);
    result.checks_skipped = count(&document["checks_skipped"]);
    result.diagnostics = document["diagnostics"].as_array()?.iter().map(diagnostic).collect::<Option<_>>()?;
    Some(result)
}

fn text_of(value: &Value) -> Option<String> {
    value.as_str().map(str::to_owned)
}

fn probe(v: &Value) -> Option<ProbeReport> {
    let (name, quantity) = (text_of(&v["name"])?, text_of(&v["quantity"])?);
    Some(ProbeReport {
        name,
        quantity,
        value: number(&v["value"]),
        at: place_of(&v["at"]),
        t: v["t"].as_f64(),
        patch: text_of(&v["patch"]),
        reason: text_of(&v["reason"]),
    })
}

fn line(v: &Value) -> Option<LineReport> {
    let numbers = |v: &Value| -> Option<Vec<f64>> { Some(v.as_array()?.iter().map(number).collect()) };
    let lists = |v: &Value| -> Option<Vec<Vec<f64>>> { v.as_array()?.iter().map(numbers).collect() };
    Some(LineReport {
        name: text_of(&v["name"])?,
        quantities: v["quantities"].as_array()?.iter().map(text_of).collect::<Option<_>>()?,
        s: numbers(&v["s"])?,
        x: lists(&v["x"])?,
        values: lists(&v["values"])?,
        t: v["t"].as_f64(),
    })
}

/// The place of an extreme.
fn place_of(v: &Value) -> Option<Vec<f64>> {
    Some(v.as_array()?.iter().map(number).collect())
}

fn check(v: &Value) -> Option<CheckReport> {
    Some(CheckReport {
        name: text_of(&v["name"])?,
        quantity: text_of(&v["quantity"])?,
        value: number(&v["value"]),
        at: place_of(&v["at"]),
        t: v["t"].as_f64(),
        expected: number(&v["expected"]),
        ok: v["ok"].as_bool()?,
        relation: text_of(&v["relation"])?,
        reason: text_of(&v["reason"]),
        skipped: v["skipped"].as_bool().unwrap_or(false),
    })
}

fn diagnostic(v: &Value) -> Option<Diagnostic> {
    let code = codes::find(v["code"].as_str()?)?.code;
    let severity = if v["severity"] == "warning" { Severity::Warning } else { Severity::Error };
    let place = |name: &str| v[name].as_u64().and_then(|n| usize::try_from(n).ok());
    Some(Diagnostic {
        severity,
        file: text_of(&v["file"]),
        line: place("line"),
        column: place("column"),
        help: text_of(&v["help"]),
        ..Diagnostic::error(code, text_of(&v["message"])?)
    })
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::case::ReadOptions;

    #[test]
    fn a_row_comes_back_with_the_same_bits() {
        let base = Base { name: "a.toml", text: "", options: ReadOptions::default() };
        let mut row = Row::begun("compare", &Spec::default(), &base);
        row.result.solved = true;
        for (k, x) in [0.1, 1.0 / 3.0, 5e-324, 1.797e308, -7.5e-310, 2.0_f64.sqrt() * 1e-9].into_iter().enumerate() {
            row.result.errors.insert(format!("error.{k}"), x);
        }
        row.result.probes.push(ProbeReport {
            name: "p".into(),
            quantity: "energy".into(),
            value: f64::NAN,
            at: Some(vec![0.1, 1.0 / 3.0]),
            t: Some(0.1),
            patch: None,
            reason: None,
        });
        row.result.warnings.push(Diagnostic::warning("E061", "unstable").with_help("read").in_file("a.toml"));
        (row.document, row.beta, row.degree) = (row.result.to_value(), Some(0.1), "3x2".into());
        let keys = [Some("k".to_owned())];
        let text = text(std::slice::from_ref(&row), &keys);
        let kept = StoredRows::read(&text).unwrap();
        let back = kept.rows(&keys[0], "compare", &Spec::default(), &base).unwrap();
        assert_eq!((kept.len(), back.len(), back[0].kept), (1, 1, true));
        assert_eq!(back[0].result.errors, row.result.errors);
        // whole numbers are written without a point: what counts is what is written again
        assert_eq!(json::text(&back[0].document), json::text(&row.document));
        assert_eq!(back[0].result.warnings, row.result.warnings);
        assert!(back[0].result.probes[0].value.is_nan() && back[0].beta == row.beta && back[0].degree == row.degree);
        assert_eq!(super::text(&back, &keys), text);
        assert!(kept.rows(&Some("other".into()), "compare", &Spec::default(), &base).is_none());
        assert!(StoredRows::read("{}").is_none() && StoredRows::read("no json").is_none());
    }

    #[test]
    fn a_row_that_a_limit_ended_is_no_finished_row() {
        let base = Base { name: "a.toml", text: "", options: ReadOptions::default() };
        for (status, kept) in [(Status::Limit, false), (Status::Interrupted, false), (Status::Singular, true)] {
            let mut row = Row::begun("compare", &Spec::default(), &base);
            row.result.status = status;
            row.document = row.result.to_value();
            let stored = StoredRows::read(&text(std::slice::from_ref(&row), &[Some("k".into())])).unwrap();
            assert_eq!(stored.rows(&Some("k".into()), "compare", &Spec::default(), &base).is_some(), kept, "{status:?}");
        }
    }
}
