//! Glued patches: one solution, whatever the patches' order, orientation, backend, and however many meet in a point.

use faying::linalg::Vector;
use faying_cli::Case;
use faying_cli::case::ReadOptions;
use faying_cli::errors::Diagnostics;
use faying_cli::run::run;
use faying_cli::{Finished, Parts, Registry, RunControl, RunOptions, Status};

fn read(text: &str) -> Result<Case, Diagnostics> {
    Case::parse("glue.toml", text, &ReadOptions::default())
}

fn solve(text: &str) -> Finished {
    let case = read(text).unwrap_or_else(|e| panic!("{e}\n{text}"));
    let finished = run(&case, &Registry::default(), &RunOptions::default(), &RunControl::default());
    assert_eq!(finished.result.status, Status::Ok, "{:?}\n{text}", finished.result.diagnostics);
    finished
}

fn faults(text: &str) -> Diagnostics {
    match read(text) {
        Err(found) => found,
        Ok(case) => case.run(&Registry::default()).expect_err("the case is wrong"),
    }
}

fn probe(finished: &Finished, name: &str) -> f64 {
    finished.result.probes.iter().find(|p| p.name == name).unwrap().value
}

fn error(finished: &Finished, name: &str) -> f64 {
    *finished.result.errors.get(name).unwrap()
}

/// A bilinear patch of four corners, first axis fastest.
fn quad(name: &str, corners: [[f64; 2]; 4], rest: &str) -> String {
    let [a, b, c, d] = corners.map(|p| format!("[{:?}, {:?}]", p[0], p[1]));
    format!(
        "[[patch]]\nname = \"{name}\"\ngeometry = {{ kind = \"nurbs\", degree = [1, 1], knots = [[0, 0, 1, 1], [0, 0, 1, 1]], \
         points = [{a}, {b}, {c}, {d}] }}\n{rest}\n"
    )
}

/// The symmetries of a square: the corners of the same patch seen from elsewhere.
fn turned(c: [[f64; 2]; 4], k: usize) -> [[f64; 2]; 4] {
    let flipped = if k & 1 == 1 { [c[1], c[0], c[3], c[2]] } else { c };
    let flipped = if k & 2 == 2 { [flipped[2], flipped[3], flipped[0], flipped[1]] } else { flipped };
    if k & 4 == 4 { [flipped[0], flipped[2], flipped[1], flipped[3]] } else { flipped }
}

const ELASTIC: &str = "[model]\nphysics = \"elasticity\"\ndimension = 2\n";
const STEEL: &str = "[[material]]\nname = \"m\"\nyoung = 1.0\npoisson = 0.3\n";

/// The three squares of GeoPDEs' L-shape with `joints` between them.
fn l_shape(elements: usize, joints: &str) -> String {
    let patch = |name: &str, min: &str, max: &str| {
        format!(
            "[[patch]]\nname = \"{name}\"\ngeometry = {{ kind = \"box\", min = {min}, max = {max} }}\nelements = [{elements}, {elements}]\n"
        )
    };
    format!(
        "{ELASTIC}exact = {{ u = [\"x*sin(y)\", \"x*cos(y)\"] }}\n[discretization]\ndegree = 3\n{STEEL}{}{}{}{joints}\
         [[boundary]]\non = \"all-outer\"\ndirichlet = \"exact\"\n",
        patch("a", "[-1, -1]", "[0, 0]"),
        patch("b", "[-1, 0]", "[0, 1]"),
        patch("c", "[0, 0]", "[1, 1]")
    )
}

/// Error of GeoPDEs' three-patch L-shape, geopdes ex_plane_strain_Lshaped_mp: cubic, 6 x 6 elements per patch.
const GEOPDES_L: f64 = 6.41633220768243e-07;

#[test]
fn the_glued_l_shape_has_the_error_that_geopdes_prints() {
    for joints in [
        "[[interface]]\nbetween = \"all\"\ncoupling = \"glue\"\n",
        "[[interface]]\nslave = \"a.top\"\nmaster = \"b.bottom\"\ncoupling = \"glue\"\n\
         [[interface]]\nslave = \"c.left\"\nmaster = \"b.right\"\ncoupling = \"glue\"\n",
        "[[interface]]\nslave = [\"a.top\", \"b.right\"]\nmaster = [\"b.bottom\", \"c.left\"]\ncoupling = \"glue\"\n",
    ] {
        let solved = solve(&l_shape(6, joints));
        let e = error(&solved, "error.u.L2");
        assert!((e - GEOPDES_L).abs() <= 1e-12, "{e:e}");
        // 9 functions per direction of a patch, two seams of 9
        assert_eq!(solved.result.unknowns.primal, 2 * (3 * 81 - 18));
    }
}

#[test]
fn the_tied_l_shape_stays_within_twice_the_glued_one_and_keeps_its_order() {
    for [first, second] in [[["a.top", "b.bottom"], ["c.left", "b.right"]], [["b.bottom", "a.top"], ["b.right", "c.left"]]] {
        let joints: String = [first, second].map(|[s, m]| format!("[[interface]]\nslave = \"{s}\"\nmaster = \"{m}\"\n")).concat();
        let errors = [3, 6, 12].map(|n| error(&solve(&l_shape(n, &joints)), "error.u.L2"));
        assert!(errors[1] <= 2.0 * GEOPDES_L, "{errors:?}");
        let rate = (errors[1] / errors[2]).log2();
        assert!(rate > 3.9, "rate {rate} of {errors:?}");
    }
}

