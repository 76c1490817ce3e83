//! VTU files that VTK and meshio wrote, in every encoding that they have: `tests/data/vtu/make.py`.

use crate::gmsh::{Random, mutate};
use faying_files::vtu_read::{VtuFile, parse};
use faying_files::{CellShape, FileError, Limits};
use std::path::Path;

fn bytes(name: &str) -> Vec<u8> {
    std::fs::read(Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")).join("tests/data/vtu").join(format!("{name}.vtu"))).unwrap()
}

fn read(name: &str) -> VtuFile {
    parse(&bytes(name), &Limits::default()).unwrap_or_else(|e| panic!("{name}: {e}"))
}

/// Point data T = x + 2 y + 4 z and v = x, cell data the number of the cell: all exact in binary.
fn check(name: &str, file: &VtuFile, cells: usize) {
    let field = |fields: &[faying_files::vtu_read::VtuField], name: &str| fields.iter().find(|f| f.name == name).cloned().unwrap();
    let (t, v, number) = (field(&file.point_fields, "T"), field(&file.point_fields, "v"), field(&file.cell_fields, "number"));
    assert_eq!((t.components, v.components, number.components), (1, 3, 1), "{name}");
    assert_eq!(number.values, (0..cells).map(|k| k as f64).collect::<Vec<_>>(), "{name}");
    assert_eq!(t.values, file.points.iter().map(|x| x[0] + 2.0 * x[1] + 4.0 * x[2]).collect::<Vec<_>>(), "{name}");
    assert_eq!(v.values, file.points.iter().flatten().copied().collect::<Vec<_>>(), "{name}");
}

#[test]
fn every_encoding_of_vtk_and_meshio_is_the_same_grid() {
    let plain = read("plane_ascii_none");
    assert_eq!((plain.points.len(), plain.types.as_slice()), (14, &[8, 8, 9, 5, 22][..]));
    check("plane_ascii_none", &plain, 5);
    for mode in ["inline", "raw", "base64"] {
        for pack in ["none", "zlib", "lz4", "lzma"] {
            let name = format!("plane_{mode}_{pack}");
            assert_eq!(read(&name), plain, "{name}");
        }
    }
    for name in ["plane_default", "plane_wide", "plane_big"] {
        let file = read(name);
        assert_eq!(VtuFile { version: plain.version, ..file }, plain, "{name}");
    }
    // meshio has no pixels
    let quads = read("plane_meshio_ascii");
    assert_eq!(quads.types, [9, 9, 9, 5, 22]);
    check("plane_meshio_ascii", &quads, 5);
    for name in ["plane_meshio_default", "plane_meshio_none", "plane_meshio_lzma"] {
        assert_eq!(read(name), quads, "{name}");
    }
    let meshes = [&plain, &quads].map(|file| file.mesh().unwrap());
    assert_eq!(meshes[0].blocks, meshes[1].blocks, "a pixel is a quadrilateral");
}

#[test]
fn pixels_voxels_and_quadratic_cells_have_their_sizes() {
    let mesh = read("plane_default").mesh().unwrap();
    // three squares, a triangle, and a triangle of order 2 whose edges are straight
    for (shape, order, area) in [(CellShape::Quadrilateral, 1, 3.0), (CellShape::Triangle, 1, 0.5), (CellShape::Triangle, 2, 0.5)] {
        let block = mesh.blocks.iter().find(|b| (b.shape, b.order) == (shape, order)).unwrap();
        let map = faying_files::CellMap::<2>::new(block, &mesh.points).unwrap();
        let found = faying::space::measure::<2, 3, f64, _>(&map);
        assert!((found - area).abs() < 1e-14, "{shape:?} of order {order}: {found}");
    }
    let solid = read("solid_base64_zlib");
    check("solid", &solid, 5);
    let mesh = solid.mesh().unwrap();
    let hexahedra = mesh.blocks.iter().find(|b| b.shape == CellShape::Hexahedron).unwrap();
    assert_eq!(hexahedra.ids.len(), 2, "a voxel is a hexahedron");
    assert!((crate::gmsh::measure(&mesh, 3, None) - 2.0).abs() < 0.5);
    let map = faying_files::CellMap::<3>::new(hexahedra, &mesh.points).unwrap();
    assert!((faying::space::measure::<3, 3, f64, _>(&map) - 2.0).abs() < 1e-14);
}

/// A quadrilateral of 8 nodes with one bent edge, as text.
const EIGHT: &str = r#"<VTKFile type="UnstructuredGrid" version="1.0"><UnstructuredGrid><Piece NumberOfPoints="8 " NumberOfCells="1">
<Points><DataArray type="Float64" NumberOfComponents="3" format="ascii">0 0 0 1 0 0 1 1 0 0 1 0 0.5 -0.25 0 1 0.5 0 0.5 1 0 0 0.5 0</DataArray></Points>
<Cells><DataArray type="Int32" Name="connectivity" format="ascii"><!-- all --><InformationKey name="a"> 7 </InformationKey>0 1 2 3 4 5 6 7</DataArray>
<DataArray type="Int32" Name="offsets" format="ascii">8</DataArray><DataArray type="UInt8" Name="types" format="ascii">23</DataArray></Cells>
</Piece></UnstructuredGrid></VTKFile>"#;

#[test]
fn quadrilaterals_of_eight_nodes_keep_their_shape() {
    let mesh = parse(EIGHT.as_bytes(), &Limits::default()).unwrap().mesh().unwrap();
    assert_eq!((mesh.points.len(), mesh.blocks[0].order), (9, 2));
    // the parabola below the edge: 2/3 of 0.25
    let area = crate::gmsh::measure(&mesh, 2, None);
    assert!((area - 1.0 - 0.5 / 3.0).abs() < 1e-14, "{area}");
    let short = EIGHT.replace("5 6 7<", "5 6<").replace(">8<", ">7<");
    let error = parse(short.as_bytes(), &Limits::default()).unwrap().mesh().unwrap_err();
    assert!(error.to_string().contains("cell 0 has 7 points, a 8-node quadrilateral has 8"), "{error}");
}

#[test]
fn damaged_blocks_of_every_compression_are_refused_within_the_memory_allowed() {
    for (seed, (name, allowed)) in
        [("plane_raw_lz4", 200_000), ("plane_raw_lzma", 300_000), ("plane_inline_lzma", 300_000)].into_iter().enumerate()
    {
        let good = bytes(name);
        let limits = Limits { memory: Some(allowed) };
        assert!(parse(&good, &limits).is_ok(), "{name}: {:?}", parse(&good, &limits).err());
        let mut random = Random(500 + seed as u64);
        let mut damaged = 0;
        for _ in 0..2000 {
            let mut bad = good.clone();
            mutate(&mut random, &mut bad);
            let mut result = None;
            let info = allocation_counter::measure(|| result = Some(parse(&bad, &limits)));
            assert!(info.bytes_max + bad.len() as u64 <= allowed + 60_000, "{name}: {} bytes", info.bytes_max);
            match result.unwrap() {
                Ok(grid) => drop(grid.mesh()),
                Err(FileError::Broken { what, .. }) => damaged += usize::from(what.contains("a compressed block is damaged")),
                Err(FileError::Unsupported { .. } | FileError::Memory { .. }) => {}
                Err(other) => panic!("{other:?}"),
            }
        }
        assert!(damaged > 20, "{name}: {damaged} damaged blocks were noticed");
    }
}
