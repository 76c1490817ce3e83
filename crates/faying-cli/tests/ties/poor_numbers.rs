//! Warnings where numbers are poor: each appears where its number is, and not on sound cases beside it.

use faying_cli::Case;
use faying_cli::case::ReadOptions;
use faying_cli::errors::Diagnostic;
use faying_cli::{Registry, RunResult, Status};

fn run(text: &str) -> RunResult {
    let case = Case::parse("case.toml", text, &ReadOptions::default()).unwrap_or_else(|e| panic!("{e}\n{text}"));
    let result = case.run(&Registry::default()).unwrap_or_else(|e| panic!("{e}\n{text}"));
    assert!(matches!(result.status, Status::Ok), "{:?}\n{text}", result.diagnostics);
    result
}

/// The only warning of a result.
fn only<'a>(result: &'a RunResult, code: &str, words: &[&str]) -> &'a Diagnostic {
    let [warning] = &result.warnings[..] else { panic!("{:?}", result.warnings) };
    assert_eq!(warning.code, code, "{warning:?}");
    assert!(words.iter().all(|w| warning.message.contains(w)), "{words:?}: {warning:?}");
    assert!(warning.help.is_some() && warning.line.is_some(), "{warning:?}");
    warning
}

fn none(result: &RunResult, what: &str) {
    assert!(result.warnings.is_empty(), "{what}: {:?}", result.warnings);
}

fn error(result: &RunResult, name: &str) -> f64 {
    *result.errors.get(name).unwrap()
}

const ELASTIC: &str = "[model]\nphysics = \"elasticity\"\ndimension = 2\n[[material]]\nname = \"m\"\nyoung = 1.0\npoisson = 0.3\n";

fn block(name: &str, [x0, y0]: [f64; 2], [x1, y1]: [f64; 2], [nx, ny]: [usize; 2], rest: &str) -> String {
    format!(
        "[[patch]]\nname = \"{name}\"\ngeometry = {{ kind = \"box\", min = [{x0:?}, {y0:?}], max = [{x1:?}, {y1:?}] }}\nelements = [{nx}, {ny}]\n{rest}\n"
    )
}

fn on(sides: &str, what: &str) -> String {
    format!("[[boundary]]\non = {sides}\n{what}\n")
}

/// A linear field on a spline solid of one span per direction, of these degrees, its control points off the lattice by up to `bend`.
fn solid(degrees: [usize; 3], bend: f64, degree: usize) -> String {
    let (mut points, mut knots) = (Vec::new(), Vec::new());
    for q in degrees {
        knots.push([vec!["0"; q + 1], vec!["1"; q + 1]].concat().join(", "));
    }
    for k in 0..=degrees[2] {
        for j in 0..=degrees[1] {
            for i in 0..=degrees[0] {
                let at = |i: usize, q: usize| i as f64 / q as f64;
                let (u, v, w) = (at(i, degrees[0]), at(j, degrees[1]), at(k, degrees[2]));
                // no symmetry that would make coefficients of the highest degrees vanish
                let (i, j, k) = (1.0 + i as f64, 1.0 + j as f64, 1.0 + k as f64);
                let off = |a: f64| bend * (a * i + 2.3 * a * a * j + 0.7 * (a + 1.0) * i * j * k).sin();
                let (x, y, z) = (u + off(1.1), v + off(1.7), w + off(2.9));
                points.push(format!("[{x:?}, {y:?}, {z:?}]"));
            }
        }
    }
    format!(
        "[model]\nphysics = \"poisson\"\ndimension = 3\nexact = {{ u = \"1 + 2*x - y + 3*z\" }}\n[[patch]]\nname = \"a\"\ndegree = {degree}\n\
         geometry = {{ kind = \"nurbs\", degree = {degrees:?}, knots = [[{}]], points = [{}] }}\nelements = [2, 2, 1]\n\
         [[boundary]]\non = [\"a.left\", \"a.right\", \"a.front\", \"a.back\"]\ndirichlet = \"exact\"\n\
         [[boundary]]\non = [\"a.bottom\", \"a.top\"]\nneumann = \"exact\"\n",
        knots.join("], ["),
        points.join(", ")
    )
}

