//! Contacts by Nitsche's method: fluxes of the bodies, rows and values at points.

use super::data::{Data, Point};
use super::model::{Against, ContactModel, ContactPart, Formulation, Model, SideModel};
use crate::contact::{Contact, ContactError, Opponent, PointValues, point_values};
use crate::coupling::{Nitsche, Segments, Side};
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

/// Slave side of a contact by Nitsche's method, and its opponent.
#[derive(Debug)]
pub struct PointSides<'a, const S: usize, const N: usize> {
    /// The slave side.
    pub slave: &'a SideModel<S, N>,
    /// The opponent.
    pub against: &'a Against<S, N>,
    /// Master sides, joined into one in `against`.
    pub masters: &'a [Arc<SideModel<S, N>>],
}

/// The fluxes through both sides of a contact at a time.
#[derive(Debug)]
pub(super) struct ContactFluxes<const S: usize, const N: usize> {
    slave: Box<dyn Flux<S, N>>,
    master: JoinedFlux<S, N>,
}

impl<const S: usize, const N: usize> PointSides<'_, S, N> {
    fn fluxes(&self, model: &Model<S, N>, t: f64) -> ContactFluxes<S, N> {
        let of = |side: &SideModel<S, N>| {
            let patch = &model.patches[side.patch];
            patch.physics_at(t).flux(patch.body.space(), &side.trace, patch.field)
        };
        let mut next = 0;
        let runs = self.masters.iter().map(|m| {
            let first = next;
            next += m.trace.facets.len();
            (first, of(m))
        });
        ContactFluxes { slave: of(self.slave), master: JoinedFlux { runs: runs.collect() } }
    }

    /// Whether a material of the bodies changes with the time.
    pub fn change(&self, model: &Model<S, N>) -> bool {
        self.masters.iter().map(|m| &**m).chain([self.slave]).any(|side| model.patches[side.patch].changing.is_some())
    }

    /// Rows at the points at time `t`.
    ///
    /// # Errors
    /// [`ContactError`] of Nitsche's method.
    pub fn contact(
        &self,
        model: &Model<S, N>,
        method: &Nitsche,
        gap: &Data,
        reach: Option<f64>,
        t: f64,
    ) -> Result<Contact<S, N>, ContactError> {
        let fluxes = self.fluxes(model, t);
        let slave = Side { trace: &self.slave.trace, field: model.patches[self.slave.patch].field, flux: Some(&*fluxes.slave) };
        let gap = |x: &Vector<N>, g: f64| gap.value(&Point::new(x.as_slice()).at_time(t).with_gap(g));
        match self.against {
            Against::Side(master, segments) => {
                let opponent = Opponent::Master(Side { trace: &master.trace, field: master.field, flux: Some(&fluxes.master) });
                Contact::nitsche(method, slave, opponent, segments, &gap, model.unknowns)
            }
            Against::Rigid(obstacle, segments) => {
                let target = obstacle.target(t, None);
                Contact::nitsche(method, slave, Opponent::Rigid(&*target, reach), segments, &gap, model.unknowns)
            }
        }
    }
}

impl<const S: usize, const N: usize> ContactPart<S, N> {
    /// The slave side and what it faces.
    pub(super) fn point_sides(&self) -> PointSides<'_, S, N> {
        PointSides { slave: &self.slave, against: &self.against, masters: &self.masters }
    }

    /// The fluxes of the bodies at time `t`.
    pub(super) fn fluxes(&self, model: &Model<S, N>, t: f64) -> ContactFluxes<S, N> {
        self.point_sides().fluxes(model, t)
    }
}

impl<const S: usize, const N: usize> ContactModel<S, N> {
    /// lambda and gap of Nitsche's method at the points of `segments` that face something, and their numbers there; none of other
    /// methods, and where the method has no value.
    pub(super) fn at_points(
        &self,
        model: &Model<S, N>,
        part: &ContactPart<S, N>,
        fluxes: &ContactFluxes<S, N>,
        segments: &Segments<S>,
        u: &[f64],
        t: f64,
    ) -> Option<(Vec<usize>, PointValues)> {
        let Formulation::Nitsche(method) = &self.formulation else { return None };
        let slave = Side { trace: &part.slave.trace, field: model.patches[part.slave.patch].field, flux: Some(&*fluxes.slave) };
        let gap = |x: &Vector<N>, g: f64| self.gap.value(&Point::new(x.as_slice()).at_time(t).with_gap(g));
        match &part.against {
            Against::Side(master, _) => {
                let opponent = Opponent::Master(Side { trace: &master.trace, field: master.field, flux: Some(&fluxes.master) });
                point_values(method, slave, opponent, segments, &gap, u).ok()
            }
            Against::Rigid(obstacle, _) => {
                let target = obstacle.target(t, None);
                point_values(method, slave, Opponent::Rigid(&*target, self.reach), segments, &gap, u).ok()
            }
        }
    }
}
