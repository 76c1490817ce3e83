//! Meshes of Abaqus and CalculiX input files (`.inp`).
//!
//! Source: Abaqus 2023 keywords and elements guides; CalculiX CrunchiX 2.21 user's manual. Read are nodes, elements and sets, in files that
//! include others; everything else, materials and steps among it, is passed over with a note. Words are read in upper and lower case alike.
//!
//! | keyword | meaning |
//! | --- | --- |
//! | `*NODE`, `*ELEMENT` | nodes; elements of the types below |
//! | `*ELSET` | a group of elements |
//! | `*SURFACE` of faces `S1` to `S6` | a side |
//! | `*NSET`, `*SURFACE, TYPE=NODE` | a side of the facets of the boundary all of whose nodes are in the set; if there is none, in space the edges of such facets, else the corners |
//! | `*INCLUDE, INPUT=file` | the contents of another file, relative to the folder of the first one |
//!
//! Elements: `CPE`, `CPS`, `CAX`, `DC2D`, `DCAX` of 3, 4, 6 and 8 nodes; `C3D`, `DC3D` of 4, 8, 10 and 20 nodes, and of 5 (pyramids) and
//! 6 (prisms), of which no body is made; `T2D`, `T3D` of 2 and 3 nodes as lines, the middle node of 3 being the one between the two that are
//! farthest apart, since programs list it second or last; each with any letters behind that choose integration or further unknowns.
//! Quadrilaterals of 8 and hexahedra of 20 nodes get the nodes in the middle of faces and cells where their own map has them, so that
//! their shape does not change.

mod build;
mod facets;
mod kinds;
mod lines;
mod sets;

use super::{FileError, Limits, MeshFile};

/// Returns the bytes of a file that another one includes, by the name that stands there.
pub type Include<'a> = dyn FnMut(&str) -> Result<Vec<u8>, FileError> + 'a;

/// Whether the bytes look like an input file: the first line that is no comment begins with `*` and a letter.
pub fn recognises(bytes: &[u8]) -> bool {
    let mut lines = bytes.split(|b| *b == b'\n').map(<[u8]>::trim_ascii).filter(|l| !l.is_empty() && !l.starts_with(b"**"));
    lines.next().is_some_and(|l| l.len() > 1 && l[0] == b'*' && l[1].is_ascii_alphabetic())
}

/// Reads a mesh.
///
/// # Errors
/// [`FileError::Unsupported`] for other elements, several parts, moved instances, and keywords that generate nodes or elements;
/// [`FileError::Broken`] with the line; [`FileError::Memory`]; errors of `include`.
pub fn parse(bytes: &[u8], limits: &Limits, include: &mut Include<'_>) -> Result<MeshFile, FileError> {
    let mut reader = lines::Reader::new(bytes.len(), limits, include);
    reader.file(bytes)?;
    build::mesh(reader.finish()?)
}
