//! Reads `[[boundary]]`: prescribed values and loads.

use super::reader::{Block, Reader, Uses};
use super::tree::{Node, Value};
use super::types::*;
use crate::formula::Formula;
use crate::place::Located;

/// A boundary block; "all-outer" is resolved after all blocks are read.
#[derive(Debug)]
pub(super) struct Read {
    pub boundary: Boundary,
    pub all_outer: Option<crate::place::SourceSpan>,
}

impl Reader {
    /// One `[[boundary]]`.
    pub fn boundary(&mut self, b: &mut Block, index: usize, model: &Model, patches: &[Patch]) -> Read {
        let name = self.name(b, "boundary", index);
        let n = model.components();
        let mut all_outer = None;
        let on = match self.required(b, "on") {
            None => Vec::new(),
            Some(node) if matches!(&node.value, Value::Text(s) if s == "all-outer") => {
                all_outer = Some(node.at);
                Vec::new()
            }
            Some(node) => self.sides(&node, "on", patches),
        };
        let filter = self.filter(b);
        let mut dirichlet: Components<Datum> = (0..n).map(|_| None).collect();
        let (mut fix_normal, mut fix_tangential) = (None, None);
        if let Some(node) = b.node("fix").cloned() {
            self.fix(&node, &mut dirichlet, &mut fix_normal, &mut fix_tangential);
        }
        if let Some(node) = b.node("dirichlet").cloned() {
            for (k, datum) in self.components_of(&node, "dirichlet", Uses::Space, n, true).into_iter().enumerate() {
                let Some(datum) = datum else { continue };
                if dirichlet[k].is_some() {
                    let message = format!("component {} is fixed and prescribed in one block", component(n, k));
                    self.fault("E052", datum.at, message, "leave it out of `fix` or of `dirichlet`");
                } else {
                    dirichlet[k] = Some(datum);
                }
            }
        }
        let traction = self.traction(b, model);
        let pressure = self.formula(b, "pressure", Uses::Space);
        let mut resultant = |key: &str| -> Components<Formula> {
            let none = || (0..n).map(|_| None).collect();
            match b.node(key).cloned() {
                Some(node) if matches!(&node.value, Value::Table(t) if t.entries.is_empty()) => {
                    let example = if n == 1 { "u" } else { "x" };
                    self.wrong_type(&node, key, "a table of some components", format!("write {key} = {{ {example} = 1.0 }}"));
                    none()
                }
                Some(node) => self.formulas_of(&node, key, Uses::Space, n),
                None => none(),
            }
        };
        let (force, spring, rigid_force) = (resultant("force"), resultant("spring"), resultant("rigid_force"));
        // negative stiffness is unstable; the sign of formulas is not known here
        for k in spring.iter().flatten() {
            if let Some(value) = k.value.as_constant().filter(|v| *v < 0.0) {
                let message = format!("`spring` must not be negative, found {value:?}");
                self.fault("E015", k.at, message, "a spring pulls back with the force stiffness times displacement: write it positive");
            }
        }
        let kinds: Vec<&str> = b.keys.iter().map(|k| k.name).filter(|k| !["name", "on", "where"].contains(k)).collect();
        if !kinds.iter().any(|k| b.has(k) || b.refused.contains(k)) {
            let message = format!("{} has no condition", b.what);
            self.fault("E013", b.at, message, format!("give one of {}", kinds.join(", ")));
        }
        let boundary = Boundary {
            all_outer: all_outer.is_some(),
            head: b.head(),
            name,
            on,
            filter,
            dirichlet,
            fix_normal,
            fix_tangential,
            traction,
            pressure,
            force,
            spring,
            rigid_force,
        };
        Read { boundary, all_outer }
    }

    /// `where`, which is asked once.
    pub(super) fn filter(&mut self, b: &Block) -> Option<Located<Formula>> {
        let filter = self.formula(b, "where", Uses::Space)?;
        if filter.value.depends_on_time() {
            let message = "`where` must not depend on t: its facets are chosen once".to_owned();
            self.fault("E017", filter.at, message, "write loads that move as formulas of t, which are zero elsewhere");
            return None;
        }
        Some(filter)
    }

    fn fix(
        &mut self,
        node: &Node,
        dirichlet: &mut Components<Datum>,
        normal: &mut Option<Located<()>>,
        tangential: &mut Option<Located<()>>,
    ) {
        let n = dirichlet.len();
        let known: Vec<(&str, usize)> = if n == 1 {
            vec![("u", 0)]
        } else {
            ["x", "y", "z"][..n].iter().copied().zip(0..).chain([("normal", 10), ("tangential", 11)]).collect()
        };
        let items: Vec<&Node> = match &node.value {
            Value::List(list) if !list.is_empty() => list.iter().collect(),
            Value::Text(_) => vec![node],
            _ => {
                let example = if n == 1 { "fix = [\"u\"]" } else { "fix = [\"x\", \"y\"]" };
                self.wrong_type(node, "fix", "a list of components", format!("write {example}"));
                return;
            }
        };
        for item in items {
            match self.word_of(item, "fix", &known) {
                Some(10) => *normal = Some(Located::new((), item.at)),
                Some(11) => *tangential = Some(Located::new((), item.at)),
                Some(k) => dirichlet[k] = Some(Located::new(Datum::Formula(Formula::constant(0.0)), item.at)),
                None => {}
            }
        }
    }

    // `traction` and `neumann` mean the same
    fn traction(&mut self, b: &Block, model: &Model) -> Components<Datum> {
        let n = model.components();
        if b.has("traction") && b.has("neumann") {
            self.fault(
                "E015",
                b.key_at("neumann"),
                "`neumann` does not stand beside `traction`",
                "they mean the same: leave one of them out",
            );
        }
        let key = if b.has("traction") { "traction" } else { "neumann" };
        match b.node(key).cloned() {
            Some(node) => self.components_of(&node, key, Uses::Space, n, true),
            None => (0..n).map(|_| None).collect(),
        }
    }
}

/// The name of a component.
pub(super) fn component(n: usize, k: usize) -> &'static str {
    if n == 1 { "u" } else { ["x", "y", "z"][k.min(2)] }
}
