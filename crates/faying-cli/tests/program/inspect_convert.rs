//! `faying inspect` and `faying convert` as their users meet them.

use crate::common::peer;
use serde_json::Value;
use std::f64::consts::PI;
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

fn close(value: &Value, expected: f64, what: &str) {
    let found = value.as_f64().unwrap_or_else(|| panic!("{what} is {value}"));
    assert!((found - expected).abs() <= 1e-12 * expected.abs().max(1.0), "{what}: {found:e}, expected {expected:e}");
}

/// A quarter of a ring of radii 1 and 2 (patch 0) beside the square [-1, 0] x [1, 2] (patch 1), with a label on both outer sides.
const RING: &str = r#"<?xml version="1.0"?>
<xml>
 <Geometry type="TensorNurbs2" id="7">
  <Basis type="TensorNurbsBasis2">
   <Basis type="TensorBSplineBasis2">
    <Basis type="BSplineBasis" index="0"><KnotVector degree="2">0 0 0 1 1 1</KnotVector></Basis>
    <Basis type="BSplineBasis" index="1"><KnotVector degree="1">0 0 0.5 1 1</KnotVector></Basis>
   </Basis>
   <weights>1 0.70710678118654752 1 1 0.70710678118654752 1 1 0.70710678118654752 1</weights>
  </Basis>
  <coefs geoDim="2">1 0  1 1  0 1  1.5 0  1.5 1.5  0 1.5  2 0  2 2  0 2</coefs>
 </Geometry>
 <Geometry type="TensorBSpline2" id="8">
  <Basis type="TensorBSplineBasis2">
   <Basis type="BSplineBasis" index="0"><KnotVector degree="1">0 0 1 1</KnotVector></Basis>
   <Basis type="BSplineBasis" index="1"><KnotVector degree="1">0 0 0.5 1 1</KnotVector></Basis>
  </Basis>
  <coefs geoDim="2">0 1  -1 1  0 1.5  -1 1.5  0 2  -1 2</coefs>
 </Geometry>
 <MultiPatch parDim="2" id="0">
  <patches type="id_range">7 8</patches>
  <interfaces>7 2 8 1 0 1 1 1</interfaces>
  <boundary>7 4
8 4
7 1
7 3
8 2
8 3</boundary>
 </MultiPatch>
</xml>
"#;

/// A unit square of two triangles and a quadrilateral beside it, Gmsh 2.2.
const MIXED: &str = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n3\n1 5 \"left end\"\n2 1 \"soft\"\n2 2 \"hard\"\n$EndPhysicalNames\n\
$Nodes\n6\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n5 3 0 0\n6 3 1 0\n$EndNodes\n\
$Elements\n4\n1 1 2 5 1 4 1\n2 2 2 1 1 1 2 3\n3 2 2 1 1 1 3 4\n4 3 2 2 2 2 5 6 3\n$EndElements\n";

#[test]
fn spline_patches_are_measured_exactly_with_their_sides() {
    let at = folder(&[("ring.xml", RING)]);
    let (code, found) = json(at.path(), &["inspect", "ring.xml"]);
    assert_eq!(code, 0, "{found}");
    assert_eq!((&found["format"], &found["kind"], &found["dimension"]), (&"G+Smo XML".into(), &"patches".into(), &2.into()));
    close(&found["measure"], 0.75 * PI + 1.0, "area");
    let ring = &found["patches"][0];
    assert_eq!((&ring["degree"], &ring["elements"]), (&serde_json::json!([2, 1]), &serde_json::json!([1, 2])));
    // from the x axis to the y axis, then outwards: left-handed
    assert_eq!((&ring["rational"], &ring["handedness"], &ring["id"]), (&true.into(), &"left".into(), &7.into()));
    for (side, length) in [("u0", 1.0), ("u1", 1.0), ("v0", 0.5 * PI), ("v1", PI)] {
        close(&ring["sides"][side], length, side);
    }
    close(&found["patches"][1]["measure"], 1.0, "square");
    assert_eq!(found["patches"][1]["rational"], false);
    let q = &found["quality"];
    assert_eq!((&q["inverted"], &q["elements"]), (&0.into(), &4.into()));
    // the square's elements are 1 x 0.5; an arc is as long as its chord, sqrt(2) r
    close(&q["shortest_edge"], 0.5, "shortest edge");
    close(&q["longest_edge"], 2.0 * 2f64.sqrt(), "longest edge");
    assert!(q["least_scaled_jacobian"].as_f64() > Some(0.5) && q["least_jacobian"].as_f64() > Some(0.0), "{q}");
    let out = faying(at.path(), &["inspect", "ring.xml"]);
    let text = String::from_utf8(out.stdout).unwrap();
    assert!(text.contains("2 x 1") && text.contains("NURBS") && text.contains("v1"), "{text}");
}

