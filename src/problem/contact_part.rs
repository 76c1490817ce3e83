//! Construction of a slave side of a contact: multiplier, opponent and rows.

use super::contact_rows::ContactSides;
use super::coupled::{Contact, StatedOpponent};
use super::data::Point;
use super::facing_obstacle::is_turned_round;
use super::held_part::HeldPart;
use super::interface_error::InterfaceError;
use super::interface_side::InterfaceSide;
use super::last_time::LastTime;
use super::model::{BodySide, ContactModel, ContactPart, Model, Opposing};
use super::multipliers::{unstable_pairing, wrapped, wrapped_in_order};
use super::tie_part::{finer_segments, points_of};
use super::touching::explained;
use crate::assembly::gauss_rules;
use crate::basis::{Basis, Elements};
use crate::contact::{Cone, ContactError, ContactKinematics, ContactRows, points_at_rims};
use crate::coupling::consistency::ConsistencyEstimate;
use crate::coupling::interface::{InterfaceQuadrature, Partners};
use crate::coupling::multiplier::{MultiplierError, PiecewiseConstant};
use crate::coupling::{Coupling, Interface, Mortar, Rows, Segments, Side};
use crate::linalg::Vector;
use crate::space::Trace;
use std::collections::HashSet;
use std::sync::Arc;

/// Most places of a moving obstacle, but for the last one, at whose rims elements are divided.
const MOST_PLACES: usize = 4;

/// A slave side of a contact to be built.
pub(super) struct SlaveOf<'a, const S: usize, const N: usize> {
    /// The contact as it was stated.
    pub contact: &'a Contact<S, N>,
    /// The side that carries the multiplier.
    pub slave: &'a Arc<BodySide<S, N>>,
    /// The sides it faces; none against an obstacle.
    pub masters: &'a [Arc<BodySide<S, N>>],
    /// All times, in order; at least one.
    pub times: &'a [f64],
    /// Whether an unknown (function of the body, component) is prescribed, or its function tied.
    pub taken: &'a dyn Fn(usize, usize) -> bool,
    /// Whether an unknown of the model is prescribed.
    pub fixed: &'a dyn Fn(usize) -> bool,
    /// Whether other slave sides press a function of the body along all of its free directions.
    pub on_seam: &'a dyn Fn(usize) -> bool,
}

/// A multiplier and what is known of it: fields of [`ContactPart`].
#[derive(Default)]
struct Chosen<const S: usize> {
    multiplier: Option<Box<dyn Basis<S>>>,
    reading: Option<Box<dyn Basis<S>>>,
    unstable: Option<(usize, usize)>,
}

/// The opponent, its second segments, and finer ones.
type Opposed<const S: usize, const N: usize> = (Opposing<S, N>, Option<Segments<S>>, Option<Segments<S>>);

