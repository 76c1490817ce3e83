//! `manifest.json`: command, inputs, times and files of a run.

use serde::{Deserialize, Serialize};
use std::path::Path;

/// A file that was read.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Input {
    /// Its name as the user wrote it.
    pub file: String,
    /// Its size.
    pub bytes: usize,
    /// SHA-256 of its bytes.
    pub sha256: String,
}

impl Input {
    /// A file with its size and hash.
    pub fn new(file: impl Into<String>, bytes: &[u8]) -> Self {
        Self { file: file.into(), bytes: bytes.len(), sha256: crate::case::sha256(bytes) }
    }
}

/// Seconds of a phase.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PhaseSeconds {
    /// Its name.
    pub phase: String,
    /// Wall-clock seconds, repeated phases added up.
    pub seconds: f64,
}

/// The content of `manifest.json`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Manifest {
    /// "faying.manifest/1".
    pub schema: String,
    /// Version of the program.
    pub version: String,
    /// "run", "compare", ...
    pub command: String,
    /// The case as the user wrote it.
    pub case: String,
    /// The case as an absolute path, "-" for stdin: identifies the case that owns the folder.
    pub case_path: String,
    /// The words after the program's name.
    pub options: Vec<String>,
    /// Files that were read.
    pub inputs: Vec<Input>,
    /// Threads that were used.
    pub threads: usize,
    /// Seconds of every phase, of a study of every row, in order.
    pub seconds: Vec<PhaseSeconds>,
    /// Files that were written, this one included.
    pub files: Vec<String>,
}

impl Manifest {
    /// Reads a manifest; `None` if there is none or faying did not write it.
    pub fn read(file: &Path) -> Option<Self> {
        let text = std::fs::read_to_string(file).ok()?;
        serde_json::from_str(&text).ok().filter(|m: &Self| m.schema.starts_with("faying.manifest/"))
    }

    /// The text of the file.
    pub fn to_json(&self) -> String {
        let mut text = serde_json::to_string_pretty(self).expect("a manifest has string keys and plain values only");
        text.push('\n');
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inputs_carry_their_sha_256() {
        // FIPS 180-4, the empty message
        assert_eq!(Input::new("a", b"").sha256, "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
    }
}
