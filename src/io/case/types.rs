//! The typed case: what a case file says, every default filled in, every value with its place.
//!
//! Vectors have one entry per coordinate (2 or 3), fields one per component of the unknown: 1 for Poisson, the
//! dimension for elasticity. Names of patches and sides are resolved; formulas are parsed.

use super::super::formula::{Constants, Formula};
use super::super::place::{Located, Place};
use super::super::reference::StoredRun;
use super::super::{errors::Diagnostics, errors::Source};
use super::opened::FileRead;
use super::part::FilePart;
use super::sides::Family;
use std::sync::Arc;

/// The head of a block, for errors that concern it as a whole.
pub type Head = Located<()>;

/// A whole case.
#[derive(Clone, Debug)]
pub struct Case {
    /// The text that places refer to.
    pub source: Source,
    /// Warnings found while reading.
    pub warnings: Diagnostics,
    /// Version of the case file's grammar: 1.
    pub schema: Located<usize>,
    /// Title, empty by default.
    pub title: Located<String>,
    /// Constants of `[let]`.
    pub constants: Constants,
    /// `[model]`.
    pub model: Model,
    /// `[discretization]`: the defaults, already merged into every patch.
    pub discretization: Discretization,
    /// `[[material]]`; a Poisson case without any gets one named `default` of conductivity 1.
    pub materials: Vec<Material>,
    /// `[[patch]]`; a file of several patches gives NAME.0, NAME.1, ...
    pub patches: Vec<Patch>,
    /// Sides that are one because groups of one mesh share their facets.
    pub joints: Vec<Joint>,
    /// Points that patches of one mesh share beside their common facets.
    pub meetings: Vec<Meeting>,
    /// Files that were read beside the case.
    pub files: Vec<FileRead>,
    pub(super) families: Vec<Family>,
    /// `[[boundary]]`.
    pub boundaries: Vec<Boundary>,
    /// `[[interface]]`.
    pub interfaces: Vec<Tie>,
    /// `[[contact]]`.
    pub contacts: Vec<Contact>,
    /// `[steps]`: times, `[1.0]` by default.
    pub steps: Located<Vec<f64>>,
    /// `[solver]`.
    pub solver: Solver,
    /// `[[probe]]`.
    pub probes: Vec<Probe>,
    /// `[[check]]`.
    pub checks: Vec<Check>,
    /// The `[study.NAME]` tables.
    pub studies: Vec<Located<StudyValues>>,
    pub(super) effective: String,
}

impl PartialEq for Case {
    /// Equal content; names of files, places and options do not count.
    fn eq(&self, other: &Self) -> bool {
        self.schema == other.schema
            && self.title == other.title
            && self.constants == other.constants
            && self.model == other.model
            && self.discretization == other.discretization
            && self.materials == other.materials
            && self.patches == other.patches
            && self.joints.iter().map(|j| &j.sides).eq(other.joints.iter().map(|j| &j.sides))
            && self.meetings.iter().map(|m| (&m.patches, m.point)).eq(other.meetings.iter().map(|m| (&m.patches, m.point)))
            && self.boundaries == other.boundaries
            && self.interfaces == other.interfaces
            && self.contacts == other.contacts
            && self.steps == other.steps
            && self.solver == other.solver
            && self.probes == other.probes
            && self.checks == other.checks
            && self.studies == other.studies
    }
}

/// Which equation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Physics {
    /// -div(k grad u) = f.
    Poisson,
    /// -div sigma(u) = f.
    Elasticity,
}

/// How a plane body stands for a spatial one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Assumption {
    /// No strain out of the plane.
    PlaneStrain,
    /// No stress out of the plane.
    PlaneStress,
}

/// `[model]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Model {
    /// The block.
    pub head: Head,
    /// Which equation.
    pub physics: Located<Physics>,
    /// 2 or 3.
    pub dimension: Located<usize>,
    /// Elasticity in the plane.
    pub assumption: Located<Assumption>,
    /// Manufactured solution, one formula per component.
    pub exact: Option<Located<Vec<Located<Formula>>>>,
    /// Body force (elasticity) or source (Poisson), one formula per component.
    pub source: Option<Located<Vec<Located<Formula>>>>,
    /// Acceleration; needs a density.
    pub gravity: Option<Located<Vec<f64>>>,
    /// A stored run that stands for the exact solution.
    pub reference: Option<Located<String>>,
    /// What its file holds.
    pub stored: Option<Arc<StoredRun>>,
}

