//! Cases in three dimensions whose bodies come from files, and files that say the same in other words.

use crate::common::peer;
use faying_cli::Case;
use faying_cli::case::ReadOptions;
use faying_cli::errors::Diagnostics;
use faying_cli::{Registry, RunResult, Status};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use tempfile::TempDir;

fn try_run(folder: &Path, text: &str) -> Result<RunResult, Diagnostics> {
    let options = ReadOptions { folder: Some(folder.to_owned()), ..ReadOptions::default() };
    Case::parse("case.toml", text, &options)?.run(&Registry::default())
}

fn run(folder: &Path, text: &str) -> RunResult {
    let result = try_run(folder, text).unwrap_or_else(|e| panic!("{e}\n{text}"));
    assert_eq!(result.status, Status::Ok, "{:?}\n{text}", result.diagnostics);
    result
}

fn values(result: &RunResult) -> Vec<f64> {
    result.probes.iter().map(|p| p.value).collect()
}

fn probes(quantities: &[&str]) -> String {
    quantities.iter().map(|q| format!("[[probe]]\nquantity = '{q}'\n")).collect()
}

/// Largest difference of two lists, relative to the second.
fn apart(a: &[f64], b: &[f64]) -> f64 {
    assert!(a.len() == b.len() && b.iter().all(|v| v.is_finite() && v.abs() > 1e-4), "{a:?} {b:?}");
    a.iter().zip(b).map(|(x, y)| ((x - y) / y).abs()).fold(0.0, f64::max)
}

const SAME: f64 = 1e-10;

/// -div grad u = 1 with u = 0 all around the body of a file.
fn heated(dimension: usize, geometry: &str, keys: &str, quantities: &[&str]) -> String {
    format!(
        "[model]\nphysics = \"poisson\"\ndimension = {dimension}\nsource = 1\n[[patch]]\nname = \"b\"\n\
         geometry = {{ kind = \"file\", {geometry} }}\n{keys}\n[[boundary]]\non = \"all-outer\"\ndirichlet = 0\n{}",
        probes(quantities)
    )
}

#[test]
fn solids_stored_in_other_orders_and_directions_have_one_solution() {
    let Some(peer) = peer::peer_data() else { return };
    let folder = peer.join("mfem/miniapps-nurbs");
    let quantities = ["energy", "volume.b", "u at [0.3, 0.4, 0.3]", "u at [1.0, 0.5, 0.5]", "u at [1.6, 0.2, 0.7]"];
    for backend in ["iga", "fe"] {
        for list in ["", ", refinement = \"two-cubes.ref\""] {
            let keys = format!("backend = \"{backend}\"\ndegree = 2\nelements = 2");
            let all = ["two-cubes-nurbs", "two-cubes-nurbs-autoedge", "two-cubes-nurbs-rot"]
                .map(|name| values(&run(&folder, &heated(3, &format!("file = \"{name}.mesh\"{list}"), &keys, &quantities))));
            for one in &all[1..] {
                let apart = apart(one, &all[0]);
                println!("two cubes {backend}{list}: {one:?}, apart {apart:.1e}");
                assert!(apart < SAME);
            }
            assert!((all[0][1] - 2.0).abs() < 1e-12);
        }
        // one box from the program's own shapes, with the same elements
        let boxed = format!(
            "[model]\nphysics = \"poisson\"\ndimension = 3\nsource = 1\n[[patch]]\nname = \"b\"\n\
             geometry = {{ kind = \"box\", min = [0, 0, 0], max = [2, 1, 1] }}\nbackend = \"fe\"\ndegree = 2\nelements = [4, 2, 2]\n\
             [[boundary]]\non = \"all-outer\"\ndirichlet = 0\n{}",
            probes(&quantities)
        );
        let keys = "backend = \"fe\"\ndegree = 2\nelements = 2";
        let read = values(&run(&folder, &heated(3, "file = \"two-cubes-nurbs.mesh\"", keys, &quantities)));
        assert!(apart(&read, &values(&run(&folder, &boxed))) < SAME);
    }
}

