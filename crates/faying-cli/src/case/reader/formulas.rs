//! Formulas and lists: vectors, components, fields.

use super::{Block, Reader, Sign, Uses};
use crate::case::rows;
use crate::case::tree::{Node, Value};
use crate::case::types::{Components, Datum};
use crate::formula::{Formula, Scope};
use crate::place::Located;

impl Reader {
    pub fn push_formula_error(&mut self, node: &Node, what: &str, e: &crate::formula::FormulaError) {
        let at = node.inside(e.offset, e.length);
        let position = if node.literal && at.in_file().is_some() { String::new() } else { format!(" (character {})", e.offset + 1) };
        let help = e.help.clone().unwrap_or_default();
        self.fault("E017", at, format!("formula of `{what}`: {}{position}", e.message), help);
    }

    /// A number or a quoted formula.
    pub fn formula_of(&mut self, node: &Node, what: &str, uses: Uses) -> Option<Located<Formula>> {
        let text = match &node.value {
            Value::Text(text) => text,
            Value::Integer(_) | Value::Float(_) => {
                let v = self.number_of(node, what, Sign::Any)?;
                return Some(Located::new(Formula::constant(v), node.at));
            }
            _ => {
                self.wrong_type(node, what, "a number or a quoted formula", "");
                return None;
            }
        };
        let scope = match uses {
            Uses::Space => Scope::space(&self.constants),
            Uses::Gap => Scope::gap(&self.constants),
            Uses::Time => Scope::time(&self.constants),
            Uses::Check => Scope::check(&self.constants, &self.names),
        };
        match Formula::parse(text, &scope) {
            Ok(f) => {
                if f.as_constant().is_some_and(|v| !v.is_finite()) {
                    self.fault("E015", node.at, format!("the value of `{what}` is not finite"), "");
                    return None;
                }
                Some(Located::new(f, node.at))
            }
            Err(e) => {
                self.push_formula_error(node, what, &e);
                None
            }
        }
    }

    pub fn formula(&mut self, block: &Block, key: &str, uses: Uses) -> Option<Located<Formula>> {
        let node = block.node(key).cloned()?;
        self.formula_of(&node, key, uses)
    }

    /// Numbers of a list, each with its place.
    pub fn numbers_of(&mut self, node: &Node, what: &str) -> Option<Vec<Located<f64>>> {
        let Value::List(list) = &node.value else {
            self.wrong_type(node, what, "a list of numbers", "");
            return None;
        };
        let mut out = Vec::with_capacity(list.len());
        for n in list {
            out.push(Located::new(self.number_of(n, what, Sign::Any)?, n.at));
        }
        Some(out)
    }

    /// Two numbers, the second larger.
    pub fn pair(&mut self, block: &Block, key: &str, sign: Sign) -> Located<[f64; 2]> {
        let fallback = Located::new([1.0, 2.0], block.at);
        let Some(node) = self.required(block, key) else { return fallback };
        let example = block.key(key).example(self.dimension);
        let good = matches!(&node.value, Value::List(l) if l.len() == 2);
        if !good {
            self.wrong_type(&node, key, "a list of 2 numbers", format!("write {example}"));
            return fallback;
        }
        let Value::List(list) = &node.value else { return fallback };
        let (Some(a), Some(b)) = (self.number_of(&list[0], key, sign), self.number_of(&list[1], key, sign)) else { return fallback };
        if a >= b {
            self.fault("E015", node.at, format!("`{key}` must increase, found [{a:?}, {b:?}]"), format!("write {example}"));
            return fallback;
        }
        Located::new([a, b], node.at)
    }

    /// A point or direction: a list of all coordinates, in the plane also with a third that is 0; a table of some where allowed.
    pub fn vector_of(&mut self, node: &Node, what: &str, table: bool) -> Option<Located<Vec<f64>>> {
        let n = self.dimension;
        match &node.value {
            Value::List(list) => {
                let mut v = Vec::with_capacity(list.len());
                for item in list {
                    v.push(self.number_of(item, what, Sign::Any)?);
                }
                if n == 2 && v.len() == 3 && v[2] == 0.0 {
                    v.pop();
                }
                if v.len() != n {
                    self.fault(
                        "E044",
                        node.at,
                        format!("`{what}` must have {n} coordinates, found {}", list.len()),
                        format!("the model has dimension {n}"),
                    );
                    return None;
                }
                Some(Located::new(v, node.at))
            }
            Value::Table(_) if table => {
                let b = self.block(node, &format!("`{what}`"), &rows::COORDINATES[..n])?;
                let v = b.keys.iter().map(|k| self.number(&b, k.name).map_or(0.0, |v| v.value)).collect();
                Some(Located::new(v, node.at))
            }
            _ => {
                let expected = if table { format!("a list of {n} numbers or a table of some") } else { format!("a list of {n} numbers") };
                self.wrong_type(node, what, &expected, "");
                None
            }
        }
    }