/// Sectors of a regular polygon around the origin, glued; `turn` permutes the axes of each.
fn star(sectors: usize, turn: impl Fn(usize) -> usize, disc: &str, joint: &str) -> String {
    let at = |r: f64, k: f64| {
        let angle = 0.3 + 2.0 * std::f64::consts::PI * k / sectors as f64;
        [r * angle.cos(), r * angle.sin()]
    };
    let patches: String = (0..sectors)
        .map(|k| {
            let k0 = k as f64;
            let corners = [[0.0, 0.0], at(0.8, k0), at(0.8, k0 + 1.0), at(1.0, k0 + 0.5)];
            quad(&format!("p{k}"), turned(corners, turn(k)), "elements = [3, 3]")
        })
        .collect();
    format!(
        "{ELASTIC}body_force = [\"x + 1\", \"y*x\"]\n[discretization]\n{disc}{STEEL}{patches}\
         [[interface]]\nbetween = \"all\"\n{joint}[[boundary]]\non = \"all-outer\"\ndirichlet = [\"0.01*x*y\", \"0.02*x\"]\n\
         [[probe]]\nname = \"x\"\nquantity = \"u.x at [0.2, 0.1]\"\n[[probe]]\nname = \"y\"\nquantity = \"u.y at [-0.3, 0.15]\"\n"
    )
}

const GLUE: &str = "coupling = \"glue\"\n";

#[test]
fn cross_points_of_three_four_and_five_patches_do_not_depend_on_how_the_patches_lie() {
    for sectors in [3, 4, 5] {
        for disc in ["degree = 2\n", "backend = \"fe\"\ndegree = 2\n", "backend = \"fe\"\ncells = \"simplex\"\ndegree = 1\n"] {
            let straight = solve(&star(sectors, |_| 0, disc, GLUE));
            // a triangle mesh cuts along one diagonal: turn by what keeps it
            let turns: &[usize] = if disc.contains("simplex") { &[0, 3, 4, 7] } else { &[0, 1, 2, 3, 4, 5, 6, 7] };
            let mixed = solve(&star(sectors, |k| turns[(3 * k + sectors) % turns.len()], disc, GLUE));
            for name in ["x", "y"] {
                let (a, b) = (probe(&straight, name), probe(&mixed, name));
                assert!((a - b).abs() <= 1e-10 * a.abs(), "{sectors} {disc} {name}: {a:e} {b:e}");
            }
            assert_eq!(straight.result.unknowns.primal, mixed.result.unknowns.primal);
            assert!((straight.result.energy - mixed.result.energy).abs() <= 1e-12 * straight.result.energy);
        }
    }
}

#[test]
fn a_neighbour_may_be_flipped_and_rotated_in_eight_ways() {
    let plate = |k: usize| {
        let (left, right) = ([[0.0, 0.0], [1.0, 0.1], [0.1, 1.0], [0.9, 1.2]], [[1.0, 0.1], [2.0, 0.0], [0.9, 1.2], [2.1, 0.9]]);
        format!(
            "{ELASTIC}body_force = [\"1\", \"x\"]\n{STEEL}{}{}[[interface]]\nbetween = [\"l\", \"r\"]\n{GLUE}\
             [[boundary]]\non = \"l.left\"\nfix = [\"x\", \"y\"]\n[[probe]]\nname = \"x\"\nquantity = \"u.x at [2.05, 0.45]\"\n",
            quad("l", left, "elements = [4, 3]"),
            quad("r", turned(right, k), if k & 4 == 0 { "elements = [2, 3]" } else { "elements = [3, 2]" })
        )
    };
    let first = probe(&solve(&plate(0)), "x");
    assert!(first > 0.0);
    for k in 1..8 {
        let x = probe(&solve(&plate(k)), "x");
        assert!((x - first).abs() <= 1e-10 * first, "{k}: {x:e} {first:e}");
    }
}

/// A bending plate of one box, or of two glued at x = 1.
fn plate(patches: &str, boundary: &str) -> String {
    format!(
        "{ELASTIC}body_force = [\"0.2\", \"-1 + 0.1*x\"]\n[discretization]\ndegree = 2\ncontinuity = 0\n{STEEL}{patches}{boundary}\
         [[probe]]\nname = \"y\"\nquantity = \"u.y at [1.3, 0.6]\"\n"
    )
}

const ONE: &str = "[[patch]]\nname = \"a\"\ngeometry = { kind = \"box\", min = [0, 0], max = [2, 1] }\nelements = [4, 2]\n";
const TWO: &str = "[[patch]]\nname = \"a\"\ngeometry = { kind = \"box\", min = [0, 0], max = [1, 1] }\nelements = [2, 2]\n\
                   [[patch]]\nname = \"b\"\ngeometry = { kind = \"box\", min = [1, 0], max = [2, 1] }\nelements = [2, 2]\n\
                   [[interface]]\nslave = \"a.right\"\nmaster = \"b.left\"\ncoupling = \"glue\"\n";

