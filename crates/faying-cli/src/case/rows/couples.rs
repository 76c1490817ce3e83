//! `[[interface]]` and `[[contact]]`, with `multiplier` and `active_set`.

use super::common::{later, name, word};
use super::model::POINTS;
use crate::case::key::{Axis, Key, KeyKind, Only, Plain, Scene, Special, Uses};
use crate::case::names::EntryFamily;
use crate::case::tree::Table;

const NOT_GLUED: Only = Only { holds: not_glued, of: "couplings that tie: glued sides share their unknowns", instead: "" };
const TIED_BY_ROWS: Only = Only {
    holds: |t, s| not_glued(t, s) && s.names.has_rows(word(t, "coupling").unwrap_or("mortar")),
    of: "couplings with a multiplier",
    instead: "",
};
const MULTIPLIED: Only = Only { holds: |t, s| s.names.needs(method(t)).multiplier, of: "methods with a multiplier", instead: "" };

fn not_glued(table: &Table, _: &Scene<'_>) -> bool {
    word(table, "coupling") != Some("glue")
}

fn method(table: &Table) -> &str {
    word(table, "method").unwrap_or("lagrange")
}

const fn slave() -> Key {
    Key::of("slave", Special::Sides, "side that carries the multiplier").required("\"upper.v0\"").aliases(&["nonmortar", "secondary"])
}

const fn multiplier() -> Key {
    Key::of("multiplier", Special::Multiplier, "space of the multiplier").default("\"auto\"").axis(Axis::Pairing)
}

const fn integration() -> Key {
    Key::of("integration", Special::Entry(EntryFamily::Integrations), "which side's elements divide the interface for integration")
        .default("\"merged\"")
        .axis(Axis::Integration)
}

const fn extra_points() -> Key {
    Key::new("extra_points", POINTS, "Gauss points per segment beyond max(p_slave, p_master) + 1").default("0").axis(Axis::ExtraPoints)
}

pub(in crate::case) const INTERFACE: &[Key] = &[
    name(),
    slave(),
    Key::of("master", Special::Sides, "side that the slave is tied to").required("\"lower.v1\"").aliases(&["mortar", "primary"]),
    Key::of("between", Special::Words, "\"all\" or a list of patches: every pair of touching sides, slave = the finer").optional("\"all\""),
    Key::of("coupling", Special::Entry(EntryFamily::Couplings), "how the sides are tied").default("\"mortar\""),
    multiplier().only(TIED_BY_ROWS),
    integration().only(NOT_GLUED),
    extra_points().only(NOT_GLUED),
    Key::new("tolerance", KeyKind::Auto, "largest distance of the sides").unit("length").default("\"auto\""),
    Key::of("exact", Special::Field, "exact multiplier, for its error").unit("force/area").optional("[\"0\", \"-1\"]").only(NOT_GLUED),
    PART.only(NOT_GLUED),
];

const PART: Key = Key::new(
    "where",
    KeyKind::Formula,
    "keeps only the slave's facets whose centre satisfies it, so that a side may have several partners",
)
.optional("\"x > 0\"");

pub(in crate::case) const CONTACT: &[Key] = &[
    name(),
    slave(),
    Key::of("master", Special::Sides, "side that the slave faces; or rigid").optional("\"lower.v1\"").aliases(&["mortar", "primary"]),
    Key::of("rigid", Special::Obstacle, "a rigid obstacle instead of a master")
        .optional("{ kind = \"half-plane\", point = [0, 0], normal = [0, 1] }"),
    Key::of("gap", Special::FormulaOf(Uses::Gap), "formula of the geometric gap g and x, y, z, t").unit("length").default("\"g\""),
    Key::of("method", Special::Entry(EntryFamily::Methods), "how contact is enforced").default("\"lagrange\""),
    multiplier().only(MULTIPLIED),
    integration(),
    extra_points(),
    Key::new("cone", KeyKind::Word(&["coefficients", "weights", "values"]), "discrete cone of admissible multipliers")
        .default("\"coefficients\"")
        .only(MULTIPLIED),
    Key::new("reach", KeyKind::Auto, "search distance; points farther from the master have no partner").unit("length").default("\"auto\""),
    Key::new("exact", KeyKind::Formula, "exact multiplier, negative in compression, for its error").unit("force/area").optional("-1.25e-3"),
    Key::new("symmetry", KeyKind::Flag, "a zone that ends at the end of the side goes on beyond it (half models)").default("false"),
    Key::of("active_set", Special::Block(ACTIVE_SET), "settings of the active set").default("{}"),
    PART,
    Key::new(
        "adjust",
        KeyKind::Flag,
        "close gaps and overlaps at rest that facets explain: up to twice their distance from the surfaces for which they stand; clearances and press fits belong into `gap` then",
    )
    .default("false"),
    later("friction", Plain::Zero, "0", "contact is frictionless here: leave it out, or write 0"),
];

pub(in crate::case) const ACTIVE_SET: &[Key] = &[
    Key::of(
        "start",
        Special::Only(
            "one of \"auto\", \"all\", \"none\", \"gap\", or { seed = 7 }",
            r#"{"anyOf":[{"enum":["auto","all","none","gap"]},{"type":"object","properties":{"seed":{"type":"integer","minimum":0}},"required":["seed"],"additionalProperties":false}]}"#,
        ),
        "rows that are closed at first",
    )
    .default("\"auto\""),
    Key::new("max_iterations", KeyKind::Whole(1, 100_000), "largest number of linear systems").default("100"),
    Key::new("c", KeyKind::Positive, "weight of the gap against the multiplier, in units of the slave's stiffness").default("1.0"),
];

/// A random start.
pub(in crate::case) const SEED: &[Key] = &[Key::new("seed", KeyKind::Whole(0, i64::MAX), "seed of a random start").required("7")];

pub(in crate::case) const MULTIPLIER: &[Key] = &[
    Key::new("degree", KeyKind::Whole(0, 12), "degree of the multiplier").required("1"),
    Key::of(
        "continuity",
        Special::Only("a whole number from -1 to degree - 1", r#"{"type":"integer","minimum":-1,"maximum":11}"#),
        "at the breakpoints, -1 is discontinuous; default degree - 1",
    )
    .optional("0"),
    Key::new("ends", KeyKind::Word(&["auto", "full", "lowered"]), "degree in the end elements").default("\"auto\""),
];
