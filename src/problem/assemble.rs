//! Assembly of a problem: ties and contacts of its model, and the checks of the whole.

use super::assembled::System;
use super::body_locators::BodyLocators;
use super::builder::Problem;
use super::contact_part::SlaveOf;
use super::coupled::{Contact, StatedOpponent, Tie};
use super::curved_slides::SampledSlide;
use super::data::Data;
use super::error::{ErrorKind, ProblemError, ProblemErrors};
use super::facet_owners::FacetOwners;
use super::facets_apart::FacetsApart;
use super::fixed::Eliminated;
use super::handles::{InterfaceId, Statement};
use super::interface_error::InterfaceError;
use super::interface_side::InterfaceSide;
use super::model::{BodySide, ContactModel, Model, TieModel};
use super::obstacle::{ForceDriven, MovingObstacle};
use super::smooth_pieces::places_of;
use super::solved::Common;
use super::tie_part::TieCounts;
use super::touching::Search;
use super::touching_bodies;
use crate::space::{SideError, Trace};
use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::sync::Arc;

impl<const S: usize, const N: usize> Problem<S, N>
where
    Trace<S, N>: InterfaceSide<S, N>,
{
    /// Builds ties and contacts and checks the whole problem: prescribed values, sides that meet, multipliers, rigid motions.
    ///
    /// # Errors
    /// All that is wrong; of supports, ties, contacts and rigid motions those that come first hide what follows.
    pub fn assemble(&self) -> Result<System<S, N>, ProblemErrors> {
        let system = self.assemble_movable()?;
        system.held()?;
        Ok(system)
    }

    /// The system of the problem, as [`assemble`](Self::assemble) makes it, whatever may still move as a rigid body:
    /// [`System::rigid_motions`] lists it.
    ///
    /// # Errors
    /// Those of [`assemble`](Self::assemble), but for rigid motions.
    pub fn assemble_movable(&self) -> Result<System<S, N>, ProblemErrors> {
        Trace::<S, N>::system_of(self)
    }

    /// The work of [`assemble_movable`](Self::assemble_movable).
    pub(super) fn system(&self) -> Result<System<S, N>, ProblemErrors> {
        some(self.check_interfaces())?;
        let model = Arc::new(self.between_kinks(Self::built)?);
        let (identity, regions, places) = (self.identity.clone(), self.regions.clone(), BodyLocators::new(model.patches.len()));
        Ok(System::new(Common { identity, regions, places, model, half_width: Trace::<S, N>::half_width }, self.times.clone()))
    }

    fn built(&self) -> Result<Model<S, N>, ProblemErrors> {
        let pressed = self.contacts.iter().map(|c| c.own.forces.len()).sum();
        let mut model = self.model(pressed)?;
        let fixed = self.fixed(&model)?;
        let members = self.memberships(&model);
        some(self.build_slides(&mut model, &fixed))?;
        let (ties, found) = self.explained_ties();
        model.findings.extend(found);
        some(self.build_ties(&ties, &mut model, &fixed, &members))?;
        some(self.build_contacts(&mut model, pressed, &fixed, &members))?;
        some(model.carried(&self.times))?;
        Ok(model)
    }

    /// Builds the rows of all curved sides that slide; returns what is wrong.
    fn build_slides(&self, model: &mut Model<S, N>, fixed: &Eliminated) -> Vec<ProblemError> {
        let slides: Vec<_> = self.said.slides.iter().map(|slide| SampledSlide::new(model, slide)).collect();
        let mut errors = model.contradicted_slides(&slides, &self.times);
        if !errors.is_empty() {
            return errors;
        }
        let tied = self.tied(model, &|_| false);
        for (k, slide) in self.said.slides.iter().enumerate() {
            match model.slide_part(&slides[k], &slides[..k], fixed, &tied) {
                Ok(part) => {
                    model.rows += part.num_rows();
                    model.slides.push(part);
                }
                Err(error) => {
                    errors.push(ProblemError::new(ErrorKind::Slide(error), vec![slide.of], vec![slide.side.label.clone()]));
                }
            }
        }
        errors
    }

    /// Builds all ties; returns what is wrong.
    fn build_ties(&self, ties: &[Tie<S, N>], model: &mut Model<S, N>, fixed: &Eliminated, members: &TieCounts) -> Vec<ProblemError> {
        let mut errors = Vec::new();
        for tie in ties {
            let mut parts = Vec::new();
            for (k, pair) in places_of(tie.own.pairs.iter().map(|p| &p.slave)).into_iter().zip(&tie.own.pairs) {
                match model.tie_part(tie, pair, self.times[0], fixed, members) {
                    Ok(mut part) => {
                        part.number = k;
                        model.rows += part.num_rows;
                        parts.push(part);
                    }
                    Err(error) => errors.push(of_slave(tie.id(), k, &tie.name, &pair.slave, error)),
                }
            }
            let exact = (!tie.exact.is_empty()).then(|| tie.exact.clone());
            model.ties.push(TieModel { id: tie.id(), name: tie.name.clone(), parts, exact });
        }
        errors
    }

    /// Builds all contacts; returns what is wrong.
    fn build_contacts(&self, model: &mut Model<S, N>, pressed: usize, fixed: &Eliminated, tied: &TieCounts) -> Vec<ProblemError> {
        let (mut errors, seams) = (Vec::new(), self.seams(model, fixed));
        let mut next = model.unknowns - pressed;
        for contact in &self.contacts {
            let (obstacle, masters) = match &contact.own.faced {
                StatedOpponent::Sides(masters) => (None, masters.as_slice()),
                StatedOpponent::Obstacle { .. } => (Some(Arc::new(obstacle(contact, next))), &[][..]),
            };
            next += contact.own.forces.len();
            let mut built = ContactModel {
                id: contact.id(),
                idle: Vec::new(),
                name: contact.name.clone(),
                parts: Vec::new(),
                obstacle,
                gap: contact.own.gap.clone(),
                reach: contact.own.reach,
                exact: contact.exact.first().cloned(),
                symmetry: contact.own.symmetry,
                start: contact.own.start,
                method: Arc::clone(&contact.own.method),
            };
            let mut behind = Vec::new();
            for (k, slave) in places_of(contact.own.slaves.iter()).into_iter().zip(&contact.own.slaves) {
                let field = model.patches[slave.patch].field;
                let beside = self.memberships_beside(model, slave);
                let tied = beside.as_ref().unwrap_or(tied);
                let taken =
                    |function: usize, c: usize| fixed.is(field.unknown(function, c)) || tied.count(model, slave.patch, function) > 0;
                let fixed = |unknown: usize| fixed.is(unknown);
                let on_seam = |function: usize| seams.hold(slave, model.function(slave.patch, function));
                let setup = SlaveOf { contact, slave, masters, times: &self.times, taken: &taken, fixed: &fixed, on_seam: &on_seam };
                match model.contact_part(&built, &setup) {
                    Ok(mut part) => {
                        part.number = k;
                        model.rows += part.num_rows;
                        built.parts.push(part);
                    }
                    Err(InterfaceError::NothingFaces) => {
                        built.idle.push(k);
                        behind.push(of_slave(contact.id(), k, &contact.name, slave, InterfaceError::NothingFaces));
                    }
                    Err(error) => errors.push(of_slave(contact.id(), k, &contact.name, slave, error)),
                }
            }
            // a side of which a piece faces something is not idle
            built.idle.dedup();
            built.idle.retain(|k| built.parts.iter().all(|part| part.number != *k));
            // a side that faces nothing is none of the contact where others face something
            if built.parts.is_empty() {
                errors.extend(behind);
            }
            model.contacts.push(built);
        }
        errors
    }
}

