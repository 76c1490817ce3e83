//! Errors of problems before they are solved.

use super::handles::Statement;
use super::interface_error::InterfaceError;
use super::physics::PhysicsError;
use super::revolution_error::RevolutionError;
use crate::assembly::DirichletError;
use crate::coupling::multiplier::MultiplierError;
use crate::physics::MaterialError;
use crate::space::{GlueError, SideError};
use std::fmt::{Display, Formatter};

/// An error of a problem: its kind, and the statements that it is about.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct ProblemError {
    /// The error.
    pub kind: ErrorKind,
    /// The statements, the one that is wrong last; of a call that fails those that it refers to.
    pub of: Vec<Statement>,
    /// Names of the statements or of what the call referred to, in the order of the sentence.
    pub(super) names: Vec<String>,
}

impl ProblemError {
    /// The statement and the place of a slave side on which there is no room for its multiplier.
    pub(super) fn slave_without_room(&self) -> Option<(Statement, usize)> {
        let ErrorKind::Interface { slave, error } = &self.kind else { return None };
        let is_narrow = matches!(
            error,
            InterfaceError::Multiplier { .. }
                | InterfaceError::Counts(_)
                | InterfaceError::TooMany { .. }
                | InterfaceError::Held { .. }
                | InterfaceError::Shared
        );
        is_narrow.then(|| Some((*self.of.last()?, *slave))).flatten()
    }
}

/// All errors that [`Problem::assemble`](super::Problem::assemble) finds, at least one.
#[derive(Clone, Debug, PartialEq)]
pub struct ProblemErrors(pub Vec<ProblemError>);

/// Kinds of errors.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum ErrorKind {
    /// A problem without bodies.
    Empty,
    /// A body, a region, a tie or a contact of another problem, or one that was made after the system.
    OtherProblem,
    /// Two bodies, two ties or two contacts of one name.
    NameTaken,
    /// A material that problems do not take.
    Material(PhysicsError),
    /// Constants of a material beyond their limits.
    OutOfLimits {
        /// The limit.
        error: MaterialError,
        /// A quadrature point \[length\]; coordinates beyond the dimension are zero.
        x: [f64; 3],
        /// The time.
        t: f64,
    },
    /// Bodies with different numbers of components.
    Mixed {
        /// Number of components of the body.
        found: usize,
        /// Number of components of the other bodies.
        expected: usize,
    },
    /// A component that the unknown does not have.
    NoComponent {
        /// The component, from 0.
        component: usize,
        /// Number of components.
        components: usize,
    },
    /// A function that the body does not have.
    NoFunction {
        /// The function, from 0.
        function: usize,
        /// Number of functions.
        functions: usize,
    },
    /// An element that the body does not have.
    NoElement {
        /// The element, from 0.
        element: usize,
        /// Number of elements.
        elements: usize,
    },
    /// A side that the body does not have.
    Side(SideError),
    /// Sides that have no edge and no corner in common.
    NoRegion,
    /// A part of a side with triangles and quadrilaterals.
    MixedCells,
    /// A load but a force, a spring or a normal on an edge, in a corner, or at points, edges or faces of a mesh.
    NotASide,
    /// A force spread over sides, edges and corners together, which have no common measure.
    MixedRegion,
    /// Sliding along a side without a normal: a line or a point.
    NoNormal,
    /// Sliding along facets that stand for a curved side: their normals are those of the side to the order of their degree only.
    Faceted,
    /// A curved side that slides where other supports, ties or contacts hold the same facets.
    SlideBeside,
    /// A curved side that slides, and has too few elements for the conditions on it.
    Slide(MultiplierError),
    /// A contact, a pressure, a weight or sliding in a problem of one component.
    Scalar,
    /// Prescribed values that contradict each other or do not exist.
    Prescribed {
        /// The reason.
        error: DirichletError,
        /// The time.
        t: f64,
        /// Whether values change with the time.
        changes: bool,
    },
    /// Sliding along a side, a side that moves as one, or an equation, which values prescribed beside it contradict in a common function.
    Contradiction {
        /// Its defect with these values, in the unit of its unknowns.
        defect: f64,
        /// The time.
        t: f64,
        /// Whether values change with the time.
        changes: bool,
    },
    /// A component of a side, an edge or a corner that is prescribed twice.
    Twice {
        /// The component.
        component: usize,
    },
    /// A load or springs in a component that is prescribed wherever they act: they would act on supports alone.
    Held {
        /// The component.
        component: usize,
    },
    /// A load or springs along directions that are held wherever they act, such as the normal of a side that slides.
    HeldAlong,
    /// A force on sides that move as one in a component which is prescribed in a part of them: it would act on that support alone.
    HeldAsOne {
        /// The component.
        component: usize,
    },
    /// Values of an exact solution, in a problem without one.
    NoExact,
    /// An exact solution in a body, and none in another one.
    ExactInPart,
    /// A source or a weight beside an exact solution, which has its own.
    SourceTwice,
    /// A foundation beside an exact solution, whose source is that of a body without one.
    FoundationBesideExact,
    /// A statement that bodies of revolution do not allow.
    Revolution(RevolutionError),
    /// Data that are not finite at a quadrature point.
    NotFinite {
        /// The point \[length\]; coordinates beyond the dimension are zero.
        x: [f64; 3],
        /// The time.
        t: f64,
        /// The value.
        value: f64,
        /// Number of the function in the statement, from 0.
        component: usize,
    },
    /// Data so large at a quadrature point that their squares overflow; of springs and foundations their product with a number of that size.
    TooLarge {
        /// The point \[length\]; coordinates beyond the dimension are zero.
        x: [f64; 3],
        /// The time.
        t: f64,
        /// The value.
        value: f64,
        /// Number of the function in the statement, from 0.
        component: usize,
    },
    /// A stiffness of springs or of a foundation, or a density, that is negative at a quadrature point.
    Negative {
        /// The point \[length\]; coordinates beyond the dimension are zero.
        x: [f64; 3],
        /// The time.
        t: f64,
        /// The value.
        value: f64,
        /// Number of the function in the statement, from 0.
        component: usize,
    },
    /// Sides that cannot be glued.
    Glue(GlueError),
    /// A slave side of a tie or a contact that cannot be built.
    Interface {
        /// Its place in the list of slave sides.
        slave: usize,
        /// The reason.
        error: InterfaceError,
    },
    /// A side with facets that are slave twice: its name and that of the other one.
    SlaveTwice,
    /// A side that meets itself, or two sides that are slave and master of each other.
    BothWays,
    /// No sides of bodies touch that are not joined yet.
    NothingTouches {
        /// The distance of the nearest sides \[length\]; `None` if no two face each other.
        distance: Option<f64>,
    },
    /// A side that touches another one beyond the sides with which it shares facets.
    TouchesBeyond,
    /// A tie or a contact of a slave side with an empty list of masters.
    NoMaster,
    /// A motion or a force of a contact between bodies.
    NoObstacle,
    /// A contact closes the gaps of an obstacle that moves: they would be those of its motion.
    AdjustsMoving,
    /// A component in which an obstacle cannot be moved or pressed, or is so twice.
    Driven {
        /// The component, from 0.
        component: usize,
    },
    /// Bodies that can still move as rigid bodies with every contact closed: a sentence per body.
    Motions(Vec<String>),
    /// A point in no element of a body.
    Outside {
        /// The point \[length\]; coordinates beyond the dimension are zero.
        x: [f64; 3],
    },
}

