//! Contact of two bodies in space from case files.

use faying_cli::case::ReadOptions;
use faying_cli::{Case, Registry, RunResult};

fn run(text: &str) -> RunResult {
    let case = Case::parse("case.toml", text, &ReadOptions::default()).unwrap_or_else(|e| panic!("{e}\n{text}"));
    let result = case.run(&Registry::default()).unwrap_or_else(|e| panic!("{e}\n{text}"));
    assert_eq!(result.exit, 0, "{:?}\n{text}", result.diagnostics);
    result
}

const HEAD: &str = "[model]\nphysics = \"elasticity\"\ndimension = 3\n[discretization]\nbackend = \"iga\"\ndegree = 2\n\
    [[material]]\nname = \"m\"\nyoung = 1000.0\npoisson = 0.3\n";

/// Two blocks on grids that do not match, pressed by 2; `cells` are those of both, `keys` those of the contact.
fn stacked(cells: [&str; 2], keys: &str) -> String {
    let patch = |name: &str, z: [f64; 2], elements: &str, cells: &str| {
        format!(
            "[[patch]]\nname = \"{name}\"\ngeometry = {{ kind = \"box\", min = [0, 0, {}], max = [1, 1, {}] }}\nelements = {elements}\n{cells}\n",
            z[0], z[1]
        )
    };
    HEAD.to_owned()
        + &patch("lower", [0.0, 0.5], "[4, 4, 2]", cells[0])
        + &patch("upper", [0.5, 1.0], "[3, 3, 2]", cells[1])
        + "[[boundary]]\non = \"lower.bottom\"\nfix = [\"z\"]\n[[boundary]]\non = [\"lower.left\", \"upper.left\"]\nfix = [\"x\"]\n\
           [[boundary]]\non = [\"lower.front\", \"upper.front\"]\nfix = [\"y\"]\n[[boundary]]\non = \"upper.top\"\npressure = 2.0\n\
           [[probe]]\nname = \"uz\"\nquantity = \"u.z at [0.3, 0.4, 1]\"\n"
        + &format!("[[contact]]\nname = \"c\"\n{keys}\n")
}

#[test]
fn a_uniform_pressure_passes_between_all_pairs_by_every_method() {
    let cells = ["backend = \"iga\"", "backend = \"fe\"", "backend = \"fe\"\ncells = \"simplex\""];
    let roles = ["slave = \"upper.bottom\"\nmaster = \"lower.top\"", "slave = \"lower.top\"\nmaster = \"upper.bottom\""];
    for (k, (a, b)) in cells.iter().flat_map(|a| cells.iter().map(move |b| (a, b))).enumerate() {
        for method in ["lagrange\"\nintegration = \"merged", "lagrange\"\nintegration = \"mixed", "augmented", "nitsche"] {
            let result = run(&stacked([a, b], &format!("method = \"{method}\"\n{}", roles[k % 2])));
            let found = result.contact.get("c").unwrap();
            assert!((found.pressure.max - 2.0).abs() < 1e-8 && (found.pressure.min - 2.0).abs() < 1e-8, "{a} {b} {method}: {found:?}");
            assert!((found.force[2].abs() - 2.0).abs() < 1e-10 && (found.area - 1.0).abs() < 1e-10, "{a} {b} {method}: {found:?}");
            let segments = &found.segments;
            assert!(segments.lost == Some(0) && segments.outside.is_some_and(|out| out < 1e-9), "{a} {b} {method}: {segments:?}");
            let uz = result.probes[0].value;
            assert!((uz + 2e-3).abs() < 1e-9, "{a} {b} {method}: {uz}");
        }
    }
}