#[test]
fn meshes_are_counted_and_measured_by_groups() {
    let at = folder(&[("mixed.msh", MIXED)]);
    let (code, found) = json(at.path(), &["inspect", "mixed.msh"]);
    assert_eq!(code, 0, "{found}");
    close(&found["measure"], 3.0, "area");
    assert_eq!(found["points"], 6);
    let cells: Vec<(&str, u64)> =
        found["cells"].as_array().unwrap().iter().map(|c| (c["shape"].as_str().unwrap(), c["count"].as_u64().unwrap())).collect();
    assert_eq!(cells, [("line", 1), ("triangle", 2), ("quadrilateral", 1)]);
    for (name, dimension, cells, nodes, measure) in [("left end", 1, 1, 2, 1.0), ("soft", 2, 2, 4, 1.0), ("hard", 2, 1, 4, 2.0)] {
        let group = found["groups"].as_array().unwrap().iter().find(|g| g["name"] == name).unwrap();
        assert_eq!((&group["dimension"], &group["cells"], &group["nodes"]), (&dimension.into(), &cells.into(), &nodes.into()), "{group}");
        close(&group["measure"], measure, name);
    }
    let q = &found["quality"];
    close(&q["shortest_edge"], 1.0, "shortest edge");
    close(&q["longest_edge"], 2.0, "longest edge");
    // a right isosceles triangle: det 1 over the longest two edges 1 sqrt(2), regular sqrt(3) / 2
    close(&q["least_scaled_jacobian"], 1.0 / (2f64.sqrt() * 3f64.sqrt() / 2.0), "scaled Jacobian");
    close(&q["least_jacobian"], 1.0, "Jacobian");
}

#[test]
fn groups_that_are_sides_are_told_with_their_middle_and_outward_normal() {
    // a cube with its lid, a lid with half of the wall beside it, and the wall around it
    let faces = [(1, "5 6 7 8"), (2, "5 6 7 8"), (2, "1 2 6 5"), (3, "1 2 6 5"), (3, "2 3 7 6"), (3, "3 4 8 7"), (3, "4 1 5 8")];
    let faces: Vec<String> =
        faces.iter().enumerate().map(|(k, (group, nodes))| format!("{} 3 2 {group} {group} {nodes}\n", k + 1)).collect();
    let cube = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n4\n2 1 \"lid\"\n2 2 \"edge\"\n2 3 \"wall\"\n3 4 \"cube\"\n$EndPhysicalNames\n\
        $Nodes\n8\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n5 0 0 1\n6 1 0 1\n7 1 1 1\n8 0 1 1\n$EndNodes\n$Elements\n8\n"
        .to_owned()
        + &faces.concat()
        + "8 5 2 4 4 1 2 3 4 5 6 7 8\n$EndElements\n";
    let at = folder(&[("mixed.msh", MIXED), ("cube.msh", &cube)]);
    let half = 0.5f64.sqrt();
    for (file, name, middle, normal) in [
        ("mixed.msh", "left end", [0.0, 0.5, 0.0], Some([-1.0, 0.0, 0.0])),
        ("cube.msh", "lid", [0.5, 0.5, 1.0], Some([0.0, 0.0, 1.0])),
        ("cube.msh", "edge", [0.5, 0.25, 0.75], Some([0.0, -half, half])),
        ("cube.msh", "wall", [0.5, 0.5, 0.5], None),
        ("cube.msh", "cube", [f64::NAN; 3], None),
    ] {
        let (code, found) = json(at.path(), &["inspect", file]);
        assert_eq!(code, 0, "{found}");
        let group = found["groups"].as_array().unwrap().iter().find(|g| g["name"] == name).unwrap();
        let same = |value: &Value, point: [f64; 3]| (0..3).for_each(|k| close(&value[k], point[k], name));
        if middle[0].is_nan() {
            assert!(group["middle"].is_null(), "{group}");
        } else {
            same(&group["middle"], middle);
        }
        match normal {
            Some(normal) => same(&group["normal"], normal),
            None => assert!(group["normal"].is_null(), "{group}"),
        }
    }
    let text = |file: &str| String::from_utf8(faying(at.path(), &["inspect", file]).stdout).unwrap();
    let row = |file: &str, name: &str| {
        text(file).lines().find(|line| line.starts_with(name)).unwrap().split_whitespace().collect::<Vec<_>>().join(" ")
    };
    assert!(row("mixed.msh", "left end").ends_with("(0, 0.5) (-1, 0)"), "{}", text("mixed.msh"));
    assert!(
        row("cube.msh", "lid").ends_with("(0.5, 0.5, 1) (0, 0, 1)") && row("cube.msh", "wall").ends_with("(0.5, 0.5, 0.5) all round"),
        "{}",
        text("cube.msh")
    );
}

