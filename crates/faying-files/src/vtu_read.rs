//! Reader of VTK unstructured grids (`.vtu`): points, cells, fields.
//!
//! Arrays as text, in base64 inside the document, or appended raw or in base64, uncompressed or compressed by zlib, LZ4 or LZMA; either
//! byte order. What stands inside an array beside its text, such as the keys of information that VTK adds, is skipped.
//! Source: "VTK XML Formats", vtk.org; the conventions of this program's own writer are in [`crate::vtu`].

use super::budget::Budget;
use super::vtu_array::{Array, Layout, attribute};
use super::vtu_bytes::Compression;
use super::{FileError, Limits, Spot, vtu};
use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};
use std::borrow::Cow;

/// Most fields of a file.
const MAX_FIELDS: usize = 4096;

/// Values at points or in cells.
#[derive(Clone, Debug, PartialEq)]
pub struct VtuField {
    /// Its name.
    pub name: String,
    /// Numbers per point or cell.
    pub components: usize,
    /// The values, point after point.
    pub values: Vec<f64>,
}

impl VtuField {
    /// Least and largest finite value of every component; `None` if a component has no finite value.
    pub fn ranges(&self) -> Vec<Option<[f64; 2]>> {
        let mut ranges: Vec<Option<[f64; 2]>> = vec![None; self.components];
        for point in self.values.chunks_exact(self.components.max(1)) {
            for (range, v) in ranges.iter_mut().zip(point).filter(|(_, v)| v.is_finite()) {
                let [low, high] = range.unwrap_or([*v; 2]);
                *range = Some([low.min(*v), high.max(*v)]);
            }
        }
        ranges
    }
}

/// An unstructured grid.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct VtuFile {
    /// Version of the format, as major * 100 + minor.
    pub version: u32,
    /// Points.
    pub points: Vec<[f64; 3]>,
    /// Points of all cells, cell after cell.
    pub connectivity: Vec<u32>,
    /// End of each cell in `connectivity`.
    pub ends: Vec<usize>,
    /// VTK's number of each cell's type.
    pub types: Vec<u8>,
    /// Fields at points, the weights of rational cells among them.
    pub point_fields: Vec<VtuField>,
    /// Fields of cells, the degrees of high-order cells among them.
    pub cell_fields: Vec<VtuField>,
    /// Numbers and names of the patches, where this program wrote the file: the field `patch` has the number in each cell.
    pub patches: Vec<(i64, String)>,
}

impl VtuFile {
    /// Points of a cell.
    pub fn cell(&self, k: usize) -> &[u32] {
        let first = if k == 0 { 0 } else { self.ends[k - 1] };
        &self.connectivity[first..self.ends[k]]
    }

    /// Types of cells with their names and how many there are, by number.
    pub fn cell_types(&self) -> Vec<(u8, &'static str, usize)> {
        let mut counts = [0; 256];
        self.types.iter().for_each(|t| counts[usize::from(*t)] += 1);
        (0..=255u8).filter(|t| counts[usize::from(*t)] > 0).map(|t| (t, type_name(t), counts[usize::from(t)])).collect()
    }
}

/// Name of a type of cells.
pub fn type_name(number: u8) -> &'static str {
    match number {
        1 => "vertex",
        3 => "line",
        5 => "triangle",
        8 => "pixel",
        9 => "quadrilateral",
        10 => "tetrahedron",
        11 => "voxel",
        12 => "hexahedron",
        13 => "wedge",
        14 => "pyramid",
        21 => "quadratic line",
        22 => "quadratic triangle",
        23 => "8-node quadrilateral",
        24 => "quadratic tetrahedron",
        25 => "20-node hexahedron",
        28 => "biquadratic quadrilateral",
        29 => "triquadratic hexahedron",
        68 => "Lagrange curve",
        69 => "Lagrange triangle",
        70 => "Lagrange quadrilateral",
        71 => "Lagrange tetrahedron",
        72 => "Lagrange hexahedron",
        73 => "Lagrange wedge",
        75 => "Bezier curve",
        76 => "Bezier triangle",
        77 => "Bezier quadrilateral",
        78 => "Bezier tetrahedron",
        79 => "Bezier hexahedron",
        80 => "Bezier wedge",
        _ => "other",
    }
}

