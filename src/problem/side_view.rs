//! Sides of bodies as others see them.

use super::model::SideModel;
use crate::quadrature::PerElement;
use crate::space::Trace;
use std::fmt::{Debug, Formatter};
use std::sync::Arc;

/// A side of a body, or several sides of a contact as one. A clone is the same side.
#[derive(Clone)]
pub struct SideView<const S: usize, const N: usize>(pub(super) Arc<SideModel<S, N>>);

impl<const S: usize, const N: usize> SideView<S, N> {
    /// Number of its body, of several sides that of the first.
    pub fn number(&self) -> usize {
        self.0.patch
    }

    /// Its name in the body: u0, v1, a tag.
    pub fn name(&self) -> &str {
        &self.0.side
    }

    /// Its name in results: "lower.v0".
    pub fn label(&self) -> &str {
        &self.0.label
    }

    /// Functions, map and facets.
    pub fn trace(&self) -> &Trace<S, N> {
        &self.0.trace
    }

    /// (first element, number of the body) of every run of elements; one run, unless several sides are one.
    pub fn runs(&self) -> &[(usize, usize)] {
        &self.0.runs
    }

    /// Rules of integrals over the side.
    pub fn rules(&self) -> &PerElement<S> {
        &self.0.rules
    }

    /// Highest degree of its functions.
    pub fn degree(&self) -> usize {
        self.0.degree()
    }
}

impl<const S: usize, const N: usize> Debug for SideView<S, N> {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        f.debug_tuple("SideView").field(&self.0.label).finish()
    }
}

impl<const S: usize, const N: usize> From<&Arc<SideModel<S, N>>> for SideView<S, N> {
    fn from(side: &Arc<SideModel<S, N>>) -> Self {
        Self(Arc::clone(side))
    }
}
