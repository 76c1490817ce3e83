//! Specification of a patch as data, and its errors.

use crate::basis::{Basis, Cell, WeightError};
use crate::geometry::ControlNet;

use super::InvertedElement;

/// The functions of a spline patch.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum BasisKind {
    /// NURBS where the weights of the geometry vary and the degree allows it, else B-splines.
    #[default]
    Auto,
    /// B-splines over the weight function of the geometry.
    Nurbs,
    /// B-splines.
    BSpline,
}

/// The map of a Lagrange mesh.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Mapping {
    /// The space's own functions with nodes on the geometry.
    #[default]
    Isoparametric,
    /// The exact map of the geometry.
    Exact,
}

/// Largest degree of a spline patch.
pub const MAX_DEGREE_SPLINE: usize = 12;
/// Largest degree of a Lagrange mesh of tensor cells.
pub const MAX_DEGREE_TENSOR: usize = 8;
/// Largest degree of a Lagrange mesh of simplices.
pub const MAX_DEGREE_SIMPLEX: usize = 4;

/// A geometry and its discretisation; [`Patch`](super::Patch) and [`Mesh`](super::Mesh) each read the parts that apply to them.
///
/// # Example
/// ```
/// use faying::{geometry::shapes, space::{Body, Patch, PatchSpec}};
/// let ring = shapes::annulus_sector([0.0, 0.0], [1.0, 2.0], [0.0, 90.0])?;
/// let spec = PatchSpec::new(ring).with_degree([3, 3]).with_elements([4, 2]);
/// let patch = Patch::<1, 2>::try_new(&spec)?;
/// assert_eq!(patch.sides(), ["u0", "u1", "v0", "v1"]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct PatchSpec<const N: usize> {
    /// The geometry.
    pub net: ControlNet<N, N>,
    /// Degree per direction; 1 to 12 (splines), 8 (tensor cells), 4 (simplices).
    pub degree: [usize; N],
    /// Ends of the elements per direction in the parameters of the net, increasing; the net's own knots are added.
    pub breakpoints: [Vec<f64>; N],
    /// Splines: continuity at knots, `None` for degree - 1; at the net's own knots at most what the net has.
    pub continuity: Option<usize>,
    /// Splines: kind of functions.
    pub basis: BasisKind,
    /// Lagrange: shape of the cells.
    pub cells: Cell,
    /// Lagrange: kind of map.
    pub mapping: Mapping,
}

impl<const N: usize> PatchSpec<N> {
    /// Creates a specification of degree 2 on the elements of the net, all else by default.
    pub fn new(net: ControlNet<N, N>) -> Self {
        let breakpoints = std::array::from_fn(|k| net.axes[k].breakpoints().to_vec());
        Self {
            net,
            degree: [2; N],
            breakpoints,
            continuity: None,
            basis: BasisKind::default(),
            cells: Cell::Tensor,
            mapping: Mapping::default(),
        }
    }

    /// Whether Lagrange cells on it have sides that lie exactly on those of the net: cells on the exact map, and cells of a polynomial net of at
    /// most their degree.
    pub(super) fn is_exact(&self) -> bool {
        let polynomial = self.net.weights.is_none() && (0..N).all(|k| self.net.axes[k].degree(0)[0] <= self.degree[k]);
        self.mapping == Mapping::Exact || polynomial
    }

    /// Sets the degree per direction.
    #[must_use]
    pub fn with_degree(mut self, degree: [usize; N]) -> Self {
        self.degree = degree;
        self
    }

    /// Sets `elements` equal elements per direction in total, rounded up to a multiple of the net's spans.
    #[must_use]
    pub fn with_elements(mut self, elements: [usize; N]) -> Self {
        self.breakpoints = self.net.breakpoints_total(elements);
        self
    }

    /// Sets the breakpoints per direction.
    #[must_use]
    pub fn with_breakpoints(mut self, breakpoints: [Vec<f64>; N]) -> Self {
        self.breakpoints = breakpoints;
        self
    }

    /// Sets the continuity at knots.
    #[must_use]
    pub fn with_continuity(mut self, continuity: usize) -> Self {
        self.continuity = Some(continuity);
        self
    }

    /// Sets the kind of spline functions.
    #[must_use]
    pub fn with_basis(mut self, basis: BasisKind) -> Self {
        self.basis = basis;
        self
    }