#[test]
fn inverted_elements_are_reported_with_their_place_and_not_refused() {
    // the quadrilateral crosses itself
    let folded = MIXED.replace("4 3 2 2 2 2 5 6 3", "4 3 2 2 2 2 6 5 3");
    let at = folder(&[("folded.msh", &folded)]);
    let (code, found) = json(at.path(), &["inspect", "folded.msh"]);
    assert_eq!(code, 0, "{found}");
    assert_eq!(found["quality"]["inverted"], 1);
    let place = &found["quality"]["inverted_at"][0];
    assert_eq!((&place["part"], &place["element"]), (&"quadrilateral".into(), &4.into()));
    assert!(place["at"][0].as_f64().is_some_and(|x| (1.0..=3.0).contains(&x)));
    assert!(found["notes"].as_array().unwrap().iter().any(|n| n.as_str().unwrap().contains("1 inverted elements")), "{found}");
}

#[test]
fn cases_are_inspected_by_their_geometry_and_their_blocks() {
    let at = folder(&[]);
    assert_eq!(faying(at.path(), &["new", "poisson-arc"]).status.code(), Some(0));
    let (code, found) = json(at.path(), &["inspect", "poisson-arc.toml"]);
    assert_eq!(code, 0, "{found}");
    let patch = &found["patches"][0];
    assert!(patch["rational"] == true && patch["measure"].as_f64() > Some(0.0), "{found}");
    assert_eq!(found["case"]["patches"][0]["name"], patch["name"]);
    // what `run` says of the same bodies
    let (_, checked) = json(at.path(), &["check", "poisson-arc.toml"]);
    let name = patch["name"].as_str().unwrap();
    close(&patch["measure"], checked["geometry"]["measure"][name].as_f64().unwrap(), "area");
    let (_, changed) = json(at.path(), &["inspect", "poisson-arc.toml", "--set", &format!("patch.{name}.geometry.scale=2")]);
    close(&changed["patches"][0]["measure"], 4.0 * patch["measure"].as_f64().unwrap(), "area of twice the size");
    // bodies that are meshes are inspected by their files
    assert_eq!(faying(at.path(), &["new", "l-bracket"]).status.code(), Some(0));
    let said = String::from_utf8(faying(at.path(), &["inspect", "l-bracket.toml"]).stdout).unwrap();
    assert!(said.starts_with("l-bracket.toml: case, meshes of dimension 2\n") && said.contains("faying inspect l-bracket.msh"), "{said}");
}

#[test]
fn pictures_show_every_element_and_name_the_sides_and_replace_nothing() {
    let at = folder(&[("ring.xml", RING), ("mixed.msh", MIXED)]);
    let (code, found) = json(at.path(), &["inspect", "ring.xml", "--svg"]);
    assert_eq!((code, &found["files"]), (0, &serde_json::json!(["ring.svg"])));
    let svg = std::fs::read_to_string(at.path().join("ring.svg")).unwrap();
    assert_eq!(svg.matches("<polygon").count(), 4);
    for name in ["0.u0", "0.v1", "1.u1"] {
        assert!(svg.contains(&format!(">{name}</text>")), "{name}");
    }
    let mut reader = quick_xml::Reader::from_str(&svg);
    while reader.read_event().unwrap() != quick_xml::events::Event::Eof {}
    let (code, again) = json(at.path(), &["inspect", "ring.xml", "--svg"]);
    assert_eq!((code, &again["diagnostics"][0]["code"]), (4, &"E090".into()));
    assert_eq!(faying(at.path(), &["inspect", "ring.xml", "--svg", "--force"]).status.code(), Some(0));
    assert_eq!(faying(at.path(), &["inspect", "mixed.msh", "--svg=a.svg"]).status.code(), Some(0));
    let svg = std::fs::read_to_string(at.path().join("a.svg")).unwrap();
    assert!(svg.matches("<polygon").count() == 3 && svg.contains(">left end</text>") && svg.contains(">hard</text>"));
    // never over what is read
    assert_eq!(faying(at.path(), &["inspect", "ring.xml", "--svg=./ring.xml", "--force"]).status.code(), Some(2));
    assert!(std::fs::read_to_string(at.path().join("ring.xml")).unwrap() == RING);
}

