//! Diagnostics: errors and warnings with a code, a place in a file, a snippet and advice.
//!
//! ```text
//! error[E012]: unknown key `yougn` in material "steel"
//!   --> hertz.toml:9:1
//!    |
//!  9 | yougn = 1.0
//!    | ^^^^^ did you mean `young`?
//!    = help: keys here: name, young, poisson, lambda, mu       (faying explain E012)
//! ```

use std::fmt::Write as _;

use serde::Serialize;
use serde::ser::SerializeStruct;

use super::codes;
use super::place::{LineStarts, Origin, SourceSpan};

/// Severity of a diagnostic.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Severity {
    /// The run goes on.
    Warning,
    /// The run stops.
    Error,
}

impl Severity {
    /// The word that opens a message.
    pub fn word(self) -> &'static str {
        match self {
            Self::Warning => "warning",
            Self::Error => "error",
        }
    }
}

/// One error or warning.
#[derive(Clone, Debug, PartialEq)]
pub struct Diagnostic {
    /// Code of [`codes::CODES`].
    pub code: &'static str,
    /// Error or warning.
    pub severity: Severity,
    /// Message, one line.
    pub message: String,
    /// The file, or the option `--set a.b=v`, that it concerns.
    pub file: Option<String>,
    /// Line in the file, from 1.
    pub line: Option<usize>,
    /// Column in characters, from 1.
    pub column: Option<usize>,
    /// Characters under the caret.
    pub length: usize,
    /// Text beside the caret, such as the nearest known name.
    pub label: Option<String>,
    /// Allowed values, or advice.
    pub help: Option<String>,
    /// The text of the line.
    pub snippet: Option<String>,
}

impl Diagnostic {
    /// An error without a place.
    pub fn error(code: &'static str, message: impl Into<String>) -> Self {
        Self {
            code,
            severity: Severity::Error,
            message: message.into(),
            file: None,
            line: None,
            column: None,
            length: 1,
            label: None,
            help: None,
            snippet: None,
        }
    }

    /// A warning without a place.
    pub fn warning(code: &'static str, message: impl Into<String>) -> Self {
        Self { severity: Severity::Warning, ..Self::error(code, message) }
    }

    /// Adds the allowed values or advice.
    pub fn with_help(mut self, help: impl Into<String>) -> Self {
        self.help = Some(help.into());
        self
    }

    /// Adds advice if there is some.
    pub(crate) fn with_some_help(self, help: Option<impl Into<String>>) -> Self {
        match help {
            Some(help) => self.with_help(help),
            None => self,
        }
    }

    /// Adds the text beside the caret.
    pub fn with_label(mut self, label: impl Into<String>) -> Self {
        self.label = Some(label.into());
        self
    }

    /// Adds the file alone.
    pub fn in_file(mut self, file: impl Into<String>) -> Self {
        self.file = Some(file.into());
        self
    }

    /// Adds a place in a source, with its snippet.
    pub fn at(mut self, source: &CaseText, place: SourceSpan) -> Self {
        match place.origin {
            Origin::Set(k) => {
                self.file = Some(source.sets.get(k).map_or_else(|| "--set".to_owned(), |s| format!("--set {s}")));
                return self;
            }
            Origin::Option => {
                self.file = Some("the command line".to_owned());
                return self;
            }
            Origin::File | Origin::Default => self.file = Some(source.name.clone()),
        }
        if let Some((line, column)) = place.in_file() {
            self.line = Some(line);
            self.column = Some(column);
            self.length = place.length.max(1);
            self.snippet = source.lines.line(line).map(str::to_owned);
        }
        self
    }

    /// Exit code of the program for this diagnostic: 0 for a warning.
    pub fn exit(&self) -> i32 {
        match self.severity {
            Severity::Warning => 0,
            Severity::Error => codes::find(self.code).map_or(3, |c| c.exit),
        }
    }

