//! Bodies, conditions, loads, interfaces and contacts, ready to be assembled.

use super::changing::Changing;
use super::corners::SharedCorner;
use super::data::{Data, Exact};
use super::facets_apart::FacetsApart;
use super::function_sums::FunctionSums;
use super::glued::{Glued, Hinge};
use super::handles::{BodyId, ContactId, Statement, TieId};
use super::obstacle::ObstacleModel;
use super::physics::Physics;
use super::start::Start;
use crate::assembly::{Equation, Rim, gauss_rules_along, points_of_curved_cells};
use crate::basis::Basis;
use crate::contact::{Cone, ContactMethod, ContactRows};
use crate::coupling::consistency::Finer;
use crate::coupling::{Coupling, Rows, Segments};
use crate::geometry::{Bounds, Geometry};
use crate::linalg::{Triplets, Vector};
use crate::quadrature::PerElement;
use crate::space::{Body, Connected, Field, Trace};
use std::sync::Arc;

/// A body with its unknowns and its material.
#[derive(Clone, Debug)]
pub struct PatchModel<const S: usize, const N: usize> {
    /// Its handle.
    pub id: BodyId,
    /// Its name.
    pub name: String,
    /// Name of the backend that made it; empty if it has none.
    pub backend: String,
    /// The body.
    pub body: Arc<dyn Body<S, N>>,
    /// Place of its unknowns among those of the model.
    pub field: Field,
    /// Its material at the first time; [`PatchModel::physics_at`] at any other.
    pub physics: Physics<N>,
    /// The material as a function of time; `None` if it does not change.
    pub changing: Option<Changing<Physics<N>>>,
    /// Rules of the bulk integrals.
    pub rules: PerElement<N>,
    /// Gauss points per direction of its sides beyond degree + 1.
    pub extra_points: usize,
    /// The mesh before its refinement, by whose facets the surface is known; `None` if these are its own.
    pub unrefined: Option<Arc<dyn Body<S, N>>>,
    /// Whether its sides lie exactly on those of the geometry.
    pub exact_map: bool,
    /// Whether its facets stand for a geometry that is known, as those of a mesh made of a patch; not for meshes of cells, nor for exact maps.
    pub is_shaped: bool,
    /// Bounding box; `None` for a body without elements.
    pub extent: Option<Bounds<N>>,
    /// Its parts, which share no functions.
    pub parts: Connected,
    /// Body force or source of the patch, one function per component.
    pub source: Vec<Data>,
    /// Density and gravity, one pair per weight.
    pub weights: Vec<(Data, Vector<N>)>,
}

impl<const S: usize, const N: usize> PatchModel<S, N> {
    /// A body whose unknowns begin at `first`, without loads; `extra_points` Gauss points per direction beyond those that its degree and its
    /// curved cells need.
    pub(super) fn new(id: BodyId, name: String, body: Arc<dyn Body<S, N>>, physics: Physics<N>, first: usize, extra_points: usize) -> Self {
        let curved = points_of_curved_cells(&**body.space());
        Self {
            id,
            name,
            backend: String::new(),
            field: Field { first, components: physics.components() },
            rules: gauss_rules_along(&**body.space(), curved.map(|k| k + extra_points)),
            // the normals of its sides are products of two derivatives of the map as well
            extra_points: extra_points + curved.into_iter().max().unwrap_or(0),
            exact_map: body.is_exact(),
            extent: body.space().extent(),
            parts: Connected::of(&**body.space()),
            unrefined: None,
            is_shaped: false,
            body,
            physics,
            changing: None,
            source: Vec::new(),
            weights: Vec::new(),
        }
    }

    /// Its material at time `t`.
    pub fn physics_at(&self, t: f64) -> Physics<N> {
        match &self.changing {
            None => self.physics.clone(),
            Some(Changing(of)) => of(t),
        }
    }

    /// Number of unknowns.
    pub fn num_unknowns(&self) -> usize {
        self.field.components * self.body.space().num_functions()
    }

    /// Its unknowns within those of the model.
    pub fn range(&self) -> std::ops::Range<usize> {
        self.field.first..self.field.first + self.num_unknowns()
    }
}

/// A side of a body, or several sides of a contact as one.
#[derive(Debug)]
pub struct SideModel<const S: usize, const N: usize> {
    /// The patch.
    pub(crate) patch: usize,
    /// Canonical name of the side: u0, v1, ...
    pub(crate) side: String,
    /// Name in results: "lower.bottom".
    pub(crate) label: String,
    /// Functions, map and facets.
    pub(crate) trace: Trace<S, N>,
    /// Place of the unknowns of the trace's functions among those of the model.
    pub(crate) field: Field,
    /// (first element, patch) of every run of elements; one run, unless several sides are joined.
    pub(crate) runs: Vec<(usize, usize)>,
    /// Rules of integrals over the side.
    pub(crate) rules: PerElement<S>,
}

