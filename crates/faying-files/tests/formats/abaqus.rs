//! Abaqus input files: what Gmsh writes, every keyword that is read, what is refused.

use crate::gmsh::{least, measure};
use faying_files::inp::parse;
use faying_files::{CellShape, FileError, Limits, MeshFile};
use std::path::Path;

fn folder() -> std::path::PathBuf {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")).join("tests/data/inp")
}

/// Reads a text that includes the given files.
fn read_with(text: &str, files: &[(&str, &str)]) -> Result<MeshFile, FileError> {
    let mut include = |name: &str| {
        let missing = || FileError::System { missing: true, message: "no such file".into() };
        files.iter().find(|f| f.0 == name).map(|f| f.1.as_bytes().to_vec()).ok_or_else(missing)
    };
    parse(text.as_bytes(), &Limits::default(), &mut include)
}

fn read(text: &str) -> MeshFile {
    read_with(text, &[]).unwrap_or_else(|e| panic!("{e}"))
}

fn cells(mesh: &MeshFile, shape: CellShape) -> usize {
    mesh.blocks.iter().filter(|b| b.shape == shape).map(|b| b.ids.len()).sum()
}

/// Names of sides with the numbers of their facets.
fn sides<const N: usize>(mesh: &MeshFile) -> Vec<(String, usize)> {
    mesh.cells::<N>(None).unwrap().tags.into_iter().map(|t| (t.name, t.corners.len())).collect()
}

#[test]
fn meshes_of_gmsh_have_the_sizes_that_gmsh_measures() {
    // body and rim by the Gauss points of Gmsh; exact for straight cells and for curved edges up to 1e-9
    let sizes: [(&str, usize, f64, f64); 8] = [
        ("disc_tri_1", 2, 2.8284271247461903, 6.122934917841439),
        ("disc_tri_2", 2, 3.1391475703122422, 6.2808094322965555),
        ("disc_quad_1", 2, 2.828427124746193, 6.122934917841439),
        ("disc_quad_2", 2, 3.1391475703122302, 6.2808094322965555),
        ("ball_tet_1", 3, 3.229523149686928, 11.084300100517856),
        ("ball_tet_2", 3, 4.150977803817434, 12.496857245037631),
        ("drum_hex_1", 3, 2.8284271247461943, 6.122934917841442),
        ("drum_hex_2", 3, 3.1391475703122325, 6.280809432296558),
    ];
    for (name, dimension, body, rim) in sizes {
        let path = folder().join(format!("{name}.inp"));
        let Ok(faying_files::Contents::Mesh(mesh)) = faying_files::read(&path, &Limits::default()) else { panic!("{name}") };
        let found = [measure(&mesh, dimension, Some("body")), measure(&mesh, dimension - 1, Some("rim"))];
        for (found, expected) in found.into_iter().zip([body, rim]) {
            assert!((found / expected - 1.0).abs() < 1e-8, "{name}: {found}, Gmsh {expected}");
        }
        assert!(least(&mesh, dimension) > 0.1, "{name}: {}", least(&mesh, dimension));
        let bodies = if dimension == 2 {
            mesh.cells::<2>(Some("body")).map(|c| c.tags.len())
        } else {
            mesh.cells::<3>(Some("body")).map(|c| c.tags.len())
        };
        assert!(bodies.unwrap() > 0, "{name}");
        // the set of nodes of the rim has the facets that the file lists, and no second ones
        let order = if name.ends_with('2') { 2 } else { 1 };
        assert!(mesh.blocks.iter().all(|b| b.order == order || b.shape == CellShape::Point), "{name}");
    }
}

/// Two quadrilaterals [0, 2] x [0, 1] and a triangle beside them.
const PLANE: &str = "** a comment
*Heading
 anything, 3
*Part, name=P
*NODE, nset=ALL
1, 0., 0.
2, 1.D0, 0, 0
3, 2, 0
 11, 0, 1
12, 1, 1
13, 2, 1
20, 3, 0
*Element, Type=cps4r, ElSet = \"Two squares\"
1, 1, 2,
12, 11
2, 2, 3, 13, 12
*ELEMENT, TYPE=CPE3
7, 3, 20, 13
*elset, elset=first, generate
1, 1
*ELSET,
ELSET=solids
first, 2
*ELSET, ELSET=Solids
7
*NSET, NSET=left
1, 11
*NSET, NSET=ends
 left, 20