// Degrees of the integrand: 2q + p - 1 along each direction, so 5 points for q = p = 3 and 4 where q = 1.
#[test]
fn curved_splines_in_space_take_the_points_that_linear_fields_ask_for_and_say_how_many() {
    for (degrees, bend, degree, points) in [
        ([3, 3, 3], 0.06, 3, [5, 5, 5]),
        ([3, 3, 1], 0.06, 3, [5, 5, 4]),
        ([3, 3, 3], 0.06, 4, [5, 5, 5]),
        ([3, 3, 3], 0.0, 3, [4, 4, 4]),
        ([1, 1, 1], 0.06, 3, [4, 4, 4]),
    ] {
        let result = run(&solid(degrees, bend, degree));
        let what = format!("{degrees:?} {bend} {degree}");
        assert_eq!(result.geometry.points.get("a").unwrap(), &points.to_vec(), "{what}");
        assert!(error(&result, "error.u.H1.rel") < 1e-12, "{what}: {:e}", error(&result, "error.u.H1.rel"));
        none(&result, &what);
    }
    // plane patches keep degree + 1
    let plane =
        ELASTIC.to_owned() + &block("a", [0.0, 0.0], [1.0, 1.0], [2, 2], "degree = 3") + &on("\"a.bottom\"", "fix = [\"x\", \"y\"]");
    assert_eq!(run(&plane).geometry.points.get("a").unwrap(), &vec![4, 4]);
}

/// Two blocks, the upper one coarse, pressed together or tied; the load varies along the interface.
fn pair(kind: &str, multiplier: &str, integration: &str, degree: usize, [coarse, fine]: [usize; 2]) -> String {
    ELASTIC.replace("[[material]]", "[[material]]\nname = \"hard\"\nyoung = 1e3\npoisson = 0.3\n[[material]]")
        + &block("lower", [0.0, 0.0], [1.0, 0.5], [fine, 8], &format!("degree = {degree}\nmaterial = \"m\""))
        + &block("upper", [0.0, 0.5], [1.0, 1.0], [coarse, 2], &format!("degree = {degree}\nmaterial = \"hard\""))
        + &on("\"lower.bottom\"", "fix = [\"x\", \"y\"]")
        + &on("\"upper.top\"", "dirichlet = [\"0\", \"-0.01*(1 + x)\"]")
        + &format!(
            "[[{kind}]]\nname = \"i\"\nslave = \"upper.bottom\"\nmaster = \"lower.top\"\nmultiplier = \"{multiplier}\"\nintegration = \"{integration}\"\n"
        )
}

#[test]
fn a_coarse_slave_that_does_not_see_a_finer_softer_master_is_told_with_its_estimate() {
    for kind in ["contact", "interface"] {
        for degree in [1, 2] {
            let (poor, sound) = (run(&pair(kind, "auto", "slave", degree, [2, 32])), run(&pair(kind, "auto", "merged", degree, [2, 32])));
            let force = |r: &RunResult| r.reactions.get("lower.bottom").unwrap()[1];
            let off = 1.0 - force(&poor) / force(&sound);
            assert!((0.15..0.35).contains(&off), "{kind}, degree {degree}: {off}");
            let warning = only(&poor, "E065", &["\"i\"", "%"]);
            assert!(warning.help.as_ref().unwrap().contains("merged"), "{warning:?}");
            // but for what a multiplier of two elements leaves between its functions
            assert!(sound.warnings.iter().all(|w| w.message.contains("interface \"i\" is too coarse")), "{kind}: {:?}", sound.warnings);
            // matching grids are integrated exactly by the slave's points
            none(&run(&pair(kind, "auto", "slave", degree, [8, 8])), kind);
        }
    }
}

