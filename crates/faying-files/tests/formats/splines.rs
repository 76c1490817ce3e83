//! Files of spline patches and MFEM meshes: every one of the peer data is read with a fact, or refused with the reason.

use crate::common::peer;
mod measure;

use faying_files::{CellShape, Contents, FileError, Limits, MeshFile, SplineFile, SplinePatch, gismo, mfem};
use measure::{at, mesh_measure, patch_measure};
use peer::peer_data;
use std::f64::consts::PI;
use std::path::Path;

fn patches(folder: &Path, name: &str) -> SplineFile {
    match faying_files::read(&folder.join(name), &Limits::default()) {
        Ok(Contents::Patches(file)) => file,
        other => panic!("{name}: {other:?}"),
    }
}

fn mesh(folder: &Path, name: &str) -> MeshFile {
    match faying_files::read(&folder.join(name), &Limits::default()) {
        Ok(Contents::Mesh(file)) => file,
        other => panic!("{name}: {other:?}"),
    }
}

fn text(bytes: impl AsRef<[u8]>) -> Result<Contents, FileError> {
    faying_files::parse("test", bytes.as_ref(), &Limits::default())
}

fn refusal(bytes: impl AsRef<[u8]>) -> String {
    let error = text(bytes).unwrap_err();
    assert_eq!(crate::kind(&error), "content");
    error.to_string()
}

fn near(value: f64, expected: f64, relative: f64, what: &str) {
    assert!((value - expected).abs() <= relative * expected.abs(), "{what}: {value:.17e}, expected {expected:.17e}");
}

/// File, patches, joints, measure and how well the file's digits give it.
const SPLINES: &[(&str, usize, usize, f64, f64)] = &[
    // by the same formulas in Python
    ("gismo/domain2d/yeti_mp2.xml", 21, 24, 6.191070496411402, 1e-12),
    // hexagons of side 1: 3 sqrt(3) / 2
    ("gismo/planar/hexagon_3p.xml", 3, 3, 2.598_076_211_353_316, 1e-12),
    ("gismo/planar/hexagon_5p.xml", 5, 3, 2.598_076_211_353_316, 1e-12),
    ("gismo/planar/lshape2d_3patches_tens.xml", 3, 2, 3.0, 1e-12),
    ("gismo/planar/lshape_p2.xml", 1, 0, 2.0, 1e-12),
    ("gismo/planar/square_with_disk.xml", 5, 8, 16.0, 1e-12),
    ("gismo/planar/two_squares.xml", 2, 1, 2.0, 1e-12),
    ("gismo/planar/unitdisk.xml", 1, 0, PI, 1e-12),
    // circumference and height are the ends of the knots
    ("gismo/surfaces/cylinder.xml", 1, 0, 46.439_992_636_888_14 * 23.745_573_181_684_91, 1e-12),
    ("gismo/surfaces/simple.xml", 1, 0, 1.0520214674761839, 1e-12),
    ("gismo/volumes/cube.xml", 7, 0, 27.0, 1e-12),
    // radii 0.5 and 1, height 4; weights of twelve digits
    ("gismo/volumes/cylinder.xml", 1, 0, 3.0 * PI, 1e-11),
    ("gismo/volumes/fichera.xml", 7, 9, 7.0, 1e-12),
    ("splinepy/gismo_additional_blocks.xml", 4, 4, 4.0, 1e-12),
    ("splinepy/gismo_indent_labels_ascii_2d.xml", 4, 4, 4.0, 1e-12),
    ("splinepy/gismo_indent_nolabels_ascii_2d.xml", 4, 4, 4.0, 1e-12),
    ("splinepy/gismo_indent_nolabels_ascii_3d.xml", 4, 4, 4.0, 1e-12),
    ("splinepy/gismo_noindent_labels_ascii_2d.xml", 4, 4, 4.0, 1e-12),
    ("splinepy/gismo_noindent_nolabels_ascii_2d.xml", 4, 4, 4.0, 1e-12),
    ("splinepy/gismo_noindent_nolabels_ascii_3d.xml", 4, 4, 4.0, 1e-12),
    ("splinepy/mfem_cartesian_2d.mesh", 4, 4, 4.0, 1e-12),
    ("splinepy/mfem_cartesian_3d.mesh", 4, 4, 4.0, 1e-12),
    ("mfem/data/beam-hex-nurbs.mesh", 2, 1, 8.0, 1e-12),
    ("mfem/data/beam-quad-nurbs.mesh", 2, 1, 8.0, 1e-12),
    ("mfem/data/beam-quad-nurbs-sf.mesh", 2, 1, 8.0, 1e-12),
    ("mfem/data/cube-nurbs.mesh", 1, 0, 1.0, 1e-12),
    // an exact disc of radius 2 sqrt(2)
    ("mfem/data/disc-nurbs.mesh", 5, 8, 8.0 * PI, 1e-12),
    // nine digits: the unit square less a disc of radius 0.2
    ("mfem/data/square-disc-nurbs.mesh", 4, 4, 1.0 - 0.04 * PI, 1e-9),
    ("mfem/data/segment-nurbs.mesh", 1, 0, 1.0, 1e-12),
    ("mfem/data/square-nurbs.mesh", 1, 0, 1.0, 1e-12),
    ("mfem/data/square-nurbs-pw.mesh", 1, 0, 1.0, 1e-12),
    ("mfem/miniapps-nurbs/3patch-nurbs.mesh", 3, 3, 3.5, 1e-12),
    ("mfem/miniapps-nurbs/3patch-nurbs-flipedge.mesh", 3, 3, 3.5, 1e-12),
    ("mfem/miniapps-nurbs/cube-nurbs.mesh", 1, 0, 1.0, 1e-12),
    ("mfem/miniapps-nurbs/ijk-hex-nurbs.mesh", 8, 12, 8.0, 1e-12),
    ("mfem/miniapps-nurbs/plus-nurbs.mesh", 5, 4, 5.0, 1e-12),
    ("mfem/miniapps-nurbs/plus-nurbs-permuted.mesh", 5, 4, 5.0, 1e-12),
    ("mfem/miniapps-nurbs/square-nurbs.mesh", 1, 0, 1.0, 1e-12),
    ("mfem/miniapps-nurbs/two-cubes-nurbs.mesh", 2, 1, 2.0, 1e-12),
    ("mfem/miniapps-nurbs/two-cubes-nurbs-autoedge.mesh", 2, 1, 2.0, 1e-12),
    ("mfem/miniapps-nurbs/two-cubes-nurbs-rot.mesh", 2, 1, 2.0, 1e-12),
    ("mfem/miniapps-nurbs/two-squares-nurbs.mesh", 2, 1, 2.0, 1e-12),
    ("mfem/miniapps-nurbs/two-squares-nurbs-autoedge.mesh", 2, 1, 2.0, 1e-12),
    ("mfem/miniapps-nurbs/two-squares-nurbs-rot.mesh", 2, 1, 2.0, 1e-12),
];

