//! Whole runs through the library: sample cases, quantities, errors of the build, repeatability.

use faying_cli::Case;
use faying_cli::case::{ReadOptions, Start};
use faying_cli::errors::Diagnostics;
use faying_cli::{Progress, Registry, RunControl, RunResult, Status};

fn read(text: &str) -> Result<Case, Diagnostics> {
    Case::parse("case.toml", text, &ReadOptions::default())
}

fn run(text: &str) -> RunResult {
    let case = read(text).unwrap_or_else(|e| panic!("{e}"));
    case.run(&Registry::default()).unwrap_or_else(|e| panic!("{e}"))
}

fn show(result: &RunResult) -> String {
    let mut out = format!("status {:?}\n", result.status);
    for c in &result.checks {
        out += &format!("{} {}: {:e} {} {:e} -> {} {:?}\n", c.name, c.quantity, c.value, c.relation, c.expected, c.ok, c.reason);
    }
    out + &format!("{:?}\n", result.diagnostics)
}

#[test]
fn sample_cases_pass_their_checks_as_written_and_with_each_backend() {
    for name in ["poisson-arc", "contact-patch", "hertz", "iga-fe-arc"] {
        for backend in [None, Some("iga"), Some("fe")] {
            let options = ReadOptions { backend: backend.map(str::to_owned), ..ReadOptions::default() };
            let path = format!("{}/examples/cases/{name}.toml", concat!(env!("CARGO_MANIFEST_DIR"), "/../.."));
            let case = Case::read_with(path, &options).unwrap_or_else(|e| panic!("{name}: {e}"));
            let result = case.run(&Registry::default()).unwrap_or_else(|e| panic!("{name}: {e}"));

            assert_eq!(result.status, Status::Ok, "{name} {backend:?}: {}", show(&result));
        }
    }
}

/// A unit square of elasticity, clamped below, with `rest` appended.
fn square(rest: &str) -> String {
    format!(
        "[model]\nphysics = \"elasticity\"\ndimension = 2\n[[material]]\nname = \"m\"\nyoung = 1.0\npoisson = 0.3\n\
         [[patch]]\nname = \"a\"\ngeometry = {{ kind = \"box\", min = [0, 0], max = [1, 1] }}\nelements = [3, 2]\n\
         [[boundary]]\non = \"a.bottom\"\nfix = [\"x\", \"y\"]\n{rest}"
    )
}

/// Two unit squares of elasticity above each other, the lower one clamped below.
fn pair(upper: &str, rest: &str) -> String {
    square(&format!("[[patch]]\nname = \"b\"\ngeometry = {{ kind = \"box\", {upper} }}\nelements = [4, 2]\n{rest}"))
}

/// The errors of a case, found while reading or building.
fn faults(text: &str) -> Diagnostics {
    match read(text) {
        Err(found) => found,
        Ok(case) => case.run(&Registry::default()).expect_err("the case is wrong"),
    }
}

/// What is missing where the case should have an error of this code with a place, whose text holds `part`.
fn refuses(text: &str, code: &str, part: &str) -> Option<String> {
    let found = faults(text);
    match found.items.iter().find(|d| d.code == code && d.render().contains(part)) {
        None => Some(format!("no {code} with `{part}` in\n{found}")),
        Some(d) if d.line.is_none() => Some(format!("{code} has no place: {found}")),
        Some(_) => None,
    }
}

fn close(found: f64, expected: f64, tolerance: f64, what: &str) {
    assert!((found - expected).abs() <= tolerance * expected.abs().max(1.0), "{what}: {found:e}, expected {expected:e}");
}

fn number(result: &RunResult, path: &[&str]) -> f64 {
    let value = result.to_value();
    let mut at = &value;
    for key in path {
        at = match key.parse::<usize>() {
            Ok(k) => &at[k],
            Err(_) => &at[*key],
        };
    }
    at.as_f64().unwrap_or_else(|| panic!("{path:?} is {at}"))
}

/// The values of the probes by name.
fn probe(result: &RunResult, name: &str) -> f64 {
    result.probes.iter().find(|p| p.name == name).unwrap_or_else(|| panic!("probe {name}")).value
}

#[test]
fn polynomial_manufactured_solutions_are_met_to_rounding() {
    // both fields are polynomials of degree 3 on a box: in the space of p = 3; constants of the material vary
    for backend in ["iga", "fe"] {
        for (model, material) in [
            ("physics = \"poisson\"\nexact = { u = \"x^3 - 2*x*y^2 + y\" }", "conductivity = \"1 + x*y\""),
            ("physics = \"elasticity\"\nexact = { u = [\"x^3 - y^2\", \"x*y^2 + 1\"] }", "young = \"2 + x*y\"\npoisson = 0.3"),
            (
                "physics = \"elasticity\"\nassumption = \"plane-stress\"\nexact = { u = [\"x^3 - y^2\", \"x*y^2 + 1\"] }",
                "lambda = \"2 + x\"\nmu = \"1 + y\"",
            ),
        ] {
            let text = format!(
                "[model]\ndimension = 2\n{model}\n[discretization]\nbackend = \"{backend}\"\ndegree = 3\nextra_points = 2\n\
                 [[material]]\nname = \"m\"\n{material}\n\
                 [[patch]]\nname = \"a\"\ngeometry = {{ kind = \"box\", min = [0, 0], max = [1, 2] }}\nelements = [2, 3]\n\
                 [[boundary]]\non = [\"a.left\", \"a.top\"]\ndirichlet = \"exact\"\n[[boundary]]\non = [\"a.right\", \"a.bottom\"]\nneumann = \"exact\"\n"
            );
            let result = run(&text);
            for norm in ["error.u.L2", "error.u.H1", "error.u.energy"] {
                let error = *result.errors.get(norm).unwrap();
                assert!(error < 1e-11, "{backend} {norm} = {error:e}\n{text}");
            }
        }
    }
}