#[test]
fn files_that_cannot_be_read_end_with_the_code_of_the_contract() {
    let at = folder(&[("ring.xml", RING), ("empty.msh", ""), ("cut.msh", &MIXED[..MIXED.len() / 2])]);
    for (words, exit, code, part) in [
        (&["inspect", "rin.xml"][..], 4, "E003", "ring.xml"),
        (&["inspect", "empty.msh"], 3, "E043", "empty"),
        (&["inspect", "cut.msh"], 3, "E043", "line"),
        (&["inspect", "ring.xml", "--max-memory", "100"], 6, "E081", "allowed"),
        (&["inspect", "."], 4, "E091", "folder"),
    ] {
        let (found, document) = json(at.path(), words);
        let first = &document["diagnostics"][0];
        assert_eq!((found, &first["code"]), (exit, &code.into()), "{words:?}: {document}");
        assert!(first.to_string().contains(part), "{words:?}: {first}");
    }
    assert_eq!(faying(at.path(), &["inspect"]).status.code(), Some(2));
}

#[test]
fn a_byte_order_mark_before_text_is_passed_over() {
    let marked = |text: &str| format!("\u{feff}{text}");
    let at = folder(&[("ring.xml", RING), ("mixed.msh", MIXED), ("bom.xml", &marked(RING)), ("bom.msh", &marked(MIXED))]);
    for (plain, with) in [("ring.xml", "bom.xml"), ("mixed.msh", "bom.msh")] {
        let (a, b) = (json(at.path(), &["inspect", plain]), json(at.path(), &["inspect", with]));
        assert_eq!((a.0, b.0), (0, 0), "{}", b.1);
        assert_eq!((&a.1["measure"], &a.1["quality"]), (&b.1["measure"], &b.1["quality"]));
    }
}

#[test]
fn a_file_that_cannot_be_read_is_named_once() {
    let at = folder(&[("note.txt", "hello")]);
    let (_, document) = json(at.path(), &["inspect", "note.txt"]);
    let message = document["diagnostics"][0]["message"].as_str().unwrap();
    assert_eq!(message.matches("note.txt").count(), 1, "{message}");
}

#[test]
fn files_of_other_programs_have_their_known_sizes() {
    let Some(data) = peer::peer_data() else { return };
    let at = folder(&[]);
    for (file, measure) in [
        ("gismo/planar/unitdisk.xml", PI),
        ("gismo/planar/square_with_disk.xml", 16.0),
        ("gismo/volumes/cube.xml", 27.0),
        ("gismo/volumes/cylinder.xml", 3.0 * PI),
        ("gismo/volumes/fichera.xml", 7.0),
        ("mfem/data/disc-nurbs.mesh", 8.0 * PI),
        ("mfem/data/beam-hex.mesh", 8.0),
        ("mfem/data/beam-tet.mesh", 8.0),
        ("mfem/data/l-shape.mesh", 0.75),
    ] {
        let path = data.join(file);
        let (code, found) = json(at.path(), &["inspect", path.to_str().unwrap()]);
        assert_eq!(code, 0, "{file}: {found}");
        let size = found["measure"].as_f64().unwrap();
        // points of files are rounded to 15 digits
        assert!((size - measure).abs() < 1e-12 * measure, "{file}: {size:e}, expected {measure:e}");
        assert_eq!(found["quality"]["inverted"], 0, "{file}");
    }
}

#[test]
fn splines_go_to_mfem_and_back_to_equal_patches() {
    let at = folder(&[("ring.xml", RING)]);
    for words in [["convert", "ring.xml", "ring.mesh"], ["convert", "ring.mesh", "again.xml"]] {
        let out = faying(at.path(), &words);
        assert_eq!(out.status.code(), Some(0), "{words:?}: {}", String::from_utf8_lossy(&out.stderr));
    }
    let read = |name: &str| match faying_files::read(&at.path().join(name), &Default::default()).unwrap() {
        faying_files::Contents::Patches(file) => file.patches,
        other => panic!("{other:?}"),
    };
    for (a, b) in read("ring.xml").iter().zip(&read("again.xml")) {
        assert_eq!((&a.degree, &a.knots, &a.points), (&b.degree, &b.knots, &b.points));
        let weights = |p: &faying_files::SplinePatch| p.weights.clone().unwrap_or_else(|| vec![1.0; p.points.len()]);
        assert_eq!(weights(a), weights(b));
    }
    assert_eq!(read("again.xml").len(), 2);
}

