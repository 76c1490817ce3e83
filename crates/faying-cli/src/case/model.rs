//! Reads `[let]`, `[model]`, `[discretization]`, `[[material]]`, `[steps]` and `[solver]`.

use super::keys;
use super::reader::{Block, Reader, Sign, Uses};
use super::tree::{Node, Table, Value};
use super::types::*;
use crate::formula::{ConstantText, Constants, Formula, is_free_name};
use crate::place::{Located, Place};

use super::names::Names;

impl Reader {
    /// `[let]`: constants of every formula.
    pub fn constants(&mut self, node: Option<&Node>) {
        let Some(node) = node else { return };
        let Value::Table(table) = &node.value else {
            self.wrong_type(node, "let", "a table of constants", "write [let] and below it NAME = VALUE");
            return;
        };
        let mut definitions = Vec::new();
        let mut nodes = Vec::new();
        let mut known = Vec::new();
        for e in &table.entries {
            if !is_free_name(&e.key) {
                let help = "names in formulas are letters, digits and `_`, begin with a letter, and are none of x, y, z, t, r, theta, g, pi, e, nor a function";
                self.fault("E016", e.key_at, format!("`{}` cannot be the name of a constant", e.key), help);
                continue;
            }
            known.push(e.key.clone());
            let text = match &e.node.value {
                Value::Text(s) => ConstantText::Formula(s.clone()),
                Value::Integer(_) | Value::Float(_) => match self.number_of(&e.node, &e.key, Sign::Any) {
                    Some(v) => ConstantText::Number(v),
                    None => continue,
                },
                _ => {
                    self.wrong_type(&e.node, &e.key, "a number or a quoted formula", "");
                    continue;
                }
            };
            definitions.push((e.key.clone(), text));
            nodes.push(e.node.clone());
        }
        let (constants, errors) = Constants::resolve(&definitions);
        for (k, e) in errors {
            self.push_formula_error(&nodes[k], &definitions[k].0, &e);
        }
        self.constants = constants;
        // constants with an error get a value, so that formulas that use them are not reported again
        for name in &known {
            if self.constants.get(name).is_none() {
                self.constants.insert(name, 1.0);
            }
        }
    }

    /// `[model]`.
    pub fn model(&mut self, b: &mut Block) -> Model {
        let physics = match self.required(b, "physics", "physics = \"elasticity\"") {
            Some(node) => Located::new(
                self.word_of(&node, "physics", &[("poisson", Physics::Poisson), ("elasticity", Physics::Elasticity)])
                    .unwrap_or(Physics::Elasticity),
                node.at,
            ),
            None => Located::new(Physics::Elasticity, b.at),
        };
        let dimension = match self.required(b, "dimension", "dimension = 2") {
            Some(node) => Located::new(self.whole_of(&node, "dimension", 2, 3).unwrap_or(2), node.at),
            None => Located::new(2, b.at),
        };
        self.dimension = dimension.value;
        let poisson = physics.value == Physics::Poisson;
        let n = if poisson { 1 } else { dimension.value };
        self.components = n;
        let words = [("plane-strain", Assumption::PlaneStrain), ("plane-stress", Assumption::PlaneStress)];
        let assumption = if poisson || dimension.value == 3 {
            let axisymmetric = b.node("assumption").is_some_and(|node| matches!(&node.value, Value::Text(word) if word == "axisymmetric"));
            if axisymmetric && dimension.value == 2 {
                self.word(b, "assumption", &words);
            } else if b.has("assumption") {
                let why =
                    if poisson { "plane elasticity, the physics here is poisson" } else { "plane elasticity, the dimension here is 3" };
                self.fault("E015", b.key_at("assumption"), format!("`assumption` is a key of {why}"), "");
            }
            Located::new(if dimension.value == 3 { Assumption::Solid } else { Assumption::PlaneStrain }, Place::NONE)
        } else {
            self.word(b, "assumption", &words)
        };
        let exact = b.node("exact").cloned().and_then(|node| {
            let inner = self.block(&node, "`exact`", &["u"])?;
            let u = self.required(&inner, "u", if n == 1 { "exact = { u = \"x*y\" }" } else { "exact = { u = [\"x*y\", \"0\"] }" })?;
            let field = self.field_of(&u, "exact.u", Uses::Space, n);
            Some(field)
        });
        if b.has("exact") && exact.is_none() {
            self.broken.insert("exact".to_owned());
        }
        let source = self.source(b, poisson, n);
        if let (Some(_), Some(s)) = (&exact, &source) {
            self.fault(
                "E015",
                s.at,
                "a body force or source does not stand beside `exact`".to_owned(),
                "it follows from `exact`; leave one of them out",
            );
        }
        let gravity = self.gravity(b, poisson);
        let reference = b.node("reference").cloned().and_then(|node| self.text_of(&node, "reference"));
        let stored = reference.as_ref().and_then(|file| self.open_reference(file));
        self.absolute(b, "reference");
        Model { head: b.head(), physics, dimension, assumption, exact, source, gravity, reference, stored }
    }

