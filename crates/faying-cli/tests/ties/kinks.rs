//! Sides with kinks: two bodies meet on a roof whose halves are at right angles, and at a small angle.
//!
//! Tractions of a state of constant stress jump in the ridge; multipliers hold them as those of the halves do.

use faying_cli::case::ReadOptions;
use faying_cli::{Case, Registry, RunControl, RunOptions, RunResult, SideOutput};

const BACKENDS: [&str; 3] = ["backend = \"iga\"", "backend = \"fe\"", "backend = \"fe\"\ncells = \"simplex\""];

/// Two bodies on [0, 2] that meet on a roof of the height `h`; `exact` per component, the last one along the height.
fn roof(dimension: usize, h: f64, kinds: [&str; 2], degree: usize, exact: &[&str], interface: &str) -> String {
    let last = ["y", "z"][dimension - 2];
    let mut text = format!(
        "[model]\nphysics = \"elasticity\"\ndimension = {dimension}\nexact = {{ u = {exact:?} }}\n[discretization]\ndegree = {degree}\n\
         [[material]]\nname = \"m\"\nyoung = 1\npoisson = 0\n"
    );
    let ridge = [0.0, h, 0.0];
    for (k, (name, [low, high], n)) in [("a", [[-1.0; 3], ridge], [2, 2, 3]), ("b", [ridge, [2.0; 3]], [3, 2, 2])].into_iter().enumerate() {
        let depth: &[f64] = if dimension == 2 { &[0.0] } else { &[0.0, 1.0] };
        let at = |x: usize, y: f64, z: f64| if dimension == 2 { vec![x as f64, z] } else { vec![x as f64, y, z] };
        let layer = |heights: [f64; 3]| depth.iter().flat_map(move |&y| (0..3).map(move |x| at(x, y, heights[x]))).collect::<Vec<_>>();
        let points: Vec<Vec<f64>> = layer(low).into_iter().chain(layer(high)).collect();
        let knots: Vec<Vec<f64>> =
            std::iter::once(vec![0.0, 0.0, 1.0, 2.0, 2.0]).chain((1..dimension).map(|_| vec![0.0, 0.0, 1.0, 1.0])).collect();
        let elements = if dimension == 2 { vec![n[0], n[2]] } else { n.to_vec() };
        text += &format!(
            "[[patch]]\nname = \"{name}\"\ngeometry = {{ kind = \"nurbs\", degree = {:?}, knots = {knots:?}, points = {points:?} }}\n\
             elements = {elements:?}\n{}\n",
            vec![1; dimension],
            kinds[k]
        );
    }
    let sides: &[&str] = if dimension == 2 { &["left", "right"] } else { &["left", "right", "front", "back"] };
    let all: Vec<String> = ["a", "b"].iter().flat_map(|b| sides.iter().map(move |s| format!("{b}.{s}"))).collect();
    text + &format!(
        "[[boundary]]\non = [\"a.bottom\", \"b.top\"]\ndirichlet = \"exact\"\n[[boundary]]\non = {all:?}\nneumann = \"exact\"\n"
    ) + &interface.replace("HEIGHT", last)
}

fn run(text: &str) -> RunResult {
    let case = Case::parse("case.toml", text, &ReadOptions::default()).unwrap_or_else(|e| panic!("{e}\n{text}"));
    case.run(&Registry::default()).unwrap_or_else(|e| panic!("{e}\n{text}"))
}

fn kinds(slave: &'static str, dimension: usize) -> [&'static str; 2] {
    // the plane has no simplices that are solids' faces: triangles
    [if dimension == 2 { BACKENDS[0] } else { BACKENDS[1] }, slave]
}