    pub fn required_vector(&mut self, block: &Block, key: &str) -> Located<Vec<f64>> {
        let fallback = Located::new(vec![0.0; self.dimension], block.at);
        let Some(node) = self.required(block, key) else { return fallback };
        self.vector_of(&node, key, false).unwrap_or(fallback)
    }

    /// Data of some of `n` components: one formula if n = 1, a list of all, or a table of some; "exact" where allowed.
    pub fn components_of(&mut self, node: &Node, what: &str, uses: Uses, n: usize, exact: bool) -> Components<Datum> {
        let none = || -> Components<Datum> { (0..n).map(|_| None).collect() };
        match &node.value {
            Value::Text(s) if exact && s == "exact" => (0..n).map(|_| Some(Located::new(Datum::Exact, node.at))).collect(),
            Value::Text(_) | Value::Integer(_) | Value::Float(_) if n == 1 => vec![self.datum(node, what, uses, exact)],
            Value::List(list) => {
                if list.len() != n {
                    let help = format!("write a list of all {n}, or a table of some, such as {{ {} = \"0\" }}", axis(n, n - 1));
                    self.fault("E044", node.at, format!("`{what}` must have {n} components, found {}", list.len()), help);
                    return none();
                }
                list.iter().map(|item| self.datum(item, what, uses, exact)).collect()
            }
            Value::Table(_) => {
                let keys = if n == 1 { rows::UNKNOWN } else { &rows::COORDINATES[..n] };
                let Some(b) = self.block(node, &format!("`{what}`"), keys) else { return none() };
                keys.iter().map(|k| b.node(k.name).cloned().and_then(|item| self.datum(&item, what, uses, exact))).collect()
            }
            _ => {
                let expected =
                    if n == 1 { "a number or a quoted formula".to_owned() } else { format!("a list of {n} formulas or a table of some") };
                let expected = if exact { format!("\"exact\", {expected}") } else { expected };
                let help = if n == 1 { String::new() } else { format!("write {what} = {{ {} = {} }}", axis(n, n - 1), sample(node)) };
                self.wrong_type(node, what, &expected, help);
                none()
            }
        }
    }

    fn datum(&mut self, node: &Node, what: &str, uses: Uses, exact: bool) -> Option<Located<Datum>> {
        if exact && matches!(&node.value, Value::Text(s) if s == "exact") {
            return Some(Located::new(Datum::Exact, node.at));
        }
        self.formula_of(node, what, uses).map(|f| f.map(Datum::Formula))
    }

    /// Formulas of some of `n` components, as `components_of` without "exact".
    pub fn formulas_of(&mut self, node: &Node, what: &str, uses: Uses, n: usize) -> Components<Formula> {
        let data = self.components_of(node, what, uses, n, false);
        data.into_iter()
            .map(|d| {
                d.and_then(|l| match l.value {
                    Datum::Formula(f) => Some(Located::new(f, l.at)),
                    Datum::Exact => None,
                })
            })
            .collect()
    }

    /// All components, missing ones 0.
    pub fn field_of(&mut self, node: &Node, what: &str, uses: Uses, n: usize) -> Located<Vec<Located<Formula>>> {
        let data = self.formulas_of(node, what, uses, n);
        let all = data.into_iter().map(|d| d.unwrap_or_else(|| Located::new(Formula::constant(0.0), node.at))).collect();
        Located::new(all, node.at)
    }
}

fn axis(n: usize, k: usize) -> &'static str {
    if n == 1 { "u" } else { ["x", "y", "z"][k.min(2)] }
}

fn sample(node: &Node) -> String {
    match &node.value {
        Value::Text(s) if s.chars().count() < 30 => format!("{s:?}"),
        Value::Integer(n) => n.to_string(),
        Value::Float(v) => format!("{v:?}"),
        _ => "0".to_owned(),
    }
}
