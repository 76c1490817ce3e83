//! Reads `[let]`, `[model]`, `[discretization]`, `[[material]]`, `[steps]` and `[solver]`.

use super::reader::{Block, Reader, Sign, Uses};
use super::rows;
use super::tree::{Node, Table, Value};
use super::types::*;
use crate::formula::{ConstantText, Constants, Formula, is_free_name};
use crate::place::{Located, SourceSpan};

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
        // constants with an error get a value, so that formulas that use them are not reported again
        let reported = ConstantText::Number(1.0);
        for e in &table.entries {
            if !is_free_name(&e.key) {
                let help = "names in formulas are letters, digits and `_`, begin with a letter, and are none of x, y, z, t, r, theta, pi, e, nor a function";
                self.fault("E016", e.key_at, format!("`{}` cannot be the name of a constant", e.key), help);
                continue;
            }
            known.push(e.key.clone());
            let text = match &e.node.value {
                Value::Text(s) => ConstantText::Formula(s.clone()),
                Value::Integer(_) | Value::Float(_) => match self.number_of(&e.node, &e.key, Sign::Any) {
                    Some(v) => ConstantText::Number(v),
                    None => reported.clone(),
                },
                _ => {
                    self.wrong_type(&e.node, &e.key, "a number or a quoted formula", "write NAME = 2.5 or NAME = \"sqrt(F)\"");
                    reported.clone()
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
        for name in &known {
            if self.constants.get(name).is_none() {
                self.constants.insert(name, 1.0);
            }
        }
    }

    /// `[model]`.
    pub fn model(&mut self, b: &mut Block) -> Model {
        let physics = self.required_word(b, "physics", &[Physics::Poisson, Physics::Elasticity]);
        let physics = physics.unwrap_or(Located::new(Physics::Elasticity, b.at));
        let dimension = self.required_whole(b, "dimension").unwrap_or(Located::new(2, b.at));
        self.dimension = dimension.value;
        let poisson = physics.value == Physics::Poisson;
        let n = if poisson { 1 } else { dimension.value };
        self.components = n;
        let assumption = if dimension.value == 3 {
            Located::new(Assumption::Solid, SourceSpan::NONE)
        } else {
            self.word(b, "assumption", &[Assumption::PlaneStrain, Assumption::PlaneStress, Assumption::Axisymmetric])
        };
        let exact = self.exact(b, n);
        let source = self.source(b, poisson, n);
        if let (Some(_), Some(s)) = (&exact, &source) {
            self.fault(
                "E015",
                s.at,
                "a body force or source does not stand beside `exact`".to_owned(),
                "it follows from `exact`; leave one of them out",
            );
        }
        let gravity = self.gravity(b);
        let foundation = self.foundation(b, poisson, n, exact.is_some());
        let reference = b.node("reference").cloned().and_then(|node| self.text_of(&node, "reference"));
        let stored = reference.as_ref().and_then(|file| self.open_reference(file));
        self.absolute(b, "reference");
        Model { head: b.head(), physics, dimension, assumption, exact, source, gravity, foundation, reference, stored }
    }

    /// `exact`: a manufactured solution of `n` components.
    pub fn exact(&mut self, b: &Block, n: usize) -> Option<Located<Vec<Located<Formula>>>> {
        let exact = b.node("exact").cloned().and_then(|node| {
            let inner = self.block(&node, "`exact`", rows::EXACT)?;
            let u = self.required(&inner, "u")?;
            Some(self.field_of(&u, "exact.u", Uses::Space, n))
        });
        if b.has("exact") && exact.is_none() {
            self.broken.insert("exact".to_owned());
        }
        exact
    }

    /// `gravity` (elasticity).
    pub fn gravity(&mut self, b: &Block) -> Option<Located<Vec<f64>>> {
        b.node("gravity").cloned().and_then(|node| self.vector_of(&node, "gravity", true))
    }

    /// `reaction` (Poisson) or `foundation` (elasticity), per component.
    pub fn foundation(&mut self, b: &Block, poisson: bool, n: usize, beside_exact: bool) -> Components<Formula> {
        let key = if poisson { "reaction" } else { "foundation" };
        let Some(node) = b.node(key).cloned() else { return (0..n).map(|_| None).collect() };
        let all = match &node.value {
            Value::Table(t) if t.entries.is_empty() => {
                let example = if poisson { "1.0" } else { "{ y = 1e3 }" };
                self.wrong_type(&node, key, "a table of some components", format!("write {key} = {example}"));
                return (0..n).map(|_| None).collect();
            }
            _ => self.formulas_of(&node, key, Uses::Space, n),
        };
        if beside_exact {
            let message = format!("`{key}` does not stand beside `exact`");
            self.fault("E015", node.at, message, "the source of `exact` is that of the equation without it; leave one of them out");
        }
        // negative stiffness is unstable; the sign of formulas is not known here
        for k in all.iter().flatten() {
            if let Some(value) = k.value.as_constant().filter(|v| *v < 0.0) {
                let message = format!("`{key}` must not be negative, found {value:?}");
                self.fault("E015", k.at, message, "it pulls back with the force stiffness times displacement: write it positive");
            }
        }
        all
    }

    /// `source` (Poisson) or `body_force` (elasticity).
    pub fn source(&mut self, b: &Block, poisson: bool, n: usize) -> Option<Located<Vec<Located<Formula>>>> {
        let key = if poisson { "source" } else { "body_force" };
        let node = b.node(key).cloned()?;
        Some(self.field_of(&node, key, Uses::Space, n))
    }

    /// `[discretization]`, or the keys of a patch over these defaults.
    pub fn discretization(&mut self, b: &mut Block, defaults: Option<&Discretization>) -> Discretization {
        let own = |b: &Block, key: &str| defaults.is_none() || b.has(key);
        let backend = if own(b, "backend") { self.entry_name(b, "backend") } else { inherit(defaults, |d| &d.backend) };
        let degree = if own(b, "degree") { self.degrees(b) } else { inherit(defaults, |d| &d.degree) };
        let continuity = if own(b, "continuity") { self.continuity(b) } else { inherit(defaults, |d| &d.continuity) };
        let basis = if own(b, "basis") { self.word(b, "basis", &BASES.map(|(_, basis)| basis)) } else { inherit(defaults, |d| &d.basis) };
        let cells = if own(b, "cells") { self.word(b, "cells", &CELLS.map(|(_, cell)| cell)) } else { inherit(defaults, |d| &d.cells) };
        let mapping = if own(b, "mapping") {
            self.word(b, "mapping", &MAPPINGS.map(|(_, mapping)| mapping))
        } else {
            inherit(defaults, |d| &d.mapping)
        };
        let extra_points = if own(b, "extra_points") { self.whole(b, "extra_points") } else { inherit(defaults, |d| &d.extra_points) };
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

    fn degrees(&mut self, b: &mut Block) -> Located<Vec<usize>> {
        let n = self.dimension;
        let node = self.value_of(b, "degree");
        let degree = match &node.value {
            Value::List(list) if list.len() == n => list.iter().map(|item| self.whole_of(item, "degree", 1, 12).unwrap_or(2)).collect(),
            Value::List(list) => {
                let message = format!("`degree` must be one number or a list of {n}, found a list of {}", list.len());
                self.fault("E044", node.at, message, format!("the model has dimension {n}"));
                vec![2; n]
            }
            _ => vec![self.whole_of(&node, "degree", 1, 12).unwrap_or(2); n],
        };
        Located::new(degree, node.at)
    }

    fn continuity(&mut self, b: &mut Block) -> Located<Option<usize>> {
        let node = self.value_of(b, "continuity");
        let continuity = match &node.value {
            Value::Text(s) if s == "max" => None,
            Value::Integer(_) => self.whole_of(&node, "continuity", 0, 11),
            _ => {
                self.wrong_type(&node, "continuity", "\"max\" or a whole number from 0 to degree - 1", "write continuity = \"max\"");
                None
            }
        };
        Located::new(continuity, node.at)
    }

    /// `[[material]]`; by default one without properties for Poisson.
    pub fn materials(&mut self, root: &mut Block, model: &Model) -> Vec<Material> {
        let known = self.known.extended(rows::MATERIAL);
        let mut materials = self.list(root, "material", &known, |r, b, k| r.material(b, k, model));
        if materials.is_empty() && model.physics.value == Physics::Poisson && !root.has("material") {
            let mut table = Table::default();
            table.set("name", SourceSpan::NONE, Node::new(Value::Text("default".to_owned()), SourceSpan::NONE));
            root.default("material", Value::List(vec![Node::new(Value::Table(table), SourceSpan::NONE)]));
            materials = self.list(root, "material", rows::MATERIAL, |r, b, k| r.material(b, k, model));
        }
        self.unique("material", &materials.iter().map(|m| m.name.clone()).collect::<Vec<_>>());
        materials
    }

    /// One `[[material]]`.
    pub fn material(&mut self, b: &mut Block, index: usize, model: &Model) -> Material {
        let name = self.name(b, "material", index);
        let poisson = model.physics.value == Physics::Poisson;
        let law = self.law(b);
        let density = self.formula(b, "density", Uses::Space);
        self.density_broken |= density.is_none() && b.has("density");
        let node = self.value_of(b, "conductivity");
        let conductivity = self.formula_of(&node, "conductivity", Uses::Space).unwrap_or(Located::new(Formula::constant(1.0), node.at));
        if poisson {
            self.limit(&conductivity, "conductivity", "positive", |v| v > 0.0, "");
        }
        if let Some(d) = &density {
            self.limit(d, "density", "0 or positive", |v| v >= 0.0, "");
        }
        let elastic = if poisson || law.is_some() { None } else { self.elastic(b, model) };
        Material { head: b.head(), name, law, elastic, conductivity, density }
    }

    /// The law of the registry that a material names; where a value cannot be read, it is without.
    fn law(&mut self, b: &mut Block) -> Option<Located<Law>> {
        const LATER: &[&str] = &["neo-hooke", "saint-venant-kirchhoff", "mooney-rivlin"];
        let named = b.node("law").cloned();
        let mut word = None;
        if let Some(node) = &named {
            match &node.value {
                Value::Text(text) if LATER.contains(&text.as_str()) && self.known.laws.iter().all(|law| law.name != *text) => {
                    self.fault("E019", node.at, format!("law = {text:?} is not in this version"), "write law = \"hooke\"");
                }
                _ => word = self.entry_name_of(b, node, "law"),
            }
        }
        let laws = self.known.laws.clone();
        let chosen = word.as_deref().unwrap_or("hooke");
        let given = self.entry(b, "law", chosen, &laws);
        let entry = laws.into_iter().find(|law| law.name == chosen)?;
        Some(Located::new(Law { name: entry.name, given: given.unwrap_or_default() }, named?.at))
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
            if !b.has(key) {
                let help = format!("write {key} = {value:?} (give young and poisson, or lambda and mu)");
                r.fault("E013", b.at, format!("`{key}` is missing in {}", b.what), help);
            }
            r.formula(b, key, Uses::Space)
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
        let what = match model.assumption.value {
            Assumption::PlaneStress => "plane stress",
            Assumption::Axisymmetric => "the stiffness of bodies of revolution",
            _ => "plane strain",
        };
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
        let Some(b) = b else { return Located::new(vec![1.0], SourceSpan::NONE) };
        let at = b.at;
        match (b.node("t").cloned(), b.node("count").cloned()) {
            (Some(_), Some(count)) => self.fault("E015", count.at, "`count` does not stand beside `t`", "leave one of them out"),
            (None, None) => self.fault("E013", at, format!("`t` is missing in {}", b.what), "write t = [0.5, 1.0], or count = 2"),
            (None, Some(_)) => {
                if let Some(n) = self.optional_whole(b, "count") {
                    return Located::new((1..=n.value).map(|k| k as f64 / n.value as f64).collect(), at);
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
    pub fn solver(&mut self, b: &mut Block) -> Solver {
        let constraint = self.entry_name(b, "constraint");
        let linear = self.word(b, "linear", &[Linear::Auto, Linear::Direct, Linear::Iterative]);
        let tolerance = self.number_or_default(b, "tolerance");
        let max_iterations = self.optional_whole(b, "max_iterations");
        if tolerance.value >= 1.0 {
            let message = format!("`tolerance` of the solver is relative and must be below 1, found {}", tolerance.value);
            self.fault("E015", tolerance.at, message, "write for example tolerance = 1e-10");
        }
        Solver { constraint, linear, tolerance, max_iterations }
    }
}

fn inherit<T: Clone>(defaults: Option<&Discretization>, field: impl Fn(&Discretization) -> &T) -> T {
    field(defaults.expect("a key without defaults is read from the block")).clone()
}
