//! Type, default and meaning of every key, for `faying schema`; a test holds the list against the reader's keys.

/// One key of one block.
#[derive(Clone, Copy, Debug)]
pub(super) struct Entry {
    /// The block; the kind for geometries and obstacles.
    pub block: &'static str,
    /// The key.
    pub key: &'static str,
    /// Its type as JSON Schema, with its default.
    pub kind: &'static str,
    /// Its meaning.
    pub text: &'static str,
}

const fn e(block: &'static str, key: &'static str, kind: &'static str, text: &'static str) -> Entry {
    Entry { block, key, kind, text }
}

const TABLE: &str = r#"{"type":"object"}"#;
const TEXT: &str = r#"{"type":"string"}"#;
const NAME: &str = r##"{"$ref":"#/$defs/name"}"##;
const FORMULA: &str = r##"{"$ref":"#/$defs/formula"}"##;
const NUMBER: &str = r##"{"$ref":"#/$defs/number"}"##;
const POSITIVE: &str = r##"{"$ref":"#/$defs/positive"}"##;
const VECTOR: &str = r##"{"$ref":"#/$defs/vector"}"##;
const FIELD: &str = r##"{"$ref":"#/$defs/field"}"##;
const COMPONENTS: &str = r##"{"$ref":"#/$defs/components"}"##;
const SIDES: &str = r##"{"$ref":"#/$defs/sides"}"##;
const WORDS: &str = r##"{"$ref":"#/$defs/words"}"##;
const AUTO: &str = r##"{"$ref":"#/$defs/auto","default":"auto"}"##;
const EXTRA: &str = r##"{"$ref":"#/$defs/extra_points","default":0}"##;
const PAIR: &str = r##"{"type":"array","items":{"$ref":"#/$defs/number"},"minItems":2,"maxItems":2}"##;
const NUMBERS: &str = r##"{"type":"array","items":{"$ref":"#/$defs/number"}}"##;
const MULTIPLIER: &str = r##"{"$ref":"#/$defs/multiplier","default":"auto"}"##;
const INTEGRATION: &str = r##"{"$ref":"#/$defs/integration","default":"merged"}"##;
const BACKEND: &str = r##"{"$ref":"#/$defs/backend"}"##;
const DEGREE: &str =
    r##"{"anyOf":[{"$ref":"#/$defs/degree"},{"type":"array","items":{"$ref":"#/$defs/degree"},"minItems":2,"maxItems":3}]}"##;
const CONTINUITY: &str = r#"{"anyOf":[{"const":"max"},{"type":"integer","minimum":0,"maximum":11}]}"#;
const BASIS: &str = r#"{"enum":["auto","nurbs","b-spline"]}"#;
const CELLS: &str = r#"{"enum":["tensor","simplex"]}"#;
const MAPPING: &str = r#"{"enum":["isoparametric","exact"]}"#;
const LIST: &str = r#"{"type":"array"}"#;

