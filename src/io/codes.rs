//! The error codes of the program: what each means and with which code the program exits.

/// One error code.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Code {
    /// The code itself, `E012`.
    pub code: &'static str,
    /// What the program exits with when an error of this code ends it.
    pub exit: i32,
    /// The mistake in a few words.
    pub title: &'static str,
    /// What it means and what to do, a few sentences.
    pub text: &'static str,
}

const fn code(code: &'static str, exit: i32, title: &'static str, text: &'static str) -> Code {
    Code { code, exit, title, text }
}

/// Every code of the program, in order.
pub const CODES: &[Code] = &[
    code(
        "E001",
        3,
        "schema newer than the program",
        "The case file states a `schema` that this program does not know. Install a newer version of faying, or write the case for an older schema.",
    ),
    code(
        "E003",
        4,
        "file not found",
        "A file that was named cannot be read. Names in a case file are relative to the folder of the case file; names on the command line to the current folder. The message lists files with similar names in that folder.",
    ),
    code(
        "E005",
        3,
        "TOML syntax",
        "The case file is not valid TOML. The place is where the parser stopped; a quote or a bracket that is missing may stand on the line before.",
    ),
    code(
        "E012",
        3,
        "unknown key",
        "A key is not known at this place. The message names the nearest known key and lists all keys that may stand there.",
    ),
    code("E013", 3, "required key missing", "A block lacks a key that has no default. The place is the head of the block."),
    code(
        "E014",
        3,
        "wrong type",
        "A value has the wrong type: a text where a number is expected, one number where a list is expected. The message states what is allowed and what was found. Formulas are quoted, plain numbers and switches are not.",
    ),
    code(
        "E015",
        3,
        "value out of range, or key not for this kind",
        "A value is outside its range, is not one of the allowed words, or a key does not belong to the kind of block it stands in.",
    ),
    code(
        "E016",
        3,
        "duplicate or bad name",
        "Names consist of letters, digits, `_` and `-`, and are unique within their kind; interfaces and contacts share one set of names.",
    ),
    code(
        "E017",
        3,
        "formula",
        "A quoted formula cannot be read. The caret stands at the character where reading stopped. Formulas know + - * / ^, comparisons, if(c, a, b), the usual functions, pi, e, x, y, z, t, r, theta and the names of [let]. Data of sides and loads must be finite at every point where they are integrated.",
    ),
    code("E018", 3, "unknown quantity", "A quantity of a probe or a check is not known. The message names the nearest one."),
    code(
        "E019",
        3,
        "known, not in this version",
        "The key or value is part of the case file's language, but this version of the program does not build it.",
    ),
    code(
        "E021",
        3,
        "unknown patch or side",
        "A side is written PATCH.SIDE. Sides are u0, u1, v0, v1 (left, right, bottom, top), in 3D also w0, w1; the collapsed edge of a disc is no side.",
    ),
    code(
        "E022",
        3,
        "point outside every body",
        "A point of a probe or check lies outside of every body by more than a quarter of an element.",
    ),
    code(
        "E023",
        3,
        "sides do not meet",
        "Two sides that are to be tied are farther apart than `tolerance` allows. Use [[contact]] if a gap is meant.",
    ),
    code(
        "E024",
        3,
        "over-constrained",
        "There are more multipliers than free unknowns of the slave side: a cross point where several interfaces end, too few elements, or a `fix` or `dirichlet` on the slave side itself. Use more elements on the slave side, exchange slave and master, or choose a smaller multiplier space.",
    ),
    code(
        "E025",
        3,
        "slave partly covered",
        "A tied slave side must be covered by its masters to 1e-6 of its measure. Exchange slave and master, or list every master.",
    ),
    code(
        "E026",
        3,
        "side slave twice, or its own master",
        "A side carries one multiplier: it may be slave once. It cannot be its own master, and two sides are coupled by one block: not again with slave and master exchanged.",
    ),
    code("E031", 3, "knots decrease", "A knot vector must not decrease."),
    code(
        "E032",
        3,
        "knot repeated too often",
        "A knot may be repeated degree times inside and degree + 1 times at the ends; the ends must be repeated degree + 1 times (an open knot vector).",
    ),
    code(
        "E033",
        3,
        "counts disagree",
        "The number of control points must be the product of (knots - degree - 1) over the directions, with one weight each.",
    ),
    code("E034", 3, "weight not positive", "Weights of a NURBS patch must be positive and finite."),
    code(
        "E041",
        3,
        "inverted element",
        "The map of an element changes its orientation. The message names the patch, the element, the least Jacobian and where.",
    ),
    code("E042", 3, "mesh group missing", "The mesh has no group of this name; the message lists the groups."),
    code(
        "E043",
        3,
        "file unsupported or broken",
        "The kind or the version of a file is not supported, or the file is broken at the given line or byte.",
    ),
    code("E044", 3, "wrong dimension", "A point, a list or a mesh has another dimension than the model."),
    code(
        "E051",
        3,
        "no support",
        "A body can still move although every contact is closed. Fix it with [[boundary]], or tie it to something that is fixed. A body that loses contact while iterating ends with exit 5 instead.",
    ),
    code(
        "E052",
        3,
        "two conditions on one side and component",
        "Each component of a side has one kind of condition: prescribed once, or loaded. Both lines are named.",
    ),
    code(
        "E053",
        3,
        "material limits",
        "The material's constants leave the range in which the problem can be solved: -1 < poisson < 0.5, young > 0, conductivity > 0. Formulas are checked at the quadrature points.",
    ),
    code(
        "E054",
        3,
        "no material",
        "A patch has no material. With exactly one [[material]] it is taken, with several the patch must name one.",
    ),
    code("E061", 3, "unstable pair", "A warning: the multiplier space is not stable on this side; `faying infsup` shows it."),
    code("E062", 3, "needs `exact` or `reference`", "Errors and data marked \"exact\" need `exact` in [model] (or a reference)."),
    code("E063", 3, "study needs an interface", "This study looks at an interface or contact; the case has none."),
    code(
        "E064",
        3,
        "no such multiplier here",
        "The multiplier does not exist on this side: p/p-2 needs degree 2, dual needs positive lumped weights. The message names what exists.",
    ),
    code(
        "E071",
        5,
        "contact does not settle",
        "The active set visited the same state twice, or did not settle within active_set.max_iterations (default 30): raise it, \
         or begin nearer to the answer with active_set.start = \"gap\". After a cycle the message names the functions that flip \
         and where. The last state is saved.",
    ),
    code("E072", 5, "singular", "The system of equations is singular: a body can move, or a constraint is redundant."),
    code("E073", 5, "not finite", "A number became infinite or undefined while solving."),
    code("E074", 5, "iterative solver stopped", "The iterative solver did not reach its tolerance."),
    code(
        "E081",
        6,
        "limit",
        "The memory, time or size limit is reached. The message gives the predicted memory and unknowns, the limit, and the line to change.",
    ),
    code("E090", 4, "output folder exists", "The output folder holds files that faying did not write for this case. Use --force or --out."),
    code("E091", 4, "writing failed", "A result could not be written."),
];

/// The entry of a code, `None` if there is no such code.
pub fn find(code: &str) -> Option<&'static Code> {
    CODES.iter().find(|c| c.code.eq_ignore_ascii_case(code))
}
