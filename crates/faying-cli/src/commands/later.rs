//! Commands and options that this version does not implement: exit 2.

use clap::error::{ContextKind, ContextValue, ErrorKind};
use std::ffi::OsString;

/// Commands that are not implemented.
const COMMANDS: &[&str] = &["completions", "man"];
/// Options that are not implemented, each with its command.
const OPTIONS: &[(&str, &str)] = &[("run", "--no-pictures"), ("run", "--dry"), ("run", "--watch"), ("run", "--resume")];

/// "`--watch` is not in this version", if `error` is about a command or an option that is not implemented.
pub fn of(error: &clap::Error, words: &[OsString]) -> Option<String> {
    let context = |kind: ContextKind| match error.get(kind) {
        Some(ContextValue::String(text)) => Some(text.as_str()),
        _ => None,
    };
    let word = match error.kind() {
        ErrorKind::InvalidSubcommand => context(ContextKind::InvalidSubcommand).filter(|word| COMMANDS.contains(word))?,
        ErrorKind::UnknownArgument => {
            let word = context(ContextKind::InvalidArg)?;
            let known = |&&(command, option): &&(&str, &str)| option == word && words.iter().any(|w| w == command);
            OPTIONS.iter().find(known).map(|_| word)?
        }
        _ => return None,
    };
    Some(format!("`{word}` is not in this version"))
}
