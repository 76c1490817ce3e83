//! `--vtu quadratic`: cells that every reader knows, points that are shared, means at them, values in the middle of cells; and what all
//! `.vtu` files have: names of components and patches, pressures.

use faying_files::Limits;
use faying_files::vtu_read::{VtuField, VtuFile, parse};
use std::path::Path;
use std::process::Command;

fn run(at: &Path, words: &[&str]) {
    let out =
        Command::new(env!("CARGO_BIN_EXE_faying")).current_dir(at).args(["run", "case.toml", "--force"]).args(words).output().unwrap();
    assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
}

fn grid(path: &Path) -> VtuFile {
    parse(&std::fs::read(path).unwrap(), &Limits::default()).unwrap()
}

fn field<'a>(fields: &'a [VtuField], name: &str) -> &'a VtuField {
    fields.iter().find(|f| f.name == name).unwrap_or_else(|| panic!("no field {name}"))
}

/// Two squares of n x n elements beside each other, tied, under their weight.
fn squares(dimension: usize, degree: usize, n: usize, cells: &str) -> String {
    let (corner, third, load) = if dimension == 3 { (", 1", ", 0", ", \"0\"") } else { ("", "", "") };
    let elements = format!("[{n}, {n}{}]", if dimension == 3 { format!(", {n}") } else { String::new() });
    let axes = if dimension == 3 { "\"x\", \"y\", \"z\"" } else { "\"x\", \"y\"" };
    format!(
        "[model]\nphysics = \"elasticity\"\ndimension = {dimension}\nbody_force = [\"0\", \"-1\"{load}]\n[discretization]\nbackend = \"fe\"\n\
         degree = {degree}\ncells = \"{cells}\"\n[[material]]\nname = \"m\"\nyoung = 100\npoisson = 0.3\n[[patch]]\nname = \"left\"\n\
         geometry = {{ kind = \"box\", min = [0, 0{third}], max = [1, 1{corner}] }}\nelements = {elements}\n[[patch]]\nname = \"right\"\n\
         geometry = {{ kind = \"box\", min = [1, 0{third}], max = [2, 1{corner}] }}\nelements = {elements}\n[[boundary]]\non = \"left.{}\"\nfix = [{axes}]\n\
         [[interface]]\nname = \"seam\"\nslave = \"right.{}\"\nmaster = \"left.{}\"\n",
        if dimension == 3 { "u0" } else { "left" },
        if dimension == 3 { "u0" } else { "left" },
        if dimension == 3 { "u1" } else { "right" },
    )
}

#[test]
fn points_have_means_and_cells_their_middle_where_fields_jump() {
    // cells of VTK's own types: their number and nodes per cell
    for (dimension, degree, n, cells, kind, nodes) in [
        (2, 1, 4, "tensor", 9, 4),
        (2, 2, 3, "tensor", 28, 9),
        (2, 1, 3, "simplex", 5, 3),
        (2, 2, 3, "simplex", 22, 6),
        (3, 1, 2, "tensor", 12, 8),
        (3, 2, 2, "tensor", 29, 27),
        (3, 2, 1, "simplex", 24, 10),
    ] {
        let what = format!("{dimension}D, degree {degree}, {cells}");
        let at = tempfile::tempdir().unwrap();
        std::fs::write(at.path().join("case.toml"), squares(dimension, degree, n, cells)).unwrap();
        run(at.path(), &["--out", "jump"]);
        run(at.path(), &["--vtu", "quadratic", "--out", "shared"]);
        let (jump, shared) = (grid(&at.path().join("jump/fields.vtu")), grid(&at.path().join("shared/fields.vtu")));
        assert!(shared.types.iter().all(|t| *t == kind), "{what}: {:?}", shared.types);
        assert_eq!((shared.version, shared.points.len()), (100, 2 * (degree * n + 1).pow(dimension as u32)), "{what}");
        assert!(jump.points.len() > shared.points.len(), "{what}: stresses jump");
        assert_eq!(shared.types.len(), jump.types.len());
        assert_eq!(shared.patches, [(0, "left".to_owned()), (1, "right".to_owned())], "{what}");
        assert!(shared.cell_fields.iter().all(|f| f.name != "HigherOrderDegrees"));
        // the nodes of both kinds of cells stand in the same order
        let (own, other) = (field(&shared.point_fields, "displacement"), field(&jump.point_fields, "displacement"));
        for name in ["stress", "von_mises"] {
            let (values, jumps) = (field(&shared.point_fields, name), field(&jump.point_fields, name));
            let c = values.components;
            let (mut sums, mut counts) = (vec![0.0; values.values.len()], vec![0.0; shared.points.len()]);
            let greatest = jumps.values.iter().fold(0.0f64, |m, v| m.max(v.abs()));
            for k in 0..shared.types.len() {
                assert_eq!((shared.cell(k).len(), jump.cell(k).len()), (nodes, nodes), "{what}");
                for (a, b) in shared.cell(k).iter().zip(jump.cell(k)) {
                    let (a, b) = (*a as usize, *b as usize);
                    assert!((0..3).all(|i| (shared.points[a][i] - jump.points[b][i]).abs() < 1e-12), "{what}");
                    assert!((0..3).all(|i| (own.values[3 * a + i] - other.values[3 * b + i]).abs() < 1e-9), "{what}");
                    counts[a] += 1.0;
                    (0..c).for_each(|i| sums[c * a + i] += jumps.values[c * b + i]);
                }
            }
            for (p, count) in counts.iter().enumerate() {
                for i in 0..c {
                    let (found, mean) = (values.values[c * p + i], sums[c * p + i] / count);
                    assert!((found - mean).abs() <= 1e-8 * greatest, "{what}, {name}: {found}, mean {mean}");
                }
            }
            // stresses of degree p - 1 in every direction or less are met by the values in the middle; those of straight triangles are linear
            let middles = field(&shared.cell_fields, name);
            assert_eq!(middles.values.len(), c * shared.types.len());
            if name == "stress" && (degree == 1 || (dimension, cells) == (2, "tensor")) {
                for k in 0..shared.types.len() {
                    let of = jump.cell(k);
                    for i in 0..c {
                        let at = |n: &u32| jumps.values[c * *n as usize + i];
                        let expected = if degree == 1 { of.iter().map(at).sum::<f64>() / nodes as f64 } else { at(&of[8]) };
                        let found = middles.values[c * k + i];
                        assert!((found - expected).abs() <= 1e-8 * greatest, "{what}: {found} in the middle of cell {k}, not {expected}");
                    }
                }
            }
        }
    }
}