impl Model {
    /// Components of the unknown: 1 for Poisson, the dimension for elasticity.
    pub fn components(&self) -> usize {
        match self.physics.value {
            Physics::Poisson => 1,
            Physics::Elasticity => self.dimension.value,
        }
    }
}

/// Which functions an `iga` patch uses.
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

/// `[[material]]`; constants may be formulas of x, y, z.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// The block.
    pub head: Head,
    /// Its name.
    pub name: Located<String>,
    /// Elastic constants, `None` for Poisson.
    pub elastic: Option<Elastic>,
    /// Conductivity, 1 by default; Poisson only.
    pub conductivity: Located<Formula>,
    /// Mass per volume.
    pub density: Option<Located<Formula>>,
}

/// Elastic constants in one of two pairs.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Elastic {
    /// Young's modulus (force per area) and Poisson's ratio.
    YoungPoisson(Located<Formula>, Located<Formula>),
    /// Lamé's constants lambda and mu (force per area).
    Lame(Located<Formula>, Located<Formula>),
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

/// A built-in shape, or a net of control points.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Shape {
    /// u, v (, w) = x, y (, z).
    Box {
        /// Least coordinates.
        min: Located<Vec<f64>>,
        /// Largest coordinates.
        max: Located<Vec<f64>>,
    },
    /// u = angle, v = radius.
    AnnulusSector {
        /// Centre.
        center: Located<Vec<f64>>,
        /// Inner and outer radius.
        radius: Located<[f64; 2]>,
        /// First and last angle in degrees.
        angle_deg: Located<[f64; 2]>,
    },
    /// u = angle, v = radius; v0 is the centre and no side.
    DiscSector {
        /// Centre.
        center: Located<Vec<f64>>,
        /// Radius.
        radius: Located<f64>,
        /// First and last angle in degrees.
        angle_deg: Located<[f64; 2]>,
    },
    /// A quarter; u around the hole from the x axis to the y axis, v from the hole to the edge.
    PlateWithHole {
        /// Radius of the hole.
        radius: Located<f64>,
        /// Half the width of the whole plate.
        half_width: Located<f64>,
    },
    /// u = longitude, v = latitude, w = radius.
    SphereOctant {
        /// Centre.
        center: Located<Vec<f64>>,
        /// Inner and outer radius.
        radius: Located<[f64; 2]>,
    },
    /// Control points, u fastest. Counts, knots and weights are already checked (E031 to E034).
    Nurbs {
        /// Degree per direction.
        degree: Located<Vec<usize>>,
        /// Open knot vector per direction.
        knots: Vec<Located<Vec<f64>>>,
        /// Points, u fastest.
        points: Located<Vec<Vec<f64>>>,
        /// Weights, all 1 where `None`.
        weights: Option<Located<Vec<f64>>>,
    },
    /// A file of patches or a mesh.
    File {
        /// Path relative to the case file.
        file: Located<String>,
        /// The number of a spline patch in it.
        id: Option<Located<String>>,
        /// Name or number of the group of a mesh.
        group: Option<Located<String>>,
        /// Path of a list of knots that are added to the spline patches.
        refinement: Option<Located<String>>,
        /// What was read: one part for a patch of the case; none for obstacles.
        parts: Vec<Arc<FilePart>>,
    },
}

impl Shape {
    /// What a patch takes from its file.
    pub fn part(&self) -> Option<&FilePart> {
        match self {
            Self::File { parts, .. } => parts.first().map(|p| &**p),
            _ => None,
        }
    }

    pub(super) fn part_mut(&mut self) -> Option<&mut FilePart> {
        match self {
            Self::File { parts, .. } => parts.first_mut().map(Arc::make_mut),
            _ => None,
        }
    }

    /// The word of the case file.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Box { .. } => "box",
            Self::AnnulusSector { .. } => "annulus-sector",
            Self::DiscSector { .. } => "disc-sector",
            Self::PlateWithHole { .. } => "plate-with-hole",
            Self::SphereOctant { .. } => "sphere-octant",
            Self::Nurbs { .. } => "nurbs",
            Self::File { .. } => "file",
        }
    }

    /// Whether `elements` counts in total (built-in shapes) rather than per knot span.
    pub fn is_built_in(&self) -> bool {
        !matches!(self, Self::Nurbs { .. } | Self::File { .. })
    }
}

/// `geometry`: a shape, then extrude, scale, rotate and move in this order.
#[derive(Clone, Debug, PartialEq)]
pub struct Geometry {
    /// The shape.
    pub shape: Located<Shape>,
    /// Height along z.
    pub extrude: Option<Located<f64>>,
    /// Factor about the origin.
    pub scale: Option<Located<f64>>,
    /// Angle in degrees about the origin.
    pub rotate_deg: Option<Located<f64>>,
    /// Axis of the rotation in 3D.
    pub axis: Option<Located<Vec<f64>>>,
    /// Translation (`move`).
    pub translate: Option<Located<Vec<f64>>>,
}

