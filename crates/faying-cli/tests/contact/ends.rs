//! Obstacles that end within elements of the side that they press, or are smaller than one.

use faying_cli::case::ReadOptions;
use faying_cli::{Case, Registry, RunResult};

fn run(text: &str) -> RunResult {
    let case = Case::parse("case.toml", text, &ReadOptions::default()).unwrap_or_else(|e| panic!("{e}\n{text}"));
    let result = case.run(&Registry::default()).unwrap_or_else(|e| panic!("{e}\n{text}"));
    assert_eq!(result.exit, 0, "{:?}\n{text}", result.diagnostics);
    result
}

/// A block, held below, with `n` elements of 2 / n along its sides, and `rigid` pressed on it.
fn pressed(cells: &str, n: usize, rigid: &str, keys: &str) -> RunResult {
    run(&format!(
        "[model]\nphysics = \"elasticity\"\ndimension = 3\n[[material]]\nname = \"m\"\nyoung = 1.0\npoisson = 0.3\n\
         [[patch]]\nname = \"b\"\ngeometry = {{ kind = \"box\", min = [-1, -1, -1], max = [1, 1, 0] }}\nelements = [{n}, {n}, 4]\n{cells}\n\
         [[boundary]]\non = \"b.bottom\"\nfix = [\"x\", \"y\", \"z\"]\n\
         [[contact]]\nname = \"c\"\nslave = \"b.top\"\nrigid = {{ {rigid}, move = {{ z = -0.001 }} }}\n{keys}\n"
    ))
}

/// A square punch of the width `w` with a corner at (`x`, `y`).
fn punch(w: f64, [x, y]: [f64; 2]) -> String {
    format!("kind = \"box\", min = [{x}, {y}, 0], max = [{}, {}, 1]", x + w, y + w)
}

const CELLS: [&str; 3] = ["backend = \"iga\"", "backend = \"fe\"", "backend = \"fe\"\ncells = \"simplex\""];

/// Elements are a third wide: edges of the punch lie on their borders, within them, and the whole punch within one. With `FAYING_CONTACT=all` every
/// punch on all cells.
#[test]
fn the_area_under_a_punch_is_that_of_its_face_wherever_it_stands() {
    let punches = [(0.5, [-0.25, -0.25]), (0.5, [-0.15, -0.3]), (0.1, [0.05, -0.05]), (0.1, [0.12, 0.2]), (0.02, [0.2, 0.21])];
    let all = std::env::var("FAYING_CONTACT").is_ok_and(|v| v == "all");
    for cells in CELLS {
        for (width, corner) in (if all || cells == CELLS[0] { &punches[..] } else { &punches[1..3] }).iter().copied() {
            let result = pressed(cells, 6, &punch(width, corner), "multiplier = \"constant\"");
            let found = &result.contact["c"];
            let area = width * width;
            // points that overhang an edge by 1e-8 of the obstacle are on it; a corner may reach a twentieth of a triangle unseen
            let allowed = if cells.contains("simplex") { 1e-3 * area } else { 1e-7 * width };
            let faced = found.segments.measure;
            assert!((faced - area).abs() < allowed, "{cells} {width} {corner:?}: {faced} for {area}");
            // of the narrow triangles some stay open
            assert!(found.area <= faced * (1.0 + 1e-12), "{cells} {width} {corner:?}: {} of {faced}", found.area);
            assert!(
                cells.contains("simplex") || found.area >= faced * (1.0 - 1e-12),
                "{cells} {width} {corner:?}: {} of {faced}",
                found.area
            );
            let coarse = result.warnings.iter().any(|d| d.code == "E065" && d.message.contains("functions of the slave lie across it"));
            assert!(coarse, "{cells} {width} {corner:?}: {:?}", result.warnings);
        }
    }
}

