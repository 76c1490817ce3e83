//! Rows, offsets and weights of contacts at a time and at a place of their obstacles.

use super::data::{Data, Point};
use super::model::{Against, ContactModel, ContactPart, Formulation, Model, SideModel};
use super::rigid_bodies::unit;
use crate::basis::Basis;
use crate::contact::{self, Contact, ContactError, Opponent};
use crate::coupling::{Segments, Side};
use crate::linalg::Vector;

/// Rows of a slave side against what it faces, at time `t` and where `place` has the obstacle.
///
/// # Errors
/// [`ContactError`] if the gap has no value, or the cone does not exist on these multipliers.
pub fn rows<const S: usize, const N: usize>(
    model: &Model<S, N>,
    slave: &SideModel<S, N>,
    against: &Against<S, N>,
    (psi, cone, second): (&dyn Basis<S>, contact::Cone, Option<&Segments<S>>),
    gap: &Data,
    reach: Option<f64>,
    t: f64,
    place: Option<&[f64]>,
) -> Result<Contact<S, N>, ContactError> {
    let side = Side { trace: &slave.trace, field: model.patches[slave.patch].field, flux: None };
    let gap = |x: &Vector<N>, g: f64| gap.value(&Point::new(x.as_slice()).at_time(t).with_gap(g));
    let built = match against {
        Against::Side(master, segments) => {
            let master = Side { trace: &master.trace, field: master.field, flux: None };
            let built = Contact::new(side, Opponent::Master(master), psi, segments.clone(), &gap, model.unknowns)?;
            match second {
                Some(second) => built.with_master_sums(side, master, psi, second, model.unknowns)?,
                None => built,
            }
        }
        Against::Rigid(obstacle, segments) => {
            let target = obstacle.target(t, place);
            let mut built = Contact::new(side, Opponent::Rigid(&*target, reach), psi, segments.clone(), &gap, model.unknowns)?;
            for p in &obstacle.pressed {
                let at = place.and_then(|u| u.get(p.unknown)).copied().unwrap_or(0.0);
                built.let_obstacle_move(psi, &unit(p.component), p.unknown, at);
            }
            built
        }
    };
    built.with_cone(cone, psi)
}

impl<const S: usize, const N: usize> ContactModel<S, N> {
    /// Rows, offsets and weights of a part at time `t`, obstacles that forces press at rest.
    ///
    /// # Errors
    /// [`ContactError`] where the gap has no value.
    pub fn at(&self, model: &Model<S, N>, part: &ContactPart<S, N>, t: f64) -> Result<Contact<S, N>, ContactError> {
        self.at_place(model, part, t, None)
    }

    /// Rows, offsets and weights of a part at time `t`, obstacles that forces press at the place given by `unknowns` of the model.
    ///
    /// # Errors
    /// [`ContactError`] where the gap has no value.
    pub(super) fn at_place(
        &self,
        model: &Model<S, N>,
        part: &ContactPart<S, N>,
        t: f64,
        unknowns: Option<&[f64]>,
    ) -> Result<Contact<S, N>, ContactError> {
        let place = unknowns.filter(|_| self.is_pressed());
        if !part.changes && place.is_none() {
            return Ok(part.first.clone());
        }
        match (&self.formulation, &part.multiplier) {
            (_, Some(psi)) => {
                let chosen = (&**psi, part.cone, part.second.as_ref());
                rows(model, &part.slave, &part.against, chosen, &self.gap, self.reach, t, place)
            }
            (Formulation::Nitsche(method), None) => part.point_sides().contact(model, method, &self.gap, self.reach, t),
            _ => Ok(part.first.clone()),
        }
    }

    /// Whether a force presses its obstacle.
    pub fn is_pressed(&self) -> bool {
        self.obstacle.as_ref().is_some_and(|o| !o.pressed.is_empty())
    }
}