impl ProblemError {
    /// An error of `of`, with `names` for its sentence.
    pub(super) fn new(kind: ErrorKind, of: Vec<Statement>, names: Vec<String>) -> Self {
        Self { kind, of, names }
    }

    /// An error of what has no handle, such as a call that failed.
    pub(super) fn named(kind: ErrorKind, names: &[&str]) -> Self {
        Self { kind, of: Vec::new(), names: names.iter().map(|n| (*n).to_owned()).collect() }
    }

    /// Names of what the error is about: labels of sides and regions, names of bodies, ties, contacts and loads.
    pub fn names(&self) -> &[String] {
        &self.names
    }
}

impl Display for ProblemError {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        let name = |k: usize| self.names.get(k).map_or("?", String::as_str);
        let (one, other) = (name(0), name(1));
        match &self.kind {
            ErrorKind::Empty => write!(f, "the problem has no body"),
            ErrorKind::OtherProblem => {
                write!(f, "this body, region, tie or contact belongs to another problem, or was made after the system")
            }
            ErrorKind::NameTaken => write!(f, "the name \"{one}\" is taken"),
            ErrorKind::Material(error) => write!(f, "body \"{one}\": {error}"),
            ErrorKind::OutOfLimits { error, x, t } => write!(f, "body \"{one}\", material at {x:?}, t = {t}: {error}"),
            ErrorKind::Mixed { found, expected } => {
                write!(f, "body \"{one}\" has {found} components of the unknown, the bodies before it {expected}")
            }
            ErrorKind::NoComponent { component, components } => write!(f, "there is no component {component} of {components}"),
            ErrorKind::NoFunction { function, functions } => write!(f, "body \"{one}\" has no function {function} of {functions}"),
            ErrorKind::NoElement { element, elements } => write!(f, "body \"{one}\" has no element {element} of {elements}"),
            ErrorKind::Side(error) => write!(f, "body \"{one}\": {error}"),
            ErrorKind::NoRegion => write!(f, "{} have no edge and no corner in common", self.names.join(", ")),
            ErrorKind::MixedCells => write!(f, "parts of `{one}`, a side of triangles and quadrilaterals, are not in this version"),
            ErrorKind::NotASide => write!(f, "`{one}` is no side: loads but forces, springs and normals are those of sides"),
            ErrorKind::MixedRegion => {
                write!(f, "a force is spread over sides, over edges or over corners, not over `{one}` and `{other}` together")
            }
            ErrorKind::NoNormal => write!(f, "`{one}` is a line or a point and has no normal"),
            ErrorKind::Faceted => write!(f, "`{one}` stands for a curved side by facets, whose normals are not those of the side"),
            ErrorKind::SlideBeside => write!(f, "`{one}` is curved and slides, and `{other}` holds facets of it, too"),
            ErrorKind::Slide(error) => write!(f, "`{one}` is curved and slides: {error}"),
            ErrorKind::Scalar => write!(f, "\"{one}\" needs one component per coordinate"),
            ErrorKind::Prescribed { error, t, .. } => write!(f, "{error} (t = {t})"),
            ErrorKind::Contradiction { defect, t, .. } => {
                let others: Vec<String> = self.names.iter().skip(1).map(|name| format!("`{name}`")).collect();
                write!(f, "the condition on `{one}` contradicts {} by {defect:e} (t = {t})", others.join(", "))
            }
            ErrorKind::Twice { component } => write!(f, "component {component} of `{one}` is prescribed twice"),
            ErrorKind::Held { component } => {
                write!(f, "component {component} of `{one}` is loaded, and prescribed wherever the load acts")
            }
            ErrorKind::HeldAlong => write!(f, "the load on `{one}` acts along directions that are held wherever it acts"),
            ErrorKind::HeldAsOne { component } => {
                write!(
                    f,
                    "`{one}` moves as one in component {component}, which `{other}` prescribes in a part of it: its force has no effect"
                )
            }
            ErrorKind::NoExact => write!(f, "\"{one}\" takes the values of an exact solution, and the problem has none"),
            ErrorKind::ExactInPart => write!(f, "body \"{one}\" has an exact solution, body \"{other}\" has none"),
            ErrorKind::SourceTwice => write!(f, "body \"{one}\" has a source; the exact solution has its own"),
            ErrorKind::FoundationBesideExact => {
                write!(f, "body \"{one}\" has a foundation; the source of the exact solution is that of a body without one")
            }
            ErrorKind::Revolution(error) => error.write(f, one),
            ErrorKind::NotFinite { x, t, value, .. } => write!(f, "\"{one}\" on `{other}`: {value} at {x:?}, t = {t}"),
            ErrorKind::TooLarge { x, t, value, .. } => {
                write!(f, "\"{one}\" on `{other}` is too large: {value:e} at {x:?}, t = {t}; its square overflows")
            }
            ErrorKind::Negative { x, t, value, .. } => write!(f, "\"{one}\" on `{other}` is negative: {value} at {x:?}, t = {t}"),
            ErrorKind::Glue(error) => write!(f, "`{one}` and {} cannot be glued: {error}", self.names[1..].join(", ")),
            ErrorKind::Interface { error, .. } => write!(f, "\"{one}\", slave side `{other}`: {error}"),
            ErrorKind::SlaveTwice => write!(f, "`{one}` is slave twice; make it the master of one of them"),
            ErrorKind::BothWays => write!(f, "`{one}` on `{other}`: a side meets another one, and one of the two is the slave"),
            ErrorKind::NothingTouches { distance: None } => write!(f, "no sides of the bodies touch each other that are not joined yet"),
            ErrorKind::NothingTouches { distance: Some(d) } => write!(
                f,
                "no sides of the bodies touch each other that are not joined yet; the nearest, `{one}` and `{other}`, are {d:.3e} apart"
            ),
            ErrorKind::TouchesBeyond => write!(f, "`{one}` touches `{other}` beyond the sides with which it shares facets"),
            ErrorKind::NoMaster => write!(f, "the list of master sides is empty"),
            ErrorKind::AdjustsMoving => write!(f, "contact \"{one}\" closes the gaps of facets: its obstacle must stay where it is"),
            ErrorKind::NoObstacle => write!(f, "contact \"{one}\" faces a body: only obstacles are moved or pressed"),
            ErrorKind::Driven { component } => write!(
                f,
                "the obstacle of contact \"{one}\" is driven in component {component}: give each of its own once, either a motion or a force"
            ),
            ErrorKind::Motions(motions) => f.write_str(&motions.join("; ")),
            ErrorKind::Outside { x } => write!(f, "the point {x:?} is not in body \"{one}\""),
        }
    }
}

impl std::error::Error for ProblemError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        Some(match &self.kind {
            ErrorKind::Material(error) => error,
            ErrorKind::OutOfLimits { error, .. } => error,
            ErrorKind::Side(error) => error,
            ErrorKind::Prescribed { error, .. } => error,
            ErrorKind::Glue(error) => error,
            ErrorKind::Slide(error) => error,
            ErrorKind::Interface { error, .. } => error,
            _ => return None,
        })
    }
}

impl Display for ProblemErrors {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.0.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n"))
    }
}

impl std::error::Error for ProblemErrors {}

impl From<ProblemError> for ProblemErrors {
    fn from(error: ProblemError) -> Self {
        Self(vec![error])
    }
}