#[test]
fn gmsh_files_keep_everything_in_another_version_and_in_binary() {
    let at = folder(&[("mixed.msh", MIXED)]);
    for words in [
        &["convert", "mixed.msh", "text.msh"][..],
        &["convert", "text.msh", "binary.msh", "--binary"],
        &["convert", "binary.msh", "v.vtu"],
        &["convert", "v.vtu", "back.msh"],
    ] {
        let out = faying(at.path(), words);
        assert_eq!(out.status.code(), Some(0), "{words:?}: {}", String::from_utf8_lossy(&out.stderr));
    }
    let read = |name: &str| match faying_files::read(&at.path().join(name), &Default::default()).unwrap() {
        faying_files::Contents::Mesh(mesh) => mesh,
        other => panic!("{other:?}"),
    };
    let first = read("mixed.msh");
    for name in ["text.msh", "binary.msh", "back.msh"] {
        let other = read(name);
        assert_eq!((&first.points, &first.blocks, &first.groups), (&other.points, &other.blocks, &other.groups), "{name}");
    }
    assert!(std::fs::read_to_string(at.path().join("text.msh")).unwrap().contains("4.1 0 8"));
}

#[test]
fn splines_become_curved_cells_with_a_group_per_patch_side_and_label() {
    let at = folder(&[("ring.xml", RING)]);
    let (code, done) = json(at.path(), &["convert", "ring.xml", "ring.msh"]);
    assert_eq!(code, 0, "{done}");
    let lost = done["lost"].to_string();
    assert!(lost.contains("knots, weights and smoothness") && lost.contains("cells of order 2 are up to"), "{lost}");
    let areas: Vec<f64> = (1..=4)
        .map(|order| {
            let name = format!("p{order}.msh");
            let out = faying(at.path(), &["convert", "ring.xml", &name, "--order", &order.to_string()]);
            assert_eq!(out.status.code(), Some(0));
            let (_, found) = json(at.path(), &["inspect", &name]);
            assert_eq!((&found["cells"][1]["order"], &found["quality"]["inverted"]), (&order.into(), &0.into()));
            let group = |name: &str| found["groups"].as_array().unwrap().iter().find(|g| g["name"] == name).unwrap().clone();
            close(&group("1")["measure"], 1.0, "square");
            close(&group("0.u0")["measure"], 1.0, "straight side");
            // patches share the points of their common side: (2 p + 1) of 2 (p + 1) (2 p + 1)
            let lattice = (order + 1) * (2 * order + 1);
            assert_eq!(found["points"], 2 * lattice - (2 * order + 1));
            found["measure"].as_f64().unwrap() - 1.0
        })
        .collect();
    // between arcs of radii 1 and 2: chords cut r^2 / 2 off a sector; parabolas through the middle of the arc add 2/3 of base and height
    for (area, sector) in areas.iter().zip([0.5, 0.5 + 2.0 / 3.0 * (2f64.sqrt() - 1.0)]) {
        close(&(*area).into(), 3.0 * sector, "area");
    }
    let off: Vec<f64> = areas.iter().map(|a| (a - 0.75 * PI).abs()).collect();
    assert!(off.windows(2).all(|w| w[1] < w[0]) && off[3] < 0.1 * off[1], "{off:?}");
    let (_, disc) = json(at.path(), &["convert", "ring.xml", "ring.vtu"]);
    assert_eq!(disc["exit"], 0);
    // nodes of a collapsed side lie in one place
    let case = "[model]\nphysics = \"poisson\"\ndimension = 2\n[[patch]]\nname = \"disc\"\nelements = [3, 2]\n\
        geometry = { kind = \"disc-sector\", radius = 1, angle_deg = [0, 90] }\n[[boundary]]\non = \"disc.v1\"\nfix = \"u\"\n";
    std::fs::write(at.path().join("disc.toml"), case).unwrap();
    let (code, done) = json(at.path(), &["convert", "disc.toml", "disc.msh"]);
    assert!(code == 0 && done["lost"].to_string().contains("the common points of disc.v0"), "{done}");
}

