//! The three streams: a summary or one JSON document on stdout, messages on stderr.

use super::arguments::{ColorChoice, Common};
use crate::errors::{Diagnostics, Severity};
use std::io::{IsTerminal, Write};
use std::path::PathBuf;

/// Output streams of a command.
#[derive(Clone, Debug)]
pub struct Streams {
    color: bool,
    quiet: bool,
    /// Whether progress messages are written.
    pub verbose: bool,
    /// Whether a progress bar is shown on stderr.
    pub progress: bool,
    /// File of the document, "-" for stdout; `None`: no document.
    pub json: Option<PathBuf>,
}

impl Streams {
    /// The streams of the options.
    pub fn new(common: &Common) -> Self {
        let terminal = std::io::stderr().is_terminal();
        let color = match common.color {
            ColorChoice::Always => true,
            ColorChoice::Never => false,
            ColorChoice::Auto => terminal && std::env::var_os("NO_COLOR").is_none_or(|v| v.is_empty()),
        };
        Self { color, quiet: common.quiet, verbose: common.verbose, progress: terminal && !common.quiet, json: common.json.clone() }
    }

    /// Whether stdout is for the JSON document alone.
    pub fn json_on_stdout(&self) -> bool {
        self.json.as_ref().is_some_and(|file| file.as_os_str() == "-")
    }

    /// Writes the summary to stdout, unless `--quiet` is given or the document is written there.
    ///
    /// # Errors
    /// Errors of writing to stdout; a closed pipe is no error.
    pub fn summary(&self, text: &str) -> std::io::Result<()> {
        if self.quiet || self.json_on_stdout() { Ok(()) } else { to_stdout(text) }
    }

    /// Writes the JSON document, if one is requested.
    ///
    /// # Errors
    /// Errors of writing.
    pub fn document(&self, text: &str) -> std::io::Result<()> {
        match &self.json {
            _ if text.is_empty() => Ok(()),
            None => Ok(()),
            Some(file) if file.as_os_str() == "-" => to_stdout(text),
            Some(file) => super::folder::write_whole(file, text.as_bytes()),
        }
    }

    /// Errors and warnings on stderr.
    pub fn diagnostics(&self, list: &Diagnostics) {
        let mut shown = list.clone();
        if self.quiet {
            shown.items.retain(|d| d.severity == Severity::Error);
        }
        if !shown.is_empty() {
            self.message(&shown.render());
        }
    }

    /// A message on stderr, its leading word coloured.
    pub fn message(&self, text: &str) {
        let text = if self.color { coloured(text) } else { text.to_owned() };
        // a failure of stderr cannot be reported anywhere
        let _ = std::io::stderr().lock().write_all(text.as_bytes());
    }
}

fn coloured(text: &str) -> String {
    let line = |line: &str| {
        let paint = |code: &str, word: &str| line.strip_prefix(word).map(|rest| format!("\x1b[1;{code}m{word}\x1b[0m{rest}"));
        paint("31", "error").or_else(|| paint("33", "warning")).unwrap_or_else(|| line.to_owned())
    };
    text.split_inclusive('\n').map(line).collect()
}

/// Writes to stdout; a closed pipe is no error.
pub fn to_stdout(text: &str) -> std::io::Result<()> {
    let mut out = std::io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(e) if e.kind() == std::io::ErrorKind::BrokenPipe => Ok(()),
        other => other,
    }
}
