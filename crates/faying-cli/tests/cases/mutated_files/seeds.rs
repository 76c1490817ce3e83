//! What is mutated: small files of every kind, and cases that use them.

use faying_cli::convert::{ConvertOptions, convert};
use faying_files::{self, Format, Limits};
use std::path::{Path, PathBuf};

/// A file, and how a case makes a body of it.
pub struct Seed {
    pub name: String,
    pub bytes: Vec<u8>,
    pub dimension: usize,
    /// Keys of the patch beside its geometry.
    pub keys: &'static str,
}

/// Two squares in the layout of patches; the second one is turned.
const SQUARES: &str = "MFEM NURBS mesh v1.0\n\ndimension\n2\n\nelements\n2\n1 3 0 1 4 3\n1 3 5 4 1 2\n\nboundary\n2\n1 1 0 1\n2 1 2 5\n\n\
    edges\n7\n0 0 1\n1 1 4\n0 3 4\n1 0 3\n2 1 2\n1 2 5\n2 4 5\n\nvertices\n6\n\npatches\n\n\
    knotvectors\n2\n1 2 0 0 1 1\n1 2 0 0 1 1\n\ndimension\n2\n\ncontrolpoints\n0 0 1\n1 0 1\n0 1 1\n1 1 1\n\n\
    knotvectors\n2\n1 2 0 0 1 1\n1 2 0 0 1 1\n\ndimension\n2\n\ncontrolpoints\n2 1 1\n1 1 1\n2 0 1\n1 0 1\n";

/// Two squares by edges, knot vectors, weights and a space.
const BEAM: &str = "MFEM NURBS mesh v1.0\n\n# two patches\ndimension\n2\n\nelements\n2\n1 3 0 1 4 5\n2 3 1 2 3 4\n\nboundary\n6\n3 1 0 1\n\
    3 1 4 5\n3 1 1 2\n3 1 3 4\n1 1 5 0\n2 1 2 3\n\nedges\n7\n0 0 1\n0 5 4\n1 1 2\n1 4 3\n2 0 5\n2 1 4\n2 2 3\n\nvertices\n6\n\nknotvectors\n3\n\
    1 3 0 0 1 2 2\n1 2 0 0 1 1\n1 2 0 0 1 1\n\nweights\n1\n1\n1\n1\n1\n1\n1\n1\n\nFiniteElementSpace\nFiniteElementCollection: NURBS1\n\
    VDim: 2\nOrdering: 1\n\n0 0\n2 0\n3 0\n3 1\n2 1\n0 1\n1 0\n1 1\n";

/// A cube.
const CUBE: &str = "MFEM NURBS mesh v1.0\n\ndimension\n3\n\nelements\n1\n1 5 0 1 2 3 4 5 6 7\n\nboundary\n2\n1 3 0 3 2 1\n2 3 4 5 6 7\n\nedges\n0\n\n\
    vertices\n8\n\npatches\n\nknotvectors\n3\n1 2 0 0 1 1\n1 2 0 0 1 1\n2 3 0 0 0 1 1 1\n\ndimension\n3\n\ncontrolpoints\n0 0 0 1\n1 0 0 1\n\
    0 1 0 1\n1 1 0 1\n0 0 0.5 1\n1 0 0.5 1\n0 1 0.5 1\n1 1 0.5 1\n0 0 1 1\n1 0 1 1\n0 1 1 1\n1 1 1 1\n";

/// Triangles and a quadrilateral with names.
const MIXED: &str = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n3\n1 1 \"left side\"\n1 2 \"right\"\n2 3 \"sheet\"\n$EndPhysicalNames\n$Nodes\n6\n\
    1 0 0 0\n2 1 0 0\n3 2 0 0\n4 0 1 0\n5 1 1 0\n6 2 1 0\n$EndNodes\n$Elements\n5\n1 1 2 1 1 1 4\n2 1 2 2 2 3 6\n3 2 2 3 1 1 2 5\n4 2 2 3 1 1 5 4\n\
    5 3 2 3 1 2 3 6 5\n$EndElements\n";

