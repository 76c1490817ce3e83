//! Fluxes of the bodies at both sides of a contact, for methods that need them.

use super::contact_rows::ContactSides;
use super::model::{BodySide, Model};
use crate::linalg::Vector;
use crate::physics::{Flux, FluxTable};

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
pub(super) struct SideFluxes<const S: usize, const N: usize> {
    slave: Box<dyn Flux<S, N>>,
    master: JoinedFlux<S, N>,
}

impl<const S: usize, const N: usize> SideFluxes<S, N> {
    /// The flux through the slave side.
    pub(super) fn slave(&self) -> &dyn Flux<S, N> {
        &*self.slave
    }

    /// The flux through the master sides, joined into one.
    pub(super) fn master(&self) -> &dyn Flux<S, N> {
        &self.master
    }
}

impl<const S: usize, const N: usize> ContactSides<'_, S, N> {
    /// The fluxes of the bodies at time `t`.
    pub(super) fn fluxes(&self, model: &Model<S, N>, t: f64) -> SideFluxes<S, N> {
        let of = |side: &BodySide<S, N>| {
            let patch = &model.patches[side.patch];
            patch.physics_at(t).flux(patch.body.space(), &side.trace, patch.field, patch.is_revolved())
        };
        let mut next = 0;
        let runs = self.masters.iter().map(|m| {
            let first = next;
            next += m.trace.facets.len();
            (first, of(m))
        });
        SideFluxes { slave: of(self.slave), master: JoinedFlux { runs: runs.collect() } }
    }

    /// Whether a material of the bodies changes with the time.
    pub(super) fn change(&self, model: &Model<S, N>) -> bool {
        self.masters.iter().map(|m| &**m).chain([self.slave]).any(|side| model.patches[side.patch].changing.is_some())
    }
}