    /// The text of the diagnostic: several lines, ended by a line break.
    pub fn render(&self) -> String {
        let mut out = String::new();
        // writing to a String cannot fail
        let _ = writeln!(out, "{}[{}]: {}", self.severity.word(), self.code, one_line(&self.message));
        let number = self.line.map_or(String::new(), |l| l.to_string());
        let width = number.len().max(1);
        if let Some(file) = &self.file {
            let place = match (self.line, self.column) {
                (Some(l), Some(c)) => format!(":{l}:{c}"),
                (Some(l), None) => format!(":{l}"),
                _ => String::new(),
            };
            let _ = writeln!(out, "{:width$} --> {}{place}", "", one_line(file));
        }
        if let (Some(snippet), Some(column)) = (&self.snippet, self.column) {
            let (text, indent, carets) = window(snippet, column, self.length);
            let label = self.label.as_deref().map_or(String::new(), |l| format!(" {}", one_line(l)));
            let _ = writeln!(out, "{:width$}  |", "");
            let _ = writeln!(out, " {number} | {text}");
            let _ = writeln!(out, "{:width$}  | {:indent$}{}{label}", "", "", "^".repeat(carets));
        } else if let Some(label) = &self.label {
            let _ = writeln!(out, "{:width$}  = note: {}", "", one_line(label));
        }
        let explain = format!("faying explain {}", self.code);
        let _ = match self.remedy() {
            Some(help) => writeln!(out, "{:width$}  = help: {}       ({explain})", "", one_line(help)),
            None => writeln!(out, "{:width$}  = help: {explain}", ""),
        };
        out
    }

    /// The help, or the remedy of the code where there is neither help nor label.
    fn remedy(&self) -> Option<&str> {
        let of_code = || codes::find(self.code).map(|code| code.remedy.trim_end_matches('.')).filter(|_| self.label.is_none());
        self.help.as_deref().or_else(of_code)
    }

    /// The advice as one text: label and help, or the remedy of the code where there is neither.
    pub fn advice(&self) -> Option<String> {
        match (&self.label, self.remedy()) {
            (Some(l), Some(h)) => Some(format!("{l}; {h}")),
            (Some(l), None) => Some(l.clone()),
            (None, h) => h.map(str::to_owned),
        }
    }

    /// The JSON object `{code, severity, message, file, line, column, help}`.
    pub fn to_json(&self) -> serde_json::Value {
        serde_json::json!({
            "code": self.code, "severity": self.severity.word(), "message": self.message,
            "file": self.file, "line": self.line, "column": self.column, "help": self.advice(),
        })
    }
}

impl Serialize for Diagnostic {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut s = serializer.serialize_struct("Diagnostic", 7)?;
        s.serialize_field("code", self.code)?;
        s.serialize_field("severity", &self.severity)?;
        s.serialize_field("message", &self.message)?;
        s.serialize_field("file", &self.file)?;
        s.serialize_field("line", &self.line)?;
        s.serialize_field("column", &self.column)?;
        s.serialize_field("help", &self.advice())?;
        s.end()
    }
}

/// The text of a case with its name and its `--set` options: the source of all places.
#[derive(Clone, Debug, Default)]
pub struct CaseText {
    /// Name of the file as the user wrote it.
    pub name: String,
    /// Its lines.
    pub lines: LineStarts,
    /// The texts of the `--set` options.
    pub sets: Vec<String>,
}

/// At most this many diagnostics are listed.
pub const LISTED: usize = 20;

/// A collection of diagnostics.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Diagnostics {
    /// The diagnostics in the order they were found.
    pub items: Vec<Diagnostic>,
}

impl Diagnostics {
    /// An empty collection.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds one; the same error at the same place is kept once.
    pub fn push(&mut self, diagnostic: Diagnostic) {
        if !self.items.contains(&diagnostic) {
            self.items.push(diagnostic);
        }
    }

    /// Adds all of another collection.
    pub fn extend(&mut self, other: Self) {
        for d in other.items {
            self.push(d);
        }
    }