*NSET, NSET=top, GENERATE
11, 13
*NSET, NSET=corner
20
*NSET, NSET=of_first, ELSET=first
*SURFACE, NAME=under, TYPE=ELEMENT
solids, S1
*SURFACE, NAME=slope
7, S2
*SURFACE, NAME=up, TYPE=NODE
top, 1.
*End Part
*Material, name=steel
*Elastic
210e3, 0.3
";

#[test]
fn sets_and_surfaces_of_a_plane_file_are_groups_and_sides() {
    let mesh = read(PLANE);
    assert_eq!((mesh.dimension(), mesh.points.len(), mesh.ids.clone()), (2, 7, vec![1, 2, 3, 11, 12, 13, 20]));
    assert_eq!((cells(&mesh, CellShape::Quadrilateral), cells(&mesh, CellShape::Triangle)), (2, 1));
    for (name, size) in [("Two squares", 2.0), ("first", 1.0), ("solids", 2.5)] {
        assert!((measure(&mesh, 2, Some(name)) - size).abs() < 1e-14, "{name}");
    }
    // all nodes make no side; the first square has three edges on the boundary; "ends" has the edge of "left", its third node lies on no facet of the set
    let expected = [("under", 3), ("slope", 1), ("left", 1), ("ends", 1), ("top", 2), ("of_first", 3), ("up", 2), ("corner", 1)];
    let mut found = sides::<2>(&mesh);
    let mut expected: Vec<(String, usize)> = expected.map(|(n, k)| (n.to_owned(), k)).into();
    found.sort();
    expected.sort();
    assert_eq!(found, expected);
    assert_eq!(mesh.point("corner"), Some([3.0, 0.0, 0.0]));
    for (name, length) in [("under", 3.0), ("slope", 2f64.sqrt()), ("left", 1.0), ("top", 2.0), ("of_first", 3.0)] {
        assert!((measure(&mesh, 1, Some(name)) - length).abs() < 1e-14, "{name}: {}", measure(&mesh, 1, Some(name)));
    }
    let notes = mesh.notes.join("; ");
    assert!(notes.contains("1 of 3 nodes of the set \"ends\"") && notes.contains("not read: *ELASTIC, *MATERIAL"), "{notes}");
    // windows line ends, upper case
    assert_eq!(read(&PLANE.replace('\n', "\r\n")), mesh);
    let upper = read(&PLANE.to_ascii_uppercase());
    assert_eq!((sides::<2>(&upper).len(), upper.blocks.len()), (8, mesh.blocks.len()));
}

#[test]
fn files_are_included_where_they_are_named() {
    let (nodes, rest) = PLANE.split_at(PLANE.find("*Element, Type").unwrap());
    let (elements, sets) = rest.split_at(rest.find("*elset, elset=first").unwrap());
    let whole = format!("*INCLUDE, INPUT=parts/nodes.inp\n*include,\ninput=cells.inp\n{sets}");
    let files = [("parts/nodes.inp", nodes), ("cells.inp", elements)];
    assert_eq!(read_with(&whole, &files).unwrap(), read(PLANE));
    // data lines of a file of their own
    let (head, lines) = elements.split_at(elements.find("1, 1, 2").unwrap());
    let (lines, more) = lines.split_at(lines.find("*ELEMENT").unwrap());
    let data = format!("{nodes}{}, INPUT=data\n{more}{sets}", head.trim_end());
    assert_eq!(read_with(&data, &[("data", lines)]).unwrap(), read(PLANE));
    let broken = elements.replace("2, 2, 3", "2, 2, 33");
    for (files, expected) in [
        (vec![("parts/nodes.inp", nodes)], "cannot read the included file \"cells.inp\": no such file (line 2)"),
        (
            vec![("parts/nodes.inp", nodes), ("cells.inp", &broken)],
            "\"cells.inp\": element 2 refers to node 33, which is in no *NODE (line 4)",
        ),
        (vec![("parts/nodes.inp", nodes), ("cells.inp", "*INCLUDE, INPUT=cells.inp")], "more than 8 files that include each other"),
    ] {
        let error = read_with(&whole, &files).unwrap_err().to_string();
        assert!(error.contains(expected), "{error}");
    }
    // relative to the folder of the first file
    let at = tempfile::tempdir().unwrap();
    std::fs::create_dir(at.path().join("parts")).unwrap();
    for (name, text) in [("parts/nodes.inp", nodes), ("cells.inp", elements), ("all.inp", &whole)] {
        std::fs::write(at.path().join(name), text).unwrap();
    }
    let found = faying_files::read(&at.path().join("all.inp"), &Limits::default()).unwrap();
    assert_eq!(found, faying_files::Contents::Mesh(read(PLANE)));
}