/// A case whose exact solution is given, prescribed on `held`, its fluxes or tractions on all other sides.
fn exact(dimension: usize, physics: &str, u: &str, geometry: &str, keys: &str, held: &str) -> String {
    let steel = if physics == "elasticity" { "[[material]]\nname = \"m\"\nyoung = 1.0\npoisson = 0.3\n" } else { "" };
    format!(
        "[model]\nphysics = \"{physics}\"\ndimension = {dimension}\nexact = {{ u = {u} }}\n{steel}[[patch]]\nname = \"b\"\n\
         geometry = {{ kind = \"file\", {geometry} }}\n{keys}\n[[boundary]]\non = {held}\ndirichlet = \"exact\"\n{}",
        probes(&["error.u.L2", "error.u.H1"])
    )
}

const LINEAR: [(&str, &str); 2] = [("poisson", "\"x - 2*y + 3*z\""), ("elasticity", "[\"0.1*x + 0.2*z\", \"y - 0.3*x\", \"0.2*y - z\"]")];

#[test]
fn volumes_of_other_programs_reproduce_linear_fields() {
    let Some(peer) = peer::peer_data() else { return };
    // rational maps: the rule is exact only in the limit of many points
    let files: [(&str, &str, f64); 8] = [
        ("gismo/volumes/cube.xml", "", 27.0),
        ("gismo/volumes/fichera.xml", "", 7.0),
        ("gismo/volumes/cylinder.xml", "", 3.0 * std::f64::consts::PI),
        ("mfem/miniapps-nurbs/ijk-hex-nurbs.mesh", "", 8.0),
        ("mfem/data/beam-hex-nurbs.mesh", "", 8.0),
        // in the plane, made solid
        ("gismo/planar/lshape2d_3patches_tens.xml", ", extrude = 0.5", 1.5),
        ("gismo/planar/square_with_disk.xml", ", extrude = 0.5", 8.0),
        ("gismo/planar/two_squares.xml", ", extrude = 2", 4.0),
    ];
    for (name, more, volume) in files {
        let path = peer.join(name);
        let geometry = format!("file = \"{}\"{more}", path.file_name().unwrap().to_str().unwrap());
        for (physics, u) in LINEAR {
            let text = exact(
                3,
                physics,
                u,
                &geometry,
                if name.contains("cylinder") || name.contains("disk") { "extra_points = 10" } else { "" },
                "\"all-outer\"",
            ) + &probes(&["volume.b"]);
            let found = values(&run(path.parent().unwrap(), &text));
            println!("{name} {physics}: {found:?}");
            assert!(found[..2].iter().all(|e| *e < SAME * found[2]), "{name} {physics}: {found:?}");
            assert!((found[2] - volume).abs() < 1e-10 * volume, "{name}: {found:?}");
        }
    }
}

#[test]
fn indented_and_labelled_variants_of_a_file_have_one_solution() {
    let Some(peer) = peer::peer_data() else { return };
    let folder = peer.join("splinepy");
    for backend in ["iga", "fe"] {
        let keys = format!("backend = \"{backend}\"\ndegree = 3\nelements = 2");
        let of = |dimension: usize, name: &str| {
            let size = if dimension == 3 { "volume.b" } else { "area.b" };
            values(&run(&folder, &heated(dimension, &format!("file = \"{name}\""), &keys, &["energy", size, "u.max"])))
        };
        let variants = ["indent_labels", "indent_nolabels", "noindent_labels", "noindent_nolabels"];
        let flat = variants.map(|v| of(2, &format!("gismo_{v}_ascii_2d.xml")));
        let cartesian = of(2, "mfem_cartesian_2d.mesh");
        for one in flat[1..].iter().chain([&cartesian]) {
            assert!(apart(one, &flat[0]) < SAME, "{one:?} {:?}", flat[0]);
        }
        let solid = ["gismo_indent_nolabels_ascii_3d.xml", "gismo_noindent_nolabels_ascii_3d.xml", "mfem_cartesian_3d.mesh"];
        let solid = solid.map(|name| of(3, name));
        println!("{backend}: {:?} {:?}", flat[0], solid[0]);
        assert!(solid[1..].iter().all(|one| apart(one, &solid[0]) < SAME), "{solid:?}");
    }
}

