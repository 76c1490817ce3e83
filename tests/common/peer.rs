//! The folder of other projects' files, which the tests read where it is there.

use std::path::{Path, PathBuf};

/// The folder: `FAYING_PEER_DATA`, or `shared/peer-data` beside the project; `None`, with a message, where it is absent.
pub fn peer_data() -> Option<PathBuf> {
    let project = Path::new(env!("CARGO_MANIFEST_DIR")).ancestors().find(|folder| folder.join("Cargo.lock").is_file());
    let beside = project.and_then(Path::parent).unwrap_or(Path::new("..")).join("shared/peer-data");
    let folder = std::env::var_os("FAYING_PEER_DATA").map_or(beside, PathBuf::from);
    if folder.is_dir() {
        return Some(folder);
    }
    println!("skipped: there is no folder {}", folder.display());
    None
}