#[test]
fn spline_files_have_their_patches_joints_and_measures() {
    let Some(folder) = peer_data() else { return };
    for &(name, count, joints, expected, relative) in SPLINES {
        let file = patches(&folder, name);
        assert_eq!((file.patches.len(), file.joints.len()), (count, joints), "{name}");
        // rational patches of degree 2: fourteen points per span leave nothing
        let measure: f64 = file.patches.iter().map(|p| patch_measure(p, if p.dimension() == 3 { 10 } else { 14 })).sum();
        near(measure, expected, relative, name);
    }
}

/// Points of a side at thirds of its parameters.
fn side_points(patch: &SplinePatch, side: &str) -> Vec<[f64; 3]> {
    let place = ["u0", "u1", "v0", "v1", "w0", "w1"].iter().position(|s| *s == side).unwrap();
    let d = patch.dimension();
    let grid = if d == 3 { 16 } else { 4 };
    let point = |k: usize| {
        let mut rest = k;
        let t: Vec<f64> = (0..d)
            .map(|a| {
                let (first, last) = (patch.knots[a][0], *patch.knots[a].last().unwrap());
                let x = if a == place / 2 {
                    (place % 2) as f64
                } else {
                    let i = rest % 4;
                    rest /= 4;
                    i as f64 / 3.0
                };
                first + (last - first) * x
            })
            .collect();
        at(patch, &t).0
    };
    (0..grid).map(point).collect()
}

/// Its interfaces join sides that do not touch.
const WRONG: &str = "gismo/planar/hexagon_5p.xml";

#[test]
fn sides_that_a_file_joins_lie_on_each_other() {
    let Some(folder) = peer_data() else { return };
    let mut seen = 0;
    for (name, ..) in SPLINES.iter().filter(|s| s.0 != WRONG) {
        let file = patches(&folder, name);
        for [one, other] in &file.joints {
            let a = side_points(&file.patches[one.patch], &one.side);
            let b = side_points(&file.patches[other.patch], &other.side);
            for x in a {
                let apart = b.iter().map(|y| (0..3).map(|k| (x[k] - y[k]).powi(2)).sum::<f64>().sqrt()).fold(f64::MAX, f64::min);
                // the digits of G+Smo's yeti footprint
                assert!(apart < 1e-5, "{name}: {one:?} {other:?} are {apart} apart at {x:?}");
                seen += 1;
            }
        }
    }
    assert!(seen > 300, "{seen} points");
}

