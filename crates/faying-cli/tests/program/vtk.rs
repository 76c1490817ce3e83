//! The .vtu files, read by a reader of our own and evaluated by VTK itself where it is installed (Debian: python3-vtk9).

use crate::common::cells;
use faying::basis::{Cell, Elements, Order};
use faying::geometry::{ControlNet, Geometry, MapTable, shapes};
use faying::linalg::Vector;
use faying::space::{BasisKind, Body, Field, Mapping, Mesh, Patch, PatchSpec, Space, field_at};
use faying_cli::plot;
use faying_cli::table::InterfaceRow;
use faying_files::vtu::{CellStyle, MAX_DEGREE, Part, write};
use quick_xml::Reader;
use quick_xml::events::Event;
use std::collections::BTreeMap;
use std::process::Command;
use std::sync::Arc;

/// Local points at which cells are compared.
const POINTS: [[f64; 2]; 4] = [[0.25, 0.3], [0.5, 0.1], [0.05, 0.9], [0.0, 0.0]];

/// The arrays of a file, all numbers as f64.
struct File {
    attributes: BTreeMap<String, String>,
    arrays: BTreeMap<String, (usize, Vec<f64>)>,
    points: usize,
    cells: usize,
}

/// The bytes of an array: how many blocks, bytes of one, of the last, of each as it stands in the file, then the zlib streams.
fn inflated(bytes: &[u8]) -> Vec<u8> {
    use std::io::Read;
    let number = |k: usize| u64::from_le_bytes(bytes[8 * k..8 * k + 8].try_into().unwrap()) as usize;
    let (blocks, size, last) = (number(0), number(1), number(2));
    let (mut at, mut raw) = (8 * (3 + blocks), Vec::new());
    for k in 0..blocks {
        let before = raw.len();
        flate2::read::ZlibDecoder::new(&bytes[at..at + number(3 + k)]).read_to_end(&mut raw).unwrap();
        assert_eq!(raw.len() - before, if k + 1 == blocks && last > 0 { last } else { size }, "block {k} of {blocks}");
        at += number(3 + k);
    }
    raw
}

fn read(bytes: &[u8]) -> File {
    let tag = b"<AppendedData encoding=\"raw\">";
    let data = bytes.windows(tag.len()).position(|w| w == tag).expect("appended data") + tag.len();
    let data = data + bytes[data..].iter().position(|b| *b == b'_').expect("an underscore opens the data") + 1;
    let mut file = File { attributes: BTreeMap::new(), arrays: BTreeMap::new(), points: 0, cells: 0 };
    let mut reader = Reader::from_reader(&bytes[..data]);
    loop {
        match reader.read_event().expect("XML before the data") {
            Event::Start(e) | Event::Empty(e) => {
                let tag = String::from_utf8(e.name().as_ref().to_vec()).unwrap();
                let own: BTreeMap<String, String> = e
                    .attributes()
                    .map(|a| a.unwrap())
                    .map(|a| (String::from_utf8(a.key.as_ref().to_vec()).unwrap(), String::from_utf8(a.value.to_vec()).unwrap()))
                    .collect();
                if tag == "Piece" {
                    file.points = own["NumberOfPoints"].parse().unwrap();
                    file.cells = own["NumberOfCells"].parse().unwrap();
                }
                if tag == "DataArray" {
                    let at = data + own["offset"].parse::<usize>().unwrap();
                    let raw = inflated(&bytes[at..]);
                    let values: Vec<f64> = match own["type"].as_str() {
                        "Float64" => raw.chunks_exact(8).map(|b| f64::from_le_bytes(b.try_into().unwrap())).collect(),
                        "Int64" => raw.chunks_exact(8).map(|b| i64::from_le_bytes(b.try_into().unwrap()) as f64).collect(),
                        "Int32" => raw.chunks_exact(4).map(|b| f64::from(i32::from_le_bytes(b.try_into().unwrap()))).collect(),
                        "UInt8" => raw.iter().map(|b| f64::from(*b)).collect(),
                        other => panic!("array of type {other}"),
                    };
                    file.arrays.insert(own["Name"].clone(), (own["NumberOfComponents"].parse().unwrap(), values));
                } else {
                    file.attributes.extend(own.into_iter().map(|(k, v)| (format!("{tag}.{k}"), v)));
                }
            }
            Event::Eof => return file,
            _ => {}
        }
    }
}

