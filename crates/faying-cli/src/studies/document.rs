//! The JSON document of a study: `result.json`.

use super::rows::Row;
use super::study::{Study, Tolerance};
use crate::json;
use serde_json::{Map, Value, json};

impl Study {
    /// The JSON document, with `files` as the names of the written files.
    pub fn to_json(&self, files: &[String]) -> String {
        let (errors, warnings) = self.messages();
        let rows: Vec<Value> = self.rows.iter().map(member).collect();
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
        if !self.notes.is_empty() {
            map.insert("notes".into(), json!(self.notes));
        }
        if self.stopped.is_some() {
            map.insert("reason".into(), json!(self.left()));
        }
        map.insert("warnings".into(), json!(warnings));
        map.insert("diagnostics".into(), json!(errors));
        map.insert("files".into(), json!(files));
        json::text(&document)
    }
}

/// One row: its position on the axes, the results of its run, the additions of the study.
fn member(row: &Row) -> Value {
    let r = &row.result;
    let or_null = |text: &str| if text.is_empty() { Value::Null } else { json!(text) };
    let whole_or_text = |text: &str| text.parse::<usize>().map_or_else(|_| or_null(text), |n| json!(n));
    let built = r.geometry.elements > 0;
    let mut map = Map::new();
    let mut put = |key: &str, value: Value| drop(map.insert(key.to_owned(), value));
    put("name", json!(row.spec.name()));
    put("backend", json!(if r.backend.is_empty() { row.spec.name() } else { &r.backend }));
    put("backends", json!(r.backends));
    put("degree", whole_or_text(&row.degree));
    put("level", json!(row.spec.level));
    put("pairing", or_null(&row.pairing));
    put("integration", or_null(&row.integration));
    put("extra_points", whole_or_text(&row.extra_points));
    put("vary", Value::Object(row.spec.vary.iter().map(|(k, v)| (k.clone(), json!(v))).collect()));
    put("elements", if built { json!(r.geometry.elements) } else { Value::Null });
    put("h", if built { json!(r.geometry.h) } else { Value::Null });
    for key in ["unknowns", "contact", "interface", "energy", "errors"] {
        put(key, row.document.get(key).cloned().unwrap_or(Value::Null));
    }
    put("rates", json!(row.rates));
    let mut differences = json!(row.differences);
    json::add_reasons(&mut differences);
    put("differences", differences);
    if row.beta.is_some() || row.verdict.is_some() {
        put("side", json!(row.interface));
        put("beta", json!(row.beta));
        put("parametric", json!(row.parametric));
        put("slope", json!(row.slope));
        put("verdict", json!(row.verdict));
    }
    let mut answers = json!({"probes": r.probes, "checks": r.checks});
    json::add_reasons(&mut answers);
    for key in ["probes", "checks"] {
        put(key, answers[key].take());
    }
    put("checks_performed", json!(r.checks_performed));
    put("checks_expected", json!(r.checks_expected));
    put("checks_skipped", json!(r.checks_skipped));
    put("status", json!(r.status));
    put("exit", json!(r.exit));
    if let Some(d) = r.diagnostics.first() {
        put("reason", json!(d.message));
        put("code", json!(d.code));
    } else if !row.solved() && row.beta.is_none() {
        put("reason", json!("nothing was solved"));
    }
    put("diagnostics", json!(r.diagnostics));
    Value::Object(map)
}