/// Between kinked sides across a gap points lie outside of their master cell, by as much as the fan of the kink is wide; both numbers are
/// quantities.
#[test]
fn how_far_points_lie_outside_of_their_cells_is_told() {
    // a ridge of two planes that rise by 1 in 5 to y = 0.5, below a plane at 0.1 above it: the normals of each face leave the ridge by 0.1 * 0.2
    let half = |name: &str, y: [f64; 2], z: [f64; 2]| {
        let corner = |c: usize| format!("[{}, {}, {}]", c % 2, y[c / 2 % 2], if c < 4 { -0.5 } else { z[c / 2 % 2] });
        let points: Vec<String> = (0..8).map(corner).collect();
        let knots = "[[0, 0, 1, 1], [0, 0, 1, 1], [0, 0, 1, 1]]";
        format!(
            "[[patch]]\nname = \"{name}\"\ngeometry = {{ kind = \"nurbs\", degree = [1, 1, 1], knots = {knots}, points = [{}] }}\nelements = [2, 2, 1]\n",
            points.join(", ")
        )
    };
    let text = HEAD.to_owned()
        + &half("front", [0.0, 0.5], [-0.1, 0.0])
        + &half("back", [0.5, 1.0], [0.0, -0.1])
        + "[[patch]]\nname = \"upper\"\ngeometry = { kind = \"box\", min = [0, 0.1, 0.1], max = [1, 0.9, 0.4] }\nelements = [3, 5, 1]\n\
           [[interface]]\nname = \"glued\"\ncoupling = \"glue\"\nslave = \"front.v1\"\nmaster = \"back.v0\"\n\
           [[boundary]]\non = [\"front.bottom\", \"back.bottom\"]\nfix = [\"x\", \"y\", \"z\"]\n\
           [[boundary]]\non = \"upper.top\"\ndirichlet = { x = 0, y = 0, z = -0.12 }\n\
           [[contact]]\nname = \"c\"\nslave = \"upper.bottom\"\nmaster = [\"front.top\", \"back.top\"]\n\
           [[probe]]\nname = \"lost\"\nquantity = \"contact.c.segments.lost\"\n[[probe]]\nname = \"out\"\nquantity = \"contact.c.segments.outside\"\n";
    let result = run(&text);
    let segments = result.contact.get("c").unwrap().segments;
    // the foot of a point over the ridge lies 0.1 * 0.2 / (1 + 0.2^2) beyond it in y, of cells 0.25 wide
    let widest = 0.1 * 0.2 / 1.04 / 0.25;
    let outside = segments.outside.unwrap();
    assert!(outside <= widest + 1e-9 && outside > 0.3 * widest, "{outside} {widest}");
    assert_eq!((result.probes[0].value, result.probes[1].value), (0.0, outside));
}

/// A hollow ball pressed on a block that reaches beyond it, both as slave: its force is the one that holds the block, and roles
/// change it by what elements as wide as the zone allow.
#[test]
fn a_ball_on_a_wider_block_is_pressed_with_either_role() {
    let text = |roles: &str| {
        HEAD.to_owned()
            + "[[patch]]\nname = \"ball\"\nelements = [8, 8, 3]\n\
               geometry = { kind = \"sphere-octant\", radius = [0.5, 1.0], rotate_deg = -90, axis = [1, 0, 0], move = [0, 0, 1.0] }\n\
               [[patch]]\nname = \"block\"\nelements = [8, 8, 4]\ngeometry = { kind = \"box\", min = [0, 0, -1], max = [1, 1, 0] }\n\
               grade = { toward = { u = 0.0, v = 0.0, w = 1.0 }, ratio = 0.2 }\n\
               [[boundary]]\non = \"block.bottom\"\nfix = [\"x\", \"y\", \"z\"]\n[[boundary]]\non = [\"block.u0\", \"ball.u1\"]\nfix = [\"x\"]\n\
               [[boundary]]\non = [\"block.v0\", \"ball.v0\"]\nfix = [\"y\"]\n[[boundary]]\non = \"ball.u0\"\ndirichlet = { z = -0.05 }\n\
               [[probe]]\nname = \"f\"\nquantity = \"reaction.block.bottom.z\"\n[[contact]]\nname = \"c\"\nsymmetry = true\n"
            + roles
    };
    let forces = ["slave = \"block.top\"\nmaster = \"ball.w1\"\n", "slave = \"ball.w1\"\nmaster = \"block.top\"\n"].map(|roles| {
        let result = run(&text(roles));
        let force = result.contact.get("c").unwrap().force[2].abs();
        let held = result.probes[0].value;
        assert!((force - held.abs()).abs() < 1e-9 * force, "{force} and {held}");
        force
    });
    assert!((forces[0] / forces[1] - 1.0).abs() < 0.06, "{forces:?}");
}