#[test]
fn what_cannot_be_converted_says_why_and_writes_nothing() {
    let at = folder(&[("ring.xml", RING), ("mixed.msh", MIXED), ("there.msh", "mine")]);
    for (words, exit, part) in [
        (&["convert", "mixed.msh", "mixed.xml"][..], 3, "holds spline patches"),
        (&["convert", "mixed.msh", "mixed.xml"], 3, "give OUT the ending of a format that holds it"),
        (&["convert", "mixed.msh", "mixed.stl"], 2, "names no format"),
        (&["convert", "mixed.msh", "there.msh"], 4, "exists"),
        (&["convert", "mixed.msh", "./mixed.msh", "--force"], 2, "write over"),
        (&["convert", "nothing.msh", "a.msh"], 4, "no such file"),
        (&["convert", "ring.xml", "a.msh", "--order", "5"], 2, "order"),
        (&["convert", "mixed.msh", "no/such/a.msh"], 0, ""),
    ] {
        let out = faying(at.path(), words);
        let said = String::from_utf8_lossy(&out.stderr).into_owned();
        assert_eq!(out.status.code(), Some(exit), "{words:?}: {said}");
        assert!(said.contains(part), "{words:?}: {said}");
    }
    assert_eq!(std::fs::read_to_string(at.path().join("there.msh")).unwrap(), "mine");
    for name in ["mixed.xml", "mixed.stl", "a.msh"] {
        assert!(!at.path().join(name).exists(), "{name}");
    }
    assert_eq!(faying(at.path(), &["convert", "mixed.msh", "there.msh", "--force"]).status.code(), Some(0));
}

#[test]
fn a_vtu_shows_its_fields_with_their_ranges_whatever_its_cells_are() {
    // u = x + 2 y on [0, 2] x [0, 1]: from 0 to 4; the patch is number 0
    let case = "[model]\nphysics = \"poisson\"\ndimension = 2\nexact = { u = \"x + 2*y\" }\n[[patch]]\nname = \"a\"\n\
                geometry = { kind = \"box\", min = [0, 0], max = [2, 1] }\nelements = [3, 2]\n[[boundary]]\non = \"all-outer\"\ndirichlet = \"exact\"\n";
    let at = folder(&[("case.toml", case)]);
    for (style, shape) in [("bezier", "Bezier quadrilateral"), ("lagrange", "quadrilateral"), ("linear", "quadrilateral")] {
        let out = faying(at.path(), &["run", "case.toml", "--vtu", style, "--force"]);
        assert_eq!(out.status.code(), Some(0), "{}", String::from_utf8_lossy(&out.stderr));
        let (code, found) = json(at.path(), &["inspect", "case.out/fields.vtu"]);
        assert_eq!(code, 0, "{found}");
        let field = |name: &str| found["fields"].as_array().unwrap().iter().find(|f| f["name"] == name).unwrap().clone();
        let u = field("u");
        close(&u["ranges"][0][1], 4.0, "largest u");
        assert!(u["ranges"][0][0].as_f64().unwrap().abs() < 1e-12 && u["on"] == "points", "{u}");
        assert_eq!((&field("patch")["on"], field("patch")["ranges"][0][1].as_f64()), (&"cells".into(), Some(0.0)));
        assert_eq!((found["cells"][0]["shape"].as_str(), found["dimension"].as_u64()), (Some(shape), Some(2)), "{style}");
        if style == "bezier" {
            assert_eq!((&found["cells"][0]["count"], &found["cells"][0]["order"]), (&6.into(), &2.into()));
            assert!(found["notes"].to_string().contains("counted, not measured"), "{found}");
        } else {
            close(&found["measure"], 2.0, "area");
        }
        let text = String::from_utf8(faying(at.path(), &["inspect", "case.out/fields.vtu"]).stdout).unwrap();
        let row = text.lines().map(|l| l.split_whitespace().collect::<Vec<_>>()).find(|w| w.first() == Some(&"u"));
        let row = row.unwrap_or_else(|| panic!("{text}"));
        assert!(row[1] == "points" && row.last() == Some(&"4"), "{row:?}");
    }
}

#[test]
fn a_case_shows_the_patches_of_its_files_where_they_stand() {
    let case = "[model]\nphysics = \"poisson\"\ndimension = 2\n[[patch]]\nname = \"r\"\n\
                geometry = { kind = \"file\", file = \"ring.xml\", scale = 2, move = [1, 0] }\n[[patch]]\nname = \"m\"\n\
                geometry = { kind = \"file\", file = \"mixed.msh\", move = [9, 0] }\n[[boundary]]\non = \"all-outer\"\ndirichlet = 0\n";
    let at = folder(&[("case.toml", case), ("ring.xml", RING), ("mixed.msh", MIXED)]);
    let (code, found) = json(at.path(), &["inspect", "case.toml"]);
    assert_eq!(code, 0, "{found}");
    let names: Vec<&str> = found["patches"].as_array().unwrap().iter().map(|p| p["name"].as_str().unwrap()).collect();
    assert_eq!(names, ["r.0", "r.1"]);
    // a quarter of the ring of radii 2 and 4, a square of edge 2
    close(&found["patches"][0]["measure"], 3.0 * PI, "quarter ring");
    close(&found["patches"][1]["measure"], 4.0, "square");
    assert!(found["notes"].to_string().contains("patch \\\"m\\\" is of a mesh: faying inspect"), "{found}");
}

