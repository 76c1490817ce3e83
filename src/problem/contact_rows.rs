//! Rows, offsets and weights of contacts at a time and at a place of their obstacles, as their method makes them.

use super::contact_fluxes::SideFluxes;
use super::last_time::LastTime;
use super::model::{BodySide, ContactModel, ContactPart, Model, Opposing};
use super::rigid_bodies::unit;
use crate::basis::Basis;
use crate::contact::{Cone, ContactAt, ContactError, ContactRows, Opponent, PointValues, RowsAt, Translation, points_at_rims};
use crate::coupling::{Segments, Side};
use crate::linalg::Vector;
use std::sync::Arc;

/// A slave side of a contact, what it faces, and its multiplier.
#[derive(Clone, Copy, Debug)]
pub(super) struct ContactSides<'a, const S: usize, const N: usize> {
    /// The slave side.
    pub slave: &'a BodySide<S, N>,
    /// The opponent.
    pub against: &'a Opposing<S, N>,
    /// Master sides, joined into one in `against`.
    pub masters: &'a [Arc<BodySide<S, N>>],
    /// The multiplier space, if the method needs one.
    pub multiplier: Option<&'a dyn Basis<S>>,
    /// Cone of admissible multipliers.
    pub cone: Cone,
    /// The master's own points, for mixed integration.
    pub second: Option<&'a Segments<S>>,
    /// Largest gap or overlap at rest that is closed \[length\].
    pub closes: f64,
    /// Fluxes of the bodies, if the method needs them.
    pub fluxes: &'a LastTime<SideFluxes<S, N>>,
}

impl<const S: usize, const N: usize> ContactPart<S, N> {
    /// The slave side and what it faces.
    pub(super) fn sides(&self) -> ContactSides<'_, S, N> {
        ContactSides {
            slave: &self.slave,
            against: &self.against,
            masters: &self.masters,
            multiplier: self.multiplier.as_deref(),
            cone: self.cone,
            second: self.second.as_ref(),
            closes: self.closes,
            fluxes: &self.fluxes,
        }
    }
}

impl<const S: usize, const N: usize> ContactModel<S, N> {
    /// Asks the method about sides at time `t`, on `segments` or on those of the sides, where `place` has the obstacle.
    fn seen<R>(
        &self,
        model: &Model<S, N>,
        sides: &ContactSides<'_, S, N>,
        fluxes: Option<&SideFluxes<S, N>>,
        segments: Option<&Segments<S>>,
        (t, place): (f64, Option<&[f64]>),
        ask: impl FnOnce(&ContactAt<'_, S, N>) -> R,
    ) -> R {
        let flux = fluxes.map(SideFluxes::slave);
        let slave = Side { trace: &sides.slave.trace, field: model.patches[sides.slave.patch].field, flux };
        let gap = |x: &Vector<N>, g: f64| self.wanted(x, t, g, sides.closes);
        let at = |opponent, own, translations| ContactAt {
            second: sides.second,
            cone: sides.cone,
            translations,
            ..ContactAt::new(slave, opponent, segments.unwrap_or(own), sides.multiplier, &gap, model.unknowns)
        };
        match sides.against {
            Opposing::Side(master, own) => {
                let master = Side { trace: &master.trace, field: master.field, flux: fluxes.and_then(SideFluxes::master) };
                ask(&at(Opponent::Master(master), own, &[]))
            }
            Opposing::Rigid(obstacle, own, rules) => {
                let target = obstacle.target(t, place);
                // rows of functions have points of any number, those of points the same ones at all times
                let cut = (segments.is_none() && sides.multiplier.is_some() && (obstacle.changes || place.is_some()))
                    .then(|| model.revolved(points_at_rims(&sides.slave.trace, std::slice::from_ref(&target), rules), sides.slave));
                let own = cut.as_ref().unwrap_or(own);
                let stands = |unknown: usize| place.and_then(|u| u.get(unknown)).copied().unwrap_or(0.0);
                let pressed = obstacle.pressed.iter();
                let pressed = pressed.map(|p| Translation { direction: unit(p.component), unknown: p.unknown, at: stands(p.unknown) });
                ask(&at(Opponent::Rigid(&*target, self.reach), own, &pressed.collect::<Vec<_>>()))
            }
        }
    }

    /// Rows of sides at time `t`, where `place` has the obstacle.
    ///
    /// # Errors
    /// [`ContactError`] of the method.
    pub(super) fn rows(
        &self,
        model: &Model<S, N>,
        sides: &ContactSides<'_, S, N>,
        t: f64,
        place: Option<&[f64]>,
    ) -> Result<ContactRows<S, N>, ContactError> {
        let fluxes = self.method.needs().fluxes.then(|| sides.fluxes(model, t));
        let rows = self.seen(model, sides, fluxes.as_deref(), None, (t, place), |at| self.method.rows(at))?;
        rows.sound(sides.multiplier.map(Basis::num_functions), model.unknowns).map(|()| rows)
    }

    /// Rows, offsets and weights of a part at time `t`, obstacles that forces press at rest.
    ///
    /// # Errors
    /// [`ContactError`] where the gap has no value.
    pub fn at(&self, model: &Model<S, N>, part: &ContactPart<S, N>, t: f64) -> Result<ContactRows<S, N>, ContactError> {
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
    ) -> Result<ContactRows<S, N>, ContactError> {
        let place = unknowns.filter(|_| self.is_pressed());
        if !part.changes && place.is_none() { Ok(part.first.clone()) } else { self.rows(model, &part.sides(), t, place) }
    }

    /// lambda and gap at the points of `segments` that face something; `None` of methods with multipliers, and where the method has no
    /// value; NaN everywhere where its lists do not fit together.
    pub(super) fn values(
        &self,
        model: &Model<S, N>,
        part: &ContactPart<S, N>,
        fluxes: Option<&SideFluxes<S, N>>,
        segments: &Segments<S>,
        (u, t): (&[f64], f64),
    ) -> Option<PointValues> {
        let values = self.seen(model, &part.sides(), fluxes, Some(segments), (t, None), |at| self.method.values(at, u))?.ok()?;
        let points = segments.ds.len();
        let none = || vec![f64::NAN; points];
        Some(match values.sound(points) {
            Ok(()) => values,
            Err(_) => PointValues { point: (0..points).collect(), lambda: none(), gap: none() },
        })
    }

    /// Whether a force presses its obstacle.
    pub fn is_pressed(&self) -> bool {
        self.obstacle.as_ref().is_some_and(|o| !o.pressed.is_empty())
    }

    /// Whether bodies sink into each other by the compliance of rows of multiplier functions, which no iteration takes back: a penalty.
    pub(super) fn is_soft(&self) -> bool {
        self.parts.iter().filter(|part| part.first.at == RowsAt::Functions).any(|part| {
            let begun = self.method.begin(&part.first, &|_| 1.0);
            begun.iteration.is_none() && begun.compliance.iter().any(|c| *c > 0.0)
        })
    }
}
