//! Readers and writers of geometry and mesh files.
//!
//! Formats are detected by content, never by the name of the file. Counts that a file declares are never trusted: memory grows with the
//! data read, and the total stays below [`Limits::memory`].

mod budget;
mod cell_map;
pub mod gismo;
mod gismo_write;
pub mod gmsh;
mod handed;
pub mod inp;
mod mesh;
pub mod mfem;
pub mod pvd;
mod read;
mod select;
mod serendipity;
mod sides;
mod spline;
mod text;
pub mod vtu;
mod vtu_array;
mod vtu_bytes;
mod vtu_mesh;
pub mod vtu_read;
mod xml;

pub use cell_map::CellMap;
pub use mesh::{CellShape, Group, MeshBlock, MeshFile};
pub use read::{beside, parse, parse_with, read, read_bytes};
pub use spline::{KnotUse, Label, PatchSide, SplineFile, SplinePatch};
pub use vtu_mesh::write_vtu;

/// Contents of a file: spline patches or a mesh.
#[derive(Clone, Debug, PartialEq)]
pub enum Contents {
    /// Spline patches: G+Smo XML, MFEM NURBS meshes.
    Patches(SplineFile),
    /// A Lagrange mesh: Gmsh, MFEM, VTU, Abaqus and CalculiX.
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
    /// Abaqus or CalculiX input file; read only.
    Abaqus,
}

/// Text of a written file, and the information that the format cannot store.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Written {
    /// The text.
    pub text: String,
    /// Information that is lost, one phrase per item.
    pub lost: Vec<String>,
}

/// Limits of a reader.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Limits {
    /// Largest number of bytes of memory; `None`: no limit.
    pub memory: Option<u64>,
}

/// UTF-8 byte order mark, which some editors write at the start of text.
pub const BYTE_ORDER_MARK: &[u8] = b"\xEF\xBB\xBF";

/// Position in a file.
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

/// Error of reading or using a file.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum FileError {
    /// The kind or version is not supported (E043).
    #[error("{what} is not supported{}", at(.spot))]
    Unsupported {
        /// Name of the kind or version, e.g. "MSH version 1.0", "THB-spline basis".
        what: String,
        /// Position in the file, if known.
        spot: Option<Spot>,
    },
    /// The file contradicts itself or its format (E043).
    #[error("{what}{}", at(.spot))]
    Broken {
        /// Description: expected and found.
        what: String,
        /// Position in the file, if known.
        spot: Option<Spot>,
    },
    /// The corners of a cell do not follow each other around it: a facet of a group joins corners that lie across the cell (E041).
    #[error("element {cell} is twisted: the element {facet} of group \"{group}\" joins corners that lie across it")]
    Twisted {
        /// The file's number of the cell.
        cell: u64,
        /// The file's number of the facet.
        facet: u64,
        /// Label of the group of the facet.
        group: String,
    },
    /// It holds something of another dimension than requested (E044).
    #[error("{what}{}", at(.spot))]
    Dimension {
        /// Description: the dimension found and the one expected.
        what: String,
        /// Position in the file, if known.
        spot: Option<Spot>,
    },
    /// There is no such patch or group (E042).
    #[error("there is no {wanted}; there are {known}")]
    Missing {
        /// Missing item, e.g. group "steel".
        wanted: String,
        /// Existing items, separated by commas.
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
    /// The system could not open or read it (E003 if it does not exist, exit 4).
    #[error("{message}")]
    System {
        /// Whether there is no such file.
        missing: bool,
        /// Message of the system.
        message: String,
    },
}

fn at(spot: &Option<Spot>) -> String {
    spot.map_or(String::new(), |s| format!(" ({s})"))
}
