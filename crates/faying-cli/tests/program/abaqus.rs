//! Abaqus and CalculiX meshes in cases, and in `inspect` and `convert`.

use serde_json::Value;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use tempfile::TempDir;

fn faying(at: &Path, words: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_faying")).current_dir(at).stdin(Stdio::null()).args(words).output().unwrap()
}

fn json(at: &Path, words: &[&str]) -> (i32, Value) {
    let out = faying(at, &[words, &["--json"]].concat());
    let text = String::from_utf8(out.stdout).unwrap();
    let value = serde_json::from_str(&text).unwrap_or_else(|e| panic!("{e}: {text}\n{}", String::from_utf8_lossy(&out.stderr)));
    (out.status.code().unwrap_or(-1), value)
}

fn folder(files: &[(&str, &str)]) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in files {
        std::fs::write(folder.path().join(name), text).unwrap();
    }
    folder
}

/// A linear field on a file of Gmsh, given all around or on the side `rim`: every element of order 1 and 2 has it.
fn linear_field(name: &str, dimension: usize, on: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/data/inp").join(format!("{name}.inp"));
    let u = ["0.3*x - 0.1*y + 0.2*z", "0.4*y + 0.1*x", "0.5*z - 0.3*y"][..dimension].iter().map(|f| format!("\"{f}\"")).collect::<Vec<_>>();
    let u = u.join(", ").replace(" + 0.2*z", if dimension == 2 { "" } else { " + 0.2*z" });
    let degree = &name[name.len() - 1..];
    format!(
        "[model]\nphysics = \"elasticity\"\ndimension = {dimension}\nexact = {{ u = [{u}] }}\n[discretization]\nbackend = \"fe\"\ndegree = {degree}\n\
         [[material]]\nname = \"m\"\nyoung = 3\npoisson = 0.3\n[[patch]]\nname = \"b\"\n\
         geometry = {{ kind = \"file\", file = '{}', group = \"body\" }}\n[[boundary]]\non = \"{on}\"\ndirichlet = \"exact\"\n\
         [[check]]\nquantity = \"error.u.H1\"\nbelow = 1e-12\n",
        path.display()
    )
}

#[test]
fn linear_fields_are_exact_on_meshes_of_every_element_type() {
    for (name, dimension, on) in [
        ("disc_tri_1", 2, "b.rim"),
        ("disc_tri_2", 2, "b.rim"),
        ("disc_quad_1", 2, "b.rim"),
        ("disc_quad_2", 2, "b.rim"),
        ("ball_tet_1", 3, "b.rim"),
        ("ball_tet_2", 3, "b.rim"),
        ("drum_hex_1", 3, "all-outer"),
        ("drum_hex_2", 3, "all-outer"),
    ] {
        let at = folder(&[("case.toml", &linear_field(name, dimension, on))]);
        let (code, found) = json(at.path(), &["run", "case.toml", "--vtu", "none"]);
        assert_eq!(code, 0, "{name}: {} {}", found["diagnostics"], found["checks"]);
    }
}

/// A unit square of two elements below a third one, with its nodes in another file.
const MESH: &str = "*INCLUDE, INPUT=nodes.inp\n*ELEMENT, TYPE=CPS4, ELSET=low\n1, 1, 2, 5, 4\n2, 2, 3, 6, 5\n*ELEMENT, TYPE=CPS4, ELSET=high\n\
                    3, 4, 6, 8, 7\n*NSET, NSET=bottom\n1, 2, 3\n*SURFACE, NAME=top\nhigh, S3\n";
const NODES: &str = "*NODE\n1, 0, 0\n2, 0.5, 0\n3, 1, 0\n4, 0, 1\n5, 0.5, 1\n6, 1, 1\n7, 0, 2\n8, 1, 2\n";

/// The square alone under its weight; the other element is another group.
const COLUMN: &str = "[model]\nphysics = \"elasticity\"\ndimension = 2\nassumption = \"plane-stress\"\nbody_force = [\"0\", \"-1\"]\n\
                      [discretization]\nbackend = \"fe\"\ndegree = 1\n[[material]]\nname = \"m\"\nyoung = 2\npoisson = 0\n[[patch]]\nname = \"b\"\n\
                      geometry = { kind = \"file\", file = \"m.inp\", group = \"low\" }\n[[boundary]]\non = \"b.bottom\"\nfix = [\"x\", \"y\"]\n\
                      [[probe]]\nname = \"p\"\nquantity = \"u.y at [0.5, 1]\"\n";

