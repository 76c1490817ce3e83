//! Geometry and mesh files, against files of other systems and against themselves.
#![allow(clippy::unwrap_used)]

mod abaqus;
mod common;
mod gmsh;
mod splines;
mod vtu_files;

use faying_files::FileError;

/// The kind of an error in one word.
fn kind(error: &FileError) -> &'static str {
    match error {
        FileError::Unsupported { .. } | FileError::Broken { .. } => "content",
        FileError::Dimension { .. } => "dimension",
        FileError::Missing { .. } => "missing",
        FileError::Memory { .. } => "memory",
        FileError::System { missing: true, .. } => "absent",
        _ => "system",
    }
}
