//! Floor 8: two sides, their segments and multipliers become rows or stiffness. Decides nothing.

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

/// Why sides could not be coupled.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CouplingError {
    /// The sides are farther apart than allowed.
    #[error("the sides are up to {distance:.3e} apart (at {at:?}); allowed {allowed:.3e}")]
    Apart {
        /// Largest distance found.
        distance: f64,
        /// Where.
        at: [f64; 3],
        /// Largest distance allowed.
        allowed: f64,
    },
    /// No point of the slave side has a partner on the master side.
    #[error("no part of the slave side faces the master side")]
    NothingFaces,
    /// A point of the slave side, or what it faces, is not finite.
    #[error("a point of the slave side's element {element}, or what it faces, is not finite")]
    NotFinite {
        /// The element of the slave side.
        element: usize,
    },
    /// A multiplier space lives on other elements than the slave side.
    #[error("the multiplier has {found} elements, the slave side {expected}")]
    Elements {
        /// Elements of the slave side.
        expected: usize,
        /// Elements of the multiplier.
        found: usize,
    },
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

/// All that a coupling sees of an interface.
#[derive(Clone, Copy, Debug)]
pub struct Interface<'a, const S: usize, const N: usize, T: Real = f64> {
    /// The side that carries the multiplier.
    pub slave: Side<'a, S, N, T>,
    /// The other side; none where it is rigid.
    pub master: Option<Side<'a, S, N, T>>,
    /// One multiplier space, or one per component.
    pub multiplier: &'a [&'a dyn Basis<S, T>],
    /// Where both sides are seen together.
    pub segments: &'a Segments<S, T>,
    /// A second list for the master part of the reaction: mixed integration.
    pub master_segments: Option<&'a Segments<S, T>>,
    /// A direction per point of `segments`; then each function makes one scalar row along it: contact.
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

/// What a coupling adds to the system.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CouplingBlocks<T: Real = f64> {
    /// C u = -offset for tied rows.
    pub constraint: Rows<T>,
    /// B whose transpose carries the multiplier to the equilibrium; equal to C where absent.
    pub reaction: Option<Rows<T>>,
    /// Entries added to the stiffness.
    pub stiffness: Triplets<T>,
    /// Softens the rows: penalty stiffness over the stiffness of their slave unknowns; none: exact rows.
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

/// Turns sides, multipliers and segments into rows, stiffness or both. (S, N) stands for (N - 1, N).
pub trait Coupling<const S: usize, const N: usize, T: Real = f64>: Debug + Send + Sync {
    /// The blocks of `interface` in a system with `unknowns` unknowns.
    ///
    /// Rows of a vector multiplier: component after component, row = offset of the component + function.
    ///
    /// # Errors
    /// [`CouplingError`] where the interface lacks what the coupling needs.
    fn assemble(&self, interface: &Interface<'_, S, N, T>, unknowns: usize) -> Result<CouplingBlocks<T>, CouplingError>;

    /// Whether it makes rows, and so needs a multiplier; one that only adds stiffness says no.
    fn has_rows(&self) -> bool {
        true
    }

    /// What takes the place of the multiplier where there are no rows: lambda at the points of the segments for the solution
    /// `unknowns`, `[component][point]`, in the sign of a multiplier \[force/area\]. Unless it says otherwise,
    /// minus the slave's traction.
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
    fn lambda(&self, interface: &Interface<'_, S, N, T>, unknowns: &[T]) -> Result<Vec<Vec<T>>, CouplingError> {
        (**self).lambda(interface, unknowns)
    }
}