#[test]
fn reactions_of_a_glued_body_are_those_of_the_single_patch() {
    let one = solve(&plate(ONE, "[[boundary]]\non = \"a.bottom\"\nfix = [\"x\", \"y\"]\n"));
    let two = solve(&plate(TWO, "[[boundary]]\non = [\"a.bottom\", \"b.bottom\"]\nfix = [\"x\", \"y\"]\n"));
    let half = solve(&plate(TWO, "[[boundary]]\non = \"a.bottom\"\nfix = [\"x\", \"y\"]\n"));
    assert!((probe(&one, "y") - probe(&two, "y")).abs() <= 1e-12 * probe(&one, "y").abs());
    assert!((one.result.energy - two.result.energy).abs() <= 1e-12 * one.result.energy);
    assert_eq!(one.result.unknowns.primal, two.result.unknowns.primal);
    let reaction = |f: &Finished, side: &str| f.result.reactions.get(side).unwrap().clone();
    let whole = reaction(&one, "a.bottom");
    // the load is 2 area times the force: -(0.4, -1.8)
    assert!((whole[0] + 0.4).abs() <= 1e-10 && (whole[1] - 1.8).abs() <= 1e-10, "{whole:?}");
    let (a, b) = (reaction(&two, "a.bottom"), reaction(&two, "b.bottom"));
    for c in 0..2 {
        assert!((a[c] + b[c] - whole[c]).abs() <= 1e-10, "{a:?} {b:?} {whole:?}");
        // nothing of the force across the seam
        assert!((reaction(&half, "a.bottom")[c] - whole[c]).abs() <= 1e-10);
    }
    for f in [&one, &two, &half] {
        assert!(f.result.balance.force.iter().all(|v| v.abs() <= 1e-10), "{:?}", f.result.balance);
    }
}

#[test]
fn a_closed_ring_is_two_glued_half_rings() {
    let ring = |patches: &str, inner: &str, outer: &str| {
        format!(
            "{ELASTIC}[discretization]\ndegree = 2\ncontinuity = 0\n{STEEL}{patches}[[boundary]]\non = {outer}\nfix = [\"x\", \"y\"]\n\
             [[boundary]]\non = {inner}\npressure = \"1 + 0.3*x + 0.2*y\"\n\
             [[probe]]\nname = \"x\"\nquantity = \"u.x at [1.2, 0.5]\"\n[[probe]]\nname = \"y\"\nquantity = \"u.y at [-0.4, -1.4]\"\n"
        )
    };
    let sector = |name: &str, from: f64, to: f64, n: usize, rest: &str| {
        format!(
            "[[patch]]\nname = \"{name}\"\ngeometry = {{ kind = \"annulus-sector\", center = [0, 0], radius = [1, 2], angle_deg = [{from}, {to}] }}\n\
             elements = [{n}, 3]\n{rest}"
        )
    };
    let closed = solve(&ring(&sector("a", 0.0, 360.0, 8, "closed = \"u\"\n"), "\"a.v0\"", "\"a.v1\""));
    let halves = sector("a", 0.0, 180.0, 4, "") + &sector("b", 180.0, 360.0, 4, "") + "[[interface]]\nbetween = \"all\"\n" + GLUE;
    let halves = solve(&ring(&halves, "[\"a.v0\", \"b.v0\"]", "[\"a.v1\", \"b.v1\"]"));
    for name in ["x", "y"] {
        let (a, b) = (probe(&closed, name), probe(&halves, name));
        assert!((a - b).abs() <= 1e-10 * a.abs(), "{name}: {a:e} {b:e}");
    }
    assert_eq!(closed.result.unknowns.primal, halves.result.unknowns.primal);
    let sum = |f: &Finished| f.result.reactions.iter().fold([0.0; 2], |s, (_, r)| [s[0] + r[0], s[1] + r[1]]);
    let (a, b) = (sum(&closed), sum(&halves));
    assert!((0..2).all(|c| (a[c] - b[c]).abs() <= 1e-10), "{a:?} {b:?}");
}

/// Two closed rings, the inner one turned by 37 degrees, and what presses or ties them.
fn rings(backend: &str, degree: usize, n: usize, model: &str, rest: &str) -> String {
    let across = n / 4;
    let patch = |name: &str, radius: [f64; 2], from: f64, n: usize| {
        let to = from + 360.0;
        format!(
            "[[patch]]\nname = \"{name}\"\ngeometry = {{ kind = \"annulus-sector\", radius = {radius:?}, angle_deg = [{from}, {to}] }}\nclosed = \"u\"\nelements = [{n}, {across}]\n"
        )
    };
    let discretization = format!("[discretization]\nbackend = \"{backend}\"\ndegree = {degree}\nmapping = \"exact\"\n");
    format!("{model}{discretization}{}{}{rest}", patch("i", [0.2, 0.6], 37.0, n + n / 4), patch("o", [0.6, 1.0], 0.0, n))
}

#[test]
fn a_multiplier_on_a_closed_side_closes_too() {
    let model = "[model]\nphysics = \"poisson\"\ndimension = 2\nexact = { u = \"exp(0.7*x)*sin(y) + x*y\" }\n";
    let tie = "[[interface]]\nname = \"k\"\nslave = \"o.v0\"\nmaster = \"i.v1\"\nmultiplier = \"p/p\"\n\
               [[boundary]]\non = [\"i.v0\", \"o.v1\"]\ndirichlet = \"exact\"\n";
    // functions on the closed side: one per node of Lagrange lines; splines are smooth but across the four arcs
    for (backend, degree, functions) in [("fe", 1, 48), ("fe", 2, 96), ("iga", 2, 48 + 4)] {
        let errors = [48, 96].map(|n| {
            let run = solve(&rings(backend, degree, n, model, tie));
            if n == 48 {
                assert_eq!(run.result.unknowns.multipliers, functions, "{backend} {degree}");
            }
            error(&run, "error.k.lambda.L2")
        });
        // the seed's bound is p - 1/2; one multiplier too many where the side closes left an error that does not fall
        let rate = (errors[0] / errors[1]).log2();
        assert!(rate > degree as f64 - 0.1, "{backend} {degree}: {errors:?} fall with order {rate}");
    }
}

