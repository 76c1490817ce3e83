//! Decoding of the arrays of a `.vtu`: raw or base64, uncompressed or compressed by zlib, LZ4 or LZMA, each with a header.
//!
//! An uncompressed array: its length, then its bytes. A compressed one: the number of blocks, the size of a block and of the last one
//! unless that is full, the compressed size of every block, then the blocks. In base64 the header is encoded separately.
//! A block is a zlib stream, an LZ4 block, or an XZ stream of one block of LZMA2, which VTK and Python's `lzma` write.
//! Sources: "VTK XML Formats", vtk.org; "The .xz File Format", tukaani.org.

use super::FileError;
use super::budget::Budget;
use flate2::{Decompress, FlushDecompress, Status};
use std::borrow::Cow;
use std::io::Read;

/// Memory of a zlib stream that is read: its window and its tables.
const STREAM: u64 = 1 << 16;

/// Memory of an LZMA stream beside its dictionary: a chunk of input, the tables, and the least that a dictionary has.
const LZMA: u64 = 3 << 16;

/// Memory of a dictionary per byte in it, which grows by doubling.
const DICTIONARY: u64 = 3;

/// Most bytes that come out of a byte of LZ4.
const LZ4: usize = 255;

/// Most bytes that a block grows by at once.
const STEP: usize = 1 << 15;

/// Compression of the blocks of an array.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Compression {
    Zlib,
    Lz4,
    Lzma,
}

impl Compression {
    /// The compression that VTK's compressor of a name makes.
    pub fn of_name(name: &str) -> Option<Self> {
        match name {
            "vtkZLibDataCompressor" => Some(Self::Zlib),
            "vtkLZ4DataCompressor" => Some(Self::Lz4),
            "vtkLZMADataCompressor" => Some(Self::Lzma),
            _ => None,
        }
    }
}

/// Error of decoding an array.
#[derive(Debug)]
pub(super) enum Fault {
    /// The array contradicts itself.
    Broken(&'static str),
    /// It is too large.
    Memory(FileError),
}

impl From<FileError> for Fault {
    fn from(error: FileError) -> Self {
        Self::Memory(error)
    }
}

const EARLY: Fault = Fault::Broken("the data end early");

const DAMAGED: Fault = Fault::Broken("a compressed block is damaged");

/// Layout of the numbers ahead of an array.
#[derive(Clone, Copy, Debug)]
pub(super) struct Header {
    /// Bytes of a number.
    pub bytes: usize,
    /// Whether the first byte is the highest.
    pub big_endian: bool,
}

impl Header {
    /// The k-th number.
    fn number(self, data: &[u8], k: usize) -> Result<usize, Fault> {
        let at = k.checked_mul(self.bytes).ok_or(EARLY)?;
        let mut word = [0; 8];
        word[..self.bytes].copy_from_slice(data.get(at..at.saturating_add(self.bytes)).ok_or(EARLY)?);
        if self.big_endian {
            word[..self.bytes].reverse();
        }
        usize::try_from(u64::from_le_bytes(word)).map_err(|_| EARLY)
    }

    /// Bytes of an uncompressed array; owned ones are counted in `budget`.
    pub fn plain<'a>(self, source: &'a [u8], base64: bool, budget: &mut Budget) -> Result<Cow<'a, [u8]>, Fault> {
        if !base64 {
            let count = self.number(source, 0)?;
            return Ok(Cow::Borrowed(source[self.bytes..].get(..count).ok_or(EARLY)?));
        }
        let count = self.number(&decode(source, self.bytes), 0)?;
        let all = count.saturating_add(self.bytes).min(source.len());
        budget.take(all as u64)?;
        let mut data = decode(source, all);
        if data.len() < self.bytes || data.len() - self.bytes < count {
            return Err(EARLY);
        }
        data.drain(..self.bytes);
        data.truncate(count);
        Ok(Cow::Owned(data))
    }

    /// Bytes of a compressed array, which are counted in `budget`.
    pub fn unpacked<'a>(self, source: &[u8], base64: bool, compression: Compression, budget: &mut Budget) -> Result<Cow<'a, [u8]>, Fault> {
        let part = |bytes: usize| if base64 { Cow::Owned(decode(source, bytes)) } else { Cow::Borrowed(source) };
        let blocks = self.number(&part(self.bytes), 0)?;
        let head = blocks.checked_add(3).and_then(|n| n.checked_mul(self.bytes)).filter(|n| *n <= source.len()).ok_or(EARLY)?;
        budget.take(head as u64)?;
        let header = part(head)[..].get(..head).ok_or(EARLY)?.to_vec();
        let (full, last) = (self.number(&header, 1)?, self.number(&header, 2)?);
        let mut end = head;
        for k in 0..blocks {
            end = end.checked_add(self.number(&header, 3 + k)?).filter(|n| *n <= source.len()).ok_or(EARLY)?;
        }
        let decoded = if base64 { end as u64 } else { 0 };
        budget.take(decoded + STREAM)?;
        let data = part(end);
        let (mut raw, mut from) = (Vec::new(), head);
        for k in 0..blocks {
            let to = from + self.number(&header, 3 + k)?;
            let size = if k + 1 == blocks && last > 0 { last } else { full };
            let block = data.get(from..to).ok_or(EARLY)?;
            match compression {
                Compression::Zlib => inflate(block, size, &mut raw, budget)?,
                Compression::Lz4 => lz4(block, size, &mut raw, budget)?,
                Compression::Lzma => lzma(block, size, &mut raw, budget)?,
            }
            from = to;
        }
        budget.give(head as u64 + decoded + STREAM);
        Ok(Cow::Owned(raw))
    }
}

