//! End of a command: its exit code, its document, its messages.

use crate::errors::{Diagnostic, Diagnostics};
use crate::json;
use serde_json::{Value, json};

/// The end of a command.
#[derive(Clone, Debug, Default)]
pub struct Exit {
    /// The exit code.
    pub exit: i32,
    /// Summary on stdout, unless the document is written there.
    pub summary: String,
    /// The JSON document; empty if it cannot be written.
    pub document: String,
    /// Errors and warnings on stderr.
    pub diagnostics: Diagnostics,
    /// Message and advice on stderr for an error without a code.
    pub message: Option<(String, Option<String>)>,
}

/// The status that goes with an exit code.
pub fn status(exit: i32) -> &'static str {
    match exit {
        0 => "ok",
        1 => "check-failed",
        4 => "io-failed",
        5 => "singular",
        6 => "limit",
        70 => "internal",
        130 => "interrupted",
        _ => "invalid",
    }
}

impl Exit {
    /// Ended by `diagnostics`, before there was a result.
    pub fn failed(diagnostics: Diagnostics) -> Self {
        Self::refused(diagnostics.exit(), diagnostics)
    }

    /// Ended by `diagnostics` with this exit code; the document has no numbers.
    pub fn refused(exit: i32, diagnostics: Diagnostics) -> Self {
        let document = failure(status(exit), exit, diagnostics.to_json());
        Self { exit, document, diagnostics, ..Self::default() }
    }

    /// Ended by a message without a code.
    pub fn plain(status: &str, exit: i32, message: &str, help: Option<&str>) -> Self {
        let message_and_help = Some((message.to_owned(), help.map(str::to_owned)));
        Self { exit, document: plain_failure(status, exit, message, help), message: message_and_help, ..Self::default() }
    }

    /// Returns this end without its document.
    #[must_use]
    pub fn without_document(self) -> Self {
        Self { document: String::new(), ..self }
    }

    /// Done without a result: `fields` are added to the document.
    pub fn done(command: &str, summary: String, fields: Value) -> Self {
        let mut document =
            json!({"schema": "faying.result/1", "version": env!("CARGO_PKG_VERSION"), "command": command, "status": "ok", "exit": 0});
        if let (Some(all), Value::Object(more)) = (document.as_object_mut(), fields) {
            all.extend(more);
        }
        Self { summary, document: json::text(&document), ..Self::default() }
    }
}

impl From<Diagnostic> for Exit {
    fn from(diagnostic: Diagnostic) -> Self {
        Self::failed(diagnostic.into())
    }
}

/// The document of a failure.
pub fn failure(status: &str, exit: i32, diagnostics: Value) -> String {
    json::text(
        &json!({"schema": "faying.result/1", "version": env!("CARGO_PKG_VERSION"), "status": status, "exit": exit, "checks": [], "diagnostics": diagnostics}),
    )
}

/// The document of a failure that has no code: usage and internal errors.
pub fn plain_failure(status: &str, exit: i32, message: &str, help: Option<&str>) -> String {
    failure(
        status,
        exit,
        json!([{"code": null, "severity": "error", "message": message, "file": null, "line": null, "column": null, "help": help}]),
    )
}

/// A wrong use of the command line: exit 2.
pub(super) fn usage(message: &str, help: Option<&str>) -> Exit {
    Exit::plain("invalid", 2, message, help)
}
