//! A small XML document as a tree with lines: no entities in numbers, no document types, bounded depth and memory.

use super::FileError;
use super::budget::Budget;
use super::text::{Words, broken, shown, unsupported};
use quick_xml::Reader;
use quick_xml::XmlVersion;
use quick_xml::events::{BytesStart, Event};
use std::borrow::Cow;

/// Largest depth of nested elements.
const DEPTH: usize = 32;

/// An element.
#[derive(Debug)]
pub(super) struct XmlElement<'a> {
    /// Its name.
    pub name: String,
    /// The line it begins in.
    pub line: usize,
    /// Names and values of its attributes.
    pub attributes: Vec<(String, String)>,
    /// The elements in it.
    pub children: Vec<XmlElement<'a>>,
    /// Pieces of its text that are not blank, with their lines.
    text: Vec<(&'a [u8], usize)>,
    /// The line of an entity within the text.
    entity: Option<usize>,
}

impl<'a> XmlElement<'a> {
    /// The value of an attribute.
    pub(super) fn attribute(&self, name: &str) -> Option<&str> {
        self.attributes.iter().find(|(n, _)| n == name).map(|(_, v)| v.as_str())
    }

    /// The elements called `name` in it.
    pub(super) fn named<'b>(&'b self, name: &'b str) -> impl Iterator<Item = &'b XmlElement<'a>> {
        self.children.iter().filter(move |c| c.name == name)
    }

    /// The only element called `name` in it.
    ///
    /// # Errors
    /// [`FileError::Broken`] if there is none, or several.
    pub(super) fn only(&self, name: &str) -> Result<&XmlElement<'a>, FileError> {
        let mut all = self.children.iter().filter(|c| c.name == name);
        let first = all.next().ok_or_else(|| broken(self.line, format!("<{}> has no <{name}>", self.name)))?;
        match all.next() {
            Some(second) => Err(broken(second.line, format!("<{}> has a second <{name}>", self.name))),
            None => Ok(first),
        }
    }

    /// The whole text, with comments replaced by blank lines.
    ///
    /// # Errors
    /// [`FileError::Broken`] for an entity.
    pub(super) fn words(&self) -> Result<(Cow<'a, [u8]>, usize), FileError> {
        if let Some(line) = self.entity {
            return Err(broken(line, format!("<{}> holds an entity where numbers are expected", self.name)));
        }
        let Some(&(first, line)) = self.text.first() else {
            return Ok((Cow::Borrowed(b""), self.line));
        };
        if self.text.len() == 1 {
            return Ok((Cow::Borrowed(first), line));
        }
        let mut all = Vec::with_capacity(self.text.iter().map(|(t, _)| t.len() + 1).sum());
        let mut at = line;
        for &(piece, line) in &self.text {
            all.push(b' ');
            all.extend((at..line).map(|_| b'\n'));
            all.extend_from_slice(piece);
            at = line.max(at) + lines(piece);
        }
        Ok((Cow::Owned(all), line))
    }

    /// Exactly `count` numbers, which are `what` in messages.
    ///
    /// # Errors
    /// [`FileError`] for more, fewer or other words.
    pub(super) fn numbers(&self, count: usize, what: &str, budget: &mut Budget) -> Result<Vec<f64>, FileError> {
        let (text, line) = self.words()?;
        let mut words = Words::new(&text, line);
        let all = words.numbers(count, what, budget)?;
        match words.line() {
            _ if words.done() => Ok(all),
            line => Err(broken(line, format!("more than {count} numbers as {what}"))),
        }
    }
}

fn lines(text: &[u8]) -> usize {
    text.iter().filter(|b| **b == b'\n').count()
}

/// Line counter for positions that only move forward.
struct Lines<'a> {
    bytes: &'a [u8],
    at: usize,
    line: usize,
}

impl Lines<'_> {
    fn of(&mut self, place: usize) -> usize {
        let place = place.clamp(self.at, self.bytes.len());
        self.line += lines(&self.bytes[self.at..place]);
        self.at = place;
        self.line
    }
}

