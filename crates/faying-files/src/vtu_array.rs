//! An array of a `.vtu`: its head, and its values whatever their encoding.

use super::budget::Budget;
use super::vtu_bytes::{Compression, Fault, Header};
use super::{FileError, Spot};
use quick_xml::events::BytesStart;
use std::borrow::Cow;

/// Encoding of the arrays of a file.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Layout {
    /// Whether it was read.
    pub known: bool,
    /// Whether the first byte of a number is the highest.
    pub big_endian: bool,
    /// Whether the numbers ahead of arrays have 8 bytes, not 4.
    pub wide: bool,
    /// Compression of all arrays that are no text.
    pub compression: Option<Compression>,
}

/// The head of an array.
#[derive(Clone, Debug)]
pub(super) struct Array {
    pub name: String,
    pub components: usize,
    /// Byte of its element.
    pub at: usize,
    kind: String,
    format: String,
    offset: usize,
}

/// The value of an attribute, without the blanks by which VTK keeps room for numbers.
pub(super) fn attribute(tag: &BytesStart<'_>, name: &str) -> Option<String> {
    let value = tag.try_get_attribute(name).ok().flatten()?;
    let unescaped = value.normalized_value(quick_xml::XmlVersion::Implicit1_0).ok()?;
    Some(unescaped.trim().to_owned())
}

impl Array {
    /// The head of the array whose element begins at byte `at`.
    pub fn new(tag: &BytesStart<'_>, at: usize) -> Result<Self, FileError> {
        let text = |name: &str| attribute(tag, name).unwrap_or_default();
        let components = attribute(tag, "NumberOfComponents").map_or(Some(1), |c| c.parse().ok()).filter(|c| (1..=64).contains(c));
        let Some(components) = components else {
            let what = "an array whose number of components is not 1 to 64".into();
            return Err(FileError::Broken { what, spot: Some(Spot::Byte(at)) });
        };
        let offset = text("offset").parse().unwrap_or(0);
        Ok(Self { name: text("Name"), components, at, kind: text("type"), format: text("format"), offset })
    }

    /// Its values: `text` is the text of its element, `appended` the appended data of the file, in base64 or not. Memory is counted in
    /// `budget`.
    pub fn values(
        &self,
        layout: &Layout,
        appended: Option<(&[u8], bool)>,
        text: &[u8],
        budget: &mut Budget,
    ) -> Result<Vec<f64>, FileError> {
        let spot = Some(Spot::Byte(self.at));
        let broken = |what: &str| FileError::Broken { what: format!("array \"{}\": {what}", self.name), spot };
        let (size, real) = match self.kind.as_str() {
            "Float64" => (8, true),
            "Float32" => (4, true),
            "Int64" | "UInt64" => (8, false),
            "Int32" | "UInt32" => (4, false),
            "Int16" | "UInt16" => (2, false),
            "Int8" | "UInt8" => (1, false),
            other => {
                let what = format!("an array of type {}", other.chars().take(24).collect::<String>());
                return Err(FileError::Unsupported { what, spot });
            }
        };
        let mut values = Vec::new();
        if self.format == "ascii" {
            for word in text.split(u8::is_ascii_whitespace).filter(|w| !w.is_empty()) {
                let value = std::str::from_utf8(word).ok().and_then(|w| w.parse().ok()).ok_or_else(|| broken("a word is no number"))?;
                budget.room(&mut values, 1)?;
                values.push(value);
            }
            return Ok(values);
        }
        let (source, base64) = match (self.format.as_str(), appended) {
            ("binary", _) => (text.trim_ascii(), true),
            ("appended", Some((data, base64))) => (data.get(self.offset..).unwrap_or_default(), base64),
            _ => return Err(broken("its format is not ascii, binary or appended, or nothing is appended")),
        };
        let header = Header { bytes: if layout.wide { 8 } else { 4 }, big_endian: layout.big_endian };
        let raw = match layout.compression {
            Some(compression) => header.unpacked(source, base64, compression, budget),
            None => header.plain(source, base64, budget),
        };
        let raw = raw.map_err(|fault| match fault {
            Fault::Broken(what) => broken(what),
            Fault::Memory(error) => error,
        })?;
        let count = raw.len();
        if count % size != 0 {
            return Err(broken("its length is no multiple of its type's"));
        }
        budget.room(&mut values, count / size)?;
        let signed = self.kind.starts_with("Int");
        values.extend(raw.chunks_exact(size).map(|chunk| {
            let mut word = [0; 8];
            word[..size].copy_from_slice(chunk);
            if layout.big_endian {
                word[..size].reverse();
            }
            let bits = u64::from_le_bytes(word);
            match (real, size, signed) {
                (true, 8, _) => f64::from_bits(bits),
                (true, _, _) => f64::from(f32::from_bits(bits as u32)),
                (false, _, true) => (((bits << (64 - 8 * size)) as i64) >> (64 - 8 * size)) as f64,
                (false, _, false) => bits as f64,
            }
        }));
        if let Cow::Owned(raw) = raw {
            budget.give(raw.capacity() as u64);
        }
        Ok(values)
    }
}