pub(super) const ENTRIES: &[Entry] = &[
    e("", "schema", r#"{"const":1,"default":1}"#, "version of the case file's grammar"),
    e("", "title", r#"{"type":"string","default":""}"#, "heading of tables and pictures"),
    e("", "let", r#"{"type":"object","additionalProperties":{"type":["number","string"]}}"#, "constants for every formula"),
    e("", "model", TABLE, "the equation, its dimension, its exact solution"),
    e("", "discretization", TABLE, "defaults for every patch; a patch may override each"),
    e("", "material", LIST, "constants of materials"),
    e("", "patch", LIST, "bodies"),
    e("", "boundary", LIST, "prescribed values and loads on sides"),
    e("", "interface", LIST, "pairs of sides that are tied"),
    e("", "contact", LIST, "pairs of sides that may touch"),
    e("", "steps", TABLE, "times; without it one step at t = 1"),
    e("", "solver", TABLE, "how the systems are solved"),
    e("", "probe", LIST, "quantities to report"),
    e("", "check", LIST, "what decides exit 0 or 1"),
    e("", "study", TABLE, "defaults of studies, a table per command"),
    e("model", "physics", r#"{"enum":["poisson","elasticity"]}"#, "-div(k grad u) = f, or -div sigma(u) = f"),
    e("model", "dimension", r#"{"enum":[2,3]}"#, "dimension of space"),
    e("model", "assumption", r#"{"enum":["plane-strain","plane-stress"],"default":"plane-strain"}"#, "elasticity in the plane"),
    e(
        "model",
        "exact",
        r##"{"type":"object","properties":{"u":{"$ref":"#/$defs/field"}},"required":["u"],"additionalProperties":false}"##,
        "manufactured solution: source, data marked \"exact\" and errors follow from it",
    ),
    e("model", "reference", TEXT, "a stored run that errors are measured against"),
    e("model", "source", FORMULA, "source of Poisson's equation; not beside exact"),
    e("model", "body_force", FIELD, "force per volume; not beside exact"),
    e("model", "gravity", VECTOR, "acceleration; needs a density"),
    e(
        "discretization",
        "backend",
        r##"{"$ref":"#/$defs/backend","default":"iga"}"##,
        "which functions: iga (splines), fe (Lagrange elements)",
    ),
    e(
        "discretization",
        "degree",
        r##"{"anyOf":[{"$ref":"#/$defs/degree"},{"type":"array","items":{"$ref":"#/$defs/degree"},"minItems":2,"maxItems":3}],"default":2}"##,
        "polynomial degree, or one per direction; at most 12 (iga), 8 (fe tensor), 4 (fe simplex)",
    ),
    e(
        "discretization",
        "continuity",
        r#"{"anyOf":[{"const":"max"},{"type":"integer","minimum":0,"maximum":11}],"default":"max"}"#,
        "iga: C^(p-1) at new knots, or C^k",
    ),
    e("discretization", "basis", r#"{"enum":["auto","nurbs","b-spline"],"default":"auto"}"#, "iga: rational where the geometry is"),
    e(
        "discretization",
        "cells",
        r#"{"enum":["tensor","simplex"],"default":"tensor"}"#,
        "fe: quadrilaterals and hexahedra, or triangles and tetrahedra",
    ),
    e(
        "discretization",
        "mapping",
        r#"{"enum":["isoparametric","exact"],"default":"isoparametric"}"#,
        "fe: degree of the space, or the patch's own map",
    ),
    e(
        "discretization",
        "extra_points",
        EXTRA,
        "Gauss points per direction beyond the default: degree + 1; more in curved splines in space, result.json says how many",
    ),
    e("material", "name", NAME, "what patches call it"),
    e("material", "young", FORMULA, "Young's modulus [force/area], with poisson"),
    e("material", "poisson", FORMULA, "Poisson's ratio, below 0.5"),
    e("material", "lambda", FORMULA, "first Lame constant [force/area], with mu"),
    e("material", "mu", FORMULA, "shear modulus [force/area], with lambda"),
    e("material", "conductivity", r##"{"$ref":"#/$defs/formula","default":1.0}"##, "k of Poisson's equation"),
    e("material", "density", FORMULA, "mass per volume, for gravity"),
    e("patch", "name", NAME, "what sides and tables call it"),
    e("patch", "geometry", r##"{"$ref":"#/$defs/geometry"}"##, "the shape"),
    e("patch", "material", NAME, "which material; may be left out where there is exactly one"),
    e(
        "patch",
        "elements",
        r##"{"anyOf":[{"type":"integer","minimum":1},{"type":"array","minItems":2,"maxItems":3,"items":{"anyOf":[{"type":"integer","minimum":1},{"type":"array","items":{"$ref":"#/$defs/number"},"minItems":2}]}}]}"##,
        "elements per direction, or breakpoints; of nurbs and files pieces per knot span, default 1",
    ),
    e("patch", "refine", r#"{"type":"integer","minimum":0,"maximum":20,"default":0}"#, "halvings of every element"),
    e("patch", "grade", r##"{"$ref":"#/$defs/grade"}"##, "sizes grow geometrically away from a parameter"),
    e("patch", "backend", BACKEND, "instead of that of [discretization]"),
    e("patch", "degree", DEGREE, "instead of that of [discretization]"),
    e("patch", "continuity", CONTINUITY, "instead of that of [discretization]"),
    e("patch", "basis", BASIS, "instead of that of [discretization]"),
    e("patch", "cells", CELLS, "instead of that of [discretization]"),
    e("patch", "mapping", MAPPING, "instead of that of [discretization]"),
    e("patch", "extra_points", r##"{"$ref":"#/$defs/extra_points"}"##, "instead of that of [discretization]"),
    e("patch", "source", FORMULA, "source of this patch, beside that of the model"),
    e("patch", "body_force", FIELD, "force per volume of this patch, beside that of the model"),
    e("patch", "gravity", VECTOR, "acceleration of this patch, beside that of the model"),
    e("patch", "closed", r#"{"enum":["u","v","w"]}"#, "direction that closes on itself: a ring"),
    e("patch", "glue", r#"{"type":"boolean"}"#, "whether touching sides of a file's patches are glued; default true"),
    e("motion", "extrude", POSITIVE, "height along z; the third parameter"),
    e("motion", "scale", POSITIVE, "factor about the origin"),
    e("motion", "rotate_deg", NUMBER, "angle about the origin in degrees"),
    e("motion", "axis", VECTOR, "axis of the rotation in 3D"),
    e("motion", "move", VECTOR, "translation"),
    e("box", "min", VECTOR, "least coordinates"),
    e("box", "max", VECTOR, "largest coordinates"),
    e("annulus-sector", "center", VECTOR, "default the origin"),
    e("annulus-sector", "radius", PAIR, "inner and outer radius"),
    e("annulus-sector", "angle_deg", PAIR, "first and last angle"),
    e("disc-sector", "center", VECTOR, "default the origin"),
    e("disc-sector", "radius", POSITIVE, "radius; v0 is the centre and no side"),
    e("disc-sector", "angle_deg", PAIR, "first and last angle"),
    e("plate-with-hole", "radius", POSITIVE, "radius of the hole"),
    e("plate-with-hole", "half_width", POSITIVE, "half the width of the whole plate"),
    e("sphere-octant", "center", VECTOR, "default the origin"),
    e("sphere-octant", "radius", PAIR, "inner and outer radius"),
    e("nurbs", "degree", r#"{"type":"array","items":{"type":"integer","minimum":1},"minItems":2,"maxItems":3}"#, "degree per direction"),
    e(
        "nurbs",
        "knots",
        r##"{"type":"array","items":{"type":"array","items":{"$ref":"#/$defs/number"}},"minItems":2,"maxItems":3}"##,
        "open knot vector per direction",
    ),
    e("nurbs", "points", r##"{"type":"array","items":{"$ref":"#/$defs/vector"}}"##, "control points, u runs fastest"),
    e("nurbs", "weights", NUMBERS, "positive, one per point; default 1"),
    e(
        "nurbs-curve",
        "degree",
        r##"{"anyOf":[{"$ref":"#/$defs/degree"},{"type":"array","items":{"$ref":"#/$defs/degree"},"minItems":1,"maxItems":1}]}"##,
        "degree of the curve",
    ),
    e(
        "nurbs-curve",
        "knots",
        r##"{"anyOf":[{"type":"array","items":{"$ref":"#/$defs/number"}},{"type":"array","items":{"type":"array","items":{"$ref":"#/$defs/number"}},"minItems":1,"maxItems":1}]}"##,
        "open knot vector; the obstacle lies to the right of the curve",
    ),
    e("nurbs-curve", "points", r##"{"type":"array","items":{"$ref":"#/$defs/vector"}}"##, "control points along the curve"),
    e("nurbs-curve", "weights", NUMBERS, "positive, one per point; default 1"),
    e("file", "file", TEXT, "path relative to the case file"),
    e("file", "id", r#"{"type":["string","integer"]}"#, "a patch of a G+Smo file"),
    e("file", "group", r#"{"type":["string","integer"]}"#, "a group of a Gmsh file"),
    e("file", "refinement", TEXT, "the .ref list of an MFEM mesh"),
    e(
        "grade",
        "toward",
        r##"{"type":"object","properties":{"u":{"$ref":"#/$defs/number"},"v":{"$ref":"#/$defs/number"},"w":{"$ref":"#/$defs/number"}},"additionalProperties":false}"##,
        "parameter from 0 to 1 per graded direction",
    ),
    e("grade", "ratio", POSITIVE, "size of the first element over the uniform size, at most 1"),
    e("boundary", "name", NAME, "default boundary-0, ..."),
    e("boundary", "on", SIDES, "a side PATCH.SIDE, a list, or all-outer: sides in no other block"),
    e("boundary", "where", FORMULA, "keeps only the facets whose centre satisfies it"),
    e(
        "boundary",
        "fix",
        r#"{"anyOf":[{"enum":["x","y","z","u","normal","tangential"]},{"type":"array","minItems":1,"items":{"enum":["x","y","z","u","normal","tangential"]}}]}"#,
        "components that are zero",
    ),
    e("boundary", "dirichlet", COMPONENTS, "prescribed values; \"exact\" follows from the exact solution"),
    e("boundary", "neumann", COMPONENTS, "flux k du/dn or traction; \"exact\" follows from the exact solution"),
    e("boundary", "traction", COMPONENTS, "force per area"),
    e("boundary", "pressure", FORMULA, "force per area along minus the outward normal"),
    e("boundary", "force", COMPONENTS, "resultant, spread evenly"),
    e("boundary", "spring", COMPONENTS, "force per area and length"),
    e("boundary", "rigid_force", COMPONENTS, "the side moves as one in that direction, resultant given"),
    e("interface", "name", NAME, "default interface-0, ..."),
    e("interface", "slave", SIDES, "carries the multiplier"),
    e("interface", "master", SIDES, "what the slave is tied to"),
    e("interface", "between", WORDS, "\"all\" or a list of patches: every pair of touching sides, slave = the finer"),
    e("interface", "coupling", r##"{"$ref":"#/$defs/coupling","default":"mortar"}"##, "how the sides are tied"),
    e("interface", "multiplier", MULTIPLIER, "the multiplier space"),
    e("interface", "integration", INTEGRATION, "who makes the segments"),
    e("interface", "extra_points", EXTRA, "Gauss points per segment beyond max(p_slave, p_master) + 1"),
    e("interface", "tolerance", AUTO, "largest distance of the sides [length]"),
    e("interface", "exact", FIELD, "exact multiplier, for its error"),
    e("contact", "name", NAME, "default contact-0, ..."),
    e("contact", "slave", SIDES, "carries the multiplier"),
    e("contact", "master", SIDES, "what the slave faces; or rigid"),
    e("contact", "rigid", r##"{"$ref":"#/$defs/obstacle"}"##, "a rigid obstacle instead of a master"),
    e("contact", "gap", r##"{"$ref":"#/$defs/formula","default":"g"}"##, "formula of the geometric gap g and x, y, z, t"),
    e("contact", "method", r##"{"$ref":"#/$defs/method","default":"lagrange"}"##, "how contact is enforced"),
    e("contact", "multiplier", MULTIPLIER, "the multiplier space"),
    e("contact", "integration", INTEGRATION, "who makes the segments"),
    e("contact", "extra_points", EXTRA, "Gauss points per segment beyond max(p_slave, p_master) + 1"),
    e(
        "contact",
        "cone",
        r#"{"enum":["coefficients","weights","values"],"default":"coefficients"}"#,
        "the discrete cone of admissible multipliers",
    ),
    e("contact", "reach", AUTO, "farther points face nothing [length]"),
    e("contact", "exact", FORMULA, "exact multiplier, negative in compression, for its error"),
    e(
        "contact",
        "symmetry",
        r#"{"type":"boolean","default":false}"#,
        "a zone that ends at the end of the side goes on beyond it (half models)",
    ),
    e("contact", "active_set", r##"{"$ref":"#/$defs/active_set"}"##, "the iteration"),
    e(
        "active_set",
        "start",
        r#"{"anyOf":[{"enum":["auto","all","none","gap"]},{"type":"object","properties":{"seed":{"type":"integer","minimum":0}},"required":["seed"],"additionalProperties":false}],"default":"auto"}"#,
        "which rows are closed at first",
    ),
    e("active_set", "max_iterations", r#"{"type":"integer","minimum":1,"maximum":100000,"default":100}"#, "most linear systems"),
    e("active_set", "c", r##"{"$ref":"#/$defs/positive","default":1.0}"##, "weight of the gap against the multiplier"),
    e("multiplier", "degree", r#"{"type":"integer","minimum":0,"maximum":12}"#, "degree of the multiplier"),
    e(
        "multiplier",
        "continuity",
        r#"{"type":"integer","minimum":-1,"maximum":11}"#,
        "at the breakpoints, -1 is discontinuous; default degree - 1",
    ),
    e("multiplier", "ends", r#"{"enum":["auto","full","lowered"],"default":"auto"}"#, "degree in the end elements"),
    e("obstacle", "move", COMPONENTS, "prescribed motion, formulas of t"),
    e("obstacle", "force", COMPONENTS, "the force that drives it"),
    e("half-plane", "point", VECTOR, "a point of the plane"),
    e("half-plane", "normal", VECTOR, "out of the obstacle"),
    e("sphere", "center", VECTOR, "its centre"),
    e("sphere", "radius", POSITIVE, "its radius; a circle in 2D"),
    e("sphere", "inside", r#"{"type":"boolean","default":false}"#, "whether the body is inside"),
    e("cylinder", "center", VECTOR, "a point of the axis"),
    e("cylinder", "axis", VECTOR, "direction of the axis"),
    e("cylinder", "radius", POSITIVE, "its radius"),
    e("torus", "center", VECTOR, "its centre"),
    e("torus", "axis", VECTOR, "direction of the axis"),
    e("torus", "radius", PAIR, "radius of the circle and of the tube"),
    e("level-set", "f", FORMULA, "positive outside; the gap is the distance to f = 0"),
    e("level-set", "along", VECTOR, "with it the gap is f and the normal is this direction"),
    e("steps", "t", NUMBERS, "increasing times"),
    e("steps", "count", r#"{"type":"integer","minimum":1,"maximum":100000}"#, "equal steps up to t = 1"),
    e("solver", "constraint", r##"{"$ref":"#/$defs/constraint","default":"auto"}"##, "solver of the constrained systems"),
    e("solver", "linear", r#"{"enum":["auto","direct","iterative"],"default":"auto"}"#, "solver of the linear systems"),
    e("solver", "tolerance", POSITIVE, "error and residual at which iterations end, relative"),
    e("solver", "max_iterations", r#"{"type":"integer","minimum":1}"#, "of an iterative solver"),
    e("probe", "name", NAME, "default probe-0, ..."),
    e("probe", "quantity", TEXT, "such as u.y at [1.0, 0.5] in upper"),
    e("check", "name", NAME, "default check-0, ..."),
    e("check", "quantity", TEXT, "such as error.u.L2"),
    e("check", "below", FORMULA, "value < bound"),
    e("check", "above", FORMULA, "value > bound"),
    e("check", "equals", FORMULA, "|value - expected| <= atol + rtol |expected|"),
    e("check", "rtol", FORMULA, "relative tolerance of equals"),
    e("check", "atol", FORMULA, "absolute tolerance of equals"),
    e("check", "over", r#"{"const":"all"}"#, "holds both extremes of a field to the check"),
    e("check", "backend", BACKEND, "only there"),
    e("study", "levels", r#"{"type":"integer","minimum":1,"maximum":20}"#, "number of levels, each halves every element"),
    e(
        "study",
        "degrees",
        r##"{"anyOf":[{"$ref":"#/$defs/degree"},{"type":"array","items":{"$ref":"#/$defs/degree"}},{"type":"object","additionalProperties":{"type":"array","items":{"$ref":"#/$defs/degree"}}}]}"##,
        "degrees of all backends, or a table of them",
    ),
    e("study", "backends", WORDS, "backends, iga+fe for slave patches iga and all others fe"),
    e("study", "pairings", WORDS, "multipliers"),
    e("study", "integration", WORDS, "integrations of interfaces"),
    e(
        "study",
        "extra_points",
        r##"{"anyOf":[{"$ref":"#/$defs/extra_points"},{"type":"array","items":{"$ref":"#/$defs/extra_points"}}]}"##,
        "additional points of interfaces",
    ),
    e("study", "vary", WORDS, "KEY=v1,v2, or a list of them"),
    e("study", "quantities", WORDS, "probes or quantities"),
    e("study", "tol", POSITIVE, "largest relative difference from the first row"),
    e("study", "norm", r#"{"enum":["l2","h-half"]}"#, "norm of multipliers"),
    e("study", "ends", r#"{"enum":["case","zero","free"]}"#, "what holds at the ends of slave sides"),
];
