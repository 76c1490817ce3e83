//! Files that a case names: opened once each, bounded in size, hashed; anything but a regular file is rejected.

use std::io::Read as _;
use std::path::{Path, PathBuf};
use std::rc::Rc;
use std::sync::Arc;

use sha2::{Digest, Sha256};

use super::files::{FileRead, Opened};
use super::reader::Reader;
use crate::codes;
use crate::errors::{Diagnostic, nearest};
use crate::place::{Located, SourceSpan};
use crate::reference::{self, StoredRun};
use faying_files::{Contents, FileError, Limits};

/// Longest refinement list that is read, in bytes.
const LONGEST_LIST: u64 = 16 << 20;

/// SHA-256 of `bytes` in hexadecimal digits.
pub fn sha256(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().map(|b| format!("{b:02x}")).collect()
}

/// The remedy for a mesh or a geometry that cannot be read.
const MESH: &str = "name a file of a mesh or a geometry that may be read";
/// The remedy for a stored run that cannot be read.
const STORED: &str = "`faying run CASE --save-reference FILE` writes stored runs";

/// E003 for a file that a case names and that cannot be read, with `wanted`, or with similar names in its folder where it is missing.
fn cannot_open(name: &str, path: &Path, why: &str, missing: bool, wanted: &str) -> Diagnostic {
    if !missing {
        return Diagnostic::error("E003", format!("cannot read {name}: {why}")).with_help(wanted);
    }
    let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let d = Diagnostic::error("E003", format!("there is no file {name}"));
    if !folder.is_dir() {
        return d.with_help(format!("there is no folder {}", folder.display()));
    }
    let mut names: Vec<String> = std::fs::read_dir(folder)
        .map(|entries| entries.flatten().map(|e| e.file_name().to_string_lossy().into_owned()).collect())
        .unwrap_or_default();
    names.sort();
    let wanted = path.file_name().map_or(String::new(), |n| n.to_string_lossy().into_owned());
    let stem = |n: &str| Path::new(n).file_stem().map_or(String::new(), |s| s.to_string_lossy().to_lowercase());
    let mut similar: Vec<&str> = nearest(&wanted, names.iter().map(String::as_str)).into_iter().collect();
    let own = stem(&wanted);
    for n in &names {
        let close = !own.is_empty() && (stem(n).contains(&own) || (stem(n).len() > 2 && own.contains(&stem(n))));
        if close && !similar.contains(&n.as_str()) && similar.len() < 5 {
            similar.push(n);
        }
    }
    match similar.as_slice() {
        [] => d.with_help("paths are relative to the case file"),
        some => d.with_help(format!("similar names there: {}", some.join(", "))),
    }
}

/// The bytes of a regular file of at most `most` bytes; pipes and devices are rejected, as they may never end.
///
/// # Errors
/// [`FileError::System`], or [`FileError::Memory`] where it is longer.
pub(crate) fn bytes_at(path: &Path, most: Option<u64>) -> Result<Vec<u8>, FileError> {
    let system = |e: std::io::Error| FileError::System { missing: e.kind() == std::io::ErrorKind::NotFound, message: e.to_string() };
    let plain = |message: &str| FileError::System { missing: false, message: message.to_owned() };
    // checked before opening: opening a pipe waits for a writer
    let known = std::fs::metadata(path).map_err(system)?;
    if known.is_dir() {
        return Err(plain("it is a folder"));
    }
    if !known.is_file() {
        return Err(plain("it is no regular file"));
    }
    let most = most.unwrap_or(u64::MAX - 1);
    if known.len() > most {
        return Err(FileError::Memory { needed: known.len(), allowed: most });
    }
    let mut bytes = Vec::new();
    // it may grow meanwhile
    std::fs::File::open(path).map_err(system)?.take(most + 1).read_to_end(&mut bytes).map_err(system)?;
    if bytes.len() as u64 > most {
        return Err(FileError::Memory { needed: bytes.len() as u64, allowed: most });
    }
    Ok(bytes)
}

/// Record of a file that was read.
fn file_read(name: &str, path: PathBuf, bytes: &[u8]) -> FileRead {
    let path = std::fs::canonicalize(&path).unwrap_or(path);
    FileRead { name: name.to_owned(), path, bytes: bytes.len(), sha256: sha256(bytes) }
}

impl Reader {
    /// The path of a name in the case.
    pub fn path_of(&self, name: &str) -> PathBuf {
        self.folder.join(name)
    }

