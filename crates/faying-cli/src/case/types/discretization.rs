//! `[discretization]`: functions, cells and elements.

use crate::place::Located;
pub use faying::basis::Cell;
pub use faying::space::{BasisKind, Divisions, Grading, Mapping};

/// `[discretization]`, or the same keys of a patch merged with it.
#[derive(Clone, Debug, PartialEq)]
pub struct Discretization {
    /// Name of the backend, one of those the reader was given (`iga`, `fe`, ...).
    pub backend: Located<String>,
    /// Degree per direction.
    pub degree: Located<Vec<usize>>,
    /// C^k at new knots; `None` is "max".
    pub continuity: Located<Option<usize>>,
    /// Functions of iga patches.
    pub basis: Located<BasisKind>,
    /// Cells of fe patches.
    pub cells: Located<Cell>,
    /// Map of fe patches.
    pub mapping: Located<Mapping>,
    /// Gauss points per direction beyond degree + 1.
    pub extra_points: Located<usize>,
}