#[test]
fn members_may_be_named_with_the_instance_of_their_part() {
    let own = "*NSET, NSET=two\n11, 13\n*SURFACE, NAME=lower\n1, S1\n*SURFACE, NAME=all\nsolids, S1\n";
    let named = own.replace("11, 13", "P-1.11, p-1.13").replace("\n1, S1", "\nP-1.1, S1").replace("solids, S1", "P-1.solids, S1");
    let of = |sets: &str| {
        let assembly = format!("*End Part\n*Assembly, name=A\n*Instance, name=\"P-1\", part=P\n*End Instance\n{sets}*End Assembly");
        read(&PLANE.replacen("*End Part", &assembly, 1))
    };
    assert_eq!(of(&named), of(own));
    assert_eq!(sides::<2>(&of(&named)).into_iter().filter(|s| ["two", "lower", "all"].contains(&s.0.as_str())).count(), 3);
    let other = named.replace("P-1.1,", "Q-1.1,");
    let text = PLANE.replacen("*End Part", &format!("*End Part\n*Instance, name=P-1, part=P\n*End Instance\n{other}"), 1);
    let error = read_with(&text, &[]).unwrap_err().to_string();
    assert!(error.contains("there is no set of elements \"Q-1.1\" before this line"), "{error}");
}

/// A cube of an 8-node hexahedron below two prisms, and a pyramid above.
const SOLID: &str = "*NODE
1, 0, 0, 0
2, 1, 0, 0
3, 1, 1, 0
4, 0, 1, 0
5, 0, 0, 1
6, 1, 0, 1
7, 1, 1, 1
8, 0, 1, 1
9, 0.5, 0.5, 2
*ELEMENT, TYPE=C3D8I, ELSET=cube
1, 1, 2, 3, 4, 5, 6, 7, 8
";

#[test]
fn faces_of_solids_lie_where_their_numbers_say() {
    for (face, at) in [(1, [2, 0]), (2, [2, 1]), (3, [1, 0]), (4, [0, 1]), (5, [1, 1]), (6, [0, 0])] {
        let mesh = read(&format!("{SOLID}*SURFACE, NAME=s\ncube, S{face}\n"));
        let tags = mesh.cells::<3>(None).unwrap().tags;
        assert_eq!(tags.len(), 1);
        assert!(tags[0].corners[0].iter().all(|n| mesh.points[*n][at[0]] == at[1] as f64), "S{face}");
    }
    // S1: 1 2 3, S2: 1 4 2, S3: 2 4 3, S4: 3 4 1
    let tet = "*NODE\n1, 0, 0, 0\n2, 1, 0, 0\n3, 0, 1, 0\n4, 0, 0, 1\n*ELEMENT, TYPE=C3D4, ELSET=e\n1, 1, 2, 3, 4\n";
    for (face, corners) in [(1, [0, 1, 2]), (2, [0, 1, 3]), (3, [1, 2, 3]), (4, [0, 2, 3])] {
        let mesh = read(&format!("{tet}*SURFACE, NAME=s\ne, S{face}\n"));
        let mut found: Vec<usize> = mesh.cells::<3>(None).unwrap().tags[0].corners[0][..3].to_vec();
        found.sort_unstable();
        assert_eq!(found, corners, "S{face}");
    }
    // an edge and a corner of a solid
    let mesh = read(&format!("{SOLID}*NSET, NSET=edge\n1, 5\n*NSET, NSET=tip\n7\n*NSET, NSET=far\n1, 7\n"));
    let dimension = |name: &str| mesh.groups.iter().filter(|g| g.name.as_deref() == Some(name)).map(|g| g.dimension).collect::<Vec<_>>();
    assert_eq!((dimension("edge"), dimension("tip"), dimension("far")), (vec![1], vec![0], vec![0]));
    assert!((measure(&mesh, 1, Some("edge")) - 1.0).abs() < 1e-15);
}