impl File {
    /// Counts, ids and types fit together.
    fn check(&self) {
        assert_eq!(self.arrays["Points"].1.len(), 3 * self.points);
        let (offsets, ids, types) = (&self.arrays["offsets"].1, &self.arrays["connectivity"].1, &self.arrays["types"].1);
        assert_eq!(offsets.len(), self.cells);
        assert_eq!(types.len(), self.cells);
        assert_eq!(offsets.last().copied().unwrap_or(0.0) as usize, ids.len());
        assert!(ids.iter().all(|i| *i >= 0.0 && (*i as usize) < self.points));
        for (name, (components, values)) in &self.arrays {
            let count = match name.as_str() {
                "connectivity" => continue,
                name if name.starts_with("patch.") => 1,
                "offsets" | "types" | "patch" | "element" | "HigherOrderDegrees" => self.cells,
                _ => self.points,
            };
            assert_eq!(values.len(), components * count, "{name}");
        }
        if types.iter().any(|t| *t >= 68.0) {
            assert_eq!(self.attributes["CellData.HigherOrderDegrees"], "HigherOrderDegrees");
            let degrees = &self.arrays["HigherOrderDegrees"];
            assert_eq!(degrees.0, 3);
            for c in 0..self.cells {
                let from = if c == 0 { 0.0 } else { offsets[c - 1] };
                let (d, n) = (&degrees.1[3 * c..3 * c + 3], offsets[c] - from);
                let expected = match types[c] as u8 {
                    70 | 77 => (d[0] + 1.0) * (d[1] + 1.0),
                    69 | 76 => (d[0] + 1.0) * (d[0] + 2.0) / 2.0,
                    68 | 75 => d[0] + 1.0,
                    _ => n,
                };
                assert_eq!(n, expected, "points of cell {c}");
            }
        }
        assert_eq!(self.arrays.contains_key("RationalWeights"), self.attributes.contains_key("PointData.RationalWeights"));
        if let Some((_, w)) = self.arrays.get("RationalWeights") {
            assert!(w.iter().all(|w| *w > 0.0));
        }
        // high-order hexahedra need version 2.2
        let hexahedra = types.iter().any(|t| [72.0, 79.0].contains(t));
        assert_eq!(self.attributes["VTKFile.version"], if hexahedra { "2.2" } else { "1.0" });
        assert_eq!(self.attributes["VTKFile.header_type"], "UInt64");
        assert_eq!(self.attributes["VTKFile.compressor"], "vtkZLibDataCompressor");
    }
}

/// A python that knows VTK.
fn python() -> Option<&'static str> {
    ["/usr/bin/python3", "python3"]
        .into_iter()
        .find(|p| Command::new(p).args(["-c", "import vtkmodules.vtkIOXML"]).output().is_ok_and(|o| o.status.success()))
}

/// What VTK finds at `POINTS` of every cell: (cell, point) -> name -> values; the position under "x".
fn by_vtk(bytes: &[u8], points: &[[f64; 2]]) -> Option<BTreeMap<(usize, usize), BTreeMap<String, Vec<f64>>>> {
    let Some(python) = python() else {
        eprintln!("skipped: no python3 with VTK here (Debian: apt-get install python3-vtk9)");
        return None;
    };
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("grid.vtu");
    std::fs::write(&file, bytes).unwrap();
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/program/vtk/evaluate.py");
    let words = points.iter().map(|p| format!("{:?},{:?}", p[0], p[1]));
    let out = Command::new(python).arg(script).arg(&file).args(words).output().unwrap();
    assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
    assert!(out.stderr.is_empty(), "VTK says {}", String::from_utf8_lossy(&out.stderr));
    let mut found = BTreeMap::new();
    for (k, line) in String::from_utf8(out.stdout).unwrap().lines().skip(1).enumerate() {
        let words: Vec<&str> = line.split(' ').collect();
        let mut values: BTreeMap<String, Vec<f64>> = BTreeMap::new();
        let mut name = "x".to_owned();
        for word in &words[3..] {
            match word.parse::<f64>() {
                Ok(v) => values.entry(name.clone()).or_default().push(v),
                Err(_) => name = (*word).to_owned(),
            }
        }
        found.insert((words[0].parse().unwrap(), k % points.len()), values);
    }
    Some(found)
}

/// Numbers between -1 and 1, the same in every run.
fn numbers(n: usize) -> Vec<f64> {
    let mut state = 0x2545_f491_4f6c_dd1d_u64;
    (0..n)
        .map(|_| {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
        })
        .collect()
}

fn displacement(space: &Arc<dyn Space<2, 2>>) -> impl Fn(usize, &[Vector<2>]) -> Vec<f64> + Send + Sync + 'static {
    let (space, u) = (space.clone(), numbers(2 * space.num_functions()));
    move |e, xi| {
        field_at::<2, 2, f64, _>(&*space, &Field { first: 0, components: 2 }, &u, e, xi)
            .iter()
            .flat_map(|f| [f.value[0], f.value[1]])
            .collect()
    }
}

/// A linear stress state over the body: what a patch test with a body force has.
fn stress(space: &Arc<dyn Space<2, 2>>) -> impl Fn(usize, &[Vector<2>]) -> Vec<f64> + Send + Sync + 'static {
    let space = space.clone();
    move |e, xi| {
        let mut table = MapTable::new();
        space.map(e, xi, Order::Values, &mut table);
        table.x.iter().flat_map(|x| [1.0, -1.25e-3, 0.3, 0.1, 0.0, 0.0].map(|s| s * (1.0 + 0.1 * x[0]))).collect()
    }
}

fn part(name: &str, space: &Arc<dyn Space<2, 2>>, style: CellStyle) -> Part<'static, 2, 2> {
    Part::new(name, space.clone(), style).with_exact("displacement", 2, displacement(space)).with("stress", 6, stress(space)).with(
        "von_mises",
        1,
        |e, xi| xi.iter().map(|x| 1.0 + e as f64 + x[0]).collect(),
    )
}

/// A plate of unequal degrees with curved sides.
fn curved_plate() -> ControlNet<2, 2> {
    let mut net = shapes::rectangle([0.0, 0.0], [2.0, 1.0]).unwrap().elevate(0, 1);
    net.points[1] += Vector::<2>::new(0.1, 0.3);
    net
}

fn ring() -> ControlNet<2, 2> {
    shapes::annulus_sector([0.0, 0.0], [1.0, 2.0], [0.0, 90.0]).unwrap()
}

