//! `[discretization]`: functions, cells and elements.

use crate::place::Located;
pub use faying::basis::Cell;
pub use faying::space::{BasisKind, Divisions, Grading, Mapping};

/// Words for the bases of splines.
pub(crate) const BASES: [(&str, BasisKind); 3] = [("auto", BasisKind::Auto), ("nurbs", BasisKind::Nurbs), ("b-spline", BasisKind::BSpline)];
/// Words for the shapes of cells.
pub(crate) const CELLS: [(&str, Cell); 2] = [("tensor", Cell::Tensor), ("simplex", Cell::Simplex)];
/// Words for the maps of cells.
pub(crate) const MAPPINGS: [(&str, Mapping); 2] = [("isoparametric", Mapping::Isoparametric), ("exact", Mapping::Exact)];

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