const IGA: &str = "degree = 2\nelements = 2";
const FE: &str = "degree = 1\nbackend = \"fe\"";
const FE2: &str = "degree = 2\nbackend = \"fe\"";

fn folder(name: &str) -> PathBuf {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")).join(name)
}

/// A sample's files.
pub fn example(name: &str) -> Vec<u8> {
    std::fs::read(folder("examples/cases").join(name)).unwrap()
}

pub fn other_format(bytes: &[u8], to: Format, binary: bool) -> Vec<u8> {
    let read = faying_files::parse("seed", bytes, &Limits::default()).unwrap();
    convert(&read, to, &ConvertOptions { binary, ..ConvertOptions::default() }).unwrap().bytes
}

/// Every kind of file, in the plane and in space.
pub fn seeds() -> Vec<Seed> {
    let gmsh = |name: &str| std::fs::read(folder("tests/data/gmsh").join(name)).unwrap();
    let hexagon = example("cross-point.xml");
    let (quads, tets) = (gmsh("disc_quad_p2_v4_bin.msh"), gmsh("octant_tet_p2_v2.msh"));
    let list: Vec<(&str, Vec<u8>, usize, &'static str)> = vec![
        ("mixed-v2.msh", MIXED.into(), 2, FE2),
        ("mixed-v4.msh", other_format(MIXED.as_bytes(), Format::Gmsh, false), 2, FE),
        ("tri-p2-v4-bin.msh", gmsh("disc_tri_p2_v4_bin.msh"), 2, FE2),
        ("quad-p2-v4.msh", other_format(&quads, Format::Gmsh, false), 2, FE),
        ("tet-p1-v2-bin.msh", gmsh("octant_tet_p1_v2_bin.msh"), 3, FE),
        ("tet-p2-v4.msh", gmsh("octant_tet_p2_v4.msh"), 3, FE),
        ("hex-p3-v2.msh", gmsh("box_hex_p3_v2.msh"), 3, FE),
        ("hex-p3-v4-bin.msh", gmsh("box_hex_p3_v4_bin.msh"), 3, FE2),
        ("quad-p2.mesh", other_format(&quads, Format::Mfem, false), 2, FE2),
        ("tet-p2.mesh", other_format(&tets, Format::Mfem, false), 3, FE),
        ("quad-p2.vtu", other_format(&quads, Format::Vtu, false), 2, FE),
        ("squares-nurbs.mesh", SQUARES.into(), 2, IGA),
        ("beam-nurbs.mesh", BEAM.into(), 2, IGA),
        ("cube-nurbs.mesh", CUBE.into(), 3, IGA),
        ("hexagon-nurbs.mesh", other_format(&hexagon, Format::Mfem, false), 2, FE2),
        ("hexagon.xml", hexagon, 2, IGA),
        ("cube.xml", other_format(CUBE.as_bytes(), Format::Gismo, false), 3, FE),
        ("plate.xml", example("iga-fe-plate.xml"), 2, IGA),
    ];
    list.into_iter().map(|(name, bytes, dimension, keys)| Seed { name: name.to_owned(), bytes, dimension, keys }).collect()
}

impl Seed {
    /// A case that makes a body of the file.
    pub fn case(&self) -> String {
        format!(
            "[model]\nphysics = \"poisson\"\ndimension = {}\nsource = 1\n[[patch]]\nname = \"body\"\n\
             geometry = {{ kind = \"file\", file = \"{}\" }}\n{}\n[[boundary]]\non = \"all-outer\"\ndirichlet = 0\n\
             [[probe]]\nquantity = \"energy\"\n",
            self.dimension, self.name, self.keys
        )
    }
}