#[test]
fn quantities_of_a_homogeneous_state_have_their_known_values() {
    // uniaxial tension q = 2 along y, plane stress, E = 4, nu = 0.25: eps_y = q/E, eps_x = -nu q/E
    let text = "[let]\nq = 2.0\nE = 4.0\n[model]\nphysics = \"elasticity\"\ndimension = 2\nassumption = \"plane-stress\"\n\
        [[material]]\nname = \"m\"\nyoung = \"E\"\npoisson = 0.25\n\
        [[patch]]\nname = \"a\"\ngeometry = { kind = \"box\", min = [0, 0], max = [3, 2] }\nelements = [3, 2]\n\
        [[boundary]]\non = \"a.left\"\nfix = [\"x\"]\n[[boundary]]\non = \"a.bottom\"\nfix = [\"y\"]\n[[boundary]]\non = \"a.top\"\ntraction = { y = \"q\" }\n\
        [[probe]]\nname = \"tip\"\nquantity = \"u.y at [3, 2]\"\n\
        [[probe]]\nname = \"tip-in\"\nquantity = \"displacement.y at [q + 1, 2] in a\"\n\
        [[probe]]\nname = \"edge\"\nquantity = \"stress.yy at [1, 1]\"\n\
        [[probe]]\nname = \"zz\"\nquantity = \"stress.zz at [1, 1]\"\n\
        [[probe]]\nname = \"mises\"\nquantity = \"von_mises.max\"\n\
        [[probe]]\nname = \"least\"\nquantity = \"u.x.min in a\"\n\
        [[probe]]\nname = \"energy\"\nquantity = \"energy\"\n\
        [[probe]]\nname = \"support\"\nquantity = \"reaction.a.v0.y\"\n\
        [[probe]]\nname = \"support-path\"\nquantity = \"reactions.a.bottom.1\"\n\
        [[probe]]\nname = \"area\"\nquantity = \"area.a\"\n\
        [[probe]]\nname = \"length\"\nquantity = \"length.a.top\"\n\
        [[probe]]\nname = \"all\"\nquantity = \"unknowns\"\n\
        [[probe]]\nname = \"path\"\nquantity = \"unknowns.primal\"\n\
        [[check]]\nname = \"stress\"\nquantity = \"stress.yy\"\nover = \"all\"\nequals = \"q\"\nrtol = 1e-11\n\
        [[check]]\nname = \"formula\"\nquantity = \"energy\"\nequals = \"-0.5*reaction.a.bottom.y*u.y at [0, 2]\"\nrtol = 1e-11\n\
        [[check]]\nname = \"of-probe\"\nquantity = \"probes.tip.value\"\nequals = \"probes.tip-in.value + 0*probes.0.value\"\nrtol = 1e-11\n\
        [[check]]\nname = \"rate\"\nquantity = \"rate.error.u.L2\"\nabove = 2\n\
        [[check]]\nname = \"elsewhere\"\nquantity = \"energy\"\nabove = 1e9\nbackend = \"fe\"\n\
        [[check]]\nname = \"wrong\"\nquantity = \"stress.yy.max\"\nbelow = 1.0\n";
    let result = run(text);
    let tight = 1e-12;
    close(probe(&result, "tip"), 2.0 * 2.0 / 4.0, tight, "u.y = q L / E");
    close(probe(&result, "tip-in"), 1.0, tight, "the same in the patch");
    close(probe(&result, "edge"), 2.0, tight, "stress on a common edge of elements");
    close(probe(&result, "zz"), 0.0, tight, "plane stress");
    close(probe(&result, "mises"), 2.0, tight, "uniaxial");
    close(probe(&result, "least"), -0.375, tight, "u.x = -nu q/E * 3 on the right side");
    close(probe(&result, "energy"), 0.5 * 2.0 * 2.0 / 4.0 * 6.0, tight, "q^2/(2E) area");
    close(probe(&result, "support"), -6.0, tight, "reaction by alias");
    close(probe(&result, "support-path"), -6.0, tight, "reaction by path");
    close(probe(&result, "area"), 6.0, tight, "area");
    close(probe(&result, "length"), 3.0, tight, "length");
    // 5 x 4 functions of degree 2, two components
    assert_eq!(probe(&result, "all"), 40.0);
    assert_eq!(probe(&result, "path"), 40.0);
    let ok: Vec<bool> = result.checks.iter().map(|c| c.ok).collect();
    let skipped: Vec<bool> = result.checks.iter().map(|c| c.skipped).collect();
    // nothing decides a rate in a run
    assert_eq!(ok, [true, true, true, false, true, false], "{}", show(&result));
    assert_eq!(skipped, [false, false, false, false, true, false]);
    assert!(result.checks[3].reason.as_ref().is_some_and(|r| r.contains("faying convergence")), "{:?}", result.checks[3]);
    assert_eq!((result.status, result.exit), (Status::CheckFailed, 1));
    assert_eq!((result.checks_expected, result.checks_performed, result.checks_skipped), (6, 5, 1));
    for k in ["0", "1"] {
        close(number(&result, &["balance", "force", k]), 0.0, 1e-13, "balance of forces");
    }
    close(number(&result, &["balance", "moment"]), 0.0, 1e-12, "balance of moments");
}

#[test]
fn springs_resultants_gravity_and_sliding_sides_carry_their_share() {
    let plate = |shape: &str, material: &str, rest: &str| {
        format!(
            "[model]\nphysics = \"elasticity\"\ndimension = 2\nGRAVITY\n[[material]]\nname = \"m\"\n{material}\n\
             [[patch]]\nname = \"a\"\ngeometry = {{ kind = \"box\", {shape} }}\nelements = [2, 2]\n{rest}"
        )
    };
    // a rigid plate on springs sinks by force over stiffness
    let springs = plate(
        "min = [0, 0], max = [2, 1]",
        "young = 1e6\npoisson = 0.0",
        "[[boundary]]\non = \"a.left\"\nfix = [\"x\"]\n[[boundary]]\non = \"a.bottom\"\nspring = { y = 5.0 }\n[[boundary]]\non = \"a.top\"\nforce = { y = -3.0 }\n\
         [[probe]]\nname = \"sink\"\nquantity = \"u.y at [1, 0]\"\n",
    );
    let result = run(&springs.replace("GRAVITY", ""));
    close(probe(&result, "sink"), -3.0 / (5.0 * 2.0), 1e-9, "force over spring stiffness");
    // the stiffness of a rigid motion is round-off of young times sink, one for each of the 16 functions
    let round_off = 16.0 * f64::EPSILON * 1e6 * 0.3;
    close(number(&result, &["balance", "force", "1"]), 0.0, round_off, "springs balance the force");
    // the same under its own weight: density 2 times 9 times area 2
    let result = run(&springs.replace("GRAVITY", "gravity = [0, -9]").replace("young", "density = 2.0\nyoung"));
    close(probe(&result, "sink"), -(3.0 + 36.0) / 10.0, 1e-6, "force and weight over spring stiffness");
    // gravity of the patch adds to it
    let own = springs.replace("GRAVITY", "gravity = [0, -5]").replace("young", "density = 2.0\nyoung");
    let result = run(&own.replace("elements", "gravity = [0, -4]\nelements"));
    close(probe(&result, "sink"), -(3.0 + 36.0) / 10.0, 1e-6, "gravity of model and patch");
    // inclined rollers at 45 degrees, pressure on the third side: one stress everywhere, sqrt(1 - nu + nu^2) in plane strain
    let inclined = plate(
        "min = [0, 0], max = [1, 1], rotate_deg = 45",
        "young = 1.0\npoisson = 0.3",
        "[[boundary]]\non = [\"a.bottom\", \"a.left\"]\nfix = [\"normal\"]\n[[boundary]]\non = \"a.top\"\npressure = 1.0\n\
         [[probe]]\nname = \"high\"\nquantity = \"von_mises.max\"\n[[probe]]\nname = \"low\"\nquantity = \"von_mises.min\"\n\
         [[probe]]\nname = \"x\"\nquantity = \"reaction.a.bottom.x\"\n[[probe]]\nname = \"y\"\nquantity = \"reaction.a.bottom.y\"\n",
    );
    let result = run(&inclined.replace("GRAVITY", ""));
    for name in ["high", "low"] {
        close(probe(&result, name), (1.0_f64 - 0.3 + 0.09).sqrt(), 1e-11, "one stress everywhere");
    }
    // the bottom's normal is (1, -1)/sqrt 2: it pushes back along (-1, 1)/sqrt 2 with force 1; corners are shared with the left side
    close(number(&result, &["balance", "force", "0"]), 0.0, 1e-12, "balance");
    close(number(&result, &["balance", "force", "1"]), 0.0, 1e-12, "balance");
    // a side that moves as one: uniform u_y on top of a plate that is pulled up, resultant given
    let rigid = plate(
        "min = [0, 0], max = [1, 1]",
        "young = 1.0\npoisson = 0.3",
        "[[boundary]]\non = \"a.bottom\"\nfix = [\"x\", \"y\"]\n[[boundary]]\non = \"a.top\"\nrigid_force = { y = 0.5 }\n\
         [[probe]]\nname = \"l\"\nquantity = \"u.y at [0, 1]\"\n[[probe]]\nname = \"m\"\nquantity = \"u.y at [0.4, 1]\"\n\
         [[probe]]\nname = \"up\"\nquantity = \"reaction.a.bottom.y\"\n",
    );
    let result = run(&rigid.replace("GRAVITY", ""));
    close(probe(&result, "l"), probe(&result, "m"), 1e-13, "the side moves as one");
    close(probe(&result, "up"), -0.5, 1e-12, "the resultant");
}

#[test]
fn set_changes_the_case_and_ends_with_another_result() {
    let text = square(
        "[[boundary]]\non = \"a.top\"\npressure = \"p\"\n[let]\np = 1.0\n[[probe]]\nname = \"top\"\nquantity = \"u.y at [0.5, 1]\"\n",
    );
    let with = |sets: &[&str]| {
        let options = ReadOptions { sets: sets.iter().map(|s| (*s).to_string()).collect(), ..ReadOptions::default() };
        Case::parse("case.toml", &text, &options).unwrap().run(&Registry::default()).unwrap()
    };
    let (one, two, fine) = (with(&[]), with(&["let.p=2.0"]), with(&["patch.a.elements=[6, 4]", "patch.a.degree=3"]));
    close(probe(&two, "top"), 2.0 * probe(&one, "top"), 1e-12, "twice the pressure");
    assert!(fine.unknowns.primal > one.unknowns.primal);
}