#[test]
fn files_without_a_simple_measure_have_their_points_in_place() {
    let Some(folder) = peer_data() else { return };
    // A quarter sphere of radius 10 with weights of five digits and a small hole at the poles.
    let sphere = patches(&folder, "gismo/surfaces/quarter_sphere.xml");
    for t in [[0.2, 0.3], [0.7, 0.5], [0.5, 0.8]] {
        let x = at(&sphere.patches[0], &t).0;
        near(x.iter().map(|x| x * x).sum::<f64>().sqrt(), 10.0, 1e-3, "radius");
    }
    // The boundary of the deformed square in the order of its four edges; the patch does not fold.
    let deformed = patches(&folder, "mfem/miniapps-nurbs/square-nurbs-deformed.mesh");
    let patch = &deformed.patches[0];
    let area = patch_measure(patch, 6);
    let mut round = 0.0;
    for (side, sign) in [([None, Some(0.0)], 1.0), ([Some(1.0), None], 1.0), ([None, Some(1.0)], -1.0), ([Some(0.0), None], -1.0)] {
        for span in 0..4 {
            for (x, w) in measure::gauss(6) {
                let t = (f64::from(span) + x) / 4.0;
                let (p, tangents) = at(patch, &[side[0].unwrap_or(t), side[1].unwrap_or(t)]);
                let along = tangents[usize::from(side[0].is_some())];
                round += sign * w / 4.0 * 0.5 * (p[0] * along[1] - p[1] * along[0]);
            }
        }
    }
    near(area, round.abs(), 1e-12, "area by Green's formula");
    // The deformed cube: weights are one, so volume by the divergence theorem would need faces; it does not fold and its corners are these.
    let cube = patches(&folder, "mfem/miniapps-nurbs/cube-nurbs-deformed.mesh");
    assert!(patch_measure(&cube.patches[0], 4) > 0.1);
    assert_eq!(cube.patches[0].points.len(), 216);
    // Curves, control points multiplied by their weights in one file and not in the other.
    for (name, ends) in [
        ("mfem/data/nurbs-segments2d.mesh", &[[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [2.0, 1.0], [2.0, 0.0], [3.0, 1.0]][..]),
        ("mfem/data/nurbs-segments2d-patches.mesh", &[[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [2.0, 1.0], [2.0, 0.0], [3.0, 1.0]]),
        (
            "mfem/data/nurbs-segments2d-patches-multispan.mesh",
            &[[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [2.0, 1.0], [2.0, 0.0], [3.0, 1.0], [3.0, 0.0], [4.0, 0.0]],
        ),
    ] {
        let file = patches(&folder, name);
        let found: Vec<[f64; 2]> =
            file.patches.iter().flat_map(|p| [p.points[0], *p.points.last().unwrap()]).map(|p| [p[0], p[1]]).collect();
        assert_eq!(found, ends, "{name}");
    }
    let product = patches(&folder, "mfem/data/nurbs-segments2d-patches.mesh");
    assert_eq!(product.patches[1].points[1], [1.02 / 1.2, 1.02 / 1.2, 0.0]);
    let plain = patches(&folder, "mfem/data/nurbs-segments2d.mesh");
    assert_eq!(plain.patches[1].points[1], [1.02, 1.02, 0.0]);
}

fn labels(file: &SplineFile) -> Vec<(String, usize)> {
    file.labels.iter().map(|l| (l.name.clone(), l.sides.len())).collect()
}

#[test]
fn boundaries_are_labels() {
    let Some(folder) = peer_data() else { return };
    let file = patches(&folder, "splinepy/gismo_indent_labels_ascii_2d.xml");
    let bids = [("BID1", 4), ("BID2", 2), ("BID3", 2)].map(|(n, k)| (n.to_string(), k));
    assert_eq!(labels(&file), bids);
    assert_eq!((file.labels[0].sides[2].patch, file.labels[0].sides[2].side.as_str()), (2, "v1"));
    assert_eq!(file.patches[1].id, Some(101));
    let file = patches(&folder, "splinepy/gismo_additional_blocks.xml");
    assert_eq!(
        file.notes,
        ["2 blocks <Function> are not read", "1 block <OptionList> is not read", "1 block <boundaryConditions> is not read"]
    );
    let file = patches(&folder, "mfem/miniapps-nurbs/cube-nurbs.mesh");
    let sides: Vec<(&str, &str)> = file.labels.iter().map(|l| (l.name.as_str(), l.sides[0].side.as_str())).collect();
    assert_eq!(sides, [("1", "w0"), ("2", "w1"), ("3", "v0"), ("4", "u1"), ("5", "v1"), ("6", "u0")]);
    let file = patches(&folder, "mfem/data/beam-quad-nurbs-sf.mesh");
    assert_eq!(labels(&file), [("1", 1), ("2", 1), ("3", 4)].map(|(n, k)| (n.to_string(), k)));
    assert_eq!(file.notes, ["3 spacing formulas are not read; the elements are those of the knots"]);
    assert_eq!(file.patches.iter().map(|p| p.attribute).collect::<Vec<_>>(), [Some(1), Some(2)]);
}

#[test]
fn files_that_are_not_read_say_why() {
    let Some(folder) = peer_data() else { return };
    let all = [
        ("gismo/domain2d/squareTHB.xml", "a THB-spline (THBSpline2) is not supported (line 3)"),
        ("gismo/planar/lshape2d_3patches_thb.xml", "a THB-spline (THBSpline2) is not supported (line 3)"),
        ("gismo/thbbasis/simple.xml", "a THB-spline basis (THBSplineBasis2) is not supported (line 3)"),
        ("gismo/thbbasis/thbs_basis_02.xml", "a THB-spline basis (THBSplineBasis2) is not supported (line 3)"),
        (
            "mfem/data/nc3-nurbs.mesh",
            "a MFEM NURBS NC-patch mesh (patches that meet along a part of a side, a hierarchy of refined sides) is not supported (line 1)",
        ),
    ];
    for (name, reason) in all {
        let error = faying_files::read(&folder.join(name), &Limits::default()).unwrap_err();
        assert_eq!((crate::kind(&error), error.to_string().as_str()), ("content", reason), "{name}");
    }
}

/// Every `.xml` and `.mesh` of the folder is in one of the tables above or among the meshes.
#[test]
fn no_file_is_forgotten() {
    let Some(folder) = peer_data() else { return };
    let mut open = vec![folder.clone()];
    let mut count = 0;
    while let Some(at) = open.pop() {
        for entry in std::fs::read_dir(at).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                open.push(path);
            } else if path.extension().is_some_and(|e| e == "xml" || e == "mesh") {
                count += 1;
            }
        }
    }
    // five are refused, six have other facts
    assert_eq!(count, SPLINES.len() + MESHES.len() + 5 + 6);
}

/// File, points, elements, measure and how well the file's digits give it, measure of the boundary elements.
const MESHES: &[(&str, usize, usize, f64, f64, f64)] = &[
    ("mfem/data/beam-hex.mesh", 36, 8, 8.0, 1e-12, 34.0),
    ("mfem/data/beam-quad.mesh", 18, 8, 8.0, 1e-12, 18.0),
    ("mfem/data/beam-tet.mesh", 36, 48, 8.0, 1e-12, 34.0),
    ("mfem/data/beam-tri.mesh", 18, 16, 8.0, 1e-12, 18.0),
    ("mfem/data/fichera.mesh", 26, 7, 7.0, 1e-12, 24.0),
    ("mfem/data/l-shape.mesh", 8, 3, 0.75, 1e-12, 4.0),
    // six digits: the unit square less a polygon of 24 corners on the circle of radius 0.2, whose sides are 0.4 sin(7.5 degrees)
    ("mfem/data/square-disc.mesh", 101, 154, 0.875_766_858_350_79, 1e-5, 5.253_051_445_312_5),
    // orders 2 and 3 with the nodes on the straight sides
    ("mfem/data/square-disc-p2.mesh", 356, 154, 0.875_766_858_350_79, 1e-5, 5.253_051_445_312_5),
    ("mfem/data/square-disc-p3.mesh", 765, 154, 0.875_766_858_350_79, 1e-5, 5.253_051_445_312_5),
    ("mfem/data/square-mixed.mesh", 25, 20, 1.0, 1e-12, 4.0),
    // five rhombi of side 1 and angle 72 degrees in six digits: 5 sin(72 degrees), ten sides
    ("mfem/data/star.mesh", 31, 20, 4.755_282_581_475_767, 1e-5, 10.0),
    ("mfem/data/star-mixed.mesh", 31, 30, 4.755_282_581_475_767, 1e-5, 10.0),
    ("mfem/miniapps-tribol/two-hex.mesh", 16, 2, 2.0, 1e-12, 12.0),
    ("tribol/two_hex.mesh", 16, 2, 2.0, 1e-12, 12.0),
    ("tribol/two_hex_apart.mesh", 16, 2, 2.0, 1e-12, 12.0),
    ("tribol/two_hex_overlap.mesh", 16, 2, 2.0, 1e-12, 12.0),
    // no simple shapes: cells that do not fold, between the star and a circle around it, about the Fichera corner
    ("mfem/data/star-q2.mesh", 101, 20, 4.755, 0.2, 10.0),
    ("mfem/data/star-q3.mesh", 211, 20, 4.755, 0.2, 10.0),
    ("mfem/data/fichera-q2.mesh", 117, 7, 7.0, 0.2, 24.0),
];

#[test]
fn mfem_meshes_have_their_points_elements_and_measures() {
    let Some(folder) = peer_data() else { return };
    for &(name, points, elements, measure, relative, boundary) in MESHES {
        let file = mesh(&folder, name);
        let d = file.dimension();
        let count: usize = file.blocks.iter().filter(|b| b.shape.dimension() == d).map(|b| b.ids.len()).sum();
        assert_eq!((file.points.len(), count), (points, elements), "{name}");
        near(mesh_measure(&file, 0), measure, relative, name);
        near(mesh_measure(&file, 1), boundary, relative.max(1e-12), name);
        let attributes: Vec<String> = file.groups.iter().map(|g| g.label()).collect();
        assert!(!attributes.is_empty() && file.blocks.iter().all(|b| b.groups.len() == 1), "{name}: {attributes:?}");
    }
    let beam = mesh(&folder, "mfem/data/beam-quad.mesh");
    let groups: Vec<(usize, i64)> = beam.groups.iter().map(|g| (g.dimension, g.number)).collect();
    assert_eq!(groups, [(2, 1), (2, 2), (1, 1), (1, 2), (1, 3)]);
    // nodes of a square stand with the first axis fastest: 0 1 10 9 in the file
    assert_eq!(beam.blocks[0].nodes[..4], [0, 1, 9, 10]);
}

#[test]
fn gauss_lobatto_nodes_become_equispaced() {
    let map = |x: f64, y: f64| [x + 0.1 * x * x * y, y - 0.2 * y * y * y + 0.1 * x * x];
    let a = 0.5 - 0.5 * 0.2f64.sqrt();
    let (b, t) = (1.0 - a, 1.0 / 3.0);
    // vertices, edges from the lower vertex to the higher one, inside
    let square =
        [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [a, 0.0], [b, 0.0], [1.0, a], [1.0, b], [b, 1.0], [a, 1.0], [0.0, a], [0.0, b]];
    let inner = [[a, a], [b, a], [a, b], [b, b]];
    let triangle = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [a, 0.0], [b, 0.0], [b, a], [a, b], [0.0, a], [0.0, b], [t, t]];
    let shapes = [("3 0 1 2 3", 4, [&square[..], &inner].concat()), ("2 0 1 2", 3, triangle.to_vec())];
    for (element, vertices, nodes) in shapes {
        let mut file = format!("MFEM mesh v1.0\ndimension 2\nelements 1\n1 {element}\nboundary 1\n1 1 0 1\nvertices {vertices}\nnodes\n");
        file += "FiniteElementSpace\nFiniteElementCollection: H1_2D_P3\nVDim: 2\nOrdering: 1\n";
        for [x, y] in nodes {
            let p = map(x, y);
            file += &format!("{:?} {:?}\n", p[0], p[1]);
        }
        let Ok(Contents::Mesh(file)) = text(file) else { panic!("{element} is not read") };
        let simplex = file.blocks[0].shape == CellShape::Triangle;
        let mut k = 0;
        for j in 0..=3 {
            for i in 0..=if simplex { 3 - j } else { 3 } {
                let x = map(f64::from(i) / 3.0, f64::from(j) / 3.0);
                let p = file.points[file.blocks[0].nodes[k] as usize];
                assert!((0..2).all(|d| (p[d] - x[d]).abs() < 1e-14), "{element}: node {i} {j} is {p:?}, expected {x:?}");
                k += 1;
            }
        }
        // the boundary element has the nodes of the first edge
        assert_eq!(file.blocks[1].nodes, [0, vertices, vertices + 1, 1]);
    }
}

