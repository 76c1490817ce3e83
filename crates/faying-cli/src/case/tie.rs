//! Reads `[[interface]]` and `[[contact]]`.

use super::keys;
use super::names::Names;
use super::reader::{Block, Reader, Sign, Uses};
use super::tree::{Node, Table, Value};
use super::types::*;
use crate::errors::{Diagnostic, nearest};
use crate::formula::{Constants, Formula, Scope};
use crate::place::Located;

const NO_MULTIPLIER: &str = "this method has no multiplier";

// k of the multiplier p/p-k
fn lowered_by(name: &str) -> Option<usize> {
    name.strip_prefix("p/p-")?.parse().ok()
}

impl Reader {
    /// One `[[interface]]`.
    pub fn interface(&mut self, b: &mut Block, index: usize, model: &Model, patches: &[Patch], names: &Names) -> Tie {
        let name = self.name(b, "interface", index, false);
        let between = b.node("between").cloned().and_then(|node| self.between(&node, patches));
        let mut side = |key: &str, example: &str| {
            if b.has("between") {
                if b.has(key) {
                    self.fault("E015", b.key_at(key), format!("`{key}` does not stand beside `between`"), "");
                }
                return Vec::new();
            }
            self.required(b, key, example).map_or(Vec::new(), |node| self.sides(&node, key, patches))
        };
        let (slave, master) = (side("slave", "slave = \"upper.v0\""), side("master", "master = \"lower.v1\""));
        let coupling = self.registered(b, "coupling", &names.couplings, "mortar");
        // glued sides share their unknowns: there is no multiplier and nothing to integrate
        let glue = coupling.value == "glue";
        for key in ["multiplier", "integration", "extra_points", "exact"].into_iter().filter(|key| glue && b.has(key)) {
            let message = format!("`{key}` is not a key of coupling = \"glue\"");
            self.fault("E015", b.key_at(key), message, "glued sides share their unknowns: there is no multiplier");
        }
        let none = || Located::new(Multiplier::Named("auto".to_owned()), b.at);
        if !glue && !names.has_rows(&coupling.value) {
            let kind = format!("coupling = {:?}", coupling.value);
            self.only_default(b, "multiplier", "auto", &kind, "this coupling has no multiplier");
        }
        let multiplier = if glue { none() } else { self.multiplier(b, names) };
        let integration = if glue { Located::new("merged".to_owned(), b.at) } else { self.integration(b, names) };
        let extra_points = if glue { Located::new(0, b.at) } else { self.whole(b, "extra_points", 0, 60, 0) };
        let tolerance = self.auto(b, "tolerance");
        let given = self.entry(b, "coupling", &coupling.value, &names.coupling_keys);
        let exact = b.node("exact").cloned().map(|node| self.field_of(&node, "exact", Uses::Space, model.components()));
        Tie {
            head: b.head(),
            name,
            slave,
            master,
            between,
            coupling,
            multiplier,
            integration,
            extra_points,
            tolerance,
            given: given.unwrap_or_default(),
            exact,
        }
    }

    /// `integration`.
    fn integration(&mut self, b: &mut Block, names: &Names) -> Located<String> {
        let word = self.registered(b, "integration", &names.integrations, "merged");
        // another name
        if word.value == "segments" { Located::new("merged".to_owned(), word.at) } else { word }
    }