/// Dual multipliers on the cells that have them, by the same pressure; where they have none the line is named.
#[test]
fn dual_multipliers_press_alike_where_there_are_some() {
    let keys = "multiplier = \"dual\"\nslave = \"upper.bottom\"\nmaster = \"lower.top\"";
    for cells in ["backend = \"iga\"", "backend = \"fe\"", "backend = \"fe\"\ncells = \"simplex\"\ndegree = 1"] {
        let result = run(&stacked(["backend = \"iga\"", cells], keys));
        let found = result.contact.get("c").unwrap();
        assert!((found.pressure.max - 2.0).abs() < 1e-8 && (found.pressure.min - 2.0).abs() < 1e-8, "{cells}: {found:?}");
        assert!((found.force[2] - 2.0).abs() < 1e-10, "{cells}: {found:?}");
    }
    let text = stacked(["backend = \"iga\"", "backend = \"fe\"\ncells = \"simplex\""], keys);
    let error =
        Case::parse("case.toml", &text, &ReadOptions::default()).unwrap().run(&Registry::default()).expect_err("refused").to_string();
    assert!(error.contains("E064") && error.contains("multiplier = \"dual\"") && error.contains("p/p, p/p-1, constant"), "{error}");
}

/// Elements of a wide block whose normals are 40 to 60 degrees off those of a ball lose nothing, near the zone and far from it.
#[test]
fn slanted_elements_of_a_coarse_side_lose_no_part() {
    for (ball, n, width) in [("[3, 3, 1]", 3, 2.0), ("[4, 4, 1]", 5, 2.0), ("[3, 3, 1]", 3, 1.0)] {
        let block = format!("[{n}, {n}, 1]");
        let text = HEAD.to_owned()
            + &format!(
                "[[patch]]\nname = \"ball\"\nelements = {ball}\n\
                 geometry = {{ kind = \"sphere-octant\", radius = [0.5, 1.0], rotate_deg = -90, axis = [1, 0, 0], move = [0, 0, 1.0] }}\n\
                 [[patch]]\nname = \"block\"\nelements = {block}\ngeometry = {{ kind = \"box\", min = [0, 0, -1], max = [{width}, {width}, 0] }}\n\
                 [[boundary]]\non = \"block.bottom\"\nfix = [\"x\", \"y\", \"z\"]\n[[boundary]]\non = [\"block.u0\", \"ball.u1\"]\nfix = [\"x\"]\n\
                 [[boundary]]\non = [\"block.v0\", \"ball.v0\"]\nfix = [\"y\"]\n[[boundary]]\non = \"ball.u0\"\ndirichlet = {{ z = -0.05 }}\n\
                 [[contact]]\nname = \"c\"\nsymmetry = true\nslave = \"block.top\"\nmaster = \"ball.w1\"\n"
            );
        let result = run(&text);
        assert!(result.warnings.iter().all(|w| !w.message.contains("lose a part")), "{ball} {block}: {:?}", result.warnings);
        // elements of which all is within 60 degrees of the ball's normal: x² + y² <= 3
        let (covered, size) = (result.contact.get("c").unwrap().segments.measure, width / f64::from(n));
        let opposed = |(i, j): &(i32, i32)| f64::from((i + 1).pow(2) + (j + 1).pow(2)) * size * size <= 3.0;
        let least = (0..n * n).map(|q| (q % n, q / n)).filter(opposed).count() as f64 * size * size;
        assert!(covered > least - 1e-9, "{ball} {block} {width}: {covered} of {least}");
    }
}