/// The control points of all patches in a fixed order.
fn cloud(file: &SplineFile) -> Vec<[f64; 3]> {
    let mut all: Vec<[f64; 3]> = file.patches.iter().flat_map(|p| p.points.iter().copied()).collect();
    // Variants round differently: nine decimals tell the points apart.
    all.sort_by_key(|p| p.map(|x| (x * 1e9).round() as i64));
    all
}

#[test]
fn refinement_lists_go_to_every_patch_of_a_knot_vector_in_its_direction() {
    let Some(folder) = peer_data() else { return };
    let list = |name: &str| mfem::refinement_list(&std::fs::read(folder.join("mfem/miniapps-nurbs").join(name)).unwrap()).unwrap();
    let cube = patches(&folder, "mfem/miniapps-nurbs/cube-nurbs.mesh").refined(&list("cube.ref")).unwrap();
    assert_eq!(cube.patches[0].knots, [vec![0.0, 0.0, 0.2, 0.5, 1.0, 1.0], vec![0.0, 0.0, 0.5, 1.0, 1.0], vec![0.0, 0.0, 0.5, 1.0, 1.0]]);
    assert_eq!(cube.patches[0].points.len(), 36);
    for (name, variants, knots) in [("two-squares", ["", "-autoedge", "-rot"], 18), ("two-cubes", ["", "-autoedge", "-rot"], 54)] {
        let all: Vec<SplineFile> = variants
            .iter()
            .map(|v| patches(&folder, &format!("mfem/miniapps-nurbs/{name}-nurbs{v}.mesh")).refined(&list(&format!("{name}.ref"))).unwrap())
            .collect();
        for file in &all {
            let (expected, found) = (cloud(&all[0]), cloud(file));
            assert_eq!(found.len(), knots);
            for (a, b) in expected.iter().zip(&found) {
                assert!((0..3).all(|k| (a[k] - b[k]).abs() < 1e-15), "{name}: {a:?} and {b:?}");
            }
        }
        // the second patch of the rotated variant runs against its first knot vector
        assert!(all[2].patches[1].uses[0].reversed && !all[0].patches[1].uses[0].reversed);
        assert_eq!(all[2].patches[1].knots[0], [0.0, 0.0, 0.8, 1.0, 1.0]);
    }
    let wrong = cube.refined(&list("two-cubes.ref")).unwrap_err();
    assert_eq!(wrong.to_string(), "the list of knots is for 4 knot vectors, the mesh has 3");
    let outside = cube.refined(&[vec![2.0], vec![], vec![]]).unwrap_err().to_string();
    assert!(outside.starts_with("knots for the knot vector 0: "), "{outside}");
    let unnumbered = patches(&folder, "gismo/planar/lshape_p2.xml").refined(&[]).unwrap_err().to_string();
    assert_eq!(unnumbered, "a list of knots needs a file that numbers its knot vectors: MFEM meshes do");
    assert_eq!(mfem::refinement_list(b"1\n2 0.5").unwrap_err().to_string(), "the text ends where a knot is expected (line 2)");
}