/// The face of a punch as a box and as a surface; all integrations and methods, and a stiff body in its place.
#[test]
fn all_roads_to_a_punch_agree() {
    let box_of = |keys: &str| pressed(CELLS[0], 6, &punch(0.1, [0.05, -0.05]), keys).contact["c"].force[2];
    let known = box_of("");
    let surface = "kind = \"nurbs\", degree = [1, 1], knots = [[0, 0, 1, 1], [0, 0, 1, 1]], \
                   points = [[0.05, -0.05, 0], [0.05, 0.05, 0], [0.15, -0.05, 0], [0.15, 0.05, 0]]";
    let others =
        [box_of("integration = \"slave\""), box_of("method = \"augmented\""), pressed(CELLS[0], 6, surface, "").contact["c"].force[2]];
    assert!(others.iter().all(|force| (force / known - 1.0).abs() < 1e-4), "{others:?} for {known}");
    let body = run("[model]\nphysics = \"elasticity\"\ndimension = 3\n[[material]]\nname = \"m\"\nyoung = 1.0\npoisson = 0.3\n\
         [[material]]\nname = \"stiff\"\nyoung = 1e6\npoisson = 0.3\n\
         [[patch]]\nname = \"b\"\nmaterial = \"m\"\ngeometry = { kind = \"box\", min = [-1, -1, -1], max = [1, 1, 0] }\nelements = [6, 6, 4]\n\
         [[patch]]\nname = \"p\"\nmaterial = \"stiff\"\ngeometry = { kind = \"box\", min = [0.05, -0.05, 0], max = [0.15, 0.05, 0.1] }\nelements = [1, 1, 1]\n\
         [[boundary]]\non = \"b.bottom\"\nfix = [\"x\", \"y\", \"z\"]\n[[boundary]]\non = \"p.top\"\ndirichlet = { x = 0, y = 0, z = -0.001 }\n\
         [[contact]]\nname = \"c\"\nslave = \"b.top\"\nmaster = \"p.bottom\"\n");
    let force = body.contact["c"].force[2];
    assert!((force / known - 1.0).abs() < 1e-2, "{force} for {known}");
}

/// In the plane: a punch within one element, across one border, and over the corner between two sides of it.
#[test]
fn a_punch_in_the_plane_presses_its_width() {
    for cells in ["backend = \"iga\"", "backend = \"fe\""] {
        for [a, b] in [[0.05, 0.15], [-0.1, 0.07], [-0.5, 0.4]] {
            let result = run(&format!(
                "[model]\nphysics = \"elasticity\"\ndimension = 2\n[[material]]\nname = \"m\"\nyoung = 1.0\npoisson = 0.3\n\
                 [[patch]]\nname = \"b\"\ngeometry = {{ kind = \"box\", min = [-1, -1], max = [1, 0] }}\nelements = [6, 4]\n{cells}\n\
                 [[boundary]]\non = \"b.bottom\"\nfix = [\"x\", \"y\"]\n\
                 [[contact]]\nname = \"c\"\nslave = \"b.top\"\nmultiplier = \"constant\"\n\
                 rigid = {{ kind = \"box\", min = [{a}, 0], max = [{b}, 1], move = {{ y = -0.001 }} }}\n"
            ));
            let area = result.contact["c"].area;
            // points that overhang an end by 1e-8 of the obstacle are on it
            assert!((area / (b - a) - 1.0).abs() < 5e-7, "{cells}: {area} for {a} to {b}");
        }
    }
}

/// A punch that slides over the borders of elements has its width at every step, as it has at one step alone.
#[test]
fn a_punch_that_slides_presses_its_width_at_every_step() {
    let at = |times: &str, keys: &str| {
        run(&format!(
            "[model]\nphysics = \"elasticity\"\ndimension = 2\n[[material]]\nname = \"m\"\nyoung = 1.0\npoisson = 0.3\n\
             [[patch]]\nname = \"b\"\ngeometry = {{ kind = \"box\", min = [0, -1], max = [1, 0] }}\nelements = [3, 2]\n\
             [[boundary]]\non = \"b.bottom\"\nfix = [\"x\", \"y\"]\n\
             [[contact]]\nname = \"c\"\nslave = \"b.top\"\n{keys}\n\
             rigid = {{ kind = \"box\", min = [0, 0], max = [0.4, 1], move = {{ x = \"0.2*t\", y = -0.01 }} }}\n\
             [steps]\nt = {times}\n[[probe]]\nname = \"faced\"\nquantity = \"contact.c.segments.measure\"\n"
        ))
    };
    for keys in ["", "multiplier = \"constant\"", "method = \"augmented\"", "integration = \"slave\""] {
        let one = at("[1.0]", keys);
        for times in ["[0.5, 1.0]", "[0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0]"] {
            let many = at(times, keys);
            let (a, b) = (&many.contact["c"], &one.contact["c"]);
            assert!((many.probes[0].value - 0.4).abs() < 1e-7, "{keys} {times}: {}", many.probes[0].value);
            assert!((a.force[1] / b.force[1] - 1.0).abs() < 1e-9, "{keys} {times}: {:?} for {:?}", a.force, b.force);
        }
    }
}