#[test]
fn results_do_not_depend_on_the_number_of_threads() {
    let text = pair(
        "min = [0, 1], max = [1, 2]",
        "[[boundary]]\non = \"b.top\"\npressure = \"1 + x\"\n[[boundary]]\non = [\"b.left\"]\nfix = [\"x\"]\n\
         [[contact]]\nname = \"c\"\nslave = \"b.bottom\"\nmaster = \"a.top\"\n",
    );
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| run(&text).to_json())
    };
    assert_eq!(with(1), with(2));
}

#[test]
fn all_constraint_solvers_give_the_same_numbers_and_count_their_iterations() {
    let text = pair(
        "min = [0, 1], max = [1, 2]",
        "[[boundary]]\non = \"b.top\"\ntraction = [\"0.3*x\", \"x - 2\"]\n[[interface]]\nname = \"i\"\nslave = \"b.bottom\"\nmaster = \"a.top\"\n\
         [[probe]]\nname = \"u\"\nquantity = \"u.x at [0.7, 1.5]\"\n[[probe]]\nname = \"l\"\nquantity = \"interface.i.lambda.y at [0.4, 1]\"\n[solver]\nWHICH\n",
    );
    let a = run(&text.replace("WHICH", "constraint = \"saddle-point\""));
    let i = a.interface.get("i").unwrap();
    assert!(i.balance < 1e-12, "action and reaction: {:e}", i.balance);
    assert!(i.consistency < 1e-12, "merged integration of splines on a line: {:e}", i.consistency);
    close(i.segments.measure, 1.0, 1e-12, "the interface's length");
    assert_eq!(a.solve.as_ref().unwrap().iterations, 0);
    let words = [
        "constraint = \"condensed\"",
        "constraint = \"schur\"",
        "constraint = \"uzawa\"\ntolerance = 1e-12",
        "linear = \"iterative\"",
        "constraint = \"condensed\"\nlinear = \"iterative\"",
        "constraint = \"uzawa\"\nlinear = \"iterative\"\ntolerance = 1e-12",
    ];
    let mut methods = vec![a.solve.as_ref().unwrap().linear.clone()];
    for which in words {
        let b = run(&text.replace("WHICH", which));
        assert_eq!(b.status, Status::Ok, "{which}: {}", show(&b));
        close(probe(&a, "u"), probe(&b, "u"), 1e-9, "displacement");
        close(probe(&a, "l"), probe(&b, "l"), 1e-9, "multiplier");
        let solve = b.solve.as_ref().unwrap();
        assert_eq!(solve.iterations > 0, which != words[0], "{which}: {} iterations", solve.iterations);
        assert!(!methods.contains(&solve.linear), "{}", solve.linear);
        methods.push(solve.linear.clone());
    }
}

#[test]
fn an_iterative_solver_that_does_not_reach_its_tolerance_ends_with_e074() {
    let text = pair(
        "min = [0, 1], max = [1, 2]",
        "[[boundary]]\non = \"b.top\"\npressure = 1.0\n[[interface]]\nname = \"i\"\nslave = \"b.bottom\"\nmaster = \"a.top\"\n\
         [solver]\nWHICH\nmax_iterations = 2\n",
    );
    for which in [
        "linear = \"iterative\"",
        "constraint = \"condensed\"\nlinear = \"iterative\"",
        "constraint = \"schur\"",
        "constraint = \"uzawa\"\ntolerance = 1e-14",
        "constraint = \"uzawa\"\nlinear = \"iterative\"",
    ] {
        let result = run(&text.replace("WHICH", which));
        assert_eq!((result.status, result.exit), (Status::NotConverged, 5), "{which}: {}", show(&result));
        let d = &result.diagnostics[0];
        assert_eq!(d.code, "E074", "{which}");
        for part in ["after 2 iterations", "relative residual", "wanted"] {
            assert!(d.message.contains(part), "{which}: {}", d.message);
        }
        assert!(d.line.is_some() && d.help.as_ref().unwrap().contains("max_iterations"));
    }
}

#[test]
fn words_of_the_solver_that_do_not_go_together_are_refused() {
    let refused = |words: &str| {
        let text = square(&format!("[solver]\n{words}\n"));
        match Case::parse("case.toml", &text, &ReadOptions::default()).and_then(|case| case.run(&Registry::default())) {
            Err(faults) => faults.to_string(),
            Ok(result) => panic!("{words}: {}", show(&result)),
        }
    };
    let schur = refused("constraint = \"schur\"\nlinear = \"iterative\"");
    assert!(schur.contains("E015") && schur.contains("constraint = \"uzawa\""), "{schur}");
    let direct = refused("constraint = \"condensed\"\ntolerance = 1e-6");
    assert!(direct.contains("E015") && direct.contains("linear = \"iterative\""), "{direct}");
}

#[test]
fn a_list_of_masters_is_one_side_and_cross_points_are_lowered() {
    // one slave over two masters that are tied to each other: p/p is lowered at the cross point and at the fixed ends
    let text = "[model]\nphysics = \"elasticity\"\ndimension = 2\nexact = { u = [\"x + 2*y\", \"y - x\"] }\n[[material]]\nname = \"m\"\nyoung = 1.0\npoisson = 0.3\n\
        [[patch]]\nname = \"a\"\ngeometry = { kind = \"box\", min = [0, 0], max = [1, 1] }\nelements = [2, 2]\n\
        [[patch]]\nname = \"b\"\ngeometry = { kind = \"box\", min = [1, 0], max = [2, 1] }\nelements = [3, 3]\n\
        [[patch]]\nname = \"c\"\ngeometry = { kind = \"box\", min = [0, 1], max = [2, 2] }\nelements = [5, 2]\n\
        [[boundary]]\non = \"all-outer\"\ndirichlet = \"exact\"\n\
        [[interface]]\nname = \"v\"\nslave = \"b.left\"\nmaster = \"a.right\"\nmultiplier = \"p/p\"\n\
        [[interface]]\nname = \"h\"\nslave = \"c.bottom\"\nmaster = [\"a.top\", \"b.top\"]\nmultiplier = \"p/p\"\n\
        [[check]]\nname = \"error\"\nquantity = \"error.u.L2\"\nbelow = 1e-12\n[[check]]\nname = \"lambda\"\nquantity = \"error.lambda.L2\"\nbelow = 1e-10\n\
        [[check]]\nname = \"length\"\nquantity = \"interface.h.measure\"\nequals = 2\nrtol = 1e-12\n";
    let result = run(text);
    assert_eq!(result.status, Status::Ok, "{}", show(&result));
    // v: 5 functions, both ends lowered (one prescribed, one a cross point) per component; h: 7 functions, both ends prescribed
    assert_eq!(result.unknowns.multipliers, 2 * 3 + 2 * 5);
}

