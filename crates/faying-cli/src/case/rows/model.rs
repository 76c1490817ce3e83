//! `[model]`, `[discretization]`, `[[material]]`.

use super::common::{foundation, later, reaction, word};
use crate::case::key::{Axis, Key, KeyKind, Only, Plain, Scene, Special};
use crate::case::names::EntryFamily;
use crate::case::tree::Table;
use crate::case::types::{BASES, CELLS, MAPPINGS};

const ELASTIC: Only = Only { holds: |t, _| word(t, "physics") != Some("poisson"), of: "elasticity", instead: "use source" };
const POISSON: Only = Only { holds: |t, _| word(t, "physics") != Some("elasticity"), of: "poisson", instead: "use body_force" };
const PLANE: Only = Only {
    holds: |t, _| !in_space(t) && (word(t, "assumption") == Some("axisymmetric") || word(t, "physics") != Some("poisson")),
    of: "plane elasticity and bodies of revolution",
    instead: "",
};

fn in_space(table: &Table) -> bool {
    table.get("dimension").is_some_and(|e| matches!(e.node.value, crate::case::tree::Value::Integer(3)))
}

pub(in crate::case) const MODEL: &[Key] = &[
    Key::new("physics", KeyKind::Word(&["poisson", "elasticity"]), "-div(k grad u) = f, or -div sigma(u) = f").required("\"elasticity\""),
    Key::new("dimension", KeyKind::Whole(2, 3), "dimension of space").required("2"),
    later("kinematics", Plain::Words(&["small"], &["finite"]), "\"small\"", "displacements and rotations are small here"),
    Key::new(
        "assumption",
        KeyKind::Word(&["plane-strain", "plane-stress", "axisymmetric"]),
        "elasticity in the plane; axisymmetric (poisson, too): x >= 0 is the radius, y the axis, forces, areas and energies are of the full circle, stress.zz is the hoop stress",
    )
        .default("\"plane-strain\"")
        .only(PLANE),
    Key::of("exact", Special::Block(EXACT), "manufactured solution: source, data marked \"exact\" and errors follow from it")
        .optional("{ u = [\"x*y\", \"0\"] }"),
    Key::new("reference", KeyKind::Text, "a stored run that errors are measured against").optional("\"p4.ref\""),
    Key::new("source", KeyKind::Formula, "source of Poisson's equation; not beside exact").optional("\"x*y\"").only(POISSON),
    Key::of("body_force", Special::Field, "force per volume; not beside exact")
        .unit("force/volume")
        .optional("[\"0\", \"-1\"]")
        .only(ELASTIC),
    Key::of("gravity", Special::SomeCoordinates, "acceleration; needs a density")
        .unit("length/time^2")
        .optional("[0, -9.81]")
        .only(ELASTIC),
    reaction("c of -div(k grad u) + c u = f; not beside exact").only(Only { instead: "use foundation", ..POISSON }),
    foundation("springs of the volume: force per volume and length; not beside exact").only(Only { instead: "use reaction", ..ELASTIC }),
];

pub(in crate::case) const EXACT: &[Key] =
    &[Key::of("u", Special::Field, "a formula of x, y, z per component of the unknown").required("\"x*y\"")];

pub(in crate::case) const DISCRETIZATION: &[Key] = &[
    Key::of("backend", Special::Entry(EntryFamily::Backends), "functions: iga (splines), fe (Lagrange elements)")
        .default("\"iga\"")
        .axis(Axis::Backend),
    Key::of("degree", DEGREE, "polynomial degree, or one per direction; at most 12 (iga), 8 (fe tensor), 4 (fe simplex)")
        .default("2")
        .axis(Axis::Degree),
    Key::of("continuity", CONTINUITY, "iga: C^(p-1) at new knots, or C^k").default("\"max\""),
    Key::new("basis", BASIS, "iga: rational where the geometry is").default("\"auto\""),
    Key::new("cells", CELL, "fe: quadrilaterals and hexahedra, or triangles and tetrahedra").default("\"tensor\""),
    Key::new("mapping", MAPPING, "fe: degree of the space, or the patch's own map").default("\"isoparametric\""),
    Key::new(
        "extra_points",
        POINTS,
        "Gauss points per direction beyond the default: degree + 1; more in curved splines in space, result.json says how many",
    )
    .default("0"),
];

pub(super) const DEGREE: Special = Special::Only(
    "a whole number from 1 to 12, or one per direction",
    r##"{"anyOf":[{"$ref":"#/$defs/degree"},{"type":"array","items":{"$ref":"#/$defs/degree"},"minItems":2,"maxItems":3}]}"##,
);
pub(super) const CONTINUITY: Special = Special::Only(
    "\"max\" or a whole number from 0 to degree - 1",
    r#"{"anyOf":[{"const":"max"},{"type":"integer","minimum":0,"maximum":11}]}"#,
);
pub(super) const BASIS: KeyKind = KeyKind::Word(&[BASES[0].0, BASES[1].0, BASES[2].0]);
pub(super) const CELL: KeyKind = KeyKind::Word(&[CELLS[0].0, CELLS[1].0]);
pub(super) const MAPPING: KeyKind = KeyKind::Word(&[MAPPINGS[0].0, MAPPINGS[1].0]);
/// Gauss points beyond a default.
pub(super) const POINTS: KeyKind = KeyKind::Whole(0, 60);

const HOOKE: Only = Only { holds: |t, s| !s.poisson && hooke(t, s), of: "law \"hooke\" of elasticity", instead: "" };
const CONDUCTS: Only = Only { holds: |t, s| s.poisson && hooke(t, s), of: "poisson without law", instead: "" };
const LAW: Only = Only { holds: |t, s| !s.poisson || !hooke(t, s), of: "elasticity, or a law with keys of its own", instead: "" };

/// Whether a material names no law of the registry.
fn hooke(material: &Table, scene: &Scene<'_>) -> bool {
    word(material, "law").is_none_or(|law| scene.names.laws.iter().all(|entry| entry.name != law))
}

pub(in crate::case) const MATERIAL: &[Key] = &[
    Key::of("name", Special::Name, "name, as in `material` of a patch").required("\"steel\""),
    Key::new("young", KeyKind::Formula, "Young's modulus, with poisson").unit("force/area").optional("210e3").symbol("E").only(HOOKE),
    Key::new("poisson", KeyKind::Formula, "Poisson's ratio, below 0.5").optional("0.3").symbol("nu").only(HOOKE),
    Key::new("lambda", KeyKind::Formula, "first Lame constant, with mu").unit("force/area").optional("1.0").only(HOOKE),
    Key::new("mu", KeyKind::Formula, "shear modulus, with lambda").unit("force/area").optional("1.0").only(HOOKE),
    Key::new("conductivity", KeyKind::Formula, "k of Poisson's equation").default("1.0").only(CONDUCTS),
    Key::new("density", KeyKind::Formula, "mass per volume, for gravity").unit("mass/volume").optional("7.8e-9").symbol("rho"),
    Key::of("law", Special::Entry(EntryFamily::Laws), "law of the material; default that of Hooke or Fourier")
        .optional("\"hooke\"")
        .only(LAW),
    later("volumetric", Plain::Never, "\"log\"", "it belongs to laws of finite kinematics"),
    later("c1", Plain::Never, "1.0", "it belongs to laws of finite kinematics"),
    later("c2", Plain::Never, "1.0", "it belongs to laws of finite kinematics"),
    later("bulk", Plain::Never, "1.0", "it belongs to laws of finite kinematics; here young and poisson, or lambda and mu"),
];
