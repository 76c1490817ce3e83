//! Floor 8: constraint rows or stiffness of two coupled sides, from their segments and multipliers.

pub mod consistency;
pub mod evaluate;
pub mod inf_sup;
pub mod interface;
pub mod mortar;
pub mod multiplier;
pub mod nitsche;
mod penalty;

use crate::basis::Basis;
use crate::linalg::{Real, Triplets, Vector};
use crate::physics::Flux;
use crate::space::{Field, Trace};
use std::fmt::Debug;

pub use interface::{Coverage, InterfaceQuadrature, Segments};
pub use mortar::Mortar;
pub use nitsche::Nitsche;
pub use penalty::Penalty;

/// Error when sides cannot be coupled.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CouplingError {
    /// The sides are farther apart than allowed.
    #[error("the sides are up to {distance:.3e} apart (at {at:?}); allowed {allowed:.3e}")]
    Apart {
        /// Largest distance found.
        distance: f64,
        /// Position of that point; coordinates beyond the dimension are zero.
        at: [f64; 3],
        /// Largest distance allowed.
        allowed: f64,
    },
    /// No point of the slave side has a partner on the master side.
    #[error("no part of the slave side faces the master side")]
    NothingFaces,
    /// A point of the slave side, or its partner, is not finite.
    #[error("a point of the slave side's element {element}, or what it faces, is not finite")]
    NotFinite {
        /// The element of the slave side.
        element: usize,
    },
    /// Pieces leave a part of a slave element uncovered or cover it twice, though the master does not end there.
    #[error("the pieces of the slave side's element {element} cover {share:.10} of it, and the master does not end there")]
    Lost {
        /// The element of the slave side.
        element: usize,
        /// Share that the pieces cover, in local coordinates; more than 1 if parts are covered twice.
        share: f64,
    },
    /// A multiplier space has other elements than the slave side.
    #[error("the multiplier has {found} elements, the slave side {expected}")]
    Elements {
        /// Elements of the slave side.
        expected: usize,
        /// Elements of the multiplier.
        found: usize,
    },
    /// The segments of a rule are not sound.
    #[error("the rule of integration returns wrong segments: {0}")]
    Rule(String),
    /// The coupling needs something the interface does not have.
    #[error("{0}")]
    Missing(String),
}

/// One side of an interface.
#[derive(Clone, Copy, Debug)]
pub struct Side<'a, const S: usize, const N: usize, T: Real = f64> {
    /// Its space and facets.
    pub trace: &'a Trace<S, N, T>,
    /// Numbering of the body's unknowns.
    pub field: Field,
    /// The body's flux, for Nitsche.
    pub flux: Option<&'a dyn Flux<S, N, T>>,
}

/// Input of a coupling: sides, multipliers and segments of an interface.
#[derive(Clone, Copy, Debug)]
pub struct Interface<'a, const S: usize, const N: usize, T: Real = f64> {
    /// The side that carries the multiplier.
    pub slave: Side<'a, S, N, T>,
    /// The other side; `None` if it is rigid.
    pub master: Option<Side<'a, S, N, T>>,
    /// One multiplier space, or one per component.
    pub multiplier: &'a [&'a dyn Basis<S, T>],
    /// Quadrature points shared by both sides, in local coordinates of each.
    pub segments: &'a Segments<S, T>,
    /// Second list for the master part of the reaction (mixed integration).
    pub master_segments: Option<&'a Segments<S, T>>,
    /// Direction per point of `segments`; each function then makes one scalar row along it (contact).
    pub direction: Option<&'a [Vector<N, T>]>,
}

/// Constraint rows in vector unknowns: C = slave + master.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Rows<T: Real = f64> {
    /// Entries in unknowns of the slave body.
    pub slave: Triplets<T>,
    /// Entries in unknowns of the master body.
    pub master: Triplets<T>,
}

/// Contributions of a coupling to the system.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CouplingBlocks<T: Real = f64> {
    /// C u = -offset for tied rows.
    pub constraint: Rows<T>,
    /// B, whose transpose applies the multiplier to the equilibrium; `None` if equal to C.
    pub reaction: Option<Rows<T>>,
    /// Entries added to the stiffness.
    pub stiffness: Triplets<T>,
    /// Penalty stiffness of soft rows over the stiffness of their slave unknowns; `None` for exact rows.
    pub penalty: Option<T>,
}

impl<T: Real> CouplingBlocks<T> {
    /// No rows and no stiffness in a system with `unknowns` unknowns.
    pub fn empty(unknowns: usize) -> Self {
        let rows = || Triplets::new(0, unknowns);
        Self {
            constraint: Rows { slave: rows(), master: rows() },
            reaction: None,
            stiffness: Triplets::new(unknowns, unknowns),
            penalty: None,
        }
    }
}

/// Assembles rows, stiffness or both from sides, multipliers and segments. (S, N) stands for (N - 1, N).
pub trait Coupling<const S: usize, const N: usize, T: Real = f64>: Debug + Send + Sync {
    /// Assembles the blocks of `interface` in a system with `unknowns` unknowns.
    ///
    /// Rows of a vector multiplier: component after component, row = offset of the component + function.
    ///
    /// # Errors
    /// [`CouplingError`] where the interface lacks what the coupling needs.
    fn assemble(&self, interface: &Interface<'_, S, N, T>, unknowns: usize) -> Result<CouplingBlocks<T>, CouplingError>;

    /// Whether the coupling makes rows, and so needs a multiplier; `false` if it only adds stiffness.
    fn has_rows(&self) -> bool {
        true
    }

    /// Whether it takes the stresses of the sides for what crosses the interface. Such sides may carry nothing else in the same points: no load,
    /// springs, support or other interface.
    fn needs_fluxes(&self) -> bool {
        false
    }

    /// Whether its rows are those of the mortar method: integrals of the multiplier's functions times the jump.
    fn rows_are_mortar(&self) -> bool {
        false
    }

    /// Multiplier field of a coupling without rows: lambda at the points of the segments for the solution `unknowns`,
    /// `[component][point]`, in the sign of a multiplier \[force/area\]. By default minus the slave's traction.
    ///
    /// # Errors
    /// [`CouplingError`] where the interface lacks what is needed.
    fn lambda(&self, interface: &Interface<'_, S, N, T>, unknowns: &[T]) -> Result<Vec<Vec<T>>, CouplingError> {
        evaluate::slave_flux(interface, unknowns)
    }
}

impl<const S: usize, const N: usize, T: Real, X: Coupling<S, N, T> + ?Sized> Coupling<S, N, T> for Box<X> {
    fn assemble(&self, interface: &Interface<'_, S, N, T>, unknowns: usize) -> Result<CouplingBlocks<T>, CouplingError> {
        (**self).assemble(interface, unknowns)
    }
    fn has_rows(&self) -> bool {
        (**self).has_rows()
    }
    fn needs_fluxes(&self) -> bool {
        (**self).needs_fluxes()
    }
    fn rows_are_mortar(&self) -> bool {
        (**self).rows_are_mortar()
    }
    fn lambda(&self, interface: &Interface<'_, S, N, T>, unknowns: &[T]) -> Result<Vec<Vec<T>>, CouplingError> {
        (**self).lambda(interface, unknowns)
    }
}