    /// `gravity` (elasticity).
    pub fn gravity(&mut self, b: &Block, poisson: bool) -> Option<Located<Vec<f64>>> {
        let gravity = b.node("gravity").cloned().and_then(|node| self.vector_of(&node, "gravity", true));
        if let (true, Some(g)) = (poisson, &gravity) {
            self.fault("E015", g.at, "`gravity` is a key of elasticity, the physics here is poisson", "use source");
            return None;
        }
        gravity
    }

    /// `source` (Poisson) or `body_force` (elasticity).
    pub fn source(&mut self, b: &Block, poisson: bool, n: usize) -> Option<Located<Vec<Located<Formula>>>> {
        let (key, other) = if poisson { ("source", "body_force") } else { ("body_force", "source") };
        if b.has(other) {
            let physics = if poisson { "poisson" } else { "elasticity" };
            self.fault("E015", b.key_at(other), format!("`{other}` is not a key of {physics}"), format!("write {key}"));
        }
        let node = b.node(key).cloned()?;
        Some(self.field_of(&node, key, Uses::Space, n))
    }

    /// `[discretization]`, or the keys of a patch over these defaults.
    pub fn discretization(&mut self, b: &mut Block, defaults: Option<&Discretization>, names: &Names) -> Discretization {
        let own = |b: &Block, key: &str| defaults.is_none() || b.has(key);
        let backend =
            if own(b, "backend") { self.registered(b, "backend", &names.backends, "iga") } else { inherit(defaults, |d| &d.backend) };
        let degree = if own(b, "degree") { self.degrees(b) } else { inherit(defaults, |d| &d.degree) };
        let continuity = if own(b, "continuity") { self.continuity(b) } else { inherit(defaults, |d| &d.continuity) };
        let basis = if own(b, "basis") { self.word(b, "basis", &BASES) } else { inherit(defaults, |d| &d.basis) };
        let cells = if own(b, "cells") { self.word(b, "cells", &CELLS) } else { inherit(defaults, |d| &d.cells) };
        let mapping = if own(b, "mapping") { self.word(b, "mapping", &MAPPINGS) } else { inherit(defaults, |d| &d.mapping) };
        let extra_points =
            if own(b, "extra_points") { self.whole(b, "extra_points", 0, 60, 0) } else { inherit(defaults, |d| &d.extra_points) };
        Discretization { backend, degree, continuity, basis, cells, mapping, extra_points }
    }

    /// Checks the ranges that depend on several keys of one patch.
    pub fn check_discretization(&mut self, d: &Discretization) {
        let (most, what) = match (d.backend.value.as_str(), d.cells.value) {
            ("fe", Cell::Tensor) => (8, " for backend fe"),
            ("fe", Cell::Simplex) => (4, " for backend fe with simplex cells"),
            _ => (12, ""),
        };
        let at = d.degree.at;
        if let Some(p) = d.degree.iter().find(|p| **p > most) {
            self.fault(
                "E015",
                at,
                format!("`degree` must be a whole number from 1 to {most}{what}, found {p}"),
                format!("write degree = {most}"),
            );
        }
        if d.backend.value == "fe" && d.cells.value == Cell::Simplex && d.degree.iter().any(|p| *p != d.degree[0]) {
            self.fault("E015", at, "simplex cells have one degree for all directions", format!("write degree = {}", d.degree[0]));
        }
        if let (Some(k), "iga") = (d.continuity.value, d.backend.value.as_str()) {
            let least = d.degree.iter().copied().min().unwrap_or(1);
            if k >= least {
                let message = format!("`continuity` must be less than the degree {least}, found {k}");
                self.fault("E015", d.continuity.at, message, "write continuity = \"max\" for the smoothest functions");
            }
        }
    }

