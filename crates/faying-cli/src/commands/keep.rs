//! `--save-reference FILE`: the file of the stored run.

use super::folder::write_whole;
use super::manifest::Input;
use crate::case::sha256;
use crate::errors::Diagnostic;
use crate::reference::{self, MAGIC, StoredRun};
use std::io::Read;
use std::path::Path;

/// Checks, before solving, whether a stored run may be written to `file`: without `force` it replaces no file but another stored run
/// that is none of the `inputs` of this run.
///
/// # Errors
/// E090 if `file` must not be replaced, E091 if its folder does not exist.
pub fn claim(file: &Path, inputs: &[Input], force: bool) -> Result<(), Diagnostic> {
    let folder = file.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    if !folder.is_dir() {
        let message = format!("`{}` cannot be written: there is no folder `{}`", file.display(), folder.display());
        return Err(Diagnostic::error("E091", message).with_help("make the folder, or name another file"));
    }
    let Ok(known) = std::fs::metadata(file) else { return Ok(()) };
    let taken = |why: &str| {
        Err(Diagnostic::error("E090", format!("`{}` {why}", file.display())).with_help("name another file for --save-reference"))
    };
    if known.is_dir() {
        return taken("is a folder");
    }
    let mut start = Vec::new();
    let read = known.is_file().then(|| std::fs::File::open(file).and_then(|f| f.take(MAGIC.len() as u64).read_to_end(&mut start)));
    let is_ours = read.is_none_or(|done| done.is_ok()) && (start == MAGIC || known.len() == 0);
    if known.is_file() && !force && !is_ours {
        return taken("is there and is no stored run; --force overwrites it");
    }
    let bytes = if is_ours && !force { std::fs::read(file).unwrap_or_default() } else { Vec::new() };
    if !bytes.is_empty() && inputs.iter().any(|input| input.sha256 == sha256(&bytes)) {
        return taken("is the `reference` of this run; --force overwrites it");
    }
    Ok(())
}

/// Writes the stored run, whole or not at all.
///
/// # Errors
/// E091 if that fails.
pub fn write(file: &Path, run: &StoredRun) -> Result<(), Diagnostic> {
    write_whole(file, &reference::write(run)).map_err(|e| {
        Diagnostic::error("E091", format!("writing `{}` failed: {e}", file.display())).with_help("name another file for --save-reference")
    })
}
