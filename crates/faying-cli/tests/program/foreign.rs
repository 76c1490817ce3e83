//! Files that are written here, read by Gmsh, PyMFEM and meshio; skipped where Python has them not.

use faying_cli::convert::{ConvertOptions, convert};
use faying_files::{Format, Limits, read};
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::Command;

fn file(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/program").join(name)
}

/// What Gmsh and meshio find in some files.
fn seen(files: &[PathBuf]) -> Vec<Value> {
    let output = Command::new("python3").arg(file("foreign/read.py")).args(files).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    // both print remarks before the document
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    serde_json::from_str(text.lines().last().unwrap()).unwrap()
}

#[test]
fn gmsh_and_meshio_read_what_is_written() {
    if !Command::new("python3").args(["-c", "import gmsh, meshio"]).output().is_ok_and(|o| o.status.success()) {
        println!("skipped: no Python with gmsh and meshio");
        return;
    }
    let names = [
        "disc_tri_p1_v4_bin",
        "disc_tri_p2_v4_bin",
        "disc_tri_p3_v4_bin",
        "disc_tri_p4_v4_bin",
        "disc_quad_p1_v4_bin",
        "disc_quad_p2_v4_bin",
        "disc_quad_p3_v4_bin",
        "disc_quad_p4_v4_bin",
        "octant_tet_p1_v2_bin",
        "octant_tet_p2_v4",
        "octant_tet_p3_v2_bin",
        "octant_tet_p4_v2_bin",
        "box_hex_p3_v4",
    ];
    let folder = tempfile::tempdir().unwrap();
    let mut files = Vec::new();
    for name in names {
        let own = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/data/gmsh").join(format!("{name}.msh"));
        let contents = read(&own, &Limits::default()).unwrap();
        files.push(own);
        for binary in [false, true] {
            let path = folder.path().join(format!("{name}_{binary}.msh"));
            std::fs::write(&path, convert(&contents, Format::Gmsh, &ConvertOptions { binary, ..ConvertOptions::default() }).unwrap().bytes)
                .unwrap();
            files.push(path);
        }
    }
    let all = seen(&files);
    for (name, own) in names.iter().zip(all.chunks(3)) {
        // version 2 lists an element once per group, and others keep every copy: its facets are counted twice
        let exact = name.contains("v4");
        for written in &own[1..] {
            assert_eq!(written[0]["types"], own[0][0]["types"], "{name}");
            if exact {
                assert_eq!(written[0]["groups"], own[0][0]["groups"], "{name}");
                assert_eq!(written[1], own[0][1], "{name}");
            }
            for d in if exact { 0..3 } else { 2..3 } {
                let (a, b) = (written[0]["measures"][d].as_f64().unwrap(), own[0][0]["measures"][d].as_f64().unwrap());
                assert!((a - b).abs() <= 1e-13 * b.abs(), "{name}: measure of dimension {}: {a}, {b} in the original", d + 1);
            }
        }
        assert!(own[0][0]["measures"].as_array().unwrap().iter().any(|m| m.as_f64().unwrap() > 0.4), "{name}");
    }
}

