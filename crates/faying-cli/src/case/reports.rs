//! Reads `[[probe]]`, `[[check]]` and `[study.*]`.

use super::key::KeyKind;
use super::reader::{Block, Reader, Sign, Uses};
use super::rows;
use super::tree::{Node, Value};
use super::types::*;
use crate::errors::{Diagnostic, nearest};
use crate::formula::Formula;
use crate::place::Located;

impl Reader {
    fn quantity(&mut self, b: &Block) -> Located<String> {
        let node = self.required(b, "quantity");
        let Some(text) = node.and_then(|n| self.text_of(&n, "quantity")) else { return Located::new("energy".to_owned(), b.at) };
        if text.trim().is_empty() {
            self.fault("E018", text.at, "the quantity is empty", "write for example quantity = \"energy\"");
        }
        text
    }

    /// One `[[probe]]`.
    pub fn probe(&mut self, b: &mut Block, index: usize) -> Probe {
        Probe { head: b.head(), name: self.name(b, "probe", index), quantity: self.quantity(b), t: self.asked_steps(b) }
    }

    /// `t`: a time, or "all".
    fn asked_steps(&mut self, b: &Block) -> Option<Located<AskedSteps>> {
        let node = b.node("t").cloned()?;
        let steps = match &node.value {
            Value::Text(word) if word == "all" => AskedSteps::All,
            Value::Integer(_) | Value::Float(_) => AskedSteps::At(self.number_of(&node, "t", Sign::Any)?),
            _ => {
                self.wrong_type(&node, "t", "a time of [steps], or \"all\"", "write t = 0.5");
                return None;
            }
        };
        Some(Located::new(steps, node.at))
    }

    /// One `[[line]]`.
    pub fn line(&mut self, b: &mut Block, index: usize) -> Line {
        let name = self.name(b, "line", index);
        let node = self.required(b, "quantity");
        let items = match node.as_ref().map(|n| &n.value) {
            Some(Value::List(items)) => items.clone(),
            _ => node.into_iter().collect(),
        };
        let quantities: Vec<Located<String>> = items.iter().filter_map(|item| self.text_of(item, "quantity")).collect();
        let (from, to) = (self.required_vector(b, "from"), self.required_vector(b, "to"));
        if from.value == to.value {
            self.fault("E015", to.at, "the line has no length: `from` and `to` are one point", "write a [[probe]] for a point");
        }
        let (n, t) = (self.whole(b, "n"), self.asked_steps(b));
        Line { head: b.head(), name, quantities, from, to, n, t }
    }

    /// One `[[check]]`.
    pub fn check(&mut self, b: &mut Block, index: usize) -> Check {
        let name = self.name(b, "check", index);
        let quantity = self.quantity(b);
        let given: Vec<&str> = ["below", "above", "equals"].into_iter().filter(|k| b.has(k)).collect();
        let zero = || Located::new(Formula::constant(0.0), b.at);
        let bound = |r: &mut Self, key: &str| r.formula(b, key, Uses::Check).unwrap_or_else(zero);
        if let Some(second) = given.get(1) {
            self.fault("E015", b.key_at(second), format!("`{second}` does not stand beside `{}`", given[0]), "write two checks");
        }
        let condition = match given.first().copied() {
            Some("below") => Condition::Below(bound(self, "below")),
            Some("above") => Condition::Above(bound(self, "above")),
            Some(_) => {
                if !b.has("rtol") && !b.has("atol") {
                    self.fault("E013", b.at, format!("`rtol` is missing in {}", b.what), "write rtol = 1e-6, or atol");
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
            let value = self.entry_name_of(b, &node, "backend")?;
            Some(Located::new(value, node.at))
        });
        let over_all = self.optional_word(b, "over", &[()]);
        let t = self.asked_steps(b);
        Check { head: b.head(), name, quantity, condition, backend, over_all, t }
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
            if !rows::STUDIES.contains(&e.key.as_str()) {
                let mut d = Diagnostic::error("E012", format!("unknown study `{}`", e.key));
                if let Some(near) = nearest(&e.key, rows::STUDIES.iter().copied()) {
                    d = d.with_label(format!("did you mean `{near}`?"));
                }
                self.push(e.key_at, d.with_help(format!("studies: {}", rows::STUDIES.join(", "))));
                continue;
            }
            let Some(b) = self.block(&e.node, &format!("`study.{}`", e.key), rows::STUDY) else { continue };
            let values = StudyValues {
                name: e.key.clone(),
                levels: self.optional_whole(&b, "levels").map(|n| n.value),
                degrees: b.node("degrees").cloned().map_or(Vec::new(), |node| self.study_degrees(&node)),
                backends: self.words(&b, "backends"),
                pairings: self.words(&b, "pairings"),
                integration: self.words(&b, "integration"),
                extra_points: self.study_points(&b),
                vary: self.words(&b, "vary"),
                quantities: self.words(&b, "quantities"),
                norm: self.one_of(&b, "norm"),
                ends: self.one_of(&b, "ends"),
                tol: self.number(&b, "tol").map(|v| v.value),
            };
            out.push(Located::new(values, e.key_at));
        }
        out
    }

    // one of the words of a key
    fn one_of(&mut self, b: &Block, key: &str) -> Option<String> {
        let KeyKind::Word(words) = b.key(key).kind else { panic!("`{key}` is no word") };
        self.optional_word(b, key, words).map(|word| word.value.to_owned())
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