#[test]
fn wrong_cases_are_refused_with_code_place_and_advice() {
    let tie = |rest: &str| format!("[[interface]]\nname = \"i\"\nslave = \"b.bottom\"\nmaster = \"a.top\"\n{rest}");
    let probe = |q: &str| square(&format!("[[probe]]\nname = \"p\"\nquantity = '{q}'\n"));
    let upper = "min = [0, 1], max = [1, 2]";
    // a check of a supported pair in contact
    let pad = |quantity: &str, rest: &str| {
        pair(
            "min = [0, 1], max = [1, 2]",
            &format!(
                "[[boundary]]\non = \"b.left\"\nfix = [\"x\"]\n[[contact]]\nname = \"c\"\nslave = \"b.bottom\"\nmaster = \"a.top\"\n\
                 [[probe]]\nname = \"p\"\nquantity = \"energy\"\n[[check]]\nquantity = \"{quantity}\"\nbelow = 1\n{rest}"
            ),
        )
    };
    let mut wrong: Vec<String> = Vec::new();
    for (text, code, part) in [
        // quantities
        (probe("enrgy"), "E018", "did you mean `energy`"),
        (probe("u at [0, 0]"), "E018", "write u.x or u.y"),
        (probe("stress.yy"), "E018", "add `at [x, y]`"),
        (probe("flux.x at [0, 0]"), "E018", "the flux belongs to Poisson"),
        (probe("contact.c.pressure at [0, 0]"), "E018", "there is no contact `c`; the case has no [[contact]]"),
        (probe("u.x at [0, 0] in c"), "E021", "patches are a"),
        (probe("u.x at [3, 0]"), "E022", "outside every body"),
        (probe("u.x at [1, q]"), "E017", "coordinate `q`"),
        (probe("error.u.L2"), "E062", "needs `exact`"),
        (probe("error.u.L3"), "E018", "unknown quantity"),
        (probe("stres.xx at [0, 0]"), "E018", "did you mean `stress.xx`?"),
        (probe("U.y at [0, 0]"), "E018", "did you mean `u.y`?"),
        (probe("area.nope"), "E018", "did you mean `area.a`?"),
        (pad("contact.mid.force.y", ""), "E018", "did you mean `contact.c.force.y`?"),
        (pad("error.c.lambda.L2", ""), "E062", "needs `exact` in [[contact]] \"c\""),
        (pad("error.lambda.L2.rel", ""), "E062", "needs `exact` in [[contact]]"),
        (pad("error.d.lambda.L2", ""), "E018", "unknown quantity"),
        (pad("energy", "over = \"all\"\n"), "E015", "`over` checks the minimum and maximum"),
        (pad("rate.foo", ""), "E018", "unknown quantity `foo`"),
        (pad("infsup.xyz.beta", ""), "E018", "infsup.PAIRING.beta"),
        (pad("probes.1.value", ""), "E018", "unknown quantity"),
        (probe("probes.p.value"), "E018", "unknown quantity"),
        (probe("checks.0.value"), "E018", "unknown quantity"),
        (pad("contact.mid.stick", ""), "E018", "there is no contact `mid`; contacts: c"),
        (pad("strain.xq", ""), "E018", "unknown component `xq` of the strain"),
        (pad("principal.4", ""), "E018", "principal.1, principal.2 and principal.3"),
        // sides that do not fit
        (pair("min = [0, 1.25], max = [1, 2]", &tie("")), "E023", "`b.bottom` and `a.top` are up to 0.25 apart"),
        (pair("min = [0.5, 1], max = [1.5, 2]", &tie("")), "E025", "only 50 % of the slave side `b.bottom`"),
        // multipliers
        (pair(upper, &tie("multiplier = \"p/p-4\"\n")), "E064", "p/p-4"),
(square("").replace("dimension = 2", "dimension = 2\ngravity = [0, -9.81]"), "E013", "`gravity` needs a density, material \"m\" has none"),
        // supports
        (pair(upper, ""), "E051", "body \"b\" can still move: translation x, translation y, rotation"),
        (
            pair(upper, "[[contact]]\nname = \"c\"\nslave = \"b.bottom\"\nmaster = \"a.top\"\n"),
            "E051",
            "body \"b\" can still move: translation x, even with every contact closed",
        ),
        // values that disagree in a corner
        (square("[[boundary]]\non = \"a.left\"\ndirichlet = { x = \"1 + y\" }\n"), "E052", "prescribed as"),
        (square("[[boundary]]\non = \"a.left\"\ndirichlet = { x = \"1/(y - y)\" }\n"), "E017", "not finite"),
        // contact
        (
            pair(upper, "[[boundary]]\non = \"b.left\"\nfix = [\"x\"]\n[[contact]]\nname = \"c\"\nslave = \"b.bottom\"\nrigid = { kind = \"sphere\", center = [0.5, 0], radius = 1 }\ngap = \"g/(x - x)\"\n"),
            "E017",
            "the gap `g/(x - x)` is not finite at x = ",
        ),
        // geometry: the second column of control points lies behind the first
        (
            "[model]\nphysics = \"poisson\"\ndimension = 2\n[[patch]]\nname = \"a\"\ngeometry = { kind = \"nurbs\", degree = [2, 1], knots = [[0, 0, 0, 1, 1, 1], [0, 0, 1, 1]], \
             points = [[0, 0], [-2, 0], [1, 0], [0, 1], [-2, 1], [1, 1]] }\n[[boundary]]\non = \"all-outer\"\ndirichlet = 0\n"
                .to_string(),
            "E041",
            "inverted",
        ),
        (
            "[model]\nphysics = \"elasticity\"\ndimension = 2\n[[material]]\nname = \"m\"\nyoung = 1.0\npoisson = 0.5\n[[patch]]\nname = \"a\"\n\
             geometry = { kind = \"box\", min = [0, 0], max = [1, 1] }\nelements = [2, 2]\n[[boundary]]\non = \"all-outer\"\nfix = [\"x\", \"y\"]\n"
                .to_string(),
            "E053",
            "poisson = 0.5",
        ),
    ] {
        wrong.extend(refuses(&text, code, part));
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn quantities_of_the_contract_that_are_not_built_are_not_in_this_version() {
    let pad = |quantity: &str, check: &str| {
        pair(
            "min = [0, 1], max = [1, 2]",
            &format!(
                "[[boundary]]\non = \"b.left\"\nfix = [\"x\"]\n[[contact]]\nname = \"c\"\nslave = \"b.bottom\"\nmaster = \"a.top\"\n\
                 [[probe]]\nname = \"p\"\nquantity = '{quantity}'\n[[check]]\nquantity = \"energy\"\nbelow = \"{check}\"\n"
            ),
        )
    };
    let fields = ["nominal.xx", "nominal.yx"];
    let forms = [".min", ".max", ".max in a", " at [0.5, 0.2]", " at [0.5, 0.2] in a", " at TIP"];
    let mut all: Vec<String> = fields.iter().flat_map(|f| forms.iter().map(move |form| format!("{f}{form}"))).collect();
    let contact = ["friction.x", "friction.y", "stick", "slip", "slip.max", "dissipated"];
    all.extend(contact.iter().flat_map(|q| ["", "rate."].map(|before| format!("{before}contact.c.{q}"))));
    all.extend(["stretch.a.least", "newton.iterations", "newton.rate"].map(str::to_owned));
    let mut wrong: Vec<String> = Vec::new();
    for quantity in &all {
        let name = quantity.trim_start_matches("rate.");
        wrong.extend(refuses(&pad(quantity, "1"), "E019", &format!("`{name}` is not in this version")));
        if !name.contains('[') && name == quantity {
            wrong.extend(refuses(&pad("energy", quantity), "E019", &format!("`{name}` is not in this version")));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn too_few_elements_for_the_multiplier_are_over_constrained() {
    // a slave side of one element with both ends prescribed: 3 functions, 1 is free, the multiplier p/p-1 has 2
    let text = "[model]\nphysics = \"poisson\"\ndimension = 2\n\
        [[patch]]\nname = \"a\"\ngeometry = { kind = \"box\", min = [0, 0], max = [1, 1] }\nelements = [1, 1]\n\
        [[patch]]\nname = \"b\"\ngeometry = { kind = \"box\", min = [0, 1], max = [1, 2] }\nelements = [2, 1]\n\
        [[boundary]]\non = \"all-outer\"\ndirichlet = 0\n\
        [[interface]]\nname = \"i\"\nslave = \"a.top\"\nmaster = \"b.bottom\"\nmultiplier = \"p/p-1\"\n";
    assert_eq!(refuses(text, "E024", "2 functions for 1 free unknowns"), None);
    assert_eq!(refuses(text, "E024", "give patch \"a\" more elements"), None);
    let warned = read(
        &text
            .replace("elements = [1, 1]", "elements = [6, 1]")
            .replace("elements = [2, 1]", "elements = [4, 1]")
            .replace("all-outer", "a.bottom"),
    )
    .unwrap();
    let result = warned.run(&Registry::default()).unwrap();
    assert!(result.warnings.iter().any(|d| d.code == "E061" && d.message.contains("p/p-1")), "{:?}", result.warnings);
}

#[test]
fn a_body_that_loses_contact_ends_with_rigid_motion_left_and_exit_five() {
    // pulled up from the plane: nothing holds it once the contact opens
    let text = "[model]\nphysics = \"elasticity\"\ndimension = 2\n[[material]]\nname = \"m\"\nyoung = 1.0\npoisson = 0.3\n\
        [[patch]]\nname = \"a\"\ngeometry = { kind = \"box\", min = [0, 0], max = [1, 1] }\nelements = [3, 2]\n\
        [[boundary]]\non = \"a.left\"\nfix = [\"x\"]\n[[boundary]]\non = \"a.top\"\ntraction = { y = 1.0 }\n\
        [[contact]]\nname = \"c\"\nslave = \"a.bottom\"\nrigid = { kind = \"half-plane\", point = [0, 0], normal = [0, 1] }\n";
    let result = run(text);
    assert_eq!((result.status, result.exit), (Status::Singular, 5));
    let text = result.diagnostics.iter().map(|d| d.message.clone()).collect::<String>();
    assert!(text.contains("infeasible load: nothing holds body \"a\" against its load in translation y"), "{text}");
    assert!(text.contains("a force (0, -1) is missing"), "{text}");
    assert_eq!(result.solve.unwrap().reason, "infeasible load");
}

#[test]
fn an_active_set_that_does_not_settle_keeps_its_last_state() {
    let text = pair(
        "min = [0, 1], max = [1, 2]",
        "[[boundary]]\non = \"b.left\"\nfix = [\"x\"]\n[[boundary]]\non = \"b.top\"\ntraction = { y = \"5*x - 3\" }\n\
         [[contact]]\nname = \"c\"\nslave = \"b.bottom\"\nmaster = \"a.top\"\nactive_set = { max_iterations = 1 }\n\
         [[probe]]\nname = \"p\"\nquantity = \"contact.c.force.y\"\n[solver]\nconstraint = \"condensed\"\n",
    );
    let result = run(&text);
    assert_eq!((result.status, result.exit), (Status::NotConverged, 5), "{}", show(&result));
    assert_eq!(result.diagnostics[0].code, "E071");
    assert!(probe(&result, "p").is_finite(), "the last state answers probes");
    assert_eq!(result.solve.unwrap().active_set.unwrap().iterations, 1);
}

#[test]
fn memory_is_predicted_before_anything_is_allocated() {
    let case = read(&square("")).unwrap();
    let watch = faying_cli::RunControl { max_memory: Some(1000), ..Default::default() };
    let finished = faying_cli::run::run(&case, &Registry::default(), &faying_cli::RunOptions::default(), &watch);
    assert_eq!((finished.result.status, finished.result.exit), (Status::Limit, 6));
    let d = &finished.result.diagnostics[0];
    assert!(d.code == "E081" && d.message.contains("the limit is 1 kB"), "{}", d.render());
    assert!(finished.output.is_none());
    let checked =
        faying_cli::run::check(&case, &Registry::default(), &faying_cli::RunOptions::default(), &faying_cli::RunControl::default());
    assert!(checked.result.predicted.is_some_and(|p| p.memory > 1_000_000) && checked.result.solve.is_none());
}

#[test]
fn loads_and_materials_without_a_value_are_refused_at_their_place() {
    let source = "[model]\nphysics = \"poisson\"\ndimension = 2\nsource = \"1/(x - x)\"\n[[patch]]\nname = \"a\"\n\
        geometry = { kind = \"box\", min = [0, 0], max = [1, 1] }\nelements = [2, 2]\n[[boundary]]\non = \"all-outer\"\ndirichlet = 0\n";
    let load = |on: &str, what: &str| square(&format!("[[boundary]]\non = \"{on}\"\n{what}\n"));
    let material = |young: &str, poisson: &str| {
        load("a.top", "pressure = 1")
            .replace("young = 1.0", &format!("young = {young}"))
            .replace("poisson = 0.3", &format!("poisson = {poisson}"))
    };
    let mut wrong: Vec<String> = Vec::new();
    for (text, code, part) in [
        (source.to_string(), "E017", "source in patch \"a\""),
        (source.replace("1/(x - x)", "x").replace("elements", "source = \"sqrt(y - 0.9)\"\nelements"), "E017", "found NaN"),
        (load("a.left", "pressure = \"1/x\""), "E017", "the pressure of `a.left`: `1/x` is not finite at x = 0"),
        (load("a.top", "traction = { y = \"sqrt(x - 0.5)\" }"), "E017", "the traction of `a.top`"),
        (load("a.top", "spring = { y = \"1/(y - 1)\" }"), "E017", "the spring of `a.top`"),
        // the one step is at t = 1
        (load("a.top", "pressure = \"1/(t - 1)\""), "E017", "t = 1"),
        (material("\"x - 0.5\"", "0.3"), "E053", "young = \"x - 0.5\""),
        (material("1.0", "\"0.3 + 0.4*x\""), "E053", "poisson = \"0.3 + 0.4*x\""),
        (material("1.0", "\"0.3 + 0.4*x\""), "E053", "at x = 0.5"),
        (
            source.replace("1/(x - x)", "1").replace("[[patch]]", "[[material]]\nname = \"m\"\nconductivity = \"0.5 - y\"\n[[patch]]"),
            "E053",
            "conductivity = -",
        ),
    ] {
        wrong.extend(refuses(&text, code, part));
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    // zero at the rim alone is no quadrature point
    assert_eq!(run(&material("\"x\"", "0.3")).status, Status::Ok);
}

#[test]
fn two_sides_are_coupled_once() {
    let upper = "min = [0, 1], max = [1, 2]";
    let up = "[[interface]]\nname = \"i\"\nslave = \"a.top\"\nmaster = \"b.bottom\"\n";
    for down in [
        "[[interface]]\nname = \"k\"\nslave = \"b.bottom\"\nmaster = \"a.top\"\n",
        "[[interface]]\nname = \"k\"\nslave = [\"b.left\", \"b.bottom\"]\nmaster = [\"a.right\", \"a.top\"]\n",
        "[[contact]]\nname = \"k\"\nslave = \"b.bottom\"\nmaster = \"a.top\"\n",
    ] {
        let text = pair(upper, &format!("{up}{down}"));
        let kind = if down.contains("contact") { "contact" } else { "interface" };
        assert_eq!(refuses(&text, "E026", "interface \"i\" on line"), None);
        assert_eq!(refuses(&text, "E026", &format!("and {kind} \"k\" on line")), None);
    }
}

#[test]
fn a_start_by_gaps_takes_bodies_that_touch_as_closed() {
    // gaps of touching boxes are round-off of either sign
    for (slave, master, force) in [("l.top", "u.bottom", -1e-3), ("u.bottom", "l.top", 1e-3)] {
        let text = format!(
            "[model]\nphysics = \"elasticity\"\ndimension = 2\n[discretization]\ndegree = 3\n[[material]]\nname = \"m\"\nyoung = 1.0\npoisson = 0.3\n\
             [[patch]]\nname = \"l\"\ngeometry = {{ kind = \"box\", min = [0, 0], max = [1, 0.5] }}\nelements = [4, 2]\n\
             [[patch]]\nname = \"u\"\ngeometry = {{ kind = \"box\", min = [0, 0.5], max = [1, 1] }}\nelements = [[0, 0.2, 0.45, 0.8, 1.0], 2]\nbackend = \"fe\"\n\
             [[boundary]]\non = \"l.bottom\"\nfix = [\"y\"]\n[[boundary]]\non = [\"l.left\", \"u.left\"]\nfix = [\"x\"]\n[[boundary]]\non = \"u.top\"\npressure = 1e-3\n\
             [[contact]]\nname = \"c\"\nslave = \"{slave}\"\nmaster = \"{master}\"\nactive_set = {{ start = \"gap\" }}\n\
             [[probe]]\nname = \"f\"\nquantity = \"contact.c.force.y\"\n"
        );
        let result = run(&text);
        assert_eq!(result.status, Status::Ok, "{slave}: {}", show(&result));
        close(probe(&result, "f"), force, 1e-12, slave);
        assert_eq!(result.solve.unwrap().active_set.unwrap().iterations, 1, "{slave}");
    }
}

#[test]
fn the_half_width_is_that_of_the_sides_as_one() {
    // one box of 80 elements, and the same cut at `cut`: the joint is no end of the side
    let case = |cut: f64, left: usize, obstacle: &str| {
        format!(
            "[model]\nphysics = \"elasticity\"\ndimension = 2\n[[material]]\nname = \"m\"\nyoung = 1.0\npoisson = 0.3\n\
             [[patch]]\nname = \"a\"\ngeometry = {{ kind = \"box\", min = [0, 0], max = [{cut}, 1] }}\nelements = [{left}, 16]\n\
             [[patch]]\nname = \"b\"\ngeometry = {{ kind = \"box\", min = [{cut}, 0], max = [1, 1] }}\nelements = [{}, 16]\n\
             [[boundary]]\non = [\"a.top\", \"b.top\"]\ndirichlet = [\"0\", \"-0.02\"]\n\
             [[interface]]\nname = \"t\"\nslave = \"a.right\"\nmaster = \"b.left\"\n\
             [[contact]]\nname = \"c\"\nslave = [\"b.bottom\", \"a.bottom\"]\nrigid = {{ {obstacle} }}\n\
             [[probe]]\nname = \"w\"\nquantity = \"contact.c.half_width\"\n",
            80 - left
        )
    };
    let plane = "kind = \"half-plane\", point = [0, 0], normal = [0, 1]";
    let round = "kind = \"sphere\", center = [0.5, -2], radius = 2.0";
    close(probe(&run(&case(0.6, 48, plane)), "w"), 0.5, 1e-9, "half of it");
    // what the same gives with the joint beside the zone, and what one box gives with elements of 1/320: 0.1685
    let width = |cut: f64, left: usize| probe(&run(&case(cut, left, round)), "w");
    close(width(0.45, 36), width(0.2, 16), 0.2 * 0.0125, "a zone over the joint: within a fifth of an element");
    close(width(0.45, 36), 0.1685, 0.01 * 0.1685, "a zone over the joint");
}

#[test]
fn a_contact_side_held_along_the_normal_is_refused_with_the_condition() {
    for backend in ["iga", "fe"] {
        for degree in [1, 2, 3] {
            let text = format!(
                "[discretization]\ndegree = {degree}\nbackend = \"{backend}\"\n{}",
                square(
                    "[[contact]]\nname = \"c\"\nslave = \"a.bottom\"\nrigid = { kind = \"half-plane\", point = [0, 0], normal = [0, 1] }\n"
                )
            );
            assert_eq!(refuses(&text, "E024", "0 free unknowns"), None, "{backend} {degree}");
            assert_eq!(refuses(&text, "E024", "component y by `fix` or `dirichlet` (line "), None, "{backend} {degree}");
        }
    }
    // a tied slave side, one component of which is prescribed
    let tied = pair(
        "min = [0, 1], max = [1, 2]",
        "[[interface]]\nname = \"i\"\nslave = \"b.bottom\"\nmaster = \"a.top\"\n[[boundary]]\non = \"b.bottom\"\nfix = [\"x\"]\n",
    );
    assert_eq!(refuses(&tied, "E024", "component x has 0 free unknowns"), None);
    assert_eq!(refuses(&tied, "E024", "component x by `fix` or `dirichlet` (line "), None);
}

#[test]
fn the_remedy_for_a_slave_side_that_conditions_hold_fits_these_conditions() {
    let upper = "min = [0, 1], max = [1, 2]";
    let rigid = "[[boundary]]\non = \"b.left\"\nfix = [\"x\"]\n[[boundary]]\non = \"b.bottom\"\nrigid_force = { y = -1.0 }\n";
    let fixed = "[[boundary]]\non = \"b.left\"\nfix = [\"x\"]\n[[boundary]]\non = \"b.bottom\"\nfix = [\"y\"]\n";
    let faced = |opponent: &str, more: &str| format!("[[contact]]\nname = \"c\"\nslave = \"b.bottom\"\n{opponent}\n{more}");
    let (side, plane) = ("master = \"a.top\"", "rigid = { kind = \"half-plane\", point = [0, 1], normal = [0, 1] }");
    let pressed = plane.replace(" }", ", force = { y = 1.0 } }");
    let (one, other) =
        ("`b.bottom` moves as one: component y by `rigid_force` (line ", "drop that condition, or let another side be the slave");
    let tied = format!("{rigid}[[interface]]\nname = \"c\"\nslave = \"b.bottom\"\nmaster = \"a.top\"\n");
    let dual = "multiplier = \"dual\"\n";
    for (rest, has_side) in [
        (tied, true),
        (faced(side, dual) + rigid, true),
        (faced(plane, dual) + rigid, false),
        (faced(&pressed, dual) + rigid, false),
        (faced(side, "") + fixed, true),
        (faced(plane, "") + fixed, false),
        (faced(&pressed, "") + fixed, false),
    ] {
        let text = pair(upper, &rest);
        assert_eq!(refuses(&text, "E024", if rest.contains("rigid_force") { one } else { "`b.bottom` is prescribed itself" }), None);
        assert_eq!(refuses(&text, "E024", "drop that condition"), None);
        assert_eq!(refuses(&text, "E024", other).is_none(), has_side, "{rest}");
        assert!(refuses(&text, "E024", "more elements").is_some(), "{rest}");
    }
}

#[test]
fn stresses_have_a_value_at_the_centre_of_a_disc() {
    // uniform pressure: one stress everywhere, also where the map collapses
    for backend in ["iga", "fe"] {
        let text = format!(
            "[discretization]\nbackend = \"{backend}\"\n[model]\nphysics = \"elasticity\"\ndimension = 2\n[[material]]\nname = \"m\"\nyoung = 1.0\npoisson = 0.3\n\
             [[patch]]\nname = \"a\"\ngeometry = {{ kind = \"disc-sector\", center = [0.3, 0.2], radius = 1.0, angle_deg = [0, 90] }}\nelements = [16, 3]\n\
             [[boundary]]\non = \"a.u0\"\nfix = [\"y\"]\n[[boundary]]\non = \"a.u1\"\nfix = [\"x\"]\n[[boundary]]\non = \"a.v1\"\npressure = 1.0\n\
             [[probe]]\nname = \"s\"\nquantity = \"stress.xx at [0.3, 0.2]\"\n"
        );
        let result = run(&text);
        // the sides of elements of degree 2 leave the circle by the fourth power of their size
        close(probe(&result, "s"), -1.0, if backend == "iga" { 1e-6 } else { 1e-3 }, backend);
    }
}

#[test]
fn contact_next_to_a_prescribed_corner_is_the_same_in_a_mirror() {
    for (degree, multiplier) in [(1, "p/p"), (1, "auto"), (2, "p/p"), (3, "p/p")] {
        for backend in ["iga", "fe"] {
            // bodies from -1 to 1; `right`: the prescribed side
            let case = |right: bool, at: f64| {
                let (held, other) = if right { ("a.right", "a.left") } else { ("a.left", "a.right") };
                format!(
                    "[model]\nphysics = \"elasticity\"\ndimension = 2\n[discretization]\ndegree = {degree}\nbackend = \"{backend}\"\n\
                     [[material]]\nname = \"m\"\nyoung = 1.0\npoisson = 0.3\n\
                     [[patch]]\nname = \"a\"\ngeometry = {{ kind = \"box\", min = [-1, 0], max = [1, 1] }}\nelements = [8, 4]\n\
                     [[boundary]]\non = \"{held}\"\ndirichlet = {{ y = \"-0.001\" }}\n[[boundary]]\non = \"a.top\"\ntraction = {{ y = -0.1 }}\n\
                     [[boundary]]\non = \"{other}\"\nfix = [\"x\"]\n\
                     [[contact]]\nname = \"c\"\nslave = \"a.bottom\"\nrigid = {{ kind = \"half-plane\", point = [0, 0], normal = [0, 1] }}\nmultiplier = \"{multiplier}\"\n\
                     [[probe]]\nname = \"force\"\nquantity = \"contact.c.force.y\"\n[[probe]]\nname = \"largest\"\nquantity = \"contact.c.pressure.max\"\n\
                     [[probe]]\nname = \"end\"\nquantity = \"contact.c.pressure at [{at}, 0]\"\n[[probe]]\nname = \"width\"\nquantity = \"contact.c.half_width\"\n\
                     [[probe]]\nname = \"u\"\nquantity = \"u.y at [{}, 0.6]\"\n[[probe]]\nname = \"moment\"\nquantity = \"contact.c.moment.z\"\n",
                    at / 2.0
                )
            };
            let (left, right) = (run(&case(false, -0.98)), run(&case(true, 0.98)));
            let what = format!("degree {degree}, {multiplier}, {backend}");
            assert_eq!((left.status, right.status), (Status::Ok, Status::Ok), "{what}");
            assert_eq!(left.unknowns.multipliers, right.unknowns.multipliers, "{what}");
            for name in ["force", "largest", "end", "width", "u"] {
                let [a, b] = [&right, &left].map(|result| probe(result, name));
                // too coarse a zone has no half width on either side
                if name != "width" || !(a.is_nan() && b.is_nan()) {
                    close(a, b, 1e-10, &format!("{what}: {name}"));
                }
            }
            close(probe(&right, "moment"), -probe(&left, "moment"), 1e-10, &format!("{what}: moment"));
        }
    }
}

#[test]
fn names_of_a_registry_from_outside_run_from_a_case_file() {
    use faying::constraint::Direct;
    use faying::coupling::Mortar;
    use faying::coupling::multiplier::{MultiplierKind, build};
    use faying::problem::Multiplier;
    use faying::space::Patch;
    let mut registry = Registry::default();
    // a backend that makes splines one degree higher than asked for, and the other families under new names
    registry.plane.backends.add(
        "higher",
        Box::new(|spec| {
            let spec = spec.clone().with_degree(spec.degree.map(|p| p + 1));
            Ok(Box::new(Patch::<1, 2>::try_new(&spec).map_err(|e| faying_cli::Fault::new("E015", e.to_string()))?))
        }),
    );
    registry.plane.multipliers.add("mine", Multiplier::of(|trace, _| build(&trace.space, MultiplierKind::Constant, &[])));
    registry.plane.couplings.add_keyed("dowels", Vec::new(), Box::new(|_| Ok(Box::new(Mortar))));
    registry.solvers.add("direct", Box::new(|_| Ok(Box::new(Direct::new()))));
    let text = pair(
        "min = [0, 1], max = [1, 2]",
        "backend = \"higher\"\n[[boundary]]\non = \"b.top\"\npressure = 1.0\n\
         [[interface]]\nname = \"i\"\nslave = \"b.bottom\"\nmaster = \"a.top\"\nmultiplier = \"mine\"\ncoupling = \"dowels\"\n[solver]\nconstraint = \"direct\"\n",
    );
    let options = ReadOptions { names: registry.case_names(), ..ReadOptions::default() };
    let result =
        Case::parse("case.toml", &text, &options).unwrap_or_else(|e| panic!("{e}")).run(&registry).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(result.status, Status::Ok);
    assert_eq!(result.backend, "higher+iga");
    // b has degree 3 on 4 x 2 elements: 7 x 5 functions; a has 5 x 4
    assert_eq!((result.unknowns.primal, result.unknowns.multipliers), (2 * (7 * 5 + 5 * 4), 2 * 4));
    // without the names the case is refused with the names there are
    let refused = Case::parse("case.toml", &text, &ReadOptions::default()).expect_err("unknown names");
    assert!(refused.to_string().contains("higher"), "{refused}");
}

/// Solves, and then claims that row 0 pulls while it is closed and penetrates while it is open.
#[derive(Debug, Default)]
struct Fickle(faying::constraint::Direct);

impl faying::constraint::ConstraintSolver for Fickle {
    fn abilities(&self) -> faying::constraint::Abilities {
        self.0.abilities()
    }

    fn solve(
        &mut self,
        system: &faying::constraint::ConstrainedSystem<'_>,
    ) -> Result<faying::constraint::ConstrainedSolution, faying::constraint::SolveError> {
        let mut solution = self.0.solve(system)?;
        if solution.active[0] {
            solution.multipliers[0] = 10.0;
        } else {
            solution.gap[0] = -10.0;
        }
        Ok(solution)
    }
}

#[test]
fn an_active_set_that_cycles_names_the_iterations_and_the_functions() {
    let mut registry = Registry::default();
    registry.solvers.add("fickle", Box::new(|_| Ok(Box::new(Fickle::default()))));
    let text = pair(
        "min = [0, 1], max = [1, 2]",
        "[[boundary]]\non = \"b.left\"\nfix = [\"x\"]\n[[boundary]]\non = \"b.top\"\npressure = 1.0\n\
         [[contact]]\nname = \"c\"\nslave = \"b.bottom\"\nmaster = \"a.top\"\n[[probe]]\nname = \"p\"\nquantity = \"u.y at [1, 2] in b\"\n\
         [solver]\nconstraint = \"fickle\"\n",
    );
    let options = ReadOptions { names: registry.case_names(), ..ReadOptions::default() };
    let result =
        Case::parse("case.toml", &text, &options).unwrap_or_else(|e| panic!("{e}")).run(&registry).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!((result.status, result.exit), (Status::NotConverged, 5));
    let d = &result.diagnostics[0];
    assert_eq!(d.code, "E071");
    for part in ["visited the same state twice (iterations 1 and 3)", "functions 0 of \"c\" on `b.bottom` flip", "near x = ", "y = 1"] {
        assert!(d.message.contains(part), "{}", d.message);
    }
    let set = result.solve.as_ref().and_then(|s| s.active_set.as_ref()).unwrap();
    // back in the first state, single exchanges come back, too: no matrix of rows does that
    assert_eq!((set.cycles, set.iterations), (2, 3));
    assert!((1..=3).contains(&set.best));
    assert!(probe(&result, "p").is_finite(), "the last state is kept");
}

#[test]
fn cases_too_large_for_the_machine_are_refused_at_once_at_their_elements() {
    let options = |sets: &[&str]| ReadOptions { sets: sets.iter().map(|s| s.to_string()).collect(), ..ReadOptions::default() };
    let begun = std::time::Instant::now();
    for (sets, limit, part) in [
        // (n + 2)^2 functions of degree 2, two components each
        (&["patch.a.elements=[1000000, 1000000]"][..], None, "about 2000008000008 unknowns"),
        (&["patch.a.elements=[30000, 30000]"], None, "about 1800240008 unknowns"),
        (
            &["patch.a.elements=[30000, 30000]", "discretization.backend=fe", "discretization.degree=8"],
            None,
            "this version holds up to 4.3e9 unknowns",
        ),
        (&["patch.a.elements=[1000000, 1000000]", "patch.a.refine=20"], None, "unknowns"),
        (&["patch.a.elements=[1500, 1500]"], Some(1_000_000_000), "about 4512008 unknowns"),
    ] {
        let case = Case::parse("case.toml", &square(""), &options(sets)).unwrap_or_else(|e| panic!("{e}"));
        let watch = faying_cli::RunControl { max_memory: limit, ..Default::default() };
        for go in [faying_cli::run::run, faying_cli::run::check] {
            let finished = go(&case, &Registry::default(), &faying_cli::RunOptions::default(), &watch);
            assert_eq!((finished.result.status, finished.result.exit), (Status::Limit, 6), "{sets:?}");
            let d = &finished.result.diagnostics[0];
            assert!(d.code == "E081" && d.message.contains(part) && finished.output.is_none(), "{}", d.render());
            assert!(d.render().contains(&format!("--set {}", sets[0])), "{}", d.render());
            // no memory helps where the version itself ends
            let fixed = d.message.contains("this version holds");
            assert_eq!(d.render().contains("raise --max-memory"), !fixed, "{}", d.render());
        }
    }
    assert!(begun.elapsed().as_secs() < 5, "{:?}", begun.elapsed());
}

/// A watch that raises its flag at the first news that `pick` chooses.
fn interrupts(pick: fn(&Progress<'_>) -> bool) -> RunControl {
    let interrupted = std::sync::Arc::new(std::sync::atomic::AtomicBool::new(false));
    let flag = interrupted.clone();
    let listener = move |news: Progress<'_>| {
        if pick(&news) {
            flag.store(true, std::sync::atomic::Ordering::Relaxed);
        }
    };
    RunControl { interrupted, listener: Some(Box::new(listener)), ..RunControl::default() }
}

#[test]
fn a_run_stops_where_it_is_told_to_and_says_null_for_what_it_did_not_compute() {
    let path = format!("{}/examples/cases/hertz.toml", concat!(env!("CARGO_MANIFEST_DIR"), "/../.."));
    let mut case = Case::read(path).unwrap();
    // the guess of `auto` needs one system alone; condensation solves every set as a whole
    case.contacts[0].active_set.start.value = Start::All;
    case.solver.constraint.value = "condensed".into();
    let go = |watch: &RunControl| faying_cli::run::run(&case, &Registry::default(), &faying_cli::RunOptions::default(), watch);
    for phase in ["assemble", "solve"] {
        let watch = if phase == "solve" {
            interrupts(|n| matches!(n, Progress::Phase("solve")))
        } else {
            interrupts(|n| matches!(n, Progress::Phase("assemble")))
        };
        let finished = go(&watch);
        assert_eq!((finished.result.status, finished.result.exit), (Status::Interrupted, 130), "{phase}");
        assert!(finished.output.is_none() && !finished.result.solved);
        let value = finished.result.to_value();
        let contact = value["contact"].as_object().unwrap().values().next().unwrap();
        assert!(contact["active"].is_null() && contact["force"][0].is_null() && contact["gap"]["min"].is_null(), "{contact}");
        assert_eq!(contact["reason"], "nothing was solved");
        assert!(value["energy"].is_null() && value["solve"]["residual"].is_null() && value["unknowns"]["primal"].as_u64() > Some(0));
    }
    // within the active set: its last state is kept
    let finished = go(&interrupts(|n| matches!(n, Progress::Iteration { iteration: 2, .. })));
    assert_eq!((finished.result.status, finished.result.exit), (Status::Interrupted, 130));
    assert!(finished.output.is_some() && finished.result.solved);
    let iterations = finished.result.solve.as_ref().unwrap().active_set.as_ref().unwrap().iterations;
    assert_eq!(iterations, 2, "the system that had begun comes to its end");
    // after everything was solved
    let finished = go(&interrupts(|n| matches!(n, Progress::Phase("fields"))));
    assert_eq!((finished.result.status, finished.result.exit), (Status::Interrupted, 130));
    assert!(finished.output.is_some() && finished.result.to_value()["energy"].as_f64() > Some(0.0));
    // a deadline that has passed
    let watch = RunControl { deadline: Some((std::time::Instant::now(), 1e-9)), ..RunControl::default() };
    let finished = go(&watch);
    assert_eq!((finished.result.status, finished.result.exit), (Status::Limit, 6));
    assert_eq!(finished.result.diagnostics.len(), 1);
}

#[test]
fn documents_have_no_numbers_that_nobody_computed() {
    let go = |text: &str, command: fn(&Case, &Registry, &faying_cli::RunOptions, &RunControl) -> faying_cli::Finished| {
        command(&read(text).unwrap(), &Registry::default(), &faying_cli::RunOptions::default(), &RunControl::default()).result
    };
    let checked = go(&square(""), faying_cli::run::check).to_value();
    for key in ["energy", "reactions", "contact", "interface", "balance", "errors", "solve"] {
        assert!(checked.get(key).is_none(), "{key}");
    }
    assert!(checked["geometry"]["least_jacobian"].as_f64() > Some(0.0));
    // interrupted before anything was solved
    let watch = RunControl::default();
    watch.interrupted.store(true, std::sync::atomic::Ordering::Relaxed);
    let case = read(&square("")).unwrap();
    let result = faying_cli::run::run(&case, &Registry::default(), &faying_cli::RunOptions::default(), &watch).result;
    assert_eq!((result.status, result.solved), (Status::Interrupted, false), "{}", show(&result));
    let value = result.to_value();
    assert!(value["energy"].is_null() && value["reactions"]["a.bottom"][0].is_null() && value["solve"]["residual"].is_null(), "{value}");
    assert_eq!(value["reason"], "nothing was solved");
    assert_eq!(value["solve"]["reason"], "the run was interrupted");
}

#[test]
fn unknowns_that_loads_and_contact_hold_at_zero_are_no_residual() {
    // all unknowns but the prescribed ones are zero up to rounding; poisson 0.418 and others ended as "singular"
    for poisson in ["0.3", "0.41", "0.418", "0.4186138798343641", "0.42", "0.45"] {
        for constraint in ["saddle-point", "condensed", "schur"] {
            let result = run(&format!(
                "[model]\nphysics = \"elasticity\"\ndimension = 2\n[solver]\nconstraint = \"{constraint}\"\n\
                 [[material]]\nname = \"m\"\nyoung = 0.275970675187929337\npoisson = {poisson}\n[[patch]]\nname = \"a\"\n\
                 geometry = {{ kind = \"nurbs\", degree = [1, 1], knots = [[0, 0, 1, 1], [0, 0, 1, 1]], points = [[0, 0], [2.7156051773124434, 0], \
                 [0, 0.7788239645251305], [2.7156051773124434, 0.7788239645251305]], scale = 1.35992037216407072e-5, \
                 move = [-1.74584284506765718e-3, 6.71204861793017228e-3] }}\nelements = [3, 1]\ndegree = 1\n\
                 [[boundary]]\non = [\"a.u0\", \"a.u1\"]\nfix = [\"normal\"]\n[[boundary]]\non = \"a.v1\"\ndirichlet = [\"0\", \"-1.07409742229728885e-8\"]\n\
                 [[contact]]\nname = \"c\"\nslave = \"a.v0\"\nrigid = {{ kind = \"half-plane\", point = [-1.74312300432332909e-3, 6.71204861793017228e-3], normal = [0, 1] }}\n"
            ));
            assert_eq!(result.status, Status::Ok, "{poisson} {constraint}: {}", show(&result));
        }
    }
}

/// Far from the origin the directions of a flat side differ by the rounding of positions.
#[test]
fn flat_sides_far_from_the_origin_are_held_along_their_normals() {
    for backend in ["iga", "fe"] {
        for angle in [0, 37, 90] {
            let text = format!(
                "[model]\nphysics = \"elasticity\"\ndimension = 2\n[[material]]\nname = \"m\"\nyoung = 1.0\npoisson = 0.3\n\
                 [[patch]]\nname = \"a\"\ngeometry = {{ kind = \"box\", min = [0, 0], max = [1, 1], rotate_deg = {angle}, move = [1e6, -1e6] }}\n\
                 elements = [4, 4]\nbackend = \"{backend}\"\n[[boundary]]\non = [\"a.bottom\", \"a.left\"]\nfix = [\"normal\"]\n\
                 [[boundary]]\non = \"a.top\"\npressure = 1.0\n"
            );
            // energy of a bar: (1 - nu^2) / 2
            let energy = run(&text).energy;
            assert!((energy - 0.455).abs() < 1e-7, "{backend}, {angle}: {energy}");
        }
    }
}