fn bodies() -> Vec<(&'static str, Arc<dyn Space<2, 2>>)> {
    let iga = |net: ControlNet<2, 2>, degree: [usize; 2], basis: BasisKind| {
        Patch::<1, 2>::try_new(&PatchSpec::new(net).with_degree(degree).with_elements([3, 2]).with_basis(basis)).unwrap().space().clone()
    };
    let fe = |net: ControlNet<2, 2>, degree: usize, cells: Cell, mapping: Mapping| {
        let spec = PatchSpec::new(net).with_degree([degree; 2]).with_elements([3, 2]).with_cells(cells).with_mapping(mapping);
        Mesh::<1, 2>::from_patch(&spec).unwrap().space().clone()
    };
    let mut all = vec![
        ("ring, NURBS (2,2)", iga(ring(), [2, 2], BasisKind::Nurbs)),
        ("ring, NURBS (3,2)", iga(ring(), [3, 2], BasisKind::Nurbs)),
        ("ring, B-splines (1,1)", iga(ring(), [1, 1], BasisKind::BSpline)),
        ("ring, B-splines (2,3)", iga(ring(), [2, 3], BasisKind::BSpline)),
        ("plate, B-splines (2,3)", iga(curved_plate(), [2, 3], BasisKind::BSpline)),
        ("plate, B-splines (4,4)", iga(curved_plate(), [4, 4], BasisKind::BSpline)),
        ("disc, NURBS (2,2)", iga(shapes::disc_sector([0.0, 0.0], 1.0, [0.0, 60.0]).unwrap(), [2, 2], BasisKind::Nurbs)),
        ("plate with a hole, NURBS (3,3)", iga(shapes::plate_with_hole(1.0, 4.0).unwrap(), [3, 3], BasisKind::Nurbs)),
    ];
    for degree in 1..=4 {
        all.push(("quadrilaterals", fe(ring(), degree, Cell::Tensor, Mapping::Isoparametric)));
        all.push(("triangles", fe(ring(), degree, Cell::Simplex, Mapping::Isoparametric)));
    }
    all
}

/// The local point of an element that is the cell's (r, s): cells of left-handed elements have their first two axes exchanged.
fn cell_point<const D: usize>(space: &dyn Space<D, D>, element: usize, mut point: Vector<D>) -> Vector<D> {
    let mut table = MapTable::new();
    space.map(element, &[Vector::<D>::repeat(0.3)], Order::Gradients, &mut table);
    if faying::linalg::determinant(&table.jacobian[0]) < 0.0 {
        point.swap_rows(0, 1);
    }
    point
}

/// VTK and the space agree at `POINTS` of every element to 1e-9.
fn compare(name: &str, space: &Arc<dyn Space<2, 2>>, style: CellStyle, stresses: bool) {
    let part = part(name, space, style);
    let bytes = write(std::slice::from_ref(&part)).unwrap();
    let file = read(&bytes);
    file.check();
    assert_eq!(file.cells, space.num_elements());
    let Some(found) = by_vtk(&bytes, &POINTS) else { return };
    for e in 0..space.num_elements() {
        let xi = POINTS.map(|x| cell_point(&**space, e, Vector::<2>::from(x)));
        let mut table = MapTable::new();
        space.map(e, &xi, Order::Values, &mut table);
        let (u, s) = ((part.fields[0].sample)(e, &xi), (part.fields[1].sample)(e, &xi));
        for q in 0..POINTS.len() {
            let vtk = &found[&(e, q)];
            let near = |what: &str, a: &[f64], b: &[f64]| {
                for (a, b) in a.iter().zip(b) {
                    assert!((a - b).abs() < 1e-9, "{name} ({style:?}), {what} at {:?} of element {e}: VTK {a}, ours {b}", POINTS[q]);
                }
            };
            near("position", &vtk["x"], &[table.x[q][0], table.x[q][1], 0.0]);
            near("displacement", &vtk["displacement"], &[u[2 * q], u[2 * q + 1], 0.0]);
            if stresses {
                near("stress", &vtk["stress"], &s[6 * q..6 * q + 6]);
            }
        }
    }
}

#[test]
fn vtk_evaluates_bezier_cells_of_every_basis_as_we_do() {
    for (name, space) in bodies() {
        // a linear stress lies in the span of the cell where the map's degree does
        compare(name, &space, CellStyle::Bezier, true);
    }
}

#[test]
fn vtk_evaluates_lagrange_cells_of_polynomial_spaces_as_we_do() {
    for (name, space) in
        bodies().into_iter().filter(|(name, _)| name.starts_with("quad") || name.starts_with("tri") || name.starts_with("plate, B"))
    {
        compare(name, &space, CellStyle::Lagrange, true);
    }
}