/// `[[patch]]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Patch {
    /// The block.
    pub head: Head,
    /// Its name.
    pub name: Located<String>,
    /// Its shape.
    pub geometry: Located<Geometry>,
    /// Index into [`Case::materials`].
    pub material: Located<usize>,
    /// One entry per direction.
    pub elements: Located<Vec<Located<Divisions>>>,
    /// Halvings of every element.
    pub refine: Located<usize>,
    /// Grading.
    pub grade: Option<Located<Grade>>,
    /// Degree, backend, ...: the patch's own or the defaults.
    pub discretization: Discretization,
    /// Body force or source of this patch, beside that of the model, one formula per component.
    pub source: Option<Located<Vec<Located<Formula>>>>,
    /// Acceleration of this patch, beside that of the model; needs a density.
    pub gravity: Option<Located<Vec<f64>>>,
    /// Direction that closes on itself.
    pub closed: Option<Located<String>>,
    /// Whether the patches of a file are glued.
    pub glue: Located<bool>,
}

/// Two sides that are the same facets of one mesh file: their patches share the functions there.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Joint {
    /// The sides.
    pub sides: [SideRef; 2],
    /// The patch block that says so.
    pub at: Place,
}

/// A point of one mesh file where patches meet that no common facet joins there: they share the function of that point.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Meeting {
    /// The patches.
    pub patches: Vec<usize>,
    /// The point, by its place in the file.
    pub point: usize,
    /// The block of the last of them.
    pub at: Place,
}

/// A side of a patch by its canonical name, or the tag of a mesh.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct SideRef {
    /// Index into [`Case::patches`].
    pub patch: usize,
    /// `u0`, `u1`, `v0`, `v1`, `w0`, `w1`, or the tag of a mesh.
    pub side: String,
}

/// Prescribed or applied data of one component.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Datum {
    /// Follows from `exact` of the model.
    Exact,
    /// A formula of x, y, z, t.
    Formula(Formula),
}

/// Data of some components: one entry per component, `None` where nothing is said.
pub type Components<D> = Vec<Option<Located<D>>>;

/// `[[boundary]]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Boundary {
    /// The block.
    pub head: Head,
    /// Its name, `boundary-0`, ... by default.
    pub name: Located<String>,
    /// The sides; "all-outer" is already resolved, but for sides that will be found to touch others.
    pub on: Vec<Located<SideRef>>,
    /// Whether the case says "all-outer".
    pub all_outer: bool,
    /// Keeps facets whose centre satisfies it (`where`).
    pub filter: Option<Located<Formula>>,
    /// Prescribed components: `fix` (zero) and `dirichlet` together.
    pub dirichlet: Components<Datum>,
    /// `fix = ["normal"]`.
    pub fix_normal: Option<Located<()>>,
    /// `fix = ["tangential"]`.
    pub fix_tangential: Option<Located<()>>,
    /// Traction (force per area), or k du/dn: `traction` and `neumann`.
    pub traction: Components<Datum>,
    /// Pressure along minus the outward normal (force per area).
    pub pressure: Option<Located<Formula>>,
    /// Resultant per component, spread evenly, a force.
    pub force: Components<Formula>,
    /// Springs per component (force per area and length).
    pub spring: Components<Formula>,
    /// The side moves as one in this component, resultant given, a force.
    pub rigid_force: Components<Formula>,
}

/// The multiplier's words.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Multiplier {
    /// A name: `auto`, `p/p`, `p/p-2`, `constant`, `dual`, or one of a registry.
    Named(String),
    /// Degree, continuity and ends as data.
    Data {
        /// Degree.
        degree: usize,
        /// Continuity at the breakpoints, -1 is discontinuous; `None`: degree - 1.
        continuity: Option<isize>,
        /// What happens at constrained ends.
        ends: Ends,
    },
}

/// What a multiplier does in the end elements.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Ends {
    /// Lowered where a component is constrained or at cross points.
    Auto,
    /// Never lowered.
    Full,
    /// Always lowered.
    Lowered,
}

/// Who makes the list of segments.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Integration {
    /// Segments of both sides (alias `segments`).
    Merged,
    /// The slave's elements.
    Slave,
    /// Slave for the constraint, master for the reaction.
    Mixed,
}