/// Whether the bytes look like a VTK XML file.
pub fn recognises(bytes: &[u8]) -> bool {
    bytes.trim_ascii_start().starts_with(b"<") && bytes[..bytes.len().min(1 << 12)].windows(8).any(|w| w == b"<VTKFile")
}

/// Reads an unstructured grid.
///
/// # Errors
/// [`FileError::Unsupported`] for other compressions and other kinds of grids; [`FileError::Broken`] with the byte; [`FileError::Memory`].
pub fn parse(bytes: &[u8], limits: &Limits) -> Result<VtuFile, FileError> {
    let (xml, appended) = appended(bytes)?;
    let mut state =
        State { file: VtuFile::default(), appended, layout: Layout::default(), budget: Budget::new(limits, bytes.len()), piece: None };
    let mut reader = Reader::from_reader(xml);
    let mut path: Vec<Vec<u8>> = Vec::new();
    let mut open: Option<Open<'_>> = None;
    loop {
        let at = reader.buffer_position() as usize;
        let spot = Some(Spot::Byte(at));
        let event = reader.read_event().map_err(|e| FileError::Broken { what: format!("XML: {e}"), spot })?;
        if let Some(array) = &mut open {
            match event {
                Event::Start(_) => array.inside += 1,
                Event::End(_) if array.inside > 0 => array.inside -= 1,
                Event::End(_) => {
                    if let Some(Open { array, text, .. }) = open.take() {
                        state.store(&path, array, &text)?;
                    }
                }
                Event::Text(text) if array.inside == 0 && text.iter().any(|b| !b.is_ascii_whitespace()) => {
                    if !array.text.is_empty() {
                        return Err(FileError::Broken { what: "the text of an array stands in two parts".into(), spot });
                    }
                    array.text = text.into_inner();
                }
                Event::Eof => return Err(FileError::Broken { what: "the file ends inside an array".into(), spot }),
                _ => {}
            }
            continue;
        }
        match event {
            Event::Start(tag) if tag.name().as_ref() == b"DataArray" => {
                open = Some(Open { array: state.array(&tag, at)?, text: Cow::Borrowed(b""), inside: 0 });
            }
            Event::Empty(tag) if tag.name().as_ref() == b"DataArray" => {
                let array = state.array(&tag, at)?;
                state.store(&path, array, b"")?;
            }
            Event::Empty(tag) if tag.name().as_ref() == b"VTKFile" => {
                // wrong kinds are reported first
                state.start(&tag, at)?;
                return Err(FileError::Broken { what: "the VTKFile element is empty".into(), spot });
            }
            Event::Start(tag) => {
                state.start(&tag, at)?;
                if path.len() >= 16 {
                    return Err(FileError::Broken { what: "XML elements stand more than 16 deep".into(), spot });
                }
                path.push(tag.name().as_ref()[..tag.name().as_ref().len().min(64)].to_vec());
            }
            Event::End(tag) => {
                if tag.name().as_ref() == b"Piece" {
                    state.end_piece(at)?;
                }
                path.pop();
            }
            Event::Eof => break,
            _ => {}
        }
    }
    if !state.layout.known {
        return Err(FileError::Broken { what: "the file has no VTKFile element".into(), spot: Some(Spot::Byte(0)) });
    }
    if state.piece.is_some() {
        return Err(FileError::Broken { what: "the file ends inside a Piece".into(), spot: Some(Spot::Byte(bytes.len())) });
    }
    Ok(state.file)
}

/// Splits the bytes into the document before the appended data, and these with their encoding (true: base64).
fn appended(bytes: &[u8]) -> Result<(&[u8], Option<(&[u8], bool)>), FileError> {
    let mark = b"<AppendedData";
    let Some(at) = bytes.windows(mark.len()).position(|w| w == mark) else { return Ok((bytes, None)) };
    let broken = || FileError::Broken { what: "AppendedData without `_` before the data".into(), spot: Some(Spot::Byte(at)) };
    let end = at + bytes[at..].iter().position(|b| *b == b'>').ok_or_else(broken)?;
    let head = &bytes[at..end];
    let base64 = head.windows(6).any(|w| w == b"base64");
    let underscore = end + bytes[end..].iter().position(|b| *b == b'_').ok_or_else(broken)?;
    Ok((&bytes[..at], Some((&bytes[underscore + 1..], base64))))
}