#[test]
fn vtk_evaluates_cells_of_unstructured_meshes_as_we_do() {
    use cells::{Shapes, bent, boxes};
    for degree in 1..=4 {
        let mixed = boxes([3, 2], Shapes::Mixed, degree, Some(2), &bent);
        let space = Mesh::<1, 2>::from_cells(&mixed, degree, Mapping::Isoparametric).unwrap().space().clone();
        // quadratic cells have degree 2 at most
        let styles = [CellStyle::Lagrange, CellStyle::Bezier, CellStyle::Quadratic];
        for style in &styles[..if degree > 2 { 2 } else { 3 }] {
            compare("triangles and quadrilaterals", &space, *style, true);
        }
        for (shapes, kinds, local) in [
            (Shapes::Tensor, [72.0, 79.0, 29.0], (degree + 1).pow(3)),
            (Shapes::Simplex, [71.0, 78.0, 24.0], (degree + 1) * (degree + 2) * (degree + 3) / 6),
        ] {
            let solid = boxes([2, 1, 1], shapes, degree, Some(2), &bent);
            let space = Mesh::<2, 3>::from_cells(&solid, degree, Mapping::Isoparametric).unwrap().space().clone();
            for (style, kind) in styles.into_iter().zip(kinds).take(if degree > 2 { 2 } else { 3 }) {
                let (field, u) = (Field { first: 0, components: 1 }, numbers(space.num_functions()));
                let of = space.clone();
                let sample = move |e: usize, xi: &[Vector<3>]| -> Vec<f64> {
                    field_at::<1, 3, f64, _>(&*of, &field, &u, e, xi).iter().map(|f| f.value[0]).collect()
                };
                let part = Part::new("solid", space.clone(), style).with_exact("u", 1, sample);
                let bytes = write(std::slice::from_ref(&part)).unwrap();
                let file = read(&bytes);
                file.check();
                assert_eq!((file.cells, file.arrays["connectivity"].1.len()), (space.num_elements(), local * space.num_elements()));
                // linear cells are written as such
                assert!(degree == 1 || file.arrays["types"].1.iter().all(|t| *t == kind));
                let Some(found) = by_vtk(&bytes, &POINTS) else { continue };
                for ((e, q), vtk) in found {
                    let xi = [cell_point(&*space, e, Vector::<3>::new(POINTS[q][0], POINTS[q][1], 0.0))];
                    let mut table = MapTable::new();
                    space.map(e, &xi, Order::Values, &mut table);
                    let u = (part.fields[0].sample)(e, &xi)[0];
                    assert!((0..3).all(|k| (vtk["x"][k] - table.x[0][k]).abs() < 1e-9), "{shapes:?}, {degree}, {style:?}: {:?}", vtk["x"]);
                    assert!((vtk["u"][0] - u).abs() < 1e-9, "{shapes:?}, {degree}, {style:?}: VTK {}, ours {u}", vtk["u"][0]);
                }
            }
        }
    }
}

#[test]
fn the_ring_becomes_rational_cells_and_a_plate_does_not() {
    let types = |space: &Arc<dyn Space<2, 2>>| read(&write(&[part("ring", space, CellStyle::Bezier)]).unwrap());
    let of = |name: &str| bodies().into_iter().find(|(n, _)| *n == name).unwrap().1;
    let ring = types(&of("ring, NURBS (2,2)"));
    assert!(ring.arrays["types"].1.iter().all(|t| *t == 77.0));
    assert_eq!(ring.arrays["HigherOrderDegrees"].1[..3], [2.0, 2.0, 0.0]);
    // weights of the quarter circle: cos 45 degrees in the middle of the whole arc, closer to one on its thirds
    let w = &ring.arrays["RationalWeights"].1;
    assert!(w.iter().any(|w| *w < 0.95));
    // degree 2 in both: the B-spline numerator times the weight function has degree 2 + 2 around, 3 + 1 across
    assert_eq!(types(&of("ring, B-splines (2,3)")).arrays["HigherOrderDegrees"].1[..3], [4.0, 4.0, 0.0]);
    let plate = types(&of("plate, B-splines (2,3)"));
    assert!(!plate.arrays.contains_key("RationalWeights"));
    assert_eq!(plate.arrays["HigherOrderDegrees"].1[..3], [2.0, 3.0, 0.0]);
}

#[test]
fn elements_that_are_neither_polynomial_nor_rational_become_lagrange_cells() {
    let spec = PatchSpec::new(ring()).with_degree([2, 2]).with_elements([3, 2]).with_cells(Cell::Simplex).with_mapping(Mapping::Exact);
    let triangles = Mesh::<1, 2>::from_patch(&spec).unwrap().space().clone();
    let file = read(&write(&[part("ring", &triangles, CellStyle::Bezier)]).unwrap());
    file.check();
    assert!(file.arrays["types"].1.contains(&69.0));

    let spec = PatchSpec::new(ring()).with_degree([9, 3]).with_elements([1, 1]).with_basis(BasisKind::BSpline);
    let high = Patch::<1, 2>::try_new(&spec).unwrap().space().clone();
    let file = read(&write(&[part("ring", &high, CellStyle::Bezier)]).unwrap());
    assert_eq!(file.arrays["types"].1, [70.0], "degree 9 + 2 passes what VTK evaluates ({MAX_DEGREE})");
}

#[test]
fn linear_cells_fill_the_elements() {
    let of = |name: &str| bodies().into_iter().filter(|(n, _)| *n == name).map(|(_, s)| s).collect::<Vec<_>>();
    for (name, kind, pieces) in [("quadrilaterals", 9.0, 9), ("triangles", 5.0, 9)] {
        let cubic = &of(name)[2];
        let file = read(&write(&[part(name, cubic, CellStyle::Linear)]).unwrap());
        file.check();
        assert!(file.arrays["types"].1.iter().all(|t| *t == kind));
        assert_eq!(file.cells, pieces * cubic.num_elements());
        assert!(!file.arrays.contains_key("HigherOrderDegrees"));
    }
}

#[test]
fn several_parts_number_patches_and_elements() {
    let all = bodies();
    let parts: Vec<_> = all[..3].iter().map(|(name, space)| part(name, space, CellStyle::Bezier)).collect();
    let file = read(&write(&parts).unwrap());
    file.check();
    let (patch, element) = (&file.arrays["patch"].1, &file.arrays["element"].1);
    assert_eq!(patch[..], [[0.0; 6], [1.0; 6], [2.0; 6]].concat()[..]);
    assert_eq!(element[..6], [0.0, 1.0, 2.0, 3.0, 4.0, 5.0]);
}

