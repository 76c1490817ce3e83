//! The error codes of the program: what each means and with which code the program exits.

use faying_files::FileError;

/// One error code.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Code {
    /// The code itself, `E012`.
    pub code: &'static str,
    /// Exit code of the program when an error of this code ends it; 0 of warnings, which end nothing.
    pub exit: i32,
    /// The mistake in a few words.
    pub title: &'static str,
    /// Meaning, a few sentences.
    pub text: &'static str,
    /// Example lines that cause it.
    pub example: &'static str,
    /// Advice.
    pub remedy: &'static str,
}

const fn code(code: &'static str, exit: i32, title: &'static str, text: &'static str, example: &'static str, remedy: &'static str) -> Code {
    Code { code, exit, title, text, example, remedy }
}

/// Every code of the program, in order.
pub const CODES: &[Code] = &[
    code(
        "E001",
        3,
        "schema newer than the program",
        "The case file states a `schema` that this program does not know. Install a newer version of faying, or write the case for an older schema.",
        "schema = 2",
        "install a newer faying, or write the case for schema 1.",
    ),
    code(
        "E003",
        4,
        "file not found",
        "A file that was named cannot be read. Names in a case file are relative to the folder of the case file; names on the command line to the current folder. The message lists files with similar names in that folder.",
        "$ faying run hertzz.toml\nerror[E003]: there is no file hertzz.toml",
        "correct the name; `ls *.toml` shows the cases of this folder, `faying new --list` the samples.",
    ),
    code(
        "E005",
        3,
        "TOML syntax",
        "The case file is not valid TOML. The place is where the parser stopped; a quote or a bracket that is missing may stand on the line before.",
        "title = \"Hertz",
        "close the quote or bracket where the message points, or on the line before.",
    ),
    code(
        "E012",
        3,
        "unknown key",
        "A key is not known at this place. The message names the nearest known key and lists all keys that may stand there.",
        "[[material]]\nname = \"steel\"\nyougn = 210e3        # did you mean `young`?",
        "write the key that the message names, or take the line out.",
    ),
    code(
        "E013",
        3,
        "required key missing",
        "A block lacks a key that has no default. The place is the head of the block.",
        "[[material]]\nname = \"steel\"\nyoung = 210e3        # `poisson` is missing",
        "add the key; the message shows a line that fits.",
    ),
    code(
        "E014",
        3,
        "wrong type",
        "A value has the wrong type: a text where a number is expected, one number where a list is expected. The message states what is allowed and what was found. Formulas are quoted, plain numbers and switches are not.",
        "degree = \"2\"         # a text where a whole number is expected",
        "write what the message asks for: numbers without quotes, texts and formulas in quotes.",
    ),
    code(
        "E015",
        3,
        "value out of range, or key not for this kind",
        "A value is outside its range, or so large that its square overflows, is not one of the allowed words, or a key does not belong to the kind of block it stands in.",
        "degree = 40          # at most 12 (iga), 8 (fe), 4 (fe, simplex cells)",
        "choose a value from the range that the message states, or take a key out that belongs to another kind.",
    ),
    code(
        "E016",
        3,
        "duplicate or bad name",
        "Names consist of letters, digits, `_` and `-`, and are unique within their kind; interfaces and contacts share one set of names. \
         Or a list names a side twice, or tags of a mesh that have facets in common: loads and springs would act twice there.",
        "[[patch]]\nname = \"lower block\"  # a blank in a name",
        "use letters, digits, `_` and `-`, and each name once: name = \"lower-block\".",
    ),
    code(
        "E017",
        3,
        "formula",
        "A quoted formula cannot be read. The caret stands at the character where reading stopped. Formulas know + - * / ^, comparisons, if(c, a, b), sin cos tan asin acos atan atan2 sinh cosh tanh exp log (the natural one) sqrt abs min max pow sign, pi, e, x, y, z, t, r, theta and the names of [let]. Data of sides and loads must be finite at every point where they are integrated. \
         As a warning: an `exact` made of pieces whose flux jumps inside a body or across an interface. The source that follows from it is taken at points and \
         lacks the jump, so that the case solves for something else and errors do not fall. \
         Or a load, springs, prescribed values or a modulus jump inside of elements or have no bound, or `where` cuts facets: the rule of integration misses more than 1e-3 of the force, the moment, the value or the stiffness; both values are told. \
         Or the functions of a side miss more than 30 % of the values that are prescribed on it, in the mean.",
        "pressure = \"p*sin(x\"  # a bracket is missing",
        "correct the formula at the caret; define the names it uses in [let].",
    ),
    code(
        "E018",
        3,
        "unknown quantity",
        "A quantity of a probe or a check is not known. The message names the nearest one.",
        "[[probe]]\nquantity = \"contact.pad.presure.max\"",
        "write a quantity of the reference, such as u.y at [1, 0.5], stress.yy.max, reaction.PATCH.SIDE.y, contact.NAME.force.y; `faying explain stress.xx` tells what one is.",
    ),
    code(
        "E019",
        3,
        "known, not in this version",
        "The key, value or quantity is part of the case file's language, but this version of the program does not build it.",
        "[[contact]]\nfriction = 0.3",
        "take it out, or use what the message offers.",
    ),
    code(
        "E021",
        3,
        "unknown patch or side",
        "A side is written PATCH.SIDE. Sides are u0, u1, v0, v1 (left, right, bottom, top), in 3D also w0, w1; the collapsed edge of a disc is no side.",
        "slave = \"inner.v2\"     # sides of \"inner\" are u0, u1, v0, v1",
        "write PATCH.SIDE with a side that the message lists.",
    ),
    code(
        "E022",
        3,
        "point outside every body",
        "A point of a probe or check lies outside of every body by more than a quarter of an element.",
        "quantity = \"u.y at [1.0, 2.0] in upper\"   # upper ends at y = 1",
        "move the point into the body, or leave out `in PATCH`.",
    ),
    code(
        "E023",
        3,
        "sides do not meet",
        "Two sides that are to be tied are farther apart than `tolerance` allows, or the sides of a contact do not face each other: \
         outward normals must oppose, within 60 degrees, and an overlap at rest (of bodies, of a body and an obstacle, or by the formula of `gap`) may be up \
         to half the thickness of a body. `between` ties sides if faceting explains their gap: \
         mean at most 1/4, largest at most 2 times the deviation of the facets from the curved surface; of a side that another block joins in \
         part it ties the rest. As a warning: sides that are \
         nearly together are not tied, or named ones are tied across a distance that their facets do not explain; sides that touch, nearly touch or overlap are joined by nothing; \
         nodes of a mesh coincide and are not shared, so that the cells on both sides do not hang together. Use [[contact]] if a gap is meant.",
        "[[interface]]\nslave = \"inner.v1\"     # r = 1.5\nmaster = \"outer.v0\"    # r = 1.75",
        "correct the geometry, raise `tolerance` if the gap is meant to be closed, or use [[contact]] if it is to stay.",
    ),
    code(
        "E024",
        3,
        "over-constrained, or too few multipliers",
        "There are more multipliers than free unknowns of the slave side: a cross point where several interfaces end, too few elements, or a `fix` or `dirichlet` on the slave side itself. Use more elements on the slave side, exchange slave and master, or choose a smaller multiplier space. \
         Or there are too few to hold a body: the rows of the multiplier leave a rigid motion that its points would not (one constant per component lets a body turn about the middle of the side); the message names it. \
         Or a curved side with `fix = [\"normal\"]` or `[\"tangential\"]` has too few elements between ends that are held.",
        "elements = [1, 4]      # one element on the slave side, both of its ends fixed",
        "use more elements on the slave side; where there are too many multipliers exchange slave and master or choose a smaller one such as \"p/p-2\", where there are too few a larger one such as \"p/p\".",
    ),
    code(
        "E025",
        3,
        "slave partly covered",
        "A tied slave side must be covered by its masters, once, to 1e-6 of its measure. Exchange slave and master, list every master, and none \
         twice. Facets that stand for one curved surface may end beside each other by as much as they leave it: their tie is made, and a \
         warning tells the share that nothing ties.",
        "slave = \"long.top\"      # reaches farther than its master\nmaster = \"short.bottom\"",
        "exchange slave and master, or list every master: master = [\"a.bottom\", \"b.bottom\"].",
    ),
    code(
        "E026",
        3,
        "side slave twice, or its own master",
        "A side carries one multiplier: it may be slave once, and so may every facet of the tags of a mesh. It cannot be its own master, and two sides are coupled by one block: not again with slave and master exchanged.",
        "slave = \"a.top\", master = \"b.bottom\"     # and in a second block:\nslave = \"a.top\", master = \"c.bottom\"",
        "write one block with a list of masters.",
    ),
    code(
        "E031",
        3,
        "knots decrease",
        "A knot vector must not decrease.",
        "knots = [[0, 0, 0, 0.6, 0.5, 1, 1, 1], [0, 0, 1, 1]]",
        "sort the knots of the direction that the message names.",
    ),
    code(
        "E032",
        3,
        "knot repeated too often",
        "A knot may be repeated degree times inside and degree + 1 times at the ends; the ends must be repeated degree + 1 times (an open knot vector).",
        "degree = [2, 1]\nknots = [[0, 0, 1, 1], [0, 0, 1, 1]]       # the first direction needs 0 0 0 1 1 1",
        "repeat the ends degree + 1 times and inner knots at most degree times.",
    ),
    code(
        "E033",
        3,
        "counts disagree",
        "The number of control points must be the product of (knots - degree - 1) over the directions, with one weight each.",
        "degree = [1, 1]\nknots = [[0, 0, 1, 1], [0, 0, 1, 1]]       # 2 x 2 = 4 points\npoints = [[0, 0], [1, 0], [0, 1]]",
        "give one point and one weight per function, u running fastest.",
    ),
    code(
        "E034",
        3,
        "weight not positive",
        "Weights of a NURBS patch must be positive and finite.",
        "weights = [1, 0, 1, 1]",
        "write positive weights; 1 everywhere is a B-spline and needs no `weights`.",
    ),
    code(
        "E041",
        3,
        "inverted element",
        "The map of an element changes its orientation, or its corners do not follow each other around it. The message names the patch, the \
         element, the least Jacobian and where. Or \
         a body of revolution has points beyond its axis: assumption = \"axisymmetric\" takes x for the radius. As a \
         warning: cells with an aspect (longest edge over least height) beyond 1e8, whose stiffness loses its digits to rounding.",
        "points = [[0, 0], [1, 0], [1, 1], [0, 1]]    # the last two exchanged: the patch folds over",
        "put the points in order, u fastest; a weight or a point that is far off folds a patch, too.",
    ),
    code(
        "E042",
        3,
        "mesh group missing",
        "The mesh has no group of this name; the message lists the groups.",
        "geometry = { kind = \"file\", file = \"bracket.msh\", group = \"steal\" }",
        "write a group that the message lists.",
    ),
    code(
        "E043",
        3,
        "file unsupported or broken",
        "The kind or the version of a file is not supported, or the file is broken at the given line or byte.",
        "geometry = { kind = \"file\", file = \"part.step\" }",
        "convert the file to Gmsh 2.2 or 4.1, G+Smo XML, an MFEM mesh, VTU or an Abaqus input file; where it is broken, the message names the line or byte.",
    ),
    code(
        "E044",
        3,
        "wrong dimension",
        "A point, a list or a mesh has another dimension than the model.",
        "dimension = 2          # in [model]\nmin = [0, 0, 0]        # in a geometry",
        "give as many numbers as the model has dimensions.",
    ),
    code(
        "E051",
        3,
        "no support",
        "A body can still move although every contact is closed. Fix it with [[boundary]], or tie it to something that is fixed. A body that loses contact while iterating ends with exit 5 instead. \
         A part of a mesh that shares no node with the rest is named by its middle. As a warning: springs hold a motion of a body with less than 1e-5 of the body's own stiffness, and nothing else does.",
        "[[boundary]]\non = \"upper.top\"\npressure = 1.0         # and nothing holds \"upper\" sideways",
        "fix what the message names: fix = [\"x\"] on one side of the body.",
    ),
    code(
        "E052",
        3,
        "two conditions on one side and component",
        "Each component of a side has one kind of condition: prescribed once, or loaded. Loads along directions that are held act on supports alone. \
         Sides that slide or move as one must agree with what is prescribed where they meet it. A facet of a curved side that slides is held by nothing else: no other \
         component, tie or contact. Both lines are named. \
         As a warning: prescribed values of two tied bodies differ in their common corner, and the multiplier there has to carry the jump.",
        "[[boundary]]\non = \"a.left\"\nfix = [\"x\"]\n[[boundary]]\non = \"a.left\"\ntraction = { x = 1.0 }",
        "keep one of the two blocks.",
    ),
    code(
        "E053",
        3,
        "material limits",
        "The material's constants leave the range in which the problem can be solved: -1 < poisson < 0.5, young > 0, conductivity > 0. Formulas are checked at the quadrature points. \
         As a warning: a body of degree 1 with poisson above about 0.49 (but in plane stress) is too stiff, several times on coarse meshes: volumetric locking.",
        "poisson = 0.5          # plane strain: incompressible",
        "write a value within the limits, such as poisson = 0.499 (with degree 2 or more) or young = 1.0.",
    ),
    code(
        "E054",
        3,
        "no material",
        "A patch has no material. With exactly one [[material]] it is taken, with several the patch must name one.",
        "[[material]]           # two materials, and a patch that names none\nname = \"steel\"",
        "write material = \"steel\" in the patch.",
    ),
    code(
        "E061",
        0,
        "unstable pair",
        "A warning: the multiplier space is not stable on this side; `faying infsup` shows it. `constant` on a side of degree 1, and spaces \
         given as data, may be p/p-1 by another name; constants on maximally smooth splines of degree 3, 5, ... are p/p-3, p/p-5, ..., not stable either. \
         Or `dual` holds constants only: on splines of degree 3 and more its inf-sup constant is small and lambda converges with order 1.",
        "multiplier = \"p/p-1\"",
        "use \"p/p\", or from degree 2 on \"p/p-2\" (the default there).",
    ),
    code(
        "E062",
        3,
        "needs `exact` or `reference`",
        "Data marked \"exact\" need `exact` in [model]; errors need that or `reference`, a run that `faying run --save-reference` stored. A stored run knows lambda of the interfaces and contacts that have multipliers.",
        "[[check]]\nquantity = \"error.u.L2\"  # [model] has no `exact`",
        "add exact = { u = ... } or reference = \"fine.ref\" to [model], or ask for another quantity.",
    ),
    code(
        "E063",
        3,
        "study needs an interface",
        "This study looks at an interface or contact, or at its multiplier; the case has none.",
        "$ faying quadrature plate.toml       # one patch, nothing tied",
        "choose a case with [[interface]] or [[contact]].",
    ),
    code(
        "E064",
        3,
        "no such multiplier here",
        "The multiplier does not exist on this side: p/p-2 needs degree 2, dual needs positive lumped weights (triangles of degree 2 have none at vertices), and in \
         contact smooth splines of degree 3 and more, and surfaces, have no dual functions where the master ends within an element. The message names what exists.",
        "degree = 1\nmultiplier = \"p/p-2\"",
        "raise the degree of the slave, or use multiplier = \"auto\".",
    ),
    code(
        "E065",
        0,
        "inexact integration",
        "A warning: the quadrature error at this interface is above 1 % \
         (interface.NAME.consistency, contact.NAME.consistency). Slave points do not see the kinks of the master's functions; mixed integration does \
         not see those of a multiplier of low degree. Of a patch: on coarse cells of a rational map the Gauss points miss more than 1e-3 of the stress of \
         linear fields; the message says how many extra_points do not. Of a contact: it slides so far along a curved surface that the gap along the \
         normal at rest is wrong by more than a tenth of what is closed; small kinematics do not see the curve. Or fewer than four functions (in space across it in either direction in which it ends, in half models three to five by the degree, from an axis of revolution on four to eleven) carry a zone that \
         ends inside of its side, or the pieces between surfaces are known to lose a part of elements that face each other. Or its cone holds no pressure at all points (`weights`, `values`), and at some it pulls with more than a fifth of the largest. Of an interface: its sides are apart, and the forces on both lose a moment about the gap. Or its multiplier runs round an edge of the slave side, where tractions jump, or sees gaps between facets that alternate. Or springs alone take what the forces of mixed integration lack in balance. Or they come apart between the functions of a multiplier that is too coarse by more than 2 % of the displacement. Of a penalty: bodies sink by more than a hundredth of their size or a tenth of their displacement. \
         Of Nitsche's method in contact: pressures at points are off the stress of the bodies by more than 0.15 of the largest, by the factor times a small gap. \
         Of a patch: more than a hundredth of it has strains or rotations beyond 0.1, which small kinematics do not allow. \
         Of a run: its condition number times the rounding of numbers is not small.",
        "integration = \"mixed\"\nmultiplier = \"p/p-2\"",
        "do what the help of the message says: integration = \"merged\" (the default), extra_points, smaller elements, a stiffer factor.",
    ),
    code(
        "E071",
        5,
        "contact does not settle",
        "The active set did not settle within active_set.max_iterations (default 100): raise it, or begin from another \
         active_set.start. A state that comes back is a cycle: it is counted (solve.active_set.cycles) and left by single \
         exchanges; where these come to no end either, the message names the iterations, the functions that flip and where. The state \
         that violates the contact conditions least is saved; solve.active_set.best says which iteration it is from.",
        "active_set = { max_iterations = 3 }",
        "raise max_iterations, begin with start = \"all\", or refine the slave side.",
    ),
    code(
        "E072",
        5,
        "singular",
        "The system of equations is singular or has negative energy: a body can move, a constraint is redundant, or the factor of a \
         coupling or contact is too small or too large. With contact three outcomes are told apart. \"infeasible load\": contact presses and never pulls, and \
         no pressure balances the loads on a body that nothing else holds; the message names the motion and the force that is missing. \
         \"rigid motion left\": the loads could be balanced, but the contact that holds the body has opened and its place is not determined. \
         \"infeasible contact\": prescribed values hold a part of the slave side within what it faces, where no pressure moves it.",
        "[[interface]]          # the same pair of sides tied a second time, exchanged",
        "fix the body that can move, or take out the constraint that says a thing twice.",
    ),
    code(
        "E073",
        5,
        "not finite",
        "A number became infinite or undefined while solving.",
        "young = \"1/x\"          # and an element reaches x = 0",
        "look for a formula that divides by zero or overflows where the body is.",
    ),
    code(
        "E074",
        5,
        "iterative solver stopped",
        "The iterative solver did not reach its tolerance.",
        "[solver]\nlinear = \"iterative\"\nmax_iterations = 10",
        "raise max_iterations or tolerance, or use linear = \"direct\".",
    ),
    code(
        "E081",
        6,
        "limit",
        "The memory, time or size limit is reached. The message gives the predicted memory and unknowns, the limit, and the line to change.",
        "$ faying run fine.toml --max-memory 500MB",
        "raise the limit, or use fewer elements or a lower degree at the line that the message names.",
    ),
    code(
        "E090",
        4,
        "output folder exists",
        "The output folder holds files that faying did not write for this case. Use --force or --out.",
        "$ faying run a.toml --out results      # `results` holds files of another case",
        "give another folder with --out, or --force to write beside what is there.",
    ),
    code(
        "E091",
        4,
        "writing failed",
        "A result could not be written: the disk is full, the folder may not be written to, or something stands in the way.",
        "$ faying run a.toml --out /            # no permission",
        "make room or permissions, or give another folder with --out.",
    ),
];

/// The entry of a code, `None` if there is no such code.
pub fn find(code: &str) -> Option<&'static Code> {
    CODES.iter().find(|c| c.code.eq_ignore_ascii_case(code))
}

/// Code of an error in a geometry or mesh file.
pub fn of_file(error: &FileError) -> &'static str {
    match error {
        FileError::Dimension { .. } => "E044",
        FileError::Twisted { .. } => "E041",
        FileError::Missing { .. } => "E042",
        FileError::Memory { .. } => "E081",
        FileError::System { missing: true, .. } => "E003",
        FileError::System { .. } => "E091",
        _ => "E043",
    }
}
