//! `[discretization]`: functions, cells and elements.

use crate::place::Located;

/// Basis functions of an `iga` patch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum BasisKind {
    /// NURBS where the weights vary and the degree allows it, else B-splines.
    Auto,
    /// B-splines over the patch's weight function.
    Nurbs,
    /// B-splines.
    BSpline,
}

/// Cells of an `fe` patch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Cells {
    /// Quadrilaterals, hexahedra.
    Tensor,
    /// Triangles, tetrahedra.
    Simplex,
}

/// Map of an `fe` patch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Mapping {
    /// Of the degree of the space.
    Isoparametric,
    /// The patch's own map.
    Exact,
}

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
    pub cells: Located<Cells>,
    /// Map of fe patches.
    pub mapping: Located<Mapping>,
    /// Gauss points per direction beyond degree + 1.
    pub extra_points: Located<usize>,
}

/// Elements of one direction.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Divisions {
    /// In total for built-in shapes, per knot span for nurbs patches.
    Count(usize),
    /// Increasing breakpoints, the ends of the direction included.
    Breakpoints(Vec<f64>),
}

/// `grade`: element sizes grow geometrically away from a place in the parameters.
#[derive(Clone, Debug, PartialEq)]
pub struct Grade {
    /// Parameter in 0..1 per direction, `None`: not graded.
    pub toward: Vec<Option<f64>>,
    /// Size of the first element over the uniform size, in 0..1.
    pub ratio: f64,
}
