//! The arrays of all pieces, and the XML document that holds them.

use super::PATCH;
use super::piece::{AHEAD, Piece};
use super::points::Points;
use flate2::{Compress, Compression, FlushCompress};
use quick_xml::Writer;
use quick_xml::events::{BytesEnd, BytesStart, Event};
use rayon::prelude::*;

/// A field of a file.
pub(super) struct Kept {
    pub name: String,
    pub components: usize,
    /// Whether points have means over the elements around; its values in the middle of elements are kept, too.
    pub averaged: bool,
}

/// The arrays of a file.
pub(super) struct Grid {
    kept: Vec<Kept>,
    /// Names of the parts.
    parts: Vec<String>,
    points: Points,
    rational: bool,
    connectivity: Vec<i64>,
    offsets: Vec<i64>,
    types: Vec<u8>,
    degrees: Vec<f64>,
    patch: Vec<i32>,
    element: Vec<i32>,
    /// Per field the values in cells; empty where it is not averaged.
    middles: Vec<Vec<f64>>,
    /// Points of the current element.
    ids: Vec<usize>,
}

impl Grid {
    /// Creates a grid with the given point fields.
    pub fn new(kept: Vec<Kept>) -> Self {
        let (connectivity, offsets, types, degrees) = Default::default();
        Self {
            points: Points::new(&kept),
            parts: Vec::new(),
            rational: false,
            connectivity,
            offsets,
            types,
            degrees,
            patch: Vec::new(),
            element: Vec::new(),
            middles: vec![Vec::new(); kept.len()],
            kept,
            ids: Vec::new(),
        }
    }

    /// Begins a part of the given number of elements.
    pub fn begin(&mut self, name: &str, elements: usize) {
        self.parts.push(name.to_owned());
        self.points.begin(elements);
    }

    pub fn append(&mut self, part: usize, element: usize, piece: &Piece<'_>) {
        self.points.of(piece, &mut self.ids);
        self.rational |= piece.rational;
        for cell in piece.cells.iter() {
            self.connectivity.extend(cell.iter().map(|i| self.ids[*i] as i64));
            self.offsets.push(self.connectivity.len() as i64);
            self.types.push(piece.kind);
            self.degrees.extend(piece.degrees);
            self.patch.push(i32::try_from(part).unwrap_or(i32::MAX));
            self.element.push(i32::try_from(element).unwrap_or(i32::MAX));
            let mut first = AHEAD;
            for (field, values) in self.kept.iter().zip(&mut self.middles) {
                if field.averaged {
                    values.extend_from_slice(&piece.middle[first..first + field.components]);
                }
                first += field.components;
            }
        }
    }

    /// Writes the document; every array is dropped as soon as it is in it.
    pub fn into_bytes(mut self) -> Vec<u8> {
        let hexahedra = self.types.iter().any(|t| [72, 79].contains(t));
        let high_order = self.types.iter().any(|t| *t >= 68);
        let mut file = File::new(hexahedra);
        file.start("UnstructuredGrid", &[]);
        file.start("FieldData", &[]);
        for (name, number) in self.parts.iter().zip(0i32..) {
            file.array_with("Int32", &format!("{PATCH}{name}"), 1, &[("NumberOfTuples", "1")], std::iter::once(number.to_le_bytes()));
        }
        file.end("FieldData");
        let (points, cells) = (self.points.x.len().to_string(), self.types.len().to_string());
        file.start("Piece", &[("NumberOfPoints", &points), ("NumberOfCells", &cells)]);
        // the attribute, not the array alone, makes readers use the weights
        file.start("PointData", if self.rational { &[("RationalWeights", "RationalWeights")] } else { &[] });
        self.points.average();
        for (field, values) in self.kept.iter().zip(std::mem::take(&mut self.points.fields)) {
            file.field(field, values);
        }
        let weights = std::mem::take(&mut self.points.weights);
        if self.rational {
            file.array("Float64", "RationalWeights", 1, weights.iter().map(|v| v.to_le_bytes()));
        }
        drop(weights);
        file.end("PointData");
        file.start("CellData", if high_order { &[("HigherOrderDegrees", "HigherOrderDegrees")] } else { &[] });
        if high_order {
            file.array("Float64", "HigherOrderDegrees", 3, self.degrees.into_iter().map(f64::to_le_bytes));
        }
        for (field, values) in self.kept.iter().zip(self.middles).filter(|f| f.0.averaged) {
            file.field(field, values);
        }
        file.array("Int32", "patch", 1, self.patch.into_iter().map(i32::to_le_bytes));
        file.array("Int32", "element", 1, self.element.into_iter().map(i32::to_le_bytes));
        file.end("CellData");
        file.start("Points", &[]);
        file.array("Float64", "Points", 3, self.points.x.into_iter().flatten().map(f64::to_le_bytes));
        file.end("Points");
        file.start("Cells", &[]);
        file.array("Int64", "connectivity", 1, self.connectivity.into_iter().map(i64::to_le_bytes));
        file.array("Int64", "offsets", 1, self.offsets.into_iter().map(i64::to_le_bytes));
        file.array("UInt8", "types", 1, self.types.into_iter().map(u8::to_le_bytes));
        file.end("Cells");
        file.end("Piece");
        file.end("UnstructuredGrid");
        file.finish()
    }
}

