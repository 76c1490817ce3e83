//! Obstacles in space with the shape of a geometry: boxes, NURBS, files, against the plane and the sphere that they stand for.

use crate::common::pressed::kkt;
use faying_cli::case::ReadOptions;
use faying_cli::{Case, Registry, RunResult};

fn read(text: &str) -> Result<Case, String> {
    Case::parse("case.toml", text, &ReadOptions::default()).map_err(|e| e.to_string())
}

fn run(text: &str) -> RunResult {
    let case = read(text).unwrap_or_else(|e| panic!("{e}\n{text}"));
    let result = case.run(&Registry::default()).unwrap_or_else(|e| panic!("{e}\n{text}"));
    assert_eq!(result.exit, 0, "{:?}\n{text}", result.diagnostics);
    result
}

fn refused(text: &str) -> String {
    match read(text) {
        Err(faults) => faults,
        Ok(case) => case.run(&Registry::default()).expect_err("refused").to_string(),
    }
}

/// A block over [0, 1] x [0, 0.8] with its bottom at `z`, its top moved down by 0.02, above an obstacle.
fn block(z: f64, cells: &str, rigid: &str) -> String {
    format!(
        "[model]\nphysics = \"elasticity\"\ndimension = 3\n[discretization]\n{cells}\ndegree = 2\n\
         [[material]]\nname = \"m\"\nyoung = 1.0\npoisson = 0.3\n\
         [[patch]]\nname = \"block\"\ngeometry = {{ kind = \"box\", min = [0, 0, {z}], max = [1, 0.8, {}] }}\nelements = [4, 3, 2]\n\
         [[boundary]]\non = \"block.top\"\ndirichlet = {{ x = 0, y = 0, z = -0.02 }}\n\
         [[contact]]\nname = \"c\"\nslave = \"block.bottom\"\nrigid = {{ {rigid} }}\n",
        z + 0.5
    )
}

/// Same force, pressures and closed set.
fn compare(what: &str, one: &RunResult, other: &RunResult) {
    let [a, b] = [one, other].map(|r| r.contact.get("c").unwrap());
    let size = a.force.iter().fold(0.0f64, |m, f| m.max(f.abs()));
    assert!(size > 0.0 && a.active == b.active, "{what}: {} {}", a.active, b.active);
    for (a, b) in a.force.iter().zip(&b.force) {
        assert!((a - b).abs() < 1e-10 * size, "{what}: {a} {b}");
    }
    assert!((a.pressure.max - b.pressure.max).abs() < 1e-9 * a.pressure.max, "{what}: {} {}", a.pressure.max, b.pressure.max);
}

const CELLS: [&str; 3] = ["backend = \"iga\"", "backend = \"fe\"", "backend = \"fe\"\ncells = \"simplex\""];

/// The corners of the square [-1, 2] x [-1, 2] at z = 0, u along x.
const SQUARE: &str =
    "kind = \"nurbs\", degree = [1, 1], knots = [[0, 0, 1, 1], [0, 0, 1, 1]], points = [[-1, -1, 0], [2, -1, 0], [-1, 2, 0], [2, 2, 0]]";

