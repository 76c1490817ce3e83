//! `[[contact]]`: slave sides, their masters or obstacles, and the enforcement of contact.

use super::{Components, Geometry, Head, Multiplier, SideRef};
use crate::case::given::Given;
use crate::formula::Formula;
use crate::place::Located;
pub use faying::contact::Cone;
use faying::contact::Needs;
pub use faying::problem::Start;

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
    /// f = 0, gap the distance to it, or f along a fixed direction.
    LevelSet {
        /// The function of x, y, z, t.
        f: Located<Formula>,
        /// The normal, of length 1, if the gap is f itself.
        along: Option<Located<Vec<f64>>>,
    },
    /// The shape of a patch, placed; `nurbs` and files of curves may have one parameter: the obstacle lies to their right.
    Geometry(Box<Geometry>),
    /// An obstacle of the registry.
    Entry {
        /// Its name.
        kind: String,
        /// Its values.
        given: Given,
    },
}

impl ObstacleShape {
    /// The word of its kind.
    pub fn kind(&self) -> &str {
        match self {
            Self::HalfPlane { .. } => "half-plane",
            Self::Sphere { .. } => "sphere",
            Self::Cylinder { .. } => "cylinder",
            Self::Torus { .. } => "torus",
            Self::LevelSet { .. } => "level-set",
            Self::Geometry(geometry) => geometry.shape.value.kind(),
            Self::Entry { kind, .. } => kind,
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

/// Master of a contact: sides of bodies, or a rigid obstacle.
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
    /// `where`: keeps only the slave's facets whose centre satisfies it.
    pub filter: Option<Located<Formula>>,
    /// Master sides or rigid obstacle.
    pub master: Master,
    /// The gap as a formula of the geometric gap g and x, y, z, t; default g.
    pub gap: Located<Formula>,
    /// Method.
    pub method: Located<String>,
    /// Needs of the method.
    pub needs: Needs,
    /// Values of the keys of the method.
    pub given: Given,
    /// Multiplier.
    pub multiplier: Located<Multiplier>,
    /// Integration, as of ties.
    pub integration: Located<String>,
    /// Gauss points per segment beyond max(p_slave, p_master) + 1.
    pub extra_points: Located<usize>,
    /// Cone.
    pub cone: Located<Cone>,
    /// Search distance: farther points have no partner (a length), `None`: auto.
    pub reach: Located<Option<f64>>,
    /// Exact multiplier, negative in compression (force per area).
    pub exact: Option<Located<Formula>>,
    /// Whether a zone that ends at the end of the side goes on beyond it: half models.
    pub symmetry: Located<bool>,
    /// Whether gaps and overlaps at rest that facets explain are closed.
    pub adjust: Located<bool>,
    /// Active set.
    pub active_set: ActiveSetSpec,
}

impl Contact {
    /// The sides that its slaves meet; none of a rigid obstacle.
    pub fn masters(&self) -> &[Located<SideRef>] {
        match &self.master {
            Master::Sides(masters) => masters,
            Master::Rigid(_) => &[],
        }
    }
}
