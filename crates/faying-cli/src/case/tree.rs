//! The TOML tree with places: made by the parser, changed by `--set`, typed by the reader, written as the effective case.

use toml::de::{DeTable, DeValue};

use super::key::Key;
use crate::errors::{CaseText, Diagnostic, Diagnostics};
use crate::place::{LineStarts, SourceSpan};

/// A value of the file with its place; equal to another one of the same value.
#[derive(Clone, Debug)]
pub(super) struct Node {
    pub value: Value,
    pub at: SourceSpan,
    /// Whether the text is in single quote marks without escapes, so that positions in it are columns.
    pub literal: bool,
}

/// A value of TOML; numbers that do not fit are infinite or not numbers and refused by the reader.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Value {
    Text(String),
    Integer(i64),
    Float(f64),
    Bool(bool),
    Date(String),
    List(Vec<Node>),
    Table(Table),
}

/// Entries in the order of the file.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Table {
    pub entries: Vec<Entry>,
}

/// A key and its value.
#[derive(Clone, Debug)]
pub(super) struct Entry {
    pub key: String,
    pub key_at: SourceSpan,
    pub node: Node,
}

impl PartialEq for Node {
    fn eq(&self, other: &Self) -> bool {
        self.value == other.value
    }
}

impl PartialEq for Entry {
    fn eq(&self, other: &Self) -> bool {
        self.key == other.key && self.node == other.node
    }
}

impl Node {
    pub fn new(value: Value, at: SourceSpan) -> Self {
        Self { value, at, literal: false }
    }

    /// The place of a part of the text of this value, or of the whole value where columns are unknown.
    pub fn inside(&self, offset: usize, length: usize) -> SourceSpan {
        if self.literal && self.at.in_file().is_some() { self.at.inside(offset + 1, length) } else { self.at }
    }

    /// Description for messages: "the text "2"".
    pub fn describe(&self) -> String {
        let cut = |s: &str| if s.chars().count() > 40 { format!("{}...", s.chars().take(40).collect::<String>()) } else { s.to_owned() };
        match &self.value {
            Value::Text(s) => format!("the text {:?}", cut(s)),
            Value::Integer(n) => format!("{n}"),
            Value::Float(v) => format!("{v:?}"),
            Value::Bool(b) => format!("{b}"),
            Value::Date(d) => format!("the date {d}"),
            Value::List(l) if l.is_empty() => "an empty list".to_owned(),
            Value::List(l) => format!("a list of {}", l.len()),
            Value::Table(_) => "a table".to_owned(),
        }
    }

    /// The value as JSON.
    pub fn to_json(&self) -> serde_json::Value {
        serde_json::to_value(self.to_toml()).unwrap_or_default()
    }

    fn to_toml(&self) -> toml::Value {
        match &self.value {
            Value::Text(s) | Value::Date(s) => toml::Value::String(s.clone()),
            Value::Integer(n) => toml::Value::Integer(*n),
            Value::Float(v) => toml::Value::Float(*v),
            Value::Bool(b) => toml::Value::Boolean(*b),
            Value::List(l) => toml::Value::Array(l.iter().map(Self::to_toml).collect()),
            Value::Table(t) => toml::Value::Table(t.entries.iter().map(|e| (e.key.clone(), e.node.to_toml())).collect()),
        }
    }
}

impl Table {
    pub fn get(&self, key: &str) -> Option<&Entry> {
        self.entries.iter().find(|e| e.key == key)
    }

    pub fn get_mut(&mut self, key: &str) -> Option<&mut Entry> {
        self.entries.iter_mut().find(|e| e.key == key)
    }

    /// Adds or replaces an entry.
    pub fn set(&mut self, key: &str, key_at: SourceSpan, node: Node) {
        match self.get_mut(key) {
            Some(entry) => *entry = Entry { key: key.to_owned(), key_at, node },
            None => self.entries.push(Entry { key: key.to_owned(), key_at, node }),
        }
    }

    /// Brings the entries into the order of the keys; others come last.
    pub fn order(&mut self, keys: &[Key]) {
        self.entries.sort_by_key(|e| keys.iter().position(|k| k.name == e.key).unwrap_or(keys.len()));
    }

    /// The document: plain values first, then `[tables]` and `[[lists of tables]]`, everything below inline.
    pub fn to_document(&self) -> String {
        let mut out = String::new();
        for e in &self.entries {
            if !e.node.is_block() {
                line(&mut out, e);
            }
        }
        for e in &self.entries {
            match &e.node.value {
                Value::Table(t) if e.key == "study" => {
                    for s in &t.entries {
                        block(&mut out, &format!("[study.{}]", bare(&s.key)), &s.node);
                    }
                }
                Value::Table(_) => block(&mut out, &format!("[{}]", bare(&e.key)), &e.node),
                Value::List(l) if e.node.is_block() => {
                    for item in l {
                        block(&mut out, &format!("[[{}]]", bare(&e.key)), item);
                    }
                }
                _ => {}
            }
        }
        out
    }
}