    // a name of the registry
    pub fn registered(&mut self, b: &mut Block, key: &str, known: &[String], default: &str) -> Located<String> {
        match b.node(key).cloned() {
            None => Located::new(default.to_owned(), b.default(key, Value::Text(default.to_owned()))),
            Some(node) => Located::new(self.registered_of(&node, key, known).unwrap_or_else(|| default.to_owned()), node.at),
        }
    }

    pub fn registered_of(&mut self, node: &Node, key: &str, known: &[String]) -> Option<String> {
        let words: Vec<(&str, usize)> = known.iter().enumerate().map(|(k, n)| (n.as_str(), k)).collect();
        self.word_of(node, key, &words).map(|k| known[k].clone())
    }

    fn degrees(&mut self, b: &mut Block) -> Located<Vec<usize>> {
        let n = self.dimension;
        match b.node("degree").cloned() {
            None => Located::new(vec![2; n], b.default("degree", Value::Integer(2))),
            Some(node) => {
                let degree = match &node.value {
                    Value::List(list) if list.len() == n => {
                        list.iter().map(|item| self.whole_of(item, "degree", 1, 12).unwrap_or(2)).collect()
                    }
                    Value::List(list) => {
                        let message = format!("`degree` must be one number or a list of {n}, found a list of {}", list.len());
                        self.fault("E044", node.at, message, format!("the model has dimension {n}"));
                        vec![2; n]
                    }
                    _ => vec![self.whole_of(&node, "degree", 1, 12).unwrap_or(2); n],
                };
                Located::new(degree, node.at)
            }
        }
    }

    fn continuity(&mut self, b: &mut Block) -> Located<Option<usize>> {
        match b.node("continuity").cloned() {
            None => Located::new(None, b.default("continuity", Value::Text("max".to_owned()))),
            Some(Node { value: Value::Text(s), at, .. }) if s == "max" => Located::new(None, at),
            Some(node) if matches!(node.value, Value::Integer(_)) => Located::new(self.whole_of(&node, "continuity", 0, 11), node.at),
            Some(node) => {
                self.wrong_type(&node, "continuity", "\"max\" or a whole number from 0 to degree - 1", "write continuity = \"max\"");
                Located::new(None, node.at)
            }
        }
    }

    /// `[[material]]`; by default one without properties for Poisson.
    pub fn materials(&mut self, root: &mut Block, model: &Model) -> Vec<Material> {
        let mut known = keys::MATERIAL.to_vec();
        if !self.known.laws.is_empty() {
            known.push("law");
        }
        for key in self.known.laws.iter().flat_map(|entry| &entry.keys) {
            if !known.contains(&key.name) {
                known.push(key.name);
            }
        }
        let mut materials = self.list(root, "material", &known, |r, b, k| r.material(b, k, model));
        if materials.is_empty() && model.physics.value == Physics::Poisson && !root.has("material") {
            let mut table = Table::default();
            table.set("name", Place::NONE, Node::new(Value::Text("default".to_owned()), Place::NONE));
            root.default("material", Value::List(vec![Node::new(Value::Table(table), Place::NONE)]));
            materials = self.list(root, "material", keys::MATERIAL, |r, b, k| r.material(b, k, model));
        }
        self.unique("material", &materials.iter().map(|m| m.name.clone()).collect::<Vec<_>>());
        materials
    }

