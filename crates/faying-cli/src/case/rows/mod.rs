//! The grammar of case files: a row per key, block by block, in the order in which the effective case shows them.

mod bodies;
mod couples;
mod demand;
mod model;
mod obstacles;
mod sides;

pub(super) use bodies::{GRADE, PATCH, geometries};
pub(super) use couples::{ACTIVE_SET, CONTACT, INTERFACE, MULTIPLIER, SEED};
pub(super) use demand::{CHECK, PROBE, SOLVER, STEPS, STUDIES, STUDY};
pub(super) use model::{DISCRETIZATION, EXACT, MATERIAL, MODEL};
pub(super) use obstacles::{CURVE, obstacles};
pub(super) use sides::BOUNDARY;

use super::key::{Key, KeyKind, Plain, Special};
use super::names::Names;
use super::tree::{Table, Value};
use crate::place::{Located, Origin};

/// Top level.
pub(super) const ROOT: &[Key] = &[
    Key::of("schema", Special::Only("1", r#"{"const":1}"#), "version of the grammar of case files").default("1"),
    Key::new("title", KeyKind::Text, "heading of tables and pictures").default("\"\""),
    later("units", Plain::Never, "\"mm\"", "numbers are in any one consistent system of units; say which in `title`"),
    later("output", Plain::Never, "{}", "fields.vtu holds all fields, for pictures of another program"),
    Key::of("let", Special::Let, "constants for every formula").optional("{ F = 1e-4, a = \"sqrt(F)\" }"),
    Key::of("model", Special::Block(MODEL), "equation, dimension of space, exact solution")
        .required("{ physics = \"poisson\", dimension = 2 }"),
    Key::of("discretization", Special::Block(DISCRETIZATION), "defaults of every patch, which may override each")
        .optional("{ degree = 2 }"),
    Key::of("material", Special::Blocks(MATERIAL), "constants of materials").optional("[]"),
    Key::of("patch", Special::Blocks(PATCH), "bodies").required("[]"),
    Key::of("boundary", Special::Blocks(BOUNDARY), "prescribed values and loads on sides").optional("[]"),
    Key::of("interface", Special::Blocks(INTERFACE), "pairs of sides that are tied").optional("[]"),
    Key::of("contact", Special::Blocks(CONTACT), "pairs of sides that may touch").optional("[]"),
    Key::of("steps", Special::Block(STEPS), "times; without it one step at t = 1").optional("{ count = 4 }"),
    Key::of("solver", Special::Block(SOLVER), "how the systems are solved").optional("{ linear = \"direct\" }"),
    Key::of("probe", Special::Blocks(PROBE), "quantities to report").optional("[]"),
    later("line", Plain::Never, "[]", "write a [[probe]] for every point of the line"),
    Key::of("check", Special::Blocks(CHECK), "conditions that decide between exit 0 and 1").optional("[]"),
    Key::of("study", Special::BlockPer(STUDIES, STUDY), "defaults of studies, a table per command").optional("{}"),
];

/// Components of vectors.
pub(super) const COORDINATES: &[Key] = &[coordinate("x"), coordinate("y"), coordinate("z")];

/// The component of Poisson's equation.
pub(super) const UNKNOWN: &[Key] = &[coordinate("u")];

/// Parameters of a patch.
pub(super) const PARAMETERS: &[Key] = &[coordinate("u"), coordinate("v"), coordinate("w")];

const fn coordinate(name: &'static str) -> Key {
    Key::new(name, KeyKind::Number, "a component").optional("1.0")
}

/// Words that users may expect in any block and that are not implemented.
pub(super) const LATER: &[&str] = &["friction", "axisymmetric", "dynamics", "thermal", "plasticity", "adhesion", "damping"];

/// A key that this version does not have, with an example of a value.
const fn later(name: &'static str, plain: Plain, example: &'static str, help: &'static str) -> Key {
    Key::of(name, Special::Later(plain, help), "not in this version").optional(example)
}

/// `name`, made of the block and the position by default.
const fn name() -> Key {
    Key::of("name", Special::Name, "name in messages, tables and files; default BLOCK-0, BLOCK-1, ..").optional("\"pad\"")
}

/// Surroundings of a block that its keys may depend on.
pub(super) struct Scene<'a> {
    pub names: &'a Names,
    /// Whether the physics is Poisson's equation.
    pub poisson: bool,
    pub dimension: usize,
    /// Backend of [discretization].
    pub backend: Option<&'a Located<String>>,
}

/// The text of a key of a table.
pub(super) fn word<'a>(table: &'a Table, key: &str) -> Option<&'a str> {
    match &table.get(key)?.node.value {
        Value::Text(word) => Some(word),
        _ => None,
    }
}

/// Whether the patch does not take `backend` from the case file: options may change it where keys of the other one stand.
fn other_backend(table: &Table, scene: &Scene<'_>, backend: &str) -> bool {
    let own = table.get("backend").map(|e| (word(table, "backend").unwrap_or_default(), e.node.at.origin));
    let (word, origin) = own.or(scene.backend.map(|b| (b.value.as_str(), b.at.origin))).unwrap_or_default();
    word != backend || !matches!(origin, Origin::File | Origin::Default)
}
