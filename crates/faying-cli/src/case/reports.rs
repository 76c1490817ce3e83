//! Reads `[[probe]]`, `[[check]]` and `[study.*]`.

use super::keys;
use super::names::Names;
use super::reader::{Block, Reader, Uses};
use super::tree::{Node, Value};
use super::types::*;
use crate::errors::{Diagnostic, nearest};
use crate::formula::Formula;
use crate::place::Located;

impl Reader {
    fn quantity(&mut self, b: &Block) -> Located<String> {
        let node = self.required(b, "quantity", "quantity = \"u.y at [1.0, 0.5]\"");
        let Some(text) = node.and_then(|n| self.text_of(&n, "quantity")) else { return Located::new("energy".to_owned(), b.at) };
        if text.trim().is_empty() {
            self.fault("E018", text.at, "the quantity is empty", "write for example quantity = \"energy\"");
        }
        text
    }

    /// One `[[probe]]`.
    pub fn probe(&mut self, b: &mut Block, index: usize) -> Probe {
        Probe { head: b.head(), name: self.name(b, "probe", index, false), quantity: self.quantity(b) }
    }

    /// One `[[check]]`.
    pub fn check(&mut self, b: &mut Block, index: usize, names: &Names) -> Check {
        let name = self.name(b, "check", index, false);
        let quantity = self.quantity(b);
        let given: Vec<&str> = ["below", "above", "equals"].into_iter().filter(|k| b.has(k)).collect();
        let zero = || Located::new(Formula::constant(0.0), b.at);
        let bound = |r: &mut Self, key: &str| r.formula(b, key, Uses::Check).unwrap_or_else(zero);
        if let Some(second) = given.get(1) {
            self.fault("E015", b.key_at(second), format!("`{second}` does not stand beside `{}`", given[0]), "write two checks");
        }
        for key in ["rtol", "atol"] {
            if b.has(key) && !b.has("equals") {
                self.fault("E015", b.key_at(key), format!("`{key}` belongs to `equals`"), "");
            }
        }
        let condition = match given.first().copied() {
            Some("below") => Condition::Below(bound(self, "below")),
            Some("above") => Condition::Above(bound(self, "above")),
            Some(_) => {
                if !b.has("rtol") && !b.has("atol") {
                    self.missing(b, "rtol", "rtol = 1e-6, or atol");
                }
                let value = bound(self, "equals");
                Condition::Equals { value, rtol: self.tolerance(b, "rtol"), atol: self.tolerance(b, "atol") }
            }
            None => {
                let message = format!("`below`, `above` or `equals` is missing in {}", b.what);
                self.fault("E013", b.at, message, "write for example below = 1e-2, or equals = 1.0 with rtol = 1e-6");
                Condition::Below(zero())
            }
        };
        let backend = b.node("backend").cloned().and_then(|node| {
            let value = self.registered_of(&node, "backend", &names.backends)?;
            Some(Located::new(value, node.at))
        });
        let over_all =
            b.node("over").cloned().and_then(|node| self.word_of(&node, "over", &[("all", ())]).map(|()| Located::new((), node.at)));
        Check { head: b.head(), name, quantity, condition, backend, over_all }
    }

    fn tolerance(&mut self, b: &Block, key: &str) -> Option<Located<Formula>> {
        let f = self.formula(b, key, Uses::Check)?;
        if f.as_constant().is_some_and(|v| v < 0.0) {
            self.fault("E015", f.at, format!("`{key}` must be 0 or positive"), "");
        }
        Some(f)
    }

    /// `[study.NAME]`: values of a study that the command line does not give; keys that no study of this version has are not read.
    pub fn studies(&mut self, node: Option<&Node>) -> Vec<Located<StudyValues>> {
        let Some(node) = node else { return Vec::new() };
        let Value::Table(table) = &node.value else {
            self.wrong_type(node, "study", "a table", "write [study.convergence]");
            return Vec::new();
        };
        let mut out = Vec::new();
        for e in &table.entries {
            if !keys::STUDIES.contains(&e.key.as_str()) {
                let mut d = Diagnostic::error("E012", format!("unknown study `{}`", e.key));
                if let Some(near) = nearest(&e.key, keys::STUDIES.iter().copied()) {
                    d = d.with_label(format!("did you mean `{near}`?"));
                }
                self.push(e.key_at, d.with_help(format!("studies: {}", keys::STUDIES.join(", "))));
                continue;
            }
            let Some(b) = self.block(&e.node, &format!("`study.{}`", e.key), keys::STUDY) else { continue };
            let values = StudyValues {
                name: e.key.clone(),
                levels: b.node("levels").cloned().and_then(|levels| self.whole_of(&levels, "levels", 1, 20)),
                degrees: b.node("degrees").cloned().map_or(Vec::new(), |node| self.study_degrees(&node)),
                backends: self.words(&b, "backends"),
                pairings: self.words(&b, "pairings"),
                integration: self.words(&b, "integration"),
                extra_points: self.study_points(&b),
                vary: self.words(&b, "vary"),
                quantities: self.words(&b, "quantities"),
                norm: self.one_of(&b, "norm", &["l2", "h-half"]),
                ends: self.one_of(&b, "ends", &["case", "zero", "free"]),
                tol: b.node("tol").cloned().and_then(|tol| self.number_of(&tol, "tol", super::reader::Sign::Positive)),
            };
            out.push(Located::new(values, e.key_at));
        }
        out
    }

    // one of some words
    fn one_of(&mut self, b: &Block, key: &str, words: &[&str]) -> Option<String> {
        let node = b.node(key).cloned()?;
        let text = self.text_of(&node, key)?;
        if !words.contains(&text.value.as_str()) {
            self.fault("E015", text.at, format!("unknown {key} \"{}\"", text.value), format!("known: {}", words.join(", ")));
            return None;
        }
        Some(text.value)
    }

    // a text or a list of texts
    fn words(&mut self, b: &Block, key: &str) -> Vec<String> {
        let Some(node) = b.node(key).cloned() else { return Vec::new() };
        let items = match &node.value {
            Value::List(items) => items.clone(),
            _ => vec![node],
        };
        items.iter().filter_map(|item| self.text_of(item, key)).map(|text| text.value).collect()
    }

    // a number or a list of numbers
    fn study_points(&mut self, b: &Block) -> Vec<usize> {
        let Some(node) = b.node("extra_points").cloned() else { return Vec::new() };
        let items = match &node.value {
            Value::List(items) => items.clone(),
            _ => vec![node],
        };
        items.iter().filter_map(|item| self.whole_of(item, "extra_points", 0, 60)).collect()
    }

    // [1, 2, 3] or { iga = [2, 3, 4] }
    fn study_degrees(&mut self, node: &Node) -> Vec<String> {
        let mut list = |backend: Option<&str>, node: &Node| {
            let items = match &node.value {
                Value::List(items) => items.clone(),
                _ => vec![node.clone()],
            };
            let degrees: Vec<String> =
                items.iter().filter_map(|item| self.whole_of(item, "degrees", 1, 12)).map(|p| p.to_string()).collect();
            (!degrees.is_empty()).then(|| backend.map_or(String::new(), |b| format!("{b}:")) + &degrees.join(","))
        };
        match &node.value {
            Value::Table(table) => table.entries.iter().filter_map(|e| list(Some(&e.key), &e.node)).collect(),
            _ => list(None, node).into_iter().collect(),
        }
    }
}