#[test]
fn constant_stress_is_tied_round_a_ridge() {
    for dimension in [2, 3] {
        for (backend, degree) in BACKENDS.iter().flat_map(|b| [1, 2].map(|p| (*b, p))) {
            for multiplier in ["auto", "p/p", "constant", "dual"] {
                if multiplier == "dual" && dimension == 3 && degree == 2 && backend == BACKENDS[2] {
                    // quadratic functions of triangles have none
                    continue;
                }
                let exact = if dimension == 2 { vec!["x", "0"] } else { vec!["x", "0", "0"] };
                let tie = format!("[[interface]]\nname = \"t\"\nslave = \"b.bottom\"\nmaster = \"a.top\"\nmultiplier = \"{multiplier}\"\n");
                let result = run(&roof(dimension, 1.0, kinds(backend, dimension), degree, &exact, &tie));
                let off = *result.errors.get("error.u.L2").unwrap();
                assert!(off < 1e-9, "{dimension}D {backend}, degree {degree}, {multiplier}: {off:e}");
            }
        }
    }
}

/// A roof whose halves are single elements of the slave.
fn of_single_walls(dimension: usize, h: f64, slave: &'static str, degree: usize, multiplier: &str) -> String {
    let exact = if dimension == 2 { vec!["x", "0"] } else { vec!["x", "0", "0"] };
    let tie = format!("[[interface]]\nname = \"t\"\nslave = \"b.bottom\"\nmaster = \"a.top\"\nmultiplier = \"{multiplier}\"\n");
    let text = roof(dimension, h, kinds(slave, dimension), degree, &exact, &tie);
    let (three, one) = if dimension == 2 { ("[3, 2]", "[1, 2]") } else { ("[3, 2, 2]", "[1, 2, 2]") };
    assert!(text.contains(three));
    text.replace(three, one)
}

const ROUND: &str = "runs round an edge of `b.v0`";

fn is_told(result: &RunResult) -> bool {
    result.warnings.iter().any(|w| w.code == "E065" && w.message.contains(ROUND))
}

#[test]
fn constant_stress_is_tied_round_a_ridge_of_single_elements() {
    for dimension in [2, 3] {
        // turns of 7, 33, 62 degrees
        for h in [0.06, 0.3, 0.6] {
            for (backend, degree) in BACKENDS.iter().flat_map(|b| [1, 2, 3].map(|p| (*b, p))).filter(|(_, p)| dimension == 2 || *p < 3) {
                let result = run(&of_single_walls(dimension, h, backend, degree, "p/p"));
                for name in ["error.u.L2", "error.t.lambda.L2"] {
                    let found = result.errors.get(name).copied().unwrap();
                    assert!(found < 1e-9, "{name} {found:e}: {dimension} {h} {backend} {degree}");
                }
                assert!(!result.warnings.iter().any(|w| w.message.contains(ROUND)), "{dimension} {h} {backend} {degree}");
            }
        }
    }
}

/// Held at both ends, walls of one element of degree 1 have no multiplier of their own.
#[test]
fn multipliers_that_run_round_an_edge_are_told() {
    for (degree, elements, told) in [(1, "[1, 2]", true), (2, "[1, 2]", false), (1, "[2, 2]", false)] {
        let text = of_single_walls(2, 0.3, BACKENDS[1], degree, "p/p").replace("[1, 2]", elements).replace("neumann", "dirichlet");
        let result = run(&text);
        assert_eq!(is_told(&result), told, "{degree} {elements}: {:?}", result.warnings);
        assert_eq!(result.errors.get("error.u.L2").copied().unwrap() > 1e-3, told, "{degree} {elements}");
    }
}