/// Variant of Nitsche's method.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Variant {
    /// Symmetric.
    Symmetric,
    /// Unsymmetric.
    Unsymmetric,
    /// Incomplete.
    Incomplete,
}

/// `[[interface]]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Tie {
    /// The block.
    pub head: Head,
    /// Its name, `interface-0`, ... by default.
    pub name: Located<String>,
    /// Slave sides.
    pub slave: Vec<Located<SideRef>>,
    /// Master sides.
    pub master: Vec<Located<SideRef>>,
    /// Patches whose touching sides are coupled, "all" for all: stands for slave and master.
    pub between: Option<Located<Vec<String>>>,
    /// Name of the coupling: `mortar`, `nitsche`, `penalty`, `glue`, or one of a registry.
    pub coupling: Located<String>,
    /// Multiplier.
    pub multiplier: Located<Multiplier>,
    /// Integration.
    pub integration: Located<Integration>,
    /// Gauss points per segment beyond max(p_slave, p_master) + 1.
    pub extra_points: Located<usize>,
    /// Largest distance of the sides (a length), `None`: auto.
    pub tolerance: Located<Option<f64>>,
    /// Multiplies modulus / h, `None`: auto.
    pub factor: Located<Option<f64>>,
    /// Variant of nitsche.
    pub variant: Located<Variant>,
    /// Exact multiplier, one formula per component.
    pub exact: Option<Located<Vec<Located<Formula>>>>,
}

/// The rigid shape of an obstacle.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum ObstacleShape {
    /// Everything below the plane.
    HalfPlane {
        /// A point of the plane.
        point: Located<Vec<f64>>,
        /// Normal out of the obstacle, of length 1.
        normal: Located<Vec<f64>>,
    },
    /// A circle in 2D.
    Sphere {
        /// Centre.
        center: Located<Vec<f64>>,
        /// Radius.
        radius: Located<f64>,
        /// Whether the body is inside.
        inside: Located<bool>,
    },
    /// A cylinder (3D).
    Cylinder {
        /// A point of the axis.
        center: Located<Vec<f64>>,
        /// Direction of the axis.
        axis: Located<Vec<f64>>,
        /// Radius.
        radius: Located<f64>,
    },
    /// A torus (3D).
    Torus {
        /// Centre.
        center: Located<Vec<f64>>,
        /// Direction of the axis.
        axis: Located<Vec<f64>>,
        /// Radius of the circle and of the tube.
        radius: Located<[f64; 2]>,
    },
    /// f = 0, gap f/|grad f|, or f along a fixed direction.
    LevelSet {
        /// The function of x, y, z, t.
        f: Located<Formula>,
        /// The normal, of length 1, if the gap is f itself.
        along: Option<Located<Vec<f64>>>,
    },
    /// The shape of a patch, placed; `nurbs` and files of curves may have one parameter: the obstacle lies to their right.
    Geometry(Box<Geometry>),
}

impl ObstacleShape {
    /// The word of its kind.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::HalfPlane { .. } => "half-plane",
            Self::Sphere { .. } => "sphere",
            Self::Cylinder { .. } => "cylinder",
            Self::Torus { .. } => "torus",
            Self::LevelSet { .. } => "level-set",
            Self::Geometry(geometry) => geometry.shape.value.kind(),
        }
    }
}

/// `rigid = { ... }`.
#[derive(Clone, Debug, PartialEq)]
pub struct Obstacle {
    /// Its shape.
    pub shape: Located<ObstacleShape>,
    /// Prescribed motion per coordinate (`move`), a formula of t.
    pub translate: Components<Formula>,
    /// Force that drives it, per coordinate.
    pub force: Components<Formula>,
}

/// What the slave of a contact faces.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
// a case has few contacts: a box would save nothing
#[allow(clippy::large_enum_variant)]
pub enum Master {
    /// Sides of bodies.
    Sides(Vec<Located<SideRef>>),
    /// A rigid obstacle.
    Rigid(Located<Obstacle>),
}

/// How contact is enforced.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Method {
    /// Multipliers.
    Lagrange,
    /// Penalty.
    Penalty,
    /// Augmented Lagrangian.
    Augmented,
    /// Nitsche.
    Nitsche,
}

/// The discrete cone of admissible multipliers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Cone {
    /// P: coefficients.
    Coefficients,
    /// W: weights.
    Weights,
    /// E: values.
    Values,
}

/// First guess of the active set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Start {
    /// Every row closed.
    All,
    /// Every row open.
    None,
    /// Rows of initial gap <= 0 closed.
    Gap,
    /// Pseudo-random.
    Seed(u64),
}