/// Patches without what only one of the formats has.
fn bare(file: &SplineFile) -> Vec<SplinePatch> {
    let strip = |p: &SplinePatch| SplinePatch {
        id: None,
        name: None,
        attribute: None,
        uses: Vec::new(),
        weights: p.weights.clone().filter(|w| w.iter().any(|x| *x != 1.0)),
        ..p.clone()
    };
    file.patches.iter().map(strip).collect()
}

#[test]
fn written_splines_read_back_to_the_same_bits() {
    let Some(folder) = peer_data() else { return };
    let others = ["gismo/surfaces/quarter_sphere.xml", "mfem/miniapps-nurbs/cube-nurbs-deformed.mesh", "mfem/data/nurbs-segments2d.mesh"];
    for name in SPLINES.iter().map(|s| s.0).chain(others) {
        let file = patches(&folder, name);
        let written = gismo::write(&file);
        let again = gismo::parse(written.text.as_bytes(), &Limits::default()).unwrap_or_else(|e| panic!("{name}: {e}"));
        assert_eq!(bare(&again), bare(&file), "{name}");
        assert_eq!((&again.joints, &again.labels), (&file.joints, &file.labels), "{name}");
        let lost = name.ends_with(".mesh").then_some("which patches share a knot vector");
        assert_eq!(written.lost.last().map(String::as_str), lost, "{name}: {:?}", written.lost);
        let written = mfem::write(&file).unwrap();
        let Ok(Contents::Patches(again)) = text(&written.text) else { panic!("{name}: {:?}", text(&written.text)) };
        assert_eq!(bare(&again), bare(&file), "{name}");
        let key = |f: &SplineFile| {
            let mut all: Vec<_> = f.joints.iter().map(|j| j.clone().map(|s| (s.patch, s.side))).collect();
            all.iter_mut().for_each(|j| j.sort());
            all.sort();
            all
        };
        // patches of one shape and different knots may not share a side in MFEM
        if !written.lost.iter().any(|l| l.starts_with("that patches")) {
            assert_eq!(key(&again), key(&file), "{name}");
        }
        let sizes = |f: &SplineFile| f.labels.iter().map(|l| l.sides.len()).collect::<Vec<_>>();
        assert_eq!(sizes(&again), sizes(&file), "{name}");
        if name.ends_with(".mesh") {
            let uses = |f: &SplineFile| f.patches.iter().map(|p| (p.attribute, p.uses.clone())).collect::<Vec<_>>();
            assert_eq!(uses(&again), uses(&file), "{name}");
        }
    }
}

