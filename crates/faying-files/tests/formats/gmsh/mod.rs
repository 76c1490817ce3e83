//! Gmsh files: facts of meshes of other projects, node orders, round trips, broken files.

use crate::common::peer;
mod broken;
mod measure;
mod peers;
mod vtu;

pub use broken::{Random, mutate};
use faying_files::gmsh::{parse, write};
use faying_files::{CellShape, FileError, Limits, MeshFile};
use measure::{cells, lattice};
pub use measure::{least, measure};
use std::f64::consts::PI;
use std::path::Path;

fn read(path: &Path) -> Result<MeshFile, FileError> {
    parse(&std::fs::read(path).unwrap(), &Limits::default())
}

fn bytes(name: &str) -> Vec<u8> {
    std::fs::read(Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")).join("tests/data/gmsh").join(name)).unwrap()
}

fn data(name: &str) -> MeshFile {
    parse(&bytes(name), &Limits::default()).unwrap_or_else(|e| panic!("{name}: {e}"))
}

/// Coordinates of the nodes of all cells: equal for meshes that number and sort their points in another way.
fn corners(mesh: &MeshFile) -> Vec<(CellShape, usize, Vec<String>, Vec<[f64; 3]>)> {
    let labels = |groups: &[usize]| groups.iter().map(|g| mesh.groups[*g].label()).collect();
    let place = |n: &u32| mesh.points[*n as usize];
    mesh.blocks.iter().map(|b| (b.shape, b.order, labels(&b.groups), b.nodes.iter().map(place).collect())).collect()
}

#[test]
fn nodes_stand_where_the_reference_element_of_gmsh_says() {
    let reference: serde_json::Value = serde_json::from_slice(&bytes("reference_nodes.json")).unwrap();
    for (name, entry) in reference.as_object().unwrap() {
        let (number, count, dimension) = (entry[0].as_u64().unwrap(), entry[1].as_u64().unwrap() as usize, entry[3].as_u64().unwrap());
        let order: usize = name[name.len() - 1..].parse().unwrap();
        let list: Vec<f64> = entry[2].as_array().unwrap().iter().map(|v| v.as_f64().unwrap()).collect();
        let stride = list.len() / count;
        let mut text = format!("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n{count}\n");
        for i in 0..count {
            let at = |k: usize| if k < dimension as usize { list[i * stride + k] } else { 0.0 };
            text += &format!("{} {} {} {}\n", i + 1, at(0), at(1), at(2));
        }
        let nodes: Vec<String> = (1..=count).map(|n| n.to_string()).collect();
        text += &format!("$EndNodes\n$Elements\n1\n1 {number} 0 {}\n$EndElements\n", nodes.join(" "));
        let mesh = parse(text.as_bytes(), &Limits::default()).unwrap();
        let block = &mesh.blocks[0];
        assert_eq!((block.order, block.shape.dimension()), (order, dimension as usize), "{name}");
        let simplex = matches!(block.shape, CellShape::Triangle | CellShape::Tetrahedron);
        let lattice = lattice(block.shape, order);
        assert_eq!(lattice.len(), count, "{name}");
        for (a, node) in lattice.iter().zip(&block.nodes) {
            for k in 0..dimension as usize {
                let unit = a[k] as f64 / order as f64;
                let expected = if simplex { unit } else { 2.0 * unit - 1.0 };
                assert!(
                    (mesh.points[*node as usize][k] - expected).abs() < 1e-12,
                    "{name}: node {a:?} at {:?}",
                    mesh.points[*node as usize]
                );
            }
        }
    }
}

#[test]
fn curved_meshes_come_near_the_disc_and_the_ball_with_their_order() {
    // errors allowed per order: a chord, a parabola, ... through points of the circle; a wrong order of nodes folds cells
    let allowed = [0.3, 2e-2, 2e-3, 2e-4];
    for p in 1..=4 {
        for (name, dimension, group, side, exact, skin) in [
            (format!("disc_quad_p{p}_v4_bin.msh"), 2, "disc", "rim", PI, 2.0 * PI),
            (format!("disc_tri_p{p}_v4_bin.msh"), 2, "disc", "rim", PI, 2.0 * PI),
            (format!("octant_tet_p{p}_v2_bin.msh"), 3, "ball", "outer skin", PI / 6.0, PI / 2.0),
        ] {
            let mesh = data(&name);
            assert!(mesh.blocks.iter().filter(|b| b.shape != CellShape::Point).all(|b| b.order == p), "{name}");
            let error = [
                (measure(&mesh, dimension, Some(group)) / exact - 1.0).abs(),
                (measure(&mesh, dimension - 1, Some(side)) / skin - 1.0).abs(),
            ];
            println!("{name}: errors {error:?}, least Jacobian ratio {}", least(&mesh, dimension));
            assert!(error.iter().all(|e| *e < allowed[p - 1]), "{name}: {error:?}");
            assert!(least(&mesh, dimension) > 0.05, "{name}");
        }
    }
}

#[test]
fn text_and_binary_of_both_versions_are_one_mesh() {
    for name in ["box_hex_p3", "octant_tet_p2"] {
        let all = ["v2", "v2_bin", "v4", "v4_bin"].map(|v| data(&format!("{name}_{v}.msh")));
        let first = corners(&all[1]);
        for other in all.iter().map(corners) {
            assert_eq!(other.len(), first.len());
            for (a, b) in other.iter().zip(&first) {
                assert_eq!((a.0, a.1, &a.2, a.3.len()), (b.0, b.1, &b.2, b.3.len()), "{name}");
                // text has 16 digits
                assert!(a.3.iter().flatten().zip(b.3.iter().flatten()).all(|(a, b)| (a - b).abs() < 4e-15), "{name}");
            }
        }
        assert_eq!(all[0].ids, all[1].ids);
        assert_eq!(all[2].ids, all[3].ids);
        assert_eq!(corners(&all[1]), corners(&all[3]), "binary ones to the bit");
    }
}

#[test]
fn elements_of_several_groups_are_one_element() {
    for version in ["v2", "v4"] {
        let mesh = data(&format!("octant_tet_p2_{version}.msh"));
        let labels: Vec<String> = mesh.groups.iter().map(|g| format!("{}:{}", g.dimension, g.label())).collect();
        assert_eq!(labels, ["2:outer skin", "2:4", "2:all", "3:ball"]);
        let body = mesh.cells::<3>(Some("ball")).unwrap();
        let count = |name: &str| body.tags.iter().find(|t| t.name == name).map_or(0, |t| t.corners.len());
        assert_eq!(count("outer skin") + count("4"), count("all"));
        assert!((measure(&mesh, 2, Some("4")) - 0.75 * PI).abs() < 0.02);
        assert!(mesh.notes.is_empty(), "{:?}", mesh.notes);
    }
}

#[test]
fn groups_select_cells_sides_and_points() {
    let mesh = data("box_hex_p3_v4.msh");
    assert_eq!(mesh.point("corner"), mesh.point("9"));
    let corner = mesh.point("corner").unwrap();
    assert!(corner.iter().zip([0.0, 0.0, 1.0]).all(|(x, y)| (x - y).abs() < 1e-12), "{corner:?}");
    assert_eq!(mesh.point("box"), None);
    let body = mesh.cells::<3>(Some("1")).unwrap();
    assert_eq!(body, mesh.cells::<3>(None).unwrap());
    assert_eq!(body.blocks.len(), 1);
    let found: Vec<(&str, Option<usize>, usize)> = body.tags.iter().map(|t| (t.name.as_str(), t.dimension(), t.corners.len())).collect();
    assert_eq!(found[1..], [("corner", Some(0), 1)]);
    assert_eq!(found[0].1, Some(2));
    assert!(body.tags[0].name == "left" && body.tags[0].corners[0].iter().all(|c| body.points[*c][0].abs() < 1e-12));
    let missing = mesh.cells::<3>(Some("steel")).unwrap_err();
    assert_eq!((crate::kind(&missing), missing.to_string().as_str()), ("missing", "there is no group \"steel\"; there are \"box\""));
    assert_eq!(crate::kind(&mesh.cells::<2>(None).unwrap_err()), "dimension");
    assert_eq!(crate::kind(&mesh.cells::<2>(Some("left")).unwrap_err()), "dimension");
}

#[test]
fn what_is_written_reads_back_equal() {
    let mut names: Vec<String> = std::fs::read_dir(Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")).join("tests/data/gmsh"))
        .unwrap()
        .map(|e| e.unwrap().file_name().into_string().unwrap())
        .filter(|n| n.ends_with(".msh"))
        .collect();
    names.sort();
    assert!(names.len() >= 16);
    for name in names {
        let mesh = data(&name);
        for binary in [false, true] {
            let again = parse(&write(&mesh, binary).unwrap(), &Limits::default()).unwrap();
            assert_eq!(again, mesh, "{name}, binary {binary}");
        }
    }
}

#[test]
fn cells_keep_their_orientation_and_left_handed_ones_are_read() {
    let text = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n3\n7 0 0 0\n1000000000000 0 1 0\n9 1 0 0\n$EndNodes\n\
                $Elements\n1\n5 2 2 -4 1 7 1000000000000 9\n$EndElements\n";
    let mesh = parse(text.as_bytes(), &Limits::default()).unwrap();
    assert_eq!(mesh.ids, [7, 1_000_000_000_000, 9]);
    assert_eq!((mesh.blocks[0].nodes.as_slice(), mesh.groups[0].number), (&[0, 1, 2][..], 4));
    assert!(cells(&mesh, &mesh.blocks[0])[0].0 < 0.0);
}