impl<const S: usize, const N: usize> SideModel<S, N> {
    /// The patch behind an element of the side.
    pub(crate) fn patch_of(&self, element: usize) -> usize {
        self.runs[self.runs.partition_point(|r| r.0 <= element) - 1].1
    }
}

/// A prescribed value.
#[derive(Clone, Debug)]
pub enum Value {
    /// Zero.
    Zero,
    /// The exact solution.
    Exact,
    /// A function.
    Data(Data),
}

impl From<Data> for Value {
    fn from(data: Data) -> Self {
        if data.as_constant() == Some(0.0) { Self::Zero } else { Self::Data(data) }
    }
}

impl From<f64> for Value {
    fn from(value: f64) -> Self {
        Data::from(value).into()
    }
}

/// A component prescribed on a side.
#[derive(Clone, Debug)]
pub struct Condition<const S: usize, const N: usize> {
    /// The statement.
    pub of: Statement,
    /// The side.
    pub side: Arc<SideModel<S, N>>,
    /// The component.
    pub component: usize,
    /// Its value.
    pub value: Value,
}

/// An edge or a corner of a body.
#[derive(Debug)]
pub struct RimModel<const N: usize> {
    /// The patch.
    pub patch: usize,
    /// Canonical name: u0w1, u0v0w0, ...
    pub name: String,
    /// Name in results: "lower.u0w1".
    pub label: String,
    /// Its points and functions.
    pub rim: Rim<N>,
}

/// A component prescribed on an edge or in a corner.
#[derive(Clone, Debug)]
pub struct Pin<const N: usize> {
    /// The statement.
    pub of: Statement,
    /// The edge or the corner.
    pub rim: Arc<RimModel<N>>,
    /// The component.
    pub component: usize,
    /// Its value.
    pub value: Value,
}

/// A load per point of a side.
#[derive(Clone, Debug)]
pub enum Action {
    /// Component of the traction [force/area], or k du/dn.
    Traction(usize, Data),
    /// Component of the traction of the exact solution.
    Exact(usize),
    /// Pressure along minus the outward normal.
    Pressure(Data),
    /// Component of a resultant, spread evenly \[force\].
    Force(usize, Data, f64),
}

/// A load on a side.
#[derive(Clone, Debug)]
pub struct SideLoad<const S: usize, const N: usize> {
    /// The statement.
    pub of: Statement,
    /// The first statement of its name; loads of one are summed in results.
    pub group: Statement,
    /// Name of the load in results.
    pub name: String,
    /// The side.
    pub side: Arc<SideModel<S, N>>,
    /// The load.
    pub action: Action,
}

/// Sides that move as one in a component, driven by a resultant.
#[derive(Clone, Debug)]
pub struct RigidSides<const S: usize, const N: usize> {
    /// The sides.
    pub sides: Vec<Arc<SideModel<S, N>>>,
    /// The component that all their points have in common.
    pub component: usize,
}

/// Springs between a side and the ground.
#[derive(Clone, Debug)]
pub struct SideSpring<const S: usize, const N: usize> {
    /// The statement.
    pub of: Statement,
    /// Name of the springs in messages.
    pub name: String,
    /// The side.
    pub side: Arc<SideModel<S, N>>,
    /// The component.
    pub component: usize,
    /// Force/area per length.
    pub stiffness: Data,
}

/// A slave side paired with one master side.
#[derive(Debug)]
pub struct Pairing<const S: usize, const N: usize> {
    /// The master side.
    pub master: Arc<SideModel<S, N>>,
    /// Common segments of both sides.
    pub segments: Segments<S>,
    /// Second set of segments, for mixed integration.
    pub second: Option<Segments<S>>,
}

