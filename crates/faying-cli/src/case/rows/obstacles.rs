//! `rigid` of `[[contact]]`: kinds of obstacles.

use super::bodies::{GEOMETRIES, PLACING, POINT_LIST, WEIGHTS};
use crate::case::key::{Key, KeyKind, Special};
use crate::case::names::Names;

/// Keys of every obstacle.
const MOTION: &[Key] = &[
    Key::of("move", Special::Components { exact: false }, "prescribed motion, formulas of t")
        .unit("length")
        .optional("{ y = \"-0.05*t\" }"),
    Key::of("force", Special::Components { exact: false }, "force that drives it, formulas of t").unit("force").optional("{ y = -1.0 }"),
];

const fn center() -> Key {
    Key::new("center", KeyKind::Vector, "centre, or a point of the axis").unit("length").required("[0, 0]")
}

const fn axis() -> Key {
    Key::new("axis", KeyKind::Vector, "direction of the axis").required("[0, 0, 1]")
}

const fn radius() -> Key {
    Key::new("radius", KeyKind::Positive, "radius").unit("length").required("1.0")
}

/// Kinds that no patch has, with their own keys.
const KINDS: &[(&str, &[Key])] = &[
    (
        "half-plane",
        &[
            Key::new("point", KeyKind::Vector, "a point of the plane").unit("length").required("[0, 0]"),
            Key::new("normal", KeyKind::Vector, "normal out of the obstacle").required("[0, 1]"),
        ],
    ),
    ("sphere", &[center(), radius(), Key::new("inside", KeyKind::Flag, "whether the body is inside").default("false")]),
    ("cylinder", &[center(), axis(), radius()]),
    (
        "torus",
        &[center(), axis(), Key::of("radius", Special::Pair, "radius of the circle and of the tube").unit("length").required("[2.0, 0.5]")],
    ),
    (
        "level-set",
        &[
            Key::new("f", KeyKind::Formula, "positive outside; the gap is the distance to f = 0").required("\"y - 0.1*x^2\""),
            Key::new("along", KeyKind::Vector, "with it the gap is f and the normal is this direction").optional("[0, 1]"),
        ],
    ),
];

/// Keys of `nurbs` with one parameter, an obstacle of the plane.
pub(in crate::case) const CURVE: &[Key] = &[
    Key::of(
        "degree",
        Special::Only(
            "a whole number",
            r##"{"anyOf":[{"$ref":"#/$defs/degree"},{"type":"array","items":{"$ref":"#/$defs/degree"},"minItems":1,"maxItems":1}]}"##,
        ),
        "degree of the curve",
    )
    .required("2"),
    Key::of(
        "knots",
        Special::Only(
            "a list of numbers",
            r##"{"anyOf":[{"type":"array","items":{"$ref":"#/$defs/number"}},{"type":"array","items":{"type":"array","items":{"$ref":"#/$defs/number"}},"minItems":1,"maxItems":1}]}"##,
        ),
        "open knot vector; the obstacle lies to the right of the curve",
    )
    .required("[0, 0, 0, 1, 1, 1]"),
    Key::of("points", POINT_LIST, "control points along the curve").unit("length").required("[[0, 0], [1, 0], ..]"),
    WEIGHTS,
];

/// Kinds of obstacles with all their keys; `nurbs` stands twice, as a shape and as a curve.
pub(in crate::case) fn obstacles(names: &Names) -> Vec<(String, Vec<Key>)> {
    let own = KINDS.iter().map(|(kind, own)| ((*kind).to_owned(), [own, MOTION].concat()));
    let entries = names.obstacles.iter().map(|entry| (entry.name.clone(), [&entry.keys, MOTION].concat()));
    let shapes = GEOMETRIES.iter().chain([&("nurbs", CURVE)]).map(|(kind, own)| ((*kind).to_owned(), [own, PLACING, MOTION].concat()));
    // an entry takes the place of a kind of the language
    let is_free = |(kind, _): &(String, Vec<Key>)| names.obstacles.iter().all(|entry| entry.name != *kind);
    own.chain(shapes).filter(is_free).chain(entries).collect()
}