    /// One `[[contact]]`.
    pub fn contact(&mut self, b: &mut Block, index: usize, model: &Model, patches: &[Patch], names: &Names) -> Contact {
        let name = self.name(b, "contact", index, false);
        if model.physics.value == Physics::Poisson {
            self.fault("E015", b.at, "[[contact]] needs physics = \"elasticity\", the physics here is poisson", "");
        }
        let slave = self.required(b, "slave", "slave = \"upper.v0\"").map_or(Vec::new(), |node| self.sides(&node, "slave", patches));
        let master = self.master(b, patches);
        let gap = match b.node("gap").cloned() {
            Some(node) => self.formula_of(&node, "gap", Uses::Gap),
            None => {
                let at = b.default("gap", Value::Text("g".to_owned()));
                let f = Formula::parse("g", &Scope::gap(&Constants::default())).expect("g is a gap formula");
                Some(Located::new(f, at))
            }
        };
        let gap = gap.unwrap_or_else(|| Located::new(Formula::constant(0.0), b.at));
        let methods: Vec<String> = names.methods.iter().map(|m| m.entry.name.clone()).collect();
        let method = self.registered(b, "method", &methods, "lagrange");
        let needs = names.needs(&method.value);
        let kind = format!("method = {:?}", method.value);
        if !needs.multiplier {
            self.only_default(b, "multiplier", "auto", &kind, NO_MULTIPLIER);
            self.only_default(b, "cone", "coefficients", &kind, NO_MULTIPLIER);
        }
        if !needs.mixed && b.node("integration").is_some_and(|node| matches!(&node.value, Value::Text(word) if word == "mixed")) {
            let message = format!("mixed integration has no meaning for {kind}: it has no multiplier");
            self.fault("E015", b.key_at("integration"), message, "write integration = \"merged\" or \"slave\"");
        }
        let multiplier = self.multiplier(b, names);
        let integration = self.integration(b, names);
        let extra_points = self.whole(b, "extra_points", 0, 60, 0);
        let cone = self.word(b, "cone", &[("coefficients", Cone::Coefficients), ("weights", Cone::Weights), ("values", Cone::Values)]);
        let reach = self.auto(b, "reach");
        let given = self.entry(b, "method", &method.value, &names.method_keys());
        let exact = self.formula(b, "exact", Uses::Space);
        let symmetry = self.flag(b, "symmetry", false);
        let active_set = self.active_set(b);
        Contact {
            head: b.head(),
            name,
            slave,
            master,
            gap,
            method,
            needs,
            given: given.unwrap_or_default(),
            multiplier,
            integration,
            extra_points,
            cone,
            reach,
            exact,
            symmetry,
            active_set,
        }
    }

    // a key without effect for `kind` is accepted with its default value alone
    fn only_default(&mut self, b: &Block, key: &str, default: &str, kind: &str, why: &str) {
        if b.node(key).is_some_and(|node| !matches!(&node.value, Value::Text(word) if word == default)) {
            let message = format!("`{key}` is not a key of {kind}");
            self.fault("E015", b.key_at(key), message, format!("{why}; leave it out or write {default:?}"));
        }
    }

    fn between(&mut self, node: &Node, patches: &[Patch]) -> Option<Located<Vec<String>>> {
        let names = match &node.value {
            Value::Text(s) if s == "all" => vec![s.clone()],
            Value::List(list) => {
                let mut out = Vec::new();
                for item in list {
                    let name = self.text_of(item, "between")?;
                    if !patches.iter().any(|p| p.name == name) && !self.broken.contains("patch") {
                        let list = patches.iter().map(|p| p.name.as_str()).collect::<Vec<_>>().join(", ");
                        self.fault("E021", item.at, format!("there is no patch {:?}", name.value), format!("patches are {list}"));
                    }
                    out.push(name.value);
                }
                out
            }
            _ => {
                self.wrong_type(node, "between", "\"all\" or a list of patches", "");
                return None;
            }
        };
        Some(Located::new(names, node.at))
    }

    fn multiplier(&mut self, b: &mut Block, names: &Names) -> Located<Multiplier> {
        let auto = Multiplier::Named("auto".to_owned());
        let Some(node) = b.node("multiplier").cloned() else {
            return Located::new(auto, b.default("multiplier", Value::Text("auto".to_owned())));
        };
        let value = match &node.value {
            Value::Text(name) => {
                let lowered = lowered_by(name).is_some_and(|k| (1..=12).contains(&k));
                if names.multipliers.contains(name) || lowered {
                    Multiplier::Named(name.clone())
                } else {
                    let shown: String = name.chars().take(60).collect();
                    let mut d = Diagnostic::error("E064", format!("there is no multiplier {shown:?}"));
                    if let Some(near) = nearest(&shown, names.multipliers.iter().map(String::as_str)) {
                        d = d.with_label(format!("did you mean {near:?}?"));
                    }
                    // one entry for the whole family p/p-4, p/p-6, ...
                    let mut list: Vec<&str> =
                        names.multipliers.iter().map(String::as_str).filter(|n| lowered_by(n).is_none_or(|k| k <= 2)).collect();
                    let family = list.iter().position(|n| *n == "p/p-2").map_or(list.len(), |k| k + 1);
                    list.insert(family, "p/p-2k");
                    let help = format!("known: {}, or {{ degree = 1, continuity = 0, ends = \"auto\" }}", list.join(", "));
                    self.push(node.at, d.with_help(help));
                    auto
                }
            }
            Value::Table(_) => match self.multiplier_data(&node) {
                Some((data, table)) => {
                    b.replace("multiplier", table);
                    data
                }
                None => auto,
            },
            _ => {
                self.wrong_type(&node, "multiplier", "a name such as \"p/p-2\" or a table", "write multiplier = \"auto\"");
                auto
            }
        };
        Located::new(value, node.at)
    }

