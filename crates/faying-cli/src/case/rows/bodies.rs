//! `[[patch]]`: geometry, elements, functions.

use super::common::{foundation, other_backend, reaction, word};
use super::model::{BASIS, CELL, CONTINUITY, DEGREE, EXACT, MAPPING, POINTS};
use crate::case::key::{Axis, Key, KeyKind, Only, Special};
use crate::case::names::EntryFamily;
use crate::case::tree::Value;

const OF_IGA: Only = Only { holds: |t, s| other_backend(t, s, "fe"), of: "backend \"iga\"", instead: "" };
const OF_FE: Only = Only { holds: |t, s| other_backend(t, s, "iga"), of: "backend \"fe\"", instead: "" };
const ELASTIC: Only = Only { holds: |_, s| !s.poisson, of: "elasticity", instead: "use source" };
const POISSON: Only = Only { holds: |_, s| s.poisson, of: "poisson", instead: "use body_force" };
const OF_FILES: Only = Only {
    holds: |t, _| t.get("geometry").is_none_or(|e| matches!(&e.node.value, Value::Table(g) if word(g, "kind") == Some("file"))),
    of: "files of several patches",
    instead: "write an interface with coupling = \"glue\" to glue patches",
};
const IN_SPACE: Only = Only { holds: |_, s| s.dimension == 3, of: "3D rotations", instead: "" };

pub(in crate::case) const PATCH: &[Key] = &[
    Key::of("name", Special::Name, "name, as in NAME.left").required("\"lower\""),
    Key::of("geometry", Special::Geometry, "shape").required("{ kind = \"box\", min = [0, 0], max = [1, 1] }"),
    Key::of("material", Special::Name, "its material; may be left out where there is exactly one").optional("\"steel\""),
    Key::of(
        "elements",
        Special::Only(
            "a whole number, or per direction one or a list of breakpoints",
            r##"{"anyOf":[{"type":"integer","minimum":1},{"type":"array","minItems":2,"maxItems":3,"items":{"anyOf":[{"type":"integer","minimum":1},{"type":"array","items":{"$ref":"#/$defs/number"},"minItems":2}]}}]}"##,
        ),
        "elements per direction, or breakpoints; of nurbs and files pieces per knot span, default 1",
    )
    .optional("[4, 2]"),
    Key::new("refine", KeyKind::Whole(0, 20), "halvings of every element").default("0").axis(Axis::Level),
    Key::of("grade", Special::Block(GRADE), "sizes grow geometrically away from a parameter").optional("{ toward = { u = 0.5, v = 0.0 }, ratio = 0.02 }"),
    Key::of("backend", Special::Entry(EntryFamily::Backends), OVERRIDES).optional("\"fe\"").axis(Axis::Backend),
    Key::of("degree", DEGREE, OVERRIDES).optional("3").axis(Axis::Degree),
    Key::of("continuity", CONTINUITY, OVERRIDES).optional("0").only(OF_IGA),
    Key::new("basis", BASIS, OVERRIDES).optional("\"b-spline\"").only(OF_IGA),
    Key::new("cells", CELL, OVERRIDES).optional("\"simplex\"").only(OF_FE),
    Key::new("mapping", MAPPING, OVERRIDES).optional("\"exact\"").only(OF_FE),
    Key::new("extra_points", POINTS, OVERRIDES).optional("1"),
    Key::new("source", KeyKind::Formula, "source of this patch, beside that of the model").optional("1.0").only(POISSON),
    Key::of("body_force", Special::Field, "force per volume of this patch, beside that of the model")
        .unit("force/volume")
        .optional("[\"0\", \"-1\"]")
        .only(ELASTIC),
    Key::of("gravity", Special::SomeCoordinates, "acceleration of this patch, beside that of the model")
        .unit("length/time^2")
        .optional("[0, -9.81]")
        .only(ELASTIC),
    Key::new("closed", KeyKind::Word(&["u", "v", "w"]), "direction that closes on itself: a ring").optional("\"u\""),
    Key::new("glue", KeyKind::Flag, "whether touching sides of a file's patches are glued; default true").optional("false").only(OF_FILES),
    Key::of("exact", Special::Block(EXACT), "manufactured solution in this patch, instead of that of the model; it may jump between patches")
        .optional("{ u = [\"x*y\", \"0\"] }"),
    reaction("c of -div(k grad u) + c u = f in this patch, beside that of the model").only(Only { instead: "use foundation", ..POISSON }),
    foundation("springs of the volume of this patch, beside those of the model").only(Only { instead: "use reaction", ..ELASTIC }),
];

const OVERRIDES: &str = "instead of that of [discretization]";