impl<const S: usize, const N: usize> Problem<S, N> {
    /// Names that are taken, slave sides that are so twice, and motions and forces of contacts.
    fn check_interfaces(&self) -> Vec<ProblemError> {
        let mut errors = Vec::new();
        let (ties, contacts) = (&self.ties, &self.contacts);
        let mut names: HashMap<&str, Statement> = HashMap::new();
        let all = ties.iter().map(|t| (&t.name, t.id().into())).chain(contacts.iter().map(|c| (&c.name, c.id().into())));
        for (name, id) in all {
            if let Some(&first) = names.get(name.as_str()) {
                errors.push(ProblemError::new(ErrorKind::NameTaken, vec![first, id], vec![name.clone()]));
            }
            names.insert(name, id);
        }
        self.check_slaves(&mut errors);
        let mut pairs: BTreeMap<[*const BodySide<S, N>; 2], Statement> = BTreeMap::new();
        let of_ties =
            ties.iter().flat_map(|t| t.own.pairs.iter().flat_map(move |p| p.masters.iter().map(move |m| (&p.slave, m, t.id().into()))));
        let of_contacts = contacts.iter().flat_map(|c| {
            let masters = if let StatedOpponent::Sides(masters) = &c.own.faced { masters.as_slice() } else { &[] };
            c.own.slaves.iter().flat_map(move |s| masters.iter().map(move |m| (s, m, Statement::from(c.id()))))
        });
        for (slave, master, id) in of_ties.chain(of_contacts) {
            pairs.insert([Arc::as_ptr(slave), Arc::as_ptr(master)], id);
            if let Some(&first) = pairs.get(&[Arc::as_ptr(master), Arc::as_ptr(slave)]) {
                errors.push(ProblemError::new(ErrorKind::BothWays, vec![first, id], vec![slave.label.clone(), master.label.clone()]));
            }
        }
        for contact in contacts {
            let driven = || contact.own.motion.iter().chain(&contact.own.forces).map(|(component, _)| *component);
            let mut refuse = |kind| errors.push(ProblemError::new(kind, vec![contact.id().into()], vec![contact.name.clone()]));
            let changes = matches!(contact.own.faced, StatedOpponent::Obstacle { changes: true, .. });
            if contact.own.adjust && (changes || driven().next().is_some()) {
                refuse(ErrorKind::AdjustsMoving);
            } else if matches!(contact.own.faced, StatedOpponent::Sides(_)) && driven().next().is_some() {
                refuse(ErrorKind::NoObstacle);
            } else if let Some(component) = driven().find(|c| *c >= N || driven().filter(|other| other == c).count() > 1) {
                refuse(ErrorKind::Driven { component });
            }
        }
        errors
    }