#[test]
fn parts_with_different_fields_are_refused() {
    let space = &bodies()[0].1;
    let other = Part::new("other", space.clone(), CellStyle::Bezier).with("u", 1, |_, xi| vec![0.0; xi.len()]);
    let error = write(&[part("ring", space, CellStyle::Bezier), other]).unwrap_err();
    assert!(error.to_string().starts_with("part \"other\" has the fields u:1, the first part displacement:2"), "{error}");
    let short = Part::new("short", space.clone(), CellStyle::Lagrange).with("u", 1, |_, _| vec![0.0]);
    assert!(write(&[short]).unwrap_err().to_string().contains("gave 1 numbers on element 0"));
}

#[test]
fn fields_given_together_make_the_same_file() {
    for style in [CellStyle::Bezier, CellStyle::Lagrange, CellStyle::Linear] {
        for (name, space) in &bodies() {
            let (u, s) = (displacement(space), stress(space));
            let together = part(name, space, style).with_together(move |e, xi| {
                let (u, s) = (u(e, xi), s(e, xi));
                let point = |k: usize| [&u[2 * k..2 * k + 2], &s[6 * k..6 * k + 6], &[1.0 + e as f64 + xi[k][0]]].concat();
                (0..xi.len()).flat_map(point).collect()
            });
            assert!(write(&[together]).unwrap() == write(&[part(name, space, style)]).unwrap(), "{name}, {style:?}");
        }
    }
    let short = part("short", &bodies()[0].1, CellStyle::Lagrange).with_together(|_, _| vec![0.0]);
    assert!(write(&[short]).unwrap_err().to_string().contains("gave 1 numbers on element 0"));
}

#[test]
fn files_are_the_same_bytes_for_any_number_of_threads() {
    let made = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let of = |style: CellStyle| bodies().iter().map(|(name, space)| write(&[part(name, space, style)]).unwrap()).collect::<Vec<_>>();
        pool.install(|| [CellStyle::Lagrange, CellStyle::Bezier, CellStyle::Linear].map(of))
    };
    assert!(made(1) == made(3));
}

#[test]
fn vtk_reads_the_curve_of_a_side_with_its_multiplier() {
    let patch = Patch::<1, 2>::try_new(&PatchSpec::new(ring()).with_degree([2, 2]).with_elements([3, 2])).unwrap();
    let trace = patch.trace("v0").unwrap();
    let side = Part { least_degree: 3, ..Part::new("arc", trace.space.clone(), CellStyle::Lagrange) }
        .with("lambda", 2, |e, xi: &[Vector<1>]| xi.iter().flat_map(|x| [e as f64 + x[0].powi(3), -1.0]).collect())
        .with("active", 1, |_, xi| vec![1.0; xi.len()]);
    let bytes = write(std::slice::from_ref(&side)).unwrap();
    let file = read(&bytes);
    file.check();
    assert_eq!(file.arrays["types"].1, [68.0; 3]);
    let Some(found) = by_vtk(&bytes, &[[0.4, 0.0]]) else { return };
    for e in 0..3 {
        let lambda = &found[&(e, 0)]["lambda"];
        assert!((lambda[0] - (e as f64 + 0.064)).abs() < 1e-12 && (lambda[1] + 1.0).abs() < 1e-12, "{lambda:?}");
        let r = found[&(e, 0)]["x"][0].hypot(found[&(e, 0)]["x"][1]);
        assert!((r - 1.0).abs() < 1e-3, "on the arc up to the cubic's own error");
    }
}

#[test]
fn pictures_are_svg_documents_of_fixed_bytes() {
    let all = bodies();
    let plot = plot::FieldPlot {
        title: "A ring & a <plate>",
        label: "von Mises",
        field: "von_mises",
        component: Some(0),
        range: None,
        length: "",
        moved: 0.0,
        marks: &[],
        obstacles: &[],
    };
    let parts = [part("ring", &all[1].1, CellStyle::Bezier), part("triangles", &all[9].1, CellStyle::Lagrange)];
    let svg = plot::fields(&plot, &parts).unwrap();
    assert_eq!(svg, plot::fields(&plot, &parts).unwrap());
    let mut reader = Reader::from_str(&svg);
    while !matches!(reader.read_event().expect("well-formed XML"), Event::Eof) {}
    assert!(svg.contains("<path fill=") && svg.contains("A ring &amp; a"));
    let none = plot::FieldPlot { field: "pressure", ..plot };
    assert!(plot::fields(&none, &parts).unwrap_err().to_string().contains("has no field \"pressure\""));

    let trace = Patch::<1, 2>::try_new(&PatchSpec::new(ring())).unwrap().trace("v0").unwrap();
    let side = Part::new("arc", trace.space.clone(), CellStyle::Lagrange)
        .with("lambda", 1, |_, xi: &[Vector<1>]| xi.iter().map(|x| -(1.0 - x[0]).sqrt()).collect());
    let rows = [
        InterfaceRow { s: Some(0.2), lambda: vec![-1.0], active: true, ..InterfaceRow::default() },
        InterfaceRow { s: Some(1.2), ..InterfaceRow::default() },
    ];
    let exact = |e: usize, xi: &[Vector<1>]| xi.iter().map(|x| -(e as f64) - x[0]).collect();
    let sides = [plot::SlaveCurve { label: "ring.v0", part: &side, rows: &rows, exact: Some(&exact) }];
    let svg = plot::side(&plot::SidePlot { title: "pad", contact: true, sides: &sides, units: ["", ""] }).unwrap();
    let mut reader = Reader::from_str(&svg);
    while !matches!(reader.read_event().expect("well-formed XML"), Event::Eof) {}
    assert!(svg.contains("active function (1 of 2)") && svg.contains("exact"));
}

