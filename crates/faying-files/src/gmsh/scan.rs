//! Reading of numbers from the bytes of a file, as text or binary, without a copy.

use crate::{FileError, Spot};

/// A source of numbers: text or binary.
pub(super) trait Source: Sized {
    /// A C int.
    fn int(&mut self) -> Result<i64, FileError>;
    /// A size_t.
    fn size(&mut self) -> Result<u64, FileError>;
    /// A double, finite or not.
    fn real(&mut self) -> Result<f64, FileError>;
    /// Checks that nothing follows on the line of a node or an element.
    fn end_record(&mut self) -> Result<(), FileError>;
    /// Position of the next byte.
    fn at(&self) -> usize;
    /// Continues at byte `at`.
    fn go_to(&mut self, at: usize);
    /// Position of the last number, for messages.
    fn spot(&self) -> Spot;

    /// A number of a node or an element: positive.
    #[inline]
    fn tag(&mut self, wide: bool) -> Result<u64, FileError> {
        let tag = if wide { self.size()? } else { u64::try_from(self.int()?).unwrap_or(0) };
        if tag == 0 { Err(self.broken("a node or element has a number that is not positive")) } else { Ok(tag) }
    }

    /// [`FileError::Broken`] at the last number.
    #[cold]
    fn broken(&self, what: impl Into<String>) -> FileError {
        FileError::Broken { what: what.into(), spot: Some(self.spot()) }
    }
}

/// Line of a byte, from 1.
pub(super) fn line_of(bytes: &[u8], at: usize) -> Spot {
    Spot::Line(1 + bytes[..at.min(bytes.len())].iter().filter(|b| **b == b'\n').count())
}

/// Numbers separated by white space.
pub(super) struct Ascii<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Ascii<'a> {
    pub fn new(bytes: &'a [u8], at: usize) -> Self {
        Self { bytes, at }
    }

    #[inline]
    fn skip(&mut self) {
        while self.at < self.bytes.len() && self.bytes[self.at] <= b' ' {
            self.at += 1;
        }
    }

    /// The next word, which is not consumed.
    fn word(&self) -> &'a [u8] {
        let rest = &self.bytes[self.at..];
        &rest[..rest.iter().position(|b| *b <= b' ').unwrap_or(rest.len())]
    }

    #[cold]
    fn unexpected(&self, wanted: &str) -> FileError {
        let word = self.word();
        let what = if word.is_empty() {
            format!("expected {wanted}, the file ends")
        } else {
            format!("expected {wanted}, found `{}`", String::from_utf8_lossy(&word[..word.len().min(24)]))
        };
        self.broken(what)
    }

    #[inline]
    fn digits(&mut self, wanted: &str) -> Result<u64, FileError> {
        let from = self.at;
        let mut value = 0u64;
        while let Some(digit) = self.bytes.get(self.at).map(|b| b.wrapping_sub(b'0')).filter(|d| *d < 10) {
            // 18 digits fit without a check
            if self.at - from >= 18 {
                value = match value.checked_mul(10).and_then(|v| v.checked_add(u64::from(digit))) {
                    Some(v) => v,
                    None => {
                        self.at = from;
                        return Err(self.unexpected(wanted));
                    }
                };
            } else {
                value = value * 10 + u64::from(digit);
            }
            self.at += 1;
        }
        if self.at == from || self.bytes.get(self.at).is_some_and(|b| *b > b' ') {
            self.at = from;
            return Err(self.unexpected(wanted));
        }
        Ok(value)
    }
}

impl Source for Ascii<'_> {
    #[inline]
    fn int(&mut self) -> Result<i64, FileError> {
        self.skip();
        let negative = self.bytes.get(self.at) == Some(&b'-');
        self.at += usize::from(negative);
        let value = i64::try_from(self.digits("a whole number")?).map_err(|_| self.broken("a whole number is too large"))?;
        Ok(if negative { -value } else { value })
    }

    #[inline]
    fn size(&mut self) -> Result<u64, FileError> {
        self.skip();
        self.digits("a whole number that is not negative")
    }

    #[inline]
    fn real(&mut self) -> Result<f64, FileError> {
        self.skip();
        let word = self.word();
        let value = std::str::from_utf8(word).ok().and_then(|w| w.parse().ok()).ok_or_else(|| self.unexpected("a number"))?;
        self.at += word.len();
        Ok(value)
    }

    #[inline]
    fn end_record(&mut self) -> Result<(), FileError> {
        while let Some(b) = self.bytes.get(self.at) {
            match b {
                b'\n' => break,
                b' ' | b'\t' | b'\r' => self.at += 1,
                _ => return Err(self.unexpected("the end of the line")),
            }
        }
        Ok(())
    }

    fn at(&self) -> usize {
        self.at
    }

    fn go_to(&mut self, at: usize) {
        self.at = at;
    }

    fn spot(&self) -> Spot {
        line_of(self.bytes, self.at)
    }
}

/// Binary numbers in either byte order.
pub(super) struct Binary<'a> {
    bytes: &'a [u8],
    at: usize,
    from: usize,
    big_endian: bool,
}

impl<'a> Binary<'a> {
    pub fn new(bytes: &'a [u8], at: usize, big_endian: bool) -> Self {
        Self { bytes, at, from: at, big_endian }
    }

    #[inline]
    fn take<const N: usize>(&mut self) -> Result<[u8; N], FileError> {
        self.from = self.at;
        let Some(chunk) = self.bytes.get(self.at..).and_then(|rest| rest.first_chunk::<N>()) else {
            return Err(self.broken("the file ends inside binary data"));
        };
        self.at += N;
        let mut chunk = *chunk;
        if self.big_endian {
            chunk.reverse();
        }
        Ok(chunk)
    }
}

impl Source for Binary<'_> {
    #[inline]
    fn int(&mut self) -> Result<i64, FileError> {
        Ok(i64::from(i32::from_le_bytes(self.take()?)))
    }

    #[inline]
    fn size(&mut self) -> Result<u64, FileError> {
        Ok(u64::from_le_bytes(self.take()?))
    }

    #[inline]
    fn real(&mut self) -> Result<f64, FileError> {
        Ok(f64::from_le_bytes(self.take()?))
    }

    #[inline]
    fn end_record(&mut self) -> Result<(), FileError> {
        Ok(())
    }

    fn at(&self) -> usize {
        self.at
    }

    fn go_to(&mut self, at: usize) {
        self.at = at;
    }

    fn spot(&self) -> Spot {
        Spot::Byte(self.from)
    }
}