/// An array whose end was not met yet.
struct Open<'a> {
    array: Array,
    text: Cow<'a, [u8]>,
    /// Elements inside that are open.
    inside: usize,
}

/// Adds the values of an array to the field of its name.
fn add_field(fields: &mut Vec<VtuField>, array: Array, values: Vec<f64>, budget: &mut Budget) -> Result<(), FileError> {
    let broken = |what: String| Err(FileError::Broken { what, spot: Some(Spot::Byte(array.at)) });
    let full = fields.len() >= MAX_FIELDS;
    match fields.iter_mut().find(|f| f.name == array.name) {
        Some(field) if field.components == array.components => {
            budget.room(&mut field.values, values.len())?;
            field.values.extend(values);
        }
        Some(_) => return broken(format!("array \"{}\" changes its number of components", array.name)),
        None if full => return broken(format!("more than {MAX_FIELDS} arrays")),
        None => fields.push(VtuField { name: array.name, components: array.components, values }),
    }
    Ok(())
}

/// A piece being read.
#[derive(Debug, Default)]
struct Piece {
    points: u64,
    cells: u64,
    first_point: usize,
    first_end: usize,
    first_cell: usize,
    first_id: usize,
}

struct State<'a> {
    file: VtuFile,
    appended: Option<(&'a [u8], bool)>,
    layout: Layout,
    budget: Budget,
    piece: Option<Piece>,
}

