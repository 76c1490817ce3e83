//! Lagrange meshes as stored in files.

use super::Format;

/// Shape of a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[non_exhaustive]
pub enum CellShape {
    /// A point.
    Point,
    /// An edge.
    Line,
    /// A triangle.
    Triangle,
    /// A quadrilateral.
    Quadrilateral,
    /// A tetrahedron.
    Tetrahedron,
    /// A hexahedron.
    Hexahedron,
    /// A wedge; read, but not supported in bodies.
    Prism,
    /// A pyramid; read, but not supported in bodies.
    Pyramid,
}

impl CellShape {
    /// Dimension of the cell.
    pub fn dimension(self) -> usize {
        match self {
            Self::Point => 0,
            Self::Line => 1,
            Self::Triangle | Self::Quadrilateral => 2,
            Self::Tetrahedron | Self::Hexahedron | Self::Prism | Self::Pyramid => 3,
        }
    }
}

/// Cells of one shape, order and set of groups.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MeshBlock {
    /// Shape of the cells.
    pub shape: CellShape,
    /// Geometry order, 1 to 4; 1 for points.
    pub order: usize,
    /// Nodes of all cells, cell after cell, as places in [`MeshFile::points`]; within a cell equispaced and the first axis fastest
    /// (as in [`CellBlock`](faying::space::CellBlock)), for prisms and pyramids in the order of the file.
    pub nodes: Vec<u32>,
    /// The file's numbers of the cells.
    pub ids: Vec<u64>,
    /// Places in [`MeshFile::groups`] of the groups all these cells are in.
    pub groups: Vec<usize>,
}

/// A physical group.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Group {
    /// Dimension of its cells.
    pub dimension: usize,
    /// Its number in the file.
    pub number: i64,
    /// Its name, if any.
    pub name: Option<String>,
}

impl Group {
    /// The name, or the number as text.
    pub fn label(&self) -> String {
        self.name.clone().unwrap_or_else(|| self.number.to_string())
    }
}

/// A file of points and cells.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshFile {
    /// Its format.
    pub format: Format,
    /// Points; missing coordinates are zero.
    pub points: Vec<[f64; 3]>,
    /// The file's numbers of the points.
    pub ids: Vec<u64>,
    /// Cells of all dimensions.
    pub blocks: Vec<MeshBlock>,
    /// Groups of all dimensions.
    pub groups: Vec<Group>,
    /// Contents of the file that are not read, one sentence each.
    pub notes: Vec<String>,
}

impl MeshFile {
    /// Highest dimension of a cell; zero without cells.
    pub fn dimension(&self) -> usize {
        self.blocks.iter().map(|b| b.shape.dimension()).max().unwrap_or(0)
    }
}