/// Writes the pictures of this file's bodies to the folder named by FAYING_PICTURES, to look at.
#[test]
fn pictures_to_look_at_are_written_where_asked() {
    let Some(folder) = std::env::var_os("FAYING_PICTURES") else { return };
    let folder = std::path::Path::new(&folder);
    for (k, (name, space)) in bodies().iter().enumerate() {
        let plot = plot::FieldPlot {
            title: name,
            label: "stress.xx",
            field: "stress",
            component: Some(0),
            range: None,
            length: "",
            moved: 0.0,
            marks: &[],
            obstacles: &[],
        };
        std::fs::write(folder.join(format!("fields_{k}.svg")), plot::fields(&plot, &[part(name, space, CellStyle::Bezier)]).unwrap())
            .unwrap();
    }
    let half = shapes::disc_sector([0.0, 1.0], 1.0, [180.0, 360.0]).unwrap();
    let (upper, lower) =
        (PatchSpec::new(half).with_elements([12, 6]), PatchSpec::new(shapes::rectangle([-1.5, -1.0], [1.5, 0.0]).unwrap()));
    let upper = Patch::<1, 2>::try_new(&upper).unwrap();
    let lower = Mesh::<1, 2>::from_patch(&lower.with_elements([14, 6]).with_cells(Cell::Simplex)).unwrap();
    let peak = |space: &Arc<dyn Space<2, 2>>| {
        let space = space.clone();
        move |e: usize, xi: &[Vector<2>]| {
            let mut table = MapTable::new();
            space.map(e, xi, Order::Values, &mut table);
            table.x.iter().map(|x| 1e3 / (0.1 + x.norm_squared()).sqrt()).collect()
        }
    };
    let parts =
        [upper.space(), lower.space()].map(|space| Part::new("body", space.clone(), CellStyle::Bezier).with("von_mises", 1, peak(space)));
    let plot = plot::FieldPlot {
        title: "A half cylinder on a block",
        label: "von Mises stress",
        field: "von_mises",
        component: Some(0),
        range: None,
        length: "",
        moved: 0.0,
        marks: &[],
        obstacles: &[],
    };
    std::fs::write(folder.join("pair.svg"), plot::fields(&plot, &parts).unwrap()).unwrap();
    let trace = upper.trace("v1").unwrap();
    let space = trace.space.clone();
    let pressure = |x: &Vector<2>| -(0.09 - x[0] * x[0]).max(0.0).sqrt();
    let side = Part::new("arc", trace.space.clone(), CellStyle::Lagrange).with("lambda", 1, move |e, xi: &[Vector<1>]| {
        let mut table = MapTable::new();
        space.map(e, xi, Order::Values, &mut table);
        table.x.iter().map(|x| 0.97 * pressure(x)).collect()
    });
    let rows: Vec<_> = (0..24)
        .map(|i| InterfaceRow {
            s: Some(std::f64::consts::PI * (i as f64 + 0.5) / 24.0),
            active: (10..14).contains(&i),
            lambda: vec![0.0],
            ..InterfaceRow::default()
        })
        .collect();
    let exact = {
        let space = trace.space.clone();
        move |e: usize, xi: &[Vector<1>]| {
            let mut table = MapTable::new();
            space.map(e, xi, Order::Values, &mut table);
            table.x.iter().map(pressure).collect()
        }
    };
    let sides = [plot::SlaveCurve { label: "half.v0", part: &side, rows: &rows, exact: Some(&exact) }];
    let title = "A half cylinder on a block: pressure on pad";
    let picture = plot::SidePlot { title, contact: true, sides: &sides, units: ["", ""] };
    std::fs::write(folder.join("pressure.svg"), plot::side(&picture).unwrap()).unwrap();
    let tied = Part::new("arc", trace.space.clone(), CellStyle::Lagrange)
        .with("lambda", 2, |e, xi: &[Vector<1>]| xi.iter().flat_map(|x| [(e as f64 + x[0]).sin(), (e as f64 * 0.5).cos()]).collect());
    let tied = tied.with("normal", 2, |_, xi: &[Vector<1>]| xi.iter().flat_map(|_| [0.0, 1.0]).collect());
    let sides = [plot::SlaveCurve { label: "half.v0", part: &tied, rows: &rows, exact: None }];
    let picture = plot::SidePlot { title: "Multiplier", contact: false, sides: &sides, units: ["", ""] };
    std::fs::write(folder.join("tied.svg"), plot::side(&picture).unwrap()).unwrap();
}

/// Runs `case` in `folder` and returns its fields.vtu and its probes by name.
fn run(folder: &std::path::Path, case: &str, backend: &str) -> (Vec<u8>, BTreeMap<String, f64>) {
    std::fs::write(folder.join("case.toml"), case).unwrap();
    // Bezier cells are the patches themselves
    let words = ["run", "case.toml", "--backend", backend, "--vtu", "bezier", "--json"];
    let out = Command::new(env!("CARGO_BIN_EXE_faying")).current_dir(folder).args(words).output().unwrap();
    assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
    let result: serde_json::Value = serde_json::from_slice(&out.stdout).unwrap();
    let probes = result["probes"].as_array().unwrap().iter();
    let value = |p: &serde_json::Value| (p["name"].as_str().unwrap().to_owned(), p["value"].as_f64().unwrap());
    (std::fs::read(folder.join("case.out/fields.vtu")).unwrap(), probes.map(value).collect())
}