#[test]
fn constants_on_sides_of_degree_1_are_the_unstable_pair_under_another_name() {
    for kind in ["contact", "interface"] {
        let warning = run(&pair(kind, "constant", "merged", 1, [8, 8]));
        only(&warning, "E061", &["constant", "p/p-1", "degree 1"]);
        for (multiplier, degree) in [("constant", 2), ("p/p", 1), ("auto", 1), ("auto", 2), ("p/p-2", 2)] {
            none(&run(&pair(kind, multiplier, "merged", degree, [8, 8])), &format!("{kind} {multiplier} {degree}"));
        }
    }
    // as data: linear functions on a side of degree 2 are p/p-1, constants p/p-2
    let data = |degree: usize| pair("contact", "X", "merged", 2, [8, 8]).replace("\"X\"", &format!("{{ degree = {degree} }}"));
    only(&run(&data(1)), "E061", &["p/p-1", "degree 2"]);
    none(&run(&data(0)), "constants on degree 2");
    // constants on cubic splines, one function per element: p/p-3; continuous cubics have bubbles
    only(&run(&pair("contact", "constant", "merged", 3, [8, 8])), "E061", &["p/p-3"]);
    none(&run(&pair("contact", "constant", "merged", 3, [8, 8]).replace("[model]", "discretization.backend = \"fe\"\n[model]")), "bubbles");
}

/// A linear field on a ring of `elements` per quarter.
fn ring(elements: usize, extra: &str) -> String {
    format!(
        "[model]\nphysics = \"poisson\"\ndimension = 2\nexact = {{ u = \"1 + 2*x - y\" }}\n[[patch]]\nname = \"a\"\n\
         geometry = {{ kind = \"annulus-sector\", radius = [0.2, 2.0], angle_deg = [0, 90] }}\nelements = [{elements}, 1]\n{extra}\n\
         [[boundary]]\non = [\"a.u0\", \"a.u1\", \"a.v0\"]\nneumann = \"exact\"\n[[boundary]]\non = \"a.v1\"\ndirichlet = \"exact\"\n"
    )
}

