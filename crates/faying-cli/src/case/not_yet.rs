//! Features of the case file's language that this version does not implement: E019 at their place.
//!
//! Every entry is already typed; to implement one, delete its line here.

use super::reader::Reader;
use super::tree::{Node, Table, Value};
use super::types::*;
use crate::formula::{Formula, Scope};
use crate::place::Place;

/// Accepted values of a key that is not implemented: those that state what this version does anyway.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Plain {
    /// No value.
    Never,
    /// Zero: a number, a formula of constants, or a list or table of them.
    Zero,
    /// The accepted words, and the other words of the language.
    Words(&'static [&'static str], &'static [&'static str]),
}

/// Keys of the language that are not implemented: (block, key, accepted values, help).
///
/// A block is "" for the top level, else its name. An accepted value stays in the effective case.
pub(super) const LATER_KEYS: &[(&str, &str, Plain, &str)] = &[
    ("", "units", Plain::Never, "numbers are in any one consistent system of units; say which in `title`"),
    ("", "output", Plain::Never, "fields.vtu holds all fields, for pictures of another program"),
    ("", "line", Plain::Never, "write a [[probe]] for every point of the line"),
    ("model", "kinematics", Plain::Words(&["small"], &["finite"]), "displacements and rotations are small here"),
    ("model", "reaction", Plain::Zero, "leave it out, or write 0"),
    ("model", "foundation", Plain::Zero, "a `spring` of [[boundary]] acts on sides"),
    ("material", "law", Plain::Words(&["hooke"], &["neo-hooke", "saint-venant-kirchhoff", "mooney-rivlin"]), "write law = \"hooke\""),
    ("material", "volumetric", Plain::Never, "it belongs to laws of finite kinematics"),
    ("material", "c1", Plain::Never, "it belongs to laws of finite kinematics"),
    ("material", "c2", Plain::Never, "it belongs to laws of finite kinematics"),
    ("material", "bulk", Plain::Never, "it belongs to laws of finite kinematics; here young and poisson, or lambda and mu"),
    ("patch", "exact", Plain::Never, "write exact in [model], for all patches; if(c, a, b) makes it piecewise"),
    ("patch", "reaction", Plain::Zero, "leave it out, or write 0"),
    ("patch", "foundation", Plain::Zero, "a `spring` of [[boundary]] acts on sides"),
    ("contact", "friction", Plain::Zero, "contact is frictionless here: leave it out, or write 0"),
    ("steps", "smallest", Plain::Never, "steps of linear elasticity are never halved: leave it out"),
    ("solver", "newton", Plain::Never, "small kinematics needs no Newton iteration: leave it out"),
    (
        "solver",
        "preconditioner",
        Plain::Words(&["auto"], &["fast-diagonal", "multigrid", "aggregation", "gauss-seidel"]),
        "write preconditioner = \"auto\"",
    ),
    ("solver", "operator", Plain::Words(&["auto", "matrix"], &["matrix-free"]), "write operator = \"matrix\""),
    ("solver", "precision", Plain::Words(&["double"], &["mixed"]), "everything is in double precision here: leave it out"),
];

/// The keys of a block that are not implemented.
pub(super) fn later_of(block: &str) -> impl Iterator<Item = &'static (&'static str, &'static str, Plain, &'static str)> {
    LATER_KEYS.iter().filter(move |(of, ..)| *of == block)
}

/// Couplings that integrate over the surfaces of both sides.
const SURFACE_COUPLINGS: &[&str] = &["mortar", "nitsche", "penalty"];

impl Reader {
    fn later(&mut self, at: Place, what: &str, help: &str) {
        self.fault("E019", at, format!("{what} is not in this version"), help);
    }

    /// Splits the given keys of a block that are not implemented: those with accepted values, which stay, and the others, each E019.
    ///
    /// `what` names the block as messages do: `[model]`, `contact`, `patch 0`.
    pub(super) fn later_keys(&mut self, table: &Table, what: &str) -> (Vec<&'static str>, Vec<&'static str>) {
        let block = what.trim_matches(['[', ']', '`']).split(' ').next().unwrap_or_default();
        // keys of a law of the registry
        let own: Vec<&str> = match block {
            "material" => self.known.laws.iter().flat_map(|e| &e.keys).map(|k| k.name).collect(),
            _ => Vec::new(),
        };
        let given = later_of(block).filter_map(|later| Some((later, table.get(later.1)?.clone())));
        let given = given.filter(|(later, _)| !own.contains(&later.1));
        let laws: Vec<String> = self.known.laws.iter().map(|e| e.name.clone()).collect();
        let (mut plain, mut refused) = (Vec::new(), Vec::new());
        for (&(_, key, allowed, help), entry) in given.collect::<Vec<_>>() {
            let fault = match allowed {
                Plain::Never => Some((entry.key_at, format!("`{key}`"))),
                Plain::Zero => (!self.is_zero(&entry.node)).then(|| (entry.key_at, format!("`{key}`"))),
                Plain::Words(plain, others) => {
                    let laws = laws.iter().filter(|_| (block, key) == ("material", "law"));
                    let built = plain.iter().copied().chain(laws.map(String::as_str)).map(|w| (w, None));
                    let words: Vec<(&str, Option<&str>)> = built.chain(others.iter().map(|w| (*w, Some(*w)))).collect();
                    self.word_of(&entry.node, key, &words).flatten().map(|word| (entry.node.at, format!("{key} = {word:?}")))
                }
            };
            match fault {
                None => plain.push(key),
                Some((at, what)) => {
                    self.later(at, &what, help);
                    refused.push(key);
                }
            }
        }
        (plain, refused)
    }

    fn is_zero(&self, node: &Node) -> bool {
        match &node.value {
            Value::Integer(n) => *n == 0,
            Value::Float(v) => *v == 0.0,
            Value::Text(text) => Formula::parse(text, &Scope::number(&self.constants)).is_ok_and(|f| f.as_constant() == Some(0.0)),
            Value::List(items) => items.iter().all(|item| self.is_zero(item)),
            Value::Table(table) => table.entries.iter().all(|e| self.is_zero(&e.node)),
            _ => false,
        }
    }

    /// Reports all features of the case that are not implemented.
    pub fn not_in_this_version(&mut self, case: &Case) {
        let m = &case.model;
        if m.dimension.value == 3 {
            self.later_surfaces(case);
        }
        for c in &case.contacts {
            self.later_contact(c);
        }
    }

    fn later_surfaces(&mut self, case: &Case) {
        let ties = case.interfaces.iter().filter(|t| SURFACE_COUPLINGS.contains(&t.coupling.value.as_str()));
        for at in ties.map(|t| t.head.at).collect::<Vec<Place>>() {
            let help = "share the unknowns of sides that match by coupling = \"glue\", or take a plane model";
            self.fault("E019", at, "interfaces between surfaces are not in this version", help);
        }
        for c in &case.contacts {
            let help = "take a plane model of the cross-section: contact between lines is there";
            self.fault("E019", c.head.at, "contact between surfaces is not in this version", help);
        }
    }

    fn later_contact(&mut self, c: &Contact) {
        if let (Master::Rigid(o), false) = (&c.master, c.needs.pressed)
            && let Some(f) = o.force.iter().flatten().next()
        {
            self.later(
                f.at,
                &format!("`force` of an obstacle with method = {:?}", c.method.value),
                "write method = \"lagrange\", or use move",
            );
        }
    }
}