#[test]
fn included_files_are_read_beside_the_mesh_and_stand_in_the_manifest() {
    let at = folder(&[("case.toml", &COLUMN.replace("m.inp", "parts/m.inp"))]);
    std::fs::create_dir(at.path().join("parts")).unwrap();
    std::fs::write(at.path().join("parts/m.inp"), MESH).unwrap();
    std::fs::write(at.path().join("parts/nodes.inp"), NODES).unwrap();
    let (code, found) = json(at.path(), &["run", "case.toml"]);
    assert_eq!(code, 0, "{}", found["diagnostics"]);
    // a column under its own weight, one element high: u'' = q / E is met at nodes, q h^2 / (2 E)
    let u = found["probes"][0]["value"].as_f64().unwrap();
    assert!((u + 0.25).abs() < 1e-13, "{u}");
    let manifest: Value = serde_json::from_slice(&std::fs::read(at.path().join("case.out/manifest.json")).unwrap()).unwrap();
    let text = manifest.to_string();
    assert!(text.contains("m.inp") && text.contains("nodes.inp"), "{text}");
    // errors of included files name them with the line
    std::fs::write(at.path().join("parts/nodes.inp"), NODES.replace("5, 0.5, 1", "5, half, 1")).unwrap();
    let (code, found) = json(at.path(), &["check", "case.toml"]);
    let first = found["diagnostics"][0]["message"].as_str().unwrap();
    assert_eq!((code, &found["diagnostics"][0]["code"]), (3, &"E043".into()));
    assert!(first.contains("\"nodes.inp\": a coordinate must be a finite number, found \"half\" (line 6)"), "{first}");
    std::fs::remove_file(at.path().join("parts/nodes.inp")).unwrap();
    let (code, found) = json(at.path(), &["check", "case.toml"]);
    assert_eq!(code, 3);
    assert!(found["diagnostics"][0].to_string().contains("cannot read the included file"), "{found}");
}

#[test]
fn meshes_are_inspected_and_converted_with_their_sets() {
    let at = folder(&[("m.inp", MESH), ("nodes.inp", NODES)]);
    let (code, found) = json(at.path(), &["inspect", "m.inp"]);
    assert_eq!((code, &found["format"], found["measure"].as_f64()), (0, &"Abaqus input file".into(), Some(2.0)), "{found}");
    for (name, dimension, size) in [("low", 2, 1.0), ("high", 2, 1.0), ("bottom", 1, 1.0), ("top", 1, 1.0)] {
        let group = found["groups"].as_array().unwrap().iter().find(|g| g["name"] == name).unwrap();
        assert_eq!((&group["dimension"], group["measure"].as_f64()), (&dimension.into(), Some(size)), "{group}");
    }
    for name in ["m.msh", "m.vtu"] {
        assert_eq!(faying(at.path(), &["convert", "m.inp", name]).status.code(), Some(0));
        let (_, other) = json(at.path(), &["inspect", name]);
        assert_eq!((&other["groups"], &other["cells"], &other["points"]), (&found["groups"], &found["cells"], &found["points"]), "{name}");
    }
    let out = faying(at.path(), &["convert", "m.msh", "n.inp"]);
    assert_eq!(out.status.code(), Some(2));
}