    /// One `[[material]]`.
    pub fn material(&mut self, b: &mut Block, index: usize, model: &Model) -> Material {
        let name = self.name(b, "material", index, true);
        let poisson = model.physics.value == Physics::Poisson;
        if let Some(law) = self.law(b) {
            let density = self.formula(b, "density", Uses::Space);
            self.density_broken |= density.is_none() && b.has("density");
            let conductivity = Located::new(Formula::constant(1.0), b.at);
            return Material { head: b.head(), name, law: Some(law), elastic: None, conductivity, density };
        }
        let wrong: &[&str] = if poisson { &["young", "poisson", "lambda", "mu", "law"] } else { &["conductivity"] };
        for key in wrong.iter().filter(|k| b.has(k)) {
            let (physics, keys) = if poisson { ("poisson", "conductivity") } else { ("elasticity", "young, poisson, lambda, mu, density") };
            self.fault(
                "E015",
                b.key_at(key),
                format!("`{key}` is not a key of a material for physics {physics}"),
                format!("keys here: name, {keys}"),
            );
        }
        let density = self.formula(b, "density", Uses::Space);
        self.density_broken |= density.is_none() && b.has("density");
        let conductivity = match self.formula(b, "conductivity", Uses::Space) {
            Some(k) => k,
            None if poisson && !b.has("conductivity") => Located::new(Formula::constant(1.0), b.default("conductivity", Value::Float(1.0))),
            None => Located::new(Formula::constant(1.0), b.at),
        };
        if poisson {
            self.limit(&conductivity, "conductivity", "positive", |v| v > 0.0, "");
        }
        if let Some(d) = &density {
            self.limit(d, "density", "0 or positive", |v| v >= 0.0, "");
        }
        let elastic = if poisson { None } else { self.elastic(b, model) };
        Material { head: b.head(), name, law: None, elastic, conductivity, density }
    }

    /// The law of the registry that a material names. Keys of other laws are reported; where a value cannot be read, the law is without.
    fn law(&mut self, b: &mut Block) -> Option<Located<Law>> {
        let node = b.node("law").cloned();
        let named = |n: &Node| matches!(&n.value, Value::Text(word) if word == "hooke");
        let word = node.as_ref().filter(|n| !named(n)).and_then(|n| self.text_of(n, "law"));
        let entry = word.as_ref().and_then(|word| self.known.laws.iter().find(|entry| entry.name == word.value).cloned());
        let own: Vec<&str> = entry.iter().flat_map(|e| &e.keys).map(|k| k.name).collect();
        let given: Vec<&'static str> = b.keys.iter().copied().filter(|key| b.has(key)).collect();
        for key in given {
            let foreign =
                if entry.is_some() { !["name", "density", "law"].contains(&key) } else { !keys::MATERIAL.contains(&key) && key != "law" };
            if foreign && !own.contains(&key) {
                let law = entry.as_ref().map_or("hooke", |e| e.name.as_str());
                let known = if entry.is_some() { own.join(", ") } else { keys::MATERIAL[1..].join(", ") };
                self.fault("E015", b.key_at(key), format!("`{key}` is not a key of law {law:?}"), format!("keys here: name, {known}"));
            }
        }
        let (word, entry) = (word?, entry?);
        let given = self.given(b, &entry.keys).unwrap_or_default();
        Some(Located::new(Law { name: entry.name, given }, word.at))
    }

    fn elastic(&mut self, b: &mut Block, model: &Model) -> Option<Elastic> {
        let has = |k: &str| b.has(k);
        let lame = has("lambda") || has("mu");
        if lame && (has("young") || has("poisson")) {
            let key = if has("lambda") { "lambda" } else { "mu" };
            let message = format!("{} gives constants of both pairs", b.what);
            self.fault("E015", b.key_at(key), message, "give young and poisson, or lambda and mu");
            return None;
        }
        let (first, second, values) = if lame { ("lambda", "mu", (1.0, 1.0)) } else { ("young", "poisson", (1.0, 0.3)) };
        let take = |r: &mut Self, key: &str, value: f64| {
            let example = format!("{key} = {value:?} (give young and poisson, or lambda and mu)");
            let node = r.required(b, key, &example)?;
            r.formula_of(&node, key, Uses::Space)
        };
        let (p, q) = (take(self, first, values.0), take(self, second, values.1));
        let (p, q) = (p?, q?);
        if lame {
            self.limit(&q, "mu", "positive", |v| v > 0.0, "");
            if let (Some(l), Some(m)) = (p.as_constant(), q.as_constant())
                && m > 0.0
                && 3.0 * l + 2.0 * m <= 0.0
            {
                self.fault("E053", p.at, format!("3 lambda + 2 mu must be positive, found {:?}", 3.0 * l + 2.0 * m), "");
            }
            return Some(Elastic::Lame(p, q));
        }
        self.limit(&p, "young", "positive", |v| v > 0.0, "");
        let stress = model.assumption.value == Assumption::PlaneStress;
        let what = if stress { "plane stress" } else { "plane strain" };
        if stress {
            self.limit(&q, "poisson", "between -1 and 0.5", |v| v > -1.0 && v <= 0.5, "");
        } else if q.as_constant() == Some(0.5) {
            self.fault("E053", q.at, format!("poisson = 0.5 makes {what} singular"), "write a value below 0.5, such as 0.499");
        } else {
            self.limit(&q, "poisson", "between -1 and 0.5", |v| v > -1.0 && v < 0.5, "");
        }
        Some(Elastic::YoungPoisson(p, q))
    }