#[test]
fn vtk_finds_in_the_file_of_a_run_what_its_quantities_say() {
    let sample = |name: &str| {
        std::fs::read_to_string(format!("{}/examples/cases/{name}.toml", concat!(env!("CARGO_MANIFEST_DIR"), "/../.."))).unwrap()
    };
    let folder = tempfile::tempdir().unwrap();
    // stress in the patch test alone: elsewhere it is a quotient that the cells interpolate
    for (name, patches, stress) in [("contact-patch", ["lower", "upper"], true), ("iga-fe-arc", ["inner", "outer"], false)] {
        for backend in ["iga", "fe"] {
            let case = sample(name);
            let case = case.split("[[check]]").next().unwrap(); // probes are enough
            let (bytes, _) = run(folder.path(), case, backend);
            let file = read(&bytes);
            file.check();
            let Some(found) = by_vtk(&bytes, &POINTS[..3]) else { return };
            let mut asked = case.to_owned();
            for ((cell, q), vtk) in found.iter().filter(|((cell, _), _)| cell % 3 == 0) {
                let patch = patches[file.arrays["patch"].1[*cell] as usize];
                for quantity in ["u.x", "u.y", "stress.yy"] {
                    let at = format!("{quantity} at [{:?}, {:?}] in {patch}", vtk["x"][0], vtk["x"][1]);
                    let probe = quantity.replace('.', "-");
                    asked += &format!("\n[[probe]]\nname = \"{probe}-{cell}-{q}\"\nquantity = \"{at}\"\n");
                }
            }
            let (_, probes) = run(folder.path(), &asked, backend);
            for ((cell, q), vtk) in found.iter().filter(|((cell, _), _)| cell % 3 == 0) {
                let u = &vtk["displacement"];
                let mut pairs = vec![("u-x", u[0]), ("u-y", u[1])];
                if stress {
                    pairs.push(("stress-yy", vtk["stress"][1]));
                }
                for (what, by_vtk) in pairs {
                    let ours = probes[&format!("{what}-{cell}-{q}")];
                    assert!((ours - by_vtk).abs() < 1e-9, "{name} ({backend}): {what} in cell {cell}: VTK {by_vtk}, ours {ours}");
                }
            }
        }
    }
}

/// What VTK's own maps measure: per cell its signed size and its least Jacobian determinant.
fn measured_by_vtk(bytes: &[u8]) -> Option<Vec<[f64; 2]>> {
    let Some(python) = python() else {
        eprintln!("skipped: no python3 with VTK here (Debian: apt-get install python3-vtk9)");
        return None;
    };
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("grid.vtu");
    std::fs::write(&file, bytes).unwrap();
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/program/vtk/measure.py");
    let out = Command::new(python).arg(script).arg(&file).output().unwrap();
    assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
    let number = |word: Option<&str>| word.unwrap().parse::<f64>().unwrap();
    let line = |line: &str| {
        let mut words = line.split(' ').skip(1);
        [number(words.next()), number(words.next())]
    };
    Some(String::from_utf8(out.stdout).unwrap().lines().map(line).collect())
}

/// No cell is negative, and all together are `expected` up to `tolerance`.
fn positive(what: &str, bytes: &[u8], expected: Option<f64>, tolerance: f64) {
    let Some(cells) = measured_by_vtk(bytes) else { return };
    let total: f64 = cells.iter().map(|c| c[0]).sum();
    assert!(!cells.is_empty() && cells.iter().all(|c| c[0] > 0.0 && c[1] > -1e-12 * c[0]), "{what}: {cells:?}");
    if let Some(expected) = expected {
        assert!((total - expected).abs() <= tolerance * expected, "{what}: VTK measures {total:?}, we {expected:?}");
    }
}

#[test]
fn no_cell_is_inside_out_and_vtk_measures_what_we_do() {
    for (name, space) in bodies() {
        let ours = faying::space::measure::<2, 2, f64, _>(&*space);
        let whole = |style| write(&[Part::new(name, space.clone(), style)]).unwrap();
        // Bezier cells are the map of the element, Lagrange cells where that is polynomial
        positive(name, &whole(CellStyle::Bezier), Some(ours), 1e-9);
        let polynomial = !name.contains("NURBS") && !name.starts_with("ring");
        positive(name, &whole(CellStyle::Lagrange), polynomial.then_some(ours), if space.degree(0) == [1, 1] { 1e-12 } else { 1e-9 });
        positive(name, &whole(CellStyle::Linear), None, 0.0);
    }
}