#[test]
fn prisms_and_pyramids_are_read_and_no_bodies() {
    let more = "*ELEMENT, TYPE=C3D5, ELSET=roof\n2, 5, 6, 7, 8, 9\n*ELEMENT, TYPE=C3D6\n3, 1, 2, 3, 5, 6, 7\n";
    let mesh = read(&format!("{SOLID}{more}"));
    assert_eq!((cells(&mesh, CellShape::Pyramid), cells(&mesh, CellShape::Prism)), (1, 1));
    let error = mesh.cells::<3>(Some("roof")).unwrap_err();
    assert!(error.to_string().contains("a body of pyramids (element 2)"), "{error}");
}

#[test]
fn what_is_not_read_is_refused_at_its_line() {
    let of = |from: &str, to: &str| PLANE.replacen(from, to, 1);
    for (text, expected) in [
        (of("cps4r", "S4R"), "element type S4R (CPE, CPS, CAX"),
        (of("cps4r", "S4R"), "is not supported (line 13)"),
        (of("2, 2, 3, 13, 12", "2, 2, 3, 13"), "element 2 has 3 of its 4 nodes (line 17)"),
        (of("2, 2, 3, 13, 12", "2, 2, 3, 13, 12, 11"), "element 2 has more than 4 nodes (line 16)"),
        (of("2, 2, 3, 13, 12", "2, 2, 3, 14, 12"), "element 2 refers to node 14, which is in no *NODE (line 16)"),
        (of("3, 2, 0", "3, 2, x"), "a coordinate must be a finite number, found \"x\" (line 8)"),
        (of("3, 2, 0", "3, inf, 0"), "a coordinate must be a finite number, found \"inf\" (line 8)"),
        (of("3, 2, 0", "-3, 2, 0"), "the number of a node must be a whole number from 1, found \"-3\" (line 8)"),
        (of("20, 3, 0", "13, 3, 0"), "node 13 stands twice (line 12)"),
        (of("7, 3, 20", "2, 3, 20"), "element 2 stands twice (line 18)"),
        (of("left, 20", "right, 20"), "there is no set of nodes \"right\" before this line (line 29)"),
        (of("left, 20", "left, 21"), "set \"ends\" has node 21, which the file does not have (line 29)"),
        (of("11, 13\n", "13, 11\n"), "GENERATE from 13 to 11 is empty (line 31)"),
        (of("solids, S1", "solids, S5"), "element 1 has no face S5 that is read (line 36)"),
        (of("solids, S1", "solids, SPOS"), "face SPOS of a surface (S1 to S6 are read) is not supported (line 36)"),
        (of("solids, S1", "solid, S1"), "there is no set of elements \"solid\" before this line (line 36)"),
        (of("*Heading", "*NGEN"), "*NGEN (nodes and elements are read as a list) is not supported (line 2)"),
        (of("*End Part", "*Part, name=Q"), "a file of several parts (write it without parts and assemblies) is not supported (line 41)"),
        (
            of("*End Part", "*Instance, name=a, part=P\n1, 0, 0"),
            "an instance that is moved (move the part itself) is not supported (line 42)",
        ),
        (of("nset=ALL", "system=C"), "*NODE with SYSTEM (Cartesian coordinates are read) is not supported (line 5)"),
        ("*Heading\n*NODE\n1, 0, 0\n".to_owned(), "the file has no *ELEMENT (line 4)"),
    ] {
        let error = read_with(&text, &[]).unwrap_err();
        assert!(error.to_string().contains(expected) && crate::kind(&error) == "content", "{error}\nnot: {expected}");
    }
}

#[test]
fn mutated_files_are_read_or_refused_within_the_memory_allowed() {
    use crate::gmsh::{Random, mutate};
    let solid = std::fs::read(folder().join("drum_hex_2.inp")).unwrap();
    for (seed, good) in [PLANE.as_bytes().to_vec(), solid].into_iter().enumerate() {
        let mut random = Random(300 + seed as u64);
        for _ in 0..1000 {
            let mut bad = good.clone();
            mutate(&mut random, &mut bad);
            let mut result = None;
            let limits = Limits { memory: Some(400_000) };
            let none = |_: &str| Err(FileError::System { missing: true, message: "none".into() });
            let info = allocation_counter::measure(|| result = Some(parse(&bad, &limits, &mut { none })));
            assert!(info.bytes_max + bad.len() as u64 <= 460_000, "{} bytes", info.bytes_max);
            match result.unwrap() {
                Ok(mesh) => drop((mesh.cells::<2>(None), mesh.cells::<3>(None))),
                Err(FileError::Unsupported { .. } | FileError::Broken { .. } | FileError::Memory { .. }) => {}
                Err(other) => panic!("{other:?}"),
            }
        }
    }
}