pub(in crate::case) const GRADE: &[Key] = &[
    Key::of(
        "toward",
        Special::Only(
            "a table of u, v, w",
            r##"{"type":"object","properties":{"u":{"$ref":"#/$defs/number"},"v":{"$ref":"#/$defs/number"},"w":{"$ref":"#/$defs/number"}},"additionalProperties":false}"##,
        ),
        "parameter from 0 to 1 per graded direction",
    )
    .required("{ u = 0.5, v = 0.0 }"),
    Key::new("ratio", KeyKind::Positive, "size of the first element over the uniform size, at most 1").required("0.02"),
];

/// Keys of every geometry, applied in this order.
pub(in crate::case) const MOTIONS: &[Key] = &[
    Key::new("extrude", KeyKind::Positive, "height along z; the third parameter").unit("length").optional("1.0"),
    SCALE,
    ROTATE,
    AXIS,
    Key::of("move", Special::SomeCoordinates, "translation").unit("length").optional("[0, 1]"),
];

/// Keys that place an obstacle with the shape of a patch; `move` is its motion.
pub(in crate::case) const PLACING: &[Key] = &[SCALE, ROTATE, AXIS];

const SCALE: Key = Key::new("scale", KeyKind::Positive, "factor about the origin").optional("2.0");
const ROTATE: Key = Key::new("rotate_deg", KeyKind::Number, "angle about the origin in degrees").unit("degree").optional("30");
const AXIS: Key = Key::new("axis", KeyKind::Vector, "axis of the rotation in 3D").optional("[0, 0, 1]").only(IN_SPACE);

const fn center() -> Key {
    Key::new("center", KeyKind::Vector, "centre; default the origin").unit("length").optional("[0, 0]")
}

const fn radii() -> Key {
    Key::of("radius", Special::Pair, "inner and outer radius").unit("length").required("[1.0, 2.0]")
}

const fn angles() -> Key {
    Key::of("angle_deg", Special::Pair, "first and last angle").unit("degree").required("[0, 90]")
}

const fn radius(text: &'static str) -> Key {
    Key::new("radius", KeyKind::Positive, text).unit("length").required("1.0")
}

const BOX: &[Key] = &[
    Key::new("min", KeyKind::Vector, "least coordinates").unit("length").required("[0, 0]"),
    Key::new("max", KeyKind::Vector, "largest coordinates").unit("length").required("[1, 1]"),
];

const NURBS: &[Key] = &[
    Key::of(
        "degree",
        Special::Only(
            "a whole number per direction",
            r#"{"type":"array","items":{"type":"integer","minimum":1},"minItems":2,"maxItems":3}"#,
        ),
        "degree per direction",
    )
    .required("[2, 1]"),
    Key::of(
        "knots",
        Special::Only(
            "a list of numbers per direction",
            r##"{"type":"array","items":{"type":"array","items":{"$ref":"#/$defs/number"}},"minItems":2,"maxItems":3}"##,
        ),
        "open knot vector per direction",
    )
    .required("[[0, 0, 0, 1, 1, 1], [0, 0, 1, 1]]"),
    Key::of("points", POINT_LIST, "control points, u runs fastest").unit("length").required("[[0, 0], [1, 0], ..]"),
    WEIGHTS,
];

pub(super) const POINT_LIST: Special = Special::Only("a list of points", r##"{"type":"array","items":{"$ref":"#/$defs/vector"}}"##);
pub(super) const WEIGHTS: Key = Key::of("weights", Special::Numbers, "positive, one per point; default 1").optional("[1, 0.7, 1]");

const FILE: &[Key] = &[
    Key::new("file", KeyKind::Text, "path relative to the case file").required("\"part.xml\""),
    Key::of("id", WORD_OR_NUMBER, "a patch of a G+Smo file").optional("0"),
    Key::of("group", WORD_OR_NUMBER, "a group of a mesh file").optional("\"bracket\""),
    Key::new("refinement", KeyKind::Text, "the .ref list of an MFEM mesh").optional("\"part.ref\""),
];

const WORD_OR_NUMBER: Special = Special::Only("a name or a number", r#"{"type":["string","integer"]}"#);

/// Kinds of geometry with their own keys.
pub(super) const GEOMETRIES: &[(&str, &[Key])] = &[
    ("box", BOX),
    ("annulus-sector", &[center(), radii(), angles()]),
    ("disc-sector", &[center(), radius("radius; v0 is the centre and no side"), angles()]),
    (
        "plate-with-hole",
        &[
            radius("radius of the hole"),
            Key::new("half_width", KeyKind::Positive, "half the width of the whole plate").unit("length").required("4.0"),
        ],
    ),
    ("sphere-octant", &[center(), radii()]),
    ("nurbs", NURBS),
    ("file", FILE),
];

/// Kinds of geometry of patches, with all their keys.
pub(in crate::case) fn geometries() -> Vec<(String, Vec<Key>)> {
    GEOMETRIES.iter().map(|(kind, own)| ((*kind).to_owned(), [own, MOTIONS].concat())).collect()
}