/// Two bodies that meet on single facets of degree 1, in a constant stress.
fn facets(heights: &[f64]) -> String {
    let n = heights.len();
    let layer = |heights: &[f64]| heights.iter().enumerate().map(|(x, y)| vec![x as f64, *y]).collect::<Vec<_>>();
    let knots: Vec<usize> = std::iter::once(0).chain(0..n).chain([n - 1]).collect();
    let mut text = String::from(
        "[model]\nphysics = \"elasticity\"\ndimension = 2\nexact = { u = [\"x\", \"0.3*y\"] }\n[discretization]\nbackend = \"fe\"\ndegree = 1\n\
         [[material]]\nname = \"m\"\nyoung = 1\npoisson = 0\n",
    );
    let (below, above) = (vec![-2.0; n], vec![2.0; n]);
    for (name, low, high, elements) in [("a", &below[..], heights, 3), ("b", heights, &above[..], 1)] {
        let points: Vec<_> = layer(low).into_iter().chain(layer(high)).collect();
        text += &format!(
            "[[patch]]\nname = \"{name}\"\nelements = [{elements}, 2]\n\
             geometry = {{ kind = \"nurbs\", degree = [1, 1], knots = [{knots:?}, [0, 0, 1, 1]], points = {points:?} }}\n"
        );
    }
    text + "[[boundary]]\non = [\"a.bottom\", \"b.top\"]\ndirichlet = \"exact\"\n\
            [[boundary]]\non = [\"a.left\", \"a.right\", \"b.left\", \"b.right\"]\nneumann = \"exact\"\n\
            [[interface]]\nname = \"t\"\nslave = \"b.bottom\"\nmaster = \"a.top\"\n"
}

/// Zigzags have no room for pieces of degree 1, and lambda of a constant stress is off by a third at 16 degrees; chords of a circle are facets
/// of a smooth surface up to 20 degrees from one to the next. With degree 2 all but these are exact.
#[test]
fn multipliers_that_run_round_facets_are_told() {
    let zigzag = |turn: f64| (0..5).map(|k| f64::from(k % 2) * (turn / 2.0).to_radians().tan()).collect::<Vec<_>>();
    let arc = |radius: f64| (0..5).map(|k| (radius * radius - f64::from(k - 2).powi(2)).sqrt() - radius).collect::<Vec<_>>();
    for (heights, told) in [(zigzag(16.0), true), (zigzag(45.0), true), (arc(8.0), false), (arc(2.2), true)] {
        let text = facets(&heights);
        let result = run(&text);
        assert_eq!(is_told(&result), told, "{heights:?}: {:?}", result.warnings);
        let off = |result: &RunResult| result.errors.get("error.t.lambda.L2.rel").copied().unwrap();
        assert!(off(&result) > 0.02, "{heights:?}: {:e}", off(&result));
        let finer = run(&text.replace("degree = 1\n", "degree = 2\n").replace("master =", "multiplier = \"p/p\"\nmaster ="));
        assert_eq!(off(&finer) < 1e-9, heights[0] == heights[2], "{heights:?}: {:e}", off(&finer));
    }
}

/// Pressure 1 on one half, 0.3 on the other.
#[test]
fn bodies_press_each_other_round_a_ridge() {
    for dimension in [2, 3] {
        for (backend, degree) in BACKENDS.iter().flat_map(|b| [1, 2].map(|p| (*b, p))) {
            for method in ["lagrange", "penalty", "nitsche"] {
                let h = ["y", "z"][dimension - 2];
                let [across, along] = [format!("-0.65*x + 0.35*{h}"), format!("0.35*x - 0.65*{h}")];
                let exact = if dimension == 2 { vec![&*across, &along] } else { vec![&*across, "0", &along] };
                let contact = format!("[[contact]]\nname = \"t\"\nslave = \"b.bottom\"\nmaster = \"a.top\"\nmethod = \"{method}\"\n");
                let contact = if method == "penalty" { contact + "factor = 1e7\n" } else { contact };
                let result = run(&roof(dimension, 1.0, kinds(backend, dimension), degree, &exact, &contact));
                let off = *result.errors.get("error.u.L2").unwrap();
                let wanted = if method == "penalty" { 1e-6 } else { 1e-9 };
                assert!(off < wanted, "{dimension}D {backend}, degree {degree}, {method}: {off:e}");
                let pressure = &result.contact["t"];
                assert!((pressure.pressure.max - 1.0).abs() < 1e3 * wanted, "{dimension}D {backend}, {degree}, {method}: {pressure:?}");
            }
        }
    }
}