    // formulas of x are checked where they are evaluated
    fn limit(&mut self, f: &Located<Formula>, what: &str, allowed: &str, good: impl Fn(f64) -> bool, help: &str) {
        if let Some(v) = f.as_constant()
            && !good(v)
        {
            self.fault("E053", f.at, format!("`{what}` must be {allowed}, found {v:?}"), help);
        }
    }

    /// `[steps]`.
    pub fn steps(&mut self, b: Option<&mut Block>) -> Located<Vec<f64>> {
        let Some(b) = b else { return Located::new(vec![1.0], Place::NONE) };
        let at = b.at;
        match (b.node("t").cloned(), b.node("count").cloned()) {
            (Some(_), Some(count)) => self.fault("E015", count.at, "`count` does not stand beside `t`", "leave one of them out"),
            (None, None) => self.missing(b, "t", "t = [0.5, 1.0], or count = 2"),
            (None, Some(count)) => {
                if let Some(n) = self.whole_of(&count, "count", 1, 100_000) {
                    return Located::new((1..=n).map(|k| k as f64 / n as f64).collect(), at);
                }
            }
            (Some(t), None) => {
                if let Some(times) = self.numbers_of(&t, "t") {
                    if let Some(w) = times.windows(2).find(|w| w[0].value >= w[1].value) {
                        self.fault("E015", w[1].at, "the times of `t` must increase", "");
                    } else if times.is_empty() {
                        self.wrong_type(&t, "t", "a list of times", "");
                    } else {
                        return Located::new(times.iter().map(|v| v.value).collect(), at);
                    }
                }
            }
        }
        Located::new(vec![1.0], at)
    }

    /// `[solver]`.
    pub fn solver(&mut self, b: &mut Block, names: &Names) -> Solver {
        let constraint = self.registered(b, "constraint", &names.constraints, "auto");
        let linear = self.word(b, "linear", &[("auto", Linear::Auto), ("direct", Linear::Direct), ("iterative", Linear::Iterative)]);
        if linear.value != Linear::Iterative && FACTORISING.contains(&constraint.value.as_str()) {
            for key in ["tolerance", "max_iterations"].iter().filter(|k| b.has(k)) {
                let help = "leave it out, or take constraint = \"schur\" or \"uzawa\", which iterate";
                self.fault("E015", b.key_at(key), format!("`{key}` is a key of linear = \"iterative\""), help);
            }
        }
        let tolerance = self.number(b, "tolerance", Sign::Positive).unwrap_or(Located::new(1e-10, b.at));
        let max_iterations = b
            .node("max_iterations")
            .cloned()
            .and_then(|n| self.whole_of(&n, "max_iterations", 1, 10_000_000).map(|v| Located::new(v, n.at)));
        if tolerance.value >= 1.0 {
            let message = format!("`tolerance` of the solver is relative and must be below 1, found {}", tolerance.value);
            self.fault("E015", tolerance.at, message, "write for example tolerance = 1e-10");
        }
        Solver { constraint, linear, tolerance, max_iterations }
    }
}

/// Constraint solvers that do not iterate with `linear = "direct"`.
const FACTORISING: &[&str] = &["auto", "saddle-point", "condensed"];

fn inherit<T: Clone>(defaults: Option<&Discretization>, field: impl Fn(&Discretization) -> &T) -> T {
    field(defaults.expect("a key without defaults is read from the block")).clone()
}
