//! Writing a stored run: the same bytes for the same run.

use super::numbers::{put_exact, put_rounded};
use super::{MAGIC, StoredRun};
use flate2::Compression;
use flate2::write::ZlibEncoder;
use std::io::Write;

/// The bytes of the file.
///
/// # Panics
/// If the head is longer than 4 GiB.
pub fn write(run: &StoredRun) -> Vec<u8> {
    let head = serde_json::to_vec(run).expect("a stored run has string keys and plain values only");
    let mut out = u32::try_from(head.len()).expect("names fit into 4 GiB").to_le_bytes().to_vec();
    out.extend(head);
    for patch in &run.patches {
        put_exact(&mut out, &[patch.breakpoints.len() as f64]);
        patch.breakpoints.iter().for_each(|list| put_exact(&mut out, list));
        put_rounded(&mut out, &patch.coefficients, run.components, run.components * patch.row);
    }
    for side in &run.sides {
        put_exact(&mut out, &side.facets);
        put_rounded(&mut out, &side.values, side.components, side.components * (side.degree + 1));
    }
    let mut encoder = ZlibEncoder::new(MAGIC.to_vec(), Compression::best());
    encoder.write_all(&out).expect("writing to memory does not fail");
    encoder.finish().expect("writing to memory does not fail")
}
