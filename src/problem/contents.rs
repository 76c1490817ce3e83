//! Contents of a system: its bodies, ties, contacts and supports, and their sizes.

use super::handles::BodyId;
use super::interface_view::InterfaceView;
use super::model::{BodyModel, Model};
use crate::quadrature::PerElement;
use crate::space::{Body, Space, Trace, measure, revolved_measure};
use std::ops::Range;
use std::sync::Arc;

/// Contents of a system: bodies, ties, contacts and supports in the order in which they were said.
#[derive(Clone, Copy, Debug)]
pub struct Contents<'a, const S: usize, const N: usize> {
    pub(super) model: &'a Model<S, N>,
}

impl<'a, const S: usize, const N: usize> Contents<'a, S, N> {
    /// Components of the unknown: one in conduction, N in elasticity.
    pub fn components(&self) -> usize {
        self.model.components
    }

    /// Whether the bodies are those of revolution.
    pub fn is_revolved(&self) -> bool {
        self.model.is_revolved()
    }

    /// Numbers of unknowns and rows, and the size of all bodies together.
    pub fn size(&self) -> SizeModel {
        let model = self.model;
        SizeModel {
            unknowns: model.unknowns,
            primal: model.num_primal(),
            rows: model.rows,
            multipliers: model.num_multipliers(),
            diagonal: model.size,
        }
    }

    /// Whether the exact solution is known.
    pub fn has_exact(&self) -> bool {
        self.model.has_exact()
    }

    /// The bodies.
    pub fn bodies(&self) -> impl ExactSizeIterator<Item = BodyView<'a, S, N>> + use<'a, S, N> {
        self.model.patches.iter().map(|patch| BodyView { patch })
    }

    /// The body with a number.
    ///
    /// # Panics
    /// If there are fewer bodies.
    pub fn body(&self, number: usize) -> BodyView<'a, S, N> {
        BodyView { patch: &self.model.patches[number] }
    }

    /// The ties.
    pub fn ties(&self) -> impl ExactSizeIterator<Item = InterfaceView<'a, S, N>> + use<'a, S, N> {
        self.model.ties.iter().map(InterfaceView::of_tie)
    }

    /// The contacts.
    pub fn contacts(&self) -> impl ExactSizeIterator<Item = InterfaceView<'a, S, N>> + use<'a, S, N> {
        self.model.contacts.iter().map(InterfaceView::of_contact)
    }

    /// The ties, then the contacts.
    pub fn interfaces(&self) -> impl Iterator<Item = InterfaceView<'a, S, N>> + use<'a, S, N> {
        self.ties().chain(self.contacts())
    }

    /// Sides, edges and corners that supports hold, sides first.
    pub fn supports(&self) -> impl Iterator<Item = SupportView<'a>> + use<'a, S, N> {
        let sides = self.model.supports.iter().map(|s| SupportView { body: s.patch, name: &s.side, label: &s.label, is_side: true });
        let rims = self.model.pins.iter().map(|p| &p.rim);
        sides.chain(rims.map(|r| SupportView { body: r.patch, name: &r.name, label: &r.label, is_side: false }))
    }
}

/// Numbers of unknowns and rows of a system, and the size of its bodies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SizeModel {
    /// Unknowns, prescribed and glued ones included.
    pub unknowns: usize,
    /// Unknowns without those that gluing makes dependent.
    pub primal: usize,
    /// Rows of all ties and contacts.
    pub rows: usize,
    /// Rows but for those at points.
    pub multipliers: usize,
    /// Diagonal of the box around all bodies \[length\].
    pub diagonal: f64,
}

/// A body of a problem or a system.
#[derive(Clone, Copy, Debug)]
pub struct BodyView<'a, const S: usize, const N: usize> {
    pub(super) patch: &'a BodyModel<S, N>,
}

impl<'a, const S: usize, const N: usize> BodyView<'a, S, N> {
    /// Its handle.
    pub fn id(&self) -> BodyId {
        self.patch.id
    }

    /// Its name.
    pub fn name(&self) -> &'a str {
        &self.patch.name
    }

    /// Name of the backend that made it; empty if it has none.
    pub fn backend(&self) -> &'a str {
        &self.patch.backend
    }

    /// The body itself.
    pub fn body(&self) -> &'a Arc<dyn Body<S, N>> {
        &self.patch.body
    }

    /// Its space.
    pub fn space(&self) -> &'a Arc<dyn Space<N, N>> {
        self.patch.body.space()
    }

    /// Rules of its integrals, without the factor 2 pi r of bodies of revolution.
    pub fn rules(&self) -> &'a PerElement<N> {
        self.patch.rules_of_map()
    }

    /// Its area or volume; the volume of the body of revolution that it stands for [length^N, or length^3].
    pub fn measure(&self) -> f64 {
        self.measure_of(&**self.space())
    }

    /// Length or area of one of its sides, the area of the surface of revolution that it stands for.
    pub fn side_measure(&self, side: &Trace<S, N>) -> f64 {
        self.measure_of(&*side.space)
    }

    fn measure_of<const D: usize>(&self, geometry: &dyn Space<D, N>) -> f64 {
        if self.patch.is_revolved() { revolved_measure(geometry) } else { measure(geometry) }
    }

    /// Gauss points per direction of its sides beyond degree + 1.
    pub fn extra_points(&self) -> usize {
        self.patch.extra_points
    }

    /// Its unknowns among those of the system.
    pub fn unknowns(&self) -> Range<usize> {
        self.patch.range()
    }
}

/// A side, edge or corner that supports hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SupportView<'a> {
    /// Number of its body.
    pub body: usize,
    /// Its name in the body: u0, u0w1, a tag.
    pub name: &'a str,
    /// Its name in results.
    pub label: &'a str,
    /// Whether it is a side, not an edge or a corner.
    pub is_side: bool,
}