/// Sides that coincide are joined and raise no word, although facets of a shallow roof might stand for a curved surface.
#[test]
fn shallow_roofs_that_coincide_touch() {
    for dimension in [2, 3] {
        for height in [0.02, 0.1, 0.3] {
            for kind in [BACKENDS[1], BACKENDS[2]] {
                let exact = if dimension == 2 { vec!["x", "0"] } else { vec!["x", "0", "0"] };
                for how in ["between = \"all\"", "slave = \"b.bottom\"\nmaster = \"a.top\""] {
                    let tie = format!("[[interface]]\nname = \"t\"\n{how}\n");
                    let result = run(&roof(dimension, height, [BACKENDS[1], kind], 1, &exact, &tie));
                    let off = *result.errors.get("error.u.L2").unwrap();
                    // ridges below 5 degrees are no kinks
                    assert!(off < if height < 0.05 { 1e-4 } else { 1e-9 }, "{dimension}D {height} {kind} {how}: {off:e}");
                    assert!(result.warnings.iter().all(|w| w.code != "E023"), "{dimension}D {height} {kind} {how}: {:?}", result.warnings);
                }
            }
        }
    }
}

/// A side round a corner on a list of masters, one on each side of it.
fn corner(degrees: f64, coupling: &str) -> String {
    // the corner at (1, 1), its sides down to y at x = 0 and 2
    let y = 1.0 - (0.5 * degrees.to_radians()).tan();
    let patch = |name: &str, points: String, knots: &str, n: [usize; 2]| {
        format!(
            "[[patch]]\nname = \"{name}\"\ngeometry = {{ kind = \"nurbs\", degree = [1, 1], knots = [[{knots}], [0, 0, 1, 1]], \
             points = [{points}] }}\nelements = {n:?}\n"
        )
    };
    "[model]\nphysics = \"elasticity\"\ndimension = 2\nexact = { u = [\"x\", \"0.5*y\"] }\n[discretization]\ndegree = 2\n\
     [[material]]\nname = \"m\"\nyoung = 1\npoisson = 0\n"
        .to_owned()
        + &patch("p", format!("[0, {0}], [1, {0}], [2, {0}], [0, {y}], [1, 1], [2, {y}]", y - 1.0), "0, 0, 1, 2, 2", [3, 2])
        + &patch("a", format!("[0, {y}], [1, 1], [0, 2], [1, 2]"), "0, 0, 1, 1", [2, 2])
        + &patch("b", format!("[1, 1], [2, {y}], [1, 2], [2, 2]"), "0, 0, 1, 1", [4, 2])
        + "[[boundary]]\non = [\"p.v0\", \"a.v1\", \"b.v1\"]\ndirichlet = \"exact\"\n\
           [[boundary]]\non = [\"p.u0\", \"p.u1\", \"a.u0\", \"b.u1\"]\nneumann = \"exact\"\n\
           [[interface]]\nname = \"ab\"\nslave = \"a.u1\"\nmaster = \"b.u0\"\n"
        + &format!("[[interface]]\nname = \"c\"\nslave = \"p.v1\"\nmaster = [\"a.v0\", \"b.v0\"]\ncoupling = \"{coupling}\"\n")
        + if coupling == "penalty" { "factor = 1e7\n" } else { "" }
}

#[test]
fn a_kinked_slave_is_tied_to_a_list_of_masters() {
    for (degrees, coupling) in [60.0, 89.0, 91.0, 120.0].into_iter().flat_map(|d| ["mortar", "nitsche", "penalty"].map(|c| (d, c))) {
        let off = *run(&corner(degrees, coupling)).errors.get("error.u.L2").unwrap();
        assert!(off < if coupling == "penalty" { 1e-5 } else { 1e-9 }, "{degrees} {coupling}: {off:e}");
    }
}