/// A slave side of a tied interface.
#[derive(Debug)]
pub struct TiePart<const S: usize, const N: usize> {
    /// The side that carries the multiplier.
    pub slave: Arc<SideModel<S, N>>,
    /// One multiplier space per component; empty if the coupling has no rows.
    pub multipliers: Vec<Box<dyn Basis<S>>>,
    /// (p, k) if the multiplier is the unstable pairing p/p-k under another name.
    pub unstable: Option<(usize, usize)>,
    /// The coupling of the sides.
    pub coupling: Arc<dyn Coupling<S, N>>,
    /// The master sides.
    pub pairings: Vec<Pairing<S, N>>,
    /// C in unknowns of the model.
    pub rows: Rows,
    /// B, if it differs from C.
    pub reaction: Option<Rows>,
    /// Per master, the integrals of every row's multiplier function; empty if the rows are not mortar rows.
    pub function_sums: Vec<Vec<FunctionSums<N>>>,
    /// Stiffness that the coupling adds in unknowns of the model, at the first time.
    pub stiffness: Triplets,
    /// Penalty stiffness over the stiffness of the slave unknowns; `None` for exact rows.
    pub penalty: Option<f64>,
    /// Rows of a finer integration, for the consistency error; `None` if the rows are not mortar rows.
    pub finer: Option<Finer>,
    /// First row in the system.
    pub first_row: usize,
    /// Number of rows.
    pub num_rows: usize,
}

/// A tied interface.
#[derive(Debug)]
pub struct TieModel<const S: usize, const N: usize> {
    /// Its handle.
    pub id: TieId,
    /// Its name.
    pub name: String,
    /// One part per slave side.
    pub parts: Vec<TiePart<S, N>>,
    /// Exact multiplier, one function per component; `None`: from the exact solution, if there is one.
    pub exact: Option<Vec<Data>>,
}

/// The opponent of a contact side.
pub enum Against<const S: usize, const N: usize> {
    /// A deformable side.
    Side(Arc<SideModel<S, N>>, Segments<S>),
    /// A rigid obstacle.
    Rigid(Arc<ObstacleModel<S, N>>, Segments<S>),
}

impl<const S: usize, const N: usize> std::fmt::Debug for Against<S, N> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Side(side, _) => f.debug_tuple("Side").field(&side.label).finish(),
            Self::Rigid(obstacle, _) => f.debug_tuple("Rigid").field(obstacle).finish(),
        }
    }
}

/// A slave side of a contact.
#[derive(Debug)]
pub struct ContactPart<const S: usize, const N: usize> {
    /// Place of the slave side in the statement.
    pub number: usize,
    /// The side that carries the multiplier.
    pub slave: Arc<SideModel<S, N>>,
    /// Multiplier space; `None` for methods whose rows belong to points.
    pub multiplier: Option<Box<dyn Basis<S>>>,
    /// Functions by which the pressure is evaluated; `None`: those of the multiplier.
    pub reading: Option<Box<dyn Basis<S>>>,
    /// (p, k) if the multiplier is the unstable pairing p/p-k under another name.
    pub unstable: Option<(usize, usize)>,
    /// Cone of admissible multipliers.
    pub cone: Cone,
    /// The opponent.
    pub against: Against<S, N>,
    /// Segments for the integrals over the master, for mixed integration.
    pub second: Option<Segments<S>>,
    /// Rows of a finer integration, for the consistency error; `None` against an obstacle and without multiplier.
    pub finer: Option<Finer>,
    /// Deformable master sides, joined into one in `against`.
    pub masters: Vec<Arc<SideModel<S, N>>>,
    /// Rows, offsets and weights at the first time at which a point of the side faces the opponent.
    pub first: ContactRows<S, N>,
    /// Whether they change with the time.
    pub changes: bool,
    /// First row in the system.
    pub first_row: usize,
    /// Number of rows.
    pub num_rows: usize,
}

impl<const S: usize, const N: usize> ContactPart<S, N> {
    /// The functions through which lambda is read at points, one per multiplier; none without multiplier.
    pub fn read_through(&self) -> Option<&dyn Basis<S>> {
        self.reading.as_deref().or(self.multiplier.as_deref())
    }

    /// Its rows in the system.
    pub fn rows(&self) -> std::ops::Range<usize> {
        self.first_row..self.first_row + self.num_rows
    }
}

/// A contact.
#[derive(Debug)]
pub struct ContactModel<const S: usize, const N: usize> {
    /// Its handle.
    pub id: ContactId,
    /// Slave sides, by their places in the statement, that face nothing while others do.
    pub idle: Vec<usize>,
    /// Its name.
    pub name: String,
    /// One part per slave side.
    pub parts: Vec<ContactPart<S, N>>,
    /// The rigid obstacle that it faces, if it is one.
    pub obstacle: Option<Arc<ObstacleModel<S, N>>>,
    /// Gap as a function of position, time and geometric gap.
    pub gap: Data,
    /// Largest distance of partners of rigid obstacles.
    pub reach: Option<f64>,
    /// Exact multiplier; none: from the model's exact solution, if any.
    pub exact: Option<Data>,
    /// Whether a zone that ends at the end of a side goes on beyond it: half models.
    pub symmetry: bool,
    /// First guess of the active set.
    pub start: Start,
    /// The method by which it is enforced.
    pub method: Arc<dyn ContactMethod<S, N>>,
}