#[test]
fn interfaces_are_written_with_their_directions() {
    let Some(folder) = peer_data() else { return };
    // the same tokens as in the files of G+Smo and splinepy themselves
    for name in
        ["gismo/planar/hexagon_3p.xml", "gismo/planar/square_with_disk.xml", "gismo/domain2d/yeti_mp2.xml", "gismo/volumes/fichera.xml"]
    {
        let interfaces = |text: &str| -> Vec<String> {
            let from = text.find("<interfaces>").unwrap() + 12;
            let to = text.find("</interfaces>").unwrap();
            text[from..to].split_whitespace().map(str::to_string).collect()
        };
        let theirs = std::fs::read_to_string(folder.join(name)).unwrap();
        assert_eq!(interfaces(&gismo::write(&patches(&folder, name)).text), interfaces(&theirs), "{name}");
    }
}

#[test]
fn written_meshes_read_back_to_the_same_bits() {
    let Some(folder) = peer_data() else { return };
    for (name, ..) in MESHES {
        let file = mesh(&folder, name);
        let written = mfem::write_mesh(&file).unwrap();
        assert!(written.lost.is_empty(), "{name}: {:?}", written.lost);
        let Ok(Contents::Mesh(again)) = text(&written.text) else { panic!("{name}: {:?}", text(&written.text)) };
        let cells = |f: &MeshFile| f.blocks.iter().map(|b| (b.shape, b.order, b.nodes.clone(), b.groups.clone())).collect::<Vec<_>>();
        assert_eq!((&again.points, cells(&again), &again.groups), (&file.points, cells(&file), &file.groups), "{name}");
    }
}

