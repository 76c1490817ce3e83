//! Place of the document of `--json=FILE`: never over a file that the command reads or writes itself.

use super::ended::Exit;
use crate::errors::Diagnostic;
use std::ffi::OsString;
use std::path::{Component, Path, PathBuf};

/// Checks that the document can be written to `file` and that no argument names the same file.
///
/// # Errors
/// Exit 2 or E091, without a document.
pub fn document(file: Option<&Path>, words: &[OsString]) -> Result<(), Exit> {
    let Some(file) = file.filter(|f| f.as_os_str() != "-") else { return Ok(()) };
    if let Some(word) = words.iter().skip(1).find(|word| !is_option(word) && same(Path::new(word), file)) {
        let message = format!("--json would write over `{}`", word.to_string_lossy());
        return Err(
            super::ended::usage(&message, Some("give the document a file of its own, such as --json=result.json")).without_document()
        );
    }
    let folder = parent(file);
    if folder.is_dir() && !file.is_dir() {
        return Ok(());
    }
    let why = if file.is_dir() { "it is a folder".to_owned() } else { format!("there is no folder `{}`", folder.display()) };
    let problem = Diagnostic::error("E091", format!("--json cannot write `{}`: {why}", file.display()));
    Err(Exit::from(problem.with_help("make the folder, or give another file")).without_document())
}

/// Checks that the document is no file in the folder of results, which the run owns.
///
/// # Errors
/// Exit 2, without a document.
pub fn beside_results(file: Option<&Path>, out: &Path) -> Result<(), Exit> {
    let Some(file) = file.filter(|f| f.as_os_str() != "-") else { return Ok(()) };
    if absolute(parent(file)) != absolute(out) {
        return Ok(());
    }
    let message = format!("--json cannot write `{}`: that folder is for the files of the run", file.display());
    let help = format!("`{}` is the same document: leave --json out, or give a file elsewhere", out.join("result.json").display());
    Err(super::ended::usage(&message, Some(&help)).without_document())
}

/// Checks that the document is not the file that the command writes.
///
/// # Errors
/// Exit 2, without a document.
pub fn not_over(file: Option<&Path>, written: &Path) -> Result<(), Exit> {
    match file {
        Some(file) if file.as_os_str() != "-" && absolute(file) == absolute(written) => {
            let message = format!("--json would write over `{}`", written.display());
            Err(super::ended::usage(&message, Some("give the document a file of its own")).without_document())
        }
        _ => Ok(()),
    }
}

/// Checks that the written file is not the one that is read.
///
/// # Errors
/// Exit 2.
pub fn apart(written: &Path, read: &Path, option: &str) -> Result<(), Exit> {
    if absolute(written) != absolute(read) {
        return Ok(());
    }
    Err(super::ended::usage(&format!("{option} would write over `{}`", read.display()), Some("give another file")))
}

fn is_option(word: &OsString) -> bool {
    word.to_string_lossy().starts_with('-')
}

fn parent(file: &Path) -> &Path {
    file.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or_else(|| Path::new("."))
}

/// Whether two paths lead to one file that exists.
fn same(a: &Path, b: &Path) -> bool {
    matches!((std::fs::canonicalize(a), std::fs::canonicalize(b)), (Ok(a), Ok(b)) if a == b && a.is_file())
}

/// The path from the root, links followed as far as it exists.
fn absolute(path: &Path) -> PathBuf {
    let start = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    let mut out = PathBuf::new();
    for part in start.components() {
        match part {
            Component::ParentDir => {
                out.pop();
            }
            other => out.push(other),
        }
        if let Ok(found) = std::fs::canonicalize(&out) {
            out = found;
        }
    }
    out
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn folders_are_compared_before_they_exist() {
        let at = tempfile::tempdir().unwrap();
        let out = at.path().join("a.out");
        assert!(beside_results(Some(&at.path().join("b/../a.out/./r.json")), &out).is_err());
        std::fs::create_dir(&out).unwrap();
        assert!(beside_results(Some(&out.join("result.json")), &out).is_err());
        assert!(beside_results(Some(&at.path().join("r.json")), &out).is_ok());
        assert!(beside_results(None, &out).is_ok());
    }
}