#[test]
fn text_and_binary_twins_are_one_mesh_and_surfaces_are_no_bodies() {
    let Some(peer) = peer::peer_data() else { return };
    let folder = peer.join("ndgrid/meshes");
    // the six tetrahedra of a cube share one diagonal; cubes of them at degree 2 and 4
    for degree in [2, 4] {
        let of = |name: &str| {
            let keys = format!("degree = {degree}\nrefine = 1");
            run(&folder, &heated(3, &format!("file = \"{name}.msh\""), &keys, &["energy", "volume.b", "u at [0.5, 0.4, 0.3]"]))
        };
        let (text, binary) = (of("cube_tetrahedron"), of("cube_tetrahedron_bin"));
        assert_eq!(text.unknowns, binary.unknowns);
        assert_eq!(values(&text), values(&binary));
        assert!((values(&text)[1] - 1.0).abs() < 1e-12);
    }
    for name in ["cube_quadrilateral", "cube_quadrilateral_bin", "sphere_triangle", "sphere_triangle_bin"] {
        for dimension in [2, 3] {
            let found = try_run(&folder, &heated(dimension, &format!("file = \"{name}.msh\""), "", &["energy"])).unwrap_err();
            assert_eq!(found.items[0].code, "E044", "{name}: {found}");
        }
    }
}

/// A block bent around the z axis: degree 2 x 1 x 1, no arc, so cells of order 2 have its shape exactly.
const BENT: &str = r#"<?xml version="1.0"?>
<xml><Geometry type="TensorBSpline3" id="0"><Basis type="TensorBSplineBasis3">
<Basis type="BSplineBasis" index="0"><KnotVector degree="2">0 0 0 0.5 1 1 1</KnotVector></Basis>
<Basis type="BSplineBasis" index="1"><KnotVector degree="1">0 0 0.5 1 1</KnotVector></Basis>
<Basis type="BSplineBasis" index="2"><KnotVector degree="1">0 0 1 1</KnotVector></Basis></Basis>
<coefs geoDim="3">0 0 0  0.5 0.3 0  1.5 0.3 0  2 0 0   0 0.5 0  0.5 0.8 0  1.5 0.8 0  2 0.5 0   0 1 0  0.5 1.3 0  1.5 1.3 0  2 1 0
 0 0 1  0.5 0.3 1.1  1.5 0.3 1.2  2 0 1   0 0.5 1  0.5 0.8 1.1  1.5 0.8 1.2  2 0.5 1   0 1 1  0.5 1.3 1.1  1.5 1.3 1.2  2 1 1</coefs>
</Geometry></xml>"#;

fn converted(order: usize) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("bent.xml"), BENT).unwrap();
    for (name, more) in [("bent.msh", &[][..]), ("binary.msh", &["--binary"])] {
        let mut command = Command::new(env!("CARGO_BIN_EXE_faying"));
        let out = command.current_dir(folder.path()).args(["convert", "bent.xml", name, "--order", &order.to_string()]);
        let out = out.args(more).stdin(Stdio::null()).output().unwrap();
        assert_eq!(out.status.code(), Some(0), "{}", String::from_utf8_lossy(&out.stderr));
    }
    folder
}

#[test]
fn curved_hexahedra_of_a_file_reproduce_linear_fields_and_have_the_splines_volume() {
    for order in [2, 3] {
        let folder = converted(order);
        let volume = values(&run(
            folder.path(),
            &(exact(3, "poisson", "\"x\"", "file = \"bent.xml\"", "", "\"all-outer\"") + &probes(&["volume.b"])),
        ))[2];
        for file in ["bent.msh", "binary.msh"] {
            for (physics, u) in LINEAR {
                let geometry = format!("file = \"{file}\"");
                let text = exact(3, physics, u, &geometry, &format!("degree = {order}"), "[\"b.\\\"0.u0\\\"\", \"b.\\\"0.v1\\\"\"]")
                    + "[[boundary]]\non = \"all-outer\"\nneumann = \"exact\"\n"
                    + &probes(&["volume.b"]);
                let found = values(&run(folder.path(), &text));
                println!("order {order} {file} {physics}: {found:?}, volume {volume}");
                assert!(found[..2].iter().all(|e| *e < SAME), "{found:?}");
                assert!((found[2] - volume).abs() < 1e-12 * volume, "{found:?}");
            }
        }
    }
}