impl State<'_> {
    fn start(&mut self, tag: &BytesStart<'_>, at: usize) -> Result<(), FileError> {
        let spot = Some(Spot::Byte(at));
        let unsupported = |what: String| Err(FileError::Unsupported { what, spot });
        match tag.name().as_ref() {
            b"VTKFile" => {
                let kind = attribute(tag, "type").unwrap_or_default();
                if kind != "UnstructuredGrid" {
                    return unsupported(format!("a VTK file of type {}", kind.chars().take(24).collect::<String>()));
                }
                let compressor = attribute(tag, "compressor").filter(|c| !c.is_empty());
                let compression = compressor.as_ref().and_then(|c| Compression::of_name(c));
                if let Some(other) = compressor.filter(|_| compression.is_none()) {
                    let other = other.chars().take(32).collect::<String>();
                    return unsupported(format!("a VTU file compressed by {other} (zlib, LZ4, LZMA and no compression are read)"));
                }
                let version = attribute(tag, "version").unwrap_or_default();
                let mut parts = version.split('.').map(|p| p.parse::<u8>().unwrap_or(0));
                self.file.version = 100 * u32::from(parts.next().unwrap_or(0)) + u32::from(parts.next().unwrap_or(0));
                self.layout = Layout {
                    known: true,
                    big_endian: attribute(tag, "byte_order").is_some_and(|o| o == "BigEndian"),
                    wide: attribute(tag, "header_type").is_some_and(|h| h == "UInt64"),
                    compression,
                };
            }
            b"Piece" => {
                let count = |name: &str| attribute(tag, name).and_then(|v| v.parse().ok());
                let (Some(points), Some(cells)) = (count("NumberOfPoints"), count("NumberOfCells")) else {
                    return Err(FileError::Broken { what: "a Piece without its numbers of points and cells".into(), spot });
                };
                let (f, ends) = (&self.file, self.file.ends.len());
                let piece = Piece {
                    points,
                    cells,
                    first_point: f.points.len(),
                    first_end: ends,
                    first_cell: f.types.len(),
                    first_id: f.connectivity.len(),
                };
                if self.piece.replace(piece).is_some() {
                    return Err(FileError::Broken { what: "a Piece inside a Piece".into(), spot });
                }
            }
            _ => {}
        }
        Ok(())
    }

    fn array(&mut self, tag: &BytesStart<'_>, at: usize) -> Result<Array, FileError> {
        self.budget.take(256 + tag.len() as u64)?;
        Array::new(tag, at)
    }

    fn store(&mut self, path: &[Vec<u8>], array: Array, text: &[u8]) -> Result<(), FileError> {
        let place = path.last().map_or(&b""[..], |p| p);
        if let Some(name) = array.name.strip_prefix(vtu::PATCH).filter(|_| place == b"FieldData") {
            let number = array.values(&self.layout, self.appended, text, &mut self.budget)?;
            if let Some(number) = number.first().filter(|_| self.file.patches.len() < MAX_FIELDS) {
                self.file.patches.push((*number as i64, name.to_owned()));
            }
            return Ok(());
        }
        let wanted = matches!((place, array.name.as_str()), (b"Cells", "connectivity" | "offsets" | "types"))
            || matches!(place, b"Points" | b"PointData" | b"CellData");
        if !wanted {
            return Ok(());
        }
        let spot = Some(Spot::Byte(array.at));
        let broken = |what: String| FileError::Broken { what, spot };
        let values = array.values(&self.layout, self.appended, text, &mut self.budget)?;
        let Some(piece) = &self.piece else { return Err(broken("an array outside a Piece".into())) };
        let (points, cells) = (piece.points, piece.cells);
        let first_point = piece.first_point;
        let expect = |count: u64| {
            if values.len() as u64 == count.saturating_mul(array.components as u64) {
                return Ok(());
            }
            let (name, components) = (&array.name, array.components);
            Err(broken(format!("array \"{name}\" holds {} numbers, not {count} times {components}", values.len())))
        };
        let whole = |v: f64, below: u64| if v >= 0.0 && v.fract() == 0.0 && v < below as f64 { Some(v as u64) } else { None };
        let file = &mut self.file;
        match (place, array.name.as_str()) {
            (b"Points", _) => {
                expect(points)?;
                if array.components != 3 {
                    return Err(broken("points do not have 3 coordinates".into()));
                }
                if file.points.len() != first_point || values.iter().any(|v| !v.is_finite()) {
                    return Err(broken("the points of a piece stand twice, or one is not finite".into()));
                }
                self.budget.room(&mut file.points, values.len() / 3)?;
                file.points.extend(values.as_chunks::<3>().0);
            }
            (b"Cells", "connectivity") => {
                self.budget.room(&mut file.connectivity, values.len())?;
                for v in &values {
                    let Some(id) = whole(*v, points.min(u64::from(u32::MAX) - first_point as u64)) else {
                        return Err(broken(format!("a cell refers to point {v} of {points}")));
                    };
                    file.connectivity.push(first_point as u32 + id as u32);
                }
            }
            (b"Cells", "offsets") => {
                expect(cells)?;
                self.budget.room(&mut file.ends, values.len())?;
                for v in &values {
                    let Some(end) = whole(*v, u64::from(u32::MAX)) else { return Err(broken(format!("a cell ends at {v}"))) };
                    file.ends.push(piece.first_id + end as usize);
                }
            }
            (b"Cells", _) => {
                expect(cells)?;
                self.budget.room(&mut file.types, values.len())?;
                for v in &values {
                    let Some(kind) = whole(*v, 256) else { return Err(broken(format!("a cell has the type {v}"))) };
                    file.types.push(kind as u8);
                }
            }
            _ => {
                let at_points = place == b"PointData";
                expect(if at_points { points } else { cells })?;
                let fields = if at_points { &mut file.point_fields } else { &mut file.cell_fields };
                return add_field(fields, array, values, &mut self.budget);
            }
        }
        self.budget.give(8 * values.capacity() as u64);
        Ok(())
    }

    /// Checks that counts and offsets of a piece agree.
    fn end_piece(&mut self, at: usize) -> Result<(), FileError> {
        let Some(piece) = self.piece.take() else { return Ok(()) };
        let broken = |what: &str| Err(FileError::Broken { what: what.into(), spot: Some(Spot::Byte(at)) });
        let f = &self.file;
        let ends = &f.ends[piece.first_end..];
        if (f.points.len() - piece.first_point) as u64 != piece.points {
            return broken("a Piece does not have as many points as it declares");
        }
        if ends.len() as u64 != piece.cells || (f.types.len() - piece.first_cell) as u64 != piece.cells {
            return broken("a Piece does not have as many cells as it declares");
        }
        let rising = ends.iter().scan(piece.first_id, |last, e| Some(*e >= std::mem::replace(last, *e))).all(|ok| ok);
        if !rising || ends.last().copied().unwrap_or(piece.first_id) != f.connectivity.len() {
            return broken("the offsets of the cells do not fit their points");
        }
        Ok(())
    }
}