#[test]
fn sides_are_told_with_their_middle_and_outward_normal() {
    let at = folder(&[("ring.xml", RING)]);
    let (code, found) = json(at.path(), &["inspect", "ring.xml"]);
    assert_eq!(code, 0, "{found}");
    let near = |value: &serde_json::Value, wanted: [f64; 3], what: &str| {
        for k in 0..3 {
            assert!((value[k].as_f64().unwrap() - wanted[k]).abs() < 1e-12, "{what}: {value}");
        }
    };
    // a quarter of a ring: its arcs have their middle at 45 degrees and look from and to the centre; the square [-1, 0] x [1, 2]
    let s = 0.5f64.sqrt();
    let along_radius = |places: &serde_json::Value, side: &str| -> f64 {
        let (middle, normal) = (&places[side]["middle"], &places[side]["normal"]);
        let [x, y] = [0, 1].map(|k| middle[k].as_f64().unwrap());
        let r = x.hypot(y);
        assert!((x / r - s).abs() < 1e-12 && (y / r - s).abs() < 1e-12 && ((r - 1.0).abs() < 1e-12 || (r - 2.0).abs() < 1e-12), "{middle}");
        let outward = if r < 1.5 { -1.0 } else { 1.0 };
        near(normal, [outward * s, outward * s, 0.0], side);
        r
    };
    let ring = &found["patches"][0]["places"];
    let arcs = if ring["v0"]["middle"][0].as_f64().unwrap() > 0.1 && ring["v0"]["middle"][1].as_f64().unwrap() > 0.1 {
        ["v0", "v1"]
    } else {
        ["u0", "u1"]
    };
    assert!((arcs.map(|side| along_radius(ring, side)).iter().sum::<f64>() - 3.0).abs() < 1e-12);
    let square = found["patches"][1]["places"].as_object().unwrap();
    for (middle, normal) in [([-1.0, 1.5], [-1.0, 0.0]), ([0.0, 1.5], [1.0, 0.0]), ([-0.5, 1.0], [0.0, -1.0]), ([-0.5, 2.0], [0.0, 1.0])] {
        let is = |place: &&serde_json::Value| (0..2).all(|k| (place["middle"][k].as_f64().unwrap() - middle[k]).abs() < 1e-12);
        near(&square.values().find(is).unwrap()["normal"], [normal[0], normal[1], 0.0], "square");
    }
    // a full ring is closed, a box in space has six normals, named in its picture
    let case = |dimension: usize, geometry: &str, elements: &str| {
        format!(
            "[model]\nphysics = \"poisson\"\ndimension = {dimension}\n[[patch]]\nname = \"a\"\ngeometry = {{ {geometry} }}\nelements = {elements}\n\
             [[boundary]]\non = \"all-outer\"\ndirichlet = \"0\"\n"
        )
    };
    let ring = "kind = \"annulus-sector\", center = [0, 0], radius = [1, 2], angle_deg = [0, 360]";
    std::fs::write(at.path().join("ring.toml"), case(2, ring, "[4, 1]\nclosed = \"u\"")).unwrap();
    let (code, found) = json(at.path(), &["inspect", "ring.toml"]);
    assert_eq!((code, &found["patches"][0]["places"]["u0"]["closed_with"]), (0, &"u1".into()), "{found}");
    assert!(found["patches"][0]["places"]["u0"]["normal"].is_null());
    let text = String::from_utf8(faying(at.path(), &["inspect", "ring.toml"]).stdout).unwrap();
    assert!(text.contains("lies on u1") && text.contains("lies on u0") && text.contains("outward normal"), "{text}");
    std::fs::write(at.path().join("box.toml"), case(3, "kind = \"box\", min = [0, 0, 0], max = [2, 4, 6]", "[2, 3, 1]")).unwrap();
    let (code, found) = json(at.path(), &["inspect", "box.toml", "--svg"]);
    assert_eq!(code, 0, "{found}");
    for (k, axis) in ["u", "v", "w"].into_iter().enumerate() {
        for (end, sign) in [(0, -1.0), (1, 1.0)] {
            let place = &found["patches"][0]["places"][format!("{axis}{end}")];
            let half = [1.0, 2.0, 3.0];
            let on = |j: usize| if j == k { f64::from(end) * 2.0 * half[j] } else { half[j] };
            near(&place["normal"], std::array::from_fn(|j| if j == k { sign } else { 0.0 }), axis);
            // of two elements the point between them, of three the middle of the second
            near(&place["middle"], std::array::from_fn(on), axis);
        }
    }
    let svg = std::fs::read_to_string(at.path().join("box.svg")).unwrap();
    // from the corner (1, -1, 1): u1, v0 and w1 are seen, the others through the body
    for (name, seen) in [("u0", false), ("u1", true), ("v0", true), ("v1", false), ("w0", false), ("w1", true)] {
        let label = svg.lines().find(|line| line.contains(&format!(">a.{name}</text>"))).unwrap();
        assert_eq!(label.contains("fill-opacity"), !seen, "{label}");
    }
}

