//! Typed reading of values: every getter reports what is wrong at its place and lets reading go on.

use std::collections::BTreeSet;
use std::path::PathBuf;

use super::from_file::FromFile;
use super::keys;
use super::opened::{FileRead, Opened};
use super::sides::Family;
use super::tree::{Node, Table, Value};
use super::types::{Components, Datum, Joint, Meeting};
use crate::io::errors::{Diagnostic, Diagnostics, Source, nearest};
use crate::io::formula::{Constants, Formula, Scope};
use crate::io::place::{Located, Origin, Place};

/// Errors beyond this many are not kept.
const KEPT: usize = 500;

/// What reading needs everywhere.
#[derive(Debug)]
pub(super) struct Reader {
    pub source: Source,
    pub found: Diagnostics,
    pub constants: Constants,
    /// Names of blocks, which may hold `-` in formulas of checks.
    pub names: Vec<String>,
    pub dimension: usize,
    pub components: usize,
    /// What could not be read as a whole, `exact` or the names of a list such as `patch`: what refers to them shall not be reported again.
    pub broken: BTreeSet<String>,
    /// Whether a density is given but could not be read.
    pub density_broken: bool,
    /// The folder that paths are relative to.
    pub folder: PathBuf,
    /// Most bytes that reading a file may take.
    pub memory: Option<u64>,
    /// Files read so far.
    pub files: Vec<FileRead>,
    /// Geometry files opened so far.
    pub opened: Vec<Opened>,
    /// One entry per patch, until patches are expanded.
    pub from_files: Vec<Option<FromFile>>,
    /// Names that stand for all patches of a file.
    pub families: Vec<Family>,
    /// Sides that are one.
    pub joints: Vec<Joint>,
    /// Points that are one.
    pub meetings: Vec<Meeting>,
}

/// A table that is being read.
#[derive(Debug)]
pub(super) struct Block {
    pub table: Table,
    /// Its head, or the value itself for an inline table.
    pub at: Place,
    /// What it is: `material "steel"`.
    pub what: String,
    pub keys: Vec<&'static str>,
    /// Keys that unknown ones stand for although they are given, too.
    pub meant: Vec<&'static str>,
}

impl Block {
    pub fn node(&self, key: &str) -> Option<&Node> {
        self.table.get(key).map(|e| &e.node)
    }

    pub fn has(&self, key: &str) -> bool {
        self.table.get(key).is_some()
    }

    /// The place of a key, or of the head where the key is absent.
    pub fn key_at(&self, key: &str) -> Place {
        self.table.get(key).map_or(self.at, |e| e.key_at)
    }

    /// Writes a default into the tree, where the effective case finds it.
    pub fn default(&mut self, key: &str, value: Value) -> Place {
        let at = Place { origin: Origin::Default, ..self.at };
        self.table.set(key, at, Node::new(value, at));
        at
    }

    /// Puts the read form of an inline table, with its defaults, in place of what the file says.
    pub fn replace(&mut self, key: &str, table: Table) {
        if let Some(e) = self.table.get_mut(key) {
            e.node.value = Value::Table(table);
        }
    }

    /// The table in the order of its keys.
    pub fn finish(mut self) -> Table {
        self.table.order(&self.keys);
        self.table
    }

    pub fn head(&self) -> Located<()> {
        Located::new((), self.at)
    }
}

/// Signs that a number may have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Sign {
    Any,
    Positive,
}

/// Which names a formula may use.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Uses {
    Space,
    Gap,
    Time,
    Check,
}

impl Reader {
    pub fn push(&mut self, at: Place, diagnostic: Diagnostic) {
        if self.found.items.len() < KEPT {
            let located = diagnostic.at(&self.source, at);
            self.found.push(located);
        }
    }

    pub fn fault(&mut self, code: &'static str, at: Place, message: impl Into<String>, help: impl Into<String>) {
        let help = help.into();
        let d = Diagnostic::error(code, message);
        self.push(at, if help.is_empty() { d } else { d.with_help(help) });
    }

    pub fn wrong_type(&mut self, node: &Node, what: &str, expected: &str, help: impl Into<String>) {
        // names of blocks are quoted already
        let what = what.trim_matches('`');
        self.fault("E014", node.at, format!("`{what}` must be {expected}, found {}", node.describe()), help);
    }

