//! Options that this version does not implement: exit 2.

use clap::error::{ContextKind, ContextValue, ErrorKind};
use std::ffi::OsString;

/// Options that are not implemented, each with its command.
const OPTIONS: &[(&str, &str)] = &[("run", "--resume")];

/// "`--resume` is not in this version", if `error` is about an option that is not implemented.
pub fn of(error: &clap::Error, words: &[OsString]) -> Option<String> {
    let context = |kind: ContextKind| match error.get(kind) {
        Some(ContextValue::String(text)) => Some(text.as_str()),
        _ => None,
    };
    let word = context(ContextKind::InvalidArg).filter(|_| error.kind() == ErrorKind::UnknownArgument)?;
    OPTIONS.iter().find(|(command, option)| *option == word && words.iter().any(|w| w == command))?;
    Some(format!("`{word}` is not in this version"))
}
