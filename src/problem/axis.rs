//! The axis of bodies of revolution: nothing lies beyond it, and what lies on it has u_r = 0 and no area.

use super::builder::Problem;
use super::coupled::StatedOpponent;
use super::data::Point;
use super::error::ProblemError;
use super::handles::Statement;
use super::model::{BodyModel, BodySide, Condition, Model, Value};
use super::resultant::Resultant;
use super::revolution_error::RevolutionError;
use super::rigid::RigidForm;
use crate::basis::{Cell, Order};
use crate::coupling::Segments;
use crate::geometry::{Embedding, MapTable, cell, circumference};
use crate::linalg::{Matrix, Vector};
use crate::quadrature::Quadrature;
use crate::space::Trace;
use std::borrow::Cow;
use std::sync::Arc;

/// Radii below this share of the size of a body are rounding.
const ROUNDING: f64 = 1e-9;

/// The radius below which a point of a body counts as one of the axis.
fn nothing<const S: usize, const N: usize>(body: &BodyModel<S, N>) -> f64 {
    ROUNDING * body.extent.map_or(0.0, |b| b.diagonal())
}

/// Whether a side lies on the axis wholly.
fn is_on_axis<const S: usize, const N: usize>(body: &BodyModel<S, N>, side: &BodySide<S, N>) -> bool {
    let (space, least, mut map) = (&*side.trace.space, nothing(body), MapTable::new());
    (0..space.num_elements()).all(|e| {
        space.map(e, &side.rules.rule(e).points, Order::Values, &mut map);
        map.x.iter().all(|x| x[0].abs() <= least)
    })
}

/// The faces of the elements of a plane body that lie on the axis, but for those that are a point.
fn facets_on_axis<const S: usize, const N: usize>(body: &BodyModel<S, N>) -> Vec<Embedding<S, N>> {
    let (space, least, mut map, mut found) = (&**body.body.space(), nothing(body), MapTable::new(), Vec::new());
    for element in 0..space.num_elements() {
        let kind = space.cell(element);
        let corners = cell::corners::<N, f64>(kind);
        for face in cell::faces::<N, f64>(kind) {
            let [origin, end] = [face.corners[0], face.corners[1]].map(|c| corners[c]);
            let facet = Embedding { element, origin, axes: Matrix::<N, S>::from_fn(|i, _| end[i] - origin[i]) };
            let points: Vec<Vector<N>> = (0..5).map(|k| facet.lift(&Vector::repeat(k as f64 / 4.0))).collect();
            space.map(element, &points, Order::Values, &mut map);
            let is_long = (map.x[4] - map.x[0]).norm() > least;
            if is_long && map.x.iter().all(|x| x[0].abs() <= least) {
                found.push(facet);
            }
        }
    }
    found
}

impl<const S: usize, const N: usize> Problem<S, N> {
    /// Reports points beyond the axis, and what acts on sides of no area.
    pub(super) fn check_axis(&self, errors: &mut Vec<ProblemError>) {
        if !self.is_revolved {
            return;
        }
        for body in &self.bodies {
            let (space, least, mut map) = (&**body.body.space(), nothing(body), MapTable::new());
            let beyond = (0..space.num_elements()).find_map(|e| {
                let points = [cell::corners::<N, f64>(space.cell(e)), body.rules.rule(e).points.clone()].concat();
                space.map(e, &points, Order::Values, &mut map);
                map.x.iter().find(|x| x[0] < -least).copied()
            });
            if let Some(x) = beyond {
                let kind = RevolutionError::BeyondAxis { x: Point::new(x.as_slice()).x }.into();
                errors.push(ProblemError::new(kind, vec![body.id.into()], vec![body.name.clone()]));
            }
        }
        let mut radial = Vec::new();
        let mut refuse = |of: Statement, side: &BodySide<S, N>| {
            let known = errors.iter().any(|e| e.kind == RevolutionError::OnAxis.into() && e.of == [of]);
            if !known && is_on_axis(&self.bodies[side.patch], side) {
                errors.push(ProblemError::new(RevolutionError::OnAxis.into(), vec![of], vec![side.label.clone()]));
            }
        };
        self.said.loads.iter().for_each(|l| refuse(l.of, &l.side));
        self.said.springs.iter().for_each(|s| refuse(s.of, &s.side));
        // u_r is zero there
        let moved = |c: &&Condition<S, N>| c.component == 0 && self.components() > 1 && matches!(&c.value, Value::Data(_));
        self.said.conditions.iter().filter(moved).for_each(|c| refuse(c.of, &c.side));
        for load in self.said.point_loads.iter().filter(|l| l.component == 0 && self.components() > 1) {
            let least = nothing(&self.bodies[load.rim.patch]);
            if load.force.as_constant() != Some(0.0) && load.rim.rim.x.iter().all(|x| x[0].abs() <= least) {
                radial.push(ProblemError::new(RevolutionError::OnAxis.into(), vec![load.of], vec![load.rim.label.clone()]));
            }
        }
        for tie in &self.ties {
            tie.own.pairs.iter().flat_map(|p| p.masters.iter().chain([&p.slave])).for_each(|side| refuse(tie.id().into(), side));
        }
        for contact in &self.contacts {
            contact.own.slaves.iter().for_each(|side| refuse(contact.id().into(), side));
        }
        errors.append(&mut radial);
        for contact in &self.contacts {
            if matches!(contact.own.faced, StatedOpponent::Obstacle { .. })
                && contact.own.forces.iter().any(|(component, _)| *component == 0)
            {
                errors.push(ProblemError::new(RevolutionError::RadialForce.into(), vec![contact.id().into()], vec![contact.name.clone()]));
            }
        }
    }
}

