//! The folder of other projects' files, which the tests read where it is there.

use std::path::PathBuf;

/// The folder: `FAYING_PEER_DATA`, or `../shared/peer-data` beside the crate; `None`, with a message, where it is absent.
pub fn peer_data() -> Option<PathBuf> {
    let beside = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../shared/peer-data");
    let folder = std::env::var_os("FAYING_PEER_DATA").map_or(beside, PathBuf::from);
    if folder.is_dir() {
        return Some(folder);
    }
    println!("skipped: there is no folder {}", folder.display());
    None
}