#[test]
fn what_is_no_geometry_is_refused_with_its_line() {
    let xml = |inner: &str| format!("<xml>\n{inner}\n</xml>");
    let curve = |knots: &str, coefficients: &str| {
        let basis = format!("<Basis type=\"BSplineBasis\"><KnotVector degree=\"1\">{knots}</KnotVector></Basis>");
        xml(&format!("<Geometry type=\"BSpline\" id=\"3\">{basis}\n<coefs geoDim=\"2\">{coefficients}</coefs></Geometry>"))
    };
    let whole = curve("0 0 1 1", "0 0 1 0");
    assert!(text(&whole).is_ok());
    let head = "MFEM NURBS mesh v1.0\ndimension 1\nelements 1\n1 1 0 1\nboundary 0\nedges 1\n0 0 1\nvertices 2\n";
    let cases: Vec<(String, &str)> = vec![
        (String::new(), "test is empty; G+Smo XML, MFEM meshes, Gmsh MSH files, VTU grids and Abaqus input files are read (line 1)"),
        (
            "\0".repeat(10_000),
            "test looks like binary data of another format; G+Smo XML, MFEM meshes, Gmsh MSH files, VTU grids and Abaqus input files are read (line 1)",
        ),
        (
            "solid cube".into(),
            "test looks like an STL file; G+Smo XML, MFEM meshes, Gmsh MSH files, VTU grids and Abaqus input files are read (line 1)",
        ),
        (
            "hello\nworld".into(),
            "test begins with \"hello\"; G+Smo XML, MFEM meshes, Gmsh MSH files, VTU grids and Abaqus input files are read (line 1)",
        ),
        ("<VTKFile type=\"UnstructuredGrid\"/>".into(), "the VTKFile element is empty (byte 0)"),
        ("<!DOCTYPE a [<!ENTITY b \"c\">]><xml/>".into(), "a document type (DTD) in XML is not supported (line 1)"),
        ("<a>".repeat(100_000), "XML of more than 32 levels is not supported (line 1)"),
        ("<xml/>".into(), "the file holds no geometry (line 1)"),
        ("<xml>\n<Geometry>".into(), "<Geometry> is not closed (line 2)"),
        (curve("0 0 1 2 2", "0 0 1 0"), "6 coordinates of 3 control points do not fit in the 7 bytes that follow (line 3)"),
        (curve("0 0 1 2", "0 0 1 0"), "the knot vector"),
        (curve("0 1 0 1", "0 0 1 0"), "the knot vector"),
        (curve("0 0 &amp; 1", "0 0 1 0"), "<KnotVector> holds an entity where numbers are expected (line 2)"),
        (curve("0 0 1 1", "0 0 1"), "4 coordinates of 2 control points do not fit in the 5 bytes that follow (line 3)"),
        (curve("0 0 1 1", "0 0 1 0 7"), "more than 4 numbers as coordinates of 2 control points (line 3)"),
        (curve("0 0 1 1", "0 0 1 nan"), "coordinates of 2 control points must be finite, found NaN (line 3)"),
        (curve("0 0 1 1", "0 0 1 x1"), "coordinates of 2 control points must be a number, found \"x1\" (line 3)"),
        (
            whole.replace("</xml>", "<MultiPatch parDim=\"1\" id=\"5\"><patches type=\"id_range\">5 5</patches></MultiPatch></xml>"),
            "the MultiPatch names geometry 5, which is not in the file (line 4)",
        ),
        (
            whole.replace("</xml>", "<MultiPatch><patches type=\"id_range\">3 1152921504606846976</patches></MultiPatch></xml>"),
            "the MultiPatch names geometry 4, which is not in the file (line 4)",
        ),
        (
            whole.replace("</xml>", "<MultiPatch><patches type=\"id_index\">3 3</patches></MultiPatch></xml>"),
            "the MultiPatch names geometry 3 twice (line 4)",
        ),
        (
            "MFEM mesh v1.0\ndimension 2\nelements 1152921504606846976\n".into(),
            "1152921504606846976 elements do not fit in the 1 bytes that follow (line 3)",
        ),
        ("MFEM NC mesh v1.0\n".into(), "a MFEM NC mesh (a hierarchy of refined elements with hanging nodes) is not supported (line 1)"),
        ("MFEM mesh v9.0\n".into(), "\"MFEM mesh v9.0\" is not supported (line 1)"),
        (head.replace("vertices 2", "vertices 1152921504606846976"), "1152921504606846976 vertices are more than 1 patches have (line 8)"),
        (head.replace("0 0 1\n", "0 1 1\n"), "an edge from the vertex 1 to itself (line 7)"),
        (head.replace("1 1 0 1", "1 1 0 0"), "an element has the vertex 0 twice (line 4)"),
        (
            format!("{head}knotvectors 1\n9223372036854775807 1152921504606846976 0\n"),
            "1152921504606846976 functions of degree 9223372036854775807",
        ),
        (
            format!("{head}knotvectors 1\n1 1152921504606846976 0\n"),
            "1152921504606846978 knots do not fit in the 3 bytes that follow (line 10)",
        ),
        (format!("{head}knotvectors 1\n1 2 0 0 1 1\nperiodic 1 1\n"), "a periodic MFEM NURBS mesh is not supported (line 11)"),
        (
            format!("{head}patches\nknotvectors 1\n1 2 0 0 1 1\ndimension 2\ncontrolpoints\n0 0 1\n1 0 -1\n"),
            "weight 1 is -1, weights are positive (line 14)",
        ),
    ];
    let mut wrong = Vec::new();
    for (bytes, reason) in cases {
        let found = refusal(&bytes);
        if !found.contains(reason) {
            wrong.push(format!("found \"{found}\", expected \"{reason}\""));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn endless_files_folders_and_long_lines_end() {
    let limits = Limits { memory: Some(1 << 20) };
    let error = faying_files::read(Path::new("/"), &limits).unwrap_err();
    assert_eq!((crate::kind(&error), error.to_string().as_str()), ("system", "it is a folder"));
    assert_eq!(crate::kind(&faying_files::read(Path::new("/nowhere/at/all"), &limits).unwrap_err()), "absent");
    if Path::new("/dev/zero").exists() {
        let error = faying_files::read(Path::new("/dev/zero"), &limits).unwrap_err();
        assert_eq!((crate::kind(&error), error.to_string().as_str()), ("system", "it is a device"));
    }
    for head in ["MFEM mesh v1.0\ndimension 2\nelements ", "<xml>"] {
        let mut line = head.as_bytes().to_vec();
        line.resize(200 << 20, b'1');
        let info = allocation_counter::measure(|| {
            assert!(refusal(&line).len() < 200);
        });
        assert!(info.bytes_max < 1 << 16, "{} bytes for a line of 200 MB", info.bytes_max);
    }
}

/// A generator of numbers by the rule x' = 6364136223846793005 x + 1442695040888963407 mod 2^64.
struct Numbers(u64);

impl Numbers {
    fn below(&mut self, n: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 33) as usize) % n.max(1)
    }
}

#[test]
fn mutated_files_neither_panic_nor_take_more_memory_than_allowed() {
    let Some(folder) = peer_data() else { return };
    let seeds = [
        "gismo/planar/hexagon_3p.xml",
        "gismo/planar/unitdisk.xml",
        "splinepy/gismo_additional_blocks.xml",
        "mfem/data/square-disc-nurbs.mesh",
        "mfem/data/beam-hex-nurbs.mesh",
        "mfem/data/beam-quad-nurbs-sf.mesh",
        "mfem/miniapps-nurbs/two-cubes-nurbs-rot.mesh",
        "mfem/miniapps-nurbs/3patch-nurbs.mesh",
        "mfem/data/star-q3.mesh",
        "mfem/data/fichera-q2.mesh",
        "mfem/data/star-mixed.mesh",
    ];
    let words = ["1152921504606846976", "-1", "18446744073709551615", "0", "nan", "1e400", "4294967295", "", "<xml>", "7", "&x;", "1e308"];
    const ALLOWED: u64 = 1 << 18;
    // Messages, names and maps of a few entries.
    const SLACK: u64 = 1 << 14;
    let mut numbers = Numbers(7);
    let (mut read, mut refused) = (0, 0);
    for name in seeds {
        let seed = std::fs::read(folder.join(name)).unwrap();
        for _ in 0..600 {
            let mut bytes = seed.clone();
            for _ in 0..=numbers.below(3) {
                let at = numbers.below(bytes.len());
                match numbers.below(5) {
                    0 => bytes[at] = numbers.below(256) as u8,
                    1 => bytes.truncate(at),
                    2 => {
                        // a word becomes another
                        let end = at + bytes[at..].iter().position(u8::is_ascii_whitespace).unwrap_or(0);
                        bytes.splice(at..end, words[numbers.below(words.len())].bytes());
                    }
                    3 => {
                        // a line is doubled
                        let end = at + bytes[at..].iter().position(|b| *b == b'\n').unwrap_or(0);
                        let line = bytes[at..end].to_vec();
                        bytes.splice(at..at, line);
                    }
                    _ => {
                        let end = (at + 1 + numbers.below(40)).min(bytes.len());
                        bytes.drain(at..end);
                    }
                }
                if bytes.is_empty() {
                    break;
                }
            }
            let mut outcome = None;
            let limits = Limits { memory: Some(ALLOWED + bytes.len() as u64) };
            let info = allocation_counter::measure(|| outcome = Some(faying_files::parse(name, &bytes, &limits)));
            assert!(info.bytes_max <= ALLOWED + SLACK, "{name}: {} bytes", info.bytes_max);
            match outcome.unwrap() {
                Ok(_) => read += 1,
                Err(FileError::Memory { .. }) => {}
                Err(error) => {
                    assert_eq!(crate::kind(&error), "content");
                    refused += 1;
                }
            }
        }
    }
    println!("{read} mutants are read, {refused} refused");
    assert!(read > 100 && refused > 3000, "{read} read, {refused} refused");
}