#[test]
fn closed_rings_press_each_other_evenly_where_they_close() {
    let model = "[model]\nphysics = \"elasticity\"\ndimension = 2\n[[material]]\nname = \"m\"\nyoung = 1e9\npoisson = 0.2\n";
    let contact = "[[contact]]\nname = \"k\"\nslave = \"o.v0\"\nmaster = \"i.v1\"\nmultiplier = \"p/p\"\n\
                   [[boundary]]\non = \"o.v1\"\npressure = \"1e7 + 1e5*cos(2*theta)\"\n\
                   [[boundary]]\non = [\"i.v0\", \"o.v1\"]\nspring = { x = 1, y = 1 }\n\
                   [[probe]]\nname = \"seam\"\nquantity = \"contact.k.pressure at [0.6, 0]\"\n";
    // code_aster SSNP167: pressure 9259259.259259 + 135717.909691 cos 2t
    let pressure = 9_259_259.259_259 + 135_717.909_691;
    for (backend, degree) in [("fe", 2), ("iga", 2), ("fe", 1)] {
        let run = solve(&rings(backend, degree, 40, model, contact));
        let off = probe(&run, "seam") / pressure - 1.0;
        assert!(off.abs() < 5e-3, "{backend} {degree}: {off:e}");
    }
}

/// Values of the displacement at points inside every element, patch after patch.
fn values(finished: &Finished) -> Vec<f64> {
    let xi: Vec<Vector<2>> = [[0.1, 0.2], [0.5, 0.5], [0.9, 0.3]].map(Vector::from).to_vec();
    let Parts::Plane(parts) = &finished.output.as_ref().unwrap().parts else { panic!("a case in the plane") };
    parts.iter().flat_map(|part| (0..part.space.num_elements()).flat_map(|e| (part.fields[0].sample)(e, &xi)).collect::<Vec<_>>()).collect()
}

#[test]
fn twins_stay_twins_when_glued_also_one_of_each() {
    let [iga, fe] = ["continuity = 0\nbasis = \"b-spline\"\n", "backend = \"fe\"\nmapping = \"exact\"\n"];
    for degree in [1, 2, 3] {
        let case = |left: &str, right: &str| {
            let sector = |name: &str, from: f64, to: f64, disc: &str| {
                format!(
                    "[[patch]]\nname = \"{name}\"\ngeometry = {{ kind = \"annulus-sector\", center = [0, 0], radius = [1, 2], \
                     angle_deg = [{from}, {to}] }}\nelements = [3, 2]\ndegree = {degree}\n{disc}"
                )
            };
            format!(
                "{ELASTIC}body_force = [\"x\", \"1\"]\n{STEEL}{}{}[[interface]]\nslave = \"a.u1\"\nmaster = \"b.u0\"\n{GLUE}\
                 [[boundary]]\non = \"a.u0\"\nfix = [\"x\", \"y\"]\n[[boundary]]\non = \"b.v1\"\npressure = \"x*y\"\n",
                sector("a", 0.0, 60.0, left),
                sector("b", 60.0, 150.0, right)
            )
        };
        let first = values(&solve(&case(iga, iga)));
        let largest = first.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        for (left, right) in [(fe, fe), (iga, fe), (fe, iga)] {
            let other = values(&solve(&case(left, right)));
            let d = first.iter().zip(&other).fold(0.0_f64, |m, (a, b)| m.max((a - b).abs()));
            assert!(d <= 1e-10 * largest, "degree {degree}: {d:e}");
        }
    }
}

#[test]
fn what_cannot_be_glued_says_why() {
    let two = |first: &str, second: &str, rest: &str| {
        format!(
            "{ELASTIC}{STEEL}[[patch]]\nname = \"a\"\ngeometry = {{ kind = \"box\", min = [0, 0], max = [1, 1] }}\n{first}\
             [[patch]]\nname = \"b\"\n{second}[[interface]]\nname = \"s\"\nslave = \"a.right\"\nmaster = \"b.left\"\ncoupling = \"glue\"\n{rest}\
             [[boundary]]\non = \"a.left\"\nfix = [\"x\", \"y\"]\n"
        )
    };
    let neighbour = |x: f64| format!("geometry = {{ kind = \"box\", min = [{x:?}, 0], max = [2, 1] }}\n");
    let cases = [
        (two("elements = [2, 3]\n", &(neighbour(1.25) + "elements = [2, 3]\n"), ""), "E023", "up to 0.25 apart (at x = 1, y = "),
        (two("elements = [2, 3]\n", &(neighbour(1.0) + "elements = [2, 4]\n"), ""), "E015", "their grids do not match at element 0"),
        (two("elements = [2, 3]\n", &(neighbour(1.0) + "elements = [2, 3]\ndegree = 3\n"), ""), "E015", "degree 2 against 3"),
        (two("elements = [2, 3]\n", &(neighbour(1.0) + "elements = [2, 3]\ncontinuity = 0\n"), ""), "E015", "continuity"),
        (
            two("elements = [2, 3]\n", &(neighbour(1.0) + "elements = [2, 3]\n"), "multiplier = \"p/p\"\n"),
            "E015",
            "`multiplier` is a key of couplings with a multiplier",
        ),
    ];
    for (text, code, words) in cases {
        let found = faults(&text);
        let first = &found.items[0];
        assert!(first.code == code && first.message.contains(words), "{found}");
    }
}

/// A block pressed on a body by a displacement of its top; LOWER and UPPER stand for patches and their sides.
fn pressed(lower: &str, upper: &str, contact: &str, base: &str, top: &str) -> String {
    format!(
        "{ELASTIC}[discretization]\ndegree = 2\ncontinuity = 0\n{STEEL}{lower}{upper}{contact}\
         [[boundary]]\non = {base}\nfix = [\"x\", \"y\"]\n[[boundary]]\non = {top}\ndirichlet = [\"0.01\", \"-0.05 - 0.02*x\"]\n"
    )
}

