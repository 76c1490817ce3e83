//! Places in a case file (line, column, length), and values with their place.

use std::fmt;
use std::ops::Deref;

/// Origin of a value.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Origin {
    /// The case file itself.
    File,
    /// The option `--set` with this position on the command line.
    Set(usize),
    /// Another option of the command line, such as `--backend`.
    Option,
    /// A default. The line and column, if any, are those of the block.
    #[default]
    Default,
}

/// A range of characters in one line of the case file.
///
/// Lines and columns count from 1, columns in characters; line 0 means that there is no place.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub struct SourceSpan {
    /// Line, from 1.
    pub line: usize,
    /// Column in characters, from 1.
    pub column: usize,
    /// Characters under the caret, within the line.
    pub length: usize,
    /// Origin of the value.
    pub origin: Origin,
}

impl SourceSpan {
    /// No place at all.
    pub const NONE: Self = Self { line: 0, column: 0, length: 0, origin: Origin::Default };

    /// Line and column in the file; `None` for values of options and other values without a line.
    pub fn in_file(&self) -> Option<(usize, usize)> {
        (self.line > 0).then_some((self.line, self.column))
    }

    /// The place `offset` characters further, `length` long: a position inside a quoted formula.
    pub fn inside(&self, offset: usize, length: usize) -> Self {
        Self { column: self.column + offset, length: length.max(1), ..*self }
    }
}

/// A value with its place in the case file.
///
/// Located values are equal if their values are equal; places are ignored.
#[derive(Clone, Copy, Default)]
pub struct Located<T> {
    /// The value.
    pub value: T,
    /// Place of the value.
    pub at: SourceSpan,
}

impl<T> Located<T> {
    /// A value with its place.
    pub fn new(value: T, at: SourceSpan) -> Self {
        Self { value, at }
    }

    /// Applies `f` to the value; the place stays.
    pub fn map<U>(self, f: impl FnOnce(T) -> U) -> Located<U> {
        Located { value: f(self.value), at: self.at }
    }
}

impl<T> Deref for Located<T> {
    type Target = T;
    fn deref(&self) -> &T {
        &self.value
    }
}

impl<T: PartialEq> PartialEq for Located<T> {
    fn eq(&self, other: &Self) -> bool {
        self.value == other.value
    }
}

impl<T: fmt::Debug> fmt::Debug for Located<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.value.fmt(f)
    }
}

/// Line starts of a text, to turn byte offsets into places.
#[derive(Clone, Debug, Default)]
pub struct LineStarts {
    text: String,
    starts: Vec<usize>,
}

impl LineStarts {
    /// Indexes a text.
    pub fn new(text: &str) -> Self {
        let starts = std::iter::once(0).chain(text.bytes().enumerate().filter(|(_, b)| *b == b'\n').map(|(k, _)| k + 1)).collect();
        Self { text: text.to_owned(), starts }
    }

    /// The place of a range of bytes; the part beyond the first line is cut off.
    pub fn place(&self, range: std::ops::Range<usize>) -> SourceSpan {
        let start = self.floor(range.start);
        let line = self.starts.partition_point(|&s| s <= start).max(1);
        let begin = self.starts.get(line - 1).copied().unwrap_or(0);
        let content = self.line(line).unwrap_or("");
        let end = self.floor(range.end).clamp(start, (begin + content.len()).max(start));
        let column = self.text[begin..start].chars().count() + 1;
        let length = self.text[start..end].chars().count().max(1);
        SourceSpan { line, column, length, origin: Origin::File }
    }

    /// The text of a line, counted from 1, without its end.
    pub fn line(&self, line: usize) -> Option<&str> {
        let begin = *self.starts.get(line.checked_sub(1)?)?;
        let end = self.starts.get(line).map_or(self.text.len(), |&s| s - 1);
        Some(self.text[begin..end].trim_end_matches('\r'))
    }

    /// The whole text.
    pub fn text(&self) -> &str {
        &self.text
    }

    // the largest character border not beyond `offset`: parsers may point into the middle of one
    fn floor(&self, offset: usize) -> usize {
        let mut at = offset.min(self.text.len());
        while !self.text.is_char_boundary(at) {
            at -= 1;
        }
        at
    }
}