#[test]
fn solids_of_left_handed_patches_have_their_volume_in_every_style() {
    let sample = std::fs::read_to_string(concat!(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."), "/examples/cases/solid.toml")).unwrap();
    let sample = sample.split("[[check]]").next().unwrap();
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("case.toml"), sample).unwrap();
    let faying = |words: &[&str]| {
        let out = Command::new(env!("CARGO_BIN_EXE_faying")).current_dir(folder.path()).args(words).arg("--json").output().unwrap();
        assert!(out.status.success(), "{words:?}: {}", String::from_utf8_lossy(&out.stderr));
        serde_json::from_slice::<serde_json::Value>(&out.stdout).unwrap()
    };
    for backend in ["iga", "fe"] {
        let mut measures = Vec::new();
        for style in ["lagrange", "bezier", "linear"] {
            let result = faying(&["run", "case.toml", "--backend", backend, "--vtu", style, "--force"]);
            let exact: f64 = result["geometry"]["measure"].as_object().unwrap().values().map(|v| v.as_f64().unwrap()).sum();
            let bytes = std::fs::read(folder.path().join("case.out/fields.vtu")).unwrap();
            read(&bytes).check();
            // what `inspect` finds in the file is the measure of the map that was written
            let seen = faying(&["inspect", "case.out/fields.vtu"]);
            let written = if style == "bezier" { Some(exact) } else { seen["measure"].as_f64() };
            positive(&format!("solid, {backend}, {style}"), &bytes, written, 1e-9);
            measures.push((exact, written.unwrap()));
        }
        assert!(measures.iter().all(|(exact, written)| (written / exact - 1.0).abs() < 0.1), "{measures:?}");
    }
}

#[test]
fn points_are_shared_where_all_data_are_continuous() {
    use cells::{Shapes, bent, boxes};
    let plain =
        |space: &Arc<dyn Space<2, 2>>, style| Part::new("body", space.clone(), style).with_exact("displacement", 2, displacement(space));
    for (name, space) in bodies() {
        for style in [CellStyle::Lagrange, CellStyle::Bezier, CellStyle::Linear] {
            let file = read(&write(&[plain(&space, style)]).unwrap());
            file.check();
            let [p, q] = [0, 1].map(|k| file.arrays.get("HigherOrderDegrees").map_or(0, |d| d.1[k] as usize));
            let simplex = space.cell(0) == Cell::Simplex;
            if style != CellStyle::Linear && !simplex {
                // 3 x 2 elements; some patches halve them at their own knots
                let n = space.num_elements() / 2;
                let counts = [(n * p + 1) * (2 * q + 1), (n * q + 1) * (2 * p + 1)];
                assert!(counts.contains(&file.points), "{name} ({style:?}): {} points, not {counts:?}", file.points);
            }
            // a field that jumps between elements keeps every element's own points
            let jumps = plain(&space, style).with("own", 1, |e, xi| vec![e as f64; xi.len()]);
            let apart = read(&write(&[jumps]).unwrap());
            let nodes: usize = if style == CellStyle::Linear { continue } else { file.arrays["connectivity"].1.len() };
            assert_eq!(apart.points, nodes, "{name} ({style:?})");
        }
    }
    // triangles and quadrilaterals, tetrahedra, hexahedra: as many points as places
    for degree in 1..=4 {
        let mixed = Mesh::<1, 2>::from_cells(&boxes([3, 2], Shapes::Mixed, degree, Some(2), &bent), degree, Mapping::Isoparametric);
        let space = mixed.unwrap().space().clone();
        let file = read(&write(&[plain(&space, CellStyle::Lagrange)]).unwrap());
        assert_eq!(file.points, (3 * degree + 1) * (2 * degree + 1), "degree {degree}");
        for shapes in [Shapes::Tensor, Shapes::Simplex] {
            let solid = boxes([2, 1, 1], shapes, degree, Some(2), &bent);
            let space = Mesh::<2, 3>::from_cells(&solid, degree, Mapping::Isoparametric).unwrap().space().clone();
            let file = read(&write(&[Part::new("solid", space, CellStyle::Lagrange)]).unwrap());
            assert_eq!(file.points, (2 * degree + 1) * (degree + 1) * (degree + 1), "{shapes:?}, degree {degree}");
        }
    }
}

/// A run of scalar unknowns writes one point per node, whatever the backend, and Lagrange cells.
#[test]
fn runs_write_lagrange_cells_with_shared_points_by_default() {
    let case = "[model]\nphysics = \"poisson\"\ndimension = 2\nsource = \"1\"\n[discretization]\ndegree = 1\n[[patch]]\nname = \"a\"\n\
                geometry = { kind = \"box\", min = [0, 0], max = [1, 1] }\nelements = [40, 40]\n[[boundary]]\non = \"all-outer\"\ndirichlet = \"0\"\n";
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("case.toml"), case).unwrap();
    for backend in ["iga", "fe"] {
        let words = ["run", "case.toml", "--backend", backend, "--force"];
        let out = Command::new(env!("CARGO_BIN_EXE_faying")).current_dir(folder.path()).args(words).output().unwrap();
        assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
        let bytes = std::fs::read(folder.path().join("case.out/fields.vtu")).unwrap();
        let file = read(&bytes);
        file.check();
        assert_eq!((file.points, file.cells), (41 * 41, 1600));
        assert!(file.arrays["types"].1.iter().all(|t| *t == 70.0), "{backend}");
        // 1681 points of four numbers and 1600 cells of nine: 170 kB as they are
        assert!(bytes.len() < 90_000, "{} bytes", bytes.len());
    }
}

/// Elements are handed over in portions; their order and their fields do not show it.
#[test]
fn elements_of_large_grids_keep_their_order() {
    let spec = PatchSpec::new(shapes::rectangle([0.0, 0.0], [1.0, 1.0]).unwrap()).with_elements([130, 70]);
    let space: Arc<dyn Space<2, 2>> = Patch::<1, 2>::try_new(&spec).unwrap().space().clone();
    for style in [CellStyle::Bezier, CellStyle::Lagrange] {
        let own = |name: &str| Part::new(name, space.clone(), style).with("own", 1, |e, xi| vec![e as f64; xi.len()]);
        let file = read(&write(&[own("a"), own("b")]).unwrap());
        let elements = 130 * 70;
        assert_eq!(file.cells, 2 * elements);
        let (nodes, ends) = (&file.arrays["connectivity"].1, &file.arrays["offsets"].1);
        let mut first = 0;
        for (cell, &end) in ends.iter().enumerate() {
            let number = (cell % elements) as f64;
            assert_eq!((file.arrays["patch"].1[cell], file.arrays["element"].1[cell]), ((cell / elements) as f64, number));
            let same = |&node: &f64| (file.arrays["own"].1[node as usize] - number).abs() < 1e-9;
            assert!(end as usize > first && nodes[first..end as usize].iter().all(same), "cell {cell}");
            first = end as usize;
        }
    }
}