/// A quarter of a ring and half of it beside, both left-handed, and the same as solids of height 1: G+Smo XML.
fn rings(solid: bool) -> String {
    let knots = |k: usize, p: usize| {
        let ends = |t: &str| vec![t; p + 1].join(" ");
        format!("<Basis type=\"BSplineBasis\" index=\"{k}\"><KnotVector degree=\"{p}\">{} {}</KnotVector></Basis>", ends("0"), ends("1"))
    };
    let mut text = "<xml>".to_owned();
    let d = if solid { 3 } else { 2 };
    for (id, (a, b)) in [(1.0, 2.0), (2.0, 3.5)].into_iter().enumerate() {
        let layer = |z: &str| {
            let points = |r: f64| format!("{r} 0 {z} {r} {r} {z} 0 {r} {z} ");
            points(a) + &points(b)
        };
        let layers = if solid { layer("0") + &layer("1") } else { layer("") };
        let axes: String = [2, 1, 1][..d].iter().enumerate().map(|(k, p)| knots(k, *p)).collect();
        let weights = "1 0.70710678118654752 1 ".repeat(if solid { 4 } else { 2 });
        text += &format!(
            "<Geometry type=\"TensorNurbs{d}\" id=\"{id}\"><Basis type=\"TensorNurbsBasis{d}\"><Basis type=\"TensorBSplineBasis{d}\">{axes}</Basis>\
             <weights>{weights}</weights></Basis><coefs geoDim=\"{d}\">{layers}</coefs></Geometry>"
        );
    }
    let map = if solid { "0 1 2 1 1 1" } else { "0 1 1 1" };
    text + &format!(
        "<MultiPatch parDim=\"{d}\" id=\"9\"><patches type=\"id_range\">0 1</patches><interfaces>0 4 1 3 {map}</interfaces>\
         <boundary name=\"inside\">0 3</boundary></MultiPatch></xml>"
    )
}

/// Measure and least cell of files as other programs find them; none where a program is not there.
fn signed(files: &[PathBuf]) -> Vec<Option<[f64; 2]>> {
    let Ok(output) = Command::new("python3").arg(file("foreign/signed.py")).args(files).output() else { return vec![None; files.len()] };
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    serde_json::from_str(text.lines().last().unwrap()).unwrap()
}

#[test]
fn other_programs_find_no_negative_cell_and_our_measure() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let faying = |words: &[&str]| {
        let out = Command::new(env!("CARGO_BIN_EXE_faying")).current_dir(folder.path()).args(words).arg("--json").output().unwrap();
        assert!(out.status.success(), "{words:?}: {}", String::from_utf8_lossy(&out.stderr));
        serde_json::from_slice::<Value>(&out.stdout).unwrap()
    };
    let mut files = Vec::new();
    for solid in [false, true] {
        let name = if solid { "solid" } else { "plane" };
        std::fs::write(at(&format!("{name}.xml")), rings(solid)).unwrap();
        let found = faying(&["inspect", &format!("{name}.xml")]);
        assert_eq!(found["patches"][0]["handedness"], "left");
        let exact = (3.5f64 * 3.5 - 1.0) * std::f64::consts::PI / 4.0;
        assert!((found["measure"].as_f64().unwrap() / exact - 1.0).abs() < 1e-12);
        for (end, order) in [("msh", "1"), ("msh", "2"), ("msh", "4"), ("mesh", "1")] {
            let to = format!("{name}_{order}.{end}");
            faying(&["convert", &format!("{name}.xml"), &to, "--order", order]);
            files.push((at(&to), if end == "mesh" { exact } else { faying(&["inspect", &to])["measure"].as_f64().unwrap() }, 1e-9));
        }
        // Lagrange cells in an MFEM mesh: order 1 with vertices, 2 with nodes
        for order in ["1", "2"] {
            let (from, to) = (format!("{name}_{order}.msh"), format!("{name}_lagrange_{order}.mesh"));
            faying(&["convert", &from, &to]);
            let ours = faying(&["inspect", &to]);
            assert_eq!(ours["quality"]["left_handed"], 0, "{to}");
            files.push((at(&to), ours["measure"].as_f64().unwrap(), if order == "1" && !solid { 1e-12 } else { 1e-9 }));
        }
        // sides keep their names over a round trip, for this program and by their place
        faying(&["convert", &format!("{name}_1.mesh"), &format!("{name}_back.xml")]);
        let back = faying(&["inspect", &format!("{name}_back.xml")]);
        for k in 0..2 {
            assert_eq!(back["patches"][k]["sides"], found["patches"][k]["sides"]);
            assert_eq!(back["patches"][k]["handedness"], "left");
        }
        assert_eq!(back["joints"], found["joints"]);
        assert_eq!(back["labels"][0]["sides"], found["labels"][0]["sides"]);
        // another program sees right-handed patches with the label on the same side
        let text = std::fs::read_to_string(at(&format!("{name}_1.mesh"))).unwrap();
        let plain: String = text.lines().filter(|line| !line.starts_with("# faying")).map(|line| format!("{line}\n")).collect();
        assert_ne!(plain.len(), text.len());
        std::fs::write(at(&format!("{name}_plain.mesh")), plain).unwrap();
        let plain = faying(&["inspect", &format!("{name}_plain.mesh")]);
        assert_eq!(plain["patches"][0]["handedness"], "right");
        assert_eq!((&plain["labels"][0]["sides"][0], &found["labels"][0]["sides"][0]), (&"0.u0".into(), &"0.v0".into()));
        let measure = |found: &Value| found["labels"][0]["measure"].as_f64().unwrap();
        assert!((measure(&plain) / measure(&found) - 1.0).abs() < 1e-12);
    }
    let paths: Vec<PathBuf> = files.iter().map(|f| f.0.clone()).collect();
    for ((path, ours, tolerance), theirs) in files.iter().zip(signed(&paths)) {
        let Some([total, least]) = theirs else {
            println!("skipped: {}: python3 has not its program", path.display());
            continue;
        };
        assert!(least > 0.0, "{}: a cell of {least}", path.display());
        assert!((total / ours - 1.0).abs() < *tolerance, "{}: {total}, ours {ours}", path.display());
    }
}