    /// Sets the shape of the cells.
    #[must_use]
    pub fn with_cells(mut self, cells: Cell) -> Self {
        self.cells = cells;
        self
    }

    /// Sets the map of a Lagrange mesh.
    #[must_use]
    pub fn with_mapping(mut self, mapping: Mapping) -> Self {
        self.mapping = mapping;
        self
    }

    /// Halves every element `times` times in every direction.
    ///
    /// # Panics
    /// If more than 2^32 elements would come out in one direction.
    #[must_use]
    pub fn refined(mut self, times: usize) -> Self {
        for (k, b) in self.breakpoints.iter_mut().enumerate() {
            // knots of the net first, or halving would not see the elements they cut
            let knots = self.net.axes[k].breakpoints();
            *b = super::refine::halved(&super::refine::joined(knots, b), times);
        }
        self
    }

    pub(crate) fn check_degree(&self, max: usize, kind: &'static str) -> Result<(), SpecError> {
        match (0..N).find(|&k| !(1..=max).contains(&self.degree[k])) {
            Some(direction) => Err(SpecError::Degree { direction, degree: self.degree[direction], max, kind }),
            None => Ok(()),
        }
    }

    /// The highest degree of the net in a direction.
    pub(crate) fn net_degree(&self, direction: usize) -> usize {
        self.net.axes[direction].degree(0)[0]
    }
}

/// Error when a patch cannot be built.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SpecError {
    /// The degree is out of range.
    #[error("degree {degree} in direction {} is out of range; {kind} take 1 to {max}", axis(.direction))]
    Degree {
        /// The direction, 0 for u.
        direction: usize,
        /// The degree given.
        degree: usize,
        /// The largest degree allowed.
        max: usize,
        /// Name of the kind of space.
        kind: &'static str,
    },
    /// NURBS of this degree cannot carry the weights of the geometry.
    #[error(
        "NURBS of degree {degree} in direction {} cannot carry the weights of a geometry of degree {needed}; raise the degree to {needed} or use B-splines",
        axis(.direction)
    )]
    DegreeTooLow {
        /// The direction, 0 for u.
        direction: usize,
        /// The degree given.
        degree: usize,
        /// The least degree that works.
        needed: usize,
    },
    /// The continuity is higher than the degree allows.
    #[error("continuity {continuity} needs degree {} or more; direction {} has degree {degree}", .continuity + 1, axis(.direction))]
    Continuity {
        /// The direction, 0 for u.
        direction: usize,
        /// The continuity given.
        continuity: usize,
        /// The degree there.
        degree: usize,
    },
    /// A breakpoint is outside the parameters of the geometry.
    #[error("breakpoint {index} in direction {} is {value}; it must be from {from} to {to}", axis(.direction))]
    BreakpointOutside {
        /// The direction, 0 for u.
        direction: usize,
        /// Its index in the list.
        index: usize,
        /// Its value.
        value: f64,
        /// First parameter of the geometry.
        from: f64,
        /// Last parameter.
        to: f64,
    },
    /// Breakpoints do not increase.
    #[error("breakpoint {index} in direction {} is {value} and not larger than the one before; breakpoints must increase", axis(.direction))]
    BreakpointsFall {
        /// The direction, 0 for u.
        direction: usize,
        /// Its index in the list.
        index: usize,
        /// Its value.
        value: f64,
    },
    /// Simplices have one degree.
    #[error("simplex cells need the same degree in every direction, found {degree:?}")]
    MixedDegree {
        /// The degrees given.
        degree: Vec<usize>,
    },
    /// Tetrahedra on the exact map at a collapsed edge are not built.
    #[error(
        "side {side} is collapsed: tetrahedra on the exact map are not in this version there; use the isoparametric map or tensor cells"
    )]
    ExactCollapsed {
        /// The collapsed side.
        side: String,
    },
    /// A cell between collapsed edges has no tetrahedron with volume.
    #[error("cell {cell} of the patch lies between collapsed edges and leaves no tetrahedron; take more elements, or tensor cells")]
    FlatCell {
        /// The cell, first axis fastest.
        cell: usize,
    },
    /// The weights of the refined weight function are unusable.
    #[error(transparent)]
    Weights(#[from] WeightError),
    /// The map folds over.
    #[error(transparent)]
    Inverted(#[from] InvertedElement),
}

fn axis(direction: &usize) -> &'static str {
    ["u", "v", "w"].get(*direction).copied().unwrap_or("?")
}
