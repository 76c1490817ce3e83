//! Bodies, their sides and rims.

use crate::assembly::{Rim, gauss_rules_along, points_of_curved_cells, revolved};
use crate::basis::Order;
use crate::geometry::{Bounds, Geometry, MapTable, Sag};
use crate::linalg::{Vector, measure};
use crate::problem::changing::Changing;
use crate::problem::data::{Data, Exact};
use crate::problem::handles::BodyId;
use crate::problem::physics::Physics;
use crate::quadrature::{PerElement, Quadrature};
use crate::space::{Body, Connected, Field, Trace};
use std::sync::{Arc, OnceLock};

/// A body with its unknowns and its material.
#[derive(Clone, Debug)]
pub struct BodyModel<const S: usize, const N: usize> {
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
    /// Its material at the first time; [`BodyModel::physics_at`] at any other.
    pub physics: Physics<N>,
    /// The material as a function of time; `None` if it does not change.
    pub changing: Option<Changing<Physics<N>>>,
    /// Rules of the bulk integrals, with the factor 2 pi r of bodies of revolution.
    pub rules: PerElement<N>,
    /// The rules without that factor, of bodies of revolution.
    pub plane_rules: Option<PerElement<N>>,
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
    /// Exact solution in the patch.
    pub exact: Option<Arc<dyn Exact>>,
    /// Body force or source of the patch, one function per component.
    pub source: Vec<Data>,
    /// Density and gravity, one pair per weight.
    pub weights: Vec<(Data, Vector<N>)>,
}

impl<const S: usize, const N: usize> BodyModel<S, N> {
    /// A body whose unknowns begin at `first`, without loads; `extra_points` Gauss points per direction beyond those that its degree and its
    /// curved cells need.
    pub fn new(id: BodyId, name: String, body: Arc<dyn Body<S, N>>, physics: Physics<N>, first: usize, extra_points: usize) -> Self {
        let curved = points_of_curved_cells(&**body.space());
        Self {
            id,
            name,
            backend: String::new(),
            field: Field { first, components: physics.components() },
            rules: gauss_rules_along(&**body.space(), curved.map(|k| k + extra_points)),
            // the normals of its sides are products of two derivatives of the map as well
            extra_points: extra_points + curved.into_iter().max().unwrap_or(0),
            plane_rules: None,
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
            exact: None,
        }
    }

    /// The body of revolution that it stands for.
    #[must_use]
    pub fn revolved(mut self) -> Self {
        let rules = revolved(&**self.body.space(), &self.rules);
        self.plane_rules = Some(std::mem::replace(&mut self.rules, rules));
        self
    }

    /// Rules of the integrals over its elements as they are, without the factor 2 pi r of bodies of revolution.
    pub fn rules_of_map(&self) -> &PerElement<N> {
        self.plane_rules.as_ref().unwrap_or(&self.rules)
    }

    /// Whether it stands for a body of revolution.
    pub fn is_revolved(&self) -> bool {
        self.plane_rules.is_some()
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
pub struct BodySide<const S: usize, const N: usize> {
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
    /// The side of which this is a piece between kinks; `None` for one that was said as it is.
    pub(crate) whole: Option<Whole<S, N>>,
    /// The sag of its facets as those of its pieces, once one of these was asked for it.
    pub(crate) sag_of_pieces: OnceLock<Sag<S, N>>,
}

/// A side, and its elements that a piece of it consists of.
#[derive(Debug)]
pub(crate) struct Whole<const S: usize, const N: usize> {
    /// The side.
    pub side: Arc<BodySide<S, N>>,
    /// The elements, in the order of those of the piece.
    pub elements: Vec<usize>,
}

impl<const S: usize, const N: usize> BodySide<S, N> {
    /// The side as it was said, of which this may be a piece.
    pub(crate) fn said(self: &Arc<Self>) -> Arc<Self> {
        self.whole.as_ref().map_or(self, |whole| &whole.side).clone()
    }

    /// The patch behind an element of the side.
    pub(crate) fn patch_of(&self, element: usize) -> usize {
        self.runs[self.runs.partition_point(|r| r.0 <= element) - 1].1
    }

    /// Measure of the side by its rules \[length^S\], of a body of revolution with the factor 2 pi r.
    pub fn measure(&self) -> f64 {
        let mut map = MapTable::new();
        (0..self.trace.facets.len()).map(|element| self.measure_of(element, &mut map)).sum()
    }

    /// Measure of an element of the side by its rule \[length^S\], of a body of revolution with the factor 2 pi r.
    pub(crate) fn measure_of(&self, element: usize, map: &mut MapTable<S, N>) -> f64 {
        let rule = self.rules.rule(element);
        self.trace.space.map(element, &rule.points, Order::Gradients, map);
        rule.weights.iter().zip(&map.jacobian).map(|(w, j)| w * measure(j)).sum()
    }
}

/// An edge or a corner of a body, or points, edges or faces of it that have a name.
#[derive(Clone, Debug)]
pub struct BodyRim<const N: usize> {
    /// The patch.
    pub patch: usize,
    /// Canonical name: u0w1, u0v0w0, ..., or that of the mesh.
    pub name: String,
    /// Name in results: "lower.u0w1".
    pub label: String,
    /// Its points and functions.
    pub rim: Rim<N>,
}