/// Bytes of a compressed block.
const BLOCK: usize = 1 << 17;

/// Blocks compressed in parallel.
const AT_ONCE: usize = 32;

/// Level of the compression: level 3 takes three times as long for a tenth less.
const LEVEL: u32 = 1;

/// An XML document with compressed data appended.
pub(crate) struct File {
    xml: Writer<Vec<u8>>,
    appended: Vec<u8>,
}

impl File {
    /// An unstructured grid. `hexahedra`: readers take high-order hexahedra of older versions in another order.
    pub fn new(hexahedra: bool) -> Self {
        let mut file = Self { xml: Writer::new_with_indent(Vec::new(), b' ', 2), appended: Vec::new() };
        let attributes = [
            ("type", "UnstructuredGrid"),
            ("version", if hexahedra { "2.2" } else { "1.0" }),
            ("byte_order", "LittleEndian"),
            ("header_type", "UInt64"),
            ("compressor", "vtkZLibDataCompressor"),
        ];
        file.start("VTKFile", &attributes);
        file
    }

    fn event(&mut self, event: Event<'_>) {
        self.xml.write_event(event).expect("a Vec takes every byte");
    }

    pub fn start(&mut self, tag: &str, attributes: &[(&str, &str)]) {
        self.event(Event::Start(BytesStart::new(tag).with_attributes(attributes.iter().copied())));
    }

    pub fn end(&mut self, tag: &str) {
        self.event(Event::End(BytesEnd::new(tag)));
    }

    /// A field, with names of the components of vectors and of symmetric tensors.
    fn field(&mut self, field: &Kept, values: Vec<f64>) {
        let components: &[(&str, &str)] = match field.components {
            3 => &[("ComponentName0", "x"), ("ComponentName1", "y"), ("ComponentName2", "z")],
            6 => &[
                ("ComponentName0", "xx"),
                ("ComponentName1", "yy"),
                ("ComponentName2", "zz"),
                ("ComponentName3", "xy"),
                ("ComponentName4", "yz"),
                ("ComponentName5", "xz"),
            ],
            _ => &[],
        };
        self.array_with("Float64", &field.name, field.components, components, values.into_iter().map(f64::to_le_bytes));
    }

    /// An array of numbers, each as its 1, 2, 4 or 8 bytes.
    pub fn array<const B: usize>(&mut self, kind: &str, name: &str, components: usize, numbers: impl Iterator<Item = [u8; B]>) {
        self.array_with(kind, name, components, &[], numbers);
    }

    /// An array with more attributes.
    fn array_with<const B: usize>(
        &mut self,
        kind: &str,
        name: &str,
        components: usize,
        more: &[(&str, &str)],
        numbers: impl Iterator<Item = [u8; B]>,
    ) {
        let (components, offset) = (components.to_string(), self.appended.len().to_string());
        let attributes = [
            ("type", kind),
            ("Name", name),
            ("NumberOfComponents", components.as_str()),
            ("format", "appended"),
            ("offset", offset.as_str()),
        ];
        self.event(Event::Empty(BytesStart::new("DataArray").with_attributes(attributes.into_iter().chain(more.iter().copied()))));
        let (mut sizes, mut data, mut total) = (Vec::new(), Vec::new(), 0);
        let mut raw = Vec::with_capacity((B * numbers.size_hint().0).min(AT_ONCE * BLOCK));
        let mut pack = |raw: &mut Vec<u8>| {
            for block in raw.par_chunks(BLOCK).map(deflated).collect::<Vec<_>>() {
                sizes.push(block.len());
                data.extend(block);
            }
            total += raw.len();
            raw.clear();
        };
        for bytes in numbers {
            raw.extend_from_slice(&bytes);
            // blocks hold whole numbers of every size
            if raw.len() == AT_ONCE * BLOCK {
                pack(&mut raw);
            }
        }
        pack(&mut raw);
        // number of blocks, size of one, size of the last unless it is full, compressed size of each
        for n in [sizes.len(), BLOCK, total % BLOCK].into_iter().chain(sizes) {
            self.appended.extend((n as u64).to_le_bytes());
        }
        self.appended.extend(data);
    }

    pub fn finish(mut self) -> Vec<u8> {
        self.start("AppendedData", &[("encoding", "raw")]);
        let (raw, out) = (std::mem::take(&mut self.appended), self.xml.get_mut());
        out.push(b'_');
        // the document is put together around the data, which are most of it
        let head = std::mem::take(out);
        self.end("AppendedData");
        self.end("VTKFile");
        let tail = self.xml.into_inner();
        let mut bytes = raw;
        bytes.reserve_exact(head.len() + tail.len() + 1);
        bytes.splice(0..0, head);
        bytes.extend(tail);
        bytes.push(b'\n');
        bytes
    }
}

/// A block as a zlib stream.
fn deflated(block: &[u8]) -> Vec<u8> {
    let mut out = Vec::with_capacity(block.len() / 2 + 64);
    let mut stream = Compress::new(Compression::new(LEVEL), true);
    loop {
        let rest = &block[stream.total_in() as usize..];
        match stream.compress_vec(rest, &mut out, FlushCompress::Finish).expect("a stream that was not ended takes every byte") {
            flate2::Status::StreamEnd => return out,
            _ => out.reserve(block.len() / 4 + 64),
        }
    }
}