/// Blocks that touch and slide along each other without pressure: what rounding leaves is no area, and no zone that is too coarse.
#[test]
fn nothing_presses_where_bodies_only_slide() {
    for method in ["lagrange", "augmented", "penalty", "nitsche"] {
        let text = stacked(["backend = \"iga\""; 2], &format!("method = \"{method}\"\nslave = \"upper.bottom\"\nmaster = \"lower.top\""))
            .replace("on = \"lower.bottom\"\nfix = [\"z\"]", "on = \"lower.bottom\"\nfix = [\"x\", \"y\", \"z\"]")
            .replace("on = [\"lower.left\", \"upper.left\"]\nfix = [\"x\"]", "on = \"lower.left\"\nfix = [\"x\"]")
            .replace("on = [\"lower.front\", \"upper.front\"]\nfix = [\"y\"]", "on = \"lower.front\"\nfix = [\"y\"]")
            .replace("pressure = 2.0", "dirichlet = { x = 0.1, y = 0.03, z = 0.0 }");
        assert!(text.contains("x = 0.1") && !text.contains("upper.left"), "{text}");
        let result = run(&text);
        let found = result.contact.get("c").unwrap();
        assert!(found.area == 0.0 && found.pressure.max.abs() < 1e-11, "{method}: {found:?}");
        assert!(result.warnings.is_empty(), "{method}: {:?}", result.warnings);
    }
}

/// Centres of discs and poles of spheres are points at any distance from the origin, where their sides have lengths by rounding.
#[test]
fn collapsed_edges_far_from_the_origin_are_points() {
    let material = "[model]\nphysics = \"elasticity\"\ndimension = 3\n[[material]]\nname = \"m\"\nyoung = 1\npoisson = 0.3\n";
    let patch = |name: &str, geometry: &str, elements: &str| {
        format!("[[patch]]\nname = \"{name}\"\ngeometry = {{ {geometry} }}\nelements = {elements}\n")
    };
    for (at, swapped) in
        ["[0, 0, 0]", "[800, 0, 0]", "[707, 707, 0]", "[0, 0, 1e4]", "[1e5, 0, 0]"].into_iter().zip([false, true].into_iter().cycle())
    {
        let ball = |radii: &str| format!("kind = \"sphere-octant\", radius = {radii}, move = {at}");
        let sides = if swapped { ["o.w0", "i.w1"] } else { ["i.w1", "o.w0"] };
        let shells = material.to_owned()
            + &patch("i", &ball("[0.6, 1.0]"), "[4, 4, 2]")
            + &patch("o", &ball("[1.0, 1.5]"), "[3, 3, 2]")
            + "[[boundary]]\non = [\"i.u0\", \"i.u1\", \"i.v0\", \"o.u0\", \"o.u1\", \"o.v0\"]\nfix = [\"normal\"]\n"
            + &format!("[[contact]]\nname = \"fit\"\nslave = \"{}\"\nmaster = \"{}\"\ngap = \"g-0.001\"\n", sides[0], sides[1]);
        let fit = &run(&shells).contact["fit"];
        // after Lame
        let lame = 5.613_590_798_775_984e-4;
        assert!((fit.pressure.max / lame - 1.0).abs() < 2e-3 && (fit.pressure.min / lame - 1.0).abs() < 2e-3, "{at}: {fit:?}");
        assert!((fit.area / (0.5 * std::f64::consts::PI) - 1.0).abs() < 1e-6, "{at}: {fit:?}");
        let disc =
            |z: f64| format!("kind = \"disc-sector\", radius = 1, angle_deg = [0, 90], extrude = 0.5, move = [{}, 0, {z}]", at.len() * 200);
        let discs = material.to_owned()
            + &patch("a", &disc(0.0), "[3, 3, 1]")
            + &patch("b", &disc(0.5), "[4, 2, 1]")
            + "[[boundary]]\non = [\"a.u0\", \"a.u1\", \"b.u0\", \"b.u1\", \"a.w0\"]\nfix = [\"normal\"]\n\
               [[boundary]]\non = \"b.w1\"\npressure = 1e-3\n[[contact]]\nname = \"fit\"\nslave = \"a.w1\"\nmaster = \"b.w0\"\n";
        let fit = &run(&discs).contact["fit"];
        assert!((fit.pressure.max / 1e-3 - 1.0).abs() < 1e-4 && (fit.pressure.min / 1e-3 - 1.0).abs() < 1e-4, "{at}: {fit:?}");
        assert!((fit.area / (0.25 * std::f64::consts::PI) - 1.0).abs() < 1e-9, "{at}: {fit:?}");
    }
}