fn block(name: &str, min: [f64; 2], max: [f64; 2], elements: [usize; 2]) -> String {
    format!("[[patch]]\nname = \"{name}\"\ngeometry = {{ kind = \"box\", min = {min:?}, max = {max:?} }}\nelements = {elements:?}\n")
}

#[test]
fn a_block_across_the_seam_of_two_masters_is_pressed_as_on_one_patch() {
    let whole = block("l", [0.0, 0.0], [2.0, 1.0], [4, 2]);
    let straight = block("l", [0.0, 0.0], [1.0, 1.0], [2, 2]) + &block("r", [1.0, 0.0], [2.0, 1.0], [2, 2]);
    // the right half runs the other way and upwards first
    let corners = turned([[1.0, 0.0], [2.0, 0.0], [1.0, 1.0], [2.0, 1.0]], 7);
    let other = block("l", [0.0, 0.0], [1.0, 1.0], [2, 2]) + &quad("r", corners, "elements = [2, 2]");
    let top_of_other = "r.u0";
    for (from, to) in [(0.55, 1.45), (0.9, 1.7), (0.13, 1.03)] {
        let upper = block("up", [from, 1.0], [to, 1.6], [5, 2]);
        let contact = |master: &str| format!("[[contact]]\nname = \"c\"\nslave = \"up.bottom\"\nmaster = {master}\n");
        let one = solve(&pressed(&whole, &upper, &contact("\"l.top\""), "\"l.bottom\"", "\"up.top\""));
        let glued = |lower: &str, masters: &str, base: &str| {
            let joint = "[[interface]]\nbetween = [\"l\", \"r\"]\n".to_owned() + GLUE;
            solve(&pressed(&(lower.to_owned() + &joint), &upper, &contact(masters), base, "\"up.top\""))
        };
        let two = glued(&straight, "[\"l.top\", \"r.top\"]", "[\"l.bottom\", \"r.bottom\"]");
        let swapped = glued(&straight, "[\"r.top\", \"l.top\"]", "[\"l.bottom\", \"r.bottom\"]");
        let turned = glued(&other, &format!("[\"l.top\", \"{top_of_other}\"]"), "[\"l.bottom\", \"r.u1\"]");
        let c = |f: &Finished| f.result.contact.get("c").unwrap().clone();
        let a = c(&one);
        assert!(a.force[1] > 1e-3 && a.active > 0, "{a:?}");
        for b in [c(&two), c(&swapped), c(&turned)] {
            // nothing of the slave side is lost at the seam
            assert!((b.segments.measure - (to - from)).abs() <= 1e-12, "{}", b.segments.measure);
            for k in 0..2 {
                assert!((a.force[k] - b.force[k]).abs() <= 1e-9 * a.force[1], "{:?} {:?}", a.force, b.force);
            }
            assert!((a.pressure.max - b.pressure.max).abs() <= 1e-9 * a.pressure.max);
            assert_eq!(a.active, b.active);
        }
    }
}

#[test]
fn a_glued_pair_of_slaves_is_pressed_as_one_patch() {
    let lower = block("l", [0.0, 0.0], [2.0, 1.0], [7, 2]);
    let contact =
        |slaves: &str, psi: &str| format!("[[contact]]\nname = \"c\"\nslave = {slaves}\nmaster = \"l.top\"\nmultiplier = \"{psi}\"\n");
    let upper = block("a", [0.2, 1.0], [1.8, 1.6], [4, 2]);
    let halves = block("a", [0.2, 1.0], [1.0, 1.6], [2, 2])
        + &block("b", [1.0, 1.0], [1.8, 1.6], [2, 2])
        + "[[interface]]\nslave = \"a.right\"\nmaster = \"b.left\"\n"
        + GLUE;
    // p/p-2 of a C^0 trace is discontinuous: the same multipliers on one side and on two
    let one = solve(&pressed(&lower, &upper, &contact("\"a.bottom\"", "p/p-2"), "\"l.bottom\"", "\"a.top\""));
    let tops = "[\"a.top\", \"b.top\"]";
    let two = solve(&pressed(&lower, &halves, &contact("[\"a.bottom\", \"b.bottom\"]", "p/p-2"), "\"l.bottom\"", tops));
    let c = |f: &Finished| f.result.contact.get("c").unwrap().clone();
    let (a, b) = (c(&one), c(&two));
    assert!((a.force[1] - b.force[1]).abs() <= 1e-9 * a.force[1] && a.active == b.active, "{a:?} {b:?}");
    assert!((a.pressure.max - b.pressure.max).abs() <= 1e-9 * a.pressure.max);
    // p/p has a multiplier per function: one of the sides is lowered where they share one, and the system stays regular
    let full = solve(&pressed(&lower, &halves, &contact("[\"a.bottom\", \"b.bottom\"]", "p/p"), "\"l.bottom\"", tops));
    let f = c(&full);
    assert!((a.force[1] - f.force[1]).abs() <= 0.01 * a.force[1], "{a:?} {f:?}");
    assert_eq!(full.result.unknowns.multipliers, 2 * 5 - 1);
}

