//! The keys of every block, in the order in which the effective case shows them.

/// Top level.
pub(super) const ROOT: &[&str] = &[
    "schema",
    "title",
    "let",
    "model",
    "discretization",
    "material",
    "patch",
    "boundary",
    "interface",
    "contact",
    "steps",
    "solver",
    "probe",
    "check",
    "study",
];

/// Top-level keys that are lists of tables.
pub(super) const LISTS: &[&str] = &["material", "patch", "boundary", "interface", "contact", "probe", "check"];

pub(super) const MODEL: &[&str] = &["physics", "dimension", "assumption", "exact", "reference", "source", "body_force", "gravity"];

pub(super) const DISCRETIZATION: &[&str] = &["backend", "degree", "continuity", "basis", "cells", "mapping", "extra_points"];

pub(super) const MATERIAL: &[&str] = &["name", "young", "poisson", "lambda", "mu", "conductivity", "density"];

pub(super) const PATCH: &[&str] = &[
    "name",
    "geometry",
    "material",
    "elements",
    "refine",
    "grade",
    "backend",
    "degree",
    "continuity",
    "basis",
    "cells",
    "mapping",
    "extra_points",
    "source",
    "body_force",
    "gravity",
    "closed",
    "glue",
];

/// Keys of every geometry, applied in this order.
pub(super) const MOTIONS: &[&str] = &["extrude", "scale", "rotate_deg", "axis", "move"];

/// Kinds of geometry with their own keys.
pub(super) const GEOMETRIES: &[(&str, &[&str])] = &[
    ("box", &["min", "max"]),
    ("annulus-sector", &["center", "radius", "angle_deg"]),
    ("disc-sector", &["center", "radius", "angle_deg"]),
    ("plate-with-hole", &["radius", "half_width"]),
    ("sphere-octant", &["center", "radius"]),
    ("nurbs", &["degree", "knots", "points", "weights"]),
    ("file", &["file", "id", "group", "refinement"]),
];

pub(super) const GRADE: &[&str] = &["toward", "ratio"];

pub(super) const BOUNDARY: &[&str] =
    &["name", "on", "where", "fix", "dirichlet", "neumann", "traction", "pressure", "force", "spring", "rigid_force"];

pub(super) const INTERFACE: &[&str] =
    &["name", "slave", "master", "between", "coupling", "multiplier", "integration", "extra_points", "tolerance", "exact"];

pub(super) const CONTACT: &[&str] = &[
    "name",
    "slave",
    "master",
    "rigid",
    "gap",
    "method",
    "multiplier",
    "integration",
    "extra_points",
    "cone",
    "reach",
    "exact",
    "symmetry",
    "active_set",
];

/// Other names of a key.
pub(super) const ALIASES: &[(&str, &str)] =
    &[("nonmortar", "slave"), ("secondary", "slave"), ("mortar", "master"), ("primary", "master"), ("quantity", "quantities")];

/// Textbook symbols of a key.
pub(super) const SYMBOLS: &[(&str, &str)] = &[("E", "young"), ("nu", "poisson"), ("rho", "density")];

/// Keys of every obstacle.
pub(super) const OBSTACLE: &[&str] = &["move", "force"];

/// Kinds of obstacle that no patch has, with their own keys.
pub(super) const OBSTACLES: &[(&str, &[&str])] = &[
    ("half-plane", &["point", "normal"]),
    ("sphere", &["center", "radius", "inside"]),
    ("cylinder", &["center", "axis", "radius"]),
    ("torus", &["center", "axis", "radius"]),
    ("level-set", &["f", "along"]),
];

/// Keys that place an obstacle with the shape of a patch; `move` is its motion.
pub(super) const PLACING: &[&str] = &["scale", "rotate_deg", "axis"];

/// Kinds of geometry as obstacles: their own keys, and those of [`PLACING`].
pub(super) const OBSTACLE_GEOMETRIES: &[(&str, &[&str])] = &[
    ("box", &["min", "max", "scale", "rotate_deg", "axis"]),
    ("annulus-sector", &["center", "radius", "angle_deg", "scale", "rotate_deg", "axis"]),
    ("disc-sector", &["center", "radius", "angle_deg", "scale", "rotate_deg", "axis"]),
    ("plate-with-hole", &["radius", "half_width", "scale", "rotate_deg", "axis"]),
    ("sphere-octant", &["center", "radius", "scale", "rotate_deg", "axis"]),
    ("nurbs", &["degree", "knots", "points", "weights", "scale", "rotate_deg", "axis"]),
    ("file", &["file", "id", "group", "refinement", "scale", "rotate_deg", "axis"]),
];

/// A nurbs obstacle of one parameter.
pub(super) const NURBS_CURVE: &[&str] = &["degree", "knots", "points", "weights"];

pub(super) const MULTIPLIER: &[&str] = &["degree", "continuity", "ends"];

pub(super) const ACTIVE_SET: &[&str] = &["start", "max_iterations", "c"];

pub(super) const STEPS: &[&str] = &["t", "count"];

pub(super) const SOLVER: &[&str] = &["constraint", "linear", "tolerance", "max_iterations"];

pub(super) const PROBE: &[&str] = &["name", "quantity"];

pub(super) const CHECK: &[&str] = &["name", "quantity", "below", "above", "equals", "rtol", "atol", "over", "backend"];

pub(super) const STUDIES: &[&str] = &["compare", "convergence", "quadrature", "infsup", "sweep"];

pub(super) const STUDY: &[&str] =
    &["levels", "degrees", "backends", "pairings", "integration", "extra_points", "vary", "quantities", "tol", "norm", "ends"];

/// Keys that users may expect in any block and that are not implemented; those of single blocks are in `not_yet`.
pub(super) const LATER: &[&str] = &["friction", "axisymmetric", "dynamics", "thermal", "plasticity", "adhesion", "damping"];