#[test]
fn meshes_written_by_gmsh_reproduce_the_polynomials_of_their_degree() {
    let folder = PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")).join("tests/data/gmsh");
    // straight hexahedra of order 3: all cubics; curved tetrahedra: linear fields, whatever their order
    let cubic = [("poisson", "\"x^3 - 2*x*y*z + y^2*z\""), ("elasticity", "[\"x^2*y\", \"y^3 - z^2*x\", \"x*y*z\"]")];
    for version in ["v2", "v2_bin", "v4", "v4_bin"] {
        for (physics, u) in cubic {
            let text = exact(3, physics, u, &format!("file = \"box_hex_p3_{version}.msh\""), "degree = 3\nrefine = 1", "\"b.left\"")
                + "[[boundary]]\non = \"all-outer\"\nneumann = \"exact\"\n";
            let found = values(&run(&folder, &text));
            println!("hexahedra {version} {physics}: {found:?}");
            assert!(found.iter().all(|e| *e < SAME), "{found:?}");
        }
    }
    for name in ["octant_tet_p2_v4", "octant_tet_p2_v4_bin", "octant_tet_p2_v2", "octant_tet_p3_v2_bin"] {
        let degree = if name.contains("p3") { 3 } else { 2 };
        for (physics, u) in LINEAR {
            let geometry = format!("file = \"{name}.msh\", group = \"ball\"");
            let text = exact(3, physics, u, &geometry, &format!("degree = {degree}"), "'b.\"outer skin\"'")
                + "[[boundary]]\non = \"all-outer\"\nneumann = \"exact\"\n";
            let found = values(&run(&folder, &text));
            println!("{name} {physics}: {found:?}");
            assert!(found.iter().all(|e| *e < SAME), "{found:?}");
        }
    }
}

#[test]
fn patches_of_a_file_left_apart_are_tied_or_glued_by_between() {
    let Some(peer) = peer::peer_data() else { return };
    let files = [
        ("mfem/miniapps-nurbs", "two-squares-nurbs.mesh", 2, "\"x - 2*y\""),
        ("mfem/miniapps-nurbs", "two-cubes-nurbs-rot.mesh", 3, "\"x - 2*y + z\""),
        ("gismo/volumes", "fichera.xml", 3, "\"x - 2*y + z\""),
    ];
    for (folder, name, dimension, u) in files {
        let folder = peer.join(folder);
        let of = |more: &str, joint: &str| {
            let keys = format!("degree = 2\nelements = 2\n{more}");
            let text = exact(dimension, "poisson", u, &format!("file = \"{name}\""), &keys, "\"all-outer\"");
            run(&folder, &format!("{text}[[probe]]\nquantity = \"unknowns\"\n{joint}"))
        };
        let together = of("", "");
        let glued = of("glue = false", "[[interface]]\nbetween = \"all\"\ncoupling = \"glue\"\n");
        assert_eq!(together.unknowns, glued.unknowns, "{name}");
        // without an interface each patch is a body: the common side is part of its outside
        let alone = of("glue = false", "");
        assert!(alone.unknowns.primal > together.unknowns.primal && alone.unknowns.multipliers == 0, "{name}");
        let mut all = vec![together, glued, alone];
        let tie = "[[interface]]\nbetween = \"all\"\n";
        if dimension == 2 {
            let tied = of("glue = false", tie);
            assert!(tied.unknowns.multipliers > 0 && tied.unknowns.primal > all[0].unknowns.primal, "{name}");
            all.push(tied);
        }
        for result in &all {
            let found = values(result);
            println!("{name}: {found:?}");
            assert!(found[..2].iter().all(|e| *e < SAME), "{name}: {found:?}");
        }
    }
}