/// One element of degree 1 per wall with held ends has no multiplier, and that is the reason that is given.
#[test]
fn walls_without_room_are_the_reason() {
    let text = corner(90.0, "mortar").replace("degree = 2\n", "degree = 1\n").replace("[3, 2]", "[1, 2]").replace("neumann", "dirichlet");
    let case = Case::parse("case.toml", &text, &ReadOptions::default()).unwrap_or_else(|e| panic!("{e}"));
    let found: Vec<_> = case.run(&Registry::default()).unwrap_err().items.iter().map(|d| d.code).collect();
    assert!(found.contains(&"E024") && !found.contains(&"E023"), "{found:?}");
}

/// Files and numbers show the side as one: along its whole length, with one share per master.
#[test]
fn pieces_of_a_side_are_shown_as_the_side() {
    for (dimension, statement) in [(2, "interface"), (2, "contact"), (3, "interface"), (3, "contact")] {
        let h = ["y", "z"][dimension - 2];
        let [across, along] = [format!("-0.65*x + 0.35*{h}"), format!("0.35*x - 0.65*{h}")];
        let exact = if dimension == 2 { vec![&*across, &along] } else { vec![&*across, "0", &along] };
        let text = roof(
            dimension,
            1.0,
            [BACKENDS[0]; 2],
            2,
            &exact,
            &format!("[[{statement}]]\nname = \"t\"\nslave = \"b.bottom\"\nmaster = \"a.top\"\n"),
        );
        let case = Case::parse("case.toml", &text, &ReadOptions::default()).unwrap_or_else(|e| panic!("{e}\n{text}"));
        let finished = faying_cli::run::run(&case, &Registry::default(), &RunOptions::default(), &RunControl::default());
        let output = finished.output.unwrap();
        assert!(output.sides.len() == 2 && output.sides.iter().all(|side| side.name == "t"), "{dimension}D {statement}");
        let rows = SideOutput::table(&output.sides);
        // constants on six elements, in space times two
        assert_eq!(rows.len(), if dimension == 2 { 6 } else { 12 }, "{dimension}D {statement}");
        for row in &rows {
            assert!((row.x[dimension - 1] - (1.0 - (row.x[0] - 1.0).abs())).abs() < 1e-12, "{dimension}D {statement}: {row:?}");
            if dimension == 2 {
                assert!((row.s.unwrap() - std::f64::consts::SQRT_2 * row.x[0]).abs() < 1e-9, "{statement}: {row:?}");
            }
        }
        assert!(rows.windows(2).all(|w| dimension == 3 || w[0].s < w[1].s), "{statement}");
        let file = faying_files::vtu_read::parse(&SideOutput::vtu(&output.sides).unwrap(), &faying_files::Limits::default()).unwrap();
        let ends = file.points.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], x| [a.min(x[0]), b.max(x[0])]);
        assert_eq!(ends, [0.0, 2.0], "{dimension}D {statement}");
        if statement == "interface" {
            let sides = &finished.result.interface["t"].sides;
            assert!(sides.len() == 1 && (sides[0].share - 1.0).abs() < 1e-12, "{sides:?}");
        }
    }
}

