//! Gmsh's MSH files, versions 2.2 and 4.1, text and binary.
//!
//! Source: Gmsh 4.15 reference manual, "MSH file format". Elements of order 1 to 4 are complete ones; their nodes are kept with the first
//! axis fastest (see [`MeshBlock`](super::MeshBlock)). Groups are the physical groups; an element of version 2.2 stands in the file once
//! per group and is one element here. Partitions, periodic nodes, ghost elements and fields are skipped with a note.

mod collect;
mod kinds;
mod nodes;
mod parse;
mod scan;
mod write;

pub(super) use kinds::lexicographic;
pub(super) use nodes::Lookup;

use super::{FileError, Limits, MeshFile};

/// Whether the bytes look like an MSH file, of whatever version.
pub fn recognises(bytes: &[u8]) -> bool {
    let start = &bytes[..bytes.len().min(1 << 12)];
    let start = start.trim_ascii_start();
    [&b"$MeshFormat"[..], b"$NOD", b"$Comments", b"$PhysicalNames"].iter().any(|head| start.starts_with(head))
}

/// Reads an MSH file of version 2.2 or 4.1.
///
/// Blocks are sorted by shape, order and groups, cells within one as in the file; groups by dimension and number. Time is linear in the
/// length of the file, but for sorting nodes whose numbers have wide gaps and finding elements of version 2.2 that stand once per group.
///
/// # Errors
/// [`FileError::Unsupported`] for other versions, incomplete elements and orders above 4; [`FileError::Broken`] with the line, or in
/// binary data the byte; [`FileError::Memory`] before memory beyond the limit is taken, the bytes of the file counted.
pub fn parse(bytes: &[u8], limits: &Limits) -> Result<MeshFile, FileError> {
    parse::parse(bytes, limits)
}

/// Returns the bytes of an MSH file of version 4.1.
///
/// Every set of groups becomes an entity of its own. Numbers of points and elements are kept if they are positive and unique, else all
/// are renumbered. [`parse`] returns an equal mesh, apart from notes, with equal bits of every coordinate.
///
/// # Errors
/// [`FileError::Unsupported`] for orders above 4.
pub fn write(mesh: &MeshFile, binary: bool) -> Result<Vec<u8>, FileError> {
    write::write(mesh, binary)
}
