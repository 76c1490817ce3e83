//! Errors of ties and contacts.

use crate::contact::ContactError;
use crate::coupling::CouplingError;
use crate::coupling::multiplier::MultiplierError;

/// A tie or a contact cannot be built.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum InterfaceError {
    /// A contact without a master.
    #[error("there is no master side")]
    NoMaster,
    /// A method with a factor that is not positive.
    #[error(transparent)]
    Factor(CouplingError),
    /// Nitsche's method against an obstacle that a force presses.
    #[error("Nitsche's method against an obstacle that a force presses is not in this version")]
    PressedAtPoints,
    /// Sides that do not meet.
    #[error("the sides do not meet: {0}")]
    Apart(CouplingError),
    /// A slave side of a tie that its masters do not cover.
    #[error("only {} % of the slave side meets its masters", 100.0 * .share)]
    Uncovered {
        /// Covered share of the slave side.
        share: f64,
    },
    /// Segments that cannot be built, or that are not sound.
    #[error(transparent)]
    Segments(CouplingError),
    /// Blocks of a coupling that cannot be built.
    #[error(transparent)]
    Coupling(CouplingError),
    /// Rows of a contact that cannot be built.
    #[error(transparent)]
    Contact(ContactError),
    /// A slave side of which no point faces the opponent.
    #[error("no part of the slave side faces the opponent")]
    NothingFaces,
    /// A slave side without a free unknown in components or, if it is that of a contact, along the normal.
    #[error("the slave side has no free unknown in components {components:?}")]
    Held {
        /// The components; of contacts those that the normals have.
        components: Vec<usize>,
        /// Whether equations between components hold functions of the side.
        by_equations: bool,
    },
    /// A multiplier that does not exist on the slave side.
    #[error("{error}")]
    Multiplier {
        /// Its component; `None` of contacts.
        component: Option<usize>,
        /// The reason.
        error: MultiplierError,
    },
    /// More multipliers of a component than free unknowns.
    #[error("{0}")]
    Counts(MultiplierError),
    /// More multipliers of a contact than free unknowns along the normal.
    #[error("the normal direction has {multipliers} functions for {free} free unknowns")]
    TooMany {
        /// Number of multipliers.
        multipliers: usize,
        /// Number of free unknowns.
        free: usize,
        /// Components that the normals have.
        components: Vec<usize>,
        /// Whether equations between components hold functions of the side.
        by_equations: bool,
    },
}
