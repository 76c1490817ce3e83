//! Errors of problems before they are solved.

use super::fixed::Conflict;
use super::interface_error::InterfaceError;
use super::physics::PhysicsError;
use crate::assembly::DirichletError;
use crate::space::{GlueError, SideError};

/// A problem that cannot be stated or assembled.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ProblemError {
    /// A problem without bodies.
    #[error("the problem has no body")]
    Empty,
    /// A body or a solution of another problem.
    #[error("this body belongs to another problem")]
    OtherProblem,
    /// Two bodies, two ties or two contacts of one name.
    #[error("the name \"{name}\" is taken")]
    Name {
        /// The name.
        name: String,
    },
    /// No tie or contact has this name.
    #[error("there is no contact and no tie \"{name}\"")]
    Unknown {
        /// The name.
        name: String,
    },
    /// A material that problems do not take.
    #[error("body \"{body}\": {error}")]
    Material {
        /// The body.
        body: String,
        /// The reason.
        error: PhysicsError,
    },
    /// Bodies with different numbers of components.
    #[error("body \"{body}\" has {found} components of the unknown, the bodies before it {expected}")]
    Mixed {
        /// The body.
        body: String,
        /// Its number of components.
        found: usize,
        /// Number of components of the other bodies.
        expected: usize,
    },
    /// A component that the unknown does not have.
    #[error("there is no component {component} of {components}")]
    Component {
        /// The component, from 0.
        component: usize,
        /// Number of components.
        components: usize,
    },
    /// A side that the body does not have.
    #[error("body \"{body}\": {error}")]
    Side {
        /// The body.
        body: String,
        /// The reason.
        error: SideError,
    },
    /// Sides that cannot be glued.
    #[error("`{slave}` and `{master}` cannot be glued: {error}")]
    Glue {
        /// The first side.
        slave: String,
        /// The second side.
        master: String,
        /// The reason.
        error: GlueError,
    },
    /// Prescribed values that contradict each other or do not exist.
    #[error("{error} (t = {t})")]
    Prescribed {
        /// The reason.
        error: DirichletError,
        /// The time.
        t: f64,
    },
    /// A tie or a contact that cannot be built.
    #[error("\"{name}\", slave side `{slave}`: {error}")]
    Interface {
        /// Name of the tie or contact.
        name: String,
        /// The slave side.
        slave: String,
        /// The reason.
        error: InterfaceError,
    },
    /// A contact or a pressure in a problem of one component.
    #[error("\"{name}\" needs one component per coordinate")]
    Scalar {
        /// Name of the contact, or of the side under pressure.
        name: String,
    },
    /// A side that is the slave of two ties.
    #[error("`{side}` is slave twice; make it the master of one of them")]
    SlaveTwice {
        /// The side.
        side: String,
    },
    /// A side that meets itself, or two sides that are slave and master of each other.
    #[error("`{slave}` on `{master}`: a side meets another one, and one of the two is the slave")]
    BothWays {
        /// The slave side.
        slave: String,
        /// The master side.
        master: String,
    },
    /// A source beside an exact solution, which has its own.
    #[error("body \"{body}\" has a source; the exact solution has its own")]
    SourceTwice {
        /// The body.
        body: String,
    },
    /// A side that takes values of an exact solution, in a problem without one.
    #[error("side \"{side}\" takes the values of an exact solution, and the problem has none")]
    NoExact {
        /// The side.
        side: String,
    },
    /// A tie or a contact of a slave side with an empty list of masters.
    #[error("the list of master sides is empty")]
    NoMaster,
    /// A motion or a force of a contact between bodies.
    #[error("contact \"{name}\" faces a body: only obstacles are moved or pressed")]
    NoObstacle {
        /// Name of the contact.
        name: String,
    },
    /// A component in which an obstacle cannot be moved or pressed, or is so twice.
    #[error("the obstacle of contact \"{name}\" is driven in component {component}: give 0 or 1, each once, either a motion or a force")]
    Driven {
        /// Name of the contact.
        name: String,
        /// The component, from 0.
        component: usize,
    },
    /// Bodies that can still move as rigid bodies with every contact closed.
    #[error("{}", .motions.join("; "))]
    Motions {
        /// A sentence per body.
        motions: Vec<String>,
    },
    /// A point in no body.
    #[error("the point {at:?} is not in body \"{body}\"")]
    Outside {
        /// The body.
        body: String,
        /// The point; coordinates beyond the dimension are zero.
        at: [f64; 3],
    },
}

impl From<Box<Conflict>> for ProblemError {
    fn from(conflict: Box<Conflict>) -> Self {
        Self::Prescribed { error: conflict.error, t: conflict.t }
    }
}