    /// Slave sides, or parts of them, with facets of another one. A side may face several obstacles.
    fn check_slaves(&self, errors: &mut Vec<ProblemError>) {
        let of_ties = self.ties.iter().flat_map(|t| t.own.pairs.iter().map(|p| (&p.slave, t.id().into(), true)));
        let of_contacts = self.contacts.iter().flat_map(|c| c.own.slaves.iter().map(|s| (s, Statement::from(c.id()), false)));
        let all: Vec<(&Arc<BodySide<S, N>>, Statement, bool)> = of_ties.chain(of_contacts).collect();
        let mut before = FacetOwners::default();
        for (number, &(slave, id, is_tied)) in all.iter().enumerate() {
            let meets = |&other: &usize| !Arc::ptr_eq(all[other].0, slave) || is_tied && all[other].2;
            if let Some(first) = before.of(slave).find(meets) {
                errors.push(ProblemError::new(
                    ErrorKind::SlaveTwice,
                    vec![all[first].1, id],
                    vec![slave.label.clone(), all[first].0.label.clone()],
                ));
            }
            before.add(slave, number);
        }
    }

    /// The ties, with the distances that the facets of named sides explain, and warnings of those that they do not.
    fn explained_ties(&self) -> (Vec<Tie<S, N>>, Vec<FacetsApart>) {
        let (mut ties, mut found) = (self.ties.clone(), Vec::new());
        let mut none = |_: usize, name: &str| Err(SideError::Unknown { side: name.to_owned(), known: String::new() });
        let mut search = Search::new(self.compiled, &self.bodies, &mut none);
        for tie in ties.iter_mut().filter(|t| t.own.tolerance.is_none()) {
            for pair in tie.own.pairs.iter_mut().filter(|p| p.is_asked) {
                pair.explained = search.tie(pair.slave.clone(), pair.masters.clone(), None).explained;
            }
        }
        found.extend(search.findings.iter().filter_map(touching_bodies::apart));
        (ties, found)
    }

    /// Number of tied sides and curved sides that slide of every function.
    pub(super) fn memberships(&self, model: &Model<S, N>) -> TieCounts {
        self.memberships_but(model, &|_| false)
    }

    /// These, but for tied masters that are parts of the side of `slave`: their functions are free there, unlike those on an edge that the side
    /// has in common with a tied one. `None` if there is no such master.
    fn memberships_beside(&self, model: &Model<S, N>, slave: &BodySide<S, N>) -> Option<TieCounts> {
        let own = |master: &BodySide<S, N>| master.patch == slave.patch && master.side == slave.side;
        let mut masters = self.ties.iter().flat_map(|t| &t.own.pairs).flat_map(|p| &p.masters);
        masters.any(|master| own(master)).then(|| self.memberships_but(model, &own))
    }