    /// Whether there is an error among them.
    pub fn has_errors(&self) -> bool {
        self.items.iter().any(|d| d.severity == Severity::Error)
    }

    /// Whether the collection is empty.
    pub fn is_empty(&self) -> bool {
        self.items.is_empty()
    }

    /// Sorts by line and column; diagnostics without a place come last.
    pub fn sort(&mut self) {
        self.items.sort_by_key(|d| (d.line.unwrap_or(usize::MAX), d.column.unwrap_or(0)));
    }

    /// The exit code: the first of 4, 6, 5, 3 among those of the errors, else 0.
    ///
    /// The precedence of all exit codes is 130, 70, 4, 6, 5, 3, 1, 0.
    pub fn exit(&self) -> i32 {
        let codes: Vec<i32> = self.items.iter().map(Diagnostic::exit).collect();
        [4, 6, 5, 3].into_iter().find(|c| codes.contains(c)).unwrap_or(0)
    }

    /// The first [`LISTED`] diagnostics, errors before warnings, and a line that counts the rest.
    pub fn render(&self) -> String {
        let (errors, warnings): (Vec<_>, Vec<_>) = self.items.iter().partition(|d| d.severity == Severity::Error);
        let all: Vec<_> = errors.into_iter().chain(warnings).collect();
        let mut out: String = all.iter().take(LISTED).map(|d| d.render()).collect::<Vec<_>>().join("\n");
        if all.len() > LISTED {
            let _ = writeln!(out, "\n... and {} more", all.len() - LISTED);
        }
        out
    }

    /// The JSON list of the first [`LISTED`] diagnostics.
    pub fn to_json(&self) -> serde_json::Value {
        self.items.iter().take(LISTED).map(Diagnostic::to_json).collect()
    }
}

impl From<Diagnostic> for Diagnostics {
    fn from(d: Diagnostic) -> Self {
        Self { items: vec![d] }
    }
}

impl std::fmt::Display for Diagnostics {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.render())
    }
}

impl std::error::Error for Diagnostics {}

/// Widest snippet in characters; longer lines are cut around the caret.
const WIDTH: usize = 120;

// the visible part of a line, the characters before the caret in it, and the number of carets
fn window(line: &str, column: usize, length: usize) -> (String, usize, usize) {
    let chars: Vec<char> = line.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
    let at = (column - 1).min(chars.len());
    let begin = if chars.len() <= WIDTH { 0 } else { at.saturating_sub(WIDTH / 3) };
    let end = (begin + WIDTH).min(chars.len());
    let mut text: String = chars[begin..end].iter().collect();
    let mut indent = at - begin;
    if begin > 0 {
        text.insert_str(0, "...");
        indent += 3;
    }
    if end < chars.len() {
        text.push_str("...");
    }
    (text.trim_end().to_owned(), indent, length.clamp(1, (end - at).max(1)))
}

/// A text of the user on one line: control characters become spaces, very long texts are cut.
pub fn one_line(text: &str) -> String {
    const LONGEST: usize = 2000;
    let mut out: String = text.chars().take(LONGEST).map(|c| if c.is_control() { ' ' } else { c }).collect();
    if text.chars().count() > LONGEST {
        out.push_str("...");
    }
    out
}

/// The candidate that is nearest to a misspelt word, if one is near enough.
pub fn nearest<'a>(word: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    if word.chars().count() > 100 {
        return None;
    }
    let lower = word.to_lowercase();
    candidates
        .into_iter()
        .map(|c| (strsim::damerau_levenshtein(&lower, &c.to_lowercase()), c))
        .filter(|(d, c)| {
            // edit distance below the length, and at most about a third of it
            let longest = word.chars().count().max(c.chars().count());
            *d < longest.max(1) && *d <= 1 + longest / 3
        })
        .min_by_key(|(d, _)| *d)
        .map(|(_, c)| c)
}