#[test]
fn a_mortar_tie_may_end_on_a_glued_seam() {
    // an exact linear field through a seam and two ties: p/p is lowered where both slaves share a function
    let case = |psi: &str, lists: [&str; 2]| {
        let [slaves, masters] = lists;
        format!(
            "{ELASTIC}exact = {{ u = [\"0.1*x + 0.2*y\", \"0.3*x - 0.1*y\"] }}\n{STEEL}{}{}{}\
             [[interface]]\nname = \"g\"\nslave = \"a.right\"\nmaster = \"b.left\"\n{GLUE}\
             [[interface]]\nname = \"m\"\nslave = {slaves}\nmaster = {masters}\nmultiplier = \"{psi}\"\n\
             [[boundary]]\non = \"all-outer\"\ndirichlet = \"exact\"\n",
            block("l", [0.0, 0.0], [2.0, 1.0], [5, 2]),
            block("a", [0.0, 1.0], [1.1, 2.0], [3, 3]),
            block("b", [1.1, 1.0], [2.0, 2.0], [4, 3])
        )
    };
    for psi in ["p/p", "p/p-2"] {
        for lists in [["[\"a.bottom\", \"b.bottom\"]", "\"l.top\""], ["\"l.top\"", "[\"a.bottom\", \"b.bottom\"]"]] {
            let solved = solve(&case(psi, lists));
            assert!(error(&solved, "error.u.L2") <= 1e-11, "{psi} {lists:?}: {:e}", error(&solved, "error.u.L2"));
        }
    }
}

#[test]
fn between_ties_what_touches_with_the_finer_side_as_slave() {
    let case = |joint: &str| {
        format!(
            "{ELASTIC}exact = {{ u = [\"0.1*x + 0.2*y\", \"0.3*x - 0.1*y\"] }}\n{STEEL}{}{}{}{}{joint}\
             [[boundary]]\non = \"all-outer\"\ndirichlet = \"exact\"\n",
            block("a", [0.0, 0.0], [1.0, 1.0], [4, 3]),
            block("b", [1.0, 0.0], [2.0, 1.0], [3, 5]),
            block("c", [0.0, 1.0], [2.0, 2.0], [5, 2]),
            // touches nothing but a corner
            block("d", [2.0, -1.0], [3.0, 0.0], [2, 2])
        )
    };
    let solved = solve(&case("[[interface]]\nname = \"m\"\nbetween = \"all\"\n"));
    assert!(error(&solved, "error.u.L2") <= 1e-11);
    let m = solved.result.interface.get("m").unwrap();
    assert!((m.segments.measure - 3.0).abs() <= 1e-12, "{}", m.segments.measure);
    // slaves: b.left with 5 elements, and a.top with b.top, 7 elements, against c.bottom with 5;
    // p/p-2 = p/0 per component
    assert_eq!(solved.result.unknowns.multipliers, 2 * (5 + 4 + 3));
    // a pair that is named is not found again
    let named = "[[interface]]\nname = \"m\"\nbetween = \"all\"\n[[interface]]\nname = \"n\"\nslave = \"a.right\"\nmaster = \"b.left\"\n";
    let solved = solve(&case(named));
    assert!((solved.result.interface.get("m").unwrap().segments.measure - 2.0).abs() <= 1e-12);
    assert!((solved.result.interface.get("n").unwrap().segments.measure - 1.0).abs() <= 1e-12);
    let found = faults(&case("[[interface]]\nname = \"m\"\nbetween = [\"a\", \"d\"]\n"));
    assert!(found.items[0].code == "E023" && found.items[0].message.contains("touch"), "{found}");
}

/// The corners of the unit cube, deformed, first axis fastest.
fn corner(c: usize) -> [f64; 3] {
    let x: [f64; 3] = std::array::from_fn(|k| (c >> k & 1) as f64);
    [x[0] + 0.1 * x[1] * x[2], x[1] - 0.1 * x[0], x[2] + 0.15 * x[0] * x[1]]
}

/// A trilinear patch over a part of the cube; its axes are those of the cube in the order `order`, `flip` turns them round.
fn brick(name: &str, lo: [f64; 3], hi: [f64; 3], order: [usize; 3], flip: usize, elements: [usize; 3]) -> String {
    let point = |c: usize| -> [f64; 3] {
        let xi: [f64; 3] = {
            let mut xi = [0.0; 3];
            for k in 0..3 {
                xi[order[k]] = if (c >> k ^ flip >> k) & 1 == 1 { hi[order[k]] } else { lo[order[k]] };
            }
            xi
        };
        let mut x = [0.0; 3];
        for c in 0..8 {
            let weight: f64 = (0..3).map(|k| if c >> k & 1 == 1 { xi[k] } else { 1.0 - xi[k] }).product();
            (0..3).for_each(|k| x[k] += weight * corner(c)[k]);
        }
        x
    };
    let points: Vec<String> = (0..8).map(|c| format!("{:?}", point(c))).collect();
    let elements: Vec<usize> = (0..3).map(|k| elements[order[k]]).collect();
    format!(
        "[[patch]]\nname = \"{name}\"\ngeometry = {{ kind = \"nurbs\", degree = [1, 1, 1], knots = [[0, 0, 1, 1], [0, 0, 1, 1], [0, 0, 1, 1]], \
         points = [{}] }}\nelements = {elements:?}\n",
        points.join(", ")
    )
}

const ORDERS: [[usize; 3]; 6] = [[0, 1, 2], [1, 2, 0], [2, 0, 1], [0, 2, 1], [1, 0, 2], [2, 1, 0]];