    fn memberships_but(&self, model: &Model<S, N>, left_out: &dyn Fn(&BodySide<S, N>) -> bool) -> TieCounts {
        let mut members = self.tied(model, left_out);
        self.said.slides.iter().for_each(|slide| members.add(model, &slide.side));
        members
    }

    /// Number of tied sides of every function, but for masters that are `left_out`; couplings without rows constrain no functions.
    fn tied(&self, model: &Model<S, N>, left_out: &dyn Fn(&BodySide<S, N>) -> bool) -> TieCounts {
        let mut members = TieCounts::default();
        for tie in self.ties.iter().filter(|t| t.own.coupling.has_rows()) {
            // a side in two lists of one tie counts once
            let mut seen = BTreeSet::new();
            for side in tie.own.pairs.iter().flat_map(|p| p.masters.iter().filter(|m| !left_out(m)).chain([&p.slave])) {
                if seen.insert(Arc::as_ptr(side)) {
                    members.add(model, side);
                }
            }
        }
        members
    }
}

/// Sides behind handles, for messages.
impl<const S: usize, const N: usize> Problem<S, N> {
    /// The tie or the contact that a statement is; `None` of any other.
    pub fn interface(&self, of: Statement) -> Option<InterfaceId> {
        let tie = self.ties.iter().map(|t| InterfaceId::from(t.id()));
        tie.chain(self.contacts.iter().map(|c| c.id().into())).find(|id| of == (*id).into())
    }

    /// The slave side with a number, from 0, of a tie or a contact, and its masters; no masters against an obstacle. `None` if there is no
    /// such side.
    pub fn slave_and_masters(&self, of: Statement, slave: usize) -> Option<(Arc<BodySide<S, N>>, Vec<Arc<BodySide<S, N>>>)> {
        if let Some(tie) = self.ties.iter().find(|t| of == t.id().into()) {
            return tie.own.pairs.get(slave).map(|p| (p.slave.clone(), p.masters.clone()));
        }
        let contact = self.contacts.iter().find(|c| of == c.id().into())?;
        let masters = if let StatedOpponent::Sides(masters) = &contact.own.faced { masters.clone() } else { Vec::new() };
        Some((contact.own.slaves.get(slave)?.clone(), masters))
    }

    /// The obstacle of a contact.
    pub(super) fn obstacle(&self, of: Statement) -> Option<MovingObstacle<S, N>> {
        let contact = self.contacts.iter().find(|c| of == c.id().into())?;
        matches!(contact.own.faced, StatedOpponent::Obstacle { .. }).then(|| obstacle(contact, 0))
    }
}

fn some(errors: Vec<ProblemError>) -> Result<(), ProblemErrors> {
    if errors.is_empty() { Ok(()) } else { Err(ProblemErrors(errors)) }
}

/// The error of a slave side, the one with the number `slave` of its tie or contact.
pub(super) fn of_slave<const S: usize, const N: usize>(
    id: impl Into<Statement>,
    slave: usize,
    name: &str,
    side: &BodySide<S, N>,
    error: InterfaceError,
) -> ProblemError {
    ProblemError::new(ErrorKind::Interface { slave, error }, vec![id.into()], vec![name.to_owned(), side.label.clone()])
}

/// The obstacle of a contact, whose unknowns begin at `unknown`.
fn obstacle<const S: usize, const N: usize>(contact: &Contact<S, N>, unknown: usize) -> MovingObstacle<S, N> {
    let StatedOpponent::Obstacle { at_rest, changes } = &contact.own.faced else { unreachable!("the contact faces an obstacle") };
    let pressed = contact.own.forces.iter().enumerate();
    let pressed = pressed.map(|(k, (component, force))| ForceDriven { component: *component, unknown: unknown + k, force: force.clone() });
    let mut motion = vec![None; N];
    for (component, by) in &contact.own.motion {
        motion[*component] = Some(by.clone());
    }
    let changes = *changes || motion.iter().flatten().any(Data::depends_on_time);
    MovingObstacle { at_rest: at_rest.clone(), motion, pressed: pressed.collect(), changes }
}
