//! Every MSH file of the peer data reads, with a fact each.

use super::measure::{least, measure};
use super::peer::peer_data;
use super::{corners, read};
use faying_files::{CellShape, MeshFile};

fn files() -> Option<Vec<(String, MeshFile)>> {
    let root = peer_data()?;
    let mut list = Vec::new();
    for folder in ["ndgrid/meshes", "ndgrid/tests", "nutils", "scikit-fem"] {
        for entry in std::fs::read_dir(root.join(folder)).unwrap() {
            let path = entry.unwrap().path();
            if path.extension().is_some_and(|e| e == "msh") {
                let mesh = read(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
                list.push((format!("{folder}/{}", path.file_stem().unwrap().to_string_lossy()), mesh));
            }
        }
    }
    list.sort_by(|a, b| a.0.cmp(&b.0));
    Some(list)
}

/// Cells per shape.
fn count(mesh: &MeshFile, shape: CellShape) -> usize {
    mesh.blocks.iter().filter(|b| b.shape == shape).map(|b| b.ids.len()).sum()
}

#[test]
fn every_peer_mesh_reads_and_has_its_size() {
    let Some(files) = files() else { return };
    use CellShape::{Hexahedron, Quadrilateral, Tetrahedron, Triangle};
    // shape, number, measure with the relative error of its straight or curved cells, where the shape of the domain is known
    let facts: [(&str, CellShape, usize, Option<(f64, f64)>); 21] = [
        ("ndgrid/meshes/cube_quadrilateral", Quadrilateral, 6, Some((6.0, 1e-14))),
        ("ndgrid/meshes/cube_tetrahedron", Tetrahedron, 6, Some((1.0, 1e-13))),
        ("ndgrid/meshes/cube_tetrahedron_bin", Tetrahedron, 6, Some((1.0, 1e-13))),
        ("ndgrid/meshes/mixed", Quadrilateral, 1, Some((1.0, 1e-13))),
        ("ndgrid/meshes/sphere_triangle", Triangle, 128, Some((4.0 * std::f64::consts::PI, 0.06))),
        ("ndgrid/meshes/sphere_triangle_bin", Triangle, 128, Some((4.0 * std::f64::consts::PI, 0.06))),
        ("ndgrid/tests/test_mesh_ascii_v2", Triangle, 40, None),
        ("ndgrid/tests/test_mesh_binary_v4", Triangle, 40, None),
        ("nutils/mesh2d_p1_v2", Triangle, 138, Some((2.0, 1e-13))),
        ("nutils/mesh2d_p4_v4", Triangle, 134, Some((2.0, 1e-13))),
        ("scikit-fem/annulus", Triangle, 98, Some((std::f64::consts::PI * (0.25 - 0.01), 0.05))),
        ("scikit-fem/beams", Tetrahedron, 851, Some((0.12, 1e-13))),
        ("scikit-fem/interface", Triangle, 170, Some((1.0, 1e-13))),
        ("scikit-fem/internal", Triangle, 274, Some((1.0, 1e-13))),
        ("scikit-fem/mixedtriquad", Triangle, 16, None),
        ("scikit-fem/mixedtriquad", Quadrilateral, 36, None),
        ("scikit-fem/oriented_squares", Triangle, 266, Some((1.0, 1e-13))),
        ("scikit-fem/quadratic_tri", Triangle, 119, Some((std::f64::consts::PI * 0.25, 1e-4))),
        ("scikit-fem/quadraticsphere", Tetrahedron, 640, Some((std::f64::consts::PI / 6.0, 1e-3))),
        ("scikit-fem/square", Triangle, 184, Some((1.0, 1e-13))),
        ("scikit-fem/tagged_gmsh4", Triangle, 80, Some((0.55, 1e-13))),
    ];
    for (name, mesh) in &files {
        assert_eq!(count(mesh, Hexahedron), 0);
        println!("{name}: measure {}, least {}", measure(mesh, mesh.dimension(), None), least(mesh, mesh.dimension()));
        assert_eq!(mesh.points.len(), mesh.ids.len(), "{name}");
        for (_, shape, number, size) in facts.iter().filter(|f| f.0 == name) {
            assert_eq!(count(mesh, *shape), *number, "{name}");
            if let Some((exact, error)) = size {
                let own: f64 =
                    mesh.blocks.iter().filter(|b| b.shape == *shape).flat_map(|b| super::cells(mesh, b)).map(|c| c.0.abs()).sum();
                assert!((own / exact - 1.0).abs() < *error, "{name}: {own} against {exact}");
            }
        }
    }
    assert!(facts.iter().all(|f| files.iter().any(|(name, _)| name == f.0)));
}

#[test]
fn the_nutils_domain_has_its_areas_sides_and_point_in_every_order_and_version() {
    let Some(files) = files() else { return };
    let own: Vec<_> = files.iter().filter(|f| f.0.starts_with("nutils/")).collect();
    assert_eq!(own.len(), 8);
    for (name, mesh) in own {
        let order: usize = name[15..16].parse().unwrap();
        assert!(mesh.blocks.iter().all(|b| b.shape == CellShape::Point || b.order == order), "{name}");
        // straight cells with equispaced nodes: constant Jacobians, or the nodes are in a wrong order
        assert!(least(mesh, 2) > 1.0 - 1e-9, "{name}: {}", least(mesh, 2));
        assert!(least(mesh, 1) > 1.0 - 1e-9, "{name}");
        for (label, size) in [("neumann", 2.0), ("dirichlet", 4.0), ("extra", 2.0), ("iface", 1.0)] {
            assert!((measure(mesh, 1, Some(label)) - size).abs() < 1e-12, "{name}: {label}");
        }
        for label in ["left", "right"] {
            assert!((measure(mesh, 2, Some(label)) - 1.0).abs() < 1e-12, "{name}: {label}");
        }
        assert!(mesh.point("midpoint").unwrap().iter().zip([1.0, 0.0, 0.0]).all(|(x, y)| (x - y).abs() < 1e-12), "{name}");
        let whole: Vec<(String, usize)> = mesh.cells::<2>(None).unwrap().tags.into_iter().map(|t| (t.name, t.corners.len())).collect();
        let expected = [("neumann", 10), ("dirichlet", 20), ("extra", 10), ("iface", 5), ("midpoint", 1)].map(|(n, k)| (n.to_owned(), k));
        assert_eq!(whole, expected, "{name}");
        let left: Vec<(String, usize)> =
            mesh.cells::<2>(Some("left")).unwrap().tags.into_iter().map(|t| (t.name, t.corners.len())).collect();
        let expected = [("neumann", 5), ("dirichlet", 10), ("extra", 10), ("iface", 5), ("midpoint", 1)].map(|(n, k)| (n.to_owned(), k));
        assert_eq!(left, expected, "{name}");
    }
}

#[test]
fn text_and_binary_of_ndgrid_are_one_mesh() {
    let Some(files) = files() else { return };
    let of = |name: &str| &files.iter().find(|f| f.0 == name).unwrap().1;
    for name in ["cube_quadrilateral", "cube_tetrahedron", "sphere_triangle"] {
        let (text, binary) = (of(&format!("ndgrid/meshes/{name}")), of(&format!("ndgrid/meshes/{name}_bin")));
        assert_eq!(corners(text), corners(binary), "{name}");
    }
    let shapes = |m: &MeshFile| -> Vec<_> { corners(m).into_iter().filter(|b| b.0 == CellShape::Triangle).map(|b| b.3).collect() };
    let first = shapes(of("ndgrid/tests/test_mesh_ascii_v2"));
    for name in ["ascii_v4", "binary_v2", "binary_v4"] {
        assert_eq!(shapes(of(&format!("ndgrid/tests/test_mesh_{name}"))), first, "{name}");
    }
}

#[test]
fn a_surface_in_space_is_no_plane_mesh() {
    let Some(files) = files() else { return };
    let sphere = &files.iter().find(|f| f.0 == "ndgrid/meshes/sphere_triangle").unwrap().1;
    let error = sphere.cells::<2>(None).unwrap_err();
    assert_eq!(crate::kind(&error), "dimension");
    assert!(error.to_string().contains("off the plane"), "{error}");
}
