//! Reader of files of any format, which is detected from the contents.

use super::inp::{self, Include};
use super::text::shown;
use super::{Contents, FileError, Limits, Spot, gismo, gmsh, mfem, vtu_read};
use std::fs::File;
use std::io::{ErrorKind, Read};
use std::path::Path;

/// Default limit of the bytes of a file, which also ends endless files.
const MOST: u64 = 1 << 32;

/// Reads a file of any format.
///
/// # Errors
/// [`FileError::System`] if it cannot be opened or read, and for devices; [`FileError::Memory`] for a file longer than the limit,
/// before it is read; otherwise as [`parse`].
pub fn read(path: &Path, limits: &Limits) -> Result<Contents, FileError> {
    // callers put the name of the file in front of the message
    parse_with("the file", &read_bytes(path, limits)?, limits, &mut beside(path, limits))
}

/// Reads the files that the file at `path` includes; relative names are looked up in its folder.
pub fn beside<'a>(path: &'a Path, limits: &'a Limits) -> impl FnMut(&str) -> Result<Vec<u8>, FileError> + 'a {
    move |name| read_bytes(&path.parent().unwrap_or(Path::new("")).join(name), limits)
}

/// Reads the bytes of a file, within the limit.
///
/// # Errors
/// As [`read`], except errors of the contents.
pub fn read_bytes(path: &Path, limits: &Limits) -> Result<Vec<u8>, FileError> {
    let system = |e: std::io::Error| FileError::System { missing: e.kind() == ErrorKind::NotFound, message: e.to_string() };
    let allowed = limits.memory.unwrap_or(MOST);
    let about = std::fs::metadata(path).map_err(system)?;
    if about.is_dir() {
        return Err(FileError::System { missing: false, message: "it is a folder".to_string() });
    }
    if is_device(&about) {
        return Err(FileError::System { missing: false, message: "it is a device".to_string() });
    }
    if about.is_file() && about.len() > allowed {
        return Err(FileError::Memory { needed: about.len(), allowed });
    }
    let file = File::open(path).map_err(system)?;
    let mut bytes = Vec::new();
    let expected = if about.is_file() { about.len() } else { 0 };
    bytes
        .try_reserve_exact(usize::try_from(expected).unwrap_or(usize::MAX))
        .map_err(|_| FileError::Memory { needed: expected, allowed })?;
    // One byte more than allowed detects a longer file, even an endless one.
    file.take(allowed.saturating_add(1)).read_to_end(&mut bytes).map_err(system)?;
    if bytes.len() as u64 > allowed {
        return Err(FileError::Memory { needed: bytes.len() as u64, allowed });
    }
    Ok(bytes)
}

/// Whether it is a device: these have no known end; a pipe has one and is read up to the limit.
fn is_device(about: &std::fs::Metadata) -> bool {
    #[cfg(unix)]
    {
        use std::os::unix::fs::FileTypeExt;
        about.file_type().is_char_device() || about.file_type().is_block_device()
    }
    #[cfg(not(unix))]
    {
        let _ = about;
        false
    }
}

/// Reads the bytes of a file of any format that includes no other; `name` is used in messages alone.
///
/// # Errors
/// [`FileError::Unsupported`] for a format or a kind that is not read, [`FileError::Broken`], [`FileError::Memory`].
pub fn parse(name: &str, bytes: &[u8], limits: &Limits) -> Result<Contents, FileError> {
    let none = |_: &str| Err(FileError::System { missing: false, message: "it was read without its folder".into() });
    parse_with(name, bytes, limits, &mut { none })
}

/// Reads the bytes of a file of any format; `include` returns the bytes of files that it includes.
///
/// # Errors
/// As [`parse`], and those of `include`.
pub fn parse_with(name: &str, bytes: &[u8], limits: &Limits, include: &mut Include<'_>) -> Result<Contents, FileError> {
    // some editors write a byte order mark before UTF-8
    let text = bytes.strip_prefix(super::BYTE_ORDER_MARK).unwrap_or(bytes);
    let start = text.trim_ascii_start();
    if gmsh::recognises(text) {
        return gmsh::parse(text, limits).map(Contents::Mesh);
    }
    if start.starts_with(b"MFEM") {
        return mfem::parse(text, limits);
    }
    if vtu_read::recognises(text) {
        return vtu_read::parse(text, limits)?.mesh().map(Contents::Mesh);
    }
    if start.starts_with(b"<") {
        return gismo::parse(text, limits).map(Contents::Patches);
    }
    if inp::recognises(text) {
        return inp::parse(text, limits, include).map(Contents::Mesh);
    }
    let what = format!(
        "{} {}; G+Smo XML, MFEM meshes, Gmsh MSH files, VTU grids and Abaqus input files are read",
        shown(name.as_bytes()),
        looks(bytes)
    );
    Err(FileError::Broken { what, spot: Some(Spot::Line(1)) })
}

/// Description of unrecognised contents, for a message.
fn looks(bytes: &[u8]) -> String {
    let start = &bytes[..bytes.len().min(1 << 12)];
    let first = start.split(|b| *b == b'\n').find(|l| !l.trim_ascii().is_empty()).unwrap_or_default().trim_ascii();
    let binary = start.iter().filter(|b| **b == 0 || (**b < 32 && !b.is_ascii_whitespace())).count();
    if bytes.is_empty() {
        "is empty".to_string()
    } else if first.is_empty() {
        "is blank".to_string()
    } else if binary > 0 {
        "looks like binary data of another format".to_string()
    } else if start.starts_with(b"{") {
        "looks like JSON".to_string()
    } else if start.starts_with(b"# vtk DataFile") {
        "looks like a legacy VTK file".to_string()
    } else if start.starts_with(b"solid") {
        "looks like an STL file".to_string()
    } else if start.starts_with(b"ISO-10303-21") {
        "looks like a STEP file".to_string()
    } else {
        format!("begins with \"{}\"", shown(first))
    }
}