/// Two strips of one function each are wider together than they are: told, as one of them is. With six functions across each nothing is.
#[test]
fn strips_of_contact_are_told_by_their_own_width() {
    let strips = |r: f64| format!("kind = \"level-set\", f = \"min((x - 0.5)^2, (x + 0.5)^2) + (z - {r})^2 - {r}^2\"");
    for cells in CELLS {
        for (n, radius, told) in [(16, 5.0, true), (20, 100.0, false)] {
            let result = pressed(cells, n, &strips(radius), "");
            let coarse = result.warnings.iter().any(|d| d.code == "E065" && d.message.contains("functions of the slave lie across it"));
            assert_eq!(coarse, told, "{cells} {radius}: {:?}, {:?}", result.contact["c"], result.warnings);
        }
    }
}

/// Beside an edge the cones of means and of values let p/p on splines pull, and its force is a fifth too large: told; that of coefficients
/// does neither.
#[test]
fn a_cone_that_lets_a_contact_pull_beside_an_edge_is_told() {
    let third = 1.0 / 3.0;
    let solve = |cone: &str| pressed(CELLS[0], 12, &punch(2.0 * third, [-third; 2]), &format!("multiplier = \"p/p\"\ncone = \"{cone}\""));
    let known = solve("coefficients").contact["c"].force[2];
    for (cone, wrong) in [("coefficients", false), ("weights", true), ("values", true)] {
        let result = solve(cone);
        let found = &result.contact["c"];
        let told = result.warnings.iter().any(|d| d.code == "E065" && d.message.contains("\"c\" pulls: its pressure falls to "));
        assert_eq!(
            (told, found.pressure.min < 0.0, (found.force[2] / known - 1.0).abs() > 0.1),
            (wrong, wrong, wrong),
            "{cone}: {found:?}"
        );
    }
}

/// A rigid plane sinks by 0.01 into a block whose side beside it is held at its place, or is moved by so much along the normal: what the
/// plane leaves of it is told from a tenth of the displacement on.
#[test]
fn a_side_that_is_held_inside_of_an_obstacle_is_told() {
    let solve = |dimension: usize, cells: &str, moved: f64, keys: &str| {
        let (axis, min, max, elements, normal) = match dimension {
            2 => ("y", "[0, -1]", "[1, 0]", "[6, 4]", "[0, -1]"),
            _ => ("z", "[0, 0, -1]", "[1, 1, 0]", "[4, 3, 3]", "[0, 0, -1]"),
        };
        let (all, point) = (["\"x\", \"y\"", "\"x\", \"y\", \"z\""][dimension - 2], ["[0, -0.01]", "[0, 0, -0.01]"][dimension - 2]);
        run(&format!(
            "[model]\nphysics = \"elasticity\"\ndimension = {dimension}\n[discretization]\ndegree = 2\n\
             [[material]]\nname = \"m\"\nyoung = 1.0\npoisson = 0.3\n\
             [[patch]]\nname = \"b\"\ngeometry = {{ kind = \"box\", min = {min}, max = {max} }}\nelements = {elements}\n{cells}\n\
             [[boundary]]\non = \"b.bottom\"\nfix = [{all}]\n[[boundary]]\non = \"b.left\"\ndirichlet = {{ {axis} = \"{moved}*(1 + {axis})\" }}\n\
             [[contact]]\nname = \"c\"\nslave = \"b.top\"\nrigid = {{ kind = \"half-plane\", point = {point}, normal = {normal} }}\n{keys}\n"
        ))
    };
    for (dimension, cells) in [2, 3].into_iter().flat_map(|d| CELLS.map(|c| (d, c))) {
        for keys in ["", "multiplier = \"p/p\"", "integration = \"slave\""] {
            for (moved, wrong) in [(0.0, true), (-0.005, true), (-0.01, false), (-0.012, false)] {
                let result = solve(dimension, cells, moved, keys);
                let told = result.warnings.iter().any(|d| d.code == "E065" && d.message.contains("is held 0.00"));
                assert_eq!(told, wrong, "{dimension}D {cells} {keys} {moved}: {:?}", result.warnings);
            }
        }
    }
}