/// Rectangles of chords: far from the origin rounding leaves corners within the sides of their common parts, which take as many points as
/// integrate them exactly nevertheless. The same model at every place, tied and in contact, for every method.
#[test]
fn unlike_chords_press_alike_at_every_place() {
    let model = |at: [f64; 3], kind: &str, keys: &str| {
        let sector = |name: &str, radius: [f64; 2], height: f64, z: f64, elements: [usize; 3]| {
            format!(
                "[[patch]]\nname = \"{name}\"\nbackend = \"fe\"\nelements = {elements:?}\ngeometry = {{ kind = \"annulus-sector\", radius = {radius:?}, \
                 angle_deg = [0, 90], extrude = {height}, move = [{}, {}, {}] }}\n",
                at[0],
                at[1],
                at[2] + z
            )
        };
        run(&("[model]\nphysics = \"elasticity\"\ndimension = 3\n[discretization]\ndegree = 1\n[[material]]\nname = \"m\"\nyoung = 1\npoisson = 0.3\n"
            .to_owned()
            + &sector("inner", [1.0, 1.5], 1.0, 0.0, [6, 2, 2])
            + &sector("outer", [1.5, 2.0], 0.6, 0.2, [4, 1, 3])
            + "[[boundary]]\non = \"inner.v0\"\nspring = [1, 1, 1]\n[[boundary]]\non = \"outer.v1\"\nspring = [0.001, 0.001, 0.001]\n\
               [[boundary]]\non = \"outer.v1\"\npressure = 0.01\n"
            + &format!("[[{kind}]]\nname = \"c\"\nslave = \"outer.v0\"\nmaster = \"inner.v1\"\n{keys}")))
    };
    for (kind, keys) in [("contact", ""), ("contact", "method = \"nitsche\"\n"), ("interface", "")] {
        let here = model([0.0; 3], kind, keys);
        for at in [[8.0, -5.6, 0.0], [30.0, -20.0, 0.0], [300.0, -200.0, 50.0]] {
            let there = model(at, kind, keys);
            let (a, b) = (here.energy, there.energy);
            assert!((b / a - 1.0).abs() < 1e-8, "{kind} {keys} {at:?}: {b} for {a}");
            let contacts = here.contact.values().zip(there.contact.values());
            for (here, there) in contacts {
                assert!((there.pressure.max / here.pressure.max - 1.0).abs() < 1e-6, "{kind} {keys} {at:?}: {there:?} for {here:?}");
                assert!(there.consistency < 1e-9, "{kind} {keys} {at:?}: {there:?}");
            }
        }
    }
}

/// Without multipliers, too, the master's integrals by points of the slave are inexact, and on the same pieces they are not.
#[test]
fn inexact_integration_is_told_without_multipliers() {
    let codes = |integration: &str, method: &str| -> (f64, Vec<&'static str>) {
        let keys = format!("slave = \"lower.top\"\nmaster = \"upper.bottom\"\nmethod = \"{method}\"\nintegration = \"{integration}\"");
        let result = run(&stacked(["backend = \"fe\"\ndegree = 3", "backend = \"fe\"\ndegree = 1"], &keys));
        (result.contact["c"].consistency, result.warnings.iter().map(|w| w.code).collect())
    };
    for method in ["nitsche", "augmented", "lagrange"] {
        let (error, warnings) = codes("slave", method);
        assert!(error > 5e-3 && warnings.contains(&"E065") == (error > 1e-2), "{method}: {error} {warnings:?}");
        let (error, warnings) = codes("merged", method);
        assert!(error < 1e-9 && !warnings.contains(&"E065"), "{method}: {error} {warnings:?}");
    }
}