    fn multiplier_data(&mut self, node: &Node) -> Option<(Multiplier, Table)> {
        let mut b = self.block(node, "`multiplier`", keys::MULTIPLIER)?;
        let degree = self.required(&b, "degree", "degree = 1");
        let degree = degree.and_then(|n| self.whole_of(&n, "degree", 0, 12));
        let continuity = match b.node("continuity").cloned() {
            None => None,
            Some(n) => match n.value {
                Value::Integer(k) if (-1..=11).contains(&k) => {
                    if let Some(p) = degree.filter(|p| k >= *p as i64) {
                        let message = format!("`continuity` must be less than the degree {p}, found {k}");
                        self.fault("E015", n.at, message, "-1 is discontinuous");
                    }
                    Some(k as isize)
                }
                _ => {
                    self.wrong_type(&n, "continuity", "a whole number from -1 to degree - 1", "-1 is discontinuous");
                    None
                }
            },
        };
        let ends = self.word(&mut b, "ends", &[("auto", Ends::Auto), ("full", Ends::Full), ("lowered", Ends::Lowered)]);
        Some((Multiplier::Data { degree: degree?, continuity, ends: ends.value }, b.finish()))
    }

    fn active_set(&mut self, b: &mut Block) -> ActiveSetSpec {
        let node = match b.node("active_set").cloned() {
            Some(node) if matches!(node.value, Value::Table(_)) => node,
            other => {
                if let Some(node) = other {
                    self.wrong_type(&node, "active_set", "a table", "write active_set = { max_iterations = 100 }");
                }
                let at = b.default("active_set", Value::Table(Table::default()));
                Node::new(Value::Table(Table::default()), at)
            }
        };
        let mut inner = self.block(&node, "`active_set`", keys::ACTIVE_SET).expect("the value was just found to be a table");
        let start = match inner.node("start").cloned() {
            Some(n) if matches!(n.value, Value::Table(_)) => {
                let seed = self.block(&n, "`start`", &["seed"]).and_then(|s| {
                    let seed = self.required(&s, "seed", "start = { seed = 7 }")?;
                    self.whole_of(&seed, "seed", 0, i64::MAX)
                });
                Located::new(seed.map_or(Start::Auto, |k| Start::Seed(k as u64)), n.at)
            }
            _ => self.word(&mut inner, "start", &[("auto", Start::Auto), ("all", Start::All), ("none", Start::None), ("gap", Start::Gap)]),
        };
        let max_iterations = self.whole(&mut inner, "max_iterations", 1, 100_000, 100);
        let c = match self.number(&inner, "c", Sign::Positive) {
            Some(c) => c,
            None if inner.has("c") => Located::new(1.0, inner.at),
            None => Located::new(1.0, inner.default("c", Value::Float(1.0))),
        };
        b.replace("active_set", inner.finish());
        ActiveSetSpec { start, max_iterations, c }
    }

    fn master(&mut self, b: &mut Block, patches: &[Patch]) -> Master {
        match (b.node("master").cloned(), b.node("rigid").cloned()) {
            (Some(_), Some(rigid)) => {
                self.fault("E015", rigid.at, "`rigid` does not stand beside `master`", "leave one of them out");
                Master::Sides(Vec::new())
            }
            (Some(master), None) => Master::Sides(self.sides(&master, "master", patches)),
            (None, Some(rigid)) => match self.obstacle(&rigid) {
                Some((obstacle, table)) => {
                    b.replace("rigid", table);
                    Master::Rigid(Located::new(obstacle, rigid.at))
                }
                None => Master::Sides(Vec::new()),
            },
            (None, None) => {
                let message = format!("`master` or `rigid` is missing in {}", b.what);
                let help = "write master = \"lower.v1\", or rigid = { kind = \"half-plane\", point = [0, 0], normal = [0, 1] }";
                self.fault("E013", b.at, message, help);
                Master::Sides(Vec::new())
            }
        }
    }
}
