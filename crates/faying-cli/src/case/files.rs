//! Files that a case reads.

use faying_files::Contents;
use std::path::PathBuf;
use std::rc::Rc;

/// A file that was read for a case, beside the case file.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct FileRead {
    /// Its name as the case has it.
    pub name: String,
    /// Its absolute path.
    pub path: PathBuf,
    /// Its size in bytes.
    pub bytes: usize,
    /// SHA-256 of its bytes, in hexadecimal digits.
    pub sha256: String,
}

/// A geometry file and its contents; `None` if it has an error, which was reported.
#[derive(Debug)]
pub(super) struct Opened {
    pub(super) path: PathBuf,
    pub(super) contents: Option<Rc<Contents>>,
}