/// A case whose bodies are glued, tied and loaded in every way that has a word.
const PLANE: &str = r#"
[let]
F = 2.0
[model]
physics = "elasticity"
dimension = 2
[[material]]
name = "steel"
young = "100 + 10*x"
poisson = 0.3
density = 1.0
[[patch]]
name = "squares"
geometry = { kind = "file", file = "squares-nurbs.mesh", scale = 1.0, rotate_deg = 0, move = [0, 0] }
elements = 2
[[patch]]
name = "sheet"
geometry = { kind = "file", file = "mixed-v2.msh", group = "sheet", move = [2, 0] }
backend = "fe"
refine = 1
[[patch]]
name = "block"
geometry = { kind = "box", min = [0, -1], max = [2, 0] }
elements = [[0, 0.4, 1], 2]
grade = { toward = { v = 1.0 }, ratio = 0.5 }
[[boundary]]
on = "block.bottom"
fix = ["normal"]
[[boundary]]
on = "squares.0.u0"
fix = ["x"]
[[boundary]]
on = "block.u0v0"
fix = ["x", "y"]
[[boundary]]
on = "sheet.right"
where = "y > 0.2"
force = { x = "F*t" }
[[boundary]]
on = ["block.left", "block.right"]
spring = { x = 1.0 }
[[interface]]
name = "seams"
between = ["squares.1", "sheet"]
multiplier = "p/p"
[[contact]]
name = "pad"
slave = "block.top"
master = ["squares.0.v0", "squares.1.v1"]
gap = "g"
[steps]
t = [0.5, 1.0]
[[probe]]
name = "tip"
quantity = "u.y at [3.5, 0.5] in sheet"
[[probe]]
name = "force"
quantity = "contact.pad.force.y"
[[check]]
quantity = "area.sheet"
equals = 2
rtol = 1e-9
"#;

/// Solids: one of a file, a block glued to it, an extruded arc.
const SPACE: &str = r#"
[model]
physics = "elasticity"
dimension = 3
[discretization]
degree = 1
[[material]]
name = "steel"
young = 100
poisson = 0.3
[[patch]]
name = "cube"
geometry = { kind = "file", file = "cube-nurbs.mesh", id = 0 }
elements = 2
[[patch]]
name = "hexes"
geometry = { kind = "box", min = [1, 0, 0], max = [2, 1, 1] }
elements = [1, 2, 2]
backend = "fe"
[[patch]]
name = "pipe"
geometry = { kind = "annulus-sector", radius = [1, 2], angle_deg = [0, 90], extrude = 1, rotate_deg = 90, axis = [0, 0, 1], move = [0, 0, 2] }
elements = [2, 1, 1]
degree = 2
[[boundary]]
on = "cube.u0"
fix = ["x", "y", "z"]
[[boundary]]
on = "hexes.u1"
traction = [0, 0, "t"]
[[boundary]]
on = ["pipe.w0", "pipe.w1"]
fix = ["z"]
[[boundary]]
on = "pipe.u0"
fix = ["normal"]
[[boundary]]
on = "pipe.u1"
fix = ["normal"]
[[boundary]]
on = "pipe.v0"
pressure = "z"
[[interface]]
name = "seam"
slave = "cube.u1"
master = "hexes.u0"
coupling = "glue"
[steps]
count = 2
[[probe]]
quantity = "volume.pipe"
[[check]]
quantity = "u.z.max"
above = 0
"#;

/// Cases with the files that they use.
pub fn cases() -> Vec<String> {
    let text = |name: &str| String::from_utf8(example(name)).unwrap();
    let few = |text: String| {
        text.replace("[12, 12]", "[3, 3]").replace("[12, 8]", "[4, 2]").replace("[8, 8]", "[2, 2]").replace("[10, 10]", "[3, 2]")
    };
    vec![
        PLANE.to_owned(),
        SPACE.to_owned(),
        few(text("cross-point.toml")),
        few(text("iga-fe-plate.toml")).replace("refine = 1 ", "refine = 0 "),
    ]
}
