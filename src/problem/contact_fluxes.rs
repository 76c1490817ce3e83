//! Fluxes of the bodies at both sides of a contact, for methods that need them.

use super::bounded_flux::BoundedFlux;
use super::contact_rows::ContactSides;
use super::model::{Model, Opposing};
use crate::contact::ContactKinematics;
use crate::coupling::Segments;
use crate::linalg::Vector;
use crate::physics::{Flux, FluxTable};
use std::sync::Arc;

/// Flux through several sides that are joined into one.
#[derive(Debug)]
struct JoinedFlux<const S: usize, const N: usize> {
    /// First element of every side, and its flux.
    runs: Vec<(usize, Box<dyn Flux<S, N>>)>,
}

impl<const S: usize, const N: usize> JoinedFlux<S, N> {
    /// Returns the flux of the side with `element`, and the element's number there.
    fn of(&self, element: usize) -> (&dyn Flux<S, N>, usize) {
        let (first, flux) = &self.runs[self.runs.partition_point(|run| run.0 <= element) - 1];
        (&**flux, element - first)
    }
}

impl<const S: usize, const N: usize> Flux<S, N> for JoinedFlux<S, N> {
    fn tabulate(&self, element: usize, xi: &[Vector<S>], table: &mut FluxTable) {
        let (flux, own) = self.of(element);
        flux.tabulate(own, xi, table);
    }

    fn stabilisation(&self, element: usize) -> f64 {
        let (flux, own) = self.of(element);
        flux.stabilisation(own)
    }

    fn stabilisation_of_sum(&self, element: usize, xi: &[Vector<S>], ds: &[f64]) -> f64 {
        let (flux, own) = self.of(element);
        flux.stabilisation_of_sum(own, xi, ds)
    }
}

/// The fluxes through both sides of a contact at a time.
#[derive(Debug)]
pub struct SideFluxes<const S: usize, const N: usize> {
    slave: BoundedFlux<S, N>,
    master: Option<BoundedFlux<S, N>>,
}

impl<const S: usize, const N: usize> SideFluxes<S, N> {
    /// The flux through the slave side.
    pub(super) fn slave(&self) -> &dyn Flux<S, N> {
        &self.slave
    }

    /// The flux through the master sides, joined into one; `None` against an obstacle.
    pub(super) fn master(&self) -> Option<&dyn Flux<S, N>> {
        self.master.as_ref().map(|flux| flux as _)
    }
}

impl<const S: usize, const N: usize> ContactSides<'_, S, N> {
    /// The fluxes of the bodies at time `t`, with their bounds on the points that face each other.
    pub(super) fn fluxes(&self, model: &Model<S, N>, t: f64) -> Arc<SideFluxes<S, N>> {
        let t = if self.change(model) { t } else { 0.0 };
        self.fluxes.at(t, || {
            let (flux, field) = (model.flux(self.slave, t), model.patches[self.slave.patch].field);
            let slave = |segments: &Segments<S>| BoundedFlux::of_slave(flux, self.slave, field, &segments.slave);
            let (master, segments) = match self.against {
                Opposing::Rigid(_, segments, _) => return SideFluxes { slave: slave(segments), master: None },
                Opposing::Side(master, segments) => (master, segments),
            };
            let faced = ContactKinematics::against_master(&self.slave.trace, &master.trace, segments).ok();
            let segments = faced.as_ref().map_or(segments, |(segments, _)| segments);
            let mut next = 0;
            let runs = self.masters.iter().map(|m| {
                let first = next;
                next += m.trace.facets.len();
                (first, model.flux(m, t))
            });
            let joined = Box::new(JoinedFlux { runs: runs.collect() });
            SideFluxes { slave: slave(segments), master: Some(BoundedFlux::of_master(joined, master, master.field, segments)) }
        })
    }

    /// Whether a material of the bodies changes with the time.
    pub(super) fn change(&self, model: &Model<S, N>) -> bool {
        self.masters.iter().map(|m| &**m).chain([self.slave]).any(|side| model.patches[side.patch].changing.is_some())
    }
}