/// `active_set`.
#[derive(Clone, Debug, PartialEq)]
pub struct ActiveSetSpec {
    /// First guess.
    pub start: Located<Start>,
    /// Most iterations.
    pub max_iterations: Located<usize>,
    /// Weight of the gap against the multiplier, in units of the slave's stiffness.
    pub c: Located<f64>,
}

/// `[[contact]]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Contact {
    /// The block.
    pub head: Head,
    /// Its name, `contact-0`, ... by default.
    pub name: Located<String>,
    /// Slave sides.
    pub slave: Vec<Located<SideRef>>,
    /// What they face.
    pub master: Master,
    /// The gap as a formula of the geometric gap g and x, y, z, t; default g.
    pub gap: Located<Formula>,
    /// Method.
    pub method: Located<Method>,
    /// Multiplier.
    pub multiplier: Located<Multiplier>,
    /// Integration.
    pub integration: Located<Integration>,
    /// Gauss points per segment beyond max(p_slave, p_master) + 1.
    pub extra_points: Located<usize>,
    /// Cone.
    pub cone: Located<Cone>,
    /// Farther points face nothing (a length), `None`: auto.
    pub reach: Located<Option<f64>>,
    /// Exact multiplier, negative in compression (force per area).
    pub exact: Option<Located<Formula>>,
    /// Active set.
    pub active_set: ActiveSetSpec,
    /// Augmented: error of the multipliers at which the iteration ends, relative; none: auto.
    pub tolerance: Located<Option<f64>>,
    /// Multiplies modulus / h, `None`: auto.
    pub factor: Located<Option<f64>>,
    /// Variant of nitsche.
    pub variant: Located<Variant>,
}

/// How linear systems are solved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Linear {
    /// The program chooses.
    Auto,
    /// Factorisation.
    Direct,
    /// Krylov.
    Iterative,
}

/// `[solver]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Solver {
    /// Name of the constraint solver: `auto`, `saddle-point`, `condensed`, `schur`, `uzawa`, or one of a registry.
    pub constraint: Located<String>,
    /// Linear solver.
    pub linear: Located<Linear>,
    /// Error and residual at which iterations end, relative.
    pub tolerance: Located<f64>,
    /// Most iterations of an iterative solver, `None`: auto.
    pub max_iterations: Option<Located<usize>>,
}

/// `[[probe]]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Probe {
    /// The block.
    pub head: Head,
    /// Its name, `probe-0`, ... by default.
    pub name: Located<String>,
    /// The quantity as text.
    pub quantity: Located<String>,
}

/// What a check demands; the numbers may be formulas of constants and quantities.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Condition {
    /// value < bound.
    Below(Located<Formula>),
    /// value > bound.
    Above(Located<Formula>),
    /// |value - expected| <= atol + rtol |expected|; one of them may be absent.
    Equals {
        /// Expected value.
        value: Located<Formula>,
        /// Relative tolerance.
        rtol: Option<Located<Formula>>,
        /// Absolute tolerance.
        atol: Option<Located<Formula>>,
    },
}

/// `[[check]]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Check {
    /// The block.
    pub head: Head,
    /// Its name, `check-0`, ... by default.
    pub name: Located<String>,
    /// The quantity as text.
    pub quantity: Located<String>,
    /// What is demanded.
    pub condition: Condition,
    /// Only for this backend.
    pub backend: Option<Located<String>>,
    /// `over = "all"`: both extremes.
    pub over_all: Option<Located<()>>,
}

/// `[study.NAME]`: what a study varies where the command line is silent.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StudyValues {
    /// The command: `compare`, `convergence`, ...
    pub name: String,
    /// Number of levels.
    pub levels: Option<usize>,
    /// As words of the command line: `1,2,3` or `iga:2,3,4`.
    pub degrees: Vec<String>,
    /// Names of backends, `SLAVE+MASTER` for one on slave patches.
    pub backends: Vec<String>,
    /// Multipliers, by name or as the text of their data.
    pub pairings: Vec<String>,
    /// Integrations of interfaces and contacts.
    pub integration: Vec<String>,
    /// Their points beyond the default.
    pub extra_points: Vec<usize>,
    /// As words of the command line: `KEY=v1,v2`.
    pub vary: Vec<String>,
    /// Probes or quantities.
    pub quantities: Vec<String>,
    /// Largest relative difference from the first row.
    pub tol: Option<f64>,
    /// Norms of the inf-sup test: `l2`, `h-half`.
    pub norm: Option<String>,
    /// Ends of slave sides in the inf-sup test: `case`, `zero`, `free`.
    pub ends: Option<String>,
}