impl<const S: usize, const N: usize> Model<S, N>
where
    Trace<S, N>: InterfaceSide<S, N>,
{
    /// Builds a slave side of `contact`; its rows are not counted among those of the model yet.
    ///
    /// # Errors
    /// [`InterfaceError`] for sides that do not face each other, and for multipliers that do not exist or are too many.
    pub(super) fn contact_part(
        &self,
        contact: &ContactModel<S, N>,
        setup: &SlaveOf<'_, S, N>,
    ) -> Result<ContactPart<S, N>, InterfaceError> {
        let (slave, needs) = (setup.slave, contact.method.needs());
        contact.method.check().map_err(InterfaceError::Method)?;
        let refused = (contact.is_pressed() && !needs.pressed, setup.contact.rule.is_mixed() && !needs.mixed);
        if refused != (false, false) {
            return Err(InterfaceError::Refused { pressed: refused.0, mixed: refused.1 });
        }
        let (against, second, finer) = self.opponent(contact, setup)?;
        let Chosen { multiplier, reading, unstable } = match needs.multiplier {
            true => self.contact_multiplier(contact, setup, &against)?,
            false => Chosen::default(),
        };
        let cone = if needs.multiplier { setup.contact.own.cone } else { Cone::default() };
        let (psi, masters) = (multiplier.as_deref(), setup.masters);
        let closes = if setup.contact.own.adjust { explained(&self.patches, slave, masters) } else { 0.0 };
        let fluxes = LastTime::default();
        let sides =
            ContactSides { slave, against: &against, masters, multiplier: psi, cone, second: second.as_ref(), closes, fluxes: &fluxes };
        let moves = contact.obstacle.as_ref().is_some_and(|o| o.changes);
        let changes = moves || contact.gap.depends_on_time() || (needs.fluxes && sides.change(self));
        // an obstacle may come within reach later
        for &t in setup.times_of(moves) {
            let first = contact.rows(self, &sides, t, None).map_err(|error| at_time(error, t))?;
            if first.facing.contains(&true) {
                self.sound_later(contact, setup, &sides, &first)?;
                let finer = finer.and_then(|segments| self.finer_contact(slave, &against, psi, &segments));
                let by_elements = if psi.is_none() { self.rows_of_elements(slave, &against) } else { None };
                return Ok(ContactPart {
                    number: 0,
                    slave: slave.clone(),
                    num_rows: first.offset.len(),
                    multiplier,
                    reading,
                    unstable,
                    held: self.held_functions(setup, &against, t),
                    is_dual: needs.multiplier && setup.contact.multiplier.is_dual(),
                    cone,
                    against,
                    second,
                    finer,
                    by_elements,
                    masters: masters.to_vec(),
                    first,
                    closes,
                    fluxes,
                    changes,
                    first_row: self.rows,
                });
            }
        }
        Err(InterfaceError::NothingFaces)
    }

    /// Checks that the gap has a value at all times: its formula at the points that are faced `first`, an obstacle whose shape changes by its
    /// rows. Such an obstacle must not be turned round, either.
    fn sound_later(
        &self,
        contact: &ContactModel<S, N>,
        setup: &SlaveOf<'_, S, N>,
        sides: &ContactSides<'_, S, N>,
        first: &ContactRows<S, N>,
    ) -> Result<(), InterfaceError> {
        if let (StatedOpponent::Obstacle { changes: true, .. }, Opposing::Rigid(obstacle, ..)) = (&setup.contact.own.faced, sides.against) {
            return setup.times.iter().try_for_each(|&t| {
                let rows = contact.rows(self, sides, t, None).map_err(|error| at_time(error, t))?;
                let turned = !rows.facing.contains(&true) && is_turned_round(&setup.slave.trace, &*obstacle.target(t, None));
                if turned { Err(InterfaceError::TurnedRound { t }) } else { Ok(()) }
            });
        }
        for &t in setup.times_of(contact.gap.depends_on_time()) {
            let value = |(x, g): &(&Vector<N>, &f64)| contact.wanted(x, t, **g, sides.closes);
            if let Some((x, g)) = first.frames.x.iter().zip(&first.frames.gap).find(|at| !value(at).is_finite()) {
                return Err(InterfaceError::Gap { at: Point::new(x.as_slice()).x, geometric: *g, t });
            }
        }
        Ok(())
    }

    /// The opponent with its segments.
    fn opponent(&self, contact: &ContactModel<S, N>, setup: &SlaveOf<'_, S, N>) -> Result<Opposed<S, N>, InterfaceError> {
        let (slave, rule, extra_points) = (setup.slave, &setup.contact.rule, setup.contact.extra_points);
        // an obstacle has no quadrature points of its own: mixed integration uses those of the slave
        if let Some(obstacle) = &contact.obstacle {
            let points = gauss_rules(&*slave.trace.space, extra_points);
            let times = setup.times_of(obstacle.changes);
            let places: Vec<_> =
                times.iter().step_by(times.len().div_ceil(MOST_PLACES)).chain(times.last()).map(|&t| obstacle.target(t, None)).collect();
            let segments = self.revolved(points_at_rims(&slave.trace, &places, &points), slave);
            return Ok((Opposing::Rigid(Arc::clone(obstacle), segments, points), None, None));
        }
        let master = BodySide::joined(self, setup.masters).ok_or(InterfaceError::NoMaster)?;
        let partners = Partners::Facing { reach: contact.reach };
        let points = points_of(slave, &master, extra_points);
        let make = |rule: Box<dyn InterfaceQuadrature<S, N>>| {
            let (own, other) = (slave.trace.oriented(), master.trace.oriented());
            let segments = rule.segments(&own, &other)?;
            segments.well_formed(own.num_elements(), other.num_elements()).map(|()| segments)
        };
        let verified = |segments: Segments<S>| {
            let (own, other) = (&*slave.trace.space, &*master.trace.space);
            segments.opposite(own, other)?;
            segments.verified(own, other)
        };
        let segments = make(rule.first(points, partners)).and_then(verified).map_err(InterfaceError::Segments)?;
        let segments = self.revolved(segments, slave);
        let sums = rule.is_mixed().then(|| Trace::<S, N>::master_sums(points, partners));
        let second = sums.map(make).transpose().map_err(InterfaceError::Segments)?.map(|s| self.revolved(s, slave));
        let finer = finer_segments(slave, &master, points, partners).map(|s| self.revolved(s, slave));
        Ok((Opposing::Side(master, segments), second, finer))
    }

    /// The multiplier of a slave side, lowered where it cannot move along the normals of its opponent.
    fn contact_multiplier(
        &self,
        contact: &ContactModel<S, N>,
        setup: &SlaveOf<'_, S, N>,
        against: &Opposing<S, N>,
    ) -> Result<Chosen<S>, InterfaceError> {
        let slave = setup.slave;
        let times = setup.times_of(contact.obstacle.as_ref().is_some_and(|o| o.changes));
        let immobile = self.immobile(setup, against, times);
        // a function shared by slave sides would get more multipliers than it has free directions: it counts as constrained
        let stuck = |function: usize| (setup.on_seam)(function) || immobile.is(function);
        let held = |f: usize| stuck(f) || immobile.inside(f) || (0..N).all(|c| (setup.taken)(f, c));
        let free = slave.trace.dofs.iter().filter(|&&f| !held(f)).map(|&f| self.function(slave.patch, f)).collect::<HashSet<_>>().len();
        let (components, by_equations) = (immobile.components(), immobile.by_equations());
        if free == 0 {
            let is_shared = slave.trace.dofs.iter().all(|&f| (setup.on_seam)(f));
            return Err(if is_shared { InterfaceError::Shared } else { InterfaceError::Held { components, by_equations } });
        }
        let refused = |error| InterfaceError::Multiplier { component: None, error };
        let mut psi = wrapped(self, slave, &stuck, setup.contact.multiplier.make(&slave.trace, &stuck).map_err(refused)?);
        let mut reading = None;
        let nameless = setup.contact.multiplier.is_nameless();
        let unstable = if nameless { unstable_pairing(&*slave.trace.space, &*psi) } else { None };
        let is_dual = setup.contact.multiplier.is_dual();
        if is_dual && self.is_revolved() {
            return Err(refused(MultiplierError::Revolution));
        }
        // what faces something at the first time at which anything does
        let faced = match against {
            Opposing::Side(_, segments) if !is_dual => Some(segments.clone()).filter(|s| !s.ds.is_empty()),
            _ => times.iter().map(|&t| faced(slave, against, contact.reach, t)).find(|s| !s.ds.is_empty()),
        };
        match &faced {
            Some(segments) if is_dual => {
                let (functions, read) = slave.trace.covered_dual(&stuck, segments).map_err(refused)?;
                psi = wrapped_in_order(self, slave, &stuck, functions);
                reading = Some(wrapped_in_order(self, slave, &stuck, read)).filter(|read| read.num_functions() == psi.num_functions());
            }
            Some(segments) => psi = slave.trace.without_slivers(psi, &self.along_curve(segments, slave)),
            None => {}
        }
        if psi.num_functions() > free {
            // the pressure of dual multipliers is read through other functions, which say nothing of who has whose
            let part = Some(HeldPart::of(slave, &*psi, &held)).filter(|part| reading.is_none() && part.free() <= free);
            let Some(part) = part else {
                return Err(InterfaceError::TooMany { multipliers: psi.num_functions(), free, components, by_equations });
            };
            psi = part.given(psi);
        }
        Ok(Chosen { multiplier: Some(psi), reading, unstable })
    }

    /// Rows on finer segments, against which the consistency error is estimated: those of the multiplier, without one of a constant per
    /// element.
    fn finer_contact(
        &self,
        slave: &BodySide<S, N>,
        against: &Opposing<S, N>,
        psi: Option<&dyn Basis<S>>,
        segments: &Segments<S>,
    ) -> Option<ConsistencyEstimate> {
        let constants = PiecewiseConstant::of(&*slave.trace.space);
        self.on_segments(slave, against, (psi.unwrap_or(&constants), segments), &|interface| {
            ConsistencyEstimate::try_new(&[*interface], self.unknowns).ok()
        })
    }

    /// Rows of a constant per element of the slave, on the segments of the contact.
    fn rows_of_elements(&self, slave: &BodySide<S, N>, against: &Opposing<S, N>) -> Option<Rows> {
        let Opposing::Side(_, segments) = against else { return None };
        let constants = PiecewiseConstant::of(&*slave.trace.space);
        self.on_segments(slave, against, (&constants, segments), &|interface| {
            Some(Mortar.assemble(interface, self.unknowns).ok()?.constraint)
        })
    }

    /// Calls `with` for the pair of a slave and its master, on segments other than those of the contact.
    fn on_segments<R>(
        &self,
        slave: &BodySide<S, N>,
        against: &Opposing<S, N>,
        (psi, segments): (&dyn Basis<S>, &Segments<S>),
        with: &dyn Fn(&Interface<'_, S, N>) -> Option<R>,
    ) -> Option<R> {
        let Opposing::Side(master, _) = against else { return None };
        let (segments, frames) = ContactKinematics::against_master(&slave.trace, &master.trace, segments).ok()?;
        with(&Interface {
            slave: Side { trace: &slave.trace, field: self.patches[slave.patch].field, flux: None },
            master: Some(Side { trace: &master.trace, field: master.field, flux: None }),
            multiplier: &[psi],
            segments: &segments,
            master_segments: None,
            direction: Some(&frames.normal),
        })
    }
}

impl<const S: usize, const N: usize> SlaveOf<'_, S, N> {
    /// All times if something changes with them, else the first.
    fn times_of(&self, changes: bool) -> &[f64] {
        if changes { self.times } else { &self.times[..self.times.len().min(1)] }
    }
}

/// The error of rows at time `t`.
fn at_time(error: ContactError, t: f64) -> InterfaceError {
    match error {
        ContactError::Gap { at, geometric } => InterfaceError::Gap { at, geometric, t },
        other => InterfaceError::Contact(other),
    }
}

/// Returns the points of a slave side that face its opponent at time `t`.
pub(super) fn faced<const S: usize, const N: usize>(
    slave: &BodySide<S, N>,
    against: &Opposing<S, N>,
    reach: Option<f64>,
    t: f64,
) -> Segments<S> {
    match against {
        // a master without tangent, or a normal that is none, is reported when the rows are built
        Opposing::Side(master, segments) => ContactKinematics::against_master(&slave.trace, &master.trace, segments)
            .map_or_else(|_| segments.clone(), |(segments, _)| segments),
        Opposing::Rigid(obstacle, segments, _) => {
            ContactKinematics::against_obstacle(&slave.trace, &*obstacle.target(t, None), segments, reach)
                .map_or_else(|_| segments.clone(), |(segments, _)| segments)
        }
    }
}
