//! The grammar of case files: a row per key, block by block, in the order in which the effective case shows them.

mod bodies;
mod common;
mod couples;
mod demand;
mod model;
mod obstacles;
mod sides;

pub(super) use bodies::{GRADE, PATCH, geometries};
pub(super) use common::word;
pub(super) use couples::{ACTIVE_SET, CONTACT, INTERFACE, MULTIPLIER, SEED};
pub(super) use demand::{CHECK, LINE, PROBE, SOLVER, STEPS, STUDIES, STUDY};
pub(super) use model::{DISCRETIZATION, EXACT, MATERIAL, MODEL};
pub(super) use obstacles::{CURVE, obstacles};
pub(super) use sides::BOUNDARY;

use super::key::{Inside, Key, KeyKind, Special};
use super::names::Names;

/// Top level.
pub(super) const ROOT: &[Key] = &[
    Key::of("schema", Special::Only("1", r#"{"const":1}"#), "version of the grammar of case files").default("1"),
    Key::new("title", KeyKind::Text, "heading of tables and pictures").default("\"\""),
    Key::of("units", Special::Block(UNITS), "labels of pictures and reports; numbers are never converted")
        .optional("{ length = \"mm\", force = \"N\" }"),
    Key::of("output", Special::Block(OUTPUT), "what pictures show").optional("{ deformed = 20 }"),
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
    Key::of("line", Special::Blocks(LINE), "fields along straight lines: csv and svg").optional("[]"),
    Key::of("check", Special::Blocks(CHECK), "conditions that decide between exit 0 and 1").optional("[]"),
    Key::of("study", Special::BlockPer(STUDIES, STUDY), "defaults of studies, a table per command").optional("{}"),
];

/// Names of units.
pub(super) const UNITS: &[Key] = &[
    Key::new("length", KeyKind::Text, "unit of lengths, at most 12 letters").optional("\"mm\""),
    Key::new("force", KeyKind::Text, "unit of forces, at most 12 letters").optional("\"N\""),
];

/// Contents of pictures.
pub(super) const OUTPUT: &[Key] = &[
    Key::of(
        "fields",
        Special::Words,
        "what fields.svg shows, one below the other: von_mises, displacement, u.x, stress.yy, u, any field of quantities such as principal.1, \
         strain.xx or stress.rr about [x, y], which fields.vtu has then, too, contact.NAME.pressure, interface.NAME.lambda; without it von_mises, or u",
    )
    .optional("[\"von_mises\", \"stress.yy\"]"),
    Key::of(
        "deformed",
        Special::Only("\"auto\", a number from 0, or false", r#"{"anyOf":[{"enum":["auto",false]},{"type":"number","minimum":0}]}"#),
        "factor of the displacements in fields.svg; auto: the largest one is about a twentieth of the bodies, in contact as it is",
    )
    .default("\"auto\""),
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
pub(super) const LATER: &[&str] = &["friction", "dynamics", "thermal", "plasticity", "adhesion", "damping"];

/// Keys within the value of a key.
pub(super) fn inside(key: &Key, names: &Names) -> Inside {
    match key.special() {
        Some(Special::Block(keys) | Special::Blocks(keys) | Special::BlockPer(_, keys)) => Inside::Block(names.extended(keys)),
        Some(Special::Multiplier) => Inside::Block(MULTIPLIER.to_vec()),
        Some(Special::Geometry) => Inside::Kinds(geometries()),
        Some(Special::Obstacle) => Inside::Kinds(obstacles(names)),
        _ => Inside::Nothing,
    }
}