#[test]
fn prisms_and_pyramids_are_measured() {
    let text = "*NODE\n1, 0, 0, 0\n2, 1, 0, 0\n3, 1, 1, 0\n4, 0, 1, 0\n5, 0, 0, 1\n6, 1, 0, 1\n7, 1, 1, 1\n8, 0, 1, 1\n9, 3, 7, 3\n11, 2.5, 0.2, 0.1\n\
                12, 2, 1.3, -0.2\n13, 2.2, -0.1, 1.4\n\
                *ELEMENT, TYPE=C3D8, ELSET=cube\n1, 1, 2, 3, 4, 5, 6, 7, 8\n*ELEMENT, TYPE=C3D5, ELSET=roof\n2, 5, 6, 7, 8, 9\n\
                *ELEMENT, TYPE=C3D6, ELSET=ramp\n3, 1, 2, 3, 5, 6, 7\n4, 2, 3, 6, 11, 12, 13\n";
    let at = folder(&[("m.inp", text)]);
    let (code, found) = json(at.path(), &["inspect", "m.inp"]);
    assert_eq!(code, 0, "{found}");
    let group = |name: &str| found["groups"].as_array().unwrap().iter().find(|g| g["name"] == name).unwrap()["measure"].as_f64().unwrap();
    // a third of base times height
    assert!((group("cube") - 1.0).abs() < 1e-14 && (group("roof") - 2.0 / 3.0).abs() < 1e-14, "{found}");
    // half a cube, and a skew prism
    let x = [[1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [1.0, 0.0, 1.0], [2.5, 0.2, 0.1], [2.0, 1.3, -0.2], [2.2, -0.1, 1.4]];
    assert!((group("ramp") - 0.5 - prism(&x)).abs() < 1e-12, "{} and {}", group("ramp"), prism(&x));
    let notes = found["notes"].to_string();
    assert!(notes.contains("no body is made of prisms and pyramids"), "{notes}");
}

/// Volume of a prism of straight edges: its determinant is quadratic in w and linear in u and v, so that Simpson's rule in w and the three
/// middles of edges in the triangle are exact.
fn prism(x: &[[f64; 3]; 6]) -> f64 {
    let det = |u: f64, v: f64, w: f64| {
        let at = |f: &dyn Fn(usize) -> f64| -> [f64; 3] { std::array::from_fn(|k| (0..6).map(|a| f(a) * x[a][k]).sum()) };
        let level = |a: usize| if a < 3 { 1.0 - w } else { w };
        let shape = |a: usize| [1.0 - u - v, u, v][a % 3];
        let (du, dv) = (at(&|a| level(a) * [-1.0, 1.0, 0.0][a % 3]), at(&|a| level(a) * [-1.0, 0.0, 1.0][a % 3]));
        let dw = at(&|a| if a < 3 { -shape(a) } else { shape(a) });
        (du[1] * dv[2] - du[2] * dv[1]) * dw[0] + (du[2] * dv[0] - du[0] * dv[2]) * dw[1] + (du[0] * dv[1] - du[1] * dv[0]) * dw[2]
    };
    let middle = |w: f64| [[0.5, 0.0], [0.5, 0.5], [0.0, 0.5]].iter().map(|[u, v]| det(*u, *v, w)).sum::<f64>() / 6.0;
    ((middle(0.0) + 4.0 * middle(0.5) + middle(1.0)) / 6.0).abs()
}

#[test]
fn cases_are_converted_with_the_elements_that_they_ask_for() {
    let case = "[model]\nphysics = \"poisson\"\ndimension = 2\n[discretization]\ndegree = 2\n[[patch]]\nname = \"low\"\n\
                geometry = { kind = \"box\", min = [0, 0], max = [2, 1] }\nelements = [4, [0, 0.25, 1]]\nrefine = 1\n[[patch]]\nname = \"ring\"\n\
                geometry = { kind = \"annulus-sector\", center = [0, 5], radius = [1, 2], angle_deg = [0, 90] }\nelements = [3, 2]\n\
                [[boundary]]\non = \"all-outer\"\ndirichlet = 0\n";
    let at = folder(&[("case.toml", case)]);
    let (code, done) = json(at.path(), &["convert", "case.toml", "case.msh", "--order", "4"]);
    assert_eq!(code, 0, "{done}");
    let (_, found) = json(at.path(), &["inspect", "case.msh"]);
    let group = |name: &str| found["groups"].as_array().unwrap().iter().find(|g| g["name"] == name).unwrap().clone();
    assert_eq!((&group("low")["cells"], &group("ring")["cells"], &group("low.u0")["cells"]), (&32.into(), &6.into(), &4.into()));
    assert!((group("low")["measure"].as_f64().unwrap() - 2.0).abs() < 1e-13);
    let area = group("ring")["measure"].as_f64().unwrap() / (0.75 * std::f64::consts::PI);
    assert!((area - 1.0).abs() < 1e-6, "{area}");
    // splines keep the exact map
    assert_eq!(faying(at.path(), &["convert", "case.toml", "case.xml"]).status.code(), Some(0));
    let (_, splines) = json(at.path(), &["inspect", "case.xml"]);
    let exact = 2.0 + 0.75 * std::f64::consts::PI;
    assert!((splines["measure"].as_f64().unwrap() - exact).abs() < 1e-12, "{splines}");
    // a case whose bodies are meshes has nothing to convert
    let at = folder(&[("case.toml", COLUMN), ("m.inp", MESH), ("nodes.inp", NODES)]);
    let (code, found) = json(at.path(), &["convert", "case.toml", "case.msh"]);
    assert_eq!((code, &found["diagnostics"][0]["code"]), (3, &"E043".into()), "{found}");
    assert!(found["diagnostics"][0]["line"].is_number());
    // simplices are cut from boxes, which is what a geometry has
    assert!(faying(at.path(), &["new", "solid"]).status.success());
    let (code, done) = json(at.path(), &["convert", "solid.toml", "solid.msh"]);
    let lost = &done["lost"];
    assert!(
        code == 0 && lost.as_array().unwrap().iter().any(|l| l.as_str().unwrap().contains("simplices of patch \"tetrahedra\"")),
        "{done}"
    );
}