impl Node {
    fn is_block(&self) -> bool {
        match &self.value {
            Value::Table(_) => true,
            Value::List(l) => !l.is_empty() && l.iter().all(|n| matches!(n.value, Value::Table(_))),
            _ => false,
        }
    }
}

fn block(out: &mut String, head: &str, node: &Node) {
    out.push('\n');
    out.push_str(head);
    out.push('\n');
    if let Value::Table(t) = &node.value {
        for e in &t.entries {
            line(out, e);
        }
    }
}

fn line(out: &mut String, e: &Entry) {
    out.push_str(&format!("{} = {}\n", bare(&e.key), e.node.to_toml()));
}

// keys that the reader accepts are bare; a quoted one is possible only for names that it refused
fn bare(key: &str) -> String {
    if !key.is_empty() && key.chars().all(|c| c.is_ascii_alphanumeric() || c == '_' || c == '-') {
        key.to_owned()
    } else {
        toml::Value::String(key.to_owned()).to_string()
    }
}

/// Parses a text; syntax errors carry the parser's own spans.
pub(super) fn parse(source: &CaseText) -> Result<Table, Diagnostics> {
    const MOST: usize = 5;
    let (document, mut errors) = DeTable::parse_recoverable(source.lines.text());
    if !errors.is_empty() {
        errors.sort_by_key(|e| e.span().map_or(usize::MAX, |s| s.start));
        let mut out = Diagnostics::new();
        let mut last = 0;
        for e in &errors {
            let place = e.span().map_or(SourceSpan::NONE, |s| source.lines.place(s));
            // further errors on the same line are usually consequences of the first
            if place.line != 0 && place.line == last || out.items.len() == MOST {
                continue;
            }
            last = place.line;
            out.push(
                Diagnostic::error("E005", format!("the file is not valid TOML: {}", first_line(e.message())))
                    .with_help("texts and formulas are quoted, lists are [a, b], tables are { key = value }")
                    .at(source, place),
            );
        }
        return Err(out);
    }
    Ok(table(document.get_ref(), &source.lines, None))
}

/// Parses one value; used for `--set`.
pub(super) fn parse_value(text: &str, at: SourceSpan) -> Result<Node, String> {
    let value = DeValue::parse(text).map_err(|e| first_line(e.message()).to_owned())?;
    Ok(node(value.get_ref(), value.span(), &LineStarts::new(text), Some(at)))
}

fn first_line(text: &str) -> &str {
    text.lines().next().unwrap_or("")
}

fn table(t: &DeTable<'_>, lines: &LineStarts, fixed: Option<SourceSpan>) -> Table {
    let entries = t
        .iter()
        .map(|(k, v)| Entry {
            key: k.get_ref().to_string(),
            key_at: fixed.unwrap_or_else(|| lines.place(k.span())),
            node: node(v.get_ref(), v.span(), lines, fixed),
        })
        .collect();
    Table { entries }
}

// `fixed` is the place of everything in a `--set` option
fn node(v: &DeValue<'_>, span: std::ops::Range<usize>, lines: &LineStarts, fixed: Option<SourceSpan>) -> Node {
    let at = fixed.unwrap_or_else(|| lines.place(span.clone()));
    let mut literal = false;
    let value = match v {
        DeValue::String(s) => {
            // one quote mark, the text itself, one quote mark
            literal = lines.text().get(span).is_some_and(|raw| raw.len() == s.len() + 2 && raw.get(1..raw.len() - 1) == Some(s.as_ref()));
            Value::Text(s.to_string())
        }
        DeValue::Integer(n) => match i64::from_str_radix(n.as_str(), n.radix()) {
            Ok(i) => Value::Integer(i),
            Err(_) if n.radix() == 10 => Value::Float(n.as_str().parse().unwrap_or(f64::INFINITY)),
            Err(_) => Value::Float(f64::INFINITY),
        },
        DeValue::Float(f) => Value::Float(f.as_str().parse().unwrap_or(f64::NAN)),
        DeValue::Boolean(b) => Value::Bool(*b),
        DeValue::Datetime(d) => Value::Date(d.to_string()),
        DeValue::Array(a) => Value::List(a.iter().map(|v| node(v.get_ref(), v.span(), lines, fixed)).collect()),
        DeValue::Table(t) => Value::Table(table(t, lines, fixed)),
    };
    Node { value, at, literal }
}