impl<const S: usize, const N: usize> Model<S, N> {
    /// Whether its bodies are those of revolution: all of them, or none.
    pub(super) fn is_revolved(&self) -> bool {
        self.patches.first().is_some_and(BodyModel::is_revolved)
    }

    /// The factor of integrals: 2 pi r of bodies of revolution, else 1.
    pub(super) fn around(&self, x: &Vector<N>) -> f64 {
        if self.is_revolved() { circumference(x) } else { 1.0 }
    }

    /// Segments of the curve whose surface of revolution `segments` are those of.
    pub(super) fn along_curve<'a>(&self, segments: &'a Segments<S>, slave: &BodySide<S, N>) -> Cow<'a, Segments<S>> {
        if !self.is_revolved() {
            return Cow::Borrowed(segments);
        }
        Cow::Owned(segments.clone().scaled(&*slave.trace.space, &|x| 1.0 / circumference(x)))
    }

    /// A resultant in space: bodies of revolution have no moments.
    pub(super) fn in_space(&self, resultant: Resultant) -> Resultant {
        if self.is_revolved() { Resultant { moment: [0.0; 3], ..resultant } } else { resultant }
    }

    /// The sum of all external forces as it has to vanish: radial forces of bodies of revolution need not.
    pub(super) fn balanced(&self, resultant: Resultant) -> Resultant {
        let mut all = self.in_space(resultant);
        if self.is_revolved() && self.components > 1 {
            all.force[0] = 0.0;
        }
        all
    }

    /// Segments of the surface that a slave side stands for.
    pub(super) fn revolved(&self, segments: Segments<S>, slave: &BodySide<S, N>) -> Segments<S> {
        if self.is_revolved() { segments.revolved(&*slave.trace.space) } else { segments }
    }

    /// Whether a condition asks for no more than u_r = 0 on the axis: it holds by symmetry, and there is no reaction to it.
    pub(super) fn is_symmetry(&self, condition: &Condition<S, N>) -> bool {
        let side = &condition.side;
        self.is_revolved() && self.components > 1 && condition.component == 0 && is_on_axis(&self.patches[side.patch], side)
    }

    /// Holds u_r = 0 where bodies lie on the axis and no support does.
    pub(super) fn hold_axis(&mut self) {
        if !self.is_revolved() || self.components == 1 {
            return;
        }
        for number in 0..self.patches.len() {
            let patch = &self.patches[number];
            let held: Vec<Arc<BodySide<S, N>>> =
                self.conditions.iter().filter(|c| c.component == 0 && c.side.patch == number).map(|c| c.side.clone()).collect();
            let is_held = |facet: &Embedding<S, N>| {
                let center = facet.lift(&Vector::repeat(0.5));
                let same = |f: &Embedding<S, N>| f.element == facet.element && (f.lift(&Vector::repeat(0.5)) - center).norm() <= ROUNDING;
                held.iter().any(|side| side.trace.facets.iter().any(same))
            };
            let mut facets = facets_on_axis(patch);
            facets.retain(|facet| !is_held(facet));
            if facets.is_empty() {
                continue;
            }
            let trace = Trace::from_facets(patch.body.space(), facets, Cell::Tensor).expect("nothing lies beyond the axis");
            let side = Arc::new(BodySide::of_trace(patch, number, "axis", format!("{}.axis", patch.name), trace));
            self.conditions.push(Condition { of: patch.id.into(), side, component: 0, value: Value::Zero });
        }
    }

    /// The motions that symmetry around the axis holds of `bodies` bodies: all but the translation along the axis.
    pub(super) fn held_by_symmetry(&self, bodies: usize) -> Vec<RigidForm> {
        if !self.is_revolved() || self.components == 1 {
            return Vec::new();
        }
        // modes: translations x and y, rotation
        let mode = |body: usize, k: usize| vec![(body, std::array::from_fn(|i| f64::from(u8::from(i == k))))];
        (0..bodies).flat_map(|body| [mode(body, 0), mode(body, 2)]).collect()
    }
}