#[test]
fn eight_boxes_in_any_orientation_are_one_box() {
    let case = |disc: &str, patches: &str, joint: &str| {
        format!(
            "[model]\nphysics = \"elasticity\"\ndimension = 3\nbody_force = [\"x\", \"1\", \"-y\"]\n[discretization]\n{disc}{STEEL}{patches}{joint}\
             [[boundary]]\non = \"all-outer\"\ndirichlet = [\"0.01*x*y\", \"0\", \"0.02*x\"]\n\
             [[probe]]\nname = \"x\"\nquantity = \"u.x at [0.45, 0.31, 0.62]\"\n[[probe]]\nname = \"y\"\nquantity = \"u.y at [0.7, 0.55, 0.4]\"\n"
        )
    };
    for (disc, elements) in
        [("degree = 2\ncontinuity = 0\n", 2), ("backend = \"fe\"\ndegree = 2\n", 2), ("backend = \"fe\"\ndegree = 1\n", 4)]
    {
        let one = solve(&case(disc, &brick("a", [0.0; 3], [1.0; 3], [0, 1, 2], 0, [elements; 3]), ""));
        for seed in [1, 2] {
            let patches: String = (0..8usize)
                .map(|p| {
                    let lo: [f64; 3] = std::array::from_fn(|k| 0.5 * (p >> k & 1) as f64);
                    let hi = lo.map(|v| v + 0.5);
                    brick(&format!("p{p}"), lo, hi, ORDERS[(5 * p + seed) % 6], (3 * p * seed + p / 2) % 8, [elements / 2; 3])
                })
                .collect();
            let eight = solve(&case(disc, &patches, "[[interface]]\nbetween = \"all\"\ncoupling = \"glue\"\n"));
            assert_eq!(eight.result.unknowns.primal, one.result.unknowns.primal);
            for name in ["x", "y"] {
                let (a, b) = (probe(&one, name), probe(&eight, name));
                assert!((a - b).abs() <= 1e-10 * a.abs(), "{disc} {seed} {name}: {a:e} {b:e}");
            }
            let sum = |f: &Finished| f.result.reactions.iter().fold([0.0; 3], |s, (_, r)| std::array::from_fn(|k| s[k] + r[k]));
            let (a, b) = (sum(&one), sum(&eight));
            assert!((0..3).all(|k| (a[k] - b[k]).abs() <= 1e-9), "{a:?} {b:?}");
        }
    }
}

#[test]
fn a_long_list_of_glued_patches_stays_one_body() {
    // a chain of twelve squares, named in no order, one body for the supports
    let patches: String =
        (0..12).map(|k| 5 * k % 12).map(|k| block(&format!("p{k}"), [f64::from(k), 0.0], [f64::from(k) + 1.0, 1.0], [1, 1])).collect();
    let text = format!(
        "{ELASTIC}{STEEL}{patches}[[interface]]\nbetween = \"all\"\n{GLUE}[[boundary]]\non = \"p0.left\"\nfix = [\"x\", \"y\"]\n\
         [[boundary]]\non = \"p11.right\"\ntraction = [\"1\", \"0\"]\n"
    );
    let solved = solve(&text);
    let r = solved.result.reactions.get("p0.left").unwrap();
    assert!((r[0] + 1.0).abs() <= 1e-10 && r[1].abs() <= 1e-9, "{r:?}");
    // without the support the first patch speaks for the body
    let free = faults(&text.replace("on = \"p0.left\"\nfix = [\"x\", \"y\"]", "on = \"p0.left\"\nfix = [\"x\"]"));
    assert!(free.items[0].code == "E051" && free.items.len() == 1, "{free}");
}

#[test]
fn prescribed_values_meet_at_glued_corners_or_are_refused() {
    let held = |a: &str, b: &str| {
        plate(TWO, &format!("[[boundary]]\non = \"a.bottom\"\ndirichlet = {a}\n[[boundary]]\non = \"b.bottom\"\ndirichlet = {b}\n"))
    };
    // one formula that is met by both, corner included: the field of the single patch
    let (f, whole) = ("[\"0.1*x^2\", \"0.2*x\"]", "[[boundary]]\non = \"a.bottom\"\ndirichlet = [\"0.1*x^2\", \"0.2*x\"]\n");
    let (one, two) = (solve(&plate(ONE, whole)), solve(&held(f, f)));
    assert!((probe(&one, "y") - probe(&two, "y")).abs() <= 1e-12 * probe(&one, "y").abs());
    // different formulas with one value at the corner (1, 0)
    solve(&held("[\"0.1*x\", \"0\"]", "[\"0.1\", \"0\"]"));
    let found = faults(&held("[\"0.1*x\", \"0\"]", "[\"0.2\", \"0\"]"));
    assert!(found.items[0].code == "E052" && found.items[0].message.contains("common point (1, 0)"), "{found}");
}

