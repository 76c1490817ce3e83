//! Fluxes through the sides of ties and contacts, with their bounds by the energy of the bodies on the integration of the interface.

use super::model::BodySide;
use crate::coupling::nitsche::{bounds, master_bounds};
use crate::coupling::{Segments, Side};
use crate::linalg::Vector;
use crate::physics::{Flux, FluxTable};
use crate::space::Field;

/// A flux whose bounds are computed once, on the segments of its interface. They hold for the measure of the facets and for the sums over
/// all these points, so a method that weights fluxes by them has the weights of the solution at any points it is asked for.
#[derive(Debug)]
pub(super) struct BoundedFlux<const S: usize, const N: usize> {
    flux: Box<dyn Flux<S, N>>,
    /// Bound by element; zero for elements that are not in the segments.
    bounds: Vec<f64>,
}

impl<const S: usize, const N: usize> BoundedFlux<S, N> {
    /// The flux through `side`, whose bounds are computed when a method asks for them.
    pub fn unbounded(flux: Box<dyn Flux<S, N>>) -> Self {
        Self { flux, bounds: Vec::new() }
    }

    /// The flux through a slave side with its bounds on `elements`; without them where one has none, which its method reports.
    pub fn of_slave(flux: Box<dyn Flux<S, N>>, side: &BodySide<S, N>, field: Field, elements: &[usize]) -> Self {
        let bounds = bounds(&Side { trace: &side.trace, field, flux: Some(&*flux) }, elements).unwrap_or_default();
        Self { flux, bounds }
    }

    /// The flux through a master side with its bounds on `segments`; without them where one has none, which its method reports.
    pub fn of_master(flux: Box<dyn Flux<S, N>>, side: &BodySide<S, N>, field: Field, segments: &Segments<S>) -> Self {
        let bounds = master_bounds(&Side { trace: &side.trace, field, flux: Some(&*flux) }, segments).unwrap_or_default();
        Self { flux, bounds }
    }
}

impl<const S: usize, const N: usize> Flux<S, N> for BoundedFlux<S, N> {
    fn tabulate(&self, element: usize, xi: &[Vector<S>], table: &mut FluxTable) {
        self.flux.tabulate(element, xi, table);
    }

    fn stabilisation(&self, element: usize) -> f64 {
        let known = self.bounds.get(element).copied().filter(|d| *d > 0.0);
        known.unwrap_or_else(|| self.flux.stabilisation(element))
    }

    fn stabilisation_of_sum(&self, element: usize, xi: &[Vector<S>], ds: &[f64]) -> f64 {
        let known = self.bounds.get(element).copied().filter(|d| *d > 0.0);
        known.unwrap_or_else(|| self.flux.stabilisation_of_sum(element, xi, ds))
    }
}