/// A zone is as coarse as it is across, whatever its functions along a line of contact, and whatever crowds at a pole.
#[test]
fn zones_in_space_are_judged_across() {
    // a quarter of a cylinder on a plane, of which Hertz' half width is a fifteenth of the radius
    let cylinder = |elements: [usize; 3]| {
        format!(
            "[model]\nphysics = \"elasticity\"\ndimension = 3\n[[material]]\nname = \"m\"\nyoung = 1.0\npoisson = 0.3\n\
             [[patch]]\nname = \"c\"\nbackend = \"fe\"\nmapping = \"exact\"\n\
             geometry = {{ kind = \"annulus-sector\", center = [0, 1], radius = [0.3, 1], angle_deg = [-90, 0], extrude = 0.5 }}\n\
             elements = {elements:?}\ngrade = {{ toward = {{ u = 0.0, v = 1.0 }}, ratio = 0.08 }}\n\
             [[boundary]]\non = [\"c.w0\", \"c.w1\"]\nfix = [\"z\"]\n[[boundary]]\non = \"c.u0\"\nfix = [\"x\"]\n\
             [[boundary]]\non = \"c.u1\"\nrigid_force = {{ y = -0.000776767414349125 }}\n\
             [[contact]]\nname = \"k\"\nslave = \"c.v1\"\nrigid = {{ kind = \"half-plane\", point = [0, 0, 0], normal = [0, 1, 0] }}\nsymmetry = true\n"
        )
    };
    let hertz = 0.032_966_27;
    for (elements, is_coarse) in [([5, 4, 8], true), ([16, 8, 2], false)] {
        let result = run(&cylinder(elements));
        let (off, told) =
            (result.contact["k"].pressure.max / hertz - 1.0, result.warnings.iter().any(|w| w.message.contains("too coarse")));
        assert!((off.abs() > 0.15) == is_coarse && told == is_coarse, "{elements:?}: {off} {:?}", result.warnings);
    } // balls whose poles touch: 21 functions crowd there
    let ball = |name: &str, place: &str, elements: &str, degree: usize| {
        format!(
            "[[patch]]\nname = \"{name}\"\ngeometry = {{ kind = \"sphere-octant\", radius = [0.3, 1.0], {place} }}\nelements = {elements}\n\
             backend = \"iga\"\ndegree = {degree}\ngrade = {{ toward = {{ v = 1.0, w = 1.0 }}, ratio = 0.1 }}\n"
        )
    };
    let balls = "[model]\nphysics = \"elasticity\"\ndimension = 3\n[[material]]\nname = \"m\"\nyoung = 1.0\npoisson = 0.3\n".to_owned()
        + &ball("up", "rotate_deg = 180, axis = [1, 1, 0], move = [0, 0, 1.0]", "[5, 10, 5]", 2)
        + &ball("lo", "move = [0, 0, -1.0]", "[6, 9, 5]", 3)
        + "[[boundary]]\non = \"lo.v0\"\nfix = [\"z\"]\n[[boundary]]\non = [\"up.u0\", \"up.u1\", \"lo.u0\", \"lo.u1\"]\nfix = [\"normal\"]\n\
           [[boundary]]\non = \"up.v0\"\nrigid_force = { z = -0.00018754578754578757 }\n\
           [[contact]]\nname = \"k\"\nslave = \"lo.w1\"\nmaster = \"up.w1\"\n";
    let result = run(&balls);
    let off = result.contact["k"].pressure.max / 0.055_966_573 - 1.0;
    assert!(off > 0.5 && result.warnings.iter().any(|w| w.message.contains("too coarse")), "{off} {:?}", result.warnings);
}
