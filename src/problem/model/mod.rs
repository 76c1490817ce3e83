//! Bodies, conditions, loads, interfaces and contacts, ready to be assembled.

mod body;
mod contact;
mod imposed;
mod slide;
mod tie;

pub(crate) use body::Whole;
pub use body::{BodyModel, BodyRim, BodySide};
pub use contact::{ContactModel, ContactPart, Opposing};
pub use imposed::{
    Action, Condition, Foundation, HeldSide, PointCondition, PointLoad, RigidSides, SaidEquation, SideLoad, SideSpring, Value,
};
pub use slide::{CurvedSlide, SlidePart, tangents};
pub use tie::{Pairing, TieModel, TiePart};

use super::corners::SharedCorner;
use super::facets_apart::FacetsApart;
use super::glued::{Glued, SharedPoint};
use crate::assembly::Equation;
use crate::linalg::Vector;
use crate::physics::Flux;
use std::sync::Arc;

/// A problem, ready to be assembled.
#[derive(Debug)]
pub struct Model<const S: usize, const N: usize> {
    /// Components of the unknown.
    pub components: usize,
    /// Number of unknowns, prescribed ones included.
    pub unknowns: usize,
    /// Bodies, with unknowns in their order.
    pub patches: Vec<BodyModel<S, N>>,
    /// Functions that glued patches share.
    pub glued: Glued,
    /// Points in which patches of one mesh hold together beside their common facets.
    pub hinges: Vec<SharedPoint<N>>,
    /// Prescribed components.
    pub conditions: Vec<Condition<S, N>>,
    /// Corners in which prescribed sides of several bodies meet.
    pub corners: Vec<SharedCorner<N>>,
    /// Components prescribed on edges and in corners.
    pub pins: Vec<PointCondition<N>>,
    /// Sides with at least one prescribed component.
    pub supports: Vec<Arc<BodySide<S, N>>>,
    /// Equations between unknowns: sliding along inclined sides, sides that move as one.
    pub equations: Vec<SaidEquation>,
    /// Sides held by equations.
    pub held: Vec<HeldSide<S, N>>,
    /// Curved sides that slide, with their rows.
    pub slides: Vec<SlidePart<S, N>>,
    /// Sides that move as one along an axis; their equations are among those above.
    pub rigid_sides: Vec<RigidSides<S, N>>,
    /// Loads on sides.
    pub loads: Vec<SideLoad<S, N>>,
    /// Forces on edges and in corners.
    pub point_loads: Vec<PointLoad<N>>,
    /// Springs on sides.
    pub springs: Vec<SideSpring<S, N>>,
    /// Springs of the volume.
    pub foundations: Vec<Foundation>,
    /// Warnings of the searches for touching sides from which the problem was made.
    pub findings: Vec<FacetsApart>,
    /// Tied interfaces.
    pub ties: Vec<TieModel<S, N>>,
    /// Contacts.
    pub contacts: Vec<ContactModel<S, N>>,
    /// Rows of all curved sides that slide, interfaces and contacts.
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
    /// Whether the exact solution is known, in all patches.
    pub fn has_exact(&self) -> bool {
        !self.patches.is_empty() && self.patches.iter().all(|p| p.exact.is_some())
    }

    /// A model of bodies without conditions, loads, ties and contacts; `glued` and `hinges` join them.
    pub fn new(patches: Vec<BodyModel<S, N>>, glued: Glued, hinges: Vec<SharedPoint<N>>) -> Self {
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
            slides: Vec::new(),
            rigid_sides: Vec::new(),
            loads: Vec::new(),
            point_loads: Vec::new(),
            springs: Vec::new(),
            foundations: Vec::new(),
            findings: Vec::new(),
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

    /// Number of multipliers: all rows except those of contacts at points.
    pub fn num_multipliers(&self) -> usize {
        let at_points = self.contacts.iter().flat_map(|c| &c.parts).filter(|part| part.multiplier.is_none());
        self.rows - at_points.map(|part| part.num_rows).sum::<usize>()
    }

    /// Number of unknowns without those that gluing makes dependent.
    pub fn num_primal(&self) -> usize {
        self.unknowns - self.glued.num_bound()
    }

    /// The flux of a body on one of its sides at time `t`.
    pub(super) fn flux(&self, side: &BodySide<S, N>, t: f64) -> Box<dyn Flux<S, N>> {
        let patch = &self.patches[side.patch];
        patch.physics_at(t).flux(patch.body.space(), &side.trace, patch.field, patch.is_revolved())
    }

    /// All conditions between unknowns: glued functions first.
    pub(super) fn all_equations(&self) -> Vec<Equation> {
        let mut all = self.glued.equations();
        all.extend(self.equations.iter().map(|e| e.equation.clone()));
        all
    }
}