    /// Records a file that was read, once.
    fn keep_read(&mut self, file: FileRead) {
        if !self.files.iter().any(|f| f.path == file.path) {
            self.files.push(file);
        }
    }

    /// Bytes of a file that the case names, recorded among its files; errors are reported at `file` and ask for what is `wanted`.
    fn bytes_of(&mut self, file: &Located<String>, most: Option<u64>, wanted: &str) -> Option<Vec<u8>> {
        let path = self.path_of(&file.value);
        match bytes_at(&path, most) {
            Ok(bytes) => {
                self.keep_read(file_read(&file.value, path, &bytes));
                Some(bytes)
            }
            Err(FileError::System { missing, message }) => {
                self.push(file.at, cannot_open(&short(&file.value), &path, &message, missing, wanted));
                None
            }
            Err(e) => {
                self.file_fault(&file.value, file.at, &e);
                None
            }
        }
    }

    /// Contents of a geometry file; it is read once, and its errors are reported once.
    pub fn open(&mut self, file: &Located<String>) -> Option<Rc<Contents>> {
        let path = self.path_of(&file.value);
        let path = std::fs::canonicalize(&path).unwrap_or(path);
        if let Some(known) = self.opened.iter().find(|o| o.path == path) {
            return known.contents.clone();
        }
        let memory = self.memory;
        let contents = self.bytes_of(file, memory, MESH).and_then(|bytes| {
            let mut included = Vec::new();
            let folder = path.parent().unwrap_or(Path::new("")).to_owned();
            let mut include = |name: &str| {
                let path = folder.join(name);
                let bytes = bytes_at(&path, memory)?;
                included.push(file_read(name, path, &bytes));
                Ok(bytes)
            };
            let parsed = faying_files::parse_with("the file", &bytes, &Limits { memory }, &mut include);
            included.into_iter().for_each(|file| self.keep_read(file));
            match parsed {
                Ok(contents) => Some(Rc::new(contents)),
                Err(e) => {
                    self.file_fault(&file.value, file.at, &e);
                    None
                }
            }
        });
        self.opened.push(Opened { path, contents: contents.clone() });
        contents
    }

    /// The text of a small file beside the geometry.
    pub fn open_list(&mut self, file: &Located<String>) -> Option<Vec<u8>> {
        let mut bytes = self.bytes_of(file, Some(self.memory.map_or(LONGEST_LIST, |m| m.min(LONGEST_LIST))), MESH)?;
        // the byte order mark is not part of the text
        if bytes.starts_with(faying_files::BYTE_ORDER_MARK) {
            bytes.drain(..faying_files::BYTE_ORDER_MARK.len());
        }
        Some(bytes)
    }

    /// The stored run of a file.
    pub fn open_reference(&mut self, file: &Located<String>) -> Option<Arc<StoredRun>> {
        let memory = self.memory;
        let bytes = self.bytes_of(file, memory, STORED)?;
        match reference::read(&bytes, &Limits { memory }) {
            Ok(run) => Some(Arc::new(run)),
            Err(e) => {
                let help = match e {
                    FileError::Memory { .. } => "raise --max-memory, or store a coarser run",
                    _ => STORED,
                };
                self.fault(codes::of_file(&e), file.at, format!("{}: {e}", short(&file.value)), help);
                None
            }
        }
    }

    /// Reports an error in a file, at the place of the case that names it.
    pub fn file_fault(&mut self, file: &str, at: SourceSpan, error: &FileError) {
        let help = match error {
            FileError::Memory { .. } => "raise --max-memory, or give a smaller file",
            FileError::Unsupported { .. } => {
                "read are: G+Smo XML, MFEM meshes, Gmsh 2.2 and 4.1, VTU, Abaqus input files; `faying inspect` shows what a file holds"
            }
            FileError::Twisted { .. } => "list the corners of the element in their order around it; `faying inspect` names such elements",
            FileError::Broken { .. } => "`faying inspect` shows what a file holds",
            FileError::Dimension { .. } => {
                "`dimension` of the case and of what the file holds must be the same, and points of a plane case have z = 0; \
                 `faying inspect` shows what a file holds"
            }
            _ => "",
        };
        self.fault(codes::of_file(error), at, format!("{}: {error}", short(file)), help);
    }
}

fn short(text: &str) -> String {
    match text.chars().count() {
        n if n > 120 => format!("..{}", text.chars().skip(n - 120).collect::<String>()),
        _ => text.to_owned(),
    }
}