#[test]
fn meshio_reads_shared_points_with_all_their_data() {
    if !Command::new("python3").args(["-c", "import meshio"]).output().is_ok_and(|o| o.status.success()) {
        println!("skipped: no Python with meshio");
        return;
    }
    for (dimension, degree, cells, expected) in [
        (2, 1, "tensor", "quad"),
        (2, 2, "tensor", "quad9"),
        (2, 2, "simplex", "triangle6"),
        (3, 2, "tensor", "hexahedron27"),
        (3, 2, "simplex", "tetra10"),
    ] {
        let at = tempfile::tempdir().unwrap();
        std::fs::write(at.path().join("case.toml"), squares(dimension, degree, 2, cells)).unwrap();
        run(at.path(), &["--vtu", "quadratic"]);
        let script = "import meshio, sys\nm = meshio.read(sys.argv[1])\nprint(len(m.points), {b.type for b in m.cells}, sorted(m.point_data), \
                      sorted(m.cell_data), {k: int(v.ravel()[0]) for k, v in m.field_data.items()})";
        let out = Command::new("python3").args(["-c", script]).arg(at.path().join("case.out/fields.vtu")).output().unwrap();
        assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
        let points = 2 * (2 * degree + 1).pow(dimension as u32);
        let expected = format!(
            "{points} {{'{expected}'}} ['displacement', 'stress', 'von_mises'] ['element', 'patch', 'stress', 'von_mises'] {{'patch.left': 0, 'patch.right': 1}}"
        );
        assert_eq!(String::from_utf8_lossy(&out.stdout).lines().last().unwrap(), expected);
    }
}

#[test]
fn components_have_names_and_contacts_a_pressure() {
    let at = tempfile::tempdir().unwrap();
    let out = Command::new(env!("CARGO_BIN_EXE_faying")).current_dir(at.path()).args(["new", "contact-patch"]).output().unwrap();
    assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
    std::fs::rename(at.path().join("contact-patch.toml"), at.path().join("case.toml")).unwrap();
    run(at.path(), &[]);
    let bytes = std::fs::read(at.path().join("case.out/fields.vtu")).unwrap();
    let text = String::from_utf8_lossy(&bytes);
    for names in [
        "ComponentName0=\"xx\" ComponentName1=\"yy\" ComponentName2=\"zz\" ComponentName3=\"xy\" ComponentName4=\"yz\" ComponentName5=\"xz\"",
        "Name=\"displacement\" NumberOfComponents=\"3\"",
        "ComponentName0=\"x\" ComponentName1=\"y\" ComponentName2=\"z\"",
        "Name=\"patch.lower\"",
    ] {
        assert!(text.contains(names), "{names}");
    }
    let side = grid(&at.path().join("case.out/interface_pad.vtu"));
    let (pressure, lambda) = (field(&side.point_fields, "pressure"), field(&side.point_fields, "lambda"));
    // the patch test: 1.25e-3 everywhere
    assert!(pressure.values.iter().all(|p| (p - 1.25e-3).abs() < 1e-12), "{:?}", pressure.values);
    assert!(pressure.values.iter().zip(&lambda.values).all(|(p, l)| *p == -l));
    // the groups of a mesh made of fields are the patches
    let mesh = grid(&at.path().join("case.out/fields.vtu")).mesh().unwrap();
    let names: Vec<String> = mesh.groups.iter().map(|g| g.label()).collect();
    assert_eq!(names, ["lower", "upper"]);
}
