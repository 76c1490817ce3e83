//! Reads `[[interface]]` and `[[contact]]`.

use super::reader::{Block, Reader, Uses};
use super::rows;
use super::tree::{Node, Table, Value};
use super::types::*;
use crate::errors::{Diagnostic, nearest};
use crate::formula::{Formula, Variable};
use crate::place::Located;

// k of the multiplier p/p-k
fn lowered_by(name: &str) -> Option<usize> {
    name.strip_prefix("p/p-")?.parse().ok()
}

impl Reader {
    /// One `[[interface]]`.
    pub fn interface(&mut self, b: &mut Block, index: usize, model: &Model, patches: &[Patch]) -> Tie {
        let name = self.name(b, "interface", index);
        let between = b.node("between").cloned().and_then(|node| self.between(&node, patches));
        let mut side = |key: &str| {
            if b.has("between") {
                if b.has(key) {
                    self.fault("E015", b.key_at(key), format!("`{key}` does not stand beside `between`"), "");
                }
                return Vec::new();
            }
            self.required(b, key).map_or(Vec::new(), |node| self.sides(&node, key, patches))
        };
        let (slave, master) = (side("slave"), side("master"));
        if b.has("between") && b.has("where") {
            self.fault("E015", b.key_at("where"), "`where` does not stand beside `between`", "name slave and master");
        }
        let filter = self.filter(b);
        let coupling = self.entry_name(b, "coupling");
        let multiplier = self.multiplier(b);
        let integration = self.integration(b);
        let extra_points = self.whole(b, "extra_points");
        let tolerance = self.auto(b, "tolerance");
        let given = self.entry(b, "coupling", &coupling.value, &self.known.coupling_keys.clone());
        let exact = b.node("exact").cloned().map(|node| self.field_of(&node, "exact", Uses::Space, model.components()));
        Tie {
            head: b.head(),
            name,
            slave,
            filter,
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
    fn integration(&mut self, b: &mut Block) -> Located<String> {
        let word = self.entry_name(b, "integration");
        // another name
        if word.value == "segments" { Located::new("merged".to_owned(), word.at) } else { word }
    }

    /// One `[[contact]]`.
    pub fn contact(&mut self, b: &mut Block, index: usize, model: &Model, patches: &[Patch]) -> Contact {
        let name = self.name(b, "contact", index);
        if model.physics.value == Physics::Poisson {
            self.fault("E015", b.at, "[[contact]] needs physics = \"elasticity\", the physics here is poisson", "");
        }
        let slave = self.required(b, "slave").map_or(Vec::new(), |node| self.sides(&node, "slave", patches));
        let filter = self.filter(b);
        let master = self.master(b, patches);
        let node = self.value_of(b, "gap");
        let gap = self.formula_of(&node, "gap", Uses::Gap).unwrap_or_else(|| Located::new(Formula::constant(0.0), b.at));
        let plain = matches!(&node.value, Value::Text(text) if text.trim() == "g");
        if self.constants.get("g").is_some() && gap.value.uses(Variable::G) && !plain {
            let message = "`g` is the geometric gap here, and a constant of [let]";
            self.fault("E016", gap.at, message, "give the constant another name");
        }
        let method = self.entry_name(b, "method");
        let needs = self.known.needs(&method.value);
        if !needs.mixed && b.node("integration").is_some_and(|node| matches!(&node.value, Value::Text(word) if word == "mixed")) {
            let message = format!("mixed integration has no meaning for method = {:?}: it has no multiplier", method.value);
            self.fault("E015", b.key_at("integration"), message, "write integration = \"merged\" or \"slave\"");
        }
        let multiplier = self.multiplier(b);
        let integration = self.integration(b);
        let extra_points = self.whole(b, "extra_points");
        let cone = self.word(b, "cone", &[Cone::Coefficients, Cone::Weights, Cone::Values]);
        let reach = self.auto(b, "reach");
        let given = self.entry(b, "method", &method.value, &self.known.method_keys());
        let exact = self.formula(b, "exact", Uses::Space);
        let symmetry = self.flag(b, "symmetry");
        let adjust = self.flag(b, "adjust");
        if let (true, Master::Rigid(obstacle)) = (adjust.value, &master)
            && obstacle.value.translate.iter().chain(&obstacle.value.force).any(Option::is_some)
        {
            let message = "`adjust` closes gaps at rest, and the obstacle moves: its motion would be closed, too";
            self.fault("E015", adjust.at, message, "leave `adjust` or the motion of the obstacle out");
        }
        let active_set = self.active_set(b);
        Contact {
            head: b.head(),
            name,
            slave,
            filter,
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
            adjust,
            active_set,
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

    fn multiplier(&mut self, b: &mut Block) -> Located<Multiplier> {
        let auto = Multiplier::Named("auto".to_owned());
        let node = self.value_of(b, "multiplier");
        let known = self.known.multipliers.clone();
        let value = match &node.value {
            Value::Text(name) => {
                let lowered = lowered_by(name).is_some_and(|k| (1..=12).contains(&k));
                if known.contains(name) || lowered {
                    Multiplier::Named(name.clone())
                } else {
                    let shown: String = name.chars().take(60).collect();
                    let mut d = Diagnostic::error("E064", format!("there is no multiplier {shown:?}"));
                    if let Some(near) = nearest(&shown, known.iter().map(String::as_str)) {
                        d = d.with_label(format!("did you mean {near:?}?"));
                    }
                    // one entry for the whole family p/p-4, p/p-6, ...
                    let mut list: Vec<&str> = known.iter().map(String::as_str).filter(|n| lowered_by(n).is_none_or(|k| k <= 2)).collect();
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
        let mut b = self.block(node, "`multiplier`", rows::MULTIPLIER)?;
        let degree = self.required_whole(&b, "degree").map(|p| p.value);
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
        let ends = self.word(&mut b, "ends", &[Ends::Auto, Ends::Full, Ends::Lowered]);
        Some((Multiplier::Data { degree: degree?, continuity, ends: ends.value }, b.finish()))
    }

    fn active_set(&mut self, b: &mut Block) -> ActiveSetSpec {
        let mut node = self.value_of(b, "active_set");
        if !matches!(node.value, Value::Table(_)) {
            self.wrong_type(&node, "active_set", "a table", "write active_set = { max_iterations = 100 }");
            node.value = Value::Table(Table::default());
        }
        let mut inner = self.block(&node, "`active_set`", rows::ACTIVE_SET).expect("the value is a table");
        let start = self.value_of(&mut inner, "start");
        let value = match &start.value {
            Value::Table(_) => {
                let seed = self.block(&start, "`start`", rows::SEED).and_then(|s| self.required_whole(&s, "seed"));
                seed.map(|k| Start::Seed(k.value as u64))
            }
            _ => self.word_of(&start, "start", &[("auto", Start::Auto), ("all", Start::All), ("none", Start::None), ("gap", Start::Gap)]),
        };
        let start = Located::new(value.unwrap_or(Start::Auto), start.at);
        let max_iterations = self.whole(&mut inner, "max_iterations");
        let c = self.number_or_default(&mut inner, "c");
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