#[test]
fn coarse_rational_cells_that_miss_linear_fields_say_how_many_points_do_not() {
    let poor = run(&ring(1, ""));
    let missed = error(&poor, "error.u.H1.rel");
    assert!(missed > 1e-3, "{missed:e}");
    let warning = only(&poor, "E065", &["\"a\"", "linear fields"]);
    let help = warning.help.as_ref().unwrap();
    let extra: usize = help.split("extra_points = ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap();
    let better = run(&ring(1, &format!("extra_points = {extra}")));
    none(&better, help);
    assert!(error(&better, "error.u.H1.rel") < 2e-4, "{extra}: {:e}", error(&better, "error.u.H1.rel"));
    let fine = run(&ring(6, ""));
    none(&fine, "fine cells");
    assert!(error(&fine, "error.u.H1.rel") < 1e-3);
}

#[test]
fn cells_thinner_than_1e_8_of_their_length_are_told() {
    let strip = |height: f64| {
        ELASTIC.to_owned()
            + &block("a", [0.0, 0.0], [1.0, height], [1, 1], "")
            + &on("\"a.bottom\"", "fix = [\"x\", \"y\"]")
            + &on("\"a.top\"", "pressure = 1e-2")
    };
    only(&run(&strip(1e-9)), "E041", &["\"a\"", "aspect", "1.0e9"]);
    none(&run(&strip(1e-7)), "1e-7");
}

#[test]
fn springs_too_soft_for_the_rotation_or_translation_that_they_hold_are_told() {
    // fixed in a corner: only the spring on top holds the rotation
    let hinged = |k: f64| {
        ELASTIC.to_owned()
            + &block("a", [0.0, 0.0], [1.0, 1.0], [2, 2], "")
            + &on("\"a.u0v0\"", "fix = [\"x\", \"y\"]")
            + &on("\"a.top\"", &format!("spring = {{ x = {k:?} }}\npressure = 1e-9"))
    };
    only(
        &run(&hinged(1e-6)),
        "E051",
        &["\"a\" is held in rotation about (0, 0) only by springs 5.9e-7 as stiff as the body", "round-off grows accordingly"],
    );
    none(&run(&hinged(1e-3)), "a spring of 1e-3");
    let sliding = |k: f64| {
        ELASTIC.to_owned()
            + &block("a", [0.0, 0.0], [1.0, 1.0], [2, 2], "")
            + &on("\"a.bottom\"", &format!("fix = [\"y\"]\nspring = {{ x = {k:?} }}"))
            + &on("\"a.top\"", "pressure = 1e-9")
    };
    only(&run(&sliding(1e-6)), "E051", &["\"a\"", "translation x"]);
    none(&run(&sliding(1e-2)), "a spring of 1e-2");
    // what a side holds needs no spring, however soft that is
    none(&run(&(hinged(1e-9) + &on("\"a.left\"", "fix = [\"x\"]"))), "held besides");
}

/// Poisson on two squares, tied at x = 1/2 or one body, with an exact solution.
fn kinked(exact: &str, conductivities: [f64; 2], tied: bool, elements: usize) -> String {
    let mut text = format!("[model]\nphysics = \"poisson\"\ndimension = 2\nexact = {{ u = \"{exact}\" }}\n");
    for (name, k) in ["p", "q"].iter().zip(conductivities) {
        text += &format!("[[material]]\nname = \"{name}\"\nconductivity = {k:?}\n");
    }
    if tied {
        text += &block("a", [0.0, 0.0], [0.5, 1.0], [elements, 2], "material = \"p\"");
        text += &block("b", [0.5, 0.0], [1.0, 1.0], [elements, 3], "material = \"q\"");
        text += "[[interface]]\nname = \"i\"\nslave = \"b.left\"\nmaster = \"a.right\"\n";
    } else {
        text += &block("a", [0.0, 0.0], [1.0, 1.0], [elements, 2], "material = \"p\"");
    }
    text + &on("\"all-outer\"", "dirichlet = \"exact\"")
}

#[test]
fn an_exact_solution_whose_flux_jumps_is_told_inside_of_elements_between_them_and_across_ties() {
    // inside of elements (3 of them), between elements (4), across a tie of one material and of two
    for elements in [3, 4] {
        only(&run(&kinked("if(x < 0.5, x, 2*x - 0.5)", [1.0; 2], false, elements)), "E017", &["\"a\"", "x = 0.5", "jumps"]);
    }
    only(&run(&kinked("if(x < 0.5, x, 2*x - 0.5)", [1.0; 2], true, 2)), "E017", &["interface \"i\""]);
    only(&run(&kinked("x + y", [1.0, 2.0], true, 2)), "E017", &["interface \"i\""]);
    // conductivities that go with the kink, pieces that join smoothly, no pieces
    none(&run(&kinked("if(x < 0.5, x, 2*x - 0.5)", [2.0, 1.0], true, 2)), "continuous flux");
    let smooth = run(&kinked("if(x < 0.5, 0, (x - 0.5)^3)", [1.0; 2], false, 3));
    assert!(smooth.warnings.iter().all(|w| !w.message.contains("flux")), "smooth pieces: {:?}", smooth.warnings);
    none(&run(&kinked("sin(3*x)*y", [1.0; 2], true, 4)), "no pieces");
}

/// An arch laid on a rigid disc with hardly less curvature, its feet pulled down: it stretches along the disc.
fn arch(load: f64) -> String {
    ELASTIC.to_owned()
        + "[[patch]]\nname = \"arch\"\ngeometry = { kind = \"annulus-sector\", radius = [1.01, 1.11], angle_deg = [30, 150], move = [0, -0.01] }\nelements = [40, 2]\n"
        + &on("[\"arch.u0\", \"arch.u1\"]", &format!("traction = {{ y = {:?} }}", -load))
        + &on("\"arch.v1\"", "spring = { x = 1e-3 }")
        + "[[contact]]\nname = \"disc\"\nslave = \"arch.v0\"\nrigid = { kind = \"sphere\", center = [0, 0], radius = 1.0 }\n"
}

#[test]
fn a_contact_that_slides_along_a_curve_farther_than_its_gap_allows_is_told() {
    // the arch turns by more than small kinematics allow, too
    let slid = run(&arch(5e-2));
    assert!(slid.warnings.iter().all(|w| w.code == "E065" && w.message.contains("small kinematics")), "{:?}", slid.warnings);
    assert_eq!(slid.warnings.iter().filter(|w| w.message.contains("\"disc\" slides too far")).count(), 1, "{:?}", slid.warnings);
    none(&run(&arch(1e-3)), "a light load");
}

/// Two bars of moduli 1000 and 1 in series, pulled by 1: the exact solution has a kink at the tie, which is at x = `at`; `slave` is stiff or soft.
fn bars(at: f64, stiff_is_slave: bool, form: &str) -> String {
    let sides = ["a.right", "b.left"];
    let (slave, master) = if stiff_is_slave { (sides[0], sides[1]) } else { (sides[1], sides[0]) };
    format!("[model]\nphysics = \"elasticity\"\ndimension = 2\nexact = {{ u = [\"{form}\", \"0\"] }}\n")
        + "[[material]]\nname = \"stiff\"\nyoung = 1000.0\npoisson = 0.0\n[[material]]\nname = \"soft\"\nyoung = 1.0\npoisson = 0.0\n"
        + &block("a", [0.0, 0.0], [at, 1.0], [3, 3], "material = \"stiff\"")
        + &block("b", [at, 0.0], [2.0 * at, 1.0], [2, 2], "material = \"soft\"")
        + &on("\"a.left\"", "fix = [\"x\"]")
        + &on("[\"a.bottom\", \"b.bottom\"]", "fix = [\"y\"]")
        + &on("\"b.right\"", "traction = [1.0, 0.0]")
        + &format!("[[interface]]\nname = \"i\"\nslave = \"{slave}\"\nmaster = \"{master}\"\n")
}

#[test]
fn lambda_is_that_of_the_slaves_own_piece_of_the_exact_solution() {
    for at in [1.0, 1.0 / 3.0, 1e3] {
        let [less, or_equal] = ["<", "<="].map(|word| format!("if(x {word} {at:?}, x/1000, {at:?}/1000 + x - {at:?})"));
        let minimum = format!("max(x/1000, {at:?}/1000 + x - {at:?})");
        for form in [less, or_equal, minimum] {
            for stiff in [true, false] {
                let result = run(&bars(at, stiff, &form));
                none(&result, &form);
                let found = error(&result, "error.i.lambda.L2.rel");
                assert!(found < 1e-9, "{form} {stiff}: {found:e}");
            }
        }
    }
}

/// The flux 1/r through two half rings of conductivities 3 and 1 that meet at r = 1.
fn half_rings(backend: &str, degree: usize, [inner, outer]: [usize; 2], slave: &str) -> String {
    let (slave, master) = if slave == "inner" { ("a.v1", "b.v0") } else { ("b.v0", "a.v1") };
    let ring = |name: &str, radius: [f64; 2], n: usize| {
        format!(
            "[[patch]]\nname = \"{name}\"\ngeometry = {{ kind = \"annulus-sector\", radius = {radius:?}, angle_deg = [0, 180] }}\n\
             elements = [{n}, 3]\nmaterial = \"{name}\"\n"
        )
    };
    format!(
        "[model]\nphysics = \"poisson\"\ndimension = 2\nexact = {{ u = \"if(r < 1, log(r)/3, log(r))\" }}\n\
         [discretization]\nbackend = \"{backend}\"\ndegree = {degree}\n\
         [[material]]\nname = \"a\"\nconductivity = 3.0\n[[material]]\nname = \"b\"\nconductivity = 1.0\n{}{}\
         [[interface]]\nname = \"i\"\nslave = \"{slave}\"\nmaster = \"{master}\"\n[[boundary]]\non = \"all-outer\"\ndirichlet = \"exact\"\n",
        ring("a", [0.5, 1.0], inner),
        ring("b", [1.0, 2.0], outer)
    )
}

#[test]
fn facets_that_leave_the_line_between_two_pieces_have_the_right_lambda_and_no_jump() {
    for (backend, degree) in [("iga", 2), ("fe", 1), ("fe", 2), ("fe", 3)] {
        for slave in ["inner", "outer"] {
            let of = |n: [usize; 2]| {
                let result = run(&half_rings(backend, degree, n, slave));
                none(&result, &format!("{backend} {degree} {slave} {n:?}"));
                error(&result, "error.i.lambda.L2.rel")
            };
            // a wrong piece makes the error 0.67 or 2
            let errors = [[7, 10], [14, 20], [28, 40]].map(of);
            println!("{backend} {degree} {slave}: {errors:?}");
            assert!(errors.iter().all(|e| *e < 0.02), "{backend} {degree} {slave}: {errors:?}");
        }
    }
}

#[test]
fn a_side_whose_piece_is_open_has_no_error_of_lambda_but_a_warning() {
    // quarters of a circle as single facets: how far they leave it is not told by their angles
    let result = run(&half_rings("fe", 1, [2, 2], "outer"));
    only(&result, "E017", &["\"i\"", "error.i.lambda.L2"]);
    assert!(error(&result, "error.i.lambda.L2").is_nan() && error(&result, "error.u.L2").is_finite());
    let document: serde_json::Value = serde_json::from_str(&result.to_json()).unwrap();
    assert!(document["errors"]["error.i.lambda.L2"].is_null());
    assert!(document["errors"]["reason"].as_str().unwrap().contains("pieces of `exact`"), "{}", document["errors"]);
}

/// Rings that fit exactly, squeezed evenly by a pressure.
fn fitting_rings(radius: f64, move_by: f64, young: f64) -> String {
    let ring = |name: &str, inner: f64, outer: f64| {
        format!(
            "[[patch]]\nname = \"{name}\"\ngeometry = {{ kind = \"annulus-sector\", center = [{move_by:?}, 0], radius = [{:?}, {:?}], angle_deg = [0, 90] }}\n\
             elements = [2, 1]\n",
            inner * radius,
            outer * radius
        )
    };
    format!(
        "[model]\nphysics = \"elasticity\"\ndimension = 2\n[discretization]\nbackend = \"fe\"\ndegree = 1\n[[material]]\nname = \"m\"\nyoung = {young:?}\npoisson = 0.2\n"
    ) + &ring("outer", 0.6, 1.0)
        + &ring("inner", 0.2, 0.6)
        + &on("[\"outer.u0\", \"inner.u0\"]", "fix = [\"y\"]")
        + &on("[\"outer.u1\", \"inner.u1\"]", "fix = [\"x\"]")
        + &on("\"outer.v1\"", &format!("pressure = {:?}", 1e-4 * young))
        + "[[contact]]\nname = \"c\"\nslave = \"inner.v1\"\nmaster = \"outer.v0\"\n"
}

#[test]
fn sides_that_fit_to_rounding_neither_slide_nor_leave_their_surface() {
    for (radius, move_by, young) in [(1.0, 0.0, 1e9), (1e3, 0.0, 1.0), (1e-4, 0.0, 2e11), (1.0, 300.0, 1e3)] {
        none(&run(&fitting_rings(radius, move_by, young)), &format!("{radius} {move_by} {young}"));
    }
}

/// A half cylinder, by its quarter, on a half cylinder below it; far from the zone their sides look away from each other.
fn cylinders(elements: usize, integration: &str) -> String {
    let quarter = |name: &str, y: f64, angles: [f64; 2], radius: f64, n: usize, toward: usize| {
        format!(
            "[[patch]]\nname = \"{name}\"\ngeometry = {{ kind = \"annulus-sector\", center = [0, {y:?}], radius = [{:?}, {radius:?}], angle_deg = {angles:?} }}\n\
             elements = [{n}, 12]\ngrade = {{ toward = {{ u = {toward}, v = 1 }}, ratio = 0.05 }}\n",
            0.2 * radius
        )
    };
    ELASTIC.replace("young = 1.0", "young = 1000.0")
        + &quarter("upper", 6.0, [-90.0, 0.0], 6.0, elements, 0)
        + &quarter("lower", -10.0, [0.0, 90.0], 10.0, elements * 5 / 4, 1)
        + &on("[\"upper.u0\", \"lower.u1\"]", "fix = [\"x\"]")
        + &on("\"upper.u1\"", "dirichlet = { y = \"-0.1\" }")
        + &on("\"lower.u0\"", "fix = [\"y\"]")
        + &format!(
            "[[contact]]\nname = \"c\"\nslave = \"upper.v1\"\nmaster = \"lower.v1\"\nsymmetry = true\nintegration = \"{integration}\"\n"
        )
}

#[test]
fn the_integration_of_a_contact_is_judged_where_it_is_closed() {
    for elements in [24, 32, 48] {
        let result = run(&cylinders(elements, "merged"));
        println!("{elements}: {:e}", result.contact.get("c").unwrap().consistency);
        none(&result, &format!("{elements} elements"));
    }
}

#[test]
fn coarse_facets_do_not_make_distant_sides_near() {
    // beams 100 long and 10 thick in two facets, 2.8 apart from a third that ties them
    let beams = |gap: f64| {
        ELASTIC.to_owned()
            + &block("a", [0.0, 0.0], [100.0, 10.0], [2, 3], "")
            + &block("b", [0.0, 10.0 + gap], [100.0, 20.0 + gap], [2, 3], "")
            + &block("c", [100.0, 0.0], [110.0, 20.0 + gap], [1, 5], "")
            + "[[interface]]\nname = \"i\"\nbetween = \"all\"\n"
            + &on("\"a.left\"", "fix = [\"x\", \"y\"]")
            + &on("\"b.left\"", "traction = [0, -1e-6]")
    };
    for gap in [2.8, 0.5, 6.0] {
        none(&run(&beams(gap)), &format!("{gap} apart"));
    }
    only(&run(&beams(0.05)), "E023", &["`a.top`", "`b.bottom`", "not tied"]);
}

#[test]
fn a_centre_that_is_a_point_to_rounding_is_no_side() {
    let folder = tempfile::TempDir::new().unwrap();
    for (size, off) in [(2.0, 6e-17), (2.0, 0.0), (3e5, 1e-11), (1e-6, 2e-22)] {
        let points = [[off, 0.0], [off, off], [0.0, off], [size, 0.0], [size, size], [0.0, size]];
        let list: Vec<String> = points.iter().map(|[x, y]| format!("{x:e} {y:e}")).collect();
        let file = format!(
            "<?xml version=\"1.0\"?>\n<xml><Geometry type=\"TensorNurbs2\" id=\"0\"><Basis type=\"TensorNurbsBasis2\">\
             <Basis type=\"TensorBSplineBasis2\"><Basis type=\"BSplineBasis\" index=\"0\"><KnotVector degree=\"2\">0 0 0 1 1 1</KnotVector></Basis>\
             <Basis type=\"BSplineBasis\" index=\"1\"><KnotVector degree=\"1\">0 0 1 1</KnotVector></Basis></Basis>\
             <weights>1 0.7071067811865476 1 1 0.7071067811865476 1</weights></Basis><coefs geoDim=\"2\">{}</coefs></Geometry></xml>\n",
            list.join(" ")
        );
        std::fs::write(folder.path().join("disc.xml"), file).unwrap();
        for moved in [0.0, 7.0] {
            let text = format!(
                "[model]\nphysics = \"poisson\"\ndimension = 2\nsource = \"1\"\n[[patch]]\nname = \"d\"\n\
                 geometry = {{ kind = \"file\", file = \"disc.xml\", move = [{:?}, 0] }}\nelements = [4, 4]\n\
                 [[boundary]]\non = \"all-outer\"\ndirichlet = 0\n[[probe]]\nname = \"u\"\nquantity = \"u at [{:?}, {:?}]\"\n",
                moved * size,
                (moved + 0.15) * size,
                0.15 * size
            );
            let path = folder.path().join("case.toml");
            std::fs::write(&path, &text).unwrap();
            let result = Case::read(&path).unwrap_or_else(|e| panic!("{size} {off}: {e}")).run(&Registry::default()).unwrap();
            none(&result, &text);
            assert!((result.probes[0].value / (size * size) - 0.0208159).abs() < 1e-6, "{:?}", result.probes);
            assert_eq!(result.reactions.len(), 3, "{:?}", result.reactions);
        }
    }
}