    // blocks ------------------------------------------------------------------------------------

    /// Opens a table; unknown keys are reported with the nearest known one, and read as it where it is absent, so that a
    /// misspelt key is one error.
    pub fn block(&mut self, node: &Node, what: &str, known: &[&'static str]) -> Option<Block> {
        let Value::Table(table) = &node.value else {
            self.wrong_type(node, what, "a table", "");
            return None;
        };
        let mut table = table.clone();
        for (alias, key) in keys::ALIASES {
            if !known.contains(key) {
                continue;
            }
            if let Some(at) = table.get(alias).map(|e| e.key_at) {
                if table.get(key).is_some() {
                    self.fault("E016", at, format!("`{alias}` is another name of `{key}`, which is given too"), format!("keep `{key}`"));
                    table.entries.retain(|e| e.key != *alias);
                } else if let Some(e) = table.get_mut(alias) {
                    e.key = (*key).to_owned();
                }
            }
        }
        let named = match table.get("name").map(|e| &e.node.value) {
            Some(Value::Text(name)) if known.contains(&"name") => format!("{what} {name:?}"),
            _ => what.to_owned(),
        };
        let unknown: Vec<(String, Place)> =
            table.entries.iter().filter(|e| !known.contains(&e.key.as_str())).map(|e| (e.key.clone(), e.key_at)).collect();
        let mut meant = Vec::new();
        for (key, at) in unknown {
            let Some(near) = self.unknown_key(&key, at, &named, known) else { continue };
            if table.get(near).is_some() {
                meant.push(near);
            } else if let Some(e) = table.get_mut(&key) {
                e.key = near.to_owned();
            }
        }
        table.entries.retain(|e| known.contains(&e.key.as_str()));
        Some(Block { table, at: node.at, what: named, keys: known.to_vec(), meant })
    }

    /// Reports an unknown key; returns the known one that it stands for.
    pub fn unknown_key(&mut self, key: &str, at: Place, what: &str, known: &[&'static str]) -> Option<&'static str> {
        if keys::LATER.contains(&key) {
            self.fault("E019", at, format!("`{key}` is not in this version"), format!("keys here: {}", known.join(", ")));
            return None;
        }
        let place = if what.is_empty() { "at the top level".to_owned() } else { format!("in {what}") };
        let mut d = Diagnostic::error("E012", format!("unknown key `{key}` {place}"));
        let symbol = keys::SYMBOLS.iter().find(|(s, k)| *s == key && known.contains(k)).map(|(_, k)| *k);
        let near = symbol.or_else(|| nearest(key, known.iter().copied())).and_then(|n| known.iter().find(|k| **k == n).copied());
        if let Some(near) = near {
            d = d.with_label(format!("did you mean `{near}`?"));
        }
        self.push(at, d.with_help(format!("keys here: {}", known.join(", "))));
        near
    }

    pub fn missing(&mut self, block: &Block, key: &str, example: &str) {
        let what = block.what.clone();
        self.fault("E013", block.at, format!("`{key}` is missing in {what}"), format!("write {example}"));
    }

    /// The node of a required key.
    pub fn required(&mut self, block: &Block, key: &str, example: &str) -> Option<Node> {
        let node = block.node(key).cloned();
        if node.is_none() {
            self.missing(block, key, example);
        }
        node
    }

    // scalars -----------------------------------------------------------------------------------

    pub fn text_of(&mut self, node: &Node, what: &str) -> Option<Located<String>> {
        match &node.value {
            Value::Text(s) => Some(Located::new(s.clone(), node.at)),
            _ => {
                self.wrong_type(node, what, "a text in quotes", "");
                None
            }
        }
    }

    pub fn flag(&mut self, block: &mut Block, key: &str, default: bool) -> Located<bool> {
        match block.node(key).cloned() {
            None => Located::new(default, block.default(key, Value::Bool(default))),
            Some(Node { value: Value::Bool(b), at, .. }) => Located::new(b, at),
            Some(node) => {
                self.wrong_type(&node, key, "true or false", format!("write {key} = {default}"));
                Located::new(default, node.at)
            }
        }
    }

    pub fn whole_of(&mut self, node: &Node, what: &str, least: i64, most: i64) -> Option<usize> {
        let range = if most >= i64::from(i32::MAX) {
            format!("a whole number of at least {least}")
        } else {
            format!("a whole number from {least} to {most}")
        };
        let (wrong_type, near) = match &node.value {
            Value::Integer(n) if (least..=most).contains(n) => return usize::try_from(*n).ok(),
            Value::Integer(n) => (false, (*n).clamp(least, most)),
            Value::Float(v) if v.is_finite() && v.abs() < 1e15 => (true, (v.round() as i64).clamp(least, most)),
            Value::Text(s) => (true, s.trim().parse::<i64>().unwrap_or(least).clamp(least, most)),
            _ => (true, least),
        };
        let message = format!("`{what}` must be {range}, found {}", node.describe());
        let help = if what.contains(' ') { String::new() } else { format!("write {what} = {near}") };
        self.fault(if wrong_type { "E014" } else { "E015" }, node.at, message, help);
        None
    }

    pub fn whole(&mut self, block: &mut Block, key: &str, least: i64, most: i64, default: usize) -> Located<usize> {
        match block.node(key).cloned() {
            None => Located::new(default, block.default(key, Value::Integer(default as i64))),
            Some(node) => Located::new(self.whole_of(&node, key, least, most).unwrap_or(default), node.at),
        }
    }

    /// A number, or a formula of constants.
    pub fn number_of(&mut self, node: &Node, what: &str, sign: Sign) -> Option<f64> {
        let value = match &node.value {
            Value::Integer(n) => *n as f64,
            Value::Float(v) => *v,
            Value::Text(text) => {
                let parsed = Formula::parse(text, &Scope::number(&self.constants));
                match parsed {
                    Ok(f) => f.value(&Default::default()),
                    Err(e) => {
                        self.push_formula_error(node, what, &e);
                        return None;
                    }
                }
            }
            _ => {
                self.wrong_type(node, what, "a number", "");
                return None;
            }
        };
        let allowed = match sign {
            Sign::Any => "finite",
            Sign::Positive => "positive",
        };
        let good = value.is_finite()
            && match sign {
                Sign::Any => true,
                Sign::Positive => value > 0.0,
            };
        if !good {
            self.fault("E015", node.at, format!("`{what}` must be {allowed}, found {value:?}"), "");
            return None;
        }
        Some(value)
    }

    /// "auto" or a positive number.
    pub fn auto(&mut self, block: &mut Block, key: &str) -> Located<Option<f64>> {
        match block.node(key).cloned() {
            None => Located::new(None, block.default(key, Value::Text("auto".to_owned()))),
            Some(Node { value: Value::Text(s), at, .. }) if s == "auto" => Located::new(None, at),
            Some(node) => Located::new(self.number_of(&node, key, Sign::Positive), node.at),
        }
    }

    pub fn number(&mut self, block: &Block, key: &str, sign: Sign) -> Option<Located<f64>> {
        let node = block.node(key).cloned()?;
        self.number_of(&node, key, sign).map(|v| Located::new(v, node.at))
    }

    pub fn required_number(&mut self, block: &Block, key: &str, sign: Sign, example: &str) -> Located<f64> {
        let Some(node) = self.required(block, key, example) else { return Located::new(1.0, block.at) };
        Located::new(self.number_of(&node, key, sign).unwrap_or(1.0), node.at)
    }

    /// One of some words.
    pub fn word_of<T: Copy>(&mut self, node: &Node, what: &str, words: &[(&str, T)]) -> Option<T> {
        let list = words.iter().map(|(w, _)| format!("{w:?}")).collect::<Vec<_>>().join(", ");
        let Value::Text(text) = &node.value else {
            self.wrong_type(node, what, &format!("one of {list}"), "");
            return None;
        };
        if let Some((_, value)) = words.iter().find(|(w, _)| w == text) {
            return Some(*value);
        }
        if keys::LATER.contains(&text.as_str()) {
            self.fault("E019", node.at, format!("{text:?} is not in this version"), format!("`{what}` is one of {list}"));
            return None;
        }
        let text: String = text.chars().take(60).collect();
        let mut d = Diagnostic::error("E015", format!("`{what}` must be one of {list}, found {text:?}"));
        if let Some(near) = nearest(&text, words.iter().map(|(w, _)| *w)) {
            d = d.with_label(format!("did you mean {near:?}?"));
        }
        self.push(node.at, d);
        None
    }

    /// One of some words; the first is the default.
    pub fn word<T: Copy>(&mut self, block: &mut Block, key: &str, words: &[(&str, T)]) -> Located<T> {
        let (name, default) = words[0];
        match block.node(key).cloned() {
            None => Located::new(default, block.default(key, Value::Text(name.to_owned()))),
            Some(node) => Located::new(self.word_of(&node, key, words).unwrap_or(default), node.at),
        }
    }

    // names -------------------------------------------------------------------------------------

    /// `name`: required with an example, or else made of the kind and the position.
    pub fn name(&mut self, block: &mut Block, kind: &str, index: usize, required: bool) -> Located<String> {
        let fallback = format!("{kind}-{index}");
        match block.node("name").cloned() {
            None if required => {
                self.missing(block, "name", if kind == "material" { "name = \"steel\"" } else { "name = \"lower\"" });
                self.broken.insert(kind.to_owned());
                Located::new(fallback, block.at)
            }
            None => {
                let at = block.default("name", Value::Text(fallback.clone()));
                Located::new(fallback, at)
            }
            Some(node) => {
                let Some(name) = self.text_of(&node, "name") else {
                    self.broken.insert(kind.to_owned());
                    return Located::new(fallback, node.at);
                };
                // a bad name stays: what refers to it finds it
                if name.is_empty() || !name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_' || c == '-') {
                    self.fault("E016", node.at, format!("{:?} is no name", name.value), "names are made of letters, digits, `_` and `-`");
                }
                name
            }
        }
    }

    /// Names of one kind are unique.
    pub fn unique(&mut self, kind: &str, names: &[Located<String>]) {
        let mut first = std::collections::BTreeMap::new();
        for n in names {
            if let Some(at) = first.get(&n.value).copied() {
                let place: Place = at;
                let line = place.in_file().map_or(String::new(), |(l, _)| format!(" on line {l}"));
                self.fault(
                    "E016",
                    n.at,
                    format!("the {kind} name {:?} is already used{line}", n.value),
                    "names are unique within their kind",
                );
                self.broken.insert(kind.to_owned());
            } else {
                first.insert(n.value.clone(), n.at);
            }
        }
    }

    // formulas ----------------------------------------------------------------------------------

    pub fn push_formula_error(&mut self, node: &Node, what: &str, e: &crate::io::formula::FormulaError) {
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

    // lists -------------------------------------------------------------------------------------

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
    pub fn pair(&mut self, block: &Block, key: &str, sign: Sign, example: &str) -> Located<[f64; 2]> {
        let fallback = Located::new([1.0, 2.0], block.at);
        let Some(node) = self.required(block, key, example) else { return fallback };
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
                let known: &[&'static str] = &["x", "y", "z"][..n];
                let b = self.block(node, &format!("`{what}`"), known)?;
                let v = known.iter().map(|k| self.number(&b, k, Sign::Any).map_or(0.0, |v| v.value)).collect();
                Some(Located::new(v, node.at))
            }
            _ => {
                let expected = if table { format!("a list of {n} numbers or a table of some") } else { format!("a list of {n} numbers") };
                self.wrong_type(node, what, &expected, "");
                None
            }
        }
    }

    pub fn required_vector(&mut self, block: &Block, key: &str, example: &str) -> Located<Vec<f64>> {
        let fallback = Located::new(vec![0.0; self.dimension], block.at);
        let Some(node) = self.required(block, key, example) else { return fallback };
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
                let known: &[&'static str] = if n == 1 { &["u"] } else { &["x", "y", "z"][..n] };
                let Some(b) = self.block(node, &format!("`{what}`"), known) else { return none() };
                known.iter().map(|k| b.node(k).cloned().and_then(|item| self.datum(&item, what, uses, exact))).collect()
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

    /// The same without "exact".
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