/// A Gmsh mesh of [0, 3]^2 in squares of the size 1 / n, without those of [1, 2]^2, or these alone; `edge` is the group of the square's edges.
fn squares(n: usize, is_inside: bool, edge: &str) -> String {
    let id = |i: usize, j: usize| j * (3 * n + 1) + i + 1;
    let mut used = std::collections::BTreeSet::new();
    let mut elements = Vec::new();
    for (i, j) in (0..3 * n).flat_map(|j| (0..3 * n).map(move |i| (i, j))) {
        if ((n..2 * n).contains(&i) && (n..2 * n).contains(&j)) == is_inside {
            let corners = [id(i, j), id(i + 1, j), id(i + 1, j + 1), id(i, j + 1)];
            used.extend(corners);
            elements.push((3, 1, corners.to_vec()));
        }
    }
    for k in n..2 * n {
        for (a, b) in [((k, n), (k + 1, n)), ((k, 2 * n), (k + 1, 2 * n)), ((n, k), (n, k + 1)), ((2 * n, k), (2 * n, k + 1))] {
            elements.push((1, 2, vec![id(a.0, a.1), id(b.0, b.1)]));
        }
    }
    for k in (0..3 * n).filter(|_| !is_inside) {
        for (a, b) in [((k, 0), (k + 1, 0)), ((k, 3 * n), (k + 1, 3 * n)), ((0, k), (0, k + 1)), ((3 * n, k), (3 * n, k + 1))] {
            elements.push((1, 3, vec![id(a.0, a.1), id(b.0, b.1)]));
        }
    }
    let place = |id: usize| [((id - 1) % (3 * n + 1)) as f64 / n as f64, ((id - 1) / (3 * n + 1)) as f64 / n as f64];
    let nodes: Vec<String> = used.iter().map(|&k| format!("{k} {:?} {:?} 0", place(k)[0], place(k)[1])).collect();
    let lines = elements.iter().enumerate().map(|(k, (kind, group, ids))| {
        let ids: Vec<String> = ids.iter().map(usize::to_string).collect();
        format!("{} {kind} 2 {group} {group} {}", k + 1, ids.join(" "))
    });
    let lines: Vec<String> = lines.collect();
    format!(
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n3\n2 1 \"all\"\n1 2 \"{edge}\"\n1 3 \"outer\"\n$EndPhysicalNames\n\
         $Nodes\n{}\n{}\n$EndNodes\n$Elements\n{}\n{}\n$EndElements\n",
        nodes.len(),
        nodes.join("\n"),
        lines.len(),
        lines.join("\n")
    )
}

/// A square in the square hole of a plate, whose walls are one side: walls of few elements, and of one that is refined.
#[test]
fn walls_of_a_hole_are_parts() {
    let folder = tempfile::tempdir().unwrap();
    let mut missed = Vec::new();
    for (walls, refine) in [(2, 0), (3, 0), (1, 1), (1, 2)] {
        std::fs::write(folder.path().join("plate.msh"), squares(walls, false, "hole")).unwrap();
        std::fs::write(folder.path().join("inside.msh"), squares(3, true, "rim")).unwrap();
        for (degree, multiplier) in [1, 2].into_iter().flat_map(|p| ["auto", "p/p", "dual"].map(|m| (p, m))) {
            for statement in ["interface", "contact"] {
                let text = format!(
                    "[model]\nphysics = \"elasticity\"\ndimension = 2\nexact = {{ u = [\"-0.005*x\", \"-0.005*y\"] }}\n\
                     [discretization]\nbackend = \"fe\"\ndegree = {degree}\n[[material]]\nname = \"m\"\nyoung = 1\npoisson = 0.3\n\
                     [[patch]]\nname = \"plate\"\ngeometry = {{ kind = \"file\", file = \"plate.msh\" }}\nrefine = {refine}\n\
                     [[patch]]\nname = \"inside\"\ngeometry = {{ kind = \"file\", file = \"inside.msh\" }}\n\
                     [[boundary]]\non = \"plate.outer\"\ndirichlet = \"exact\"\n\
                     [[{statement}]]\nname = \"t\"\nslave = \"plate.hole\"\nmaster = \"inside.rim\"\nmultiplier = \"{multiplier}\"\n"
                );
                let path = folder.path().join("case.toml");
                std::fs::write(&path, &text).unwrap();
                let what = format!("{walls} refined {refine}, degree {degree}, {statement}, {multiplier}");
                let case = Case::read_with(&path, &ReadOptions::default()).unwrap_or_else(|e| panic!("{e}"));
                match case.run(&Registry::default()).map(|result| *result.errors.get("error.u.L2").unwrap()) {
                    Ok(off) if off < 1e-9 => {}
                    Ok(off) => missed.push(format!("{what}: {off:e}")),
                    Err(fault) => missed.push(format!("{what}: {fault}")),
                }
            }
        }
    }
    assert!(missed.is_empty(), "{}", missed.join("\n"));
}