/// Reads a document; returns its root element.
///
/// # Errors
/// [`FileError::Broken`] for what is not XML, [`FileError::Unsupported`] for document types and more than [`DEPTH`] levels,
/// [`FileError::Memory`].
pub(super) fn parse<'a>(bytes: &'a [u8], budget: &mut Budget) -> Result<XmlElement<'a>, FileError> {
    let mut reader = Reader::from_reader(bytes);
    let mut lines = Lines { bytes, at: 0, line: 1 };
    let mut open: Vec<XmlElement<'a>> = Vec::new();
    let mut root: Option<XmlElement<'a>> = None;
    loop {
        let start = place(reader.buffer_position());
        let event = reader.read_event();
        let line = lines.of(start);
        let closed = match event {
            Err(e) => return Err(broken(lines.of(place(reader.error_position())), format!("not well-formed XML: {e}"))),
            Ok(Event::DocType(_)) => return Err(unsupported(line, "a document type (DTD) in XML")),
            Ok(Event::Start(tag)) => {
                if open.len() == DEPTH {
                    return Err(unsupported(line, format!("XML of more than {DEPTH} levels")));
                }
                open.push(node(&tag, line, budget)?);
                None
            }
            Ok(Event::Empty(tag)) => Some(node(&tag, line, budget)?),
            Ok(Event::End(_)) => open.pop(),
            Ok(Event::Text(text)) => {
                let all = &bytes[start..place(reader.buffer_position()).min(bytes.len())];
                if !text.trim_ascii().is_empty() {
                    match open.last_mut() {
                        Some(node) => {
                            budget.items(1, size_of::<(&[u8], usize)>())?;
                            node.text.push((all, line));
                        }
                        None => return Err(broken(line, format!("text outside of the XML: \"{}\"", shown(all.trim_ascii())))),
                    }
                }
                None
            }
            Ok(Event::CData(_) | Event::GeneralRef(_)) => {
                if let Some(node) = open.last_mut() {
                    node.entity.get_or_insert(line);
                }
                None
            }
            Ok(Event::Comment(_) | Event::Decl(_) | Event::PI(_)) => None,
            Ok(Event::Eof) => break,
        };
        let Some(node) = closed else { continue };
        match open.last_mut() {
            Some(parent) => parent.children.push(node),
            None if root.is_some() => return Err(broken(node.line, format!("a second root element <{}>", node.name))),
            None => root = Some(node),
        }
    }
    if let Some(node) = open.last() {
        return Err(broken(node.line, format!("<{}> is not closed", node.name)));
    }
    root.ok_or_else(|| broken(lines.of(bytes.len()), "the XML has no element"))
}

fn place(position: u64) -> usize {
    usize::try_from(position).unwrap_or(usize::MAX)
}

fn node<'a>(tag: &BytesStart<'_>, line: usize, budget: &mut Budget) -> Result<XmlElement<'a>, FileError> {
    // The vectors that grow may hold twice as much, and three times while they move.
    budget.items(3, size_of::<XmlElement<'_>>())?;
    budget.items(2, tag.len())?;
    let mut attributes = Vec::new();
    for attribute in tag.attributes().with_checks(false) {
        budget.items(4, size_of::<(String, String)>())?;
        let attribute = attribute.map_err(|e| broken(line, format!("not well-formed XML: {e}")))?;
        let value = attribute.normalized_value(XmlVersion::Implicit1_0).map_err(|e| broken(line, format!("not well-formed XML: {e}")))?;
        attributes.push((String::from_utf8_lossy(attribute.key.as_ref()).into_owned(), value.into_owned()));
    }
    let name = String::from_utf8_lossy(tag.name().as_ref()).into_owned();
    Ok(XmlElement { name, line, attributes, children: Vec::new(), text: Vec::new(), entity: None })
}