#[test]
fn boxes_nurbs_and_files_are_the_plane_of_their_face() {
    let patch = |id: usize, x: [f64; 2]| {
        let axis = |k: usize| format!("<Basis type=\"BSplineBasis\" index=\"{k}\"><KnotVector degree=\"1\">0 0 1 1</KnotVector></Basis>");
        let points: Vec<String> = (0..8).map(|c| format!("{} {} {}", x[c % 2], [-1, 2][c / 2 % 2], [-1, 0][c / 4])).collect();
        format!(
            "<Geometry type=\"TensorBSpline3\" id=\"{id}\"><Basis type=\"TensorBSplineBasis3\">{}{}{}</Basis><coefs geoDim=\"3\">{}</coefs></Geometry>",
            axis(0),
            axis(1),
            axis(2),
            points.join(" ")
        )
    };
    let solids = file("solids.xml", &format!("<xml>{}{}</xml>", patch(0, [-1.0, 0.45]), patch(1, [0.45, 2.0])));
    // a tetrahedron below the triangle of (-4, -2), (4, -2), (0, 6)
    let mesh = file(
        "tip.msh",
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n1 -4 -2 0\n2 4 -2 0\n3 0 6 0\n4 0 0 -3\n$EndNodes\n\
         $Elements\n1\n1 4 2 1 1 1 3 2 4\n$EndElements\n",
    );
    let surface = file(
        "surface.xml",
        "<xml><Geometry type=\"TensorBSpline2\" id=\"0\"><Basis type=\"TensorBSplineBasis2\">\
         <Basis type=\"BSplineBasis\" index=\"0\"><KnotVector degree=\"1\">0 0 0.3 1 1</KnotVector></Basis>\
         <Basis type=\"BSplineBasis\" index=\"1\"><KnotVector degree=\"1\">0 0 1 1</KnotVector></Basis></Basis>\
         <coefs geoDim=\"3\">-1 -1 0 0.1 -1 0 2 -1 0 -1 2 0 0.1 2 0 2 2 0</coefs></Geometry></xml>",
    );
    for cells in CELLS {
        let known = run(&block(0.0, cells, "kind = \"half-plane\", point = [0, 0, 0], normal = [0, 0, 1]"));
        kkt(&known, 1.0);
        for rigid in [
            "kind = \"box\", min = [-1, -1, -1], max = [2, 2, 0]".to_owned(),
            "kind = \"box\", min = [-1, 0, -1], max = [2, 0.5, 2], rotate_deg = -90, axis = [1, 0, 0]".to_owned(),
            SQUARE.to_owned(),
            format!("kind = \"file\", file = {solids:?}"),
            format!("kind = \"file\", file = {mesh:?}"),
            format!("kind = \"file\", file = {surface:?}"),
            // moved by -d
            "kind = \"box\", min = [-1, -1, -1], max = [2, 2, 0.5], move = { z = -0.5 }".to_owned(),
        ] {
            compare(&rigid, &known, &run(&block(0.0, cells, &rigid)));
        }
        // the body moved by d
        let above = run(&block(0.5, cells, "kind = \"box\", min = [-1, -1, -1], max = [2, 2, 0.5]"));
        compare(cells, &known, &above);
        // driven by a force
        let driven =
            run(&block(0.0, cells, "kind = \"box\", min = [-1, -1, -1], max = [2, 2, 0], force = { z = 2e-3 }")
                .replace("z = -0.02", "z = 0"));
        assert!((driven.contact.get("c").unwrap().force[2] - 2e-3).abs() < 1e-12);
    }
}

#[test]
fn the_outer_sphere_of_an_octant_is_a_sphere() {
    let turned = "rotate_deg = 54.735610317245346, axis = [1, -1, 0], move = { x = 0.45, y = 0.4, z = -2 }";
    for cells in CELLS {
        let known = run(&block(0.0, cells, "kind = \"sphere\", center = [0.45, 0.4, -2], radius = 2"));
        let shaped = run(&block(0.0, cells, &format!("kind = \"sphere-octant\", radius = [1.5, 2], {turned}")));
        compare(cells, &known, &shaped);
    }
}

#[test]
fn what_faces_nothing_is_refused_with_the_way_round() {
    let swapped = SQUARE.replace("[2, -1, 0], [-1, 2, 0]", "[-1, 2, 0], [2, -1, 0]");
    let text = refused(&block(0.0, CELLS[0], &swapped));
    assert!(text.contains("E023") && text.contains("exchange its directions u and v"), "{text}");
    // a box above the body, and one beside it
    for rigid in ["kind = \"box\", min = [-1, -1, 1], max = [2, 2, 2]", "kind = \"box\", min = [2, -1, -1], max = [3, 2, 0]"] {
        let text = refused(&block(0.0, CELLS[0], rigid));
        assert!(text.contains("E023"), "{rigid}: {text}");
    }
    let flat = SQUARE.replace("[-1, 2, 0], [2, 2, 0]", "[-1, -1, 0], [2, -1, 0]");
    let text = refused(&block(0.0, CELLS[0], &flat));
    assert!(text.contains("has no normal"), "{text}");
    let short = SQUARE.replace(", [2, 2, 0]", "");
    let text = refused(&block(0.0, CELLS[0], &short));
    assert!(text.contains("E033") && text.contains("2 x 2 control points, found 3"), "{text}");
}

/// A file in a folder of its own.
fn file(name: &str, text: &str) -> String {
    let folder = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join("shaped_in_space");
    std::fs::create_dir_all(&folder).unwrap();
    let path = folder.join(name);
    std::fs::write(&path, text).unwrap();
    path.to_str().unwrap().to_owned()
}