/// Appends the `size` bytes of a zlib stream; memory grows with what comes out of it.
fn inflate(block: &[u8], size: usize, raw: &mut Vec<u8>, budget: &mut Budget) -> Result<(), Fault> {
    let (start, mut stream) = (raw.len(), Decompress::new(true));
    loop {
        let left = size.saturating_sub(raw.len() - start);
        budget.room(raw, left.clamp(1, STEP))?;
        let before = (stream.total_in(), raw.len());
        let rest = &block[(before.0 as usize).min(block.len())..];
        let status = stream.decompress_vec(rest, raw, FlushDecompress::None).map_err(|_| DAMAGED)?;
        if status == Status::StreamEnd {
            break;
        }
        if raw.len() - start > size || (stream.total_in(), raw.len()) == before {
            return Err(DAMAGED);
        }
    }
    if raw.len() - start == size { Ok(()) } else { Err(DAMAGED) }
}

/// Appends the `size` bytes of an LZ4 block.
fn lz4(block: &[u8], size: usize, raw: &mut Vec<u8>, budget: &mut Budget) -> Result<(), Fault> {
    if size > block.len().saturating_mul(LZ4) {
        return Err(DAMAGED);
    }
    let start = raw.len();
    budget.room(raw, size)?;
    raw.resize(start + size, 0);
    match lz4_flex::block::decompress_into(block, &mut raw[start..]) {
        Ok(found) if found == size => Ok(()),
        _ => Err(DAMAGED),
    }
}

/// Appends the `size` bytes of an XZ stream; memory grows with what comes out of it.
fn lzma(block: &[u8], size: usize, raw: &mut Vec<u8>, budget: &mut Budget) -> Result<(), Fault> {
    let stream = lzma2(block).ok_or(DAMAGED)?;
    // nothing refers farther back than to the begin of the block, whatever dictionary its header asks for
    let dictionary = u32::try_from(size.max(1 << 12)).map_err(|_| DAMAGED)?;
    budget.take(LZMA)?;
    let mut reader = lzma_rust2::Lzma2Reader::new(stream, dictionary, None);
    let start = raw.len();
    loop {
        let (from, step) = (raw.len(), (size - (raw.len() - start)).clamp(1, STEP));
        budget.room(raw, step)?;
        budget.take(DICTIONARY * step as u64)?;
        raw.resize(from + step, 0);
        let found = reader.read(&mut raw[from..]).map_err(|_| DAMAGED)?;
        budget.give(DICTIONARY * (step - found) as u64);
        raw.truncate(from + found);
        if found == 0 || raw.len() - start > size {
            break;
        }
    }
    budget.give(LZMA + DICTIONARY * (raw.len() - start) as u64);
    if raw.len() - start == size { Ok(()) } else { Err(DAMAGED) }
}

/// The LZMA2 data of an XZ stream whose first block has no other filter.
fn lzma2(stream: &[u8]) -> Option<&[u8]> {
    // the magic bytes, two flags and their checksum, then the header of a block, whose first byte counts words of four
    let rest = stream.strip_prefix(b"\xFD7zXZ\0")?.get(6..)?;
    let (header, data) = rest.split_at_checked(4 * (1 + usize::from(*rest.first()?)))?;
    let flags = header[1];
    let mut at = 2;
    // the compressed and the uncompressed size, where they are given, in digits of seven bits
    for _ in 0..(flags >> 6 & 1) + (flags >> 7) {
        while header.get(at)? & 0x80 != 0 {
            at += 1;
        }
        at += 1;
    }
    // LZMA2 is filter 0x21 with one byte of properties
    (flags & 3 == 0 && header.get(at..at + 2)? == [0x21, 1]).then_some(data)
}

/// Bytes of base64 text, at most so many; padding may stand between parts.
fn decode(text: &[u8], at_most: usize) -> Vec<u8> {
    let mut out = Vec::with_capacity(at_most.min(text.len()));
    let (mut bits, mut count) = (0u32, 0);
    for b in text {
        let digit = match b {
            b'A'..=b'Z' => b - b'A',
            b'a'..=b'z' => b - b'a' + 26,
            b'0'..=b'9' => b - b'0' + 52,
            b'+' => 62,
            b'/' => 63,
            b'=' => {
                (bits, count) = (0, 0);
                continue;
            }
            b if b.is_ascii_whitespace() => continue,
            _ => break,
        };
        bits = (bits << 6 | u32::from(digit)) & 0xffff;
        count += 6;
        if count >= 8 {
            count -= 8;
            out.push((bits >> count) as u8);
        }
        if out.len() >= at_most {
            break;
        }
    }
    out
}
