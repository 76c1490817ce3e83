//! Geometry and mesh files: what they hold, whatever their format.
//!
//! Formats are told by content, never by the name of the file. Counts that a file declares are never trusted: memory grows with what
//! was read, and the whole stays below [`Limits::memory`].

mod budget;
mod cell_map;
pub mod gismo;
mod gismo_write;
pub mod gmsh;
mod handed;
mod mesh;
pub mod mfem;
pub mod pvd;
mod read;
mod select;
mod sides;
mod spline;
mod text;
pub mod vtu;
mod vtu_bytes;
mod vtu_mesh;
pub mod vtu_read;
mod xml;

pub use cell_map::CellMap;
pub use mesh::{CellShape, Group, MeshBlock, MeshFile};
pub use read::{parse, read, read_bytes};
pub use spline::{KnotUse, Label, PatchSide, SplineFile, SplinePatch};
pub use vtu_mesh::write_vtu;

/// What a file holds.
#[derive(Clone, Debug, PartialEq)]
pub enum Contents {
    /// Spline patches: G+Smo XML, MFEM NURBS meshes.
    Patches(SplineFile),
    /// A Lagrange mesh: Gmsh, MFEM, VTU.
    Mesh(MeshFile),
}

/// A format of files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// G+Smo XML.
    Gismo,
    /// MFEM mesh, NURBS or not.
    Mfem,
    /// Gmsh MSH 2.2 or 4.1.
    Gmsh,
    /// VTK XML unstructured grid.
    Vtu,
}

/// The text of a file that was written, and what it does not carry.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Written {
    /// The text.
    pub text: String,
    /// What is lost, one phrase each.
    pub lost: Vec<String>,
}

/// What reading may use.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Limits {
    /// Most bytes of memory; none: no limit.
    pub memory: Option<u64>,
}

/// What some editors write before UTF-8 text.
pub const BYTE_ORDER_MARK: &[u8] = b"\xEF\xBB\xBF";

/// Where in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Spot {
    /// A line, from 1.
    Line(usize),
    /// A byte, from 0: in binary parts.
    Byte(usize),
}

impl std::fmt::Display for Spot {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Line(line) => write!(f, "line {line}"),
            Self::Byte(byte) => write!(f, "byte {byte}"),
        }
    }
}

/// Why a file cannot be used.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum FileError {
    /// The kind or version is not supported (E043).
    #[error("{what} is not supported{}", at(.spot))]
    Unsupported {
        /// What: "MSH version 1.0", "THB-spline basis".
        what: String,
        /// Where it stands.
        spot: Option<Spot>,
    },
    /// The file contradicts itself or its format (E043).
    #[error("{what}{}", at(.spot))]
    Broken {
        /// What was expected and found.
        what: String,
        /// Where.
        spot: Option<Spot>,
    },
    /// It holds something of another dimension than asked for (E044).
    #[error("{what}{}", at(.spot))]
    Dimension {
        /// What there is and what was expected.
        what: String,
        /// Where.
        spot: Option<Spot>,
    },
    /// There is no such patch or group (E042).
    #[error("there is no {wanted}; there are {known}")]
    Missing {
        /// Such as: group "steel".
        wanted: String,
        /// What there is, separated by commas.
        known: String,
    },
    /// Reading it would take more memory than allowed (E081).
    #[error("reading it takes about {needed} bytes; {allowed} are allowed")]
    Memory {
        /// Bytes needed.
        needed: u64,
        /// Bytes allowed.
        allowed: u64,
    },
    /// The system could not open or read it (E003 where it is not there, exit 4).
    #[error("{message}")]
    System {
        /// Whether there is no such file.
        missing: bool,
        /// What the system says.
        message: String,
    },
}

fn at(spot: &Option<Spot>) -> String {
    spot.map_or(String::new(), |s| format!(" ({s})"))
}