/// A block whose ends are held, `depth` deep in a plane or in a block below.
fn held_by_its_ends(discretization: &str, elements: usize, faced: &str, keys: &str) -> RunResult {
    run(&format!(
        "[model]\nphysics = \"elasticity\"\ndimension = 2\n[discretization]\n{discretization}\n[[material]]\nname = \"m\"\nyoung = 1.0\npoisson = 0.3\n\
         [[patch]]\nname = \"up\"\ngeometry = {{ kind = \"box\", min = [0, 0], max = [2, 1] }}\nelements = [{elements}, 3]\n\
         [[boundary]]\non = [\"up.left\", \"up.right\"]\nfix = [\"x\", \"y\"]\n\
         [[patch]]\nname = \"lo\"\ngeometry = {{ kind = \"box\", min = [0, -1], max = [2, 0] }}\nelements = [5, 3]\n\
         [[boundary]]\non = \"lo.bottom\"\nfix = [\"x\", \"y\"]\n[[contact]]\nname = \"c\"\nslave = \"up.bottom\"\n{faced}\n{keys}\n"
    ))
}

/// Where a side is held deep the force depends on the elements, and is another one by every method: told. A master that gives way is not what holds.
#[test]
fn held_depths_are_told_with_every_method_and_masters_that_give_way_are_not() {
    const PLANE: &str = "rigid = { kind = \"half-plane\", point = [0, 0.01], normal = [0, 1] }";
    const BLOCK: &str = "master = \"lo.top\"\ngap = \"g - 0.01\"";
    for discretization in ["backend = \"iga\"\ndegree = 2", "backend = \"fe\"\ndegree = 1", "backend = \"fe\"\ndegree = 2"] {
        for method in ["lagrange", "nitsche", "penalty", "augmented"] {
            let solve = |faced: &str, n: usize| {
                let result = held_by_its_ends(discretization, n, faced, &format!("method = \"{method}\""));
                let of = |word: &str| result.warnings.iter().any(|w| w.code == "E065" && w.message.contains(word));
                ([of("is held 0.00"), of("its force, a mean")], result.contact["c"].force[1])
            };
            let (coarse, fine) = (solve(PLANE, 8), solve(PLANE, 32));
            assert_eq!([coarse.0, fine.0], [[true, false]; 2], "{discretization} {method}");
            assert!((fine.1 / coarse.1 - 1.0).abs() > 0.2, "{discretization} {method}: {coarse:?} {fine:?}");
            assert!(!solve(BLOCK, 6).0[0], "{discretization} {method}");
        }
    }
}

/// Facets around a disc are within it by their sag whatever holds their ends.
#[test]
fn facets_that_are_held_on_an_obstacle_are_not_deep_in_it() {
    for elements in [5, 10, 20] {
        let result = run(&format!(
            "[model]\nphysics = \"elasticity\"\ndimension = 2\n[discretization]\nbackend = \"fe\"\ndegree = 1\n[[material]]\nname = \"m\"\nyoung = 1.0\npoisson = 0.3\n\
             [[patch]]\nname = \"a\"\ngeometry = {{ kind = \"annulus-sector\", radius = [1, 2], angle_deg = [0, 90] }}\nelements = [{elements}, 2]\n\
             [[boundary]]\non = [\"a.u0\", \"a.u1\"]\nfix = [\"x\", \"y\"]\n[[boundary]]\non = \"a.v1\"\npressure = 1e-3\n\
             [[contact]]\nname = \"c\"\nslave = \"a.v0\"\nrigid = {{ kind = \"sphere\", center = [0, 0], radius = 1 }}\n"
        ));
        let word = |word: &str| result.warnings.iter().any(|w| w.code == "E065" && w.message.contains(word));
        assert_eq!((word("facets decide what touches"), word("is held")), (true, false), "{elements}: {:?}", result.warnings);
    }
}