#[test]
fn fields_are_no_larger_than_what_meshio_writes() {
    if !Command::new("python3").args(["-c", "import meshio"]).output().is_ok_and(|o| o.status.success()) {
        println!("skipped: no Python with meshio");
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    for (physics, load) in [("poisson", "source = \"1\""), ("elasticity", "body_force = [\"0\", \"-1\"]")] {
        let fixed = if physics == "poisson" { "dirichlet = \"0\"" } else { "fix = [\"x\", \"y\"]" };
        let material = if physics == "poisson" { "" } else { "[[material]]\nname = \"m\"\nyoung = 1\npoisson = 0.3\n" };
        let case = format!(
            "[model]\nphysics = \"{physics}\"\ndimension = 2\n{load}\n[discretization]\nbackend = \"fe\"\ndegree = 1\n{material}[[patch]]\n\
             name = \"a\"\ngeometry = {{ kind = \"box\", min = [0, 0], max = [1, 1] }}\nelements = [60, 60]\n[[boundary]]\non = \"all-outer\"\n{fixed}\n"
        );
        std::fs::write(folder.path().join("case.toml"), case).unwrap();
        let out =
            Command::new(env!("CARGO_BIN_EXE_faying")).current_dir(folder.path()).args(["run", "case.toml", "--force"]).output().unwrap();
        assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
        // bilinear cells of meshio's own kind, one point per node where the data allow it
        let script = "import meshio, sys\nm = meshio.read(sys.argv[1])\n\
                      cells = [('quad', b.data[:, :4]) for b in m.cells]\n\
                      meshio.Mesh(m.points, cells, point_data=m.point_data, cell_data=m.cell_data).write(sys.argv[2])\nprint(len(m.points))";
        let fields = folder.path().join("case.out/fields.vtu");
        let theirs = folder.path().join("theirs.vtu");
        let out = Command::new("python3").args(["-c", script]).args([&fields, &theirs]).output().unwrap();
        assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
        let points: usize = String::from_utf8_lossy(&out.stdout).lines().last().unwrap().parse().unwrap();
        // the displacement is continuous, stresses of bilinear elements are not
        assert!(if physics == "poisson" { points == 61 * 61 } else { points > 2 * 61 * 61 }, "{physics}: {points} points");
        let [own, other] = [&fields, &theirs].map(|path| std::fs::metadata(path).unwrap().len() as f64);
        assert!(own <= 1.2 * other, "{physics}: {own} bytes, meshio {other}");
    }
}