#[test]
fn a_seam_of_two_backends_in_space_is_no_seam() {
    let [iga, fe] = ["continuity = 0\nbasis = \"b-spline\"\n", "backend = \"fe\"\nmapping = \"exact\"\n"];
    let low = |name: &str, disc: &str| brick(name, [0.0; 3], [0.5, 1.0, 1.0], [0, 1, 2], 0, [2, 2, 2]) + disc;
    let high = |name: &str, disc: &str| brick(name, [0.5, 0.0, 0.0], [1.0; 3], [0, 1, 2], 0, [2, 2, 2]) + disc;
    let joint = "[[interface]]\nslave = \"a.right\"\nmaster = \"b.left\"\ncoupling = \"glue\"\n";
    // the bottom is prescribed up to the seam's edge on both; the tops, glued too, sink as one
    let case = |degree: usize, patches: &str, bottoms: &str, tops: &str| {
        format!(
            "[model]\nphysics = \"elasticity\"\ndimension = 3\nbody_force = [\"x\", \"1\", \"-y\"]\n[discretization]\ndegree = {degree}\n{STEEL}{patches}\
             [[boundary]]\non = [{bottoms}]\ndirichlet = [\"0.01*x*y\", \"0\", \"0.02*x\"]\n[[boundary]]\non = [{tops}]\nrigid_force = {{ z = -0.3 }}\n\
             [[probe]]\nname = \"x\"\nquantity = \"u.x at [0.45, 0.31, 0.62]\"\n[[probe]]\nname = \"y\"\nquantity = \"u.y at [0.7, 0.55, 0.4]\"\n\
             [[probe]]\nname = \"z\"\nquantity = \"u.z at [1.05, 0.4, 1.06]\"\n"
        )
    };
    for degree in [1, 2, 3] {
        let one = brick("a", [0.0; 3], [1.0; 3], [0, 1, 2], 0, [4, 2, 2]);
        let one = solve(&case(degree, &(one + iga), "\"a.bottom\"", "\"a.top\""));
        let whole = one.result.reactions.get("a.w0").unwrap().clone();
        for (left, right) in [(iga, iga), (iga, fe), (fe, iga), (fe, fe)] {
            let patches = low("a", left) + &high("b", right) + joint;
            let two = solve(&case(degree, &patches, "\"a.bottom\", \"b.bottom\"", "\"a.top\", \"b.top\""));
            assert_eq!(two.result.unknowns.primal, one.result.unknowns.primal);
            for name in ["x", "y", "z"] {
                let (a, b) = (probe(&one, name), probe(&two, name));
                assert!((a - b).abs() <= 1e-10 * a.abs(), "degree {degree}, {left}{right}{name}: {a:e} {b:e}");
            }
            assert!((one.result.energy - two.result.energy).abs() <= 1e-10 * one.result.energy);
            let of = |side: &str| two.result.reactions.get(side).unwrap().clone();
            let (a, b) = (of("a.w0"), of("b.w0"));
            assert!((0..3).all(|k| (a[k] + b[k] - whole[k]).abs() <= 1e-10), "{a:?} {b:?} {whole:?}");
            assert!(two.result.balance.force.iter().all(|v| v.abs() <= 1e-10), "{:?}", two.result.balance);
        }
    }
}

#[test]
fn glued_sides_of_a_list_sink_as_one() {
    let top = |sides: &str| format!("[[boundary]]\non = {sides}\nrigid_force = {{ y = -0.7 }}\n");
    let held = |sides: &str| format!("[[boundary]]\non = {sides}\nfix = [\"x\", \"y\"]\n");
    let one = solve(&plate(ONE, &(held("\"a.bottom\"") + &top("\"a.top\""))));
    let two = solve(&plate(TWO, &(held("[\"a.bottom\", \"b.bottom\"]") + &top("[\"a.top\", \"b.top\"]"))));
    assert!((probe(&one, "y") - probe(&two, "y")).abs() <= 1e-12 * probe(&one, "y").abs());
    let of = |f: &Finished, side: &str| f.result.reactions.get(side).unwrap().clone();
    let (whole, a, b) = (of(&one, "a.bottom"), of(&two, "a.bottom"), of(&two, "b.bottom"));
    // force 0.7 down and the load of two squares: (0.4, -1.8)
    assert!((whole[0] + 0.4).abs() <= 1e-10 && (whole[1] - 2.5).abs() <= 1e-10, "{whole:?}");
    assert!((0..2).all(|k| (a[k] + b[k] - whole[k]).abs() <= 1e-10), "{a:?} {b:?}");
}

#[test]
fn values_that_no_seam_can_carry_are_prescribed_on_both_of_its_sides() {
    let [iga, fe] = ["continuity = 0\nbasis = \"b-spline\"\n", "backend = \"fe\"\nmapping = \"exact\"\n"];
    let case = |left: &str, right: &str, u: &str| {
        let low = brick("a", [0.0; 3], [0.5, 1.0, 1.0], [0, 1, 2], 0, [2, 2, 2]) + left;
        let high = brick("b", [0.5, 0.0, 0.0], [1.0; 3], [0, 1, 2], 0, [2, 2, 2]) + right;
        format!(
            "[model]\nphysics = \"poisson\"\ndimension = 3\nexact = {{ u = \"{u}\" }}\n[discretization]\ndegree = 2\n{low}{high}\
             [[interface]]\nslave = \"a.right\"\nmaster = \"b.left\"\ncoupling = \"glue\"\n[[boundary]]\non = \"all-outer\"\ndirichlet = \"exact\"\n"
        )
    };
    for u in ["sin(x)*y", "exp(x + y + z)", "1e-18*sin(9*x*y)"] {
        let same = error(&solve(&case(iga, iga, u)), "error.u.L2");
        for (left, right) in [(iga, fe), (fe, iga), (fe, fe)] {
            let mixed = error(&solve(&case(left, right, u)), "error.u.L2");
            assert!(mixed < 1.05 * same, "{left}{right}{u}: {mixed:e} {same:e}");
        }
    }
}

#[test]
fn the_result_tells_which_sides_are_glued_and_how_much_of_them() {
    let joints = "[[interface]]\nname = \"seam\"\nbetween = \"all\"\ncoupling = \"glue\"\n";
    let finished = solve(&l_shape(4, joints));
    let glued = &finished.result.geometry.glued;
    let mut pairs: Vec<[&str; 2]> = glued.iter().map(|g| [g.sides.slave.as_str(), g.sides.master.as_str()]).collect();
    pairs.iter_mut().for_each(|p| p.sort_unstable());
    pairs.sort_unstable();
    assert_eq!(pairs, [["a.top", "b.bottom"], ["b.right", "c.left"]]);
    for g in glued {
        assert_eq!(g.interface, "seam");
        assert!(g.sides.distance < 1e-12 && (g.sides.share - 1.0).abs() < 1e-12, "{g:?}");
    }
}
