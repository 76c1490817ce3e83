//! `[steps]`, `[solver]`, `[[probe]]`, `[[check]]`, `[study.COMMAND]`.

use super::common::{later, name, word};
use crate::case::key::{Key, KeyKind, Only, Plain, Special, Uses};
use crate::case::names::EntryFamily;

pub(in crate::case) const STEPS: &[Key] = &[
    Key::of("t", Special::Numbers, "increasing times").optional("[0.5, 1.0]"),
    Key::new("count", KeyKind::Whole(1, 100_000), "number of equal steps up to t = 1").optional("4"),
    later("smallest", Plain::Never, "1e-3", "steps of linear elasticity are never halved: leave it out"),
];

/// Constraint solvers that iterate by themselves.
const ITERATING: &[&str] = &["auto", "saddle-point", "condensed"];
const ITERATES: Only = Only {
    holds: |t, _| word(t, "linear") == Some("iterative") || !ITERATING.contains(&word(t, "constraint").unwrap_or("auto")),
    of: "linear = \"iterative\"",
    instead: "leave it out, or take constraint = \"schur\" or \"uzawa\", which iterate",
};

pub(in crate::case) const SOLVER: &[Key] = &[
    Key::of("constraint", Special::Entry(EntryFamily::Constraints), "solver of the constrained systems").default("\"auto\""),
    Key::new("linear", KeyKind::Word(&["auto", "direct", "iterative"]), "solver of the linear systems").default("\"auto\""),
    Key::new("tolerance", KeyKind::Positive, "error and residual at which iterations end, relative").default("1e-10").only(ITERATES),
    Key::new("max_iterations", KeyKind::Whole(1, 10_000_000), "largest number of iterations of an iterative solver")
        .optional("1000")
        .only(ITERATES),
    later("newton", Plain::Never, "{}", "small kinematics needs no Newton iteration: leave it out"),
    later(
        "preconditioner",
        Plain::Words(&["auto"], &["fast-diagonal", "multigrid", "aggregation", "gauss-seidel"]),
        "\"auto\"",
        "write preconditioner = \"auto\"",
    ),
    later("operator", Plain::Words(&["auto", "matrix"], &["matrix-free"]), "\"matrix\"", "write operator = \"matrix\""),
    later("precision", Plain::Words(&["double"], &["mixed"]), "\"double\"", "everything is in double precision here: leave it out"),
];

pub(in crate::case) const PROBE: &[Key] = &[
    name(),
    quantity(),
    Key::of("t", ASKED_STEPS, "its step, by default the last; `steps` of result.json and history.csv hold every probe at every step")
        .optional("0.5"),
];

const ASKED_STEPS: Special = Special::Only("a time of [steps], or \"all\"", r#"{"anyOf":[{"type":"number"},{"const":"all"}]}"#);

pub(in crate::case) const LINE: &[Key] = &[
    name(),
    Key::of("quantity", Special::Words, "a field, or a list of them").required("\"stress.yy\"").aliases(&["quantities"]),
    Key::new("from", KeyKind::Vector, "the point at which it begins").unit("length").required("[0, 0]"),
    Key::new("to", KeyKind::Vector, "the point at which it ends").unit("length").required("[0, 1]"),
    Key::new("n", KeyKind::Whole(2, 100_000), "number of points, both ends included").default("101"),
    Key::of("t", ASKED_STEPS, "its step, by default the last; all: every step, beside each other").optional("0.5"),
];

const fn quantity() -> Key {
    Key::new("quantity", KeyKind::Text, "a quantity").required("\"u.y at [1.0, 0.5]\"")
}

const EQUALS: Only = Only { holds: |t, _| t.get("equals").is_some(), of: "checks by `equals`", instead: "" };
const BOUND: Special = Special::FormulaOf(Uses::Check);

pub(in crate::case) const CHECK: &[Key] = &[
    name(),
    quantity(),
    Key::of("below", BOUND, "the value is below this").optional("1e-2"),
    Key::of("above", BOUND, "the value is above this").optional("0"),
    Key::of("equals", BOUND, "|value - expected| <= atol + rtol |expected|").optional("1.0"),
    Key::of("rtol", BOUND, "relative tolerance of equals").optional("1e-6").only(EQUALS),
    Key::of("atol", BOUND, "absolute tolerance of equals").optional("1e-12").only(EQUALS),
    Key::new("over", KeyKind::Word(&["all"]), "check minimum and maximum of the field").optional("\"all\""),
    Key::of("backend", Special::Entry(EntryFamily::Backends), "evaluate only if all patches use this backend").optional("\"iga\""),
    Key::of("t", ASKED_STEPS, "the step at which it has to hold, by default the last; all: every step").optional("0.5"),
];

/// Commands with a table of their own.
pub(in crate::case) const STUDIES: &[&str] = &["compare", "convergence", "quadrature", "infsup", "sweep"];

const DEGREES: Special = Special::Only(
    "degrees, or a table of a list per backend",
    r##"{"anyOf":[{"$ref":"#/$defs/degree"},{"type":"array","items":{"$ref":"#/$defs/degree"}},{"type":"object","additionalProperties":{"type":"array","items":{"$ref":"#/$defs/degree"}}}]}"##,
);
const COUNTS: Special = Special::Only(
    "a whole number from 0 to 60, or a list of them",
    r##"{"anyOf":[{"$ref":"#/$defs/extra_points"},{"type":"array","items":{"$ref":"#/$defs/extra_points"}}]}"##,
);

pub(in crate::case) const STUDY: &[Key] = &[
    Key::new("levels", KeyKind::Whole(1, 20), "number of levels, each halves every element").optional("4"),
    Key::of("degrees", DEGREES, "degrees of all backends, or a table of them").optional("[1, 2, 3]"),
    Key::of("backends", Special::Words, "backends; iga+fe: iga on slave patches, fe elsewhere").optional("[\"iga\", \"fe\"]"),
    Key::of("pairings", Special::Words, "multipliers").optional("[\"p/p\", \"p/p-2\"]"),
    Key::of("integration", Special::Words, "integrations of interfaces").optional("[\"merged\", \"slave\"]"),
    Key::of("extra_points", COUNTS, "additional points of interfaces").optional("[0, 1, 2]"),
    Key::of("vary", Special::Words, "KEY=v1,v2, or a list of them").optional("\"let.F=1,2\""),
    Key::of("quantities", Special::Words, "probes or quantities").optional("[\"energy\"]").aliases(&["quantity"]),
    Key::new("tol", KeyKind::Positive, "largest relative difference from the first row").optional("1e-8"),
    Key::new("norm", KeyKind::Word(&["l2", "h-half"]), "norm of multipliers; h-half: h^-1/2 |w| and h^1/2 |mu|").optional("\"l2\""),
    Key::new("ends", KeyKind::Word(&["case", "zero", "free"]), "conditions at the ends of slave sides").optional("\"case\""),
];
