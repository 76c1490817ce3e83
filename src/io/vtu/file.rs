//! The arrays of all pieces, and the XML document that holds them.

use super::piece::Piece;
use quick_xml::Writer;
use quick_xml::events::{BytesEnd, BytesStart, Event};

/// The arrays of a file.
#[derive(Clone, Debug, Default)]
pub(super) struct Grid {
    pub names: Vec<(String, usize)>,
    points: Vec<f64>,
    pub fields: Vec<Vec<f64>>,
    weights: Vec<f64>,
    rational: bool,
    connectivity: Vec<i64>,
    offsets: Vec<i64>,
    types: Vec<u8>,
    degrees: Vec<f64>,
    patch: Vec<i32>,
    element: Vec<i32>,
}

impl Grid {
    pub fn append(&mut self, part: usize, element: usize, piece: &Piece) {
        let first = self.points.len() / 3;
        self.points.extend(piece.points.iter().flatten());
        self.rational |= piece.weights.is_some();
        match &piece.weights {
            Some(w) => self.weights.extend(w),
            None => self.weights.extend(std::iter::repeat_n(1.0, piece.points.len())),
        }
        for (all, own) in self.fields.iter_mut().zip(&piece.fields) {
            all.extend(own);
        }
        for cell in &piece.cells {
            self.connectivity.extend(cell.iter().map(|i| (first + i) as i64));
            self.offsets.push(self.connectivity.len() as i64);
            self.types.push(piece.kind);
            self.degrees.extend(piece.degrees);
            self.patch.push(i32::try_from(part).unwrap_or(i32::MAX));
            self.element.push(i32::try_from(element).unwrap_or(i32::MAX));
        }
    }

    /// Every array is dropped as soon as it is in the document.
    pub fn into_bytes(mut self) -> Vec<u8> {
        let hexahedra = self.types.iter().any(|t| [72, 79].contains(t));
        let high_order = self.types.iter().any(|t| *t >= 68);
        let mut file = File::new();
        let version = if hexahedra { "2.2" } else { "1.0" };
        file.start(
            "VTKFile",
            &[("type", "UnstructuredGrid"), ("version", version), ("byte_order", "LittleEndian"), ("header_type", "UInt64")],
        );
        file.start("UnstructuredGrid", &[]);
        let (points, cells) = ((self.points.len() / 3).to_string(), self.types.len().to_string());
        file.start("Piece", &[("NumberOfPoints", &points), ("NumberOfCells", &cells)]);
        // the attribute, not the array alone, makes readers use the weights
        file.start("PointData", if self.rational { &[("RationalWeights", "RationalWeights")] } else { &[] });
        for ((name, components), values) in self.names.iter().zip(self.fields) {
            file.array("Float64", name, *components, values.into_iter().map(f64::to_le_bytes));
        }
        let weights = std::mem::take(&mut self.weights);
        if self.rational {
            file.array("Float64", "RationalWeights", 1, weights.iter().map(|v| v.to_le_bytes()));
        }
        drop(weights);
        file.end("PointData");
        file.start("CellData", if high_order { &[("HigherOrderDegrees", "HigherOrderDegrees")] } else { &[] });
        if high_order {
            file.array("Float64", "HigherOrderDegrees", 3, self.degrees.into_iter().map(f64::to_le_bytes));
        }
        file.array("Int32", "patch", 1, self.patch.into_iter().map(i32::to_le_bytes));
        file.array("Int32", "element", 1, self.element.into_iter().map(i32::to_le_bytes));
        file.end("CellData");
        file.start("Points", &[]);
        file.array("Float64", "Points", 3, self.points.into_iter().map(f64::to_le_bytes));
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

/// An XML document with raw data appended.
pub(in crate::io) struct File {
    xml: Writer<Vec<u8>>,
    appended: Vec<u8>,
}

impl File {
    pub fn new() -> Self {
        Self { xml: Writer::new_with_indent(Vec::new(), b' ', 2), appended: Vec::new() }
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

    /// An array of numbers, each as its bytes.
    pub fn array<const B: usize>(&mut self, kind: &str, name: &str, components: usize, numbers: impl Iterator<Item = [u8; B]>) {
        let (components, offset) = (components.to_string(), self.appended.len().to_string());
        let attributes = [
            ("type", kind),
            ("Name", name),
            ("NumberOfComponents", components.as_str()),
            ("format", "appended"),
            ("offset", offset.as_str()),
        ];
        self.event(Event::Empty(BytesStart::new("DataArray").with_attributes(attributes)));
        // no room for more: of large files the half would stay empty
        self.appended.reserve_exact(8 + B * numbers.size_hint().0);
        let header = self.appended.len();
        self.appended.extend([0; 8]);
        numbers.for_each(|bytes| self.appended.extend_from_slice(&bytes));
        let length = (self.appended.len() - header - 8) as u64;
        self.appended[header..header + 8].copy_from_slice(&length.to_le_bytes());
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