#[test]
fn the_picture_of_a_case_is_the_mesh_that_is_solved_with_supports_and_loads() {
    let at = folder(&[]);
    let head = "[model]\nphysics = \"elasticity\"\ndimension = 3\n[discretization]\nbackend = \"fe\"\ndegree = 1\n\
        [[material]]\nname = \"m\"\nyoung = 1\npoisson = 0\n[[patch]]\nname = \"a\"\n\
        geometry = { kind = \"box\", min = [0, 0, 0], max = [2, 4, 6] }\nelements = [2, 3, 1]\n";
    let loads = "[[boundary]]\non = \"a.u1\"\nfix = [\"x\", \"y\", \"z\"]\n[[boundary]]\non = \"a.u0\"\nfix = [\"x\"]\n[[boundary]]\non = \"a.w1\"\npressure = 1\n";
    std::fs::write(at.path().join("box.toml"), format!("{head}{loads}")).unwrap();
    let picture = |words: &[&str]| {
        let all = [&["inspect", "box.toml", "--svg", "--force"][..], words].concat();
        let out = faying(at.path(), &all);
        assert_eq!(out.status.code(), Some(0), "{}", String::from_utf8_lossy(&out.stderr));
        (std::fs::read_to_string(at.path().join("box.svg")).unwrap(), String::from_utf8(out.stdout).unwrap())
    };
    let count = |svg: &str, word: &str| svg.matches(word).count();
    // 2 (2 x 3 + 3 x 1 + 1 x 2) faces of hexahedra; of the two held sides the one that is seen: a mark per element, 3 x 1; 2 x 3 on top
    let (svg, _) = picture(&[]);
    assert_eq!(count(&svg, "<polygon fill"), 22);
    assert_eq!((count(&svg, "class=\"support\""), count(&svg, "class=\"load\"")), (3, 6));
    assert!(svg.contains("triangles: supports, arrows: loads") && svg.contains(">a.u0</text>") && svg.contains(">a</text>"));
    // what presses on the top points down: no step to the side
    let load = svg.lines().find(|line| line.contains("class=\"load\"")).unwrap();
    let ends: Vec<&str> = load.split_once("d=\"M").unwrap().1.split(['L', 'M', ',', '"']).take(4).collect();
    let [x0, y0, x1, y1] = [0, 1, 2, 3].map(|k| ends[k].parse::<f64>().unwrap());
    assert!((x0 - x1).abs() < 0.02 && (y1 - y0 - 22.0).abs() < 0.02, "{ends:?}");
    // tetrahedra: two triangles per face
    let (svg, _) = picture(&["--set", "discretization.cells=simplex"]);
    assert_eq!(count(&svg, "<polygon fill"), 44);
    // a case that has no mesh shows its geometries and says why: the sides of its interface are 3 apart
    let apart = "[[patch]]\nname = \"b\"\ngeometry = { kind = \"box\", min = [5, 0, 0], max = [6, 4, 6] }\nelements = [1, 1, 1]\n\
        [[interface]]\nname = \"i\"\nslave = \"a.u1\"\nmaster = \"b.u0\"\n";
    let held = loads.replace("a.u1", "b.u1");
    std::fs::write(at.path().join("box.toml"), format!("{head}{apart}{held}")).unwrap();
    let (svg, text) = picture(&[]);
    assert!(count(&svg, "<polygon") > 5 && !svg.contains("supports"), "{svg}");
    assert!(text.contains("the picture shows the geometries, for there is no mesh: `a."), "{text}");
}
