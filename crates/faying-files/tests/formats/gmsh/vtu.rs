//! VTU files: what is written reads back, what other programs write, broken ones.

use super::broken::{Random, mutate};
use super::data;
use super::measure::{least, measure};
use faying::geometry::shapes::annulus_sector;
use faying::space::{Body, Mesh, PatchSpec};
use faying_files::vtu::{CellStyle, Part, write};
use faying_files::vtu_read::parse;
use faying_files::{CellShape, FileError, Limits, write_vtu};

#[test]
fn meshes_of_every_order_come_back_from_vtu() {
    for p in 1..=4 {
        for name in ["disc_quad_p{}_v4_bin.msh", "disc_tri_p{}_v4_bin.msh", "octant_tet_p{}_v2_bin.msh", "box_hex_p3_v4.msh"] {
            let mut mesh = data(&name.replace("{}", &p.to_string()));
            let grid = parse(&write_vtu(&mesh).unwrap(), &Limits::default()).unwrap();
            let again = grid.mesh().unwrap();
            assert_eq!(again.points, mesh.points);
            // a grid has no numbers of points
            mesh.ids = again.ids.clone();
            mesh.format = again.format;
            assert_eq!(again, mesh, "{name} of order {p}");
        }
    }
}

#[test]
fn quarter_rings_that_this_program_writes_become_meshes() {
    // six chords of 15 degrees lose 1.1 % of the area
    for (p, error) in [(1, 0.012), (2, 1e-4), (3, 1e-5)] {
        let ring = annulus_sector([0.0, 0.0], [1.0, 2.0], [0.0, 90.0]).unwrap();
        let mesh = Mesh::<1, 2>::from_patch(&PatchSpec::new(ring).with_degree([p, p]).with_elements([6, 3])).unwrap();
        let bytes = write(&[Part::new("ring", mesh.space().clone(), CellStyle::Lagrange)]).unwrap();
        // angle, then radius is left-handed; its cells are not
        let mesh = parse(&bytes, &Limits::default()).unwrap().mesh().unwrap();
        assert_eq!(mesh.points.len(), (6 * p + 1) * (3 * p + 1), "shared points are one");
        assert_eq!(p, mesh.blocks[0].order);
        let area = measure(&mesh, 2, Some("ring")) / (0.75 * std::f64::consts::PI);
        assert!((area - 1.0).abs() < error && least(&mesh, 2) > 0.1, "order {p}: {area}");
    }
}

const TEXT: &str = r#"<?xml version="1.0"?>
<VTKFile type="UnstructuredGrid" version="0.1" byte_order="LittleEndian">
<UnstructuredGrid><Piece NumberOfPoints="4" NumberOfCells="2">
<PointData><DataArray type="Float32" Name="T" NumberOfComponents="1" format="ascii">1 2.5 -3 4</DataArray></PointData>
<Points><DataArray type="Float64" NumberOfComponents="3" format="ascii">0 0 0 1 0 0 1 1 0 0 1 0</DataArray></Points>
<Cells><DataArray type="Int32" Name="connectivity" format="ascii">0 1 2 0 2 3</DataArray>
<DataArray type="Int32" Name="offsets" format="ascii">3 6</DataArray>
<DataArray type="UInt8" Name="types" format="binary">AgAAAA==BQU=</DataArray></Cells>
</Piece></UnstructuredGrid></VTKFile>"#;

#[test]
fn text_and_base64_arrays_of_other_programs_are_read() {
    let grid = parse(TEXT.as_bytes(), &Limits::default()).unwrap();
    assert_eq!((grid.points.len(), grid.cell_types()), (4, vec![(5, "triangle", 2)]));
    assert_eq!(grid.point_fields[0].ranges(), [Some([-3.0, 4.0])]);
    let mesh = grid.mesh().unwrap();
    assert!((measure(&mesh, 2, None) - 1.0).abs() < 1e-15);
    // header and data as one base64 text, as meshio writes
    let joined = TEXT.replace("AgAAAA==BQU=", "AgAAAAUF");
    assert_eq!(parse(joined.as_bytes(), &Limits::default()).unwrap(), grid);
}