/// A problem, ready to be assembled.
#[derive(Debug)]
pub struct Model<const S: usize, const N: usize> {
    /// Components of the unknown.
    pub components: usize,
    /// Number of unknowns, prescribed ones included.
    pub unknowns: usize,
    /// Bodies, with unknowns in their order.
    pub patches: Vec<PatchModel<S, N>>,
    /// Functions that glued patches share.
    pub glued: Glued,
    /// Points in which patches of one mesh hold together beside their common facets.
    pub hinges: Vec<Hinge<N>>,
    /// Prescribed components.
    pub conditions: Vec<Condition<S, N>>,
    /// Corners in which prescribed sides of several bodies meet.
    pub corners: Vec<SharedCorner<N>>,
    /// Components prescribed on edges and in corners.
    pub pins: Vec<Pin<N>>,
    /// Sides with at least one prescribed component.
    pub supports: Vec<Arc<SideModel<S, N>>>,
    /// Equations between unknowns: sliding along inclined sides, sides that move as one.
    pub equations: Vec<Equation>,
    /// Sides held by equations, with the direction: the normal, a tangent, or the axis along which the side moves as one.
    pub held: Vec<(Arc<SideModel<S, N>>, Vector<N>)>,
    /// Sides that move as one along an axis; their equations are among those above.
    pub rigid_sides: Vec<RigidSides<S, N>>,
    /// Loads on sides.
    pub loads: Vec<SideLoad<S, N>>,
    /// Springs on sides.
    pub springs: Vec<SideSpring<S, N>>,
    /// Warnings of the searches for touching sides from which the problem was made.
    pub findings: Vec<FacetsApart>,
    /// Manufactured solution.
    pub exact: Option<Arc<dyn Exact>>,
    /// Tied interfaces.
    pub ties: Vec<TieModel<S, N>>,
    /// Contacts.
    pub contacts: Vec<ContactModel<S, N>>,
    /// Rows of all interfaces and contacts.
    pub rows: usize,
    /// Largest number of iterations of the active set.
    pub max_iterations: usize,
    /// Weight of the gap in the active set.
    pub c: f64,
    /// Centre of the bounding box of all bodies.
    pub center: Vector<N>,
    /// Diagonal of the box around the model \[length\].
    pub size: f64,
}

impl<const S: usize, const N: usize> Model<S, N> {
    /// A model of bodies without conditions, loads, ties and contacts; `glued` and `hinges` join them.
    pub fn new(patches: Vec<PatchModel<S, N>>, glued: Glued, hinges: Vec<Hinge<N>>) -> Self {
        let whole = patches.iter().filter_map(|p| p.extent).reduce(|a, b| a.union(&b));
        let (center, size) = whole.map_or((Vector::zeros(), 1.0), |b| (b.center(), b.diagonal().max(f64::MIN_POSITIVE)));
        Self {
            components: patches.first().map_or(1, |p| p.field.components),
            unknowns: patches.last().map_or(0, |p| p.range().end),
            patches,
            glued,
            hinges,
            conditions: Vec::new(),
            corners: Vec::new(),
            pins: Vec::new(),
            supports: Vec::new(),
            equations: Vec::new(),
            held: Vec::new(),
            rigid_sides: Vec::new(),
            loads: Vec::new(),
            springs: Vec::new(),
            findings: Vec::new(),
            exact: None,
            ties: Vec::new(),
            contacts: Vec::new(),
            rows: 0,
            max_iterations: 100,
            c: 1.0,
            center,
            size,
        }
    }

    /// Number (unknown / components) of `function` of `patch`, of its representative if it is glued.
    pub fn function(&self, patch: usize, function: usize) -> usize {
        self.glued.root(self.patches[patch].field.first / self.components + function)
    }

    /// Number of multipliers: rows of all interfaces and contacts except those at points.
    pub fn num_multipliers(&self) -> usize {
        let at_points = self.contacts.iter().flat_map(|c| &c.parts).filter(|part| part.multiplier.is_none());
        self.rows - at_points.map(|part| part.num_rows).sum::<usize>()
    }

    /// Number of unknowns without those that gluing makes dependent.
    pub fn num_primal(&self) -> usize {
        self.unknowns - self.glued.num_bound()
    }

    /// All conditions between unknowns: glued functions first.
    pub(super) fn all_equations(&self) -> Vec<Equation> {
        let mut all = self.glued.equations();
        all.extend(self.equations.iter().cloned());
        all
    }
}
