//! The output folder: the case that owns it, files that may be replaced, atomic writes.

use super::manifest::Manifest;
use crate::errors::Diagnostic;
use std::io::Write;
use std::path::{Path, PathBuf};

/// Name of the list of files that faying wrote.
pub const MANIFEST: &str = "manifest.json";

/// A folder that may be written to.
#[derive(Clone, Debug)]
pub struct Folder {
    path: PathBuf,
    /// Files of an earlier run of the same case.
    old: Vec<String>,
}

impl Folder {
    /// Checks whether results of `case` with this hash may be written to `path`; creates nothing.
    ///
    /// The case is the same if its path is, whatever the contents, or if its text is and the old path is gone; on stdin the text decides.
    ///
    /// # Errors
    /// E090 if the folder holds anything but results of the same case and `force` is not given.
    pub fn claim(path: &Path, case: &str, sha256: &str, force: bool) -> Result<Self, Diagnostic> {
        let taken = |why: &str| {
            Diagnostic::error("E090", format!("output folder `{}` {why}", path.display()))
                .with_help("choose another folder with --out, or overwrite files of the same name with --force")
        };
        let unreadable = |e: std::io::Error| {
            Diagnostic::error("E091", format!("output folder `{}` cannot be read: {e}", path.display()))
                .with_help("choose another folder with --out")
        };
        let mut folder = Self { path: path.to_owned(), old: Vec::new() };
        let entries = match std::fs::read_dir(path) {
            Err(e) if e.kind() == std::io::ErrorKind::NotFound => return Ok(folder),
            Err(e) if e.kind() == std::io::ErrorKind::NotADirectory => return Err(taken("is a file")),
            Err(e) => return Err(unreadable(e)),
            Ok(entries) => entries,
        };
        if entries.take(1).count() == 0 || force {
            return Ok(folder);
        }
        match Manifest::read(&path.join(MANIFEST)) {
            None => Err(taken("holds files that faying did not write")),
            Some(manifest) if !is_same(&manifest, case, sha256) => {
                let other = if manifest.case_path == "-" { "read from stdin".to_owned() } else { format!("`{}`", manifest.case_path) };
                Err(taken(&format!("holds the results of another case, {other}")))
            }
            Some(manifest) => {
                // a manipulated list must not reach beyond the folder
                folder.old = manifest.files.into_iter().filter(|name| is_plain(name)).collect();
                Ok(folder)
            }
        }
    }

    /// Path of the folder.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Removes the files of the earlier run and makes the folder.
    ///
    /// # Errors
    /// E091 if the folder cannot be made or an old file cannot be removed.
    pub fn open(&self) -> Result<(), Diagnostic> {
        std::fs::create_dir_all(&self.path).map_err(|e| failed(&self.path, &e))?;
        for name in &self.old {
            let file = self.path.join(name);
            match std::fs::remove_file(&file) {
                Err(e) if e.kind() != std::io::ErrorKind::NotFound => return Err(failed(&file, &e)),
                _ => {}
            }
        }
        Ok(())
    }

    /// Writes one file atomically.
    ///
    /// # Errors
    /// E091 if that fails; then there is no such file.
    pub fn write(&self, name: &str, bytes: &[u8]) -> Result<(), Diagnostic> {
        let file = self.path.join(name);
        write_whole(&file, bytes).map_err(|e| failed(&file, &e))
    }
}

/// Whether the results of `manifest` are those of `case` with this hash.
fn is_same(manifest: &Manifest, case: &str, sha256: &str) -> bool {
    let same_text = manifest.inputs.first().is_some_and(|input| input.sha256 == sha256);
    match manifest.case_path == case {
        true => case != "-" || same_text,
        false => same_text && !Path::new(&manifest.case_path).exists(),
    }
}

/// Whether `name` is the name of a file in this very folder.
fn is_plain(name: &str) -> bool {
    let mut parts = Path::new(name).components();
    matches!((parts.next(), parts.next()), (Some(std::path::Component::Normal(one)), None) if one == name) && !name.contains(['/', '\\'])
}

fn failed(file: &Path, error: &std::io::Error) -> Diagnostic {
    Diagnostic::error("E091", format!("writing `{}` failed: {error}", file.display()))
        .with_help("make room or permissions, or choose another folder with --out")
}

/// Writes a file atomically: a temporary file beside it is moved into its place.
///
/// # Errors
/// The error of the file system.
pub fn write_whole(file: &Path, bytes: &[u8]) -> std::io::Result<()> {
    if file.is_dir() {
        return Err(std::io::Error::new(std::io::ErrorKind::IsADirectory, "it is a folder"));
    }
    if std::fs::metadata(file).is_ok_and(|known| !known.is_file()) {
        // a device or a pipe is written to, not replaced
        return std::fs::OpenOptions::new().write(true).open(file)?.write_all(bytes);
    }
    beside(file, bytes)?.persist(file).map(|_| ()).map_err(|e| e.error)
}

/// Writes a new file atomically, never over another one; makes its folder.
///
/// # Errors
/// `AlreadyExists`, or another error of the file system.
pub fn write_new(file: &Path, bytes: &[u8]) -> std::io::Result<()> {
    if let Some(folder) = file.parent().filter(|p| !p.as_os_str().is_empty()) {
        std::fs::create_dir_all(folder)?;
    }
    beside(file, bytes)?.persist_noclobber(file).map(|_| ()).map_err(|e| e.error)
}

/// A temporary file with `bytes` in the folder of `file`.
fn beside(file: &Path, bytes: &[u8]) -> std::io::Result<tempfile::NamedTempFile> {
    let folder = file.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or_else(|| Path::new("."));
    let mut builder = tempfile::Builder::new();
    builder.prefix(".faying-");
    #[cfg(unix)]
    {
        // permissions of any new file; the system applies the user's mask
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(std::fs::Permissions::from_mode(0o666));
    }
    let mut temporary = builder.tempfile_in(folder)?;
    temporary.write_all(bytes)?;
    temporary.as_file().sync_data().or_else(ignore_unsupported)?;
    Ok(temporary)
}

// some file systems do not support sync
fn ignore_unsupported(e: std::io::Error) -> std::io::Result<()> {
    if e.kind() == std::io::ErrorKind::InvalidInput || e.kind() == std::io::ErrorKind::Unsupported { Ok(()) } else { Err(e) }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn only_files_of_the_folder_itself_are_plain() {
        assert!(is_plain("fields.vtu"));
        for odd in ["../x", "/etc/passwd", "a/b", "..", ".", "", "a\\b", "fields.vtu/"] {
            assert!(!is_plain(odd), "{odd}");
        }
    }

    #[test]
    fn a_file_appears_whole_and_replaces_the_old_one() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("a.txt");
        write_whole(&file, b"one").unwrap();
        write_whole(&file, b"two").unwrap();
        assert_eq!(std::fs::read(&file).unwrap(), b"two");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
        assert!(write_whole(folder.path(), b"x").is_err());
    }
}