#[test]
fn grids_that_cannot_be_used_say_why() {
    for (from, to, expected) in [
        ("type=\"UnstructuredGrid\"", "type=\"PolyData\"", "a VTK file of type PolyData is not supported"),
        (
            "byte_order",
            "compressor=\"vtkOtherDataCompressor\" byte_order",
            "a VTU file compressed by vtkOtherDataCompressor (zlib, LZ4, LZMA",
        ),
        ("byte_order", "compressor=\"vtkLZ4DataCompressor\" byte_order", "the data end early (byte "),
        ("byte_order", "compressor=\"vtkZLibDataCompressor\" byte_order", "the data end early (byte "),
        ("0 1 2 0 2 3", "0 1 2 0 2 4", "a cell refers to point 4 of 4 (byte "),
        ("0 1 2 0 2 3", "0 1 2 0 2 -1", "a cell refers to point -1 of 4 (byte "),
        (">3 6<", ">6 3<", "the offsets of the cells do not fit their points (byte "),
        ("NumberOfPoints=\"4\"", "NumberOfPoints=\"1152921504606846976\"", "holds 4 numbers, not 1152921504606846976 times 1 (byte "),
        ("0 0 0 1", "nan 0 0 1", "is not finite (byte "),
        ("AgAAAA==BQU=", "////fwU=", "the data end early (byte "),
    ] {
        let text = TEXT.replacen(from, to, 1);
        let error = parse(text.as_bytes(), &Limits::default()).unwrap_err();
        assert!(error.to_string().contains(expected) && crate::kind(&error) == "content", "{error}");
    }
    let bezier = TEXT.replace("AgAAAA==BQU=", "AgAAAExM");
    let error = parse(bezier.as_bytes(), &Limits::default()).unwrap().mesh().unwrap_err();
    assert!(error.to_string().contains("Bezier triangle"), "{error}");
}

/// The types 5 and 5 as a block of two bytes: header and data as base64 texts of their own, as VTK writes, with 4-byte numbers.
const PACKED: &str = "AQAAAACAAAACAAAACgAAAA==eJxjZQUAABEACw==";

#[test]
fn compressed_arrays_in_base64_are_read_and_damaged_ones_are_not() {
    let zlib = TEXT.replace("byte_order", "compressor=\"vtkZLibDataCompressor\" byte_order").replace("AgAAAA==BQU=", PACKED);
    assert_eq!(parse(zlib.as_bytes(), &Limits::default()).unwrap(), parse(TEXT.as_bytes(), &Limits::default()).unwrap());
    for (from, to, expected) in [
        ("eJxjZQUAABEACw==", "eJxjZQUAABEA", "the data end early"),
        ("eJxjZQUAABEACw==", "eJxjZQUAABEAAA==", "a compressed block is damaged"),
        // three bytes are promised
        ("AQAAAACAAAACAAAACgAAAA==", "AQAAAACAAAADAAAACgAAAA==", "a compressed block is damaged"),
        // 2^30 blocks
        ("AQAAAACAAAACAAAACgAAAA==", "AAAAQACAAAACAAAACgAAAA==", "the data end early"),
    ] {
        let error = parse(zlib.replace(from, to).as_bytes(), &Limits::default()).unwrap_err();
        assert!(error.to_string().contains(expected) && crate::kind(&error) == "content", "{to}: {error}");
    }
}

#[test]
fn mutated_grids_are_read_or_refused_within_the_memory_allowed() {
    let raw = write_vtu(&data("disc_quad_p2_v4_bin.msh")).unwrap();
    for (seed, good) in [raw, TEXT.as_bytes().to_vec()].into_iter().enumerate() {
        let mut random = Random(100 + seed as u64);
        for _ in 0..2000 {
            let mut bad = good.clone();
            mutate(&mut random, &mut bad);
            let mut result = None;
            let info = allocation_counter::measure(|| result = Some(parse(&bad, &Limits { memory: Some(200_000) })));
            assert!(info.bytes_max + bad.len() as u64 <= 260_000, "{} bytes", info.bytes_max);
            match result.unwrap() {
                Ok(grid) => drop(grid.mesh().map(|m| m.blocks.iter().filter(|b| b.shape == CellShape::Line).count())),
                Err(FileError::Unsupported { .. } | FileError::Broken { .. } | FileError::Memory { .. }) => {}
                Err(other) => panic!("{other:?}"),
            }
        }
    }
}
